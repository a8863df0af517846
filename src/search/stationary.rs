//! One stationary pair in a box: F = (D.a(s), D.a(t)) has a zero there, and no other (docs/claims.md, section N).
//!
//! A box may step over a joint: then F comes in parts, on each of which it is a polynomial, and is continuous. The derivatives
//! of all parts lie in an interval matrix J. With Y near the inverse of its middle and A = Y J, in a box X with a corner z:
//! - *once*: if A11, A22 > 0 and A11 A22 > |A12| |A21|, F vanishes at most once in X;
//! - *Krawczyk*: if z - Y F(z) + (1 - A)(X - z) lies inside X, F vanishes in X.

use super::strand::{Strand, over};
use super::tree::Cell;
use crate::bernstein::{Ball, Form, Scalar, UNIT, Vec3, binomial_error, binomials, dot};
use crate::enclosure::Interval;
use crate::integer::{Int, ldexp};
use crate::spine::Bezier;

/// Covers the rounding of the bounds themselves.
const SLACK: f64 = 1.0 + 1e-9;

/// Bernstein coefficients in f64, each off by at most `rad`.
#[derive(Debug, Clone)]
pub(crate) struct Net {
    ds: usize,
    dt: usize,
    c: Vec<f64>,
    rad: f64,
}

impl Net {
    /// Of 2^-exp times a form.
    pub(crate) fn of(form: &Form<f64>, exp: i64) -> Self {
        let (ds, dt) = (form.ds, form.dt);
        let (bs, bt) = (binomials(ds), binomials(dt));
        let (mut c, up) = (Vec::with_capacity(form.c.len()), form.exp - exp);
        for (row, b) in form.c.chunks(dt + 1).zip(bs.iter()) {
            c.extend(row.iter().zip(bt.iter()).map(|(x, b2)| x / (b * b2)));
        }
        let errors = 3.0 * UNIT + binomial_error(ds) + binomial_error(dt);
        let rad = form.norm.rad + errors * (form.norm.mag + form.norm.rad);
        if up != 0 {
            c.iter_mut().for_each(|c| *c = ldexp(*c, up));
        }
        Self { ds, dt, c, rad: ldexp(rad, up) * SLACK + 1e-290 }
    }

    /// As a form.
    fn form(&self) -> Form<f64> {
        let (bs, bt) = (binomials(self.ds), binomials(self.dt));
        let rows = self.c.chunks(self.dt + 1).zip(bs.iter());
        let c = rows.flat_map(|(row, b)| row.iter().zip(bt.iter()).map(move |(x, b2)| x * (b * b2))).collect();
        let (mag, errors) = (self.mag(), 3.0 * UNIT + binomial_error(self.ds) + binomial_error(self.dt));
        let norm = Ball { mag: mag * SLACK, rad: (self.rad + errors * mag) * SLACK + 1e-290 };
        Form { ds: self.ds, dt: self.dt, exp: 0, c, norm }
    }

    fn mag(&self) -> f64 {
        self.c.iter().fold(0.0f64, |m, x| m.max(x.abs())) + self.rad
    }

    /// On the box [s0, s1] x [t0, t1] instead of the unit square, which it may leave.
    pub(crate) fn cut(&self, [s, t]: [[f64; 2]; 2]) -> Self {
        let mut cut = self.clone();
        let width = self.dt + 1;
        cut.cut_along(s, self.ds, |c, t, rest, right| casteljau_of_rows(c, width, t, rest, right));
        cut.cut_along(t, self.dt, |c, t, rest, right| {
            c.chunks_mut(width).for_each(|row| casteljau(row, t, rest, right))
        });
        cut
    }

    /// `casteljau` goes over all coefficients for the part right of t, or left.
    fn cut_along(&mut self, [from, to]: [f64; 2], degree: usize, casteljau: impl Fn(&mut [f64], f64, f64, bool)) {
        // the part right of one place and left of another, the farther cut first: its shares stay small
        let cuts = if from + to < 1.0 {
            [(from, true), ((to - from) / (1.0 - from), false)]
        } else {
            [(to, false), (from / to, true)]
        };
        for (t, right) in cuts {
            if t == if right { 0.0 } else { 1.0 } {
                continue;
            }
            let (rest, mag) = (1.0 - t, self.mag());
            casteljau(&mut self.c, t, rest, right);
            // each level rounds a combination whose factors are off by a few roundings too
            let grown = ((t.abs() + rest.abs()).max(1.0) * (1.0 + 16.0 * UNIT)).powi(degree as i32) * SLACK;
            self.rad = grown * (self.rad + 9.0 * degree as f64 * UNIT * mag) * SLACK + 1e-290;
        }
    }

