//! Where a falling function crosses zero.

/// The most steps of bracketing, and of closing in: each at least halves, so that doubles are exhausted.
const STEPS: usize = 60;

/// Where `f` is zero, to within `tolerance` of its value. It must fall, be `at_from` > 0 at `from` where `stride` is positive
/// and `at_from` < 0 where that is negative; the zero lies that way, at about `stride` or nearer.
pub fn falling(mut f: impl FnMut(f64) -> f64, from: f64, at_from: f64, mut stride: f64, tolerance: f64) -> f64 {
    let (mut near, mut at_near) = (from, at_from);
    let (mut far, mut at_far) = (from + stride, f(from + stride));
    for _ in 0..STEPS {
        if at_far * at_from <= 0.0 {
            break;
        }
        stride *= 2.0;
        (near, at_near) = (far, at_far);
        far += stride;
        at_far = f(far);
    }
    // Regula falsi after Illinois: an end that stays twice counts half, so that both ends close in.
    for _ in 0..STEPS {
        let x = if at_near == at_far { far } else { far - at_far * (far - near) / (at_far - at_near) };
        let at_x = f(x);
        if at_x.abs() <= tolerance || x == near || x == far {
            return x;
        }
        if at_x * at_far < 0.0 {
            (near, at_near) = (far, at_far);
        } else {
            at_near /= 2.0;
        }
        (far, at_far) = (x, at_x);
    }
    far
}

#[cfg(test)]
mod tests {
    use super::falling;

    #[test]
    fn it_finds_zeros_on_both_sides_near_and_far() {
        let f = |x: f64| 2.0 - x - 0.5 * x.powi(3);
        for (from, stride) in [(0.0, 1e-3), (0.0, 100.0), (5.0, -1e-3), (5.0, -40.0)] {
            let x = falling(f, from, f(from), stride, 1e-12);
            assert!(f(x).abs() <= 1e-12, "{x} from {from} by {stride}");
        }
    }

    #[test]
    fn a_jump_is_met_too() {
        let jump = |x: f64| if x < 0.3 { 1.0 } else { -2.0 };
        assert!((falling(jump, 0.0, 1.0, 0.01, 1e-12) - 0.3).abs() < 1e-6);
    }
}
