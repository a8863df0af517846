//! Exact upper bounds: the witnesses W1 to W4 of theory.md, section 2, and existence of a doubly critical pair. Candidates
//! come as f64; what is returned was checked in integers.

use super::body::Candidate;
use super::curvature::Peak;
use super::ends::{Contact, Of};
use super::frame::{At, Dyadic, ExactForms, Frame, cross3, dot3};
use super::tree::V3;
use crate::bernstein::{Form, Vec3, dot};
use crate::integer::{Int, decompose, ldexp};
use crate::number::Rational;
use crate::spine::Bezier;
use num_bigint::BigInt;
use num_integer::Integer;
use std::cmp::Ordering;

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

/// A proved self-contact: each parameter lies between two, the point in the hull of `points`.
#[derive(Debug, Clone)]
pub(crate) struct Touch {
    pub(crate) s: [At; 2],
    pub(crate) t: [At; 2],
    pub(crate) points: Option<Vec<[Rational; 3]>>,
}

impl<'f> Exact<'f> {
    pub(crate) fn new(frame: &'f Frame) -> Self {
        Self { frame, forms: frame.segments.iter().map(|_| None).collect() }
    }

    fn span(&mut self, segment: usize) -> &(ExactForms, Vec3<Int>) {
        let bezier = &self.frame.segments[segment];
        self.forms[segment].get_or_insert_with(|| (bezier.forms(), bezier.binormal()))
    }

    pub(crate) fn point(&mut self, at: &At) -> Point {
        let (forms, _) = self.span(at.segment);
        Point { x: forms.r.each_ref().map(|r| r.at(&at.t)), w: forms.w.at(&at.t) }
    }

