//! Random polynomials: as many real roots as Sturm's theorem counts, one in each interval; as many complex roots as the degree.
#![no_main]

use libfuzzer_sys::fuzz_target;
use polynomials::{int, product, sturm};
use tubecert::Rational;
use tubecert::roots::{complex_roots, real_roots};

#[path = "../../tests/polynomials/mod.rs"]
mod polynomials;

fuzz_target!(|factors: Vec<Vec<i8>>| {
    // products of small factors: multiple and rational roots are common
    let factors = factors.into_iter().take(4).map(|f| f.into_iter().take(6).map(|c| int(c.into())).collect::<Vec<_>>());
    let mut p: Vec<Rational> = product(factors.filter(|f| !f.is_empty()));
    while p.last().is_some_and(|c| *c == int(0)) {
        p.pop();
    }
    if p.len() < 2 {
        return;
    }
    let real = real_roots(&p).expect("not zero");
    let far = int(1 << 40);
    assert_eq!(real.len(), sturm(&p, &-&far, &far), "{p:?}");
    for root in &real {
        let (lo, hi) = (root.lo(), root.hi());
        // Sturm counts in (lo, hi]: the interval with its lower end a little lower
        let below = &lo - Rational::new(1.into(), (1_u64 << 62).into());
        assert!(sturm(&p, &below, &hi) >= 1, "{p:?}");
    }
    assert!(real.windows(2).all(|pair| pair[0].hi() < pair[1].lo()), "{p:?}");
    let complex = complex_roots(&p).expect("not zero");
    assert_eq!(complex.iter().map(|root| root.multiplicity()).sum::<usize>(), p.len() - 1, "{p:?}");
    let on_axis = complex.iter().filter(|root| root.im() == int(0)).count();
    assert_eq!(on_axis, real.len(), "{p:?}");
});
