//! How much the u-lines of a decomposition turn about the spine: the twist of theory.md, section 6, enclosed.
//!
//! With a = (c, z), f = |a|^2, s = |z| / sqrt f, Q = Im(conj(c) c') / f, K = |a x a'|^2 / f^2 and theta' = Im(conj(A) A') / f the
//! mean over phi of ((N x N').T)^2 is (docs/claims.md, P)
//!   (theta' - Q)^2 / s + K / (s (1 + s)) - Q^2 (1 + s + s^2) / (s (1 + s)^2).
//! For A = prod (t - z) over the roots z, theta' is a sum of y / ((t - x)^2 + y^2) with whole factors: the integral is a quadratic
//! form in them. Its coefficients are enclosed once, for all decompositions of a segment, by Gauss's rule on cells.

use super::meter::Meter;
use super::squares::{Choice, is_real, powers};
use crate::enclosure::Interval;
use crate::integer::Int;
use crate::number::Rational;
use crate::roots::{ComplexRoot, common_zero, complex_roots_while, halves, to_bernstein};
use crate::spine::Bezier;

/// Rotations by their rows, up to a factor; the third row is the axis. One after the other is tried until the tangents stay
/// off the great circle across it.
const ROTATIONS: [[[i64; 3]; 3]; 15] = {
    // axes (1, 2p, 2q) for signs p, q, and their cyclic like
    const fn about(p: i64, q: i64) -> [[[i64; 3]; 3]; 3] {
        [
            [[2 * p * q, -2 * q, p], [2, p, -2 * q], [1, 2 * p, 2 * q]],
            [[p, 2 * p * q, -2 * q], [-2 * q, 2, p], [2 * q, 1, 2 * p]],
            [[-2 * q, p, 2 * p * q], [p, -2 * q, 2], [2 * p, 2 * q, 1]],
        ]
    }
    let [[a, b, c], [d, e, f], [g, h, i], [j, k, l]] = [about(1, 1), about(-1, 1), about(1, -1), about(-1, -1)];
    [
        [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
        [[0, 1, 0], [0, 0, 1], [1, 0, 0]],
        [[0, 0, 1], [1, 0, 0], [0, 1, 0]],
        a,
        b,
        c,
        d,
        e,
        f,
        g,
        h,
        i,
        j,
        k,
        l,
    ]
};

/// Nodes > 0 of Gauss's rule with 12 nodes on [-1, 1], and their weights, to the nearest f64.
const NODES: [[f64; 2]; 6] = [
    [0.981_560_634_246_719_3, 0.047_175_336_386_511_83],
    [0.904_117_256_370_474_9, 0.106_939_325_995_318_43],
    [0.769_902_674_194_304_7, 0.160_078_328_543_346_23],
    [0.587_317_954_286_617_4, 0.203_167_426_723_065_92],
    [0.367_831_498_998_180_2, 0.233_492_536_538_354_8],
    [0.125_233_408_511_468_9, 0.249_147_045_813_402_8],
];
/// The share of the greatest possible twist to which the integrals are enclosed, and that of a full turn.
const WIDTH: f64 = 1e-10;
/// Covers the rounding in bounds of errors.
const SLACK: f64 = 1.000_001;
/// Halvings of the segment.
const DEPTH: u32 = 40;

/// The axis of the twists on a part of a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Axis {
    /// Where the part starts, in the parameter 0 .. 1 of its segment; exact.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// In place of z, up to a factor.
    pub axis: [i64; 3],
}

/// The twists of all decompositions of one segment.
pub(crate) struct Twist {
    /// The axes in place of z, of the parts in order.
    pub(crate) axes: Vec<Axis>,
    /// Integrals of v[i] v[j] / s for v = the kernels y / ((t - x)^2 + y^2) of the pairs, then Q.
    gram: Vec<Vec<Interval>>,
    /// The integral of what does not depend on A.
    rest: Interval,
    multiplicities: Vec<usize>,
}

