//! The spine as exact pieces: docs/certificate-format.md, section 2.

use std::cell::{OnceCell, RefCell};
use std::collections::HashMap;
use std::rc::Rc;

use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::{One, Signed, Zero};

use super::poly::{Poly, Vector, cross, dot};
use super::rules::{Why, check};
use crate::curve::Curve;
use crate::number::{Rational, same};

/// No part is deeper than so many halvings, so positions are integers over 2^DEPTH.
pub(super) const DEPTH: usize = 512;
/// The halves of so many pieces are kept for the next pair that may want them.
const KEPT: usize = 2048;

/// Consecutive spans, or a part of one span.
pub(super) type Arc = Rc<[Rc<Piece>]>;
type Lines = [Vec<BigInt>; 4];

/// A span or a part of one. All is up to one positive factor.
pub(super) struct Piece {
    /// Where it lies on the spine, over 2^DEPTH.
    pub(super) from: BigInt,
    pub(super) to: BigInt,
    pub(super) r: Vector,
    pub(super) w: Poly,
    a: OnceCell<Vector>,
    products: OnceCell<Products>,
}

/// What pairs of pieces need of each.
pub(super) struct Products {
    pub(super) rr: Poly,
    pub(super) ww: Poly,
    pub(super) rw: Vector,
    /// Paired with (r, w) of another piece D.a: D.a(s) = (r.a)(s) w(t) - (w a)(s).r(t).
    pub(super) tilt: [Poly; 4],
}

impl Piece {
    pub(super) fn new(from: BigInt, to: BigInt, mut r: Vector, mut w: Poly) -> Rc<Self> {
        let all = || r.iter().chain([&w]).flat_map(|f| &f.0);
        let twos = all().filter_map(BigInt::trailing_zeros).min().unwrap_or(0);
        r.iter_mut().chain([&mut w]).flat_map(|f| &mut f.0).for_each(|c| *c >>= twos);
        Rc::new(Self { from, to, r, w, a: OnceCell::new(), products: OnceCell::new() })
    }

    /// A positive multiple of C'.
    pub(super) fn a(&self) -> &Vector {
        // the derivative of a constant is the empty sum, and the product with it a zero of the degree of a
        let minor = |r: &Poly| r.derivative().times(&self.w).minus(r.times(&self.w.derivative()));
        self.a.get_or_init(|| self.r.each_ref().map(minor))
    }

    /// a x a' = w b, a multiple of C' x C'': for a' = r'' w - r w''.
    pub(super) fn wb(&self) -> Vector {
        cross(self.a(), &self.a().each_ref().map(Poly::derivative))
    }

    pub(super) fn products(&self) -> &Products {
        self.products.get_or_init(|| {
            let [x, y, z] = self.a().each_ref().map(|a| Poly::default().minus(a.times(&self.w)));
            Products {
                rr: dot(&self.r, &self.r),
                ww: self.w.times(&self.w),
                rw: self.r.each_ref().map(|r| r.times(&self.w)),
                tilt: [x, y, z, dot(&self.r, self.a())],
            }
        })
    }

    /// r and w together.
    pub(super) fn point(&self) -> [&Poly; 4] {
        let [x, y, z] = &self.r;
        [x, y, z, &self.w]
    }

    /// w in the degree of r.
    pub(super) fn full_weight(&self) -> Poly {
        let ([x, ..], mut w) = (&self.r, self.w.clone());
        w.raise(x.0.len());
        w
    }

    /// The point at t, and a there, as a piece of the degree 0.
    pub(super) fn at(&self, t: &Rational) -> Rc<Self> {
        let at = |f: &Poly| f.at(t);
        let place = Self::new(BigInt::zero(), BigInt::zero(), self.r.each_ref().map(at), at(&self.full_weight()));
        place.a.get_or_init(|| self.a().each_ref().map(at));
        place
    }

    /// The vector C - C' from another piece to this one, times both weights.
    pub(super) fn away_from(&self, other: &Self) -> Vector {
        let ([x, y, z], [u, v, w]) = (&self.r, &other.r);
        [(x, u), (y, v), (z, w)].map(|(r, p)| r.times(&other.w).minus(p.times(&self.w)))
    }

    /// The part between two local parameters; from the greater to the less it runs back.
    pub(super) fn part(&self, from: &Rational, to: &Rational) -> Rc<Self> {
        let (a, b, q) = (from.numer() * to.denom(), to.numer() * from.denom(), from.denom() * to.denom());
        let [x, y, z, w] = self.point().map(|f| f.between(&a, &b, &q));
        // all times q^degree of r, of which a constant weight has not had its share
        let w = w.scaled(&q.pow((x.0.len() - w.0.len()) as u32));
        let place = |t: &Rational| &self.from + (&self.to - &self.from) * t.numer() / t.denom();
        Self::new(place(from), place(to), [x, y, z], w)
    }
}

pub(super) struct Spine {
    pub(super) spans: Arc,
    pub(super) closed: bool,
    /// The last halves made, by the middle of the piece.
    kept: RefCell<HashMap<BigInt, [Arc; 2]>>,
}

impl Spine {
    pub(super) fn of(curve: &Curve) -> Self {
        let span = |(k, [x, y, z, mut w]): (usize, Lines)| {
            // a first weight of 0 makes all 0, which `curved` finds
            let sign = w.first().map(BigInt::signum).unwrap_or_default();
            w.truncate(if w.iter().all(|v| w.first() == Some(v)) { 1 } else { w.len() });
            let [x, y, z, w] = [x, y, z, w].map(|c| Poly::bernstein(c).scaled(&sign));
            Piece::new(BigInt::from(k) << DEPTH, BigInt::from(k + 1) << DEPTH, [x, y, z], w)
        };
        let mut spine = Self::open(bezier(curve).enumerate().map(span).collect());
        spine.closed = spine.is_smooth(0);
        spine
    }

