//! Dyadic rationals: local parameters, witnesses and every exact value at them.

use crate::bernstein::Form;
use crate::integer::{Int, decompose, ldexp};
use crate::number::Rational;
use num_integer::Integer;
use num_rational::Ratio;
use num_traits::Zero;
use std::cmp::Ordering;

/// A dyadic rational m 2^e, exact: local parameters, witnesses and every value at them.
#[derive(Debug, Clone)]
pub(crate) struct Dyadic {
    pub(crate) m: Int,
    pub(crate) e: i64,
}

impl Dyadic {
    pub(crate) const ZERO: Self = Self { m: Int::ZERO, e: 0 };
    pub(crate) const ONE: Self = Self { m: Int::ONE, e: 0 };

    pub(crate) fn from_f64(x: f64) -> Self {
        let (m, e) = crate::integer::decompose(x);
        Self { m: Int::from(m), e }
    }

    pub(crate) fn aligned(a: &Self, b: &Self) -> (Int, Int, i64) {
        let e = a.e.min(b.e);
        (&a.m << (a.e - e) as u64, &b.m << (b.e - e) as u64, e)
    }

    pub(crate) fn add(&self, other: &Self) -> Self {
        let (a, b, e) = Self::aligned(self, other);
        Self { m: &a + &b, e }
    }

    pub(crate) fn sub(&self, other: &Self) -> Self {
        let (a, b, e) = Self::aligned(self, other);
        Self { m: &a - &b, e }
    }

    pub(crate) fn mul(&self, other: &Self) -> Self {
        Self { m: &self.m * &other.m, e: self.e + other.e }
    }

    pub(crate) fn sqr(&self) -> Self {
        self.mul(self)
    }

    pub(crate) fn cmp(&self, other: &Self) -> Ordering {
        let (a, b, _) = Self::aligned(self, other);
        a.cmp(&b)
    }

    /// Nearest, but for under- and overflow.
    pub(crate) fn to_f64(&self) -> f64 {
        self.m.to_f64_shifted(-self.e)
    }

    pub(crate) fn rational(&self) -> Rational {
        shifted(&Rational::from(self.m.big()), self.e)
    }
}

impl From<i64> for Dyadic {
    fn from(m: i64) -> Self {
        Self { m: Int::from(m), e: 0 }
    }
}

impl PartialEq for Dyadic {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

pub(crate) fn dot3(a: &[Dyadic; 3], b: &[Dyadic; 3]) -> Dyadic {
    a[0].mul(&b[0]).add(&a[1].mul(&b[1])).add(&a[2].mul(&b[2]))
}

pub(crate) fn cross3(a: &[Dyadic; 3], b: &[Dyadic; 3]) -> [Dyadic; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i].mul(&b[j]).sub(&a[j].mul(&b[i])))
}

/// x 2^by. As x is in lowest terms, only twos can cancel.
pub(crate) fn shifted(x: &Rational, by: i64) -> Rational {
    if x.is_zero() {
        return x.clone();
    }
    let (up, down) = if by < 0 { (x.denom(), x.numer()) } else { (x.numer(), x.denom()) };
    let steps = by.unsigned_abs();
    let cancelled = down.trailing_zeros().unwrap_or(0).min(steps);
    let (up, down) = (up << (steps - cancelled), down >> cancelled);
    if by < 0 { Ratio::new_raw(down, up) } else { Ratio::new_raw(up, down) }
}

pub(crate) fn step(j: i64) -> Dyadic {
    Dyadic { m: Int::ONE, e: -j }
}

pub(crate) fn truncated(x: &Dyadic, bits: i64) -> Dyadic {
    if x.e >= -bits {
        return x.clone();
    }
    Dyadic { m: Int::from(x.m.big() >> (-bits - x.e) as u64), e: -bits }
}

pub(crate) fn decompose_exponent(x: f64) -> i64 {
    let (m, e) = decompose(x);
    e + 64 - i64::from(m.unsigned_abs().leading_zeros())
}

