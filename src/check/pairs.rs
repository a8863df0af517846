//! The claim about all stationary pairs: docs/certificate-format.md, section 7. F = (D.a(s), D.a(t)) has one zero in each box
//! and none elsewhere. Boxes are in positions; those of an open spine may reach beyond its ends, where its polynomials go on.

use std::rc::Rc;

use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::{One, Signed, ToPrimitive, Zero};

use super::arc::{Arc, DEPTH, Piece, Spine};
use super::field::{Field, Net};
use super::poly::{Poly, dot, paired};
use super::range::Range;
use super::rules::{Why, check, side};
use super::upper::place;
use super::{Rejection, walk, wanted};
use crate::certificate::{Node, pairs::Evidence};
use crate::claim::{PairBox, Pairs};
use crate::curve::Curve;
use crate::number::{Rational, compare};

type Square = [Range; 2];

/// Whether the evidence proves what is claimed.
pub(super) fn verify(spine: &Spine, curve: &Curve, claim: &Pairs, evidence: &Evidence) -> Result<(), Rejection> {
    let wrong = |number, why| Rejection::of("claim", why).at(number, &"pair");
    let of_box = |c: &'_ PairBox| {
        c.s.iter().chain(&c.t).chain([&c.distance.0]).chain(&c.distance.1).all(|x| x.denom().is_positive())
    };
    let numbers = claim.pairs.iter().chain(&claim.undecided).all(of_box);
    wanted(numbers, "claim", "a number has no positive denominator")?;
    walk::along(spine, &Rational::zero(), &evidence.along)?;
    let line = Line::of(spine, curve);
    let (mut boxes, mut on_spine) = (vec![], vec![]);
    for (isolated, number) in evidence.isolated.iter().zip(1..) {
        let squares = [&isolated.outer, &isolated.inner].map(|square| square.each_ref().map(Range::of));
        let on = alone(&line, &squares).and_then(|()| line.holds(&squares[1]));
        if on.map_err(|why| Rejection::of("alone", why).at(number, &"box"))? {
            on_spine.push(squares.clone());
        }
        boxes.push(squares);
    }
    for (number, ([outer, inner], claimed)) in on_spine.iter().zip(&claim.pairs).enumerate() {
        let others = on_spine.iter().skip(number + 1);
        let distinct = others.into_iter().all(|[_, other]| !line.some(inner, other, |a, b| a.meets(b)));
        let place = line.square(claimed);
        let fits = line.some(inner, &place, Range::is_inside) && line.some(&place, outer, Range::is_inside);
        let told = check(distinct, "two boxes may hold the same pair").and_then(|()| {
            check(fits, "the place claimed is not around the pair, or not in the box where it is alone")
        });
        let (lo, hi) = &claimed.distance;
        let zero = !lo.is_positive() && hi.as_ref().is_some_and(Zero::is_zero);
        let touching = |why| if zero { touches(&line, inner) } else { Err(why) };
        told.and_then(|()| line.distance(inner, claimed).or_else(touching)).map_err(|why| wrong(number + 1, why))?;
    }
    wanted(on_spine.len() == claim.pairs.len(), "claim", "the pairs claimed are not as many as those proved")?;
    let undecided: Vec<_> = claim.undecided.iter().map(|claimed| (line.square(claimed), claimed)).collect();
    walk::pairs(spine, "tree", &evidence.tree, |node, a, b| {
        let cell = [positions(a).ok_or("the arc is empty")?, positions(b).ok_or("the arc is empty")?];
        let inside = |square: &Square| line.some(&cell, square, Range::is_inside);
        match node {
            Node::Side(fields) => side(walk::one(a)?, walk::one(b)?, *fields),
            Node::Pair(k) => check(boxes.get(*k).is_some_and(|[outer, _]| inside(outer)), "the cell is not in the box"),
            Node::Open => {
                let unknown = |(lo, hi): &(Rational, Option<Rational>)| lo.is_zero() && hi.is_none();
                let told = |(place, claimed): &(Square, &PairBox)| {
                    inside(place) && (unknown(&claimed.distance) || line.distance(&cell, claimed).is_ok())
                };
                check(undecided.iter().any(told), "the cell is not in what is called undecided")
            }
            _ => Err(walk::MISPLACED),
        }
    })
}

fn positions(arc: &Arc) -> Option<Range> {
    let at = |place: &BigInt| Rational::new(place.clone(), BigInt::one() << DEPTH);
    Some(Range { lo: at(&arc.first()?.from), hi: at(&arc.last()?.to) })
}

/// The spine as a line of positions.
struct Line<'a> {
    spine: &'a Spine,
    knots: Vec<Rational>,
    count: Rational,
}

/// A piece, its length in positions, and the factors of (r, w) and of a by which they are continuous from part to part.
struct Part {
    piece: Rc<Piece>,
    size: Range,
    point: Rational,
    tangent: Rational,
}

