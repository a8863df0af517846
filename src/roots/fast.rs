//! The roots of a square-free polynomial in plain f64: Aberth's iteration finds them, disks with a proved rounding error
//! (docs/rounding.md, section 10) prove them. Where a disk is too wide there is no answer, never a wrong one.

use super::real::bound;
use crate::bernstein::UNIT;
use crate::integer::{Int, ldexp};

/// Covers second-order terms and the rounding of the bounds themselves.
const SLACK: f64 = 1.0 + 1e-9;
/// Covers underflow in a value.
const TINY: f64 = 1e-290;
/// Below this, the squares in a distance underflow.
const NEAR: f64 = 1e-150;

#[derive(Debug, Clone, Copy)]
pub(super) struct Complex {
    pub(super) re: f64,
    pub(super) im: f64,
}

impl Complex {
    pub(super) const ZERO: Self = Self { re: 0.0, im: 0.0 };

    fn size(self) -> f64 {
        (self.re * self.re + self.im * self.im).sqrt()
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }

    /// Not below the size, nor much above.
    fn size_above(self) -> f64 {
        let size = self.size() * SLACK;
        if size > NEAR { size } else { self.re.abs() + self.im.abs() }
    }

    fn minus(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }

    pub(super) fn times(self, other: Self) -> Self {
        Self { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }

    /// 0 for the inverse of 0, or nearly.
    pub(super) fn inverse(self) -> Self {
        let norm = self.re * self.re + self.im * self.im;
        if norm < 1e-300 { Self::ZERO } else { Self { re: self.re / norm, im: -self.im / norm } }
    }
}

/// A root, and no other, lies strictly inside. The centre is real iff the root is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Disk {
    pub(super) centre: Complex,
    pub(super) radius: f64,
}

/// What f64 has found of the roots of p, all over 2^`scale`.
pub(super) struct Found {
    pub(super) scale: i64,
    /// As many as there are roots; nothing is proved about them.
    pub(super) places: Vec<Complex>,
    /// Disjoint; real ones, and those above the axis.
    pub(super) disks: Option<Vec<Disk>>,
}

/// Looks for the roots of an integer polynomial, not 0 at 0, of degree 1 or more.
pub(super) fn roots(p: &[Int]) -> Found {
    let scale = bound(p);
    // p(2^scale x), whose roots are in the unit disk, divided by 2^size
    let up = |k: usize| k as i64 * scale;
    let size = p.iter().enumerate().map(|(k, c)| c.bits() as i64 + up(k)).max().unwrap_or(0);
    let near: Vec<f64> = p.iter().enumerate().map(|(k, c)| c.to_f64_shifted(size - up(k))).collect();
    let mut places: Vec<Complex> = starts(p, scale)
        .into_iter()
        .map(|(z, exponent)| Complex { re: ldexp(z.re, exponent), im: ldexp(z.im, exponent) })
        .collect();
    aberth(&near, &mut places);
    let disks = disks(&near, &places);
    Found { scale, places, disks }
}

/// p(z) by Horner's rule, and a bound of its error, if the coefficients are off by at most two units of rounding.
fn value(p: &[f64], z: Complex, size: f64) -> (Complex, f64) {
    let (mut value, mut sum) = (Complex::ZERO, 0.0);
    for c in p.iter().rev() {
        value = value.times(z);
        value.re += c;
        sum = sum * size + value.re.abs() + value.im.abs();
    }
    (value, 9.0 * UNIT * sum * SLACK + TINY)
}

/// Until no place moves, or its value is all rounding.
fn aberth(p: &[f64], z: &mut [Complex]) {
    let slope = derivative(p);
    let mut open: Vec<usize> = (0..z.len()).collect();
    for _ in 0..100 {
        open.retain(|&i| {
            let here = z[i];
            let size = here.size();
            let (value, error) = value(p, here, size);
            let rate = slope.iter().rev().fold(Complex::ZERO, |sum, c| {
                let next = sum.times(here);
                Complex { re: next.re + c, ..next }
            });
            let newton = value.times(rate.inverse());
            let others = z.iter().enumerate().filter(|(j, _)| *j != i);
            let pull = others.map(|(_, other)| here.minus(*other).inverse()).fold(Complex::ZERO, Complex::plus);
            let pulled = newton.times(pull);
            let step = newton.times(Complex { re: 1.0 - pulled.re, im: -pulled.im }.inverse());
            z[i] = here.minus(step);
            // a quarter of the bound is met by rounding alone
            value.size() > 0.25 * error && step.size() > 2.0 * UNIT * size
        });
        if open.is_empty() {
            return;
        }
    }
}

