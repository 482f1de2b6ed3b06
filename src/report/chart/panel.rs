//! A panel: axes around an area in which data are drawn.

use super::palette::{GRID, INK};
use super::{Anchor, Axis, Canvas, Drawn, FINENESS, LABEL_PX, TEXT_PX, fine};
use crate::model::Direction;
use plotters::coord::cartesian::Cartesian2d;
use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::{Circle, DrawingArea, PathElement, Polygon, RGBColor, SVGBackend};
use plotters::style::{Color, ShapeStyle};

/// Where a panel's data area stands on the canvas, px; labels and ticks stand outside, left and below.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Left edge.
    pub left: f64,
    /// Upper edge.
    pub top: f64,
    /// Right edge.
    pub right: f64,
    /// Lower edge.
    pub bottom: f64,
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub color: RGBColor,
    /// Its width, px.
    pub width_px: f64,
    /// Length of dashes and of the gaps between them, px; `None` is a whole line.
    pub dash_px: Option<(f64, f64)>,
}

impl Stroke {
    /// A whole line.
    pub fn solid(color: RGBColor, width_px: f64) -> Self {
        Self { color, width_px, dash_px: None }
    }

    /// A dashed line.
    pub fn dashed(color: RGBColor, width_px: f64, dash_px: f64, gap_px: f64) -> Self {
        Self { color, width_px, dash_px: Some((dash_px, gap_px)) }
    }
}

/// A sign for one point, or a line's or band's sample in a legend.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mark {
    /// A triangle that points up: moving up.
    Up,
    /// A triangle that points down: moving down.
    Down,
    /// A triangle that points left: goes on there.
    Leftwards,
    /// A triangle that points right.
    Rightwards,
    /// A disc of this radius, px.
    Disc(f64),
    /// A ring.
    Ring,
    /// A square on its corner.
    Diamond,
    /// A square.
    Square,
    /// A line of this width, px, dashed or not.
    Line(f64, Option<(f64, f64)>),
    /// A band.
    Band,
}

impl Mark {
    /// The triangle that points where the motion goes.
    pub fn of(direction: Direction) -> Self {
        match direction {
            Direction::Up => Self::Up,
            Direction::Down => Self::Down,
        }
    }
}

/// An area with axes.
pub struct Panel<'a> {
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    frame: Frame,
    area: DrawingArea<SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>,
}

