//! The thresholds by which a diagnosis decides, in one place; `policy/1`, a file that changes some.
//!
//! What is here somebody chose, by reason or by blind simulated cases (`scripts/blind/sensitivity.py` tells how their score moves with each).
//! Numbers that follow from sampling or numerics stand where they are used.

use crate::document::Document;
use crate::problem::Result;
use std::path::Path;

/// The format's name and version.
pub const FORMAT: &str = "policy/1";

/// Every threshold of judgement. The text of a field is its unit, a colon, and the reason: files, schema and guide take it from here.
///
/// "Gap" is what exceeds the floor's square of what the base leaves within its confidence, "remainder" the same of what causes already chosen
/// leave; a "floor" is the noise floor, RMS.
#[derive(Debug, Clone, PartialEq)]
pub struct Policy {
    /// Floors, RMS: the first cause must change the prediction by this much; a weaker one cannot be distinguished from an error of the floor,
    /// unless it spares the base (`prior_penalty_apart`). What all causes leave is material if a fit without physics finds this much of it
    /// again on held-out data, beyond what the encoder leaves: of noise none finds any.
    pub first_floors: f64,
    /// Floors, RMS: a further cause must change the prediction by this much, more than the first: what that leaves may be misfit of its formula.
    pub further_floors: f64,
    /// Share of the gap's square: the first cause must explain this much of it; less does not account for the gap.
    pub first_gap_share: f64,
    /// Share of the remainder's square: a further cause must explain this much of it, unless it is distinct.
    pub further_remainder_share: f64,
    /// Share of the square that the causes before it explain: a further cause must exceed this, which may be misfit of their formulas.
    pub further_explained_share: f64,
    /// Share of the gap's square: enough for a further cause; in a gap with many small causes even a large one is a small share of the
    /// remainder.
    pub further_gap_share: f64,
    /// Share of the remainder's square: enough for a further cause, if it reaches `further_floors`; one cause seldom explains to the floor what is
    /// misfit of another's formula.
    pub further_closing_share: f64,
    /// Share of its gain: a further cause that is ahead of every other cause by this much is distinct; `distinct_remainder_share` is then enough. An
    /// effect that came out with numbers that suit another as well is not distinguished from that if it is ahead by less.
    pub distinct_share: f64,
    /// Share of the remainder's square: a distinct further cause must explain this much of it, less than one that others could replace.
    pub distinct_remainder_share: f64,
    /// Standard errors over clusters (trials or cycles): the gain of a cause must exceed this many, but for one that spares the base
    /// (`prior_penalty_apart`).
    pub gain_errors: f64,
    /// Multiple, of squares: the gain of a cause must exceed the gain that the encoder's errors alone, simulated once, would give by this
    /// factor.
    pub gain_over_encoder: f64,
    /// Share of the gain of the clusters that improve: the others may lose at most this much where the standard errors do not decide.
    pub gain_lost_share: f64,
    /// Standard errors over clusters: a cause behind the best by no more does as well, and the simpler is preferred, the equal a rival.
    pub tie_errors: f64,
    /// Share of the gap's square, once more for each parameter fewer: a cause behind the best by no more does as well; so small a
    /// difference has no practical meaning.
    pub tie_gap_share: f64,
    /// Share of the floor's square: a cause behind the best by no more does as well; so small a difference is noise.
    pub tie_floor_share: f64,
    /// Share of the square that the best cause leaves above the floor: a cause behind it by no more does as well; where the formula of the best
    /// does not fit exactly, as much of the others' misfit may be due to their formulas.
    pub tie_remainder_share: f64,
    /// Share of the gap's square: causes that differ by more do not tie, however uncertain they are.
    pub tie_gap_share_max: f64,
    /// Share of the floor's square: a cause that leaves no more than this above it has an exact formula, as far as noise shows. What it leaves
    /// beyond is misfit of its form; another form of the same effect that leaves more by less than that misfit, or by less than `gain_errors`,
    /// is not distinguished from it.
    pub form_exact_floor_share: f64,
    /// Squared standard deviations: a cause that moves the base by this much more is worse; its prior is e^-5 times as likely. A
    /// first cause that the base imitates to within `first_floors` may be named if it spares the base as much, and `prior_penalty_per_parameter` more for
    /// each of its numbers.
    pub prior_penalty_apart: f64,
    /// Squared standard deviations: each parameter fewer is worth this much of the prior penalty, as much as determining one to a hundredth of
    /// its range (2 ln 100).
    pub prior_penalty_per_parameter: f64,
    /// Floors, RMS: what all causes leave is material if it exceeds this, slow noise left out of the floor, and `open_share`.
    pub open_floors: f64,
    /// Share of the residual of the base, RMS: what all causes leave is material if it exceeds this and `open_floors`.
    pub open_share: f64,
    /// Floors, RMS: causes other than contact leave more than this and `form_share` only if a formula is wrong; slow noise is in the floor.
    pub form_floors: f64,
    /// Share of the residual of the base, RMS: causes other than contact leave more than this and `form_floors` only if a formula is wrong.
    pub form_share: f64,
    /// Share of the residual of the base, RMS: causes that leave more do not name the gap; it is a fifth of the energy.
    pub unnamed_share: f64,
    /// Multiple, RMS: where the base leaves more than this times what the model left of the recordings that it was identified from, the gap to
    /// be named is what lies above that.
    pub news_factor: f64,
    /// Floors, RMS: where the residual of the base is below this, causes are named only if most of the resamples agree.
    pub weak_floors: f64,
    /// Floors, RMS: a verdict that names causes is clear only if the gap is at least this large.
    pub clear_floors: f64,
    /// Share of the gap, RMS: a verdict that names causes is clear only if they leave no more than this.
    pub clear_share: f64,
    /// Weight: resamples that disagree count with this where causes are named. Most of them prefer a rival for the same part of the gap, and blind
    /// verdicts on which few agreed were not right that much more seldom (agreement below 0.8: 35 of 53, else 451 of 515).
    pub disagreement_weight: f64,
    /// Multiple of the usual level of the residual: a contact event reaches this.
    pub contact_peak: f64,
    /// Floors: where the usual level exceeds this, misfit has peaks too, and a contact event must be larger in proportion to the root of the
    /// excess.
    pub contact_misfit_floors: f64,
    /// Multiple of the usual level: a contact event lasts as long as it stays above this.
    pub contact_edge: f64,
    /// Share of a contact event's square: a model that leaves less of it predicts it, and it was no contact.
    pub contact_left_share: f64,
    /// Share of a contact event's peak: a residual that reaches this in the same state elsewhere repeats, and was no contact; between
    /// repeats of one motion, peaks are alike if the ratio of the smaller to the larger exceeds it.
    pub contact_repeated_share: f64,
    /// Quantile of the residual in the same state elsewhere: this one is compared with `contact_repeated_share`, so one row of five must
    /// reach that.
    pub contact_repeated_quantile: f64,
    /// Factor: speeds within it belong to the same state.
    pub contact_speed_factor: f64,
    /// Multiple: the encoder's errors may be this many times as large as one simulation of them; an event below that was no contact.
    pub contact_over_encoder: f64,
    /// Standard errors: by more of them events gather where the joint is slow, and those at the slower half of all samples were no contacts.
    pub contact_slow_errors: f64,
    /// Standard errors: events that gather at one speed or acceleration by more of them were no contacts.
    pub contact_gather_errors: f64,
    /// Lobes of alternating sign: a residual with so many oscillates, and was no contact.
    pub contact_swings: f64,
    /// Share of the largest lobe's area: smaller lobes of an oscillating residual do not count.
    pub contact_swing_share: f64,
    /// Floors of noise, RMS over all rows: contact is reported as a cause above this and `contact_encoder_share`, their squares added.
    pub contact_floors: f64,
    /// Share of the encoder's part of the floor, RMS over all rows: contact is reported as a cause above this and `contact_floors`, their
    /// squares added; the encoder's part repeats with the motion, so it hides less.
    pub contact_encoder_share: f64,
    /// Multiple, RMS: contact is not needed where causes leave at most this times, over all rows, what they leave without the rows of contact
    /// events.
    pub contact_needless_factor: f64,
    /// Share of the range of positions: closer positions are the same place, within one motion and between its repeats. As a share of the largest
    /// speed: two speeds below it count as equal, whatever their ratio and sign.
    pub same_place_share: f64,
    /// Multiple of the median: blocks of differences between repeats that exceed it hold more than noise.
    pub floor_outlier: f64,
    /// Factor, RMS: slow noise raises the floor by no more than this, however much there seems to be: the rest may have a cause.
    pub floor_rise_max: f64,
    /// Factor, RMS: noise that is not white may differ from the density carried on from beyond the low-pass by this: without repeats, what causes
    /// leave counts as such noise up to there if a flexible fit predicts none of it, and all of what is left if the density would make it larger.
    /// Noise is no louder than this times what is left at the speeds where that is quietest. Where nothing is named, repeats that
    /// differ at some speeds by more than this times what that density (at least that next to the low-pass) and the encoder would give do not differ
    /// by noise: the verdict is `unknown`.
    pub floor_coloured_max: f64,
    /// Factor, RMS: noise is no louder than this times what is left in the third of the motion cycles that is quietest (of simulated campaigns in
    /// which nothing is wrong 98 of 100 are within 1.44).
    pub floor_unsteady_max: f64,
    /// Share of the square of what is left: more of it that lasts for ten independent samples is no noise, whether a fit predicts it or not.
    /// Neither is what lasts less than this share of what white noise would: it swings faster.
    pub floor_lasting_share: f64,
    /// Share of the rise of the floor's square: its standard error; the recordings hold few independent stretches of slow noise.
    pub floor_rise_error: f64,
    /// Share of the square of the residual above the fast floor: without repeats, all of it is noise if a flexible fit predicts no more than
    /// this on held-out data.
    pub floor_found_again_share: f64,
    /// Share of the floor's square: its standard error at least, however many repeats there are; noise differs between trials, and what repeats
    /// differ by is not all noise (simulated campaigns scatter by 0.08 about what chance allows).
    pub floor_repeats_error: f64,
    /// Share of the floor's square: the standard error of a floor from the spectrum.
    pub floor_spectrum_error: f64,
    /// Share of the encoder's mean square: its standard error, because it is simulated once.
    pub floor_encoder_error: f64,
    /// Multiple of the median power of its neighbourhood: a line in the spectrum that exceeds it is an oscillation; of a thousand independent
    /// frequencies of noise the strongest has about 10.
    pub oscillation_prominence: f64,
    /// Periods in a stretch: an oscillation has at least this many; fewer are a drift, or the motion itself.
    pub oscillation_periods: f64,
    /// Orders: an oscillation at a multiple of a frequency of the motion, up to this one, is due to the motion.
    pub oscillation_orders: f64,
}

