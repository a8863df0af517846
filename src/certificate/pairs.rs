//! The evidence for stationary pairs, and its spelling.

use std::fmt::Write;

use super::Node;
use super::text::{Lines, push_tree};
use crate::claim::{PairBox, Pairs};
use crate::error::Error;
use crate::number::{Rational, to_fraction_text};

/// Boxes in which a pair is alone, and the tree that closes the rest.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Evidence {
    pub(crate) along: Vec<Node>,
    pub(crate) isolated: Vec<Isolated>,
    pub(crate) tree: Vec<Node>,
    /// The strongest claim that is proved.
    pub(crate) claim: Pairs,
}

/// A zero of F in `inner`, the only one in `outer`, in positions; at one point if `inner` is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Isolated {
    pub(crate) outer: [[Rational; 2]; 2],
    pub(crate) inner: [[Rational; 2]; 2],
}

fn list<'a>(numbers: impl IntoIterator<Item = &'a Rational>) -> String {
    numbers.into_iter().map(to_fraction_text).collect::<Vec<_>>().join(" ")
}

impl PairBox {
    fn encode(&self) -> String {
        let (lo, hi) = &self.distance;
        let hi = hi.as_ref().map_or("inf".to_string(), to_fraction_text);
        format!("{} {} {hi}", list(self.s.iter().chain(&self.t)), to_fraction_text(lo))
    }

    fn decode(lines: &mut Lines, word: &str) -> Result<Self, Error> {
        let [a, b, c, d, lo, hi] = lines.fields(word)?;
        let [a, b, c, d, lo] = lines.rationals([a, b, c, d, lo])?;
        let hi = if hi == "inf" { None } else { Some(lines.rational(hi)?) };
        Ok(Self { s: [a, b], t: [c, d], distance: (lo, hi) })
    }
}

impl Evidence {
    pub(super) fn encode(&self) -> String {
        let mut out = String::new();
        push_tree(&mut out, "along", &self.along);
        // writing to a String cannot fail
        for claimed in &self.claim.pairs {
            let _ = writeln!(out, "claim {}", claimed.encode());
        }
        for claimed in &self.claim.undecided {
            let _ = writeln!(out, "undecided {}", claimed.encode());
        }
        for Isolated { outer, inner } in &self.isolated {
            let _ = writeln!(out, "alone {}\nlies {}", list(outer.as_flattened()), list(inner.as_flattened()));
        }
        push_tree(&mut out, "tree", &self.tree);
        out
    }

    pub(super) fn decode(lines: &mut Lines) -> Result<Self, Error> {
        lines.after("along")?;
        let along = lines.nodes();
        let (mut pairs, mut undecided, mut isolated) = (vec![], vec![], vec![]);
        while lines.next_is("claim") {
            pairs.push(PairBox::decode(lines, "claim")?);
        }
        while lines.next_is("undecided") {
            undecided.push(PairBox::decode(lines, "undecided")?);
        }
        while lines.next_is("alone") {
            let mut ranges = |word| {
                let fields = lines.fields(word)?;
                let [a, b, c, d] = lines.rationals(fields)?;
                Ok::<_, Error>([[a, b], [c, d]])
            };
            isolated.push(Isolated { outer: ranges("alone")?, inner: ranges("lies")? });
        }
        lines.after("tree")?;
        let tree = lines.nodes();
        Ok(Self { along, isolated, tree, claim: Pairs { pairs, undecided } })
    }
}
