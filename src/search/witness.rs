//! Exact upper bounds: the witnesses W1 to W3 of theory.md, section 2. Candidates come as f64; what is returned was checked
//! in integers.

use super::curvature::{Peak, kappa_sq};
use super::dyadic::{Dyadic, cross3, decompose_exponent, dot3, least_f64, ratio, rounded_quotient, step, truncated};
use super::ends::Contact;
use super::frame::{At, ExactForms, Frame};
use super::newton::Candidate;
use super::tree::V3;
use crate::bernstein::Vec3;
use crate::certificate::{Foot, Upper};
use crate::integer::{Int, ldexp};
use crate::number::{Rational, compare};
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

/// The forms of a span and its b.
type Forms = (ExactForms, Vec3<Int>);

/// Exact evaluation of one spine, the forms of a span made when first needed; of most none ever are.
pub(crate) struct Exact<'f> {
    pub(crate) frame: &'f Frame,
    forms: Vec<Option<Box<Forms>>>,
}

/// Two disks, exactly: centres, tangent vectors d and a, q / w from the first centre to the second, u = d x a.
pub(crate) struct DiskPair {
    from: Point,
    to: Point,
    pub(crate) d: [Dyadic; 3],
    pub(crate) a: [Dyadic; 3],
    pub(crate) q: [Dyadic; 3],
    pub(crate) w: Dyadic,
    pub(crate) u: [Dyadic; 3],
}

impl DiskPair {
    pub(crate) fn parallel(&self) -> bool {
        self.u.iter().all(|x| x.m.is_zero())
    }

    /// rho^2 of parallel disks as numerator and denominator: |q|^2 / 4 in one plane; `None` in different ones.
    pub(crate) fn parallel_sq(&self) -> Option<(Dyadic, Dyadic)> {
        let one_plane = dot3(&self.d, &self.q).m.is_zero();
        one_plane.then(|| (dot3(&self.q, &self.q), Dyadic::from(4).mul(&self.w.sqr())))
    }

    /// d_e^2, d_t^2 and X of theory.md, section 5, each times |u|^2 w^2.
    fn distances(&self) -> [Dyadic; 3] {
        let (aq, dq, uq) = (dot3(&self.a, &self.q), dot3(&self.d, &self.q), dot3(&self.u, &self.q));
        [aq.sqr().mul(&dot3(&self.d, &self.d)), dq.sqr().mul(&dot3(&self.a, &self.a)), uq.sqr()]
    }

    /// rho^2 as numerator and denominator; `None` if the planes do not meet.
    pub(crate) fn rho_sq(&self) -> Option<(Dyadic, Dyadic)> {
        if self.parallel() {
            return self.parallel_sq();
        }
        let [n1, n2, n3] = self.distances();
        let den = dot3(&self.u, &self.u).mul(&self.w.sqr());
        if n1.cmp(&n2.add(&n3)).is_ge() {
            return Some((n1, den));
        }
        if n2.cmp(&n1.add(&n3)).is_ge() {
            return Some((n2, den));
        }
        let num = n1.add(&n2).mul(&n3).mul(&Dyadic::from(2)).add(&n3.sqr()).add(&n1.sub(&n2).sqr());
        Some((num, n3.mul(&Dyadic::from(4)).mul(&den)))
    }

    /// The point where disks of radius rho touch: the share of the two feet on the common line that is best there.
    fn contact(&self) -> [Rational; 3] {
        let (from, to) = (self.from.cartesian(), self.to.cartesian());
        let two = Rational::from(BigInt::from(2));
        if self.parallel() {
            return std::array::from_fn(|k| (&from[k] + &to[k]) / &two);
        }
        let [n1, n2, n3] = self.distances();
        let rational = |x: &[Dyadic; 3]| x.each_ref().map(Dyadic::rational);
        let (d, a) = (rational(&self.d), rational(&self.a));
        let [aa, dd, da] =
            [dot3(&self.a, &self.a), dot3(&self.d, &self.d), dot3(&self.d, &self.a)].map(|x| x.rational());
        let per = (dot3(&self.u, &self.u).mul(&self.w)).rational();
        let (aq, dq) = (dot3(&self.a, &self.q).rational() / &per, dot3(&self.d, &self.q).rational() / &per);
        let foot_e: [Rational; 3] = std::array::from_fn(|k| &from[k] + &aq * (&dd * &a[k] - &da * &d[k]));
        let foot_t: [Rational; 3] = std::array::from_fn(|k| &to[k] - &dq * (&aa * &d[k] - &da * &a[k]));
        if n1.cmp(&n2.add(&n3)).is_ge() {
            return foot_e;
        }
        if n2.cmp(&n1.add(&n3)).is_ge() {
            return foot_t;
        }
        let share = (n1.sub(&n2).rational() / n3.rational() + Rational::from(BigInt::from(1))) / two;
        std::array::from_fn(|k| &foot_t[k] + &share * (&foot_e[k] - &foot_t[k]))
    }
}

