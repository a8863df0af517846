//! What is asked of `radius`, and what it answers.

use crate::certificate::Certificate;
use crate::options::{Enclosure, options};
use crate::search::meter::Stop;

/// What keeps delta from being larger.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LimitedBy {
    /// 1/kappa at a point.
    Curvature,
    /// Two points of the body, each nearest to their middle.
    BodyToBody,
    /// The disk at one end and a disk of the body.
    EndToBody,
    /// The disks at the two ends.
    EndToEnd,
    /// The tangent jumps at a joint, or at the closure: delta = 0.
    Corner,
    /// The spine touches itself: delta = 0.
    SelfContact,
    /// Nothing: the spine is straight and delta is infinite.
    None,
    /// The enclosure is too wide to tell.
    Undecided,
}

impl LimitedBy {
    /// The word used in JSON.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Curvature => "curvature",
            Self::BodyToBody => "body_to_body",
            Self::EndToBody => "end_to_body",
            Self::EndToEnd => "end_to_end",
            Self::Corner => "corner",
            Self::SelfContact => "self_contact",
            Self::None => "none",
            Self::Undecided => "undecided",
        }
    }
}

/// An end of an open spine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SpineEnd {
    /// The first point of the domain.
    Start,
    /// The last point of the domain.
    Finish,
}

/// Where the upper bound of delta was witnessed. Parameters in the curve's own knots, `x` in its unit.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Location {
    /// The second parameter; `None` for curvature and corners.
    pub s: Option<Enclosure>,
    /// The parameter.
    pub t: Enclosure,
    /// The point where the disks touch.
    pub x: Option<[Enclosure; 3]>,
    /// The end whose disk touches, for the two terms of the ends.
    pub end: Option<SpineEnd>,
}

/// The four terms of delta; see theory.md, section 2.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Terms {
    /// 1 / kappa_max.
    pub curvature: Enclosure,
    /// Half the least distance of a doubly critical pair that is not local.
    pub body_to_body: Enclosure,
    /// The least rho(e, t) over an end e and the body.
    pub end_to_body: Enclosure,
    /// rho of the two ends.
    pub end_to_end: Enclosure,
}

/// The terms of Theorem 3.1 of Maekawa et al. 1998, where the rims of disks meet (theory.md, section 5).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Rim {
    /// Least radius at which the end circle meets a circle of the body.
    pub end_to_body: Enclosure,
    /// Radius at which the two end circles meet.
    pub end_to_end: Enclosure,
    /// The least of these, of 1/kappa_max and of the body term.
    pub delta: Enclosure,
}

/// The answer of [`radius`](fn@crate::radius).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Radius {
    /// delta: the largest radius for which the solid tube does not self-intersect. Every r < `lo` is proved free of
    /// self-intersection, every r > `hi` is proved to have one.
    pub delta: Enclosure,
    /// The term that binds.
    pub limited_by: LimitedBy,
    /// Other terms whose enclosure meets that of delta.
    pub also: Vec<LimitedBy>,
    /// Is the spine closed with a common tangent?
    pub closed: bool,
    /// The exact witness of `delta.hi`.
    pub at: Option<Location>,
    /// The four terms. A term that cannot bind may have an infinite `hi` unless all terms were asked for.
    pub terms: Terms,
    /// The rim terms, if all terms were asked for; those of the ends are infinite on a closed spine.
    pub rim: Option<Rim>,
    /// Was everything enclosed as narrowly as asked?
    pub complete: bool,
    /// The evidence for `delta`, if it was asked for (and can be written: see docs/certificate-format.md). The bounds it
    /// proves are those of `delta` as printed.
    pub certificate: Option<Certificate>,
    /// Cells that the searches looked at.
    pub cells: u64,
    /// Why the searches stopped early, if they did.
    pub stopped: Option<Stop>,
}

options! {
    /// Options of [`radius`](fn@crate::radius).
    RadiusOptions {
        /// Asks for every term, and the rim terms. Default false.
        all_terms: bool = false,
    }
}
