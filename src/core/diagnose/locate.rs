//! Where a gap lies: which recorded quantity it follows, and within what bounds most of it stands.
//!
//! The share of a region is the part of the gap's energy above the floor that a function of that quantity alone accounts for
//! (means over bins, with and without the sign of the motion, corrected for how many bins could chase noise); for regions that
//! are a set of samples (rest, events, clipped) it is their energy.

use super::base::BaseModel;
use super::contact_events::ContactEvent;
use super::data::DataSet;
use super::measures::Measures;
use super::record::Record;
use crate::effects::Region;
use crate::model::Joint;
use crate::numerics::statistics::quantile;

/// Bins of a quantity.
const BINS: usize = 24;
/// The window in which most of the gap stands is the narrowest that holds this share of it.
const WINDOW_SHARE: f64 = 0.7;
/// If a constant accounts for this share of what any quantity accounts for, there is nothing to locate.
const FLAT: f64 = 0.85;
/// Regions below this share are not reported.
pub(super) const SHARE_MIN: f64 = 0.03;

/// A region of the gap.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// Which.
    pub region: Region,
    /// Its bounds, with units.
    pub detail: String,
    /// Share of the gap's energy above the floor.
    pub share_of_gap: f64,
    /// Share of the samples within the bounds.
    pub share_of_samples: f64,
    /// RMS of the residual within the bounds, N m.
    pub rmse_nm: f64,
}

/// One quantity over all rows.
pub(super) struct Quantity {
    /// Where a gap lies that follows it.
    pub region: Region,
    /// In SI.
    pub values: Vec<f64>,
    /// For people: what it is, its unit, and what one of the unit is.
    pub means: (&'static str, &'static str, f64),
}

/// The regions of `residual_nm`, by share.
pub fn locate(base: &BaseModel<'_>, residual_nm: &[f64], events: &[ContactEvent]) -> Vec<Place> {
    let floor_square = base.mask.floor_nm * base.mask.floor_nm;
    let excess = |rows: &mut dyn Iterator<Item = usize>| -> f64 {
        rows.map(|i| residual_nm[i] * residual_nm[i] - floor_square).sum::<f64>()
    };
    let whole = excess(&mut (0..residual_nm.len())).max(f64::MIN_POSITIVE);
    let sign = signs(base);
    let rows_per_independent = base.data().records.rows_per_independent;
    let survey = Survey { rows_per_independent, residual: residual_nm, sign: &sign, whole, floor_square };
    let mut in_event = vec![false; residual_nm.len()];
    events.iter().for_each(|event| in_event[event.rows.clone()].fill(true));
    let mut found: Vec<Place> =
        quantities(base.data(), &base.model.joint).iter().filter_map(|quantity| survey.place(quantity)).collect();
    let sets: [(Region, &str, Vec<bool>); 3] = [
        (Region::Rest, "the joint rests", base.data().records.rows(|r, i| r.rests[i])),
        (Region::Clipped, "the sensor clips, or is about to", base.data().records.rows(|r, i| r.clipped[i])),
        (Region::Bursts, "contact events, not repeated", in_event),
    ];
    for (region, detail, is_in) in sets {
        let rows: Vec<usize> = (0..is_in.len()).filter(|i| is_in[*i]).collect();
        let (share, samples) =
            (excess(&mut rows.iter().copied()) / whole, rows.len() as f64 / is_in.len().max(1) as f64);
        if !rows.is_empty() && share > 2.0 * samples {
            let rmse_nm = rms(rows.iter().map(|i| residual_nm[*i]));
            let share_of_gap = share.min(1.0);
            found.push(Place { region, detail: detail.to_string(), share_of_gap, share_of_samples: samples, rmse_nm });
        }
    }
    let constant = survey.constant();
    let most = found.iter().map(|place| place.share_of_gap).fold(0.0, f64::max);
    if constant > FLAT * most {
        found.push(Place {
            region: Region::Everywhere,
            detail: "the same at all positions, speeds and times".to_string(),
            share_of_gap: constant.max(most).min(1.0),
            share_of_samples: 1.0,
            rmse_nm: rms(residual_nm.iter().copied()),
        });
    }
    found.retain(|place| place.share_of_gap >= SHARE_MIN);
    found.sort_by(|a, b| b.share_of_gap.total_cmp(&a.share_of_gap));
    found
}

