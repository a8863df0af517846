//! An upper bound for delta found by sampling: straight from the definition (theory.md, section 2), sharing no code
//! with the library.
//!
//! Everything is looked for in f64, on the curve moved and scaled into a box of size 1, and then *evaluated again in
//! rational arithmetic* on the untouched data. What is reported are exact facts: 1/kappa(t), rho(s, t), or a valley
//! (W3). So `delta.lo` must not exceed them by anything at all, and f64 noise can only make the oracle miss something.
#![allow(dead_code)] // each test binary uses a part

use num_bigint::BigInt;
use num_traits::{Num, One, Signed, ToPrimitive, Zero};
use std::ops::Neg;
use tubecert::{Curve, Radius, Rational, Spine};

// ---------------------------------------------------------------------------------------------------------------
// A B-spline over any field: de Boor, twice, with control points of derivatives.

/// What both arithmetics can do.
pub trait Field: Num + Neg<Output = Self> + Clone + PartialOrd {}
impl<T: Num + Neg<Output = T> + Clone + PartialOrd> Field for T {}

/// Homogeneous control points (w x, w y, w z, w) and the full knot vector.
#[derive(Debug, Clone)]
pub struct Bspline<T> {
    degree: usize,
    knots: Vec<T>,
    points: Vec<[T; 4]>,
}

/// C, C', C'' at a parameter.
pub type Jet<T> = [[T; 3]; 3];

impl<T: Field> Bspline<T> {
    /// The spans that are not empty, by the index of the knot before.
    fn spans(&self) -> Vec<usize> {
        (self.degree..self.points.len()).filter(|&k| self.knots[k] < self.knots[k + 1]).collect()
    }

    /// Control points of the derivative of order 0, 1, 2 that matter on span k.
    fn control(&self, k: usize, order: usize) -> Vec<[T; 4]> {
        let p = self.degree;
        let mut c: Vec<[T; 4]> = self.points[k - p..=k].to_vec();
        for level in 0..order {
            let n = p - level; // the degree of c
            let mut factor = T::zero();
            for _ in 0..n {
                factor = factor + T::one();
            }
            c = (1..c.len())
                .map(|j| {
                    let i = k - n + j; // index of c[j]
                    let length = self.knots[i + n].clone() - self.knots[i].clone();
                    let step = factor.clone() / length;
                    std::array::from_fn(|x| step.clone() * (c[j][x].clone() - c[j - 1][x].clone()))
                })
                .collect();
            if c.is_empty() {
                break;
            }
        }
        c
    }

    fn de_boor(&self, k: usize, mut c: Vec<[T; 4]>, t: &T) -> [T; 4] {
        if c.is_empty() {
            return std::array::from_fn(|_| T::zero());
        }
        let n = c.len() - 1;
        for level in 1..=n {
            for j in (level..=n).rev() {
                let from = self.knots[j + k - n].clone();
                let to = self.knots[j + 1 + k - level].clone();
                let share = (t.clone() - from.clone()) / (to - from);
                let rest = T::one() - share.clone();
                c[j] = std::array::from_fn(|x| rest.clone() * c[j - 1][x].clone() + share.clone() * c[j][x].clone());
            }
        }
        c[n].clone()
    }

    /// C, C', C'' at t as seen from span k.
    pub fn jet(&self, k: usize, t: &T) -> Jet<T> {
        let [h0, h1, h2] = [0, 1, 2].map(|order| {
            if order > self.degree {
                return std::array::from_fn(|_| T::zero());
            }
            self.de_boor(k, self.control(k, order), t)
        });
        let w = h0[3].clone();
        let c: [T; 3] = std::array::from_fn(|x| h0[x].clone() / w.clone());
        let c1: [T; 3] = std::array::from_fn(|x| (h1[x].clone() - h1[3].clone() * c[x].clone()) / w.clone());
        let two = T::one() + T::one();
        let c2 = std::array::from_fn(|x| {
            (h2[x].clone() - two.clone() * h1[3].clone() * c1[x].clone() - h2[3].clone() * c[x].clone()) / w.clone()
        });
        [c, c1, c2]
    }
}

pub fn sub<T: Field>(a: &[T; 3], b: &[T; 3]) -> [T; 3] {
    std::array::from_fn(|k| a[k].clone() - b[k].clone())
}

pub fn dot<T: Field>(a: &[T; 3], b: &[T; 3]) -> T {
    a[0].clone() * b[0].clone() + a[1].clone() * b[1].clone() + a[2].clone() * b[2].clone()
}

