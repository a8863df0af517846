//! Random and adversarial spines for property tests, and changes of them.
#![allow(dead_code)] // each test binary uses a part

use crate::shapes::*;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};
use tubecert::{Curve, Rational};

pub fn settings(cases: u32) -> Config {
    // fixed unless PROPTEST_RNG_SEED says otherwise
    let seed = std::env::var("PROPTEST_RNG_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(20_261_122);
    let cases = std::env::var("PROPTEST_CASES").ok().and_then(|s| s.parse().ok()).unwrap_or(cases);
    Config {
        cases,
        rng_seed: RngSeed::Fixed(seed),
        failure_persistence: None,
        max_shrink_iters: 200,
        ..Config::default()
    }
}

pub fn lattice(most: i64) -> impl Strategy<Value = Point> {
    [-most..=most, -most..=most, -most..=most].prop_map(|p| p.map(int))
}

pub fn points(planar: bool, most: i64, count: std::ops::RangeInclusive<usize>) -> impl Strategy<Value = Vec<Point>> {
    prop::collection::vec(lattice(most), count).prop_map(move |mut points| {
        if planar {
            points.iter_mut().for_each(|p| p[2] = int(0));
        }
        points
    })
}

/// Powers of two with exponents up to this.
pub fn weights(spread: i32, count: usize) -> impl Strategy<Value = Vec<Rational>> {
    prop::collection::vec((-spread..=spread).prop_map(|e| power(2, e)), count)
}

pub fn any_bezier() -> impl Strategy<Value = Curve> {
    (any::<bool>(), any::<bool>()).prop_flat_map(|(planar, high)| {
        let count = if high { 6..=13 } else { 3..=5 };
        points(planar, if high { 9 } else { 4 }, count).prop_map(bezier)
    })
}

pub fn rational_bezier() -> impl Strategy<Value = Curve> {
    (any::<bool>(), 1..=8i32).prop_flat_map(|(planar, spread)| {
        points(planar, 5, 3..=7)
            .prop_flat_map(move |p| (weights(spread, p.len()), Just(p)))
            .prop_map(|(w, p)| Curve::new(p.len() - 1, p, Some(w), None).expect("a segment"))
    })
}

/// Point k and point n - k are images of each other under a half turn, a mirror or the point reflection.
pub fn symmetric() -> impl Strategy<Value = Curve> {
    (points(false, 5, 2..=4), 0..4usize, any::<bool>()).prop_map(|(half, kind, middle)| {
        let sign = [[-1, 1, 1], [-1, -1, 1], [-1, -1, -1], [-1, 1, 1]][kind];
        let image = |p: &Point| -> Point { std::array::from_fn(|k| &p[k] * int(sign[k])) };
        let fixed: Point = std::array::from_fn(|k| if sign[k] == 1 { half[0][k].clone() * int(2) } else { int(0) });
        let mut all = half.clone();
        if middle {
            all.push(fixed);
        }
        all.extend(half.iter().rev().map(image));
        if kind == 3 {
            all.iter_mut().for_each(|p| p[2] = int(0));
        }
        bezier(all)
    })
}

pub fn clamped() -> impl Strategy<Value = Curve> {
    (2..=4usize, any::<bool>(), any::<bool>()).prop_flat_map(|(degree, planar, rational)| {
        points(planar, 5, degree + 2..=9).prop_flat_map(move |p| {
            let steps = prop::collection::vec(0..=2i64, p.len() - degree - 1);
            let spread = if rational { 3 } else { 0 };
            (steps, weights(spread, p.len()), Just(p)).prop_map(move |(steps, w, p)| {
                let (mut knots, mut run) = (vec![0; degree + 1], degree + 1);
                let mut last = 0;
                for step in steps {
                    let step = if run >= degree { step.max(1) } else { step };
                    run = if step == 0 { run + 1 } else { 1 };
                    last += step;
                    knots.push(last);
                }
                knots.extend(vec![last + 1; degree + 1]);
                Curve::new(degree, p, Some(w), Some(knots.into_iter().map(int).collect())).expect("a spline")
            })
        })
    })
}

pub fn closed() -> impl Strategy<Value = Curve> {
    (2..=4usize, any::<bool>())
        .prop_flat_map(|(degree, planar)| points(planar, 6, 5..=10).prop_map(move |p| periodic(degree, &p)))
}

/// Straight runs and quarter circles on a lattice: coplanar end disks, exact ties, strands that overlap.
pub fn turtle() -> impl Strategy<Value = Curve> {
    prop::collection::vec((0..3u8, 1..=3i64), 2..=7).prop_map(|moves| {
        let (mut at, mut ahead) = ([0i64, 0], [1i64, 0]);
        let mut path = Path::from(plane(int(0), int(0)));
        for (kind, size) in moves {
            let step = |at: [i64; 2], by: [i64; 2]| [at[0] + size * by[0], at[1] + size * by[1]];
            let left = if kind == 1 { [-ahead[1], ahead[0]] } else { [ahead[1], -ahead[0]] };
            let corner = step(at, ahead);
            let place = |p: [i64; 2]| plane(int(p[0]), int(p[1]));
            if kind == 0 {
                path = path.line(place(corner));
                at = corner;
            } else {
                at = step(corner, left);
                path = path.quarter(place(corner), place(at));
                ahead = left;
            }
        }
        path.curve()
    })
}

/// Strands that pass each other at a distance from 1 down to 1e-7, sheared so that nothing is symmetric.
pub fn passing() -> impl Strategy<Value = Curve> {
    (1..=9i64, -7..=0i32, -2..=2i64, -2..=2i64).prop_map(|(m, e, a, b)| {
        map_points(&alpha(int(m) * power(10, e)), |[x, y, z]| {
            [x + y * q(a, 5), y.clone(), z + x * q(b, 7) + y * q(a, 3)]
        })
    })
}

pub fn constructed() -> impl Strategy<Value = Curve> {
    (0..6usize, 1..=9i64, -6..=0i32).prop_map(|(kind, m, e)| {
        let size = q(m, 10) * power(10, e);
        match kind {
            0 => hairpin(int(2), size),
            1 => stadium(int(2), size),
            2 => hook(size),
            3 => bulb(size),
            4 => faced(size),
            _ => peanut(size),
        }
    })
}

pub fn small_spine() -> impl Strategy<Value = Curve> {
    prop_oneof![
        3 => any_bezier(),
        2 => rational_bezier(),
        3 => symmetric(),
        3 => clamped(),
        2 => closed(),
        3 => turtle(),
        1 => passing(),
        1 => constructed(),
    ]
}

/// The same with a scale and a place, exact.
pub fn spine_anywhere() -> impl Strategy<Value = Curve> {
    (
        small_spine(),
        prop_oneof![4 => Just(0i32), 1 => -12..=12i32, 1 => prop::sample::select(vec![-280, 280])],
        0..4usize,
    )
        .prop_map(|(curve, e, shift)| {
            let curve = if e == 0 { curve } else { scaled(&curve, &power(10, e)) };
            if shift == 0 { moved(&curve, &[power(10, 9), int(3), -power(10, 7)]) } else { curve }
        })
}

pub fn quaternion() -> impl Strategy<Value = [i64; 4]> {
    [-3..=3i64, -3..=3i64, -3..=3i64, -3..=3i64].prop_filter("not 0", |q| q.iter().any(|x| *x != 0))
}

/// A change that leaves delta as it is, or multiplies it by the factor.
#[derive(Debug, Clone)]
pub enum Change {
    Rotate([i64; 4]),
    Move(Point),
    Reverse,
    Elevate,
    Insert(Rational),
    Reweight(Rational),
    Scale(Rational),
}

pub fn change() -> impl Strategy<Value = Change> {
    prop_oneof![
        quaternion().prop_map(Change::Rotate),
        lattice(1000).prop_map(Change::Move),
        Just(Change::Reverse),
        Just(Change::Elevate),
        (1..=96i64).prop_map(|n| Change::Insert(q(n, 97))),
        (1..=20i64, 1..=20i64).prop_map(|(n, d)| Change::Reweight(q(n, d))),
        (1..=99i64, -20..=20i32).prop_map(|(m, e)| Change::Scale(int(m) * power(10, e))),
    ]
}

impl Change {
    /// The curve after it and the factor of lengths; `None` where it does not apply.
    pub fn apply(&self, curve: &Curve) -> Option<(Curve, Rational)> {
        let one_segment = curve.control_points().len() == curve.degree() + 1;
        let changed = match self {
            Self::Rotate(q) => rotated(curve, *q),
            Self::Move(by) => moved(curve, by),
            Self::Reverse => reversed(curve),
            Self::Elevate => elevated(one_segment.then_some(curve)?)?,
            Self::Insert(share) => with_knot(curve, share)?,
            Self::Reweight(c) => reweighted(one_segment.then_some(curve)?, c),
            Self::Scale(factor) => return Some((scaled(curve, factor), factor.clone())),
        };
        Some((changed, int(1)))
    }
}
