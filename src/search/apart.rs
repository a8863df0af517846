//! The rule *slab*: two arcs are further than 2r apart along one direction; in f64, and exactly where f64 cannot tell.

use super::dyadic::{Dyadic, decompose_exponent};
use super::frame::Frame;
use super::tree::{Cell, ROUNDING, V3, dot, norm, sub, unit};
use crate::integer::{Int, ldexp};
use crate::spine::Bezier;

/// Is u.(p - q) > 2r |u| for all p and q, which are off such that p - q is off by at most `e`? `None`: f64 cannot tell.
pub(crate) fn hulls_apart(p: &[V3], q: &[V3], e: f64, u: &V3, r: f64) -> Option<bool> {
    let base = &q[0];
    // every p - base is no longer than this
    let worst = p.iter().chain(q).map(|p| norm(&sub(p, base))).fold(0.0f64, f64::max);
    let range = |points: &[V3], pick: fn(f64, f64) -> f64, from: f64| {
        points.iter().map(|p| dot(&sub(p, base), u)).fold(from, pick)
    };
    let gap = range(p, f64::min, f64::INFINITY) - range(q, f64::max, f64::NEG_INFINITY);
    let size = norm(u);
    if gap > (2.0 * r * size + e * size) * (1.0 + ROUNDING) + ROUNDING * worst * size {
        return Some(true);
    }
    (gap < (2.0 * r * size - e * size) * (1.0 - ROUNDING) - ROUNDING * worst * size).then_some(false)
}

/// The same for homogeneous integer points.
fn hulls_apart_exactly(p: &[[Int; 4]], q: &[[Int; 4]], u: &[i64; 3], r: f64) -> bool {
    let u = u.map(Int::from);
    let dot = |a: &[Int]| (0..3).fold(Int::ZERO, |sum, k| &sum + &(&a[k] * &u[k]));
    let size = dot(&u);
    let (r, square) = (Dyadic::from_f64(2.0 * r), |x: &Int| x * x);
    let apart = |p: &[Int; 4], q: &[Int; 4]| {
        let (gap, w) = (&(&dot(p) * &q[3]) - &(&dot(q) * &p[3]), &p[3] * &q[3]);
        let reach = r.sqr().mul(&Dyadic { m: &square(&w) * &size, e: 0 });
        w.sign().is_gt() && gap.sign().is_gt() && Dyadic { m: square(&gap), e: 0 }.cmp(&reach).is_gt()
    };
    p.iter().all(|p| q.iter().all(|q| apart(p, q)))
}

/// The direction of `v` in integers, the largest of about `bits` bits.
pub(super) fn rounded(v: &V3, bits: i32) -> [i64; 3] {
    let largest = v.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let top = decompose_exponent(largest);
    let whole = v.map(|x| ldexp(x, i64::from(bits) - top).round() as i64);
    let twos = whole.iter().fold(0i64, |all, x| all | x).trailing_zeros();
    if twos < 64 { whole.map(|x| x >> twos) } else { whole }
}

/// The direction `u` in few digits, if two hulls are further than 2r apart along it.
pub(super) fn direction(
    u: &V3,
    p: &[V3],
    q: &[V3],
    e: f64,
    r: f64,
    exact: impl Fn() -> (Vec<[Int; 4]>, Vec<[Int; 4]>),
) -> Option<[i64; 3]> {
    let mut unsure = None;
    for whole in [10, 24, 52].map(|bits| rounded(u, bits)) {
        match hulls_apart(p, q, e, &whole.map(|x| x as f64), r) {
            Some(true) => return Some(whole),
            Some(false) => {}
            None => unsure = Some(whole),
        }
    }
    unsure.filter(|u| {
        let (p, q) = exact();
        hulls_apart_exactly(&p, &q, u, r)
    })
}

/// The same for two cells.
pub(super) fn hulls_apart_along(frame: &Frame, x: Cell, y: Cell, e: f64, u: &V3, r: f64) -> Option<[i64; 3]> {
    let points = |c: Cell| exact_points(&c.exact(frame));
    direction(u, x.p, y.p, e, r, || (points(x), points(y)))
}

pub(super) fn exact_points(arc: &Bezier) -> Vec<[Int; 4]> {
    (0..=arc.degree()).map(|i| arc.point(i)).collect()
}

/// A direction in which balls of these centres' difference and radii's sum are further than 2r apart.
pub(super) fn balls_apart(q0: &V3, spread: f64, r: f64) -> Option<[i64; 3]> {
    [8, 24, 52].iter().map(|bits| rounded(q0, *bits)).find(|u| {
        let u = unit(&u.map(|x| x as f64));
        let gap = dot(q0, &u) - norm(q0) * ROUNDING - spread * (1.0 + ROUNDING);
        gap > 2.0 * r * (1.0 + ROUNDING)
    })
}
