//! Topologically reliable polylines (theory.md, section 7): options in, vertices and their proof out.

use crate::certificate::{Certificate, Evidence, polyline::Evidence as Proof};
use crate::claim;
use crate::error::{Error, ErrorKind};
use crate::number::{Rational, f64_above, f64_below, nearest_text, parse_rational, rational_from_f64, upper_text};
use crate::options::{self, Enclosure, options};
use crate::radius::{RadiusOptions, radius, tube};
use crate::search::dyadic::shifted;
use crate::search::frame::Frame;
use crate::search::meter::Stop;
use crate::search::polyline::{Course, Rail, asymptotic, course, of_control_polygons, rational};
use crate::spine::Spine;

/// The share of the proved radius of the tube that the polyline may use.
pub(crate) const SHARE: f64 = 0.96;

options! {
    /// Options of [`polyline`](fn@crate::polyline). The relative width is that of delta, where delta is less than the tolerance.
    PolylineOptions {}
}

/// A polyline near the spine and isotopic to it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Polyline {
    /// In order; a closed one does not repeat the first. Empty if none could be proved within the limits. What is proved holds for
    /// the decimals of [`nearest_text`](crate::number::nearest_text), and for these numbers where they are not exactly an end of the spine.
    pub vertices: Vec<[f64; 3]>,
    /// Of each vertex the parameter that it was put at, in the curve's knots, to a rounding or two.
    pub parameters: Vec<f64>,
    /// Is it closed, as the spine is?
    pub closed: bool,
    /// Of the Frechet distance to the spine; infinite if there is no polyline.
    pub distance: Enclosure,
    /// Delta, as far as it was needed: the polyline lies in the tube of a radius less than `lo`.
    pub tube_radius: Enclosure,
    /// How many edges there are.
    pub edges: usize,
    /// The integral of sqrt(kappa / (8 d)) along the spine, d the distance allowed: what inscribed polylines need, asymptotically for
    /// small d. By samples, not proved.
    pub edges_lower_bound: f64,
    /// Edges that a uniform subdivision needs until control polygons are this near to their chords. By samples, not proved.
    pub a_priori_edges: f64,
    /// The evidence, if it was asked for and can be written (docs/certificate-format.md, section 10).
    pub certificate: Option<Certificate>,
    /// Edges that were tried.
    pub cells: u64,
    /// Why the search stopped early, if it did.
    pub stopped: Option<Stop>,
}

impl Polyline {
    /// What is claimed by the numbers as they are printed; `None` if there is no polyline.
    #[must_use]
    pub fn claim(&self) -> Option<claim::Polyline> {
        let number = |x: &f64| parse_rational(&nearest_text(*x)).ok();
        let vertex = |[x, y, z]: &[f64; 3]| Some([number(x)?, number(y)?, number(z)?]);
        let distance = parse_rational(&upper_text(self.distance.hi)).ok()?;
        let vertices = self.vertices.iter().map(vertex).collect::<Option<Vec<_>>>()?;
        self.is_certified().then_some(claim::Polyline { vertices, closed: self.closed, distance })
    }

    /// Was a polyline found and proved?
    #[must_use]
    pub const fn is_certified(&self) -> bool {
        self.edges > 0
    }
}

