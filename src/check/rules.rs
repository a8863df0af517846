//! The conditions of the leaves: docs/certificate-format.md, sections 3 to 5. `r` is the square of the radius.

use std::rc::Rc;

use num_bigint::{BigInt, Sign};
use num_integer::Integer;
use num_traits::{One, Zero};

use super::arc::Piece;
use super::poly::{Poly, Vector, cross, dot, paired};
use crate::number::{Rational, compare};

/// Why a condition is not true.
pub(super) type Why = &'static str;

pub(super) const WEIGHTS: Why = "a control weight is not positive";
/// The unit of `bent` and `share`.
const UNIT: u32 = 32;

pub(super) fn check(fine: bool, why: Why) -> Result<(), Why> {
    if fine { Ok(()) } else { Err(why) }
}

pub(super) fn positive(form: &Poly) -> Result<(), Why> {
    check(form.is_positive(), "a coefficient is not positive")
}

/// A positive multiple of |a|^6 - r |b|^2 w^6.
pub(super) fn curvature(piece: &Piece, r: &Rational) -> Poly {
    let (aa, wb, ww) = (dot(piece.a(), piece.a()), piece.wb(), piece.w.times(&piece.w));
    let bw = dot(&wb, &wb).times(&ww.times(&ww));
    aa.times(&aa).times(&aa).scaled(r.denom()).minus(bw.scaled(r.numer()))
}

/// What is to be positive for `curved`: the weight, and |a|^2 for r = 0.
pub(super) fn curved(piece: &Piece, r: &Rational) -> [Poly; 2] {
    [piece.w.clone(), if r.is_zero() { dot(piece.a(), piece.a()) } else { curvature(piece, r) }]
}

fn square(g: &[i64; 3]) -> BigInt {
    g.iter().map(|c| BigInt::from(*c).pow(2)).sum()
}

/// The coefficients of v.g.
fn along([x, y, z]: &Vector, [g, h, k]: &[i64; 3]) -> impl Iterator<Item = BigInt> {
    x.0.iter().zip(&y.0).zip(&z.0).map(move |((x, y), z)| x * g + y * h + z * k)
}

/// All tangents of these pieces are within 45 degrees of `g`.
pub(super) fn cone(pieces: &[Rc<Piece>], g: &[i64; 3]) -> Result<(), Why> {
    let gg = square(g);
    for a @ [x, y, z] in pieces.iter().map(|piece| piece.a()) {
        let mut vectors = x.0.iter().zip(&y.0).zip(&z.0).zip(along(a, g));
        let inside = vectors.all(|(((x, y), z), along)| {
            along.sign() == Sign::Plus && (&along * &along) << 1_u8 > (x * x + y * y + z * z) * &gg
        });
        check(inside, "a tangent is not within 45 degrees of the axis")?;
    }
    Ok(())
}

/// g.p of the control points p.
fn heights(pieces: &[Rc<Piece>], g: &[i64; 3]) -> Result<Vec<Rational>, Why> {
    check(pieces.iter().all(|piece| piece.w.is_positive()), WEIGHTS)?;
    let fractions = pieces.iter().flat_map(|piece| along(&piece.r, g).zip(piece.full_weight().0));
    Ok(fractions.map(|(num, den)| Rational::new_raw(num, den)).collect())
}

pub(super) fn slab(a: &[Rc<Piece>], b: &[Rc<Piece>], g: &[i64; 3], r: &Rational) -> Result<(), Why> {
    let (above, below) = (heights(a, g)?, heights(b, g)?);
    let ends = above.iter().min_by(|p, q| compare(p, q)).zip(below.iter().max_by(|p, q| compare(p, q)));
    let (least, most) = ends.ok_or("there are no control points")?;
    let (num, den) = (least.numer() * most.denom() - most.numer() * least.denom(), least.denom() * most.denom());
    let far = num.sign() == Sign::Plus && &num * &num * r.denom() > (r.numer() * square(g) * &den * &den) << 2_u8;
    check(far, "the two are not so far apart along the normal")
}

/// The first weights of two pieces without common factor: > 0, as values of w, for which `curved` stands.
fn first_weights(a: &Piece, b: &Piece) -> [BigInt; 2] {
    let [v, w] = [a, b].map(|piece| piece.w.0.first().cloned().unwrap_or_default());
    let common = v.gcd(&w).max(BigInt::one());
    [v / &common, w / common]
}

