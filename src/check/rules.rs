//! The conditions of the leaves: docs/certificate-format.md, sections 3 to 5.

use std::rc::Rc;

use num_bigint::{BigInt, Sign};
use num_integer::Integer;
use num_traits::{One, Zero};

use super::arc::{End, Piece, Products};
use super::poly::{Poly, Tensor, Vector, cross, dot, zip};
use crate::number::Rational;

/// Why a condition is not true.
pub(super) type Why = &'static str;

const NOT_POSITIVE: Why = "a coefficient is not positive";
const WEIGHTS: Why = "a control weight is not positive";
/// The unit of `bent` and `share`.
const UNIT: u32 = 32;

/// The square of a radius.
pub(super) struct Squared {
    pub(super) num: BigInt,
    pub(super) den: BigInt,
}

impl Squared {
    pub(super) fn of(r: &Rational) -> Self {
        Self { num: r.numer() * r.numer(), den: r.denom() * r.denom() }
    }
}

pub(super) fn check(fine: bool, why: Why) -> Result<(), Why> {
    if fine { Ok(()) } else { Err(why) }
}

fn constant(v: &[BigInt; 3]) -> Vector {
    v.each_ref().map(|c| Poly(vec![c.clone()]))
}

fn square(v: &[BigInt; 3]) -> BigInt {
    v.iter().map(|c| c * c).sum()
}

/// A positive multiple of |a|^6 - r^2 |b|^2 w^6.
pub(super) fn curvature(piece: &Piece, r: &Squared) -> Poly {
    let cube = |f: &Poly| f.times(f).times(f);
    let (a, b, w) = (piece.a(), piece.b(), &piece.w);
    let bw = dot(&b, &b).times(&cube(&w.times(w)));
    cube(&dot(a, a)).scaled(&r.den).minus(bw.scaled(&r.num))
}

pub(super) fn curved(piece: &Piece, r: &Squared) -> Result<(), Why> {
    check(piece.w.is_positive(), WEIGHTS)?;
    let form = if r.num.is_zero() { dot(piece.a(), piece.a()) } else { curvature(piece, r) };
    check(form.is_positive(), NOT_POSITIVE)
}

/// All tangents of these pieces are within 45 degrees of `g`.
pub(super) fn cone(pieces: &[Rc<Piece>], g: &[i64; 3]) -> Result<(), Why> {
    let g = g.map(BigInt::from);
    let (gg, axis) = (square(&g), constant(&g));
    for piece in pieces {
        let ([x, y, z], along) = (piece.a(), dot(piece.a(), &axis));
        let mut vectors = x.0.iter().zip(&y.0).zip(&z.0).zip(&along.0);
        let inside = vectors.all(|(((x, y), z), along)| {
            along.sign() == Sign::Plus && (along * along) << 1_u8 > (x * x + y * y + z * z) * &gg
        });
        check(inside, "a tangent is not within 45 degrees of the axis")?;
    }
    Ok(())
}

/// The least g.p of the control points p, as a fraction with a positive denominator.
fn least(pieces: &[Rc<Piece>], g: &[BigInt; 3]) -> Result<(BigInt, BigInt), Why> {
    let axis = constant(g);
    let mut least: Option<(BigInt, BigInt)> = None;
    for piece in pieces {
        check(piece.w.is_positive(), WEIGHTS)?;
        for (p, w) in dot(&piece.r, &axis).0.into_iter().zip(piece.full_weight().0) {
            if least.as_ref().is_none_or(|(num, den)| &p * den < num * &w) {
                least = Some((p, w));
            }
        }
    }
    least.ok_or("there are no control points")
}

/// Whether num/den is > 2 r |g|.
fn apart(num: &BigInt, den: &BigInt, g: &[BigInt; 3], r: &Squared) -> Result<(), Why> {
    let far = num.sign() == Sign::Plus && num * num * &r.den > (&r.num * square(g) * den * den) << 2_u8;
    check(far, "the two are not so far apart along the normal")
}

pub(super) fn slab(a: &[Rc<Piece>], b: &[Rc<Piece>], g: &[i64; 3], r: &Squared) -> Result<(), Why> {
    let g = g.map(BigInt::from);
    let ((p, v), (q, w)) = (least(a, &g)?, least(b, &g.each_ref().map(|c| -c))?);
    apart(&(p * &w + q * &v), &(v * w), &g, r)
}

pub(super) fn end_slab(end: &End, pieces: &[Rc<Piece>], g: &[i64; 3], r: &Squared) -> Result<(), Why> {
    let g = g.map(BigInt::from);
    let (p, v) = least(pieces, &g)?;
    let q: BigInt = end.r.iter().zip(&g).map(|(c, g)| c * g).sum();
    apart(&(p * &end.w - q * &v), &(v * &end.w), &g, r)
}

/// Adds f(s) g(t) D.a(s), where D.a(s) = (r.a)(s) w(t) - (w a)(s).r(t).
fn add_first(sum: &mut Tensor, [f, g]: &[Poly; 2], p: &Products, b: &Piece) {
    sum.add(&f.times(&p.ra), &g.times(&b.w));
    let minus = f.scaled(&-BigInt::one());
    p.wa.iter().zip(&b.r).for_each(|(wa, r)| sum.add(&minus.times(wa), &g.times(r)));
}

/// Adds f(s) g(t) D.a(t), where D.a(t) = r(s).(w a)(t) - w(s) (r.a)(t).
fn add_second(sum: &mut Tensor, [f, g]: &[Poly; 2], a: &Piece, q: &Products) {
    sum.add(&f.times(&a.w), &g.scaled(&-BigInt::one()).times(&q.ra));
    a.r.iter().zip(&q.wa).for_each(|(r, wa)| sum.add(&f.times(r), &g.times(wa)));
}

