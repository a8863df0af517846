//! The spine as exact pieces: docs/certificate-format.md, section 2.

use std::cell::{OnceCell, RefCell};
use std::collections::VecDeque;
use std::rc::{Rc, Weak};

use num_bigint::{BigInt, Sign};
use num_integer::Integer;
use num_traits::{One, Zero};

use super::poly::{Poly, Vector, cross, dot, zip};
use crate::curve::Curve;
use crate::number::{Rational, compare, same};

/// No part is deeper than so many halvings, so positions are integers over 2^DEPTH.
const DEPTH: usize = 512;
/// So many pieces are kept for the next pair that may want them.
const KEPT: usize = 4096;

/// A span or a part of one. All is up to one positive factor.
pub(super) struct Piece {
    /// Where it lies on the spine, over 2^DEPTH.
    pub(super) from: BigInt,
    pub(super) to: BigInt,
    pub(super) r: Vector,
    pub(super) w: Poly,
    a: OnceCell<Vector>,
    products: OnceCell<Products>,
    halves: RefCell<[Weak<Piece>; 2]>,
}

/// What pairs of pieces need of each.
pub(super) struct Products {
    pub(super) rr: Poly,
    pub(super) ww: Poly,
    pub(super) ra: Poly,
    pub(super) rw: Vector,
    pub(super) wa: Vector,
}

impl Piece {
    pub(super) fn new(from: BigInt, to: BigInt, mut r: Vector, mut w: Poly) -> Rc<Self> {
        let all = || r.iter().chain([&w]).flat_map(|f| &f.0);
        let twos = all().filter_map(BigInt::trailing_zeros).min().unwrap_or(0);
        r.iter_mut().chain([&mut w]).flat_map(|f| &mut f.0).for_each(|c| *c >>= twos);
        let (a, products) = (OnceCell::new(), OnceCell::new());
        Rc::new(Self { from, to, r, w, a, products, halves: RefCell::default() })
    }

    /// A positive multiple of C'.
    pub(super) fn a(&self) -> &Vector {
        self.a.get_or_init(|| {
            self.r.each_ref().map(|r| {
                let a = r.derivative().times(&self.w);
                if self.has_constant_weight() { a } else { a.minus(r.times(&self.w.derivative())) }
            })
        })
    }

    /// A multiple of C' x C''.
    pub(super) fn b(&self) -> Vector {
        let (r, w) = (&self.r, &self.w);
        let r1 = r.each_ref().map(Poly::derivative);
        let r2 = r1.each_ref().map(Poly::derivative);
        let times = |v: Vector, f: &Poly| v.map(|c| c.times(f));
        let first = times(cross(&r1, &r2), w);
        if self.has_constant_weight() {
            return first;
        }
        let w1 = w.derivative();
        let (second, third) = (times(cross(r, &r2), &w1), times(cross(r, &r1), &w1.derivative()));
        zip(zip(first, second, Poly::minus), third, Poly::plus)
    }

    pub(super) fn products(&self) -> &Products {
        self.products.get_or_init(|| Products {
            rr: dot(&self.r, &self.r),
            ww: self.w.times(&self.w),
            ra: dot(&self.r, self.a()),
            rw: self.r.each_ref().map(|r| r.times(&self.w)),
            wa: self.a().each_ref().map(|a| a.times(&self.w)),
        })
    }

    fn has_constant_weight(&self) -> bool {
        self.w.0.len() == 1
    }

    /// w in the degree of r.
    pub(super) fn full_weight(&self) -> Poly {
        let mut w = self.w.clone();
        self.r.iter().for_each(|r| w.raise(r.0.len()));
        w
    }

    /// The first point, its weight, and a there.
    pub(super) fn first(&self) -> End {
        let first = |f: &Poly| f.0.first().cloned().unwrap_or_default();
        End { r: self.r.each_ref().map(first), w: first(&self.w), a: self.a().each_ref().map(first) }
    }

    pub(super) fn last(&self) -> End {
        let last = |f: &Poly| f.0.last().cloned().unwrap_or_default();
        End { r: self.r.each_ref().map(last), w: last(&self.w), a: self.a().each_ref().map(last) }
    }
}

