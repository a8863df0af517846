//! Integers in two tiers: machine `i128` while it fits, `BigInt` from then on. The switch is invisible.

use num_bigint::BigInt;
use num_bigint::Sign;
use num_integer::Integer;
use num_traits::{Signed, ToPrimitive, Zero};
use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Shl, Sub};

/// An exact integer. A value that fits `i128` is held as `Small`, so equal values are equal as data.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) enum Int {
    Small(i128),
    Big(Box<BigInt>),
}

impl Int {
    pub(crate) const ZERO: Self = Self::Small(0);
    pub(crate) const ONE: Self = Self::Small(1);

    pub(crate) fn big(&self) -> BigInt {
        match self {
            Self::Small(a) => BigInt::from(*a),
            Self::Big(a) => (**a).clone(),
        }
    }

    pub(crate) fn sign(&self) -> Ordering {
        match self {
            Self::Small(a) => a.cmp(&0),
            Self::Big(a) => match a.sign() {
                Sign::Minus => Ordering::Less,
                Sign::NoSign => Ordering::Equal,
                Sign::Plus => Ordering::Greater,
            },
        }
    }

    pub(crate) fn is_zero(&self) -> bool {
        matches!(self, Self::Small(0))
    }

    /// Bits of the absolute value; 0 for 0.
    pub(crate) fn bits(&self) -> u64 {
        match self {
            Self::Small(a) => u64::from(128 - a.unsigned_abs().leading_zeros()),
            Self::Big(a) => a.bits(),
        }
    }

    pub(crate) fn abs(&self) -> Self {
        if self.sign() == Ordering::Less { -self } else { self.clone() }
    }

    /// The residue in 0 .. m.
    pub(crate) fn modulo(&self, m: u64) -> u64 {
        match self {
            Self::Small(a) => a.rem_euclid(i128::from(m)) as u64,
            Self::Big(a) => a.mod_floor(&BigInt::from(m)).to_u64().unwrap_or_default(),
        }
    }

    /// The f64 nearest to `self * 2^-drop` (ties as the hardware does, error at most 2^-53 relative, plus
    /// underflow if `drop` is far above the size of the number).
    pub(crate) fn to_f64_shifted(&self, drop: i64) -> f64 {
        if self.is_zero() {
            return 0.0;
        }
        let bits = i64::try_from(self.bits()).unwrap_or(i64::MAX);
        let cut = (bits - 64).max(0);
        // The 64 leading bits, the last one sticky: one rounding only, in the conversion to f64.
        let top = match self {
            Self::Small(a) => {
                let m = a.unsigned_abs();
                let t = (m >> cut) as u64;
                t | u64::from(m & ((1u128 << cut) - 1) != 0)
            }
            Self::Big(a) => {
                let m = a.magnitude();
                let t = (m >> cut as u64).to_u64().unwrap_or(u64::MAX);
                t | u64::from(m.trailing_zeros().is_some_and(|z| z < cut as u64))
            }
        };
        let value = ldexp(top as f64, cut - drop);
        if self.sign() == Ordering::Less { -value } else { value }
    }
}

/// `x * 2^e` for any `e`: exact unless the result under- or overflows.
pub(crate) fn ldexp(mut x: f64, e: i64) -> f64 {
    let mut e = e.clamp(-4000, 4000);
    while e > 1000 {
        x *= pow2(1000);
        e -= 1000;
    }
    while e < -960 {
        x *= pow2(-960);
        e += 960;
    }
    x * pow2(e)
}

/// `2^e` for -1022 <= e <= 1023.
fn pow2(e: i64) -> f64 {
    f64::from_bits(((e + 1023) as u64) << 52)
}

/// `x = m * 2^e` with an odd integer m, or (0, 0).
pub(crate) fn decompose(x: f64) -> (i64, i64) {
    if x == 0.0 || !x.is_finite() {
        return (0, 0);
    }
    let bits = x.abs().to_bits();
    let field = (bits >> 52) as i64;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let (m, e) = if field == 0 { (fraction, -1074) } else { (fraction | (1 << 52), field - 1075) };
    let zeros = i64::from(m.trailing_zeros());
    let m = m >> zeros;
    (if x < 0.0 { -m } else { m }, e + zeros)
}

impl From<BigInt> for Int {
    fn from(a: BigInt) -> Self {
        match a.to_i128() {
            Some(small) => Self::Small(small),
            None => Self::Big(Box::new(a)),
        }
    }
}

impl From<i64> for Int {
    fn from(a: i64) -> Self {
        Self::Small(i128::from(a))
    }
}

