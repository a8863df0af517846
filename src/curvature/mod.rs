//! The critical points of curvature: options in, enclosures out (theory.md, sections 1 and 3).

mod answer;
mod evidence;

pub use answer::{ConstantStretch, CriticalPoint, Curvature, CurvatureOptions};

use crate::claim::CriticalKind;
use crate::enclosure::Interval;
use crate::error::Error;
use crate::number::{Rational, f64_above, f64_below, same};
use crate::options::{self, Enclosure};
use crate::search::critical::{Bend, Course, End, Zero, course};
use crate::search::dyadic::{Dyadic, step};
use crate::search::kappa::{Exactly, Kappa};
use crate::search::meter::Meter;
use crate::spine::{Segment, Spine};
use std::cmp::Ordering;

/// Encloses the greatest curvature and every critical point of curvature: the zeros of the critical polynomial
/// N = (b.b') w |a|^2 + 3 w' |b|^2 |a|^2 - 3 |b|^2 w (a.a') of each segment, and the joints where kappa has an extremum
/// or jumps (theory.md, section 1; `a` is the hodograph, C' x C'' = b / w^3).
///
/// All enclosures are proved, and so is that no zero is missing: where a limit stops the search, or zeros are too close
/// to be told apart, what is left stands in the list as a stretch of which nothing more is said. A spine with corners has
/// a curvature on each side of them.
///
/// # Errors
/// [`Option`](crate::ErrorKind::Option) for a width that is not between 0 and 1, [`Rounding`](crate::ErrorKind::Rounding)
/// if the processor does not round as IEEE 754 says.
///
/// ```
/// use tubecert::{CriticalKind, CurvatureOptions, Spine, curvature};
/// let parabola = Spine::from_json_str(r#"{"degree": 2, "control_points": [[-1, 1], [0, -1], [1, 1]]}"#)?;
/// let answer = curvature(&parabola, &CurvatureOptions::new())?;
/// let [vertex] = &answer.critical_points[..] else { panic!("{answer:?}") };
/// assert!(vertex.kind == Some(CriticalKind::Maximum) && vertex.unique);
/// assert!(answer.kappa_max.lo <= 2.0 && 2.0 <= answer.kappa_max.hi && answer.complete);
/// # Ok::<(), tubecert::Error>(())
/// ```
pub fn curvature(spine: &Spine, options: &CurvatureOptions) -> Result<Curvature, Error> {
    options::check(options.rel_width)?;
    let mut meter = options.meter();
    let widths = Widths::new(spine, options.rel_width);
    let arcs: Vec<Arc> = spine.segments.iter().map(|segment| Arc::new(segment, &widths, &mut meter)).collect();

    let mut list = List {
        points: vec![],
        constant: vec![],
        max: Enclosure::ZERO,
        at: None,
        witness: (0, Dyadic::ZERO),
        decided: true,
    };
    // the seam of a closed spine is a joint, at the start
    let mut before = arcs.last().filter(|_| spine.closed).map(|arc| &arc.sides[1]);
    for (k, (segment, arc)) in spine.segments.iter().zip(&arcs).enumerate() {
        list.boundary(&segment.from, before, Some(&arc.sides[0]), [k.checked_sub(1).unwrap_or(arcs.len() - 1), k]);
        list.inside(segment, arc, k);
        before = Some(&arc.sides[1]);
    }
    if !spine.closed {
        list.boundary(spine.curve().domain().1, before, None, [arcs.len() - 1, 0]);
    }
    part(&mut list.points);
    let at = list.at.unwrap_or_else(|| Enclosure::of(spine.curve().domain().0));
    let narrow = |point: &CriticalPoint| widths.parameter(&point.t) && point.kappa.is_within(widths.share);
    let complete = list.decided
        && list.points.iter().all(narrow)
        && list.constant.iter().all(|stretch| stretch.kappa.is_within(widths.share))
        && list.max.is_within(widths.share)
        && widths.parameter(&at);
    let mut answer = Curvature {
        kappa_max: list.max,
        at,
        critical_points: list.points,
        constant: list.constant,
        complete,
        certificate: None,
        cells: meter.cells,
        stopped: meter.stopped,
    };
    if options.certificate {
        answer.certificate = evidence::certificate(spine, &arcs, list.witness, &answer, &meter);
    }
    Ok(answer)
}

/// So often a segment is searched for narrower parameters, each time by this factor, while a curvature is too wide.
const TRIES: usize = 4;
const FINER: f64 = 1.0 / (1 << 24) as f64;

