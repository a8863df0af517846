//! The spine moved and scaled exactly into the unit box, and exact arcs of it.
//!
//! x -> (x - origin) 2^scale is exact in integers, so a curve far from the origin or of extreme size meets the f64 tiers
//! with the same relative precision as any other. Radii found here are scaled back by `Frame::length`.

use super::dyadic::{Dyadic, shifted};
use crate::bernstein::{Form, Scalar, Vec3, cross};
use crate::integer::{Int, exact_div, gcd};
use crate::number::Rational;
use crate::parallel;
use crate::spine::{Bezier, Spine};
use num_rational::Ratio;

/// A point of the spine: a segment and a local parameter in [0, 1].
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct At {
    pub(crate) segment: usize,
    pub(crate) t: Dyadic,
}

impl At {
    /// The dyadic parameter that an f64 is.
    pub(crate) fn near((segment, t): (usize, f64)) -> Self {
        Self { segment, t: Dyadic::from_f64(t) }
    }
}

/// The spine in the unit box.
#[derive(Debug)]
pub(crate) struct Frame {
    pub(crate) segments: Vec<Bezier>,
    pub(crate) closed: bool,
    /// Parameter values of the joints, one more than segments.
    pub(crate) knots: Vec<Rational>,
    pub(crate) scale: i64,
    pub(crate) origin: [Rational; 3],
}

impl Frame {
    pub(crate) fn new(spine: &Spine) -> Self {
        let beziers: Vec<&Bezier> = spine.segments.iter().map(|s| &s.bezier).collect();
        let (origin, scale) = placement(&beziers);
        let segments = parallel::map(&beziers, |b| moved(b, &origin, scale));
        let mut knots: Vec<Rational> = spine.segments.iter().map(|s| s.from.clone()).collect();
        knots.extend(spine.segments.last().map(|s| s.to.clone()));
        // origin is in units of 2^-scale
        let origin = origin.map(|o| shifted(&Rational::from(o.big()), -scale));
        Self { segments, closed: spine.closed, knots, scale, origin }
    }

    /// The parameter of a point, in the curve's own knots.
    pub(crate) fn parameter(&self, at: &At) -> Rational {
        let (a, b) = (&self.knots[at.segment], &self.knots[at.segment + 1]);
        a + at.t.rational() * (b - a)
    }

    /// A length of the box in the curve's unit.
    pub(crate) fn length(&self, x: &Rational) -> Rational {
        shifted(x, -self.scale)
    }

    /// A point of the box in the curve's coordinates.
    pub(crate) fn point(&self, x: &[Rational; 3]) -> [Rational; 3] {
        std::array::from_fn(|k| self.length(&x[k]) + &self.origin[k])
    }

    /// Moves a point by a local step of its own segment; across joints the step is kept as a share of the next
    /// segment. `None` beyond the ends of an open spine.
    pub(crate) fn step(&self, at: &At, by: &Dyadic) -> Option<At> {
        let t = at.t.add(by);
        let n = self.segments.len();
        if t.m.sign().is_lt() {
            let segment = if at.segment > 0 { at.segment - 1 } else { self.closed.then_some(n - 1)? };
            let t = t.add(&Dyadic::ONE);
            return (!t.m.sign().is_lt()).then_some(At { segment, t });
        }
        if t.cmp(&Dyadic::ONE).is_gt() {
            let segment = if at.segment + 1 < n { at.segment + 1 } else { self.closed.then_some(0)? };
            let t = t.sub(&Dyadic::ONE);
            return (!t.cmp(&Dyadic::ONE).is_gt()).then_some(At { segment, t });
        }
        Some(At { segment: at.segment, t })
    }
}

