//! Outward-rounded intervals of `f64`: the fast, still rigorous number type.
//!
//! An [`Interval`] is `[lo, hi] = {x real : lo <= x <= hi}`, never empty, never NaN; `lo` may be `-inf`, `hi` may
//! be `+inf`. Every operation `f` obeys inclusion: `x in X, y in Y` implies `f(x, y) in f(X, Y)`, through overflow
//! and underflow. "Tight" means the smallest `f64` interval that encloses the exact range. A zero bound is `+0.0`.
//!
//! | backend | where | how |
//! |---|---|---|
//! | `native` | x86-64 built with AVX and FMA | `inari`, directed rounding, tight |
//! | [`portable`] | everywhere | round to nearest, exact error tests, at most one step wider |
//!
//! `native` trusts the processor's rounding mode; [`rounding_is_sound`] tells whether that trust is deserved.

#[cfg(all(target_arch = "x86", not(target_feature = "sse2")))]
compile_error!("x87 arithmetic keeps excess precision: intervals need SSE2");

use num_bigint::{BigInt, BigUint};
use num_traits::{ToPrimitive, Zero};
use std::hint::black_box;

/// What both backends share: everything that follows from `new`, `lo`, `hi` without rounding of its own.
macro_rules! shared_methods {
    () => {
        impl Interval {
            /// `[x, x]`; `x` must be finite.
            pub fn point(x: f64) -> Self {
                Self::new(x, x)
            }

            /// An enclosure of `n`, tight.
            pub fn from_bigint(n: &num_bigint::BigInt) -> Self {
                Self::from_ratio(n, &1.into())
            }

            /// An enclosure of `num / den` of any magnitude, tight. Panics if `den` is zero.
            pub fn from_ratio(num: &num_bigint::BigInt, den: &num_bigint::BigInt) -> Self {
                let (lo, hi) = super::ratio_bounds(num, den);
                Self::new(lo, hi)
            }

            /// A finite point of the interval, near its middle if both bounds are finite.
            pub fn mid(self) -> f64 {
                self.lo().max(f64::MIN).midpoint(self.hi().min(f64::MAX))
            }

            /// `max {|x|}`, exact.
            pub fn mag(self) -> f64 {
                self.lo().abs().max(self.hi().abs())
            }

            /// `{|x|}`, exact.
            pub fn abs(self) -> Self {
                if self.lo() >= 0.0 {
                    self
                } else if self.hi() <= 0.0 {
                    -self
                } else {
                    Self::new(0.0, self.mag())
                }
            }

            /// The smallest interval that contains both, exact.
            pub fn hull(self, other: Self) -> Self {
                Self::new(self.lo().min(other.lo()), self.hi().max(other.hi()))
            }

            /// `{min(x, y)}`, exact.
            pub fn min(self, other: Self) -> Self {
                Self::new(self.lo().min(other.lo()), self.hi().min(other.hi()))
            }

            /// `{max(x, y)}`, exact.
            pub fn max(self, other: Self) -> Self {
                Self::new(self.lo().max(other.lo()), self.hi().max(other.hi()))
            }

            /// `{x * 2^k}`, tight: exact short of overflow and underflow.
            pub fn scale2(self, k: i32) -> Self {
                Self::new(super::scale_down(self.lo(), k), super::scale_up(self.hi(), k))
            }

            /// Whether `lo <= x <= hi`; false for NaN.
            pub fn contains(self, x: f64) -> bool {
                self.lo() <= x && x <= self.hi()
            }

            /// Whether every point is `> 0`.
            pub fn is_positive(self) -> bool {
                self.lo() > 0.0
            }

            /// Whether every point is `< 0`.
            pub fn is_negative(self) -> bool {
                self.hi() < 0.0
            }
        }

        impl std::ops::Neg for Interval {
            type Output = Self;

            /// `{-x}`, exact.
            fn neg(self) -> Self {
                Self::new(-self.hi(), -self.lo())
            }
        }

        impl std::fmt::Debug for Interval {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, "[{:?}, {:?}]", self.lo(), self.hi())
            }
        }
    };
}

#[cfg(all(target_arch = "x86_64", target_feature = "avx", target_feature = "fma"))]
mod native;
pub mod portable;

