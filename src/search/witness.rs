//! Exact upper bounds: the witnesses W1 to W4 of theory.md, section 2, and existence of a doubly critical pair. Candidates
//! come as f64; what is returned was checked in integers.

use super::curvature::Peak;
use super::dyadic::{Dyadic, cross3, decompose_exponent, dot3, least_f64, ratio, rounded_quotient, step, truncated};
use super::ends::Contact;
use super::frame::{At, ExactForms, Frame};
use super::newton::Candidate;
use super::tree::V3;
use crate::bernstein::Vec3;
use crate::integer::Int;
use crate::number::Rational;
use num_bigint::BigInt;

/// Candidates closer than this are polished with exact residuals: f64 no longer resolves them well.
pub(crate) const POLISHED: f64 = 1e-4;

/// A homogeneous point x / w, w > 0.
#[derive(Debug, Clone)]
pub(crate) struct Point {
    pub(crate) x: [Dyadic; 3],
    pub(crate) w: Dyadic,
}

impl Point {
    pub(crate) fn cartesian(&self) -> [Rational; 3] {
        let w = self.w.rational();
        std::array::from_fn(|k| self.x[k].rational() / &w)
    }
}

/// Exact evaluation of one spine, the forms of a span made when first needed.
pub(crate) struct Exact<'f> {
    pub(crate) frame: &'f Frame,
    forms: Vec<Option<(ExactForms, Vec3<Int>)>>,
}

/// An exact upper bound for delta (unit box), with the points it rests on.
#[derive(Debug, Clone)]
pub(crate) struct Witness {
    pub(crate) radius: f64,
    pub(crate) s: Option<At>,
    pub(crate) t: At,
    pub(crate) x: Option<[Rational; 3]>,
}

impl<'f> Exact<'f> {
    pub(crate) fn new(frame: &'f Frame) -> Self {
        Self { frame, forms: frame.segments.iter().map(|_| None).collect() }
    }

    pub(crate) fn span(&mut self, segment: usize) -> &(ExactForms, Vec3<Int>) {
        let bezier = &self.frame.segments[segment];
        self.forms[segment].get_or_insert_with(|| (bezier.forms(), bezier.binormal()))
    }

    pub(crate) fn point(&mut self, at: &At) -> Point {
        let (forms, _) = self.span(at.segment);
        Point { x: forms.r.each_ref().map(|r| r.at(&at.t)), w: forms.w.at(&at.t) }
    }

    /// A positive multiple of the tangent.
    pub(crate) fn hodograph(&mut self, at: &At) -> [Dyadic; 3] {
        let (forms, _) = self.span(at.segment);
        forms.a.each_ref().map(|a| a.at(&at.t))
    }

    /// W1: the least f64 radius R at hand with kappa(t)^2 >= 1/R^2.
    pub(crate) fn curved(&mut self, peak: &Peak) -> Option<Witness> {
        let at = At { segment: peak.segment, t: Dyadic::from_f64(peak.t) };
        let a = self.hodograph(&at);
        let (forms, b) = self.span(at.segment);
        let (b, w) = (b.each_ref().map(|b| b.at(&at.t)), forms.w.at(&at.t));
        let a2 = dot3(&a, &a);
        let left = a2.sqr().mul(&a2);
        let right = dot3(&b, &b).mul(&w.sqr().mul(&w).sqr());
        let radius = least_f64(peak.radius, |r| left.cmp(&r.sqr().mul(&right)).is_le())?;
        Some(Witness { radius, s: None, t: at, x: None })
    }

    /// W2 at an end of the spine and a point: rho(e, t)^2 is rational, no root is needed.
    pub(crate) fn disks(&mut self, contact: &Contact) -> Option<Witness> {
        let end = self.end(contact.finish);
        let at = At { segment: contact.t.0, t: Dyadic::from_f64(contact.t.1) };
        if distance(self.frame, &end, &at).m.is_zero() {
            return None; // one point is no pair
        }
        let (num, den, x) = self.rho_sq(&end, &at)?;
        let radius = least_f64(contact.radius, |r| num.cmp(&r.sqr().mul(&den)).is_le())?;
        Some(Witness { radius, s: Some(end), t: at, x: Some(x) })
    }

    pub(crate) fn end(&self, finish: bool) -> At {
        if finish {
            At { segment: self.frame.segments.len() - 1, t: Dyadic::ONE }
        } else {
            At { segment: 0, t: Dyadic::ZERO }
        }
    }