/// An origin, in units of 2^-scale, and a scale such that the control points come to lie about the unit box.
fn placement(beziers: &[&Bezier]) -> ([Int; 3], i64) {
    // Integer coordinates at a resolution fine enough for any size: 40 bits below the largest spread.
    let cartesian = |p: &[Int; 4], k: usize| Ratio::new(p[k].big(), p[3].big());
    let points: Vec<[Int; 4]> =
        beziers.iter().flat_map(|b| (0..=b.degree()).map(|i| b.point(i))).filter(|p| !p[3].is_zero()).collect();
    let Some(first) = points.first() else { return ([Int::ZERO, Int::ZERO, Int::ZERO], 0) };
    // floor(log2) of the largest |coordinate - first| and |coordinate|, by bit lengths: right up to two.
    let log2 = |num: &Int, den: &Int| num.bits() as i64 - den.bits() as i64;
    let (mut spread, mut size) = (i64::MIN, i64::MIN);
    for p in &points {
        for k in 0..3 {
            let gap = &(&p[k] * &first[3]) - &(&first[k] * &p[3]);
            if !gap.is_zero() {
                spread = spread.max(log2(&gap, &(&p[3] * &first[3])));
            }
            if !p[k].is_zero() {
                size = size.max(log2(&p[k], &p[3]));
            }
        }
    }
    if spread == i64::MIN {
        return ([Int::ZERO, Int::ZERO, Int::ZERO], 0);
    }
    let scale = -spread;
    if size <= spread + 2 {
        return ([Int::ZERO, Int::ZERO, Int::ZERO], scale);
    }
    let origin = [0, 1, 2].map(|k| Int::from(shifted(&cartesian(first, k), scale).round().to_integer()));
    (origin, scale)
}

/// (X 2^scale - origin W, W), cleared of common factors.
fn moved(b: &Bezier, origin: &[Int; 3], scale: i64) -> Bezier {
    let (up_x, up_w) = (scale.max(0) as u64, (-scale).max(0) as u64);
    let mut w: Vec<Int> = b.w.iter().map(|w| w << up_w).collect();
    let mut x: [Vec<Int>; 3] = std::array::from_fn(|k| {
        let shifted = |(i, x): (usize, &Int)| &(x << up_x) - &(&origin[k] * &(b.weight(i) << up_w));
        b.x[k].iter().enumerate().map(shifted).collect()
    });
    let content = x.iter().flatten().chain(&w).fold(Int::ZERO, |g, c| gcd(&g, c));
    for c in x.iter_mut().flatten().chain(&mut w) {
        *c = exact_div(c, &content);
    }
    Bezier { x, w }
}

impl Bezier {
    /// The arc over [index, index + 1] / 2^depth of the local parameter, exactly.
    pub(crate) fn cell(&self, index: &Int, depth: u32) -> Self {
        let end = |m: Int| Dyadic { m, e: -i64::from(depth) };
        self.arc(&end(index.clone()), &end(index + &Int::ONE))
    }

    /// The arc over [from, to] of the local parameter, exactly.
    pub(crate) fn arc(&self, from: &Dyadic, to: &Dyadic) -> Self {
        // over the common denominator 2^k
        let (from, to) = (from.sub(&Dyadic::ZERO), to.sub(&Dyadic::ZERO));
        let (a, b, e) = Dyadic::aligned(&from, &to);
        self.between(&a, &b, &(&Int::ONE << (-e) as u64))
    }

    /// The arc over [a, b] / one of the local parameter, exactly: the blossom needs both ends and their complements.
    pub(crate) fn between(&self, a: &Int, b: &Int, one: &Int) -> Self {
        let n = self.degree();
        let part = |c: &Vec<Int>| -> Vec<Int> {
            if c.len() == 1 && n > 0 {
                return vec![(0..n).fold(c[0].clone(), |c, _| &c * one)];
            }
            // Left part to b, then right part from a: blossoms (a^{n-j}, b^j) by de Casteljau rows.
            (0..=n)
                .map(|j| {
                    let mut row = c.clone();
                    for level in 1..=n {
                        let m = if level > n - j { b } else { a };
                        let rest = one - m;
                        for i in 0..=n - level {
                            row[i] = &(&row[i] * &rest) + &(&row[i + 1] * m);
                        }
                    }
                    row.swap_remove(0)
                })
                .collect()
        };
        Self { x: [part(&self.x[0]), part(&self.x[1]), part(&self.x[2])], w: part(&self.w) }
    }

