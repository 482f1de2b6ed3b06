//! A figure as SVG.

use super::canvas::{Canvas, Drawn, LABEL_PX, TEXT_PX, canvas};
use super::layout::{Frame, Sheet, WIDTH_PX, sheet, ticks_px};
use super::palette::{GREY, GRID, INK};
use super::{Anchor, Cells, Figure, Panel, Point, Series, Shape, Stroke, thin};

/// Stretches of a line of which the lowest and the highest point are drawn, in files: about one per pixel.
pub const FOR_FILES: usize = 1000;
/// The same in a page, for readers without its script and for print.
pub const FOR_PAGES: usize = 120;

/// Viridis (van der Walt and Smith) from its bright end: lightness falls all along, so that it reads in print and by
/// colour-blind readers, and no value is as pale as paper.
const STOPS: [(u8, u8, u8); 9] = [
    (253, 231, 37),
    (173, 220, 48),
    (94, 201, 98),
    (40, 174, 128),
    (33, 145, 140),
    (44, 114, 142),
    (59, 82, 139),
    (71, 45, 123),
    (68, 1, 84),
];
/// How far a cell reaches under its neighbours, px: no seam shows.
const LAP_PX: f64 = 0.6;
/// Strips of a colour bar.
const STRIPS: u32 = 60;

/// `figure` as SVG, of each line the lowest and the highest point of `buckets` stretches.
///
/// Errors: none that occur; plotters does not know that writing to memory does not fail.
pub fn svg(figure: &Figure, buckets: usize) -> Drawn<String> {
    let Sheet { height_px, legend, panels } = sheet(figure);
    canvas((WIDTH_PX as u32, height_px.ceil() as u32), &figure.title, |canvas| {
        for (at, entry) in &legend {
            sample(canvas, *at, entry)?;
            canvas.text((at.0 + 30.0, at.1), &entry.name, TEXT_PX, INK, Anchor::Left)?;
        }
        panels.iter().try_for_each(|(frame, panel)| Drawing { canvas, frame: *frame, panel }.draw(buckets))
    })
}

/// A legend's sample, 24 px wide from `at`.
fn sample(canvas: &Canvas, (x, y): Point, entry: &Series) -> Drawn {
    match &entry.shape {
        Shape::Line(_, stroke) => {
            let thin = Stroke { width_px: stroke.width_px.clamp(1.4, 4.0), ..*stroke };
            canvas.path(&[(x, y), (x + 24.0, y)], thin)
        }
        Shape::Band(_, _, color, opacity) => canvas.fill((x, y - 6.0), (x + 24.0, y + 6.0), *color, opacity.max(0.25)),
        Shape::Dots(_, _, color, _) => canvas.disc((x + 13.0, y), 3.0, *color, 1.0),
        Shape::Marks(_, mark, color) => canvas.mark((x + 13.0, y), *mark, *color),
        Shape::Texts(..) | Shape::Cells(_) => Ok(()),
    }
}

/// A panel being drawn.
struct Drawing<'c, 'a> {
    canvas: &'c Canvas<'a>,
    frame: Frame,
    panel: &'c Panel,
}

impl Drawing<'_, '_> {
    fn draw(&self, buckets: usize) -> Drawn {
        self.axes()?;
        // A narrow panel shows no more than its width.
        let part = (self.frame.right - self.frame.left) / WIDTH_PX;
        let buckets = (buckets as f64 * part).ceil() as usize;
        self.panel.series.iter().try_for_each(|series| self.shape(&series.shape, buckets))?;
        for (value, text) in &self.panel.beside {
            let at = (self.frame.right + 10.0, self.upwards(self.panel.y.place_within(*value)));
            self.canvas.text(at, text, TEXT_PX, INK, Anchor::Left)?;
        }
        Ok(())
    }

    /// Where a place on the x axis stands, px.
    fn across(&self, place: f64) -> f64 {
        self.frame.left + (self.frame.right - self.frame.left) * share(place, self.panel.x.places)
    }

    /// Where a place on the y axis stands, px.
    fn upwards(&self, place: f64) -> f64 {
        self.frame.bottom - (self.frame.bottom - self.frame.top) * share(place, self.panel.y.places)
    }

    /// Where a point stands, px; beyond the axes, at their ends.
    fn px(&self, (x, y): Point) -> Point {
        (self.across(self.panel.x.place_within(x)), self.upwards(self.panel.y.place_within(y)))
    }

    fn axes(&self) -> Drawn {
        let (canvas, Frame { left, top, right, bottom }, Panel { x, y, title, .. }) =
            (self.canvas, self.frame, self.panel);
        for place in x.ticks.iter().map(|t| t.0).chain(x.minor.iter().copied()) {
            canvas.line((self.across(place), top), (self.across(place), bottom), GRID, 1.0)?;
        }
        if !y.is_names {
            for place in y.ticks.iter().map(|t| t.0).chain(y.minor.iter().copied()) {
                canvas.line((left, self.upwards(place)), (right, self.upwards(place)), GRID, 1.0)?;
            }
        }
        for (place, text) in &x.ticks {
            canvas.line((self.across(*place), bottom), (self.across(*place), bottom + 4.0), INK, 1.0)?;
            canvas.text((self.across(*place), bottom + 8.0), text, TEXT_PX, INK, Anchor::Below)?;
        }
        for (place, text) in &y.ticks {
            canvas.line((left - 4.0, self.upwards(*place)), (left, self.upwards(*place)), INK, 1.0)?;
            canvas.text((left - 8.0, self.upwards(*place)), text, TEXT_PX, INK, Anchor::Right)?;
        }
        canvas.line((left, bottom), (right, bottom), INK, 1.0)?;
        canvas.line((left, top), (left, bottom), INK, 1.0)?;
        canvas.text(((left + right) / 2.0, bottom + 26.0), &x.label, LABEL_PX, INK, Anchor::Below)?;
        let beside = left - ticks_px(self.panel) - 22.0;
        canvas.text((beside, (top + bottom) / 2.0), &y.label, LABEL_PX, INK, Anchor::Upwards)?;
        canvas.heading((left, top - 12.0), title)
    }

