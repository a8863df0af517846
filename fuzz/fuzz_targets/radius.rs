//! Bytes to a small spine; what the library proves about its radius must agree with the oracle, which sampled rho and confirmed its bounds exactly.
#![no_main]

use libfuzzer_sys::fuzz_target;
use tubecert::{LimitedBy, RadiusOptions, Spine, radius};

#[path = "../../tests/oracle/mod.rs"]
mod oracle;
mod spelled;

fuzz_target!(|data: &[u8]| {
    let Some(curve) = spelled::curve(data) else { return };
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