macro_rules! binary {
    ($trait:ident, $method:ident, $checked:ident) => {
        impl $trait<&Int> for &Int {
            type Output = Int;
            fn $method(self, other: &Int) -> Int {
                if let (Int::Small(a), Int::Small(b)) = (self, other) {
                    if let Some(c) = a.$checked(*b) {
                        return Int::Small(c);
                    }
                }
                match (self, other) {
                    (Int::Big(a), Int::Big(b)) => Int::from((&**a).$method(&**b)),
                    (Int::Big(a), Int::Small(b)) => Int::from((&**a).$method(b)),
                    (Int::Small(a), Int::Big(b)) => Int::from(BigInt::from(*a).$method(&**b)),
                    (Int::Small(a), Int::Small(b)) => Int::from(BigInt::from(*a).$method(b)),
                }
            }
        }
    };
}
binary!(Add, add, checked_add);
binary!(Sub, sub, checked_sub);
binary!(Mul, mul, checked_mul);

impl Neg for &Int {
    type Output = Int;
    fn neg(self) -> Int {
        &Int::ZERO - self
    }
}

impl Shl<u64> for &Int {
    type Output = Int;
    fn shl(self, by: u64) -> Int {
        match self {
            Int::Small(0) => Int::ZERO,
            Int::Small(a) if self.bits() + by < 127 => Int::Small(a << by),
            _ => Int::from(self.big() << by),
        }
    }
}

impl PartialOrd for Int {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Int {
    fn cmp(&self, other: &Self) -> Ordering {
        match (self, other) {
            (Self::Small(a), Self::Small(b)) => a.cmp(b),
            (Self::Big(a), Self::Big(b)) => a.cmp(b),
            (Self::Big(a), Self::Small(_)) => {
                if a.is_negative() {
                    Ordering::Less
                } else {
                    Ordering::Greater
                }
            }
            (Self::Small(_), Self::Big(b)) => {
                if b.is_negative() {
                    Ordering::Greater
                } else {
                    Ordering::Less
                }
            }
        }
    }
}

/// Greatest common divisor, never negative.
pub(crate) fn gcd(a: &Int, b: &Int) -> Int {
    if let (Int::Small(a), Int::Small(b)) = (a, b) {
        let (mut a, mut b) = (a.unsigned_abs(), b.unsigned_abs());
        while b != 0 {
            (a, b) = (b, a % b);
        }
        return Int::from(BigInt::from(a));
    }
    Int::from(num_integer::Integer::gcd(&a.big(), &b.big()))
}

/// `a / b` where b divides a.
pub(crate) fn exact_div(a: &Int, b: &Int) -> Int {
    match (a, b) {
        (Int::Small(a), Int::Small(b)) if *b != -1 => Int::Small(a / b),
        _ => Int::from(a.big() / b.big()),
    }
}

/// The scalar product.
pub(crate) fn dot(u: &[Int; 3], v: &[Int; 3]) -> Int {
    (0..3).fold(Int::ZERO, |sum, k| &sum + &(&u[k] * &v[k]))
}

/// Least common multiple of positive integers.
pub(crate) fn lcm(a: &BigInt, b: &BigInt) -> BigInt {
    match (a.to_u64(), b.to_u64()) {
        _ if a.is_zero() || b.is_zero() => BigInt::zero(),
        (Some(a), Some(b)) => BigInt::from(u128::from(a / a.gcd(&b)) * u128::from(b)),
        _ => num_integer::Integer::lcm(a, b),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn int() -> impl Strategy<Value = BigInt> {
        prop_oneof![
            any::<i128>().prop_map(BigInt::from),
            any::<i64>().prop_map(BigInt::from),
            Just(BigInt::from(i128::MIN)),
            Just(BigInt::from(i128::MAX)),
            (any::<i128>(), any::<u8>()).prop_map(|(a, s)| BigInt::from(a) << s),
        ]
    }

    proptest! {
        #[test]
        fn two_tiers_are_one_ring(a in int(), b in int(), s in 0u64..200) {
            let (x, y) = (Int::from(a.clone()), Int::from(b.clone()));
            prop_assert_eq!(&x + &y, Int::from(&a + &b));
            prop_assert_eq!(&x - &y, Int::from(&a - &b));
            prop_assert_eq!(&x * &y, Int::from(&a * &b));
            prop_assert_eq!(&x << s, Int::from(&a << s));
            prop_assert_eq!(-&x, Int::from(-&a));
            prop_assert_eq!(x.cmp(&y), a.cmp(&b));
            prop_assert_eq!(gcd(&x, &y), Int::from(num_integer::Integer::gcd(&a, &b)));
            if !y.is_zero() {
                prop_assert_eq!(exact_div(&(&x * &y), &y), x);
            }
        }

        #[test]
        fn nearest_f64(a in int()) {
            let x = Int::from(a.clone()).to_f64_shifted(0);
            prop_assert_eq!(x, a.to_f64().unwrap());
        }
    }
}
