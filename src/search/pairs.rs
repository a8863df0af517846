//! All stationary pairs of |C(s) - C(t)|^2 (theory.md, section 4): every cell of the square of the spine is closed by a rule,
//! lies in a box in which one pair was proved to be alone, or stays open.
//!
//! Rules: *cone* (Lemma L: q.T is not 0 on short arcs), *tilt* and *together* (F1, F2 or a fixed combination has one strict
//! sign). The largest cells come first, in rounds: whole curves of pairs (circles, parallel strands) show as crowds of cells
//! that double from round to round, and are left open as they are.

use super::contact::{Simple, fraction};
use super::dyadic::{Dyadic, decompose_exponent, ratio, step, truncated};
use super::evidence::axis_of;
use super::frame::{At, Frame};
use super::meter::Meter;
use super::newton::newton_step;
use super::rules::{Gap, Model, bulge, one_side, sides, tilted};
use super::stationary::{Field, Net, distance_exactly, distance_over};
use super::strand::{Strand, strand_beyond};
use super::tree::{Cell, Id, Place, ROUNDING, Tree, norm, sub};
use super::witness::Exact;
use crate::bernstein::{Form, Vec3, dot};
use crate::certificate::Node;
use crate::enclosure::Interval;
use crate::integer::{Int, ldexp};
use crate::number::{Rational, compare};
use crate::roots::common_zero;
use num_bigint::BigInt;
use num_traits::ToPrimitive;
use std::collections::BTreeMap;

/// Cells are not halved below 2^-DEEPEST of a span.
const DEEPEST: u32 = 60;
/// A crowd: connected open cells of one round, as many as these.
const CROWD: usize = 512;
/// With more open cells than this, and 64 a span, the search ends.
const MOST: usize = 8192;

/// One stationary pair: it lies in `inner`, and is the only one in `outer`. Positions: segment + local parameter; beyond the
/// ends of an open spine too, where the box need not hold a pair of the spine.
pub(crate) struct Root {
    pub(crate) outer: [[Dyadic; 2]; 2],
    pub(crate) inner: [[Dyadic; 2]; 2],
    pub(crate) distance: Interval,
    pub(crate) place: On,
    /// Where the pair is exactly, if that is known.
    pub(crate) point: Option<[Rational; 2]>,
    /// `outer`, a little wider.
    about: [[f64; 2]; 2],
}

/// Where the pair of a root is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum On {
    Spine,
    /// At an end of an open spine exactly, with an irrational parameter.
    End,
    /// Beyond an end of an open spine: it is no pair.
    Beyond,
}

/// A cell, or several, that may hold pairs.
#[derive(Clone)]
pub(crate) struct Open {
    pub(crate) places: [[Place; 2]; 2],
    pub(crate) distance: Interval,
}

pub(crate) struct Found {
    pub(crate) roots: Vec<Root>,
    pub(crate) open: Vec<Open>,
    nodes: Vec<Entry>,
}

/// A node of the tree of pairs.
#[derive(Clone)]
enum Entry {
    Waiting,
    Leaf(Leaf),
    /// With the first of its children, which are two, or three.
    Split(Node, usize),
}

#[derive(Debug, Clone, Copy)]
pub(crate) enum Leaf {
    Rule(Node),
    Root(usize),
    Open,
}

/// A pair of arcs and its node.
#[derive(Clone, Copy)]
struct Pair {
    i: Id,
    j: Id,
    node: usize,
}

struct Search<'t, 'f> {
    tree: &'t mut Tree<'f>,
    found: Found,
    /// The asked width of a parameter, in units of each span.
    width: Vec<f64>,
    fine: bool,
    /// The other two coordinates, if one is the same all along.
    across: Option<[usize; 2]>,
}

