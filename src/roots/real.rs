//! Real roots: square-free factors, then those of all complex roots in f64 (`fast`) that are real; where f64 fails, bisection
//! by Descartes' rule of signs on Bernstein coefficients.
//!
//! On an interval the roots inside are as many as the changes of sign of the Bernstein coefficients, or fewer by an even
//! number: none or one change decides. Of a square-free polynomial every small enough interval is decided.

use std::sync::Arc;

use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::{One, Signed, Zero};

use super::common::halves;
use super::complex::common;
use super::fast;
use super::power::{of_factors, square_free_factors, to_bernstein, to_power};
use crate::error::Error;
use crate::integer::Int;
use crate::number::{Rational, compare};

/// A real root of a polynomial, enclosed: the polynomial has exactly one root in the closed interval from `lo` to `hi`,
/// of this multiplicity.
#[derive(Debug, Clone)]
pub struct RealRoot {
    multiplicity: usize,
    /// A square-free factor that has the root, and no other in the interval; ascending powers.
    factor: Arc<Vec<Int>>,
    /// The interval from `start` to `start + length`, both over 2^`depth`; the length is 0 for a root that is known.
    start: BigInt,
    length: BigInt,
    depth: u64,
}

/// All real roots of the polynomial with these coefficients, the constant first, in increasing order; their intervals are
/// disjoint.
///
/// Every root is there, once, with its multiplicity: the square-free factors are exact, and an interval is given only where
/// Descartes' rule proves one root. Coefficients and roots may be of any size; the time grows with the degree and with the
/// logarithm of the least distance of two roots.
///
/// # Errors
/// [`ErrorKind::Irregular`](crate::ErrorKind::Irregular) for the zero polynomial, of which every number is a root.
///
/// ```
/// use tubecert::{number::parse_rational, roots::real_roots};
/// // (x - 0.1)(x - 0.6)^2
/// let coefficients = ["-0.036", "0.48", "-1.3", "1"].map(|text| parse_rational(text).unwrap());
/// let roots = real_roots(&coefficients).unwrap();
/// assert_eq!(roots.iter().map(|root| root.multiplicity()).collect::<Vec<_>>(), [1, 2]);
/// ```
pub fn real_roots(coefficients: &[Rational]) -> Result<Vec<RealRoot>, Error> {
    let at_zero = |factor, multiplicity| {
        let zero = BigInt::zero();
        RealRoot { multiplicity, factor, start: zero.clone(), length: zero, depth: 0 }
    };
    let mut roots = of_factors(coefficients, at_zero, |factor, multiplicity| {
        let found = fast::roots(factor);
        let Some(disks) = found.disks else {
            return [true, false].into_iter().flat_map(|negative| one_side(factor, multiplicity, negative)).collect();
        };
        let root = |disk: &fast::Disk| {
            let ([centre, _, radius], depth) = common([disk.centre.re, 0.0, disk.radius], found.scale);
            RealRoot { multiplicity, factor: factor.clone(), start: centre - &radius, length: radius * 2, depth }
        };
        disks.iter().filter(|disk| disk.centre.im == 0.0).map(root).collect()
    })?;
    part(&mut roots);
    Ok(roots)
}

impl RealRoot {
    /// How often it counts.
    #[must_use]
    pub const fn multiplicity(&self) -> usize {
        self.multiplicity
    }

    /// The lower end: the root itself if it is also the upper end.
    #[must_use]
    pub fn lo(&self) -> Rational {
        Rational::new(self.start.clone(), BigInt::one() << self.depth)
    }

    /// The upper end.
    #[must_use]
    pub fn hi(&self) -> Rational {
        Rational::new(&self.start + &self.length, BigInt::one() << self.depth)
    }

    /// Both ends, over 2 to the power that comes last.
    pub(crate) fn ends(&self) -> ([BigInt; 2], u64) {
        ([self.start.clone(), &self.start + &self.length], self.depth)
    }

    /// Narrows the interval to at most this length, if that is > 0, by quadratic interval refinement: each time the place is
    /// foreseen by a chord, and a smaller interval is taken where its two signs prove it right.
    pub fn refine(&mut self, length: &Rational) {
        if !length.is_positive() {
            return;
        }
        let mut bits = 2;
        let narrow =
            |root: &Self| compare(&Rational::new(root.length.clone(), BigInt::one() << root.depth), length).is_le();
        while !narrow(self) {
            bits = if self.refined(bits) { 2 * bits } else { (bits / 2).max(1) };
        }
    }

    /// The middle, over 2^depth.
    pub(super) fn middle(&self) -> (BigInt, u64) {
        ((&self.start << 1_u8) + &self.length, self.depth + 1)
    }

    /// Takes one of 2^bits parts of the interval, if it is the one where the chord meets the axis.
    fn refined(&mut self, bits: u64) -> bool {
        let scaled = |x: &BigInt| x << bits;
        let (start, depth) = (scaled(&self.start), self.depth + bits);
        let end = &start + scaled(&self.length);
        let (first, last) = (self.value(&start, depth), self.value(&end, depth));
        let (up, down) = (first.magnitude() << bits, first.magnitude() + last.magnitude());
        let parts = BigInt::one() << bits;
        // the grid point nearest to the chord's zero, inside
        let near = BigInt::from((up + (&down >> 1_u8)) / down).clamp(BigInt::one(), &parts - 1_u8);
        let at = |k: &BigInt| &start + k * &self.length;
        let here = self.value(&at(&near), depth);
        let (low, high) = if here.is_zero() {
            (near.clone(), near)
        } else if here.sign() == first.sign() {
            let next = &near + 1_u8;
            let there = self.value(&at(&next), depth);
            if there.sign() == first.sign() {
                return false;
            }
            (if there.is_zero() { next.clone() } else { near }, next)
        } else {
            let before = &near - 1_u8;
            let there = self.value(&at(&before), depth);
            if there.sign() != first.sign() && !there.is_zero() {
                return false;
            }
            (before.clone(), if there.is_zero() { before } else { near })
        };
        let (low, high) = (at(&low), at(&high));
        (self.length, self.start, self.depth) = (high - &low, low, depth);
        self.shorten();
        true
    }

