//! The curvature term: 1/kappa > r on the whole spine, by positive Bernstein coefficients of |a|^6 - r^2 |b|^2 w^6 on the
//! cells of a dyadic partition (theory.md, section 3). No root is isolated, so circles and clusters are no special case.

use super::dyadic::{Dyadic, dot3, ratio};
use super::frame::Frame;
use super::meter::Meter;
use super::witness::Exact;
use crate::bernstein::{Form, Scalar, UNIT, Vec3, binomial_error, binomials, dot};
use crate::enclosure::Interval;
use crate::integer::{Int, ldexp};
use crate::parallel;
use crate::spine::Bezier;

/// Cells deeper than this are given up.
const MAX_DEPTH: u32 = 400;
/// In the unit box: a smaller radius may never be told from 0, and only so many cells are spent on it, for the spine and
/// for each span.
const HOPELESS: f64 = 1e-12;
const PATIENCE: usize = 2_000;
const PATIENCE_PER_SPAN: usize = 64;

/// A place of high curvature: 1/kappa there, numerically.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Peak {
    pub(crate) segment: usize,
    pub(crate) t: f64,
    pub(crate) radius: f64,
}

/// Bernstein coefficients of a, b and w on a cell, in f64: value = 2^exp (c +- rad).
#[derive(Clone)]
pub(super) struct Strips {
    pub(super) a: Strip<3>,
    pub(super) b: Strip<3>,
    pub(super) w: Strip<1>,
}

#[derive(Clone)]
pub(super) struct Strip<const N: usize> {
    c: Vec<[f64; N]>,
    rad: f64,
    pub(super) exp: i64,
}

impl<const N: usize> Strip<N> {
    fn new(forms: [&Form<Int>; N]) -> Self {
        let degree = forms[0].ds;
        let drop = forms.iter().flat_map(|f| &f.c).map(|x| x.bits() as i64).max().unwrap_or(0);
        let binomials = binomials(degree);
        let c: Vec<[f64; N]> =
            (0..=degree).map(|i| forms.map(|f| f.c[i].to_f64_shifted(drop) / binomials[i])).collect();
        let rad = (2.5 * UNIT + binomial_error(degree)) * max_abs(&c) + 1e-290;
        Self { c, rad, exp: drop + forms[0].exp }
    }

    /// The parts before and after t.
    fn cut(&self, t: f64) -> (Self, Self) {
        let n = self.c.len() - 1;
        let (mut left, mut row) = (self.c.clone(), self.c.clone());
        let rest = 1.0 - t;
        for (level, first) in left.iter_mut().enumerate().skip(1) {
            for i in 0..=n - level {
                row[i] = std::array::from_fn(|k| rest * row[i][k] + t * row[i + 1][k]);
            }
            *first = row[0];
        }
        // halving rounds sums alone
        let roundings = (n + 1) as f64 * if t == 0.5 { 1.0 } else { 16.0 };
        let rad = (self.rad + roundings * UNIT * max_abs(&self.c)) * (1.0 + 1e-9) + 1e-290;
        (Self { c: left, rad, exp: self.exp }, Self { c: row, rad, exp: self.exp })
    }

    fn forms(&self) -> [Form<f64>; N] {
        std::array::from_fn(|k| Form::from_strip(self.c.iter().map(|v| v[k]), self.rad, self.exp))
    }

    /// Value at t, numerically, without 2^exp.
    fn at(&self, t: f64) -> [f64; N] {
        at(&self.c, t)
    }

    /// The derivative over the value, of which |.|^2 has half: (v.v') / (v.v), numerically.
    fn growth(&self, t: f64) -> f64 {
        let rises = self.c.windows(2).map(|c| std::array::from_fn(|k| (self.c.len() - 1) as f64 * (c[1][k] - c[0][k])));
        let (value, slope) = (self.at(t), at(rises.collect::<Vec<[f64; N]>>().as_slice(), t));
        let dot = |v: &[f64; N]| v.iter().zip(&value).map(|(x, y)| x * y).sum::<f64>();
        dot(&slope) / dot(&value)
    }