/// The sign of the motion at each row, -1 to 1 in a transition.
fn signs(base: &BaseModel<'_>) -> Vec<f64> {
    let of = |(record, passage): (&Record, &Vec<f64>)| {
        record.rows.iter().map(|i| 2.0 * passage[*i] - 1.0).collect::<Vec<f64>>()
    };
    base.data().records.all.iter().zip(&base.passages).flat_map(of).collect()
}

fn quantities(data: &DataSet, joint: &Joint) -> Vec<Quantity> {
    let Measures { position: angle, speed: rate, acceleration: per_s2, load, torque, .. } = Measures::of(joint);
    let rows = &data.records;
    let travel: Vec<f64> = rows
        .all
        .iter()
        .flat_map(|record| {
            let travel = record.travel_rad();
            record.rows.iter().map(|i| travel[*i]).collect::<Vec<f64>>()
        })
        .collect();
    let quantity = |region, values: Vec<f64>, what, (unit, per): (&'static str, f64)| Quantity {
        region,
        values,
        means: (what, unit, per),
    };
    let mut all = vec![
        quantity(Region::AfterReversal, travel, "travel since the reversal", angle),
        quantity(Region::LowSpeed, rows.speeds_rad_s(), "speed", rate),
        quantity(Region::Position, rows.rows(|r, i| r.own[i].position), "position", angle),
        quantity(Region::Time, rows.rows(Record::elapsed_s), "time", ("s", 1.0)),
        quantity(Region::Time, rows.rows(|r, i| r.time_s[i]), "time in the trial", ("s", 1.0)),
        quantity(Region::Acceleration, rows.rows(|r, i| r.own[i].acceleration), "acceleration", per_s2),
        quantity(Region::Load, data.measured_nm.clone(), load, torque),
    ];
    for joint in 0..data.extent.others {
        let at = move |r: &Record, i: usize| r.other(joint, i);
        all.push(quantity(
            Region::OtherJoint,
            rows.rows(|r, i| at(r, i).position),
            "the other joint's position",
            angle,
        ));
        all.push(quantity(Region::OtherJoint, rows.rows(|r, i| at(r, i).velocity), "the other joint's speed", rate));
        let acceleration = rows.rows(|r, i| at(r, i).acceleration);
        all.push(quantity(Region::OtherJoint, acceleration, "the other joint's acceleration", per_s2));
    }
    all
}

/// What a gap is held against, quantity by quantity.
pub(super) struct Survey<'s> {
    /// Compared rows per independent one.
    pub rows_per_independent: f64,
    /// The gap at each row: N m, or rad.
    pub residual: &'s [f64],
    /// The sign of the motion at each row, -1 to 1.
    pub sign: &'s [f64],
    /// Its energy above the floor: the sum of squares.
    pub whole: f64,
    /// The floor's square.
    pub floor_square: f64,
}

