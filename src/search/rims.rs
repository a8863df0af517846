//! Where the rims of disks meet (theory.md, section 5): the quantity of [M98], exactly.

use super::contact::plane;
use super::dyadic::{Dyadic, cross3, dot3, least_f64, ratio, step};
use super::ends::{Contact, Of};
use super::frame::{At, Frame};
use super::witness::{DiskPair, Exact};
use crate::integer::{Int, dot};
use crate::spine::Bezier;

impl DiskPair {
    /// 2 M of theory.md, section 5.
    fn rim_vector(&self) -> [Dyadic; 3] {
        let (qd, aq, qq) = (cross3(&self.q, &self.d), dot3(&self.a, &self.q), dot3(&self.q, &self.q));
        std::array::from_fn(|k| aq.mul(&qd[k]).mul(&Dyadic::from(2)).add(&qq.mul(&self.u[k])))
    }

    /// The squared radius at which the rims meet: |M|^2 / (w det)^2 where det != 0; where det = 0 and M = 0, the squared
    /// distance to the common line. `None` if they never meet.
    fn rims_sq(&self) -> Option<(Dyadic, Dyadic)> {
        let m = self.rim_vector();
        let (mm, det) = (dot3(&m, &m), dot3(&self.u, &self.q).mul(&self.w).mul(&Dyadic::from(2)));
        if !det.m.is_zero() {
            return Some((mm, det.sqr()));
        }
        if !mm.m.is_zero() {
            return None;
        }
        if self.parallel() {
            return self.parallel_sq();
        }
        Some(self.line_sq())
    }

    /// The squared distance of the first centre to the common line of two planes that are not parallel.
    fn line_sq(&self) -> (Dyadic, Dyadic) {
        let line = dot3(&self.a, &self.q).sqr().mul(&dot3(&self.d, &self.d));
        (line, dot3(&self.u, &self.u).mul(&self.w.sqr()))
    }
}

/// Are all tangents pairwise within 90 degrees, so that no two points of the spine make a pair that is not local? By the
/// control vectors of the hodograph on a few cells; exact, so that an arc of 90 degrees counts.
pub(crate) fn all_local(frame: &Frame) -> bool {
    const CELLS: u32 = 3;
    const MOST: usize = 300;
    let cells = |segment: &Bezier| -> Vec<[Int; 3]> {
        let cells = (0..1i64 << CELLS).map(|index| segment.cell(&Int::from(index), CELLS).forms().a);
        cells.flat_map(|a| (0..a[0].c.len()).map(move |i| a.each_ref().map(|a| a.c[i].clone()))).collect()
    };
    if (frame.segments.len() * 2 * frame.segments[0].degree()) << CELLS > MOST {
        return false;
    }
    let vectors: Vec<[Int; 3]> = frame.segments.iter().flat_map(cells).collect();
    let acute = |u: &[Int; 3], v: &[Int; 3]| dot(u, v).sign().is_ge();
    vectors.iter().all(|u| vectors.iter().all(|v| acute(u, v)))
}

impl Exact<'_> {
    /// Encloses the radius at which the disks, or the rims, at two points meet; `None` only if they never do.
    pub(crate) fn meeting(&mut self, e: &At, t: &At, of: Of) -> Option<(f64, f64)> {
        let pair = self.disk_pair(e, t);
        let (num, den) = match of {
            Of::Disks => pair.rho_sq()?,
            Of::Rims => pair.rims_sq()?,
        };
        let near = ratio(&num, &den).sqrt().min(f64::MAX);
        let below = |r: &f64| Dyadic::from_f64(*r).sqr().mul(&den).cmp(&num).is_le();
        let lo = Some(near * (1.0 - 1e-14)).filter(below).unwrap_or(0.0);
        let hi = least_f64(near, |r| num.cmp(&r.sqr().mul(&den)).is_le()).unwrap_or(f64::INFINITY);
        Some((lo, hi))
    }

    /// Rims of a planar spine: M changes sign near the candidate, and the common line is within `r` of the end all the
    /// way; returns r.
    pub(crate) fn planar_rims(&mut self, contact: &Contact) -> Option<f64> {
        plane(self.frame)?;
        let e = self.end(contact.finish);
        let (segment, t) = contact.t;
        let mut vector = |t: &Dyadic| self.disk_pair(&e, &At { segment, t: t.clone() }).rim_vector();
        let opposite = |u: &[Dyadic; 3], v: &[Dyadic; 3]| {
            let signs = |w: &[Dyadic; 3]| w.each_ref().map(|x| x.m.sign());
            signs(u).iter().zip(signs(v)).any(|(u, v)| u.is_ne() && *u == v.reverse())
        };
        let bracket = [44, 36, 28].into_iter().find_map(|j| {
            let (from, to) = (Dyadic::from_f64(t).sub(&step(j)), Dyadic::from_f64(t).add(&step(j)));
            let inside = from.m.sign().is_ge() && to.cmp(&Dyadic::ONE).is_le();
            (inside && opposite(&vector(&from), &vector(&to))).then_some((from, to))
        });
        let (mut from, mut to) = bracket?;
        // f64 places a contact at a small distance only so well
        for _ in 0..40 {
            let middle = from.add(&to).mul(&step(1));
            let at_middle = vector(&middle);
            if opposite(&vector(&from), &at_middle) {
                to = middle;
            } else if opposite(&at_middle, &vector(&to)) {
                from = middle;
            } else {
                break;
            }
        }
        // the contact is anywhere between
        let nearer = At { segment, t: if contact.finish { to.clone() } else { from.clone() } };
        if !self.not_local(&e, &nearer) {
            return None;
        }
        let (line, den) = self.disk_pair(&e, &At { segment, t: from.clone() }).line_sq();
        let near = ratio(&line, &den).sqrt();
        let arc = self.frame.segments[segment].arc(&from, &to);
        let within = |r: &f64| super::ends::line_within(self.frame, contact.finish, &arc, *r);
        [1e-15, 1e-13, 1e-11, 1e-10].map(|x| near * (1.0 + x)).into_iter().find(within)
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
                let at = At::near((segment, f64::from(i) / f64::from(samples)));
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
