//! Bernstein forms in one or two variables over three arithmetics, and the sign that their coefficients prove.
//!
//! A form of degree (m, n) is held by its *scaled* coefficients `c[i][j] = C(m,i) C(n,j) p[i][j]`, where `p` are the
//! usual Bernstein coefficients on the unit square: products become plain convolutions, and signs are the same. The
//! value of a form is `2^exp` times what the coefficients say.
//!
//! The arithmetics ("tiers"), from fast to sure: `f64` with one error radius for the whole form (docs/rounding.md proves
//! it), [`Interval`] coefficients, and exact [`Int`] coefficients. All answer the same question: [`Form::positive`].

use crate::enclosure::Interval;
use crate::integer::{Int, decompose, exact_div, lcm, ldexp};
use std::borrow::Cow;

/// Half an ulp of 1: the relative error of one rounded f64 operation.
pub(crate) const UNIT: f64 = f64::EPSILON / 2.0;
/// Absorbs the rounding of the radius computations themselves and the second-order terms.
const SLACK: f64 = 1.0 + 1e-9;
/// Absorbs underflow: far above any sum of 2^-1074, far below the magnitudes that forms are kept at.
const TINY: f64 = 1e-290;

/// A number that forms can have as coefficients.
pub(crate) trait Scalar: Clone + Sized {
    /// What a whole form carries beside its coefficients.
    type Norm: Clone;
    /// Are the coefficients exact (so that exponents are aligned downward)?
    const EXACT: bool;

    fn zero() -> Self;
    /// `out[i] += a * b[i]` for all of b.
    fn axpy(out: &mut [Self], a: &Self, b: &[Self]);
    /// The form with these scaled integer coefficients.
    fn cast(form: &Form<Int>) -> Form<Self>;
    fn norm_mul(a: &Form<Self>, b: &Form<Self>, terms: usize) -> Self::Norm;
    /// Called after a product: may tighten the norm or move powers of two into `exp`.
    fn settle(_form: &mut Form<Self>) {}
    fn add_into(a: &mut Form<Self>, b: &Form<Self>, negate: bool);
    /// Coefficients times `2^by`, `exp` reduced by `by`: the same value.
    fn shift(form: &mut Form<Self>, by: i64);
    fn scale(form: &mut Form<Self>, mantissa: i64);
    fn positive(form: &Form<Self>) -> Option<bool>;
    /// The constant 1, as a form of the given degrees.
    fn ones(ds: usize, dt: usize) -> Form<Self> {
        let (bs, bt) = (int_binomials(ds), int_binomials(dt));
        let c = bs.iter().flat_map(|a| bt.iter().map(move |b| a * b)).collect();
        Self::cast(&Form { ds, dt, exp: 0, c, norm: () })
    }
    /// The sum of products.
    fn dot(a: &Vec3<Self>, b: &Vec3<Self>) -> Form<Self> {
        a[0].mul(&b[0]).add(&a[1].mul(&b[1])).add(&a[2].mul(&b[2]))
    }
}

/// A Bernstein form; see the module.
#[derive(Debug, Clone)]
pub(crate) struct Form<T: Scalar> {
    pub(crate) ds: usize,
    pub(crate) dt: usize,
    pub(crate) exp: i64,
    pub(crate) c: Vec<T>,
    pub(crate) norm: T::Norm,
}

impl<T: Scalar> Form<T> {
    /// The linear form with the values `2^exp from` at 0 and `2^exp to` at 1, exactly.
    pub(crate) fn line(from: f64, to: f64, exp: i64) -> Self {
        let ((m, e), (k, f)) = (decompose(from), decompose(to));
        let low = if m == 0 {
            f
        } else if k == 0 {
            e
        } else {
            e.min(f)
        };
        let at = |m: i64, e: i64| if m == 0 { Int::ZERO } else { &Int::from(m) << (e - low) as u64 };
        T::cast(&Form { ds: 1, dt: 0, exp: exp + low, c: vec![at(m, e), at(k, f)], norm: () })
    }

    /// The same univariate form in the other variable.
    pub(crate) fn transposed(mut self) -> Self {
        debug_assert!(self.ds == 0 || self.dt == 0);
        std::mem::swap(&mut self.ds, &mut self.dt);
        self
    }

