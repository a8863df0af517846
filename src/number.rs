//! Exact rationals: reading, comparing, the canonical text. No floating point appears here; see `print`.
#![deny(clippy::float_arithmetic, clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]

use num_bigint::BigInt;
use num_traits::Zero;

use crate::error::{Error, reading};
pub use crate::print::*;

/// An exact rational of any size. All of this crate's are in lowest terms with a positive denominator.
///
/// Compare two that come from outside with [`compare`] and [`same`]: the operators of `num-rational` expand
/// continued fractions by recursion, which numbers made for the purpose can drive through the stack.
pub type Rational = num_rational::BigRational;

/// The greatest absolute value of a written exponent.
pub const MAX_EXPONENT: usize = 5_000;
/// The most digits in one number, the exponent's own not counted; of `p/q` those of `p` and `q` together.
pub const MAX_DIGITS: usize = 2_000;
/// The greatest degree of a curve.
pub const MAX_DEGREE: usize = 64;
/// The most control points of a curve.
pub const MAX_CONTROL_POINTS: usize = 1_000_000;
/// The most bytes in a file.
pub const MAX_BYTES: usize = 256 << 20;

/// Reads the rational that `text` spells, exactly: `[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?`, of which the
/// JSON numbers are a part, or `-?\d+/\d+`. No spaces. The result is in lowest terms.
///
/// # Errors
/// [`Number`](crate::ErrorKind::Number) for any other text and for the denominator 0; beyond [`MAX_DIGITS`] or
/// [`MAX_EXPONENT`] [`Limit`](crate::ErrorKind::Limit), before memory is taken for the number.
pub fn parse_rational(text: &str) -> Result<Rational, Error> {
    spelled(text).ok_or_else(|| reading::not_a_number(text))
}

fn spelled(text: &str) -> Option<Rational> {
    let unsigned = text.strip_prefix(['-', '+']).unwrap_or(text);
    let number = match unsigned.split_once('/') {
        Some((p, q)) if !text.starts_with('+') && p.len() + q.len() <= MAX_DIGITS => {
            Rational::new(natural(p)?, natural(q).filter(|q| !q.is_zero())?)
        }
        _ => {
            let (mantissa, exponent) = unsigned.split_once(['e', 'E']).unwrap_or((unsigned, "0"));
            let (whole, places) = mantissa.split_once('.').unwrap_or((mantissa, ""));
            let power = exponent.parse().ok().filter(|power: &isize| power.unsigned_abs() <= MAX_EXPONENT)?;
            scaled(natural(&[whole, places].concat())?, power - places.len() as isize)
        }
    };
    Some(if text.starts_with('-') { -number } else { number })
}

/// What `text` spells, if it is digits, not too many, and nothing else.
fn natural(text: &str) -> Option<BigInt> {
    if text.len() <= MAX_DIGITS && text.bytes().all(|byte| byte.is_ascii_digit()) { text.parse().ok() } else { None }
}

/// `digits 10^power` in lowest terms. Only 2 and 5 can cancel, and 5^27 is the greatest power of 5 in a u64.
fn scaled(digits: BigInt, power: isize) -> Rational {
    let (up, down) = (power.max(0) as u32, power.min(0).unsigned_abs() as u32);
    let mut digits = digits * BigInt::from(10_u8).pow(up);
    let twos = digits.trailing_zeros().unwrap_or(u64::MAX).min(down.into());
    digits >>= twos;
    let mut fives = down;
    for stride in [27, 1] {
        while fives >= stride && (&digits % 5_u64.pow(stride)).is_zero() {
            digits /= 5_u64.pow(stride);
            fives -= stride;
        }
    }
    Rational::new_raw(digits, BigInt::from(5_u8).pow(fives) << (u64::from(down) - twos))
}

/// The order of `a` and `b`, exactly, by one cross-multiplication. Denominators must be positive.
#[must_use]
pub fn compare(a: &Rational, b: &Rational) -> std::cmp::Ordering {
    (a.numer() * b.denom()).cmp(&(b.numer() * a.denom()))
}

/// Whether `a` = `b`. Both must be in lowest terms with a positive denominator.
#[must_use]
pub fn same(a: &Rational, b: &Rational) -> bool {
    a.numer() == b.numer() && a.denom() == b.denom()
}
