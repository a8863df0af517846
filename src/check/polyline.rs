//! The claim about a polyline: docs/certificate-format.md, section 10. Each edge runs along an arc of the spine: it never turns
//! back against a tangent of it, it is nowhere farther than `distance` from it, and the arc reaches beyond its disks.

use std::rc::Rc;

use num_bigint::{BigInt, Sign};
use num_traits::{Signed, ToPrimitive, Zero};

use super::arc::{DEPTH, Piece, Spine};
use super::poly::{Poly, dot};
use super::range::Range;
use super::rules::{Why, check};
use super::upper::place;
use super::{Rejection, radius, wanted};
use crate::certificate::polyline::Evidence;
use crate::claim::Polyline;
use crate::number::{Rational, compare};

type Vector = [BigInt; 3];

/// Whether the evidence proves the claim.
pub(super) fn verify(spine: &Spine, claim: &Polyline, found: &Evidence) -> Result<(), Rejection> {
    let (Polyline { vertices, closed, distance }, Evidence { ends, stubs, edges, tube, .. }) = (claim, found);
    let mut numbers = vertices.iter().flatten().chain([distance]);
    wanted(numbers.all(|x| x.denom().is_positive()), "vertex", "a number has no positive denominator")?;
    wanted(!distance.is_negative(), "distance", "it is negative")?;
    wanted(*closed == spine.closed, "vertex", "of the spine and the polyline one is closed, the other is not")?;
    wanted(!spine.closed || stubs.is_none(), "stubs", "the spine is closed")?;
    let prolonged = stubs.as_ref().map(|stubs| prolonged(spine, stubs)).transpose();
    let prolonged = prolonged.map_err(|why| Rejection::of("stubs", why))?;
    let spine = prolonged.as_ref().unwrap_or(spine);
    let inside = tube.lo.as_ref().is_none_or(|lo| lo.denom().is_positive() && compare(distance, lo).is_lt());
    wanted(inside, "distance", "it is not less than the radius of the tube")?;
    radius::verify(spine, [&tube.lo, &tube.hi], tube)?;

    let count = vertices.len() - usize::from(!spine.closed && !vertices.is_empty());
    wanted(edges.len() == count && count > 0, "edge", "there must be an arc for each edge")?;
    wanted(ends.is_some() != spine.closed, "ends", "an open spine, and no other, has ends")?;
    let short = edges.iter().flatten().chain(ends.iter().flatten()).all(|x| Range::point(x).is_short());
    wanted(short, "edge", "a position is too long")?;
    let points: Vec<Point> = vertices.iter().map(Point::of).collect();
    let around = points.iter().cycle().skip(1);
    for (number, ((edge, from), to)) in edges.iter().zip(&points).zip(around).enumerate() {
        let last = !spine.closed && number + 1 == count;
        let ran = Run { spine, from, to, distance }.along(edge, [!spine.closed && number == 0, last]);
        ran.map_err(|why| Rejection::of("edge", why).at(number + 1, &"edge"))?;
    }
    // a vertex is in one disk: its parameter is the same for both of its edges, not a turn more
    let (zero, turn) = (Rational::zero(), Rational::from(BigInt::from(spine.spans.len())));
    for (number, (before, after)) in edges.iter().zip(edges.iter().cycle().skip(1)).enumerate().filter(|_| spine.closed)
    {
        let more = if number + 1 == count { &turn } else { &zero };
        let lows = before.first().into_iter().chain(after.first()).zip([&zero, more]);
        let highs = before.last().into_iter().chain(after.last()).zip([&zero, more]);
        let spread = highs.map(|(x, y)| x + y).max().zip(lows.map(|(x, y)| x + y).min());
        let less = spread.is_some_and(|(high, low)| compare(&(high - low), &turn).is_lt());
        let joined = check(less, "the arcs of two edges go round");
        joined.map_err(|why| Rejection::of("edge", why).at(number + 1, &"edge"))?;
    }
    if let (Some([start, finish]), [first, .., last]) = (ends, points.as_slice()) {
        let begins = edges.first().and_then(|edge| edge.first()).is_some_and(|from| compare(from, start).is_le());
        let ends = edges.last().and_then(|edge| edge.last()).is_some_and(|to| compare(finish, to).is_le());
        wanted(begins && ends, "ends", "a position is not on the arc of an edge")?;
        // a stub, and with it the end of the spine, is near the vertex, whose edge leaves the stub
        let second = edges.get(1).and_then(|edge| edge.first()).unwrap_or(finish);
        let before_last = edges.iter().nth_back(1).and_then(|edge| edge.last()).unwrap_or(start);
        let [before, after] = stubs.as_ref().map_or([false; 2], |stubs| stubs.each_ref().map(|u| !u.is_zero()));
        let one = Rational::from(BigInt::from(1));
        let leaves = !before || [start, second].iter().all(|x| compare(x, &one).is_ge());
        let enters = !after || [finish, before_last].iter().all(|x| compare(x, &(&turn - &one)).is_le());
        wanted(leaves && enters, "ends", "a stub is not covered")?;
        let at_start = covered(spine, first, start, [&zero, start], distance, Sign::Minus);
        let both = at_start.and_then(|()| covered(spine, last, finish, [finish, &turn], distance, Sign::Plus));
        both.map_err(|why| Rejection::of("ends", why))?;
    }
    Ok(())
}