/// Searches all pairs. `width`: what is asked of their parameters, in units of each span; `fine`: blocks of spans are not
/// closed by a rule that the checker has for single spans.
pub(crate) fn stationary_pairs(tree: &mut Tree, width: Vec<f64>, fine: bool, meter: &mut Meter) -> Found {
    let root = tree.root();
    let found = Found { roots: vec![], open: vec![], nodes: vec![Entry::Waiting] };
    let (segments, first) = (&tree.frame.segments, tree.frame.segments[0].point(0));
    let level = |k: usize, p: [Int; 4]| &p[k] * &first[3] == &first[k] * &p[3];
    let flat = |k: usize| segments.iter().all(|b| (0..=b.degree()).all(|i| level(k, b.point(i))));
    let across = [([1, 2], 0), ([0, 2], 1), ([0, 1], 2)].into_iter().find(|(_, k)| flat(*k)).map(|(axes, _)| axes);
    let mut search = Search { tree, found, width, fine, across };
    let mut open = vec![Pair { i: root, j: root, node: 0 }];
    let mut size = search.size(root);
    while !open.is_empty() {
        size *= 0.5;
        let mut next = vec![];
        while let Some(pair) = open.pop() {
            if search.size(pair.i).max(search.size(pair.j)) <= size {
                next.push(pair);
            } else if meter.tick() {
                search.process(pair, &mut open);
            } else {
                next.push(pair);
                next.append(&mut open);
                search.leave(&next);
                search.found.join();
                return search.found;
            }
        }
        open = search.without_crowds(next, size);
    }
    search.found.join();
    search.found
}

impl Search<'_, '_> {
    /// In spans.
    fn size(&self, id: Id) -> f64 {
        let node = self.tree.node(id);
        match &node.cell {
            Some(cell) => ldexp(1.0, -i64::from(cell.depth)),
            None => (node.end.segment - node.start.segment) as f64,
        }
    }

    fn process(&mut self, pair: Pair, open: &mut Vec<Pair>) {
        let Pair { i, j, node } = pair;
        if let Some(leaf) = self.leaf(i, j) {
            self.found.nodes[node] = Entry::Leaf(leaf);
            return;
        }
        let first = self.found.nodes.len();
        let mut split = |search: &mut Self, kind, parts: &[(Id, Id)]| {
            search.found.nodes[node] = Entry::Split(kind, first);
            for (k, (i, j)) in parts.iter().enumerate() {
                search.found.nodes.push(Entry::Waiting);
                open.push(Pair { i: *i, j: *j, node: first + k });
            }
        };
        if i == j {
            if let Some((l, r)) = self.halves(i) {
                return split(self, Node::Split, &[(l, l), (l, r), (r, r)]);
            }
        } else {
            let order = if self.tree.first_is_split(i, j) { [true, false] } else { [false, true] };
            for of_first in order {
                if let Some((l, r)) = self.halves(if of_first { i } else { j }) {
                    let (kind, parts) = if of_first {
                        (Node::SplitFirst, [(l, j), (r, j)])
                    } else {
                        (Node::SplitSecond, [(i, l), (i, r)])
                    };
                    return split(self, kind, &parts);
                }
            }
        }
        self.leave(&[pair]);
    }

    /// Both halves of an arc that is to be halved at all.
    fn halves(&mut self, id: Id) -> Option<(Id, Id)> {
        let wanted = self.tree.node(id).cell.as_ref().is_none_or(|cell| {
            let size = ldexp(1.0, -i64::from(cell.depth));
            cell.depth < DEEPEST && (cell.depth < 20 || size > self.width[cell.segment])
        });
        if wanted { self.tree.children(id) } else { None }
    }

