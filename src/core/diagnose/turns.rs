//! Where a joint turns an encoder does not tell when: friction may act in either direction there.

use super::base::BaseModel;
use crate::dynamics::Motion;

/// Within this many deadbands of a turn the encoder does not tell when the joint turns: a coarse one, whose deadband is half a step, stands still.
const UNDECIDED_DEADBANDS: f64 = 2.0;

/// How far the prediction of `base` moves at the rows if friction is that of the one direction, and of the other, wherever the encoder does not tell
/// which, N m.
pub fn undecided_nm(base: &BaseModel<'_>) -> [Vec<f64>; 2] {
    let records = &base.data().records;
    let undecided: Vec<Vec<bool>> =
        records.all.iter().map(|r| at_turns(&r.own, UNDECIDED_DEADBANDS * r.deadband_rad)).collect();
    [0.0, 1.0].map(|side| {
        let of_record = |(k_tilde, undecided): (&Vec<f64>, &Vec<bool>)| -> Vec<f64> {
            k_tilde.iter().zip(undecided).map(|(k, undecided)| if *undecided { side } else { *k }).collect()
        };
        let passages = base.passages.iter().zip(&undecided).map(of_record).collect();
        let predicted_nm = base.prediction_nm(&base.model, &passages);
        predicted_nm.iter().zip(&base.predicted_nm).map(|(turned, predicted)| turned - predicted).collect()
    })
}

/// Where `motion` is within `reach_rad` of where it turns, or rests, before it left there, and one sample beside: it turns between two.
fn at_turns(motion: &[Motion], reach_rad: f64) -> Vec<bool> {
    let mut is_within = vec![false; motion.len()];
    for turn in 1..motion.len() {
        if is_within[turn] || motion[turn - 1].velocity * motion[turn].velocity > 0.0 {
            continue;
        }
        let is_near = |at: &usize| (motion[*at].position - motion[turn].position).abs() <= reach_rad;
        let near = (0..turn).rev().take_while(is_near).chain((turn..motion.len()).take_while(is_near));
        near.for_each(|at| is_within[at] = true);
    }
    let is_beside = |at: usize| is_within[at.saturating_sub(1)..(at + 2).min(motion.len())].contains(&true);
    (0..motion.len()).map(is_beside).collect()
}

/// What of `residual_nm` is left at `row` if friction is anything between the directions there, by which the prediction moves `undecided_nm`, N m.
pub fn left_nm(undecided_nm: &[Vec<f64>; 2], residual_nm: &[f64], row: usize) -> f64 {
    let [one, other] = [undecided_nm[0][row], undecided_nm[1][row]];
    residual_nm[row] - residual_nm[row].clamp(one.min(other).min(0.0), one.max(other).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::{at_turns, left_nm};
    use crate::dynamics::Motion;

    #[test]
    fn near_a_turn_and_nowhere_else_friction_may_act_either_way() {
        let swing = |i: i32| {
            let (sin, cos) = (f64::from(i) * 0.01).sin_cos();
            Motion { position: sin, velocity: cos, acceleration: -sin }
        };
        let motion: Vec<Motion> = (0..1000).map(swing).collect();
        let is_at = at_turns(&motion, 1e-3);
        let is_near = |i: usize| motion[i].position.abs() >= 1.0 - 1e-3;
        assert!((1..999).all(|i| is_at[i] == (is_near(i - 1) || is_near(i) || is_near(i + 1))));
        // Each of two turns that follow one another at once has its sample beside.
        let to_and_fro =
            [0.0, 1.0, 0.5, 1.5, 2.5].map(|position| Motion { position, velocity: 1.0, acceleration: 0.0 });
        let turning: Vec<Motion> =
            to_and_fro.iter().zip([1.0, 1.0, -1.0, 1.0, 1.0]).map(|(m, velocity)| Motion { velocity, ..*m }).collect();
        assert_eq!(at_turns(&turning, 0.0), [false, true, true, true, true]);
        let rest = vec![Motion { position: 0.2, velocity: 0.0, acceleration: 0.0 }; 9];
        assert!(at_turns(&rest, 0.0)[1..].iter().all(|at| *at));
        assert!(at_turns(&[], 0.0).is_empty());
    }

    #[test]
    fn what_lies_between_the_directions_is_explained_and_no_more() {
        let undecided_nm = [vec![0.0, 0.0, -0.2], vec![-0.5, 0.0, 0.3]];
        let left = |residual_nm: f64, row: usize| left_nm(&undecided_nm, &[residual_nm; 3], row);
        assert_eq!((left(-0.4, 0), left(-0.75, 0), left(0.25, 0)), (0.0, -0.25, 0.25));
        assert_eq!((left(-0.4, 1), left(0.2, 2), left(-0.1, 2)), (-0.4, 0.0, 0.0));
    }
}