    /// A positive multiple of the tangent.
    fn hodograph(&mut self, at: &At) -> [Dyadic; 3] {
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

    /// The squared radius at which the rims at an end and at t meet: |M|^2 / (w det)^2 where det != 0; where det = 0 and
    /// M = 0, the squared distance to the common line. `None` if they never meet.
    fn rims_sq(&mut self, e: &At, t: &At) -> Option<(Dyadic, Dyadic)> {
        let (m, det, [aq, dq, qq], [d, da], w) = self.rim_parts(e, t);
        let (mm, dd) = (dot3(&m, &m), det.sqr());
        if !dd.m.is_zero() {
            return Some((mm, dd));
        }
        if !mm.m.is_zero() {
            return None;
        }
        let uu = dot3(&da, &da);
        if !uu.m.is_zero() {
            return Some((aq.sqr().mul(&dot3(&d, &d)), uu.mul(&w.sqr())));
        }
        // parallel planes: the rims meet half way if it is the same plane
        let four = Dyadic { m: Int::from(4), e: 0 };
        dq.m.is_zero().then(|| (qq, four.mul(&w.sqr())))
    }

    /// 2 M and 2 w det of theory.md, section 5, up to one common factor; a.q, d.q, |q|^2; d and d x a; the weight of q.
    #[allow(clippy::type_complexity)]
    fn rim_parts(&mut self, e: &At, t: &At) -> ([Dyadic; 3], Dyadic, [Dyadic; 3], [[Dyadic; 3]; 2], Dyadic) {
        let (pe, pt) = (self.point(e), self.point(t));
        let (d, a) = (self.hodograph(e), self.hodograph(t));
        let q: [Dyadic; 3] = std::array::from_fn(|k| pt.x[k].mul(&pe.w).sub(&pe.x[k].mul(&pt.w)));
        let w = pt.w.mul(&pe.w);
        let (qd, da, aq, qq) = (cross3(&q, &d), cross3(&d, &a), dot3(&a, &q), dot3(&q, &q));
        let two = Dyadic { m: Int::from(2), e: 0 };
        let m = std::array::from_fn(|k| aq.mul(&qd[k]).mul(&two).add(&qq.mul(&da[k])));
        let det = dot3(&da, &q).mul(&w).mul(&two);
        (m, det, [aq, dot3(&d, &q), qq], [d, da], w)
    }

    /// Encloses the radius at which the disks, or the rims, at two points meet.
    pub(crate) fn meeting(&mut self, e: &At, t: &At, of: Of) -> Option<(f64, f64)> {
        let (num, den) = match of {
            Of::Disks => self.rho_sq(e, t).map(|(num, den, _)| (num, den))?,
            Of::Rims => self.rims_sq(e, t)?,
        };
        let near = ratio(&num, &den).sqrt();
        let hi = least_f64(near, |r| num.cmp(&r.sqr().mul(&den)).is_le())?;
        let lo = (near * (1.0 - 1e-14)).max(0.0);
        let below = Dyadic::from_f64(lo).sqr().mul(&den).cmp(&num).is_le();
        below.then_some((lo, hi))
    }

    /// Rims of a planar spine: M changes sign within 2^-40 of the candidate, and the common line is within `r` of the
    /// end all the way; returns r.
    pub(crate) fn planar_rims(&mut self, contact: &Contact) -> Option<f64> {
        plane(self.frame)?;
        let e = self.end(contact.finish);
        let (segment, t) = contact.t;
        for j in [44, 36, 28] {
            let (from, to) = (Dyadic::from_f64(t).sub(&step(j)), Dyadic::from_f64(t).add(&step(j)));
            let inside = from.m.sign().is_ge() && to.cmp(&Dyadic::ONE).is_le();
            if !inside {
                continue;
            }
            let signs = [&from, &to].map(|t| {
                let (m, ..) = self.rim_parts(&e, &At { segment, t: t.clone() });
                m.map(|x| x.m.sign())
            });
            if (0..3).any(|k| signs[0][k].is_ne() && signs[0][k] == signs[1][k].reverse()) {
                let near = contact.radius;
                let arc = self.frame.segments[segment].arc(&from, &to);
                let within = |r: &f64| super::ends::line_within(self.frame, contact.finish, &arc, *r);
                return [1e-15, 1e-13, 1e-11, 1e-10].map(|x| near * (1.0 + x)).iter().find(|r| within(r)).copied();
            }
        }
        None
    }

    /// Some two tangents of the arc between an end and t are more than 90 degrees apart: the pair is not local.
    pub(crate) fn not_local(&mut self, e: &At, t: &At) -> bool {
        let (low, high) = if *e == self.end(false) { (e, t) } else { (t, e) };
        let spans = (high.segment - low.segment + 1) as u32;
        let samples = (96 / spans).clamp(1, 24);
        let mut tangents = vec![self.hodograph(low), self.hodograph(high)];
        for segment in low.segment..=high.segment {
            for i in 0..=samples {
                let at = At { segment, t: Dyadic::from_f64(f64::from(i) / f64::from(samples)) };
                let before = segment == low.segment && at.t.cmp(&low.t).is_lt();
                let after = segment == high.segment && at.t.cmp(&high.t).is_gt();
                if !(before || after) {
                    tangents.push(self.hodograph(&at));
                }
            }
        }
        tangents.iter().any(|v| tangents.iter().any(|u| dot3(u, v).m.sign().is_lt()))
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
        let found = self.valley_pair(&x, &s, &t)?;
        debug_assert!(found);
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
        let eta = (3..50).map(step).find(|eta| reach(eta) && self.valley(&x, &t, eta).unwrap_or(false))?;
        debug_assert!(eta.m.sign().is_gt());
        Some(Witness { radius, s: Some(e), t, x: Some(x.cartesian()) })
    }

    /// The larger of |x - C(s)| and |x - C(t)|, as an f64 from above.
    fn both_distances(&mut self, x: &Point, ps: &Point, pt: &Point, near: f64) -> Option<f64> {
        let (a, b) = (distance_sq(x, ps), distance_sq(x, pt));
        least_f64(near, |r| [&a, &b].iter().all(|(num, den)| num.cmp(&r.sqr().mul(den)).is_le()))
    }

    fn valley_pair(&mut self, x: &Point, s: &At, t: &At) -> Option<bool> {
        let apart = distance(self.frame, s, t);
        let two = Dyadic { m: Int::from(2), e: 0 };
        for j in 3..50 {
            let eta = step(j);
            if apart.cmp(&eta.mul(&two)).is_gt()
                && self.valley(x, s, &eta).unwrap_or(false)
                && self.valley(x, t, &eta).unwrap_or(false)
            {
                return Some(true);
            }
        }
        None
    }

    /// |x - C(t)| < |x - C(t +- eta)|; `None` if the spine ends before.
    fn valley(&mut self, x: &Point, t: &At, eta: &Dyadic) -> Option<bool> {
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
    fn polished(&mut self, mut s: At, mut t: At, radius: f64) -> (At, At) {
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

    /// W4: the two parameters of a candidate are one point, exactly (small denominators), or a planar spine crosses
    /// itself there by change of sign (Miranda).
    pub(crate) fn self_contact(&mut self, pair: &Candidate) -> Option<Touch> {
        let exact = |(segment, t): (usize, f64)| simplest(t).map(|(num, den)| (segment, num, den));
        if let (Some(s), Some(t)) = (exact(pair.s), exact(pair.t))
            && self.same_point(&s, &t)
        {
            let around = |(segment, num, den): &(usize, Int, Int)| {
                let below =
                    rounded_quotient(&Dyadic { m: num.clone(), e: 0 }, &Dyadic { m: den.clone(), e: 0 }, 80, 80);
                let above = if den == &Int::ONE { below.clone() } else { below.add(&step(80)) };
                (*segment, below, above)
            };
            return Some(self.touch(around(&s), around(&t)));
        }
        let j = self.crosses(pair)?;
        let around = |(segment, t): (usize, f64)| {
            let t = truncated(&Dyadic::from_f64(t), 60);
            (segment, t.sub(&step(j)), t.add(&step(j)))
        };
        Some(self.touch(around(pair.s), around(pair.t)))
    }

    fn touch(&mut self, s: (usize, Dyadic, Dyadic), t: (usize, Dyadic, Dyadic)) -> Touch {
        let arc = self.frame.segments[s.0].arc(&s.1, &s.2);
        // w > 0 at both ends, but a control weight of a long arc may not be: then no box is given
        let points: Option<Vec<[Rational; 3]>> = (0..=arc.degree())
            .map(|i| {
                let [x, y, z, w] = arc.point(i);
                w.sign().is_gt().then(|| [x, y, z].map(|x| Rational::new(x.big(), w.big())))
            })
            .collect();
        let ends = |(segment, from, to): (usize, Dyadic, Dyadic)| [At { segment, t: from }, At { segment, t: to }];
        Touch { s: ends(s), t: ends(t), points }
    }

    fn same_point(&mut self, s: &(usize, Int, Int), t: &(usize, Int, Int)) -> bool {
        if same_parameter(self.frame, s, t) {
            return false;
        }
        let (p, q) = (self.homogeneous(s), self.homogeneous(t));
        (0..3).all(|k| &p[k] * &q[3] == &q[k] * &p[3])
    }

    /// Homogeneous point at a rational parameter num / den.
    fn homogeneous(&mut self, (segment, num, den): &(usize, Int, Int)) -> [Int; 4] {
        let (forms, _) = self.span(*segment);
        let n = forms.r[0].ds;
        let value = |f: &Form<Int>| at_ratio(f, num, den, n);
        [value(&forms.r[0]), value(&forms.r[1]), value(&forms.r[2]), value(&forms.w)]
    }

    /// q.a(s) = q.a(t) = 0 exactly at simple rational parameters.
    pub(crate) fn exactly_critical(&mut self, pair: &Candidate) -> bool {
        let exact = |(segment, t): (usize, f64)| simplest(t).map(|(num, den)| (segment, num, den));
        let (Some(s), Some(t)) = (exact(pair.s), exact(pair.t)) else { return false };
        if same_parameter(self.frame, &s, &t) {
            return false;
        }
        let (p, q) = (self.homogeneous(&s), self.homogeneous(&t));
        let gap: [Int; 3] = std::array::from_fn(|k| &(&p[k] * &q[3]) - &(&q[k] * &p[3]));
        [&s, &t].into_iter().all(|at| {
            let (forms, _) = self.span(at.0);
            let degree = forms.a[0].ds;
            let a = forms.a.each_ref().map(|a| at_ratio(a, &at.1, &at.2, degree));
            (0..3).fold(Int::ZERO, |sum, k| &sum + &(&a[k] * &gap[k])).is_zero()
        })
    }

    /// Half the distance at a candidate with simple rational parameters, from above.
    pub(crate) fn exact_half_distance(&mut self, pair: &Candidate) -> Option<f64> {
        let exact = |(segment, t): (usize, f64)| simplest(t).map(|(num, den)| (segment, num, den));
        let (s, t) = (exact(pair.s)?, exact(pair.t)?);
        let dyadic = |m: Int| Dyadic { m, e: 0 };
        let [p, q] = [self.homogeneous(&s), self.homogeneous(&t)]
            .map(|[x, y, z, w]| Point { x: [dyadic(x), dyadic(y), dyadic(z)], w: dyadic(w) });
        let (num, den) = distance_sq(&p, &q);
        let four = dyadic(Int::from(4));
        least_f64(pair.radius, |r| num.cmp(&r.sqr().mul(&den).mul(&four)).is_le())
    }

    /// A doubly critical pair exists in a small box round the candidate (Miranda on preconditioned F1, F2); returns an
    /// upper bound for half its distance.
    pub(crate) fn critical_box(&mut self, pair: &Candidate, jacobian: [[f64; 2]; 2]) -> Option<f64> {
        let inverse = inverse(jacobian)?;
        let at = |(segment, t): (usize, f64)| At { segment, t: Dyadic::from_f64(t) };
        let (s, t) = self.polished(at(pair.s), at(pair.t), pair.radius);
        let centre = [s, t].map(|at| At { segment: at.segment, t: truncated(&at.t, 100) });
        let fine = pair.radius < POLISHED;
        for j in [80, 60, 44, 34, 28, 22, 16].into_iter().skip(if fine { 0 } else { 2 }) {
            let Some((x, y)) = self.boxed(&centre, j) else { continue };
            let (fx, fy) = (x.forms(), y.forms());
            let y_forms = |v: &Vec3<Int>| v.clone().map(Form::transposed);
            let (ry, wy, ay) = (y_forms(&fy.r), fy.w.clone().transposed(), y_forms(&fy.a));
            let d: Vec3<Int> = std::array::from_fn(|k| fx.r[k].mul(&wy).sub(&ry[k].mul(&fx.w)));
            // q.C'(s) and q.C'(t) are D.a(s) and D.a(t) over w(s)^3 w(t) and w(s) w(t)^3: bring them to one scale
            let (ws, wt) = (&fx.w.c[0], &wy.c[0]);
            let (up, down) = (ws.bits() as i64, wt.bits() as i64);
            let ratio = ws.to_f64_shifted(up) / wt.to_f64_shifted(down);
            let mut second = dot(&d, &ay).scale(ratio * ratio);
            second.exp += 2 * (up + fx.w.exp - down - wy.exp);
            if opposite_faces(&dot(&d, &fx.a), &second, inverse) {
                return half_distance_above(&x, &y);
            }
        }
        None
    }

    /// Exact arcs of half width 2^-j round the two parameters; `None` across a joint or if they overlap.
    fn boxed(&self, [s, t]: &[At; 2], j: i64) -> Option<(Bezier, Bezier)> {
        let eta = step(j);
        let sides = |at: &At| {
            let (from, to) = (at.t.sub(&eta), at.t.add(&eta));
            let inside = from.m.sign().is_ge() && to.cmp(&Dyadic::ONE).is_le();
            inside.then(|| self.frame.segments[at.segment].arc(&from, &to))
        };
        let wide = Dyadic { m: Int::from(4), e: 0 }.mul(&eta);
        distance(self.frame, s, t).cmp(&wide).is_gt().then_some(())?;
        Some((sides(s)?, sides(t)?))
    }

    /// A planar spine that crosses itself near the candidate: D = 0 in a box of half width 2^-j, by Miranda; returns j.
    fn crosses(&mut self, pair: &Candidate) -> Option<i64> {
        let [i, k] = plane(self.frame)?;
        let centre = [pair.s, pair.t].map(|(segment, t)| At { segment, t: truncated(&Dyadic::from_f64(t), 60) });
        for j in [44, 34, 28, 22, 16, 10, 6] {
            let Some((x, y)) = self.boxed(&centre, j) else { continue };
            let (fx, fy) = (x.forms(), y.forms());
            let d =
                [i, k].map(|c| fx.r[c].mul(&fy.w.clone().transposed()).sub(&fy.r[c].clone().transposed().mul(&fx.w)));
            // dD/ds ~ a(s), dD/dt ~ -a(t), each up to a positive factor; scaled to one size
            let column = |forms: &ExactForms, sign: f64| {
                let top = [i, k].map(|c| forms.a[c].c[0].bits()).into_iter().max().unwrap_or(0) as i64;
                [i, k].map(|c| sign * forms.a[c].c[0].to_f64_shifted(top))
            };
            let (a, b) = (column(&fx, 1.0), column(&fy, -1.0));
            let inverse = inverse([[a[0], b[0]], [a[1], b[1]]])?;
            if opposite_faces(&d[0], &d[1], inverse) {
                return Some(j);
            }
        }
        None
    }
}

/// Miranda: with G = Y (F1, F2), G1 has opposite strict signs on the faces s = 0 and s = 1 of the unit square, G2 on
/// t = 0 and t = 1.
fn opposite_faces(f1: &Form<Int>, f2: &Form<Int>, y: [[f64; 2]; 2]) -> bool {
    let combine = |row: [f64; 2]| f1.clone().scale(row[0]).add(&f2.clone().scale(row[1]));
    let (g1, g2) = (combine(y[0]), combine(y[1]));
    let sign = |mut coefficients: Box<dyn Iterator<Item = &Int> + '_>| -> Ordering {
        let first = coefficients.next().map_or(Ordering::Equal, Int::sign);
        if coefficients.all(|c| c.sign() == first) { first } else { Ordering::Equal }
    };
    let width = |g: &Form<Int>| g.dt + 1;
    let row = |g: &'_ Form<Int>, i: usize| sign(Box::new(g.c[i * width(g)..(i + 1) * width(g)].iter()));
    let column = |g: &'_ Form<Int>, j: usize| sign(Box::new(g.c.iter().skip(j).step_by(width(g))));
    let opposite = |a: Ordering, b: Ordering| a != Ordering::Equal && a == b.reverse();
    opposite(row(&g1, 0), row(&g1, g1.ds)) && opposite(column(&g2, 0), column(&g2, g2.dt))
}

fn inverse(m: [[f64; 2]; 2]) -> Option<[[f64; 2]; 2]> {
    let det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    let inverse = [[m[1][1] / det, -m[0][1] / det], [-m[1][0] / det, m[0][0] / det]];
    inverse.iter().flatten().all(|x| x.is_finite()).then_some(inverse)
}

/// Half the largest distance between control points of two short arcs, from above.
fn half_distance_above(x: &Bezier, y: &Bezier) -> Option<f64> {
    let dyadic = |m: Int| Dyadic { m, e: 0 };
    let points = |b: &Bezier| -> Option<Vec<Point>> {
        (0..=b.degree())
            .map(|i| {
                let [x, y, z, w] = b.point(i);
                w.sign().is_gt().then(|| Point { x: [dyadic(x), dyadic(y), dyadic(z)], w: dyadic(w) })
            })
            .collect()
    };
    let (p, q) = (points(x)?, points(y)?);
    let mut largest = 0.0f64;
    for a in &p {
        for b in &q {
            let (num, den) = distance_sq(a, b);
            let near = ratio(&num, &den).sqrt();
            largest = largest.max(least_f64(near, |r| num.cmp(&r.sqr().mul(&den)).is_le())?);
        }
    }
    Some(largest * 0.5)
}

/// |x - p|^2 as numerator and denominator.
fn distance_sq(x: &Point, p: &Point) -> (Dyadic, Dyadic) {
    let gap: [Dyadic; 3] = std::array::from_fn(|k| x.x[k].mul(&p.w).sub(&p.x[k].mul(&x.w)));
    (dot3(&gap, &gap), x.w.mul(&p.w).sqr())
}

/// A small f64 at or above `near` that satisfies an exact monotone condition.
fn least_f64(near: f64, holds: impl Fn(&Dyadic) -> bool) -> Option<f64> {
    let mut r = near * (1.0 - 4.0 * f64::EPSILON);
    let mut step = f64::EPSILON;
    for _ in 0..60 {
        if holds(&Dyadic::from_f64(r)) {
            return Some(r);
        }
        r = (r * (1.0 + step)).next_up();
        step *= 2.0;
    }
    None
}

fn step(j: i64) -> Dyadic {
    Dyadic { m: Int::ONE, e: -j }
}

fn truncated(x: &Dyadic, bits: i64) -> Dyadic {
    if x.e >= -bits {
        return x.clone();
    }
    Dyadic { m: Int::from(x.m.big() >> (-bits - x.e) as u64), e: -bits }
}

fn decompose_exponent(x: f64) -> i64 {
    let (m, e) = decompose(x);
    e + 64 - i64::from(m.unsigned_abs().leading_zeros())
}

/// num / (den 2^extra) rounded down to a multiple of 2^-bits, where `extra` = `up` - `bits`.
fn rounded_quotient(num: &Dyadic, den: &Dyadic, up: i64, bits: i64) -> Dyadic {
    // num / den / 2^(up - bits) = m 2^-bits
    let shift = num.e - den.e - (up - bits) + bits;
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

/// Parameter distance in units of spans, round the closure if that is shorter.
fn distance(frame: &Frame, s: &At, t: &At) -> Dyadic {
    let position = |at: &At| Dyadic { m: Int::from(at.segment as i64), e: 0 }.add(&at.t);
    let (a, b) = (position(s), position(t));
    let gap = if a.cmp(&b).is_ge() { a.sub(&b) } else { b.sub(&a) };
    let around = Dyadic { m: Int::from(frame.segments.len() as i64), e: 0 }.sub(&gap);
    if frame.closed && around.cmp(&gap).is_lt() { around } else { gap }
}

fn same_parameter(frame: &Frame, s: &(usize, Int, Int), t: &(usize, Int, Int)) -> bool {
    let n = Int::from(frame.segments.len() as i64);
    let position = |(segment, num, den): &(usize, Int, Int)| (&(&Int::from(*segment as i64) * den) + num, den.clone());
    let ((a, p), (b, q)) = (position(s), position(t));
    let gap = (&(&a * &q) - &(&b * &p)).abs();
    gap.is_zero() || (frame.closed && gap == &(&p * &q) * &n)
}

/// sum of c[j] num^j (den - num)^(d-j), raised to the common degree.
fn at_ratio(form: &Form<Int>, num: &Int, den: &Int, degree: usize) -> Int {
    let rest = den - num;
    let (mut sum, mut power) = (Int::ZERO, Int::ONE);
    for c in form.c.iter().rev() {
        sum = &(&sum * num) + &(c * &power);
        power = &power * &rest;
    }
    (form.ds..degree).fold(sum, |sum, _| &sum * den)
}

/// The fraction of denominator at most 1000 within 1e-9 of t in [0, 1], by continued fractions.
fn simplest(t: f64) -> Option<(Int, Int)> {
    let (mut p, mut q) = ((0i64, 1i64), (1i64, 0i64));
    let mut x = t;
    for _ in 0..12 {
        let whole = x.floor();
        (p, q) = ((p.1, whole as i64 * p.1 + p.0), (q.1, whole as i64 * q.1 + q.0));
        if q.1 > 1000 {
            return None;
        }
        let (num, den) = (p.1, q.1);
        if (num as f64 / den as f64 - t).abs() < 1e-9 {
            return (num >= 0 && num <= den).then(|| (Int::from(num), Int::from(den)));
        }
        x = 1.0 / (x - whole);
        if !x.is_finite() || x > 1e15 {
            return None;
        }
    }
    None
}

/// Two coordinates on which a planar spine projects one to one; `None` if it is not planar.
pub(crate) fn plane(frame: &Frame) -> Option<[usize; 2]> {
    let points: Vec<[Int; 4]> = frame.segments.iter().flat_map(|b| (0..=b.degree()).map(|i| b.point(i))).collect();
    let minus =
        |p: &[Int; 4], q: &[Int; 4]| -> [Int; 3] { std::array::from_fn(|k| &(&p[k] * &q[3]) - &(&q[k] * &p[3])) };
    let cross = |a: &[Int; 3], b: &[Int; 3]| -> [Int; 3] {
        [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &(&a[i] * &b[j]) - &(&a[j] * &b[i]))
    };
    let base = points.iter().find(|p| !p[3].is_zero())?;
    let gaps: Vec<[Int; 3]> = points.iter().map(|p| minus(p, base)).collect();
    let first = gaps.iter().find(|g| g.iter().any(|x| !x.is_zero()))?;
    let normal = gaps.iter().map(|g| cross(first, g)).find(|n| n.iter().any(|x| !x.is_zero()))?;
    let inside = |g: &[Int; 3]| (0..3).fold(Int::ZERO, |sum, k| &sum + &(&normal[k] * &g[k])).is_zero();
    if !gaps.iter().all(inside) {
        return None;
    }
    let drop = (0..3).max_by_key(|&k| normal[k].abs())?;
    Some([(drop + 1) % 3, (drop + 2) % 3])
}