    fn leaf(&mut self, i: Id, j: Id) -> Option<Leaf> {
        let (a, b) = (self.tree.node(i), self.tree.node(j));
        let rule = |node| Some(Leaf::Rule(node));
        if i == j {
            return if a.cone.within_45_degrees() { rule(Node::Cone(axis_of(&[&a.cone]))) } else { None };
        }
        if self.tree.touching(i, j) && self.tree.within_45_degrees(i, j) {
            return rule(Node::Cone(axis_of(&[&a.cone, &b.cone])));
        }
        let q0 = sub(&a.mid, &b.mid);
        let (length, spread) = (norm(&q0), a.rad + b.rad);
        let (first, second) = (Node::Side([1, 0]), Node::Side([0, 1]));
        if !self.fine || (a.cell.is_some() && b.cell.is_some()) {
            for (node, side) in [(a, first), (b, second)] {
                if tilted(&q0, length, spread, node) {
                    return rule(side);
                }
            }
        }
        let (Some(x), Some(y)) = (self.tree.cell(i), self.tree.cell(j)) else { return None };
        if let Some(k) = self.known(i, j) {
            return Some(Leaf::Root(k));
        }
        if x.p.is_empty() || y.p.is_empty() {
            return None;
        }
        let e = 2.0 * (x.p_err + y.p_err);
        for (cell, side) in [(x, first), (y, second)] {
            if one_side(x, y, cell, e) {
                return rule(side);
            }
        }
        let (narrow, apart) = (a.cone.cos.min(b.cone.cos) > 0.9, spread < 0.25 * length);
        if !(narrow || apart) {
            return None;
        }
        let [(s, hs), (t, ht)] = [x, y].map(|cell| {
            let h = ldexp(1.0, -i64::from(cell.depth));
            ((cell.index as f64 + 0.5) * h, h)
        });
        let at = |s: f64, t: f64| newton_step(&self.tree.evaluate(x.segment, s), &self.tree.evaluate(y.segment, t));
        let step = at(s, t)?;
        let model = Model::of(&step, [hs, ht], bulge(x) + bulge(y));
        let near = |ds: f64, dt: f64| ds.abs() < 0.7 * hs && dt.abs() < 0.7 * ht;
        let promising = near(step.ds, step.dt);
        let blurred = !apart && a.rad.max(b.rad) <= 64.0 * x.p_err.max(y.p_err);
        let [first_changes, second_changes] = step.changes([hs, ht]);
        if first_changes && second_changes && model.shares.is_none() && !promising && !blurred {
            return None; // no rule would close the cells
        }
        let gap = Gap::of(x, y);
        if !first_changes && gap.ds().one_sign() == Some(true) {
            return rule(first);
        }
        if !second_changes && gap.dt().one_sign() == Some(true) {
            return rule(second);
        }
        if let Some(fields) = model.shares.map(|shares| sides(x, y, shares))
            && gap.together(fields) == Some(true)
        {
            return rule(Node::Side(fields.map(|k| k as i64)));
        }
        // where f64 no longer sees the arcs, their exact points may still have a side
        if blurred && let Some(side) = exact_side(self.tree.frame, [x, y]) {
            return rule(side);
        }
        let (mut p, mut q, mut last) = (s + step.ds, t + step.dt, step);
        // in a box of a pair that is alone there it would most likely lead to that
        if !promising || self.claimed([x.segment as f64 + p, y.segment as f64 + q]) {
            return None;
        }
        for _ in 0..8 {
            if last.ds.abs() <= 1e-13 * hs && last.dt.abs() <= 1e-13 * ht {
                break;
            }
            last = at(p, q)?;
            (p, q) = (p + last.ds, q + last.dt);
            if !near(p - s, q - t) {
                return None;
            }
        }
        if self.met([x.segment as f64 + p, y.segment as f64 + q]) {
            return None;
        }
        let root = self.prove([x, y], &gap, [(p - s) / hs + 0.5, (q - t) / ht + 0.5])?;
        if self.found.roots.iter().any(|known| self.meets(known, &root)) {
            return None;
        }
        self.found.roots.push(root);
        self.known(i, j).map(Leaf::Root)
    }

