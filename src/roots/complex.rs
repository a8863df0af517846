//! Complex roots: Aberth's iteration for all roots at once finds them, disks prove them (theory.md, section 6).
//!
//! For a square-free p of degree n every disk |x - z| <= n |p(z) / p'(z)| holds a root; n disjoint ones hold one each.
//! f64 is tried first (`fast`); where disks meet there, the iteration is run with ever twice the digits.

use std::sync::Arc;

use num_bigint::BigInt;
use num_traits::{One, Signed, Zero};

use super::fast;
use super::power::{derivative, of_factors};
use super::real::{RealRoot, one_side};
use crate::error::Error;
use crate::integer::{Int, decompose};
use crate::number::{Rational, compare};

/// A complex root of a polynomial, enclosed: the polynomial has exactly one root in the closed disk, of this
/// multiplicity. A disk about a real centre holds a real root.
#[derive(Debug, Clone)]
pub struct ComplexRoot {
    multiplicity: usize,
    factor: Arc<Vec<Int>>,
    /// Centre and radius over 2^`depth`.
    centre: Gauss,
    radius: BigInt,
    depth: u64,
}

/// A Gaussian integer.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Gauss {
    re: BigInt,
    im: BigInt,
}

/// All complex roots of the polynomial with these coefficients, the constant first: real ones in increasing order, then
/// pairs, the root with a positive imaginary part before its conjugate. The disks are pairwise disjoint.
///
/// Multiplicities are exact (square-free factors over Q), the disks are proved in exact arithmetic. The time grows with the
/// degree and with the logarithm of the least distance of two roots.
///
/// # Errors
/// [`ErrorKind::Irregular`](crate::ErrorKind::Irregular) for the zero polynomial.
///
/// ```
/// use tubecert::{number::parse_rational, roots::complex_roots};
/// // x (x^2 + 1)^2
/// let coefficients = ["0", "1", "0", "2", "0", "1"].map(|text| parse_rational(text).unwrap());
/// let roots = complex_roots(&coefficients).unwrap();
/// assert_eq!(roots.iter().map(|root| root.multiplicity()).collect::<Vec<_>>(), [1, 2, 2]);
/// ```
pub fn complex_roots(coefficients: &[Rational]) -> Result<Vec<ComplexRoot>, Error> {
    complex_roots_while(coefficients, &mut || true).map(Option::unwrap_or_default)
}

/// The same, given up with `None` once `on` says no: it is asked for every place that moves.
pub(crate) fn complex_roots_while(
    coefficients: &[Rational],
    on: &mut dyn FnMut() -> bool,
) -> Result<Option<Vec<ComplexRoot>>, Error> {
    let mut ended = false;
    let at_zero = |factor, multiplicity| {
        let centre = Gauss { re: BigInt::zero(), im: BigInt::zero() };
        ComplexRoot { multiplicity, factor, centre, radius: BigInt::zero(), depth: 0 }
    };
    let mut roots = of_factors(coefficients, at_zero, |factor, multiplicity| {
        let found = if ended { None } else { isolated(factor, multiplicity, on) };
        ended |= found.is_none();
        found.unwrap_or_default()
    })?;
    if ended {
        return Ok(None);
    }
    let several = roots.windows(2).any(|pair| !Arc::ptr_eq(&pair[0].factor, &pair[1].factor));
    // those of different factors are different
    while let Some((i, j)) = several.then(|| meeting(&roots)).flatten() {
        for k in [i, j] {
            let half = roots[k].radius() / BigInt::from(2);
            roots[k].refine(&half);
        }
    }
    let pair = |root: &ComplexRoot| !root.centre.im.is_zero();
    roots.sort_by(|a, b| {
        let depth = a.depth.max(b.depth);
        let [x, y] = [a, b].map(|root| root.centre.shifted(depth - root.depth));
        let by_place = || x.re.cmp(&y.re).then_with(|| x.im.magnitude().cmp(y.im.magnitude()));
        pair(a).cmp(&pair(b)).then_with(by_place).then_with(|| y.im.cmp(&x.im))
    });
    Ok(Some(roots))
}

impl ComplexRoot {
    /// How often it counts.
    #[must_use]
    pub const fn multiplicity(&self) -> usize {
        self.multiplicity
    }

    /// The real part of the centre.
    #[must_use]
    pub fn re(&self) -> Rational {
        dyadic(&self.centre.re, self.depth)
    }

    /// The imaginary part of the centre: 0 for a real root.
    #[must_use]
    pub fn im(&self) -> Rational {
        dyadic(&self.centre.im, self.depth)
    }

    /// The radius of the disk: 0 for a root that is known.
    #[must_use]
    pub fn radius(&self) -> Rational {
        dyadic(&self.radius, self.depth)
    }