impl Twist {
    /// `None` if parts would be shorter than 2^-`DEPTH`, or the meter ran out.
    pub(crate) fn of(bezier: &Bezier, roots: &[ComplexRoot], meter: &mut Meter) -> Option<Self> {
        let a = bezier.forms().a.map(|form| form.c);
        let turned = |rotation: &[[i64; 3]; 3]| {
            let row = |row: &[i64; 3]| -> Vec<Int> {
                let entry = |k: usize| (0..3).fold(Int::ZERO, |sum, i| &sum + &(&a[i][k] * &Int::from(row[i])));
                (0..a[0].len()).map(entry).collect()
            };
            rotation.each_ref().map(row)
        };
        let a = ROTATIONS.each_ref().map(turned);
        let heights = a.each_ref().map(|[_, _, height]| to_bernstein(&powers(height.clone())));
        let mut found: Vec<Option<Integrand>> = ROTATIONS.iter().map(|_| None).collect();
        let size = roots.iter().filter(upper).count() + 1;
        let (zero, multiplicities) = (Interval::point(0.0), roots.iter().filter(upper).map(ComplexRoot::multiplicity));
        let mut twist = Self {
            axes: vec![],
            gram: vec![vec![zero; size]; size],
            rest: zero,
            multiplicities: multiplicities.collect(),
        };
        let mut parts = vec![((0_u64, 0_u32), heights)];
        while let Some(((index, depth), heights)) = parts.pop() {
            if let Some(k) = heights.iter().position(|height| common_zero(std::slice::from_ref(height)).is_none()) {
                if found[k].is_none() {
                    found[k] = Some(Integrand::new(&a[k], roots, meter)?);
                }
                found[k].as_ref()?.integrate((index, depth), &mut twist, meter)?;
                let length = 1.0 / (1_u64 << depth) as f64;
                let (from, to) = (index as f64 * length, (index + 1) as f64 * length);
                twist.axes.push(Axis { from, to, axis: ROTATIONS[k][2] });
                continue;
            }
            if depth >= DEPTH || !meter.tick() {
                return None;
            }
            let halved = heights.map(|height| halves(&height));
            let [left, right] =
                [0, 1].map(|side| halved.each_ref().map(|h| if side == 0 { &h.0 } else { &h.1 }.clone()));
            parts.extend([((2 * index + 1, depth + 1), right), ((2 * index, depth + 1), left)]);
        }
        let known = twist.gram.iter().flatten().chain([&twist.rest]).all(|x| x.mag().is_finite());
        known.then_some(twist)
    }

    /// Of alpha + i beta and of its conjugate.
    pub(crate) fn twists(&self, choice: &Choice) -> [[f64; 2]; 2] {
        [1.0, -1.0].map(|sign| {
            // theta' is that of the upper roots less that of the lower ones
            let taken = choice.iter().zip(&self.multiplicities).map(|(j, k)| sign * (2.0 * *j as f64 - *k as f64));
            let v: Vec<f64> = taken.chain([-1.0]).collect();
            let mut sum = self.rest;
            for (row, x) in self.gram.iter().zip(&v) {
                for (entry, y) in row.iter().zip(&v) {
                    sum = sum + *entry * Interval::point(x * y);
                }
            }
            [sum.lo().max(0.0), sum.hi()]
        })
    }
}

/// A root above the axis.
fn upper(root: &&ComplexRoot) -> bool {
    !is_real(root) && root.im() > Rational::from_integer(0.into())
}

/// A polynomial on [0, 1] by its scaled Bernstein coefficients, times 2^-drop.
struct Polynomial {
    c: Vec<Interval>,
    /// The greatest Bernstein coefficient in size, from above.
    size: f64,
}

impl Polynomial {
    fn at(&self, t: Interval) -> Interval {
        let (one, n) = (Interval::point(1.0), self.c.len() - 1);
        let rest = one - t;
        let horner = |c: &mut dyn Iterator<Item = &Interval>, quotient: Interval| {
            c.fold(Interval::point(0.0), |sum, c| sum * quotient + *c)
        };
        let (sum, scale) = if t.mid() < 0.5 {
            (horner(&mut self.c.iter().rev(), t / rest), rest)
        } else {
            (horner(&mut self.c.iter(), rest / t), t)
        };
        (0..n).fold(sum, |sum, _| sum * scale)
    }
}

/// The parts of the integrand at one place.
struct Values {
    /// The kernels, then Q.
    v: Vec<Interval>,
    over_s: Interval,
    s: Interval,
    f: Interval,
    rest: Interval,
}

