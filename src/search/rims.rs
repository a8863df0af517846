//! Where the rims of disks meet (theory.md, section 5): the quantity of [M98], exactly.

use super::contact::plane;
use super::dyadic::{Dyadic, cross3, dot3, least_f64, ratio, step};
use super::ends::{Contact, Of};
use super::frame::At;
use super::witness::Exact;
use crate::integer::Int;

impl Exact<'_> {
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

    /// Encloses the radius at which the disks, or the rims, at two points meet; `None` only if they never do.
    pub(crate) fn meeting(&mut self, e: &At, t: &At, of: Of) -> Option<(f64, f64)> {
        let (num, den) = match of {
            Of::Disks => self.rho_sq(e, t).map(|(num, den, _)| (num, den))?,
            Of::Rims => self.rims_sq(e, t)?,
        };
        let near = ratio(&num, &den).sqrt().min(f64::MAX);
        let below = |r: &f64| Dyadic::from_f64(*r).sqr().mul(&den).cmp(&num).is_le();
        let lo = Some(near * (1.0 - 1e-14)).filter(below).unwrap_or(0.0);
        let hi = least_f64(near, |r| num.cmp(&r.sqr().mul(&den)).is_le()).unwrap_or(f64::INFINITY);
        Some((lo, hi))
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
        // about a hundred tangents, however long the arc: more would find little and cost much
        let spans = high.segment - low.segment + 1;
        let samples = (96 / spans.min(96)).clamp(1, 24) as u32;
        let mut tangents = vec![self.hodograph(low), self.hodograph(high)];
        for segment in (low.segment..=high.segment).step_by(spans / 48 + 1) {
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
}