    /// Exact forms of the arc that the local parameter [0, 1] of `self` covers.
    pub(crate) fn forms(&self) -> ExactForms {
        let n = self.degree();
        let r: Vec3<Int> = self.x.each_ref().map(|x| Form::from_bernstein(x));
        let w = Form::from_bernstein(&self.w);
        let constant = self.w.len() == 1;
        let r1 = self.x.each_ref().map(|x| Form::from_bernstein(&differences(x)));
        let a = if constant {
            r1.each_ref().map(|d| d.mul(&w))
        } else {
            let w1 = Form::from_bernstein(&differences(&self.w));
            std::array::from_fn(|k| r1[k].mul(&w).sub(&r[k].mul(&w1)).lowered())
        };
        debug_assert!(n > 0);
        ExactForms { r, w, a }
    }

    /// b = w (r' x r'') - w' (r x r'') + w'' (r x r'), with C' x C'' = b / w^3.
    pub(crate) fn binormal(&self) -> Vec3<Int> {
        let zero = || std::array::from_fn(|_| Form::from_bernstein(&[Int::ZERO]));
        if self.degree() < 2 {
            return zero();
        }
        let form = |c: &Vec<Int>| Form::from_bernstein(c);
        let first = self.x.each_ref().map(|x| differences(x));
        let second = first.each_ref().map(|d| form(&differences(d)));
        let first = first.each_ref().map(form);
        let w = form(&self.w);
        let leading = cross(&first, &second).map(|c| c.mul(&w));
        if self.w.len() == 1 {
            return leading.map(Form::lowered);
        }
        let r = self.x.each_ref().map(form);
        let w1 = differences(&self.w);
        let w2 = form(&differences(&w1));
        let w1 = form(&w1);
        let (middle, last) = (cross(&r, &second), cross(&r, &first));
        let mut axes = 0..3;
        leading.map(|leading| {
            let k = axes.next().expect("three");
            leading.sub(&middle[k].mul(&w1)).add(&last[k].mul(&w2)).lowered().lowered().lowered()
        })
    }
}

/// Bernstein coefficients of the derivative.
fn differences(c: &[Int]) -> Vec<Int> {
    let n = Int::from((c.len() - 1) as i64);
    c.windows(2).map(|p| &(&p[1] - &p[0]) * &n).collect()
}

/// Numerator r, denominator w and hodograph a of an arc.
pub(crate) struct ExactForms {
    pub(crate) r: Vec3<Int>,
    pub(crate) w: Form<Int>,
    pub(crate) a: Vec3<Int>,
}

/// Denominator and hodograph in any arithmetic.
pub(crate) struct ArcForms<T: Scalar> {
    pub(crate) w: Form<T>,
    pub(crate) a: Vec3<T>,
}

impl ExactForms {
    /// D = r w' - r' w of this arc and another, each in the variable of its forms.
    pub(crate) fn difference(&self, other: &Self) -> Vec3<Int> {
        std::array::from_fn(|k| self.r[k].mul(&other.w).sub(&other.r[k].mul(&self.w)))
    }

    /// The same arc in the other variable.
    pub(crate) fn transposed(self) -> Self {
        Self { r: self.r.map(Form::transposed), w: self.w.transposed(), a: self.a.map(Form::transposed) }
    }

    pub(crate) fn cast<T: Scalar>(&self) -> ArcForms<T> {
        ArcForms { w: T::cast(&self.w), a: self.a.each_ref().map(T::cast) }
    }
}

/// The quotient of two weights where their arcs start, as a number about 1 and a power of two.
pub(crate) fn weight_ratio(top: &Form<Int>, bottom: &Form<Int>) -> (f64, i64) {
    let (up, down) = (top.c[0].bits() as i64, bottom.c[0].bits() as i64);
    (top.c[0].to_f64_shifted(up) / bottom.c[0].to_f64_shifted(down), up + top.exp - down - bottom.exp)
}
