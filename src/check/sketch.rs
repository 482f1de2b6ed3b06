//! A digest of one column that distinguishes rounding from change, and identifies a simple change (scale, offset).
//!
//! A hash turns over with the last bit of any sample, and what another machine's rounding or other text for the same number
//! does to it cannot be told from a new recording. So a column x of n samples is held by sums s_k = Σ w_ki x_i / √n instead,
//! w_0i = 1 and the others ±1 by chance (Johnson and Lindenstrauss, Contemporary Mathematics 26:189, 1984): rounding by a share
//! ε of the values moves them by about ε times the column's root mean square, one changed sample by that change over √n. The
//! sums are linear in x: a column that was scaled or shifted shows the same factor and offset in all of them.

/// Sums kept of a column.
pub const SUMS: usize = 7;
/// Sums that differ by less than this share of the root mean square are those of one column: well above what rounding of
/// doubles does (1e-12 and less), well below what any sensor resolves.
const SAME: f64 = 1e-9;
/// A factor and an offset explain a change that they leave less than this share of: text with few decimals differs so.
const EXPLAINED: f64 = 1e-4;

/// What is kept of a column, in its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sketch {
    /// Root mean square.
    pub rms: f64,
    /// Weighted sums over √n.
    pub sums: [f64; SUMS],
}

/// A column as another one times a factor, plus an offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relation {
    /// The factor.
    pub times: f64,
    /// The offset, in the column's unit.
    pub plus: f64,
}

impl Sketch {
    /// Of `values`; all zero of nothing.
    pub fn of(values: &[f64]) -> Self {
        let n = (values.len().max(1) as f64).sqrt();
        let mut sums = [0.0; SUMS];
        let mut squares = 0.0;
        for (at, value) in values.iter().enumerate() {
            squares += value * value;
            let bits = mixed(at as u64);
            for (k, sum) in sums.iter_mut().enumerate() {
                *sum += if k > 0 && bits >> k & 1 == 1 { -value } else { *value };
            }
        }
        Self { rms: squares.sqrt() / n, sums: sums.map(|sum| sum / n) }
    }

    /// Whether both are of the same column, except for rounding.
    pub fn is_same(&self, other: &Self) -> bool {
        let near = SAME * self.rms.max(other.rms);
        (self.rms - other.rms).abs() <= near && self.sums.iter().zip(other.sums).all(|(a, b)| (a - b).abs() <= near)
    }

    /// How a column of this sketch came of one with the sketch `before`, both of `rows` samples, if a factor and an offset
    /// explain it.
    pub fn relation(&self, before: &Self, rows: usize) -> Option<Relation> {
        let ones = Self::of(&vec![1.0; rows]).sums;
        let dot = |a: &[f64; SUMS], b: &[f64; SUMS]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let (xx, xo, oo) = (dot(&before.sums, &before.sums), dot(&before.sums, &ones), dot(&ones, &ones));
        let (xy, oy) = (dot(&before.sums, &self.sums), dot(&ones, &self.sums));
        let determinant = xx * oo - xo * xo;
        let (times, plus) = ((xy * oo - oy * xo) / determinant, (xx * oy - xo * xy) / determinant);
        let left = |times: f64, plus: f64| {
            let of = |k: usize| self.sums[k] - times * before.sums[k] - plus * ones[k];
            (0..SUMS).map(|k| of(k) * of(k)).sum::<f64>().sqrt()
        };
        let explains = |times: f64, plus: f64| left(times, plus) <= EXPLAINED * left(1.0, 0.0);
        // The simpler of those that explain it.
        let (scale, shift) = (xy / xx, (oy - xo) / oo);
        [(scale, 0.0), (1.0, shift), (times, plus)]
            .into_iter()
            .find(|(times, plus)| times.is_finite() && plus.is_finite() && explains(*times, *plus))
            .map(|(times, plus)| Relation { times, plus })
    }
}

/// A number whose bits look like chance (SplitMix64: Steele, Lea and Flood, OOPSLA 2014).
fn mixed(number: u64) -> u64 {
    let mut z = number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
