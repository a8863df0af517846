//! End to body (theory.md, section 5): the end disk of an open spine misses every other disk of the same radius.
//!
//! For an end e and a point t of the body put d = a(e), a = a(t), q = C(t) - C(e), u = d x a. On the line in which the
//! two normal planes meet, every share k in [0, 1] gives
//!   rho^2 >= k d_e^2 + (1-k) d_t^2 + k (1-k) X,   with equality for the best k,
//! so disks of radius r are disjoint as soon as, for one k,
//!   k (a.q)^2 |d|^2 + (1-k) (d.q)^2 |a|^2 + k (1-k) (u.q)^2 - r^2 |u|^2 > 0,
//! which also holds the case u = 0 (then a.q != 0 or d.q != 0, and the planes differ). A fixed k per cell leaves a
//! polynomial in t. The other rules: |q| > 2r, and Lemma L next to the end.

use super::apart::{balls_apart, direction, exact_points};
use super::body::floor;
use super::curvature::golden;
use super::dyadic::{Dyadic, ratio};
use super::evidence::{Fault, planted};
use super::frame::{At, Frame};
use super::meter::Meter;
use super::rules::{UNITS, first_true, in_units};
use super::tree::{Cell, Id, ROUNDING, Tree, V3, cross, dot, norm, sub, unit};
use super::witness::{Exact, POLISHED};
use crate::bernstein::{self as form, Ball, Form, Scalar, UNIT, Vec3};
use crate::certificate::Node;
use crate::enclosure::Interval;
use crate::integer::{Int, ldexp};
use crate::spine::Bezier;

/// A numerical contact of an end disk with the disk at t.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Contact {
    /// The end: start or finish.
    pub(crate) finish: bool,
    pub(crate) t: (usize, f64),
    pub(crate) radius: f64,
}

/// How narrowly the frontier of the local pairs is located for a term of its own, in the unit box.
const FRONTIER: f64 = 1e-9;

/// So many cells that f64 places badly are tried once more.
const KINKS: u32 = 8;

/// What must not meet: the disks, or only their rims (the quantity of [M98]).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Of {
    Disks,
    Rims,
}

/// Proves that the disk (or rim) of `radius` at one end misses all others, except those at points that make a local
/// pair with the end; shrinks the radius until that is so. Infinite if every pair is local.
pub(crate) fn end_to_body(
    tree: &mut Tree,
    finish: bool,
    of: Of,
    start: f64,
    own_term: bool,
    margin: f64,
    meter: &mut Meter,
) -> (f64, Option<Contact>) {
    let mut search = Search::new(tree, finish, of, start, own_term, margin);
    let mut open = vec![search.tree.root()];
    while let Some(id) = open.pop() {
        if search.radius < floor(start) {
            return (0.0, search.contact);
        }
        if search.closed(id) {
            continue;
        }
        let children = if meter.tick() { search.tree.children(id) } else { None };
        let Some((left, right)) = children else {
            search.give_up(id);
            continue;
        };
        // nearest to the end on top
        open.extend(if finish { [left, right] } else { [right, left] });
    }
    (if search.broken { search.radius } else { f64::INFINITY }, search.contact)
}

/// The end in every arithmetic: homogeneous point and tangent vector.
struct End {
    finish: bool,
    place: (usize, f64),
    point: V3,
    tangent: V3,
    exact_point: [Int; 4],
    exact_tangent: [Int; 3],
}

impl End {
    fn new(frame: &Frame, finish: bool) -> Self {
        let segment = if finish { frame.segments.len() - 1 } else { 0 };
        let bezier = &frame.segments[segment];
        let exact_point = bezier.point(if finish { bezier.degree() } else { 0 });
        let exact_tangent = bezier.end_tangent(finish);
        let whole = |m: &Int| Dyadic { m: m.clone(), e: 0 };
        let point = [0, 1, 2].map(|k| ratio(&whole(&exact_point[k]), &whole(&exact_point[3])));
        let drop = exact_tangent.iter().map(|x| x.bits() as i64).max().unwrap_or(0);
        let tangent = exact_tangent.each_ref().map(|x| x.to_f64_shifted(drop));
        Self { finish, place: (segment, if finish { 1.0 } else { 0.0 }), point, tangent, exact_point, exact_tangent }
    }
}

/// The polynomials of one arc against the end: q up to a positive factor, the weight w with the same factor.
struct Against<T: Scalar> {
    q: Vec3<T>,
    w: Form<T>,
    a: Vec3<T>,
    d: Vec3<T>,
}

