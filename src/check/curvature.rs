//! The critical points of curvature: docs/certificate-format.md, section 8.

use std::rc::Rc;

use num_bigint::{BigInt, Sign};
use num_traits::{One, Zero};

use super::arc::{Piece, Spine};
use super::kappa::{Place, at_least, at_most, equal, straight};
use super::poly::{Poly, dot};
use super::range::Range;
use super::rules::{Why, check, positive};
use super::{Rejection, wanted};
use crate::certificate::curvature::Course;
use crate::claim::{Bounds, Critical, CriticalKind, CriticalPoints};
use crate::curve::Curve;
use crate::number::{Rational, compare};

/// What a point of the claim must hold: zeros of N on a cell of a span, or at a place, or a joint that stands out.
struct Item {
    from: Rational,
    to: Rational,
    /// It is one point, and no multiple zero of N.
    simple: bool,
    joint: bool,
    /// kappa jumps here.
    jumps: bool,
    /// The signs of N before and after; `NoSign` where there is nothing, or the curvature is constant.
    signs: [Sign; 2],
    /// One, or both sides of a joint.
    places: Vec<Place>,
    /// b = 0 at the one zero.
    inflection: bool,
}

impl Item {
    fn new(from: Rational, to: Rational, signs: [Sign; 2], places: Vec<Place>) -> Self {
        Self { from, to, signs, places, simple: false, joint: false, jumps: false, inflection: false }
    }
}

/// One end of a span: the sign of N inside, next to it, and how often N is 0 there; the place.
struct Side(Sign, usize, Place);

pub(super) fn verify(curve: &Curve, spine: &Spine, claim: &CriticalPoints, course: &Course) -> Result<(), Rejection> {
    let bounds = claim.points.iter().flat_map(|point| [&point.t, &point.kappa]).chain([&claim.kappa_max, &claim.at]);
    let stretches = claim.constant.iter().flat_map(|s| [&s.from, &s.to].into_iter().chain(&s.kappa));
    let mut numbers = bounds.flatten().chain(stretches).flatten();
    wanted(numbers.all(|x| x.denom().sign() == Sign::Plus), "point", "a denominator is not positive")?;
    let knots = Spine::knots(curve);
    let lines = course.cuts.len() == spine.spans.len() && knots.len() > course.cuts.len();
    let mut placed = course.cuts.iter().flatten().chain([&course.witness.1]);
    let short = placed.all(|t| Range::point(t).is_short());
    wanted(lines && short, "span", "one line for each span, no cut too long")?;
    let (mut items, mut sides, mut constant) = (vec![], vec![], vec![]);
    for (k, ((piece, cuts), ends)) in spine.spans.iter().zip(&course.cuts).zip(knots.windows(2)).enumerate() {
        let factor = course.factors.iter().find(|(span, _)| *span == k).map(|(_, g)| Poly(g.clone()));
        let found = span(piece, cuts, ends, factor.as_ref(), &mut items);
        let pair = found.map_err(|why| Rejection::of("span", why).at(k + 1, &""))?;
        if let [Side(Sign::NoSign, ..), _] = pair {
            constant.push((ends, Place(piece.clone(), Some(Rational::zero()))));
        }
        sides.push(pair);
    }
    joints(spine.closed, &knots, sides, &claim.kappa_max, &mut items).map_err(|why| Rejection::of("kappa_max", why))?;
    items.sort_by(|p, q| compare(&p.from, &q.from).then_with(|| compare(&p.to, &q.to)));
    let joint = items.first().is_some_and(|item| item.joint && knots.first() == Some(&item.from));
    let seam = knots.last().filter(|_| spine.closed && joint);
    points(claim, &items, seam).map_err(|why| Rejection::of("point", why))?;

    wanted(claim.constant.len() == constant.len(), "constant", "not as many as spans of constant curvature")?;
    for (stretch, (ends, place)) in claim.constant.iter().zip(&constant) {
        let inside = ends.first().zip(ends.last()).zip(stretch.from.as_ref().zip(stretch.to.as_ref()));
        let inside = inside.is_some_and(|((a, b), (from, to))| compare(a, from).is_le() && compare(to, b).is_le());
        let fine = inside && at_most(place, &stretch.kappa) && at_least(place, &stretch.kappa);
        wanted(fine, "constant", "it is not in the span, or the curvature is another")?;
    }
    let (k, t) = &course.witness;
    let within = [Rational::zero(), Rational::one()].map(Some);
    let span = spine.spans.get(*k).zip(knots.get(*k..=*k + 1)).filter(|_| holds(&within, [t, t]));
    let high = span.is_some_and(|(piece, ends)| {
        let u = ends.first().zip(ends.last()).map(|(a, b)| a + t * (b - a));
        // the seam is the start as well
        let start = spine.closed && t.is_one() && *k + 1 == spine.spans.len();
        let u = if start { knots.first().cloned() } else { u };
        let place = Place(piece.clone(), Some(t.clone()));
        u.is_some_and(|u| holds(&claim.at, [&u, &u])) && at_least(&place, &claim.kappa_max)
    });
    wanted(high, "witness", "the curvature there is not that of kappa_max, or the place not in its parameter")
}

