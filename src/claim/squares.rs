//! What is claimed of |C'|^2 as a sum of two squares.

use crate::number::Rational;

/// Of f = |C'|^2 on one Bezier segment with its own parameter 0 .. 1 and the weight 1 at its start: an integral segment has the
/// speed squared, a rational one |r' w - r w'|^2.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Squares {
    /// Where the segment starts, in the curve's knots.
    pub from: Rational,
    /// Where it ends.
    pub to: Rational,
    /// All complex roots of f, each once.
    pub roots: Vec<RootBox>,
    /// How many decompositions f = alpha^2 + beta^2 there are, up to rotation and the sign of beta.
    pub count: u128,
    /// Some of them, no two the same up to rotation and sign.
    pub decompositions: Vec<TwoSquares>,
}

/// A root with re and im between these.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RootBox {
    /// From and to.
    pub re: [Rational; 2],
    /// From and to.
    pub im: [Rational; 2],
    /// How often it counts.
    pub multiplicity: usize,
}

/// Real polynomials with alpha^2 + beta^2 = f, bounds of their coefficients by rising powers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TwoSquares {
    /// From and to.
    pub alpha: Vec<[Rational; 2]>,
    /// From and to.
    pub beta: Vec<[Rational; 2]>,
}