    /// Holds the values, without 2^exp, from middle - half to middle + half, and the control points of the arc there.
    ///
    /// A control point is a blossom whose n arguments are `half` or less from the middle. By its multiaffine expansion it is
    /// off from the value there by at most half |derivative| + sum of C(n,k) half^k |differences of order k|, k >= 2,
    /// and those differences are at most 2^k times the largest coefficient.
    pub(super) fn ball(&self, middle: f64, half: f64) -> [Interval; N] {
        let (n, size) = (self.c.len() - 1, max_abs(&self.c) + self.rad);
        let mut row = self.c.clone();
        for m in (1..n).rev() {
            for i in 0..=m {
                row[i] = std::array::from_fn(|k| row[i][k] + middle * (row[i + 1][k] - row[i][k]));
            }
        }
        let next = row[n.min(1)];
        let step = 2.0 * n as f64 * half;
        if step.is_nan() || step > 0.5 {
            return [Interval::new(f64::NEG_INFINITY, f64::INFINITY); N];
        }
        // the sum is at most exp(step) - 1 - step
        let bent = step * step * size;
        let rounded = 5.0 * (n + 1) as f64 * UNIT * size + self.rad;
        std::array::from_fn(|k| {
            let slope = next[k] - row[0][k];
            let value = row[0][k] + middle * slope;
            let off = (n as f64 * half * (slope.abs() + 2.0 * rounded) + bent + rounded) * (1.0 + 1e-9);
            Interval::new((value - off).next_down(), (value + off).next_up())
        })
    }

    /// Holds the control points, without 2^exp.
    pub(super) fn hull(&self) -> [Interval; N] {
        let bound = |k: usize, pick: fn(f64, f64) -> f64| self.c.iter().map(|c| c[k]).fold(self.c[0][k], pick);
        std::array::from_fn(|k| {
            Interval::new((bound(k, f64::min) - self.rad).next_down(), (bound(k, f64::max) + self.rad).next_up())
        })
    }

    /// Are the lengths of all vectors alike, numerically?
    fn is_steady(&self) -> bool {
        let lengths = || self.c.iter().map(length);
        lengths().fold(0.0, f64::max) < 1.25 * lengths().fold(f64::INFINITY, f64::min)
    }

    fn longest(&self) -> f64 {
        self.c.iter().map(length).fold(0.0, f64::max) * (1.0 + 8.0 * UNIT) + 2.0 * self.rad
    }
}

/// The value at t of the polynomial with these Bernstein coefficients, numerically; 0 if there are none.
fn at<const N: usize>(c: &[[f64; N]], t: f64) -> [f64; N] {
    let Some((last, c)) = c.split_last() else { return [0.0; N] };
    let (mut sum, mut power) = ([0.0; N], 1.0);
    for (c, binomial) in c.iter().zip(binomials(c.len()).iter()) {
        sum = std::array::from_fn(|k| (sum[k] + binomial * power * c[k]) * (1.0 - t));
        power *= t;
    }
    std::array::from_fn(|k| sum[k] + power * last[k])
}

fn max_abs<const N: usize>(c: &[[f64; N]]) -> f64 {
    c.iter().flatten().fold(0.0f64, |m, x| m.max(x.abs()))
}