/// A positive multiple of N: the derivative of kappa^2 = c w^4 / a^3 for c = |a x a'|^2, a = |a|^2, cleared.
fn critical(piece: &Piece) -> Poly {
    let (wb, w) = (piece.wb(), &piece.w);
    let (a, c) = (dot(piece.a(), piece.a()), dot(&wb, &wb));
    let grow = w.derivative().times(&c).times(&a).scaled(&4.into());
    let turn = c.derivative().times(w).times(&a).plus(grow);
    turn.minus(c.times(w).times(&a.derivative()).scaled(&3.into()))
}

/// Looks at the cells of a span one after the other.
fn span(
    piece: &Rc<Piece>,
    cuts: &[Rational],
    ends: &[Rational],
    factor: Option<&Poly>,
    items: &mut Vec<Item>,
) -> Result<[Side; 2], Why> {
    let [start, end] = ends else { return Err("there is no span") };
    let cuts: Vec<Rational> = [Rational::zero()].iter().chain(cuts).chain([&Rational::one()]).cloned().collect();
    check(cuts.is_sorted_by(|a, b| compare(a, b).is_lt()), "the cuts are not in order between 0 and 1")?;
    if let Some(g) = factor {
        check(piece.wb().into_iter().all(|c| divides(g, c)), "the factor divides not all of b")?;
    }
    let knot = |t: &Rational| start + t * (end - start);
    let place = |t: &Rational| Place(piece.clone(), Some(t.clone()));
    let (mut first, mut last, mut after) = (None, None, 0);
    for (p, q) in cuts.iter().zip(cuts.iter().skip(1)) {
        let cell = piece.part(p, q);
        check(cell.w.is_positive(), "a control weight is not positive")?;
        positive(&dot(cell.a(), cell.a()))?;
        let form = critical(&cell);
        let signs: Vec<Sign> = form.0.iter().map(BigInt::sign).collect();
        let zeros = signs.iter().take_while(|sign| **sign == Sign::NoSign).count();
        after = signs.iter().rev().take_while(|sign| **sign == Sign::NoSign).count();
        let known: Vec<Sign> = signs.into_iter().filter(|sign| *sign != Sign::NoSign).collect();
        // N = 0: the curvature is constant
        let (Some(enter), Some(leave)) = (known.first(), known.last()) else { continue };
        match &last {
            None => first = Some(Side(*enter, zeros, place(p))),
            Some(_) if zeros == 0 => {}
            Some(before) => {
                let places = vec![place(p)];
                let signs = [*before, *enter];
                items.push(Item { simple: zeros == 1, ..Item::new(knot(p), knot(p), signs, places) });
            }
        }
        let changes = known.iter().zip(known.iter().skip(1)).filter(|(a, b)| a != b).count();
        if changes > 0 {
            let signs = [*enter, *leave];
            let opposite = |g: &Poly| g.at(p).times(&g.at(q)).has_sign(Sign::Minus);
            let (simple, inflection) = (changes == 1, changes == 1 && factor.is_some_and(opposite));
            items.push(Item { simple, inflection, ..Item::new(knot(p), knot(q), signs, vec![Place(cell, None)]) });
        }
        last = Some(*leave);
    }
    let [zero, one] = [Rational::zero(), Rational::one()].map(|t| place(&t));
    let Some((first, last)) = first.zip(last) else {
        return Ok([Side(Sign::NoSign, 0, zero), Side(Sign::NoSign, 0, one)]);
    };
    Ok([first, Side(last, after, one)])
}

/// Whether g, not 0 at 1, divides c: both are forms in t and 1 - t.
fn divides(g: &Poly, mut c: Poly) -> bool {
    let Some(lead) = g.0.last().filter(|lead| !lead.is_zero()) else { return false };
    while c.0.len() >= g.0.len() {
        let top = c.0.last().cloned().unwrap_or_default();
        let shift = vec![BigInt::zero(); c.0.len() - g.0.len()];
        c = c.scaled(lead).minus(Poly(shift.into_iter().chain(g.scaled(&top).0).collect()));
        c.0.pop();
    }
    c.is_zero()
}

