//! What is claimed of a polyline beside a spine.

use crate::number::Rational;

/// The polyline is isotopic to the spine in its tube, and near: docs/certificate-format.md, section 10.
///
/// Claimed is: the Frechet distance of polyline and spine is at most `distance`, which is less than delta; and each point of the
/// polyline lies in the normal disk of radius `distance` of exactly one parameter, which increases along the polyline, once
/// round a closed spine; an open spine counts as prolonged by straight stubs, if its polyline reaches beyond its ends by less than
/// `distance`. The parts of an open spine before the first and beyond the last of these disks are within `distance` of
/// the first and the last vertex.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Polyline {
    /// In order; of a closed polyline the first does not stand again at the end.
    pub vertices: Vec<[Rational; 3]>,
    /// Whether the last vertex is joined to the first.
    pub closed: bool,
    /// The bound.
    pub distance: Rational,
}
