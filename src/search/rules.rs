//! The rules that close a pair of cells; see `body` for what each proves.

use super::frame::{ExactForms, Frame, weight_ratio};
use super::tree::{Cell, Cone, Node, ROUNDING, SINE_SLACK, V3, cross, dot, norm, sub};
use crate::bernstein::{self as form, Ball, Form, Scalar, UNIT, Vec3, binomial_error, binomials};
use crate::enclosure::Interval;
use crate::integer::Int;
use std::cell::OnceCell;

/// Certificates hold multipliers in units of 2^-32: few bits, for exact arithmetic, but enough for strands that are far
/// closer than a cell is long.
pub(crate) const UNITS: f64 = 4_294_967_296.0;

/// To the nearest unit, for multipliers.
pub(crate) fn in_units(x: f64) -> f64 {
    (x * UNITS).round() / UNITS
}

/// What the quadratic model of |q|^2 in the middle of two cells sees; it only steers the rules.
pub(crate) struct Model {
    /// The nearest critical pair, relative to the cells and in units: there the *bent* rule is centred.
    pub(crate) centre: [f64; 2],
    /// |q|^2 there.
    pub(crate) predicted_sq: f64,
    /// Is |q|^2 all but constant in some direction?
    pub(crate) flat: bool,
    /// Shares of q.T(s) and q.T(t) that may have one sign together where neither has alone.
    pub(crate) shares: Option<[f64; 2]>,
}

/// The *bent* rule multiplies D.a by a product of lines (given by the values at both ends), so that q.C' comes to be
/// multiplied by the arc length from the centre up to third order; `shape` is that of the cell.
fn lines(centre: f64, shape: &Shape) -> [[f64; 2]; 2] {
    let (a, b) = (1.0 + shape.pace * centre + shape.weight, shape.pace + 2.0 * shape.weight);
    [[-centre, 1.0 - centre], [a, a - b]]
}

/// By which share half the speed, and half the weight, grow along a cell, numerically, in units.
pub(crate) struct Shape {
    pub(crate) pace: f64,
    pub(crate) weight: f64,
}

impl Shape {
    pub(crate) fn of(c: Cell) -> Self {
        let growth = |from: f64, to: f64| {
            let share = in_units((to - from) / (to + from));
            if share.is_nan() { 0.0 } else { share.clamp(-0.25, 0.25) }
        };
        let (w0, w1) = (c.weight(0), c.weight(c.w.len().max(1) - 1));
        let pace = growth(norm(&c.a[0]) / (w0 * w0), norm(&c.a[c.a.len() - 1]) / (w1 * w1));
        Self { pace, weight: growth(w0, w1) }
    }

    /// The weight along the cell, 1 in the middle.
    fn weights(&self) -> [f64; 2] {
        [1.0 - self.weight, 1.0 + self.weight]
    }
}

/// A rule that closes a pair of exact arcs.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Closed {
    TiltFirst,
    TiltSecond,
    Bent,
    Far,
}

