//! The zeros of the critical polynomial of curvature on one segment (theory.md, sections 1 and 3).
//!
//! What is held is 2 N = (|b|^2)' w |a|^2 + 6 w' |b|^2 |a|^2 - 3 |b|^2 w (|a|^2)', for a constant weight without the factor
//! w: the derivative of kappa^2 up to a positive factor. Three tiers find its zeros, from fast to sure:
//! - Bernstein coefficients in f64 with one error radius: none or exactly one change of sign decides a cell, others are
//!   split at a point where the sign is certain; so zeros at 1/2 are no special case;
//! - the same, after the zeros at 0 and 1 have been divided out in integers, with cells made anew from the exact
//!   polynomial where f64 cannot tell;
//! - square-free factors, where that cannot tell either: multiple zeros, and simple ones closer than about 2^-50.

use super::dyadic::{Dyadic, step};
use super::meter::Meter;
use crate::bernstein::{Form, Scalar, UNIT, Vec3, dot};
use crate::integer::Int;
use crate::roots::roots_inside;
use crate::spine::Bezier;
use std::cmp::Ordering;

/// Positions in a cell are whole multiples of 2^-48, exact in f64.
const BITS: i64 = 48;
/// Where a cell is split, in sixteenths: the first place with a certain sign.
const PLACES: [i64; 7] = [8, 7, 9, 5, 11, 3, 13];
/// So often a cell is made anew from the exact polynomial inside one that was; each time it can be 2^-20 as wide.
const LEVELS: u32 = 4;
/// Where N is at hand in integers, a simple zero is sought to this share of the segment.
const FINEST: f64 = 1.0 / (1_u64 << 56) as f64;
/// Square-free factors of polynomials of a higher degree take too long: their multiple zeros stay undecided.
const MAX_FACTORED: usize = 160;

/// Hodograph a, b and denominator w of an arc, exactly: kappa = |b| w^3 / |a|^3.
pub(crate) struct Bend {
    pub(crate) a: Vec3<Int>,
    pub(crate) b: Vec3<Int>,
    pub(crate) w: Form<Int>,
}

/// Twice N, or twice N / w for a constant weight.
fn critical<T: Scalar>(a: &Vec3<T>, b: &Vec3<T>, w: &Form<T>, slope: fn(&Form<T>) -> Form<T>) -> Form<T> {
    let (aa, bb) = (dot(a, a), dot(b, b));
    let mut form = bb.mul(&slope(&aa)).scale(-3.0);
    if bb.c.len() > 1 {
        form = form.add(&slope(&bb).mul(&aa));
    }
    if w.c.len() == 1 {
        return form;
    }
    form.mul(w).add(&slope(w).mul(&aa.mul(&bb)).scale(6.0))
}

impl Bend {
    pub(crate) fn new(bezier: &Bezier) -> Self {
        let forms = bezier.forms();
        Self { a: forms.a, b: bezier.binormal(), w: forms.w }
    }

    pub(crate) fn is_straight(&self) -> bool {
        self.b.iter().all(Form::is_zero)
    }

    /// In f64, in the second variable: products then run along rows.
    pub(crate) fn near(&self) -> Near {
        let cast = |form: &Form<Int>| f64::cast(form).transposed();
        Near::new(&critical(
            &self.a.each_ref().map(cast),
            &self.b.each_ref().map(cast),
            &cast(&self.w),
            Form::<f64>::derivative,
        ))
    }

    pub(crate) fn critical(&self) -> Form<Int> {
        critical(&self.a, &self.b, &self.w, Form::<Int>::derivative)
    }
}

/// A zero of N inside a segment, or a part of it of which nothing is known.
#[derive(Debug, Clone)]
pub(crate) struct Zero {
    /// It lies from `lo` to `hi`, in the parameter of the segment; if these differ N is 0 at neither.
    pub(crate) lo: Dyadic,
    pub(crate) hi: Dyadic,
    /// The sign of N before and after.
    pub(crate) before: Ordering,
    pub(crate) after: Ordering,
    pub(crate) simple: bool,
    /// Is it one zero, whatever its multiplicity?
    pub(crate) known: bool,
}

