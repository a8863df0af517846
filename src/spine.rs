//! The spine: a chain of rational Bezier segments with every hypothesis of theory.md, section 1, checked exactly.

use crate::bernstein::{Form, int_binomials};
use crate::curve::Curve;
use crate::error::{Error, ErrorKind};
use crate::integer::{self, Int, exact_div, gcd, lcm};
use crate::number::{Rational, compare, rational_from_f64, same};
use crate::roots::{Place, common_zero};
use num_bigint::BigInt;
use num_traits::{One, Zero};
use std::cmp::Ordering;

/// A validated spine curve: continuous, regular, with a denominator that has no zero.
///
/// Corners are allowed: they make the tube radius 0 and are reported as the place of it.
#[derive(Debug, Clone)]
pub struct Spine {
    curve: Curve,
    pub(crate) segments: Vec<Segment>,
    pub(crate) closed: bool,
    pub(crate) corner: Option<Corner>,
}

/// One rational Bezier segment in integer homogeneous coordinates with w > 0: the point is (x, y, z) / w.
#[derive(Debug, Clone)]
pub(crate) struct Segment {
    pub(crate) from: Rational,
    pub(crate) to: Rational,
    pub(crate) bezier: Bezier,
}

/// Integer homogeneous control points; `w` holds one entry if the weight is constant, else as many as `x[0]`.
#[derive(Debug, Clone)]
pub(crate) struct Bezier {
    pub(crate) x: [Vec<Int>; 3],
    pub(crate) w: Vec<Int>,
}

impl Bezier {
    pub(crate) fn degree(&self) -> usize {
        self.x[0].len() - 1
    }

    /// The i-th homogeneous control point.
    pub(crate) fn point(&self, i: usize) -> [Int; 4] {
        [self.x[0][i].clone(), self.x[1][i].clone(), self.x[2][i].clone(), self.weight(i).clone()]
    }

    pub(crate) fn weight(&self, i: usize) -> &Int {
        &self.w[if self.w.len() == 1 { 0 } else { i }]
    }

    /// A positive multiple of the tangent at the start or the finish.
    pub(crate) fn end_tangent(&self, finish: bool) -> [Int; 3] {
        let n = self.degree();
        let (i, j) = if finish { (n - 1, n) } else { (0, 1) };
        let (p, q) = (self.point(i), self.point(j));
        [0, 1, 2].map(|k| &(&q[k] * &p[3]) - &(&p[k] * &q[3]))
    }

    /// Bernstein coefficients of the hodograph r'w - r w', up to a positive factor each, in a degree that may be one
    /// too high.
    fn hodograph(&self) -> Vec<Vec<Int>> {
        let n = self.degree();
        let (bn, bd) = (int_binomials(n), int_binomials(n - 1));
        self.x
            .iter()
            .map(|x| {
                let mut scaled = vec![Int::ZERO; 2 * n];
                for i in 0..n {
                    let (dx, dw) = (&x[i + 1] - &x[i], self.weight(i + 1) - self.weight(i));
                    for j in 0..=n {
                        let term = &(&dx * self.weight(j)) - &(&dw * &x[j]);
                        scaled[i + j] = &scaled[i + j] + &(&(&bd[i] * &bn[j]) * &term);
                    }
                }
                Form { ds: 2 * n - 1, dt: 0, exp: 0, c: scaled, norm: () }.bernstein()
            })
            .collect()
    }
}

/// Where the tangent jumps.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Corner {
    /// The segment that starts at the corner; 0 for the closure.
    pub(crate) joint: usize,
}

impl Spine {
    /// Reads a curve file (format: docs/interface, "Curve files").
    ///
    /// # Errors
    /// Everything that [`Curve::from_json_str`] and [`Spine::from_curve`] refuse.
    ///
    /// ```
    /// let spine = tubecert::Spine::from_json_str(
    ///     r#"{"degree": 2, "control_points": [[-1, 1], [0, -1], [1, 1]]}"#)?;
    /// assert!(!spine.is_closed());
    /// # Ok::<(), tubecert::Error>(())
    /// ```
    pub fn from_json_str(text: &str) -> Result<Self, Error> {
        Self::from_curve(Curve::from_json_str(text)?)
    }