pub fn cross<T: Field>(a: &[T; 3], b: &[T; 3]) -> [T; 3] {
    let minor = |i: usize, j: usize| a[i].clone() * b[j].clone() - a[j].clone() * b[i].clone();
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

fn max<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { b } else { a }
}

/// rho(s, t)^2 from the two points and tangents; `None` if the normal planes do not meet. Exact over an exact field.
pub fn rho_sq<T: Field>(p: &[T; 3], d: &[T; 3], q: &[T; 3], a: &[T; 3]) -> Option<T> {
    let two = T::one() + T::one();
    let gap = sub(q, p);
    let u = cross(d, a);
    let uu = dot(&u, &u);
    if uu.is_zero() {
        let coplanar = dot(d, &gap).is_zero() && dot(a, &gap).is_zero();
        return coplanar.then(|| dot(&gap, &gap) / (two.clone() * two));
    }
    let sq = |x: T| x.clone() * x;
    // squared distances of the two points from the line in which the planes meet, and of the two feet
    let from_p = sq(dot(a, &gap)) * dot(d, d) / uu.clone();
    let from_q = sq(dot(d, &gap)) * dot(a, a) / uu.clone();
    let feet = sq(dot(&u, &gap)) / uu;
    if from_p >= from_q.clone() + feet.clone() {
        return Some(from_p);
    }
    if from_q >= from_p.clone() + feet.clone() {
        return Some(from_q);
    }
    // the point of the line that is as far from p as from q
    let along = sq(from_q - from_p.clone() + feet.clone()) / (two.clone() * two * feet);
    Some(from_p + along)
}

/// 1/kappa^2; `None` where kappa = 0.
pub fn bend_sq<T: Field>(jet: &Jet<T>) -> Option<T> {
    let b = cross(&jet[1], &jet[2]);
    let (bb, speed) = (dot(&b, &b), dot(&jet[1], &jet[1]));
    (!bb.is_zero()).then(|| speed.clone() * speed.clone() * speed / bb)
}

// ---------------------------------------------------------------------------------------------------------------
// Sampling.

/// Why delta is not larger. Parameters are shares of the domain.
#[derive(Debug, Clone, PartialEq)]
pub enum Why {
    /// 1/kappa at t, from the span with this number.
    Bend { span: usize, t: f64 },
    /// Two normal disks that meet.
    Disks { s: f64, t: f64 },
    /// A point with a nearest point inside either arc.
    Valley { x: [f64; 3], s: [f64; 3], t: [f64; 3] },
    /// A point of the normal plane of an end, with a nearest point inside the arc.
    EndValley { finish: bool, x: [f64; 3], t: [f64; 3] },
}

/// An upper bound for delta.
#[derive(Debug, Clone)]
pub struct Bound {
    pub why: Why,
    /// In the box of size 1, numerically.
    pub near: f64,
    /// The square in the unit of the curve, exactly.
    pub exact_sq: Rational,
}

/// The least bounds found, best first; none for a straight spine.
#[derive(Debug, Clone)]
pub struct Sampled {
    pub bounds: Vec<Bound>,
}

impl Sampled {
    pub fn least(&self) -> Option<&Bound> {
        self.bounds.first()
    }

    /// The square root of the least exact bound, to double precision.
    pub fn delta(&self) -> f64 {
        self.least().map_or(f64::INFINITY, |b| root(&b.exact_sq))
    }
}

/// sqrt of a rational of any size.
pub fn root(x: &Rational) -> f64 {
    if x.is_zero() {
        return 0.0;
    }
    let bits = x.numer().bits() as i64 - x.denom().bits() as i64;
    let half = bits.div_euclid(2);
    let scaled = x * power_of_two(-2 * half);
    let value = scaled.to_f64().unwrap_or(f64::NAN).sqrt();
    // in two steps, as 2^half alone may leave the range
    let (a, b) = (half / 2, half - half / 2);
    value * 2f64.powi(a as i32) * 2f64.powi(b as i32)
}

pub fn power_of_two(e: i64) -> Rational {
    let p = Rational::from_integer(BigInt::one() << e.unsigned_abs());
    if e < 0 { p.recip() } else { p }
}

pub fn exact(x: f64) -> Rational {
    Rational::from_float(x).expect("finite")
}

/// A point of the curve with its tangent of length 1.
#[derive(Clone, Copy)]
struct Sample {
    u: f64,
    c: [f64; 3],
    tangent: [f64; 3],
}

/// The curve in both arithmetics.
pub struct Oracle {
    exact: Bspline<Rational>,
    near: Bspline<f64>,
    spans: Vec<usize>,
    /// Ends of the spans as shares of the domain.
    ends: Vec<(f64, f64)>,
    domain: (Rational, Rational),
    origin: [Rational; 3],
    size: Rational,
    pub closed: bool,
}