/// An exact upper bound for delta (unit box), with the points it rests on.
#[derive(Debug, Clone)]
pub(crate) struct Witness {
    pub(crate) radius: f64,
    pub(crate) s: Option<At>,
    pub(crate) t: At,
    pub(crate) x: Option<[Rational; 3]>,
    /// Half the widths of the valleys round s and t; `None` where x is in the normal plane itself.
    valleys: [Option<Dyadic>; 2],
}

impl Witness {
    /// The end of the valley round t that is nearer to the start, or to the finish, of the spine.
    pub(crate) fn valley_end(&self, frame: &Frame, finish: bool) -> Option<At> {
        let eta = self.valleys[1].as_ref()?;
        frame.step(&self.t, &if finish { eta.clone() } else { Dyadic::ZERO.sub(eta) })
    }

    /// As docs/certificate-format.md has it.
    pub(crate) fn upper(&self, frame: &Frame) -> Upper {
        let (Some(s), Some(x)) = (&self.s, &self.x) else {
            return Upper::Curvature { span: self.t.segment, t: self.t.t.rational() };
        };
        let [at_s, at_t] = [s, &self.t].map(|at| Rational::from(BigInt::from(at.segment)) + at.t.rational());
        let foot = |at: &Rational, eta: &Option<Dyadic>| match eta.as_ref().map(Dyadic::rational) {
            Some(eta) => Foot::Valley([at - &eta, at.clone(), at + &eta]),
            None => Foot::Plane(at.clone()),
        };
        let mut feet = [foot(&at_s, &self.valleys[0]), foot(&at_t, &self.valleys[1])];
        if compare(&at_s, &at_t).is_gt() {
            feet.reverse();
        }
        Upper::Contact { x: frame.point(x), feet }
    }
}

impl<'f> Exact<'f> {
    pub(crate) fn new(frame: &'f Frame) -> Self {
        Self { frame, forms: frame.segments.iter().map(|_| None).collect() }
    }

