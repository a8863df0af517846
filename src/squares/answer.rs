//! What [`squares`](fn@super::squares) is asked and what it answers.

use crate::certificate::Certificate;
use crate::number::Rational;
use crate::options::{Enclosure, options};
use crate::search::meter::Stop;
use crate::search::twist::Axis;

/// A root of f = |C'|^2, in the parameter 0 .. 1 of its segment.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SquareRoot {
    /// The real part.
    pub re: Enclosure,
    /// The imaginary part: exactly 0 for a real root.
    pub im: Enclosure,
    /// How often it counts, exactly.
    pub multiplicity: usize,
}

/// f = alpha^2 + beta^2: real polynomials by the coefficients of rising powers of the parameter 0 .. 1 of the segment.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Decomposition {
    /// deg f / 2 + 1 coefficients, the last > 0.
    pub alpha: Vec<Enclosure>,
    /// deg f / 2 coefficients, one at least; exactly 0, all of them, where alpha^2 = f. The sign of beta is free.
    pub beta: Vec<Enclosure>,
    /// The twist of the u-lines of alpha + i beta and of alpha - i beta about the spine (see [`squares`](fn@super::squares)); `hi`
    /// infinite where it is not known.
    pub twist: [Enclosure; 2],
}

/// The answer for one Bezier segment.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SegmentSquares {
    /// Where the segment starts, in the curve's knots.
    pub from: Rational,
    /// Where it ends.
    pub to: Rational,
    /// All complex roots of f: the real ones in increasing order, then pairs, by increasing real part, the root with the
    /// positive imaginary part before its conjugate. Left out, and the answer not complete: what is too far out for f64.
    pub roots: Vec<SquareRoot>,
    /// How many decompositions there are in all, up to rotation and the sign of beta:
    /// (prod (k + 1) + [all k even]) / 2 over the multiplicities k of the pairs of roots.
    pub count: u128,
    /// All of them, or as many as the limit allows.
    pub decompositions: Vec<Decomposition>,
    /// The axes of the twists in place of z: one, or several for parts of the segment in order; none if no twist is known.
    pub axes: Vec<Axis>,
}

/// The answer of [`squares`](fn@super::squares).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Squares {
    /// One for each Bezier segment, in order; fewer if the search was stopped.
    pub segments: Vec<SegmentSquares>,
    /// Is all enclosed as narrowly as asked, is every twist known, and is no segment missing? A limit of the list of
    /// decompositions does not matter here.
    pub complete: bool,
    /// The evidence, if it was asked for and can be written (docs/certificate-format.md). It proves roots and decompositions;
    /// twists are not part of it.
    pub certificate: Option<Certificate>,
    /// Cells of the integrals, segments and decompositions that were looked at.
    pub cells: u64,
    /// Why the search stopped early, if it did.
    pub stopped: Option<Stop>,
}

options! {
    /// Options of [`squares`](fn@super::squares).
    SquaresOptions {
        /// Sets how many decompositions of a segment are listed at most. Default 64.
        limit: usize = 64,
    }
}