impl Default for Policy {
    fn default() -> Self {
        Self {
            first_floors: 0.4,
            further_floors: 0.9,
            first_gap_share: 0.15,
            further_remainder_share: 0.30,
            further_explained_share: 0.035,
            further_gap_share: 0.12,
            further_closing_share: 0.7,
            distinct_share: 0.25,
            distinct_remainder_share: 0.1,
            gain_errors: 2.0,
            gain_over_encoder: 2.5,
            gain_lost_share: 0.2,
            tie_errors: 1.5,
            tie_gap_share: 0.001,
            tie_floor_share: 0.01,
            tie_remainder_share: 0.05,
            tie_gap_share_max: 0.05,
            form_exact_floor_share: 0.05,
            prior_penalty_apart: 10.0,
            prior_penalty_per_parameter: 9.0,
            open_floors: 1.0,
            open_share: 0.4,
            form_floors: 0.75,
            form_share: 0.25,
            unnamed_share: 0.45,
            news_factor: 1.25,
            weak_floors: 0.6,
            clear_floors: 1.0,
            clear_share: 0.1,
            disagreement_weight: 0.2,
            contact_peak: 4.0,
            contact_misfit_floors: 1.5,
            contact_edge: 1.8,
            contact_left_share: 0.5,
            contact_repeated_share: 0.4,
            contact_repeated_quantile: 0.8,
            contact_speed_factor: 1.6,
            contact_over_encoder: 2.5,
            contact_slow_errors: 2.0,
            contact_gather_errors: 3.0,
            contact_swings: 4.0,
            contact_swing_share: 0.25,
            contact_floors: 0.3,
            contact_encoder_share: 0.3,
            contact_needless_factor: 1.2,
            same_place_share: 0.02,
            floor_outlier: 3.0,
            floor_rise_max: 1.25,
            floor_coloured_max: 2.0,
            floor_unsteady_max: 1.5,
            floor_lasting_share: 0.5,
            floor_rise_error: 0.5,
            floor_found_again_share: 0.04,
            floor_repeats_error: 0.06,
            floor_spectrum_error: 0.1,
            floor_encoder_error: 0.3,
            oscillation_prominence: 40.0,
            oscillation_periods: 5.0,
            oscillation_orders: 12.0,
        }
    }
}

