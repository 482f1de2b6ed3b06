//! Axes: where a value stands, and which ticks a reader wants.

/// Labelled ticks wanted on a linear axis.
const TICKS: f64 = 5.0;
/// Labelled ticks on an axis of numbers, at most.
const NUMBERS_MAX: usize = 12;

/// Values beyond this are drawn there: the span of two such, with its margin, is still a number.
const LARGEST: f64 = 1e300;
/// The smallest value that a logarithmic axis tells from zero.
const SMALLEST: f64 = 1e-300;

/// How values are spread along an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Scale {
    Linear,
    Log,
    /// sign(x) log10(1 + |x| / from): linear below `from`, logarithmic beyond, both signs.
    SignedLog {
        from: f64,
    },
}

/// One axis of a panel. A panel is drawn in places, which `place` computes from values.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// What it shows, with its unit; empty draws no label.
    pub label: String,
    /// Lowest and highest place.
    pub places: (f64, f64),
    /// Places with their text.
    pub ticks: Vec<(f64, String)>,
    /// Places of grid lines without text.
    pub minor: Vec<f64>,
    /// Whether its ticks are names, not values.
    pub is_names: bool,
    /// Whether its ticks have no texts, because a neighbour has them.
    pub is_hidden: bool,
    scale: Scale,
}

/// `axis` with values as ticks.
fn of_values(
    label: impl Into<String>,
    places: (f64, f64),
    ticks: Vec<(f64, String)>,
    minor: Vec<f64>,
    scale: Scale,
) -> Axis {
    Axis { label: label.into(), places, ticks, minor, is_names: false, is_hidden: false, scale }
}

impl Axis {
    /// Evenly spaced, from `low` to `high`.
    pub fn linear(label: impl Into<String>, low: f64, high: f64) -> Self {
        let places = widened(low, high);
        let ticks = linear_ticks(places, step((places.1 - places.0) / TICKS));
        of_values(label, places, ticks, Vec::new(), Scale::Linear)
    }

    /// Evenly spaced from -`reach` to `reach`, with three to five ticks: for a low panel.
    pub fn low(label: impl Into<String>, reach: f64) -> Self {
        let axis = Self::linear(label, -reach, reach);
        // The widest step that still leaves a tick on either side of zero, off the edge.
        let power = 10f64.powf((0.9 * axis.places.1).log10().floor());
        let widest = [5.0, 2.0].into_iter().find(|digit| digit * power <= 0.9 * axis.places.1).unwrap_or(1.0) * power;
        Self { ticks: linear_ticks(axis.places, widest), ..axis }
    }

    /// Evenly spaced, holding all of `values` and a margin of `margin` times their span.
    pub fn around(label: impl Into<String>, values: impl IntoIterator<Item = f64>, margin: f64) -> Self {
        let (low, high) = span(values);
        let room = margin * (high - low);
        Self::linear(label, low - room, high + room)
    }

    /// Logarithmic, holding all of `values`, which must be positive.
    pub fn log(label: impl Into<String>, values: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = span(values.into_iter().filter(|x| *x > 0.0).map(|x| x.clamp(SMALLEST, LARGEST)));
        let (low, high) = if low > 0.0 { (low / 1.12, high * 1.12) } else { (0.1, 1.0) };
        let decades = high.log10() - low.log10();
        let labelled: &[u32] = match decades {
            d if d < 1.6 => &[1, 2, 3, 5, 7],
            d if d < 2.6 => &[1, 2, 5],
            _ => &[1],
        };
        let (mut ticks, mut minor) = (Vec::new(), Vec::new());
        for power in low.log10().floor() as i32..=high.log10().floor() as i32 {
            for digit in 1..10 {
                let value = f64::from(digit) * 10f64.powi(power);
                if (low..=high).contains(&value) {
                    match labelled.contains(&digit) {
                        true => ticks.push((value.log10(), plain(value))),
                        false => minor.push(value.log10()),
                    }
                }
            }
        }
        of_values(label, (low.log10(), high.log10()), ticks, minor, Scale::Log)
    }

    /// Logarithmic on both sides of zero, from `low` to `high`; what is smaller than `from` gathers about zero.
    pub fn signed_log(label: impl Into<String>, low: f64, high: f64, from: f64) -> Self {
        let from = if from > 0.0 { from.clamp(SMALLEST, LARGEST) } else { 1.0 };
        let (low, high) = (bounded(low).min(bounded(high)), bounded(high).max(bounded(low)));
        let scale = Scale::SignedLog { from };
        let place = |value: f64| signed_log(value, from);
        let mut ticks = vec![(0.0, "0".to_string())];
        let largest = low.abs().max(high.abs());
        for power in from.log10().floor() as i32..=largest.log10().floor() as i32 {
            for value in [10f64.powi(power), -10f64.powi(power)] {
                // Ticks that stand in the linear part would run into the zero.
                if (low..=high).contains(&value) && value.abs() >= 0.9 * from {
                    ticks.push((place(value), minus(plain(value))));
                }
            }
        }
        of_values(label, widened(place(low), place(high)), ticks, Vec::new(), scale)
    }

    /// Rows with names from above, the first at -0.5, the next at -1.5.
    pub fn names(names: impl IntoIterator<Item = String>) -> Self {
        let ticks: Vec<(f64, String)> =
            names.into_iter().enumerate().map(|(at, name)| (-(at as f64) - 0.5, name)).collect();
        let axis = of_values("", (-(ticks.len().max(1) as f64), 0.0), ticks, Vec::new(), Scale::Linear);
        Self { is_names: true, ..axis }
    }

