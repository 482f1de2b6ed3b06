//! The noise floor: the part of the torque that no model could explain, because it does not repeat with the motion.
//!
//! From repeats of one motion: half the variance of the difference of their residuals, aligned in time by their positions. Slow differences
//! are removed (a drift between repeats is not noise), and blocks are combined by their median (neither is a contact in one repeat). Rows that a
//! contact event sets aside do not count, and no floor is much above what is left in the quietest cycles.
//! Without repeats: the density of the raw torque's noise beyond the low-pass, extrapolated below; where no fit predicts any of the
//! residual on held-out data, all of it; where the rate leaves no room beyond the low-pass, what no fit predicts. In each case the residual that
//! the encoder's steps give a perfect model is added, as far as it repeats with the motion.

use super::mask::Mask;
use super::policy::Policy;
use super::repeats::{BLOCKS_MIN, Differences};
use super::spectrum::SpectralFloor;
use crate::dynamics::AT_REST_RAD_S;
use crate::model::Model;
use crate::numerics::statistics::{quantile, root_mean_square};
use std::ops::Range;

/// Independent samples in a block.
const BLOCK: f64 = 10.0;
/// The same once the causes are known, and a drift is explained: noise that is not white has its slow part, too.
const BLOCK_LATER: f64 = 40.0;
/// Fewer independent samples in a third of the speeds do not show how loud it is there.
const THIRD_MIN: f64 = 25.0;
/// Of fewer motion cycles chance alone makes the quietest third much quieter than the rest ...
const UNITS_MIN: usize = 6;
/// ... and so it does of cycles with fewer rows that count.
const UNIT_ROWS_MIN: usize = 25;

/// The floor and where it comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Floor {
    /// RMS, N m, at the declared low-pass.
    pub rms_nm: f64,
    /// RMS of its quick part, N m: slow noise may come on top.
    pub quick_nm: f64,
    /// The residual that the encoder alone gives a perfect model in every repeat of a motion, N m; included in the RMS above.
    pub encoder_nm: f64,
    /// The same as simulated, N m: more where the model leaves less than that, which is then all that is counted.
    pub encoder_simulated_nm: f64,
    /// Its source.
    pub source: FloorSource,
    /// Standard error of the floor's square as a share of it.
    pub relative_error: f64,
    /// RMS of what a fit without physics finds again, on held-out units, of what is left, less what the encoder leaves, which repeats, too, N m:
    /// nothing of noise.
    pub found_again_nm: f64,
    /// What repeats of one motion differ by over what the noise beyond the low-pass and the encoder would give, RMS, at the speeds where that is
    /// most; nothing where there are no repeats, or no such noise is recorded.
    pub differing: Option<f64>,
}

impl Floor {
    /// The floor's square with its standard error, (N m)^2: what lies above it is a gap, in spite of the floor's error.
    pub fn upper_square(&self) -> f64 {
        self.rms_nm * self.rms_nm * (1.0 + self.relative_error)
    }

    /// The floor with its standard error, N m: where the gap begins.
    pub fn upper_nm(&self) -> f64 {
        self.upper_square().sqrt()
    }

    /// A floor of noise alone.
    pub(super) fn of_noise(rms_nm: f64, source: FloorSource, relative_error: f64) -> Self {
        let (encoder_nm, encoder_simulated_nm, found_again_nm) = (0.0, 0.0, 0.0);
        Self {
            rms_nm,
            quick_nm: rms_nm,
            encoder_nm,
            encoder_simulated_nm,
            source,
            relative_error,
            found_again_nm,
            differing: None,
        }
    }

    /// The floor of noise alone, its square raised by that of the encoder, (N m)^2, both limited to `most_square`: no floor is above the
    /// residual of a fit on held-out units.
    fn with_encoder(self, policy: &Policy, encoder_square: f64, most_square: f64) -> Self {
        let encoder_simulated_nm = encoder_square.sqrt();
        let encoder_square = encoder_square.min((most_square - self.rms_nm.powi(2)).max(0.0));
        let with = |nm: f64| ((nm * nm).min(most_square) + encoder_square).sqrt();
        let rms_nm = with(self.rms_nm);
        let share = encoder_square / rms_nm.powi(2).max(f64::MIN_POSITIVE);
        let relative_error = ((1.0 - share) * self.relative_error).hypot(policy.floor_encoder_error * share);
        let (quick_nm, encoder_nm) = (with(self.quick_nm), encoder_square.sqrt());
        Self { rms_nm, quick_nm, relative_error, encoder_nm, encoder_simulated_nm, ..self }
    }