    pub(super) fn open(spans: Arc) -> Self {
        Self { spans, closed: false, kept: RefCell::default() }
    }

    pub(super) fn halves(&self, arc: &Arc) -> Result<[Arc; 2], Why> {
        let [piece] = &**arc else {
            let (first, second) = arc.split_at(arc.len() / 2);
            return Ok([first.into(), second.into()]);
        };
        let middle: BigInt = (&piece.from + &piece.to) >> 1_u8;
        check(middle > piece.from, "a part deeper than 512 halvings")?;
        let mut kept = self.kept.borrow_mut();
        if kept.len() >= KEPT {
            kept.clear();
        }
        let parts = || {
            let [zero, half, one] = [0, 1, 2].map(|k| Rational::new(k.into(), 2.into()));
            [piece.part(&zero, &half), piece.part(&half, &one)].map(|part| Rc::new([part]) as Arc)
        };
        Ok(kept.entry(middle).or_insert_with(parts).clone())
    }

    /// Whether `a` and `b`, `a` before `b`, touch in the parameter.
    pub(super) fn touch(&self, a: &Arc, b: &Arc) -> bool {
        let finish = || BigInt::from(self.spans.len()) << DEPTH;
        match (&**a, &**b) {
            ([.., end], [start, ..]) if end.to == start.from => true,
            ([start, ..], [.., end]) => self.closed && start.from.is_zero() && end.to == finish(),
            _ => false,
        }
    }

    /// Whether the ends that meet at joint `k`, at 0 finish and start, are one point, and whether they have one direction.
    pub(super) fn joint(&self, k: usize) -> Option<[bool; 2]> {
        let before = if k == 0 { self.spans.last() } else { self.spans.get(k - 1) };
        let (p, q) = (before?.at(&Rational::one()), self.spans.get(k)?.at(&Rational::zero()));
        let is_zero = |v: Vector| v.iter().all(Poly::is_zero);
        Some([is_zero(p.away_from(&q)), is_zero(cross(p.a(), q.a())) && dot(p.a(), q.a()).is_positive()])
    }

    pub(super) fn is_smooth(&self, k: usize) -> bool {
        self.joint(k) == Some([true, true])
    }
}

/// The homogeneous control points of each span, x, y, z, w apart, as integers.
fn bezier(curve: &Curve) -> impl Iterator<Item = Lines> {
    let (n, points) = (curve.degree(), curve.control_points().iter().zip(curve.weights()));
    let points: Vec<_> = points.flat_map(|([x, y, z], w)| [x * w, y * w, z * w, w.clone()]).collect();
    (n..curve.control_points().len()).filter_map(move |k| {
        // the knots round the span, and the points that count there
        let (below, above) = (curve.knots().get(k + 1 - n..=k)?, curve.knots().get(k + 1..=k + n)?);
        let (start, end) = Some((below.last()?, above.first()?)).filter(|(start, end)| !same(start, end))?;
        let (points, _) = integers(points.get(4 * (k - n)..4 * k + 4)?);
        let lines = [0, 1, 2, 3].map(|k| points.iter().skip(k).step_by(4).cloned().collect());
        // the coefficients over the knots start, ..., start and those above; then over start, ..., start, end, ..., end
        let mut half = blossoms(lines, below, above, start, true);
        half.iter_mut().for_each(|line| line.reverse());
        let lines = blossoms(half, &vec![start.clone(); n], above, end, false);
        // remainders first: a gcd of numbers of very different lengths is slow
        let numbers = lines.iter().flatten().filter(|c| !c.is_zero()).cloned();
        let common = numbers.reduce(|common, c| common.gcd(&(c % &common))).unwrap_or_else(BigInt::one);
        Some(lines.map(|line| line.iter().map(|c| c / &common).collect()))
    })
}

/// These, times their least common denominator, and that.
fn integers(numbers: &[Rational]) -> (Vec<BigInt>, BigInt) {
    let common = numbers.iter().fold(BigInt::one(), |common, x| common.lcm(x.denom()));
    (numbers.iter().map(|x| x.numer() * (&common / x.denom())).collect(), common)
}

/// An edge of de Boor's triangle over n knots below and n above a span: its number k is the blossom at k times x and the
/// n - k knots next to the span on the side of the edge. All is times one number > 0.
fn blossoms(mut lines: Lines, below: &[Rational], above: &[Rational], x: &Rational, last: bool) -> Lines {
    let mut found = Lines::default();
    for level in 0..=above.len() {
        found.iter_mut().zip(&lines).for_each(|(f, l)| f.extend(if last { l.last() } else { l.first() }.cloned()));
        let minus = |p: &Rational, q: &Rational| p.numer() * q.denom() - q.numer() * p.denom();
        let share = |(low, up): (&_, &Rational)| Rational::new(minus(x, low) * up.denom(), minus(up, low) * x.denom());
        let (shares, common) = integers(&below.iter().skip(level).zip(above).map(share).collect::<Vec<_>>());
        found.iter_mut().flatten().for_each(|c| *c *= &common);
        lines = lines.map(|line| {
            let pairs = line.iter().zip(line.iter().skip(1));
            pairs.zip(&shares).map(|((p, q), share)| p * &common + (q - p) * share).collect()
        });
    }
    found
}