impl<'a> Canvas<'a> {
    /// Draws the axes of a panel and gives it to be filled.
    pub fn panel(&self, frame: Frame, x: Axis, y: Axis) -> Drawn<Panel<'a>> {
        let pixels = (fine(frame.left)..fine(frame.right), fine(frame.bottom)..fine(frame.top));
        let ranges = (x.places.0..x.places.1, y.places.0..y.places.1);
        let area = self.root.apply_coord_spec(Cartesian2d::new(ranges.0, ranges.1, pixels));
        let panel = Panel { x, y, frame, area };
        let (wide, tall) = (frame.right - frame.left, frame.bottom - frame.top);
        let across = |place: f64| frame.left + wide * share(place, panel.x.places);
        let upwards = |place: f64| frame.bottom - tall * share(place, panel.y.places);
        for place in panel.x.ticks.iter().map(|t| t.0).chain(panel.x.minor.iter().copied()) {
            self.line((across(place), frame.top), (across(place), frame.bottom), GRID, 1.0)?;
        }
        for place in panel.y.ticks.iter().map(|t| t.0).chain(panel.y.minor.iter().copied()) {
            self.line((frame.left, upwards(place)), (frame.right, upwards(place)), GRID, 1.0)?;
        }
        for (place, text) in &panel.x.ticks {
            self.line((across(*place), frame.bottom), (across(*place), frame.bottom + 4.0), INK, 1.0)?;
            self.text((across(*place), frame.bottom + 8.0), text, TEXT_PX, INK, Anchor::Below)?;
        }
        for (place, text) in &panel.y.ticks {
            self.line((frame.left - 4.0, upwards(*place)), (frame.left, upwards(*place)), INK, 1.0)?;
            self.text((frame.left - 8.0, upwards(*place)), text, TEXT_PX, INK, Anchor::Right)?;
        }
        self.line((frame.left, frame.bottom), (frame.right, frame.bottom), INK, 1.0)?;
        self.line((frame.left, frame.top), (frame.left, frame.bottom), INK, 1.0)?;
        let middle = (frame.left + wide / 2.0, frame.top + tall / 2.0);
        self.text((middle.0, frame.bottom + 28.0), &panel.x.label, LABEL_PX, INK, Anchor::Below)?;
        let widest = panel.y.ticks.iter().map(|(_, text)| super::text_width_px(text, TEXT_PX)).fold(0.0, f64::max);
        self.text((frame.left - widest - 24.0, middle.1), &panel.y.label, LABEL_PX, INK, Anchor::Upwards)?;
        Ok(panel)
    }

    /// A legend's sample, 24 px wide from `at_px`.
    pub(super) fn sample(&self, (x, y): (f64, f64), mark: Mark, color: RGBColor) -> Drawn {
        match mark {
            Mark::Line(width_px, None) => self.line((x, y), (x + 24.0, y), color, width_px),
            Mark::Line(width_px, Some((dash, gap))) => {
                let mut dashes = (0..).map(|i| x + f64::from(i) * (dash + gap)).take_while(|from| *from < x + 24.0);
                dashes.try_for_each(|from| self.line((from, y), ((from + dash).min(x + 24.0), y), color, width_px))
            }
            Mark::Band => self.fill((x, y - 6.0), (x + 24.0, y + 6.0), color, 0.25),
            _ => {
                let center = (fine(x + 13.0), fine(y));
                mark_shapes(mark).iter().try_for_each(|shape| match shape {
                    Shape::Disc(r) => self.root.draw(&Circle::new(center, *r, color.filled())),
                    Shape::Ring(r) => self.root.draw(&Circle::new(center, *r, color.stroke_width(fine(1.5) as u32))),
                    Shape::Corners(corners) => {
                        let around: Vec<(i32, i32)> =
                            corners.iter().map(|(a, b)| (center.0 + a, center.1 + b)).collect();
                        self.root.draw(&Polygon::new(around, color.filled()))
                    }
                })
            }
        }
    }
}

impl Panel<'_> {
    /// Where a point stands on the canvas, px; beyond the axes, at their ends.
    pub fn px(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let Frame { left, top, right, bottom } = self.frame;
        let across = share(self.x.place_within(x), self.x.places);
        let upwards = share(self.y.place_within(y), self.y.places);
        (left + (right - left) * across, bottom - (bottom - top) * upwards)
    }

    /// A line through `points`, as far as it lies within the axes.
    pub fn line(&self, points: impl IntoIterator<Item = (f64, f64)>, stroke: Stroke) -> Drawn {
        let places = points.into_iter().map(|(x, y)| (self.x.place(x), self.y.place(y)));
        let style: ShapeStyle = stroke.color.stroke_width(fine(stroke.width_px) as u32);
        let runs = visible_runs(places, self.x.places, self.y.places);
        runs.into_iter().try_for_each(|run| match stroke.dash_px {
            None => self.area.draw(&PathElement::new(run, style)),
            Some((dash, gap)) => {
                self.area.draw(&DashedPathElement::new(run.iter().copied(), fine(dash), fine(gap), style))
            }
        })
    }

    /// The area between two lines; beyond the axes it runs along their ends.
    pub fn band(&self, lower: &[(f64, f64)], upper: &[(f64, f64)], color: RGBColor, opacity: f64) -> Drawn {
        let outline = self.places(lower.iter().chain(upper.iter().rev()).copied());
        self.area.draw(&Polygon::new(outline, color.mix(opacity)))
    }

    /// Small discs, many; those beyond the axes stand at their ends.
    pub fn dots(
        &self,
        points: impl IntoIterator<Item = (f64, f64)>,
        radius_px: f64,
        color: RGBColor,
        opacity: f64,
    ) -> Drawn {
        let style = color.mix(opacity).filled();
        self.places(points).into_iter().try_for_each(|at| self.area.draw(&Circle::new(at, fine(radius_px), style)))
    }

    /// One point.
    pub fn mark(&self, at: (f64, f64), mark: Mark, color: RGBColor) -> Drawn {
        use plotters::element::EmptyElement;
        let place = (self.x.place_within(at.0), self.y.place_within(at.1));
        mark_shapes(mark).into_iter().try_for_each(|shape| match shape {
            Shape::Disc(r) => self.area.draw(&(EmptyElement::at(place) + Circle::new((0, 0), r, color.filled()))),
            Shape::Ring(r) => {
                let style = color.stroke_width(fine(1.5) as u32);
                self.area.draw(&(EmptyElement::at(place) + Circle::new((0, 0), r, style)))
            }
            Shape::Corners(corners) => {
                self.area.draw(&(EmptyElement::at(place) + Polygon::new(corners, color.filled())))
            }
        })
    }

    fn places(&self, points: impl IntoIterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
        let finite = points.into_iter().filter(|(x, y)| x.is_finite() && y.is_finite());
        finite.map(|(x, y)| (self.x.place_within(x), self.y.place_within(y))).collect()
    }
}