impl<T: Scalar> Against<T> {
    /// |q|^2 - 4 r^2.
    fn far(&self, r: f64) -> Option<bool> {
        form::dot(&self.q, &self.q).sub(&self.w.clone().scale(2.0 * r).sqr()).positive()
    }

    /// Rims: the circles of radius r meet iff |M| = r |w det|, with M = (a.q)(q x d) + |q|^2/2 (d x a) and
    /// det = d.(a x q), or both vanish; so |M|^2 - r^2 (w det)^2 > 0 keeps contacts above r.
    fn rims_apart(&self, r: f64) -> Option<bool> {
        let (aq, qq) = (form::dot(&self.a, &self.q), form::dot(&self.q, &self.q).scale(0.5));
        let (qd, da) = (form::cross(&self.q, &self.d), form::cross(&self.d, &self.a));
        let m: Vec3<T> = std::array::from_fn(|k| aq.mul(&qd[k]).add(&qq.mul(&da[k])));
        let det = form::dot(&da, &self.q).mul(&self.w).scale(r);
        form::dot(&m, &m).sub(&det.sqr()).positive()
    }

    /// Does any rule close the arc at radius r?
    fn closed(&self, of: Of, r: f64, share: f64) -> Option<bool> {
        let rims = || if of == Of::Rims { self.rims_apart(r) } else { Some(false) };
        let rules: [&dyn Fn() -> Option<bool>; 3] = [&|| self.far(r), &|| self.apart(r, share), &rims];
        first_true(rules)
    }

    /// The rule of the module for one share.
    fn apart(&self, r: f64, share: f64) -> Option<bool> {
        let u = form::cross(&self.d, &self.a);
        let square = |x: &Vec3<T>, y: &Vec3<T>| form::dot(x, y).sqr();
        let first = square(&self.a, &self.q).mul(&form::dot(&self.d, &self.d)).scale(share);
        let second = square(&self.d, &self.q).mul(&form::dot(&self.a, &self.a)).scale(1.0 - share);
        let third = square(&u, &self.q).scale(share).scale(1.0 - share);
        let fourth = form::dot(&u, &u).mul(&self.w.clone().scale(r).sqr());
        first.add(&second).add(&third).sub(&fourth).positive()
    }
}

/// What rho is made of, numerically, at one t: d_e^2 |u|^2 and so on, with |d| = |a| = 1.
#[derive(Clone, Copy)]
struct Terms {
    e: f64,
    t: f64,
    x: f64,
    u: f64,
}

impl Terms {
    /// Least over the common line of the larger distance, squared; infinite where the planes are (nearly) parallel.
    fn rho_sq(&self) -> f64 {
        if self.u < 1e-8 {
            return f64::INFINITY;
        }
        let share = if self.x > 0.0 {
            (0.5 + 0.5 * (self.e - self.t) / self.x).clamp(0.0, 1.0)
        } else {
            f64::from(u8::from(self.e > self.t))
        };
        self.at(share) / self.u
    }

    fn at(&self, share: f64) -> f64 {
        share * self.e + (1.0 - share) * self.t + share * (1.0 - share) * self.x
    }
}

pub(super) struct Search<'t, 'f> {
    pub(super) tree: &'t mut Tree<'f>,
    exact: Exact<'f>,
    end: End,
    of: Of,
    /// Is the term sought for itself, not only as far as it binds?
    own_term: bool,
    /// Rims of a planar spine, where the determinant vanishes identically.
    planar: bool,
    margin: f64,
    radius: f64,
    contact: Option<Contact>,
    /// The arcs from the end up to here, while everything so far was closed as local.
    reach: Vec<Id>,
    broken: bool,
    /// Cells that were to be given up so far.
    kinks: u32,
}

impl<'t, 'f> Search<'t, 'f> {
    pub(super) fn new(tree: &'t mut Tree<'f>, finish: bool, of: Of, start: f64, own_term: bool, margin: f64) -> Self {
        let frame = tree.frame;
        Self {
            exact: Exact::new(frame),
            end: End::new(frame, finish),
            planar: of == Of::Rims && super::contact::plane(frame).is_some(),
            tree,
            of,
            own_term,
            margin,
            radius: start.min(1e150),
            contact: None,
            reach: vec![],
            broken: false,
            kinks: 0,
        }
    }

