//! What is claimed about curvature: docs/certificate-format.md, section 8.

use super::Bounds;
use crate::number::Rational;

/// The greatest curvature and the critical points of curvature, as the command `curvature` prints them.
///
/// Claimed is: `kappa_max` holds the greatest curvature, and `at` a parameter where the curvature is at least its lower
/// bound; every zero of the critical polynomial N, and every joint where the curvature jumps or turns, lies in the `t`
/// of a point whose `kappa` holds the curvature there; the segments where the curvature is constant are `constant`, in
/// order; and of each point what [`Critical`] says. Nothing is claimed of how narrow all this is (`complete`).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CriticalPoints {
    /// The greatest curvature.
    pub kappa_max: Bounds,
    /// A parameter where it is.
    pub at: Bounds,
    /// In increasing order.
    pub points: Vec<Critical>,
    /// Where the curvature is constant.
    pub constant: Vec<Stretch>,
}

/// A critical point. If it is `unique` there is exactly one in `t`, no multiple zero of N, and it is of this kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Critical {
    /// The parameter.
    pub t: Bounds,
    /// The curvature, at a joint the greater of both sides.
    pub kappa: Bounds,
    /// `None` if nothing is said of it.
    pub kind: Option<CriticalKind>,
    /// Whether it is the only one in `t`.
    pub unique: bool,
}

/// How the curvature behaves at a critical point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum CriticalKind {
    /// kappa is continuous, does not fall before and does not rise after.
    Maximum,
    /// kappa is continuous, does not rise before and does not fall after, and is not 0.
    Minimum,
    /// kappa = 0: b = 0 at a zero of the critical polynomial.
    Inflection,
    /// A joint of two segments.
    Joint,
}

impl CriticalKind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Maximum, Self::Minimum, Self::Inflection, Self::Joint];

    /// The word used in JSON and in certificates.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Maximum => "maximum",
            Self::Minimum => "minimum",
            Self::Inflection => "inflection",
            Self::Joint => "joint",
        }
    }
}

/// Part of a segment on which the curvature is constant; it is constant on all of that segment.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stretch {
    /// Not before the start of the segment.
    pub from: Option<Rational>,
    /// Not after its end.
    pub to: Option<Rational>,
    /// The curvature.
    pub kappa: Bounds,
}
