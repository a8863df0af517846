//! Body to body (theory.md, section 4): no doubly critical pair closer than 2r, by branch and bound on pairs of arcs.
//!
//! Rules that close a pair of arcs, cheapest first. Each proves that the pair of arcs holds no (s, t), s != t, with
//! q = C(s) - C(t) orthogonal to both tangents and |q| <= 2r:
//! - *ball*: the balls round the arcs are further than 2r apart;
//! - *cone*: one arc, or two touching ones, with all tangents within 45 degrees of one vector (Lemma L);
//! - *tilt*: q.T(s), or q.T(t), has one strict sign;
//! - *slab*: for one vector u, q.u > 2r |u|;
//! - *together*: a fixed combination of q.T(s) and q.T(t) has one strict sign;
//! - *bent*: |q|^2 > 4 r^2 after adding multiples of q.T(s) and q.T(t), which vanish at a doubly critical pair. With
//!   multipliers that cancel the Hessian the bound is off by the third power of the cell, so that whole families of
//!   critical pairs (circles, parallel strands) close at moderate depth.

use super::apart::{hulls_apart, hulls_apart_along};
use super::curvature::golden;
use super::frame::Frame;
use super::meter::Meter;
use super::newton::{Candidate, Step, newton_step, partner};
use super::rules::{Gap, Model, across, bulge, decide, in_units, one_side, sides, tilted};
use super::tree::{Cell, Id, ROUNDING, Tree, V3, norm, sub};
use super::witness::{Exact, POLISHED};
use crate::integer::ldexp;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Below this radius (in the unit box) a search that starts there gives up: a self-contact, or undecided.
pub(crate) fn floor(start: f64) -> f64 {
    f64::min(1e-13, 1e-3 * start)
}

/// The largest radius that is searched. Far above the unit box: with negative weights a spine may leave it.
const BEYOND: f64 = 1e150;

