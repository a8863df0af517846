//! Bytes to a small spine, with coordinates from a small lattice or raw f64 bits; what the library proves about it must
//! agree with the oracle, which sampled rho and confirmed its bounds exactly.
#![no_main]

use libfuzzer_sys::fuzz_target;
use tubecert::{LimitedBy, RadiusOptions, Rational, Spine, radius};

#[path = "../../tests/oracle/mod.rs"]
mod oracle;

/// Takes bytes from the front; 0 when they are used up.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn next(&mut self) -> u8 {
        match self.0.split_first() {
            Some((first, rest)) => {
                self.0 = rest;
                *first
            }
            None => 0,
        }
    }

    fn number(&mut self, kind: u8) -> Rational {
        match kind {
            // raw bits; what is not finite is taken as a small number
            0 => {
                let bits = u64::from_le_bytes(std::array::from_fn(|_| self.next()));
                Rational::from_float(f64::from_bits(bits)).unwrap_or_else(|| small(bits as i64 % 16))
            }
            // a lattice point, pushed off by a tiny amount
            1 => {
                let (n, e, m) = (self.next() as i8, self.next() % 60, self.next() as i8);
                small(i64::from(n % 8)) + small(i64::from(m)) * oracle::power_of_two(-i64::from(e))
            }
            _ => small(i64::from(self.next() as i8 % 8)),
        }
    }
}

fn small(n: i64) -> Rational {
    Rational::from_integer(n.into())
}

/// The control points (closed, planar, mirrored as asked), weights and knots that the bytes spell.
fn curve(data: &[u8]) -> Option<tubecert::Curve> {
    let mut bytes = Bytes(data);
    let shape = bytes.next();
    let (planar, periodic, weighted, mirrored) = (shape & 1 > 0, shape & 2 > 0, shape & 4 > 0, shape & 8 > 0);
    let kind = [2, 2, 1, 0][usize::from(shape >> 4) % 4];
    let degree = 1 + usize::from(bytes.next() % 6);
    let extra = usize::from(bytes.next() % 5);
    let mut points: Vec<[Rational; 3]> = (0..degree + 1 + extra)
        .map(|_| {
            let mut p = std::array::from_fn(|_| bytes.number(kind));
            if planar {
                p[2] = small(0);
            }
            p
        })
        .collect();
    if mirrored {
        let n = points.len();
        for i in 0..n / 2 {
            points[n - 1 - i] = points[i].clone();
            points[n - 1 - i][0] = -points[i][0].clone();
        }
    }
    let mut weights: Vec<Rational> = points
        .iter()
        .map(|_| {
            if !weighted {
                return small(1);
            }
            let b = bytes.next();
            match b {
                0..=199 => oracle::power_of_two(i64::from(b % 9) - 4),
                200..=239 => small(i64::from(b) - 220),
                _ => bytes.number(kind),
            }
        })
        .collect();
    let knots: Vec<i64> = if periodic {
        points.extend_from_within(..degree);
        weights.extend_from_within(..degree);
        (0..(points.len() + degree + 1) as i64).collect()
    } else {
        let mut last = 0;
        let inner: Vec<i64> = (0..extra)
            .map(|_| {
                last += i64::from(bytes.next() % 3);
                last
            })
            .collect();
        std::iter::repeat_n(0, degree + 1).chain(inner).chain(std::iter::repeat_n(last + 1, degree + 1)).collect()
    };
    tubecert::Curve::new(degree, points, Some(weights), Some(knots.into_iter().map(small).collect())).ok()
}

fuzz_target!(|data: &[u8]| {
    let Some(curve) = curve(data) else { return };
    let Ok(spine) = Spine::from_curve(curve) else { return };
    let text = spine.to_json();
    if std::env::var_os("TUBECERT_SHOW").is_some() {
        println!("{text}"); // to see the curve of a slow unit
    }
    let answer = radius(&spine, &RadiusOptions::new().max_cells(20_000)).expect("an answer");
    let (lo, hi) = (answer.delta.lo, answer.delta.hi);
    assert!(lo >= 0.0 && lo <= hi, "not an enclosure: {answer:?}\n{text}");
    let sampler = oracle::Oracle::of(&spine);
    let corner = answer.limited_by == LimitedBy::Corner;
    assert_eq!(answer.closed, sampler.closed && !corner || answer.closed && corner, "{answer:?}\n{text}");
    let sampled = sampler.sample(100);
    oracle::not_above(&answer, &sampled).unwrap_or_else(|e| panic!("{e}\n{answer:?}\n{text}"));
    // the terms are bounds of their own: delta is the least of the four
    let terms =
        [&answer.terms.curvature, &answer.terms.body_to_body, &answer.terms.end_to_body, &answer.terms.end_to_end];
    assert!(terms.iter().all(|e| e.lo <= e.hi), "not an enclosure: {answer:?}\n{text}");
    assert!(terms.iter().all(|e| lo <= e.hi), "delta.lo above a term: {answer:?}\n{text}");
    if let Some(bend) = sampled.bounds.iter().find(|b| matches!(b.why, oracle::Why::Bend { .. })) {
        let lo = answer.terms.curvature.lo;
        let bound = oracle::root(&bend.exact_sq);
        assert!(lo <= bound * (1.0 + 1e-12), "curvature.lo = {lo:e} above {bound:e}: {answer:?}\n{text}");
    }
});
