//! A polyline that runs along the spine: theory.md, section 7, Theorem P'. Each edge is as long as the tolerance allows, and is
//! proved as it is made, in intervals: for the vertex that is printed, and any number within one step of it.

use super::dyadic::shifted;
use super::frame::Frame;
use super::meter::Meter;
use crate::bernstein::UNIT;
use crate::enclosure::Interval;
use crate::integer::Int;
use crate::number::Rational;
use crate::spine::Bezier;

pub(crate) type Point = [Interval; 3];

/// How far the arc of an edge reaches beyond its vertices, as a share of its length.
pub(crate) const REACH: f64 = 1.0 / 32.0;
/// An edge is long enough if the bound of its distance is this share of what is allowed.
const FULL: f64 = 0.94;
/// So often an edge is tried.
const TRIES: usize = 60;

/// The spine in the box of a frame, in intervals.
pub(crate) struct Rail<'a> {
    frame: &'a Frame,
    origin: Point,
    spans: Vec<Span>,
    /// Positions are multiples of this.
    unit: f64,
}

struct Span {
    /// Empty for a constant weight.
    w: Vec<Interval>,
    /// (r, w), nearly.
    near: Vec<[f64; 4]>,
    /// How far off r and w are in a part of the span.
    off: [f64; 2],
    /// |C'| at both ends, nearly.
    speed: [f64; 2],
}

/// A polyline with its proof.
pub(crate) struct Course {
    pub(crate) vertices: Vec<[f64; 3]>,
    /// Where the vertices are: span + local parameter.
    pub(crate) positions: Vec<f64>,
    /// The cuts of the arc of each edge.
    pub(crate) edges: Vec<Vec<f64>>,
    /// Of an open spine: beyond the disks of the first and the last vertex.
    pub(crate) ends: Option<[f64; 2]>,
    /// The lengths of the stubs of a spine that was prolonged.
    pub(crate) stubs: Option<[Rational; 2]>,
    /// No point is farther, in the box.
    pub(crate) distance: f64,
}