    /// The pair that is alone in a box that holds two arcs, either way round.
    fn known(&self, i: Id, j: Id) -> Option<usize> {
        let arcs = [i, j].map(|id| self.tree.node(id));
        let near = arcs.map(|node| [node.start, node.end].map(Place::near));
        let turn = self.tree.frame.segments.len() as f64;
        let turns = if self.tree.frame.closed { vec![0.0, turn, -turn] } else { vec![0.0] };
        let maybe = |k: usize, [from, to]: &[f64; 2]| {
            turns.iter().any(|turn| *from <= near[k][0] + turn && near[k][1] + turn <= *to)
        };
        let inside = |k: usize, range: &[Dyadic; 2]| {
            let [from, to] = [arcs[k].start, arcs[k].end].map(Place::position);
            self.turns().iter().any(|turn| range[0].cmp(&from.add(turn)).is_le() && to.add(turn).cmp(&range[1]).is_le())
        };
        self.found.roots.iter().position(|root| {
            let ([s, t], [u, v]) = (&root.outer, &root.about);
            (maybe(0, u) && maybe(1, v) && inside(0, s) && inside(1, t))
                || (maybe(0, v) && maybe(1, u) && inside(0, t) && inside(1, s))
        })
    }

    /// Is a place, in positions, in a box in which a pair is alone?
    fn claimed(&self, place: [f64; 2]) -> bool {
        let near = |root: &Root, k: usize| root.about[k][0] <= place[k] && place[k] <= root.about[k][1];
        let at = place.map(Dyadic::from_f64);
        let inside = |[from, to]: &[Dyadic; 2], at: &Dyadic| from.cmp(at).is_le() && at.cmp(to).is_le();
        self.found.roots.iter().any(|root| (0..2).all(|k| near(root, k) && inside(&root.outer[k], &at[k])))
    }

    /// Is a place, in positions, that of a pair that is known? Numerically.
    fn met(&self, place: [f64; 2]) -> bool {
        self.found.roots.iter().any(|root| {
            (0..2).all(|k| {
                let [from, to] = root.inner[k].each_ref().map(|x| x.m.to_f64_shifted(-x.e));
                from <= place[k] && place[k] <= to
            })
        })
    }

    /// May two boxes hold the same pair?
    fn meets(&self, a: &Root, b: &Root) -> bool {
        let meet = |a: &[Dyadic; 2], b: &[Dyadic; 2]| {
            self.turns().iter().any(|turn| a[0].cmp(&b[1].add(turn)).is_le() && b[0].add(turn).cmp(&a[1]).is_le())
        };
        let ([s, t], [u, v]) = (&a.inner, &b.inner);
        (meet(s, u) && meet(t, v)) || (meet(s, v) && meet(t, u))
    }

    /// By how much a position may be moved: whole turns of a closed spine.
    fn turns(&self) -> Vec<Dyadic> {
        let turn = Dyadic { m: Int::from(self.tree.frame.segments.len() as i64), e: 0 };
        let back = Dyadic::ZERO.sub(&turn);
        if self.tree.frame.closed { vec![Dyadic::ZERO, turn, back] } else { vec![Dyadic::ZERO] }
    }

