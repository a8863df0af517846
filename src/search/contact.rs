//! W4 of theory.md, section 2: proved self-contacts; and the existence of doubly critical pairs. Exact.

use super::dyadic::{Dyadic, least_f64, ratio, rounded_quotient, step, truncated};
use super::frame::{At, Frame};
use super::newton::Candidate;
use super::strand::{Strand, over, strand};
use super::witness::{Exact, POLISHED, Point, distance, distance_sq};
use crate::bernstein::{Form, dot};
use crate::certificate::{Foot, Upper};
use crate::integer::{self, Int, common_integers, exact_div, gcd};
use crate::number::{Rational, compare, same};
use crate::spine::Bezier;
use num_bigint::BigInt;
use num_traits::ToPrimitive;
use std::cmp::Ordering;

/// A rational parameter: the segment, and a fraction of it.
pub(crate) type Simple = (usize, Int, Int);

/// A proved self-contact: each parameter lies between two, the point in the hull of `points`.
#[derive(Debug, Clone)]
pub(crate) struct Touch {
    pub(crate) s: [At; 2],
    pub(crate) t: [At; 2],
    pub(crate) points: Option<Vec<[Rational; 3]>>,
    /// As docs/certificate-format.md has it.
    pub(crate) upper: Upper,
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
                strand(self.frame, *segment, &below, &above)
            };
            let upper = self.one_point(&s, &t);
            return Some(touch(&around(&s)?, &around(&t)?, upper));
        }
        let ([s, t], upper) = self.crosses(pair).or_else(|| self.mirrored(pair))?;
        Some(touch(&s, &t, upper))
    }

    /// The witness of two equal points: the point lies in both normal planes.
    fn one_point(&mut self, s: &(usize, Int, Int), t: &(usize, Int, Int)) -> Upper {
        let [x, y, z, w] = self.homogeneous(s).map(|c| Rational::from(c.big()));
        let x = self.frame.point(&[x / &w, y / &w, z / &w]);
        let mut positions = [s, t]
            .map(|(segment, num, den)| Rational::from(BigInt::from(*segment)) + Rational::new(num.big(), den.big()));
        positions.sort_by(compare);
        Upper::Contact { x, feet: positions.map(Foot::Plane) }
    }

    /// Is the spine at the end's point again, at a simple rational parameter near t?
    pub(crate) fn is_at(&mut self, end: &At, t: (usize, f64)) -> bool {
        let whole = (end.segment, end.t.m.clone(), Int::ONE);
        simplest(t).is_some_and(|t| self.same_point(&whole, &t))
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

    /// Half the distance, from above, of a candidate with q.a(s) = q.a(t) = 0 exactly at rational parameters.
    pub(crate) fn exactly_critical(&mut self, pair: &Candidate) -> Option<f64> {
        // on arcs of circles what is across from a simple parameter is rational, but not simple
        let fine = |at| fraction(at, 1_000_000, 1e-12);
        let members =
            [[simplest(pair.s), simplest(pair.t)], [simplest(pair.s), fine(pair.t)], [fine(pair.s), simplest(pair.t)]];
        members.into_iter().find_map(|[s, t]| self.critical_at(s?, t?, pair.radius))
    }

    fn critical_at(&mut self, s: Simple, t: Simple, radius: f64) -> Option<f64> {
        if same_parameter(self.frame, &s, &t) {
            return None;
        }
        let (num, den) = self.stationary_sq(&s, &t)?;
        least_f64(radius, |r| num.cmp(&r.sqr().mul(&den).mul(&Dyadic::from(4))).is_le())
    }

    /// |C(s) - C(t)|^2 as numerator and denominator, if C(s) - C(t) is orthogonal to both tangents.
    pub(crate) fn stationary_sq(&mut self, s: &Simple, t: &Simple) -> Option<(Dyadic, Dyadic)> {
        let (p, q) = (self.homogeneous(s), self.homogeneous(t));
        let gap: [Int; 3] = std::array::from_fn(|k| &(&p[k] * &q[3]) - &(&q[k] * &p[3]));
        let critical = [s, t].into_iter().all(|at| {
            let (forms, _) = self.span(at.0);
            let degree = forms.a[0].ds;
            let a = forms.a.each_ref().map(|a| at_ratio(a, &at.1, &at.2, degree));
            integer::dot(&a, &gap).is_zero()
        });
        critical.then(|| distance_sq(&whole_point(p), &whole_point(q)))
    }

    /// A doubly critical pair exists in a small box round the candidate (Miranda on preconditioned F1, F2); returns an
    /// upper bound for half its distance.
    pub(crate) fn critical_box(&mut self, pair: &Candidate) -> Option<f64> {
        let (s, t) = self.polished(At::near(pair.s), At::near(pair.t), pair.radius);
        let centre = [s, t].map(|at| At { segment: at.segment, t: truncated(&at.t, 100) });
        let fine = pair.radius < POLISHED;
        for j in [80, 60, 44, 34, 28, 22, 16].into_iter().skip(if fine { 0 } else { 2 }) {
            let Some([x, y]) = self.boxed(&centre, j) else { continue };
            if opposite_faces(&over(&x, &y, |d, ax, ay| [dot(d, ax), dot(d, ay)])).is_some() {
                return half_distance_above(&x.arcs, &y.arcs);
            }
        }
        None
    }

    /// Stretches of half width 2^-j round the two parameters; `None` beyond an end of the spine or if they overlap.
    fn boxed(&self, [s, t]: &[At; 2], j: i64) -> Option<[Strand; 2]> {
        distance(self.frame, s, t).cmp(&step(j - 2)).is_gt().then_some(())?;
        let around = |at: &At| strand(self.frame, at.segment, &at.t.sub(&step(j)), &at.t.add(&step(j)));
        Some([around(s)?, around(t)?])
    }

    /// Two arcs that are mirror images, near the candidate, and pass through their mirror: D of equal parameters keeps one
    /// direction and changes its side. The second arc runs back, or as the first.
    fn mirrored(&mut self, pair: &Candidate) -> Option<([Strand; 2], Upper)> {
        let (low, high) = if pair.s <= pair.t { (pair.s, pair.t) } else { (pair.t, pair.s) };
        let (s, maps) = (truncated(&Dyadic::from_f64(low.1), 60), symmetries(self.frame, low, high));
        let arcs = maps.iter().flat_map(|map| [44, 34, 28].map(|j| (map, s.sub(&step(j)), s.add(&step(j)))));
        let inside = arcs.filter(|(_, from, to)| from.m.sign().is_ge() && to.cmp(&Dyadic::ONE).is_le());
        inside.filter_map(|(map, from, to)| self.mirror(map, low.0, [from, to], high.0)).next()
    }

    /// The arc of one span, and its image in another, which is to be apart from it.
    fn mirror(&self, map: &Symmetry, k: usize, arc: [Dyadic; 2], l: usize) -> Option<([Strand; 2], Upper)> {
        let Frame { segments, knots, closed, .. } = self.frame;
        let place = |k: usize, t: &Rational| Rational::from(BigInt::from(k)) + t;
        let image = arc.each_ref().map(|t| {
            let at = self.frame.parameter(&At { segment: k, t: t.clone() });
            let at = if map.back { &map.shift - at } else { &map.shift + at };
            (at - &knots[l]) / (&knots[l + 1] - &knots[l])
        });
        let (first, second) = (arc.each_ref().map(|t| place(k, &t.rational())), image.each_ref().map(|t| place(l, t)));
        let [start, end] = if map.back { [1, 0] } else { [0, 1] };
        let (zero, one) = (Rational::from(BigInt::from(0)), Rational::from(BigInt::from(1)));
        let within = compare(&zero, &image[start]).is_le() && compare(&image[end], &one).is_le();
        let around = !closed || compare(&second[end], &place(segments.len(), &first[0])).is_lt();
        (within && around && compare(&first[1], &second[start]).is_lt()).then_some(())?;
        let (ends, common) = common_integers(image.iter());
        let other = segments[l].between(&ends[0], &ends[1], &common);
        let normal = through_mirror(&segments[k].arc(&arc[0], &arc[1]), &other)?.map(|x| Rational::from(x.big()));
        // the image between dyadic numbers
        let unit = BigInt::from(1) << 80_u8;
        let dyadic = |m: BigInt| Dyadic { m: Int::from(m), e: -80 };
        let below = dyadic((&image[start] * &unit).floor().to_integer());
        let above = dyadic((&image[end] * &unit).ceil().to_integer());
        let strands = [strand(self.frame, k, &arc[0], &arc[1])?, strand(self.frame, l, &below, &above)?];
        Some((strands, Upper::Mirror { arcs: [first, second], normal }))
    }

    /// A planar spine that crosses itself near the candidate: D = 0 in a box, by Miranda.
    fn crosses(&mut self, pair: &Candidate) -> Option<([Strand; 2], Upper)> {
        let (normal, [i, k]) = plane(self.frame)?;
        let centre = [pair.s, pair.t].map(|(segment, t)| At { segment, t: truncated(&Dyadic::from_f64(t), 60) });
        for j in [44, 34, 28, 22, 16, 10, 6] {
            let Some([x, y]) = self.boxed(&centre, j) else { continue };
            if let Some(rows) = opposite_faces(&over(&x, &y, |d, _, _| [d[i].clone(), d[k].clone()])) {
                let row = |row: [Dyadic; 2]| {
                    let mut vector = [Dyadic::ZERO; 3].map(|x| x.rational());
                    [vector[i], vector[k]] = row.map(|x| x.rational());
                    vector
                };
                let normal = normal.map(|x| Rational::from(x.big()));
                let upper = crossing(self.frame, [&x, &y], normal, rows.map(row));
                return Some(([x, y], upper));
            }
        }
        None
    }
}

