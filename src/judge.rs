//! The verdict on a polyline made elsewhere (theory.md, section 7).

use crate::certificate::Certificate;
use crate::claim;
use crate::enclosure::Interval;
use crate::error::{Error, ErrorKind};
use crate::integer::Int;
use crate::number::{Rational, f64_above, f64_below, parse_rational, rational_from_f64, upper_text};
use crate::options::{self, Enclosure, options};
use crate::polyline::{SHARE, end, proof};
use crate::radius::{RadiusOptions, radius};
use crate::search::dyadic::shifted;
use crate::search::follow::{Feet, Follower, INNER, all_farther};
use crate::search::frame::Frame;
use crate::search::meter::{Meter, Stop};
use crate::search::polyline::{Course, Point, REACH, Rail, dot, rational, square, sub, together};
use crate::search::tree::Tree;
use crate::spine::{Bezier, Segment, Spine};
use num_traits::Signed;

options! {
    /// Options of [`check`](fn@crate::check). The relative width is that of delta.
    CheckOptions {}
}

/// What is known of a polyline.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Verdict {
    /// It is within the tolerance of the spine, and isotopic to it in its tube.
    Certified,
    /// It is not, or does not meet each normal disk once, in order: there is a witness.
    Refuted,
    /// Neither is proved.
    Undecided,
}

impl Verdict {
    /// The word used in JSON.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Certified => "certified",
            Self::Refuted => "refuted",
            Self::Undecided => "undecided",
        }
    }
}

/// What disproves a polyline, or the place where the proof stopped.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct PolylineWitness {
    /// `vertex`, `edge` (a point of it), `spine` (a point of the curve).
    pub kind: &'static str,
    /// The edge, from 0; it starts at the vertex of that number, as given. For the last vertex of an open polyline, the last edge.
    pub edge: Option<usize>,
    /// The parameter of the point of the spine, or of the normal disk of the point of the polyline, in the curve's knots.
    pub t: Option<Enclosure>,
    /// The point.
    pub point: Option<[Enclosure; 3]>,
}

/// The answer of [`check`](fn@crate::check).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Check {
    /// The verdict.
    pub verdict: Verdict,
    /// Of the Frechet distance of polyline and spine.
    pub distance: Enclosure,
    /// `near` and isotopic; `farther_than_tolerance`, `leaves_tube`, `doubles_back`, `spine_passed_over`, `no_tube`; or what was not proved:
    /// `no_order`, `edge_not_proved`, `end_not_covered`, `limit`.
    pub reason: &'static str,
    /// Where.
    pub witness: Option<PolylineWitness>,
    /// What is proved if it is certified; the vertices are turned round if they run against the spine.
    pub claim: Option<claim::Polyline>,
    /// The evidence, if it was asked for and can be written.
    pub certificate: Option<Certificate>,
    /// Vertices and cells that were looked at.
    pub cells: u64,
    /// Why the search stopped early, if it did.
    pub stopped: Option<Stop>,
}

