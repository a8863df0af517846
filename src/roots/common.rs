//! Does an integer polynomial vanish on [0, 1]? Decided exactly, multiple roots included.
//!
//! Bisection on Bernstein coefficients decides every case but a root of even multiplicity at a point that is not
//! dyadic. After `PATIENCE` halvings the polynomial is replaced by its square-free part (the gcd with its derivative
//! taken out), for which bisection always ends: a simple root ends as a change of sign, everywhere else the
//! coefficients get one sign.

use super::power::{poly_gcd, squarefree, to_bernstein, to_power};
use crate::integer::Int;

/// Halvings before the square-free part is computed.
const PATIENCE: u32 = 40;

/// A cell [index, index + 1] / 2^depth of [0, 1] that holds a root, or a root itself when `exact`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) index: Int,
    pub(crate) depth: u32,
    pub(crate) exact: bool,
}

/// Bernstein coefficients on both halves of the interval, each times `2^degree`.
pub(crate) fn halves(p: &[Int]) -> (Vec<Int>, Vec<Int>) {
    let n = p.len() - 1;
    let mut row = p.to_vec();
    let (mut left, mut right) = (Vec::with_capacity(n + 1), Vec::with_capacity(n + 1));
    for level in 0..=n {
        let up = (n - level) as u64;
        left.push(&row[0] << up);
        right.push(&row[n - level] << up);
        for i in 0..n - level {
            row[i] = &row[i] + &row[i + 1];
        }
    }
    right.reverse();
    (left, right)
}

/// Where the polynomials, given by Bernstein coefficients on [0, 1], vanish together; `None` if nowhere.
pub(crate) fn common_zero(polys: &[Vec<Int>]) -> Option<Place> {
    let start = |polys: Vec<Vec<Int>>| (polys, Int::ZERO, 0u32);
    match bisect(start(polys.to_vec()), PATIENCE) {
        Ok(answer) => answer,
        Err(()) => {
            let common = polys.iter().map(|p| to_power(p)).reduce(poly_gcd).unwrap_or_default();
            if common.is_empty() {
                return Some(Place { index: Int::ZERO, depth: 0, exact: true });
            }
            let simple = to_bernstein(&squarefree(&common));
            bisect(start(vec![simple]), u32::MAX).unwrap_or(None)
        }
    }
}

/// The greatest common factor, by Bernstein coefficients on [0, 1] like the polynomials themselves.
pub(crate) fn common_factor(polys: &[Vec<Int>]) -> Vec<Int> {
    let common = polys.iter().map(|p| to_power(p)).reduce(poly_gcd).unwrap_or_default();
    if common.is_empty() { vec![Int::ZERO] } else { to_bernstein(&common) }
}

/// Depth-first, left half first. `Err` when a cell at depth `patience` is still open.
fn bisect(start: (Vec<Vec<Int>>, Int, u32), patience: u32) -> Result<Option<Place>, ()> {
    let mut stack = vec![start];
    let mut stuck = false;
    while let Some((polys, index, depth)) = stack.pop() {
        if polys.iter().any(|p| one_strict_sign(p)) {
            continue;
        }
        for (end, at) in [(0, 0i64), (1, 1)] {
            let value = |p: &Vec<Int>| if end == 0 { p[0].is_zero() } else { p[p.len() - 1].is_zero() };
            if polys.iter().all(value) {
                return Ok(Some(Place { index: &index + &Int::from(at), depth, exact: true }));
            }
        }
        if let [p] = &polys[..]
            && p[0].sign() != p[p.len() - 1].sign()
        {
            return Ok(Some(narrowed(p.clone(), index, depth)));
        }
        if depth >= patience {
            stuck = true;
            continue;
        }
        let (left, right) = polys.iter().map(|p| halves(p)).unzip();
        let twice = &index << 1;
        stack.push((right, &twice + &Int::ONE, depth + 1));
        stack.push((left, twice, depth + 1));
    }
    if stuck { Err(()) } else { Ok(None) }
}

/// Follows a change of sign down to a cell of depth 60, for the message.
fn narrowed(mut p: Vec<Int>, mut index: Int, mut depth: u32) -> Place {
    while depth < 60 {
        let (left, right) = halves(&p);
        let middle = right[0].sign();
        let in_left = middle != p[0].sign();
        index = &(&index << 1) + if in_left { &Int::ZERO } else { &Int::ONE };
        depth += 1;
        if middle.is_eq() {
            return Place { index: &index + &Int::ONE, depth, exact: true };
        }
        p = if in_left { left } else { right };
    }
    Place { index, depth, exact: false }
}

fn one_strict_sign(p: &[Int]) -> bool {
    let sign = p[0].sign();
    sign.is_ne() && p.iter().all(|c| c.sign() == sign)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Product of (q x - p)^m times a positive quadratic, as Bernstein coefficients.
    fn from_roots(roots: &[(i64, i64, u32)]) -> Vec<Int> {
        let mut p = vec![Int::from(3), Int::from(1), Int::from(2)];
        for &(num, den, multiplicity) in roots {
            for _ in 0..multiplicity {
                let mut next = vec![Int::ZERO; p.len() + 1];
                for (k, c) in p.iter().enumerate() {
                    next[k] = &next[k] - &(c * &Int::from(num));
                    next[k + 1] = &next[k + 1] + &(c * &Int::from(den));
                }
                p = next;
            }
        }
        to_bernstein(&p)
    }

    #[test]
    fn double_root_at_a_third_is_found() {
        let place = common_zero(&[from_roots(&[(1, 3, 2)])]).unwrap();
        assert!(!place.exact);
    }

    proptest! {
        #[test]
        fn agrees_with_the_factors(roots in prop::collection::vec((-20i64..30, 1i64..12, 1u32..4), 0..4)) {
            let inside = roots.iter().any(|&(p, q, _)| 0 <= p && p <= q);
            prop_assert_eq!(common_zero(&[from_roots(&roots)]).is_some(), inside);
        }

        #[test]
        fn common_zeros_need_a_common_factor(a in 1i64..20, b in 1i64..20, q in 20i64..23) {
            let place = common_zero(&[from_roots(&[(a, q, 2), (-1, 1, 1)]), from_roots(&[(b, q, 1), (30, 1, 1)])]);
            prop_assert_eq!(place.is_some(), a == b);
        }
    }
}
