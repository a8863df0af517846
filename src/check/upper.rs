//! The witness of hi: docs/certificate-format.md, section 6.

use std::rc::Rc;

use num_bigint::{BigInt, Sign};
use num_traits::{One, Zero};

use super::arc::{Piece, Spine};
use super::poly::{Poly, cross, dot};
use super::rules::{Why, check, curvature};
use crate::certificate::{Foot, SpanArc, Upper};
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
        Upper::Crossing { arcs, normal, first, second } => crossing(spine, arcs, [normal, first, second].map(integers)),
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

fn place(spine: &Spine, position: &Rational) -> Result<Rc<Piece>, Why> {
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

/// An arc of a span, whose weights are > 0, and its positions.
fn part(spine: &Spine, (span, [from, to]): &SpanArc) -> Result<(Rc<Piece>, [Rational; 2]), Why> {
    let piece = spine.spans.get(*span).ok_or(NO_SPAN)?;
    let inside = within(from, &Rational::zero(), to) && within(to, from, &Rational::one());
    check(inside && compare(from, to).is_lt(), "an arc is not within its span")?;
    // first 0 .. b/q, then its part from a/b on
    let (a, b, q) = (from.numer() * to.denom(), to.numer() * from.denom(), from.denom() * to.denom());
    let part = |f: &Poly| f.start(&b, &q).reversed().start(&(&b - &a), &b).reversed();
    let part = Piece::new(BigInt::zero(), BigInt::zero(), piece.r.each_ref().map(part), part(&piece.full_weight()));
    check(part.w.is_positive(), "a control weight is not positive")?;
    Ok((part, [from, to].map(|t| t + BigInt::from(*span))))
}

fn crossing(spine: &Spine, [s, t]: &[SpanArc; 2], vectors: [Rc<Piece>; 3]) -> Result<(), Why> {
    let [(a, of_a), (b, of_b)] = [part(spine, s)?, part(spine, t)?];
    apart(spine, of_a.each_ref(), of_b.each_ref())?;
    let [normal, first, second] = vectors.each_ref().map(|v| &v.r);
    check(!dot(normal, &cross(first, second)).is_zero(), "the determinant is 0")?;
    let [start, end] = [Rational::zero(), Rational::one()];
    let flat = [&a, &b].iter().all(|piece| dot(&piece.away_from(&a.at(&start)), normal).is_zero());
    check(flat, "the arcs are not in one plane across the normal")?;
    // D.v as a polynomial on one arc, at the start and at the end of the other
    let opposite = |a: &Piece, b: &Piece, v| {
        let [p, q] = [&start, &end].map(|t| dot(&b.away_from(&a.at(t)), v));
        p.has_sign(Sign::Plus) && q.has_sign(Sign::Minus) || p.has_sign(Sign::Minus) && q.has_sign(Sign::Plus)
    };
    let miranda = opposite(&a, &b, first) && opposite(&b, &a, second);
    check(miranda, "the coefficients on opposite sides have no opposite strict signs")
}
