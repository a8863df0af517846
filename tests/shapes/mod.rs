//! Curves for the tests and benches, exact, most with a delta known from their construction.
#![allow(dead_code)] // each test binary uses a part

use num_bigint::BigInt;
use num_traits::{One, Zero};
use tubecert::{Curve, Rational};

pub type Point = [Rational; 3];

pub fn q(n: i64, d: i64) -> Rational {
    Rational::new(n.into(), d.into())
}

pub fn int(n: i64) -> Rational {
    Rational::from_integer(n.into())
}

pub fn power(base: i64, e: i32) -> Rational {
    let p = Rational::from_integer(BigInt::from(base).pow(e.unsigned_abs()));
    if e < 0 { p.recip() } else { p }
}

pub fn plane(x: Rational, y: Rational) -> Point {
    [x, y, Rational::zero()]
}

pub fn bezier(points: Vec<Point>) -> Curve {
    Curve::new(points.len() - 1, points, None, None).expect("a Bezier segment")
}

pub fn bezier_int(points: &[[i64; 3]]) -> Curve {
    bezier(points.iter().map(|p| p.map(int)).collect())
}

/// The Bezier segment of polynomial coordinates (by rising power) over from..to.
pub fn from_powers(coordinates: [&[Rational]; 3], from: &Rational, to: &Rational) -> Curve {
    let n = coordinates.iter().map(|c| c.len()).max().unwrap_or(0) - 1;
    let columns = coordinates.map(|c| blossoms(c, n, from, to));
    bezier((0..=n).map(|i| std::array::from_fn(|k| columns[k][i].clone())).collect())
}

fn blossoms(c: &[Rational], n: usize, from: &Rational, to: &Rational) -> Vec<Rational> {
    // power basis in u, t = from + u (to - from), by Horner; then to Bernstein
    let mut shifted = vec![Rational::zero(); n + 1];
    for coefficient in c.iter().rev() {
        let mut next = vec![Rational::zero(); n + 1];
        for i in 0..=n {
            next[i] += &shifted[i] * from;
            if i < n {
                next[i + 1] += &shifted[i] * (to - from);
            }
        }
        next[0] += coefficient;
        shifted = next;
    }
    (0..=n).map(|i| (0..=i).map(|j| &shifted[j] * binomial(i, j) / binomial(n, j)).sum()).collect()
}

pub fn binomial(n: usize, k: usize) -> Rational {
    (0..k).fold(Rational::one(), |b, i| b * q((n - i) as i64, (i + 1) as i64))
}

/// Straight runs and exact quarter circles, as one quadratic NURBS with double knots.
#[derive(Debug, Clone)]
pub struct Path {
    points: Vec<Point>,
    weights: Vec<Rational>,
}

impl Path {
    pub fn from(start: Point) -> Self {
        Self { points: vec![start], weights: vec![Rational::one()] }
    }

    fn last(&self) -> (Point, Rational) {
        (self.points[self.points.len() - 1].clone(), self.weights[self.weights.len() - 1].clone())
    }

    pub fn line(mut self, to: Point) -> Self {
        let (from, w) = self.last();
        let middle = std::array::from_fn(|k| (&from[k] + &to[k]) / int(2));
        self.points.extend([middle, to]);
        self.weights.extend([w.clone(), w]);
        self
    }

    /// A quarter circle; its tangents meet at `corner`.
    pub fn quarter(mut self, corner: Point, to: Point) -> Self {
        let (_, w) = self.last();
        // 1 : 1 : 2 or 2 : 1 : 1, whichever keeps the weights small
        let (middle, end) = if w.is_one() { (w.clone(), &w * int(2)) } else { (&w / int(2), &w / int(2)) };
        self.points.extend([corner, to]);
        self.weights.extend([middle, end]);
        self
    }

    /// A half circle about `centre`, by way of `by`.
    pub fn half(self, centre: &Point, by: &Point) -> Self {
        let (from, _) = self.last();
        let to: Point = std::array::from_fn(|k| &centre[k] * int(2) - &from[k]);
        let corner = |p: &Point| std::array::from_fn(|k| &p[k] + &by[k] - &centre[k]);
        let (first, second) = (corner(&from), corner(&to));
        self.quarter(first, by.clone()).quarter(second, to)
    }