/// Makes a polyline that is within `tolerance` of the spine and isotopic to it inside its tube, with few edges.
///
/// *Meaning.* The Frechet distance of spine and polyline is at most `tolerance` and less than delta, and the polyline meets each
/// normal disk of radius `distance.hi` just once, in the order of the spine (an open spine: those between the disks of the first and
/// last vertex, beyond which the spine is within `tolerance` of them). So sliding inside the disks carries one to the other: it
/// is the same knot (theory.md, section 7, Theorem P').
///
/// *Exactness.* Vertices are rounded to f64; the proof is about the rounded ones. Each edge is proved in intervals: its arc
/// nowhere turns back against it, is nowhere farther than allowed, and reaches beyond its normal disks at both vertices.
///
/// *Units.* Tolerance and distances are lengths in the curve's unit.
///
/// # Errors
/// As [`radius`](fn@crate::radius); [`ErrorKind::Option`] for a tolerance that is not a positive finite number;
/// [`ErrorKind::Impossible`] if delta is 0: the spine has a corner, or touches itself.
///
/// ```
/// use tubecert::{PolylineOptions, Spine, polyline};
/// let parabola = Spine::bezier(&[[-1.0, 1.0, 0.0], [0.0, -1.0, 0.0], [1.0, 1.0, 0.0]], None)?;
/// let line = polyline(&parabola, 1e-3, &PolylineOptions::new())?;
/// assert!(line.is_certified() && line.distance.hi <= 1e-3 && line.edges < 40);
/// # Ok::<(), tubecert::Error>(())
/// ```
pub fn polyline(spine: &Spine, tolerance: f64, options: &PolylineOptions) -> Result<Polyline, Error> {
    options::check(options.rel_width)?;
    positive(tolerance)?;
    let mut meter = options.meter();
    let of_tube = RadiusOptions { rel_width: options.rel_width, budget: options.budget, ..RadiusOptions::new() };
    let of_tube = RadiusOptions { cancel: options.cancel.clone(), max_cells: options.max_cells, ..of_tube };
    let answer = radius(spine, &of_tube)?;
    if answer.delta.hi == 0.0 {
        let message =
            "delta is 0: the spine has a corner or touches itself, and no polyline near it is known to be isotopic";
        return Err(Error::new(ErrorKind::Impossible, message).help("ask radius for the place"));
    }
    let frame = Frame::new(spine);
    let rail = Rail::new(&frame);
    let boxed = |x: f64| rational_from_f64(x).map_or(f64::INFINITY, |x| f64_below(&shifted(&x, frame.scale)));
    // strictly inside the tube
    let limit = boxed(tolerance).min(SHARE * boxed(answer.delta.lo));
    // where its decimal is exactly that
    let exact = |finish: bool| {
        let told = |x: &Rational| {
            let near = [f64_below(x), f64_above(x)];
            near.into_iter().find(|near| parse_rational(&nearest_text(*near)).is_ok_and(|y| y == *x))
        };
        let [x, y, z] = end(spine, finish).each_ref().map(told);
        Some([x?, y?, z?]).filter(|_| !spine.closed)
    };
    let found = if limit > 0.0 { course(&rail, limit, [false, true].map(exact), &mut meter) } else { None };
    let mut line = Polyline {
        vertices: vec![],
        parameters: vec![],
        closed: spine.closed,
        distance: Enclosure { lo: 0.0, hi: f64::INFINITY },
        tube_radius: answer.delta,
        edges: 0,
        edges_lower_bound: asymptotic(&rail, limit).ceil().max(1.0),
        a_priori_edges: of_control_polygons(&rail, limit),
        certificate: None,
        cells: meter.cells,
        stopped: meter.stopped.or(answer.stopped),
    };
    let Some(found) = found else { return Ok(line) };
    line.distance.hi = rational_from_f64(found.distance).map_or(f64::INFINITY, |x| f64_above(&frame.length(&x)));
    let knots = knots(&frame);
    line.parameters = found.positions.iter().map(|position| parameter(&knots, *position)).collect();
    line.edges = found.edges.len();
    line.vertices.clone_from(&found.vertices);
    if options.certificate {
        let bounds = [line.distance.hi, line.tube_radius.lo];
        line.certificate = line.claim().and_then(|claim| proof(spine, &frame, &found, claim, bounds));
    }
    Ok(line)
}

pub(crate) fn positive(tolerance: f64) -> Result<(), Error> {
    if tolerance > 0.0 && tolerance.is_finite() {
        return Ok(());
    }
    let message = format!("the tolerance must be a positive number, not {tolerance}");
    Err(Error::new(ErrorKind::Option, message).key("tolerance").help("give a length, for instance 0.001"))
}

/// An end of the spine.
pub(crate) fn end(spine: &Spine, finish: bool) -> [Rational; 3] {
    let segment = if finish { spine.segments.len() - 1 } else { 0 };
    let bezier = &spine.segments[segment].bezier;
    let [x, y, z, w] = bezier.point(if finish { bezier.degree() } else { 0 });
    [x, y, z].map(|x| Rational::new(x.big(), w.big()))
}

/// The ends of the spans, nearly.
fn knots(frame: &Frame) -> Vec<f64> {
    frame.knots.iter().map(|t| f64_below(t).midpoint(f64_above(t))).collect()
}

/// The parameter at a position, nearly.
fn parameter(knots: &[f64], position: f64) -> f64 {
    let span = (position.floor().max(0.0) as usize).min(knots.len() - 2);
    let t = position - span as f64;
    knots[span] * (1.0 - t) + knots[span + 1] * t
}

/// The certificate of a claim, whose distance is less than what is proved of delta.
pub(crate) fn proof(
    spine: &Spine,
    frame: &Frame,
    found: &Course,
    claim: claim::Polyline,
    [distance, delta]: [f64; 2],
) -> Option<Certificate> {
    let edges = found.edges.iter().map(|cuts| cuts.iter().map(|x| rational(*x)).collect()).collect();
    let ends = found.ends.map(|ends| ends.map(rational));
    // half way between the two
    let tube = tube(frame, if delta.is_finite() { distance.midpoint(delta) } else { f64::INFINITY })?;
    let evidence = Evidence::Polyline(Proof { claim, ends, stubs: found.stubs.clone(), edges, tube });
    Some(Certificate { digest: spine.curve().digest(), evidence })
}
