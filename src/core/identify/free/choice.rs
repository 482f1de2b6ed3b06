//! Which form of friction with which curve: the two that support each other.

use super::FreeForm;
use super::search::{Judged, Search};
use crate::identify::combination::{CurveKind, best_supported};
use crate::identify::support::supported;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Rounds after which form and curve should have settled; they need two, seldom three.
const ROUNDS: usize = 4;

/// A curve with a form.
type Cell = (CurveKind, FreeForm);

/// The form and the curve taken, with all that was judged on the way.
pub struct Choice {
    /// The form.
    pub form: FreeForm,
    /// The curve.
    pub kind: CurveKind,
    /// The curve that the data support with this form.
    pub supported: CurveKind,
    judged: BTreeMap<(usize, usize), Judged>,
}

impl Choice {
    /// Looks for them: the curve judged with the form, the form with the curve, until neither changes. A `wanted` curve is
    /// taken whatever the data support.
    pub fn new(search: &Search, wanted: Option<CurveKind>) -> Self {
        let load = CurveKind::ALL.par_iter().map(|kind| (key(*kind, FreeForm::Load), search.judge_load(*kind)));
        let mut choice =
            Self { form: FreeForm::Load, kind: CurveKind::Sign, supported: CurveKind::Sign, judged: load.collect() };
        for _ in 0..ROUNDS {
            let curves = choice.judge(search, &CurveKind::ALL.map(|kind| (kind, choice.form)));
            choice.supported = CurveKind::ALL[best_supported(&curves)];
            choice.kind = wanted.unwrap_or(choice.supported);
            let cells: Vec<Cell> = search.forms.iter().map(|form| (choice.kind, *form)).collect();
            let form = search.forms[supported(&choice.judge(search, &cells), |_| true)];
            if form == choice.form {
                break;
            }
            choice.form = form;
        }
        choice.judge(search, &CurveKind::ALL.map(|kind| (kind, choice.form)));
        choice
    }

    /// This curve with this form, judged; both curves with the form taken and forms with the curve taken are.
    pub fn judged(&self, kind: CurveKind, form: FreeForm) -> &Judged {
        &self.judged[&key(kind, form)]
    }

    /// Judges those of `cells` that are not yet, and gives the squares of all.
    fn judge(&mut self, search: &Search, cells: &[Cell]) -> Vec<Vec<f64>> {
        let missing = cells.par_iter().filter(|(kind, form)| !self.judged.contains_key(&key(*kind, *form)));
        let judge = |(kind, form): &Cell| {
            (key(*kind, *form), search.judge_form(*kind, *form, self.judged(*kind, FreeForm::Load)))
        };
        let found: Vec<((usize, usize), Judged)> = missing.map(judge).collect();
        self.judged.extend(found);
        cells.iter().map(|(kind, form)| self.judged(*kind, *form).squares()).collect()
    }
}

fn key(kind: CurveKind, form: FreeForm) -> (usize, usize) {
    (kind as usize, form as usize)
}
