//! Arrays filled in place: one of numbers with slopes is too large to be moved about.

/// Sets each of `slots` to `of` its index.
#[inline(always)]
pub fn fill<T, const N: usize>(slots: &mut [T; N], of: impl Fn(usize) -> T) {
    slots.iter_mut().enumerate().for_each(|(i, slot)| *slot = of(i));
}
