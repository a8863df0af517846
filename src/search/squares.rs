//! |C'|^2 of one segment, its roots, and the products of them that are its decompositions (theory.md, section 6).

use num_bigint::BigInt;
use num_rational::Ratio;

use super::dyadic::Dyadic;
use super::meter::Meter;
use crate::bernstein::dot;
use crate::error::Error;
use crate::integer::Int;
use crate::number::{Rational, f64_above, f64_below};
use crate::roots::{ComplexRoot, complex_roots_while};
use crate::spine::Bezier;

/// f = |a|^2 with C' = a / w^2 and w = 1 at the start: coefficients by rising powers, the last not 0, over one denominator.
#[derive(Debug)]
pub(crate) struct Square {
    pub(crate) f: Vec<Int>,
    pub(crate) over: Int,
}

impl Square {
    pub(crate) fn of(bezier: &Bezier) -> Self {
        let a = bezier.forms().a;
        let mut f = powers(dot(&a, &a).c);
        while f.len() > 1 && f.last().is_some_and(Int::is_zero) {
            f.pop();
        }
        let w = bezier.weight(0);
        let square = w * w;
        Self { f, over: &square * &square }
    }

    /// `None` if the meter ran out.
    ///
    /// # Errors
    /// None: a hodograph of a spine is not 0.
    pub(crate) fn roots(&self, meter: &mut Meter) -> Result<Option<Vec<ComplexRoot>>, Error> {
        let f = self.f.iter().map(|c| Rational::from(c.big())).collect::<Vec<_>>();
        complex_roots_while(&f, &mut || meter.tick())
    }

    /// The degree of alpha.
    pub(crate) fn half(&self) -> usize {
        (self.f.len() - 1) / 2
    }

    fn lead(&self) -> Rational {
        Rational::new(self.f[self.f.len() - 1].big(), self.over.big())
    }
}

/// The power coefficients of the sum of c[k] t^k (1-t)^(n-k): t^n times a polynomial in y = (1-t)/t, and y + 1 = 1/t.
pub(crate) fn powers(mut c: Vec<Int>) -> Vec<Int> {
    for done in 0..c.len() {
        for k in 1..c.len() - done {
            c[k] = &c[k] - &c[k - 1];
        }
    }
    c
}

/// Which roots a decomposition takes: of every pair, in their order, how often the upper one. The lower one makes up the
/// multiplicity.
pub(crate) type Choice = Vec<usize>;

/// All choices, each or its conjugate once: the first pair that is not taken evenly is taken more often below. The last
/// pair changes first.
pub(crate) struct Choices {
    /// Of the pairs.
    multiplicities: Vec<usize>,
    next: Option<Choice>,
}

impl Choices {
    pub(crate) fn new(multiplicities: Vec<usize>) -> Self {
        let next = Some(vec![0; multiplicities.len()]);
        Self { multiplicities, next }
    }

    /// How many there are: (prod (k + 1) + [all k even]) / 2, below 2^126 as the multiplicities sum up to 126 at most.
    pub(crate) fn total(&self) -> u128 {
        let all = self.multiplicities.iter().fold(1_u128, |all, k| all * (*k as u128 + 1));
        let even = self.multiplicities.iter().all(|k| k % 2 == 0);
        (all + u128::from(even)) / 2
    }
}

impl Iterator for Choices {
    type Item = Choice;

    fn next(&mut self) -> Option<Choice> {
        let given = self.next.take()?;
        let mut next = given.clone();
        for i in (0..next.len()).rev() {
            let evenly = next[..i].iter().zip(&self.multiplicities).all(|(j, k)| 2 * j == *k);
            let most = if evenly { self.multiplicities[i] / 2 } else { self.multiplicities[i] };
            if next[i] < most {
                next[i] += 1;
                self.next = Some(next);
                break;
            }
            next[i] = 0;
        }
        Some(given)
    }
}