/// Judges a polyline: is it within `tolerance` of the spine, and isotopic to it inside its tube?
///
/// *Meaning.* That of [`polyline`](fn@crate::polyline), for vertices anywhere near the spine, exactly as they are given. On a closed
/// spine the polyline is closed, may start anywhere, run either way, and may repeat its first vertex at the end; repeated vertices count
/// once. Where the polyline of an open spine reaches beyond its ends, by less than the tolerance, the spine counts as prolonged by
/// straight stubs, whose tube is proved as well. *Refuted* rests on a witness: a point of the polyline farther than the tolerance, or than delta's upper bound, from all of
/// the spine; a point of the spine farther than the tolerance from all edges; points of the polyline in normal disks whose order is not
/// that of the spine. Otherwise *undecided*: nothing is said.
///
/// # Errors
/// As [`polyline`](fn@crate::polyline), but a spine without a tube refutes; and [`ErrorKind::Option`] for fewer than two vertices.
///
/// ```
/// use tubecert::{CheckOptions, PolylineOptions, Rational, Spine, Verdict, check, polyline};
/// let parabola = Spine::bezier(&[[-1.0, 1.0, 0.0], [0.0, -1.0, 0.0], [1.0, 1.0, 0.0]], None)?;
/// let line = polyline(&parabola, 1e-3, &PolylineOptions::new())?;
/// let mut vertices = line.claim().unwrap().vertices;
/// assert_eq!(check(&parabola, &vertices, 1e-3, &CheckOptions::new())?.verdict, Verdict::Certified);
/// vertices[5][2] = Rational::new(1.into(), 100.into());
/// assert_eq!(check(&parabola, &vertices, 1e-3, &CheckOptions::new())?.verdict, Verdict::Refuted);
/// # Ok::<(), tubecert::Error>(())
/// ```
pub fn check(
    spine: &Spine,
    vertices: &[[Rational; 3]],
    tolerance: f64,
    options: &CheckOptions,
) -> Result<Check, Error> {
    options::check(options.rel_width)?;
    crate::polyline::positive(tolerance)?;
    // a point listed twice in a row counts once
    let again = |k: &usize| *k > 0 && vertices[*k] == vertices[k - 1];
    let mut numbers: Vec<usize> = (0..vertices.len()).filter(|k| !again(k)).collect();
    if spine.closed && numbers.len() > 1 && vertices.first() == vertices.last() {
        numbers.pop();
    }
    let mut vertices: Vec<[Rational; 3]> = numbers.iter().map(|k| vertices[*k].clone()).collect();
    if vertices.len() < 2 {
        return Err(Error::new(ErrorKind::Option, "a polyline has two different vertices or more")
            .key("vertices")
            .help("give a list of points"));
    }
    let frame = Frame::new(spine);
    let rail = Rail::new(&frame);
    let tube = delta(spine, options)?;
    let mut meter = options.meter();
    let mut answer = Check {
        verdict: Verdict::Undecided,
        distance: Enclosure { lo: 0.0, hi: f64::INFINITY },
        reason: "limit",
        witness: None,
        claim: None,
        certificate: None,
        cells: 0,
        stopped: None,
    };
    if tube.hi == 0.0 {
        (answer.verdict, answer.reason) = (Verdict::Refuted, "no_tube");
        return Ok(answer);
    }
    let job = Job::new(spine, &frame, &rail, &vertices, numbers, tolerance, tube);
    let found = job.proved([false; 2], &mut meter).map(|(course, reversed)| (course, reversed, None));
    // beyond an end the spine may be prolonged
    let stubs = found.is_err().then(|| job.stubs()).flatten();
    let found = match stubs {
        None => found,
        Some(stubs) => {
            let longer = prolonged(spine, &stubs);
            let tube = delta(&longer, options)?;
            let frame = Frame::new(&longer);
            let rail = Rail::new(&frame);
            let other = Job::new(&longer, &frame, &rail, &vertices, job.numbers.clone(), tolerance, tube);
            let has = stubs.each_ref().map(Signed::is_positive);
            let proved = other.proved(has, &mut meter);
            let proved = proved
                .map(|(course, reversed)| (Course { stubs: Some(stubs), ..course }, reversed, Some((frame, tube))));
            proved.or(found)
        }
    };
    match found {
        Ok((course, reversed, other)) => {
            (answer.verdict, answer.reason) = (Verdict::Certified, "near");
            if reversed {
                vertices.reverse();
                // a closed one starts where it did
                vertices.rotate_right(usize::from(spine.closed));
            }
            let (frame, tube) = other.unwrap_or((frame, tube));
            let most = rational_from_f64(course.distance).map_or(f64::INFINITY, |x| f64_above(&frame.length(&x)));
            answer.distance.hi = most;
            let distance = parse_rational(&upper_text(most))?;
            let claim = claim::Polyline { vertices, closed: spine.closed, distance };
            if options.certificate {
                answer.certificate = proof(spine, &frame, &course, claim.clone(), [most, tube.lo]);
            }
            answer.claim = Some(claim);
        }
        Err((reason, edge)) => {
            answer.reason = reason;
            answer.witness =
                edge.map(|edge| PolylineWitness { kind: "edge", edge: Some(job.numbers[edge]), t: None, point: None });
            if let Some((reason, witness)) = job.refuted(edge, &mut meter) {
                (answer.verdict, answer.reason, answer.witness) = (Verdict::Refuted, reason, Some(witness));
                if reason == "farther_than_tolerance" || reason == "spine_passed_over" {
                    answer.distance.lo = tolerance;
                }
            }
        }
    }
    (answer.cells, answer.stopped) = (meter.cells, meter.stopped);
    Ok(answer)
}