    /// A pair near a place of two cells, given in their own parameters, that is alone in a box that holds the cells.
    fn prove(&self, [x, y]: [Cell; 2], gap: &Gap, near: [f64; 2]) -> Option<Root> {
        let cells = [x, y];
        let h = cells.map(|cell| ldexp(1.0, -i64::from(cell.depth)));
        // to hold the neighbours of the cells too, at least where the pair is near their border
        let needed = near.map(|u| [if u < 0.06 { -0.25 } else { 0.0 }, if u > 0.94 { 1.25 } else { 1.0 }]);
        // the range of a span in the parameter of the cell
        let span = [0, 1].map(|k| [-(cells[k].index as f64), 1.0 / h[k] - cells[k].index as f64]);
        if (0..2).any(|k| needed[k][0] < span[k][0] || span[k][1] < needed[k][1]) {
            return self.prove_exactly(cells, near);
        }
        let wide = span.map(|[from, to]| [from.max(-0.5), to.min(1.5)]);
        let place = |k: usize, u: f64| {
            let cell = cells[k];
            let start = Dyadic { m: Int::from(BigInt::from(cell.index)), e: 0 }.add(&Dyadic::from_f64(u));
            let local = Dyadic { e: start.e - i64::from(cell.depth), ..start };
            local.add(&Dyadic::from(cell.segment as i64))
        };
        let places = |ranges: [[f64; 2]; 2]| [0, 1].map(|k| ranges[k].map(|u| place(k, u)));
        let nets = [gap.ds(), gap.dt()].map(|f| Net::of(f, f.exp));
        let field = |part: [[f64; 2]; 2]| Field::single(nets.each_ref().map(|net| net.cut(part)));
        if !Field::single(nets.clone()).once() {
            return None; // the cells alone are too large; they need no cutting
        }
        let outer = [wide, needed].into_iter().find(|part| field(*part).once())?;
        // exact boxes of high degrees would take seconds each: a wider one then
        let heavy = cells.iter().any(|cell| cell.r.len() > 24);
        for wider in if heavy { [0.44, 29.0].as_slice() } else { &[0.44] } {
            let inner = [0, 1].map(|k| {
                let half = (wider * self.width[cells[k].segment] / h[k]).min(0.04);
                [near[k] - half, near[k] + half]
            });
            let within = (0..2).all(|k| outer[k][0] < inner[k][0] && inner[k][1] < outer[k][1]);
            if within
                && field(inner).vanishes()
                && let Some(mut distance) = distance_over([x, y], &gap.d, inner)
            {
                let crosses = |[i, k]: [usize; 2]| {
                    Field::single([&gap.d[i], &gap.d[k]].map(|d| Net::of(d, d.exp).cut(inner))).vanishes()
                };
                if distance.lo() == 0.0 && self.across.is_some_and(crosses) {
                    distance = Interval::point(0.0);
                }
                let (outer, inner) = (places(outer), places(inner));
                let about = about(&outer);
                return Some(Root { outer, inner, distance, place: On::Spine, point: None, about });
            }
        }
        self.prove_exactly(cells, near)
    }

    /// The same on the exact arcs, also across joints.
    fn prove_exactly(&self, cells: [Cell; 2], near: [f64; 2]) -> Option<Root> {
        let frame = self.tree.frame;
        let depth = cells.map(|cell| i64::from(cell.depth));
        let centre = [0, 1].map(|k| {
            let local = Dyadic { m: Int::from(BigInt::from(cells[k].index)), e: 0 };
            let local = local.add(&truncated(&Dyadic::from_f64(near[k]), 40));
            Dyadic { e: local.e - depth[k], ..local }
        });
        // a power of two of at least the distance to the far end of the cell
        let reach = [0, 1].map(|k| {
            let far = near[k].abs().max((1.0 - near[k]).abs()) + 1e-9;
            (0..=2).rev().find(|j| far <= ldexp(1.0, -j)).map_or(depth[k] - 1, |j| depth[k] + j)
        });
        if reach.iter().any(|reach| *reach < 1) {
            return None;
        }
        let around = |centre: &[Dyadic; 2], reach: [i64; 2]| -> Option<[Strand; 2]> {
            let strand = |k: usize| {
                let (t, half) = (&centre[k], step(reach[k]));
                strand_beyond(frame, cells[k].segment, &t.sub(&half), &t.add(&half))
            };
            Some([strand(0)?, strand(1)?])
        };
        let places = |centre: &[Dyadic; 2], reach: [i64; 2]| {
            [0, 1].map(|k| {
                let (at, half) = (centre[k].add(&Dyadic::from(cells[k].segment as i64)), step(reach[k]));
                [at.sub(&half), at.add(&half)]
            })
        };
        let outer = places(&centre, reach);
        if !self.apart(&outer) {
            return None;
        }
        let [x, y] = around(&centre, reach)?;
        if !Field::of_strands(&x, &y).once() {
            return None;
        }
        // closer to the pair, from what F is at a corner
        let mut at = centre;
        for bits in [30, 50] {
            let reach = [0, 1].map(|k| reach[k].max(bits));
            let [x, y] = around(&at, reach)?;
            let by = Field::of_strands(&x, &y).estimate()?;
            at = [0, 1].map(|k| {
                let moved = at[k].sub(&step(reach[k])).add(&Dyadic::from_f64(by[k]));
                truncated(&moved, 80)
            });
        }
        let asked = [0, 1].map(|k| 1 - decompose_exponent(0.44 * self.width[cells[k].segment]));
        for more in [0, -6, 24, 48] {
            let reach = [0, 1].map(|k| (asked[k] + more).max(depth[k] + 3));
            let (inner, [x, y]) = (places(&at, reach), around(&at, reach)?);
            let inside = (0..2).all(|k| outer[k][0].cmp(&inner[k][0]).is_lt() && inner[k][1].cmp(&outer[k][1]).is_lt());
            if !inside || !Field::of_strands(&x, &y).vanishes() {
                continue;
            }
            let mut distance = distance_exactly(&x, &y)?;
            if distance.lo() == 0.0 && self.across.is_some_and(|axes| Field::of_gap(&x, &y, axes).vanishes()) {
                distance = Interval::point(0.0);
            }
            let about = about(&outer);
            let root = Root { outer: outer.clone(), inner, distance, place: On::Spine, point: None, about };
            if let Some(root) = self.settled(root) {
                return Some(root);
            }
        }
        None
    }

