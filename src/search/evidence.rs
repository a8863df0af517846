//! The evidence for a lower bound: split trees whose leaves name a rule (docs/certificate-format.md).
//!
//! The searches are run once more at the radius that they proved, in the order of the trees, with the rules as the
//! checker will have them. What is written here claims nothing: it is replayed before it is given out.

use super::apart::{balls_apart, hulls_apart_along, rounded};
use super::curvature::Strips;
use super::ends::{Of, Search};
use super::frame::Frame;
use super::newton::newton_step;
use super::rules::{Closed, Gap, Model, Shape, UNITS, across, bulge, decide, one_side, sides, tilted};
use super::tree::{Cell, Cone, Id, Tree, norm, sub, unit};
use crate::certificate::{EndTree, Node};
use crate::integer::{Int, ldexp};

/// More nodes are not written: such a certificate would be of no use.
const MAX_NODES: usize = 2_000_000;
/// How many halvings of a span the checker allows.
const MAX_DEPTH: u32 = 500;

/// Ways in which a search can be wrong, planted by tests: every one must be rejected by the checker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fault {
    CurvatureUnproved,
    SignFlipped,
    RadiusForgotten,
    CellDropped,
    CellRepeated,
    LocalUnproved,
    ShareUnproved,
}

#[cfg(test)]
thread_local! {
    pub(crate) static FAULT: std::cell::Cell<Option<Fault>> = const { std::cell::Cell::new(None) };
}

#[cfg(test)]
pub(crate) fn planted(fault: Fault) -> bool {
    FAULT.get() == Some(fault)
}

#[cfg(not(test))]
pub(crate) const fn planted(_: Fault) -> bool {
    false
}

/// Denominator, regularity, and 1/kappa > r (r = 0: the first two).
pub(crate) fn along(frame: &Frame, r: f64) -> Option<Vec<Node>> {
    let mut nodes = vec![];
    blocks(frame, 0, frame.segments.len(), r, &mut nodes)?;
    Some(nodes)
}

fn blocks(frame: &Frame, from: usize, to: usize, r: f64, nodes: &mut Vec<Node>) -> Option<()> {
    if to - from > 1 {
        let middle = from + (to - from) / 2;
        nodes.push(Node::Split);
        blocks(frame, from, middle, r, nodes)?;
        return blocks(frame, middle, to, r, nodes);
    }
    let bezier = &frame.segments[from];
    let mut open = vec![(Strips::new(bezier), 0u32, Int::ZERO)];
    while let Some((mut strips, depth, index)) = open.pop() {
        strips.freshen(depth, || bezier.cell(&index, depth));
        if strips.curved(bezier, depth, &index, r) || planted(Fault::CurvatureUnproved) {
            nodes.push(Node::Curved);
            continue;
        }
        if depth >= MAX_DEPTH || nodes.len() > MAX_NODES {
            return None;
        }
        nodes.push(Node::Split);
        let (left, right) = strips.cut(0.5);
        let twice = &index << 1;
        open.push((right, depth + 1, &twice + &Int::ONE));
        open.push((left, depth + 1, twice));
    }
    Some(())
}

/// No doubly critical pair that is not local has |q| <= 2r.
pub(crate) fn pairs(tree: &mut Tree, r: f64, margin: f64) -> Option<Vec<Node>> {
    let root = tree.root();
    let r = if planted(Fault::RadiusForgotten) { 0.0 } else { r };
    let mut pairs = Pairs { tree, r, margin, nodes: vec![] };
    pairs.visit(root, root)?;
    Some(pairs.nodes)
}

struct Pairs<'t, 'f> {
    tree: &'t mut Tree<'f>,
    r: f64,
    margin: f64,
    nodes: Vec<Node>,
}

impl Pairs<'_, '_> {
    fn visit(&mut self, i: Id, j: Id) -> Option<()> {
        if let Some(leaf) = self.leaf(i, j) {
            self.nodes.push(leaf);
            return Some(());
        }
        if self.nodes.len() > MAX_NODES {
            return None;
        }
        if i == j {
            let (l, r) = self.tree.children(i)?;
            self.nodes.push(Node::Split);
            self.visit(l, l)?;
            if !planted(Fault::CellDropped) {
                self.visit(l, r)?;
            }
            return self.visit(r, r);
        }
        let (a, b) = (self.tree.node(i), self.tree.node(j));
        // tilt is a rule for single pieces
        let q0 = sub(&a.mid, &b.mid);
        let tilt = [a, b].iter().any(|node| tilted(&q0, norm(&q0), a.rad + b.rad, node));
        let first = match (a.cell.is_none(), b.cell.is_none()) {
            (true, false) if tilt => true,
            (false, true) if tilt => false,
            _ => self.tree.first_is_split(i, j),
        };
        let (of_first, of_second) = ((Node::SplitFirst, i), (Node::SplitSecond, j));
        let order = if first { [of_first, of_second] } else { [of_second, of_first] };
        let (split, (l, r)) = order.into_iter().find_map(|(split, id)| Some((split, self.tree.children(id)?)))?;
        self.nodes.push(split);
        let r = if planted(Fault::CellRepeated) { l } else { r };
        for half in [l, r] {
            if split == Node::SplitFirst { self.visit(half, j)? } else { self.visit(i, half)? }
        }
        Some(())
    }

