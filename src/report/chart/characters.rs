//! A panel as characters: bars as blocks, lines and points as braille, eight dots a character.

use super::{Axis, Panel, Point, Shape};

/// Lines of a panel with numbers on its vertical axis.
const LINES: usize = 9;
/// Dots of a character across and downwards.
const DOTS: (usize, usize) = (2, 4);
/// Eighths of a block, from the left.
const BLOCKS: [char; 9] = [' ', '▏', '▎', '▍', '▌', '▋', '▊', '▉', '█'];

/// `panel` in lines of at most `width` characters, its horizontal axis called `label`.
pub fn characters(panel: &Panel, label: &str, width: usize) -> Vec<String> {
    if panel.y.is_names { bars(panel, width) } else { dots(panel, label, width) }
}

/// A line for each name: its bars, and the text beside it.
fn bars(panel: &Panel, width: usize) -> Vec<String> {
    let of = |level: f64| panel.beside.iter().find(|(at, _)| (at - level).abs() < 0.5).map_or("", |(_, text)| text);
    let length = |text: &str| text.chars().count();
    let names = panel.y.ticks.iter().map(|(_, name)| length(name)).max().unwrap_or(0);
    let texts = panel.y.ticks.iter().map(|(level, _)| length(of(*level))).max().unwrap_or(0);
    let room = width.saturating_sub(names + texts + 2).max(10);
    let line = |(level, name): &(f64, String)| {
        let spans: Vec<Point> = panel.series.iter().filter_map(|series| span_at(&series.shape, *level)).collect();
        let place = |value: f64| room as f64 * share(&panel.x, value);
        let block = |at: usize| {
            let filled =
                |(from, to): &Point| (place(*to).min(at as f64 + 1.0) - place(*from).max(at as f64)).clamp(0.0, 1.0);
            let most = spans.iter().map(filled).fold(0.0, f64::max);
            BLOCKS[(8.0 * most).round() as usize]
        };
        let bar: String = (0..room).map(block).collect();
        format!("{}{name} {bar} {}", " ".repeat(names - length(name)), of(*level)).trim_end().to_string()
    };
    panel.y.ticks.iter().map(line).collect()
}

/// From where to where along x a bar of `shape` runs at `level`.
fn span_at(shape: &Shape, level: f64) -> Option<Point> {
    let Shape::Band(lower, upper, ..) = shape else { return None };
    let (first, last) = (lower.first()?, lower.last()?);
    (first.1 <= level && level <= upper.first()?.1).then_some((first.0, last.0))
}

/// The lines and points, with the ends of both axes.
fn dots(panel: &Panel, x_label: &str, width: usize) -> Vec<String> {
    let ends = [panel.y.places.1, panel.y.places.0].map(|place| end(&panel.y, place));
    let left = ends.iter().map(|text| text.chars().count()).max().unwrap_or(0) + 1;
    let columns = width.saturating_sub(left + 2).max(10);
    let (across, down) = (columns * DOTS.0, LINES * DOTS.1);
    let mut grid = vec![0u8; columns * LINES];
    let mut set = |x: f64, y: f64| {
        let (column, row) = ((across as f64 * x) as usize, (down as f64 * (1.0 - y)) as usize);
        if (0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y) {
            let (column, row) = (column.min(across - 1), row.min(down - 1));
            grid[row / DOTS.1 * columns + column / DOTS.0] |= bit(column % DOTS.0, row % DOTS.1);
        }
    };
    let at = |(x, y): Point| (share(&panel.x, x), share(&panel.y, y));
    for series in &panel.series {
        match &series.shape {
            Shape::Line(points, _) => points.windows(2).for_each(|pair| {
                let (from, to) = (at(pair[0]), at(pair[1]));
                let steps = ((to.0 - from.0).abs() * across as f64).max((to.1 - from.1).abs() * down as f64);
                let steps = if steps.is_finite() { steps.ceil().clamp(1.0, 4096.0) as usize } else { 0 };
                for step in 0..=steps {
                    let part = step as f64 / steps.max(1) as f64;
                    set(from.0 + part * (to.0 - from.0), from.1 + part * (to.1 - from.1));
                }
            }),
            Shape::Marks(points, ..) | Shape::Dots(points, ..) => points.iter().for_each(|point| {
                let (x, y) = at(*point);
                set(x, y);
            }),
            _ => {}
        }
    }
    let row = |(at, cells): (usize, &[u8])| {
        let label = if at == 0 {
            &ends[0]
        } else if at + 1 == LINES {
            &ends[1]
        } else {
            ""
        };
        let drawn: String = cells.iter().map(|bits| char::from_u32(0x2800 + u32::from(*bits)).unwrap_or(' ')).collect();
        format!("{label:>left$}│{drawn}")
    };
    let mut lines: Vec<String> = grid.chunks(columns).enumerate().map(row).collect();
    let (low, high) = (end(&panel.x, panel.x.places.0), end(&panel.x, panel.x.places.1));
    lines.push(format!("{:>left$}└{}", "", "─".repeat(columns)));
    let gap = columns.saturating_sub(format!("{low}{x_label}{high}").chars().count()) / 2;
    lines.push(format!("{:left$} {low}{}{x_label}{}{high}", "", " ".repeat(gap), " ".repeat(gap)));
    lines
}

/// The bit of a braille character for a dot: Unicode numbers the upper six column by column, the lowest two after them.
fn bit(column: usize, row: usize) -> u8 {
    match (column, row) {
        (0, 3) => 0x40,
        (1, 3) => 0x80,
        (column, row) => 1 << (3 * column + row),
    }
}

fn share(axis: &Axis, value: f64) -> f64 {
    (axis.place(value) - axis.places.0) / (axis.places.1 - axis.places.0)
}

/// The value at an axis' end, short.
fn end(axis: &Axis, place: f64) -> String {
    crate::report::number::significant(axis.value(place), 2)
}

#[cfg(test)]
mod tests {
    use super::super::{Stroke, palette};
    use super::*;

    #[test]
    fn a_bar_is_as_long_as_its_share_and_lines_fit() {
        let mut panel = Panel::new(Axis::linear("%", 0.0, 100.0), Axis::names(["all".to_string(), "half".to_string()]));
        panel.bar("", (0.0, 100.0), (-0.9, -0.1), palette::INK);
        panel.bar("", (50.0, 100.0), (-1.9, -1.1), palette::INK);
        let lines = characters(&panel, "", 45);
        let blocks = |line: &String| line.matches('█').count();
        assert_eq!((blocks(&lines[0]), blocks(&lines[1])), (39, 19), "{lines:?}");
        assert!(lines.iter().all(|line| line.chars().count() <= 45));
    }

    #[test]
    fn a_line_runs_from_corner_to_corner() {
        let mut panel = Panel::new(Axis::linear("s", 0.0, 1.0), Axis::linear("", 0.0, 1.0));
        panel.line("", [(0.0, 0.0), (1.0, 1.0)], Stroke::solid(palette::INK, 1.0));
        let lines = characters(&panel, "s", 40);
        assert_eq!(lines.len(), LINES + 2);
        assert!(
            lines[0].ends_with('⠉') || lines[0].ends_with('⠋') || lines[0].trim_end().ends_with(|c| c > '\u{2800}')
        );
        assert!(lines[LINES - 1].contains(['⡠', '⡰', '⡐', '⣀', '⢀', '⡀']), "{lines:?}");
    }
}
