//! The checker: whether the evidence in a certificate proves a claim, in integers alone, on the walk of the trees and by
//! the conditions of docs/certificate-format.md. It trusts no search, and nothing that a certificate says.
#![deny(clippy::float_arithmetic, clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable)]
#![deny(clippy::indexing_slicing, clippy::unimplemented, clippy::todo)]

mod arc;
mod curvature;
mod field;
mod kappa;
mod pairs;
mod poly;
mod polyline;
mod radius;
mod range;
mod rules;
mod squares;
#[cfg(test)]
mod tests;
mod upper;
mod walk;

use std::collections::BTreeMap;

use crate::certificate::{Certificate, Evidence};
use crate::claim::{Claim, Statement};
pub use crate::error::Rejection;
use arc::Spine;

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

/// Checks that `certificate` proves `claim`. All is exact; the time depends on the certificate, which bounds it.
///
/// # Errors
/// The first condition that is not true.
pub fn verify(claim: &Claim, certificate: &Certificate) -> Result<Verified, Rejection> {
    wanted(claim.curve.digest() == certificate.digest, "curve", "the certificate is for another curve")?;
    let spine = Spine::of(&claim.curve);
    match (&claim.statement, &certificate.evidence) {
        (Statement::Radius { lo, hi }, Evidence::Radius(tube)) => radius::verify(&spine, [lo, hi], tube)?,
        (Statement::Pairs(pairs), Evidence::Pairs(found)) => pairs::verify(&spine, &claim.curve, pairs, found)?,
        (Statement::Curvature(points), Evidence::Curvature(course)) => {
            curvature::verify(&claim.curve, &spine, points, course)?;
        }
        (Statement::Polyline(claimed), Evidence::Polyline(found)) => polyline::verify(&spine, claimed, found)?,
        (Statement::Squares(claimed), Evidence::Squares(found)) => {
            squares::verify(&claim.curve, &spine, claimed, &found.segments)?;
        }
        _ => return Err(Rejection::of("claim", "the certificate is for another kind of claim")),
    }
    Ok(Verified { claim: claim.clone(), closed: spine.closed, leaves: certificate.leaves() })
}

fn wanted(fine: bool, section: &'static str, why: &'static str) -> Result<(), Rejection> {
    if fine { Ok(()) } else { Err(Rejection::of(section, why)) }
}