    /// The same of its quick part.
    pub fn quick_upper_square(&self) -> f64 {
        self.quick_nm * self.quick_nm * (1.0 + self.relative_error)
    }
}

/// Where a floor comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FloorSource {
    /// Repeats of one motion.
    Repeats,
    /// The noise beyond the low-pass, its density carried on below.
    Spectrum,
    /// The whole residual: no fit predicts it on held-out data.
    Unforeseen,
}

impl FloorSource {
    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Repeats => "repeats",
            Self::Spectrum => "spectrum",
            Self::Unforeseen => "unforeseen",
        }
    }
}

/// The floor of noise alone under `residual_nm` where `mask` counts; some fit leaves `most_square` on held-out units: where the density
/// extrapolated below the low-pass exceeds that, or none was recorded, all of it is noise; where far, the density was not that of noise, and only
/// its lowest part is used.
pub fn of_noise(mask: &Mask<'_>, residual_nm: &[f64], most_square: f64) -> Floor {
    of_differences(mask, &Differences::of(mask, residual_nm, BLOCK), residual_nm, most_square)
}

/// The same by what repeats have in `residual_nm` that differs.
fn of_differences(mask: &Mask<'_>, differences: &Differences, residual_nm: &[f64], most_square: f64) -> Floor {
    let (data, steady_square) = (mask.data, most_steady_square(mask, residual_nm));
    if let Some(usual_square) = differences.usual_square() {
        let most = differences.of_one(most_of_noise(&data.policy, differences.by_speed()));
        let rms_nm = usual_square.min(most).min(steady_square).sqrt();
        let chance = (std::f64::consts::PI / (BLOCK * differences.blocks().len() as f64)).sqrt();
        let relative_error = chance.hypot(data.policy.floor_repeats_error);
        return Floor::of_noise(rms_nm, FloorSource::Repeats, relative_error);
    }
    let most_nm = most_square.min(steady_square).sqrt();
    let (carried_nm, white_nm) =
        (usual_spectral(mask, |floor| floor.carried_nm), usual_spectral(mask, |floor| floor.white_nm));
    let (rms_nm, source) = match carried_nm.zip(white_nm) {
        Some((carried_nm, _)) if carried_nm <= data.policy.floor_coloured_max * most_nm => {
            (carried_nm.min(most_nm), FloorSource::Spectrum)
        }
        Some((_, white_nm)) => (white_nm.min(most_nm), FloorSource::Spectrum),
        None => (most_nm, FloorSource::Unforeseen),
    };
    Floor::of_noise(rms_nm, source, data.policy.floor_spectrum_error)
}

/// What the recordings usually have `of` their spectral floor, N m; nothing where none has any.
fn usual_spectral(mask: &Mask<'_>, of: fn(&SpectralFloor) -> f64) -> Option<f64> {
    let records = mask.data.records.all.iter();
    let mut floors: Vec<f64> =
        records.map(|record| of(&record.spectral_floor)).filter(|floor| floor.is_finite()).collect();
    Some(quantile(&mut floors, 0.5)).filter(|rms_nm| rms_nm.is_finite())
}

/// Of `encoder_nm`, the residual that the encoder alone causes: the mean square of its part that repeats with the motion, (N m)^2, and by what
/// repeats differ, where that is known.
fn of_encoder(mask: &Mask<'_>, encoder_nm: &[f64]) -> (f64, Option<Differences>) {
    let Some(again) = mask.again() else { return (0.0, None) };
    let counted: Vec<f64> = (0..encoder_nm.len()).filter(|i| mask.counts(*i)).map(|i| encoder_nm[i]).collect();
    let differences = Differences::of(&again, encoder_nm, BLOCK);
    let in_repeats = differences.usual_square().unwrap_or_default();
    let whole = if counted.is_empty() { 0.0 } else { root_mean_square(&counted).powi(2) };
    ((whole - in_repeats).max(0.0), Some(differences))
}