/// The witness of a crossing, its arcs in the order of the spine.
fn crossing(frame: &Frame, strands: [&Strand; 2], normal: [Rational; 3], rows: [[Rational; 3]; 2]) -> Upper {
    let arcs = strands.map(|strand| {
        let [from, to] = strand.ends.each_ref().map(|at| Rational::from(BigInt::from(at.segment)) + at.t.rational());
        // across the closure
        let turn = BigInt::from(if compare(&from, &to).is_gt() { frame.segments.len() } else { 0 });
        [from, to + turn]
    });
    let ([s, t], [first, second]) = (arcs, rows);
    if compare(&s[0], &t[0]).is_lt() {
        Upper::Crossing { arcs: [s, t], normal, first, second }
    } else {
        Upper::Crossing { arcs: [t, s], normal, first: second, second: first }
    }
}

/// A map of the parameter that takes knots to knots: to `shift` minus the parameter if it runs back, else plus.
struct Symmetry {
    back: bool,
    shift: Rational,
}

/// The symmetries that take one place near to the other, as f64 sees it.
fn symmetries(frame: &Frame, low: (usize, f64), high: (usize, f64)) -> Vec<Symmetry> {
    const NEAR: f64 = 1e-9;
    const MOST: usize = 4;
    let period = &frame.knots[frame.segments.len()] - &frame.knots[0];
    let scaled = |x: &Rational| ((x - &frame.knots[0]) / &period).to_f64().unwrap_or(f64::NAN);
    let knots: Vec<f64> = frame.knots.iter().map(scaled).collect();
    let place = |(k, t): (usize, f64)| knots[k] + t * (knots[k + 1] - knots[k]);
    let (s, t) = (place(low), place(high));
    let mut found: Vec<Symmetry> = vec![];
    for (back, (knot, x)) in
        [true, false].into_iter().flat_map(|back| frame.knots.iter().zip(&knots).map(move |k| (back, k)))
    {
        let image = if back { s + t - x } else { t - s + x };
        let turns = if frame.closed { image.floor() } else { 0.0 };
        let j = knots.partition_point(|k| *k < image - turns - NEAR);
        if knots.get(j).is_some_and(|k| (k - (image - turns)).abs() < NEAR) {
            let image = &frame.knots[j] + &period * BigInt::from(turns as i64);
            let shift = if back { image + knot } else { image - knot };
            if found.len() < MOST && !found.iter().any(|map| map.back == back && same(&map.shift, &shift)) {
                found.push(Symmetry { back, shift });
            }
        }
    }
    found
}