    /// One Bezier segment from f64 coordinates, each taken as the dyadic rational that it is.
    ///
    /// # Errors
    /// NaN or infinite coordinates, and everything that [`Spine::from_curve`] refuses.
    pub fn bezier(points: &[[f64; 3]], weights: Option<&[f64]>) -> Result<Self, Error> {
        let degree = points.len().saturating_sub(1);
        Self::from_curve(Curve::new(degree, exact_points(points)?, exact_list("weights", weights)?, None)?)
    }

    /// A NURBS from f64 coordinates, each taken as the dyadic rational that it is; `knots` is the full vector.
    ///
    /// # Errors
    /// NaN or infinite numbers, and everything that [`Spine::from_curve`] refuses.
    ///
    /// ```
    /// use tubecert::{ErrorKind, Spine};
    /// let points = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [2.0, 0.0, 0.0]];
    /// let error = Spine::nurbs(2, &points, None, &[0.0, 0.0, 0.0, 1.0, 1.0, 0.5]).unwrap_err();
    /// assert_eq!((error.kind, error.index), (ErrorKind::KnotOrder, Some(5)));
    /// ```
    pub fn nurbs(degree: usize, points: &[[f64; 3]], weights: Option<&[f64]>, knots: &[f64]) -> Result<Self, Error> {
        let knots = exact_list("knots", Some(knots))?;
        Self::from_curve(Curve::new(degree, exact_points(points)?, exact_list("weights", weights)?, knots)?)
    }

    /// A NURBS from premultiplied control points (w x, w y, w z, w): these numbers define the curve, the quotients
    /// are formed exactly. Without `knots`, one Bezier segment.
    ///
    /// # Errors
    /// NaN or infinite numbers, a weight 0 (it has no Cartesian point), and what [`Spine::from_curve`] refuses.
    pub fn from_homogeneous(degree: usize, points: &[[f64; 4]], knots: Option<&[f64]>) -> Result<Self, Error> {
        let (mut cartesian, mut weights) = (vec![], vec![]);
        for (i, p) in points.iter().enumerate() {
            let [x, y, z, w] = exact_array("control_points", i, p)?;
            if w.is_zero() {
                return Err(Error::new(ErrorKind::WeightZero, "a premultiplied point of weight 0 is at infinity")
                    .key("control_points")
                    .index(i)
                    .help("give points with weights other than 0"));
            }
            cartesian.push([x / &w, y / &w, z / &w]);
            weights.push(w);
        }
        Self::from_curve(Curve::new(degree, cartesian, Some(weights), exact_list("knots", knots)?)?)
    }

    /// One Bezier segment from nalgebra points.
    ///
    /// # Errors
    /// As [`Spine::bezier`].
    #[cfg(feature = "nalgebra")]
    pub fn bezier_from_points(points: &[nalgebra::Point3<f64>], weights: Option<&[f64]>) -> Result<Self, Error> {
        let points: Vec<[f64; 3]> = points.iter().map(|p| [p.x, p.y, p.z]).collect();
        Self::bezier(&points, weights)
    }

    /// A NURBS from nalgebra points.
    ///
    /// # Errors
    /// As [`Spine::nurbs`].
    #[cfg(feature = "nalgebra")]
    pub fn nurbs_from_points(
        degree: usize,
        points: &[nalgebra::Point3<f64>],
        weights: Option<&[f64]>,
        knots: &[f64],
    ) -> Result<Self, Error> {
        let points: Vec<[f64; 3]> = points.iter().map(|p| [p.x, p.y, p.z]).collect();
        Self::nurbs(degree, &points, weights, knots)
    }