struct Integrand {
    a: [Polynomial; 3],
    slope: [Polynomial; 3],
    /// Upper roots of f.
    pairs: Vec<[Interval; 2]>,
    multiplicities: Vec<usize>,
    /// All roots of f, and those of the height, with multiplicities.
    poles: Vec<([Interval; 2], f64)>,
    zeros: Vec<([Interval; 2], f64)>,
}

fn place(root: &ComplexRoot) -> [Interval; 2] {
    [root.re(), root.im()].map(|x| {
        let r = root.radius();
        let [low, high] = [&x - &r, &x + &r];
        let bounds = [&low, &high].map(|x| Interval::from_ratio(x.numer(), x.denom()));
        bounds[0].hull(bounds[1])
    })
}

impl Integrand {
    fn new(a: &[Vec<Int>; 3], roots: &[ComplexRoot], meter: &mut Meter) -> Option<Self> {
        let zeros = powers(a[2].clone());
        let zeros = zeros.iter().map(|c| Rational::from(c.big())).collect::<Vec<_>>();
        let zeros = complex_roots_while(&zeros, &mut || meter.tick()).ok()??;
        let counted = |roots: &[ComplexRoot]| roots.iter().map(|r| (place(r), r.multiplicity() as f64)).collect();
        let slopes = a.each_ref().map(|c| slope(c));
        let drop = a.iter().chain(&slopes).flatten().map(|c| c.bits() as i64).max().unwrap_or(0);
        let polynomial = |c: &Vec<Int>| {
            let near = |c: &Int| {
                let near = c.to_f64_shifted(drop);
                if c.is_zero() { Interval::point(0.0) } else { Interval::new(near.next_down(), near.next_up()) }
            };
            let c: Vec<Interval> = c.iter().map(near).collect();
            let binomials = crate::bernstein::int_binomials(c.len() - 1);
            let size = c.iter().zip(&binomials).map(|(c, b)| c.mag() / b.to_f64_shifted(0)).fold(0.0, f64::max);
            Polynomial { size, c }
        };
        Some(Self {
            a: a.each_ref().map(polynomial),
            slope: slopes.each_ref().map(polynomial),
            pairs: roots.iter().filter(upper).map(place).collect(),
            multiplicities: roots.iter().filter(upper).map(ComplexRoot::multiplicity).collect(),
            poles: counted(roots),
            zeros: counted(&zeros),
        })
    }

    fn at(&self, t: Interval) -> Values {
        let [x, y, z] = self.a.each_ref().map(|p| p.at(t));
        let [dx, dy, dz] = self.slope.each_ref().map(|p| p.at(t));
        let one = Interval::point(1.0);
        let f = x.sqr() + y.sqr() + z.sqr();
        let (s, over_s) = (z.abs() / f.sqrt(), f.sqrt() / z.abs());
        let turn = (x * dy - y * dx) / f;
        let bend = (turn.sqr() * f.sqr() + (y * dz - z * dy).sqr() + (z * dx - x * dz).sqr()) / f.sqr();
        let next = one + s;
        let rest = (bend - turn.sqr() * (next + s.sqr()) / next) * over_s / next;
        let kernel = |[x, y]: &[Interval; 2]| *y / ((t - *x).sqr() + y.sqr());
        let v = self.pairs.iter().map(kernel).chain([turn]).collect();
        Values { v, over_s, s, f, rest }
    }

    /// A radius round t, less than the distance to any root, in which f stays within f(t)/2 of f(t), and the height alike.
    fn radius(&self, t: f64) -> f64 {
        let nearness = |roots: &[([Interval; 2], f64)]| {
            let one = |([x, y], times): &([Interval; 2], f64)| times / distance(t, [*x, *y]);
            roots.iter().map(one).fold(0.0, |sum, x| sum + x)
        };
        // prod (1 + r/d)^k <= exp(r sum k/d) <= exp 0.4 < 3/2
        let near = 0.399 / nearness(&self.poles).max(nearness(&self.zeros));
        // farther out the bounds of a in `error` grow too much
        near.min(2.0 / self.a[0].c.len() as f64)
    }