    /// rho(e, t)^2 as numerator and denominator, and the point where the disks touch; `None` if the planes do not meet.
    pub(crate) fn rho_sq(&mut self, e: &At, t: &At) -> Option<(Dyadic, Dyadic, [Rational; 3])> {
        let (pe, pt) = (self.point(e), self.point(t));
        let (d, a) = (self.hodograph(e), self.hodograph(t));
        // q = C(t) - C(e) = big_q / big_w
        let q: [Dyadic; 3] = std::array::from_fn(|k| pt.x[k].mul(&pe.w).sub(&pe.x[k].mul(&pt.w)));
        let w = pt.w.mul(&pe.w);
        let u = cross3(&d, &a);
        let (aq, dq, uq) = (dot3(&a, &q), dot3(&d, &q), dot3(&u, &q));
        let (dd, aa, uu) = (dot3(&d, &d), dot3(&a, &a), dot3(&u, &u));
        let rational = |x: &[Dyadic; 3]| x.each_ref().map(Dyadic::rational);
        let (from, to) = (pe.cartesian(), pt.cartesian());
        if uu.m.is_zero() {
            let middle = std::array::from_fn(|k| (&from[k] + &to[k]) / Rational::from(BigInt::from(2)));
            let four = Dyadic { m: Int::from(4), e: 0 };
            return dq.m.is_zero().then(|| (dot3(&q, &q), four.mul(&w.sqr()), middle));
        }
        let (n1, n2, n3) = (aq.sqr().mul(&dd), dq.sqr().mul(&aa), uq.sqr());
        let den = uu.mul(&w.sqr());
        // the feet of the two centres on the common line
        let (dr, ar, uur, wr) = (rational(&d), rational(&a), uu.rational(), w.rational());
        let da = dot3(&d, &a).rational();
        let foot_e: [Rational; 3] =
            std::array::from_fn(|k| &from[k] + aq.rational() / (&wr * &uur) * (dd.rational() * &ar[k] - &da * &dr[k]));
        let foot_t: [Rational; 3] =
            std::array::from_fn(|k| &to[k] - dq.rational() / (&wr * &uur) * (aa.rational() * &dr[k] - &da * &ar[k]));
        if n1.cmp(&n2.add(&n3)).is_ge() {
            return Some((n1, den, foot_e));
        }
        if n2.cmp(&n1.add(&n3)).is_ge() {
            return Some((n2, den, foot_t));
        }
        let two = Dyadic { m: Int::from(2), e: 0 };
        let gap = n1.sub(&n2);
        let num = n1.add(&n2).mul(&n3).mul(&two).add(&n3.sqr()).add(&gap.sqr());
        let four = two.sqr();
        let share =
            (gap.rational() / n3.rational() + Rational::from(BigInt::from(1))) / Rational::from(BigInt::from(2));
        let x = std::array::from_fn(|k| &foot_t[k] + &share * (&foot_e[k] - &foot_t[k]));
        Some((num, n3.mul(&four).mul(&den), x))
    }

    /// W3: valleys of the distance to a point x near the middle of a doubly critical pair.
    pub(crate) fn valleys(&mut self, pair: &Candidate) -> Option<Witness> {
        let at = |(segment, t): (usize, f64)| At { segment, t: Dyadic::from_f64(t) };
        let (s, t) = self.polished(at(pair.s), at(pair.t), pair.radius);
        let (ps, pt) = (self.point(&s), self.point(&t));
        // the middle, to 70 bits beyond the distance
        let bits = 70 - decompose_exponent(pair.radius);
        let coordinate = |k: usize| {
            let num = ps.x[k].mul(&pt.w).add(&pt.x[k].mul(&ps.w));
            rounded_quotient(&num, &ps.w.mul(&pt.w), bits + 1, bits)
        };
        let x = Point { x: [0, 1, 2].map(coordinate), w: Dyadic::ONE };
        let radius = self.both_distances(&x, &ps, &pt, pair.radius)?;
        self.valley_pair(&x, &s, &t).then_some(())?;
        Some(Witness { radius, s: Some(s), t, x: Some(x.cartesian()) })
    }

    /// W3 for an end: x in the end's plane exactly, and a valley on the body.
    pub(crate) fn end_valley(&mut self, contact: &Contact) -> Option<Witness> {
        let e = self.end(contact.finish);
        let t = At { segment: contact.t.0, t: Dyadic::from_f64(contact.t.1) };
        let (pe, pt, d) = (self.point(&e), self.point(&t), self.hodograph(&e));
        // m = (C(e) + C(t)) / 2 = C(e) + q/2; x = m - (d.q / 2 d.d) d
        let q: [Dyadic; 3] = std::array::from_fn(|k| pt.x[k].mul(&pe.w).sub(&pe.x[k].mul(&pt.w)));
        let (dd, dq) = (dot3(&d, &d), dot3(&d, &q));
        let two = Dyadic { m: Int::from(2), e: 0 };
        let w = two.mul(&dd).mul(&pe.w).mul(&pt.w);
        let x = std::array::from_fn(|k| {
            let base = pe.x[k].mul(&two).mul(&dd).mul(&pt.w);
            base.add(&dd.mul(&q[k])).sub(&dq.mul(&d[k]))
        });
        let x = Point { x, w };
        let radius = self.both_distances(&x, &pe, &pt, contact.radius)?;
        let reach = |steps: &Dyadic| distance(self.frame, &e, &t).cmp(steps).is_gt();
        (3..50).map(step).find(|eta| reach(eta) && self.valley(&x, &t, eta).unwrap_or(false))?;
        Some(Witness { radius, s: Some(e), t, x: Some(x.cartesian()) })
    }