/// N at an end of a segment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct End {
    /// The sign inside, next to the end.
    pub(crate) sign: Ordering,
    /// How often N is 0 at the end itself.
    pub(crate) multiplicity: usize,
}

/// How N behaves on a segment.
pub(crate) enum Course {
    /// N is 0: the curvature is constant.
    Constant,
    Varying {
        ends: [End; 2],
        zeros: Vec<Zero>,
    },
}

/// All zeros of N, those inside to `width` of the segment if f64 and the meter allow.
pub(crate) fn course(bend: &Bend, width: f64, meter: &mut Meter) -> Course {
    if bend.is_straight() {
        return Course::Constant;
    }
    let whole = (Dyadic::ZERO, Dyadic::ONE);
    let near = bend.near();
    let [first, last] = near.ends();
    if first.is_ne() && last.is_ne() {
        let mut search = Search { exact: None, width, meter, zeros: vec![], unclear: false };
        if search.isolate(near, &whole, 0).is_ok() {
            let ends = [first, last].map(|sign| End { sign, multiplicity: 0 });
            return Course::Varying { ends, zeros: search.zeros };
        }
    }
    let mut exact = bend.critical();
    if exact.is_zero() {
        return Course::Constant;
    }
    // of the sum of c[i] t^i (1-t)^(n-i) the factors t and 1 - t
    let zeros = |c: &Form<Int>| c.c.iter().take_while(|c| c.is_zero()).count();
    let at_start = zeros(&exact);
    exact.c.drain(..at_start);
    exact.c.reverse();
    let at_end = zeros(&exact);
    exact.c.drain(..at_end);
    exact.c.reverse();
    exact.ds = exact.c.len() - 1;
    let ends = [(0, at_start), (exact.ds, at_end)];
    let ends = ends.map(|(k, multiplicity)| End { sign: exact.c[k].sign(), multiplicity });
    let mut search = Search { exact: Some(&exact), width, meter, zeros: vec![], unclear: false };
    // with the exact polynomial at hand nothing is refused
    let _ = search.isolate(Near::new(&f64::cast(&exact)), &whole, 0);
    let (mut zeros, unclear) = (search.zeros, search.unclear);
    if unclear && meter.stopped.is_none() && exact.ds <= MAX_FACTORED {
        zeros = factored(&exact, width);
    }
    Course::Varying { ends, zeros }
}

/// The zeros by square-free factors.
fn factored(exact: &Form<Int>, width: f64) -> Vec<Zero> {
    let mut sign = exact.c[0].sign();
    let width = Dyadic::from_f64(width).rational();
    let zero = |mut root: crate::roots::RealRoot| {
        root.refine(&width);
        let ([lo, hi], depth) = root.ends();
        let [lo, hi] = [lo, hi].map(|m| Dyadic { m: Int::from(m), e: -(depth as i64) });
        let before = sign;
        if root.multiplicity() % 2 == 1 {
            sign = sign.reverse();
        }
        Zero { lo, hi, before, after: sign, simple: root.multiplicity() == 1, known: true }
    };
    roots_inside(&exact.bernstein()).into_iter().map(zero).collect()
}

/// The form on the part from `from` to `to`, times a power of 2.
pub(crate) fn part(form: &Form<Int>, from: &Dyadic, to: &Dyadic) -> Form<Int> {
    let (from, to) = (from.sub(&Dyadic::ZERO), to.sub(&Dyadic::ZERO));
    let (a, b, e) = Dyadic::aligned(&from, &to);
    let one = &Int::ONE << (-e) as u64;
    let (rest_a, rest_b) = (&one - &a, &one - &b);
    // Horner in t and 1 - t, both linear in the new parameter
    let product = |p: &[Int], from: &Int, to: &Int| -> Vec<Int> {
        let at = |k: usize| {
            &(if k < p.len() { &p[k] * from } else { Int::ZERO }) + &(if k > 0 { &p[k - 1] * to } else { Int::ZERO })
        };
        (0..=p.len()).map(at).collect()
    };
    let (mut value, mut power) = (vec![], vec![Int::ONE]);
    for c in form.c.iter().rev() {
        let times_t = product(&value, &a, &b);
        value = power.iter().enumerate().map(|(k, p)| &(p * c) + times_t.get(k).unwrap_or(&Int::ZERO)).collect();
        power = product(&power, &rest_a, &rest_b);
    }
    Form { c: value, ..*form }
}