    /// Holds the derivative in one direction all over the square.
    fn slope(&self, along_s: bool) -> Interval {
        let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut widen = |from: &[f64], to: &[f64]| {
            for rise in to.iter().zip(from).map(|(b, a)| b - a) {
                lo = if rise < lo { rise } else { lo };
                hi = if rise > hi { rise } else { hi };
            }
        };
        let (width, degree) = (self.dt + 1, if along_s { self.ds } else { self.dt });
        if along_s {
            widen(&self.c, &self.c[width..]);
        } else {
            self.c.chunks(width).for_each(|row| widen(row, &row[1..]));
        }
        if lo > hi {
            return Interval::point(0.0);
        }
        let off = (2.0 * self.rad + 4.0 * UNIT * self.mag()) * SLACK;
        let times = degree as f64;
        Interval::new(((lo - off).next_down() * times).next_down(), ((hi + off).next_up() * times).next_up())
    }

    /// The value at the first corner.
    fn corner(&self) -> Interval {
        Interval::new((self.c[0] - self.rad).next_down(), (self.c[0] + self.rad).next_up())
    }
}

/// The part of one polynomial right of t, or left.
fn casteljau(row: &mut [f64], t: f64, rest: f64, right: bool) {
    let n = row.len() - 1;
    for level in 1..=n {
        if right {
            for i in 0..=n - level {
                row[i] = rest * row[i] + t * row[i + 1];
            }
        } else {
            for i in (level..=n).rev() {
                row[i] = rest * row[i - 1] + t * row[i];
            }
        }
    }
}

/// The same for polynomials whose coefficients are rows.
fn casteljau_of_rows(c: &mut [f64], width: usize, t: f64, rest: f64, right: bool) {
    let n = c.len() / width - 1;
    let mut step = |i: usize| {
        let (a, b) = c[i * width..(i + 2) * width].split_at_mut(width);
        for (a, b) in a.iter_mut().zip(b) {
            let x = rest * *a + t * *b;
            *if right { a } else { b } = x;
        }
    };
    for level in 1..=n {
        if right {
            (0..=n - level).for_each(&mut step);
        } else {
            (level - 1..n).rev().for_each(&mut step);
        }
    }
}

/// A matrix of two rows.
type Matrix<T> = [[T; 2]; 2];

/// F on a box, in parts: rows along s.
pub(crate) struct Field {
    parts: Vec<Vec<[Net; 2]>>,
    /// The lengths of the parts along s and along t.
    sizes: [Vec<Interval>; 2],
}

impl Field {
    /// On the unit square, from one polynomial.
    pub(crate) fn single(f: [Net; 2]) -> Self {
        let one = || vec![Interval::point(1.0)];
        Self { parts: vec![vec![f]], sizes: [one(), one()] }
    }

    /// On two strands, exactly but for one rounding.
    pub(crate) fn of_strands(x: &Strand, y: &Strand) -> Self {
        Self::exactly(&over(x, y, |d, ax, ay| [dot(d, ax), dot(d, ay)]), x, y)
    }

    /// Two coordinates of D instead of F.
    pub(crate) fn of_gap(x: &Strand, y: &Strand, [i, k]: [usize; 2]) -> Self {
        Self::exactly(&over(x, y, |d, _, _| [d[i].clone(), d[k].clone()]), x, y)
    }

    fn exactly(forms: &[Vec<[Form<Int>; 2]>], x: &Strand, y: &Strand) -> Self {
        let near = |form: &Form<Int>| <f64 as Scalar>::cast(form);
        let near: Vec<Vec<[Form<f64>; 2]>> =
            forms.iter().map(|row| row.iter().map(|f| f.each_ref().map(near)).collect()).collect();
        let top = |k: usize| near.iter().flatten().map(|f| f[k].exp).max().unwrap_or(0);
        let tops = [top(0), top(1)];
        let parts = near.iter().map(|row| row.iter().map(|f| [0, 1].map(|k| Net::of(&f[k], tops[k]))).collect());
        Self { parts: parts.collect(), sizes: [x.sizes(), y.sizes()] }
    }

    /// Holds the derivatives of F1 and F2 along s and along t.
    fn jacobian(&self) -> Matrix<Interval> {
        let mut hull: Option<Matrix<Interval>> = None;
        for (row, ls) in self.parts.iter().zip(&self.sizes[0]) {
            for (f, lt) in row.iter().zip(&self.sizes[1]) {
                let here = f.each_ref().map(|f| [f.slope(true) / *ls, f.slope(false) / *lt]);
                hull = Some(hull.map_or(here, |all| [0, 1].map(|i| [0, 1].map(|j| all[i][j].hull(here[i][j])))));
            }
        }
        hull.expect("a box has parts")
    }