impl<'a> Line<'a> {
    fn of(spine: &'a Spine, curve: &Curve) -> Self {
        Self { spine, knots: Spine::knots(curve), count: BigInt::from(spine.spans.len()).into() }
    }

    /// Whether something is true of the ranges of two squares, the second one swapped or not and moved by whole turns or not.
    fn some(&self, [s, t]: &Square, [u, v]: &Square, is: fn(&Range, &Range) -> bool) -> bool {
        let of = |a: &Range, b: &Range| {
            // the last turn after which b does not start after a, and the next: no other can make the two meet
            let turn = if self.spine.closed { ((&a.lo - &b.lo) / &self.count).floor() } else { Rational::zero() };
            let moved = |turn: &Rational| b + &Range::point(&(&self.count * turn));
            is(a, &moved(&turn)) || (self.spine.closed && is(a, &moved(&(&turn + BigInt::one()))))
        };
        (of(s, u) && of(t, v)) || (of(s, v) && of(t, u))
    }

    fn square(&self, claimed: &PairBox) -> Square {
        [&claimed.s, &claimed.t].map(|[from, to]| Range { lo: self.position(from), hi: self.position(to) })
    }

    /// Span + local parameter. A closed spine goes round, else the first span and the last go on.
    fn position(&self, t: &Rational) -> Rational {
        let ([start, .., end], last) = (self.knots.as_slice(), self.knots.len().saturating_sub(2)) else {
            return t.clone();
        };
        let period = end - start;
        let turn = if self.spine.closed { ((t - start) / &period).floor() } else { Rational::zero() };
        let local = t - &turn * period;
        let span = self.knots.partition_point(|knot| compare(knot, &local).is_le()).saturating_sub(1).min(last);
        let around = self.knots.get(span).zip(self.knots.get(span + 1));
        around.map_or(turn.clone(), |(from, to)| (local - from) / (to - from)) + BigInt::from(span) + turn * &self.count
    }

    /// A joint with two tangents.
    fn is_corner(&self, position: &Rational) -> bool {
        let k = position.to_integer().mod_floor(self.count.numer()).to_usize().unwrap_or_default();
        position.is_integer() && k > 0 && !self.spine.is_smooth(k)
    }

    /// Whether a square is on the spine; if not it must be beyond an end. The pair is strictly inside, or all of it.
    fn holds(&self, square: &Square) -> Result<bool, Why> {
        let whole = Range { lo: Rational::zero(), hi: self.count.clone() };
        let on = self.spine.closed || square.iter().all(|range| range.is_inside(&whole));
        let beyond = |range: &Range| !range.hi.is_positive() || compare(&range.lo, &self.count).is_ge();
        check(on || square.iter().any(beyond), "the pair may be on the spine or beyond its end").map(|()| on)
    }

    fn parts(&self, range: &Range) -> Result<Vec<Part>, Why> {
        let size = &range.hi - &range.lo;
        check(!size.is_negative() && compare(&size, &BigInt::from(1).into()).is_le(), "a range is longer than a span")?;
        let whole =
            |x: Rational| if self.spine.closed { x } else { x.max(Rational::zero()).min(&self.count - BigInt::one()) };
        let first = whole(range.lo.floor()).to_integer();
        let last = whole(range.hi.ceil() - BigInt::one()).to_integer().max(first.clone());
        let mut parts: Vec<Part> = vec![];
        let mut k = first.clone();
        while k <= last {
            let index = k.mod_floor(self.count.numer()).to_usize().unwrap_or_default();
            let from = if k == first { &range.lo - &k } else { Rational::zero() };
            let to = if k == last { &range.hi - &k } else { Rational::one() };
            let piece = self.spine.spans.get(index).ok_or("there is no such span")?.part(&from, &to);
            let (mut point, mut tangent) = (Rational::one(), Rational::one());
            if let Some(before) = parts.last() {
                check(self.spine.is_smooth(index), "a box steps over a corner")?;
                let (one, zero) = (Rational::one(), Rational::zero());
                let (p, q) = (before.piece.at(&one), piece.at(&zero));
                point = &before.point * ratio(&before.piece.w.at(&one), &piece.w.at(&zero))?;
                tangent = &before.tangent * ratio(&dot(p.a(), p.a()), &dot(p.a(), q.a()))?;
            }
            parts.push(Part { piece, size: Range::point(&(to - from)), point, tangent });
            k += 1;
        }
        Ok(parts)
    }