/// Rules from exact arcs: f64 first, then intervals, then integers.
pub(crate) fn decide(cells: [Cell; 2], frame: &Frame, radius: f64, centre: [f64; 2]) -> Option<Closed> {
    /// The rule that holds, or whether surely none does; y in the second variable.
    fn run<T: Scalar>(
        [x, y]: [&ExactForms; 2],
        d: &Vec3<Int>,
        shapes: &[Shape; 2],
        radius: f64,
        centre: [f64; 2],
    ) -> Result<Closed, bool> {
        // w(t) / w(s): here a = r'w - r w' in the scale of r and w
        let (ratio, exp) = weight_ratio(&y.w, &x.w);
        let ratio = ratio * shapes[0].weights()[0] / shapes[1].weights()[0];
        let line = |[from, to]: [f64; 2], k: f64, exp: i64| Form::<T>::line(from * k, to * k, exp);
        let multiplier = |k: usize, ratio: f64, exp: i64| {
            let [first, second] = lines(centre[k], &shapes[k]);
            let own = line(first, ratio, exp).mul(&line(second, 1.0, 0));
            let own = if k == 0 { own } else { own.transposed() };
            if [x, y][1 - k].w.c.len() == 1 {
                return own;
            }
            let other = line(shapes[1 - k].weights(), 1.0, 0);
            own.mul(&if k == 0 { other.transposed() } else { other })
        };
        let (first, second) = (multiplier(0, -ratio, exp), multiplier(1, 1.0 / ratio, -exp));
        let cast = |v: &Vec3<Int>| v.each_ref().map(T::cast);
        let (d, weights) = (cast(d), T::cast(&x.w).mul(&T::cast(&y.w)));
        let (ds, dt) = (form::dot(&d, &cast(&x.a)), form::dot(&d, &cast(&y.a)));
        let plain = stretched(&d, &weights, radius);
        let bent = || plain.clone().add(&first.mul(&ds)).add(&second.mul(&dt)).positive();
        let rules: [(Closed, &dyn Fn() -> Option<bool>); 4] = [
            (Closed::TiltFirst, &|| ds.one_sign()),
            (Closed::TiltSecond, &|| dt.one_sign()),
            (Closed::Bent, &bent),
            (Closed::Far, &|| plain.positive()),
        ];
        let mut sure = true;
        for (closed, rule) in rules {
            match rule() {
                Some(true) => return Ok(closed),
                Some(false) => {}
                None => sure = false,
            }
        }
        Err(sure)
    }
    let shapes = cells.map(Shape::of);
    // D in integers: rounded, its digits would be lost where the strands are far closer than the box is wide
    let [x, y] = cells.map(|cell| cell.exact(frame).forms());
    let y = y.transposed();
    let (exact, d) = ([&x, &y], x.difference(&y));
    run::<f64>(exact, &d, &shapes, radius, centre)
        .or_else(|sure| if sure { Err(true) } else { run::<Interval>(exact, &d, &shapes, radius, centre) })
        .or_else(|sure| if sure { Err(true) } else { run::<Int>(exact, &d, &shapes, radius, centre) })
        .ok()
}

/// `Some(true)` if a rule says so; `Some(false)` if all surely fail; `None` if the arithmetic cannot tell.
pub(crate) fn first_true<const N: usize>(rules: [&dyn Fn() -> Option<bool>; N]) -> Option<bool> {
    let mut sure = true;
    for rule in rules {
        match rule() {
            Some(true) => return Some(true),
            Some(false) => {}
            None => sure = false,
        }
    }
    sure.then_some(false)
}

/// |D|^2 - (2r)^2 (w(s) w(t))^2.
fn stretched<T: Scalar>(d: &Vec3<T>, weights: &Form<T>, radius: f64) -> Form<T> {
    let reach = weights.clone().scale(2.0 * radius);
    form::dot(d, d).sub(&reach.sqr())
}

/// D, D.a(s) and D.a(t) on two cells, in f64; the products are formed when first asked for.
pub(crate) struct Gap<'c> {
    x: Cell<'c>,
    y: Cell<'c>,
    pub(crate) d: Vec3<f64>,
    ds: OnceCell<Form<f64>>,
    dt: OnceCell<Form<f64>>,
}

impl<'c> Gap<'c> {
    pub(crate) fn of(x: Cell<'c>, y: Cell<'c>) -> Self {
        Self { x, y, d: difference(x, y), ds: OnceCell::new(), dt: OnceCell::new() }
    }

    /// D.a(s).
    pub(crate) fn ds(&self) -> &Form<f64> {
        self.ds.get_or_init(|| form::dot(&self.d, &self.x.hodograph_forms()))
    }

    /// D.a(t).
    pub(crate) fn dt(&self) -> &Form<f64> {
        self.dt.get_or_init(|| form::dot(&self.d, &self.y.hodograph_forms().map(Form::transposed)))
    }

    /// The rule *together*: k D.a(s) + l D.a(t) has one sign.
    pub(crate) fn together(&self, sides: [f64; 2]) -> Option<bool> {
        let (v, w) = (self.x.weight(0), self.y.weight(0));
        let [k, l] = [sides[0] * w * w * pace(self.x), sides[1] * v * v * pace(self.y)];
        self.ds().mul(&exactly([k])).add(&self.dt().mul(&exactly([l]))).one_sign()
    }