/// The enclosure of delta.
fn delta(spine: &Spine, options: &CheckOptions) -> Result<Enclosure, Error> {
    let of_tube = RadiusOptions { rel_width: options.rel_width, budget: options.budget, ..RadiusOptions::new() };
    let of_tube = RadiusOptions { cancel: options.cancel.clone(), max_cells: options.max_cells, ..of_tube };
    Ok(radius(spine, &of_tube)?.delta)
}

/// An open spine with straight segments before and after it, so long in terms of the control legs there; 0: none.
fn prolonged(spine: &Spine, stubs: &[Rational; 2]) -> Spine {
    let mut longer = spine.clone();
    for (finish, u) in [false, true].into_iter().zip(stubs).filter(|(_, u)| u.is_positive()) {
        let segment = &longer.segments[if finish { longer.segments.len() - 1 } else { 0 }];
        let bezier = &segment.bezier;
        let n = bezier.degree();
        let (end, next) =
            if finish { (bezier.point(n), bezier.point(n - 1)) } else { (bezier.point(0), bezier.point(1)) };
        let (p, q) = (Int::from(u.numer().clone()), Int::from(u.denom().clone()));
        let (both, sum) = (&(&end[3] * &next[3]) * &q, &p + &q);
        let x = [0, 1, 2].map(|k| {
            let near = &end[k] * &next[3];
            let far = &(&near * &sum) - &(&(&p * &next[k]) * &end[3]);
            let near = &near * &q;
            if finish { vec![near, far] } else { vec![far, near] }
        });
        let one = Rational::from_integer(1.into());
        let [from, to] =
            if finish { [segment.to.clone(), &segment.to + one] } else { [&segment.from - one, segment.from.clone()] };
        let stub = Segment { from, to, bezier: Bezier { x, w: vec![both] } };
        longer.segments.insert(if finish { longer.segments.len() } else { 0 }, stub);
    }
    longer
}

struct Job<'a> {
    frame: &'a Frame,
    rail: &'a Rail<'a>,
    follower: Follower<'a>,
    /// In the box.
    points: Vec<Point>,
    middles: Vec<[f64; 3]>,
    /// Of the vertices as they were given.
    numbers: Vec<usize>,
    /// Whether the first vertex, and the last, is exactly the start, or the finish.
    exact: [[bool; 2]; 2],
    /// So near each edge must be.
    limit: f64,
    tolerance: f64,
    /// Of delta.
    tube: [f64; 2],
}