/// Bernstein coefficients on a cell, each off by at most `rad`.
pub(crate) struct Near {
    c: Vec<f64>,
    rad: f64,
    /// The greatest |coefficient|.
    size: f64,
}

impl Near {
    fn new(form: &Form<f64>) -> Self {
        let (c, rad) = form.strip();
        Self::of(c, rad)
    }

    fn of(c: Vec<f64>, rad: f64) -> Self {
        let size = c.iter().fold(0.0, |size: f64, c| size.max(c.abs()));
        Self { c, rad, size }
    }

    /// The certain sign of a number that is off by at most `rad`; `Equal` if there is none, NaN included.
    fn sign(c: f64, rad: f64) -> Ordering {
        if c > rad {
            Ordering::Greater
        } else if c < -rad {
            Ordering::Less
        } else {
            Ordering::Equal
        }
    }

    fn ends(&self) -> [Ordering; 2] {
        [self.c[0], self.c[self.c.len() - 1]].map(|c| Self::sign(c, self.rad))
    }

    /// How many zeros the cell has: 0 or 1, or `None` if the changes of sign do not tell. One uncertain sign between
    /// two that differ makes one change whatever it is.
    fn count(&self) -> Option<usize> {
        let [first, last] = self.ends();
        if first.is_eq() || last.is_eq() {
            return None;
        }
        let differs = |sign| move |c: &f64| Self::sign(*c, self.rad) != sign;
        if first == last {
            return (!self.c.iter().any(differs(first))).then_some(0);
        }
        let (i, j) = (self.c.iter().position(differs(first))?, self.c.iter().rposition(differs(last))?);
        (j <= i).then_some(1)
    }

    /// What one de Casteljau step after another adds to the error: each makes (1 - x) p + x q from 1 - x rounded, with
    /// two products and a sum.
    fn rounded(&self) -> f64 {
        (self.rad + 4.0 * self.c.len() as f64 * UNIT * self.size) * (1.0 + 1e-9)
    }

    /// Both parts, with x in [0, 1] between them.
    fn split(&self, x: f64) -> [Self; 2] {
        let n = self.c.len() - 1;
        let (y, rad) = (1.0 - x, self.rounded());
        let (mut left, mut right) = (self.c.clone(), self.c.clone());
        for (level, first) in left.iter_mut().enumerate().skip(1) {
            for i in 0..=n - level {
                right[i] = y * right[i] + x * right[i + 1];
            }
            *first = right[0];
        }
        [Self::of(left, rad), Self::of(right, rad)]
    }

    /// Value and derivative at x in [0, 1]; the value is off by at most `rounded`.
    fn at(&self, x: f64, row: &mut Vec<f64>) -> [f64; 2] {
        let (n, y) = (self.c.len() - 1, 1.0 - x);
        row.clone_from(&self.c);
        for level in 1..n {
            for i in 0..=n - level {
                row[i] = y * row[i] + x * row[i + 1];
            }
        }
        if n == 0 { [row[0], 0.0] } else { [y * row[0] + x * row[1], n as f64 * (row[1] - row[0])] }
    }

    /// About where the function, with one change of sign, is 0: Newton's method between safe ends.
    fn root(&self, rises: bool, row: &mut Vec<f64>) -> f64 {
        let (mut lo, mut hi, mut x) = (0.0, 1.0, 0.5);
        // far below what is uncertain, far above what jitters
        let noise = 0.1 * self.rounded();
        for _ in 0..100 {
            let [value, slope] = self.at(x, row);
            if (value < 0.0) == rises {
                lo = x;
            } else {
                hi = x;
            }
            let next = x - value / slope;
            let next = if next > lo && next < hi { next } else { 0.5 * (lo + hi) };
            if value.abs() <= noise || (next - x).abs() < 2.0 * UNIT {
                break;
            }
            x = next;
        }
        x
    }

