//! The walk of the trees: docs/certificate-format.md, sections 3 to 5. The stack is on the heap.

use std::collections::BTreeMap;

use super::Rejection;
use super::arc::{Arc, End, Piece, Spine};
use super::rules::{Squared, Why, bent, cone, curved, end_slab, share, side, slab};
use crate::certificate::{EndTree, Node, Which};

const MISPLACED: Why = "the rule does not belong here";

pub(super) struct Walk<'a> {
    pub(super) spine: &'a Spine,
    pub(super) r: Squared,
    /// How many leaves each rule closed.
    pub(super) leaves: BTreeMap<&'static str, usize>,
}

enum Pair {
    Same(Arc),
    Two(Arc, Arc),
}

impl Walk<'_> {
    /// Walks a tree from `root`; `step` gives the children of a node, in their order, or checks a leaf.
    fn tree<T>(
        &mut self,
        section: &'static str,
        nodes: &[Node],
        root: T,
        mut step: impl FnMut(&Self, &Node, T) -> Result<Vec<T>, Why>,
    ) -> Result<(), Rejection> {
        let mut open = vec![root];
        for (i, node) in nodes.iter().enumerate() {
            let next = open.pop().ok_or("the tree has ended before");
            let children = next.and_then(|next| step(self, node, next)).map_err(|why| Rejection {
                section,
                node: Some(i + 1),
                rule: node.to_string(),
                why: why.to_string(),
            })?;
            if children.is_empty() {
                *self.leaves.entry(node.name()).or_default() += 1;
            }
            open.extend(children.into_iter().rev());
        }
        if open.is_empty() { Ok(()) } else { Err(Rejection::of(section, "the tree stops short")) }
    }

    pub(super) fn along(&mut self, nodes: &[Node]) -> Result<(), Rejection> {
        self.tree("along", nodes, self.spine.whole(), |walk, node, arc| match node {
            Node::Split => walk.spine.halves(&arc).map(Vec::from),
            Node::Curved => curved(one(&arc)?, &walk.r).map(|()| vec![]),
            _ => Err(MISPLACED),
        })
    }

    pub(super) fn pairs(&mut self, nodes: &[Node]) -> Result<(), Rejection> {
        self.tree("pairs", nodes, Pair::Same(self.spine.whole()), |walk, node, pair| {
            let (spine, r) = (walk.spine, &walk.r);
            match (node, &pair) {
                (Node::Split, Pair::Same(a)) => {
                    let [first, second] = spine.halves(a)?;
                    let between = Pair::Two(first.clone(), second.clone());
                    return Ok(vec![Pair::Same(first), between, Pair::Same(second)]);
                }
                (Node::SplitOne(Which::First), Pair::Two(a, b)) => {
                    return Ok(spine.halves(a)?.map(|a| Pair::Two(a, b.clone())).into());
                }
                (Node::SplitOne(Which::Second), Pair::Two(a, b)) => {
                    return Ok(spine.halves(b)?.map(|b| Pair::Two(a.clone(), b)).into());
                }
                (Node::Cone(g), Pair::Same(a)) => cone(spine.pieces(a), g),
                (Node::Cone(g), Pair::Two(a, b)) if spine.touch(a, b) => {
                    cone(spine.pieces(a), g)?;
                    cone(spine.pieces(b), g)
                }
                (Node::Cone(_), _) => Err("the arcs do not touch"),
                (Node::Slab(g), Pair::Two(a, b)) => slab(spine.pieces(a), spine.pieces(b), g, r),
                (Node::Side(fields), Pair::Two(a, b)) => side(one(a)?, one(b)?, *fields),
                (Node::Bent(fields), Pair::Two(a, b)) => bent(one(a)?, one(b)?, *fields, r),
                _ => Err(MISPLACED),
            }?;
            Ok(vec![])
        })
    }

    /// The end `e` and the body; `reverse` on the finish.
    pub(super) fn end(
        &mut self,
        section: &'static str,
        tree: &EndTree,
        e: &End,
        reverse: bool,
    ) -> Result<(), Rejection> {
        let mut local = true;
        self.tree(section, &tree.nodes, self.spine.whole(), |walk, node, arc| {
            let pieces = walk.spine.pieces(&arc);
            match node {
                Node::Split => {
                    let [first, second] = walk.spine.halves(&arc)?;
                    return Ok(if reverse { vec![second, first] } else { vec![first, second] });
                }
                Node::Local if local => return cone(pieces, &tree.axis).map(|()| vec![]),
                Node::Local => Err("a leaf before this one is not local"),
                Node::Slab(g) => end_slab(e, pieces, g, &walk.r),
                Node::Share(k) => share(e, one(&arc)?, *k, &walk.r),
                _ => Err(MISPLACED),
            }?;
            local = false;
            Ok(vec![])
        })
    }
}

fn one(arc: &Arc) -> Result<&Piece, Why> {
    match arc {
        Arc::Piece(piece) => Ok(piece),
        Arc::Block(..) => Err("the arc is more than one piece"),
    }
}
