//! What an identification knows well even where single parameters trade off: A, and B(v) at the speeds that it saw.
//!
//! Parameters of (19) can differ widely between two fits of the same friction; A and B(v) cannot. Comparisons rest on them.

use super::{Both, Direction};
use crate::document::Section;
use crate::numerics::statistics::HALF_WIDTH;
use serde_json::{Map, Value, json};

/// The slowest and the fastest speed at which all of `branches` know B(v), rad/s; `None` where there is no such range.
pub fn shared_speeds<'a>(branches: impl IntoIterator<Item = &'a BranchFunctions>) -> Option<(f64, f64)> {
    let (mut slowest, mut fastest) = (0f64, f64::INFINITY);
    for of in branches {
        if let (Some(first), Some(last)) = (of.levels.first(), of.levels.last()) {
            (slowest, fastest) = (slowest.max(first.speed_rad_s), fastest.min(last.speed_rad_s));
        }
    }
    (slowest > 0.0 && slowest < fastest && fastest.is_finite()).then_some((slowest, fastest))
}

/// A and B(v) of both directions, with their errors; `None` where they were not identified.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Functions {
    /// By direction.
    pub branches: Both<Option<BranchFunctions>>,
}

/// A and B(v) of one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchFunctions {
    /// A of (17), N m; 0 where no load shows it.
    pub a_nm: f64,
    /// Its standard error, N m; infinite where no load shows it.
    pub a_se_nm: f64,
    /// B(v), slowest first.
    pub levels: Vec<Level>,
    /// Standard error that all levels share, from A and the position's zero, N m.
    pub common_se_nm: f64,
    /// Both by their source; empty where the sources are not known: then they share nothing.
    pub errors: Vec<SharedError>,
}

/// An error that moves A and all of B(v), one standard deviation of it. Those at one place in the lists of both directions are one and the same
/// error: that of A in its own direction, which B = y - A sin(theta) takes up with the opposite sign, that of the zero in both.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SharedError {
    /// What it adds to A, N m.
    pub a_nm: f64,
    /// What it adds to every B, N m.
    pub b_nm: f64,
}

/// B at one speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// |v|, rad/s.
    pub speed_rad_s: f64,
    /// B, N m.
    pub b_nm: f64,
    /// Its standard error, what all levels share left out, N m.
    pub se_nm: f64,
}

impl Functions {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        Direction::BOTH.iter().all(|direction| self.branches.of(*direction).is_none())
    }

    /// As in `model.json`: half widths are those of 95 % intervals; what is not known is null.
    pub fn to_json(&self) -> Value {
        let half = |se: f64| HALF_WIDTH * se;
        let level = |level: &Level| {
            let half_width = half(level.se_nm);
            json!({ "speed_rad_s": level.speed_rad_s, "b_nm": level.b_nm, "half_width_nm": half_width })
        };
        let shared = |error: &SharedError| json!({ "a_nm": half(error.a_nm), "b_nm": half(error.b_nm) });
        let branch = |of: &BranchFunctions| {
            json!({
                "a_nm": of.a_nm,
                "a_half_width_nm": half(of.a_se_nm),
                "b": of.levels.iter().map(level).collect::<Vec<Value>>(),
                "b_common_half_width_nm": half(of.common_se_nm),
                "shared": of.errors.iter().map(shared).collect::<Vec<Value>>(),
            })
        };
        let known = |direction: &Direction| {
            let of = self.branches.of(*direction).as_ref()?;
            Some((direction.name().to_string(), branch(of)))
        };
        Direction::BOTH.iter().filter_map(known).collect::<Map<String, Value>>().into()
    }

    /// Reads them back.
    pub fn read(s: &Section<'_>) -> Option<Self> {
        let read = |direction: Direction| s.may(direction.name()).section(BranchFunctions::read);
        Some(Self { branches: Both { up: read(Direction::Up), down: read(Direction::Down) } })
    }

    /// The errors that A and B(v) of `direction` share with those of the other one, place by place.
    pub fn errors(&self, direction: Direction) -> Vec<SharedError> {
        let Some(of) = self.branches.of(direction) else { return Vec::new() };
        let other = self.branches.of(direction.opposite()).as_ref().map_or(of.errors.len(), |other| other.errors.len());
        if !of.errors.is_empty() && other == of.errors.len() {
            return of.errors.clone();
        }
        let mut apart = vec![SharedError::default(); 4];
        let at = if direction == Direction::Up { 0 } else { 2 };
        apart[at].a_nm = if of.a_se_nm.is_finite() { of.a_se_nm } else { 0.0 };
        apart[at + 1].b_nm = of.common_se_nm;
        apart
    }

    /// B at `speed_rad_s` with its standard error, N m; `None` beyond the speeds that the identification saw.
    pub fn b_nm(&self, direction: Direction, speed_rad_s: f64) -> Option<(f64, f64)> {
        let of = self.branches.of(direction).as_ref()?;
        let level = of.at(speed_rad_s)?;
        Some((level.b_nm, level.se_nm.hypot(of.common_se_nm)))
    }

    /// B moving up less B moving down, the width of a loop without load, with its standard error, N m: what moves both alike, as
    /// the zero does, it does not know.
    pub fn width_nm(&self, speed_rad_s: f64) -> Option<(f64, f64)> {
        let level = |direction| self.branches.of(direction).as_ref()?.at(speed_rad_s);
        let (up, down) = (level(Direction::Up)?, level(Direction::Down)?);
        let shared = self.errors(Direction::Up).into_iter().zip(self.errors(Direction::Down));
        let variance: f64 = shared.map(|(up, down)| (up.b_nm - down.b_nm).powi(2)).sum();
        Some((up.b_nm - down.b_nm, up.se_nm.hypot(down.se_nm).hypot(variance.sqrt())))
    }
}