    /// A square-free factor, by rising powers, of which this is a root.
    pub(crate) fn factor(&self) -> &[Int] {
        &self.factor
    }

    /// Centre and radius over 2^depth.
    pub(crate) fn over(&self) -> ([&BigInt; 3], u64) {
        ([&self.centre.re, &self.centre.im, &self.radius], self.depth)
    }

    /// A disk n |p(z) / p'(z)| whose centre is that of this one cut to a multiple of 2^-`depth`: re, im, radius over
    /// 2^`depth`. `None` if p'(z) = 0 there.
    pub(crate) fn cut(&self, depth: u64) -> Option<[BigInt; 3]> {
        let at = |x: &BigInt| (x << depth) >> self.depth;
        let centre = Gauss { re: at(&self.centre.re), im: at(&self.centre.im) };
        let radius = disk(&self.factor, &derivative(&self.factor), &centre, depth)?;
        Some([centre.re, centre.im, radius])
    }

    /// Narrows the disk to at most this radius, if that is > 0: Newton's method, each disk proved to lie in the one before.
    pub fn refine(&mut self, radius: &Rational) {
        if !radius.is_positive() {
            return;
        }
        let slope = derivative(&self.factor);
        let mut bits = 8;
        while compare(&self.radius(), radius).is_gt() {
            let (at, old, depth) = (self.centre.shifted(bits), &self.radius << bits, self.depth + bits);
            let step = at.value(&self.factor, depth).over(&at.value(&slope, depth));
            let next = Gauss { re: &at.re - step.re, im: &at.im - step.im };
            match disk(&self.factor, &slope, &next, depth) {
                Some(radius) if at.holds(&old, &next, &radius) && radius <= &old >> 1_u8 => {
                    (self.centre, self.radius, self.depth) = (next, radius, depth);
                    bits *= 2;
                }
                // the step was rounded too coarsely
                _ => bits += 8,
            }
        }
    }
}

fn dyadic(x: &BigInt, depth: u64) -> Rational {
    Rational::new(x.clone(), BigInt::one() << depth)
}

impl Gauss {
    fn shifted(&self, bits: u64) -> Self {
        Self { re: &self.re << bits, im: &self.im << bits }
    }

    fn minus(&self, other: &Self) -> Self {
        Self { re: &self.re - &other.re, im: &self.im - &other.im }
    }

    fn bits(&self) -> u64 {
        self.re.bits().max(self.im.bits())
    }

    fn norm(&self) -> BigInt {
        &self.re * &self.re + &self.im * &self.im
    }

    /// p at this point over 2^depth, times 2^(depth n).
    fn value(&self, p: &[Int], depth: u64) -> Self {
        let (mut re, mut im) = (BigInt::zero(), BigInt::zero());
        for (k, c) in p.iter().rev().enumerate() {
            let next = &re * &self.re - &im * &self.im + (c.big() << (depth * k as u64));
            im = &re * &self.im + &im * &self.re;
            re = next;
        }
        Self { re, im }
    }

    /// The quotient, rounded; 0 for a divisor of 0.
    fn over(&self, other: &Self) -> Self {
        let norm = other.norm().max(BigInt::one());
        let re = &self.re * &other.re + &self.im * &other.im;
        let im = &self.im * &other.re - &self.re * &other.im;
        Self { re: re / &norm, im: im / norm }
    }

    /// Does the disk about this point hold another?
    fn holds(&self, radius: &BigInt, inner: &Self, less: &BigInt) -> bool {
        less <= radius && self.minus(inner).norm() <= (radius - less).pow(2)
    }
}

/// n |p(z) / p'(z)| from above, times 2^depth; `None` if p'(z) = 0.
fn disk(p: &[Int], slope: &[Int], z: &Gauss, depth: u64) -> Option<BigInt> {
    let n = BigInt::from(p.len() - 1);
    let (value, rate) = (z.value(p, depth).norm() * &n * n, z.value(slope, depth).norm());
    if value.is_zero() {
        return Some(value);
    }
    (!rate.is_zero()).then(|| (value / rate).sqrt() + 1_u8)
}

/// Two disks that meet.
fn meeting(roots: &[ComplexRoot]) -> Option<(usize, usize)> {
    let apart = |a: &ComplexRoot, b: &ComplexRoot| {
        let depth = a.depth.max(b.depth);
        let [(x, r), (y, s)] = [a, b].map(|c| (c.centre.shifted(depth - c.depth), &c.radius << (depth - c.depth)));
        x.minus(&y).norm() > (r + s).pow(2)
    };
    (0..roots.len()).flat_map(|j| (0..j).map(move |i| (i, j))).find(|(i, j)| !apart(&roots[*i], &roots[*j]))
}

