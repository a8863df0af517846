//! What is asked of `radius`, and what it answers.

use crate::certificate::Certificate;
use crate::number::{Rational, f64_above, f64_below};
use crate::search::meter::{Progress, Stop};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// A closed interval that holds a real number: `lo <= value <= hi`, both ends proved.
///
/// `hi` infinite: no upper bound is known, or none exists. `lo` infinite: the quantity is infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Enclosure {
    /// Proved lower bound.
    pub lo: f64,
    /// Proved upper bound.
    pub hi: f64,
}

impl Enclosure {
    /// The enclosure of an infinite quantity, such as a term with no pair at all.
    pub const INFINITE: Self = Self { lo: f64::INFINITY, hi: f64::INFINITY };

    pub(super) const ZERO: Self = Self { lo: 0.0, hi: 0.0 };

    /// `hi - lo <= w hi`, or `lo = hi`.
    #[must_use]
    pub fn is_within(&self, w: f64) -> bool {
        self.lo == self.hi || (self.hi.is_finite() && self.hi - self.lo <= w * self.hi)
    }

    /// Do the two enclosures share a number?
    #[must_use]
    pub fn meets(&self, other: &Self) -> bool {
        self.lo <= other.hi && other.lo <= self.hi
    }

    /// What both say of one number.
    pub(super) fn and(&self, other: &Self) -> Self {
        Self { lo: self.lo.max(other.lo), hi: self.hi.min(other.hi) }
    }

    pub(super) fn of(x: &Rational) -> Self {
        Self { lo: f64_below(x), hi: f64_above(x) }
    }
}

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

/// Options of [`radius`](fn@crate::radius).
#[derive(Clone)]
#[non_exhaustive]
pub struct RadiusOptions {
    /// Asked width: `hi - lo <= rel_width * hi`. Default 1e-9.
    pub rel_width: f64,
    /// Enclose every term, and the rim terms.
    pub all_terms: bool,
    /// Write the evidence down.
    pub certificate: bool,
    /// Cells after which the searches stop, with what is proved by then. Default 20 million.
    pub max_cells: u64,
    /// Wall-clock limit; makes answers depend on the machine. Off by default.
    pub budget: Option<Duration>,
    /// Set to true from another thread to stop early, with what is proved by then.
    pub cancel: Option<Arc<AtomicBool>>,
    /// Called now and then with the number of cells done.
    pub progress: Option<Progress>,
}

impl std::fmt::Debug for RadiusOptions {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RadiusOptions")
            .field("rel_width", &self.rel_width)
            .field("all_terms", &self.all_terms)
            .field("certificate", &self.certificate)
            .field("max_cells", &self.max_cells)
            .field("budget", &self.budget)
            .finish_non_exhaustive()
    }
}

impl Default for RadiusOptions {
    fn default() -> Self {
        Self {
            rel_width: 1e-9,
            all_terms: false,
            certificate: false,
            max_cells: 20_000_000,
            budget: None,
            cancel: None,
            progress: None,
        }
    }
}

impl RadiusOptions {
    /// The defaults.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets the asked relative width.
    #[must_use]
    pub fn rel_width(mut self, w: f64) -> Self {
        self.rel_width = w;
        self
    }

    /// Asks for every term, and the rim terms.
    #[must_use]
    pub fn all_terms(mut self, yes: bool) -> Self {
        self.all_terms = yes;
        self
    }

    /// Asks for the certificate.
    #[must_use]
    pub fn certificate(mut self, yes: bool) -> Self {
        self.certificate = yes;
        self
    }

    /// Sets the number of cells after which the searches stop.
    #[must_use]
    pub fn max_cells(mut self, n: u64) -> Self {
        self.max_cells = n;
        self
    }

    /// Sets a wall-clock limit.
    #[must_use]
    pub fn budget(mut self, limit: Duration) -> Self {
        self.budget = Some(limit);
        self
    }

    /// Sets a flag that stops the searches early.
    #[must_use]
    pub fn cancel(mut self, flag: Arc<AtomicBool>) -> Self {
        self.cancel = Some(flag);
        self
    }

    /// Sets a callback that is told the number of cells done.
    #[must_use]
    pub fn progress(mut self, report: impl Fn(u64) + Send + Sync + 'static) -> Self {
        self.progress = Some(Arc::new(report));
        self
    }
}