/// The direction of D = r w' - r' w of two arcs at equal parameters, if it is one all along and D changes its side.
fn through_mirror(x: &Bezier, y: &Bezier) -> Option<[Int; 3]> {
    let (x, y) = (x.forms(), y.forms());
    let d = x.difference(&y);
    let last = d[0].c.len() - 1;
    let at = |i: usize| d.each_ref().map(|d| d.c[i].clone());
    let (first, end) = (at(0), at(last));
    let parallel = |v: &[Int; 3]| (0..3).all(|k| &first[k] * &v[(k + 1) % 3] == &first[(k + 1) % 3] * &v[k]);
    ((0..=last).all(|i| parallel(&at(i))) && integer::dot(&first, &end).sign().is_lt()).then(|| {
        let common = first.iter().fold(Int::ZERO, |g, c| gcd(&g, c));
        first.map(|c| exact_div(&c, &common))
    })
}

fn touch(s: &Strand, t: &Strand, upper: Upper) -> Touch {
    // w > 0 at both ends, but a control weight of a long arc may not be: then no box is given
    let point = |arc: &Bezier, i: usize| {
        let [x, y, z, w] = arc.point(i);
        w.sign().is_gt().then(|| [x, y, z].map(|x| Rational::new(x.big(), w.big())))
    };
    let points = s.arcs.iter().flat_map(|arc| (0..=arc.degree()).map(move |i| point(arc, i))).collect();
    Touch { s: s.ends.clone(), t: t.ends.clone(), points, upper }
}

