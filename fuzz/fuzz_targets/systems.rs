//! Bytes to a small spine; its critical points, stationary pairs and two squares must be proved by their own certificates, and
//! no curvature sampled may be greater than the greatest.
#![no_main]

use libfuzzer_sys::fuzz_target;
use tubecert::{
    Certificate, CurvatureOptions, Curve, PairsOptions, Spine, SquaresOptions, curvature, pairs, squares, verify,
};

#[path = "../../tests/oracle/mod.rs"]
mod oracle;
mod spelled;

fn proved(curve: &Curve, certificate: Option<&Certificate>, complete: bool) {
    let Some(certificate) = certificate else { return };
    let verdict = verify(&certificate.claim(curve.clone()), certificate);
    assert!(verdict.is_ok(), "{} (complete: {complete})\n{}", verdict.unwrap_err(), curve.to_json());
}

fuzz_target!(|data: &[u8]| {
    let Some(curve) = spelled::curve(data) else { return };
    let Ok(spine) = Spine::from_curve(curve.clone()) else { return };
    let bends = curvature(&spine, &CurvatureOptions::new().max_cells(5_000).certificate(true)).expect("an answer");
    proved(&curve, bends.certificate.as_ref(), bends.complete);
    for bound in oracle::Oracle::of(&spine).sample(50).bounds {
        if matches!(bound.why, oracle::Why::Bend { .. }) {
            let least = 1.0 / (oracle::root(&bound.exact_sq) * (1.0 + 1e-12));
            assert!(bends.kappa_max.hi >= least, "{least:e} {bends:?}\n{}", curve.to_json());
        }
    }
    let found = pairs(&spine, &PairsOptions::new().max_cells(5_000).certificate(true)).expect("an answer");
    proved(&curve, found.certificate.as_ref(), found.complete);
    let two = squares(&spine, &SquaresOptions::new().max_cells(20_000).limit(2).certificate(true)).expect("an answer");
    proved(&curve, two.certificate.as_ref(), two.complete);
});
