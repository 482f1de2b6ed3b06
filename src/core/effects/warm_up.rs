//! Friction that falls as grease and bearings warm up.

use super::{
    About, ActsOn, Carried, Effect, Excitation, Extent, Family, Hooks, Parameter, Region, Sample, clock_s, spaced,
    varies,
};
use crate::dynamics::Both;
use crate::numerics::scalar::Scalar;

/// How cold the joint still is `t_s` on its clock, 1 at first.
fn cold<S: Scalar>(p: &[S], t_s: S::Given) -> S {
    let share = t_s.max(S::Given::from(0.0)) / p[4];
    if p[6].value() > 0.5 { (share + 1.0).powf(-p[5]) } else { (-share.powf(p[5])).exp() }
}

/// How much less of all friction there may seem to be when cold, beside more of its constant and viscous part.
const LESS_MAX: f64 = 0.1;
/// A joint that is cold again at the start of each trial does not warm up faster than this, s: so fast neither its mass nor its grease cools,
/// and friction that decays so after each start follows the motion.
const RESTARTS_MIN_S: f64 = 60.0;
/// Where the form stands that says which of friction's parts decay, and the parts' strengths: all of it, what is constant, what is viscous.
const PARTS: usize = 7;
const STRENGTHS: [usize; 3] = [1, 2, 3];
const EXPONENT: usize = 5;

/// The strength of the one part that a fit moves, exponentially; none where each decays on its own, along any curve.
fn only(p: &[f64]) -> Option<usize> {
    STRENGTHS.into_iter().find(|at| *at as f64 == p[PARTS])
}

static ABOUT: About = About {
    id: "warm_up",
    family: Family::Physics,
    acts_on: ActsOn::Friction,
    means: "friction decays as the joint warms up",
    formula: "friction (1 + cold_share w) + or - cold_nm w + cold_nm_s_rad v w, w = exp(-(t/time_constant_s)^exponent), or \
              with a long_tail (1 + t/time_constant_s)^-exponent; a fit moves all of it (parts 0), or with a plain \
              exponential cold_share alone (1), cold_nm (2), cold_nm_s_rad (3)",
    source: "Simoni, Beschi, Legnani and Visioli 2015",
    signature: Region::Time,
    trades_with: &["sensor_drift"],
    example: "restarts=0,cold_share=0.4,time_constant_s=15,exponent=1",
    parameters: &[
        Parameter::choice("restarts", 0.0, 1.0),
        Parameter::strength("cold_share"),
        Parameter::strength("cold_nm"),
        Parameter::strength("cold_nm_s_rad"),
        Parameter::shape("time_constant_s", 1e-2, 1e6),
        Parameter::shape("exponent", 0.3, 2.0),
        Parameter::form("long_tail", 1.0),
        Parameter::form("parts", STRENGTHS.len() as f64),
    ],
    needs: &[Excitation::Time],
    by_hand: Some("repeat the first trial cold and again after ten minutes of motion"),
    of_time: true,
    ..About::PLAIN
};

#[derive(Debug)]
pub struct WarmUp;

impl Effect for WarmUp {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn needs_clock(&self, p: &[f64]) -> bool {
        p[0] <= 0.5
    }

    fn only_adds(&self) -> bool {
        false
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        let of = |(restarts, horizon_s): (f64, f64)| {
            spaced(horizon_s / 20.0, horizon_s * 1.5, 4).flat_map(move |constant_s| {
                let start = move |exponent, long_tail, parts| {
                    vec![restarts, 0.0, 0.0, 0.0, constant_s, exponent, long_tail, parts]
                };
                let one = STRENGTHS.map(|at| start(1.0, 0.0, at as f64));
                one.into_iter().chain([start(0.9, 0.0, 0.0), start(1.0, 1.0, 0.0)])
            })
        };
        let is_slow = |(restarts, horizon_s): &(f64, f64)| *restarts <= 0.5 || *horizon_s >= RESTARTS_MIN_S;
        extent.clocks().filter(is_slow).flat_map(of).collect()
    }

    fn uses(&self, p: &[f64], at: usize) -> bool {
        let is_of_others = |only: usize| at != only && (STRENGTHS.contains(&at) || at == EXPONENT);
        !only(p).is_some_and(is_of_others)
    }

    /// Friction that is lower when cold is not this effect; where only a part of it warms up, the share may come out slightly negative.
    /// Nor is friction that is as high at the end as at the start, or that decays faster after the start of each trial than a joint cools.
    fn is_itself(&self, p: &[f64], extent: &Extent) -> bool {
        let is_less_when_warm = only(p).map_or(p[1] >= -LESS_MAX, |only| p[only] >= 0.0);
        let cools = p[0] <= 0.5 || p[4] >= RESTARTS_MIN_S;
        is_less_when_warm && cools && varies(|t_s| cold(p, t_s), extent.horizon_s(p[0]))
    }

    fn limits(&self, at: usize, _extent: &Extent) -> (f64, f64) {
        (if at == STRENGTHS[0] { -LESS_MAX } else { f64::NEG_INFINITY }, f64::INFINITY)
    }
}

impl<S: Scalar> Hooks<S> for WarmUp {
    fn friction_factor(&self, p: &[S], sample: &Sample<'_, S::Given>) -> S {
        if p[1].is_zero() { S::from(1.0) } else { p[1] * cold(p, clock_s(p[0].value(), sample)) + 1.0 }
    }

    fn friction_nm(&self, p: &[S], sample: &Sample<'_, S::Given>, _carried: Carried<S>) -> Both<S> {
        if p[2].is_zero() && p[3].is_zero() {
            return Both { up: S::from(0.0), down: S::from(0.0) };
        }
        let more_nm = (p[2] + sample.own.velocity.abs() * p[3]) * cold(p, clock_s(p[0].value(), sample));
        Both { up: more_nm, down: -more_nm }
    }
}

#[cfg(test)]
mod tests {
    use super::{Effect, WarmUp};

    #[test]
    fn where_one_part_of_friction_decays_no_other_is_fitted() {
        let fitted = |parts: f64| {
            let p = [0.0, 0.0, 0.0, 0.0, 15.0, 1.0, 0.0, parts];
            [1, 2, 3, 4, 5].into_iter().filter(|at| WarmUp.uses(&p, *at)).collect::<Vec<usize>>()
        };
        assert_eq!(fitted(0.0), [1, 2, 3, 4, 5]);
        assert_eq!([1.0, 2.0, 3.0].map(fitted), [[1, 4], [2, 4], [3, 4]]);
    }
}
