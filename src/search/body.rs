//! Body to body (theory.md, section 4): no doubly critical pair closer than 2r, by branch and bound on pairs of arcs.
//!
//! Rules that close a pair of arcs, cheapest first. Each proves that the pair of arcs holds no (s, t), s != t, with
//! q = C(s) - C(t) orthogonal to both tangents and |q| <= 2r:
//! - *ball*: the balls round the arcs are further than 2r apart;
//! - *cone*: one arc, or two touching ones, with all tangents within 45 degrees of one vector (Lemma L);
//! - *tilt*: q.T(s), or q.T(t), has one strict sign;
//! - *slab*: for one vector u, q.u > 2r |u|;
//! - *bent*: |q|^2 > 4 r^2 after adding multiples of q.T(s) and q.T(t), which vanish at a doubly critical pair. With
//!   multipliers that cancel the Hessian the bound is off by the third power of the cell, so that whole families of
//!   critical pairs (circles, parallel strands) close at moderate depth.

use super::curvature::golden;
use super::frame::{ArcForms, Dyadic, ExactForms, Frame};
use super::meter::Meter;
use super::tree::{Cell, Cone, Id, Node, ROUNDING, SINE_SLACK, Tree, V3, cross, dot, norm, sub};
use super::witness::{Exact, POLISHED};
use crate::bernstein::{self as form, Ball, Form, Scalar, UNIT, Vec3, binomial_error, binomials};
use crate::enclosure::Interval;
use crate::integer::Int;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Below this radius (in the unit box) a search gives up: a self-contact, or undecided.
pub(crate) const FLOOR: f64 = 1e-13;

/// Above half of every distance in the unit box.
const BEYOND: f64 = 64.0;

/// A numerical doubly critical pair: candidates steer the search, they prove nothing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Candidate {
    pub(crate) s: (usize, f64),
    pub(crate) t: (usize, f64),
    /// Half the distance.
    pub(crate) radius: f64,
}

#[derive(Debug)]
pub(crate) struct Outcome {
    /// Proved: no doubly critical pair (that is not local) has |q| <= 2 `radius`. Infinite if there is none at all.
    pub(crate) radius: f64,
    pub(crate) candidate: Option<Candidate>,
}

/// Searches with radii up to `start` (infinite: all pairs), shrinking to just below (by the share `margin`) the least
/// doubly critical pair met.
pub(crate) fn body_to_body(tree: &mut Tree, start: f64, margin: f64, meter: &mut Meter) -> Outcome {
    let (start, exact) = (start.min(BEYOND), Exact::new(tree.frame));
    let mut search = Search { tree, exact, radius: start, margin, candidate: None };
    let root = search.tree.root();
    let mut open = BinaryHeap::from([Reverse((0u64, root, root))]);
    while let Some(Reverse((bound, i, j))) = open.pop() {
        let bound = f64::from_bits(bound);
        if bound > 2.0 * search.radius {
            break; // the least bound first: all that is left is further apart
        }
        if search.radius < FLOOR {
            return Outcome { radius: 0.0, candidate: search.candidate };
        }
        if !meter.tick() {
            search.radius = search.radius.min(0.5 * bound * (1.0 - ROUNDING));
            break;
        }
        let Some(parts) = search.process(i, j) else { continue };
        for (a, b) in parts.into_iter().flatten() {
            let gap = search.gap(a, b);
            if gap <= 2.0 * search.radius {
                open.push(Reverse((gap.max(0.0).to_bits(), a, b)));
            }
        }
    }
    if search.radius >= BEYOND {
        search.radius = f64::INFINITY;
    }
    Outcome { radius: search.radius, candidate: search.candidate }
}

struct Search<'t, 'f> {
    tree: &'t mut Tree<'f>,
    exact: Exact<'f>,
    radius: f64,
    margin: f64,
    candidate: Option<Candidate>,
}

