//! What is asked of `curvature`, and what it answers.

use crate::certificate::Certificate;
use crate::claim::CriticalKind;
use crate::options::{Enclosure, options};
use crate::search::meter::Stop;

/// A critical point of curvature: a zero of the critical polynomial N of a segment, or a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CriticalPoint {
    /// The parameter, in the curve's own knots.
    pub t: Enclosure,
    /// The curvature there; at a joint where it jumps the greater of the two. {0, 0} at an inflection.
    pub kappa: Enclosure,
    /// `None` where N has a zero without change of sign (kappa has no extremum there), or where it is not decided.
    pub kind: Option<CriticalKind>,
    /// Is there exactly one critical point in `t`, and is it no multiple zero of N?
    pub unique: bool,
}

/// A segment on which the curvature is constant: part of a circle or of a straight line.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ConstantStretch {
    /// The knot where the segment starts, or the next f64 above it.
    pub from: f64,
    /// The knot where it ends, or the next f64 below it.
    pub to: f64,
    /// The curvature on it.
    pub kappa: Enclosure,
}

/// The answer of [`curvature`](fn@crate::curvature).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Curvature {
    /// The greatest curvature; at joints the curvatures of both sides count.
    pub kappa_max: Enclosure,
    /// Holds a parameter at which the curvature is at least `kappa_max.lo`: of several that tie, one of the first.
    pub at: Enclosure,
    /// In increasing order. Every zero of N lies in the `t` of one of them.
    ///
    /// A joint (on a closed spine the seam too) stands here if kappa jumps there, if N is 0 on either side, or if kappa
    /// turns from rising to falling or back. It is of the kind [`Joint`](CriticalKind::Joint) unless kappa is continuous
    /// and N is 0 on both sides; then it is what any other zero of N is.
    pub critical_points: Vec<CriticalPoint>,
    /// The segments on which N is zero, in increasing order; neighbours are not merged.
    pub constant: Vec<ConstantStretch>,
    /// Is every critical point told from its neighbours, or known to be one multiple zero, and everything enclosed as
    /// narrowly as asked?
    pub complete: bool,
    /// The evidence, if it was asked for and is not too long.
    pub certificate: Option<Certificate>,
    /// Cells that the search looked at.
    pub cells: u64,
    /// Why the search stopped early, if it did.
    pub stopped: Option<Stop>,
}

options! {
    /// Options of [`curvature`](fn@crate::curvature).
    CurvatureOptions {}
}