    /// Columns with names from the left, the first at 0, the next at 1.
    pub fn columns(names: impl IntoIterator<Item = String>) -> Self {
        let ticks: Vec<(f64, String)> = names.into_iter().enumerate().map(|(at, name)| (at as f64, name)).collect();
        let axis = of_values("", (-0.6, ticks.len().max(1) as f64 - 0.4), ticks, Vec::new(), Scale::Linear);
        Self { is_names: true, ..axis }
    }

    /// Places numbered from 1 to `last`: for what is counted, not measured.
    pub fn numbered(label: impl Into<String>, last: usize) -> Self {
        let every = last.div_ceil(NUMBERS_MAX).max(1);
        let ticks = (1..=last).step_by(every).map(|at| (at as f64, at.to_string())).collect();
        let axis = of_values(label, (0.6, last.max(1) as f64 + 0.4), ticks, Vec::new(), Scale::Linear);
        Self { is_names: true, ..axis }
    }

    /// What it is called in the page's script, and where a signed logarithmic one becomes linear.
    pub fn kind(&self) -> (&'static str, f64) {
        match self.scale {
            Scale::Linear => ("linear", 0.0),
            Scale::Log => ("log", 0.0),
            Scale::SignedLog { from } => ("signed", from),
        }
    }

    /// Without its label: the neighbour below or beside shows it.
    pub fn without_label(mut self) -> Self {
        self.label.clear();
        self
    }

    /// Without the ticks' texts.
    pub fn without_texts(mut self) -> Self {
        self.ticks.iter_mut().for_each(|(_, text)| text.clear());
        self.is_hidden = true;
        self.without_label()
    }

    /// With every other tick: for a panel too low for all of them.
    pub fn sparse(mut self) -> Self {
        let mut at = 0..;
        self.ticks.retain(|_| at.next().is_some_and(|at: usize| at.is_multiple_of(2)));
        self
    }

    /// Where `value` stands, be it beyond the axis.
    pub fn place(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => value,
            Scale::Log => value.max(f64::MIN_POSITIVE).log10(),
            Scale::SignedLog { from } => signed_log(value, from),
        }
    }

    /// Where `value` stands; beyond the axis, at its end.
    pub fn place_within(&self, value: f64) -> f64 {
        self.place(value).clamp(self.places.0, self.places.1)
    }

    /// The value at `place`.
    pub fn value(&self, place: f64) -> f64 {
        match self.scale {
            Scale::Linear => place,
            Scale::Log => 10f64.powf(place),
            Scale::SignedLog { from } => place.signum() * from * (10f64.powf(place.abs()) - 1.0),
        }
    }

    /// Values evenly spread in place over `low` to `high`: for curves.
    pub fn spread(&self, low: f64, high: f64, number: usize) -> Vec<f64> {
        let share = move |i: usize| i as f64 / (number.max(2) - 1) as f64;
        match self.scale {
            Scale::Log => (0..number).map(|i| low * (high / low).powf(share(i))).collect(),
            _ => (0..number).map(|i| low + (high - low) * share(i)).collect(),
        }
    }
}

/// Smallest and largest finite value; zero without any.
pub fn span(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let finite = values.into_iter().filter(|x| x.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    if low <= high { (low, high) } else { (0.0, 0.0) }
}

/// `value` as a number that can be drawn; NaN becomes zero.
fn bounded(value: f64) -> f64 {
    if value.is_nan() { 0.0 } else { value.clamp(-LARGEST, LARGEST) }
}

/// sign(x) log10(1 + |x| / from), finite for every finite x.
fn signed_log(value: f64, from: f64) -> f64 {
    value.signum() * (1.0 + (value.abs() / from).min(f64::MAX)).log10()
}

/// A span that can be divided by, whatever the ends are: a single value gets a little room.
fn widened(low: f64, high: f64) -> (f64, f64) {
    let (low, high) = (bounded(low).min(bounded(high)), bounded(high).max(bounded(low)));
    let least = 1e-6 * low.abs().max(high.abs()).max(1e-9);
    if high - low > least { (low, high) } else { (low - 50.0 * least, high + 50.0 * least) }
}

/// From here on a tick is written with an exponent.
const DIGITS_MAX: f64 = 1e9;

/// Ticks at multiples of `step`, with just the decimals that they need.
fn linear_ticks((low, high): (f64, f64), step: f64) -> Vec<(f64, String)> {
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    let text =
        |value: f64| if value.abs() < DIGITS_MAX { format!("{value:.decimals$}") } else { format!("{value:.2e}") };
    (first..=last).map(|i| (i as f64 * step, minus(text(i as f64 * step)))).collect()
}

/// 1, 2 or 5 times a power of ten, near `rough`.
fn step(rough: f64) -> f64 {
    let power = 10f64.powf(rough.log10().floor());
    let digit = [1.0, 2.0, 5.0].into_iter().find(|d| rough <= 1.4 * d * power).unwrap_or(10.0);
    digit * power
}

/// Without trailing zeros, and without an exponent where it fits.
fn plain(value: f64) -> String {
    if value.abs() >= DIGITS_MAX {
        return format!("{value:.0e}");
    }
    let text = format!("{value:.6}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
        false => text,
    }
}

/// With a true minus sign, and none before zero.
fn minus(text: String) -> String {
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| matches!(c, '0' | '.')) => rest.to_string(),
        Some(rest) => format!("\u{2212}{rest}"),
        None => text,
    }
}

#[cfg(test)]
mod tests;