/// Where the quadratic model of |q|^2 in the middle of two cells sees the nearest critical pair.
struct Model {
    /// Its parameters, relative to the cells: there the *bent* rule is centred.
    centre: [f64; 2],
    /// |q|^2 there.
    predicted_sq: f64,
}

type Parts = [Option<(Id, Id)>; 3];

impl Search<'_, '_> {
    /// Lower bound for the distance of two arcs; 0 on the diagonal.
    fn gap(&self, i: Id, j: Id) -> f64 {
        if i == j {
            return 0.0;
        }
        let (a, b) = (self.tree.node(i), self.tree.node(j));
        let gap = norm(&sub(&a.mid, &b.mid)) * (1.0 - ROUNDING) - (a.rad + b.rad) * (1.0 + ROUNDING);
        if gap.is_nan() { 0.0 } else { gap.max(0.0) }
    }

    /// `None` if closed, else the pairs to look at next.
    fn process(&mut self, i: Id, j: Id) -> Option<Parts> {
        if i == j {
            if self.tree.node(i).cone.within_45_degrees() {
                return None;
            }
            let Some((l, r)) = self.tree.children(i) else { return self.give_up(0.0) };
            return Some([Some((l, l)), Some((l, r)), Some((r, r))]);
        }
        if self.tree.touching(i, j) && self.tree.within_45_degrees(i, j) {
            return None;
        }
        let (a, b) = (self.tree.node(i), self.tree.node(j));
        let q0 = sub(&a.mid, &b.mid);
        let (length, spread) = (norm(&q0), a.rad + b.rad);
        if tilted(&q0, length, spread, a) || tilted(&q0, length, spread, b) {
            return None;
        }
        let narrow = a.cone.cos.min(b.cone.cos) > 0.9;
        let (split_first, rad) = (a.rad >= b.rad, a.rad.max(b.rad));
        if let (Some(x), Some(y)) = (&a.cell, &b.cell) {
            let floor = x.p_err.max(y.p_err);
            if self.closed_by_hulls(x, y, &q0, &across(&q0, &a.cone, &b.cone)) {
                return None;
            }
            let apart = spread < 0.25 * length;
            if (apart || narrow) && !x.p.is_empty() && !y.p.is_empty() {
                let model = self.refine(i, j);
                let (Some(x), Some(y)) = (&self.tree.node(i).cell, &self.tree.node(j).cell) else { return None };
                // the bent rule is off by about this: not before that is below what it has to spare
                let off = spread * (bulge(x) + bulge(y));
                let spare = model.predicted_sq - 4.0 * self.radius * self.radius;
                if off < spare.max(1e-2 * self.margin * model.predicted_sq) && self.closed_by_forms(x, y, &model) {
                    return None;
                }
            }
            // so small that splitting says nothing more about the distance
            let blurred = !apart && rad <= 8.0 * floor;
            if blurred || spread < 1e-3 * self.margin * length {
                return self.give_up(self.gap(i, j));
            }
        }
        let order = if split_first { [(i, j), (j, i)] } else { [(j, i), (i, j)] };
        for (split, keep) in order {
            if let Some((l, r)) = self.tree.children(split) {
                let pair = |x: Id| if split == i { (x, keep) } else { (keep, x) };
                return Some([Some(pair(l)), Some(pair(r)), None]);
            }
        }
        self.give_up(self.gap(i, j))
    }

    /// Shrinks the radius below what this cell allows: closed, at a price.
    fn give_up(&mut self, distance: f64) -> Option<Parts> {
        self.radius = self.radius.min((0.5 * distance * (1.0 - ROUNDING)).max(0.0));
        None
    }