    pub(crate) fn span(&mut self, segment: usize) -> &Forms {
        let bezier = &self.frame.segments[segment];
        self.forms[segment].get_or_insert_with(|| Box::new((bezier.forms(), bezier.binormal())))
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

    /// W1: the least f64 radius R with kappa(t)^2 >= 1/R^2, at the peak or at a simple parameter next to it.
    pub(crate) fn curved(&mut self, peak: &Peak) -> Option<Witness> {
        let (forms, b) = self.span(peak.segment);
        let rounded = |bits| ldexp(ldexp(peak.t, bits).round(), -bits);
        let places =
            [peak.t, rounded(20), rounded(8)].map(|t| (t, kappa_sq(&forms.a, b, &forms.w, &Dyadic::from_f64(t))));
        let most = |(_, [num, den]): &(f64, [Dyadic; 2]), (_, [other, per]): &(f64, [Dyadic; 2])| {
            num.mul(per).cmp(&other.mul(den))
        };
        let (t, [num, den]) = places.into_iter().max_by(most)?;
        let radius = least_f64(peak.radius, |r| den.cmp(&r.sqr().mul(&num)).is_le())?;
        Some(Witness { radius, s: None, t: At::near((peak.segment, t)), x: None, valleys: [None, None] })
    }

    /// W2 at an end of the spine and a point: rho(e, t)^2 is rational, no root is needed.
    pub(crate) fn disks(&mut self, contact: &Contact) -> Option<Witness> {
        let end = self.end(contact.finish);
        let at = At::near(contact.t);
        if distance(self.frame, &end, &at).m.is_zero() {
            return None; // one point is no pair
        }
        let disks = self.disk_pair(&end, &at);
        let (num, den) = disks.rho_sq()?;
        let radius = least_f64(contact.radius, |r| num.cmp(&r.sqr().mul(&den)).is_le())?;
        let x = Some(disks.contact());
        Some(Witness { radius, s: Some(end), t: at, x, valleys: [None, None] })
    }

    pub(crate) fn end(&self, finish: bool) -> At {
        if finish {
            At { segment: self.frame.segments.len() - 1, t: Dyadic::ONE }
        } else {
            At { segment: 0, t: Dyadic::ZERO }
        }
    }

    pub(crate) fn disk_pair(&mut self, e: &At, t: &At) -> DiskPair {
        let (from, to) = (self.point(e), self.point(t));
        let (d, a) = (self.hodograph(e), self.hodograph(t));
        let (q, w) = gap(&from, &to);
        let u = cross3(&d, &a);
        DiskPair { from, to, d, a, q, w, u }
    }

    /// W3: valleys of the distance to a point x near the middle of a doubly critical pair.
    pub(crate) fn valleys(&mut self, pair: &Candidate) -> Option<Witness> {
        let (s, t) = self.polished(At::near(pair.s), At::near(pair.t), pair.radius);
        let (ps, pt) = (self.point(&s), self.point(&t));
        // the middle, to 70 bits beyond the distance
        let bits = 70 - decompose_exponent(pair.radius);
        let coordinate = |k: usize| {
            let num = ps.x[k].mul(&pt.w).add(&pt.x[k].mul(&ps.w));
            rounded_quotient(&num, &Dyadic::from(2).mul(&ps.w).mul(&pt.w), bits)
        };
        let x = Point { x: [0, 1, 2].map(coordinate), w: Dyadic::ONE };
        let radius = self.both_distances(&x, &ps, &pt, pair.radius)?;
        let eta = self.valley_pair(&x, &s, &t)?;
        Some(Witness { radius, s: Some(s), t, x: Some(x.cartesian()), valleys: [Some(eta.clone()), Some(eta)] })
    }

    /// W3 for an end: x in the end's plane exactly, and a valley on the body.
    pub(crate) fn end_valley(&mut self, contact: &Contact) -> Option<Witness> {
        let e = self.end(contact.finish);
        let t = At::near(contact.t);
        let (pe, pt, d) = (self.point(&e), self.point(&t), self.hodograph(&e));
        // m = (C(e) + C(t)) / 2 = C(e) + q/2; x = m - (d.q / 2 d.d) d
        let (q, _) = gap(&pe, &pt);
        let (dd, dq) = (dot3(&d, &d), dot3(&d, &q));
        let two = Dyadic::from(2);
        let w = two.mul(&dd).mul(&pe.w).mul(&pt.w);
        let x = std::array::from_fn(|k| {
            let base = pe.x[k].mul(&two).mul(&dd).mul(&pt.w);
            base.add(&dd.mul(&q[k])).sub(&dq.mul(&d[k]))
        });
        let x = Point { x, w };
        let radius = self.both_distances(&x, &pe, &pt, contact.radius)?;
        let reach = |steps: &Dyadic| distance(self.frame, &e, &t).cmp(steps).is_gt();
        let eta = (3..50).map(step).find(|eta| reach(eta) && self.valley(&x, &t, eta).unwrap_or(false))?;
        Some(Witness { radius, s: Some(e), t, x: Some(x.cartesian()), valleys: [None, Some(eta)] })
    }

    /// The larger of |x - C(s)| and |x - C(t)|, as an f64 from above.
    fn both_distances(&mut self, x: &Point, ps: &Point, pt: &Point, near: f64) -> Option<f64> {
        let (a, b) = (distance_sq(x, ps), distance_sq(x, pt));
        least_f64(near, |r| [&a, &b].iter().all(|(num, den)| num.cmp(&r.sqr().mul(den)).is_le()))
    }

    /// The half width of two valleys that do not overlap.
    fn valley_pair(&mut self, x: &Point, s: &At, t: &At) -> Option<Dyadic> {
        let apart = distance(self.frame, s, t);
        (3..50).map(|j| (step(j), step(j - 1))).find_map(|(eta, both)| {
            let valleys = apart.cmp(&both).is_gt()
                && self.valley(x, s, &eta).unwrap_or(false)
                && self.valley(x, t, &eta).unwrap_or(false);
            valleys.then_some(eta)
        })
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
        let (s, t) = self.polished(At::near(pair.s), At::near(pair.t), pair.radius);
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
            let (q, w) = gap(&pt, &ps);
            // first order: q + C'(s) ds - C'(t) dt orthogonal to both tangents (curvature times distance is negligible)
            let (ws, wt) = (ps.w.sqr(), pt.w.sqr());
            let velocity = |a: &[Dyadic; 3], w: &Dyadic| a.each_ref().map(|a| ratio(a, w));
            let (a, b) = (velocity(&a, &ws), velocity(&b, &wt));
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

/// The vector from one point to another, as numerators and their weight.
fn gap(from: &Point, to: &Point) -> ([Dyadic; 3], Dyadic) {
    let q = std::array::from_fn(|k| to.x[k].mul(&from.w).sub(&from.x[k].mul(&to.w)));
    (q, to.w.mul(&from.w))
}

/// |x - p|^2 as numerator and denominator.
pub(crate) fn distance_sq(x: &Point, p: &Point) -> (Dyadic, Dyadic) {
    let (gap, w) = gap(p, x);
    (dot3(&gap, &gap), w.sqr())
}

/// Parameter distance in units of spans, round the closure if that is shorter.
pub(crate) fn distance(frame: &Frame, s: &At, t: &At) -> Dyadic {
    let position = |at: &At| Dyadic::from(at.segment as i64).add(&at.t);
    let (a, b) = (position(s), position(t));
    let gap = if a.cmp(&b).is_ge() { a.sub(&b) } else { b.sub(&a) };
    let around = Dyadic::from(frame.segments.len() as i64).sub(&gap);
    if frame.closed && around.cmp(&gap).is_lt() { around } else { gap }
}
