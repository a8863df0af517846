//! What is claimed of the stationary pairs of a spine.

use crate::number::Rational;

/// Stationary pairs of |C(s) - C(t)|^2, parameters in the curve's knots.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pairs {
    /// Each holds exactly one stationary pair, no two the same.
    pub pairs: Vec<PairBox>,
    /// Every other stationary pair lies in one of these.
    pub undecided: Vec<PairBox>,
}

/// All (s, t) with s and t between these, and bounds of |C(s) - C(t)| for what it says of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PairBox {
    /// From and to.
    pub s: [Rational; 2],
    /// From and to.
    pub t: [Rational; 2],
    /// From and to; `None` is +infinity.
    pub distance: (Rational, Option<Rational>),
}
