//! Enclosures as text: their width is shown, not hidden.

use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::{Signed, Zero};
use tubecert::number::{exact_text, f64_above, rational_from_f64};
use tubecert::{Curve, Enclosure};

/// `= lo .. hi`, and its like for the infinite.
pub fn relation(e: &Enclosure) -> String {
    let (lo, hi) = bounds(e);
    match (e.lo == f64::INFINITY, e.hi == f64::INFINITY) {
        (true, _) => "= infinity".to_string(),
        (false, true) => format!(">= {lo}"),
        _ if lo == hi => format!("= {lo}"),
        _ => format!("= {lo} .. {hi}"),
    }
}

/// The bounds of `e >= 0` moved outward to two digits beyond the first in which they differ. True as f64 too: what is
/// nearest to a decimal not above the f64 `lo` is not above it either.
pub fn bounds(e: &Enclosure) -> (String, String) {
    let (Some(lo), Some(hi)) = (rational_from_f64(e.lo), rational_from_f64(e.hi)) else {
        return (digits(e.lo, 9 - floor_log10(e.lo), Round::Down), "infinity".to_string());
    };
    let exact = exact_text(&lo);
    if e.lo == e.hi && exact.len() < 20 && !exact.contains('/') {
        return (exact.clone(), exact);
    }
    // where the ends agree: the 17 digits that tell any f64 from the next
    let width = if e.lo == e.hi { floor_log10(e.lo) - 14 } else { floor_log10(f64_above(&(hi - lo))) };
    let places = 2 - width;
    let places_lo = if e.lo == 0.0 { 0 } else { places.max(2 - floor_log10(e.lo)) };
    (digits(e.lo, places_lo, Round::Down), digits(e.hi, places, Round::Up))
}

/// Decimal places for a millionth of the domain or finer.
pub fn parameter_places(curve: &Curve) -> i32 {
    let (start, finish) = curve.domain();
    6 - floor_log10(f64_above(&(finish - start)))
}

/// Chooses how many digits are shown, so that it need not be exact.
pub fn floor_log10(x: f64) -> i32 {
    if x > 0.0 && x.is_finite() { x.log10().floor() as i32 } else { 0 }
}

#[derive(Debug, Clone, Copy)]
enum Round {
    Down,
    Up,
    Nearest,
}

/// The multiple of 10^-places next to `x`, rounded exactly.
fn digits(x: f64, places: i32, round: Round) -> String {
    let Some(x) = rational_from_f64(x) else { return x.to_string() };
    let ten = BigInt::from(10).pow(places.unsigned_abs());
    let (numer, denom) =
        if places < 0 { (x.numer().clone(), x.denom() * ten) } else { (x.numer() * ten, x.denom().clone()) };
    let count = match round {
        Round::Down => numer.div_floor(&denom),
        Round::Up => numer.div_ceil(&denom),
        Round::Nearest => Integer::div_floor(&(numer * 2 + &denom), &(denom * 2)),
    };
    decimal(&count, places)
}

pub fn nearest(x: f64, places: i32) -> String {
    let text = digits(x, places, Round::Nearest);
    if text.contains('.') && !text.contains('e') {
        return text.trim_end_matches('0').trim_end_matches('.').to_string();
    }
    text
}

/// The middle to so many digits; with fewer, and how far off it may be, where the enclosure is wider.
pub fn near(e: &Enclosure, digits: i32) -> String {
    let middle = e.lo.midpoint(e.hi);
    let half = (e.hi - middle).max(middle - e.lo).next_up();
    let (shown, proved) = (digits - 1 - floor_log10(middle.abs()), -1 - floor_log10(half));
    if e.lo == e.hi || proved >= shown {
        return nearest(middle, shown);
    }
    // half a unit of the last place more
    let off = half + 0.51 * 10_f64.powi(-proved);
    format!("{} +- {:.1e}", nearest(middle, proved), off * 1.06)
}

/// `count` 10^-places, with every digit of `count`.
fn decimal(count: &BigInt, places: i32) -> String {
    let (sign, digits) = (if count.is_negative() { "-" } else { "" }, count.magnitude().to_string());
    let exponent = digits.len() as i64 - 1 - i64::from(places);
    if count.is_zero() {
        "0".to_string()
    } else if !(-5..16).contains(&exponent) {
        let (first, rest) = digits.split_at(1);
        let point = if rest.is_empty() { "" } else { "." };
        format!("{sign}{first}{point}{rest}e{exponent}")
    } else if places <= 0 {
        format!("{sign}{digits}{}", "0".repeat(places.unsigned_abs() as usize))
    } else {
        let places = places.unsigned_abs() as usize;
        let digits = format!("{digits:0>width$}", width = places + 1);
        let (whole, fraction) = digits.split_at(digits.len() - places);
        format!("{sign}{whole}.{fraction}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use tubecert::number::{Rational, compare, parse_rational};

    fn shown(lo: f64, hi: f64) -> (String, String) {
        bounds(&Enclosure { lo, hi })
    }

    #[test]
    fn bounds_show_their_width() {
        let pair = |lo: &str, hi: &str| (lo.to_string(), hi.to_string());
        assert_eq!(shown(0.092534289633467, 0.09253428967048136), pair("0.0925342896334", "0.0925342896705"));
        assert_eq!(shown(0.4999999998, 0.5), pair("0.499999999799", "0.500000000000"));
        assert_eq!(shown(0.5, 0.5), pair("0.5", "0.5"));
        assert_eq!(shown(0.1, 0.1), pair("0.10000000000000000", "0.10000000000000001"));
        assert_eq!(shown(0.0, 3e-14), pair("0", "3.00e-14"));
        assert_eq!(shown(0.004, 0.875), pair("0.00400", "0.875"));
        assert_eq!(shown(123456789.0, 123466789.0), pair("123456700", "123466800"));
        assert_eq!(shown(2.0 / 3.0, f64::INFINITY), pair("0.6666666666", "infinity"));
        assert_eq!(shown(f64::MAX, f64::INFINITY).0, "1.797693134e308");
        assert_eq!(nearest(0.9983529746876774, 6), "0.998353");
        assert_eq!(nearest(-0.5, 6), "-0.5");
        assert_eq!(nearest(1000.0, 0), "1000");
    }

    proptest! {
        #[test]
        fn bounds_are_moved_outward_and_little(
            lo in proptest::num::f64::POSITIVE | proptest::num::f64::SUBNORMAL | proptest::num::f64::ZERO,
            step in prop_oneof![Just(0.0), 0.0..1e-14, 0.0..1e-3, 0.0..1e9],
        ) {
            let lo = lo.min(1e298);
            let hi = lo * (1.0 + step);
            let (low, high) = shown(lo, hi);
            let exact = |x| rational_from_f64(x).unwrap();
            let (low, high) = (parse_rational(&low).unwrap(), parse_rational(&high).unwrap());
            prop_assert!(compare(&low, &exact(lo)).is_le() && compare(&high, &exact(hi)).is_ge());
            let (wide, narrow) = (high - low, exact(hi) - exact(lo));
            let allowed = narrow * Rational::new(13.into(), 10.into()) + exact(lo) * exact(1e-14) + exact(1e-322);
            prop_assert!(compare(&wide, &allowed).is_le());
        }
    }
}
