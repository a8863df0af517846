//! Proofs about tubes around rational space curves.
//!
//! On a spine of many spans the threads of the current rayon pool share the work; answers do not depend on their number.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

#[cfg(feature = "search")]
mod bernstein;
pub mod certificate;
pub mod check;
pub mod claim;
mod construct;
#[cfg(feature = "search")]
mod curvature;
pub mod curve;
#[cfg(feature = "search")]
pub mod enclosure;
pub mod error;
#[cfg(feature = "search")]
mod integer;
#[cfg(feature = "search")]
mod judge;
pub mod number;
#[cfg(feature = "search")]
mod options;
#[cfg(feature = "search")]
mod pairs;
#[cfg(feature = "search")]
mod parallel;
#[cfg(feature = "search")]
mod polyline;
mod print;
#[cfg(feature = "search")]
mod radius;
#[cfg(feature = "search")]
pub mod roots;
#[cfg(feature = "search")]
mod search;
#[cfg(feature = "search")]
mod spine;
#[cfg(feature = "search")]
mod squares;

pub use certificate::Certificate;
pub use check::{Rejection, Verified, verify};
pub use claim::{Claim, CriticalKind, Statement};
#[cfg(feature = "search")]
pub use curvature::{ConstantStretch, CriticalPoint, Curvature, CurvatureOptions, curvature};
pub use curve::Curve;
pub use error::{Error, ErrorKind};
#[cfg(feature = "search")]
pub use judge::{Check, CheckOptions, PolylineWitness, Verdict, check};
pub use number::Rational;
#[cfg(feature = "search")]
pub use options::Enclosure;
#[cfg(feature = "search")]
pub use pairs::{Pairs, PairsOptions, StationaryPair, pairs};
#[cfg(feature = "search")]
pub use polyline::{Polyline, PolylineOptions, polyline};
#[cfg(feature = "search")]
pub use radius::{LimitedBy, Location, Radius, RadiusOptions, Rim, SpineEnd, Terms, radius};
#[cfg(feature = "search")]
pub use search::meter::Stop;
#[cfg(feature = "search")]
pub use spine::Spine;
#[cfg(feature = "search")]
pub use squares::{Axis, Decomposition, SegmentSquares, SquareRoot, Squares, SquaresOptions, squares};
