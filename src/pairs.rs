//! All stationary pairs: options in, boxes out (theory.md, section 4).

use crate::certificate::{Certificate, Evidence, pairs::Evidence as Proof, pairs::Isolated};
use crate::claim;
use crate::enclosure::Interval;
use crate::error::Error;
use crate::number::{Rational, f64_below, lower_text, parse_rational, upper_text};
use crate::options::{self, Enclosure, options};
use crate::search::dyadic::Dyadic;
use crate::search::evidence;
use crate::search::frame::Frame;
use crate::search::meter::Stop;
use crate::search::pairs::{Found, On, Root, stationary_pairs};
use crate::search::tree::Tree;
use crate::spine::Spine;
use num_bigint::BigInt;
use num_traits::ToPrimitive;

/// Parameters s > t in the curve's knots, and |C(s) - C(t)| in its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct StationaryPair {
    /// The greater parameter. On the seam of a closed spine an interval round the start, which may begin below it.
    pub s: Enclosure,
    /// The other parameter.
    pub t: Enclosure,
    /// |C(s) - C(t)|.
    pub distance: Enclosure,
}

/// The answer of [`pairs`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Pairs {
    /// Each holds exactly one stationary pair, no two the same; the closest first.
    pub pairs: Vec<StationaryPair>,
    /// Boxes that hold every other stationary pair, if there is any: whole curves of pairs (of a circle, of parallel strands),
    /// multiple ones, corners, and what was left when a limit was reached.
    pub undecided: Vec<StationaryPair>,
    /// Are these all: is nothing undecided?
    pub complete: bool,
    /// Is every pair enclosed as narrowly as asked?
    pub narrow: bool,
    /// The evidence, if it was asked for and can be written (docs/certificate-format.md): for the numbers as printed.
    pub certificate: Option<Certificate>,
    /// Cells that the search looked at.
    pub cells: u64,
    /// Why the search stopped early, if it did.
    pub stopped: Option<Stop>,
}

options! {
    /// Options of [`pairs`].
    PairsOptions {}
}

/// Every pair s > t at which |C(s) - C(t)|^2 is stationary: C(s) - C(t) is orthogonal to both tangents (theory.md, section 4).
/// The doubly critical pairs are among them, and so are self-intersections.
///
/// Each pair is proved to exist and to be alone in its box, and the rest of the domain is proved empty but for `undecided`.
/// Pairs (s, s), and the two parameters of a joint or of the closure, are not stationary pairs: they are excluded by proof.
///
/// # Errors
/// As [`radius`](fn@crate::radius).
///
/// ```
/// use tubecert::{PairsOptions, Spine, pairs};
/// let spine = Spine::from_json_str(r#"{"degree": 3, "control_points": [[0, 0], [9, 4], [-8, 4], [1, 0]]}"#)?;
/// let answer = pairs(&spine, &PairsOptions::new())?;
/// assert!(answer.complete);
/// # Ok::<(), tubecert::Error>(())
/// ```
pub fn pairs(spine: &Spine, options: &PairsOptions) -> Result<Pairs, Error> {
    options::check(options.rel_width)?;
    let frame = Frame::new(spine);
    let (start, end) = (&frame.knots[0], &frame.knots[frame.segments.len()]);
    let asked = |pair: &[Rational]| {
        let share = (end - start) / (&pair[1] - &pair[0]);
        (options.rel_width * share.to_f64().unwrap_or(1.0)).min(0.1)
    };
    let width = frame.knots.windows(2).map(asked).collect();
    let (mut tree, mut meter) = (Tree::new(&frame), options.meter());
    let found = stationary_pairs(&mut tree, width, options.certificate, &mut meter);
    let answer = Answer::new(&frame);
    let mut listed: Vec<(StationaryPair, usize)> = vec![];
    for (k, root) in found.roots.iter().enumerate().filter(|(_, root)| root.place != On::Beyond) {
        listed.push((answer.pair(&root.inner, root.point.as_ref(), root.distance), k));
    }
    listed.sort_by(|(a, _), (b, _)| a.distance.lo.total_cmp(&b.distance.lo).then(a.t.lo.total_cmp(&b.t.lo)));
    let (pairs, order): (Vec<StationaryPair>, Vec<usize>) = listed.into_iter().unzip();
    let undecided = found
        .open
        .iter()
        .map(|open| answer.pair(&open.places.map(|range| range.map(|place| place.position())), None, open.distance));
    let undecided: Vec<StationaryPair> = undecided.collect();
    let domain = f64_below(&(end - start));
    let parameter = |e: &Enclosure| e.hi - e.lo <= options.rel_width * domain || e.hi <= e.lo.next_up();
    let narrow =
        pairs.iter().all(|pair| parameter(&pair.s) && parameter(&pair.t) && pair.distance.is_within(options.rel_width));
    let complete = undecided.is_empty();
    let certificate =
        options.certificate.then(|| certificate(spine, &frame, &found, &order, &pairs, &undecided)).flatten();
    Ok(Pairs { pairs, undecided, complete, narrow, certificate, cells: meter.cells, stopped: meter.stopped })
}

/// Ranges of positions.
type Square = [[Rational; 2]; 2];

/// Where a pair is, as closely as it is known.
fn place(root: &Root) -> Square {
    let inner = || root.inner.each_ref().map(|range| range.each_ref().map(Dyadic::rational));
    root.point.as_ref().map_or_else(inner, |point| point.each_ref().map(|x| [x.clone(), x.clone()]))
}

struct Answer<'a> {
    frame: &'a Frame,
    /// The knots, and the lengths of the spans.
    spans: Vec<[Interval; 2]>,
}