    /// Validates exact curve data: conversion to Bezier segments by exact knot insertion, then the hypotheses of
    /// theory.md, section 1: w without zero, hodograph without zero, tangents at the joints, closure.
    ///
    /// # Errors
    /// [`ErrorKind::WeightZero`] and [`ErrorKind::Irregular`], with the parameter in the message and, if there is one,
    /// the doubled control point as index.
    pub fn from_curve(curve: Curve) -> Result<Self, Error> {
        let mut segments = bezier_segments(&curve);
        for segment in &mut segments {
            orient(segment)?;
        }
        for segment in &segments {
            if let Some(place) = common_zero(&segment.bezier.hodograph()) {
                return Err(irregular(&curve, segment, &place));
            }
        }
        let (first, last) = (&segments[0].bezier, &segments[segments.len() - 1].bezier);
        let (start, end) = (first.point(0), last.point(last.degree()));
        let ends_meet = (0..3).all(|k| &start[k] * &end[3] == &end[k] * &start[3]);
        let smooth = |a: &Bezier, b: &Bezier| same_direction(&a.end_tangent(true), &b.end_tangent(false));
        let joint = segments.windows(2).position(|pair| !smooth(&pair[0].bezier, &pair[1].bezier));
        let closure_smooth = ends_meet && smooth(last, first);
        let corner = match joint {
            Some(before) => Some(Corner { joint: before + 1 }),
            None if ends_meet && !closure_smooth => Some(Corner { joint: 0 }),
            None => None,
        };
        Ok(Self { curve, segments, closed: closure_smooth, corner })
    }

    /// The exact data this spine was made of.
    #[must_use]
    pub fn curve(&self) -> &Curve {
        &self.curve
    }

    /// The curve file of this spine, with exact numbers: reading it back gives the same spine.
    #[must_use]
    pub fn to_json(&self) -> String {
        self.curve.to_json()
    }

    /// Do the ends meet with a common tangent direction (exactly)?
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// The number of Bezier segments (knot spans of positive length in the domain).
    #[must_use]
    pub fn spans(&self) -> usize {
        self.segments.len()
    }
}

fn exact_array<const N: usize>(key: &str, index: usize, p: &[f64; N]) -> Result<[Rational; N], Error> {
    let mut exact = std::array::from_fn(|_| Rational::zero());
    for (value, x) in exact.iter_mut().zip(p) {
        *value = rational_from_f64(*x).ok_or_else(|| {
            Error::new(ErrorKind::Number, format!("{x} is not a number that a curve can have")).key(key).index(index)
        })?;
    }
    Ok(exact)
}

fn exact_points(points: &[[f64; 3]]) -> Result<Vec<[Rational; 3]>, Error> {
    points.iter().enumerate().map(|(i, p)| exact_array("control_points", i, p)).collect()
}

fn exact_list(key: &str, list: Option<&[f64]>) -> Result<Option<Vec<Rational>>, Error> {
    let exact = |(i, x): (usize, &f64)| exact_array(key, i, &[*x]).map(|[r]| r);
    list.map(|list| list.iter().enumerate().map(exact).collect()).transpose()
}

/// Parallel and pointing the same way, exactly.
pub(crate) fn same_direction(a: &[Int; 3], b: &[Int; 3]) -> bool {
    let cross_is_zero = [(1, 2), (2, 0), (0, 1)].iter().all(|&(i, j)| &a[i] * &b[j] == &a[j] * &b[i]);
    cross_is_zero && integer::dot(a, b).sign() == Ordering::Greater
}

/// Makes w > 0, or reports its zero.
fn orient(segment: &mut Segment) -> Result<(), Error> {
    let w = &segment.bezier.w;
    let sign = w[0].sign();
    if let Some(place) = common_zero(std::slice::from_ref(w)) {
        return Err(Error::new(
            ErrorKind::WeightZero,
            format!("the denominator w vanishes {}", describe(segment, &place)),
        )
        .key("weights")
        .help("change the weights so that w keeps one sign on the domain"));
    }
    if sign == Ordering::Less {
        let bezier = &mut segment.bezier;
        for c in bezier.x.iter_mut().flatten().chain(&mut bezier.w) {
            *c = -&*c;
        }
    }
    Ok(())
}

fn describe(segment: &Segment, place: &Place) -> String {
    let unit = Rational::new(place.index.big(), BigInt::one() << place.depth);
    let length = &segment.to - &segment.from;
    let t = &segment.from + &unit * &length;
    if place.exact {
        format!("at t = {}", crate::number::to_fraction_text(&t))
    } else {
        format!("near t = {}", crate::number::nearest_text(crate::number::f64_below(&t)))
    }
}