    fn shape(&self, shape: &Shape, buckets: usize) -> Drawn {
        match shape {
            Shape::Line(points, stroke) => {
                let places = |run: &[Point]| -> Vec<Point> {
                    run.iter().map(|(x, y)| (self.panel.x.place(*x), self.panel.y.place(*y))).collect()
                };
                let thinned = thin::runs(points, buckets);
                let runs = thinned.iter().flat_map(|run| visible_runs(places(run).into_iter(), self.ends()));
                runs.collect::<Vec<_>>().iter().try_for_each(|run| {
                    let px: Vec<Point> = run.iter().map(|(x, y)| (self.across(*x), self.upwards(*y))).collect();
                    self.canvas.path(&px, *stroke)
                })
            }
            Shape::Band(lower, upper, color, opacity) => {
                let (lower, upper) = (thin::low_edge(lower, buckets), thin::high_edge(upper, buckets));
                let outline: Vec<Point> = self.finite(lower.iter().chain(upper.iter().rev()));
                match outline.is_empty() {
                    true => Ok(()),
                    false => self.canvas.area(&outline, *color, *opacity),
                }
            }
            Shape::Dots(points, radius, color, opacity) => {
                self.finite(points).into_iter().try_for_each(|at| self.canvas.disc(at, *radius, *color, *opacity))
            }
            Shape::Marks(points, mark, color) => {
                self.finite(points).into_iter().try_for_each(|at| self.canvas.mark(at, *mark, *color))
            }
            Shape::Texts(texts, anchor, color) => {
                texts.iter().try_for_each(|(at, text)| self.canvas.text(self.px(*at), text, TEXT_PX, *color, *anchor))
            }
            Shape::Cells(cells) => self.cells(cells),
        }
    }

    fn ends(&self) -> [Point; 2] {
        [self.panel.x.places, self.panel.y.places]
    }

    fn finite<'p>(&self, points: impl IntoIterator<Item = &'p Point>) -> Vec<Point> {
        points.into_iter().filter(|(x, y)| x.is_finite() && y.is_finite()).map(|p| self.px(*p)).collect()
    }

    /// The cells, and beside them the bar that tells what a colour means.
    fn cells(&self, cells: &Cells) -> Drawn {
        let columns = cells.across.len() - 1;
        for (at, value) in cells.values.iter().enumerate().filter(|(_, value)| value.is_finite()) {
            let (row, column) = (at / columns, at % columns);
            let lower = (self.across(cells.across[column]).round(), self.upwards(cells.upwards[row]).round());
            let upper = (
                self.across(cells.across[column + 1]).round() + LAP_PX,
                self.upwards(cells.upwards[row + 1]).round() - LAP_PX,
            );
            self.canvas.cell(lower, upper, color_at(share(cells.axis.place(*value), cells.axis.places)))?;
        }
        let Frame { right, top, bottom, .. } = self.frame;
        let (left, end) = (right + 20.0, right + 34.0);
        let level = |place: f64| bottom - (bottom - top) * share(place, cells.axis.places);
        for strip in 0..STRIPS {
            // Each reaches to the top, the next one covers it: no seams.
            let share = f64::from(strip) / f64::from(STRIPS);
            self.canvas.cell((left, top), (end, bottom - (bottom - top) * share), color_at(share))?;
        }
        for (place, text) in &cells.axis.ticks {
            self.canvas.line((end, level(*place)), (end + 4.0, level(*place)), INK, 1.0)?;
            self.canvas.text((end + 7.0, level(*place)), text, TEXT_PX, INK, Anchor::Left)?;
        }
        let marked = level(cells.axis.place_within(cells.marked.0));
        self.canvas.mark((left - 6.0, marked), super::Mark::Rightwards, INK)?;
        self.canvas.mark((left + 2.0, bottom + 16.0), super::Mark::Rightwards, GREY)?;
        self.canvas.text((left + 12.0, bottom + 16.0), cells.marked.1, TEXT_PX, GREY, Anchor::Left)?;
        self.canvas.text((left - 2.0, top - 12.0), &cells.axis.label, TEXT_PX, INK, Anchor::Left)
    }
}

/// The colour at `share` of the scale, 0 to 1.
fn color_at(share: f64) -> (u8, u8, u8) {
    let at = share.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let from = (at as usize).min(STOPS.len() - 2);
    let part = at - from as f64;
    let (a, b) = (STOPS[from], STOPS[from + 1]);
    let mix = |a: u8, b: u8| (f64::from(a) + part * (f64::from(b) - f64::from(a))).round() as u8;
    (mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

/// The parts of a line that lie within `ends` of x and y; a point that is not finite breaks it.
fn visible_runs(places: impl Iterator<Item = Point>, [x, y]: [Point; 2]) -> Vec<Vec<Point>> {
    let mut runs: Vec<Vec<Point>> = Vec::new();
    let mut last: Option<Point> = None;
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
fn visible(from: Point, to: Point, x: Point, y: Point) -> Option<(Point, Point)> {
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

fn share(place: f64, (low, high): Point) -> f64 {
    (place - low) / (high - low)
}
