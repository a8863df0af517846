//! Polynomials in Bernstein form over the integers, without cleverness.
//!
//! `Poly(c)` is the sum of `c[i] t^i (1-t)^(n-i)`: the Bernstein coefficients times binomials, which have their signs.
//! So products are convolutions, and the formal degree n is the length less one. The empty sum has the degree -1.
//! The coefficients of a polynomial in s and t are polynomials in t.

use std::ops::AddAssign;

use num_bigint::{BigInt, Sign};
use num_traits::{One, Zero};

use crate::number::Rational;

#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Poly<C = BigInt>(pub(super) Vec<C>);

pub(super) type Vector = [Poly; 3];

impl<C: Clone + Default + for<'a> AddAssign<&'a C>> Poly<C> {
    /// Writes it in the formal degree `length` - 1, if that is higher: times t + (1-t).
    pub(super) fn raise(&mut self, length: usize) {
        while self.0.len() < length {
            self.0.push(C::default());
            for i in (1..self.0.len()).rev() {
                let (before, from) = self.0.split_at_mut(i);
                before.last().zip(from.first_mut()).into_iter().for_each(|(before, c)| *c += before);
            }
        }
    }

    /// The sum in the greater of the two degrees.
    pub(super) fn plus(mut self, mut other: Self) -> Self {
        self.raise(other.0.len());
        other.raise(self.0.len());
        self.0.iter_mut().zip(&other.0).for_each(|(c, d)| *c += d);
        self
    }
}

impl AddAssign<&Self> for Poly {
    fn add_assign(&mut self, other: &Self) {
        if self.0.len() == other.0.len() {
            self.0.iter_mut().zip(&other.0).for_each(|(c, d)| *c += d);
        } else {
            *self = std::mem::take(self).plus(other.clone());
        }
    }
}

impl Poly {
    /// The polynomial of these Bernstein coefficients.
    pub(super) fn bernstein(coefficients: Vec<BigInt>) -> Self {
        let mut binomials = Self(vec![BigInt::one()]);
        binomials.raise(coefficients.len());
        Self(coefficients.into_iter().zip(binomials.0).map(|(c, binomial)| c * binomial).collect())
    }

    /// Its Bernstein coefficients, all times one number > 0.
    pub(super) fn control(&self) -> Vec<BigInt> {
        let mut binomials = Self::constant(1);
        binomials.raise(self.0.len());
        let common = binomials.0.iter().fold(BigInt::one(), |common, c| num_integer::lcm(common, c.clone()));
        self.0.iter().zip(&binomials.0).map(|(c, binomial)| c * (&common / binomial)).collect()
    }

    pub(super) fn constant(c: impl Into<BigInt>) -> Self {
        Self(vec![c.into()])
    }

    pub(super) fn is_zero(&self) -> bool {
        self.0.iter().all(Zero::is_zero)
    }

    pub(super) fn is_positive(&self) -> bool {
        self.has_sign(Sign::Plus)
    }

    /// Whether all coefficients are > 0, or all < 0.
    pub(super) fn has_sign(&self, sign: Sign) -> bool {
        !self.0.is_empty() && self.0.iter().all(|c| c.sign() == sign)
    }

    pub(super) fn times(&self, other: &Self) -> Self {
        let mut product = vec![BigInt::zero(); (self.0.len() + other.0.len()).saturating_sub(1)];
        for (i, c) in self.0.iter().enumerate().filter(|(_, c)| !c.is_zero()) {
            product.iter_mut().skip(i).zip(&other.0).for_each(|(sum, d)| *sum += c * d);
        }
        Self(product)
    }

    pub(super) fn scaled(&self, factor: &BigInt) -> Self {
        Self(self.0.iter().map(|c| c * factor).collect())
    }

    pub(super) fn minus(self, other: Self) -> Self {
        self.plus(Self(other.0.into_iter().map(|c| -c).collect()))
    }

    pub(super) fn derivative(&self) -> Self {
        let degree = self.0.len().saturating_sub(1);
        let pairs = self.0.iter().zip(self.0.iter().skip(1)).enumerate();
        Self(pairs.map(|(i, (c, next))| next * (i + 1) - c * (degree - i)).collect())
    }

    /// q^degree times the polynomial of a/q + t (b - a)/q.
    pub(super) fn between(&self, a: &BigInt, b: &BigInt, q: &BigInt) -> Self {
        let (here, rest) = (Self(vec![a.clone(), b.clone()]), Self(vec![q - a, q - b]));
        let (mut value, mut power) = (Self::default(), Self::constant(1));
        for c in self.0.iter().rev() {
            value = value.times(&here).plus(power.scaled(c));
            power = power.times(&rest);
        }
        value
    }

    /// q^degree times the value at t = p/q.
    pub(super) fn at(&self, t: &Rational) -> Self {
        let rest = t.denom() - t.numer();
        let step = |(value, power), c| (value * t.numer() + c * &power, power * &rest);
        Self::constant(self.0.iter().rev().fold((BigInt::zero(), BigInt::one()), step).0)
    }
}

/// Bernstein coefficients on both halves, all times one number > 0: de Casteljau's algorithm with sums for means.
pub(super) fn halves(mut row: Vec<BigInt>) -> [Vec<BigInt>; 2] {
    let (mut first, mut second) = (vec![], vec![]);
    while let ([start, ..], [.., end]) = (&*row, &*row) {
        first.push(start << (row.len() - 1));
        second.insert(0, end << (row.len() - 1));
        row = row.iter().zip(row.iter().skip(1)).map(|(c, next)| c + next).collect();
    }
    [first, second]
}

impl Poly<Poly> {
    /// All coefficients, for their signs.
    pub(super) fn flat(self) -> Poly {
        Poly(self.0.into_iter().flat_map(|row| row.0).collect())
    }
}

/// The sum of the products f(s) g(t).
pub(super) fn paired<const N: usize>(f: [&Poly; N], g: [&Poly; N]) -> Poly<Poly> {
    let product = |(f, g): (&Poly, &Poly)| Poly(f.0.iter().map(|c| g.scaled(c)).collect());
    f.into_iter().zip(g).map(product).reduce(Poly::plus).unwrap_or_default()
}

pub(super) fn dot([x, y, z]: &Vector, [u, v, w]: &Vector) -> Poly {
    x.times(u).plus(y.times(v)).plus(z.times(w))
}

pub(super) fn cross([x, y, z]: &Vector, [u, v, w]: &Vector) -> Vector {
    let minor = |a: &Poly, b: &Poly, c: &Poly, d: &Poly| a.times(b).minus(c.times(d));
    [minor(y, w, z, v), minor(z, u, x, w), minor(x, v, y, u)]
}