    /// Decides whether a pair near an end of an open spine is on it; `None` if its box is too wide to tell.
    fn settled(&self, mut root: Root) -> Option<Root> {
        let frame = self.tree.frame;
        if frame.closed {
            return Some(root);
        }
        let ends = [Dyadic::ZERO, Dyadic::from(frame.segments.len() as i64)];
        // strictly inside is the pair
        if root.inner.iter().any(|[from, to]| to.cmp(&ends[0]).is_le() || from.cmp(&ends[1]).is_ge()) {
            root.place = On::Beyond;
            return Some(root);
        }
        let at_end =
            |[from, to]: &[Dyadic; 2]| ends.iter().find(|end| from.cmp(end).is_lt() && end.cmp(to).is_lt()).cloned();
        let [s, t] = root.inner.each_ref().map(at_end);
        if s.is_none() && t.is_none() {
            return Some(root);
        }
        // exactly at the end, with a simple parameter
        let place = |k: usize, end: Option<&Dyadic>| {
            let [from, to] = &root.inner[k];
            let middle = Dyadic { e: -1, ..Dyadic::ONE }.mul(&from.add(to));
            let at = located(frame, end.unwrap_or(&middle));
            let t = at.t.m.to_f64_shifted(-at.t.e);
            fraction((at.segment, t), 10_000, 1e-8)
        };
        if let (Some(p), Some(q)) = (place(0, s.as_ref()), place(1, t.as_ref()))
            && let Some((num, den)) = Exact::new(frame).stationary_sq(&p, &q)
        {
            let position = |(k, num, den): &Simple| Rational::new(num.big(), den.big()) + BigInt::from(*k);
            let point = [position(&p), position(&q)];
            let inside = |([from, to], x): (&[Dyadic; 2], &Rational)| {
                compare(&from.rational(), x).is_le() && compare(x, &to.rational()).is_le()
            };
            if root.outer.iter().zip(&point).all(inside) {
                let near = ratio(&num, &den);
                root.distance = if num.m.is_zero() {
                    Interval::point(0.0)
                } else {
                    // the quotient is off by three roundings
                    Interval::new(near * (1.0 - ROUNDING), near * (1.0 + ROUNDING) + 1e-300).sqrt()
                };
                root.point = Some(point);
                return Some(root);
            }
        }
        let (k, end) = match (s, t) {
            (Some(end), None) => (0, end),
            (None, Some(end)) => (1, end),
            _ => return None,
        };
        if stationary_on(frame, &end, &root.inner[1 - k])? {
            root.inner[k] = [end.clone(), end];
            root.place = On::End;
            return Some(root);
        }
        None
    }