fn derivative(p: &[f64]) -> Vec<f64> {
    p.iter().enumerate().skip(1).map(|(k, c)| k as f64 * c).collect()
}

fn disks(p: &[f64], places: &[Complex]) -> Option<Vec<Disk>> {
    let (slope, n) = (derivative(p), places.len() as f64);
    let disk = |centre: Complex| {
        let size = centre.size() * SLACK;
        let (value, error) = value(p, centre, size);
        let (rate, spread) = self::value(&slope, centre, size);
        let rate = rate.size() - spread;
        let radius = n * (value.size_above() + error) / rate * SLACK;
        (rate > NEAR && size <= 1.0 && radius.is_finite()).then_some(Disk { centre, radius })
    };
    let (mut real, mut above) = (vec![], vec![]);
    for &place in places {
        let found = disk(place)?;
        if place.im.abs() <= found.radius {
            real.push(disk(Complex { im: 0.0, ..place })?);
        } else if place.im > 0.0 {
            above.push(found);
        }
    }
    if real.len() + 2 * above.len() != places.len() {
        return None;
    }
    let apart = |a: &Disk, b: &Disk| a.centre.minus(b.centre).size() > (a.radius + b.radius) * SLACK + NEAR;
    real.extend(above);
    for (i, a) in real.iter().enumerate() {
        let below = Disk { centre: Complex { im: -a.centre.im, ..a.centre }, ..*a };
        let from_itself = a.centre.im == 0.0 || apart(a, &below);
        if !from_itself || !real[..i].iter().all(|b| apart(a, b) && (a.centre.im == 0.0 || apart(&below, b))) {
            return None;
        }
    }
    Some(real)
}

/// On circles whose radii the Newton polygon of the coefficients of p(2^scale x) gives; with powers of two apart, as f64
/// ends at 2^-1074.
pub(super) fn starts(p: &[Int], scale: i64) -> Vec<(Complex, i64)> {
    let logarithm = |(k, c): (usize, &Int)| {
        let bits = c.bits() as i64;
        // 0.5 <= m < 1 in place of log2 m: it only starts the iteration
        (bits + k as i64 * scale) as f64 + 2.0 * c.to_f64_shifted(bits).abs() - 2.0
    };
    let mut hull: Vec<(usize, f64)> = vec![];
    for (k, c) in p.iter().enumerate().filter(|(_, c)| !c.is_zero()) {
        let here = (k, logarithm((k, c)));
        let rise = |a: &(usize, f64), b: &(usize, f64)| (b.1 - a.1) / (b.0 - a.0) as f64;
        while hull.len() > 1 && rise(&hull[hull.len() - 2], &hull[hull.len() - 1]) <= rise(&hull[hull.len() - 1], &here)
        {
            hull.pop();
        }
        hull.push(here);
    }
    // a turn by the golden angle spreads any number of points
    let turn = Complex { re: -0.737_368_878_078_319_9, im: 0.675_490_294_261_523_8 };
    let mut direction = Complex { re: 0.8, im: 0.6 };
    let mut all = Vec::with_capacity(p.len());
    for edge in hull.windows(2) {
        let exponent = (edge[0].1 - edge[1].1) / (edge[1].0 - edge[0].0) as f64;
        let (radius, exponent) = (1.0 + exponent - exponent.floor(), exponent.floor() as i64);
        for _ in edge[0].0..edge[1].0 {
            direction = direction.times(turn);
            all.push((Complex { re: radius * direction.re, im: radius * direction.im }, exponent));
        }
    }
    all
}