    /// The larger of |x - C(s)| and |x - C(t)|, as an f64 from above.
    pub(crate) fn both_distances(&mut self, x: &Point, ps: &Point, pt: &Point, near: f64) -> Option<f64> {
        let (a, b) = (distance_sq(x, ps), distance_sq(x, pt));
        least_f64(near, |r| [&a, &b].iter().all(|(num, den)| num.cmp(&r.sqr().mul(den)).is_le()))
    }

    pub(crate) fn valley_pair(&mut self, x: &Point, s: &At, t: &At) -> bool {
        let apart = distance(self.frame, s, t);
        let two = Dyadic { m: Int::from(2), e: 0 };
        for j in 3..50 {
            let eta = step(j);
            if apart.cmp(&eta.mul(&two)).is_gt()
                && self.valley(x, s, &eta).unwrap_or(false)
                && self.valley(x, t, &eta).unwrap_or(false)
            {
                return true;
            }
        }
        false
    }

    /// |x - C(t)| < |x - C(t +- eta)|; `None` if the spine ends before.
    pub(crate) fn valley(&mut self, x: &Point, t: &At, eta: &Dyadic) -> Option<bool> {
        let here = self.point(t);
        let (num, den) = distance_sq(x, &here);
        for side in [eta.clone(), Dyadic::ZERO.sub(eta)] {
            let rim = self.frame.step(t, &side)?;
            let (far, far_den) = distance_sq(x, &self.point(&rim));
            if num.mul(&far_den).cmp(&far.mul(&den)).is_ge() {
                return Some(false);
            }
        }
        Some(true)
    }

    /// Half the distance of a candidate after Newton with exact residuals, numerically.
    pub(crate) fn half_distance(&mut self, pair: &Candidate) -> f64 {
        let at = |(segment, t): (usize, f64)| At { segment, t: Dyadic::from_f64(t) };
        let (s, t) = self.polished(at(pair.s), at(pair.t), pair.radius);
        let (num, den) = distance_sq(&self.point(&s), &self.point(&t));
        0.5 * ratio(&num, &den).sqrt()
    }

    /// Newton with exact residuals, so that pairs far closer than f64 resolves are still found.
    pub(crate) fn polished(&mut self, mut s: At, mut t: At, radius: f64) -> (At, At) {
        if radius > POLISHED {
            return (s, t);
        }
        for _ in 0..4 {
            let (ps, pt) = (self.point(&s), self.point(&t));
            let (a, b) = (self.hodograph(&s), self.hodograph(&t));
            let q: [Dyadic; 3] = std::array::from_fn(|k| ps.x[k].mul(&pt.w).sub(&pt.x[k].mul(&ps.w)));
            // first order: q + C'(s) ds - C'(t) dt orthogonal to both tangents (curvature times distance is negligible)
            let (ws, wt) = (ps.w.sqr(), pt.w.sqr());
            let velocity = |a: &[Dyadic; 3], w: &Dyadic| a.each_ref().map(|a| ratio(a, w));
            let (a, b) = (velocity(&a, &ws), velocity(&b, &wt));
            let w = ps.w.mul(&pt.w);
            let q: V3 = q.each_ref().map(|q| ratio(q, &w));
            let d = super::tree::dot;
            let (aa, ab, bb, qa, qb) = (d(&a, &a), d(&a, &b), d(&b, &b), d(&q, &a), d(&q, &b));
            let det = aa * bb - ab * ab;
            let (ds, dt) = ((-qa * bb + qb * ab) / det, (qb * aa - qa * ab) / det);
            if !(ds.is_finite() && dt.is_finite()) || det < 1e-6 * aa * bb {
                break;
            }
            let moved = |at: &At, by: f64| self.frame.step(at, &truncated(&Dyadic::from_f64(by), 160));
            let (Some(next_s), Some(next_t)) = (moved(&s, ds), moved(&t, dt)) else { break };
            (s, t) = (next_s, next_t);
        }
        (s, t)
    }
}

/// |x - p|^2 as numerator and denominator.
pub(crate) fn distance_sq(x: &Point, p: &Point) -> (Dyadic, Dyadic) {
    let gap: [Dyadic; 3] = std::array::from_fn(|k| x.x[k].mul(&p.w).sub(&p.x[k].mul(&x.w)));
    (dot3(&gap, &gap), x.w.mul(&p.w).sqr())
}

/// Parameter distance in units of spans, round the closure if that is shorter.
pub(crate) fn distance(frame: &Frame, s: &At, t: &At) -> Dyadic {
    let position = |at: &At| Dyadic { m: Int::from(at.segment as i64), e: 0 }.add(&at.t);
    let (a, b) = (position(s), position(t));
    let gap = if a.cmp(&b).is_ge() { a.sub(&b) } else { b.sub(&a) };
    let around = Dyadic { m: Int::from(frame.segments.len() as i64), e: 0 }.sub(&gap);
    if frame.closed && around.cmp(&gap).is_lt() { around } else { gap }
}