    /// Tilt and slab on control points: q.T(s) is bilinear in points and hodograph vectors.
    fn closed_by_hulls(&self, x: &Cell, y: &Cell, q0: &V3, across: &V3) -> bool {
        if x.p.is_empty() || y.p.is_empty() {
            return false;
        }
        let e = 2.0 * (x.p_err + y.p_err);
        if one_side(x, y, x, e) || one_side(x, y, y, e) {
            return true;
        }
        // every p - y.p[0] is no longer than this
        let worst = x.p.iter().chain(&y.p).map(|p| norm(&sub(p, &y.p[0]))).fold(0.0f64, f64::max);
        let slab = |u: &V3| {
            let range = |c: &Cell, pick: fn(f64, f64) -> f64, from: f64| {
                c.p.iter().map(|p| dot(&sub(p, &y.p[0]), u)).fold(from, pick)
            };
            let gap = range(x, f64::min, f64::INFINITY) - range(y, f64::max, f64::NEG_INFINITY);
            let size = norm(u);
            gap > (2.0 * self.radius * size + e * size) * (1.0 + ROUNDING) + ROUNDING * worst * size
        };
        slab(q0) || slab(across)
    }

    /// Newton's method from the middle of the two cells, for a candidate; returns its first step.
    fn refine(&mut self, i: Id, j: Id) -> Model {
        let unit = |c: &Cell| {
            let h = (-f64::from(c.depth)).exp2();
            (c.segment, c.index as f64 * h, h)
        };
        let (Some(x), Some(y)) = (&self.tree.node(i).cell, &self.tree.node(j).cell) else {
            return Model { centre: [0.5; 2], predicted_sq: 0.0 };
        };
        let ((cs, s0, hs), (ct, t0, ht)) = (unit(x), unit(y));
        let (mut s, mut t) = (s0 + 0.5 * hs, t0 + 0.5 * ht);
        let mut model = Model { centre: [0.5; 2], predicted_sq: 0.0 };
        for round in 0..12 {
            let step = newton_step(&self.tree.evaluate(cs, s), &self.tree.evaluate(ct, t));
            let Some(step) = step else { break };
            if round == 0 {
                model.centre = [0.5 + step.ds / hs, 0.5 + step.dt / ht].map(|x| x.clamp(-1.0, 2.0));
                model.predicted_sq = step.predicted_sq;
                let known = self.candidate.map_or(f64::INFINITY, |c| c.radius * (1.0 - self.margin));
                let wanted = 2.0 * (self.radius * (1.0 + 4.0 * self.margin)).min(known);
                let promising = step.predicted_sq < wanted * wanted;
                let near = step.ds.abs() < 2.0 * hs && step.dt.abs() < 2.0 * ht;
                if !(promising && near) {
                    break;
                }
            }
            s = (s + step.ds).clamp(0.0, 1.0);
            t = (t + step.dt).clamp(0.0, 1.0);
            let inside = |x: f64, from: f64, h: f64| x >= from - 2.0 * h && x <= from + 3.0 * h;
            if !(inside(s, s0, hs) && inside(t, t0, ht)) {
                break;
            }
            let still = newton_step(&self.tree.evaluate(cs, s), &self.tree.evaluate(ct, t));
            let Some(still) = still else { break };
            // f64 sees q.T to about 1e-15; on the diagonal it vanishes as well, so the parameters have to stay apart
            let settled = still.residual * still.length < 1e-14;
            let contact = settled && self.parameter_gap((cs, s), (ct, t)) > 0.5 * hs.max(ht);
            if contact || (still.residual < 1e-9 && still.length > 1e-13) {
                let mut pair = Candidate { s: (cs, s), t: (ct, t), radius: 0.5 * still.length };
                if still.flat {
                    pair = self.slid(&pair, 0.02 + 4.0 * hs);
                }
                if pair.radius < POLISHED {
                    // f64 differences no longer give the distance to 12 digits
                    pair.radius = self.exact.half_distance(&pair);
                }
                if self.candidate.is_none_or(|c| pair.radius < c.radius) {
                    self.candidate = Some(pair);
                    self.radius = self.radius.min(pair.radius * (1.0 - self.margin));
                }
                break;
            }
        }
        model
    }

