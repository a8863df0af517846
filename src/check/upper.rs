//! The witness of hi: docs/certificate-format.md, section 6.

use num_bigint::{BigInt, Sign};
use num_traits::{One, Zero};

use super::arc::Spine;
use super::poly::{Poly, cross, dot, zip};
use super::rules::{Squared, Why, check, curvature};
use crate::certificate::{Foot, SpanArc, Upper};
use crate::number::{Rational, compare};

/// `upper` proves that delta is at most `hi`.
pub(super) fn upper(spine: &Spine, upper: &Upper, hi: Option<&Rational>) -> Result<(), Why> {
    let Some(hi) = hi else {
        return check(*upper == Upper::None, "hi is inf and has a witness");
    };
    let limit = Squared::of(hi);
    match upper {
        Upper::None => Err("hi has no witness"),
        Upper::Curvature { span, t } => curved(spine, *span, t, &limit),
        Upper::Corner(joint) => {
            check(*joint < spine.spans.len(), "there is no such joint")?;
            check(*joint > 0 || spine.ends_meet(), "the ends are two points")?;
            check(!spine.is_smooth(*joint), "the joint is smooth")
        }
        Upper::Contact { x, feet } => contact(spine, x, feet, &limit),
        Upper::Crossing { arcs, normal, first, second } => crossing(spine, arcs, [normal, first, second]),
        Upper::Mirror { arcs, normal } => mirror(spine, arcs, normal),
    }
}

fn curved(spine: &Spine, span: usize, t: &Rational, limit: &Squared) -> Result<(), Why> {
    let piece = spine.spans.get(span).ok_or(NO_SPAN)?;
    check(within(t, &Rational::zero(), &Rational::one()), "t is not in 0 .. 1")?;
    let at = |f: &Poly| f.at(t.numer(), t.denom());
    check(piece.b().iter().any(|b| !at(b).is_zero()), "b is 0 there")?;
    check(at(&curvature(piece, limit)).sign() != Sign::Plus, "the curvature there is less than 1/hi")
}

const NO_SPAN: Why = "there is no such span";

fn within(x: &Rational, from: &Rational, to: &Rational) -> bool {
    compare(from, x).is_le() && compare(x, to).is_le()
}

/// x - C at a position, and a there.
struct Offset {
    num: [BigInt; 3],
    den: BigInt,
    a: [BigInt; 3],
}

impl Offset {
    fn square(&self) -> (BigInt, BigInt) {
        (self.num.iter().map(|c| c * c).sum(), &self.den * &self.den)
    }

    fn at_most(&self, limit: &Squared) -> Result<(), Why> {
        let (num, den) = self.square();
        check(num * &limit.den <= &limit.num * den, "the point is farther than hi from the spine there")
    }

    fn less_than(&self, other: &Self) -> Result<(), Why> {
        let ((p, q), (u, v)) = (self.square(), other.square());
        check(p * v < u * q, "an end of a valley is not farther")
    }
}

fn offset(spine: &Spine, [x, y, z]: &[Rational; 3], position: &Rational) -> Result<Offset, Why> {
    let count = BigInt::from(spine.spans.len());
    let whole = position.floor().to_integer();
    let mut t = position - &whole;
    let mut span = whole.clone();
    if spine.closed {
        check(-&count <= whole && position.numer() <= &(position.denom() * &count * 2), "a position is out of range")?;
        span = num_integer::Integer::mod_floor(&span, &count);
    } else if whole == count && t.is_zero() {
        (span, t) = (count - 1, Rational::one());
    }
    let piece =
        usize::try_from(span).ok().and_then(|span| spine.spans.get(span)).ok_or("a position is out of range")?;
    let at = |f: &Poly| f.at(t.numer(), t.denom());
    let w = at(&piece.full_weight());
    let common = x.denom() * y.denom() * z.denom();
    let integer = |x: &Rational| x.numer() * (&common / x.denom());
    let num = zip([x, y, z], piece.r.each_ref(), |x, r| integer(x) * &w - at(r) * &common);
    Ok(Offset { num, den: common * w, a: piece.a().each_ref().map(at) })
}

fn contact(spine: &Spine, x: &[Rational; 3], feet: &[Foot; 2], limit: &Squared) -> Result<(), Why> {
    let count = Rational::from_integer(spine.spans.len().into());
    for foot in feet {
        let at = |position| offset(spine, x, position);
        match foot {
            Foot::Plane(position) => {
                let here = at(position)?;
                let along: BigInt = here.a.iter().zip(&here.num).map(|(a, c)| a * c).sum();
                check(along.is_zero(), "the point is not in the plane")?;
                here.at_most(limit)?;
            }
            Foot::Valley([from, position, to]) => {
                let ordered = compare(from, position).is_lt() && compare(position, to).is_lt();
                check(ordered && compare(&(to - from), &count).is_lt(), "the positions of a valley are not in order")?;
                let here = at(position)?;
                here.at_most(limit)?;
                here.less_than(&at(from)?)?;
                here.less_than(&at(to)?)?;
            }
        }
    }
    let [(first, last), (next, end)] = feet.each_ref().map(|foot| match foot {
        Foot::Plane(position) => (position, position),
        Foot::Valley([from, _, to]) => (from, to),
    });
    let around = !spine.closed || compare(end, &(first + count)).is_lt();
    check(compare(last, next).is_lt() && around, "the two are not apart on the spine")
}