    pub fn curve(self) -> Curve {
        let pieces = (self.points.len() - 1) / 2;
        let mut knots = vec![Rational::zero()];
        for i in 0..=pieces {
            knots.extend([int(i as i64), int(i as i64)]);
        }
        knots.push(int(pieces as i64));
        Curve::new(2, self.points, Some(self.weights), Some(knots)).expect("a path")
    }
}

/// Two parallel strands of this length, 2 `radius` apart, joined by an exact half circle: delta is the radius, by
/// every term at once.
pub fn hairpin(length: Rational, radius: Rational) -> Curve {
    let zero = Rational::zero;
    let (left, right) = (-&radius, radius.clone());
    Path::from(plane(left.clone(), -&length))
        .line(plane(left, zero()))
        .half(&plane(zero(), zero()), &plane(zero(), radius))
        .line(plane(right, -&length))
        .curve()
}

/// Two half circles and two straight runs: delta is the radius.
pub fn stadium(length: Rational, radius: Rational) -> Curve {
    let zero = Rational::zero;
    let (left, right) = (-&radius, radius.clone());
    Path::from(plane(left.clone(), -&length))
        .line(plane(left.clone(), zero()))
        .half(&plane(zero(), zero()), &plane(zero(), radius.clone()))
        .line(plane(right, -&length))
        .half(&plane(zero(), -&length), &plane(zero(), -&length - radius))
        .curve()
}

/// `quarters` quarters of the unit circle, counterclockwise from (1, 0).
pub fn circle(quarters: usize) -> Curve {
    let corner = [(1, 0), (0, 1), (-1, 0), (0, -1)].map(|(x, y)| plane(int(x), int(y)));
    (0..quarters)
        .fold(Path::from(corner[0].clone()), |path, i| {
            let (a, b) = (&corner[i % 4], &corner[(i + 1) % 4]);
            path.quarter(std::array::from_fn(|k| &a[k] + &b[k]), b.clone())
        })
        .curve()
}

/// A straight run of length 1 that ends in a quarter circle: delta is the radius.
pub fn hook(radius: Rational) -> Curve {
    let (one, zero) = (Rational::one, Rational::zero);
    Path::from(plane(zero(), zero()))
        .line(plane(one(), zero()))
        .quarter(plane(one() + &radius, zero()), plane(one() + &radius, radius))
        .curve()
}

/// x = t^3 - t, y = t^2, z = c (t - t^3/3) for |t| <= 3/2: a loop whose strands pass each other at t = +-1, at right
/// angles to their distance 4c/3. For small c > 0 delta = 2c/3; for c = 0 the spine crosses itself there.
pub fn alpha(c: Rational) -> Curve {
    let (one, zero) = (Rational::one, Rational::zero);
    let x = [zero(), -one(), zero(), one()];
    let y = [zero(), zero(), one()];
    let z = [zero(), c.clone(), zero(), -c / int(3)];
    from_powers([&x, &y, &z], &q(-3, 2), &q(3, 2))
}

/// A closed figure of eight in the plane with its crossing at the origin, where both strands have a knot.
pub fn figure_eight() -> Curve {
    periodic(
        3,
        &[[0, 0], [2, 2], [4, 2], [5, 0], [4, -2], [2, -2], [0, 0], [-2, 2], [-4, 2], [-5, 0], [-4, -2], [-2, -2]]
            .map(|[x, y]| plane(int(x), int(y))),
    )
}

/// A bow (u, 0, height + u^2), u from `from` to 1, over the line (slant v, v, 0) with v = t^3 + t - 1, joined by a cubic: the
/// doubly critical pair has distance `height` and lies on the knot u = 0, and at the irrational zero of v.
pub fn bow_over_a_line(height: &Rational, slant: i64, from: &Rational) -> Curve {
    let zero = int(0);
    let bow: [&[Rational]; 3] = [&[int(0), int(1)], &[], &[height.clone(), int(0), int(1), int(0)]];
    let along = |k: i64| [-k, k, 0, k].map(int);
    let line: [&[Rational]; 3] = [&along(slant), &along(1), &[]];
    let (left, right) = (from_powers(bow, from, &zero), from_powers(bow, &zero, &int(1)));
    let line = from_powers(line, &int(-1), &int(2));
    let joint = [[int(5), int(0), height + int(9)], [int(-25 * slant), int(-25), int(0)]];
    let pieces = [left.control_points(), &right.control_points()[1..], &joint[..], line.control_points()];
    let knots = (0..=4).flat_map(|k| vec![int(k); if k % 4 == 0 { 4 } else { 3 }]).collect();
    Curve::new(3, pieces.concat(), None, Some(knots)).expect("a curve")
}