    /// The closest pair near a candidate along a direction in which |q|^2 is all but constant: Newton's method stops
    /// anywhere on such a stretch, and f64 no longer tells its distances apart if they are small.
    fn slid(&mut self, pair: &Candidate, reach: f64) -> Candidate {
        let Self { tree, exact, .. } = self;
        let exact = std::cell::RefCell::new(exact);
        let at = |s: f64| {
            let mut pair = partner(tree, (pair.s.0, s), pair.t)?;
            if pair.radius < POLISHED {
                pair.radius = exact.borrow_mut().half_distance(&pair);
            }
            Some(pair)
        };
        let (s, radius) = golden(|s| at(s).map_or(f64::INFINITY, |p| p.radius), pair.s.1, reach);
        let critical = |p: &Candidate| {
            let step = newton_step(&tree.evaluate(p.s.0, p.s.1), &tree.evaluate(p.t.0, p.t.1));
            step.is_some_and(|step| step.residual * step.length < 1e-12)
        };
        at(s).filter(|p| radius < pair.radius && critical(p)).unwrap_or(*pair)
    }

    /// In spans, round the closure if that is shorter.
    fn parameter_gap(&self, s: (usize, f64), t: (usize, f64)) -> f64 {
        let gap = (s.0 as f64 - t.0 as f64 + s.1 - t.1).abs();
        let frame = self.tree.frame;
        if frame.closed { gap.min(frame.segments.len() as f64 - gap) } else { gap }
    }

    /// Tilt and bent on Bernstein forms of two variables: f64, and exact where f64 cannot tell.
    fn closed_by_forms(&self, x: &Cell, y: &Cell, model: &Model) -> bool {
        if bent(x, y, self.radius, model.centre) == Some(true) {
            return true;
        }
        // f64 is at its end where its radius is no longer small against the slack that is asked for
        if x.p_err + y.p_err < 0.02 * self.margin * model.predicted_sq.max(0.0).sqrt() {
            return false;
        }
        let exact = |c: &Cell| exact_arc(self.tree.frame, c);
        decide(&exact(x), &exact(y), self.radius, model.centre)
    }
}

/// The same rules from exact arcs: intervals first, then integers.
fn decide(x: &ExactForms, y: &ExactForms, radius: f64, centre: [f64; 2]) -> bool {
    fn run<T: Scalar>(x: &ExactForms, y: &ExactForms, radius: f64, centre: [f64; 2]) -> Option<bool> {
        // w(t) / w(s) = ratio 2^exp: here a = r'w - r w' in the scale of r and w
        let (top, bottom) = (&y.w.c[0], &x.w.c[0]);
        let (up, down) = (top.bits() as i64, bottom.bits() as i64);
        let ratio = top.to_f64_shifted(up) / bottom.to_f64_shifted(down);
        let exp = up + y.w.exp - down - x.w.exp;
        let first = Form::<T>::line(centre[0] * ratio, (centre[0] - 1.0) * ratio, exp);
        let second = Form::<T>::line(-centre[1] / ratio, (1.0 - centre[1]) / ratio, -exp).transposed();
        let (x, mut y) = (x.cast::<T>(), y.cast::<T>());
        y = ArcForms { r: y.r.map(Form::transposed), w: y.w.transposed(), a: y.a.map(Form::transposed) };
        let d: Vec3<T> = std::array::from_fn(|k| x.r[k].mul(&y.w).sub(&y.r[k].mul(&x.w)));
        let (ds, dt) = (form::dot(&d, &x.a), form::dot(&d, &y.a));
        let plain = stretched(&d, &x.w.mul(&y.w), radius);
        first_true([&|| ds.one_sign(), &|| dt.one_sign(), &|| plain.positive(), &|| {
            plain.add(&first.mul(&ds)).add(&second.mul(&dt)).positive()
        }])
    }
    run::<Interval>(x, y, radius, centre).unwrap_or_else(|| run::<Int>(x, y, radius, centre) == Some(true))
}