/// What is narrow enough.
struct Widths {
    share: f64,
    domain: Rational,
}

impl Widths {
    fn new(spine: &Spine, share: f64) -> Self {
        let (from, to) = spine.curve().domain();
        let domain = to - from;
        Self { share, domain }
    }

    /// In the parameter of a segment, with room for rounding.
    fn inside(&self, segment: &Segment) -> f64 {
        let length = &segment.to - &segment.from;
        let times = if same(&length, &self.domain) { 1.0 } else { f64_below(&(&self.domain / length)) };
        0.25 * self.share * times.min(1e9)
    }

    fn parameter(&self, t: &Enclosure) -> bool {
        t.lo == t.hi || (t.hi - t.lo).next_up() <= self.share * f64_below(&self.domain)
    }
}

fn enclosure(x: Interval) -> Enclosure {
    Enclosure { lo: x.lo(), hi: x.hi() }
}

/// One end of a segment.
struct Side {
    kappa: Exactly,
    root: Enclosure,
    /// `None` where the curvature is constant.
    end: Option<End>,
}

/// A zero of N inside a segment, or a stretch left undecided.
struct Inner {
    zero: Zero,
    kappa: Enclosure,
    inflection: bool,
}

/// A segment and the critical points inside.
struct Arc {
    sides: [Side; 2],
    inner: Vec<Inner>,
}

impl Arc {
    fn new(segment: &Segment, widths: &Widths, meter: &mut Meter) -> Self {
        let bend = Bend::new(&segment.bezier);
        let kappa = Kappa::new(&segment.bezier, &bend);
        let mut width = widths.inside(segment);
        let (mut ends, mut inner) = ([None; 2], vec![]);
        for _ in 0..TRIES {
            let Course::Varying { ends: found, zeros } = course(&bend, width, meter) else { break };
            ends = found.map(Some);
            inner = zeros.into_iter().map(|zero| Inner::new(&kappa, zero, widths)).collect();
            // a small curvature wants a shorter arc
            let narrow = |i: &Inner| !i.zero.known || i.kappa.is_within(0.4 * widths.share);
            if meter.stopped.is_some() || inner.iter().all(narrow) {
                break;
            }
            width *= FINER;
        }
        let side = |t: Dyadic, end| {
            let kappa = Exactly::at(&bend, &t);
            Side { root: enclosure(kappa.root()), kappa, end }
        };
        Self { sides: [side(Dyadic::ZERO, ends[0]), side(Dyadic::ONE, ends[1])], inner }
    }
}

impl Inner {
    fn new(kappa: &Kappa, zero: Zero, widths: &Widths) -> Self {
        let inflection = zero.known && zero.after.is_gt() && zero.before.is_lt() && kappa.inflects(&zero);
        let kappa = if inflection {
            Enclosure::ZERO
        } else if zero.known {
            enclosure(kappa.on(&zero.lo, &zero.hi, |kappa, share| enclosure(kappa).is_within(share * widths.share)))
        } else {
            Enclosure { lo: 0.0, hi: kappa.at_most(&zero.lo, &zero.hi) }
        };
        Self { zero, kappa, inflection }
    }
}

/// The answer as it grows, from the start of the spine to its end.
struct List {
    points: Vec<CriticalPoint>,
    constant: Vec<ConstantStretch>,
    max: Enclosure,
    at: Option<Enclosure>,
    /// A segment and a parameter of it, in `at`.
    witness: (usize, Dyadic),
    decided: bool,
}

impl List {
    /// The curvature `kappa` at a place that may be the greatest.
    fn candidate(&mut self, t: Enclosure, kappa: Enclosure, place: (usize, Dyadic)) {
        if self.at.is_none() || kappa.lo > self.max.lo {
            (self.at, self.witness) = (Some(t), place);
        }
        self.max = Enclosure { lo: self.max.lo.max(kappa.lo), hi: self.max.hi.max(kappa.hi) };
    }

