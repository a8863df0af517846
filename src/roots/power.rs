//! Integer polynomials in the power basis: lowest degree first, primitive, no leading zeros; the zero polynomial is empty.

use std::sync::Arc;

use crate::error::{Error, ErrorKind};
use crate::integer::{Int, common_integers, exact_div, gcd, lcm};
use crate::number::Rational;

pub(super) fn trimmed(mut p: Vec<Int>) -> Vec<Int> {
    while p.last().is_some_and(Int::is_zero) {
        p.pop();
    }
    let content = p.iter().fold(Int::ZERO, |g, c| gcd(&g, c));
    if !content.is_zero() && content != Int::ONE {
        for c in &mut p {
            *c = exact_div(c, &content);
        }
    }
    p
}

/// Power coefficients are the forward differences times binomials.
pub(super) fn to_power(bernstein: &[Int]) -> Vec<Int> {
    let n = bernstein.len() - 1;
    let binomials = crate::bernstein::int_binomials(n);
    let mut row = bernstein.to_vec();
    let mut power = Vec::with_capacity(n + 1);
    for (k, binomial) in binomials.iter().enumerate() {
        power.push(binomial * &row[0]);
        for i in 0..n - k {
            row[i] = &row[i + 1] - &row[i];
        }
    }
    trimmed(power)
}

/// A positive multiple of the Bernstein coefficients b on [0, 1]: p[k] / C(n,k) are the differences of order k at b[0].
pub(crate) fn to_bernstein(power: &[Int]) -> Vec<Int> {
    let binomials = crate::bernstein::int_binomials(power.len() - 1);
    let common = binomials.iter().fold(Int::ONE, |all, c| lcm(&all, c));
    let mut row: Vec<Int> = power.iter().zip(&binomials).map(|(p, c)| p * &exact_div(&common, c)).collect();
    let mut bernstein = vec![row[0].clone()];
    for order in (1..power.len()).rev() {
        for k in 0..order {
            row[k] = &row[k] + &row[k + 1];
        }
        bernstein.push(row[0].clone());
    }
    bernstein
}

/// Primitive Euclid.
pub(super) fn poly_gcd(mut a: Vec<Int>, mut b: Vec<Int>) -> Vec<Int> {
    while !b.is_empty() {
        let r = pseudo_remainder(a, &b);
        a = std::mem::replace(&mut b, r);
    }
    a
}

fn pseudo_remainder(mut a: Vec<Int>, b: &[Int]) -> Vec<Int> {
    let lead = &b[b.len() - 1];
    while a.len() >= b.len() {
        let (top, shift) = (a[a.len() - 1].clone(), a.len() - b.len());
        for c in &mut a {
            *c = &*c * lead;
        }
        for (i, c) in b.iter().enumerate() {
            a[i + shift] = &a[i + shift] - &(c * &top);
        }
        a = trimmed(a);
    }
    a
}

/// The product of the square-free factors.
pub(super) fn squarefree(p: &[Int]) -> Vec<Int> {
    let slope = trimmed(derivative(p));
    if slope.is_empty() { p.to_vec() } else { quotient(p, &poly_gcd(p.to_vec(), slope)) }
}

/// Not made primitive: Newton's method needs it as it is.
pub(super) fn derivative(p: &[Int]) -> Vec<Int> {
    p.iter().enumerate().skip(1).map(|(k, c)| c * &Int::from(k as i64)).collect()
}

/// The primitive quotient p / d, where d divides p.
fn quotient(p: &[Int], d: &[Int]) -> Vec<Int> {
    let (mut rest, mut quotient) = (p.to_vec(), vec![]);
    let lead = &d[d.len() - 1];
    while rest.len() >= d.len() {
        let (top, shift) = (rest[rest.len() - 1].clone(), rest.len() - d.len());
        for c in rest.iter_mut().chain(&mut quotient) {
            *c = &*c * lead;
        }
        for (i, c) in d.iter().enumerate() {
            rest[i + shift] = &rest[i + shift] - &(c * &top);
        }
        rest.pop();
        quotient.push(top);
    }
    quotient.reverse();
    trimmed(quotient)
}

/// The roots of all square-free factors of a polynomial with rational coefficients: the root 0 by `at_zero`, those of the
/// other factors by `isolated`, each with the multiplicity.
pub(super) fn of_factors<R>(
    coefficients: &[Rational],
    at_zero: impl FnOnce(Arc<Vec<Int>>, usize) -> R,
    mut isolated: impl FnMut(&Arc<Vec<Int>>, usize) -> Vec<R>,
) -> Result<Vec<R>, Error> {
    let mut p = trimmed(common_integers(coefficients.iter()).0);
    if p.is_empty() {
        return Err(Error::new(ErrorKind::Irregular, "the polynomial is zero: every number is a root")
            .help("give a polynomial with a coefficient that is not 0"));
    }
    let zeros = p.iter().take_while(|c| c.is_zero()).count();
    p.drain(..zeros);
    let mut roots = vec![];
    if zeros > 0 {
        roots.push(at_zero(Arc::new(vec![Int::ZERO, Int::ONE]), zeros));
    }
    if p.len() > 1 {
        for (factor, multiplicity) in square_free_factors(&p) {
            roots.extend(isolated(&Arc::new(factor), multiplicity));
        }
    }
    Ok(roots)
}

/// Square-free factors of a primitive p of degree 1 or more, pairwise coprime, with their multiplicities: p is the
/// product of their powers, up to a constant.
pub(super) fn square_free_factors(p: &[Int]) -> Vec<(Vec<Int>, usize)> {
    let slope = trimmed(derivative(p));
    if coprime_modulo_a_prime(p, &slope) {
        return vec![(p.to_vec(), 1)];
    }
    let mut repeated = poly_gcd(p.to_vec(), slope);
    let mut once = quotient(p, &repeated);
    let (mut factors, mut multiplicity) = (vec![], 1);
    while once.len() > 1 {
        let more = poly_gcd(once.clone(), repeated.clone());
        let factor = quotient(&once, &more);
        if factor.len() > 1 {
            factors.push((factor, multiplicity));
        }
        repeated = quotient(&repeated, &more);
        once = more;
        multiplicity += 1;
    }
    factors
}

/// Are two polynomials coprime modulo a prime that divides neither leading coefficient? Then they are over Q.
fn coprime_modulo_a_prime(p: &[Int], q: &[Int]) -> bool {
    const PRIME: u64 = (1 << 61) - 1;
    // 2^61 is 1 modulo this prime
    let reduced = |x: u128| {
        let folded = (x as u64 & PRIME) + (x >> 61) as u64;
        if folded >= PRIME { folded - PRIME } else { folded }
    };
    let times = |a: u64, b: u64| reduced(u128::from(a) * u128::from(b));
    let residues = |p: &[Int]| p.iter().map(|c| c.modulo(PRIME)).collect::<Vec<u64>>();
    let (mut a, mut b) = (residues(p), residues(q));
    if a.last().is_none_or(|c| *c == 0) || b.last().is_none_or(|c| *c == 0) {
        return false;
    }
    while b.len() > 1 {
        while a.len() >= b.len() {
            let (top, lead, shift) = (a[a.len() - 1], b[b.len() - 1], a.len() - b.len());
            for (i, c) in a.iter_mut().enumerate() {
                let other = if i < shift { 0 } else { times(top, b[i - shift]) };
                *c = reduced(u128::from(times(lead, *c)) + u128::from(PRIME - other));
            }
            while a.last() == Some(&0) {
                a.pop();
            }
        }
        std::mem::swap(&mut a, &mut b);
    }
    b.len() == 1
}