/// v and v' of the page without common factor.
fn first_weights(a: &Piece, b: &Piece) -> Result<[BigInt; 2], Why> {
    let [v, w] = [a, b].map(|piece| piece.w.0.first().cloned().unwrap_or_default());
    check(v.sign() == Sign::Plus && w.sign() == Sign::Plus, WEIGHTS)?;
    let common = v.gcd(&w);
    Ok([v / &common, w / common])
}

pub(super) fn side(a: &Piece, b: &Piece, fields: [i64; 2]) -> Result<(), Why> {
    let ([x, y], [v, w]) = (fields.map(BigInt::from), first_weights(a, b)?);
    let (mut sum, one) = (Tensor::default(), Poly(vec![BigInt::one()]));
    add_first(&mut sum, &[Poly(vec![x * &w * &w]), one.clone()], a.products(), b);
    add_second(&mut sum, &[one, Poly(vec![y * &v * &v])], a, b.products());
    check(sum.sign().is_some(), "the coefficients have no strict common sign")
}

pub(super) fn bent(a: &Piece, b: &Piece, fields: [i64; 6], r: &Squared) -> Result<(), Why> {
    check(bent_form(a, b, fields, r)?.sign() == Some(true), NOT_POSITIVE)
}

/// A positive multiple of the form of `bent`.
pub(super) fn bent_form(a: &Piece, b: &Piece, fields: [i64; 6], r: &Squared) -> Result<Tensor, Why> {
    let ([x, y, g, h, u, v], unit) = (fields.map(BigInt::from), BigInt::one() << UNIT);
    let twice = |x: &BigInt| x << 1_u8;
    // 2 - u and 2 - v, times 2^32
    let (of_a, of_b) = (twice(&unit) - &u, twice(&unit) - &v);
    check([&of_a, &of_b].iter().all(|x| **x > unit && **x < &unit * 3), "a weight grows too fast")?;
    let [first, second] = first_weights(a, b)?;
    // k = top / bottom
    let (top, bottom) = (second * of_a, first * of_b);
    // 1 + g (x - s) + u (1/2 - s) at s = 0 and at s = 1, times 2^65
    let line = |x: &BigInt, g: &BigInt, u: &BigInt| {
        let [from, to] = [x.clone(), x - &unit].map(|offset| twice(&(&unit * &unit + g * offset)));
        Poly(vec![from + u * &unit, to - u * &unit])
    };
    // 1 + u (s - 1/2) at both ends, times 2^33; times 2^33 alone if the weight is constant
    let weight = |piece: &Piece, u: &BigInt| match piece.w.0.len() {
        1 => Poly(vec![twice(&unit)]),
        _ => Poly(vec![twice(&unit) - u, twice(&unit) + u]),
    };
    let (p, q) = (a.products(), b.products());
    // everything times top, bottom, the denominator of r^2 and 2^130
    let plain = (&top * &bottom) << (4 * UNIT + 2);
    let mut sum = Tensor::default();
    let square = &plain * &r.den;
    sum.add(&p.rr.scaled(&square), &q.ww);
    sum.add(&p.ww.scaled(&square), &q.rr);
    let twice_less = -twice(&square);
    p.rw.iter().zip(&q.rw).for_each(|(f, g)| sum.add(&f.scaled(&twice_less), g));
    sum.add(&p.ww.scaled(&-twice(&twice(&(plain * &r.num)))), &q.ww);
    let own = |at: Poly, line: Poly, k: &BigInt| at.times(&line).scaled(&(k * k * &r.den));
    let of_s = own(Poly(vec![x.clone(), &x - &unit]), line(&x, &g, &u), &top);
    let of_t = own(Poly(vec![-&y, &unit - &y]), line(&y, &h, &v), &bottom);
    add_first(&mut sum, &[of_s, weight(b, &v)], p, b);
    add_second(&mut sum, &[weight(a, &u), of_t], a, q);
    Ok(sum)
}

pub(super) fn share(end: &End, piece: &Piece, k: i64, r: &Squared) -> Result<(), Why> {
    check((0..=1 << UNIT).contains(&k), "the share is not in 0 .. 2^32")?;
    check(share_form(end, piece, k, r).is_positive(), NOT_POSITIVE)
}

/// The form of `share` times 2^64 and the denominator of r^2.
pub(super) fn share_form(end: &End, piece: &Piece, k: i64, r: &Squared) -> Poly {
    let (k, unit) = (BigInt::from(k), BigInt::one() << UNIT);
    let (a, d) = (piece.a(), constant(&end.a));
    let q = zip(piece.r.each_ref(), end.r.each_ref(), |r, e| r.scaled(&end.w).minus(piece.w.scaled(e)));
    let u = cross(&d, a);
    let (squared, other) = (|f: Poly| f.times(&f), &unit - &k);
    let of_end = squared(dot(a, &q)).times(&dot(&d, &d)).scaled(&(&k * &unit));
    let of_body = squared(dot(&d, &q)).times(&dot(a, a)).scaled(&(&other * &unit));
    let between = squared(dot(&u, &q)).scaled(&(k * other));
    let disks = dot(&u, &u).times(&squared(piece.w.scaled(&end.w))).scaled(&(&r.num * &unit * &unit));
    of_end.plus(of_body).plus(between).scaled(&r.den).minus(disks)
}