/// What a mark is made of, about its point.
enum Shape {
    Disc(i32),
    Ring(i32),
    Corners(Vec<(i32, i32)>),
}

fn mark_shapes(mark: Mark) -> Vec<Shape> {
    let corners = |points: &[(f64, f64)]| Shape::Corners(points.iter().map(|(x, y)| (fine(*x), fine(*y))).collect());
    match mark {
        Mark::Up => vec![corners(&[(-4.5, 3.5), (4.5, 3.5), (0.0, -4.5)])],
        Mark::Down => vec![corners(&[(-4.5, -3.5), (4.5, -3.5), (0.0, 4.5)])],
        Mark::Leftwards => vec![corners(&[(6.0, -5.0), (6.0, 5.0), (-4.0, 0.0)])],
        Mark::Rightwards => vec![corners(&[(-6.0, -5.0), (-6.0, 5.0), (4.0, 0.0)])],
        Mark::Disc(radius_px) => vec![Shape::Disc(fine(radius_px))],
        Mark::Ring => vec![Shape::Ring((4.5 * FINENESS) as i32)],
        Mark::Diamond => vec![corners(&[(0.0, -5.5), (5.5, 0.0), (0.0, 5.5), (-5.5, 0.0)])],
        Mark::Square => vec![corners(&[(-4.5, -4.5), (4.5, -4.5), (4.5, 4.5), (-4.5, 4.5)])],
        Mark::Line(..) | Mark::Band => Vec::new(),
    }
}

/// The parts of a line that lie within `x` and `y`; a point that is not finite breaks it.
fn visible_runs(places: impl Iterator<Item = (f64, f64)>, x: (f64, f64), y: (f64, f64)) -> Vec<Vec<(f64, f64)>> {
    let mut runs: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut last: Option<(f64, f64)> = None;
    for place in places {
        let seen = last.and_then(|from| visible(from, place, x, y));
        if let Some((from, to)) = seen {
            match runs.last_mut() {
                Some(run) if run.last() == Some(&from) => run.push(to),
                _ => runs.push(vec![from, to]),
            }
        }
        last = (place.0.is_finite() && place.1.is_finite()).then_some(place);
    }
    runs
}

/// The part of the way from `from` to `to` within `x` and `y`, by Liang and Barsky: each edge cuts the share of the way off
/// that lies beyond it.
fn visible(from: (f64, f64), to: (f64, f64), x: (f64, f64), y: (f64, f64)) -> Option<((f64, f64), (f64, f64))> {
    let step = (to.0 - from.0, to.1 - from.1);
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for (way, room) in
        [(-step.0, from.0 - x.0), (step.0, x.1 - from.0), (-step.1, from.1 - y.0), (step.1, y.1 - from.1)]
    {
        match room / way {
            _ if way == 0.0 && room < 0.0 => return None,
            _ if way == 0.0 => {}
            at if way < 0.0 => enter = enter.max(at),
            at => leave = leave.min(at),
        }
    }
    let at = |share: f64| (from.0 + share * step.0, from.1 + share * step.1);
    // The ends themselves where nothing is cut off: so that neighbouring parts join exactly.
    let ends = (if enter > 0.0 { at(enter) } else { from }, if leave < 1.0 { at(leave) } else { to });
    (enter <= leave && (to.0.is_finite() && to.1.is_finite())).then_some(ends)
}

fn share(place: f64, (low, high): (f64, f64)) -> f64 {
    (place - low) / (high - low)
}