/// num / den rounded down to a multiple of 2^-bits.
pub(crate) fn rounded_quotient(num: &Dyadic, den: &Dyadic, bits: i64) -> Dyadic {
    let shift = num.e - den.e + bits;
    let (mut a, mut b) = (num.m.big(), den.m.big());
    if shift >= 0 {
        a <<= shift as u64;
    } else {
        b <<= (-shift) as u64;
    }
    Dyadic { m: Int::from(a.div_floor(&b)), e: -bits }
}

/// The quotient in f64, numerically.
pub(crate) fn ratio(num: &Dyadic, den: &Dyadic) -> f64 {
    let (a, b) = (num.m.bits() as i64, den.m.bits() as i64);
    ldexp(num.m.to_f64_shifted(a) / den.m.to_f64_shifted(b), a + num.e - b - den.e)
}

/// The least f64 >= 0 that satisfies an exact monotone condition, sought from `near` >= 0.
pub(crate) fn least_f64(near: f64, holds: impl Fn(&Dyadic) -> bool) -> Option<f64> {
    // numbers >= 0 are ordered as their bits
    let holds = |bits: u64| holds(&Dyadic::from_f64(f64::from_bits(bits)));
    if !near.is_finite() || near < 0.0 {
        return None;
    }
    // -0 is 0
    let start = (near + 0.0).to_bits();
    let (mut low, mut high, mut step) = (start, start, 1);
    if holds(start) {
        while holds(low) {
            if low == 0 {
                return Some(0.0);
            }
            (low, high, step) = (low.saturating_sub(step), low, 2 * step);
        }
    }
    while !holds(high) {
        if high == f64::MAX.to_bits() {
            return None;
        }
        (low, high, step) = (high, (high + step).min(f64::MAX.to_bits()), 2 * step);
    }
    // the condition fails at low and holds at high
    while low + 1 < high {
        let middle = low.midpoint(high);
        if holds(middle) { high = middle } else { low = middle }
    }
    Some(f64::from_bits(high))
}

impl Form<Int> {
    /// The value of a univariate form at a dyadic t in [0, 1].
    pub(crate) fn at(&self, t: &Dyadic) -> Dyadic {
        let t = t.add(&Dyadic::ZERO);
        let k = -t.e;
        let rest = &(&Int::ONE << k as u64) - &t.m;
        // sum of c[j] rest^(d-j) m^j, by Horner from the top, the powers of `rest` alongside
        let mut sum = Int::ZERO;
        let mut power = Int::ONE;
        for c in self.c.iter().rev() {
            sum = &(&sum * &t.m) + &(c * &power);
            power = &power * &rest;
        }
        Dyadic { m: sum, e: self.exp - k * (self.c.len() as i64 - 1) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_bigint::BigInt;
    use proptest::prelude::*;

    proptest! {
        /// The condition r >= bound, from near it and from far off.
        #[test]
        fn the_least_f64_is_the_bound(bits in 0..f64::MAX.to_bits(), off in 0.0..2.0f64) {
            let bound = f64::from_bits(bits);
            let holds = |r: &Dyadic| r.cmp(&Dyadic::from_f64(bound)).is_ge();
            prop_assert_eq!(least_f64(bound, holds), Some(bound));
            prop_assert_eq!(least_f64((bound * off).min(f64::MAX), holds), Some(bound));
            prop_assert_eq!(least_f64(0.0, holds), Some(bound));
        }

        #[test]
        fn shifted_is_times_a_power_of_two(m in any::<i64>(), d in 1..i64::MAX, by in -200..200i64) {
            let x = Rational::new(m.into(), d.into());
            let power = |e: i64| Rational::from_integer(BigInt::from(1) << e as u64);
            let product = if by < 0 { &x / power(-by) } else { &x * power(by) };
            prop_assert_eq!(shifted(&x, by), product);
        }
    }

    #[test]
    fn no_f64_is_large_enough() {
        assert_eq!(least_f64(1.0, |_| false), None);
        assert_eq!(least_f64(1.0, |_| true), Some(0.0));
        assert_eq!(least_f64(0.0, |r| !r.m.is_zero()), Some(5e-324));
    }
}