/// An end of a piece.
pub(super) struct End {
    pub(super) r: [BigInt; 3],
    pub(super) w: BigInt,
    pub(super) a: [BigInt; 3],
}

impl End {
    fn same_point(&self, other: &Self) -> bool {
        self.r.iter().zip(&other.r).all(|(p, q)| p * &other.w == q * &self.w)
    }

    fn same_direction(&self, other: &Self) -> bool {
        let vector = |v: &[BigInt; 3]| v.clone().map(|c| Poly(vec![c]));
        let (a, b) = (vector(&self.a), vector(&other.a));
        cross(&a, &b).iter().all(Poly::is_zero) && dot(&a, &b).is_positive()
    }
}

/// A block of two or more consecutive spans, or one piece.
#[derive(Clone)]
pub(super) enum Arc {
    Block(usize, usize),
    Piece(Rc<Piece>),
}

pub(super) struct Spine {
    pub(super) spans: Vec<Rc<Piece>>,
    pub(super) closed: bool,
    /// The last pieces made, so that their owners find them again.
    kept: RefCell<VecDeque<Rc<Piece>>>,
}

impl Spine {
    pub(super) fn of(curve: &Curve) -> Result<Self, &'static str> {
        let mut spans = vec![];
        for points in bezier(curve) {
            let [x, y, z, w] = points;
            let turned = match w.first().map(BigInt::sign) {
                Some(Sign::Plus) => BigInt::one(),
                Some(Sign::Minus) => -BigInt::one(),
                _ => return Err("a span starts with the weight 0"),
            };
            let constant = w.iter().zip(w.iter().skip(1)).all(|(v, w)| v == w);
            let w = if constant { w.into_iter().take(1).collect() } else { w };
            let [x, y, z, w] = [x, y, z, w].map(|c| Poly::bernstein(c).scaled(&turned));
            let from = BigInt::from(spans.len());
            spans.push(Piece::new(&from << DEPTH, (from + 1) << DEPTH, [x, y, z], w));
        }
        let mut spine = Self { spans, closed: false, kept: RefCell::default() };
        spine.closed = spine.is_smooth(0);
        Ok(spine)
    }

    pub(super) fn whole(&self) -> Arc {
        self.block(0, self.spans.len())
    }

    fn block(&self, from: usize, to: usize) -> Arc {
        match self.spans.get(from..to) {
            Some([span]) => Arc::Piece(span.clone()),
            _ => Arc::Block(from, to),
        }
    }

    pub(super) fn pieces<'a>(&'a self, arc: &'a Arc) -> &'a [Rc<Piece>] {
        match arc {
            Arc::Block(from, to) => self.spans.get(*from..*to).unwrap_or_default(),
            Arc::Piece(piece) => std::slice::from_ref(piece),
        }
    }

    pub(super) fn halves(&self, arc: &Arc) -> Result<[Arc; 2], &'static str> {
        let piece = match arc {
            Arc::Block(from, to) => {
                let middle = from + (to - from) / 2;
                return Ok([self.block(*from, middle), self.block(middle, *to)]);
            }
            Arc::Piece(piece) => piece,
        };
        let old = piece.halves.borrow().each_ref().map(Weak::upgrade);
        if let [Some(first), Some(second)] = old {
            return Ok([Arc::Piece(first), Arc::Piece(second)]);
        }
        let middle: BigInt = (&piece.from + &piece.to) >> 1_u8;
        if middle == piece.from {
            return Err("a part deeper than 512 halvings");
        }
        // by 2^degree of r, of which a constant weight has not had its share
        let [x, ..] = &piece.r;
        let shift = x.0.len() - piece.w.0.len();
        let half = |f: &Poly| f.first_half();
        let other = |f: &Poly| f.reversed().first_half().reversed();
        let scaled = |w: Poly| Poly(w.0.into_iter().map(|c| c << shift).collect());
        let first =
            Piece::new(piece.from.clone(), middle.clone(), piece.r.each_ref().map(half), scaled(half(&piece.w)));
        let second = Piece::new(middle, piece.to.clone(), piece.r.each_ref().map(other), scaled(other(&piece.w)));
        *piece.halves.borrow_mut() = [&first, &second].map(Rc::downgrade);
        let mut kept = self.kept.borrow_mut();
        kept.extend([first.clone(), second.clone()]);
        while kept.len() > KEPT {
            kept.pop_front();
        }
        Ok([Arc::Piece(first), Arc::Piece(second)])
    }

    /// Where an arc lies on the spine, over 2^DEPTH.
    pub(super) fn place(&self, arc: &Arc) -> [BigInt; 2] {
        match arc {
            Arc::Block(from, to) => [from, to].map(|k| BigInt::from(*k) << DEPTH),
            Arc::Piece(piece) => [piece.from.clone(), piece.to.clone()],
        }
    }

    /// Whether `a` and `b`, `a` before `b`, touch in the parameter.
    pub(super) fn touch(&self, a: &Arc, b: &Arc) -> bool {
        let ([from, to], [next, end]) = (self.place(a), self.place(b));
        to == next || (self.closed && from.is_zero() && end == BigInt::from(self.spans.len()) << DEPTH)
    }

    /// The two ends that meet at joint `k`; at 0 the finish and the start.
    fn joint(&self, k: usize) -> Option<[End; 2]> {
        let before = if k == 0 { self.spans.last() } else { self.spans.get(k - 1) };
        Some([before?.last(), self.spans.get(k)?.first()])
    }

    pub(super) fn is_smooth(&self, k: usize) -> bool {
        self.joint(k).is_some_and(|[before, after]| before.same_point(&after) && before.same_direction(&after))
    }

    pub(super) fn ends_meet(&self) -> bool {
        self.joint(0).is_some_and(|[finish, start]| start.same_point(&finish))
    }
}