#[cfg(all(target_arch = "x86_64", target_feature = "avx", target_feature = "fma"))]
pub use native::Interval;
#[cfg(not(all(target_arch = "x86_64", target_feature = "avx", target_feature = "fma")))]
pub use portable::Interval;

/// Whether the arithmetic of [`Interval`] rounds outward on this machine, now.
///
/// Emulators (Valgrind among them) ignore the rounding mode without a word. Inexact results then collapse to
/// points, and this returns false: nothing may be certified. Call it once at the start.
pub fn rounding_is_sound() -> bool {
    let p = |x: f64| Interval::point(black_box(x));
    // Nearest rounding errs upward in some of these and downward in others, so neither bound can be lucky in all.
    let inexact = [
        (p(1.0) / p(3.0), 1.0 / 3.0),
        (p(-2.0) / p(3.0), -2.0 / 3.0),
        (p(0.1) + p(0.2), 0.1 + 0.2),
        (p(1.0) - p(1e-30), 1.0),
        (p(0.1) * p(0.1), 0.1 * 0.1),
        (p(-0.1) * p(0.7), -0.1 * 0.7),
        (p(0.1).sqr(), 0.1 * 0.1),
        (p(2.0).sqrt(), std::f64::consts::SQRT_2),
    ];
    inexact.iter().all(|&(x, nearest)| {
        let x = black_box(x);
        x.lo() < x.hi() && x.hi() <= x.lo().next_up().next_up() && x.contains(nearest)
    })
}

/// The `f64` neighbours of `num / den`: the largest below or equal, the smallest above or equal.
fn ratio_bounds(num: &BigInt, den: &BigInt) -> (f64, f64) {
    assert!(!den.is_zero(), "a ratio needs a nonzero denominator");
    if num.is_zero() {
        return (0.0, 0.0);
    }
    let (lo, hi) = magnitude_bounds(num.magnitude(), den.magnitude());
    if num.sign() == den.sign() { (lo, hi) } else { (-hi, -lo) }
}

/// [`ratio_bounds`] for `n, d > 0`: a 62 or 63 bit integer quotient, cut to 53 bits, then scaled.
fn magnitude_bounds(n: &BigUint, d: &BigUint) -> (f64, f64) {
    // 2^(e-1) < n/d < 2^(e+1)
    let e = n.bits() as i64 - d.bits() as i64;
    if e > 1026 {
        return (f64::MAX, f64::INFINITY);
    }
    if e < -1080 {
        return (0.0, 0.0_f64.next_up());
    }
    // n/d = (q + rem/den) 2^-shift, with 2^61 <= q < 2^63
    let shift = 62 - e;
    let (num, den) =
        if shift >= 0 { (n << shift.unsigned_abs(), d.clone()) } else { (n.clone(), d << shift.unsigned_abs()) };
    let q = &num / &den;
    let exact_quotient = &q * &den == num;
    let q = q.to_u64().expect("quotient below 2^63");
    let cut = 11 - q.leading_zeros();
    let floor = q >> cut;
    let exact = exact_quotient && floor << cut == q;
    let ceil = if exact { floor } else { floor + 1 };
    let k = cut as i32 - shift as i32;
    // Both are at most 2^53, so the conversions are exact.
    (scale_down(floor as f64, k), scale_up(ceil as f64, k))
}

/// `x * 2^k` rounded to `-inf`, except that nothing finite becomes infinite upward; `x` is not `+inf`.
///
/// Steps of at most `2^±1000`; rounding down twice is rounding down once, so the result is tight.
fn scale_down(mut x: f64, k: i32) -> f64 {
    let mut k = k.clamp(-3000, 3000);
    while k != 0 {
        let step = k.clamp(-1000, 1000);
        let factor = f64::from_bits(((1023 + step) as u64) << 52);
        let y = x * factor;
        // Undoing the scaling is exact unless `y` has overflowed.
        x = portable::lower(y, x - y / factor);
        k -= step;
    }
    x
}

/// `x * 2^k` rounded to `+inf`; mirror of [`scale_down`].
fn scale_up(x: f64, k: i32) -> f64 {
    -scale_down(-x, k)
}