fn length<const N: usize>(v: &[f64; N]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

impl Strips {
    pub(super) fn new(bezier: &Bezier) -> Self {
        let (forms, b) = (bezier.forms(), bezier.binormal());
        Self::of(&forms.a, &b, &forms.w)
    }

    pub(super) fn of(a: &Vec3<Int>, b: &Vec3<Int>, w: &Form<Int>) -> Self {
        Self { a: Strip::new(a.each_ref()), b: Strip::new(b.each_ref()), w: Strip::new([w]) }
    }

    /// The parts before and after t.
    pub(super) fn cut(&self, t: f64) -> (Self, Self) {
        let ((a0, a1), (b0, b1), (w0, w1)) = (self.a.cut(t), self.b.cut(t), self.w.cut(t));
        (Self { a: a0, b: b0, w: w0 }, Self { a: a1, b: b1, w: w1 })
    }

    /// Starts again from the exact cell where rounding has eaten the hodograph.
    pub(super) fn freshen(&mut self, depth: u32, arc: impl FnOnce() -> Bezier) {
        let shortest = self.a.c.iter().map(length).fold(f64::INFINITY, f64::min);
        if depth > 0 && depth.is_multiple_of(4) && shortest < 1e6 * self.a.rad {
            *self = Self::new(&arc());
        }
    }

    /// The rule `curved` of docs/certificate-format.md: w > 0, a != 0 and, for r > 0, 1/kappa > r.
    pub(super) fn curved(&self, bezier: &Bezier, depth: u32, index: &Int, r: f64) -> bool {
        fn rule<T: Scalar>(a: &Vec3<T>, b: &Vec3<T>, w: &Form<T>, r: f64) -> Option<bool> {
            let above = || if r > 0.0 { form(a, b, w, r).positive() } else { dot(a, a).positive() };
            match w.positive() {
                Some(true) => above(),
                other => other,
            }
        }
        let [w] = self.w.forms();
        rule(&self.a.forms(), &self.b.forms(), &w, r).unwrap_or_else(|| {
            let arc = bezier.cell(index, depth);
            let (forms, b) = (arc.forms(), arc.binormal());
            rule(&forms.a, &b, &forms.w, r) == Some(true)
        })
    }

    /// 1/kappa = |a|^3 / (|b| w^3) from three lengths.
    fn radius(&self, a: f64, b: f64, w: f64) -> f64 {
        let x = a / w; // first: the cubes of either may leave the range of f64
        ldexp(x * x * x / b, 3 * self.a.exp - self.b.exp - 3 * self.w.exp)
    }

    fn radius_at(&self, t: f64) -> f64 {
        self.radius(length(&self.a.at(t)), length(&self.b.at(t)), self.w.at(t)[0])
    }

    /// The place near t where the derivative of 1/kappa = |a|^3 / (|b| w^3) vanishes, if it does within `h`: values alone
    /// place it to half the digits only.
    fn peak(&self, t: f64, h: f64) -> f64 {
        let slope = |t: f64| 3.0 * self.a.growth(t) - self.b.growth(t) - 3.0 * self.w.growth(t);
        let (mut lo, mut hi) = (t - h, t + h);
        let (mut below, mut above) = (slope(lo), slope(hi));
        if !(lo > 0.0 && hi < 1.0 && below < 0.0 && above > 0.0) {
            return t;
        }
        // the secant, with half the weight of an end that stays
        for _ in 0..12 {
            let middle = lo + (hi - lo) * below / (below - above);
            let here = slope(middle);
            if !here.is_finite() {
                return t;
            }
            if here == 0.0 || !(lo < middle && middle < hi) {
                return middle.clamp(lo, hi);
            }
            if here < 0.0 {
                (lo, below, above) = (middle, here, 0.5 * above);
            } else {
                (hi, above, below) = (middle, here, 0.5 * below);
            }
        }
        0.5 * (lo + hi)
    }

    /// A crude lower bound for 1/kappa on the cell: shortest a along its mean, longest b, largest w.
    pub(super) fn floor(&self) -> f64 {
        let mean: [f64; 3] = std::array::from_fn(|k| self.a.c.iter().map(|v| v[k]).sum());
        let size = length(&mean);
        // not for a mean that rounding has eaten (a closed control polygon: its differences sum to 0)
        if size.is_nan() || size <= 1e-6 * max_abs(&self.a.c) {
            return 0.0;
        }
        let along = |v: &[f64; 3]| (0..3).map(|k| v[k] * mean[k]).sum::<f64>() / size;
        let shortest = self.a.c.iter().map(along).fold(f64::INFINITY, f64::min);
        let shortest = shortest - 2.0 * self.a.rad - 16.0 * UNIT * max_abs(&self.a.c);
        if shortest > 0.0 {
            self.radius(shortest, self.b.longest(), self.w.longest()) * (1.0 - 64.0 * UNIT)
        } else {
            0.0
        }
    }
}

/// |a|^6 - r^2 |b|^2 w^6.
fn form<T: Scalar>(a: &Vec3<T>, b: &Vec3<T>, w: &Form<T>, r: f64) -> Form<T> {
    let a2 = dot(a, a);
    let w3 = w.sqr().mul(w).scale(r);
    a2.sqr().mul(&a2).sub(&dot(b, b).mul(&w3.sqr()))
}

/// Is every segment straight (b = 0 identically)?
pub(crate) fn straight(frame: &Frame) -> bool {
    frame.segments.iter().all(|s| s.binormal().iter().all(Form::is_zero))
}

/// Proves 1/kappa > radius everywhere, for a radius just below (by `margin`) the least 1/kappa; returns that radius
/// and the place.
pub(crate) fn curvature(exact: &mut Exact, margin: f64, meter: &mut Meter) -> (f64, Option<Peak>) {
    let frame = exact.frame;
    let spans = parallel::map(&frame.segments, Strips::new);
    let mut search = Search { frame, spans: &spans, margin, radius: f64::MAX, peak: None, exact };
    for segment in 0..spans.len() {
        search.sample(segment);
    }
    let mut patience = PATIENCE + PATIENCE_PER_SPAN * spans.len();
    for (segment, span) in spans.iter().enumerate() {
        let bezier = &frame.segments[segment];
        let mut open = vec![Cell { strips: span.clone(), from: Dyadic::ZERO, to: Dyadic::ONE, depth: 0 }];
        while let Some(mut cell) = open.pop() {
            cell.strips.freshen(cell.depth, || bezier.arc(&cell.from, &cell.to));
            if search.closed(segment, &cell) {
                continue;
            }
            patience -= usize::from(search.radius < HOPELESS && patience > 0);
            if !meter.tick() || cell.depth >= MAX_DEPTH || patience == 0 {
                search.radius = search.radius.min(cell.strips.floor());
                continue;
            }
            open.extend(cell.cut(search.peak.filter(|peak| peak.segment == segment)));
        }
    }
    (search.radius, search.peak)
}

/// An arc of one span.
struct Cell {
    strips: Strips,
    from: Dyadic,
    to: Dyadic,
    depth: u32,
}

impl Cell {
    /// Both parts, the first on top of a stack. A cell is cut at the peak that it holds: on either side of it the form
    /// grows, so its coefficients are positive long before those of a cell round the peak are.
    fn cut(&self, peak: Option<Peak>) -> [Self; 2] {
        let at_peak = peak.map(|peak| Dyadic::from_f64(peak.t)).filter(|t| self.holds(t));
        let at = at_peak.unwrap_or_else(|| Dyadic { e: -1, ..Dyadic::ONE }.mul(&self.from.add(&self.to)));
        let share = ratio(&at.sub(&self.from), &self.to.sub(&self.from));
        let (before, after) = self.strips.cut(share);
        let depth = self.depth + 1;
        [
            Self { strips: after, from: at.clone(), to: self.to.clone(), depth },
            Self { strips: before, from: self.from.clone(), to: at, depth },
        ]
    }

    /// Is t in the interior?
    fn holds(&self, t: &Dyadic) -> bool {
        self.from.cmp(t).is_lt() && t.cmp(&self.to).is_lt()
    }
}

/// kappa^2 at t as |b|^2 w^6 over |a|^6, exactly.
pub(super) fn kappa_sq(a: &Vec3<Int>, b: &Vec3<Int>, w: &Form<Int>, t: &Dyadic) -> [Dyadic; 2] {
    let square = |v: &Vec3<Int>| {
        let v = v.each_ref().map(|f| f.at(t));
        dot3(&v, &v)
    };
    let (a, w) = (square(a), w.at(t));
    [square(b).mul(&w.sqr().mul(&w).sqr()), a.sqr().mul(&a)]
}

impl Exact<'_> {
    /// 1/kappa from exact values, numerically.
    fn radius(&mut self, segment: usize, t: &Dyadic) -> f64 {
        let (forms, b) = self.span(segment);
        let [num, den] = kappa_sq(&forms.a, b, &forms.w, t);
        ratio(&den, &num).sqrt()
    }
}