impl BranchFunctions {
    fn read(s: &Section<'_>) -> Option<Self> {
        let se = |half_width: Option<f64>| half_width.map_or(f64::INFINITY, |half| half / HALF_WIDTH);
        let level = |s: &Section<'_>| {
            let (speed_rad_s, b_nm) = (s.need("speed_rad_s").not_negative(), s.need("b_nm").number());
            let se_nm = se(s.may("half_width_nm").not_negative());
            Some(Level { speed_rad_s: speed_rad_s?, b_nm: b_nm?, se_nm })
        };
        let (a_nm, a_se_nm) = (s.need("a_nm").number(), se(s.may("a_half_width_nm").not_negative()));
        let (levels, common) = (s.need("b").sections(level), s.may("b_common_half_width_nm").not_negative());
        let error = |s: &Section<'_>| {
            let (a_nm, b_nm) = (s.need("a_nm").number(), s.need("b_nm").number());
            Some(SharedError { a_nm: a_nm? / HALF_WIDTH, b_nm: b_nm? / HALF_WIDTH })
        };
        let errors = s.may("shared").sections(error).unwrap_or_default();
        Some(Self { a_nm: a_nm?, a_se_nm, levels: levels?, common_se_nm: se(common), errors })
    }

    /// The level at `speed_rad_s`, drawn straight between those beside it; `None` beyond the slowest and the fastest.
    pub fn at(&self, speed_rad_s: f64) -> Option<Level> {
        /// Speeds that differ by less than this share are one.
        const SAME: f64 = 1e-3;
        let near = |level: &&Level| (level.speed_rad_s - speed_rad_s).abs() <= SAME * speed_rad_s;
        if let Some(level) = self.levels.iter().find(near) {
            return Some(*level);
        }
        let [before, after] = self.levels.windows(2).find_map(|pair| {
            let inside = (pair[0].speed_rad_s..=pair[1].speed_rad_s).contains(&speed_rad_s);
            inside.then_some([pair[0], pair[1]])
        })?;
        // Friction bends as the logarithm of speed does.
        let share = (speed_rad_s / before.speed_rad_s).ln() / (after.speed_rad_s / before.speed_rad_s).ln();
        let between = |a: f64, b: f64| a + share * (b - a);
        let se_nm = ((1.0 - share) * before.se_nm).hypot(share * after.se_nm);
        Some(Level { speed_rad_s, b_nm: between(before.b_nm, after.b_nm), se_nm })
    }
}