    /// Checks what is claimed of |C(s) - C(t)| on a square.
    fn distance(&self, [s, t]: &Square, PairBox { distance: (lo, hi), .. }: &PairBox) -> Result<(), Why> {
        let ys = self.parts(t)?;
        for (x, y) in self.parts(s)?.iter().flat_map(|x| ys.iter().map(move |y| (x, y))) {
            let (p, q) = (x.piece.products(), y.piece.products());
            // |D|^2 minus a squared bound times w^2 w^2
            let over = |bound: &Rational| {
                let (num, den) = (bound.numer().pow(2), bound.denom().pow(2));
                let ends = [p.rr.scaled(&den), p.ww.scaled(&den), p.ww.scaled(&-num)];
                let mixed = paired(p.rw.each_ref().map(|f| f.scaled(&(&den * -2))).each_ref(), q.rw.each_ref());
                paired(ends.each_ref(), [&q.ww, &q.rr, &q.ww]).plus(mixed).flat()
            };
            let less = |lo: &Rational| lo.is_positive() && over(lo).0.iter().any(Signed::is_negative);
            check(!less(lo), "a distance is less than claimed")?;
            let more = |hi: &Rational| hi.is_negative() || over(hi).0.iter().any(Signed::is_positive);
            check(!hi.as_ref().is_some_and(more), "a distance is more than claimed")?;
        }
        Ok(())
    }
}

/// The quotient of two constants.
fn ratio(num: &Poly, den: &Poly) -> Result<Rational, Why> {
    match (num.0.as_slice(), den.0.as_slice()) {
        ([num], [den]) if !den.is_zero() => Ok(Rational::new(num.clone(), den.clone())),
        _ => Err("a piece has no weight or no tangent at a joint"),
    }
}

/// Two forms on a square, given those of two pieces with the factors that make them continuous.
fn field(line: &Line, [s, t]: &Square, forms: impl Fn(&Part, &Part) -> [Net; 2]) -> Result<Field, Why> {
    check(!s.is_point() && !t.is_point(), "a side of a box is a point")?;
    let (xs, ys) = (line.parts(s)?, line.parts(t)?);
    let all = xs.iter().flat_map(|x| ys.iter().map(move |y| (x, y)));
    let length = |parts: &[Part]| Range::point(&parts.iter().map(|part| &part.size.lo).sum());
    let parts = all.map(|(x, y)| (forms(x, y), [x.size.clone(), y.size.clone()]));
    Field::of(parts, [length(&xs), length(&ys)]).ok_or("the derivatives have no inverse")
}

/// D.a(s) and -D.a(t).
fn tilts(x: &Part, y: &Part) -> [Net; 2] {
    let (p, q, both) = (&x.piece, &y.piece, &x.point * &y.point);
    let of_s = Net::of(paired(p.products().tilt.each_ref(), q.point()), &both * &x.tangent);
    [of_s, Net::of(paired(p.point(), q.products().tilt.each_ref()), both * &y.tangent)]
}

/// D, one coordinate being constant along the spine, vanishes in a square, so it does at the pair that is alone there.
fn touches(line: &Line, square: &Square) -> Result<(), Why> {
    let first = line.spine.spans.first().ok_or("there is no span")?.at(&Rational::zero());
    let flat =
        |k: &usize| line.spine.spans.iter().all(|span| span.away_from(&first).get(*k).is_some_and(Poly::is_zero));
    let level = (0..3).find(flat).ok_or("no coordinate is constant")?;
    let (i, j) = ((level + 1) % 3, (level + 2) % 3);
    let gap = |k: usize, x: &Part, y: &Part| {
        let (p, q) = (&x.piece, &y.piece);
        let [r, u] = [&p.r, &q.r].map(|r| r.get(k).cloned().unwrap_or_default());
        Net::of(paired([&r, &p.w.scaled(&BigInt::from(-1))], [&q.w, &u]), &x.point * &y.point)
    };
    let field = field(line, square, |x, y| [gap(i, x, y), gap(j, x, y)])?;
    check(field.vanishes(), "the spine may not touch itself there")
}

/// F has one zero in the inner square, no other in the outer one, and s is never t there.
fn alone(line: &Line, [outer, inner]: &[Square; 2]) -> Result<(), Why> {
    check(outer.iter().chain(inner).all(Range::is_short), "a position is too long")?;
    let [s, t] = outer;
    let (low, high) = if compare(&s.lo, &t.lo).is_lt() { (s, t) } else { (t, s) };
    let around = &low.lo + &line.count;
    let apart = compare(&low.hi, &high.lo).is_lt() && (!line.spine.closed || compare(&high.hi, &around).is_lt());
    check(apart, "the two sides of a box meet")?;
    check(inner[0].is_inside(s) && inner[1].is_inside(t), "a pair is not in its box")?;
    check(field(line, outer, tilts)?.once(), "the box may hold several pairs")?;
    if inner.iter().all(Range::is_point) {
        check(!inner.iter().any(|at| line.is_corner(&at.lo)), "the pair is at a corner")?;
        let (p, q) = (place(line.spine, &inner[0].lo)?, place(line.spine, &inner[1].lo)?);
        let d = p.away_from(&q);
        return check(dot(&d, p.a()).is_zero() && dot(&d, q.a()).is_zero(), "the pair is not stationary");
    }
    check(field(line, inner, tilts)?.vanishes(), "the box may hold no pair")
}