impl Oracle {
    pub fn new(curve: &Curve) -> Self {
        let homogeneous = |p: &[Rational; 3], w: &Rational| [&p[0] * w, &p[1] * w, &p[2] * w, w.clone()];
        let points: Vec<[Rational; 4]> =
            curve.control_points().iter().zip(curve.weights()).map(|(p, w)| homogeneous(p, w)).collect();
        let exact = Bspline { degree: curve.degree(), knots: curve.knots().to_vec(), points };
        let domain = (curve.knots()[curve.degree()].clone(), curve.knots()[curve.control_points().len()].clone());

        // into the box, exactly, before anything is rounded
        let origin = curve.control_points()[0].clone();
        let mut size = Rational::zero();
        for p in curve.control_points() {
            for k in 0..3 {
                size = max(size, (&p[k] - &origin[k]).abs());
            }
        }
        if size.is_zero() {
            size = Rational::one();
        }
        let heaviest = curve.weights().iter().fold(Rational::zero(), |m, w| max(m, w.abs()));
        let f = |x: Rational| x.to_f64().unwrap_or(f64::NAN);
        let points = curve
            .control_points()
            .iter()
            .zip(curve.weights())
            .map(|(p, w)| {
                let p: [Rational; 3] = std::array::from_fn(|k| (&p[k] - &origin[k]) / &size);
                homogeneous(&p, &(w / &heaviest)).map(f)
            })
            .collect();
        let length = &domain.1 - &domain.0;
        let knots = curve.knots().iter().map(|t| f((t - &domain.0) / &length)).collect();
        let near = Bspline { degree: curve.degree(), knots, points };
        let spans = exact.spans();
        let ends = spans.iter().map(|&k| (near.knots[k], near.knots[k + 1])).collect();

        let first = exact.jet(spans[0], &domain.0);
        let last = exact.jet(spans[spans.len() - 1], &domain.1);
        let turned = cross(&first[1], &last[1]);
        let closed =
            first[0] == last[0] && turned.iter().all(Rational::is_zero) && dot(&first[1], &last[1]).is_positive();
        Self { exact, near, spans, ends, domain, origin, size, closed }
    }

    /// The largest distance of a control point from the first, in one coordinate.
    pub fn size(&self) -> f64 {
        root(&(&self.size * &self.size))
    }

    pub fn of(spine: &Spine) -> Self {
        Self::new(spine.curve())
    }

    /// The ends of the spans.
    pub fn knots(&self) -> Vec<[Rational; 2]> {
        self.spans.iter().map(|&k| [self.exact.knots[k].clone(), self.exact.knots[k + 1].clone()]).collect()
    }

    /// kappa^2 at t, as seen from the span with this number.
    pub fn kappa_sq(&self, span: usize, t: &Rational) -> Rational {
        bend_sq(&self.exact.jet(self.spans[span], t)).map_or_else(Rational::zero, |r| r.recip())
    }

    /// So many points and one of every span, in order, computed exactly.
    pub fn points(&self, count: i64) -> Vec<[f64; 3]> {
        let at = |k: usize, i: i64| {
            let [from, to] = [&self.exact.knots[k], &self.exact.knots[k + 1]];
            let t = from + (to - from) * Rational::new(i.into(), count.into());
            self.exact.jet(k, &t)[0].each_ref().map(|x| x.to_f64().unwrap_or(f64::NAN))
        };
        self.spans.iter().flat_map(|k| (0..=count).map(move |i| at(*k, i))).collect()
    }

    /// The number of the span that holds u.
    fn span(&self, u: f64) -> usize {
        self.ends.iter().rposition(|e| e.0 <= u).unwrap_or(0)
    }

    fn jet(&self, u: f64) -> Jet<f64> {
        self.near.jet(self.spans[self.span(u)], &u)
    }

    /// u moved back into the domain of a closed curve, held at the ends of an open one.
    fn wrap(&self, u: f64) -> f64 {
        if self.closed { u - u.floor() } else { u.clamp(0.0, 1.0) }
    }

    fn point(&self, u: f64) -> [f64; 3] {
        self.jet(self.wrap(u))[0]
    }

    fn at(&self, u: f64) -> Sample {
        let jet = self.jet(u);
        let speed = dot(&jet[1], &jet[1]).sqrt();
        Sample { u, c: jet[0], tangent: jet[1].map(|x| x / speed) }
    }

