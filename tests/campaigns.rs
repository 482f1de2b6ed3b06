//! Campaigns that tests make: simulated, written to a temporary folder, read back through the front door.

use std::path::Path;
use tautline::identify::{Identification, Settings, run};
use tautline::log::{Campaign, Signal};
use tautline::model::Model;
use tautline::simulate::{Plan, Sensors};
use tempfile::TempDir;

/// A short protocol without noise: eight speeds, one repeat, one cosine cascade, 200 Hz.
pub fn plan() -> Plan {
    Plan {
        speeds: 8,
        slowest_rad_s: 0.05,
        fastest_rad_s: 0.4,
        repeats: 1,
        cosines: 0,
        interactions: 0,
        trajectories: Vec::new(),
        other_joints: 0,
        tracking_error_rad: 0.0,
        controller: None,
        position_alone: false,
        arm: None,
        rate_hz: 200.0,
        sensors: Sensors { torque_noise_nm: 0.0, encoder_counts: 0.0 },
        seed: 1,
        signal: Signal { torque_sign: -1.0, lowpass_hz: 5.0, lowpass_order: 4 },
        parquet: false,
    }
}

/// The bundled elbow's true model.
pub fn truth() -> Model {
    Model::read(Path::new("data/elbow/truth/model.json")).unwrap()
}

/// `plan` recorded from `model`.
pub fn record(model: &Model, plan: &Plan) -> TempDir {
    let folder = TempDir::new().unwrap();
    record_in(folder.path(), model, plan);
    folder
}

/// `plan` recorded from `model` in `folder`, which is made if it is not there.
pub fn record_in(folder: &Path, model: &Model, plan: &Plan) {
    std::fs::create_dir_all(folder).unwrap();
    let trials = plan.trials(model.joint.kind);
    for trial in &trials {
        std::fs::write(folder.join(&trial.entry.file), plan.log_bytes(model, trial).unwrap()).unwrap();
    }
    let campaign = plan.campaign(model, folder, &trials);
    std::fs::write(folder.join("campaign.toml"), campaign.to_toml()).unwrap();
}

/// The campaign in `folder`, identified.
pub fn identified(folder: &Path, settings: Settings) -> Identification {
    run(&Campaign::read(folder).unwrap(), settings, &|| ()).unwrap()
}
