//! What is claimed: apart from the evidence, and about a curve that is given with it.
#![deny(clippy::float_arithmetic, clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]

mod curvature;
mod pairs;
mod polyline;
mod squares;

use crate::curve::Curve;
use crate::number::Rational;
pub use curvature::{Critical, CriticalKind, CriticalPoints, Stretch};
pub use pairs::{PairBox, Pairs};
pub use polyline::Polyline;
pub use squares::{RootBox, Squares, TwoSquares};

/// What a JSON enclosure says: at least the first, at most the second; null is `None`, +infinity.
pub type Bounds = [Option<Rational>; 2];

/// A statement about a curve.
#[derive(Debug, Clone)]
pub struct Claim {
    /// The curve.
    pub curve: Curve,
    /// What is said of it.
    pub statement: Statement,
}

/// What can be claimed. `None` is +infinity.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Statement {
    /// "delta lies in [lo, hi]".
    Radius {
        /// The lower bound.
        lo: Option<Rational>,
        /// The upper bound.
        hi: Option<Rational>,
    },
    /// Which pairs of points are stationary.
    Pairs(Pairs),
    /// "These are the greatest curvature and the critical points of curvature".
    Curvature(CriticalPoints),
    /// |C'|^2 as a sum of two squares, on one Bezier segment after the other.
    Squares(Vec<Squares>),
    /// A polyline is near the spine and isotopic to it.
    Polyline(Polyline),
}