/// An open spine with straight pieces before and after it, so long in terms of the control legs there; 0: none.
fn prolonged(spine: &Spine, [before, after]: &[Rational; 2]) -> Result<Spine, Why> {
    let (first, last) = spine.spans.first().zip(spine.spans.last()).ok_or("there is no span")?;
    let stub = |piece: &Piece, u: &Rational, at_start: bool| {
        let (short, w) = (Range::point(u).is_short() && !u.is_negative(), piece.full_weight());
        check(short && w.is_positive(), "a length is negative or too long, or a control weight not positive")?;
        let leg = |f: &Poly| {
            let ends = if at_start { (f.0.first(), f.0.get(1)) } else { (f.0.last(), f.0.iter().nth_back(1)) };
            Ok::<_, Why>((ends.0.cloned().ok_or("there is no leg")?, ends.1.cloned().ok_or("there is no leg")?))
        };
        let (v, w) = leg(&w)?;
        // C - u (P - C) with C = r/v and P = s/w, times v w and the denominator of u
        let (p, q) = (u.numer(), u.denom());
        let [x, y, z] = piece.r.each_ref().map(|f| {
            let (r, s) = leg(f)?;
            let (near, far) = (&r * &w * q, &r * &w * (q + p) - p * s * &v);
            Ok::<_, Why>(Poly(if at_start { vec![far, near] } else { vec![near, far] }))
        });
        Ok::<_, Why>((!u.is_zero()).then_some(([x?, y?, z?], Poly::constant(v * w * q))))
    };
    let (start, finish) = (stub(first, before, true)?, stub(last, after, false)?);
    let body = spine.spans.iter().map(|piece| (piece.r.clone(), piece.w.clone()));
    let all = start.into_iter().chain(body).chain(finish).enumerate();
    let place = |k: usize| BigInt::from(k) << DEPTH;
    Ok(Spine::open(all.map(|(k, (r, w))| Piece::new(place(k), place(k + 1), r, w)).collect()))
}

/// A point, times q.
struct Point {
    x: Vector,
    q: BigInt,
}

impl Point {
    fn of([x, y, z]: &[Rational; 3]) -> Self {
        let q = x.denom() * y.denom() * z.denom();
        Self { x: [x, y, z].map(|c| c.numer() * (&q / c.denom())), q }
    }

    /// A positive multiple of the vector to another point.
    fn to(&self, other: &Self) -> Vector {
        let [a, b, c] = &self.x;
        let [d, e, f] = &other.x;
        [(a, d), (b, e), (c, f)].map(|(from, to)| to * &self.q - from * &other.q)
    }

    /// r - w times this, times q.
    fn away(&self, piece: &Piece, w: &Poly) -> [Poly; 3] {
        let ([x, y, z], [u, v, t]) = (&piece.r, &self.x);
        [(x, u), (y, v), (z, t)].map(|(r, p)| r.scaled(&self.q).minus(w.scaled(p)))
    }
}

