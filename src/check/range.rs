//! Exact intervals with rational ends.

use std::ops::{Add, Mul, Sub};

use num_traits::{Signed, Zero};

use super::arc::Spine;
use crate::curve::Curve;
use crate::number::{Rational, compare, same};

/// The bits of what a certificate puts into polynomials, where its powers stand.
const MAX_BITS: u64 = 1024;

/// All numbers from `lo` to `hi`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Range {
    pub(super) lo: Rational,
    pub(super) hi: Rational,
}

impl Range {
    pub(super) fn of([lo, hi]: &[Rational; 2]) -> Self {
        Self { lo: lo.clone(), hi: hi.clone() }
    }

    pub(super) fn point(x: &Rational) -> Self {
        Self { lo: x.clone(), hi: x.clone() }
    }

    /// Holds both.
    pub(super) fn with(self, other: Self) -> Self {
        let (lo, hi) = (compare(&self.lo, &other.lo).is_le(), compare(&self.hi, &other.hi).is_ge());
        Self { lo: if lo { self.lo } else { other.lo }, hi: if hi { self.hi } else { other.hi } }
    }

    pub(super) fn is_inside(&self, other: &Self) -> bool {
        compare(&other.lo, &self.lo).is_le() && compare(&self.hi, &other.hi).is_le()
    }

    pub(super) fn meets(&self, other: &Self) -> bool {
        compare(&other.lo, &self.hi).is_le() && compare(&self.lo, &other.hi).is_le()
    }

    pub(super) fn is_point(&self) -> bool {
        compare(&self.lo, &self.hi).is_eq()
    }

    pub(super) fn is_short(&self) -> bool {
        [&self.lo, &self.hi].iter().all(|x| x.numer().bits().max(x.denom().bits()) <= MAX_BITS)
    }

    pub(super) fn is_positive(&self) -> bool {
        self.lo.is_positive()
    }

    /// The greatest absolute value.
    pub(super) fn size(&self) -> Self {
        let zero = Self::point(&Rational::zero());
        Self::point(&self.clone().with(&zero - self).with(zero).hi)
    }
}

impl Add for &Range {
    type Output = Range;
    fn add(self, other: Self) -> Range {
        Range { lo: &self.lo + &other.lo, hi: &self.hi + &other.hi }
    }
}

impl Sub for &Range {
    type Output = Range;
    fn sub(self, other: Self) -> Range {
        Range { lo: &self.lo - &other.hi, hi: &self.hi - &other.lo }
    }
}

impl Mul for &Range {
    type Output = Range;
    fn mul(self, other: Self) -> Range {
        let ([a, b], [c, d]) = ([&self.lo, &self.hi], [&other.lo, &other.hi]);
        let [first, others @ ..] = [a * c, a * d, b * c, b * d].map(|x| Range::point(&x));
        others.into_iter().fold(first, Range::with)
    }
}

impl Spine {
    /// The ends of the spans.
    pub(super) fn knots(curve: &Curve) -> Vec<Rational> {
        let mut knots: Vec<_> =
            curve.knots().iter().take(curve.control_points().len() + 1).skip(curve.degree()).cloned().collect();
        knots.dedup_by(|a, b| same(a, b));
        knots
    }
}