    /// Have the two sides of a box no parameter in common?
    fn apart(&self, [s, t]: &[[Dyadic; 2]; 2]) -> bool {
        let (low, high) = if s[0].cmp(&t[0]).is_lt() { (s, t) } else { (t, s) };
        let turn = Dyadic::from(self.tree.frame.segments.len() as i64);
        low[1].cmp(&high[0]).is_lt() && (!self.tree.frame.closed || high[1].cmp(&low[0].add(&turn)).is_lt())
    }

    /// Leaves pairs open.
    fn leave(&mut self, pairs: &[Pair]) {
        for pair in pairs {
            self.found.nodes[pair.node] = Entry::Leaf(Leaf::Open);
            let (a, b) = (self.tree.node(pair.i), self.tree.node(pair.j));
            let length = norm(&sub(&a.mid, &b.mid));
            let spread = (a.rad + b.rad) * (1.0 + ROUNDING) + ROUNDING * length;
            // products of two different vectors of the ball are met in Bernstein coefficients of |D|^2; blocks are not told
            let least = length * length - 2.0 * length * spread - spread * spread;
            let least = (least - ROUNDING * length * length).max(0.0).sqrt() * (1.0 - ROUNDING);
            let one = a.cell.is_some() && b.cell.is_some() && spread.is_finite();
            let distance = if one { Interval::new(least, length + spread) } else { Interval::new(0.0, f64::INFINITY) };
            self.found.open.push(Open { places: [[a.start, a.end], [b.start, b.end]], distance });
        }
    }

    /// Leaves crowds open; the other pairs go on.
    fn without_crowds(&mut self, pairs: Vec<Pair>, size: f64) -> Vec<Pair> {
        if size > 0.2 || pairs.len() <= CROWD {
            return pairs;
        }
        // so many that no group is looked for: beyond what f64 resolves
        if pairs.len() > MOST + 64 * self.tree.frame.segments.len() {
            self.leave(&pairs);
            return vec![];
        }
        let places = |pair: &Pair| [pair.i, pair.j].map(|id| [self.tree.node(id).start, self.tree.node(id).end]);
        let (crowds, few): (Vec<_>, Vec<_>) =
            connected(&pairs.iter().map(places).collect::<Vec<_>>()).into_iter().partition(|crowd| crowd.len() > CROWD);
        let members = |groups: Vec<Vec<usize>>| groups.into_iter().flatten().map(|k| pairs[k]).collect::<Vec<_>>();
        self.leave(&members(crowds));
        members(few)
    }
}

impl Found {
    /// The tree in preorder, the pairs numbered anew.
    pub(crate) fn tree(&self, numbers: &[usize]) -> Vec<Node> {
        let (mut nodes, mut open) = (vec![], vec![0]);
        while let Some(k) = open.pop() {
            nodes.push(match self.nodes[k] {
                Entry::Split(kind, first) => {
                    let count = if kind == Node::Split { 3 } else { 2 };
                    open.extend((first..first + count).rev());
                    kind
                }
                Entry::Leaf(Leaf::Rule(node)) => node,
                Entry::Leaf(Leaf::Root(k)) => Node::Pair(numbers[k]),
                Entry::Leaf(Leaf::Open) | Entry::Waiting => Node::Open,
            });
        }
        nodes
    }

    /// Joins open cells that touch, until there are few.
    fn join(&mut self) {
        /// Of one group of cells that touch, or of all.
        const MOST: usize = 16;
        let open = std::mem::take(&mut self.open);
        let places: Vec<[[Place; 2]; 2]> = open.iter().map(|open| open.places).collect();
        let groups = if open.len() > 8 * CROWD { vec![(0..open.len()).collect()] } else { connected(&places) };
        for mut group in groups {
            // along the parameter in which it is longer
            group.sort_by_key(|&k| (places[k][0][0], places[k][1][0]));
            let size = group.len().div_ceil(MOST);
            for part in group.chunks(size) {
                let joined = part
                    .iter()
                    .map(|&k| &open[k])
                    .fold(None, |all: Option<Open>, next| Some(all.map_or_else(|| next.clone(), |all| all.hull(next))));
                self.open.extend(joined);
            }
        }
    }
}

