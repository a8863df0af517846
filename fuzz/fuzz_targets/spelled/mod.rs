//! Bytes to a small curve, with coordinates from a small lattice or raw f64 bits.

use tubecert::Rational;

use crate::oracle;

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
pub fn curve(data: &[u8]) -> Option<tubecert::Curve> {
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
