//! The evidence for a polyline, and its spelling.

use std::collections::BTreeMap;

use super::Tube;
use super::text::{Lines, list};
use crate::claim::Polyline;
use crate::error::Error;
use crate::number::{Rational, to_fraction_text};

/// A lower bound of delta, and for each edge the arc that it runs along.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Evidence {
    /// The strongest claim that is proved.
    pub(crate) claim: Polyline,
    /// Of an open spine: positions beyond the disks of the first and the last vertex.
    pub(crate) ends: Option<[Rational; 2]>,
    /// Of an open spine that is prolonged by straight stubs: their lengths in those of the control legs at its ends.
    pub(crate) stubs: Option<[Rational; 2]>,
    /// For each edge increasing positions, the whole ones in between among them.
    pub(crate) edges: Vec<Vec<Rational>>,
    pub(crate) tube: Tube,
}

impl Evidence {
    pub(super) fn encode(&self) -> String {
        let mut out = format!("distance {}\n", to_fraction_text(&self.claim.distance));
        let mut line = |word: &str, numbers: &[Rational]| out += &format!("{word} {}\n", list(numbers));
        self.claim.vertices.iter().for_each(|vertex| line("vertex", vertex));
        self.edges.iter().for_each(|edge| line("edge", edge));
        self.ends.iter().for_each(|ends| line("ends", ends));
        self.stubs.iter().for_each(|stubs| line("stubs", stubs));
        out + &self.tube.encode()
    }

    pub(super) fn parts(&self) -> BTreeMap<&'static str, usize> {
        let mut parts = self.tube.leaves();
        parts.insert("edge", self.edges.len());
        parts
    }

    pub(super) fn decode(lines: &mut Lines) -> Result<Self, Error> {
        let [distance] = lines.fields("distance")?;
        let distance = lines.rational(distance)?;
        let (mut vertices, mut edges) = (vec![], vec![]);
        while lines.next_is("vertex") {
            let fields = lines.fields("vertex")?;
            vertices.push(lines.rationals(fields)?);
        }
        while lines.next_is("edge") {
            let fields = lines.after("edge")?;
            edges.push(fields.iter().map(|text| lines.rational(text)).collect::<Result<_, _>>()?);
        }
        let mut both = |word| {
            let fields = if lines.next_is(word) { Some(lines.fields(word)?) } else { None };
            fields.map(|fields| lines.rationals(fields)).transpose()
        };
        let (ends, stubs) = (both("ends")?, both("stubs")?);
        let closed = ends.is_none();
        Ok(Self { claim: Polyline { vertices, closed, distance }, ends, stubs, edges, tube: lines.tube()? })
    }
}
