//! The forms of B(v) side by side, for the page: what each leaves, what the points support, what trades off.

use super::number::{significant, with_minus};
use super::wording::{Units, moving};
use crate::identify::FrictionFit;
use crate::identify::stribeck::ExponentialFit;
use crate::identify::stribeck::exponentials;
use crate::model::Term;

/// Correlations shown of each direction.
const TRADES_SHOWN: usize = 4;

/// The forms of one direction side by side.
pub struct FormsTable {
    /// The direction.
    pub title: &'static str,
    /// What the points support, and why.
    pub why: String,
    /// The strongest correlations of the parameters taken, in a sentence.
    pub trades: String,
    /// The forms.
    pub rows: Vec<FormRow>,
}

/// One form.
pub struct FormRow {
    /// In words.
    pub name: &'static str,
    /// What it leaves of B, with its unit.
    pub rmse: String,
    /// Akaike's criterion above the best, or why there is none.
    pub aicc: String,
    /// Its rates, s/rad.
    pub rates: String,
    /// Whether it is taken, supported, both or neither.
    pub note: &'static str,
}

/// The forms of `fit`.
pub fn forms_of(fit: &FrictionFit, units: &Units) -> FormsTable {
    let best = fit.forms.iter().map(|form| form.aicc()).fold(f64::INFINITY, f64::min);
    let row = |form: &ExponentialFit| {
        let number = form.rates.len();
        let rates: Vec<String> = form.rates.iter().map(|rate| significant(*rate, 3)).collect();
        FormRow {
            name: exponentials(number),
            rmse: units.torque(form.rmse_nm),
            aicc: match form.aicc().is_finite() {
                true => format!("{:+.1}", form.aicc() - best),
                false if form.freedom() < 1.0 => "exactly determined".to_string(),
                false => "too few points".to_string(),
            },
            rates: rates.join(", "),
            note: note(number == fit.taken.rates.len(), number == fit.supported),
        }
    };
    let rows = fit.forms.iter().map(row).collect();
    FormsTable { title: moving(fit.direction), why: fit.why.clone(), trades: trades(fit), rows }
}

/// The strongest correlations of the parameters taken, in a sentence.
fn trades(fit: &FrictionFit) -> String {
    let pair = |(one, other, r): (Term, Term, f64)| {
        format!("{} and {} {}", one.name(), other.name(), with_minus(&format!("{r:.3}")))
    };
    match &fit.covariance {
        Err(reason) => format!("The covariance of the parameters cannot be computed: {reason}."),
        Ok(covariance) => {
            let pairs: Vec<String> = covariance.strongest(TRADES_SHOWN).into_iter().map(pair).collect();
            format!("Strongest correlations of the parameters: {}.", pairs.join(", "))
        }
    }
}

/// Taken, best supported, both or neither.
pub fn note(taken: bool, supported: bool) -> &'static str {
    match (taken, supported) {
        (true, true) => "selected, best supported",
        (true, false) => "selected",
        (false, true) => "best supported",
        (false, false) => "",
    }
}
