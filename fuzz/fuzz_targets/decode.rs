//! Any bytes: no certificate, or one that writes itself as the same bytes; and `verify` survives it.
#![no_main]

use libfuzzer_sys::fuzz_target;
use tubecert::{Certificate, Curve, Statement, verify};

fuzz_target!(|data: &[u8]| {
    let Ok(certificate) = Certificate::decode(data) else { return };
    assert_eq!(certificate.encode().as_bytes(), data, "another spelling");
    let curve = include_str!("../../tests/curves/m98_5_1_parabola.json");
    let claim = certificate.claim(Curve::from_json_str(curve).expect("a curve"));
    if let Ok(verified) = verify(&claim, &certificate) {
        // delta of the parabola is 1/2 exactly
        let half = tubecert::number::parse_rational("1/2").expect("a number");
        let Statement::Radius { lo, hi } = &verified.claim().statement else { return };
        assert!(lo.as_ref().is_some_and(|lo| *lo <= half) && hi.as_ref().is_none_or(|hi| half <= *hi));
    }
});