    /// rho in f64; infinite where the planes are so nearly parallel that f64 says nothing.
    fn rho(&self, a: &Sample, b: &Sample) -> f64 {
        let turn = cross(&a.tangent, &b.tangent);
        if dot(&turn, &turn) < 1e-12 {
            return f64::INFINITY;
        }
        let value = rho_sq(&a.c, &a.tangent, &b.c, &b.tangent).map_or(f64::INFINITY, f64::sqrt);
        if value.is_nan() { f64::INFINITY } else { value }
    }

    /// Looks at about `count` points and all their pairs.
    pub fn sample(&self, count: usize) -> Sampled {
        let mut found: Vec<(f64, Why)> = vec![];
        let per_span = (count / self.spans.len()).clamp(6, 400);
        self.bends(per_span, &mut found);
        let grid: Vec<Sample> = self.parameters(per_span).into_iter().map(|u| self.at(u)).collect();
        let step = 1.0 / grid.len() as f64;
        self.pairs(&grid, step, &mut found);
        if !self.closed {
            self.ends(&grid, &mut found);
        }
        found.retain(|f| f.0.is_finite());
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        // of each kind the best three, exactly
        let mut kinds = [0usize; 4];
        let mut bounds = vec![];
        for (near, why) in found {
            let kind = match why {
                Why::Bend { .. } => 0,
                Why::Disks { .. } => 1,
                Why::Valley { .. } => 2,
                Why::EndValley { .. } => 3,
            };
            kinds[kind] += 1;
            if kinds[kind] > 3 {
                continue;
            }
            if let Some(exact_sq) = self.exact_sq(&why) {
                bounds.push(Bound { why, near, exact_sq });
            }
        }
        bounds.sort_by(|a, b| a.exact_sq.cmp(&b.exact_sq));
        Sampled { bounds }
    }

    /// Rising parameters, half of them even on each span and half even in arc length: with spread weights a span runs
    /// through most of its length in little of its parameter. A closed curve ends before its start.
    fn parameters(&self, per_span: usize) -> Vec<f64> {
        let fine = |per: usize| {
            let even = |&(from, to): &(f64, f64)| (0..per).map(move |i| from + (to - from) * i as f64 / per as f64);
            self.ends.iter().flat_map(even).chain([1.0]).collect::<Vec<f64>>()
        };
        let mut all = fine(per_span.div_ceil(2));
        let count = all.len();
        let dense = fine(16 * per_span);
        let points: Vec<[f64; 3]> = dense.iter().map(|&u| self.jet(u)[0]).collect();
        let mut reached = vec![0.0];
        for pair in points.windows(2) {
            let d = sub(&pair[1], &pair[0]);
            reached.push(reached[reached.len() - 1] + dot(&d, &d).sqrt());
        }
        let total = reached[reached.len() - 1];
        for i in 1..count {
            let wanted = total * i as f64 / count as f64;
            let k = reached.partition_point(|r| *r < wanted).clamp(1, reached.len() - 1);
            let share = ((wanted - reached[k - 1]) / (reached[k] - reached[k - 1])).clamp(0.0, 1.0);
            if share.is_finite() {
                all.push(dense[k - 1] + share * (dense[k] - dense[k - 1]));
            }
        }
        all.sort_by(f64::total_cmp);
        all.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        if self.closed && all[all.len() - 1] > 1.0 - 1e-9 {
            all.pop();
        }
        all
    }

    fn bends(&self, per_span: usize, found: &mut Vec<(f64, Why)>) {
        let steps = 4 * per_span; // spread weights make narrow peaks
        for (span, &(from, to)) in self.ends.iter().enumerate() {
            let bend = |t: f64| {
                let r = bend_sq(&self.near.jet(self.spans[span], &t)).map_or(f64::INFINITY, f64::sqrt);
                if r.is_nan() { f64::INFINITY } else { r }
            };
            let at = |i: usize| (from + (to - from) * i as f64 / steps as f64).clamp(from, to);
            let values: Vec<f64> = (0..=steps).map(|i| bend(at(i))).collect();
            for i in valleys(&values, 5) {
                let (near, t) = golden(bend, at(i.saturating_sub(1)), at((i + 1).min(steps)), at(i));
                found.push((near, Why::Bend { span, t }));
            }
        }
    }