    /// Adds the integrals over a cell.
    fn integrate(&self, cell: (u64, u32), sum: &mut Twist, meter: &mut Meter) -> Option<()> {
        let Twist { gram, rest, .. } = sum;
        let mut cells = vec![cell];
        while let Some((index, depth)) = cells.pop() {
            if depth > DEPTH || !meter.tick() {
                return None;
            }
            let h = 0.5 / (1_u64 << depth) as f64;
            let t = (2 * index + 1) as f64 * h;
            let share = h / self.radius(t);
            let error = if share < 0.5 { self.error(t, h, share) } else { None };
            let Some((errors, error_of_rest)) = error else {
                cells.extend([(2 * index + 1, depth + 1), (2 * index, depth + 1)]);
                continue;
            };
            for [node, weight] in NODES {
                let near = |x: f64| Interval::new(x.next_down(), x.next_up());
                for side in [near(node), -near(node)] {
                    let at = self.at(Interval::point(t) + Interval::point(h) * side);
                    let weight = near(weight) * Interval::point(h);
                    let scale = weight * at.over_s;
                    for (row, x) in gram.iter_mut().zip(&at.v) {
                        let x = *x * scale;
                        for (entry, y) in row.iter_mut().zip(&at.v) {
                            *entry = *entry + x * *y;
                        }
                    }
                    *rest = *rest + weight * at.rest;
                }
            }
            let around = |error: f64| Interval::new(-error, error);
            for (row, x) in gram.iter_mut().zip(&errors) {
                for (entry, y) in row.iter_mut().zip(&errors) {
                    *entry = *entry + around((x * y).next_up());
                }
            }
            *rest = *rest + around(error_of_rest);
        }
        Some(())
    }

    /// Bounds of the error of Gauss's rule on t - h .. t + h for the products of v and for the rest, if they are small: what is
    /// analytic and at most m within `h / share` of t is off by at most 4 m h share^24 / (1 - share). The products of these
    /// numbers are those for the products.
    fn error(&self, t: f64, h: f64, share: f64) -> Option<(Vec<f64>, f64)> {
        let here = self.at(Interval::point(t));
        let radius = h / share;
        let factor = 4.0 * h * share.powi(24) / (1.0 - share) * SLACK + f64::MIN_POSITIVE;
        // |t| + |1 - t| is at most 1 + 2 radius
        let largest = |p: &[Polynomial; 3]| {
            p.iter().map(|p| p.size * (1.0 + 2.0 * radius).powi(p.c.len() as i32 - 1)).fold(0.0, f64::max) * SLACK
        };
        let moments = 2.0 * largest(&self.a) * largest(&self.slope);
        let turn = moments / (0.5 * here.f.lo());
        // |s| grows by 3/2 sqrt 2 at most, 1/s by 2 sqrt 3/2; Re s > 0
        let (s, over_s) = (2.2 * here.s.hi(), 2.5 * here.over_s.hi());
        let rest = over_s * turn * turn * (3.0 + (1.0 + s + s * s)) * SLACK;
        let kernel = |[x, y]: &[Interval; 2]| {
            let gap = distance(t, [*x, *y]) - radius;
            if gap > 0.0 { y.hi() / (gap * gap) * SLACK } else { f64::INFINITY }
        };
        let scale = (factor * over_s).sqrt() * SLACK;
        let mut errors: Vec<f64> = self.pairs.iter().map(|pair| kernel(pair) * scale).collect();
        let taken =
            |v: &mut dyn Iterator<Item = f64>| v.zip(&self.multiplicities).map(|(v, k)| v * *k as f64).sum::<f64>();
        let total = taken(&mut errors.iter().copied()) + turn * scale;
        errors.push(turn * scale);
        let most = taken(&mut here.v.iter().map(|v| v.mag())) + here.v.last().map_or(0.0, |v| v.mag());
        let most = most * most * here.over_s.hi() + here.rest.mag();
        let small = total * total + factor * rest <= WIDTH * h * (1.0 + most);
        small.then_some((errors, factor * rest))
    }
}

/// Of t from a root, from below.
fn distance(t: f64, [x, y]: [Interval; 2]) -> f64 {
    ((Interval::point(t) - x).sqr() + y.sqr()).sqrt().lo()
}

/// The derivative of the sum of c[k] t^k (1-t)^(n-k).
fn slope(c: &[Int]) -> Vec<Int> {
    let n = c.len() - 1;
    let step = |k: usize| &(&c[k + 1] * &Int::from(k as i64 + 1)) - &(&c[k] * &Int::from((n - k) as i64));
    if n == 0 { vec![Int::ZERO] } else { (0..n).map(step).collect() }
}
