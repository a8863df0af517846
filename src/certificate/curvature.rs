//! Evidence for the critical points of curvature: docs/certificate-format.md, section 8.

use super::text::{Lines, list};
use crate::claim::{Bounds, Critical, CriticalKind, CriticalPoints, Stretch};
use crate::error::Error;
use crate::number::{Rational, to_fraction_text};
use num_bigint::BigInt;
use std::collections::BTreeMap;

/// Where the spans are cut so that changes of sign of Bernstein coefficients tell of the zeros of N.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Course {
    /// What it was written for.
    pub(crate) claim: CriticalPoints,
    /// For each span, between 0 and 1.
    pub(crate) cuts: Vec<Vec<Rational>>,
    /// Factors of b, as the coefficients c[i] of t^i (1-t)^(n-i), by spans.
    pub(crate) factors: Vec<(usize, Vec<BigInt>)>,
    /// A span and a parameter of it where kappa is at least the lower bound of kappa_max.
    pub(crate) witness: (usize, Rational),
}

/// The word for no kind.
const NONE: &str = "none";

fn bounds(bounds: &Bounds) -> String {
    let bound = |b: &Option<Rational>| b.as_ref().map_or("inf".to_string(), to_fraction_text);
    bounds.iter().map(bound).collect::<Vec<_>>().join(" ")
}

impl Course {
    pub(super) fn encode(&self) -> String {
        let CriticalPoints { kappa_max, at, points, constant } = &self.claim;
        let mut lines = vec![format!("kappa_max {}", bounds(kappa_max)), format!("at {}", bounds(at))];
        for Critical { t, kappa, kind, unique } in points {
            let kind = kind.map_or(NONE, CriticalKind::word);
            let unique = if *unique { "unique" } else { "open" };
            lines.push(format!("point {} {} {kind} {unique}", bounds(t), bounds(kappa)));
        }
        for Stretch { from, to, kappa } in constant {
            lines.push(format!("constant {} {}", bounds(&[from.clone(), to.clone()]), bounds(kappa)));
        }
        for cuts in &self.cuts {
            lines.push(format!("span {}", list(cuts)).trim_end().to_string());
        }
        for (span, g) in &self.factors {
            let g: Vec<String> = g.iter().map(BigInt::to_string).collect();
            lines.push(format!("factor {span} {}", g.join(" ")));
        }
        lines.push(format!("witness {} {}\n", self.witness.0, to_fraction_text(&self.witness.1)));
        lines.join("\n")
    }

    /// How many cells, and how many factors.
    pub(super) fn leaves(&self) -> BTreeMap<&'static str, usize> {
        let cells = self.cuts.iter().map(|cuts| cuts.len() + 1).sum();
        let factors = Some(("factor", self.factors.len())).filter(|(_, count)| *count > 0);
        [("cell", cells)].into_iter().chain(factors).collect()
    }

    pub(super) fn read(lines: &mut Lines) -> Result<Self, Error> {
        let [lo, hi] = lines.fields("kappa_max")?;
        let kappa_max = lines.bounds([lo, hi])?;
        let [lo, hi] = lines.fields("at")?;
        let at = lines.bounds([lo, hi])?;
        let (mut points, mut constant, mut cuts, mut factors) = (vec![], vec![], vec![], vec![]);
        while lines.next_is("point ") {
            let [a, b, c, d, kind, unique] = lines.fields("point")?;
            let known = CriticalKind::ALL.into_iter().find(|known| known.word() == kind);
            if known.is_none() && kind != NONE || !["unique", "open"].contains(&unique) {
                return Err(lines.error("no such kind"));
            }
            let (t, kappa) = (lines.bounds([a, b])?, lines.bounds([c, d])?);
            points.push(Critical { t, kappa, kind: known, unique: unique == "unique" });
        }
        while lines.next_is("constant ") {
            let [a, b, c, d] = lines.fields("constant")?;
            let [from, to] = lines.bounds([a, b])?;
            constant.push(Stretch { from, to, kappa: lines.bounds([c, d])? });
        }
        while lines.next_is("span") {
            let fields = lines.after("span")?;
            cuts.push(fields.into_iter().map(|field| lines.rational(field)).collect::<Result<_, _>>()?);
        }
        while lines.next_is("factor ") {
            let fields = lines.after("factor")?;
            let Some((span, g)) = fields.split_first() else { return Err(lines.error("no factor")) };
            let whole = |field: &&str| Ok(lines.rational(field)?.to_integer());
            factors.push((lines.index(span)?, g.iter().map(whole).collect::<Result<_, Error>>()?));
        }
        let [span, t] = lines.fields("witness")?;
        let witness = (lines.index(span)?, lines.rational(t)?);
        Ok(Self { claim: CriticalPoints { kappa_max, at, points, constant }, cuts, factors, witness })
    }
}