/// The homogeneous control points of each span, x, y, z, w apart, as integers.
fn bezier(curve: &Curve) -> impl Iterator<Item = [Vec<BigInt>; 4]> {
    let n = curve.degree();
    let knots = curve.knots();
    let homogeneous = |([x, y, z], w): (&[Rational; 3], &Rational)| [x * w, y * w, z * w, w.clone()];
    let spans = (n..curve.control_points().len()).filter_map(move |k| {
        let (start, end) = (knots.get(k)?, knots.get(k + 1)?);
        let local = knots.get(k + 1 - n..k + 1 + n)?;
        let points = curve.control_points().get(k - n..=k)?.iter().zip(curve.weights().get(k - n..=k)?);
        compare(start, end).is_lt().then(|| (start, end, local, points.map(homogeneous).collect::<Vec<_>>()))
    });
    spans.map(move |(start, end, local, mut points)| {
        // control point j is the blossom at j times the end, the other times the start of the span
        let mut control = Vec::with_capacity(n + 1);
        for j in 0..=n {
            if j > 0 {
                points = blossom(&points, local, j, end);
            }
            let one = (j + 1..=n).fold(points.clone(), |points, level| blossom(&points, local, level, start));
            control.extend(one);
        }
        let common = control.iter().flatten().fold(BigInt::one(), |common, c| common.lcm(c.denom()));
        let integer = |c: &Rational| c.numer() * (&common / c.denom());
        let mut all = [vec![], vec![], vec![], vec![]];
        for point in &control {
            all.iter_mut().zip(point).for_each(|(list, c)| list.push(integer(c)));
        }
        all
    })
}

/// One level of de Boor's triangle over the 2n knots round the span: the argument `level` of the blossom is `x`.
fn blossom(points: &[[Rational; 4]], knots: &[Rational], level: usize, x: &Rational) -> Vec<[Rational; 4]> {
    let pairs = points.iter().zip(points.iter().skip(1));
    let around = knots.iter().skip(level - 1).zip(knots.iter().skip(knots.len() / 2));
    let between = pairs.zip(around).map(|((p, q), (low, high))| {
        // at an end of the interval nothing is computed: the common case, and exact numbers grow
        if same(x, low) || same(x, high) {
            return if same(x, low) { p.clone() } else { q.clone() };
        }
        let share = (x - low) / (high - low);
        let mix = |p: &Rational, q: &Rational| p + (q - p) * &share;
        let ([px, py, pz, pw], [qx, qy, qz, qw]) = (p, q);
        [mix(px, qx), mix(py, qy), mix(pz, qz), mix(pw, qw)]
    });
    between.collect()
}
