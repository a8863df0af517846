//! Proofs about tubes around rational space curves.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod bernstein;
pub mod certificate;
pub mod check;
pub mod claim;
pub mod curve;
pub mod enclosure;
pub mod error;
mod integer;
pub mod json;
pub mod number;
mod radius;
mod roots;
mod search;
mod spine;

pub use curve::Curve;
pub use error::{Error, ErrorKind};
pub use number::Rational;
pub use radius::{Enclosure, LimitedBy, Location, Radius, RadiusOptions, Rim, SpineEnd, Terms, radius};
pub use search::meter::Stop;
pub use spine::Spine;