    fn pairs(&self, grid: &[Sample], step: f64, found: &mut Vec<(f64, Why)>) {
        let n = grid.len();
        let mut disks: Vec<(f64, usize, usize)> = vec![];
        let mut critical: Vec<(f64, usize, usize)> = vec![];
        // the larger of the two cosines between q and the tangents; small near a doubly critical pair
        let off = |i: usize, j: usize| {
            let q = sub(&grid[i].c, &grid[j].c);
            let length = dot(&q, &q).sqrt();
            (dot(&q, &grid[i].tangent).abs().max(dot(&q, &grid[j].tangent).abs()) / length, length)
        };
        let mut table = vec![f64::INFINITY; n * n];
        for i in 0..n {
            for j in 0..i {
                let (o, length) = off(i, j);
                let o = if length > 0.0 { o } else { 0.0 };
                table[i * n + j] = o;
                table[j * n + i] = o;
                let rho = self.rho(&grid[i], &grid[j]);
                if rho.is_finite() {
                    disks.push((rho, i, j));
                }
            }
        }
        disks.sort_by(|a, b| a.0.total_cmp(&b.0));
        for &(_, i, j) in disks.iter().take(6) {
            let (near, s, t) = self.compass(grid[i].u, grid[j].u, step);
            found.push((near, Why::Disks { s, t }));
        }
        let neighbour = |i: usize, d: isize| -> Option<usize> {
            let k = i as isize + d;
            if self.closed {
                Some(k.rem_euclid(n as isize) as usize)
            } else {
                usize::try_from(k).ok().filter(|k| *k < n)
            }
        };
        for i in 0..n {
            for j in 0..i {
                let here = table[i * n + j];
                if here > 0.9 {
                    continue;
                }
                let least = [(-1, 0), (1, 0), (0, -1), (0, 1)].into_iter().all(|(di, dj)| {
                    match (neighbour(i, di), neighbour(j, dj)) {
                        (Some(x), Some(y)) => table[x * n + y] >= here,
                        _ => true,
                    }
                });
                if least {
                    critical.push((off(i, j).1, i, j));
                }
            }
        }
        critical.sort_by(|a, b| a.0.total_cmp(&b.0));
        for &(_, i, j) in critical.iter().take(60) {
            let (s, t) = self.newton(grid[i].u, grid[j].u);
            for (s, t) in [(s, t), (grid[i].u, grid[j].u)] {
                if let Some(valley) = self.valley(s, t) {
                    found.push(valley);
                    break;
                }
            }
        }
    }

