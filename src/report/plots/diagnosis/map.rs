//! Where the residual lies: its RMS over position and speed, before and after.

use super::residual_time::{order, runs};
use super::{after_name, residuals};
use crate::diagnose::Diagnosis;
use crate::numerics::statistics::quantile;
use crate::report::chart::{Axis, Cells, Figure, Panel, span};
use crate::report::wording::Units;

/// Cells across and upwards; an odd number upwards, so that one row holds what hardly moves.
const ACROSS: usize = 28;
const UPWARDS: usize = 21;
/// Samples that a cell needs before its RMS means anything.
const SAMPLES_MIN: usize = 3;
/// Slower than this share of the fastest, speeds gather about zero.
const SLOW: f64 = 0.04;
/// The scale reaches this many times the floor at least: noise alone does not look dark.
const FLOORS: f64 = 3.0;
/// The scale ends where this share of the cells lie below: one cell must not bleach the others.
const SHOWN: f64 = 0.98;

/// Stretches of recordings kept for each cell, the largest first.
const STRETCHES: usize = 4;

const CAPTION: &str = "RMS of the residual in cells of position and signed speed, over all trials: the model as delivered (left) and with \
                       the causes found (right), on one scale; the triangle marks the noise floor. Empty cells have too few samples. \
                       Columns that stand out: the gap depends on position; rows: on speed; both ends of the travel near zero speed: on the \
                       travel after reversals; upper and lower half: on the direction. Click on a cell to see its samples over time.";

/// RMS of the cells, row by row, before and after; NaN where there are too few samples.
struct Map {
    x: Axis,
    y: Axis,
    rms_nm: [Vec<f64>; 2],
    /// Stretches of trials (place in `order`, from and to in s) in each cell, the largest first.
    stretches: Vec<Vec<(usize, f64, f64)>>,
}

/// Both maps; `None` without samples.
pub(super) fn figure(found: &Diagnosis) -> Option<Figure> {
    let units = Units::of(&found.before.joint);
    let map = map(found, &units);
    let mut all: Vec<f64> = map.rms_nm.iter().flatten().copied().filter(|rms| rms.is_finite()).collect();
    if all.is_empty() {
        return None;
    }
    let floor_nm = found.gap.floor.rms_nm;
    let top = quantile(&mut all, SHOWN).max(FLOORS * floor_nm);
    let (unit, factor) = units.torque_scale(top);
    let panels =
        ["as delivered", after_name(found)].into_iter().zip(&map.rms_nm).enumerate().map(|(at, (title, rms))| {
            let y = if at == 0 { map.y.clone() } else { map.y.clone().without_texts() };
            let edges = |(low, high): (f64, f64), number: usize| -> Vec<f64> {
                (0..=number).map(|i| low + (high - low) * i as f64 / number as f64).collect()
            };
            let mut panel = Panel::new(map.x.clone(), y).titled(title);
            panel.cells(Cells {
                across: edges(map.x.places, ACROSS),
                upwards: edges(map.y.places, UPWARDS),
                values: rms.iter().map(|rms| factor * rms).collect(),
                axis: Axis::linear(format!("RMS ({unit})"), 0.0, factor * top),
                marked: (factor * floor_nm, "floor"),
                stretches: map.stretches.clone(),
            });
            panel
        });
    let figure = Figure::new("map", "Residual over position and speed, before and after", CAPTION);
    Some(figure.row(296.0, panels.collect()))
}

fn map(found: &Diagnosis, units: &Units) -> Map {
    let place = |position_rad: f64| units.position_factor * position_rad;
    let rows = || {
        found.views.iter().flat_map(|view| (0..view.judged.len()).filter(|i| view.judged[*i]).map(move |i| (view, i)))
    };
    let (low, high) = span(rows().map(|(view, i)| place(view.position_rad[i])));
    let fastest = rows().map(|(view, i)| view.velocity_rad_s[i].abs()).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let x = Axis::linear(format!("position ({})", units.position), low, high);
    let y = Axis::signed_log(format!("speed ({})", units.speed), -fastest, fastest, SLOW * fastest);
    let mut sums = [(); 2].map(|()| vec![(0.0, 0usize); ACROSS * UPWARDS]);
    let mut energies: Vec<Vec<(f64, usize, f64, f64)>> = vec![Vec::new(); ACROSS * UPWARDS];
    for (trial, view) in order(found).into_iter().map(|at| &found.views[at]).enumerate() {
        let cell_of: Vec<usize> = (0..view.time_s.len())
            .map(|i| {
                let column = cell(x.place_within(place(view.position_rad[i])), x.places, ACROSS);
                cell(y.place_within(view.velocity_rad_s[i]), y.places, UPWARDS) * ACROSS + column
            })
            .collect();
        let both = residuals(found, view);
        for (sums, residual) in sums.iter_mut().zip(&both) {
            for i in residual.rows() {
                let (sum, count) = &mut sums[cell_of[i]];
                (*sum, *count) = (*sum + residual.nm[i] * residual.nm[i], *count + 1);
            }
        }
        let before = &both[0];
        for run in runs(cell_of.len(), |i| before.counts[i]) {
            let samples: Vec<usize> = run.collect();
            for part in samples.chunk_by(|a, b| cell_of[*a] == cell_of[*b]) {
                let energy = part.iter().map(|i| before.nm[*i] * before.nm[*i]).sum();
                let (from_s, to_s) = (view.time_s[part[0]], view.time_s[part[part.len() - 1]]);
                energies[cell_of[part[0]]].push((energy, trial, from_s, to_s));
            }
        }
    }
    let rms = |(sum, count): &(f64, usize)| {
        if *count >= SAMPLES_MIN { (sum / *count as f64).sqrt() } else { f64::NAN }
    };
    let largest = |mut of: Vec<(f64, usize, f64, f64)>| {
        of.sort_by(|a, b| b.0.total_cmp(&a.0));
        of.into_iter().take(STRETCHES).map(|(_, trial, from_s, to_s)| (trial, from_s, to_s)).collect()
    };
    let stretches = energies.into_iter().map(largest).collect();
    Map { rms_nm: sums.map(|sums| sums.iter().map(rms).collect()), stretches, x, y }
}

/// Which of `number` stretches of `low` to `high` holds `place`.
fn cell(place: f64, (low, high): (f64, f64), number: usize) -> usize {
    (((place - low) / (high - low) * number as f64) as usize).min(number - 1)
}