/// How much cells that are not straight bend q.T(s) and q.T(t), numerically, against their bulges.
const CURVED: f64 = 4.0;

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
    let floor = floor(start);
    let mut search = Search { tree, exact, radius: start, margin, candidate: None };
    let root = search.tree.root();
    let mut open = BinaryHeap::from([Reverse((0u64, root, root))]);
    while let Some(Reverse((bound, i, j))) = open.pop() {
        let bound = f64::from_bits(bound);
        if bound > 2.0 * search.radius {
            break; // the least bound first: all that is left is further apart
        }
        if search.radius < floor {
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
    if search.radius >= BEYOND && search.tree.extent() < BEYOND {
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
        let (split_first, rad) = (self.tree.first_is_split(i, j), a.rad.max(b.rad));
        if let (Some(x), Some(y)) = (self.tree.cell(i), self.tree.cell(j)) {
            let floor = x.p_err.max(y.p_err);
            if self.closed_by_hulls(x, y, &q0, &across(&q0, &a.cone, &b.cone)) {
                return None;
            }
            let apart = spread < 0.25 * length;
            let blurred = !apart && rad <= 8.0 * floor;
            // between them may lie spans that f64 does not see
            if blurred && narrow && decide([x, y], self.tree.frame, self.radius, [0.5; 2]).is_some() {
                return None;
            }
            if (apart || narrow) && !x.p.is_empty() && !y.p.is_empty() {
                let model = self.refine(i, j);
                let (Some(x), Some(y)) = (self.tree.cell(i), self.tree.cell(j)) else { unreachable!("cells") };
                let bend = model.bends(bulge(x) + bulge(y), spread, self.radius, self.margin);
                if (bend || model.shares.is_some()) && self.closed_by_forms(i, j, &model, bend) {
                    return None;
                }
            }
            // so small that splitting says nothing more about the distance
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
    fn closed_by_hulls(&self, x: Cell, y: Cell, q0: &V3, across: &V3) -> bool {
        if x.p.is_empty() || y.p.is_empty() {
            return false;
        }
        let e = 2.0 * (x.p_err + y.p_err);
        if one_side(x, y, x, e) || one_side(x, y, y, e) {
            return true;
        }
        // straight strands far closer than they are long: f64 cannot tell the gap, the exact points can
        let slab = |u: &V3| {
            let exact = || hulls_apart_along(self.tree.frame, x, y, e, u, self.radius).is_some();
            hulls_apart(x.p, y.p, e, u, self.radius).unwrap_or_else(exact)
        };
        slab(q0) || slab(across)
    }

    /// Newton's method from the middle of the two cells, for a candidate; returns the quadratic model there.
    fn refine(&mut self, i: Id, j: Id) -> Model {
        let unit = |c: Cell| {
            let h = ldexp(1.0, -i64::from(c.depth));
            (c.segment, c.index as f64 * h, h)
        };
        let (Some(x), Some(y)) = (self.tree.cell(i), self.tree.cell(j)) else {
            return Model::UNKNOWN;
        };
        let ((cs, s0, hs), (ct, t0, ht)) = (unit(x), unit(y));
        let (mut s, mut t) = (s0 + 0.5 * hs, t0 + 0.5 * ht);
        let mut model = Model::UNKNOWN;
        let curved = bulge(x) + bulge(y);
        for round in 0..12 {
            let step = newton_step(&self.tree.evaluate(cs, s), &self.tree.evaluate(ct, t));
            let Some(step) = step else { break };
            if round == 0 {
                model = Model::of(&step, [hs, ht], curved);
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
            // f64 sees q.T to about 1e-15; on the diagonal it vanishes as well, so the points have to be apart along the
            // spine
            let settled = still.residual * still.length < 1e-14;
            let contact = settled
                && parameter_gap(self.tree.frame, (cs, s), (ct, t)) > 0.5 * hs.max(ht)
                && far_along(self.tree, (cs, s), (ct, t));
            if contact || (still.residual < 1e-9 && still.length > 1e-13) {
                let mut pair = Candidate { s: (cs, s), t: (ct, t), radius: 0.5 * still.length };
                // along circles all are alike: only one that is closer than what is known
                if still.flat() {
                    if self.candidate.is_some_and(|c| pair.radius >= c.radius * (1.0 - 0.1 * self.margin)) {
                        break;
                    }
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
        let tree = &*self.tree;
        let exact = std::cell::RefCell::new(&mut self.exact);
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
        // on the diagonal the distance is 0: no pair at all
        let gap = |p: &Candidate| parameter_gap(tree.frame, p.s, p.t);
        let apart = |p: &Candidate| gap(p) > 0.5 * gap(pair);
        at(s).filter(|p| radius < pair.radius && apart(p) && critical(p)).unwrap_or(*pair)
    }

    /// Rules on Bernstein forms of two variables: together and bent in f64; tilt, bent and ball exactly where f64 cannot
    /// tell.
    fn closed_by_forms(&mut self, i: Id, j: Id, model: &Model, bend: bool) -> bool {
        loop {
            let (Some(x), Some(y)) = (self.tree.cell(i), self.tree.cell(j)) else { return false };
            let gap = Gap::of(x, y);
            if model.shares.is_some_and(|shares| gap.together(sides(x, y, shares)) == Some(true))
                || (bend && gap.bent(self.radius, model.centre) == Some(true))
            {
                return true;
            }
            // f64 is at its end where its radius is no longer small against the slack that is asked for
            if !bend || x.p_err + y.p_err < 0.02 * self.margin * model.predicted_sq.max(0.0).sqrt() {
                return false;
            }
            if !(self.tree.sharpen(i) | self.tree.sharpen(j)) {
                break;
            }
        }
        let (Some(x), Some(y)) = (self.tree.cell(i), self.tree.cell(j)) else { return false };
        decide([x, y], self.tree.frame, self.radius, model.centre).is_some()
    }
}

/// In spans, round the closure if that is shorter.
fn parameter_gap(frame: &Frame, s: (usize, f64), t: (usize, f64)) -> f64 {
    let gap = (s.0 as f64 - t.0 as f64 + s.1 - t.1).abs();
    if frame.closed { gap.min(frame.segments.len() as f64 - gap) } else { gap }
}

/// Is the spine between two places longer than f64 rounds, both ways round if it is closed? Some spans are not.
fn far_along(tree: &Tree, s: (usize, f64), t: (usize, f64)) -> bool {
    let (low, high) = if s <= t { (s, t) } else { (t, s) };
    let spans = tree.frame.segments.len();
    let long = |(first, from): (usize, f64), (last, to): (usize, f64)| {
        (first..=last).any(|k| {
            let (from, to) = (if k == first { from } else { 0.0 }, if k == last { to } else { 1.0 });
            let points = [from, 0.5 * (from + to), to].map(|t| tree.evaluate(k % spans, t)[0]);
            norm(&sub(&points[1], &points[0])) + norm(&sub(&points[2], &points[1])) > 1e-12
        })
    };
    long(low, high) && (!tree.frame.closed || long(high, (low.0 + spans, low.1)))
}

impl Model {
    const UNKNOWN: Self = Self { centre: [0.5; 2], predicted_sq: 0.0, flat: false, shares: None };

    /// The model of cells of these widths in the parameter, `curved` as far from straight in all.
    pub(crate) fn of(step: &Step, [hs, ht]: [f64; 2], curved: f64) -> Self {
        let whole = [step.ds, step.dt, step.predicted_sq];
        let near = step.ds.abs() < 1.5 * hs && step.dt.abs() < 1.5 * ht;
        let [ds, dt, predicted_sq] = if near { whole } else { step.across.unwrap_or(whole) };
        let centre = [0.5 + ds / hs, 0.5 + dt / ht].map(|x| in_units(x.clamp(-1.0, 2.0)));
        Self { centre, predicted_sq, flat: step.flat(), shares: shares(step, [hs, ht], curved) }
    }

    /// Is the bent rule, off by about the cubic part of |q|^2, worth a try: is that below what it has to spare?
    pub(crate) fn bends(&self, curved: f64, spread: f64, radius: f64, margin: f64) -> bool {
        let off = curved * if self.flat { 2.0 * curved } else { spread };
        let spare = self.predicted_sq - 4.0 * radius * radius;
        off < spare.max(1e-2 * margin * self.predicted_sq)
    }
}

/// The row of the inverse Hessian (up to a factor) that turns q.T(s) and q.T(t) into the distance from the critical
/// pair along one parameter, if that pair is outside the cells as far as can be seen. `curved`: how far the cells are
/// from straight.
fn shares(step: &Step, h: [f64; 2], curved: f64) -> Option<[f64; 2]> {
    let [a, b, c] = step.hessian;
    let det = (a * c - b * b).abs();
    // where the curves q.T(s) = 0 and q.T(t) = 0 cross at a fair angle, tilt alone will soon do for less
    if det > 0.1 * (a * a + c * c) {
        return None;
    }
    let rows = [[c, -b], [-b, a]];
    let outside = |k: usize| {
        let [s, t] = rows[k];
        let value = (s * step.gradient[0] + t * step.gradient[1]).abs();
        value - det * 0.5 * h[k] * step.speed[k] - CURVED * curved * s.abs().max(t.abs())
    };
    let best = if outside(0) * h[1] * step.speed[1] > outside(1) * h[0] * step.speed[0] { 0 } else { 1 };
    let [s, t] = rows[best];
    let size = s.abs().max(t.abs());
    // half the gradient is (q.T(s), -q.T(t))
    (outside(best) > 0.0).then(|| [s / size, -t / size])
}