/// Miranda: for some Y and G = Y (F1, F2), G1 has opposite strict signs on the faces s = 0 and s = 1 of a square, G2 on
/// t = 0 and t = 1; returns Y. The map is given on the parts of the square, rows along s.
fn opposite_faces(map: &[Vec<[Form<Int>; 2]>]) -> Option<[[Dyadic; 2]; 2]> {
    fn one_sign<'a>(mut coefficients: impl Iterator<Item = &'a Int>) -> Ordering {
        let first = coefficients.next().map_or(Ordering::Equal, Int::sign);
        if coefficients.all(|c| c.sign() == first) { first } else { Ordering::Equal }
    }
    let rows = preconditioner(map)?;
    let combined = |row: &[Dyadic; 2]| -> Vec<Vec<Form<Int>>> {
        let form = |[f1, f2]: &[Form<Int>; 2]| times_dyadic(f1, &row[0]).add(&times_dyadic(f2, &row[1]));
        map.iter().map(|parts| parts.iter().map(form).collect()).collect()
    };
    let (g1, g2) = (combined(&rows[0]), combined(&rows[1]));
    let row = |parts: &[Form<Int>], last: bool| {
        one_sign(parts.iter().flat_map(|g| {
            let (i, width) = (if last { g.ds } else { 0 }, g.dt + 1);
            g.c[i * width..(i + 1) * width].iter()
        }))
    };
    let column = |last: bool| {
        one_sign(g2.iter().flat_map(|parts| {
            let g = &parts[if last { parts.len() - 1 } else { 0 }];
            g.c.iter().skip(if last { g.dt } else { 0 }).step_by(g.dt + 1)
        }))
    };
    let opposite = |a: Ordering, b: Ordering| a != Ordering::Equal && a == b.reverse();
    let opposite = opposite(row(&g1[0], false), row(&g1[g1.len() - 1], true)) && opposite(column(false), column(true));
    opposite.then_some(rows)
}