    pub(crate) fn mul(&self, other: &Self) -> Self {
        let (ds, dt) = (self.ds + other.ds, self.dt + other.dt);
        let mut c = vec![T::zero(); (ds + 1) * (dt + 1)];
        self.add_product(other, &mut c);
        let norm = T::norm_mul(self, other, self.terms(other));
        let mut form = Self { ds, dt, exp: self.exp + other.exp, c, norm };
        T::settle(&mut form);
        form
    }

    /// Of so many products at most is a coefficient of a product the sum.
    fn terms(&self, other: &Self) -> usize {
        (self.ds.min(other.ds) + 1) * (self.dt.min(other.dt) + 1)
    }

    /// Adds the coefficients of a product to `c`.
    fn add_product(&self, other: &Self, c: &mut [T]) {
        // the longer in the inner loop
        let (a, b) = if self.c.len() < other.c.len() { (self, other) } else { (other, self) };
        let width = a.dt + b.dt + 1;
        for (i, row) in a.c.chunks(a.dt + 1).enumerate() {
            for (j, x) in row.iter().enumerate() {
                let c = &mut c[i * width + j..];
                if a.dt == 0 {
                    // all rows at once: those of the product are as long
                    T::axpy(c, x, &b.c);
                    continue;
                }
                for (c, b) in c.chunks_mut(width).zip(b.c.chunks(b.dt + 1)) {
                    T::axpy(c, x, b);
                }
            }
        }
    }

    pub(crate) fn sqr(&self) -> Self {
        self.mul(self)
    }

    fn combined(mut self, other: &Self, negate: bool) -> Self {
        let (ds, dt) = (self.ds.max(other.ds), self.dt.max(other.dt));
        if (self.ds, self.dt) != (ds, dt) {
            self = self.elevated(ds, dt).into_owned();
        }
        let (mut a, mut b) = (self, other.elevated(ds, dt));
        let target = if T::EXACT { a.exp.min(b.exp) } else { a.exp.max(b.exp) };
        let (up_a, up_b) = (a.exp - target, b.exp - target);
        if up_a != 0 {
            T::shift(&mut a, up_a);
        }
        if up_b != 0 {
            T::shift(b.to_mut(), up_b);
        }
        T::add_into(&mut a, &b, negate);
        a
    }

    pub(crate) fn add(self, other: &Self) -> Self {
        self.combined(other, false)
    }

    pub(crate) fn sub(self, other: &Self) -> Self {
        self.combined(other, true)
    }

    pub(crate) fn elevated(&self, ds: usize, dt: usize) -> Cow<'_, Self> {
        if self.ds == ds && self.dt == dt {
            Cow::Borrowed(self)
        } else {
            Cow::Owned(self.mul(&T::ones(ds - self.ds, dt - self.dt)))
        }
    }

    /// Times the dyadic rational that the finite `k` is.
    pub(crate) fn scale(mut self, k: f64) -> Self {
        debug_assert!(k.is_finite());
        let (m, e) = decompose(k);
        T::scale(&mut self, m);
        self.exp += e;
        self
    }

    /// `Some(true)`: every coefficient is > 0, so the form is > 0 on the closed unit square. `Some(false)`: some
    /// coefficient is certainly <= 0. `None`: the arithmetic cannot tell.
    pub(crate) fn positive(&self) -> Option<bool> {
        T::positive(self)
    }

    /// One strict sign, whichever.
    pub(crate) fn one_sign(&self) -> Option<bool> {
        match self.positive() {
            Some(false) => self.clone().scale(-1.0).positive(),
            known => known,
        }
    }
}

/// A vector of forms.
pub(crate) type Vec3<T> = [Form<T>; 3];

pub(crate) fn dot<T: Scalar>(a: &Vec3<T>, b: &Vec3<T>) -> Form<T> {
    T::dot(a, b)
}

pub(crate) fn cross<T: Scalar>(a: &Vec3<T>, b: &Vec3<T>) -> Vec3<T> {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i].mul(&b[j]).sub(&a[j].mul(&b[i])))
}

/// Binomial coefficients C(n, 0..=n), exact.
pub(crate) fn int_binomials(n: usize) -> Vec<Int> {
    let mut row = vec![Int::ONE; n + 1];
    for k in 1..=n {
        row[k] = exact_div(&(&row[k - 1] * &Int::from((n - k + 1) as i64)), &Int::from(k as i64));
    }
    row
}