    /// Least rho near a pair by compass search; pairs closer than 1e-4 are left alone.
    fn compass(&self, mut s: f64, mut t: f64, mut step: f64) -> (f64, f64, f64) {
        let value = |s: f64, t: f64| {
            let apart = (s - t).abs();
            let apart = if self.closed { apart.min(1.0 - apart) } else { apart };
            if apart < 1e-4 { f64::INFINITY } else { self.rho(&self.at(s), &self.at(t)) }
        };
        let mut best = value(s, t);
        for _ in 0..120 {
            let moved =
                [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0)]
                    .map(|(x, y)| (self.wrap(s + x * step), self.wrap(t + y * step)))
                    .map(|(x, y)| (value(x, y), x, y))
                    .into_iter()
                    .min_by(|a, b| a.0.total_cmp(&b.0));
            match moved {
                Some(m) if m.0 < best => (best, s, t) = m,
                _ => step *= 0.5,
            }
            if step < 1e-13 {
                break;
            }
        }
        (best, s, t)
    }

    /// A doubly critical pair near (s, t), if Newton's method finds one.
    fn newton(&self, mut s: f64, mut t: f64) -> (f64, f64) {
        for _ in 0..20 {
            let (a, b) = (self.jet(s), self.jet(t));
            let q = sub(&a[0], &b[0]);
            let (f, g) = (dot(&q, &a[1]), dot(&q, &b[1]));
            let mixed = dot(&a[1], &b[1]);
            let [[m11, m12], [m21, m22]] =
                [[dot(&a[1], &a[1]) + dot(&q, &a[2]), -mixed], [mixed, dot(&q, &b[2]) - dot(&b[1], &b[1])]];
            let det = m11 * m22 - m12 * m21;
            let (ds, dt) = ((m12 * g - m22 * f) / det, (m21 * f - m11 * g) / det);
            if !(ds.is_finite() && dt.is_finite()) {
                break;
            }
            let clip = (0.02 / ds.abs().max(dt.abs())).min(1.0);
            (s, t) = (self.wrap(s + clip * ds), self.wrap(t + clip * dt));
        }
        (s, t)
    }

    /// The middle of C(s) and C(t), if its distance has a strict valley at both.
    fn valley(&self, s: f64, t: f64) -> Option<(f64, Why)> {
        let (p, q) = (self.point(s), self.point(t));
        let x: [f64; 3] = std::array::from_fn(|k| 0.5 * (p[k] + q[k]));
        let apart = (s - t).abs();
        let apart = if self.closed { apart.min(1.0 - apart) } else { apart };
        let around_s = self.brackets(&x, s, 0.45 * apart)?;
        let around_t = self.brackets(&x, t, 0.45 * apart)?;
        let far = |p: &[f64; 3]| dot(&sub(p, &x), &sub(p, &x)).sqrt();
        Some((far(&p).max(far(&q)), Why::Valley { x, s: around_s, t: around_t }))
    }

    /// Parameters before and after t at which the curve is further from x than at t.
    fn brackets(&self, x: &[f64; 3], t: f64, most: f64) -> Option<[f64; 3]> {
        let far = |u: f64| {
            let d = sub(&self.point(u), x);
            dot(&d, &d)
        };
        let here = far(t);
        let side = |sign: f64| {
            (0..40)
                .map(|i| sign * most * 0.6f64.powi(40 - i))
                .find(|h| {
                    let u = t + h;
                    (self.closed || (0.0..=1.0).contains(&u)) && far(u) > here * (1.0 + 1e-11) + 1e-24
                })
                .map(|h| t + h)
        };
        Some([side(-1.0)?, t, side(1.0)?])
    }

    fn ends(&self, grid: &[Sample], found: &mut Vec<(f64, Why)>) {
        found.push((0.0, Why::Disks { s: 0.0, t: 1.0 })); // decided exactly
        for finish in [false, true] {
            let end = self.at(if finish { 1.0 } else { 0.0 });
            let rho = |t: f64| if (t - end.u).abs() < 1e-5 { f64::INFINITY } else { self.rho(&end, &self.at(t)) };
            let values: Vec<f64> = grid.iter().map(|g| rho(g.u)).collect();
            for i in valleys(&values, 8) {
                let from = grid[i.saturating_sub(1)].u;
                let to = grid[(i + 1).min(grid.len() - 1)].u;
                let (near, t) = golden(rho, from, to, grid[i].u);
                found.push((near, Why::Disks { s: end.u, t }));
            }
            // where the body passes the plane of the end, the middle may have a nearest point on the body
            let side = |g: &Sample| dot(&sub(&g.c, &end.c), &end.tangent);
            for pair in grid.windows(2) {
                if side(&pair[0]) * side(&pair[1]) > 0.0 {
                    continue;
                }
                let (mut a, mut b) = (pair[0], pair[1]);
                for _ in 0..60 {
                    let m = self.at(0.5 * (a.u + b.u));
                    if side(&a) * side(&m) <= 0.0 { b = m } else { a = m }
                }
                for t in [a.u, b.u, pair[0].u, pair[1].u] {
                    self.end_valley(finish, &end, t, found);
                }
            }
        }
    }

    fn end_valley(&self, finish: bool, end: &Sample, t: f64, found: &mut Vec<(f64, Why)>) {
        let c = self.point(t);
        let q = sub(&c, &end.c);
        let along = dot(&q, &end.tangent);
        let x: [f64; 3] = std::array::from_fn(|k| end.c[k] + 0.5 * (q[k] - along * end.tangent[k]));
        let far = |u: f64| {
            let d = sub(&self.point(u), &x);
            dot(&d, &d).sqrt()
        };
        let (_, foot) = golden(far, (t - 0.01).max(0.0), (t + 0.01).min(1.0), t);
        let most = 0.9 * (foot - end.u).abs();
        let Some(around) = self.brackets(&x, foot, most) else { return };
        let radius = far(foot).max(0.5 * dot(&q, &q).sqrt());
        found.push((radius, Why::EndValley { finish, x, t: around }));
    }

    // -----------------------------------------------------------------------------------------------------------
    // The same facts in rational arithmetic, on the data as given.

    /// The parameter of a share of the domain; shares beyond 0..1 go round a closed curve.
    fn parameter(&self, u: f64) -> Option<Rational> {
        let mut u = exact(u);
        if u.is_negative() || u > Rational::one() {
            if !self.closed {
                return None;
            }
            u = &u - u.floor();
        }
        Some(&self.domain.0 + u * (&self.domain.1 - &self.domain.0))
    }

    fn exact_jet(&self, t: &Rational) -> Jet<Rational> {
        let k = self.spans.iter().rev().find(|&&k| self.exact.knots[k] <= *t).unwrap_or(&self.spans[0]);
        self.exact.jet(*k, t)
    }

    fn exact_point(&self, x: &[f64; 3]) -> [Rational; 3] {
        std::array::from_fn(|k| exact(x[k]) * &self.size + &self.origin[k])
    }

    /// Is t inside an arc round whose ends the curve is further from x? Then the squared distance of x and C(t).
    fn exact_valley(&self, x: &[Rational; 3], around: &[f64; 3]) -> Option<Rational> {
        if !(around[0] < around[1] && around[1] < around[2]) {
            return None;
        }
        let mut far = [Rational::zero(), Rational::zero(), Rational::zero()];
        for (far, u) in far.iter_mut().zip(around) {
            let d = sub(&self.exact_jet(&self.parameter(*u)?)[0], x);
            *far = dot(&d, &d);
        }
        let [before, here, after] = far;
        (here < before && here < after).then_some(here)
    }

    /// The square of the bound, exactly; `None` if the exact data do not bear it out.
    pub fn exact_sq(&self, why: &Why) -> Option<Rational> {
        match why {
            Why::Bend { span, t } => {
                let k = self.spans[*span];
                let t = self.parameter(*t)?;
                // a rounded end of a span may lie just outside
                let t = if t < self.exact.knots[k] { self.exact.knots[k].clone() } else { t };
                let t = if t > self.exact.knots[k + 1] { self.exact.knots[k + 1].clone() } else { t };
                bend_sq(&self.exact.jet(k, &t))
            }
            Why::Disks { s, t } => {
                let (s, t) = (self.parameter(*s)?, self.parameter(*t)?);
                let (start, end) = (&self.domain.0, &self.domain.1);
                let seam = self.closed && ((&s == start && &t == end) || (&s == end && &t == start));
                if s == t || seam {
                    return None;
                }
                let (a, b) = (self.exact_jet(&s), self.exact_jet(&t));
                rho_sq(&a[0], &a[1], &b[0], &b[1])
            }
            Why::Valley { x, s, t } => {
                let disjoint = s[2] < t[0] || t[2] < s[0];
                let round = s[2].max(t[2]) - s[0].min(t[0]) < 1.0;
                if !(disjoint && round) {
                    return None;
                }
                let x = self.exact_point(x);
                Some(max(self.exact_valley(&x, s)?, self.exact_valley(&x, t)?))
            }
            Why::EndValley { finish, x, t } => {
                let end = if *finish { 1.0 } else { 0.0 };
                if t[0] <= end && end <= t[2] {
                    return None;
                }
                let jet = self.exact_jet(&self.parameter(end)?);
                // x moved into the plane of the end
                let x = self.exact_point(x);
                let off = dot(&sub(&x, &jet[0]), &jet[1]) / dot(&jet[1], &jet[1]);
                let x = std::array::from_fn(|k| &x[k] - &off * &jet[1][k]);
                let from_end = sub(&x, &jet[0]);
                Some(max(dot(&from_end, &from_end), self.exact_valley(&x, t)?))
            }
        }
    }
}

