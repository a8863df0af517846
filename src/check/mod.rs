//! The checker: whether the evidence in a certificate proves a claim, in integers alone, on the walk of the trees and by
//! the conditions of docs/certificate-format.md. It trusts no search, and nothing that a certificate says.
#![deny(clippy::float_arithmetic, clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable)]
#![deny(clippy::indexing_slicing, clippy::unimplemented, clippy::todo)]

mod arc;
mod poly;
mod rules;
#[cfg(test)]
mod tests;
mod upper;
mod walk;

use std::collections::BTreeMap;
use std::fmt;

use num_bigint::Sign;
use num_traits::Zero;

use crate::certificate::Certificate;
use crate::claim::Claim;
use crate::number::{Rational, compare};
use arc::Spine;
use poly::Poly;
use rules::{Squared, Why};
use walk::Walk;

/// A claim that is proved. Only [`verify`] makes one.
#[derive(Debug, Clone)]
pub struct Verified {
    claim: Claim,
    closed: bool,
    leaves: BTreeMap<&'static str, usize>,
}

impl Verified {
    /// The claim.
    #[must_use]
    pub const fn claim(&self) -> &Claim {
        &self.claim
    }

    /// Whether the spine is closed.
    #[must_use]
    pub const fn closed(&self) -> bool {
        self.closed
    }

    /// How many leaves of the trees each rule closed.
    #[must_use]
    pub const fn leaves(&self) -> &BTreeMap<&'static str, usize> {
        &self.leaves
    }
}

/// Why a claim is not proved by a certificate. It says nothing about whether the claim is true.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Rejection {
    /// The section of the certificate: "curve", "lo", "hi", "along", "pairs", "start", "finish", "upper".
    pub section: &'static str,
    /// The number of the node in the section, from 1.
    pub node: Option<usize>,
    /// The line of the node.
    pub rule: String,
    /// What is wrong.
    pub why: String,
}

impl fmt::Display for Rejection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.section)?;
        if let Some(node) = self.node {
            write!(f, ", node {node} ({})", self.rule)?;
        }
        write!(f, ": {}", self.why)
    }
}

impl std::error::Error for Rejection {}

impl Rejection {
    fn of(section: &'static str, why: Why) -> Self {
        Self { section, node: None, rule: String::new(), why: why.to_string() }
    }
}

/// Whether `a` <= `b`; `None` is +infinity. A caller's number may have any denominator, and `compare` wants positive ones.
fn at_most(a: Option<&Rational>, b: Option<&Rational>) -> bool {
    match (a, b) {
        (_, None) => true,
        (None, Some(_)) => false,
        (Some(a), Some(b)) => a.denom().sign() == Sign::Plus && b.denom().sign() == Sign::Plus && compare(a, b).is_le(),
    }
}

/// Checks that `certificate` proves `claim`. All is exact; the time depends on the certificate, which bounds it.
///
/// # Errors
/// The first condition that is not true.
pub fn verify(claim: &Claim, certificate: &Certificate) -> Result<Verified, Rejection> {
    let Certificate { digest, lo, hi, along, pairs, ends, upper } = certificate;
    let wanted = |fine: bool, section, why| if fine { Ok(()) } else { Err(Rejection::of(section, why)) };
    wanted(claim.curve.digest() == *digest, "curve", "the certificate is for another curve")?;
    for (section, bound) in [("lo", lo), ("hi", hi)] {
        let negative = bound.as_ref().is_some_and(|bound| bound.numer().sign() == Sign::Minus);
        wanted(!negative, section, "the bound is negative")?;
    }
    wanted(at_most(claim.lo.as_ref(), lo.as_ref()), "lo", "the claim is more than what the certificate proves")?;
    wanted(at_most(hi.as_ref(), claim.hi.as_ref()), "hi", "the claim is less than what the certificate proves")?;

    let spine = Spine::of(&claim.curve).map_err(|why| Rejection::of("curve", why))?;
    let positive = lo.as_ref().is_none_or(|lo| !lo.is_zero());
    if positive {
        let smooth = (1..spine.spans.len()).all(|joint| spine.is_smooth(joint));
        wanted(smooth, "lo", "a joint is not smooth")?;
        wanted(spine.closed || !spine.ends_meet(), "lo", "the ends of an open spine are one point")?;
    }
    if lo.is_none() {
        let straight = spine.spans.iter().all(|span| span.b().iter().all(Poly::is_zero));
        wanted(straight && !spine.closed, "lo", "the spine is not straight")?;
        wanted(hi.is_none(), "hi", "lo is inf and hi is not")?;
    }
    let bounded = positive && lo.is_some();
    wanted(pairs.is_some() == bounded, "pairs", "there must be pairs iff lo is > 0 and not inf")?;
    let open = bounded && !spine.closed;
    wanted(ends.is_some() == open, "start", "there must be ends iff lo is > 0 and not inf and the spine is open")?;

    let r = Squared::of(lo.as_ref().unwrap_or(&Rational::zero()));
    let mut walk = Walk { spine: &spine, r, leaves: BTreeMap::new() };
    walk.along(along)?;
    if let Some(pairs) = pairs {
        walk.pairs(pairs)?;
    }
    if let (Some([start, finish]), Some(first), Some(last)) = (ends, spine.spans.first(), spine.spans.last()) {
        walk.end("start", start, &first.first(), false)?;
        walk.end("finish", finish, &last.last(), true)?;
    }
    upper::upper(&spine, upper, hi.as_ref()).map_err(|why| Rejection::of("upper", why))?;
    Ok(Verified { claim: claim.clone(), closed: spine.closed, leaves: walk.leaves })
}