impl Survey<'_> {
    /// Share of the energy that one constant and one change with the direction account for.
    fn constant(&self) -> f64 {
        self.explained(&vec![0; self.residual.len()], 1)
    }

    /// Share of the energy that means over bins, with and without the sign, account for.
    fn explained(&self, bins: &[usize], count: usize) -> f64 {
        // r = a + b s in each bin, by least squares.
        let mut sums = vec![[0.0; 6]; count];
        for ((bin, r), s) in bins.iter().zip(self.residual).zip(self.sign) {
            let sum = &mut sums[*bin];
            for (slot, x) in sum.iter_mut().zip([1.0, *s, s * s, *r, r * s, r * r]) {
                *slot += x;
            }
        }
        let mut explained = 0.0;
        let mut used = 0.0;
        for [n, s, ss, r, rs, _] in sums {
            let det = n * ss - s * s;
            if n < 4.0 {
                continue;
            }
            if det > 1e-9 * n * n {
                let (a, b) = ((ss * r - s * rs) / det, (n * rs - s * r) / det);
                explained += a * r + b * rs;
                used += 2.0;
            } else {
                explained += r * r / n;
                used += 1.0;
            }
        }
        // This many means also account for a part of pure noise.
        let noise = used * self.rows_per_independent * self.floor_square;
        ((explained - noise) / self.whole).clamp(0.0, 1.0)
    }

    /// What follows `quantity`, and within what bounds most of the gap stands; none of a quantity that never changes.
    /// `rmse_nm` has the gap's unit.
    pub fn place(&self, quantity: &Quantity) -> Option<Place> {
        let corners = corners(&quantity.values)?;
        let bins: Vec<usize> =
            quantity.values.iter().map(|x| corners.partition_point(|c| c <= x).min(BINS - 1)).collect();
        let share_of_gap = self.explained(&bins, BINS);
        let mut energy = [0.0; BINS];
        let mut count = [0usize; BINS];
        for (bin, r) in bins.iter().zip(self.residual) {
            energy[*bin] += (r * r - self.floor_square).max(0.0);
            count[*bin] += 1;
        }
        let (from, to) = window(&energy);
        let inside = |i: &usize| (from..=to).contains(&bins[*i]);
        let (low, high) = bounds(&quantity.values, &bins, from, to);
        let (what, unit, per) = quantity.means;
        let detail = format!("{what} {} {unit}", range(low * per, high * per));
        let region = match quantity.region {
            Region::LowSpeed if from + to >= BINS => Region::HighSpeed,
            region => region,
        };
        Some(Place {
            region,
            detail,
            share_of_gap,
            share_of_samples: count[from..=to].iter().sum::<usize>() as f64 / bins.len().max(1) as f64,
            rmse_nm: rms((0..bins.len()).filter(inside).map(|i| self.residual[i])),
        })
    }
}

/// Upper bounds of bins with equally many values each; none where all are the same.
fn corners(values: &[f64]) -> Option<Vec<f64>> {
    let mut sorted = values.to_vec();
    let spread = quantile(&mut sorted, 0.99) - quantile(&mut sorted, 0.01);
    (spread > 0.0).then(|| (1..BINS).map(|k| quantile(&mut sorted, k as f64 / BINS as f64)).collect())
}

/// The narrowest run of bins that holds most of the energy.
fn window(energy: &[f64; BINS]) -> (usize, usize) {
    let whole: f64 = energy.iter().sum();
    let holds = |from: usize, to: usize| energy[from..=to].iter().sum::<f64>() >= WINDOW_SHARE * whole;
    for width in 0..BINS {
        let best = (0..BINS - width)
            .filter(|from| holds(*from, from + width))
            .max_by(|a, b| energy[*a..=a + width].iter().sum::<f64>().total_cmp(&energy[*b..=b + width].iter().sum()));
        if let Some(from) = best {
            return (from, from + width);
        }
    }
    (0, BINS - 1)
}

fn bounds(values: &[f64], bins: &[usize], from: usize, to: usize) -> (f64, f64) {
    let inside = values.iter().zip(bins).filter(|(_, bin)| (from..=to).contains(*bin)).map(|(x, _)| *x);
    inside.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
}

pub(super) fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0usize), |(sum, count), x| (sum + x * x, count + 1));
    (sum / count.max(1) as f64).sqrt()
}

/// "-0.12 to 60.3": both with the decimals that give the larger three digits.
fn range(low: f64, high: f64) -> String {
    let size = low.abs().max(high.abs());
    let digits = if size == 0.0 { 0 } else { (2 - size.log10().floor() as i32).clamp(0, 6) };
    let rounded = |x: f64| (x * 10f64.powi(digits)).round() / 10f64.powi(digits) + 0.0;
    let decimals = digits as usize;
    format!("{:.decimals$} to {:.decimals$}", rounded(low), rounded(high))
}

/// Gives `region` the `share` that a named cause explains, `name` in its detail where the region was not told of before; over all samples
/// the residual has an RMS of `rmse_nm`.
pub fn credit(places: &mut Vec<Place>, region: Region, share: f64, (name, rmse_nm): (&str, f64)) {
    match places.iter_mut().find(|place| place.region == region) {
        Some(place) => place.share_of_gap = place.share_of_gap.max(share),
        None => places.push(Place {
            region,
            detail: format!("where {name} acts"),
            share_of_gap: share,
            share_of_samples: 1.0,
            rmse_nm,
        }),
    }
    // On equal shares the cause's own region goes first.
    places.sort_by(|a, b| {
        (b.share_of_gap, b.region == region)
            .partial_cmp(&(a.share_of_gap, a.region == region))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
}
