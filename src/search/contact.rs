//! W4 of theory.md, section 2: proved self-contacts; and the existence of doubly critical pairs. Exact.

use super::dyadic::{Dyadic, least_f64, ratio, rounded_quotient, step, truncated};
use super::frame::{At, ExactForms, Frame, weight_ratio};
use super::newton::Candidate;
use super::witness::{Exact, POLISHED, Point, distance, distance_sq};
use crate::bernstein::{Form, Vec3, dot};
use crate::integer::Int;
use crate::number::Rational;
use crate::spine::Bezier;
use std::cmp::Ordering;

/// A proved self-contact: each parameter lies between two, the point in the hull of `points`.
#[derive(Debug, Clone)]
pub(crate) struct Touch {
    pub(crate) s: [At; 2],
    pub(crate) t: [At; 2],
    pub(crate) points: Option<Vec<[Rational; 3]>>,
}

impl Exact<'_> {
    /// W4: the two parameters of a candidate are one point, exactly (small denominators), or a planar spine crosses
    /// itself there by change of sign (Miranda).
    pub(crate) fn self_contact(&mut self, pair: &Candidate) -> Option<Touch> {
        if let (Some(s), Some(t)) = (simplest(pair.s), simplest(pair.t))
            && self.same_point(&s, &t)
        {
            let around = |(segment, num, den): &(usize, Int, Int)| {
                let whole = |m: &Int| Dyadic { m: m.clone(), e: 0 };
                let below = rounded_quotient(&whole(num), &whole(den), 80);
                let above = if den == &Int::ONE { below.clone() } else { below.add(&step(80)) };
                (*segment, below, above)
            };
            return Some(self.touch(around(&s), around(&t)));
        }
        let j = self.crosses(pair)?;
        let around = |(segment, t): (usize, f64)| {
            let t = truncated(&Dyadic::from_f64(t), 60);
            (segment, t.sub(&step(j)), t.add(&step(j)))
        };
        Some(self.touch(around(pair.s), around(pair.t)))
    }

    fn touch(&mut self, s: (usize, Dyadic, Dyadic), t: (usize, Dyadic, Dyadic)) -> Touch {
        let arc = self.frame.segments[s.0].arc(&s.1, &s.2);
        // w > 0 at both ends, but a control weight of a long arc may not be: then no box is given
        let points: Option<Vec<[Rational; 3]>> = (0..=arc.degree())
            .map(|i| {
                let [x, y, z, w] = arc.point(i);
                w.sign().is_gt().then(|| [x, y, z].map(|x| Rational::new(x.big(), w.big())))
            })
            .collect();
        let ends = |(segment, from, to): (usize, Dyadic, Dyadic)| [At { segment, t: from }, At { segment, t: to }];
        Touch { s: ends(s), t: ends(t), points }
    }

    fn same_point(&mut self, s: &(usize, Int, Int), t: &(usize, Int, Int)) -> bool {
        if same_parameter(self.frame, s, t) {
            return false;
        }
        let (p, q) = (self.homogeneous(s), self.homogeneous(t));
        (0..3).all(|k| &p[k] * &q[3] == &q[k] * &p[3])
    }

    /// Homogeneous point at a rational parameter num / den.
    fn homogeneous(&mut self, (segment, num, den): &(usize, Int, Int)) -> [Int; 4] {
        let (forms, _) = self.span(*segment);
        let n = forms.r[0].ds;
        let value = |f: &Form<Int>| at_ratio(f, num, den, n);
        [value(&forms.r[0]), value(&forms.r[1]), value(&forms.r[2]), value(&forms.w)]
    }

    /// Half the distance, from above, of a candidate with q.a(s) = q.a(t) = 0 exactly at simple rational parameters.
    pub(crate) fn exactly_critical(&mut self, pair: &Candidate) -> Option<f64> {
        let (s, t) = (simplest(pair.s)?, simplest(pair.t)?);
        if same_parameter(self.frame, &s, &t) {
            return None;
        }
        let (p, q) = (self.homogeneous(&s), self.homogeneous(&t));
        let gap: [Int; 3] = std::array::from_fn(|k| &(&p[k] * &q[3]) - &(&q[k] * &p[3]));
        let critical = [&s, &t].into_iter().all(|at| {
            let (forms, _) = self.span(at.0);
            let degree = forms.a[0].ds;
            let a = forms.a.each_ref().map(|a| at_ratio(a, &at.1, &at.2, degree));
            (0..3).fold(Int::ZERO, |sum, k| &sum + &(&a[k] * &gap[k])).is_zero()
        });
        critical.then_some(())?;
        let (num, den) = distance_sq(&whole_point(p), &whole_point(q));
        least_f64(pair.radius, |r| num.cmp(&r.sqr().mul(&den).mul(&Dyadic::from(4))).is_le())
    }

    /// A doubly critical pair exists in a small box round the candidate (Miranda on preconditioned F1, F2); returns an
    /// upper bound for half its distance.
    pub(crate) fn critical_box(&mut self, pair: &Candidate, jacobian: [[f64; 2]; 2]) -> Option<f64> {
        let inverse = inverse(jacobian)?;
        let (s, t) = self.polished(At::near(pair.s), At::near(pair.t), pair.radius);
        let centre = [s, t].map(|at| At { segment: at.segment, t: truncated(&at.t, 100) });
        let fine = pair.radius < POLISHED;
        for j in [80, 60, 44, 34, 28, 22, 16].into_iter().skip(if fine { 0 } else { 2 }) {
            let Some((x, y)) = self.boxed(&centre, j) else { continue };
            let (fx, fy) = (x.forms(), y.forms());
            let y_forms = |v: &Vec3<Int>| v.clone().map(Form::transposed);
            let (ry, wy, ay) = (y_forms(&fy.r), fy.w.clone().transposed(), y_forms(&fy.a));
            let d: Vec3<Int> = std::array::from_fn(|k| fx.r[k].mul(&wy).sub(&ry[k].mul(&fx.w)));
            // q.C'(s) and q.C'(t) are D.a(s) and D.a(t) over w(s)^3 w(t) and w(s) w(t)^3: bring them to one scale
            let (ratio, exp) = weight_ratio(&fx.w, &wy);
            let mut second = dot(&d, &ay).scale(ratio * ratio);
            second.exp += 2 * exp;
            if opposite_faces(&dot(&d, &fx.a), &second, inverse) {
                return half_distance_above(&x, &y);
            }
        }
        None
    }

    /// Exact arcs of half width 2^-j round the two parameters; `None` across a joint or if they overlap.
    fn boxed(&self, [s, t]: &[At; 2], j: i64) -> Option<(Bezier, Bezier)> {
        let eta = step(j);
        let sides = |at: &At| {
            let (from, to) = (at.t.sub(&eta), at.t.add(&eta));
            let inside = from.m.sign().is_ge() && to.cmp(&Dyadic::ONE).is_le();
            inside.then(|| self.frame.segments[at.segment].arc(&from, &to))
        };
        distance(self.frame, s, t).cmp(&step(j - 2)).is_gt().then_some(())?;
        Some((sides(s)?, sides(t)?))
    }

    /// A planar spine that crosses itself near the candidate: D = 0 in a box of half width 2^-j, by Miranda; returns j.
    fn crosses(&mut self, pair: &Candidate) -> Option<i64> {
        let [i, k] = plane(self.frame)?;
        let centre = [pair.s, pair.t].map(|(segment, t)| At { segment, t: truncated(&Dyadic::from_f64(t), 60) });
        for j in [44, 34, 28, 22, 16, 10, 6] {
            let Some((x, y)) = self.boxed(&centre, j) else { continue };
            let (fx, fy) = (x.forms(), y.forms());
            let d =
                [i, k].map(|c| fx.r[c].mul(&fy.w.clone().transposed()).sub(&fy.r[c].clone().transposed().mul(&fx.w)));
            // dD/ds ~ a(s), dD/dt ~ -a(t), each up to a positive factor; scaled to one size
            let column = |forms: &ExactForms, sign: f64| {
                let top = [i, k].map(|c| forms.a[c].c[0].bits()).into_iter().max().unwrap_or(0) as i64;
                [i, k].map(|c| sign * forms.a[c].c[0].to_f64_shifted(top))
            };
            let (a, b) = (column(&fx, 1.0), column(&fy, -1.0));
            let inverse = inverse([[a[0], b[0]], [a[1], b[1]]])?;
            if opposite_faces(&d[0], &d[1], inverse) {
                return Some(j);
            }
        }
        None
    }
}