fn inner(a: &Vector, b: &Vector) -> BigInt {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The coefficients of a vector one after the other.
fn coefficients([x, y, z]: &[Poly; 3]) -> impl Iterator<Item = Vector> {
    x.0.iter().zip(&y.0).zip(&z.0).map(|((x, y), z)| [x.clone(), y.clone(), z.clone()])
}

/// The part of the spine between two positions of one span.
fn part(spine: &Spine, from: &Rational, to: &Rational) -> Result<Rc<Piece>, Why> {
    let count = BigInt::from(spine.spans.len());
    let whole = from.floor();
    check(compare(from, to).is_le() && compare(to, &(&whole + BigInt::from(1))).is_le(), "a part is not in one span")?;
    let turn = if spine.closed { (&whole / &count).floor() } else { Rational::zero() };
    let span = (&whole - turn * &count).to_integer().to_usize();
    let span = span.and_then(|span| spine.spans.get(span)).ok_or("there is no such span")?;
    let piece = span.part(&(from - &whole), &(to - &whole));
    check(piece.w.is_positive(), "a control weight is not positive").map(|()| piece)
}

/// One edge, and how far it may be.
struct Run<'a> {
    spine: &'a Spine,
    from: &'a Point,
    to: &'a Point,
    distance: &'a Rational,
}

impl Run<'_> {
    fn along(&self, cuts: &[Rational], [first, last]: [bool; 2]) -> Result<(), Why> {
        let d = self.from.to(self.to);
        let [x, y, z] = &d;
        let far = self.distance.denom().pow(2);
        let near = self.distance.numer().pow(2) * inner(&d, &d) * self.from.q.pow(2);
        let (mut start, mut finish) = (None, None);
        for (from, to) in cuts.iter().zip(cuts.iter().skip(1)) {
            let piece = part(self.spine, from, to)?;
            let forward = dot(piece.a(), &d.each_ref().map(|c| Poly::constant(c.clone())));
            check(forward.is_positive(), "it may turn back against a tangent")?;
            let w = piece.full_weight();
            for (p, w) in coefficients(&self.from.away(&piece, &w)).zip(&w.0) {
                let [u, v, t] = p;
                let across = [&v * z - &t * y, &t * x - &u * z, &u * y - &v * x];
                check(inner(&across, &across) * &far <= &near * w.pow(2), "it may be farther from the arc")?;
            }
            start.get_or_insert(piece.clone());
            finish = Some(piece);
        }
        let (start, finish) = start.zip(finish).ok_or("there is no arc")?;
        // the arc starts before the disk of the first point and ends beyond that of the last
        let end = |piece: &Piece, t: i32, vertex: &Point, sign: i32, on_end: bool| {
            let place = piece.at(&BigInt::from(t).into());
            let away = vertex.away(&place, &place.w);
            let along = |v: &[Poly; 3]| dot(&away, v).scaled(&sign.into());
            let edge = d.each_ref().map(|c| Poly::constant(c.clone()));
            let (of_tangent, of_edge) = (along(place.a()), along(&edge));
            let beyond = of_tangent.is_positive() || (on_end && of_tangent.is_zero());
            check(beyond && (of_edge.is_positive() || of_edge.is_zero()), "the arc does not reach beyond it")
        };
        let zero = cuts.first().is_some_and(Zero::is_zero);
        let whole = cuts.last().is_some_and(|x| compare(x, &BigInt::from(self.spine.spans.len()).into()).is_eq());
        end(&start, 0, self.from, -1, first && zero)?;
        end(&finish, 1, self.to, 1, last && whole)
    }
}

/// The spine between `position` and an end is near the vertex, whose disk is there.
fn covered(
    spine: &Spine,
    vertex: &Point,
    position: &Rational,
    [from, to]: [&Rational; 2],
    distance: &Rational,
    farther: Sign,
) -> Result<(), Why> {
    let place = place(spine, position)?;
    let piece = if compare(from, to).is_eq() { place.clone() } else { part(spine, from, to)? };
    let (near, far) = ((distance.numer() * &vertex.q).pow(2), distance.denom().pow(2));
    let w = piece.full_weight();
    for (p, w) in coefficients(&vertex.away(&piece, &w)).zip(&w.0) {
        check(inner(&p, &p) * &far <= &near * w.pow(2), "the spine beyond a vertex is far from it")?;
    }
    let along = dot(&vertex.away(&place, &place.w), place.a());
    check(!along.has_sign(farther), "the disk of a vertex may lie farther in")
}
