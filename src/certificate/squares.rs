//! The evidence for sums of two squares, and its spelling.

use std::collections::BTreeMap;
use std::fmt::Write;

use num_bigint::BigInt;

use super::text::Lines;
use crate::claim::{RootBox, Squares, TwoSquares};
use crate::error::Error;
use crate::number::{Rational, excerpt, to_fraction_text};

/// One for each span.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Evidence {
    pub(crate) segments: Vec<Segment>,
}

/// The roots of f, and which of them the decompositions take.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Segment {
    /// Disks are over 2^bits.
    pub(crate) bits: u32,
    pub(crate) factors: Vec<Factor>,
    pub(crate) disks: Vec<Disk>,
    /// Of every decomposition, for each pair in order: how often the upper root is taken.
    pub(crate) choices: Vec<Vec<usize>>,
    /// The strongest claim that is proved.
    pub(crate) claim: Squares,
}

/// An integer polynomial by rising powers, as often a factor of f.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Factor {
    pub(crate) multiplicity: usize,
    pub(crate) coefficients: Vec<BigInt>,
}

/// About a root of a factor: a real one, or the upper one of a pair.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Disk {
    pub(crate) factor: usize,
    pub(crate) re: BigInt,
    pub(crate) im: BigInt,
    pub(crate) radius: BigInt,
}

fn words<T: ToString>(all: &[T]) -> String {
    all.iter().map(|x| format!(" {}", x.to_string())).collect()
}

fn bounds(all: &[[Rational; 2]]) -> String {
    all.iter().flatten().map(|x| format!(" {}", to_fraction_text(x))).collect()
}

impl Evidence {
    pub(super) fn encode(&self) -> String {
        let mut out = String::new();
        // writing to a String cannot fail
        for Segment { bits, factors, disks, choices, claim } in &self.segments {
            let [from, to] = [&claim.from, &claim.to].map(to_fraction_text);
            let _ = writeln!(out, "segment {from} {to} {bits}");
            for Factor { multiplicity, coefficients } in factors {
                let _ = writeln!(out, "factor {multiplicity}{}", words(coefficients));
            }
            for Disk { factor, re, im, radius } in disks {
                let _ = writeln!(out, "disk {factor} {re} {im} {radius}");
            }
            for RootBox { re, im, multiplicity } in &claim.roots {
                let _ = writeln!(out, "root {multiplicity}{}", bounds(&[re.clone(), im.clone()]));
            }
            let _ = writeln!(out, "count {}", claim.count);
            for (choice, TwoSquares { alpha, beta }) in choices.iter().zip(&claim.decompositions) {
                let _ = writeln!(out, "choice{}\nalpha{}\nbeta{}", words(choice), bounds(alpha), bounds(beta));
            }
        }
        out
    }

    /// How many disks and choices there are.
    pub(super) fn parts(&self) -> BTreeMap<&'static str, usize> {
        let disks = self.segments.iter().map(|segment| segment.disks.len()).sum();
        let choices = self.segments.iter().map(|segment| segment.choices.len()).sum();
        BTreeMap::from([("disk", disks), ("choice", choices)])
    }

    pub(super) fn decode(lines: &mut Lines) -> Result<Self, Error> {
        let mut segments = vec![];
        while lines.next_is("segment") {
            segments.push(Segment::decode(lines)?);
        }
        Ok(Self { segments })
    }
}

impl Segment {
    fn decode(lines: &mut Lines) -> Result<Self, Error> {
        let [from, to, bits] = lines.fields("segment")?;
        let ([from, to], bits) = (lines.rationals([from, to])?, small(lines, bits)?);
        let (mut factors, mut disks, mut roots) = (vec![], vec![], vec![]);
        while lines.next_is("factor") {
            let fields = lines.after("factor")?;
            let (first, rest) = fields.split_first().ok_or_else(|| lines.error("a factor has a multiplicity"))?;
            let coefficients = rest.iter().map(|text| lines.integer(text)).collect::<Result<_, _>>()?;
            factors.push(Factor { multiplicity: small(lines, first)?, coefficients });
        }
        while lines.next_is("disk") {
            let [factor, re, im, radius] = lines.fields("disk")?;
            let [re, im, radius] = [lines.integer(re)?, lines.integer(im)?, lines.integer(radius)?];
            disks.push(Disk { factor: small(lines, factor)?, re, im, radius });
        }
        while lines.next_is("root") {
            let [multiplicity, a, b, c, d] = lines.fields("root")?;
            let [a, b, c, d] = lines.rationals([a, b, c, d])?;
            roots.push(RootBox { re: [a, b], im: [c, d], multiplicity: small(lines, multiplicity)? });
        }
        let [count] = lines.fields("count")?;
        let count = small(lines, count)?;
        let (mut choices, mut decompositions) = (vec![], vec![]);
        while lines.next_is("choice") {
            let fields = lines.after("choice")?;
            choices.push(fields.iter().map(|text| small(lines, text)).collect::<Result<_, _>>()?);
            let mut polynomial = |word| {
                let fields = lines.after(word)?;
                let numbers = fields.iter().map(|text| lines.rational(text)).collect::<Result<Vec<_>, _>>()?;
                let (pairs, rest) = numbers.as_chunks::<2>();
                let fine = rest.is_empty();
                fine.then(|| pairs.to_vec()).ok_or_else(|| lines.error("wanted two bounds of each coefficient"))
            };
            decompositions.push(TwoSquares { alpha: polynomial("alpha")?, beta: polynomial("beta")? });
        }
        Ok(Self { bits, factors, disks, choices, claim: Squares { from, to, roots, count, decompositions } })
    }
}

fn small<T: std::str::FromStr>(lines: &Lines, text: &str) -> Result<T, Error> {
    text.parse().map_err(|_| lines.error(format_args!("{} is no number of this kind", excerpt(text))))
}