/// The floor under `left_nm`, the residual of `after` where `mask` counts, the model with its causes, oscillations left out; it includes slow noise.
/// Without long repeats, slow noise differs from a cause only in that no fit predicts it on held-out units: `unforeseen_square` is the residual
/// of a flexible fit there, (N m)^2. The residual of the model itself, `left_square`, limits the encoder's part. Where there are no repeats and
/// such a fit predicts nothing, the residual is noise unless its level depends on the speed, most of it lasts, or so little of it that it swings
/// faster than noise: all of it if no cause and no contact was found (`is_bare`) and it is as loud at any time, else as far as noise that is not
/// white may exceed the density beyond the low-pass.
pub fn settled(
    (mask, after): (&Mask<'_>, &Model),
    left_nm: &[f64],
    (unforeseen_square, left_square): (f64, f64),
    is_bare: bool,
) -> Floor {
    let (data, policy) = (mask.data, &mask.data.policy);
    let encoder_nm = data.encoder_nm(after);
    let (encoder_square, of_encoder) = of_encoder(mask, &encoder_nm);
    let unpredicted_square = (unforeseen_square - encoder_square).max(0.0);
    let steady_square = most_steady_square(mask, left_nm);
    let noise_square = unpredicted_square.min(steady_square);
    let differences = Differences::of(mask, left_nm, BLOCK);
    let fast = of_differences(mask, &differences, left_nm, noise_square);
    let found_again = left_square - unforeseen_square;
    let of_encoder_most = (1.0 + policy.floor_encoder_error) * encoder_square;
    let found_again_nm = (found_again - of_encoder_most).max(0.0).sqrt();
    let least = policy.floor_found_again_share * (left_square - encoder_square - fast.rms_nm.powi(2));
    let lasting = lasting_share(mask, left_nm);
    let speeds_rad_s = data.records.speeds_rad_s();
    let row = |i: usize| (speeds_rad_s[i], [left_nm[i].powi(2), encoder_nm[i].powi(2)]);
    let by_speed: Vec<(f64, [f64; 2])> = (0..left_nm.len()).filter(|i| mask.counts(*i)).map(row).collect();
    let is_short = (by_speed.len() as f64) < 3.0 * THIRD_MIN * data.records.rows_per_independent;
    let is_noise = found_again <= least
        && (is_short || !depends_on_speed(policy, by_speed))
        && (policy.floor_lasting_share / BLOCK..=policy.floor_lasting_share).contains(&lasting);
    if fast.source == FloorSource::Spectrum && noise_square > fast.rms_nm.powi(2) && is_noise {
        let all_nm = noise_square.sqrt();
        let (rms_nm, source) = match is_bare && unpredicted_square <= steady_square {
            true => (all_nm, FloorSource::Unforeseen),
            false => (all_nm.min(policy.floor_coloured_max * fast.rms_nm), FloorSource::Spectrum),
        };
        let noise = Floor { found_again_nm, ..Floor::of_noise(rms_nm, source, policy.floor_spectrum_error) };
        return noise.with_encoder(policy, encoder_square, left_square);
    }
    let beyond_nm = usual_spectral(mask, |floor| floor.carried_nm.max(floor.next_nm));
    let differing = of_encoder.zip(beyond_nm).and_then(|(of_encoder, nm)| differences.over(&of_encoder, nm));
    let slower = Differences::of(mask, left_nm, BLOCK_LATER);
    let blocks = slower.blocks();
    let whole_square = match blocks.len() >= BLOCKS_MIN {
        true => slower.of_one(usual_mean(blocks, policy.floor_outlier)),
        false => noise_square,
    };
    let rms_nm = whole_square.min(steady_square).sqrt().min(policy.floor_rise_max * fast.rms_nm).max(fast.rms_nm);
    let rise = (rms_nm / fast.rms_nm.max(f64::MIN_POSITIVE)).powi(2) - 1.0;
    let relative_error = fast.relative_error.hypot(policy.floor_rise_error * rise);
    let settled = Floor { rms_nm, relative_error, found_again_nm, differing, ..fast };
    settled.with_encoder(policy, encoder_square, left_square)
}

/// The most that the mean square of `left_nm` may be if it is noise, (N m)^2: noise does not depend on time, either, and exceeds what is left in the
/// third of the motion cycles that is quietest by no more than chance and slow noise allow. At rest a torque that is read in steps does not
/// change.
fn most_steady_square(mask: &Mask<'_>, left_nm: &[f64]) -> f64 {
    let speeds_rad_s = mask.data.records.speeds_rad_s();
    let mean_square = |unit: &Range<usize>| {
        let moves = |i: &usize| mask.counts(*i) && speeds_rad_s[*i] >= AT_REST_RAD_S;
        let squares: Vec<f64> = unit.clone().filter(moves).map(|i| left_nm[i] * left_nm[i]).collect();
        (squares.len() >= UNIT_ROWS_MIN).then(|| squares.iter().sum::<f64>() / squares.len() as f64)
    };
    let mut squares: Vec<f64> = mask.data.folds.units.iter().filter_map(mean_square).collect();
    if squares.len() < UNITS_MIN {
        return f64::INFINITY;
    }
    squares.sort_unstable_by(f64::total_cmp);
    squares.truncate(squares.len().div_ceil(3));
    mask.data.policy.floor_unsteady_max.powi(2) * squares.iter().sum::<f64>() / squares.len() as f64
}

/// Share of the square of `left_nm` that stands in means over blocks of [`BLOCK`] independent samples: a tenth of white noise.
fn lasting_share(mask: &Mask<'_>, left_nm: &[f64]) -> f64 {
    let records = &mask.data.records;
    let rows = (BLOCK * records.rows_per_independent).round().max(1.0) as usize;
    let of_range = |range: &Range<usize>| range.clone().filter(|i| mask.counts(*i)).map(|i| left_nm[i]).collect();
    let counted: Vec<Vec<f64>> = records.ranges.iter().map(of_range).collect();
    let pieces = || counted.iter().flat_map(|left_nm| left_nm.chunks_exact(rows));
    let sum = |of: fn(&[f64]) -> f64| pieces().map(of).sum::<f64>();
    let lasting = sum(|piece| piece.iter().sum::<f64>().powi(2) / piece.len() as f64);
    lasting / sum(|piece| piece.iter().map(|x| x * x).sum()).max(f64::MIN_POSITIVE)
}

/// Means over the thirds of `rows`, each a speed, rad/s, and what is there, from slow to fast where the joint moves. At rest a torque that is read in
/// steps does not change.
fn by_thirds<const N: usize>(mut rows: Vec<(f64, [f64; N])>) -> Vec<[f64; N]> {
    rows.retain(|(speed, _)| *speed >= AT_REST_RAD_S);
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mean = |rows: &[(f64, [f64; N])]| {
        std::array::from_fn(|k| rows.iter().map(|(_, values)| values[k]).sum::<f64>() / rows.len() as f64)
    };
    rows.chunks(rows.len().div_ceil(3).max(1)).map(mean).collect()
}

/// The most that the mean square of `rows` (speed, rad/s, and square at each) may be if it is noise, (N m)^2. Noise does not depend on the motion: it
/// exceeds that of the third of the speeds where it is quietest by no more than noise that is not white exceeds other noise.
fn most_of_noise(policy: &Policy, rows: Vec<(f64, f64)>) -> f64 {
    let thirds = by_thirds(rows.into_iter().map(|(speed, square)| (speed, [square])).collect());
    policy.floor_coloured_max.powi(2) * thirds.iter().fold(f64::INFINITY, |least, [square]| least.min(*square))
}

/// Whether `rows` (speed, rad/s; the square of what is left, and of what the encoder leaves) are louder at some speeds, without the encoder's
/// part, than all that is left where it is quietest allows for noise.
fn depends_on_speed(policy: &Policy, rows: Vec<(f64, [f64; 2])>) -> bool {
    let thirds = by_thirds(rows);
    let least = thirds.iter().fold(f64::INFINITY, |least, [left, _]| least.min(*left));
    let encoder_most = 1.0 + policy.floor_encoder_error;
    thirds.iter().any(|[left, encoder]| left - encoder_most * encoder > policy.floor_coloured_max.powi(2) * least)
}

/// The mean over blocks without those above `outlier` times their median, such as a contact in one repeat.
fn usual_mean(mut blocks: Vec<f64>, outlier: f64) -> f64 {
    let most = outlier * quantile(&mut blocks, 0.5);
    blocks.retain(|square| *square <= most);
    blocks.iter().sum::<f64>() / blocks.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::{
        BLOCK, Differences, Floor, FloorSource, SpectralFloor, depends_on_speed, lasting_share, most_of_noise,
        of_encoder, of_noise, quantile, root_mean_square, settled,
    };
    use crate::diagnose::Policy;
    use crate::diagnose::data::DataSet;
    use crate::diagnose::data::tests::bundled;
    use crate::diagnose::mask::Mask;
    use crate::log::Campaign;
    use crate::model::Model;
    use std::path::Path;
    use std::sync::Arc;

    /// All rows.
    fn all(data: &DataSet) -> Arc<Mask<'_>> {
        Mask::new(data, vec![true; data.measured_nm.len()], 0.0)
    }

    /// Three repeats of one motion, and a model that has nothing to do with them.
    fn repeated() -> (DataSet, Model) {
        let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"));
        let mut campaign = Campaign::read(&folder.join("elbow")).unwrap();
        campaign.trials.retain(|trial| trial.file.starts_with("cosine"));
        let model = Model::read(&folder.join("davinci_l4/base_model.json")).unwrap();
        (DataSet::read(&campaign, &model, &Policy::default(), &|_| ()).unwrap(), model)
    }

    /// Noise with as many independent samples as the recordings have.
    fn white(data: &DataSet) -> Vec<f64> {
        let mut state = 1u64;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let rows = data.measured_nm.len();
        let independent: Vec<f64> = (0..rows).map(|_| noise()).collect();
        (0..rows).map(|i| independent[(i as f64 / data.records.rows_per_independent) as usize]).collect()
    }

    /// A sine that takes as many independent samples.
    fn wave(data: &DataSet, independent: f64) -> Vec<f64> {
        let rows_per_rad = independent * data.records.rows_per_independent / std::f64::consts::TAU;
        (0..data.measured_nm.len()).map(|i| (i as f64 / rows_per_rad).sin()).collect()
    }

    #[test]
    fn without_repeats_what_no_fit_predicts_is_noise_beside_causes_up_to_a_limit() {
        let (mut data, model) = bundled();
        let records = Arc::get_mut(&mut data.records).unwrap();
        records.all.iter_mut().for_each(|record| record.repeats = None);
        let (white, slow, quick) = (white(&data), wave(&data, 50.0), wave(&data, 3.0));
        let of_left = |left_nm: &[f64], left_square: f64, unforeseen_square: f64, is_bare: bool| -> Floor {
            settled((&all(&data), &model), left_nm, (unforeseen_square, left_square), is_bare)
        };
        let of = |left_square, unforeseen_square, is_bare| of_left(&white, left_square, unforeseen_square, is_bare);
        let without_encoder = |floor: Floor| (floor.rms_nm.powi(2) - floor.encoder_nm.powi(2)).sqrt();
        let (fast_nm, encoder_square) =
            (of_noise(&all(&data), &white, f64::MAX).rms_nm, of_encoder(&all(&data), &data.encoder_nm(&model)).0);
        let [less, weak, strong] = [0.8, 1.5, 10.0].map(|factor: f64| (factor * fast_nm).powi(2) + encoder_square);
        let (limit, rise) = (data.policy.floor_coloured_max, data.policy.floor_rise_max);
        let near = |floor: Floor, factor: f64| (without_encoder(floor) / fast_nm - factor).abs() < 1e-6;
        assert!(near(of(weak, weak, false), 1.5) && near(of(strong, strong, false), limit));
        assert!(near(of(strong, strong, true), 10.0));
        assert_eq!(
            [false, true].map(|is_bare| of(strong, strong, is_bare).source),
            [FloorSource::Spectrum, FloorSource::Unforeseen]
        );
        // What is loud in one half of the time alone is no residual of which all is noise.
        let quiet = root_mean_square(&white) / fast_nm;
        let source = |loud_later: f64| {
            let loud = |i: usize| if 2 * i < white.len() { 10.0 } else { loud_later };
            let left_nm: Vec<f64> = white.iter().enumerate().map(|(i, x)| loud(i) * x / quiet).collect();
            of_left(&left_nm, strong, strong, true).source
        };
        assert_eq!([10.0, 1.0].map(source), [FloorSource::Unforeseen, FloorSource::Spectrum]);
        // No floor is above what a fit leaves on held-out units.
        assert!([false, true].iter().all(|is_bare| near(of(strong, less, *is_bare), 0.8)));
        // What a fit predicts is no noise, and neither is what lasts, swings faster than noise or is as loud as the speed.
        let loud: Vec<f64> = data.records.speeds_rad_s().iter().zip(&white).map(|(speed, x)| speed * x).collect();
        for is_bare in [false, true] {
            assert!(near(of(2.0 * strong, strong, is_bare), rise));
            assert!([&slow, &quick, &loud].iter().all(|left_nm| near(of_left(left_nm, strong, strong, is_bare), rise)));
        }
    }

    #[test]
    fn without_repeats_or_room_beyond_the_low_pass_the_floor_is_what_no_fit_predicts() {
        let (mut data, model) = bundled();
        let records = Arc::get_mut(&mut data.records).unwrap();
        for record in &mut records.all {
            record.repeats = None;
            record.spectral_floor = SpectralFloor { carried_nm: f64::NAN, white_nm: f64::NAN, next_nm: f64::NAN };
        }
        let (mask, left_nm) = (all(&data), white(&data));
        let unforeseen = |floor: Floor| {
            assert_eq!(floor.source, FloorSource::Unforeseen);
            floor.rms_nm
        };
        assert!((unforeseen(of_noise(&mask, &left_nm, 0.04)) - 0.2).abs() < 1e-12);
        let least = root_mean_square(&data.encoder_nm(&model)).powi(2);
        for is_bare in [false, true] {
            let floor = settled((&mask, &model), &left_nm, (0.04 + least, 0.09 + least), is_bare);
            assert!((0.2..0.21).contains(&unforeseen(floor)), "{}", floor.rms_nm);
        }
    }

    #[test]
    fn rows_that_do_not_count_are_in_no_floor() {
        let (data, model) = repeated();
        let (white, whole) = (white(&data), all(&data));
        let hit = |i: usize| (i / 40).is_multiple_of(2);
        let hit_nm: Vec<f64> = white.iter().enumerate().map(|(i, x)| if hit(i) { 10.0 * x } else { *x }).collect();
        let spared = Mask::new(&data, (0..white.len()).map(|i| !hit(i)).collect(), 0.0);
        let floors_nm = |mask: &Mask<'_>, left_nm: &[f64]| {
            [of_noise(mask, left_nm, f64::MAX), settled((mask, &model), left_nm, (f64::MAX, f64::MAX), false)].map(
                |floor| {
                    assert_eq!(floor.source, FloorSource::Repeats);
                    (floor.rms_nm.powi(2) - floor.encoder_nm.powi(2)).sqrt()
                },
            )
        };
        let (quiet, loud, without) =
            (floors_nm(&whole, &white), floors_nm(&whole, &hit_nm), floors_nm(&spared, &hit_nm));
        for ((quiet, loud), without) in quiet.into_iter().zip(loud).zip(without) {
            assert!(loud > 3.0 * quiet && (without / quiet - 1.0).abs() < 0.1, "{quiet}, {loud}, {without}");
        }
    }

    #[test]
    fn noise_is_as_loud_in_one_trial_as_in_another() {
        let (data, model) = repeated();
        let (white, mask) = (white(&data), all(&data));
        let noise_nm = |floor: Floor| (floor.rms_nm.powi(2) - floor.encoder_nm.powi(2)).sqrt();
        let floors_nm = |left_nm: &[f64]| {
            let settled = settled((&mask, &model), left_nm, (f64::MAX, f64::MAX), true);
            [of_noise(&mask, left_nm, f64::MAX), settled].map(noise_nm)
        };
        // Of three repeats two are loud: any two differ by much.
        let mut loud = white.clone();
        loud[data.records.ranges[1].start..].iter_mut().for_each(|x| *x *= 20.0);
        for (quiet_nm, loud_nm) in floors_nm(&white).into_iter().zip(floors_nm(&loud)) {
            let factor = loud_nm / quiet_nm;
            assert!((1.0..=1.1 * data.policy.floor_unsteady_max).contains(&factor), "{factor}");
        }
    }

    #[test]
    fn what_lasts_is_told_from_noise() {
        let (data, _) = bundled();
        // Of independent samples a tenth stands in means of ten; of a wave as long as 50 nearly all.
        let [white, wave] = [white(&data), wave(&data, 50.0)].map(|left_nm| lasting_share(&all(&data), &left_nm));
        assert!((0.05..0.2).contains(&white) && wave > 0.8, "{white} and {wave}");
    }

    #[test]
    fn noise_is_as_loud_at_any_speed_and_nothing_is_compared_at_rest() {
        let policy = &Policy::default();
        let rows = |left: fn(f64) -> f64, encoder: fn(f64) -> f64| {
            let row = |speed: f64| (speed, [left(speed), encoder(speed)]);
            (0..300).map(|i| row(f64::from(i))).collect::<Vec<_>>()
        };
        let depends = |left: fn(f64) -> f64| depends_on_speed(policy, rows(left, |_| 0.0));
        assert!(!depends(|_| 1.0) && !depends(|_| 9.0));
        assert!(!depends(|speed| if speed > 0.0 { 1.0 } else { 1e6 }), "loud at rest alone");
        assert!(depends(|speed| speed * speed), "a rumble");
        assert!(depends(|speed| if speed < 90.0 { 20.0 } else { 1.0 }), "a chatter");
        assert!(
            !depends(|speed| if speed < 90.0 { 3.0 } else { 1.0 }),
            "within what noise that is not white may differ by"
        );
        let slow = |speed: f64| if speed < 90.0 { 20.0 } else { 1.0 };
        assert!(!depends_on_speed(policy, rows(slow, slow)), "what the encoder leaves");
        let simulated = |speed: f64| if speed < 90.0 { 16.0 } else { 0.0 };
        assert!(!depends_on_speed(policy, rows(slow, simulated)), "what it leaves, simulated once");
        // The most that a rumble's noise may be is what its slow third has, times the square of the limit.
        let rumble = |speed: f64| if speed <= 100.0 { 2.0 } else { 50.0 };
        let most = most_of_noise(policy, (0..300).map(|i| (f64::from(i), rumble(f64::from(i)))).collect());
        assert!((most / (2.0 * policy.floor_coloured_max.powi(2)) - 1.0).abs() < 1e-12, "{most}");
        // Of a joint that never moves nothing is known.
        assert!(!depends_on_speed(policy, vec![(0.0, [1.0; 2]); 9]));
    }

    #[test]
    fn repeats_are_held_against_noise_at_the_speeds_where_they_differ_most() {
        let (data, _) = repeated();
        let (white, mask, speeds) = (white(&data), all(&data), data.records.speeds_rad_s());
        let slow = quantile(&mut speeds.clone(), 0.3);
        let of = |left_nm: &[f64]| Differences::of(&mask, left_nm, BLOCK);
        let (encoder, beyond_nm) = (of(&vec![0.0; white.len()]), root_mean_square(&white));
        let factor = |loud: f64| {
            let at = |(x, speed): (&f64, &f64)| if *speed <= slow { loud * x } else { *x };
            of(&white.iter().zip(&speeds).map(at).collect::<Vec<f64>>()).over(&encoder, beyond_nm).unwrap()
        };
        let (steady, chatter) = (factor(1.0), factor(3.0));
        assert!((0.8..1.3).contains(&steady) && chatter > 2.0 * steady, "{steady} and {chatter}");
        // What the encoder makes repeats differ by counts, and without noise beyond the low-pass nothing is known.
        assert!((of(&white).over(&of(&white), beyond_nm).unwrap() / steady - 0.5f64.sqrt()).abs() < 0.05);
        assert!(of(&white).over(&encoder, 0.0).is_none());
    }
}