const TABLE: usize = 57;
static BINOMIALS: [[f64; TABLE]; TABLE] = {
    let mut rows = [[0.0; TABLE]; TABLE];
    let mut n = 0;
    while n < TABLE {
        rows[n][0] = 1.0;
        let mut k = 1;
        while k <= n {
            rows[n][k] = rows[n - 1][k - 1] + if k < n { rows[n - 1][k] } else { 0.0 };
            k += 1;
        }
        n += 1;
    }
    rows
};

/// C(n, 0..=n) in f64: exact up to n = 56, beyond with a relative error below `binomial_error(n)`.
pub(crate) fn binomials(n: usize) -> Cow<'static, [f64]> {
    if n < TABLE {
        return Cow::Borrowed(&BINOMIALS[n][..=n]);
    }
    let mut row = vec![1.0; n + 1];
    for k in 1..=n {
        row[k] = row[k - 1] * ((n - k + 1) as f64) / (k as f64);
    }
    Cow::Owned(row)
}

static INVERSES: [[f64; TABLE]; TABLE] = {
    let mut rows = BINOMIALS;
    let mut n = 0;
    while n < TABLE {
        let mut k = 0;
        while k <= n {
            rows[n][k] = 1.0 / rows[n][k];
            k += 1;
        }
        n += 1;
    }
    rows
};

/// 1 / C(n, 0..=n) in f64, off by half an ulp more than `binomials`.
fn inverses(n: usize) -> Cow<'static, [f64]> {
    if n < TABLE {
        return Cow::Borrowed(&INVERSES[n][..=n]);
    }
    Cow::Owned(binomials(n).iter().map(|b| 1.0 / b).collect())
}

pub(crate) fn binomial_error(n: usize) -> f64 {
    if n < TABLE { 0.0 } else { 3.0 * n as f64 * UNIT }
}

/// `mantissa = m 2^e` with |m| in [1/2, 1), exact for mantissas of at most 53 bits.
fn unit_mantissa(mantissa: i64) -> (f64, i64) {
    let e = 64 - i64::from(mantissa.unsigned_abs().leading_zeros());
    (ldexp(mantissa as f64, -e), e)
}

// --- exact integers ------------------------------------------------------------------------------------------------

impl Scalar for Int {
    type Norm = ();
    const EXACT: bool = true;

    fn zero() -> Self {
        Self::ZERO
    }

    fn axpy(out: &mut [Self], a: &Self, b: &[Self]) {
        if a.is_zero() {
            return;
        }
        for (o, b) in out.iter_mut().zip(b) {
            *o = &*o + &(a * b);
        }
    }

    fn cast(form: &Form<Int>) -> Form<Self> {
        form.clone()
    }

    fn norm_mul(_: &Form<Self>, _: &Form<Self>, _: usize) {}

    fn add_into(a: &mut Form<Self>, b: &Form<Self>, negate: bool) {
        for (x, y) in a.c.iter_mut().zip(&b.c) {
            *x = if negate { &*x - y } else { &*x + y };
        }
    }

    fn shift(form: &mut Form<Self>, by: i64) {
        for x in &mut form.c {
            *x = &*x << by as u64;
        }
        form.exp -= by;
    }

    fn scale(form: &mut Form<Self>, mantissa: i64) {
        let m = Int::from(mantissa);
        for x in &mut form.c {
            *x = &*x * &m;
        }
    }

    fn positive(form: &Form<Self>) -> Option<bool> {
        Some(form.c.iter().all(|x| x.sign().is_gt()))
    }
}

impl Form<Int> {
    /// From Bernstein (unscaled) coefficients.
    pub(crate) fn from_bernstein(p: &[Int]) -> Self {
        let ds = p.len() - 1;
        let c = int_binomials(ds).iter().zip(p).map(|(b, p)| b * p).collect();
        Self { ds, dt: 0, exp: 0, c, norm: () }
    }

    /// The Bernstein (unscaled) coefficients of a univariate form, up to a common positive factor.
    pub(crate) fn bernstein(&self) -> Vec<Int> {
        let binomials = int_binomials(self.ds);
        let common = binomials.iter().fold(Int::ONE, |all, b| lcm(&all, b));
        self.c.iter().zip(&binomials).map(|(c, b)| &exact_div(&common, b) * c).collect()
    }

    /// The same univariate polynomial, whose true degree is one less, in that degree: `c[k] = q[k] + q[k-1]`.
    pub(crate) fn lowered(mut self) -> Self {
        debug_assert_eq!(self.dt, 0);
        for k in 1..self.ds {
            self.c[k] = &self.c[k] - &self.c[k - 1];
        }
        let last = self.c.pop();
        debug_assert_eq!(last.as_ref(), self.c.last(), "the degree is not lower");
        self.ds -= 1;
        self
    }