/// The roots of a square-free factor without the root 0: in f64, or with as many digits as it takes.
fn isolated(factor: &Arc<Vec<Int>>, multiplicity: usize, on: &mut dyn FnMut() -> bool) -> Option<Vec<ComplexRoot>> {
    let found = fast::roots(factor);
    if let Some(disks) = &found.disks {
        let root = |disk: &fast::Disk| {
            let ([re, im, radius], depth) = common([disk.centre.re, disk.centre.im, disk.radius], found.scale);
            ComplexRoot { multiplicity, factor: factor.clone(), centre: Gauss { re, im }, radius, depth }
        };
        return Some(disks.iter().flat_map(|disk| with_conjugate(root(disk))).collect());
    }
    isolated_slowly(factor, multiplicity, &found, on)
}

fn with_conjugate(root: ComplexRoot) -> impl Iterator<Item = ComplexRoot> {
    let Gauss { re, im } = &root.centre;
    let conjugate = (!im.is_zero()).then(|| ComplexRoot { centre: Gauss { re: re.clone(), im: -im }, ..root.clone() });
    std::iter::once(root).chain(conjugate)
}

/// Three f64 times 2^scale, as integers over one power of two.
pub(super) fn common(numbers: [f64; 3], scale: i64) -> ([BigInt; 3], u64) {
    let parts = numbers.map(decompose);
    let exponent = |(m, e): (i64, i64)| if m == 0 { i64::MAX } else { e + scale };
    let least = parts.map(exponent).into_iter().min().unwrap_or(0).min(0);
    let shifted = |(m, e): (i64, i64)| if m == 0 { BigInt::zero() } else { BigInt::from(m) << (e + scale - least) };
    (parts.map(shifted), least.unsigned_abs())
}

fn isolated_slowly(
    factor: &Arc<Vec<Int>>,
    multiplicity: usize,
    near: &fast::Found,
    on: &mut dyn FnMut() -> bool,
) -> Option<Vec<ComplexRoot>> {
    let real: Vec<RealRoot> = [true, false].iter().flat_map(|negative| one_side(factor, 1, *negative)).collect();
    let (n, slope, scale) = (factor.len() - 1, derivative(factor), near.scale);
    if real.len() == n {
        return Some(all_real(factor, multiplicity, real));
    }
    let real = real.len();
    // p(2^scale x), whose roots are in the unit disk
    let shift = |k: usize| if scale < 0 { n - k } else { k } as u64 * scale.unsigned_abs();
    let p: Vec<Int> = factor.iter().enumerate().map(|(k, c)| c << shift(k)).collect();
    let size = p.iter().map(Int::bits).max().unwrap_or(0);
    let mut found: Vec<Fixed> = vec![];
    let (mut bits, mut lost) = (32, false);
    loop {
        bits *= 2;
        if bits == 64 {
            found = near.places.iter().map(|z| fixed(z, 0, bits)).collect();
        } else {
            let near: Vec<Fixed> = p
                .iter()
                .map(|c| {
                    let re = c.big() << bits >> size;
                    Fixed { z: Gauss { re, im: BigInt::zero() }, bits }
                })
                .collect();
            found = if lost {
                fast::starts(factor, scale).iter().map(|(z, e)| fixed(z, *e, bits)).collect()
            } else {
                found.iter().map(|x| Fixed { z: x.z.shifted(bits - x.bits), bits }).collect()
            };
            aberth(&near, &mut found, 8 - bits as i64, on)?;
        }
        let depth = bits.saturating_add_signed(-scale);
        let place = |x: &Fixed| x.z.shifted((scale.max(0) as u64).saturating_sub(bits));
        let centres: Vec<Gauss> = found.iter().map(place).collect();
        let centres = symmetric(centres, real);
        // iterates that were rounded to the real axis never leave it
        lost = centres.is_none();
        let Some(centres) = centres else { continue };
        let root = |centre: Gauss| {
            let radius = disk(factor, &slope, &centre, depth)?;
            Some(ComplexRoot { multiplicity, factor: factor.clone(), centre, radius, depth })
        };
        let Some(upper) = centres.into_iter().map(root).collect::<Option<Vec<_>>>() else { continue };
        let roots: Vec<ComplexRoot> = upper.into_iter().flat_map(with_conjugate).collect();
        if meeting(&roots).is_none() {
            return Some(roots);
        }
    }
}