fn irregular(curve: &Curve, segment: &Segment, place: &Place) -> Error {
    let points = curve.control_points();
    let error = Error::new(ErrorKind::Irregular, format!("the hodograph vanishes {}", describe(segment, place)));
    match points.windows(2).position(|p| (0..3).all(|k| same(&p[0][k], &p[1][k]))) {
        Some(i) => error.key("control_points").index(i + 1).help("remove this doubled control point"),
        None => error.key("control_points").help("split the curve there, or move control points so that C' is not 0"),
    }
}

/// Exact knot insertion, span by span, in integers. For one span the Bezier point j is the blossom at
/// (a, ..., a, b, ..., b) with j times b; de Boor's denominators on a level do not depend on the arguments, so that the
/// common denominator is the same for all j and drops out of homogeneous coordinates.
fn bezier_segments(curve: &Curve) -> Vec<Segment> {
    let (n, knots) = (curve.degree(), curve.knots());
    (n..curve.control_points().len())
        .filter(|&k| compare(&knots[k], &knots[k + 1]).is_lt())
        .map(|k| {
            let around = &knots[k + 1 - n..=k + n];
            let points = homogeneous(curve, k - n..=k);
            // between full knots the control points are the Bezier points already
            let full = same(&around[0], &around[n - 1]) && same(&around[n], &around[2 * n - 1]);
            let columns = if full {
                points
            } else {
                let u = common_integers(around, &common_denominator(around));
                (0..=n).map(|j| blossom(&points, &u, n, j)).collect()
            };
            Segment { from: knots[k].clone(), to: knots[k + 1].clone(), bezier: reduced(columns) }
        })
        .collect()
}

fn common_denominator(list: &[Rational]) -> BigInt {
    list.iter().fold(BigInt::one(), |l, x| lcm(&l, x.denom()))
}

/// The rationals times their common denominator.
fn common_integers(list: &[Rational], den: &BigInt) -> Vec<Int> {
    list.iter().map(|x| Int::from(x.numer() * (den / x.denom()))).collect()
}

fn homogeneous(curve: &Curve, range: std::ops::RangeInclusive<usize>) -> Vec<[Int; 4]> {
    let weights = &curve.weights()[range.clone()];
    let weights = common_integers(weights, &common_denominator(weights));
    let flat = curve.control_points()[range].as_flattened();
    let den = common_denominator(flat);
    let numerators = common_integers(flat, &den);
    let den = Int::from(den);
    numerators.chunks(3).zip(&weights).map(|(p, w)| [&p[0] * w, &p[1] * w, &p[2] * w, &den * w]).collect()
}

/// `u` holds knots[k+1-n ..= k+n], so u[n-1] = a and u[n] = b.
fn blossom(points: &[[Int; 4]], u: &[Int], n: usize, j: usize) -> [Int; 4] {
    let mut d = points.to_vec();
    for level in 1..=n {
        let argument = if level > n - j { &u[n] } else { &u[n - 1] };
        let lengths: Vec<Int> = (level..=n).map(|i| &u[i + n - level] - &u[i - 1]).collect();
        let common = lengths.iter().fold(BigInt::one(), |l, x| lcm(&l, &x.big()));
        let common = Int::from(common);
        for i in (level..=n).rev() {
            let share = exact_div(&common, &lengths[i - level]);
            let right = &(argument - &u[i - 1]) * &share;
            let left = &(&u[i + n - level] - argument) * &share;
            d[i] = std::array::from_fn(|k| &(&left * &d[i - 1][k]) + &(&right * &d[i][k]));
        }
    }
    d[n].clone()
}

/// Without common factor; a constant weight is held once.
fn reduced(points: Vec<[Int; 4]>) -> Bezier {
    let content = points.iter().flatten().fold(Int::ZERO, |g, c| gcd(&g, c));
    let divided = |k: usize| -> Vec<Int> {
        points.iter().map(|p| if content.is_zero() { Int::ZERO } else { exact_div(&p[k], &content) }).collect()
    };
    let mut w = divided(3);
    if w.iter().all(|x| *x == w[0]) {
        w.truncate(1);
    }
    Bezier { x: [divided(0), divided(1), divided(2)], w }
}