    pub(crate) fn is_zero(&self) -> bool {
        self.c.iter().all(Int::is_zero)
    }

    /// The derivative of a univariate form.
    pub(crate) fn derivative(&self) -> Self {
        let n = self.c.len() - 1;
        let times = |c: &Int, k: usize| c * &Int::from(k as i64);
        let slope = |(i, p): (usize, &[Int])| &times(&p[1], i + 1) - &times(&p[0], n - i);
        let mut c: Vec<Int> = self.c.windows(2).enumerate().map(slope).collect();
        if n == 0 {
            c.push(Int::ZERO);
        }
        Self { ds: self.ds.saturating_sub(1), dt: self.dt.saturating_sub(1), c, ..*self }
    }

    fn max_bits(&self) -> i64 {
        self.c.iter().map(|x| x.bits() as i64).max().unwrap_or(0)
    }
}

// --- intervals -----------------------------------------------------------------------------------------------------

impl Scalar for Interval {
    type Norm = ();
    const EXACT: bool = false;

    fn zero() -> Self {
        Interval::point(0.0)
    }

    fn axpy(out: &mut [Self], a: &Self, b: &[Self]) {
        for (o, b) in out.iter_mut().zip(b) {
            *o = *o + *a * *b;
        }
    }

    fn cast(form: &Form<Int>) -> Form<Self> {
        let drop = form.max_bits();
        let c = form
            .c
            .iter()
            .map(|x| {
                // Nearest, so off by at most 2^-53 relative, plus underflow where x is far below the others.
                let near = x.to_f64_shifted(drop);
                if x.is_zero() { Interval::point(0.0) } else { Interval::new(near.next_down(), near.next_up()) }
            })
            .collect();
        Form { ds: form.ds, dt: form.dt, exp: form.exp + drop, c, norm: () }
    }

    fn norm_mul(_: &Form<Self>, _: &Form<Self>, _: usize) {}

    fn settle(form: &mut Form<Self>) {
        let mag = form.c.iter().fold(0.0f64, |m, x| m.max(x.mag()));
        if mag > 0.0 && !(1e-60..1e60).contains(&mag) && mag.is_finite() {
            let (_, e) = decompose(mag);
            Self::shift(form, -e.clamp(-1000, 1000));
        }
    }

    fn add_into(a: &mut Form<Self>, b: &Form<Self>, negate: bool) {
        for (x, y) in a.c.iter_mut().zip(&b.c) {
            *x = if negate { *x - *y } else { *x + *y };
        }
    }

    fn shift(form: &mut Form<Self>, by: i64) {
        for x in &mut form.c {
            *x = x.scale2(by.clamp(-100_000, 100_000) as i32);
        }
        form.exp -= by;
    }

    fn scale(form: &mut Form<Self>, mantissa: i64) {
        let (m, e) = unit_mantissa(mantissa);
        for x in &mut form.c {
            *x = *x * Interval::point(m);
        }
        form.exp += e;
    }

    fn positive(form: &Form<Self>) -> Option<bool> {
        if form.c.iter().any(|x| x.hi() <= 0.0) {
            return Some(false);
        }
        form.c.iter().all(|x| x.is_positive()).then_some(true)
    }
}

// --- f64 with one radius -------------------------------------------------------------------------------------------

/// For the Bernstein coefficients p of the exact form and those p^ that are held: `|p| <= mag` and `|p^ - p| <= rad`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ball {
    pub(crate) mag: f64,
    pub(crate) rad: f64,
}

impl Form<f64> {
    /// From univariate Bernstein (unscaled) coefficients, each off by at most `rad`.
    pub(crate) fn from_strip(p: impl ExactSizeIterator<Item = f64>, rad: f64, exp: i64) -> Self {
        let (ds, mut mag) = (p.len() - 1, 0.0f64);
        let scaled = |(p, b): (f64, &f64)| {
            mag = mag.max(p.abs());
            p * b
        };
        let c = p.zip(binomials(ds).iter()).map(scaled).collect();
        let mag = mag + rad;
        let rad = (rad + (UNIT + binomial_error(ds)) * mag) * SLACK + TINY;
        Self { ds, dt: 0, exp, c, norm: Ball { mag, rad } }
    }

