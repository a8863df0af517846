//! Polynomials that are hard or usual, coefficients by rising power.
#![allow(dead_code, reason = "not every user takes all")]

use num_traits::{One, Signed, Zero};
use tubecert::Rational;

pub type Poly = Vec<Rational>;

pub fn q(n: i64, d: i64) -> Rational {
    Rational::new(n.into(), d.into())
}

pub fn int(n: i64) -> Rational {
    q(n, 1)
}

pub fn times(a: &[Rational], b: &[Rational]) -> Poly {
    let mut c = vec![Rational::zero(); (a.len() + b.len()).saturating_sub(1)];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            c[i + j] += x * y;
        }
    }
    c
}

pub fn product(factors: impl IntoIterator<Item = Poly>) -> Poly {
    factors.into_iter().fold(vec![Rational::one()], |all, factor| times(&all, &factor))
}

/// (x - 1) (x - 2) .. (x - n).
pub fn wilkinson(n: usize) -> Poly {
    product((1..=n as i64).map(|k| vec![int(-k), int(1)]))
}

/// Three-term recurrences p[k+1] = (a x p[k] - b p[k-1]) / c.
pub fn orthogonal(n: usize, terms: impl Fn(i64) -> [i64; 3]) -> Poly {
    let (mut before, mut here) = (vec![int(1)], vec![int(0), int(1)]);
    for k in 1..n as i64 {
        let [a, b, c] = terms(k);
        let mut next = times(&here, &[int(0), q(a, c)]);
        for (next, before) in next.iter_mut().zip(&before) {
            *next -= before * q(b, c);
        }
        (before, here) = (here, next);
    }
    here
}

pub fn chebyshev(n: usize) -> Poly {
    orthogonal(n, |_| [2, 1, 1])
}

/// Integer coefficients between -1000 and 1000, the same in every run.
pub fn random(n: usize) -> Poly {
    let mut state = 2026_u64;
    let next = |_| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        int((state >> 33) as i64 % 2001 - 1000)
    };
    let mut p: Poly = (0..=n).map(next).collect();
    p[n] = p[n].clone() + int(2000);
    p
}

pub fn value(p: &[Rational], x: &Rational) -> Rational {
    p.iter().rev().fold(Rational::zero(), |sum, c| sum * x + c)
}

/// The number of roots, each counted once, in (from, to].
pub fn sturm(p: &[Rational], from: &Rational, to: &Rational) -> usize {
    let trimmed = |mut p: Poly| {
        while p.last().is_some_and(Zero::is_zero) {
            p.pop();
        }
        p
    };
    let slope = p.iter().enumerate().skip(1).map(|(k, c)| c * int(k as i64)).collect();
    let mut chain = vec![p.to_vec(), trimmed(slope)];
    while !chain[chain.len() - 1].is_empty() {
        let [a, b] = [&chain[chain.len() - 2], &chain[chain.len() - 1]];
        let mut rest = a.clone();
        while rest.len() >= b.len() {
            let factor = &rest[rest.len() - 1] / &b[b.len() - 1];
            let shift = rest.len() - b.len();
            for (i, c) in b.iter().enumerate() {
                rest[i + shift] -= &factor * c;
            }
            rest.pop();
        }
        // positive multiples keep the signs: small ones
        let size = rest.iter().map(Signed::abs).max().filter(|size| !size.is_zero());
        chain.push(trimmed(rest.iter().map(|c| -c / size.clone().unwrap_or_else(Rational::one)).collect()));
    }
    let changes = |x: &Rational| {
        let signs: Vec<bool> =
            chain.iter().map(|p| value(p, x)).filter(|v| !v.is_zero()).map(|v| v.is_positive()).collect();
        signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
    };
    changes(from) - changes(to)
}
