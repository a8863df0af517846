//! The curvature itself: exactly at a point, enclosed on a short arc.

use super::critical::{Bend, Zero};
use super::curvature::{Strips, kappa_sq};
use super::dyadic::Dyadic;
use crate::bernstein::{Form, dot, int_binomials};
use crate::enclosure::Interval;
use crate::integer::Int;
use crate::number::{Rational, compare};
use crate::roots::common_zero;
use crate::spine::Bezier;
use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::Signed;
use std::cmp::Ordering;

/// kappa^2 at a point, as |b|^2 w^6 / |a|^6 in exact numbers.
pub(crate) struct Exactly {
    numerator: Dyadic,
    denominator: Dyadic,
}

impl Exactly {
    pub(crate) fn at(bend: &Bend, t: &Dyadic) -> Self {
        let [numerator, denominator] = kappa_sq(&bend.a, &bend.b, &bend.w, t);
        Self { numerator, denominator }
    }

    pub(crate) fn is_zero(&self) -> bool {
        self.numerator.m.is_zero()
    }

    pub(crate) fn cmp(&self, other: &Self) -> Ordering {
        self.numerator.mul(&other.denominator).cmp(&other.numerator.mul(&self.denominator))
    }

    /// kappa, tight.
    pub(crate) fn root(&self) -> Interval {
        if self.is_zero() {
            return Interval::point(0.0);
        }
        // scaled by an even power of two to about 1: kappa^2 may lie beyond the range of f64
        let size = |x: &Dyadic| x.m.bits() as i64 + x.e;
        let half = Integer::div_floor(&(size(&self.numerator) - size(&self.denominator)), &2);
        let (num, den, _) = Dyadic::aligned(&self.numerator, &self.denominator);
        let (up, down) = ((-2 * half).max(0) as u64, (2 * half).max(0) as u64);
        let square = Interval::from_ratio(&(num.big() << up), &(den.big() << down));
        square.sqrt().scale2(half.clamp(-5000, 5000) as i32)
    }
}

/// kappa from all that a, b and w can be on an arc, control vectors included.
fn over(strips: &Strips, a: [Interval; 3], b: [Interval; 3], [w]: [Interval; 1]) -> Interval {
    let (a, b) = (length(a), length(b));
    if a.lo() < 1e-60 {
        return Interval::new(0.0, f64::INFINITY);
    }
    let x = w / a;
    let exp = 3 * strips.w.exp - 3 * strips.a.exp + strips.b.exp;
    (b * (x.sqr() * x)).abs().scale2(exp.clamp(-5000, 5000) as i32)
}

/// kappa on an arc, from the exact Bernstein coefficients of |b|^2 w^6 and |a|^6.
fn exactly_over(arc: &Bend) -> Interval {
    let (a, w) = (dot(&arc.a, &arc.a), arc.w.sqr().mul(&arc.w));
    let range = |form: Form<Int>| {
        // all times one number, and the degrees may differ: so rationals
        let c = form.c.iter().zip(int_binomials(form.c.len() - 1));
        let mut c: Vec<Rational> = c.map(|(c, binomial)| Rational::new(c.big(), binomial.big())).collect();
        c.sort_by(compare);
        [c[0].clone(), c[c.len() - 1].clone()]
    };
    let ([low, high], [short, long]) = (range(dot(&arc.b, &arc.b).mul(&w.sqr())), range(a.sqr().mul(&a)));
    let root = |x: Rational| {
        let dyadic = |x: &BigInt| Dyadic { m: Int::from(x.clone()), e: 0 };
        Exactly { numerator: dyadic(x.numer()), denominator: dyadic(x.denom()) }.root()
    };
    let least = if low.is_positive() { root(low / long).lo() } else { 0.0 };
    let most = if short.is_positive() { root(high / short).hi() } else { f64::INFINITY };
    Interval::new(least, most)
}

fn length(v: [Interval; 3]) -> Interval {
    (v[0].sqr() + v[1].sqr() + v[2].sqr()).sqrt()
}

/// A middle and a reach from it that hold all from `lo` to `hi`, in [0, 1].
fn about(lo: &Dyadic, hi: &Dyadic) -> (f64, f64) {
    let (from, to) = (lo.to_f64(), hi.to_f64());
    // in units of 2^-54, the middle is off by 2 at most, half the length by 1.25, the last sum by 0.5, of EPSILON's 4
    (0.5 * (from + to), 0.5 * (to - from).abs() + f64::EPSILON)
}

/// The curvature of a segment, on arcs of it.
pub(crate) struct Kappa<'a> {
    pub(crate) bezier: &'a Bezier,
    pub(crate) bend: &'a Bend,
    strips: Strips,
}

impl<'a> Kappa<'a> {
    pub(crate) fn new(bezier: &'a Bezier, bend: &'a Bend) -> Self {
        Self { bezier, bend, strips: Strips::of(&bend.a, &bend.b, &bend.w) }
    }

    /// kappa on all of the arc; `narrow` tells whether a share of the width that is asked is reached.
    pub(crate) fn on(&self, lo: &Dyadic, hi: &Dyadic, narrow: impl Fn(Interval, f64) -> bool) -> Interval {
        if lo == hi {
            return Exactly::at(self.bend, lo).root();
        }
        let (middle, half) = about(lo, hi);
        let Strips { a, b, w } = &self.strips;
        let first = over(&self.strips, a.ball(middle, half), b.ball(middle, half), w.ball(middle, half));
        if narrow(first, 0.1) {
            return first;
        }
        let arc = Bend::new(&self.bezier.arc(lo, hi));
        let strips = Strips::of(&arc.a, &arc.b, &arc.w);
        let second = over(&strips, strips.a.hull(), strips.b.hull(), strips.w.hull());
        let both = Interval::new(first.lo().max(second.lo()), first.hi().min(second.hi()));
        if narrow(both, 0.35) { both } else { exactly_over(&arc) }
    }

    /// No curvature of the arc, which may be long, is greater; infinite if that is not known.
    pub(crate) fn at_most(&self, lo: &Dyadic, hi: &Dyadic) -> f64 {
        let arc = Bend::new(&self.bezier.arc(lo, hi));
        // beyond 1e300 its inverse may have no normal f64
        (1.0 / Strips::of(&arc.a, &arc.b, &arc.w).floor().min(1e300)).next_up()
    }

    /// Is b = 0 at the zero of N?
    pub(crate) fn inflects(&self, zero: &Zero) -> bool {
        let Zero { lo, hi, .. } = zero;
        if lo == hi {
            return Exactly::at(self.bend, lo).is_zero();
        }
        // where b is 0 all its coordinates are
        let (middle, half) = about(lo, hi);
        let near = self.strips.b.ball(middle, half);
        if near.iter().any(|x| !x.contains(0.0)) {
            return false;
        }
        let b = self.bezier.arc(lo, hi).binormal();
        let b: Vec<Vec<Int>> = b.iter().filter(|f| !f.is_zero()).map(Form::bernstein).collect();
        common_zero(&b).is_some()
    }
}