/// Bounds of the coefficients of alpha and of beta, by rising powers, for some precision of the products: `None` where f64
/// cannot hold them. The lists are those of docs/certificate-format.md: one entry of beta at least, none beyond the degree
/// of alpha less one.
pub(crate) struct Coefficients {
    pub(crate) alpha: Vec<[f64; 2]>,
    pub(crate) beta: Vec<[f64; 2]>,
}

impl Coefficients {
    /// sqrt(lead) times the product of (t - root), for the roots of all multiplicities that `choice` takes.
    pub(crate) fn of(square: &Square, roots: &[ComplexRoot], choice: &Choice, bits: u64) -> Self {
        let disk = |root: &ComplexRoot| {
            let ([re, im, radius], depth) = root.over();
            let dyadic = |x: &BigInt| Dyadic { m: Int::from(x.clone()), e: -(depth as i64) };
            Disk::new(dyadic(re), dyadic(im), dyadic(radius), bits)
        };
        let mut product = vec![Disk { re: Dyadic::ONE, im: Dyadic::ZERO, radius: Dyadic::ZERO }];
        let (mut pairs, mut evenly) = (choice.iter(), true);
        for root in roots {
            let times = if is_real(root) {
                [root.multiplicity() / 2, 0]
            } else if root.over().0[1].sign() == num_bigint::Sign::Plus {
                let upper = pairs.next().copied().unwrap_or(0);
                evenly &= 2 * upper == root.multiplicity();
                [upper, root.multiplicity() - upper]
            } else {
                continue;
            };
            let upper = disk(root);
            let lower = Disk { im: negative(&upper.im), ..upper.clone() };
            for (disk, times) in [upper, lower].iter().zip(times) {
                for _ in 0..times {
                    product = times_root(&product, disk, bits);
                }
            }
        }
        let scale = root_of(&square.lead(), bits);
        let bounds = |x: &Dyadic, radius: &Dyadic| {
            // the root of the lead that is farther out
            let times = |x: Dyadic, more: usize| x.mul(&scale[if x.m.sign().is_lt() { 1 - more } else { more }]);
            let (lo, hi) = (times(x.sub(radius), 0), times(x.add(radius), 1));
            [f64_below(&quotient(&lo)), f64_above(&quotient(&hi))]
        };
        let beta = |disk: &Disk| if evenly { [0.0; 2] } else { bounds(&disk.im, &disk.radius) };
        let last = square.half().max(1);
        Self {
            alpha: product.iter().map(|disk| bounds(&disk.re, &disk.radius)).collect(),
            beta: product.iter().take(last).map(beta).collect(),
        }
    }

    /// Is no coefficient wider than `width` times the greatest?
    pub(crate) fn narrow(&self, width: f64) -> bool {
        let all = || self.alpha.iter().chain(&self.beta);
        let size = all().map(|[lo, hi]| lo.max(-hi)).fold(0.0, f64::max);
        all().all(|[lo, hi]| hi - lo <= width * size)
    }

    pub(crate) fn finite(&self) -> bool {
        self.alpha.iter().chain(&self.beta).flatten().all(|x| x.is_finite())
    }
}

pub(crate) fn is_real(root: &ComplexRoot) -> bool {
    root.over().0[1].sign() == num_bigint::Sign::NoSign
}

fn negative(x: &Dyadic) -> Dyadic {
    Dyadic { m: -&x.m, e: x.e }
}

/// Not in lowest terms.
fn quotient(x: &Dyadic) -> Rational {
    let m = x.m.big();
    if x.e >= 0 { Ratio::from(m << x.e) } else { Ratio::new_raw(m, BigInt::from(1) << -x.e) }
}