type Refutation = (&'static str, PolylineWitness);

impl<'a> Job<'a> {
    fn new(
        spine: &Spine,
        frame: &'a Frame,
        rail: &'a Rail<'a>,
        vertices: &[[Rational; 3]],
        numbers: Vec<usize>,
        tolerance: f64,
        delta: Enclosure,
    ) -> Self {
        let boxed = |x: f64, round: fn(&Rational) -> f64| {
            rational_from_f64(x).map_or(f64::INFINITY, |x| round(&shifted(&x, frame.scale)))
        };
        let points: Vec<Point> = vertices.iter().map(|vertex| rail.exact(vertex)).collect();
        Self {
            frame,
            rail,
            follower: Follower::new(rail, spine.closed),
            middles: points.iter().map(|point| point.map(Interval::mid)).collect(),
            points,
            numbers,
            exact: [0, vertices.len() - 1].map(|k| [false, true].map(|finish| vertices[k] == end(spine, finish))),
            limit: boxed(tolerance, f64_below).min(SHARE * boxed(delta.lo, f64_below)),
            // a decimal that was rounded down to this f64 is below the next
            tolerance: boxed(tolerance.next_up(), f64_above),
            tube: [boxed(delta.lo, f64_below), boxed(delta.hi, f64_above)],
        }
    }

    /// Of an open spine beyond whose ends, by less than is allowed, the polyline reaches: the stubs that hold it.
    fn stubs(&self) -> Option<[Rational; 2]> {
        if self.closed() || self.limit <= 0.0 {
            return None;
        }
        let (first, last) = (self.middles[0], self.middles[self.middles.len() - 1]);
        let gap = |a: &[f64; 3], b: &[f64; 3]| [0, 1, 2].map(|k| a[k] - b[k]);
        let inner = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let near = |p: &[f64; 3], q: &[f64; 3]| inner(&gap(p, q), &gap(p, q));
        let start = self.rail.place(0.0);
        let turned = near(&last, &start) < near(&first, &start);
        let stub = |finish: bool| {
            let vertex = if finish == turned { first } else { last };
            let bezier = &self.frame.segments[if finish { self.frame.segments.len() - 1 } else { 0 }];
            let n = bezier.degree();
            let at = |i: usize| {
                let point = bezier.point(i);
                [0, 1, 2].map(|k| Interval::from_ratio(&point[k].big(), &point[3].big()).mid())
            };
            let (end, next) = if finish { (at(n), at(n - 1)) } else { (at(0), at(1)) };
            let leg = gap(&end, &next);
            // in terms of the leg
            let over = inner(&gap(&vertex, &end), &leg) / inner(&leg, &leg);
            // more than that: the arc of the edge reaches beyond the vertex
            rational(if over > 0.0 && over.is_finite() { 2.5 * over + 1e-12 } else { 0.0 })
        };
        let stubs = [stub(false), stub(true)];
        stubs.iter().any(Signed::is_positive).then_some(stubs)
    }

    fn closed(&self) -> bool {
        self.frame.closed
    }

    fn edges(&self) -> usize {
        self.points.len() - usize::from(!self.closed())
    }

    /// The proof, and whether the vertices were turned round; or what was not proved, and of which edge.
    fn proved(&self, stubs: [bool; 2], meter: &mut Meter) -> Result<(Course, bool), (&'static str, Option<usize>)> {
        let (rail, count) = (self.rail, self.rail.count());
        if self.limit <= 0.0 {
            return Err(("limit", None));
        }
        let feet = self.follower.feet(&self.middles, self.limit, meter);
        let Some(Feet { positions, reversed }) = feet else { return Err(("no_order", None)) };
        let n = self.points.len();
        let number = |k: usize| match (reversed, self.closed()) {
            (false, _) => k % n,
            (true, true) => (n - k % n) % n,
            (true, false) => n - 1 - k,
        };
        // of the polyline as it was given
        let edge_number = |k: usize| if reversed { number(k + 1) } else { k };
        // the first vertex is the start, the last the finish
        let exact = |finish: bool| !self.closed() && self.exact[usize::from(finish != reversed)][usize::from(finish)];
        let (mut edges, mut most) = (vec![], 0.0_f64);
        let all = self.edges();
        for k in 0..all {
            let (from, to) = (&self.points[number(k)], &self.points[number(k + 1)]);
            let start = positions[k];
            let finish = if k + 1 < n { positions[k + 1] } else { positions[0] + count };
            let length = square(&sub(to, from)).sqrt().mid();
            let proved = [REACH, 0.125, 0.4, 1.0].iter().find_map(|reach| {
                let (start, finish) = (rail.snapped(start), rail.snapped(finish));
                let low = rail.moved(start, -reach * rail.step(start, length));
                let high = rail.moved(finish, reach * rail.step(finish, length));
                let held = |x: f64| if self.closed() { x } else { x.clamp(0.0, count) };
                let cuts = rail.cuts(held(low), held(high));
                // a vertex at an end of the spine may lie in its plane
                let on = |finish: bool, cut: f64| cut == if finish { count } else { 0.0 } && exact(finish);
                let known = [k == 0 && on(false, cuts[0]), k + 1 == all && on(true, cuts[cuts.len() - 1])];
                rail.edge(from, to, &cuts, known).filter(|off| *off <= self.limit).map(|off| (cuts, off))
            });
            if !meter.tick() {
                return Err(("limit", None));
            }
            let (cuts, off) = proved.ok_or(("edge_not_proved", Some(edge_number(k))))?;
            most = most.max(off);
            edges.push(cuts);
        }
        if self.closed() && !together(&edges, count) {
            return Err(("no_order", None));
        }
        let mut ends = None;
        if !self.closed() {
            let mut places = [0.0, count];
            for (k, vertex) in [(0, number(0)), (1, number(n - 1))] {
                let (vertex, foot) = (&self.points[vertex], positions[if k == 0 { 0 } else { n - 1 }]);
                if exact(k == 1) {
                    continue;
                }
                // a stub is all of it near the vertex, whose edge leaves it
                if stubs[k] {
                    let (place, range) = if k == 0 { (1.0, [0.0, 1.0]) } else { (count - 1.0, [count - 1.0, count]) };
                    let off = rail.covered(vertex, range, k == 0).filter(|off| *off <= self.limit);
                    let next: &[f64] =
                        edges.get(if k == 0 { 1 } else { all.wrapping_sub(2) }).map_or(&[], |cuts: &Vec<f64>| cuts);
                    let leaves = if k == 0 {
                        next.first().is_none_or(|x| *x >= 1.0)
                    } else {
                        next.last().is_none_or(|x| *x <= count - 1.0)
                    };
                    most = most.max(off.filter(|_| leaves).ok_or(("end_not_covered", None))?);
                    places[k] = place;
                    continue;
                }
                let covered = (1..30).find_map(|halvings| {
                    let more = 0.25_f64.powi(halvings).max(4.0 * self.rail.snapped(1e-12));
                    let place =
                        if k == 0 { rail.snapped(foot + more).min(count) } else { rail.snapped(foot - more).max(0.0) };
                    let range = if k == 0 { [0.0, place] } else { [place, count] };
                    if range[0] >= range[1] || range[0].floor() + 1.0 < range[1] {
                        return None;
                    }
                    rail.covered(vertex, range, k == 0).filter(|off| *off <= self.limit).map(|off| (place, off))
                });
                let (place, off) = covered.ok_or(("end_not_covered", None))?;
                most = most.max(off);
                places[k] = place;
            }
            ends = Some(places);
        }
        let course = Course { vertices: vec![], positions, edges, ends, stubs: None, distance: most };
        Ok((course, reversed))
    }

    fn refuted(&self, edge: Option<usize>, meter: &mut Meter) -> Option<Refutation> {
        let mut tree = Tree::new(self.frame);
        let (least, mut at) = (self.tolerance.min(self.tube[1]), 0.0);
        for (k, (point, middle)) in self.points.iter().zip(&self.middles).enumerate() {
            // near the foot of the one before, or nowhere near
            let (foot, off) = self.follower.foot(middle, at);
            if off <= least {
                at = foot;
                continue;
            }
            if let Some(found) = self.far(&mut tree, point, middle, ("vertex", k), meter) {
                return Some(found);
            }
        }
        let (n, edges) = (self.points.len(), self.edges());
        // the edge that stopped the proof, else all if they are few
        let suspects: Vec<usize> = match edge {
            Some(edge) => (edge.saturating_sub(1)..(edge + 2).min(edges)).collect(),
            None if edges <= 4096 => (0..edges).collect(),
            None => vec![],
        };
        let mut sequence: Vec<(usize, Point)> = vec![];
        for k in 0..n {
            sequence.push((k, self.points[k]));
            if k < edges && suspects.binary_search(&k).is_ok() {
                let (a, b) = (&self.points[k], &self.points[(k + 1) % n]);
                for i in 1..INNER {
                    let t = i as f64 / INNER as f64;
                    let inner: Point = [0, 1, 2].map(|x| a[x] + (b[x] - a[x]) * Interval::point(t));
                    if let Some(found) = self.far(&mut tree, &inner, &inner.map(Interval::mid), ("edge", k), meter) {
                        return Some(found);
                    }
                    sequence.push((k, inner));
                }
            }
        }
        self.passed_over(meter).or_else(|| self.disordered(&sequence, meter))
    }

    /// A point of the polyline is farther from all of the spine than the tolerance, or than delta.
    fn far(
        &self,
        tree: &mut Tree,
        point: &Point,
        middle: &[f64; 3],
        (kind, edge): (&'static str, usize),
        meter: &mut Meter,
    ) -> Option<Refutation> {
        if !meter.tick() {
            return None;
        }
        let least = self.tolerance.min(self.tube[1]);
        let (_, off) = self.follower.nearest(middle);
        if off <= least {
            return None;
        }
        let proved =
            |limit: f64, tree: &mut Tree, meter: &mut Meter| off > limit && all_farther(tree, point, limit, meter);
        let reason = if proved(self.tolerance, tree, meter) {
            "farther_than_tolerance"
        } else if proved(self.tube[1], tree, meter) {
            "leaves_tube"
        } else {
            return None;
        };
        Some((reason, self.witness(kind, Some(edge), None, point)))
    }

    fn witness(
        &self,
        kind: &'static str,
        edge: Option<usize>,
        places: Option<[f64; 2]>,
        point: &Point,
    ) -> PolylineWitness {
        let point = self.rail.outside(point).map(|x| Enclosure { lo: x.lo(), hi: x.hi() });
        let parameter = |position: f64| {
            let span = (position.floor().max(0.0) as usize).min(self.frame.segments.len() - 1);
            let [from, to] = [&self.frame.knots[span], &self.frame.knots[span + 1]];
            from + rational(position - span as f64) * (to - from)
        };
        let turned = |low: f64| if self.closed() { low.rem_euclid(self.rail.count()) - low } else { 0.0 };
        let places = places.map(|[low, high]| [low + turned(low), high + turned(low)]);
        let t = places.map(|[low, high]| Enclosure { lo: f64_below(&parameter(low)), hi: f64_above(&parameter(high)) });
        let edge = edge.map(|edge| self.numbers[edge.min(self.edges() - 1)]);
        PolylineWitness { kind, edge, t, point: Some(point) }
    }

    /// A point of the spine is farther than the tolerance from all edges.
    fn passed_over(&self, meter: &mut Meter) -> Option<Refutation> {
        let (n, edges) = (self.points.len(), self.edges());
        let spans = self.rail.count() as usize;
        let samples = (200_000_000 / edges / spans).clamp(1, 64);
        let near = |p: &[f64; 3], k: usize| {
            let (a, b) = (&self.middles[k], &self.middles[(k + 1) % n]);
            let d: [f64; 3] = [0, 1, 2].map(|x| b[x] - a[x]);
            let away: [f64; 3] = [0, 1, 2].map(|x| p[x] - a[x]);
            let size: f64 = d.iter().map(|x| x * x).sum();
            let t = (d.iter().zip(&away).map(|(x, y)| x * y).sum::<f64>() / size).clamp(0.0, 1.0);
            [0, 1, 2].map(|x| away[x] - t * d[x]).iter().map(|x| x * x).sum::<f64>()
        };
        for i in 0..=spans * samples {
            if !meter.tick() {
                return None;
            }
            let position = i as f64 / samples as f64;
            let place = self.rail.place(position);
            let square_of = self.tolerance * self.tolerance * (1.0 + 1e-9);
            if (0..edges).all(|k| near(&place, k) > square_of) {
                let position = self.rail.snapped(position);
                let point = self.rail.enclosed(position);
                let proved =
                    (0..edges).all(|k| farther(&point, &self.points[k], &self.points[(k + 1) % n], self.tolerance));
                if proved {
                    return Some(("spine_passed_over", self.witness("spine", None, Some([position; 2]), &point)));
                }
            }
        }
        None
    }

    /// Have two brackets no parameter in common, whole turns apart?
    fn apart(&self, a: &[f64; 2], b: &[f64; 2]) -> bool {
        if !self.closed() {
            return a[1] < b[0] || b[1] < a[0];
        }
        let (gap, both) = (b[0].midpoint(b[1]) - a[0].midpoint(a[1]), (b[1] - b[0]) + (a[1] - a[0]));
        let gap = gap.rem_euclid(self.rail.count());
        both < gap && gap < self.rail.count() - both
    }

    /// Points of the polyline lie in disks of the tube that do not follow one another as those of the spine do.
    fn disordered(&self, sequence: &[(usize, Point)], meter: &mut Meter) -> Option<Refutation> {
        let count = self.rail.count();
        let mut disks: Vec<([f64; 2], usize, Point)> = vec![];
        for (edge, point) in sequence {
            if !meter.tick() {
                return None;
            }
            let (at, off) = self.follower.nearest(&point.map(Interval::mid));
            if off >= self.tube[0] {
                continue;
            }
            let bracket = [1e-9, 1e-6, 1e-4].iter().find_map(|half| {
                let [low, high] = [self.rail.snapped(at - half), self.rail.snapped(at + half)];
                let inside = self.closed() || (low >= 0.0 && high <= count);
                let most = if inside { self.rail.bracket(point, low, high)? } else { return None };
                (most < self.tube[0]).then_some([low, high])
            });
            let Some(bracket) = bracket else { continue };
            let apart = disks.last().is_none_or(|(last, ..)| self.apart(last, &bracket));
            if apart {
                disks.push((bracket, *edge, *point));
            }
        }
        let middle = |[low, high]: &[f64; 2]| low.midpoint(*high);
        let mut steps: Vec<f64> = disks.windows(2).map(|pair| middle(&pair[1].0) - middle(&pair[0].0)).collect();
        if !self.closed() {
            let (forward, back) = (steps.iter().any(|x| *x > 0.0), steps.iter().any(|x| *x < 0.0));
            if !(forward && back) {
                return None;
            }
            let forward = steps.iter().filter(|x| **x > 0.0).count() * 2 >= steps.len();
            let wrong = steps.iter().position(|x| (*x < 0.0) == forward)?;
            let (bracket, edge, point) = &disks[wrong + 1];
            return Some(("doubles_back", self.witness("edge", Some(*edge), Some(*bracket), point)));
        }
        while disks.len() > 2 && !self.apart(&disks[disks.len() - 1].0, &disks[0].0) {
            disks.pop();
            steps.pop();
        }
        if disks.len() < 3 {
            return None;
        }
        steps.push(middle(&disks[0].0) - middle(&disks[disks.len() - 1].0));
        // forward all the way, or back all the way: once round
        let turns = (steps.iter().map(|x| x.rem_euclid(count)).sum::<f64>() / count).round() as usize;
        if turns == 1 || turns + 1 == steps.len() {
            return None;
        }
        let forward = turns * 2 <= steps.len();
        let against = |x: &f64| (x.rem_euclid(count) > 0.5 * count) == forward;
        let wrong = steps.iter().position(against).unwrap_or(0);
        let (bracket, edge, point) = &disks[(wrong + 1) % disks.len()];
        Some(("doubles_back", self.witness("edge", Some(*edge), Some(*bracket), point)))
    }
}

/// A point is farther than `limit` from a segment: proved.
fn farther(p: &Point, a: &Point, b: &Point, limit: f64) -> bool {
    let (away, d) = (sub(p, a), sub(b, a));
    let (along, size) = (dot(&away, &d), square(&d));
    let least = Interval::point(limit).sqr();
    let beyond = |x: Interval| (x - least).is_positive();
    let ends = beyond(square(&away)) && beyond(square(&sub(p, b)));
    // the foot is on the line: |p - a|^2 |d|^2 - ((p - a).d)^2 > limit^2 |d|^2; or beyond an end
    let beside = (square(&away) * size - along.sqr() - least * size).is_positive();
    let outside = along.hi() <= 0.0 || (along - size).lo() >= 0.0;
    ends && (beside || outside)
}
