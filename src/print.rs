//! How numbers are shown: f64 bounds in a known direction, and text. Outside the trust line; nothing here decides by
//! floating point either: an f64 appears only as the dyadic rational it is.

use num_bigint::{BigInt, BigUint, Sign};
use num_traits::{One, Zero};

pub(crate) use crate::error::reading::{excerpt, over_limit};
use crate::number::{MAX_DIGITS, MAX_EXPONENT, Rational, parse_rational, same};

/// A number for messages: cut if it is long.
pub(crate) fn shown(number: &Rational) -> String {
    let text = exact_text(number);
    if text.len() <= 40 { text } else { excerpt(&text) }
}

/// The dyadic rational that `x` is, exactly and in lowest terms; `None` for NaN and the infinities.
///
/// ```
/// use tubecert::number::{rational_from_f64, to_fraction_text};
/// assert_eq!(to_fraction_text(&rational_from_f64(-0.375).unwrap()), "-3/8");
/// assert!(rational_from_f64(f64::NAN).is_none());
/// ```
#[must_use]
pub fn rational_from_f64(x: f64) -> Option<Rational> {
    if !x.is_finite() {
        return None;
    }
    let sign = if x.is_sign_negative() { Sign::Minus } else { Sign::Plus };
    let (field, fraction) = ((x.to_bits() >> 52) & 0x7ff, x.to_bits() & ((1 << 52) - 1));
    // |x| = mantissa * 2^(field - 1075), the fields 0 (subnormal, no hidden bit) and 1 having the same scale.
    let mantissa = if field == 0 { fraction } else { fraction | 1 << 52 };
    if mantissa == 0 {
        return Some(Rational::zero());
    }
    let field = field.max(1);
    let integer = |n: BigUint| BigInt::from_biguint(sign, n);
    if field >= 1075 {
        return Some(Rational::from_integer(integer(BigUint::from(mantissa) << (field - 1075))));
    }
    let power = 1075 - field;
    let twos = u64::from(mantissa.trailing_zeros()).min(power);
    Some(Rational::new_raw(integer(BigUint::from(mantissa >> twos)), BigInt::one() << (power - twos)))
}

/// The greatest f64 that is <= `x`: `-inf` if `x < -f64::MAX`, `f64::MAX` if `x > f64::MAX`. Zero is +0.
/// One integer division, for `x` of any size.
#[must_use]
pub fn f64_below(x: &Rational) -> f64 {
    let (size, exact) = truncate(x.numer().magnitude(), x.denom().magnitude());
    match x.numer().sign() {
        Sign::Minus if exact => -size,
        Sign::Minus => -size.next_up(),
        Sign::NoSign | Sign::Plus => size,
    }
}

/// The least f64 that is >= `x`: `inf` if `x > f64::MAX`, `-f64::MAX` if `x < -f64::MAX`. Zero is +0.
#[must_use]
pub fn f64_above(x: &Rational) -> f64 {
    let below = f64_below(&-x);
    if below == 0.0 { 0.0 } else { -below }
}

/// The greatest finite f64 that is <= n/d (d > 0), and whether it equals n/d.
fn truncate(n: &BigUint, d: &BigUint) -> (f64, bool) {
    if n.is_zero() {
        return (0.0, true);
    }
    // 2^(e-1) < n/d < 2^(e+1) for e = bits(n) - bits(d), so floor(n/d / 2^(e-53)) has 53 or 54 bits; no f64 is
    // finer than 2^-1074. Bit counts are far below 2^63: they are of numbers in memory.
    let mut scale = (n.bits() as i64 - d.bits() as i64 - 53).max(-1074);
    let (quotient, remainder) = if scale >= 0 {
        num_integer::Integer::div_rem(n, &(d << scale))
    } else {
        num_integer::Integer::div_rem(&(n << -scale), d)
    };
    let mut mantissa = quotient.iter_u64_digits().next().unwrap_or(0);
    let mut exact = remainder.is_zero();
    if mantissa >> 53 != 0 {
        exact &= mantissa & 1 == 0;
        mantissa >>= 1;
        scale += 1;
    }
    if scale > 971 {
        return (f64::MAX, false);
    }
    // mantissa 2^scale as bits: a hidden bit adds one to the exponent field; without one, scale = -1074.
    (f64::from_bits((((scale + 1074) as u64) << 52) + mantissa), exact)
}

/// A text that [`parse_rational`] reads back as exactly `x`, if there is one within the limits: a short decimal
/// if `x` is one, else `p/q`, else a long decimal. `x` must be in lowest terms with a positive denominator.
#[must_use]
pub fn exact_text(x: &Rational) -> String {
    let decimal = finite_decimal(x);
    if let Some((sign, digits, power)) = &decimal
        && digits.len() <= SHORT
        && power.unsigned_abs() <= MAX_EXPONENT as u64
    {
        return format!("{sign}{}", short_decimal(digits, *power, SHORT));
    }
    let fraction = to_fraction_text(x);
    if fraction.bytes().filter(u8::is_ascii_digit).count() <= MAX_DIGITS {
        return fraction;
    }
    match decimal {
        Some((sign, digits, power)) => format!("{sign}{}", long_decimal(&digits, power)),
        None => fraction,
    }
}

/// `x` as a JSON number, if it is a finite decimal: plain where that is not too long, else with an exponent.
#[must_use]
pub fn decimal_text(x: &Rational) -> Option<String> {
    let (sign, digits, power) = finite_decimal(x)?;
    Some(format!("{sign}{}", short_decimal(&digits, power, 400)))
}

/// The most significant digits for which a decimal is preferred to a fraction.
const SHORT: usize = 25;