/// The square root of a positive number, from below and from above.
fn root_of(x: &Rational, bits: u64) -> [Dyadic; 2] {
    let size = x.numer().bits() as i64 - x.denom().bits() as i64;
    // x 4^shift has about 2 bits bits
    let shift = bits as i64 - size / 2;
    let (up, down) = ((2 * shift).max(0), (-2 * shift).max(0));
    let (numer, denom) = (x.numer() << up, x.denom() << down);
    let root = (&numer / &denom).sqrt();
    let exact = &root * &root * denom == numer;
    let above = if exact { root.clone() } else { &root + 1 };
    [root, above].map(|m| Dyadic { m: Int::from(m), e: -shift })
}

/// A disk in the plane.
#[derive(Debug, Clone)]
struct Disk {
    re: Dyadic,
    im: Dyadic,
    radius: Dyadic,
}

impl Disk {
    /// Cut to so many bits, and widened by what that changes.
    fn new(re: Dyadic, im: Dyadic, radius: Dyadic, bits: u64) -> Self {
        const RADIUS_BITS: u64 = 32;
        let (re, of_re) = cut(re, bits);
        let (im, of_im) = cut(im, bits);
        let (radius, of_radius) = cut([of_re, of_im].iter().flatten().fold(radius, |r, e| r.add(e)), RADIUS_BITS);
        let radius = of_radius.map_or(radius.clone(), |e| radius.add(&e));
        Self { re, im, radius }
    }

    fn size(&self) -> Dyadic {
        let size = |x: &Dyadic| Dyadic { m: x.m.abs(), e: x.e };
        size(&self.re).add(&size(&self.im))
    }
}

/// x rounded down to so many bits, and a bound of the change if there is one.
fn cut(x: Dyadic, bits: u64) -> (Dyadic, Option<Dyadic>) {
    let extra = x.m.bits().saturating_sub(bits);
    if extra == 0 {
        return (x, None);
    }
    let m = match &x.m {
        Int::Small(m) => Int::Small(m >> extra),
        Int::Big(m) => Int::from(&**m >> extra),
    };
    let e = x.e + extra as i64;
    (Dyadic { m, e }, Some(Dyadic { m: Int::ONE, e }))
}

/// p times (t - z).
fn times_root(p: &[Disk], z: &Disk, bits: u64) -> Vec<Disk> {
    let size = z.size();
    let term = |k: usize| {
        let here = p.get(k);
        let below = if k > 0 { p.get(k - 1) } else { None };
        let Some(c) = here else { return below.cloned() };
        let re = z.im.mul(&c.im).sub(&z.re.mul(&c.re));
        let im = negative(&z.re.mul(&c.im).add(&z.im.mul(&c.re)));
        let radius = size.mul(&c.radius).add(&z.radius.mul(&c.size().add(&c.radius)));
        Some(match below {
            Some(b) => Disk::new(re.add(&b.re), im.add(&b.im), radius.add(&b.radius), bits),
            None => Disk::new(re, im, radius, bits),
        })
    };
    (0..=p.len()).filter_map(term).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn choices_are_counted_and_no_two_are_conjugate() {
        for multiplicities in
            [vec![], vec![1], vec![2], vec![1, 1, 1], vec![2, 2], vec![2, 1, 3], vec![4, 2], vec![3, 3]]
        {
            let choices = Choices::new(multiplicities.clone());
            let count = choices.total();
            let all: Vec<Choice> = choices.collect();
            assert_eq!(all.len() as u128, count);
            let conjugate = |c: &Choice| c.iter().zip(&multiplicities).map(|(j, k)| k - j).collect::<Choice>();
            let seen: BTreeSet<Choice> = all.iter().flat_map(|c| [c.clone(), conjugate(c)]).collect();
            assert_eq!(seen.len(), multiplicities.iter().map(|k| k + 1).product::<usize>());
        }
    }

    #[test]
    fn power_coefficients() {
        // (1-t)^2 + 6 t (1-t) + 2 t^2
        let p = powers([1, 6, 2].map(Int::from).to_vec());
        assert_eq!(p, [1, 4, -3].map(Int::from).to_vec());
    }
}
