//! Certificates as data. Nothing is proved here; see `check`. The spelling is in `text`, outside the trust line: whatever
//! is read, from whatever text, is only evidence.
#![deny(clippy::float_arithmetic, clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
#![allow(clippy::large_enum_variant, reason = "there is one in a certificate")]

pub(crate) mod curvature;
pub(crate) mod pairs;
pub(crate) mod polyline;
pub(crate) mod squares;
mod text;

use crate::number::Rational;
pub use text::{MAX_CERTIFICATE_BYTES, MAX_CERTIFICATE_DIGITS};

/// Evidence for a claim about one curve; the format is docs/certificate-format.md.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Certificate {
    /// The digest of the curve.
    pub(crate) digest: String,
    pub(crate) evidence: Evidence,
}

/// One kind for each kind of claim.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Evidence {
    Radius(Tube),
    Pairs(pairs::Evidence),
    Curvature(curvature::Course),
    Squares(squares::Evidence),
    Polyline(polyline::Evidence),
}

/// That delta lies in [lo, hi].
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Tube {
    /// `None` is +infinity, as in `hi`.
    pub(crate) lo: Option<Rational>,
    pub(crate) hi: Option<Rational>,
    pub(crate) along: Vec<Node>,
    pub(crate) pairs: Option<Vec<Node>>,
    /// Start and finish.
    pub(crate) ends: Option<[EndTree; 2]>,
    pub(crate) upper: Upper,
}

/// A node of a split tree, in preorder. The rules are those of docs/certificate-format.md.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Node {
    /// `/`: of an arc; of a pair of the same arc.
    Split,
    /// `1`, `2`: of one arc of a pair.
    SplitFirst,
    SplitSecond,
    Curved,
    Cone([i64; 3]),
    Slab([i64; 3]),
    Side([i64; 2]),
    Bent([i64; 6]),
    Local,
    Share(i64),
    /// Of pairs: within a box that stands in the certificate; of no rule.
    Pair(usize),
    Open,
}

/// The axis of the cone for `local`, and the tree.
pub(crate) type EndTree = ([i64; 3], Vec<Node>);

/// The witness of hi.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Upper {
    None,
    Curvature { span: usize, t: Rational },
    Corner(usize),
    Contact { x: [Rational; 3], feet: [Foot; 2] },
    Crossing { arcs: [[Rational; 2]; 2], normal: [Rational; 3], first: [Rational; 3], second: [Rational; 3] },
    Mirror { arcs: [[Rational; 2]; 2], normal: [Rational; 3] },
}

/// Where a point lies in a normal plane of the spine: exactly at a position, or somewhere between two.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Foot {
    Plane(Rational),
    Valley([Rational; 3]),
}