/// One threshold: how it is called in files, and where it stands.
#[derive(Debug, Clone, Copy)]
pub struct Threshold {
    /// The name of its field.
    pub name: &'static str,
    field: fn(&mut Policy) -> &mut f64,
}

/// All thresholds, in the order of the fields.
pub const ENTRIES: [Threshold; 59] = [
    Threshold { name: "first_floors", field: |policy| &mut policy.first_floors },
    Threshold { name: "further_floors", field: |policy| &mut policy.further_floors },
    Threshold { name: "first_gap_share", field: |policy| &mut policy.first_gap_share },
    Threshold { name: "further_remainder_share", field: |policy| &mut policy.further_remainder_share },
    Threshold { name: "further_explained_share", field: |policy| &mut policy.further_explained_share },
    Threshold { name: "further_gap_share", field: |policy| &mut policy.further_gap_share },
    Threshold { name: "further_closing_share", field: |policy| &mut policy.further_closing_share },
    Threshold { name: "distinct_share", field: |policy| &mut policy.distinct_share },
    Threshold { name: "distinct_remainder_share", field: |policy| &mut policy.distinct_remainder_share },
    Threshold { name: "gain_errors", field: |policy| &mut policy.gain_errors },
    Threshold { name: "gain_over_encoder", field: |policy| &mut policy.gain_over_encoder },
    Threshold { name: "gain_lost_share", field: |policy| &mut policy.gain_lost_share },
    Threshold { name: "tie_errors", field: |policy| &mut policy.tie_errors },
    Threshold { name: "tie_gap_share", field: |policy| &mut policy.tie_gap_share },
    Threshold { name: "tie_floor_share", field: |policy| &mut policy.tie_floor_share },
    Threshold { name: "tie_remainder_share", field: |policy| &mut policy.tie_remainder_share },
    Threshold { name: "tie_gap_share_max", field: |policy| &mut policy.tie_gap_share_max },
    Threshold { name: "form_exact_floor_share", field: |policy| &mut policy.form_exact_floor_share },
    Threshold { name: "prior_penalty_apart", field: |policy| &mut policy.prior_penalty_apart },
    Threshold { name: "prior_penalty_per_parameter", field: |policy| &mut policy.prior_penalty_per_parameter },
    Threshold { name: "open_floors", field: |policy| &mut policy.open_floors },
    Threshold { name: "open_share", field: |policy| &mut policy.open_share },
    Threshold { name: "form_floors", field: |policy| &mut policy.form_floors },
    Threshold { name: "form_share", field: |policy| &mut policy.form_share },
    Threshold { name: "unnamed_share", field: |policy| &mut policy.unnamed_share },
    Threshold { name: "news_factor", field: |policy| &mut policy.news_factor },
    Threshold { name: "weak_floors", field: |policy| &mut policy.weak_floors },
    Threshold { name: "clear_floors", field: |policy| &mut policy.clear_floors },
    Threshold { name: "clear_share", field: |policy| &mut policy.clear_share },
    Threshold { name: "disagreement_weight", field: |policy| &mut policy.disagreement_weight },
    Threshold { name: "contact_peak", field: |policy| &mut policy.contact_peak },
    Threshold { name: "contact_misfit_floors", field: |policy| &mut policy.contact_misfit_floors },
    Threshold { name: "contact_edge", field: |policy| &mut policy.contact_edge },
    Threshold { name: "contact_left_share", field: |policy| &mut policy.contact_left_share },
    Threshold { name: "contact_repeated_share", field: |policy| &mut policy.contact_repeated_share },
    Threshold { name: "contact_repeated_quantile", field: |policy| &mut policy.contact_repeated_quantile },
    Threshold { name: "contact_speed_factor", field: |policy| &mut policy.contact_speed_factor },
    Threshold { name: "contact_over_encoder", field: |policy| &mut policy.contact_over_encoder },
    Threshold { name: "contact_slow_errors", field: |policy| &mut policy.contact_slow_errors },
    Threshold { name: "contact_gather_errors", field: |policy| &mut policy.contact_gather_errors },
    Threshold { name: "contact_swings", field: |policy| &mut policy.contact_swings },
    Threshold { name: "contact_swing_share", field: |policy| &mut policy.contact_swing_share },
    Threshold { name: "contact_floors", field: |policy| &mut policy.contact_floors },
    Threshold { name: "contact_encoder_share", field: |policy| &mut policy.contact_encoder_share },
    Threshold { name: "contact_needless_factor", field: |policy| &mut policy.contact_needless_factor },
    Threshold { name: "same_place_share", field: |policy| &mut policy.same_place_share },
    Threshold { name: "floor_outlier", field: |policy| &mut policy.floor_outlier },
    Threshold { name: "floor_rise_max", field: |policy| &mut policy.floor_rise_max },
    Threshold { name: "floor_coloured_max", field: |policy| &mut policy.floor_coloured_max },
    Threshold { name: "floor_unsteady_max", field: |policy| &mut policy.floor_unsteady_max },
    Threshold { name: "floor_lasting_share", field: |policy| &mut policy.floor_lasting_share },
    Threshold { name: "floor_rise_error", field: |policy| &mut policy.floor_rise_error },
    Threshold { name: "floor_found_again_share", field: |policy| &mut policy.floor_found_again_share },
    Threshold { name: "floor_repeats_error", field: |policy| &mut policy.floor_repeats_error },
    Threshold { name: "floor_spectrum_error", field: |policy| &mut policy.floor_spectrum_error },
    Threshold { name: "floor_encoder_error", field: |policy| &mut policy.floor_encoder_error },
    Threshold { name: "oscillation_prominence", field: |policy| &mut policy.oscillation_prominence },
    Threshold { name: "oscillation_periods", field: |policy| &mut policy.oscillation_periods },
    Threshold { name: "oscillation_orders", field: |policy| &mut policy.oscillation_orders },
];