    /// The derivative of a univariate form of degree 1 or more. Its Bernstein coefficients are n times the differences;
    /// those held are off by the errors of both, and by the rounding of two products and a difference.
    pub(crate) fn derivative(&self) -> Self {
        let n = self.c.len() - 1;
        let slope = |(i, p): (usize, &[f64])| (i + 1) as f64 * p[1] - (n - i) as f64 * p[0];
        let c = self.c.windows(2).enumerate().map(slope).collect();
        let (k, Ball { mag, rad }) = (2.0 * n as f64, self.norm);
        let rad = k * (rad + (2.0 * UNIT + binomial_error(n)) * (mag + rad)) * SLACK + TINY;
        let norm = Ball { mag: k * mag * SLACK, rad };
        Self { ds: self.ds.saturating_sub(1), dt: self.dt.saturating_sub(1), exp: self.exp, c, norm }
    }

    /// Univariate Bernstein (unscaled) coefficients, each off by at most the number beside them.
    pub(crate) fn strip(&self) -> (Vec<f64>, f64) {
        let n = self.c.len() - 1;
        let c = self.c.iter().zip(binomials(n).iter()).map(|(c, b)| c / b).collect();
        let rad = self.norm.rad + (2.0 * UNIT + 2.0 * binomial_error(n)) * (self.norm.mag + self.norm.rad);
        (c, rad * SLACK + TINY)
    }

    /// `max |p^| + rad`, from the coefficients.
    fn measured(&self) -> f64 {
        let larger = |m: f64, x: f64| if x > m { x } else { m };
        let mag = self.rows().fold(0.0, |mag, (row, b)| larger(mag, largest(row, &inverses(self.dt)) * b));
        mag * self.binomial_slack() + self.norm.rad
    }

    /// The rows of coefficients, each with what makes them unscaled in the first variable.
    fn rows(&self) -> impl Iterator<Item = (&[f64], f64)> {
        let inverses = inverses(self.ds);
        self.c.chunks_exact(self.dt + 1).enumerate().map(move |(i, row)| (row, inverses[i]))
    }

    /// Covers the rounding of x * inverse * inverse.
    fn binomial_slack(&self) -> f64 {
        (1.0 + 2.0 * (binomial_error(self.ds) + binomial_error(self.dt))) * SLACK
    }
}

/// Numbers side by side in the hot loops.
const LANES: usize = 4;

/// max |x| b over a row.
fn largest(row: &[f64], inverses: &[f64]) -> f64 {
    let mut lanes = [0.0f64; LANES];
    let larger = |m: f64, x: f64, b: f64| if x.abs() * b > m { x.abs() * b } else { m };
    let (rows, weights) = (row.chunks_exact(LANES), inverses.chunks_exact(LANES));
    let rest = rows.remainder().iter().zip(weights.remainder()).fold(0.0, |m, (x, b)| larger(m, *x, *b));
    for (x, b) in rows.zip(weights) {
        for k in 0..LANES {
            lanes[k] = larger(lanes[k], x[k], b[k]);
        }
    }
    lanes.into_iter().fold(rest, f64::max)
}

impl Scalar for f64 {
    type Norm = Ball;
    const EXACT: bool = false;

    fn zero() -> Self {
        0.0
    }

    fn axpy(out: &mut [Self], a: &Self, b: &[Self]) {
        for (o, b) in out.iter_mut().zip(b) {
            *o += a * b;
        }
    }

    fn cast(form: &Form<Int>) -> Form<Self> {
        let drop = form.max_bits();
        let c: Vec<f64> = form.c.iter().map(|x| x.to_f64_shifted(drop)).collect();
        let mut form =
            Form { ds: form.ds, dt: form.dt, exp: form.exp + drop, c, norm: Ball { mag: f64::INFINITY, rad: 0.0 } };
        let mag = form.measured();
        let errors = 2.0 * UNIT + binomial_error(form.ds) + binomial_error(form.dt);
        form.norm = Ball { mag: mag * (1.0 + 1e-9), rad: errors * mag * SLACK + TINY };
        form
    }

    fn norm_mul(a: &Form<Self>, b: &Form<Self>, terms: usize) -> Ball {
        let (x, y) = (a.norm, b.norm);
        let rounding = (terms + 2) as f64 * UNIT * (x.mag + x.rad) * (y.mag + y.rad);
        let inherited = x.rad * y.mag + x.mag * y.rad + x.rad * y.rad;
        Ball { mag: x.mag * y.mag * SLACK, rad: (rounding + inherited) * SLACK + TINY }
    }

