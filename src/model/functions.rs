//! What an identification knows well even where single parameters trade off: A, and B(v) at the speeds that it saw.
//!
//! Parameters of (19) can differ widely between two fits of the same friction; A and B(v) cannot. Comparisons rest on them.

use super::{Both, Direction};
use crate::document::Section;
use crate::numerics::statistics::HALF_WIDTH;
use serde_json::{Map, Value, json};

/// A and B(v) of both directions, each with what is known of it; `None` where nobody identified them.
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
        let branch = |of: &BranchFunctions| {
            json!({
                "a_nm": of.a_nm,
                "a_half_width_nm": half(of.a_se_nm),
                "b": of.levels.iter().map(level).collect::<Vec<Value>>(),
                "b_common_half_width_nm": half(of.common_se_nm),
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
        Some(Self { a_nm: a_nm?, a_se_nm, levels: levels?, common_se_nm: se(common) })
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