/// Miranda: with G = Y (F1, F2), G1 has opposite strict signs on the faces s = 0 and s = 1 of the unit square, G2 on
/// t = 0 and t = 1.
fn opposite_faces(f1: &Form<Int>, f2: &Form<Int>, y: [[f64; 2]; 2]) -> bool {
    let combine = |row: [f64; 2]| f1.clone().scale(row[0]).add(&f2.clone().scale(row[1]));
    let (g1, g2) = (combine(y[0]), combine(y[1]));
    let sign = |mut coefficients: Box<dyn Iterator<Item = &Int> + '_>| -> Ordering {
        let first = coefficients.next().map_or(Ordering::Equal, Int::sign);
        if coefficients.all(|c| c.sign() == first) { first } else { Ordering::Equal }
    };
    let width = |g: &Form<Int>| g.dt + 1;
    let row = |g: &'_ Form<Int>, i: usize| sign(Box::new(g.c[i * width(g)..(i + 1) * width(g)].iter()));
    let column = |g: &'_ Form<Int>, j: usize| sign(Box::new(g.c.iter().skip(j).step_by(width(g))));
    let opposite = |a: Ordering, b: Ordering| a != Ordering::Equal && a == b.reverse();
    opposite(row(&g1, 0), row(&g1, g1.ds)) && opposite(column(&g2, 0), column(&g2, g2.dt))
}

