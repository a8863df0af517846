//! The witness of hi: docs/certificate-format.md, section 6.

use std::rc::Rc;

use num_bigint::{BigInt, Sign};
use num_traits::{One, ToPrimitive, Zero};

use super::arc::{Arc, Piece, Spine};
use super::poly::{Poly, cross, dot};
use super::rules::{Why, check, curvature};
use crate::certificate::{Foot, Upper};
use crate::number::{Rational, compare};

const NO_SPAN: Why = "there is no such span";

/// `upper` proves that delta is at most `hi`.
pub(super) fn upper(spine: &Spine, upper: &Upper, hi: Option<&Rational>) -> Result<(), Why> {
    let Some(hi) = hi else {
        return check(*upper == Upper::None, "hi is inf and has a witness");
    };
    match upper {
        Upper::None => Err("hi has no witness"),
        Upper::Curvature { span, t } => {
            let piece = spine.spans.get(*span).ok_or(NO_SPAN)?;
            check(within(t, &Rational::zero(), &Rational::one()), "t is not in 0 .. 1")?;
            check(piece.wb().iter().any(|b| !b.at(t).is_zero()), "b is 0 there")?;
            check(!curvature(piece, &(hi * hi)).at(t).is_positive(), "the curvature there is less than 1/hi")
        }
        Upper::Corner(joint) => {
            let [one_point, one_direction] = spine.joint(*joint).ok_or("there is no such joint")?;
            check(one_point, "the ends are two points")?;
            check(!one_direction, "the joint is smooth")
        }
        Upper::Contact { x, feet } => contact(spine, &integers(x), feet, &(hi * hi)),
        Upper::Crossing { arcs, normal, first, second } => {
            crossing(&strands(spine, arcs)?, [normal, first, second].map(integers))
        }
        Upper::Mirror { arcs, normal } => mirror(&strands(spine, arcs)?, &integers(normal)),
    }
}

fn within(x: &Rational, from: &Rational, to: &Rational) -> bool {
    compare(from, x).is_le() && compare(x, to).is_le()
}

/// A point as a piece of the degree 0.
fn integers([x, y, z]: &[Rational; 3]) -> Rc<Piece> {
    let common = x.denom() * y.denom() * z.denom();
    let r = [x, y, z].map(|c| Poly::constant(c.numer() * (&common / c.denom())));
    Piece::new(BigInt::zero(), BigInt::zero(), r, Poly::constant(common))
}

/// Two stretches of the spine, given by their positions, have no point in common.
fn apart(spine: &Spine, [first, last]: [&Rational; 2], [next, end]: [&Rational; 2]) -> Result<(), Why> {
    let around = first + BigInt::from(spine.spans.len());
    let apart = compare(last, next).is_lt() && (!spine.closed || compare(end, &around).is_lt());
    check(apart, "the two are not apart on the spine")
}

pub(super) fn place(spine: &Spine, position: &Rational) -> Result<Rc<Piece>, Why> {
    let count = BigInt::from(spine.spans.len());
    let [from, to] = if spine.closed { [-1, 2] } else { [0, 1] }.map(|turns| Rational::from(&count * turns));
    check(within(position, &from, &to), "a position is out of range")?;
    let turn = (position / &count).floor() * &count;
    let position = if spine.closed { position - turn } else { position.clone() };
    let span = position.to_integer().min(count - 1);
    let piece = usize::try_from(&span).ok().and_then(|span| spine.spans.get(span)).ok_or(NO_SPAN)?;
    Ok(piece.at(&(position - span)))
}

fn contact(spine: &Spine, x: &Piece, feet: &[Foot; 2], hi_squared: &Rational) -> Result<(), Why> {
    // |x - C|^2 at a position as numerator and denominator, and a multiple of a.(x - C)
    let distance = |position| {
        let place = place(spine, position)?;
        let (away, den) = (x.away_from(&place), x.w.times(&place.w));
        Ok::<_, Why>((dot(&away, &away), den.times(&den), dot(place.a(), &away)))
    };
    let positions = feet.each_ref().map(|foot| match foot {
        Foot::Plane(position) => [position; 3],
        Foot::Valley(positions) => positions.each_ref(),
    });
    for (foot, [from, position, to]) in feet.iter().zip(positions) {
        let (num, den, along) = distance(position)?;
        if matches!(foot, Foot::Valley(_)) {
            let ordered = compare(from, position).is_lt() && compare(position, to).is_lt();
            let once = compare(&(to - from), &BigInt::from(spine.spans.len()).into()).is_lt();
            check(ordered && once, "the positions of a valley are not in order")?;
            for end in [from, to] {
                let (far, unit, _) = distance(end)?;
                check(far.times(&den).minus(num.times(&unit)).is_positive(), "an end of a valley is not farther")?;
            }
        } else {
            check(along.is_zero(), "the point is not in the plane")?;
        }
        let beyond = num.scaled(hi_squared.denom()).minus(den.scaled(hi_squared.numer())).is_positive();
        check(!beyond, "the point is farther than hi from the spine there")?;
    }
    let [[first, _, last], [next, _, end]] = positions;
    apart(spine, [first, last], [next, end])
}