pub(crate) fn sub(a: &Point, b: &Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn dot(a: &Point, b: &Point) -> Interval {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn square(a: &Point) -> Interval {
    a[0].sqr() + a[1].sqr() + a[2].sqr()
}

fn cross(a: &Point, b: &Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

impl Span {
    fn new(bezier: &Bezier) -> Self {
        let ratio = |x: &Int, w: &Int| Interval::from_ratio(&x.big(), &w.big());
        let (n, first) = (bezier.degree(), bezier.weight(0));
        let point = |i: usize| [0, 1, 2].map(|k| ratio(&bezier.x[k][i], first));
        let r: Vec<Point> = (0..=n).map(point).collect();
        let w: Vec<Interval> = match bezier.w.len() {
            1 => vec![],
            _ => bezier.w.iter().map(|w| ratio(w, first)).collect(),
        };
        let weight = |i: usize| if w.is_empty() { 1.0 } else { w[i].mid() };
        let speed = |i: usize, j: usize| {
            let leg = [0, 1, 2].map(|k| r[j][k].mid() / weight(j) - r[i][k].mid() / weight(i));
            n as f64 * weight(j) / weight(i) * leg.iter().map(|x| x * x).sum::<f64>().sqrt()
        };
        let speed = [speed(0, 1), speed(n, n - 1)];
        let near = (0..=n).map(|i| [r[i][0].mid(), r[i][1].mid(), r[i][2].mid(), weight(i)]).collect();
        let of = |all: &mut dyn Iterator<Item = Interval>| {
            all.fold(0.0_f64, |most, x| most.max((x.hi() - x.lo()) + (8 * n + 4) as f64 * UNIT * x.mag()))
        };
        let off = [of(&mut r.iter().flatten().copied()), of(&mut w.iter().copied())].map(|off| off * 1.0001 + 1e-300);
        Self { w, near, off, speed }
    }

    /// The control points, and weights, of the part from p to q, in f64 with what that is off by at the most
    /// (docs/rounding.md, section 11).
    fn part(&self, p: f64, q: f64) -> (Vec<Point>, Vec<Interval>) {
        let mut c = self.near.clone();
        let n = c.len() - 1;
        let between = |a: &[f64; 4], b: &[f64; 4], t: f64| [0, 1, 2, 3].map(|k| (1.0 - t) * a[k] + t * b[k]);
        if q < 1.0 {
            for level in 1..=n {
                for i in (level..=n).rev() {
                    c[i] = between(&c[i - 1], &c[i], q);
                }
            }
        }
        if p > 0.0 {
            let t = p / q;
            for level in 1..=n {
                for i in 0..=n - level {
                    c[i] = between(&c[i], &c[i + 1], t);
                }
            }
        }
        let [off, off_w] = self.off;
        let around = |x: f64, off: f64| Interval::new((x - off).next_down(), (x + off).next_up());
        let r = c.iter().map(|c| [around(c[0], off), around(c[1], off), around(c[2], off)]).collect();
        let w = if self.w.is_empty() { vec![] } else { c.iter().map(|c| around(c[3], off_w)).collect() };
        (r, w)
    }
}

/// The points themselves, if all weights are surely positive.
fn cartesian((r, w): &(Vec<Point>, Vec<Interval>)) -> Option<Vec<Point>> {
    if w.is_empty() {
        return Some(r.clone());
    }
    let fine = w.iter().all(|w| w.is_positive());
    fine.then(|| r.iter().zip(w).map(|(r, w)| r.map(|x| x / *w)).collect())
}

impl<'a> Rail<'a> {
    pub(crate) fn new(frame: &'a Frame) -> Self {
        let spans: Vec<Span> = frame.segments.iter().map(Span::new).collect();
        let origin = frame.origin.each_ref().map(|x| Interval::from_ratio(x.numer(), x.denom()));
        let bits = 64 - (2 * spans.len() as u64).leading_zeros() as i32;
        Self { frame, origin, spans, unit: 2_f64.powi(bits - 51) }
    }

    pub(crate) fn count(&self) -> f64 {
        self.spans.len() as f64
    }

    fn scale(&self) -> i32 {
        self.frame.scale.clamp(-5000, 5000) as i32
    }

    pub(crate) fn snapped(&self, position: f64) -> f64 {
        (position / self.unit).round() * self.unit
    }

    /// Every number that the printed vertex may be, in the box.
    pub(crate) fn vertex(&self, v: &[f64; 3]) -> Point {
        [0, 1, 2].map(|k| (Interval::new(v[k].next_down(), v[k].next_up()) - self.origin[k]).scale2(self.scale()))
    }

    /// The span of a position, or the one before if it is at its start and ends there, and the local parameter.
    fn local(&self, position: f64, ends: bool) -> (usize, f64) {
        let whole = if ends {
            (position.ceil() - 1.0).max(if self.frame.closed { f64::MIN } else { 0.0 })
        } else {
            position.floor()
        };
        let last = self.count() - 1.0;
        let whole = if self.frame.closed { whole } else { whole.clamp(0.0, last) };
        ((whole.rem_euclid(self.count())) as usize, position - whole)
    }

    /// A point of the spine in the curve's own coordinates, nearly.
    pub(crate) fn near(&self, position: f64) -> [f64; 3] {
        let at = self.enclosed(position);
        [0, 1, 2].map(|k| (Interval::point(at[k].mid()).scale2(-self.scale()) + self.origin[k]).mid())
    }

    /// A point of the spine in the box, nearly; beyond the ends of an open one its polynomials go on.
    pub(crate) fn place(&self, position: f64) -> [f64; 3] {
        self.jet(position)[0]
    }

    /// C, C' and C'' there, nearly.
    pub(crate) fn jet(&self, position: f64) -> [[f64; 3]; 3] {
        let (span, t) = self.local(position, false);
        let mut c = self.spans[span].near.clone();
        let n = c.len() - 1;
        let [mut first, mut second] = [[0.0; 4]; 2];
        for level in (1..=n).rev() {
            // of c there are level + 1
            if level == 2 {
                second = [0, 1, 2, 3].map(|k| (n * (n - 1)) as f64 * (c[2][k] - 2.0 * c[1][k] + c[0][k]));
            }
            if level == 1 {
                first = [0, 1, 2, 3].map(|k| n as f64 * (c[1][k] - c[0][k]));
            }
            for i in 0..level {
                c[i] = std::array::from_fn(|k| (1.0 - t) * c[i][k] + t * c[i + 1][k]);
            }
        }
        let w = c[0][3];
        let point = [0, 1, 2].map(|k| c[0][k] / w);
        let slope = [0, 1, 2].map(|k| (first[k] - first[3] * point[k]) / w);
        let bend = [0, 1, 2].map(|k| (second[k] - 2.0 * first[3] * slope[k] - second[3] * point[k]) / w);
        [point, slope, bend]
    }

    /// The step of the parameter that is so long at a position, nearly.
    pub(crate) fn step(&self, position: f64, length: f64) -> f64 {
        let [_, [x, y, z], _] = self.jet(position);
        (length / (x * x + y * y + z * z).sqrt()).min(1.0)
    }

    /// What a point of the box is in the curve's own coordinates.
    pub(crate) fn outside(&self, x: &Point) -> Point {
        [0, 1, 2].map(|k| x[k].scale2(-self.scale()) + self.origin[k])
    }

    /// The vertex that three exact numbers are, in the box.
    pub(crate) fn exact(&self, v: &[Rational; 3]) -> Point {
        let at = |k: usize| {
            let x = shifted(&(&v[k] - &self.frame.origin[k]), self.frame.scale);
            Interval::from_ratio(x.numer(), x.denom())
        };
        [at(0), at(1), at(2)]
    }

    /// The disk of a point is between two positions, if the spine between them is no farther from it than this.
    pub(crate) fn bracket(&self, x: &Point, from: f64, to: f64) -> Option<f64> {
        let cuts = self.cuts(from, to);
        if cuts.len() < 2 {
            return None;
        }
        let mut most = 0.0_f64;
        for (k, pair) in cuts.windows(2).enumerate() {
            let ((span, p), (_, q)) = (self.local(pair[0], false), self.local(pair[1], true));
            let points = cartesian(&self.spans[span].part(p, q))?;
            let n = points.len() - 1;
            most = points.iter().map(|point| square(&sub(point, x)).hi()).fold(most, f64::max);
            let behind = dot(&sub(x, &points[0]), &sub(&points[1], &points[0]));
            let ahead = dot(&sub(&points[n], x), &sub(&points[n], &points[n - 1]));
            if (k == 0 && !behind.is_positive()) || (k + 2 == cuts.len() && !ahead.is_positive()) {
                return None;
            }
        }
        Some(Interval::point(most).sqrt().hi())
    }

    /// The spine at a position, enclosed, in the box.
    pub(crate) fn enclosed(&self, position: f64) -> Point {
        let (span, t) = self.local(position, false);
        self.at(span, t)
    }

    fn at(&self, span: usize, t: f64) -> Point {
        let (r, w) = self.spans[span].part(0.0, t);
        let last = r.len() - 1;
        if w.is_empty() { r[last] } else { r[last].map(|x| x / w[last]) }
    }

    /// A position moved by a step of its own span; beyond a joint the step is about as long.
    pub(crate) fn moved(&self, position: f64, by: f64) -> f64 {
        let to = position + by;
        let (joint, beyond) = match by > 0.0 {
            true => (position.floor() + 1.0, position.floor() + 1.0 < to),
            false => (position.ceil() - 1.0, to < position.ceil() - 1.0),
        };
        // from the joint itself the step is in the next span
        let joint = if by < 0.0 && position == position.floor() { position } else { joint };
        let crosses = beyond || (by < 0.0 && position == joint);
        if !crosses {
            return self.snapped(to);
        }
        let k = |x: f64| x.rem_euclid(self.count()) as usize;
        let (here, there) = match by > 0.0 {
            true => (self.spans[k(joint - 1.0)].speed[1], self.spans[k(joint)].speed[0]),
            false => (self.spans[k(joint)].speed[0], self.spans[k(joint - 1.0)].speed[1]),
        };
        let ratio = (here / there).clamp(1e-6, 1e6);
        let rest = (to - joint) * if ratio.is_finite() { ratio } else { 1.0 };
        self.snapped(joint + rest.clamp(-0.5, 0.5))
    }

    /// The cuts of an arc: its ends, the joints inside, and the middles in between, as control points are farther off than halves.
    pub(crate) fn cuts(&self, from: f64, to: f64) -> Vec<f64> {
        let mut cuts = vec![from];
        let mut at = from;
        while at < to {
            let next = (at.floor() + 1.0).min(to);
            cuts.extend([self.snapped(at.midpoint(next)), next]);
            at = next;
        }
        cuts.dedup();
        cuts
    }

    /// Proves that an edge runs along the arc; the bound of its distance from it. `known`: the first, or the last, vertex is
    /// the end of the arc exactly.
    pub(crate) fn edge(&self, from: &Point, to: &Point, cuts: &[f64], known: [bool; 2]) -> Option<f64> {
        let d = sub(to, from);
        let length = square(&d);
        if !length.is_positive() || cuts.len() < 2 {
            return None;
        }
        let mut most = 0.0_f64;
        for (k, pair) in cuts.windows(2).enumerate() {
            let ((span, p), (_, q)) = (self.local(pair[0], false), self.local(pair[1], true));
            let part = self.spans[span].part(p, q);
            let points = cartesian(&part)?;
            if !forward(&part, &d) {
                return None;
            }
            for point in &points {
                most = most.max((square(&cross(&sub(point, from), &d)) / length).hi());
            }
            let n = points.len() - 1;
            let before =
                |a: &Point, b: &Point, t: &Point| dot(&sub(b, a), t).is_positive() && dot(&sub(b, a), &d).is_positive();
            if k == 0 && !known[0] && !before(&points[0], from, &sub(&points[1], &points[0])) {
                return None;
            }
            if k + 2 == cuts.len() && !known[1] && !before(to, &points[n], &sub(&points[n], &points[n - 1])) {
                return None;
            }
        }
        Some(Interval::point(most).sqrt().hi())
    }

    /// A place so little inside an end that its vertex, as printed, is not beyond the end; a place beyond its disk; and the
    /// distance of what is between the end and that place from the vertex, at most `limit`.
    fn inward(&self, at_start: bool, limit: f64) -> Option<(f64, f64, f64)> {
        let (count, mut by) = (self.count(), 16.0 * self.unit);
        while by < 0.01 {
            let [place, beyond] = [by, 2.0 * by].map(|by| if at_start { by } else { count - by });
            let vertex = self.vertex(&self.near(place));
            let range = if at_start { [0.0, beyond] } else { [beyond, count] };
            let (span, p) = self.local(if at_start { 0.0 } else { count - 0.5 }, false);
            let points = cartesian(&self.spans[span].part(p, p + 0.5))?;
            let n = points.len() - 1;
            let inside = match at_start {
                true => dot(&sub(&vertex, &points[0]), &sub(&points[1], &points[0])),
                false => dot(&sub(&points[n], &vertex), &sub(&points[n], &points[n - 1])),
            };
            let off = self.covered(&vertex, range, at_start).filter(|off| *off <= limit && inside.is_positive());
            if let Some(off) = off {
                return Some((place, beyond, off));
            }
            by *= 4.0;
        }
        None
    }

    /// The arc from one position to the other, one of them an end of the spine, is no farther from a vertex than this, whose
    /// disk lies on it.
    pub(crate) fn covered(&self, vertex: &Point, [from, to]: [f64; 2], at_start: bool) -> Option<f64> {
        let ((span, p), (_, q)) = (self.local(from, false), self.local(to, true));
        let points = cartesian(&self.spans[span].part(p, q))?;
        let n = points.len() - 1;
        let farther = match at_start {
            true => dot(&sub(&points[n], vertex), &sub(&points[n], &points[n - 1])),
            false => dot(&sub(vertex, &points[0]), &sub(&points[1], &points[0])),
        };
        let most = points.iter().map(|point| square(&sub(point, vertex)).hi()).fold(0.0, f64::max);
        farther.is_positive().then(|| Interval::point(most).sqrt().hi())
    }
}

/// Do the arcs of two edges that follow one another, round a closed spine, lie within one period?
pub(crate) fn together(edges: &[Vec<f64>], count: f64) -> bool {
    let spread = |a: &[f64], b: &[f64], more: f64| match (a, b) {
        ([a, .., b], [c, .., d]) => b.max(d + more) - a.min(c + more) < count,
        _ => false,
    };
    edges.windows(2).all(|pair| spread(&pair[0], &pair[1], 0.0)) && spread(&edges[edges.len() - 1], &edges[0], count)
}

/// The hodograph has a positive product with d all along.
fn forward((r, w): &(Vec<Point>, Vec<Interval>), d: &Point) -> bool {
    let heights: Vec<Interval> = r.iter().map(|r| dot(r, d)).collect();
    if w.is_empty() {
        return r.windows(2).all(|pair| dot(&sub(&pair[1], &pair[0]), d).is_positive());
    }
    let n = r.len() - 1;
    let (bn, bd) = (crate::bernstein::binomials(n), crate::bernstein::binomials(n - 1));
    let mut sums = vec![Interval::point(0.0); 2 * n];
    for i in 0..n {
        let (rise, more) = (heights[i + 1] - heights[i], w[i + 1] - w[i]);
        for j in 0..=n {
            let share = Interval::point(bd[i]) * Interval::point(bn[j]);
            sums[i + j] = sums[i + j] + share * (rise * w[j] - more * heights[j]);
        }
    }
    sums.iter().all(|sum| sum.is_positive())
}

/// Makes the polyline, no farther from the spine than `limit`, in the box. `exact` are the ends of an open spine, where three f64 are,
/// as printed, exactly that. `None` if the meter ran out, or an edge cannot be proved at any length.
pub(crate) fn course(rail: &Rail, limit: f64, exact: [Option<[f64; 3]>; 2], meter: &mut Meter) -> Option<Course> {
    let (count, closed) = (rail.count(), rail.frame.closed);
    let (mut start, mut finish, mut known, mut ends) = (0.0, count, [false; 2], None);
    let mut most = 0.0_f64;
    if !closed {
        let mut places = [0.0, count];
        for (k, place) in [&mut start, &mut finish].into_iter().enumerate() {
            known[k] = exact[k].is_some();
            if !known[k] {
                let (inside, beyond, off) = rail.inward(k == 0, limit)?;
                (*place, places[k], most) = (inside, beyond, most.max(off));
            }
        }
        ends = Some(places);
    }
    let mut course = Course {
        vertices: vec![exact[0].unwrap_or_else(|| rail.near(start))],
        positions: vec![start],
        edges: vec![],
        ends,
        stubs: None,
        distance: 0.0,
    };
    let first = rail.vertex(&course.vertices[0]);
    let held = |x: f64| if closed { x } else { x.clamp(0.0, count) };
    // round a closed spine in four edges at the least
    let longest = if closed { count / 4.0 } else { count };
    let (mut at, mut from, mut step) = (start, first, 0.25_f64.min(longest));
    while at < finish {
        let (mut tries, mut best) = (0, None);
        loop {
            tries += 1;
            if tries > TRIES || !meter.tick() {
                return None;
            }
            let left = finish - at;
            // the last two share what is left
            let to = if step >= left {
                finish
            } else if 2.0 * step > left {
                rail.snapped(at + 0.5 * left)
            } else {
                rail.snapped(at + step)
            };
            if to <= at {
                return None;
            }
            let ended = to >= finish;
            let place = match exact[1].filter(|_| ended) {
                Some(end) => end,
                None if ended && closed => course.vertices[0],
                None => rail.near(to),
            };
            let vertex = rail.vertex(&place);
            let (tried, length) = (to - at, square(&sub(&vertex, &from)).sqrt().mid());
            let exactly = [known[0] && course.edges.is_empty(), known[1] && ended];
            let low = if exactly[0] { 0.0 } else { held(rail.moved(at, -REACH * rail.step(at, length))) };
            let high = if exactly[1] { count } else { held(rail.moved(to, REACH * rail.step(to, length))) };
            let cuts = rail.cuts(low, high);
            let off = rail.edge(&from, &vertex, &cuts, exactly);
            let share = off.map(|off| 0.985 * (limit / off.max(1e-300)).sqrt());
            match off {
                Some(off) if off <= limit => {
                    step = (tried * share.unwrap_or(1.0).min(2.0)).min(longest);
                    best = Some((to, place, vertex, cuts, off));
                    if ended || off >= FULL * limit || tries > 6 || step <= tried * 1.01 {
                        break;
                    }
                }
                _ => {
                    if let Some((to, ..)) = &best {
                        step = to - at;
                        break;
                    }
                    step = tried * share.map_or(0.5, |share| share.clamp(0.1, 0.95));
                }
            }
        }
        let (to, place, vertex, cuts, off) = best?;
        most = most.max(off);
        course.edges.push(cuts);
        (at, from) = (to, vertex);
        if !(closed && at >= finish) {
            course.vertices.push(place);
            course.positions.push(to);
        }
    }
    course.distance = most;
    (!closed || together(&course.edges, count)).then_some(course)
}

/// The number of edges that the asymptotic law asks for: the integral of sqrt(kappa / (8 limit)) along the spine, by samples.
pub(crate) fn asymptotic(rail: &Rail, limit: f64) -> f64 {
    const SAMPLES: usize = 64;
    let mut sum = 0.0;
    for span in 0..rail.spans.len() {
        let h = 1.0 / SAMPLES as f64;
        let mid = |t: f64| rail.at(span, t).map(Interval::mid);
        let points: Vec<[f64; 3]> = (0..=2 * SAMPLES).map(|i| mid(0.5 * h * i as f64)).collect();
        for three in points.windows(3).step_by(2) {
            let [a, b, c] = [0, 1, 2].map(|i| three[i]);
            let (u, v) = ([0, 1, 2].map(|k| c[k] - a[k]), [0, 1, 2].map(|k| a[k] - 2.0 * b[k] + c[k]));
            let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            let size = |x: [f64; 3]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
            // the height of the triangle is kappa ds^2 / 8
            if size(u) > 0.0 {
                sum += (size(cross) / (2.0 * size(u)) / limit).sqrt();
            }
        }
    }
    sum
}

/// Edges of a uniform subdivision of each span, until the control polygons, whose distance falls by four with each halving, are
/// within `limit` of their chords: the a-priori number of the control-polygon argument.
pub(crate) fn of_control_polygons(rail: &Rail, limit: f64) -> f64 {
    const PARTS: i32 = 8;
    let of_span = |span: &Span| {
        let off = |k: i32| {
            let (p, q) = (f64::from(k) / f64::from(PARTS), f64::from(k + 1) / f64::from(PARTS));
            let points = cartesian(&span.part(p, q))?;
            let d = sub(&points[points.len() - 1], &points[0]);
            let far = points.iter().map(|point| (square(&cross(&sub(point, &points[0]), &d)) / square(&d)).mid());
            Some(far.fold(0.0, f64::max).sqrt())
        };
        let worst = (0..PARTS).map(|k| off(k).unwrap_or(0.0)).fold(0.0, f64::max);
        let halvings = (0.5 * (worst / limit).log2()).ceil().max(-f64::from(PARTS).log2());
        f64::from(PARTS) * halvings.exp2()
    };
    rail.spans.iter().map(of_span).sum()
}

/// A position in lowest terms.
pub(crate) fn rational(position: f64) -> Rational {
    crate::number::rational_from_f64(position).unwrap_or_default()
}