impl Threshold {
    /// Its value in `policy`.
    pub fn of(&self, policy: &Policy) -> f64 {
        *(self.field)(&mut policy.clone())
    }

    /// Its unit and its reason, from the documentation of its field: they are written once.
    pub fn unit_and_reason(&self) -> (String, String) {
        documented().find(|(name, _)| *name == self.name).map(|(_, text)| text).unwrap_or_default()
    }
}

/// Name, unit and reason of every field of [`Policy`], from this file.
fn documented() -> impl Iterator<Item = (&'static str, (String, String))> {
    let fields =
        include_str!("policy.rs").split("pub struct Policy {").nth(1).and_then(|rest| rest.split("\n}").next());
    fields.unwrap_or_default().split(": f64,").filter_map(|field| {
        let (text, name) = field.split_once("pub ")?;
        let text: Vec<&str> = text.lines().filter_map(|line| line.trim_start().strip_prefix("/// ")).collect();
        let text = text.join(" ");
        let (unit, reason) = text.split_once(": ")?;
        Some((name, (unit.to_string(), reason.to_string())))
    })
}

impl Policy {
    /// Reads a policy: the default, but for the thresholds that `file` names.
    ///
    /// Errors: the file, an unknown key, a value that is not finite and above 0.
    pub fn read(file: &Path) -> Result<Self> {
        Self::from_document(&Document::open(file)?)
    }

