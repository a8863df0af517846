//! Exact rationals: reading, comparing, the canonical text. No f64 appears here; see `print`.
#![deny(clippy::float_arithmetic, clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]

use std::cmp::Ordering;

use num_bigint::{BigInt, BigUint, Sign};
use num_traits::{One, Zero};

use crate::error::{Error, ErrorKind};
pub use crate::print::{
    decimal_text, exact_text, f64_above, f64_below, lower_text, nearest_text, rational_from_f64, upper_text,
};

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
/// The most JSON arrays and objects inside one another.
pub const MAX_NESTING: usize = 16;

/// The error for a limit that is passed: `what` is found, at most `most` (the constant `name`) is read.
pub(crate) fn over_limit(what: impl std::fmt::Display, most: usize, name: &str) -> Error {
    Error::new(ErrorKind::Limit, format!("{what}; the limit {name} is {most}"))
}

/// The start of a text from outside, quoted and made harmless, for messages.
pub(crate) fn excerpt(text: &str) -> String {
    let start: String = text.chars().take(40).collect();
    let dots = if start.len() < text.len() { "..." } else { "" };
    format!("{start:?}{dots}")
}

/// Reads the rational that `text` spells, exactly: `[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?`, of which the
/// JSON numbers are a part, or `-?\d+/\d+`. No spaces. The result is in lowest terms.
///
/// # Errors
/// [`ErrorKind::Number`] for any other text and for the denominator 0; [`ErrorKind::Limit`] beyond
/// [`MAX_DIGITS`] or [`MAX_EXPONENT`], found before memory is taken.
///
/// ```
/// use tubecert::{error::ErrorKind, number::parse_rational};
/// assert_eq!(parse_rational("-.25e1").unwrap(), parse_rational("-5/2").unwrap());
/// assert_eq!(parse_rational("1/0").unwrap_err().kind, ErrorKind::Number);
/// assert_eq!(parse_rational("1e5001").unwrap_err().kind, ErrorKind::Limit);
/// ```
pub fn parse_rational(text: &str) -> Result<Rational, Error> {
    match text.split_once('/') {
        Some((numerator, denominator)) => parse_fraction(text, numerator, denominator),
        None => parse_decimal(text),
    }
}

fn parse_fraction(text: &str, numerator: &str, denominator: &str) -> Result<Rational, Error> {
    let (sign, numerator) = match numerator.strip_prefix('-') {
        Some(rest) => (Sign::Minus, rest),
        None => (Sign::Plus, numerator),
    };
    if numerator.is_empty() || denominator.is_empty() || !all_digits(numerator) || !all_digits(denominator) {
        return Err(not_a_number(text));
    }
    limit_digits(numerator.len() + denominator.len())?;
    let (numerator, denominator) = (whole_number(numerator, text)?, whole_number(denominator, text)?);
    if denominator.is_zero() {
        return Err(Error::new(ErrorKind::Number, format!("{} has the denominator 0", excerpt(text)))
            .help("write a fraction whose denominator is not 0"));
    }
    Ok(Rational::new(BigInt::from_biguint(sign, numerator), denominator.into()))
}

fn parse_decimal(text: &str) -> Result<Rational, Error> {
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, Some(exponent)),
        None => (text, None),
    };
    let (sign, mantissa) = split_sign(mantissa);
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let count = whole.len() + fraction.len();
    let (exponent_sign, exponent) = split_sign(exponent.unwrap_or("0"));
    if count == 0 || exponent.is_empty() || !all_digits(whole) || !all_digits(fraction) || !all_digits(exponent) {
        return Err(not_a_number(text));
    }
    limit_digits(count)?;
    // More digits than an i64 holds are beyond the limit as well.
    let size = match exponent.trim_start_matches('0') {
        "" => Some(0),
        digits => digits.parse::<i64>().ok().filter(|size| *size <= MAX_EXPONENT as i64),
    };
    let Some(size) = size else {
        return Err(over_limit(format_args!("the exponent {}", excerpt(exponent)), MAX_EXPONENT, "MAX_EXPONENT"));
    };
    let digits = whole_number(&[whole, fraction].concat(), text)?;
    let shift = if exponent_sign == Sign::Minus { -size } else { size } - fraction.len() as i64;
    Ok(decimal(sign, digits, shift))
}

/// `sign digits 10^shift` in lowest terms. Only the primes 2 and 5 can cancel, so no gcd is needed.
fn decimal(sign: Sign, mut digits: BigUint, shift: i64) -> Rational {
    let power = shift.unsigned_abs();
    if digits.is_zero() {
        return Rational::zero();
    }
    if shift >= 0 {
        return Rational::from_integer(BigInt::from_biguint(sign, digits * ten_to(power)));
    }
    let twos = digits.trailing_zeros().unwrap_or(0).min(power);
    digits >>= twos;
    let fives = divide_out_fives(&mut digits, power);
    let denominator = BigUint::from(5_u8).pow((power - fives) as u32) << (power - twos);
    Rational::new_raw(BigInt::from_biguint(sign, digits), denominator.into())
}

/// Divides `n`, not 0, by 5 as often as it goes, at most `most` times, and returns how often it went.
pub(crate) fn divide_out_fives(n: &mut BigUint, most: u64) -> u64 {
    let mut fives = 0;
    // 5^27 is the greatest power in a u64: most of the way in strides of 27.
    for (divisor, stride) in [(5_u64.pow(27), 27), (5, 1)] {
        while fives + stride <= most && (&*n % divisor).is_zero() {
            *n /= divisor;
            fives += stride;
        }
    }
    fives
}

fn ten_to(power: u64) -> BigUint {
    BigUint::from(10_u8).pow(power as u32)
}

fn all_digits(text: &str) -> bool {
    text.bytes().all(|byte| byte.is_ascii_digit())
}

fn split_sign(text: &str) -> (Sign, &str) {
    match text.strip_prefix('-') {
        Some(rest) => (Sign::Minus, rest),
        None => (Sign::Plus, text.strip_prefix('+').unwrap_or(text)),
    }
}

fn limit_digits(count: usize) -> Result<(), Error> {
    if count > MAX_DIGITS {
        return Err(over_limit(format_args!("a number of {count} digits"), MAX_DIGITS, "MAX_DIGITS"));
    }
    Ok(())
}

fn whole_number(digits: &str, text: &str) -> Result<BigUint, Error> {
    BigUint::parse_bytes(digits.as_bytes(), 10).ok_or_else(|| not_a_number(text))
}

fn not_a_number(text: &str) -> Error {
    Error::new(ErrorKind::Number, format!("{} is not a number", excerpt(text)))
        .help("write a decimal such as -1.5e-3 or, in quotes, a fraction such as \"1/3\"")
}

/// The order of `a` and `b`, exactly, by one cross-multiplication. Denominators must be positive.
#[must_use]
pub fn compare(a: &Rational, b: &Rational) -> Ordering {
    (a.numer() * b.denom()).cmp(&(b.numer() * a.denom()))
}

/// Whether `a` = `b`. Both must be in lowest terms with a positive denominator.
#[must_use]
pub fn same(a: &Rational, b: &Rational) -> bool {
    a.numer() == b.numer() && a.denom() == b.denom()
}

/// `x` as `p` or `p/q` in lowest terms, the canonical text. Of any length, and `parse_rational` reads it back
/// if its digits are within [`MAX_DIGITS`]. `x` must be in lowest terms with a positive denominator.
#[must_use]
pub fn to_fraction_text(x: &Rational) -> String {
    if x.denom().is_one() { x.numer().to_string() } else { format!("{}/{}", x.numer(), x.denom()) }
}