    fn leaf(&self, i: Id, j: Id) -> Option<Node> {
        let (a, b) = (self.tree.node(i), self.tree.node(j));
        if i == j {
            return a.cone.within_45_degrees().then(|| Node::Cone(axis_of(&[&a.cone])));
        }
        if self.tree.touching(i, j) && self.tree.within_45_degrees(i, j) {
            return Some(Node::Cone(axis_of(&[&a.cone, &b.cone])));
        }
        let q0 = sub(&a.mid, &b.mid);
        let (length, spread) = (norm(&q0), a.rad + b.rad);
        if let Some(u) = balls_apart(&q0, spread, self.r) {
            return Some(Node::Slab(u));
        }
        let (Some(x), Some(y)) = (self.tree.cell(i), self.tree.cell(j)) else { return None };
        if tilted(&q0, length, spread, a) || planted(Fault::SignFlipped) {
            return Some(Node::Side([1, 0]));
        }
        if tilted(&q0, length, spread, b) {
            return Some(Node::Side([0, 1]));
        }
        if x.p.is_empty() || y.p.is_empty() {
            return None;
        }
        let e = 2.0 * (x.p_err + y.p_err);
        if one_side(x, y, x, e) {
            return Some(Node::Side([1, 0]));
        }
        if one_side(x, y, y, e) {
            return Some(Node::Side([0, 1]));
        }
        for u in [q0, across(&q0, &a.cone, &b.cone)] {
            if let Some(u) = hulls_apart_along(self.tree.frame, x, y, e, &u, self.r) {
                return Some(Node::Slab(u));
            }
        }
        let narrow = a.cone.cos.min(b.cone.cos) > 0.9;
        let apart = spread < 0.25 * length;
        if !(narrow || apart) {
            return None;
        }
        let bent = |centre: [f64; 2]| {
            let [own, other] = [Shape::of(x), Shape::of(y)];
            let fields = [centre[0], centre[1], own.pace, other.pace, 2.0 * own.weight, 2.0 * other.weight];
            Node::Bent(fields.map(|x| (x * UNITS) as i64))
        };
        let exactly = |centre: [f64; 2]| match decide([x, y], self.tree.frame, self.r, centre)? {
            Closed::TiltFirst => Some(Node::Side([1, 0])),
            Closed::TiltSecond => Some(Node::Side([0, 1])),
            Closed::Bent => Some(bent(centre)),
            // by halving: the format has no rule for it
            Closed::Far => None,
        };
        // between them may lie spans that f64 does not see
        if !apart && a.rad.max(b.rad) <= 8.0 * x.p_err.max(y.p_err) {
            return exactly([0.5; 2]);
        }
        let model = model(self.tree, x, y)?;
        let bend = model.bends(bulge(x) + bulge(y), spread, self.r, self.margin);
        if !bend && model.shares.is_none() {
            return None;
        }
        let gap = Gap::of(x, y);
        if let Some(fields) = model.shares.map(|shares| sides(x, y, shares))
            && gap.together(fields) == Some(true)
        {
            return Some(Node::Side(fields.map(|k| k as i64)));
        }
        if !bend {
            return None;
        }
        match gap.bent(self.r, model.centre) {
            Some(true) => return Some(bent(model.centre)),
            Some(false) => return None,
            None => {}
        }
        if x.p_err + y.p_err < 0.02 * self.margin * model.predicted_sq.max(0.0).sqrt() {
            return None;
        }
        exactly(model.centre)
    }
}

/// The end disk of radius r misses every other, but for points whose arc to the end is within 45 degrees of the axis.
pub(crate) fn end(tree: &mut Tree, finish: bool, r: f64) -> Option<EndTree> {
    let root = tree.root();
    let r = if planted(Fault::RadiusForgotten) { 0.0 } else { r };
    let mut search = Search::new(tree, finish, Of::Disks, r, false, 0.0);
    let axis = rounded(&search.axis_of_local(), 30);
    let direction = unit(&axis.map(|x| x as f64));
    let mut nodes = vec![];
    let mut open = vec![root];
    let mut prefix = true;
    while let Some(id) = open.pop() {
        let near = search.tree.node(id).cone.within_45_degrees_of(&direction);
        if prefix && (near || planted(Fault::LocalUnproved)) {
            nodes.push(Node::Local);
            continue;
        }
        if let Some(leaf) = search.leaf(id) {
            prefix = false;
            nodes.push(leaf);
            continue;
        }
        if nodes.len() > MAX_NODES {
            return None;
        }
        nodes.push(Node::Split);
        let (left, right) = search.tree.children(id)?;
        open.extend(if finish { [left, right] } else { [right, left] });
    }
    Some((axis, nodes))
}

/// The model that the search has of two cells.
fn model(tree: &Tree, x: Cell, y: Cell) -> Option<Model> {
    let middle = |c: Cell| {
        let h = ldexp(1.0, -i64::from(c.depth));
        (c.segment, (c.index as f64 + 0.5) * h, h)
    };
    let ((i, s, hs), (j, t, ht)) = (middle(x), middle(y));
    let step = newton_step(&tree.evaluate(i, s), &tree.evaluate(j, t))?;
    Some(Model::of(&step, [hs, ht], bulge(x) + bulge(y)))
}

/// An axis about which all tangents of the cones are within 45 degrees, in few digits if that is surely so.
pub(super) fn axis_of(cones: &[&Cone]) -> [i64; 3] {
    let both = cones.iter().skip(1).fold(*cones[0], |all, cone| all.with(cone));
    let fits = |axis: &[i64; 3]| {
        let axis = unit(&axis.map(|x| x as f64));
        cones.iter().all(|cone| cone.within_45_degrees_of(&axis))
    };
    let full = rounded(&both.axis, 52);
    [8, 24].iter().map(|bits| rounded(&both.axis, *bits)).find(fits).unwrap_or(full)
}