impl<'a> Answer<'a> {
    fn new(frame: &'a Frame) -> Self {
        let near = |x: &Rational| Interval::from_ratio(x.numer(), x.denom());
        let spans = frame.knots.windows(2).map(|pair| [near(&pair[0]), near(&(&pair[1] - &pair[0]))]).collect();
        Self { frame, spans }
    }

    /// A box of positions and distances, in the curve's own measures.
    fn pair(&self, ranges: &[[Dyadic; 2]; 2], point: Option<&[Rational; 2]>, distance: Interval) -> StationaryPair {
        let parameters = |k: usize| match point {
            Some(point) => Enclosure::of(&self.exactly(&point[k])),
            None => self.parameters(&ranges[k]),
        };
        let (a, b) = (parameters(0), parameters(1));
        // s > t whatever the two are: ranges of which one holds the other are listed as one
        let both = Enclosure { lo: a.lo.min(b.lo), hi: a.hi.max(b.hi) };
        let (s, t) = match (a.lo >= b.lo, a.hi >= b.hi) {
            (true, true) => (a, b),
            _ if b.lo >= a.lo && b.hi >= a.hi => (b, a),
            _ => (both, both),
        };
        let scale = i32::try_from(-self.frame.scale).unwrap_or(if self.frame.scale > 0 { i32::MIN } else { i32::MAX });
        let distance = distance.scale2(scale);
        StationaryPair { s, t, distance: Enclosure { lo: distance.lo().max(0.0), hi: distance.hi() } }
    }

    /// What holds the seam of a closed spine is put about the start; an arc that ends there stays where it is.
    fn parameters(&self, range: &[Dyadic; 2]) -> Enclosure {
        let count = self.spans.len() as f64;
        let [from, to] = range.each_ref().map(|x| x.m.to_f64_shifted(-x.e));
        let middle = 0.5 * (from + to);
        let mut turn = if self.frame.closed { (middle / count).floor() } else { 0.0 };
        if self.frame.closed && from < (turn + 1.0) * count && (turn + 1.0) * count < to {
            turn += 1.0;
        }
        let [from, to] = range.each_ref().map(|x| self.parameter(x, turn));
        Enclosure { lo: from.lo(), hi: to.hi() }
    }

    /// The parameter at a position, so many turns back.
    fn parameter(&self, position: &Dyadic, turn: f64) -> Interval {
        let (last, count) = (self.spans.len() - 1, self.spans.len() as i64);
        let local = position.sub(&Dyadic::from(turn as i64 * count));
        let wrap = self.frame.closed && local.m.sign().is_lt();
        let local = if wrap { local.add(&Dyadic::from(count)) } else { local };
        let near = local.m.to_f64_shifted(-local.e);
        let span = (near.floor().max(0.0) as usize).min(last);
        let within = local.sub(&Dyadic::from(span as i64));
        let x = within.m.to_f64_shifted(-within.e);
        // off by half a step at the most, unless it is exact
        let exact = Dyadic::from_f64(x) == within;
        let x = if exact { Interval::point(x) } else { Interval::new(x.next_down(), x.next_up()) };
        let [knot, length] = self.spans[span];
        let parameter = knot + length * x;
        let [start, end] = [self.spans[0][0], self.spans[last][0] + self.spans[last][1]];
        if wrap { parameter - (end - start) } else { parameter }
    }

    /// The parameter at a rational position on an open spine.
    fn exactly(&self, position: &Rational) -> Rational {
        let (knots, last) = (&self.frame.knots, self.spans.len() - 1);
        let span = position.floor().to_integer().to_usize().unwrap_or(0).min(last);
        &knots[span] + (position - BigInt::from(span)) * (&knots[span + 1] - &knots[span])
    }
}

/// What the answer claims, exactly as it is printed; `None` where a number is out of the range of f64.
pub(crate) fn printed(pairs: &[StationaryPair]) -> Option<Vec<claim::PairBox>> {
    let number = |text: String| parse_rational(&text).ok();
    let range = |e: &Enclosure| Some([number(lower_text(e.lo))?, number(upper_text(e.hi))?]);
    let printed = |pair: &StationaryPair| {
        let distance = (number(lower_text(pair.distance.lo))?, number(upper_text(pair.distance.hi)));
        Some(claim::PairBox { s: range(&pair.s)?, t: range(&pair.t)?, distance })
    };
    pairs.iter().map(printed).collect()
}

fn certificate(
    spine: &Spine,
    frame: &Frame,
    found: &Found,
    order: &[usize],
    pairs: &[StationaryPair],
    undecided: &[StationaryPair],
) -> Option<Certificate> {
    let claim = claim::Pairs { pairs: printed(pairs)?, undecided: printed(undecided)? };
    // in the order of the claim, then those beyond the ends
    let beyond = (0..found.roots.len()).filter(|k| !order.contains(k));
    let order: Vec<usize> = order.iter().copied().chain(beyond).collect();
    let mut numbers = vec![0; order.len()];
    for (new, old) in order.iter().enumerate() {
        numbers[*old] = new;
    }
    if found.roots.iter().any(|root| root.place == On::End) {
        return None;
    }
    let isolated = |k: &usize| {
        let root = &found.roots[*k];
        let outer = root.outer.each_ref().map(|range| range.each_ref().map(Dyadic::rational));
        Isolated { outer, inner: place(root) }
    };
    let isolated = order.iter().map(isolated).collect();
    let (along, tree) = (evidence::along(frame, 0.0)?, found.tree(&numbers));
    let evidence = Evidence::Pairs(Proof { along, isolated, tree, claim });
    Some(Certificate { digest: spine.curve().digest(), evidence })
}