/// An arc of a span: its control points and weights, both times binomials.
fn arc(spine: &Spine, SpanArc { span, from, to }: &SpanArc) -> Result<([Poly; 3], Poly), Why> {
    let piece = spine.spans.get(*span).ok_or(NO_SPAN)?;
    let [zero, one] = [Rational::zero(), Rational::one()];
    check(within(from, &zero, &one) && within(to, &zero, &one), "an arc is not within its span")?;
    let (a, b, q) = (from.numer() * to.denom(), to.numer() * from.denom(), from.denom() * to.denom());
    let part = |f: &Poly| f.between(&a, &b, &q);
    let w = part(&piece.full_weight());
    check(w.is_positive(), "a control weight is not positive")?;
    Ok((piece.r.each_ref().map(part), w))
}

/// Two arcs, the first before the second; either may run back.
fn two_arcs(spine: &Spine, arcs: &[SpanArc; 2]) -> Result<[([Poly; 3], Poly); 2], Why> {
    let ends = arcs.each_ref().map(|arc| {
        let [from, to] = [&arc.from, &arc.to].map(|t| t + Rational::from_integer(arc.span.into()));
        if compare(&from, &to).is_lt() { (from, to) } else { (to, from) }
    });
    let [(first, last), (next, end)] = ends;
    let around = !spine.closed || compare(&end, &(first + Rational::from_integer(spine.spans.len().into()))).is_lt();
    check(compare(&last, &next).is_lt() && around, "the two arcs are not apart on the spine")?;
    let [s, t] = arcs;
    Ok([arc(spine, s)?, arc(spine, t)?])
}

/// A positive multiple of a vector.
fn constant([x, y, z]: &[Rational; 3]) -> [Poly; 3] {
    let common = x.denom() * y.denom() * z.denom();
    [x, y, z].map(|c| Poly(vec![c.numer() * (&common / c.denom())]))
}

/// D of equal parameters is parallel to the normal and changes its side, so it is 0 for some.
fn mirror(spine: &Spine, arcs: &[SpanArc; 2], normal: &[Rational; 3]) -> Result<(), Why> {
    let ([(r, v), (q, w)], normal) = (two_arcs(spine, arcs)?, constant(normal));
    let d = zip(r.each_ref(), q.each_ref(), |r, q| r.times(&w).minus(q.times(&v)));
    check(cross(&d, &normal).iter().all(Poly::is_zero), "the points of equal parameters are not along the normal")?;
    let side = dot(&d, &normal);
    let signs = [side.0.first(), side.0.last()].map(|c| c.map_or(Sign::NoSign, BigInt::sign));
    let opposite = signs == [Sign::Plus, Sign::Minus] || signs == [Sign::Minus, Sign::Plus];
    check(opposite, "the arcs do not change sides")
}

fn crossing(spine: &Spine, arcs: &[SpanArc; 2], vectors: [&[Rational; 3]; 3]) -> Result<(), Why> {
    let [(r, v), (q, w)] = two_arcs(spine, arcs)?;
    let [normal, first, second] = vectors.map(constant);
    check(!dot(&normal, &cross(&first, &second)).is_zero(), "the determinant is 0")?;
    let level = |f: &[Poly; 3]| dot(f, &normal);
    let (height, other) = (level(&r), level(&q));
    // p_i/v_i is one value for all i, and that of the other arc
    let (Some(p), Some(base)) = (height.0.first(), v.0.first()) else { return Err(NO_SPAN) };
    let flat = |heights: &Poly, weights: &Poly| heights.0.iter().zip(&weights.0).all(|(h, w)| h * base == p * w);
    check(flat(&height, &v) && flat(&other, &w), "the arcs are not in one plane across the normal")?;

    // at an end of s, D.first = (r.first)(s) w(t) - v(s) (q.first)(t) with r, v the end's
    let side = |h: &BigInt, v: &BigInt, f: &Poly, w: &Poly| w.scaled(h).minus(f.scaled(v));
    let opposite = |f: &Poly, v: &Poly, other: &Poly, w: &Poly| {
        let start = f.0.first().zip(v.0.first()).map(|(h, v)| side(h, v, other, w));
        let end = f.0.last().zip(v.0.last()).map(|(h, v)| side(h, v, other, w));
        let signs = |p, q| start.iter().all(|f| f.has_sign(p)) && end.iter().all(|f| f.has_sign(q));
        signs(Sign::Plus, Sign::Minus) || signs(Sign::Minus, Sign::Plus)
    };
    let miranda =
        opposite(&dot(&r, &first), &v, &dot(&q, &first), &w) && opposite(&dot(&q, &second), &w, &dot(&r, &second), &v);
    check(miranda, "the coefficients on opposite sides have no opposite strict signs")
}