/// In a plane, so that the bow crosses the line: on a knot, and at an irrational parameter.
pub fn crossing_on_a_knot(slant: i64) -> Curve {
    map_points(&bow_over_a_line(&int(0), slant, &int(-1)), |[x, y, z]| [x.clone(), y + z, int(0)])
}

/// The same closed by a cubic, the seam on that knot.
pub fn crossing_on_its_seam() -> Curve {
    let flat = crossing_on_a_knot(0);
    let points = flat.control_points();
    let (end, start) = (&points[points.len() - 1], &points[0]);
    let back = [[end[0].clone(), &end[1] + int(3), int(0)], [&start[0] - int(3), &start[1] + int(6), int(0)]];
    let turned = [&points[3..], &back[..], &points[..4]].concat();
    let spans = (turned.len() - 1) / 3;
    let knots = (0..=spans).flat_map(|k| vec![int(k as i64); if k % spans == 0 { 4 } else { 3 }]).collect();
    Curve::new(3, turned, None, Some(knots)).expect("a curve")
}

/// A spine in space that is its own mirror image, the start that of the finish: it passes through the mirror x = 0 at
/// irrational parameters, and there through itself.
pub fn butterfly() -> Curve {
    let points = [[4, -19, -11], [-4, -24, 8], [0, 8, 0], [4, -24, 8], [-4, -19, -11]];
    bezier_int(&points)
}

/// A closed spine twice round in space, its second turn the mirror image of its first: it passes through the mirror z = 0
/// at irrational parameters, and there through itself.
pub fn glide() -> Curve {
    let turn = [[3, 0, 2], [2, 3, 1], [-2, 4, -1], [-4, 0, 1], [-2, -3, -3], [2, -4, 1]];
    let points = [1, -1].iter().flat_map(|side| turn.map(|[x, y, z]| [x, y, side * z].map(int)));
    periodic(3, &points.collect::<Vec<_>>())
}

/// Uniform periodic B-spline.
pub fn periodic(degree: usize, points: &[Point]) -> Curve {
    let n = points.len();
    let all: Vec<Point> = points.iter().chain(&points[..degree]).cloned().collect();
    let knots = (0..=n + 2 * degree).map(|i| int(i as i64 - degree as i64)).collect();
    Curve::new(degree, all, None, Some(knots)).expect("a periodic spline")
}

/// A torus knot as a periodic cubic B-spline with this many spans, control points rounded to 1/1000.
pub fn torus_knot(turns: i64, around: i64, spans: usize) -> Curve {
    knot(turns, around, spans, 1000)
}

/// The same, control points rounded to 1/`unit`: coarse ones would bend sharply at many spans.
pub fn knot(turns: i64, around: i64, spans: usize, unit: i64) -> Curve {
    let points: Vec<Point> = (0..spans)
        .map(|i| {
            let angle = std::f64::consts::TAU * i as f64 / spans as f64;
            let (a, b) = (angle * turns as f64, angle * around as f64);
            let r = 2.0 + b.cos();
            rounded([r * a.cos(), r * a.sin(), b.sin()], unit)
        })
        .collect();
    periodic(3, &points)
}

fn rounded(point: [f64; 3], unit: i64) -> Point {
    point.map(|x| q((unit as f64 * x).round() as i64, unit))
}

/// A clamped uniform cubic B-spline with this many spans through nearly collinear points, to nine decimals.
pub fn nearly_straight(spans: usize) -> Curve {
    let mut random = Random(1);
    let mut off = || (random.below(20_001) - 10_000) as f64 * 1e-6;
    clamped((0..spans + 3).map(|i| rounded([i as f64, off(), off()], 1_000_000_000)).collect())
}