/// `Some(true)` if a rule says so; `Some(false)` if all surely fail; `None` if the arithmetic cannot tell.
pub(crate) fn first_true<const N: usize>(rules: [&dyn Fn() -> Option<bool>; N]) -> Option<bool> {
    let mut sure = true;
    for rule in rules {
        match rule() {
            Some(true) => return Some(true),
            Some(false) => {}
            None => sure = false,
        }
    }
    sure.then_some(false)
}

/// |D|^2 - (2r)^2 (w(s) w(t))^2.
fn stretched<T: Scalar>(d: &Vec3<T>, weights: &Form<T>, radius: f64) -> Form<T> {
    let reach = weights.clone().scale(2.0 * radius);
    form::dot(d, d).sub(&reach.sqr())
}

/// The *bent* rule in f64 on two cells.
fn bent(x: &Cell, y: &Cell, radius: f64, centre: [f64; 2]) -> Option<bool> {
    let weights = |c: &Cell| {
        if c.w.is_empty() { Form::from_strip(&[1.0], 0.0, 0) } else { Form::from_strip(&c.w, c.w_err, 0) }
    };
    let hodograph = |c: &Cell| -> Vec3<f64> {
        std::array::from_fn(|k| {
            let strip: Vec<f64> = c.a.iter().map(|a| a[k]).collect();
            Form::from_strip(&strip, c.a_err, 0)
        })
    };
    let d = difference(x, y);
    let (ax, ay) = (hodograph(x), hodograph(y).map(Form::transposed));
    let plain = stretched(&d, &weights(x).mul(&weights(y).transposed()), radius);
    // dC/d sigma = pace a / w^2 on a cell, up to O(h^2); the weights at the middle
    let middle = |c: &Cell| if c.w.is_empty() { 1.0 } else { c.w[c.w.len() / 2] };
    let pace = |c: &Cell| {
        let mean: V3 = std::array::from_fn(|k| c.a.iter().map(|a| a[k]).sum::<f64>() / c.a.len() as f64);
        norm(&sub(&c.p[c.p.len() - 1], &c.p[0])) * middle(c).powi(2) / norm(&mean)
    };
    let ratio = middle(y) / middle(x);
    let (kx, ky) = (-ratio * pace(x), pace(y) / ratio);
    let first = Form::from_strip(&[-centre[0] * kx, (1.0 - centre[0]) * kx], 0.0, 0);
    let second = Form::from_strip(&[-centre[1] * ky, (1.0 - centre[1]) * ky], 0.0, 0).transposed();
    plain.add(&first.mul(&form::dot(&d, &ax))).add(&second.mul(&form::dot(&d, &ay))).positive()
}

/// D = r(s) w(t) - r(t) w(s), from differences of points so that nothing cancels.
fn difference(x: &Cell, y: &Cell) -> Vec3<f64> {
    let (n, m) = (x.p.len() - 1, y.p.len() - 1);
    let (bs, bt) = (binomials(n), binomials(m));
    let weight = |c: &Cell, i: usize| c.w.get(i).copied().unwrap_or(1.0);
    let heaviest =
        |c: &Cell| c.w.iter().copied().fold(f64::NEG_INFINITY, f64::max).max(if c.w.is_empty() { 1.0 } else { 0.0 });
    let (wx, wy) = (heaviest(x), heaviest(y));
    std::array::from_fn(|k| {
        let mut mag = 0.0f64;
        let mut c = Vec::with_capacity((n + 1) * (m + 1));
        for i in 0..=n {
            for j in 0..=m {
                let d = (x.p[i][k] - y.p[j][k]) * (weight(x, i) * weight(y, j));
                mag = mag.max(d.abs());
                c.push(d * (bs[i] * bt[j]));
            }
        }
        let points = (wx + x.w_err) * (wy + y.w_err) * (x.p_err + y.p_err);
        let gap = x.p.iter().flat_map(|p| y.p.iter().map(move |q| (p[k] - q[k]).abs())).fold(0.0f64, f64::max);
        let heavy = gap * (x.w_err * (wy + y.w_err) + y.w_err * wx) * 2.0;
        let rounding = (8.0 * UNIT + binomial_error(n) + binomial_error(m)) * mag;
        let rad = (points + heavy + rounding) * (1.0 + 1e-6) + 1e-290;
        Form { ds: n, dt: m, exp: 0, c, norm: Ball { mag: mag + rad, rad } }
    })
}