impl Open {
    fn hull(&self, other: &Self) -> Self {
        let places = [0, 1].map(|k| {
            let ([a, b], [c, d]) = (self.places[k], other.places[k]);
            [a.min(c), b.max(d)]
        });
        Self { places, distance: self.distance.hull(other.distance) }
    }
}

/// Groups of boxes that touch one another.
fn connected(boxes: &[[[Place; 2]; 2]]) -> Vec<Vec<usize>> {
    fn leader(of: &mut [usize], mut k: usize) -> usize {
        while of[k] != k {
            of[k] = of[of[k]];
            k = of[k];
        }
        k
    }
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by_key(|&k| boxes[k]);
    let mut of: Vec<usize> = (0..boxes.len()).collect();
    let mut near: Vec<usize> = vec![];
    for &k in &order {
        near.retain(|&l| boxes[l][0][1] >= boxes[k][0][0]);
        for &l in &near {
            if boxes[l][1][0] <= boxes[k][1][1] && boxes[k][1][0] <= boxes[l][1][1] {
                let (a, b) = (leader(&mut of, k), leader(&mut of, l));
                of[a.max(b)] = a.min(b);
            }
        }
        near.push(k);
    }
    let mut groups = BTreeMap::<usize, Vec<usize>>::new();
    for k in 0..boxes.len() {
        groups.entry(leader(&mut of, k)).or_default().push(k);
    }
    groups.into_values().collect()
}

/// A position as a segment and its parameter.
fn located(frame: &Frame, position: &Dyadic) -> At {
    let last = frame.segments.len() - 1;
    let whole = if position.e >= 0 {
        (&position.m << position.e as u64).big()
    } else {
        position.m.big() >> (-position.e) as u64
    };
    let segment = whole.to_usize().unwrap_or(0).min(last);
    At { segment, t: position.sub(&Dyadic::from(segment as i64)) }
}

/// Has F a zero exactly, for one position and another in a range?
fn stationary_on(frame: &Frame, end: &Dyadic, range: &[Dyadic; 2]) -> Option<bool> {
    let (end, from) = (located(frame, end), located(frame, &range[0]));
    let to = range[1].sub(&Dyadic::from(from.segment as i64));
    if to.cmp(&Dyadic::ONE).is_gt() {
        return None;
    }
    let (bezier, finish) = (&frame.segments[end.segment], !end.t.m.is_zero());
    let (tangent, point) = (bezier.end_tangent(finish), bezier.point(if finish { bezier.degree() } else { 0 }));
    let arc = frame.segments[from.segment].arc(&from.t, &to).forms();
    let constant = |k: &Int| Form::from_bernstein(std::slice::from_ref(k));
    let d: Vec3<Int> =
        std::array::from_fn(|k| arc.r[k].mul(&constant(&point[3])).sub(&arc.w.mul(&constant(&point[k]))));
    let across = d.iter().zip(&tangent).map(|(d, k)| d.mul(&constant(k)));
    let across = across.reduce(|a, b| a.add(&b))?;
    let along = dot(&d, &arc.a);
    Some(common_zero(&[across.bernstein(), along.bernstein()]).is_some())
}

/// Ranges in f64, a little wider.
fn about(ranges: &[[Dyadic; 2]; 2]) -> [[f64; 2]; 2] {
    ranges.each_ref().map(|[from, to]| {
        let near = |x: &Dyadic| x.m.to_f64_shifted(-x.e);
        [near(from) - 1e-6, near(to) + 1e-6]
    })
}

/// A side rule on the exact arcs.
fn exact_side(frame: &Frame, cells: [Cell; 2]) -> Option<Node> {
    let [x, y] = cells.map(|cell| cell.exact(frame).forms());
    let y = y.transposed();
    let d = x.difference(&y);
    let sided = |a| dot(&d, a).one_sign() == Some(true);
    if sided(&x.a) { Some(Node::Side([1, 0])) } else { sided(&y.a).then_some(Node::Side([0, 1])) }
}
