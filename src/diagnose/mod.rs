//! Where the gap between model and recordings lies, which unmodelled effect causes it, and how far it shrinks once that is added.
//!
//! The floor first; then every candidate fitted along with the base inside its confidence, judged on units that its fit never
//! saw; then the verdict.

mod candidates;
mod choose;
mod extent;
mod fit;
mod floor;
mod gram;
mod moves;
mod parts;
mod record;
mod ripple;

pub use candidates::{Cause, Tried};
pub use choose::{Choice, Found};
pub use floor::{Floor, FloorSource};

use crate::evaluate::fitted;
use crate::log::Campaign;
use crate::model::Model;
use crate::problem::Result;
use fit::Bench;
use parts::Parts;
use record::Records;

/// Looks at `campaign` with `model`.
pub fn run(campaign: &Campaign, model: &Model, progress: &(dyn Fn() + Sync)) -> Result<()> {
    let (model, _warnings) = fitted(campaign, model)?;
    let t0 = std::time::Instant::now();
    let records = Records::read(campaign, &model, progress)?;
    let parts = Parts::new(&records);
    let mut bench = Bench {
        records: &records,
        measured_nm: records.measured_nm(),
        parts: &parts,
        extent: extent::of(&records, &model),
        used: records.rows(|record, i| !(model.combination == crate::model::Combination::Sign && record.rests[i])),
        floor_nm: 0.0,
    };
    eprintln!("read {:.2}s rows {} units {}", t0.elapsed().as_secs_f64(), records.count(), parts.units.len());
    let ground = bench.ground(&model, moves::within_confidence(&model));
    let delivered = bench.residual_nm(&ground.predicted_nm);
    let floor = floor::floor(&records, &bench.rest_residual_nm(&ground));
    bench.floor_nm = floor.rms_nm;
    let rms = crate::numerics::statistics::root_mean_square(&delivered);
    eprintln!("rmse {rms:.5} floor {floor:?}");
    let choice = choose::choose(&bench, &model, progress);
    let rest = candidates::score(&bench, &choice.rest);
    eprintln!("rest {:.5} surprise {:.2}", rest.sqrt(), choice.rest.cost.surprise);
    for found in &choice.found {
        eprintln!("FOUND {} {} rivals {:?}", found.cause.name(), found.how, found.rivals);
        for t in found.tried.iter().take(7) {
            eprintln!(
                "   {:.5} surprise {:.2} {} {} [{}] {:?}",
                t.score(&bench).sqrt(),
                t.fit.cost.surprise,
                t.cause.name(),
                t.how,
                t.count(),
                t.fit.model.effects.last().map(|e| e.parameters.clone())
            );
        }
    }
    eprintln!("refused:");
    for t in choice.refused.iter().take(4) {
        eprintln!(
            "   {:.5} surprise {:.2} {} {} [{}]",
            t.score(&bench).sqrt(),
            t.fit.cost.surprise,
            t.cause.name(),
            t.how,
            t.count()
        );
    }
    eprintln!("last {:.5}  {:.2}s", candidates::score(&bench, &choice.last).sqrt(), t0.elapsed().as_secs_f64());
    Ok(())
}