/// Has (p - q).a one strict sign for all control points p of x, q of y and all hodograph vectors a of z? The
/// coordinates of points are off such that p - q is off by at most `e`.
fn one_side(x: &Cell, y: &Cell, z: &Cell, e: f64) -> bool {
    let base = &y.p[0];
    let mut side = 0.0f64;
    let reach = x.p.iter().chain(&y.p).map(|p| dot(&sub(p, base), &sub(p, base))).fold(0.0f64, f64::max).sqrt();
    for a in &z.a {
        let range = |c: &Cell| {
            c.p.iter()
                .map(|p| dot(&sub(p, base), a))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)))
        };
        let ((l, h), (lo, hi)) = (range(x), range(y));
        let err = (e * (norm(a) + 2.0 * z.a_err) + 4.0 * reach * z.a_err + ROUNDING * reach * norm(a)) * (1.0 + 1e-9);
        let now = if l - hi > err {
            1.0
        } else if lo - h > err {
            -1.0
        } else {
            return false;
        };
        if side * now < 0.0 {
            return false;
        }
        side = now;
    }
    true
}

/// A direction from the second arc to the first that is orthogonal to both, if they are nearly straight.
fn across(q0: &V3, a: &Cone, b: &Cone) -> V3 {
    let c = cross(&a.axis, &b.axis);
    if dot(&c, &c) > 1e-2 {
        return if dot(&c, q0) < 0.0 { c.map(|x| -x) } else { c };
    }
    let along = dot(q0, &a.axis);
    std::array::from_fn(|k| q0[k] - along * a.axis[k])
}

/// Is q.T of one strict sign for q in the ball (q0, spread) and T in the cone of the node?
fn tilted(q0: &V3, length: f64, spread: f64, node: &Node) -> bool {
    let sin_ball = spread / length * (1.0 + ROUNDING) + ROUNDING;
    if sin_ball.is_nan() || sin_ball >= node.cone.cos {
        return false;
    }
    // |cos(angle of q0 and axis)| > sin(alpha + beta), with alpha + beta < 90 degrees as cos(alpha) > sin(beta)
    let cos_ball = (1.0 - sin_ball * sin_ball).max(0.0).sqrt() + SINE_SLACK;
    dot(q0, &node.cone.axis).abs() / length > node.cone.sin() * cos_ball.min(1.0) + sin_ball + 2.0 * ROUNDING
}

/// Members of a family of critical pairs (circles, parallel strands) with a simple s.
pub(crate) fn snapped<'t>(tree: &'t Tree, pair: &'t Candidate) -> impl Iterator<Item = Candidate> + 't {
    [0.5, 0.0, 1.0, 0.25, 0.75].into_iter().filter_map(|s| partner(tree, (pair.s.0, s), pair.t))
}

/// The pair of s and the t near a guess with q.C'(t) = 0.
fn partner(tree: &Tree, s: (usize, f64), guess: (usize, f64)) -> Option<Candidate> {
    let spans = tree.frame.segments.len();
    let wrap = tree.frame.closed;
    let at_s = tree.evaluate(s.0, s.1);
    let (mut segment, mut t) = guess;
    for _ in 0..20 {
        let at = tree.evaluate(segment, t);
        let q = sub(&at_s[0], &at[0]);
        let step = dot(&q, &at[1]) / (dot(&at[1], &at[1]) - dot(&q, &at[2]));
        if step.abs() < 1e-13 {
            return Some(Candidate { s, t: (segment, t.clamp(0.0, 1.0)), radius: 0.5 * norm(&q) });
        }
        t += step.clamp(-0.5, 0.5);
        if t > 1.0 + 1e-9 && (segment + 1 < spans || wrap) {
            (segment, t) = ((segment + 1) % spans, 0.0);
        } else if t < -1e-9 && (segment > 0 || wrap) {
            (segment, t) = ((segment + spans - 1) % spans, 1.0);
        } else if !(-1e-9..=1.0 + 1e-9).contains(&t) {
            return None;
        }
    }
    None
}

