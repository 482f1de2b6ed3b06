//! Which trial of the recordings is which of the simulator's.

use crate::log::{Campaign, TrialEntry};
use crate::problem::{Problem, Result};
use std::path::Path;

/// Places of partners in the two lists.
pub(super) type Pair = (usize, usize);

/// Partners: logs of one name whatever their format, else of one protocol, speed, trajectory and repeat. What has none comes
/// back as warnings.
///
/// Errors: nothing has a partner.
pub(super) fn pairs(real: &Campaign, simulated: &Campaign) -> Result<(Vec<Pair>, Vec<String>)> {
    let mut left: Vec<usize> = (0..simulated.trials.len()).collect();
    let mut found: Vec<Option<usize>> = vec![None; real.trials.len()];
    for same in [same_name, same_motion] {
        for (partner, entry) in found.iter_mut().zip(&real.trials).filter(|(partner, _)| partner.is_none()) {
            let at = left.iter().position(|at| same(entry, &simulated.trials[*at]));
            *partner = at.map(|at| left.remove(at));
        }
    }
    let pairs: Vec<Pair> = found.iter().enumerate().filter_map(|(at, partner)| Some((at, (*partner)?))).collect();
    if pairs.is_empty() {
        let of = |campaign: &Campaign| campaign.trials.first().map_or("", |entry| &entry.file).to_string();
        let what = format!(
            "no trial is one of {}: neither a log's name (`{}` there, `{}` here) nor protocol, speed, trajectory and repeat are \
             the same",
            real.file.display(),
            of(real),
            of(simulated)
        );
        let cure = "let the simulator play the recorded commands, and call each log as the recorded one";
        return Problem::error(&simulated.file, what, cure).alone();
    }
    let alone = found.iter().zip(&real.trials).filter(|(partner, _)| partner.is_none()).map(|(_, entry)| entry);
    let mut warnings: Vec<String> =
        alone.map(|entry| format!("{} has no partner among the simulated trials", entry.file)).collect();
    let without =
        |at: &usize| format!("simulated {} has no partner among the recorded trials", simulated.trials[*at].file);
    warnings.extend(left.iter().map(without));
    Ok((pairs, warnings))
}

fn same_name(a: &TrialEntry, b: &TrialEntry) -> bool {
    Path::new(&a.file).file_stem() == Path::new(&b.file).file_stem()
}

fn same_motion(a: &TrialEntry, b: &TrialEntry) -> bool {
    a.protocol == b.protocol && a.trajectory == b.trajectory && a.repeat == b.repeat
}