    /// The factor at x / 2^depth, up to a positive factor.
    fn value(&self, x: &BigInt, depth: u64) -> BigInt {
        let mut value = BigInt::zero();
        for (k, c) in self.factor.iter().rev().enumerate() {
            value = value * x + (c.big() << (depth * k as u64));
        }
        value
    }

    /// In lowest terms.
    fn shorten(&mut self) {
        let twos = |x: &BigInt| x.trailing_zeros().unwrap_or(self.depth);
        let common = twos(&self.start).min(twos(&self.length)).min(self.depth);
        self.start >>= common;
        self.length >>= common;
        self.depth -= common;
    }
}

/// The roots inside (0, 1) of the polynomial, not zero, with these Bernstein coefficients, in increasing order; their
/// intervals are disjoint.
pub(crate) fn roots_inside(bernstein: &[Int]) -> Vec<RealRoot> {
    let p = to_power(bernstein);
    let mut roots = vec![];
    if p.len() > 1 {
        for (factor, multiplicity) in square_free_factors(&p) {
            let factor = Arc::new(factor);
            let root = |(index, depth, length): (Int, u64, u8)| RealRoot {
                multiplicity,
                factor: factor.clone(),
                start: index.big(),
                length: length.into(),
                depth,
            };
            roots.extend(isolate(to_bernstein(&factor)).into_iter().map(root));
        }
    }
    part(&mut roots);
    roots
}

/// The roots of a square-free factor that are > 0, or those that are < 0.
pub(super) fn one_side(factor: &Arc<Vec<Int>>, multiplicity: usize, negative: bool) -> Vec<RealRoot> {
    let turned = |(k, c): (usize, &Int)| if negative && k % 2 == 1 { -c } else { c.clone() };
    let p: Vec<Int> = factor.iter().enumerate().map(turned).collect();
    let bound = bound(&p);
    let last = p.len() - 1;
    let stretched = |(k, c): (usize, &Int)| {
        let times = if bound < 0 { last - k } else { k };
        c << (times as u64 * bound.unsigned_abs())
    };
    let cells = isolate(to_bernstein(&p.iter().enumerate().map(stretched).collect::<Vec<_>>()));
    let root = |(index, depth, length): (Int, u64, u8)| {
        let (start, length) = (index.big(), BigInt::from(length));
        let start = if negative { -(start + &length) } else { start };
        let up = u64::try_from(bound).unwrap_or(0).saturating_sub(depth);
        let depth = depth.saturating_add_signed(-bound);
        RealRoot { multiplicity, factor: factor.clone(), start: start << up, length: length << up, depth }
    };
    cells.into_iter().map(root).collect()
}

/// All roots are < 2^k in size.
pub(super) fn bound(p: &[Int]) -> i64 {
    let (lead, rest) = (&p[p.len() - 1], &p[..p.len() - 1]);
    // Fujiwara: at most twice the greatest |c / lead|^(1/j), j degrees below
    let each = rest.iter().rev().enumerate().filter(|(_, c)| !c.is_zero()).map(|(j, c)| {
        let ratio = c.bits() as i64 - lead.bits() as i64 + 1;
        Integer::div_ceil(&ratio, &(j as i64 + 1)) + 1
    });
    each.max().unwrap_or(0)
}

/// The roots inside (0, 1) of a square-free polynomial: cells `index` .. `index` + `length` over 2^depth whose ends are no
/// roots, or roots themselves, of length 0.
fn isolate(p: Vec<Int>) -> Vec<(Int, u64, u8)> {
    let (mut found, mut open) = (vec![], vec![(p, Int::ZERO, 0u64)]);
    while let Some((p, index, depth)) = open.pop() {
        let ends = !p[0].is_zero() && !p[p.len() - 1].is_zero();
        match changes(&p) {
            0 => {}
            1 if ends => found.push((index, depth, 1)),
            _ => {
                let (left, right) = halves(&p);
                let (twice, depth) = (&index << 1, depth + 1);
                let middle = &twice + &Int::ONE;
                if right[0].is_zero() {
                    found.push((middle.clone(), depth, 0));
                }
                open.push((right, middle, depth));
                open.push((left, twice, depth));
            }
        }
    }
    found
}

/// How often the sign changes, zeros left out.
fn changes(p: &[Int]) -> usize {
    let signs: Vec<_> = p.iter().map(Int::sign).filter(|sign| sign.is_ne()).collect();
    signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
}

/// Puts roots of several factors in order, narrowed until no two intervals meet.
fn part(roots: &mut [RealRoot]) {
    loop {
        // x / 2^m against y / 2^n
        let order = |(x, m): (&BigInt, u64), (y, n): (&BigInt, u64)| (x << n).cmp(&(y << m));
        roots.sort_by(|a, b| order((&a.start, a.depth), (&b.start, b.depth)));
        let meet = |a: &RealRoot, b: &RealRoot| order((&(&a.start + &a.length), a.depth), (&b.start, b.depth)).is_ge();
        let meeting = (1..roots.len()).find(|&i| meet(&roots[i - 1], &roots[i]));
        let Some(i) = meeting else { return };
        for root in &mut roots[i - 1..=i] {
            let half = Rational::new(root.length.clone(), BigInt::one() << (root.depth + 1));
            root.refine(&half);
        }
    }
}