/// The derivative of (q.a(s), q.a(t)) at a candidate, up to a positive factor for each row.
pub(crate) fn jacobian(tree: &Tree, pair: &Candidate) -> [[f64; 2]; 2] {
    let (a, b) = (tree.evaluate(pair.s.0, pair.s.1), tree.evaluate(pair.t.0, pair.t.1));
    let q = sub(&a[0], &b[0]);
    let mixed = dot(&a[1], &b[1]);
    [[dot(&a[1], &a[1]) + dot(&q, &a[2]), -mixed], [mixed, dot(&q, &b[2]) - dot(&b[1], &b[1])]]
}

/// How far the control points are from those of a uniform straight run between the same ends, numerically.
fn bulge(c: &Cell) -> f64 {
    let n = c.p.len() - 1;
    let (first, last) = (&c.p[0], &c.p[n]);
    let off = |(i, p): (usize, &V3)| {
        let share = i as f64 / n as f64;
        norm(&std::array::from_fn(|k| p[k] - (first[k] + share * (last[k] - first[k]))))
    };
    c.p.iter().enumerate().map(off).fold(0.0, f64::max)
}

struct Step {
    ds: f64,
    dt: f64,
    /// |q|^2 at the critical pair, by the quadratic model.
    predicted_sq: f64,
    length: f64,
    /// The larger of |cos(q, T(s))| and |cos(q, T(t))|.
    residual: f64,
    /// Is the Hessian nearly singular?
    flat: bool,
}

/// Newton's step for grad |q|^2 = 0 in arc length, the shortest one where the Hessian is singular.
fn newton_step(at_s: &[V3; 3], at_t: &[V3; 3]) -> Option<Step> {
    let q = sub(&at_s[0], &at_t[0]);
    let (vs, vt) = (norm(&at_s[1]), norm(&at_t[1]));
    let (gs, gt) = (dot(&q, &at_s[1]) / vs, -dot(&q, &at_t[1]) / vt);
    let a = 1.0 + dot(&q, &at_s[2]) / (vs * vs);
    let c = 1.0 - dot(&q, &at_t[2]) / (vt * vt);
    let b = -dot(&at_s[1], &at_t[1]) / (vs * vt);
    let angle = 0.5 * (2.0 * b).atan2(a - c);
    let (sin, cos) = angle.sin_cos();
    let half = 0.5 * ((a - c) * (a - c) + 4.0 * b * b).sqrt();
    let (l1, l2) = (0.5 * (a + c) + half, 0.5 * (a + c) - half);
    let small = 1e-7 * l1.abs().max(l2.abs());
    let along = |l: f64, g: f64| if l.abs() > small { -g / l } else { 0.0 };
    let (u, v) = (along(l1, cos * gs + sin * gt), along(l2, -sin * gs + cos * gt));
    let (ds, dt) = (cos * u - sin * v, sin * u + cos * v);
    let length = norm(&q);
    let step = Step {
        flat: l1.abs().min(l2.abs()) < 1e-3 * l1.abs().max(l2.abs()),
        ds: ds / vs,
        dt: dt / vt,
        predicted_sq: length * length + gs * ds + gt * dt,
        length,
        residual: if length > 0.0 { gs.abs().max(gt.abs()) / length } else { 0.0 },
    };
    (step.ds.is_finite() && step.dt.is_finite()).then_some(step)
}

/// The exact arc of a cell.
fn exact_arc(frame: &Frame, cell: &Cell) -> ExactForms {
    let end = |i: u128| Dyadic { m: Int::from(num_bigint::BigInt::from(i)), e: -i64::from(cell.depth) };
    frame.segments[cell.segment].arc(&end(cell.index), &end(cell.index + 1)).forms()
}
