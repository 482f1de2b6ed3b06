//! Searches along one line.

/// The golden ratio less one: each section leaves this share of the interval.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// The place between `a` and `b` with the least `cost`, and that cost: `sections` golden sections narrow the interval to
/// 0.618 to their power if the cost has a single valley there, and a parabola through the last three places goes beyond.
pub fn lowest(mut a: f64, mut b: f64, sections: usize, cost: impl Fn(f64) -> f64) -> (f64, f64) {
    let (mut c, mut d) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
    let (mut at_c, mut at_d) = (cost(c), cost(d));
    for _ in 0..sections {
        if at_c < at_d {
            (b, d, at_d) = (d, c, at_c);
            c = b - GOLDEN * (b - a);
            at_c = cost(c);
        } else {
            (a, c, at_c) = (c, d, at_d);
            d = a + GOLDEN * (b - a);
            at_d = cost(d);
        }
    }
    let middle = (c + d) / 2.0;
    let at_middle = cost(middle);
    let bend = at_c - 2.0 * at_middle + at_d;
    let vertex = middle + 0.25 * (d - c) * (at_c - at_d) / bend;
    // Only a valley inside the interval is one.
    let vertex = if bend > 0.0 { vertex.clamp(a, b) } else { middle };
    let places = [(c, at_c), (d, at_d), (middle, at_middle), (vertex, cost(vertex))];
    places.into_iter().fold((c, f64::INFINITY), |best, place| if place.1 < best.1 { place } else { best })
}

/// Where between `inside` and `outside` a condition ceases to hold, by `halvings`; `outside` itself if it holds there.
pub fn crossing(mut inside: f64, mut outside: f64, halvings: usize, holds: impl Fn(f64) -> bool) -> f64 {
    if holds(outside) {
        return outside;
    }
    for _ in 0..halvings {
        let middle = (inside + outside) / 2.0;
        if holds(middle) { inside = middle } else { outside = middle }
    }
    inside
}
