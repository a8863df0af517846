//! Intervals by directed rounding: a thin coat over `inari`, the only file that names it.
//!
//! It differs from IEEE 1788 as the other backend does: no empty interval, division by anything that contains
//! zero gives [`Interval::ENTIRE`].

use std::ops::{Add, Div, Mul, Sub};

/// A nonempty closed interval `[lo, hi]` of reals; see the [module above](super).
#[derive(Clone, Copy)]
pub struct Interval(inari::Interval);

shared_methods!();

impl Interval {
    /// `[-inf, +inf]`.
    pub const ENTIRE: Self = Self(inari::Interval::ENTIRE);

    /// `[lo, hi]`, with `lo <= hi`, `lo < inf`, `hi > -inf`.
    ///
    /// Anything else panics in a debug build and gives [`ENTIRE`](Self::ENTIRE) in a release build.
    pub fn new(lo: f64, hi: f64) -> Self {
        let bounds = inari::Interval::try_from((lo, hi));
        debug_assert!(bounds.is_ok(), "not an interval: [{lo:?}, {hi:?}]");
        bounds.map_or(Self::ENTIRE, Self)
    }

    /// The lower bound, never `+inf`.
    pub fn lo(self) -> f64 {
        self.0.inf() + 0.0 // inari gives -0.0
    }

    /// The upper bound, never `-inf`.
    pub fn hi(self) -> f64 {
        self.0.sup()
    }

    /// `{x^2}`, tight.
    pub fn sqr(self) -> Self {
        Self(self.0.sqr())
    }

    /// `{sqrt(x) : x >= 0}`, tight. [`ENTIRE`](Self::ENTIRE) if `hi < 0`.
    pub fn sqrt(self) -> Self {
        if self.is_negative() { Self::ENTIRE } else { Self(self.0.sqrt()) }
    }
}

impl Add for Interval {
    type Output = Self;

    /// `{x + y}`, tight.
    fn add(self, rhs: Self) -> Self {
        Self(self.0 + rhs.0)
    }
}

impl Sub for Interval {
    type Output = Self;

    /// `{x - y}`, tight.
    fn sub(self, rhs: Self) -> Self {
        Self(self.0 - rhs.0)
    }
}

impl Mul for Interval {
    type Output = Self;

    /// `{x y}`, tight.
    fn mul(self, rhs: Self) -> Self {
        Self(self.0 * rhs.0)
    }
}

impl Div for Interval {
    type Output = Self;

    /// `{x / y}`, tight; [`ENTIRE`](Self::ENTIRE) if `rhs` contains zero.
    fn div(self, rhs: Self) -> Self {
        if rhs.contains(0.0) { Self::ENTIRE } else { Self(self.0 / rhs.0) }
    }
}