struct Search<'a, 'f> {
    frame: &'f Frame,
    spans: &'a [Strips],
    margin: f64,
    radius: f64,
    peak: Option<Peak>,
    exact: &'a mut Exact<'f>,
}

impl Search<'_, '_> {
    /// Looks at a few points of a span, and climbs from the best.
    fn sample(&mut self, segment: usize) {
        let steps = 4 * self.frame.segments[segment].degree();
        let strips = &self.spans[segment];
        let h = 1.0 / steps as f64;
        let samples: Vec<f64> = (0..=steps).map(|i| strips.radius_at(i as f64 * h)).collect();
        let least = samples.iter().copied().fold(f64::INFINITY, f64::min);
        // of symmetric curves, whose samples tie but for rounding, the first
        if let Some(best) = samples.iter().position(|x| *x < self.radius && *x <= least * (1.0 + 1e-12)) {
            self.climb(segment, best as f64 * h, h);
        }
    }

    /// Golden section for the least 1/kappa near t.
    fn climb(&mut self, segment: usize, t: f64, h: f64) {
        let strips = &self.spans[segment];
        let (t, least) = golden(|t| strips.radius_at(t), t, h);
        let mut t = strips.peak(t, 1e-6 * h);
        let mut radius = strips.radius_at(t).min(least);
        if length(&strips.a.at(t)) < 1e10 * strips.a.rad || length(&strips.b.at(t)) < 1e10 * strips.b.rad {
            // small against their rounding here
            let exact = golden(|t| self.exact.radius(segment, &Dyadic::from_f64(t)), t, h);
            if exact.1.is_finite() {
                (t, radius) = exact;
            }
        }
        if radius * (1.0 - self.margin) < self.radius && radius > 0.0 {
            self.radius = radius * (1.0 - self.margin);
            self.peak = Some(Peak { segment, t, radius });
        }
    }

