//! Axes and drawings of any numbers at all.

use super::super::{Columns, Figure, Mark, Panel, Stroke, palette, svg};
use super::*;
use proptest::prelude::*;

/// Any number at all: NaN, infinite, denormal, huge, zero, and what joints have.
fn number() -> impl Strategy<Value = f64> {
    let edges =
        [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN, 5e-324, -5e-324, 0.0, -0.0, 1e-300, 1e155];
    prop_oneof![prop::num::f64::ANY, prop::sample::select(edges.to_vec()), -10.0..10.0]
}

fn filled(x: &Axis, y: &Axis, points: &[(f64, f64)]) -> Figure {
    let mut panel = Panel::new(x.clone(), y.clone());
    panel.line("line", points.to_vec(), Stroke::solid(palette::BLUE, 1.0));
    panel.dots("dots", points.to_vec(), 2.0, palette::BLUE, 0.5);
    panel.band("band", [points.to_vec(), points.to_vec()], palette::BLUE, 0.5);
    panel.marks("marks", points.to_vec(), Mark::Diamond, palette::BLUE);
    Figure::single("any", "any", "", 200.0, panel)
}

fn an_axis_and_a_drawing((low, high, from): (f64, f64, f64), values: &[f64]) {
    let axes = [
        Axis::linear("", low, high),
        Axis::low("", low),
        Axis::around("", values.iter().copied(), 0.05),
        Axis::log("", values.iter().copied()),
        Axis::signed_log("", low, high, from),
    ];
    let points: Vec<(f64, f64)> = values.iter().zip(values.iter().rev()).map(|(x, y)| (*x, *y)).collect();
    for axis in &axes {
        assert!(axis.places.0 < axis.places.1 && (axis.places.1 - axis.places.0).is_finite(), "{axis:?}");
        assert!(axis.ticks.iter().all(|(place, text)| place.is_finite() && text.len() < 24), "{axis:?}");
        assert!(axis.ticks.len() < 1400);
        let figure = filled(axis, &axes[0], &points);
        let drawn = svg(&figure, 3).unwrap();
        let mut columns = Columns::of(1);
        let sent = format!("{}{}", figure.to_json(&mut columns), columns.into_json());
        assert!(!sent.contains("NaN") && !sent.contains("inf"));
        assert!(!drawn.contains("NaN") && !drawn.contains("inf"));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    #[test]
    fn any_numbers_make_an_axis_and_a_drawing(
        ends in (number(), number(), number()), values in prop::collection::vec(number(), 0..6),
    ) {
        an_axis_and_a_drawing(ends, &values);
    }
}

#[test]
fn an_axis_to_minus_infinity_without_values_is_drawn() {
    an_axis_and_a_drawing((0.0, f64::NEG_INFINITY, 0.0), &[]);
}
