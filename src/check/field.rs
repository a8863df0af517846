//! Maps of the plane on squares, in parts on each of which they are polynomials: whether they vanish, and how often.

use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::{One, Zero};

use super::poly::Poly;
use super::range::Range;
use crate::number::Rational;

/// In a square: F at the first corner, a matrix Y near the inverse of its derivatives F', and Y F'.
pub(super) struct Field {
    sizes: [Range; 2],
    corner: [Range; 2],
    inverse: [[Range; 2]; 2],
    product: [[Range; 2]; 2],
}

impl Field {
    /// From all parts, the first of them at the first corner, with their sizes; and the sizes of the square. `None` if the
    /// matrix in the middle of the derivatives is singular.
    pub(super) fn of(parts: impl Iterator<Item = ([Net; 2], [Range; 2])>, sizes: [Range; 2]) -> Option<Self> {
        let part = |(nets, [x, y]): ([Net; 2], [Range; 2])| {
            (nets.each_ref().map(Net::corner), nets.each_ref().map(|net| [net.slope(true, &x), net.slope(false, &y)]))
        };
        type Part = ([Range; 2], [[Range; 2]; 2]);
        let join = |(corner, [[a, b], [c, d]]): Part, (_, [[e, f], [g, h]]): Part| {
            (corner, [[a.with(e), b.with(f)], [c.with(g), d.with(h)]])
        };
        let (corner, slopes) = parts.map(part).reduce(join)?;
        let [[a, b], [c, d]] = slopes.each_ref().map(|row| row.each_ref().map(|r| (&r.lo + &r.hi) / BigInt::from(2)));
        let det = &a * &d - &b * &c;
        if det.is_zero() {
            return None;
        }
        let inverse = [[&d, &-b], [&-c, &a]].map(|row| row.map(|x| Range::point(&(x / &det))));
        let [first, second] = &slopes;
        let column = |[u, v]: &[Range; 2], k: fn(&[Range; 2]) -> &Range| &(u * k(first)) + &(v * k(second));
        let product = inverse.each_ref().map(|row| [column(row, |[a, _]| a), column(row, |[_, b]| b)]);
        Some(Self { sizes, corner, inverse, product })
    }

    /// Every matrix within the product is regular: F takes no value twice.
    pub(super) fn once(&self) -> bool {
        let [[a, b], [c, d]] = &self.product;
        a.is_positive() && d.is_positive() && (&(a * d) - &(&b.size() * &c.size())).is_positive()
    }

    /// Krawczyk: z - Y F(z) + (1 - Y F')(X - z) is inside the square X, for the corner z.
    pub(super) fn vanishes(&self) -> bool {
        let ([f, g], [l, m], one) = (&self.corner, &self.sizes, Range::point(&Rational::one()));
        let zero = Range::point(&Rational::zero());
        let from = |size: &Range| zero.clone().with(size.clone());
        let inside = |[u, v]: &[Range; 2], along: Range, across: Range, size: &Range| {
            let image = &(&along + &across) - &(&(u * f) + &(v * g));
            image.is_positive() && (size - &image).is_positive()
        };
        let ([first, second], [[a, b], [c, d]]) = (&self.inverse, &self.product);
        inside(first, &(&one - a) * &from(l), &(&zero - b) * &from(m), l)
            && inside(second, &(&zero - c) * &from(l), &(&one - d) * &from(m), m)
    }
}

/// The Bernstein coefficients of a form in two variables, times a factor, over a common denominator.
pub(super) struct Net {
    rows: Vec<Vec<BigInt>>,
    unit: Rational,
}

impl Net {
    pub(super) fn of(form: Poly<Poly>, factor: Rational) -> Self {
        let shares = |length: usize| {
            let mut binomials = Poly::constant(1);
            binomials.raise(length);
            let common = binomials.0.iter().fold(BigInt::one(), |common, c| common.lcm(c));
            (binomials.0.iter().map(|c| &common / c).collect::<Vec<_>>(), common)
        };
        let (down, first) = shares(form.0.len());
        let (across, second) = shares(form.0.first().map_or(0, |row| row.0.len()));
        let row = |(row, k): (&Poly, &BigInt)| row.0.iter().zip(&across).map(|(c, l)| c * k * l).collect();
        Self { rows: form.0.iter().zip(&down).map(row).collect(), unit: factor / (first * second) }
    }

    fn corner(&self) -> Range {
        Range::point(&(&self.unit * self.rows.first().and_then(|row| row.first()).unwrap_or(&BigInt::zero())))
    }

    /// Holds the derivative in one variable, for a square of this size.
    fn slope(&self, of_s: bool, size: &Range) -> Range {
        let degree = if of_s { self.rows.len() } else { self.rows.first().map_or(0, Vec::len) }.saturating_sub(1);
        let after = self.rows.iter().skip(usize::from(of_s));
        let pairs = self.rows.iter().zip(after).flat_map(|(a, b)| a.iter().zip(b.iter().skip(usize::from(!of_s))));
        let rises: Vec<BigInt> = pairs.map(|(a, b)| b - a).collect();
        let bound = |rise: Option<&BigInt>| &self.unit * (rise.unwrap_or(&BigInt::zero()) * degree) / &size.lo;
        Range { lo: bound(rises.iter().min()), hi: bound(rises.iter().max()) }
    }
}