/// The inverse of the mean derivative of a map over its square, to the precision of f64.
fn preconditioner(map: &[Vec<[Form<Int>; 2]>]) -> Option<[[Dyadic; 2]; 2]> {
    let far = |parts: &[[Form<Int>; 2]], k: usize| parts[parts.len() - 1][k].clone();
    let mean = |k: usize| {
        let (first, last) = (&map[0], &map[map.len() - 1]);
        // coefficients at corners are values; the exponents of all parts are one
        let near_near = first[0][k].c[0].clone();
        let (near_far, far_near, far_far) = (far(first, k), &last[0][k], far(last, k));
        let near_far = near_far.c[near_far.dt].clone();
        let far_near = far_near.c[far_near.c.len() - far_near.dt - 1].clone();
        let far_far = far_far.c[far_far.c.len() - 1].clone();
        let along_s = &(&far_near + &far_far) - &(&near_near + &near_far);
        let along_t = &(&near_far + &far_far) - &(&near_near + &far_near);
        let top = along_s.bits().max(along_t.bits()) as i64;
        ([along_s, along_t].map(|x| x.to_f64_shifted(top)), top)
    };
    let ((f1, top1), (f2, top2)) = (mean(0), mean(1));
    let det = f1[0] * f2[1] - f1[1] * f2[0];
    let inverse = [[f2[1] / det, -f1[1] / det], [-f2[0] / det, f1[0] / det]];
    inverse.iter().flatten().all(|x| x.is_finite()).then_some(())?;
    // F1 is 2^top1 of the size of f1, and so is F2
    let top = top1.max(top2);
    let shifted = |x: f64, by: i64| {
        let x = Dyadic::from_f64(x);
        Dyadic { m: x.m, e: x.e + by }
    };
    Some(inverse.map(|row| [shifted(row[0], top - top1), shifted(row[1], top - top2)]))
}

fn times_dyadic(form: &Form<Int>, k: &Dyadic) -> Form<Int> {
    let mut form = form.mul(&Form::from_bernstein(std::slice::from_ref(&k.m)));
    form.exp += k.e;
    form
}

/// A point of integer homogeneous coordinates.
fn whole_point([x, y, z, w]: [Int; 4]) -> Point {
    let dyadic = |m: Int| Dyadic { m, e: 0 };
    Point { x: [x, y, z].map(dyadic), w: dyadic(w) }
}

/// Half the largest distance between control points of two short strands, from above.
fn half_distance_above(x: &[Bezier], y: &[Bezier]) -> Option<f64> {
    let points = |arcs: &[Bezier]| -> Option<Vec<Point>> {
        let points = arcs.iter().flat_map(|b| (0..=b.degree()).map(|i| b.point(i)));
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

/// The segment, and the fraction of denominator at most 1000 within 1e-7 of t in [0, 1], by continued fractions: where
/// strands touch without crossing Newton's method comes no closer.
/// Fractions of such denominators are 1e-6 apart.
fn simplest(at: (usize, f64)) -> Option<(usize, Int, Int)> {
    fraction(at, 1000, 1e-7)
}

pub(crate) fn fraction((segment, t): (usize, f64), most: i64, near: f64) -> Option<(usize, Int, Int)> {
    let (mut p, mut q) = ((0i64, 1i64), (1i64, 0i64));
    let mut x = t;
    for _ in 0..30 {
        let whole = x.floor();
        (p, q) = ((p.1, whole as i64 * p.1 + p.0), (q.1, whole as i64 * q.1 + q.0));
        if q.1 > most {
            return None;
        }
        let (num, den) = (p.1, q.1);
        if (num as f64 / den as f64 - t).abs() < near {
            return (num >= 0 && num <= den).then(|| (segment, Int::from(num), Int::from(den)));
        }
        x = 1.0 / (x - whole);
        if !x.is_finite() || x > 1e12 {
            return None;
        }
    }
    None
}

/// The normal of the plane of a planar spine, and two coordinates on which it projects one to one; `None` if it is not
/// planar.
pub(crate) fn plane(frame: &Frame) -> Option<([Int; 3], [usize; 2])> {
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
    let inside = |g: &[Int; 3]| integer::dot(&normal, g).is_zero();
    if !gaps.iter().all(inside) {
        return None;
    }
    let drop = (0..3).max_by_key(|&k| normal[k].abs())?;
    Some((normal, [(drop + 1) % 3, (drop + 2) % 3]))
}
