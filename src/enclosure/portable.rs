//! Intervals from round-to-nearest `f64` alone: no rounding mode, no FMA, no target feature.
//!
//! Each bound is computed to nearest, together with the sign of `exact - nearest` where that is known, from the
//! error-free transformations of Knuth (`TwoSum`) and Dekker (`TwoProduct`); see Muller et al., *Handbook of
//! Floating-Point Arithmetic*, 2nd ed., chapter 4. The bound then moves one step outward only if it must. Where
//! the sign is not known (a factor, quotient or root beyond `1e±144`) it always moves.

use std::ops::{Add, Div, Mul, Sub};

/// A nonempty closed interval `[lo, hi]` of reals; see the [module above](super).
#[derive(Clone, Copy)]
pub struct Interval {
    lo: f64,
    hi: f64,
}

shared_methods!();

impl Interval {
    /// `[-inf, +inf]`.
    pub const ENTIRE: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };

    /// `[lo, hi]`, with `lo <= hi`, `lo < inf`, `hi > -inf`.
    ///
    /// Anything else panics in a debug build and gives [`ENTIRE`](Self::ENTIRE) in a release build.
    pub fn new(lo: f64, hi: f64) -> Self {
        let valid = lo <= hi && lo < f64::INFINITY && hi > f64::NEG_INFINITY;
        debug_assert!(valid, "not an interval: [{lo:?}, {hi:?}]");
        // Adding +0.0 turns -0.0 into +0.0.
        if valid { Self { lo: lo + 0.0, hi: hi + 0.0 } } else { Self::ENTIRE }
    }

    /// The lower bound, never `+inf`.
    pub fn lo(self) -> f64 {
        self.lo
    }

    /// The upper bound, never `-inf`.
    pub fn hi(self) -> f64 {
        self.hi
    }

    /// `{x^2}`, within one step of tight, never below zero.
    pub fn sqr(self) -> Self {
        let x = self.abs();
        let (lo, lo_err) = two_product(x.lo, x.lo);
        let (hi, hi_err) = two_product(x.hi, x.hi);
        Self::new(lower(lo, lo_err), upper(hi, hi_err))
    }

    /// `{sqrt(x) : x >= 0}`, within one step of tight, never below zero. [`ENTIRE`](Self::ENTIRE) if `hi < 0`.
    pub fn sqrt(self) -> Self {
        if self.hi < 0.0 {
            return Self::ENTIRE;
        }
        let (lo, lo_err) = root(self.lo.max(0.0));
        let (hi, hi_err) = root(self.hi);
        Self::new(lower(lo, lo_err), upper(hi, hi_err))
    }

    /// The hull of `f` at the four corners; `f` gives the nearest value and the sign of its error.
    fn corners(self, rhs: Self, f: fn(f64, f64) -> (f64, f64)) -> Self {
        let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
        for (x, y) in [(self.lo, rhs.lo), (self.lo, rhs.hi), (self.hi, rhs.lo), (self.hi, rhs.hi)] {
            let (nearest, err) = f(x, y);
            lo = lo.min(lower(nearest, err));
            hi = hi.max(upper(nearest, err));
        }
        Self::new(lo, hi)
    }
}

impl Add for Interval {
    type Output = Self;

    /// `{x + y}`, tight.
    fn add(self, rhs: Self) -> Self {
        let (lo, lo_err) = two_sum(self.lo, rhs.lo);
        let (hi, hi_err) = two_sum(self.hi, rhs.hi);
        Self::new(lower(lo, lo_err), upper(hi, hi_err))
    }
}

impl Sub for Interval {
    type Output = Self;

    /// `{x - y}`, tight.
    fn sub(self, rhs: Self) -> Self {
        self + -rhs
    }
}

impl Mul for Interval {
    type Output = Self;

    /// `{x y}`, within one step of tight.
    fn mul(self, rhs: Self) -> Self {
        self.corners(rhs, two_product)
    }
}

impl Div for Interval {
    type Output = Self;

    /// `{x / y}`, within one step of tight; [`ENTIRE`](Self::ENTIRE) if `rhs` contains zero.
    fn div(self, rhs: Self) -> Self {
        if rhs.contains(0.0) { Self::ENTIRE } else { self.corners(rhs, quotient) }
    }
}

/// A lower bound of the exact value, from its nearest `f64` and the sign of `exact - nearest`.
///
/// An error that is infinite or NaN says nothing. From an overflow to `+inf` this steps back to `f64::MAX`.
pub(super) fn lower(nearest: f64, err: f64) -> f64 {
    if (0.0..f64::INFINITY).contains(&err) { nearest } else { nearest.next_down() }
}

/// An upper bound of the exact value; mirror of [`lower`].
fn upper(nearest: f64, err: f64) -> f64 {
    -lower(-nearest, -err)
}

/// `x + y` and its rounding error, exact unless the sum overflows; then the error is not finite.
fn two_sum(x: f64, y: f64) -> (f64, f64) {
    // the larger first: then no difference overflows
    let (x, y) = if x.abs() < y.abs() { (y, x) } else { (x, y) };
    let sum = x + y;
    let y_part = sum - x;
    (sum, (x - (sum - y_part)) + (y - y_part))
}

/// Whether products and remainders of such numbers neither overflow nor lose a bit to underflow.
///
/// An ulp of `1e-144` is `2^-531`, so every partial product is a multiple of `2^-1062`, and at most `2^958`.
fn is_moderate(x: f64) -> bool {
    (1e-144..=1e144).contains(&x.abs())
}

/// `x = high + low` with at most 26 bits each (Veltkamp).
fn split(x: f64) -> (f64, f64) {
    let c = 134_217_729.0 * x; // 2^27 + 1
    let high = c - (c - x);
    (high, x - high)
}

/// `x y` with `0 * inf = 0`, and its rounding error: exact (Dekker), or only its sign, or NaN for unknown.
fn two_product(x: f64, y: f64) -> (f64, f64) {
    if x == 0.0 || y == 0.0 {
        return (0.0, 0.0);
    }
    let product = x * y;
    if product == 0.0 {
        return (product, product.signum()); // Underflow: the sign of the zero is the sign of the product.
    }
    if !(is_moderate(x) && is_moderate(y)) {
        return (product, f64::NAN);
    }
    let ((xh, xl), (yh, yl)) = (split(x), split(y));
    (product, ((xh * yh - product) + xh * yl + xl * yh) + xl * yl)
}

/// `x / y` for `y != 0` with `inf / inf = 0`, and the sign of its rounding error or NaN for unknown.
///
/// The sign is that of the remainder `x - q y` over `y`. The first difference is exact (Sterbenz), and a rounded
/// difference has the right sign; NaN from [`two_product`] stays NaN. There `q y` cannot underflow to zero, being
/// near `x`. Zero for `inf / inf` is right for corners: another corner supplies the infinity.
fn quotient(x: f64, y: f64) -> (f64, f64) {
    if x == 0.0 || y.is_infinite() {
        return (0.0, 0.0);
    }
    let q = x / y;
    if q == 0.0 {
        return (q, q.signum());
    }
    let (product, err) = two_product(q, y);
    (q, ((x - product) - err) * y.signum())
}

/// `sqrt(x)` for `x >= 0`, and the sign of its rounding error or NaN for unknown; as in [`quotient`].
fn root(x: f64) -> (f64, f64) {
    let root = x.sqrt();
    let (product, err) = two_product(root, root);
    (root, (x - product) - err)
}