/// About the middles of intervals that are refined until the disks are apart.
fn all_real(factor: &Arc<Vec<Int>>, multiplicity: usize, mut places: Vec<RealRoot>) -> Vec<ComplexRoot> {
    let slope = derivative(factor);
    loop {
        let root = |place: &RealRoot| {
            let (re, depth) = place.middle();
            let centre = Gauss { re, im: BigInt::zero() };
            let radius = disk(factor, &slope, &centre, depth)?;
            Some(ComplexRoot { multiplicity, factor: factor.clone(), centre, radius, depth })
        };
        let roots = places.iter().map(root).collect::<Option<Vec<_>>>();
        if let Some(roots) = roots.filter(|roots| meeting(roots).is_none()) {
            return roots;
        }
        for place in &mut places {
            place.refine(&((place.hi() - place.lo()) / (BigInt::one() << 20_u8)));
        }
    }
}

/// As many places as there are real roots are put on the axis; of the others those above are taken, if they are half.
fn symmetric(mut places: Vec<Gauss>, real: usize) -> Option<Vec<Gauss>> {
    places.sort_by_cached_key(|z| z.im.abs());
    places.iter_mut().take(real).for_each(|z| z.im = BigInt::zero());
    let half = (places.len() - real) / 2;
    places.retain(|z| !z.im.is_negative());
    let above = places.iter().filter(|z| z.im.is_positive()).count();
    (above == half && places.len() == real + half).then_some(places)
}

/// Aberth's iteration, until no step is above 2^`goal`, or each place rests: once its value is all rounding, these digits
/// cannot better it. `None` once `on` says no.
fn aberth(p: &[Fixed], z: &mut [Fixed], goal: i64, on: &mut dyn FnMut() -> bool) -> Option<()> {
    let last = &p[p.len() - 1];
    let zero = last.minus(last);
    // each step of Horner's rule is off by four units or fewer
    let rounding = (4 * p.len()).ilog2() as u64 + 1;
    let mut open: Vec<usize> = (0..z.len()).collect();
    for _ in 0..200 {
        let mut ended = false;
        open.retain(|&i| {
            ended = ended || !on();
            if ended {
                return false;
            }
            let (mut value, mut slope) = (last.clone(), zero.clone());
            for c in p.iter().rev().skip(1) {
                slope = slope.times(&z[i]).plus(&value);
                value = value.times(&z[i]).plus(c);
            }
            if value.z.bits() <= rounding {
                return false;
            }
            let newton = value.over(&slope);
            // the others only turn the step of Newton's method
            let pull = (0..z.len()).filter(|&j| j != i).map(|j| z[i].minus(&z[j]).near().inverse());
            let x = newton.near().times(pull.fold(fast::Complex::ZERO, fast::Complex::plus));
            let turn = x.times(fast::Complex { re: 1.0 - x.re, im: -x.im }.inverse());
            let step = newton.plus(&newton.times(&fixed(&turn, 0, newton.bits)));
            z[i] = z[i].minus(&step);
            step.exponent() > goal
        });
        if ended {
            return None;
        }
        if open.is_empty() {
            break;
        }
    }
    Some(())
}

/// z 2^exponent; 0 for what is not finite.
fn fixed(z: &fast::Complex, exponent: i64, bits: u64) -> Fixed {
    let part = |x: f64| {
        let (m, e) = if x.is_finite() { decompose(x) } else { (0, 0) };
        let shift = bits as i64 + exponent + e;
        if shift < 0 { BigInt::from(m) >> shift.unsigned_abs() } else { BigInt::from(m) << shift.unsigned_abs() }
    };
    Fixed { z: Gauss { re: part(z.re), im: part(z.im) }, bits }
}

/// A Gaussian integer over 2^bits.
#[derive(Debug, Clone)]
struct Fixed {
    z: Gauss,
    bits: u64,
}

impl Fixed {
    fn plus(&self, other: &Self) -> Self {
        Self { z: Gauss { re: &self.z.re + &other.z.re, im: &self.z.im + &other.z.im }, bits: self.bits }
    }

    fn minus(&self, other: &Self) -> Self {
        Self { z: self.z.minus(&other.z), bits: self.bits }
    }

    fn times(&self, other: &Self) -> Self {
        let (a, b) = (&self.z, &other.z);
        let z = Gauss {
            re: (&a.re * &b.re - &a.im * &b.im) >> self.bits,
            im: (&a.re * &b.im + &a.im * &b.re) >> self.bits,
        };
        Self { z, bits: self.bits }
    }

    /// The quotient; 0 for a divisor of 0.
    fn over(&self, other: &Self) -> Self {
        Self { z: self.z.shifted(self.bits).over(&other.z), bits: self.bits }
    }

    /// In f64; 0 for what is too small.
    fn near(&self) -> fast::Complex {
        let part = |x: &BigInt| Int::from(x.clone()).to_f64_shifted(self.bits as i64);
        fast::Complex { re: part(&self.z.re), im: part(&self.z.im) }
    }

    /// About log2 of the size.
    fn exponent(&self) -> i64 {
        self.z.bits() as i64 - self.bits as i64
    }
}