    /// The rule *bent*.
    pub(crate) fn bent(&self, radius: f64, centre: [f64; 2]) -> Option<bool> {
        let (x, y) = (self.x, self.y);
        let plain = stretched(&self.d, &x.weight_form().mul(&y.weight_form().transposed()), radius);
        let (own, other) = (Shape::of(x), Shape::of(y));
        // the quotient of the weights in the middle
        let ratio = y.weight(0) * own.weights()[0] / (x.weight(0) * other.weights()[0]);
        let multiplier = |c: f64, k: f64, own: &Shape| {
            let [[from, to], second] = lines(c, own);
            exactly([from * k, to * k]).mul(&exactly(second))
        };
        let mut first = multiplier(centre[0], -ratio * pace(x), &own);
        let mut second = multiplier(centre[1], pace(y) / ratio, &other).transposed();
        if !y.w.is_empty() {
            first = first.mul(&exactly(other.weights()).transposed());
        }
        if !x.w.is_empty() {
            second = second.mul(&exactly(own.weights()));
        }
        plain.add(&first.mul(self.ds())).add(&second.mul(self.dt())).positive()
    }
}

/// The univariate form with these Bernstein coefficients.
fn exactly<const N: usize>(c: [f64; N]) -> Form<f64> {
    Form::from_strip(c.into_iter(), 0.0, 0)
}

/// r'w - r w' of the cell is `pace` times the hodograph held.
fn pace(c: Cell) -> f64 {
    let n = c.p.len() - 1;
    if c.w.is_empty() {
        let mean: V3 = std::array::from_fn(|k| c.a.iter().map(|a| a[k]).sum::<f64>() / c.a.len() as f64);
        return norm(&sub(&c.p[n], &c.p[0])) / norm(&mean);
    }
    n as f64 * c.w[0] * c.w[1] * norm(&sub(&c.p[1], &c.p[0])) / norm(&c.a[0])
}

/// Shares of q.T(s) and q.T(t) as the multipliers of *together*: whole numbers of 32 bits.
pub(crate) fn sides(x: Cell, y: Cell, shares: [f64; 2]) -> [f64; 2] {
    let chord = |c: Cell| norm(&sub(&c.p[c.p.len() - 1], &c.p[0]));
    let sides = [shares[0] / chord(x), shares[1] / chord(y)];
    let largest = sides[0].abs().max(sides[1].abs());
    sides.map(|side| (side / largest * UNITS).round())
}

/// D = r(s) w(t) - r(t) w(s), from differences of points so that nothing cancels.
fn difference(x: Cell, y: Cell) -> Vec3<f64> {
    let (n, m) = (x.p.len() - 1, y.p.len() - 1);
    let (bs, bt) = (binomials(n), binomials(m));
    let (wx, wy) = (x.heaviest(), y.heaviest());
    let larger = |m: f64, x: f64| if x > m { x } else { m };
    // in columns, so that the inner loop runs over neighbours
    let weights: Vec<f64> = (0..=m).map(|j| y.weight(j)).collect();
    std::array::from_fn(|k| {
        let column: Vec<f64> = y.p.iter().map(|q| q[k]).collect();
        let (mut mag, mut gap) = (0.0, 0.0);
        let mut c = vec![0.0; (n + 1) * (m + 1)];
        for (i, row) in c.chunks_exact_mut(m + 1).enumerate() {
            let (p, v, b) = (x.p[i][k], x.weight(i), bs[i]);
            for (((c, q), w), b2) in row.iter_mut().zip(&column).zip(&weights).zip(bt.iter()) {
                let q = p - q;
                gap = larger(gap, q.abs());
                let d = q * (v * w);
                mag = larger(mag, d.abs());
                *c = d * (b * b2);
            }
        }
        let points = (wx + x.w_err) * (wy + y.w_err) * (x.p_err + y.p_err);
        let heavy = gap * (x.w_err * (wy + y.w_err) + y.w_err * wx) * 2.0;
        let rounding = (8.0 * UNIT + binomial_error(n) + binomial_error(m)) * mag;
        let rad = (points + heavy + rounding) * (1.0 + 1e-6) + 1e-290;
        Form { ds: n, dt: m, exp: 0, c, norm: Ball { mag: mag + rad, rad } }
    })
}