    /// A short interval about x with these certain signs at its ends, which those of the cell are known to have.
    fn bracket(&self, x: f64, [first, last]: [Ordering; 2], row: &mut Vec<f64>) -> [f64; 2] {
        let [_, slope] = self.at(x, row);
        let error = self.rounded();
        let least = (1.9 * error / slope.abs()).max(8.0 * UNIT);
        let mut side = |sign: Ordering, toward: f64| {
            let mut step = least;
            while step < 1.0 {
                let p = (x + toward * step).clamp(0.0, 1.0);
                if Self::sign(self.at(p, row)[0], error) == sign {
                    return p;
                }
                step *= 4.0;
            }
            0.5 + 0.5 * toward
        };
        [side(first, -1.0), side(last, 1.0)]
    }
}

/// f64 cannot tell, and there is no exact polynomial yet.
struct Unclear;

struct Search<'a> {
    exact: Option<&'a Form<Int>>,
    width: f64,
    meter: &'a mut Meter,
    zeros: Vec<Zero>,
    /// Was a cell left undecided, though not by the meter?
    unclear: bool,
}

impl Search<'_> {
    /// The zeros on a part of the segment, in increasing order. N is not 0 at its ends, nor at those of any cell.
    fn isolate(&mut self, near: Near, part: &(Dyadic, Dyadic), level: u32) -> Result<(), Unclear> {
        let mut row = vec![];
        let mut open = vec![(near, 0, 1_i64 << BITS)];
        while let Some((near, from, to)) = open.pop() {
            let place = || (inside(part, from), inside(part, to));
            if !self.meter.tick() {
                self.give_up(&near, place());
                continue;
            }
            match near.count() {
                Some(0) => continue,
                Some(_) => {
                    let zero = self.narrowed(near, place(), &mut row)?;
                    self.zeros.push(zero);
                    continue;
                }
                None => {}
            }
            let halves = PLACES.iter().filter(|_| (to - from) % 16 == 0).find_map(|k| {
                let [left, right] = near.split(*k as f64 / 16.0);
                right.ends()[0].is_ne().then(|| (left, right, from + (to - from) / 16 * k))
            });
            match (halves, self.exact) {
                (Some((left, right, middle)), _) => {
                    open.push((right, middle, to));
                    open.push((left, from, middle));
                }
                (None, None) => return Err(Unclear),
                (None, Some(exact)) if level < LEVELS => {
                    let place = place();
                    self.isolate(anew(exact, &place), &place, level + 1)?;
                }
                (None, Some(_)) => {
                    self.unclear = true;
                    self.give_up(&near, place());
                }
            }
        }
        Ok(())
    }

    fn give_up(&mut self, near: &Near, (lo, hi): (Dyadic, Dyadic)) {
        let [before, after] = near.ends();
        self.zeros.push(Zero { lo, hi, before, after, simple: false, known: false });
    }

    /// The zero of a cell that has exactly one, a simple one.
    fn narrowed(&mut self, near: Near, cell: (Dyadic, Dyadic), row: &mut Vec<f64>) -> Result<Zero, Unclear> {
        let [before, after] = near.ends();
        let (mut near, mut place) = (near, cell);
        for _ in 0..LEVELS {
            let x = near.root(before.is_lt(), row);
            let [p, q] = near.bracket(x, [before, after], row);
            place = (between(&place, p), between(&place, q));
            let wanted = if self.exact.is_some() { self.width.min(FINEST) } else { 0.4 * self.width };
            if length(&place) <= wanted {
                break;
            }
            near = anew(self.exact.ok_or(Unclear)?, &place);
        }
        let (lo, hi) = place;
        Ok(Zero { lo, hi, before, after, simple: true, known: true })
    }
}

/// The polynomial on a part, from exact coefficients: f64 then resolves what is small there.
fn anew(exact: &Form<Int>, (from, to): &(Dyadic, Dyadic)) -> Near {
    Near::new(&f64::cast(&part(exact, from, to)))
}

/// The place at this share of a part, exactly.
fn between((from, to): &(Dyadic, Dyadic), share: f64) -> Dyadic {
    from.add(&to.sub(from).mul(&Dyadic::from_f64(share)))
}

fn inside(part: &(Dyadic, Dyadic), position: i64) -> Dyadic {
    part.0.add(&part.1.sub(&part.0).mul(&Dyadic::from(position).mul(&step(BITS))))
}

fn length((from, to): &(Dyadic, Dyadic)) -> f64 {
    to.sub(from).to_f64()
}