    /// A vector within 45 degrees of all tangents from the end to as far as needed: the middle between the tangents at both
    /// ends of that arc.
    pub(super) fn axis_of_local(&mut self) -> V3 {
        let here = unit(&self.end.tangent);
        let (mut open, mut axis) = (vec![self.tree.root()], here);
        while let Some(id) = open.pop() {
            let there = unit(&self.tree.tangent(id, !self.end.finish));
            let middle = unit(&std::array::from_fn(|k| here[k] + there[k]));
            let near = |id: &Id| self.tree.node(*id).cone.within_45_degrees_of(&middle);
            if near(&id) && self.reach.iter().all(near) {
                self.reach.push(id);
                axis = middle;
                continue;
            }
            if self.leaf(id).is_some() {
                break;
            }
            let Some((left, right)) = self.tree.children(id) else { break };
            open.extend(if self.end.finish { [left, right] } else { [right, left] });
        }
        axis
    }

    /// A rule of docs/certificate-format.md that closes the node, other than `local`.
    pub(super) fn leaf(&self, id: Id) -> Option<Node> {
        let node = self.tree.node(id);
        let q0 = sub(&node.mid, &self.end.point);
        if let Some(u) = balls_apart(&q0, node.rad + 8.0 * ROUNDING, self.radius) {
            return Some(Node::Slab(u));
        }
        let cell = self.tree.cell(id).filter(|c| !c.p.is_empty())?;
        let e = 2.0 * cell.p_err + 8.0 * ROUNDING;
        let exact = || (exact_points(&cell.exact(self.tree.frame)), vec![self.end.exact_point.clone()]);
        let end = std::slice::from_ref(&self.end.point);
        if let Some(u) = direction(&q0, cell.p, end, e, self.radius, exact) {
            return Some(Node::Slab(u));
        }
        let h = ldexp(1.0, -i64::from(cell.depth));
        let share = in_units(self.share(cell.segment, cell.index as f64 * h, h));
        let closed = against(cell, &self.end).apart(self.radius, share);
        let closed = closed
            .unwrap_or_else(|| exact_against(self.tree.frame, cell, &self.end).apart(self.radius, share) == Some(true));
        (closed || planted(Fault::ShareUnproved)).then_some(Node::Share((share * UNITS) as i64))
    }

    fn gap(&self, id: Id) -> f64 {
        let node = self.tree.node(id);
        norm(&sub(&node.mid, &self.end.point)) * (1.0 - ROUNDING) - node.rad * (1.0 + ROUNDING) - 8.0 * ROUNDING
    }

    fn give_up(&mut self, id: Id) {
        self.broken = true;
        self.radius = self.radius.min((0.5 * self.gap(id) * (1.0 - ROUNDING)).max(0.0));
    }

    /// Are all pairs of points of an arc next to `reach` and of `reach` local: tangents pairwise within 90 degrees?
    fn local(&mut self, id: Id) -> bool {
        let node = self.tree.node(id);
        let (cone, rad) = (node.cone, node.rad);
        if !cone.within_45_degrees() {
            return false;
        }
        let mut open: Vec<Id> = self.reach.clone();
        while let Some(other) = open.pop() {
            let part = self.tree.node(other);
            if part.cone.within_90_degrees_of(&cone) {
                continue;
            }
            // opened down to the size of the node: coarser cones would end the arc too early
            let parts = if part.rad > rad { self.tree.children(other) } else { None };
            let Some((left, right)) = parts else { return false };
            open.extend([left, right]);
        }
        true
    }

    fn closed(&mut self, id: Id) -> bool {
        if !self.broken && self.local(id) {
            self.reach.push(id);
            return true;
        }
        // a term of its own: its radius may be above 1/kappa_max, so local pairs are to be left out to the last
        if !self.broken && self.own_term && self.tree.node(id).rad > FRONTIER {
            return false;
        }
        if self.gap(id) > 2.0 * self.radius {
            self.broken = true;
            return true;
        }
        let Some(cell) = self.tree.cell(id).filter(|c| !c.p.is_empty()) else { return false };
        let h = ldexp(1.0, -i64::from(cell.depth));
        let (segment, from) = (cell.segment, cell.index as f64 * h);
        self.climb(segment, from, h);
        if self.tree.reaches_end(id, self.end.finish) {
            // there q = 0 and u = 0: no polynomial of any rule is positive
            return false;
        }
        let (node, gap) = (self.tree.node(id), self.gap(id));
        let Some(cell) = self.tree.cell(id) else { return false };
        let share = self.share(segment, from, h);
        let closed = against(cell, &self.end).closed(self.of, self.radius, share);
        if closed.unwrap_or_else(|| self.closed_exactly(cell, share)) {
            self.broken = true;
            return true;
        }
        // so small that splitting says nothing more about the distance
        let blurred = node.rad <= 8.0 * cell.p_err;
        if gap > 0.0 && (blurred || node.rad < 1e-3 * self.margin * gap) {
            // a few times: along an arc that f64 cannot tell from a contact it would not end
            self.kinks += 1;
            if self.kinks > KINKS || !self.closed_below_a_kink(id, share) {
                self.give_up(id);
            }
            return true;
        }
        false
    }