    fn closed(&mut self, segment: usize, cell: &Cell) -> bool {
        let strips = &cell.strips;
        if strips.floor() > self.radius {
            return true;
        }
        let h = cell.to.sub(&cell.from).to_f64();
        for (end, place) in [(0, &cell.from), (strips.a.c.len() - 1, &cell.to)] {
            let last = |n: usize| if end == 0 { 0 } else { n - 1 };
            let (a, b, w) = (&strips.a.c, &strips.b.c, &strips.w.c);
            let here = strips.radius(length(&a[last(a.len())]), length(&b[last(b.len())]), w[last(w.len())][0]);
            if here < self.radius {
                // places of f64 may all be beside the peak; and rounding may have eaten the value here
                let exact = self.exact.radius(segment, place);
                if exact < self.radius || length(&a[last(a.len())]) > 1e6 * strips.a.rad {
                    self.climb(segment, place.to_f64(), h);
                }
                if exact > f64::MIN_POSITIVE {
                    self.radius = self.radius.min(exact * (1.0 - self.margin));
                }
            }
        }
        let [w] = strips.w.forms();
        match form(&strips.a.forms(), &strips.b.forms(), &w, self.radius).positive() {
            Some(closed) => closed,
            // halves that move at a steadier speed are easier to tell
            None => strips.a.is_steady() && self.closed_exactly(segment, cell),
        }
    }

    /// The same from the exact arc: intervals, then integers.
    fn closed_exactly(&self, segment: usize, cell: &Cell) -> bool {
        let arc = self.frame.segments[segment].arc(&cell.from, &cell.to);
        let (forms, b) = (arc.forms(), arc.binormal());
        let near = forms.cast::<Interval>();
        let b_near = b.each_ref().map(Interval::cast);
        match form(&near.a, &b_near, &near.w, self.radius).positive() {
            Some(closed) => closed,
            None => form(&forms.a, &b, &forms.w, self.radius).positive() == Some(true),
        }
    }
}

/// The least value of f near t (within h, inside [0, 1]) by golden section, ends included.
pub(crate) fn golden(mut f: impl FnMut(f64) -> f64, t: f64, h: f64) -> (f64, f64) {
    const SHARE: f64 = 0.618_033_988_749_894_9;
    let (mut lo, mut hi) = ((t - h).max(0.0), (t + h).min(1.0));
    let mut best = [lo, t, hi].map(|x| (x, f(x))).into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((t, f(t)));
    let (mut x, mut y) = (hi - SHARE * (hi - lo), lo + SHARE * (hi - lo));
    let (mut fx, mut fy) = (f(x), f(y));
    for _ in 0..44 {
        if fx <= fy {
            (hi, y, fy) = (y, x, fx);
            x = hi - SHARE * (hi - lo);
            fx = f(x);
        } else {
            (lo, x, fx) = (x, y, fy);
            y = lo + SHARE * (hi - lo);
            fy = f(y);
        }
        for point in [(x, fx), (y, fy)] {
            if point.1 < best.1 {
                best = point;
            }
        }
    }
    best
}