    /// A joint, or one end of an open spine.
    fn boundary(&mut self, knot: &Rational, before: Option<&Side>, after: Option<&Side>, segments: [usize; 2]) {
        let t = Enclosure::of(knot);
        let sides = || before.into_iter().chain(after);
        for (side, place) in [before, after].iter().zip(segments.into_iter().zip([Dyadic::ONE, Dyadic::ZERO])) {
            if let Some(side) = side {
                self.candidate(t, side.root, place);
            }
        }
        let kappa = |pick: fn(&Enclosure) -> f64| sides().map(|side| pick(&side.root)).fold(0.0, f64::max);
        let kappa = Enclosure { lo: kappa(|e| e.lo), hi: kappa(|e| e.hi) };
        let jumps = before.zip(after).is_some_and(|(p, q)| p.kappa.cmp(&q.kappa).is_ne());
        let ends = [before, after].map(|side| side.and_then(|side| side.end));
        let zeros = ends.map(|end| end.map_or(0, |end| end.multiplicity));
        let [rises, falls] = [Ordering::Greater, Ordering::Less];
        let sign = ends.map(|end| end.map_or(Ordering::Equal, |end| end.sign));
        let turns = sign == [rises, falls] || sign == [falls, rises];
        if !jumps && !turns && zeros == [0, 0] {
            return;
        }
        let both = [before, after].iter().zip(zeros).all(|(side, zeros)| side.is_none() || zeros > 0);
        let kind = if jumps {
            Some(CriticalKind::Joint)
        } else if sides().all(|side| side.kappa.is_zero()) {
            Some(CriticalKind::Inflection)
        } else if !both {
            Some(CriticalKind::Joint)
        } else {
            // beyond an end of the spine nothing rises or falls
            match sign {
                [Ordering::Greater | Ordering::Equal, Ordering::Less] | [Ordering::Greater, Ordering::Equal] => {
                    Some(CriticalKind::Maximum)
                }
                [Ordering::Less | Ordering::Equal, Ordering::Greater] | [Ordering::Less, Ordering::Equal] => {
                    Some(CriticalKind::Minimum)
                }
                _ => None,
            }
        };
        let unique = zeros.iter().all(|multiplicity| *multiplicity <= 1);
        self.points.push(CriticalPoint { t, kappa, kind, unique });
    }

    fn inside(&mut self, segment: &Segment, arc: &Arc, k: usize) {
        if let [Side { end: None, root, .. }, _] = arc.sides {
            let (from, to) = (f64_above(&segment.from), f64_below(&segment.to));
            self.constant.push(ConstantStretch { from, to, kappa: root });
        }
        for Inner { zero, kappa, inflection } in &arc.inner {
            let t = parameters(segment, &zero.lo, &zero.hi);
            let kind = match (zero.before, zero.after) {
                _ if *inflection => Some(CriticalKind::Inflection),
                (Ordering::Greater, Ordering::Less) if zero.known => Some(CriticalKind::Maximum),
                (Ordering::Less, Ordering::Greater) if zero.known && kappa.lo > 0.0 => Some(CriticalKind::Minimum),
                _ => None,
            };
            self.decided &= zero.known;
            self.candidate(t, *kappa, (k, zero.lo.add(&zero.hi).mul(&step(1))));
            self.points.push(CriticalPoint { t, kappa: *kappa, kind, unique: zero.simple });
        }
    }
}

/// A stretch of a segment in the curve's own knots.
fn parameters(segment: &Segment, lo: &Dyadic, hi: &Dyadic) -> Enclosure {
    let known = |x: &Rational| Interval::new(f64_below(x), f64_above(x));
    let rounded = |t: &Dyadic| if t.m.bits() <= 53 { Interval::point(t.to_f64()) } else { known(&t.rational()) };
    let start = known(&segment.from);
    let length = known(&segment.to) - start;
    let [from, to] = [lo, hi].map(|t| start + rounded(t) * length);
    if from.lo().is_finite() && to.hi().is_finite() {
        return Enclosure { lo: from.lo(), hi: to.hi() };
    }
    // knots beyond the range of f64
    let exact = |t: &Dyadic| &segment.from + t.rational() * (&segment.to - &segment.from);
    Enclosure::between(&exact(lo), &exact(hi))
}

/// A point is unique only if its `t` meets no other, as it will be printed: up to two steps further out. Ends that
/// rounding has put out of order, next to a knot, are moved outward.
fn part(points: &mut [CriticalPoint]) {
    for i in 1..points.len() {
        points[i].t.hi = points[i].t.hi.max(points[i - 1].t.hi);
        let back = points.len() - 1 - i;
        points[back].t.lo = points[back].t.lo.min(points[back + 1].t.lo);
    }
    let printed = |t: Enclosure| Enclosure { lo: t.lo.next_down().next_down(), hi: t.hi.next_up().next_up() };
    for i in 1..points.len() {
        let [before, after] = [points[i - 1].t, points[i].t];
        points[i - 1].unique &= !printed(before).meets(&after);
        points[i].unique &= !printed(after).meets(&before);
    }
}