/// The same along a spiral of Archimedes, ten turns in a hundred spans, the next turn of the same width farther out.
pub fn spiral(spans: usize) -> Curve {
    let point = |i: usize| {
        let (angle, r) = (0.1 * i as f64, 1.0 + 0.002 * i as f64);
        rounded([r * angle.cos(), r * angle.sin(), 0.0], 1_000_000_000)
    };
    clamped((0..spans + 3).map(point).collect())
}

fn clamped(points: Vec<Point>) -> Curve {
    let spans = points.len() as i64 - 3;
    let knots = (-3..=spans + 3).map(|k| int(k.clamp(0, spans))).collect();
    Curve::new(3, points, None, Some(knots)).expect("a clamped spline")
}

/// Curve files of cubics with control points in -20 .. 20, the same in every run.
pub fn random_cubics(count: usize) -> Vec<String> {
    let mut random = Random(2026);
    let mut text = || {
        let points: [[i64; 3]; 4] = std::array::from_fn(|_| std::array::from_fn(|_| random.below(41) - 20));
        format!(r#"{{"degree": 3, "control_points": {points:?}}}"#)
    };
    (0..count).map(|_| text()).collect()
}

/// Numbers that look random, the same in every run: Knuth's linear congruential generator.
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, most: i64) -> i64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as i64 % most
    }
}

/// Symmetric about x = 0; the end disks face each other in one plane, 2 `gap` apart: delta is the gap.
pub fn bulb(gap: Rational) -> Curve {
    let side = [(gap.clone(), int(0)), (gap, int(1)), (int(3), int(2))];
    let left = side.iter().map(|(x, y)| plane(-x, y.clone()));
    let right = side.iter().rev().map(|(x, y)| plane(x.clone(), y.clone()));
    bezier(left.chain([plane(int(0), int(6))]).chain(right).collect())
}

/// A spiral in the plane: a straight run, a half circle of radius 3 back, then down to the height 2 `gap` above the
/// run, where the end disk lies in the plane of a disk of the run: delta is the gap.
pub fn faced(gap: Rational) -> Curve {
    // as one spline of degree 5 with a full knot at each joint
    let low = &gap * int(2);
    let run = [(-10, 0), (-7, 0), (-4, 0), (-1, 0), (2, 0), (5, 0)].map(|(x, y)| plane(int(x), int(y)));
    // a bend of about radius 3, ends with the tangent (-1, 0) at (5, 6)
    let bend = [(8, 0), (11, 0), (11, 6), (8, 6), (5, 6)].map(|(x, y)| plane(int(x), int(y)));
    let down =
        [(3, int(6)), (1, int(6)), (1, low.clone()), (-1, low.clone()), (-3, low)].map(|(x, y)| plane(int(x), y));
    let points: Vec<Point> = run.into_iter().chain(bend).chain(down).collect();
    let knots = [0; 6].into_iter().chain([1; 5]).chain([2; 5]).chain([3; 6]).map(int).collect();
    Curve::new(5, points, None, Some(knots)).expect("a spline")
}

/// A closed cubic like a peanut; its neck is at two knots, where the curve is at (0, +-neck) exactly.
pub fn peanut(neck: Rational) -> Curve {
    let top = |x: i64, y: Rational| plane(int(x), y);
    // at the knot of the middle point of three: (p0 + 4 p1 + p2)/6
    let y = neck;
    let points = vec![
        top(0, y.clone()),
        top(-2, y.clone()),
        top(-4, int(2)),
        top(-6, int(2)),
        top(-8, int(0)),
        top(-6, int(-2)),
        top(-4, int(-2)),
        top(-2, -&y),
        top(0, -&y),
        top(2, -&y),
        top(4, int(-2)),
        top(6, int(-2)),
        top(8, int(0)),
        top(6, int(2)),
        top(4, int(2)),
        top(2, y),
    ];
    periodic(3, &points)
}

// ---------------------------------------------------------------------------------------------------------------
// Changes of description and position, exact.

/// Knots and weights kept, every control point replaced.
pub fn map_points(curve: &Curve, f: impl Fn(&Point) -> Point) -> Curve {
    let points = curve.control_points().iter().map(f).collect();
    Curve::new(curve.degree(), points, Some(curve.weights().to_vec()), Some(curve.knots().to_vec())).expect("as before")
}

