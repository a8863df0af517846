//! What is claimed: apart from the evidence, and about a curve that is given with it.
#![deny(clippy::float_arithmetic, clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]

use crate::certificate::Certificate;
use crate::curve::Curve;
use crate::number::Rational;

/// "delta of this curve lies in [lo, hi]"; `None` is +infinity.
#[derive(Debug, Clone)]
pub struct Claim {
    /// The curve.
    pub curve: Curve,
    /// The lower bound.
    pub lo: Option<Rational>,
    /// The upper bound.
    pub hi: Option<Rational>,
}

impl Certificate {
    /// The strongest claim about `curve` that this evidence would prove.
    #[must_use]
    pub fn claim(&self, curve: Curve) -> Claim {
        Claim { curve, lo: self.lo.clone(), hi: self.hi.clone() }
    }
}