    fn settle(form: &mut Form<Self>) {
        form.norm.mag = form.norm.mag.min(form.measured());
        let mag = form.norm.mag;
        if mag > 0.0 && mag.is_finite() && !(1e-60..1e60).contains(&mag) {
            let (_, e) = decompose(mag);
            Self::shift(form, -(e + 52).clamp(-900, 900));
        }
    }

    fn add_into(a: &mut Form<Self>, b: &Form<Self>, negate: bool) {
        let sign = if negate { -1.0 } else { 1.0 };
        for (x, y) in a.c.iter_mut().zip(&b.c) {
            *x += sign * y;
        }
        let (x, y) = (a.norm, b.norm);
        a.norm.rad = (x.rad + y.rad + UNIT * (x.mag + x.rad + y.mag + y.rad)) * SLACK + TINY;
        a.norm.mag = (x.mag + y.mag) * SLACK;
        a.norm.mag = a.norm.mag.min(a.measured());
    }

    fn shift(form: &mut Form<Self>, by: i64) {
        for x in &mut form.c {
            *x = ldexp(*x, by);
        }
        form.norm.mag = ldexp(form.norm.mag, by) * SLACK;
        form.norm.rad = ldexp(form.norm.rad, by) * SLACK + TINY;
        form.exp -= by;
    }

    fn scale(form: &mut Form<Self>, mantissa: i64) {
        let (m, e) = unit_mantissa(mantissa);
        for x in &mut form.c {
            *x *= m;
        }
        form.exp += e;
        form.norm.rad = (form.norm.rad + UNIT * (form.norm.mag + form.norm.rad)) * m.abs() * SLACK + TINY;
        form.norm.mag *= m.abs() * SLACK;
    }

    fn positive(form: &Form<Self>) -> Option<bool> {
        let rad = form.norm.rad * form.binomial_slack();
        if !rad.is_finite() {
            return None;
        }
        let inverses = inverses(form.dt);
        let mut sure = true;
        for (row, b) in form.rows() {
            let (mut above, mut below) = (true, false);
            for (x, b2) in row.iter().zip(inverses.iter()) {
                let p = x * (b * b2);
                above &= p > rad && p < f64::INFINITY;
                below |= p <= -rad;
            }
            if below {
                return Some(false);
            }
            sure &= above;
        }
        sure.then_some(true)
    }

    fn ones(ds: usize, dt: usize) -> Form<Self> {
        let (bs, bt) = (binomials(ds), binomials(dt));
        let c = bs.iter().flat_map(|a| bt.iter().map(move |b| a * b)).collect();
        let rad = (UNIT + binomial_error(ds) + binomial_error(dt)) * SLACK + TINY;
        Form { ds, dt, exp: 0, c, norm: Ball { mag: 1.0, rad } }
    }

    fn dot(a: &Vec3<Self>, b: &Vec3<Self>) -> Form<Self> {
        let alike = |v: &Vec3<Self>| v[1..].iter().all(|f| (f.ds, f.dt, f.exp) == (v[0].ds, v[0].dt, v[0].exp));
        if !(alike(a) && alike(b)) {
            return a[0].mul(&b[0]).add(&a[1].mul(&b[1])).add(&a[2].mul(&b[2]));
        }
        let (ds, dt) = (a[0].ds + b[0].ds, a[0].dt + b[0].dt);
        let mut c = vec![0.0; (ds + 1) * (dt + 1)];
        a[0].add_product(&b[0], &mut c);
        let mut norm = Self::norm_mul(&a[0], &b[0], a[0].terms(&b[0]));
        let mut product = vec![0.0; c.len()];
        for (a, b) in a.iter().zip(b).skip(1) {
            product.fill(0.0);
            a.add_product(b, &mut product);
            c.iter_mut().zip(&product).for_each(|(c, p)| *c += p);
            let of_one = Self::norm_mul(a, b, a.terms(b));
            norm = Ball { mag: norm.mag + of_one.mag, rad: norm.rad + of_one.rad };
        }
        let norm = Ball { mag: norm.mag * SLACK, rad: norm.rad * SLACK };
        let mut form = Form { ds, dt, exp: a[0].exp + b[0].exp, c, norm };
        Self::settle(&mut form);
        form
    }
}