    /// Y and A.
    fn preconditioned(&self) -> Option<(Matrix<f64>, Matrix<Interval>)> {
        let j = self.jacobian();
        let [[a, b], [c, d]] = j.map(|row| row.map(Interval::mid));
        let det = a * d - b * c;
        let y = [[d / det, -b / det], [-c / det, a / det]];
        let usable = y.iter().flatten().all(|x| x.is_finite()) && j.iter().flatten().all(|x| x.mag().is_finite());
        let p = Interval::point;
        usable.then(|| (y, [0, 1].map(|i| [0, 1].map(|k| p(y[i][0]) * j[0][k] + p(y[i][1]) * j[1][k]))))
    }

    /// Does F vanish at most once?
    pub(crate) fn once(&self) -> bool {
        self.preconditioned().is_some_and(|(_, [[a, b], [c, d]])| {
            let off = Interval::point(b.mag()) * Interval::point(c.mag());
            a.is_positive() && d.is_positive() && (a * d - off).is_positive()
        })
    }

    /// Where F vanishes as far as its value at the first corner tells, from there; numerically.
    pub(crate) fn estimate(&self) -> Option<[f64; 2]> {
        let (y, _) = self.preconditioned()?;
        let f = self.parts[0][0].each_ref().map(|f| f.c[0]);
        Some(y.map(|row| -(row[0] * f[0] + row[1] * f[1])))
    }

    /// Does F vanish?
    pub(crate) fn vanishes(&self) -> bool {
        let Some((y, a)) = self.preconditioned() else { return false };
        let (p, one) = (Interval::point, Interval::point(1.0));
        let f = self.parts[0][0].each_ref().map(Net::corner);
        let total = |sizes: &[Interval]| sizes.iter().copied().reduce(|a, b| a + b).unwrap_or(one);
        let size = self.sizes.each_ref().map(|sizes| total(sizes));
        let from = size.map(|size| Interval::new(0.0, size.hi()));
        (0..2).all(|i| {
            let rest = |k: usize| (if k == i { one } else { p(0.0) } - a[i][k]) * from[k];
            let image = rest(0) + rest(1) - (p(y[i][0]) * f[0] + p(y[i][1]) * f[1]);
            image.lo() > 0.0 && image.hi() < size[i].lo()
        })
    }
}

/// |q|^2 over a box from |D|^2 and w^2 w^2, by their Bernstein coefficients: the quotient lies between the quotients of
/// those. `None` if the denominator is not surely positive.
fn quotient(num: &Form<f64>, den: &Form<f64>) -> Option<Interval> {
    let around = |x: f64, rad: f64| Interval::new((x - rad).next_down(), (x + rad).next_up());
    if let [one] = den.c[..] {
        let (num, den) = (Net::of(num, den.exp), around(one, den.norm.rad));
        let [least, most] =
            [f64::min, f64::max].map(|pick: fn(f64, f64) -> f64| num.c.iter().copied().fold(num.c[0], pick));
        return den.is_positive().then(|| around(least, num.rad).hull(around(most, num.rad)) / den);
    }
    let den = den.elevated(num.ds, num.dt);
    let (num, den) = (Net::of(num, den.exp), Net::of(&den, den.exp));
    let each = num.c.iter().zip(&den.c).map(|(p, q)| {
        let (p, q) = (around(*p, num.rad), around(*q, den.rad));
        q.is_positive().then(|| p / q)
    });
    each.collect::<Option<Vec<_>>>()?.into_iter().reduce(Interval::hull)
}

fn root(square: Interval) -> Interval {
    square.max(Interval::point(0.0)).sqrt()
}

/// |q| over a box of two cells, from D.
pub(crate) fn distance_over([x, y]: [Cell; 2], d: &Vec3<f64>, part: [[f64; 2]; 2]) -> Option<Interval> {
    let d = d.each_ref().map(|d| Net::of(d, 0).cut(part).form());
    let [v, w] = [(x.weight_form(), part[0]), (y.weight_form(), part[1])].map(|(w, range)| {
        let whole = [0.0, 1.0];
        Net::of(&w, 0).cut([range, whole]).form()
    });
    let weights = v.sqr().mul(&w.sqr().transposed());
    quotient(&dot(&d, &d), &weights).map(root)
}

/// |q| over two strands.
pub(crate) fn distance_exactly(x: &Strand, y: &Strand) -> Option<Interval> {
    let pair = |a: &Bezier, b: &Bezier| {
        let (fa, fb) = (a.forms(), b.forms().transposed());
        let d = fa.difference(&fb);
        let weights = fa.w.mul(&fb.w);
        let near = |form: &Form<Int>| <f64 as Scalar>::cast(form);
        quotient(&near(&dot(&d, &d)), &near(&weights.sqr()))
    };
    let all = x.arcs.iter().flat_map(|a| y.arcs.iter().map(move |b| pair(a, b)));
    all.collect::<Option<Vec<_>>>()?.into_iter().reduce(Interval::hull).map(root)
}
