//! Polynomials in Bernstein form over the integers, without cleverness.
//!
//! `Poly(c)` is the sum of `c[i] t^i (1-t)^(n-i)`: the Bernstein coefficients times binomials, which have their signs.
//! So products are convolutions, and the formal degree n is the length less one. The empty sum has the degree -1.

use num_bigint::{BigInt, Sign};
use num_traits::{One, Zero};

/// A polynomial in one variable in its formal degree.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Poly(pub(super) Vec<BigInt>);

pub(super) type Vector = [Poly; 3];

impl Poly {
    /// The polynomial of these Bernstein coefficients.
    pub(super) fn bernstein(coefficients: Vec<BigInt>) -> Self {
        let mut binomials = Self(vec![BigInt::one()]);
        binomials.raise(coefficients.len());
        Self(coefficients.into_iter().zip(binomials.0).map(|(c, binomial)| c * binomial).collect())
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

    /// Adds a polynomial of the same degree.
    fn add(&mut self, other: &Self) {
        self.0.iter_mut().zip(&other.0).for_each(|(c, d)| *c += d);
    }

    /// Writes it in the formal degree `length` - 1, if that is higher: times t + (1-t).
    pub(super) fn raise(&mut self, length: usize) {
        while self.0.len() < length {
            self.0.push(BigInt::zero());
            for i in (1..self.0.len()).rev() {
                let (before, from) = self.0.split_at_mut(i);
                if let (Some(before), Some(c)) = (before.last(), from.first_mut()) {
                    *c += before;
                }
            }
        }
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

    /// The sum in the greater of the two degrees.
    pub(super) fn plus(mut self, mut other: Self) -> Self {
        self.raise(other.0.len());
        other.raise(self.0.len());
        self.add(&other);
        self
    }

    pub(super) fn minus(self, other: Self) -> Self {
        self.plus(Self(other.0.into_iter().map(|c| -c).collect()))
    }

    pub(super) fn derivative(&self) -> Self {
        let degree = self.0.len().saturating_sub(1);
        let pairs = self.0.iter().zip(self.0.iter().skip(1)).enumerate();
        Self(pairs.map(|(i, (c, next))| next * (i + 1) - c * (degree - i)).collect())
    }

    /// 2^degree times the polynomial of t/2.
    pub(super) fn first_half(&self) -> Self {
        let mut half = Self(Vec::with_capacity(self.0.len()));
        for c in &self.0 {
            half.raise(half.0.len() + 1);
            half.0.last_mut().into_iter().for_each(|last| *last += c);
        }
        half.0.iter_mut().rev().enumerate().for_each(|(i, c)| *c <<= i);
        half
    }

    /// The polynomial of 1 - t.
    pub(super) fn reversed(&self) -> Self {
        Self(self.0.iter().rev().cloned().collect())
    }

    /// q^degree times the value at p/q.
    pub(super) fn at(&self, p: &BigInt, q: &BigInt) -> BigInt {
        let (mut value, mut power, rest) = (BigInt::zero(), BigInt::one(), q - p);
        for c in self.0.iter().rev() {
            value = value * p + c * &power;
            power *= &rest;
        }
        value
    }

    /// q^degree times the polynomial of a/q + t (b - a)/q.
    pub(super) fn between(&self, a: &BigInt, b: &BigInt, q: &BigInt) -> Self {
        let (here, rest) = (Self(vec![a.clone(), b.clone()]), Self(vec![q - a, q - b]));
        let (mut value, mut power) = (Self(vec![]), Self(vec![BigInt::one()]));
        for c in self.0.iter().rev() {
            value = value.times(&here).plus(power.scaled(c));
            power = power.times(&rest);
        }
        value
    }
}

/// The components of two vectors, pair by pair.
pub(super) fn zip<A, B, C>([a, b, c]: [A; 3], [d, e, f]: [B; 3], of: impl Fn(A, B) -> C) -> [C; 3] {
    [of(a, d), of(b, e), of(c, f)]
}

pub(super) fn dot(f: &Vector, g: &Vector) -> Poly {
    let [x, y, z] = zip(f.each_ref(), g.each_ref(), Poly::times);
    x.plus(y).plus(z)
}

pub(super) fn cross([x, y, z]: &Vector, [u, v, w]: &Vector) -> Vector {
    let minor = |a: &Poly, b: &Poly, c: &Poly, d: &Poly| a.times(b).minus(c.times(d));
    [minor(y, w, z, v), minor(z, u, x, w), minor(x, v, y, u)]
}

/// A sum of products f(s) g(t), kept apart by their degrees until its sign is asked for.
#[derive(Default)]
pub(super) struct Tensor(Vec<Vec<Poly>>);

impl Tensor {
    pub(super) fn add(&mut self, f: &Poly, g: &Poly) {
        let alike =
            |rows: &&mut Vec<Poly>| rows.len() == f.0.len() && rows.first().is_some_and(|row| row.0.len() == g.0.len());
        if let Some(rows) = self.0.iter_mut().find(alike) {
            for (row, c) in rows.iter_mut().zip(&f.0).filter(|(_, c)| !c.is_zero()) {
                row.0.iter_mut().zip(&g.0).for_each(|(sum, d)| *sum += c * d);
            }
        } else {
            self.0.push(f.0.iter().map(|c| g.scaled(c)).collect());
        }
    }

    /// The rows, index in s, in the greatest degrees that stand in the sum.
    pub(super) fn rows(self) -> Vec<Poly> {
        let height = self.0.iter().map(Vec::len).max().unwrap_or(0);
        let width = self.0.iter().flatten().map(|row| row.0.len()).max().unwrap_or(0);
        let mut sum = vec![Poly(vec![BigInt::zero(); width]); height];
        for mut rows in self.0 {
            rows.iter_mut().for_each(|row| row.raise(width));
            while rows.len() < height {
                rows.push(Poly(vec![BigInt::zero(); width]));
                for i in (1..rows.len()).rev() {
                    let (before, from) = rows.split_at_mut(i);
                    before.last().zip(from.first_mut()).into_iter().for_each(|(before, row)| row.add(before));
                }
            }
            sum.iter_mut().zip(&rows).for_each(|(sum, row)| sum.add(row));
        }
        sum
    }

    /// Whether all coefficients are > 0, or all < 0; `None` if neither.
    pub(super) fn sign(self) -> Option<bool> {
        let rows = self.rows();
        let all = |sign| !rows.is_empty() && rows.iter().all(|row| row.has_sign(sign));
        if all(Sign::Plus) { Some(true) } else { all(Sign::Minus).then_some(false) }
    }
}