    /// rho may have a kink where f64 does not place it well: a little less is true there, and more than giving up.
    fn closed_below_a_kink(&mut self, id: Id, share: f64) -> bool {
        let Some(cell) = self.tree.cell(id) else { return false };
        let middle = (cell.index as f64 + 0.5) * ldexp(1.0, -i64::from(cell.depth));
        let off = 16.0 * f64::EPSILON * norm(&self.tree.evaluate(cell.segment, middle)[1]);
        let before = self.radius;
        self.radius = (before - off).max(0.5 * before);
        let closed = self.tree.cell(id).is_some_and(|cell| self.closed_exactly(cell, share));
        if closed {
            self.broken = true
        } else {
            self.radius = before
        }
        closed
    }

    /// The same from the exact arc: intervals, then integers.
    fn closed_exactly(&self, cell: Cell, share: f64) -> bool {
        let exact = exact_against(self.tree.frame, cell, &self.end);
        let near = Against {
            q: exact.q.each_ref().map(Interval::cast),
            w: Interval::cast(&exact.w),
            a: exact.a.each_ref().map(Interval::cast),
            d: exact.d.each_ref().map(Interval::cast),
        };
        let near = near.closed(self.of, self.radius, share);
        near.unwrap_or_else(|| exact.closed(self.of, self.radius, share) == Some(true))
    }

    fn terms(&self, segment: usize, t: f64) -> Terms {
        let [c, c1, _] = self.tree.evaluate(segment, t);
        let (a, d, q) = (unit(&c1), unit(&self.end.tangent), sub(&c, &self.end.point));
        let u = cross(&d, &a);
        let sq = |x: f64| x * x;
        Terms { e: sq(dot(&a, &q)), t: sq(dot(&d, &q)), x: sq(dot(&u, &q)), u: dot(&u, &u) }
    }

    /// The share that leaves the most at the ends and the middle of the cell.
    fn share(&self, segment: usize, from: f64, h: f64) -> f64 {
        let samples = [0.0, 0.5, 1.0].map(|x| self.terms(segment, from + x * h));
        let r_sq = self.radius * self.radius;
        let worst = |k: f64| -samples.iter().map(|s| s.at(k) - r_sq * s.u).fold(f64::INFINITY, f64::min);
        let (share, _) = golden(worst, 0.5, 0.5);
        ldexp(ldexp(share, 30).round(), -30)
    }

    /// Looks for a contact in the cell: at its ends and middle, then golden section.
    fn climb(&mut self, segment: usize, from: f64, h: f64) {
        let value = |t: f64| {
            // next to the end itself rho tends to 1/kappa: no contact
            let own = segment == self.end.place.0 && (t - self.end.place.1).abs() < 1e-6;
            match self.of {
                _ if own => f64::INFINITY,
                Of::Disks => self.terms(segment, t).rho_sq().sqrt(),
                Of::Rims => self.rim(segment, t).0,
            }
        };
        let (t, mut radius) = if self.planar {
            // the normals meet at equal distances where this changes sign
            let gap = |t: f64| self.rim(segment, t).1;
            let (mut lo, mut hi) = (from, from + h);
            if gap(lo) * gap(hi) > 0.0 {
                return;
            }
            for _ in 0..60 {
                let middle = 0.5 * (lo + hi);
                if gap(lo) * gap(middle) <= 0.0 { hi = middle } else { lo = middle }
            }
            (lo, self.terms(segment, lo).rho_sq().sqrt())
        } else if let Some(contact) = self.one_plane(segment, from, h).filter(|_| self.of == Of::Disks) {
            contact
        } else {
            if [0.0, 0.5, 1.0].iter().all(|x| value(from + x * h) >= self.radius) {
                return;
            }
            golden(value, from + 0.5 * h, h)
        };
        if radius < POLISHED {
            // f64 differences no longer give the distance to 12 digits
            let end = self.exact.end(self.end.finish);
            radius = self.exact.meeting(&end, &At::near((segment, t)), self.of).map_or(radius, |(_, hi)| hi);
        }
        if radius * (1.0 - self.margin) < self.radius {
            self.radius = radius * (1.0 - self.margin);
            self.contact = Some(Contact { finish: self.end.finish, t: (segment, t), radius });
        }
    }