/// `x` as `p` or `p/q` in lowest terms, the canonical text. Of any length, and [`parse_rational`] reads it back
/// if its digits are within [`MAX_DIGITS`]. `x` must be in lowest terms with a positive denominator.
#[must_use]
pub fn to_fraction_text(x: &Rational) -> String {
    x.to_string()
}

/// Divides `n`, not 0, by 5 as often as it goes, and returns how often it went.
fn divide_out_fives(n: &mut BigUint) -> u64 {
    let mut fives = 0;
    // 5^27 is the greatest power in a u64: most of the way in strides of 27.
    for (divisor, stride) in [(5_u64.pow(27), 27), (5, 1)] {
        while (&*n % divisor).is_zero() {
            *n /= divisor;
            fives += stride;
        }
    }
    fives
}

/// The sign, digits and power of ten of `x`, if `x` is a finite decimal; the digits do not end in 0 unless `x` = 0.
fn finite_decimal(x: &Rational) -> Option<(&'static str, String, i64)> {
    let mut rest = x.denom().magnitude().clone();
    let twos = rest.trailing_zeros()?;
    rest >>= twos;
    let fives = divide_out_fives(&mut rest);
    if !rest.is_one() {
        return None;
    }
    let power = twos.max(fives);
    let to_tens = BigUint::from(5_u8).pow(u32::try_from(power - fives).ok()?) << (power - twos);
    let digits = (x.numer().magnitude() * to_tens).to_string();
    let kept = digits.trim_end_matches('0');
    let sign = if x.numer().sign() == Sign::Minus { "-" } else { "" };
    if kept.is_empty() {
        return Some((sign, digits, 0));
    }
    let power = (digits.len() - kept.len()) as i64 - i64::try_from(power).ok()?;
    Some((sign, kept.to_string(), power))
}

/// `digits 10^power` as a JSON number: plain where that has at most `most` digits, else with an exponent.
fn short_decimal(digits: &str, power: i64, most: usize) -> String {
    let places = power.unsigned_abs() as usize;
    if power >= 0 && digits.len() + places <= most {
        format!("{digits}{}", "0".repeat(places))
    } else if power < 0 && places <= most {
        let padded = format!("{digits:0>width$}", width = places + 1);
        let (whole, fraction) = padded.split_at(padded.len() - places);
        format!("{whole}.{fraction}")
    } else {
        format!("{digits}e{power}")
    }
}

/// `digits 10^power` with an exponent within the limit, at the cost of zeros before or after the digits.
fn long_decimal(digits: &str, power: i64) -> String {
    let exponent = power.clamp(-(MAX_EXPONENT as i64), MAX_EXPONENT as i64);
    let places = (power - exponent).unsigned_abs() as usize;
    if power >= exponent {
        return format!("{digits}{}e{exponent}", "0".repeat(places));
    }
    let padded = format!("{digits:0>places$}");
    let (whole, fraction) = padded.split_at(padded.len() - places);
    format!("{whole}.{fraction}e{exponent}")
}

/// A JSON number that is <= `x` both as the decimal it spells and as the f64 nearest to that decimal: the
/// shortest decimal of `x` if that is exactly `x`, else the shortest decimal of the f64 below. `null` if `x` is not
/// finite, which the output format reads as +infinity: keep NaN and -inf from here.
///
/// Why: the shortest decimal of an f64 lies less than one step from it, so that of the f64 below lies under `x`.
///
/// ```
/// use tubecert::number::{lower_text, upper_text};
/// assert_eq!((lower_text(0.5), upper_text(0.5)), ("0.5".to_string(), "0.5".to_string()));
/// assert_eq!((lower_text(0.1), upper_text(0.1)), ("0.09999999999999999".to_string(), "0.10000000000000002".to_string()));
/// ```
#[must_use]
pub fn lower_text(x: f64) -> String {
    outward_text(x, f64::next_down)
}

/// A JSON number that is >= `x` both as the decimal it spells and as the f64 nearest to that decimal; the mirror
/// image of [`lower_text`], `null` included.
#[must_use]
pub fn upper_text(x: f64) -> String {
    outward_text(x, f64::next_up)
}

fn outward_text(x: f64, step: fn(f64) -> f64) -> String {
    let text = nearest_text(x);
    let exact = || match (parse_rational(&text), rational_from_f64(x)) {
        (Ok(printed), Some(meant)) => same(&printed, &meant),
        _ => !x.is_finite(),
    };
    // m 2^-k = m 5^k 10^-k with an odd m has more than the 17 digits of a shortest decimal if k > 24
    if binary_places(x) <= 24 && exact() {
        return text;
    }
    let outer = step(x);
    if outer.is_finite() {
        return nearest_text(outer);
    }
    // Beyond +-f64::MAX there is no f64 to step to, but this decimal is beyond it and still nearest to it.
    let sign = if x < 0.0 { "-" } else { "" };
    format!("{sign}1.7976931348623158e308")
}

/// The k of `x` = m 2^-k with an odd m, at most 1,074; 0 for 0.
fn binary_places(x: f64) -> i64 {
    if x == 0.0 {
        return 0;
    }
    let field = ((x.to_bits() >> 52) & 0x7ff).max(1) as i64;
    // the hidden bit is the last one that there can be
    1075 - field - i64::from((x.to_bits() | 1 << 52).trailing_zeros())
}

/// The shortest decimal whose nearest f64 is `x`, as a JSON number; `null` if `x` is not finite.
#[must_use]
pub fn nearest_text(x: f64) -> String {
    if !x.is_finite() {
        "null".to_string()
    } else if x == 0.0 {
        "0".to_string()
    } else if (1e-5..1e16).contains(&x.abs()) {
        x.to_string()
    } else {
        format!("{x:e}")
    }
}