pub fn scaled(curve: &Curve, factor: &Rational) -> Curve {
    map_points(curve, |p| p.each_ref().map(|x| x * factor))
}

pub fn moved(curve: &Curve, by: &Point) -> Curve {
    map_points(curve, |p| std::array::from_fn(|k| &p[k] + &by[k]))
}

/// Rotation by the quaternion (w, x, y, z), of any length but 0.
pub fn rotated(curve: &Curve, [w, x, y, z]: [i64; 4]) -> Curve {
    let length = w * w + x * x + y * y + z * z;
    let rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ];
    map_points(curve, |p| rows.map(|row| (0..3).map(|k| &p[k] * q(row[k], length)).sum()))
}

pub fn reversed(curve: &Curve) -> Curve {
    let points = curve.control_points().iter().rev().cloned().collect();
    let weights = curve.weights().iter().rev().cloned().collect();
    let knots = curve.knots().iter().rev().map(|t| -t).collect();
    Curve::new(curve.degree(), points, Some(weights), Some(knots)).expect("reversed")
}

/// Homogeneous control points.
fn lifted(curve: &Curve) -> Vec<[Rational; 4]> {
    curve
        .control_points()
        .iter()
        .zip(curve.weights())
        .map(|(p, w)| [&p[0] * w, &p[1] * w, &p[2] * w, w.clone()])
        .collect()
}

/// The inverse of lifting; `None` if a weight is 0.
fn dropped(degree: usize, points: &[[Rational; 4]], knots: Vec<Rational>) -> Option<Curve> {
    let weights: Vec<Rational> = points.iter().map(|p| p[3].clone()).collect();
    if weights.iter().any(Zero::is_zero) {
        return None;
    }
    let points = points.iter().map(|p| std::array::from_fn(|k| &p[k] / &p[3])).collect();
    Curve::new(degree, points, Some(weights), Some(knots)).ok()
}

/// One more degree for a Bezier segment on [0, 1].
pub fn elevated(curve: &Curve) -> Option<Curve> {
    let (n, p) = (curve.degree(), lifted(curve));
    assert_eq!(p.len(), n + 1, "one segment");
    let points: Vec<[Rational; 4]> = (0..=n + 1)
        .map(|i| {
            let share = q(i as i64, n as i64 + 1);
            std::array::from_fn(|k| {
                let before = if i > 0 { &p[i - 1][k] * &share } else { Rational::zero() };
                let after = if i <= n { &p[i][k] * (Rational::one() - &share) } else { Rational::zero() };
                before + after
            })
        })
        .collect();
    let mut knots = curve.knots().to_vec();
    knots.insert(0, knots[0].clone());
    knots.push(knots[knots.len() - 1].clone());
    dropped(n + 1, &points, knots)
}

/// A knot inserted at this share of the domain (Boehm).
pub fn with_knot(curve: &Curve, share: &Rational) -> Option<Curve> {
    let (n, u, p) = (curve.degree(), curve.knots(), lifted(curve));
    let (from, to) = curve.domain();
    let t = from + share * (to - from);
    let k = (n..p.len()).rev().find(|&k| u[k] <= t && u[k] < u[k + 1])?;
    let points: Vec<[Rational; 4]> = (0..=p.len())
        .map(|i| {
            if i + n <= k {
                return p[i].clone();
            }
            if i > k {
                return p[i - 1].clone();
            }
            let share = (&t - &u[i]) / (&u[i + n] - &u[i]);
            std::array::from_fn(|x| &p[i - 1][x] * (Rational::one() - &share) + &p[i][x] * &share)
        })
        .collect();
    let mut knots = u.to_vec();
    knots.insert(k + 1, t);
    dropped(n, &points, knots)
}

/// w_i -> w_i c^i: another parameter on the same Bezier segment.
pub fn reweighted(curve: &Curve, c: &Rational) -> Curve {
    let mut factor = Rational::one();
    let weights = curve
        .weights()
        .iter()
        .map(|w| {
            let w = w * &factor;
            factor *= c;
            w
        })
        .collect();
    Curve::new(curve.degree(), curve.control_points().to_vec(), Some(weights), Some(curve.knots().to_vec()))
        .expect("one segment")
}