    /// A point of the cell whose disk lies in the plane of the end disk, and half its distance: rho jumps there, so the
    /// foot is found by Newton's method for d.q = 0.
    fn one_plane(&self, segment: usize, from: f64, h: f64) -> Option<(f64, f64)> {
        let d = &self.end.tangent;
        let mut t = from + 0.5 * h;
        for _ in 0..6 {
            let [c, c1, _] = self.tree.evaluate(segment, t);
            let q = sub(&c, &self.end.point);
            let (size, speed) = (norm(&q), norm(&c1));
            if norm(&cross(d, &c1)) > 1e-6 * speed * norm(d) {
                return None;
            }
            if dot(d, &q).abs() < 1e-14 && size > 1e-12 {
                return Some((t, 0.5 * size));
            }
            t = (t - dot(d, &q) / dot(d, &c1)).clamp(from.max(0.0), (from + h).min(1.0));
        }
        None
    }

    /// The radius at which the rims meet, and M along the largest coordinate of d x a (its sign, on planar spines).
    fn rim(&self, segment: usize, t: f64) -> (f64, f64) {
        let [c, c1, _] = self.tree.evaluate(segment, t);
        let speed = norm(&c1);
        let (a, d, q) = (c1.map(|x| x / speed), &self.end.tangent, sub(&c, &self.end.point));
        let (qd, da) = (cross(&q, d), cross(d, &a));
        let (aq, half) = (dot(&a, &q), 0.5 * dot(&q, &q));
        let m: V3 = std::array::from_fn(|k| aq * qd[k] + half * da[k]);
        let det = dot(&da, &q).abs();
        let radius = if det > 1e-7 * norm(&q) * norm(&da) { norm(&m) / det } else { f64::INFINITY };
        (radius, m.into_iter().max_by(|x, y| x.abs().total_cmp(&y.abs())).unwrap_or(0.0))
    }
}

/// Is the line common to the normal planes at the end and at t closer than r to the end, for all t of an arc?
pub(crate) fn line_within(frame: &Frame, finish: bool, arc: &Bezier, r: f64) -> bool {
    let x = exact_arc_against(arc, &End::new(frame, finish));
    let u = form::cross(&x.d, &x.a);
    let reach = form::dot(&u, &u).mul(&x.w.clone().scale(r).sqr());
    reach.sub(&form::dot(&x.a, &x.q).sqr().mul(&form::dot(&x.d, &x.d))).positive() == Some(true)
}

fn against(cell: Cell, end: &End) -> Against<f64> {
    let q = std::array::from_fn(|k| {
        let strip = cell.p.iter().enumerate().map(|(i, p)| (p[k] - end.point[k]) * cell.weight(i));
        let size = cell.p.iter().map(|p| (p[k] - end.point[k]).abs()).fold(0.0f64, f64::max);
        let rad = (cell.heaviest() + cell.w_err) * (cell.p_err + 4.0 * UNIT * end.point[k].abs() + 4.0 * UNIT * size)
            + size * cell.w_err;
        Form::from_strip(strip, rad * (1.0 + 1e-9), 0)
    });
    let (w, a) = (cell.weight_form(), cell.hodograph_forms());
    let d =
        end.tangent.map(|x| Form { ds: 0, dt: 0, exp: 0, c: vec![x], norm: Ball { mag: 1.0 + UNIT, rad: 2.0 * UNIT } });
    Against { q, w, a, d }
}

fn exact_against(frame: &Frame, cell: Cell, end: &End) -> Against<Int> {
    exact_arc_against(&cell.exact(frame), end)
}

fn exact_arc_against(arc: &Bezier, end: &End) -> Against<Int> {
    let forms = arc.forms();
    let constant = |x: &Int| Form { ds: 0, dt: 0, exp: 0, c: vec![x.clone()], norm: () };
    let scale = constant(&end.exact_point[3]);
    let q = std::array::from_fn(|k| forms.r[k].mul(&scale).sub(&forms.w.mul(&constant(&end.exact_point[k]))));
    Against { q, w: forms.w.mul(&scale), a: forms.a, d: end.exact_tangent.each_ref().map(constant) }
}
