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

use num_bigint::Sign;
use num_traits::Zero;

use crate::certificate::Certificate;
use crate::claim::Claim;
pub use crate::error::Rejection;
use crate::number::{Rational, compare};
use arc::Spine;
use poly::Poly;

/// A claim that is proved. Only [`verify`] makes one.
#[derive(Debug, Clone)]
pub struct Verified {
    claim: Claim,
    closed: bool,
    leaves: BTreeMap<&'static str, usize>,
}

impl Verified {
    /// The claim.
    pub const fn claim(&self) -> &Claim {
        &self.claim
    }

    /// Whether the spine is closed.
    pub const fn closed(&self) -> bool {
        self.closed
    }

    /// How many leaves of the trees each rule closed.
    pub const fn leaves(&self) -> &BTreeMap<&'static str, usize> {
        &self.leaves
    }
}

/// Whether `a` <= `b`; `None` is +infinity. A caller's number may have any denominator, and `compare` wants positive ones.
fn at_most(a: Option<&Rational>, b: Option<&Rational>) -> bool {
    let positive = [a, b].into_iter().flatten().all(|bound| bound.denom().sign() == Sign::Plus);
    positive && b.is_none_or(|b| a.is_some_and(|a| compare(a, b).is_le()))
}

/// Checks that `certificate` proves `claim`. All is exact; the time depends on the certificate, which bounds it.
///
/// # Errors
/// The first condition that is not true.
pub fn verify(claim: &Claim, certificate: &Certificate) -> Result<Verified, Rejection> {
    let Certificate { digest, lo, hi, along, pairs, ends, upper } = certificate;
    let wanted = |fine: bool, section, why| if fine { Ok(()) } else { Err(Rejection::of(section, why)) };
    wanted(claim.curve.digest() == *digest, "curve", "the certificate is for another curve")?;
    let (zero, lo, hi) = (Rational::zero(), lo.as_ref(), hi.as_ref());
    wanted(at_most(Some(&zero), lo), "lo", "the bound is negative")?;
    wanted(at_most(Some(&zero), hi), "hi", "the bound is negative")?;
    wanted(at_most(claim.lo.as_ref(), lo), "lo", "the claim is more than what the certificate proves")?;
    wanted(at_most(hi, claim.hi.as_ref()), "hi", "the claim is less than what the certificate proves")?;

    let spine = Spine::of(&claim.curve);
    let positive = lo.is_none_or(|lo| !lo.is_zero());
    let smooth = || (1..spine.spans.len()).all(|joint| spine.is_smooth(joint));
    wanted(!positive || smooth(), "lo", "a joint is not smooth")?;
    // the ends of an open spine then are two points: with b = 0 as C runs straight on; with pairs as no other rule than
    // `cone` closes a pair with D = 0, and C goes on along its axis. And with b = 0 no witness stands for hi < inf
    let straight = || spine.spans.iter().all(|span| span.wb().iter().all(Poly::is_zero));
    wanted(lo.is_some() || straight(), "lo", "the spine is not straight")?;
    let bounded = positive && lo.is_some();
    wanted(pairs.is_some() == bounded, "pairs", "there must be pairs iff lo is > 0 and not inf")?;
    let open = bounded && !spine.closed;
    wanted(ends.is_some() == open, "start", "there must be ends iff lo is > 0 and not inf and the spine is open")?;

    let r = lo.unwrap_or(&zero).pow(2);
    walk::along(&spine, &r, along)?;
    if let Some(pairs) = pairs {
        walk::pairs(&spine, &r, pairs)?;
    }
    if let Some([start, finish]) = ends {
        walk::end(&spine, &r, false, start)?;
        walk::end(&spine, &r, true, finish)?;
    }
    upper::upper(&spine, upper, hi).map_err(|why| Rejection::of("upper", why))?;
    Ok(Verified { claim: claim.clone(), closed: spine.closed, leaves: certificate.leaves() })
}