/// x D.a(s) + y D.a(t), x and y squared weights apart. D.a(t) = r(s).(w a)(t) - w(s) (r.a)(t).
pub(super) fn side(a: &Piece, b: &Piece, fields: [i64; 2]) -> Result<(), Why> {
    let ([x, y], [v, w]) = (fields.map(BigInt::from), first_weights(a, b));
    let strict = |form: Poly| form.has_sign(Sign::Plus) || form.has_sign(Sign::Minus);
    let all = |f: [&Poly; 4], of: BigInt, g| paired(f.map(|f| f.scaled(&of)).each_ref(), g);
    let (tilt, other) = (a.products().tilt.each_ref(), b.products().tilt.each_ref());
    // one field alone: in the degree of both strict signs are kept
    let fine = y.is_zero() && !x.is_zero() && strict(paired(tilt, b.point()).flat())
        || strict(all(tilt, x * &w * &w, b.point()).plus(all(a.point(), -y * &v * &v, other)).flat());
    check(fine, "the coefficients have no strict common sign")
}

/// The form of `bent` times a positive number.
pub(super) fn bent(a: &Piece, b: &Piece, fields: [i64; 6], r: &Rational) -> Result<Poly, Why> {
    let ([x, y, g, h, u, v], unit) = (fields.map(BigInt::from), BigInt::one() << UNIT);
    check([&u, &v].iter().all(|u| u.magnitude() < unit.magnitude()), "a weight grows too fast")?;
    let [first, second] = first_weights(a, b);
    // k = top / bottom, both > 0; everything is times top, bottom, the denominator of r and 2^130
    let (top, bottom): (BigInt, BigInt) = (second * (&unit * 2 - &u), first * (&unit * 2 - &v));
    // (x - s)(1 + g (x - s) + u (1/2 - s)) times 2^97
    let own = |x: &BigInt, g: &BigInt, u: &BigInt| {
        let line = |x: &BigInt| (&unit * &unit + g * x) << 1_u8;
        let next = x - &unit;
        Poly(vec![line(x) + u * &unit, line(&next) - u * &unit]).times(&Poly(vec![x.clone(), next]))
    };
    // 1 + u (s - 1/2), or 1 if the weight is constant, times 2^33
    let weight = |piece: &Piece, u: &BigInt| match piece.w.0.len() {
        1 => Poly::constant(&unit * 2),
        _ => Poly(vec![&unit * 2 - u, &unit * 2 + u]),
    };
    let (p, q) = (a.products(), b.products());
    // |D|^2 - 4 r w(s)^2 w(t)^2
    let plain = (&top * &bottom) << (4 * UNIT + 2);
    let (square, disks) = (&plain * r.denom(), (&plain * r.numer()) << 2_u8);
    let ends = [p.ww.scaled(&square), p.rr.scaled(&square), p.ww.scaled(&-disks)];
    let mixed = paired(p.rw.each_ref().map(|f| f.scaled(&(&square * -2))).each_ref(), q.rw.each_ref());
    let distance = mixed.plus(paired(ends.each_ref(), [&q.rr, &q.ww, &q.ww]));
    // k (x - s) .. D.a(s) and 1/k (t - y) .. D.a(t) = (y - t) .. (w(s) (r.a)(t) - r(s).(w a)(t))
    let of_s = own(&x, &g, &u).scaled(&(&top * &top * r.denom()));
    let of_t = own(&y, &h, &v).scaled(&(&bottom * &bottom * r.denom()));
    let (of_a, of_b) = (weight(a, &u), weight(b, &v));
    let point = b.point().map(|g| g.times(&of_b));
    let first = paired(p.tilt.each_ref().map(|f| f.times(&of_s)).each_ref(), point.each_ref());
    let tilt = q.tilt.each_ref().map(|g| g.times(&of_t));
    let second = paired(a.point().map(|f| f.times(&of_a)).each_ref(), tilt.each_ref());
    Ok(distance.plus(first).plus(second).flat())
}

/// The form of `share` times 2^64 and the denominator of r.
pub(super) fn share(end: &Piece, piece: &Piece, k: i64, r: &Rational) -> Result<Poly, Why> {
    check((0..=1 << UNIT).contains(&k), "the share is not in 0 .. 2^32")?;
    let (k, unit) = (BigInt::from(k), BigInt::one() << UNIT);
    let (a, d, q, other) = (piece.a(), end.a(), piece.away_from(end), &unit - &k);
    let u = cross(d, a);
    let squared = |f: Poly| f.times(&f);
    let of_end = squared(dot(a, &q)).times(&dot(d, d)).scaled(&(&k * &unit));
    let of_body = squared(dot(d, &q)).times(&dot(a, a)).scaled(&(&other * &unit));
    let between = squared(dot(&u, &q)).scaled(&(k * other));
    let disks = dot(&u, &u).times(&squared(piece.w.times(&end.w))).scaled(&(r.numer() * &unit * &unit));
    Ok(of_end.plus(of_body).plus(between).scaled(r.denom()).minus(disks))
}