/// The places of the least local minima of a list, at most so many.
fn valleys(values: &[f64], most: usize) -> Vec<usize> {
    let last = values.len() - 1;
    let mut found: Vec<usize> = (0..=last)
        .filter(|&i| values[i].is_finite())
        .filter(|&i| i == 0 || values[i] <= values[i - 1])
        .filter(|&i| i == last || values[i] <= values[i + 1])
        .collect();
    found.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    found.truncate(most);
    found
}

/// The least value of f between two parameters by golden section, and where; the start counts too.
fn golden(f: impl Fn(f64) -> f64, mut lo: f64, mut hi: f64, start: f64) -> (f64, f64) {
    let share = 0.5 * (5f64.sqrt() - 1.0);
    let mut best = (f(start), start);
    for u in [lo, hi] {
        let v = f(u);
        if v < best.0 {
            best = (v, u);
        }
    }
    let (mut a, mut b) = (hi - share * (hi - lo), lo + share * (hi - lo));
    let (mut fa, mut fb) = (f(a), f(b));
    for _ in 0..60 {
        for (v, u) in [(fa, a), (fb, b)] {
            if v < best.0 {
                best = (v, u);
            }
        }
        if fa <= fb {
            (hi, b, fb) = (b, a, fa);
            a = hi - share * (hi - lo);
            fa = f(a);
        } else {
            (lo, a, fa) = (a, b, fb);
            b = lo + share * (hi - lo);
            fb = f(b);
        }
    }
    best
}

// ---------------------------------------------------------------------------------------------------------------
// What an answer must satisfy.

