//! The walk of the trees: docs/certificate-format.md, sections 3 to 5. The stack is on the heap.

use std::collections::BTreeMap;
use std::rc::Rc;

use num_bigint::Sign;

use super::Rejection;
use super::arc::{Arc, Piece, Spine};
use super::rules::{NOT_POSITIVE, Why, bent, check, cone, curved, share, side, slab};
use crate::certificate::{EndTree, Node};
use crate::number::Rational;

const MISPLACED: Why = "the rule does not belong here";

pub(super) struct Walk<'a> {
    pub(super) spine: &'a Spine,
    /// The square of the radius.
    pub(super) r: &'a Rational,
    /// How many leaves each rule closed.
    pub(super) leaves: BTreeMap<&'static str, usize>,
}

enum Pair {
    Same(Arc),
    Two(Arc, Arc),
}

use Pair::{Same, Two};

impl Walk<'_> {
    /// Walks a tree from `root`; `step` gives the children of a node, in their order, or checks a leaf.
    fn tree<T>(
        &mut self,
        section: &'static str,
        nodes: &[Node],
        root: T,
        mut step: impl FnMut(&Node, T) -> Result<Vec<T>, Why>,
    ) -> Result<(), Rejection> {
        let mut open = vec![root];
        for (i, node) in nodes.iter().enumerate() {
            let next = open.pop().ok_or("the tree has ended before");
            let children = next.and_then(|next| step(node, next)).map_err(|why| Rejection {
                node: Some(i + 1),
                rule: node.to_string(),
                ..Rejection::of(section, why)
            })?;
            if children.is_empty() {
                *self.leaves.entry(node.name()).or_default() += 1;
            }
            open.extend(children.into_iter().rev());
        }
        if open.is_empty() { Ok(()) } else { Err(Rejection::of(section, "the tree stops short")) }
    }

    pub(super) fn along(&mut self, nodes: &[Node]) -> Result<(), Rejection> {
        let (spine, r) = (self.spine, self.r);
        self.tree("along", nodes, spine.spans.clone(), |node, arc| match node {
            Node::Split => spine.halves(&arc).map(Vec::from),
            Node::Curved => curved(one(&arc)?, r).map(|()| vec![]),
            _ => Err(MISPLACED),
        })
    }

    pub(super) fn pairs(&mut self, nodes: &[Node]) -> Result<(), Rejection> {
        let (spine, r) = (self.spine, self.r);
        self.tree("pairs", nodes, Same(spine.spans.clone()), |node, pair| {
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
                    cone(&[&**a, &**b].concat(), g)
                }
                (Node::Slab(g), Two(a, b)) => slab(a, b, g, r),
                (Node::Side(fields), Two(a, b)) => side(one(a)?, one(b)?, *fields),
                (Node::Bent(fields), Two(a, b)) => {
                    check(bent(one(a)?, one(b)?, *fields, r)?.has_sign(Sign::Plus), NOT_POSITIVE)
                }
                _ => Err(MISPLACED),
            }?;
            Ok(vec![])
        })
    }

    /// The end `e` and the body; on the finish the order is reversed.
    pub(super) fn end(&mut self, finish: bool, (axis, nodes): &EndTree, e: &Rc<Piece>) -> Result<(), Rejection> {
        let (spine, r) = (self.spine, self.r);
        let mut local = true;
        self.tree(if finish { "finish" } else { "start" }, nodes, spine.spans.clone(), |node, arc| {
            match node {
                Node::Split => {
                    let [first, second] = spine.halves(&arc)?;
                    return Ok(if finish { vec![second, first] } else { vec![first, second] });
                }
                Node::Local => check(local, "a leaf before this one is not local").and_then(|()| cone(&arc, axis)),
                Node::Slab(g) => slab(&arc, &[e.clone()], g, r),
                Node::Share(k) => check(share(e, one(&arc)?, *k, r)?.is_positive(), NOT_POSITIVE),
                _ => Err(MISPLACED),
            }?;
            local = *node == Node::Local;
            Ok(vec![])
        })
    }
}

fn one(arc: &Arc) -> Result<&Piece, Why> {
    if let [piece] = &**arc { Ok(piece) } else { Err("the arc is more than one piece") }
}
