//! The walk of the trees: docs/certificate-format.md, sections 3 to 5. The stack is on the heap.

use num_traits::{One, Zero};

use super::Rejection;
use super::arc::{Arc, DEPTH, Piece, Spine};
use super::poly::{Poly, halves};
use super::rules::{WEIGHTS, Why, check, cone, curved, positive, share, slab};
use crate::certificate::{EndTree, Node};
use crate::number::Rational;

pub(super) const MISPLACED: Why = "the rule does not belong here";

enum Pair {
    Same(Arc),
    Two(Arc, Arc),
}

/// Walks a tree from `root`; `step` gives the children of a node, in their order, or checks a leaf.
fn tree<T>(
    section: &'static str,
    nodes: &[Node],
    root: T,
    mut step: impl FnMut(&Node, T) -> Result<Vec<T>, Why>,
) -> Result<(), Rejection> {
    let mut open = vec![root];
    for (i, node) in nodes.iter().enumerate() {
        let next = open.pop().ok_or("the tree has ended before");
        let children = next.and_then(|next| step(node, next));
        open.extend(children.map_err(|why| Rejection::of(section, why).at(i + 1, node))?.into_iter().rev());
    }
    if open.is_empty() { Ok(()) } else { Err(Rejection::of(section, "the tree stops short")) }
}

/// The forms of a span are made once, and their Bernstein coefficients halved with it.
pub(super) fn along(spine: &Spine, r: &Rational, nodes: &[Node]) -> Result<(), Rejection> {
    tree("along", nodes, (spine.spans.clone(), 0, None), |node, (arc, depth, forms)| {
        if arc.len() > 1 && *node == Node::Split {
            return Ok(spine.halves(&arc)?.map(|arc| (arc, 0, None)).into());
        }
        let [w, form] = if let Some(forms) = forms { forms } else { curved(one(&arc)?, r).map(|form| form.control()) };
        match node {
            Node::Split => {
                check(depth < DEPTH, "a part deeper than 512 halvings")?;
                let ([w, after], [form, next]) = (halves(w), halves(form));
                Ok([[w, form], [after, next]].map(|forms| (arc.clone(), depth + 1, Some(forms))).into())
            }
            Node::Curved => check(Poly(w).is_positive(), WEIGHTS).and_then(|()| positive(&Poly(form))).map(|()| vec![]),
            _ => Err(MISPLACED),
        }
    })
}

/// The leaves of pairs of one arc are `cone` and `open`.
pub(super) fn pairs(
    spine: &Spine,
    section: &'static str,
    nodes: &[Node],
    mut leaf: impl FnMut(&Node, &Arc, &Arc) -> Result<(), Why>,
) -> Result<(), Rejection> {
    use Pair::{Same, Two};
    tree(section, nodes, Same(spine.spans.clone()), |node, pair| {
        match (node, &pair) {
            (Node::Split, Same(a)) => {
                let [first, second] = spine.halves(a)?;
                return Ok(vec![Same(first.clone()), Two(first, second.clone()), Same(second)]);
            }
            (Node::SplitFirst, Two(a, b)) => return Ok(spine.halves(a)?.map(|a| Two(a, b.clone())).into()),
            (Node::SplitSecond, Two(a, b)) => return Ok(spine.halves(b)?.map(|b| Two(a.clone(), b)).into()),
            (Node::Cone(g), Same(a)) => cone(a, g),
            (Node::Cone(g), Two(a, b)) => {
                check(spine.touch(a, b), "the arcs do not touch")?;
                cone(a, g).and_then(|()| cone(b, g))
            }
            (Node::Open, Same(a)) => leaf(node, a, a),
            (_, Two(a, b)) => leaf(node, a, b),
            _ => Err(MISPLACED),
        }?;
        Ok(vec![])
    })
}

/// The start, or the finish, and the body; on the finish the order is reversed.
pub(super) fn end(spine: &Spine, r: &Rational, finish: bool, (axis, nodes): &EndTree) -> Result<(), Rejection> {
    let (section, t) = if finish { ("finish", Rational::one()) } else { ("start", Rational::zero()) };
    let span = if finish { spine.spans.last() } else { spine.spans.first() };
    let e = span.ok_or_else(|| Rejection::of(section, "there is no span"))?.at(&t);
    let mut local = true;
    tree(section, nodes, spine.spans.clone(), |node, arc| {
        match node {
            Node::Split => {
                let [first, second] = spine.halves(&arc)?;
                return Ok(if finish { vec![second, first] } else { vec![first, second] });
            }
            Node::Local => check(local, "a leaf before this one is not local").and_then(|()| cone(&arc, axis)),
            Node::Slab(g) => slab(&arc, std::slice::from_ref(&e), g, r),
            Node::Share(k) => positive(&share(&e, one(&arc)?, *k, r)?),
            _ => Err(MISPLACED),
        }?;
        local = *node == Node::Local;
        Ok(vec![])
    })
}

pub(super) fn one(arc: &Arc) -> Result<&Piece, Why> {
    if let [piece] = &**arc { Ok(piece) } else { Err("the arc is more than one piece") }
}