/// Is the proved lower bound at most every bound found? The error holds the bound that it exceeds.
pub fn not_above(answer: &Radius, sampled: &Sampled) -> Result<(), String> {
    let Some(bound) = sampled.least() else { return Ok(()) };
    let lo = answer.delta.lo;
    let too_high = !lo.is_finite() || exact(lo) * exact(lo) > bound.exact_sq;
    if too_high {
        let value = root(&bound.exact_sq);
        return Err(format!("delta.lo = {lo:e} but delta <= {value:e}, by {:?}", bound.why));
    }
    Ok(())
}

/// Is delta really no more than the proved upper bound? Sampling has to come as far down, up to this share of it and of
/// the size of the curve for what sampling misses. (A `hi` below delta is unsound, and cannot be sampled.)
pub fn reaches(answer: &Radius, sampled: &Sampled, share: f64, size: f64) -> Result<(), String> {
    let (found, hi) = (sampled.delta(), answer.delta.hi);
    if found <= hi * (1.0 + share) + 1e-3 * share * size || found == hi {
        return Ok(());
    }
    Err(format!("delta.hi = {hi:e}, but sampling only finds {found:e}, by {:?}", sampled.least().map(|b| &b.why)))
}

impl Oracle {
    /// Half the gradient of |C(s) - C(t)|^2 by unit lengths of tangents, and the distance, at shares of the domain.
    pub fn slopes(&self, s: f64, t: f64) -> [f64; 3] {
        let (a, b) = (self.at(self.wrap(s)), self.at(self.wrap(t)));
        let gap = sub(&a.c, &b.c);
        [dot(&gap, &a.tangent), dot(&gap, &b.tangent), dot(&gap, &gap).sqrt()]
    }

    /// Stationary pairs of the distance, as shares of the domain, by Newton's method (with numerical derivatives) from all
    /// cells of a grid on which both slopes change sign.
    pub fn stationary(&self, count: usize) -> Vec<[f64; 2]> {
        let per_span = (count / self.spans.len()).clamp(6, 400);
        let grid: Vec<Sample> = self.parameters(per_span).into_iter().map(|u| self.at(u)).collect();
        let slope = |i: usize, j: usize| {
            let gap = sub(&grid[i].c, &grid[j].c);
            [dot(&gap, &grid[i].tangent), dot(&gap, &grid[j].tangent)]
        };
        let mut found: Vec<[f64; 2]> = vec![];
        for i in 0..grid.len() - 1 {
            for j in 0..i {
                let corners = [slope(i, j), slope(i + 1, j), slope(i, j + 1), slope(i + 1, j + 1)];
                let mixed = |k: usize| corners.iter().any(|c| c[k] <= 0.0) && corners.iter().any(|c| c[k] >= 0.0);
                if !(mixed(0) && mixed(1)) {
                    continue;
                }
                let middle = |i: usize| 0.5 * (grid[i].u + grid[i + 1].u);
                if let Some(pair) = self.stationary_near(middle(i), middle(j)) {
                    let known = found.iter().any(|p| (p[0] - pair[0]).abs() + (p[1] - pair[1]).abs() < 1e-7);
                    if !known {
                        found.push(pair);
                    }
                }
            }
        }
        found
    }

    fn stationary_near(&self, mut s: f64, mut t: f64) -> Option<[f64; 2]> {
        const H: f64 = 1e-6;
        let mut last = 1.0_f64;
        for _ in 0..20 {
            let f = self.slopes(s, t);
            let (by_s, by_t) = (self.slopes(s + H, t), self.slopes(s, t + H));
            let (lo_s, lo_t) = (self.slopes(s - H, t), self.slopes(s, t - H));
            let [a, c] = [0, 1].map(|k| (by_s[k] - lo_s[k]) / (2.0 * H));
            let [b, d] = [0, 1].map(|k| (by_t[k] - lo_t[k]) / (2.0 * H));
            let det = a * d - b * c;
            let (ds, dt) = ((d * f[0] - b * f[1]) / det, (a * f[1] - c * f[0]) / det);
            if !(ds.abs() < 0.2 && dt.abs() < 0.2) {
                return None;
            }
            (s, t) = (s - ds, t - dt);
            last = ds.abs().max(dt.abs());
            if !(self.closed || (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t)) {
                return None;
            }
        }
        // to a multiple pair it comes slowly, and not close
        if last > 1e-9 {
            return None;
        }
        let (s, t) = (self.wrap(s), self.wrap(t));
        let gap = (s - t).abs();
        let gap = if self.closed { gap.min(1.0 - gap) } else { gap };
        let f = self.slopes(s, t);
        (gap > 1e-4 && f[0].abs() < 1e-11 && f[1].abs() < 1e-11).then(|| [s.max(t), s.min(t)])
    }
}
