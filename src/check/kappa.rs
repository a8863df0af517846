//! Bounds of the curvature on a piece, or at a point of it.

use std::rc::Rc;

use num_bigint::Sign;
use num_traits::Zero;

use super::arc::Piece;
use super::poly::{Poly, dot};
use super::rules::curvature;
use crate::claim::Bounds;
use crate::number::Rational;

/// Where kappa is looked at: on a whole piece, or at a parameter of it.
pub(super) struct Place(pub(super) Rc<Piece>, pub(super) Option<Rational>);

/// b = 0.
pub(super) fn straight(Place(piece, t): &Place) -> bool {
    piece.wb().iter().all(|c| t.as_ref().map_or(c.is_zero(), |t| c.at(t).is_zero()))
}

/// kappa^2 at two ends of spans.
pub(super) fn equal(Place(piece, t): &Place, Place(other, u): &Place) -> bool {
    let parts = |piece: &Piece, t: &Option<Rational>| {
        let (a, wb, ww) = (dot(piece.a(), piece.a()), piece.wb(), piece.w.times(&piece.w));
        let at = |form: Poly| t.as_ref().map_or(form.clone(), |t| form.at(t));
        // at 0 and 1 the value itself, whatever the degree
        (at(dot(&wb, &wb).times(&ww).times(&ww)), at(a.times(&a).times(&a)))
    };
    let ((p, a), (q, b)) = (parts(piece, t), parts(other, u));
    p.times(&b) == q.times(&a)
}

/// The coefficients, or the value, of a positive multiple of |a|^6 - r |b|^2 w^6.
fn form(Place(piece, t): &Place, r: &Rational) -> Poly {
    let form = curvature(piece, r);
    t.as_ref().map_or(form.clone(), |t| form.at(t))
}

/// kappa is at most the upper bound.
pub(super) fn at_most(place: &Place, [_, hi]: &Bounds) -> bool {
    let has = |r: &Rational, sign| form(place, r).0.iter().any(|c| c.sign() == sign);
    match hi {
        None => true,
        Some(hi) if hi.is_zero() => straight(place),
        Some(hi) => hi.numer().sign() == Sign::Plus && !has(&hi.recip().pow(2), Sign::Minus),
    }
}

/// kappa is at least the lower bound.
pub(super) fn at_least(place: &Place, [lo, _]: &Bounds) -> bool {
    lo.as_ref().is_some_and(|lo| {
        lo.numer().sign() != Sign::Plus || form(place, &lo.recip().pow(2)).0.iter().all(|c| c.sign() != Sign::Plus)
    })
}