fn inverse(m: [[f64; 2]; 2]) -> Option<[[f64; 2]; 2]> {
    let det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    let inverse = [[m[1][1] / det, -m[0][1] / det], [-m[1][0] / det, m[0][0] / det]];
    inverse.iter().flatten().all(|x| x.is_finite()).then_some(inverse)
}

/// A point of integer homogeneous coordinates.
fn whole_point([x, y, z, w]: [Int; 4]) -> Point {
    let dyadic = |m: Int| Dyadic { m, e: 0 };
    Point { x: [x, y, z].map(dyadic), w: dyadic(w) }
}

/// Half the largest distance between control points of two short arcs, from above.
fn half_distance_above(x: &Bezier, y: &Bezier) -> Option<f64> {
    let points = |b: &Bezier| -> Option<Vec<Point>> {
        let points = (0..=b.degree()).map(|i| b.point(i));
        points.map(|p| p[3].sign().is_gt().then(|| whole_point(p))).collect()
    };
    let (p, q) = (points(x)?, points(y)?);
    let mut largest = 0.0f64;
    for a in &p {
        for b in &q {
            let (num, den) = distance_sq(a, b);
            let near = ratio(&num, &den).sqrt();
            largest = largest.max(least_f64(near, |r| num.cmp(&r.sqr().mul(&den)).is_le())?);
        }
    }
    Some(largest * 0.5)
}

fn same_parameter(frame: &Frame, s: &(usize, Int, Int), t: &(usize, Int, Int)) -> bool {
    let n = Int::from(frame.segments.len() as i64);
    let position = |(segment, num, den): &(usize, Int, Int)| (&(&Int::from(*segment as i64) * den) + num, den.clone());
    let ((a, p), (b, q)) = (position(s), position(t));
    let gap = (&(&a * &q) - &(&b * &p)).abs();
    gap.is_zero() || (frame.closed && gap == &(&p * &q) * &n)
}

/// sum of c[j] num^j (den - num)^(d-j), raised to the common degree.
fn at_ratio(form: &Form<Int>, num: &Int, den: &Int, degree: usize) -> Int {
    let rest = den - num;
    let (mut sum, mut power) = (Int::ZERO, Int::ONE);
    for c in form.c.iter().rev() {
        sum = &(&sum * num) + &(c * &power);
        power = &power * &rest;
    }
    (form.ds..degree).fold(sum, |sum, _| &sum * den)
}

/// The segment, and the fraction of denominator at most 1000 within 1e-9 of t in [0, 1], by continued fractions.
fn simplest((segment, t): (usize, f64)) -> Option<(usize, Int, Int)> {
    let (mut p, mut q) = ((0i64, 1i64), (1i64, 0i64));
    let mut x = t;
    for _ in 0..12 {
        let whole = x.floor();
        (p, q) = ((p.1, whole as i64 * p.1 + p.0), (q.1, whole as i64 * q.1 + q.0));
        if q.1 > 1000 {
            return None;
        }
        let (num, den) = (p.1, q.1);
        if (num as f64 / den as f64 - t).abs() < 1e-9 {
            return (num >= 0 && num <= den).then(|| (segment, Int::from(num), Int::from(den)));
        }
        x = 1.0 / (x - whole);
        if !x.is_finite() || x > 1e15 {
            return None;
        }
    }
    None
}

/// Two coordinates on which a planar spine projects one to one; `None` if it is not planar.
pub(crate) fn plane(frame: &Frame) -> Option<[usize; 2]> {
    let points: Vec<[Int; 4]> = frame.segments.iter().flat_map(|b| (0..=b.degree()).map(|i| b.point(i))).collect();
    let minus =
        |p: &[Int; 4], q: &[Int; 4]| -> [Int; 3] { std::array::from_fn(|k| &(&p[k] * &q[3]) - &(&q[k] * &p[3])) };
    let cross = |a: &[Int; 3], b: &[Int; 3]| -> [Int; 3] {
        [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &(&a[i] * &b[j]) - &(&a[j] * &b[i]))
    };
    let base = points.iter().find(|p| !p[3].is_zero())?;
    let gaps: Vec<[Int; 3]> = points.iter().map(|p| minus(p, base)).collect();
    let first = gaps.iter().find(|g| g.iter().any(|x| !x.is_zero()))?;
    let normal = gaps.iter().map(|g| cross(first, g)).find(|n| n.iter().any(|x| !x.is_zero()))?;
    let inside = |g: &[Int; 3]| (0..3).fold(Int::ZERO, |sum, k| &sum + &(&normal[k] * &g[k])).is_zero();
    if !gaps.iter().all(inside) {
        return None;
    }
    let drop = (0..3).max_by_key(|&k| normal[k].abs())?;
    Some([(drop + 1) % 3, (drop + 2) % 3])
}