    fn from_document(document: &Document) -> Result<Self> {
        document.read(|root| {
            root.need("format").choice(&[(FORMAT, ())]);
            let mut policy = Self::default();
            for threshold in &ENTRIES {
                if let Some(value) = root.may(threshold.name).positive() {
                    *(threshold.field)(&mut policy) = value;
                }
            }
            Some(policy)
        })
    }

    /// Names and values of the thresholds that differ from the default.
    pub fn changed(&self) -> Vec<(&'static str, f64)> {
        let default = Self::default();
        let changed = ENTRIES.iter().filter(|threshold| threshold.of(self) != threshold.of(&default));
        changed.map(|threshold| (threshold.name, threshold.of(self))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{ENTRIES, Policy, Threshold, documented};
    use crate::document::Document;

    #[test]
    fn every_field_is_listed_once_with_unit_and_reason() {
        // The fields as the compiler knows them.
        let shown = format!("{:?}", Policy::default());
        let fields: Vec<&str> = shown.split(": ").filter_map(|part| part.rsplit([' ', '{']).next()).collect();
        let names = ENTRIES.map(|threshold| threshold.name);
        assert_eq!(fields[..fields.len() - 1], names);
        assert_eq!(documented().map(|(name, _)| name).collect::<Vec<&str>>(), names);
        for threshold in &ENTRIES {
            let (unit, reason) = threshold.unit_and_reason();
            assert!(!unit.is_empty() && reason.len() > 20, "{}: {unit}: {reason}", threshold.name);
        }
    }

    #[test]
    fn each_name_leads_to_its_own_field() {
        for Threshold { name, field } in &ENTRIES {
            let mut policy = Policy::default();
            *field(&mut policy) *= 1.25;
            assert!(format!("{policy:?}").contains(&format!("{name}: {:?}", *field(&mut policy))), "{name}");
            assert_eq!(policy.changed(), [(*name, *field(&mut policy))]);
        }
    }

    #[test]
    fn a_file_changes_the_thresholds_that_it_names_and_no_others() {
        let read = |text: &str| Policy::from_document(&Document::from_toml("policy.toml".as_ref(), text).unwrap());
        let policy = read("format = \"policy/1\"\nfirst_floors = 1\n").unwrap();
        assert_eq!(policy, Policy { first_floors: 1.0, ..Policy::default() });
        let told =
            read("format = \"policy/1\"\nfirst_floor = 1\nopen_share = 0\ntie_errors = inf\n").unwrap_err().to_string();
        assert!(told.contains("did you mean `first_floors`?"), "{told}");
        assert_eq!(told.matches("expected a number above 0").count(), 2, "{told}");
        assert!(read("first_floors = 1\n").unwrap_err().to_string().contains("policy/1"));
    }
}