fn ordered([from, to]: &[Rational; 2]) -> [&Rational; 2] {
    if compare(from, to).is_gt() { [to, from] } else { [from, to] }
}

/// Two stretches of the spine that are apart, from one position to another, in pieces of which all weights are > 0.
fn strands(spine: &Spine, [s, t]: &[[Rational; 2]; 2]) -> Result<[Arc; 2], Why> {
    apart(spine, ordered(s), ordered(t))?;
    let strand = |arc: &[Rational; 2]| {
        let ([low, high], [from, _]) = (ordered(arc), arc);
        let back = compare(low, from).is_lt();
        let turns = BigInt::from(spine.spans.len() * if spine.closed { 2 } else { 1 });
        check(within(low, &Rational::zero(), high) && within(high, low, &turns.into()), "a position is out of range")?;
        let whole = |x: Rational| x.to_integer().to_usize().ok_or(NO_SPAN);
        let (first, end) = (whole(low.floor())?, whole(high.ceil())?);
        let part = |k: usize| {
            let from = if k == first { low - BigInt::from(k) } else { Rational::zero() };
            let to = if k + 1 == end { high - BigInt::from(k) } else { Rational::one() };
            let span = spine.spans.get(if spine.closed { k % spine.spans.len() } else { k }).ok_or(NO_SPAN)?;
            let part = if back { span.part(&to, &from) } else { span.part(&from, &to) };
            check(part.w.is_positive(), "a control weight is not positive").map(|()| part)
        };
        let parts = (first..end).map(part).collect::<Result<Vec<_>, Why>>()?;
        Ok::<Arc, Why>(if back { parts.into_iter().rev().collect() } else { parts.into() })
    };
    Ok([strand(s)?, strand(t)?])
}

fn change_sides([start, end]: [&Poly; 2]) -> bool {
    let signs = |a, b| start.has_sign(a) && end.has_sign(b);
    signs(Sign::Plus, Sign::Minus) || signs(Sign::Minus, Sign::Plus)
}

/// D of equal parameters keeps to the normal and changes sides, so it is 0 for some.
fn mirror(arcs: &[Arc; 2], normal: &Piece) -> Result<(), Why> {
    let [[a], [b]] = arcs.each_ref().map(|arc| &**arc) else { return Err("the arc is more than one piece") };
    let d = a.away_from(b);
    check(cross(&d, &normal.r).iter().all(Poly::is_zero), "the points of equal parameters are not along the normal")?;
    let side = dot(&d, &normal.r);
    check(change_sides([&side.at(&Rational::zero()), &side.at(&Rational::one())]), "the arcs do not change sides")
}

fn crossing([a, b]: &[Arc; 2], vectors: [Rc<Piece>; 3]) -> Result<(), Why> {
    let [normal, first, second] = vectors.each_ref().map(|v| &v.r);
    check(!dot(normal, &cross(first, second)).is_zero(), "the determinant is 0")?;
    let ends = |arc: &Arc| Some([arc.first()?.at(&Rational::zero()), arc.last()?.at(&Rational::one())]);
    let (of_a, of_b) = ends(a).zip(ends(b)).ok_or("an arc is empty")?;
    let [base, _] = &of_a;
    let flat = a.iter().chain(&**b).all(|piece| dot(&piece.away_from(base), normal).is_zero());
    check(flat, "the arcs are not in one plane across the normal")?;
    // D.v on all of one arc, at the start and at the end of the other
    let opposite = |ends: &[Rc<Piece>; 2], other: &Arc, v| {
        let rows = |end: &Piece| Poly(other.iter().flat_map(|piece| dot(&piece.away_from(end), v).0).collect());
        change_sides([&rows(&ends[0]), &rows(&ends[1])])
    };
    let miranda = opposite(&of_a, b, first) && opposite(&of_b, a, second);
    check(miranda, "the coefficients on opposite sides have no opposite strict signs")
}