/// The joints, and the ends of an open spine, in order: those that stand out become items. kappa_max holds at all.
fn joints(
    closed: bool,
    knots: &[Rational],
    sides: Vec<[Side; 2]>,
    max: &Bounds,
    items: &mut Vec<Item>,
) -> Result<(), Why> {
    let (starts, finishes): (Vec<Side>, Vec<Side>) = sides.into_iter().map(|[start, finish]| (start, finish)).unzip();
    let mut before: Vec<Option<Side>> = [None].into_iter().chain(finishes.into_iter().map(Some)).collect();
    let after = starts.into_iter().map(Some).chain([None]);
    if closed && let Some((first, seam)) = before.pop().and_then(|seam| Some((before.first_mut()?, seam))) {
        *first = seam;
    }
    for ((t, before), after) in knots.iter().zip(before).zip(after) {
        let at = |side: &Option<Side>| side.as_ref().map_or((Sign::NoSign, 0), |Side(sign, zeros, _)| (*sign, *zeros));
        let ([sign, next], [p, q]) = ([at(&before).0, at(&after).0], [at(&before).1, at(&after).1]);
        let both = before.as_ref().zip(after.as_ref());
        let jumps = both.is_some_and(|(Side(.., p), Side(.., q))| !equal(p, q));
        let turns = sign != Sign::NoSign && next == -sign;
        let joint = both.is_some();
        let places: Vec<Place> = before.into_iter().chain(after).map(|Side(.., place)| place).collect();
        check(places.iter().all(|place| at_most(place, max)), "the curvature at the end of a span is greater")?;
        if p + q > 0 || jumps || turns {
            let item = Item::new(t.clone(), t.clone(), [sign, next], places);
            items.push(Item { simple: p < 2 && q < 2, joint, jumps, ..item });
        }
    }
    Ok(())
}

/// Every item is in a point of the claim, and what is said of unique points is true. The first item may stand at the seam.
fn points(claim: &CriticalPoints, items: &[Item], seam: Option<&Rational>) -> Result<(), Why> {
    let ends_before = |[_, hi]: &Bounds, x: &Rational| hi.as_ref().is_some_and(|hi| compare(hi, x).is_lt());
    let starts_after = |[lo, _]: &Bounds, x: &Rational| lo.as_ref().is_none_or(|lo| compare(lo, x).is_gt());
    let mut next = claim.points.iter().zip(claim.points.iter().skip(1));
    let apart = |p: &Critical, q: &Critical| q.t[0].as_ref().is_some_and(|lo| ends_before(&p.t, lo));
    let ordered =
        next.all(|(p, q)| p.t.iter().zip(&q.t).all(|(p, q)| below(p, q)) && (!(p.unique || q.unique) || apart(p, q)));
    check(ordered, "the points are not in order")?;
    for item in items {
        let first = claim.points.partition_point(|point| ends_before(&point.t, &item.from));
        let mut near = claim.points.iter().skip(first).take_while(|point| !starts_after(&point.t, &item.to));
        check(near.any(|point| has(point, item)), "a zero of N, or a joint, is in none")?;
    }
    for point in &claim.points {
        check(below(&point.kappa[1], &claim.kappa_max[1]), "the curvature is greater than kappa_max")?;
        let first = items.partition_point(|item| starts_after(&point.t, &item.to));
        let mut meeting = items.iter().skip(first).take_while(|item| !ends_before(&point.t, &item.from));
        let one = meeting.next().is_some_and(|item| item.simple && has(point, item) && is(point, item))
            && meeting.next().is_none()
            && seam.is_none_or(|end| ends_before(&point.t, end));
        check(one || !point.unique, "it is not the only one, or of another kind")?;
    }
    Ok(())
}

/// Whether a point is where an item is, with its curvature.
fn has(point: &Critical, item: &Item) -> bool {
    let zero = point.kappa.iter().all(|bound| bound.as_ref().is_some_and(Zero::is_zero));
    let (low, high) = (|p: &Place| at_least(p, &point.kappa), |p: &Place| at_most(p, &point.kappa));
    let kappa = (item.inflection && zero) || (item.places.iter().all(high) && item.places.iter().any(low));
    kappa && holds(&point.t, [&item.from, &item.to]) && (!item.jumps || point.kind == Some(CriticalKind::Joint))
}

fn is(point: &Critical, item: &Item) -> bool {
    let [before, after] = item.signs;
    let bent = || matches!(&point.kappa, [Some(lo), _] if lo.numer().sign() == Sign::Plus);
    match point.kind {
        Some(CriticalKind::Maximum) => !item.jumps && before != Sign::Minus && after != Sign::Plus,
        Some(CriticalKind::Minimum) => !item.jumps && bent() && before != Sign::Plus && after != Sign::Minus,
        Some(CriticalKind::Inflection) => item.inflection || item.places.iter().all(straight),
        Some(CriticalKind::Joint) => item.joint,
        None => true,
    }
}

/// `None` is +infinity.
fn below(a: &Option<Rational>, b: &Option<Rational>) -> bool {
    b.as_ref().is_none_or(|b| a.as_ref().is_some_and(|a| compare(a, b).is_le()))
}

fn holds([lo, hi]: &Bounds, [from, to]: [&Rational; 2]) -> bool {
    lo.as_ref().is_some_and(|lo| compare(lo, from).is_le()) && hi.as_ref().is_none_or(|hi| compare(to, hi).is_le())
}