/// Has (p - q).a one strict sign for all control points p of x, q of y and all hodograph vectors a of z? The
/// coordinates of points are off such that p - q is off by at most `e`.
pub(crate) fn one_side(x: Cell, y: Cell, z: Cell, e: f64) -> bool {
    let base = &y.p[0];
    let mut side = 0.0f64;
    let reach = x.p.iter().chain(y.p).map(|p| dot(&sub(p, base), &sub(p, base))).fold(0.0f64, f64::max).sqrt();
    for a in z.a {
        let range = |c: Cell| {
            c.p.iter()
                .map(|p| dot(&sub(p, base), a))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)))
        };
        let ((l, h), (lo, hi)) = (range(x), range(y));
        let err = (e * (norm(a) + 2.0 * z.a_err) + 4.0 * reach * z.a_err + ROUNDING * reach * norm(a)) * (1.0 + 1e-9);
        let now = if l - hi > err {
            1.0
        } else if lo - h > err {
            -1.0
        } else {
            return false;
        };
        if side * now < 0.0 {
            return false;
        }
        side = now;
    }
    true
}

/// A direction from the second arc to the first that is orthogonal to both, if they are nearly straight.
pub(crate) fn across(q0: &V3, a: &Cone, b: &Cone) -> V3 {
    let c = cross(&a.axis, &b.axis);
    if dot(&c, &c) > 1e-2 {
        return if dot(&c, q0) < 0.0 { c.map(|x| -x) } else { c };
    }
    let along = dot(q0, &a.axis);
    std::array::from_fn(|k| q0[k] - along * a.axis[k])
}

/// Is q.T of one strict sign for q in the ball (q0, spread) and T in the cone of the node?
pub(crate) fn tilted(q0: &V3, length: f64, spread: f64, node: &Node) -> bool {
    let sin_ball = spread / length * (1.0 + ROUNDING) + ROUNDING;
    if sin_ball.is_nan() || sin_ball >= node.cone.cos {
        return false;
    }
    // |cos(angle of q0 and axis)| > sin(alpha + beta), with alpha + beta < 90 degrees as cos(alpha) > sin(beta)
    let cos_ball = (1.0 - sin_ball * sin_ball).max(0.0).sqrt() + SINE_SLACK;
    dot(q0, &node.cone.axis).abs() / length > node.cone.sin() * cos_ball.min(1.0) + sin_ball + 2.0 * ROUNDING
}

/// How far the control points are from those of a uniform straight run between the same ends, numerically.
pub(crate) fn bulge(c: Cell) -> f64 {
    let n = c.p.len() - 1;
    let (first, last) = (&c.p[0], &c.p[n]);
    let off = |(i, p): (usize, &V3)| {
        let share = i as f64 / n as f64;
        norm(&std::array::from_fn(|k| p[k] - (first[k] + share * (last[k] - first[k]))))
    };
    c.p.iter().enumerate().map(off).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::super::tree::Head;
    use super::*;

    fn vectors(points: &[V3; 3]) -> [V3; 2] {
        [sub(&points[1], &points[0]), sub(&points[2], &points[1])]
    }

    fn cell<'c>(head: &'c Head, p: &'c [V3; 3], a: &'c [V3]) -> Cell<'c> {
        Cell { head, r: p, w: &[], a, p }
    }

    /// An arc that turns back: (p - q).a is below 0 for its first hodograph vector and above 0 for its second, and
    /// where it turns the distance to the other arc is stationary.
    #[test]
    fn one_side_needs_one_sign_of_all_hodograph_vectors() {
        let head = Head::default();
        let points = [
            [[0.0, -0.1, 0.0], [1.0, 0.0, 0.0], [0.0, 0.1, 0.0]],
            [[0.0, -0.1, 0.0], [1.0, 0.0, 0.0], [2.0, 0.1, 0.0]],
            [[10.0, -0.1, 0.0], [10.0, 0.0, 0.0], [10.0, 0.1, 0.0]],
            [[-10.0, -0.1, 0.0], [-10.0, 0.0, 0.0], [-10.0, 0.1, 0.0]],
        ];
        let a = points.each_ref().map(vectors);
        let [back, on, far, before] = [0, 1, 2, 3].map(|k| cell(&head, &points[k], &a[k]));
        for other in [far, before] {
            assert!(!one_side(back, other, back, 1e-12));
            assert!(!one_side(other, back, back, 1e-12));
            // one vector alone, or both with one sign, would do
            assert!(one_side(on, other, on, 1e-12));
            assert!(one_side(other, on, on, 1e-12));
        }
        let [first, second] = [0, 1].map(|k| Cell { a: &back.a[k..=k], ..back });
        assert!(one_side(back, far, first, 1e-12) && one_side(back, far, second, 1e-12));
    }
}
