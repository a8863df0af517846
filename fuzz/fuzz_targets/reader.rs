//! Any bytes: an error or a curve, never a panic. A curve reads back from its own text as the same curve.
#![no_main]

use libfuzzer_sys::fuzz_target;
use tubecert::{Curve, Spine};

/// Validation is exact, so its cost grows with the size of the numbers: larger curves only pass the reader.
const MOST_POINTS: usize = 24;
const MOST_BITS: u64 = 2_000;

fuzz_target!(|data: &[u8]| {
    let Ok(curve) = Curve::from_json_slice(data) else { return };
    let text = curve.to_json();
    let again = Curve::from_json_str(&text).unwrap_or_else(|e| panic!("does not read its own text: {e:?}\n{text}"));
    assert_eq!(again.digest(), curve.digest(), "another digest\n{text}");
    assert_eq!(again.to_json(), text, "another text");
    assert_eq!((again.name(), again.source(), again.unit()), (curve.name(), curve.source(), curve.unit()));

    let bits = curve.control_points().iter().flatten().chain(curve.weights()).chain(curve.knots());
    let bits = bits.map(|x| x.numer().bits().max(x.denom().bits())).max().unwrap_or(0);
    if curve.degree() <= 16 && curve.control_points().len() <= MOST_POINTS && bits <= MOST_BITS {
        let text = std::str::from_utf8(data).expect("read as UTF-8");
        if let Ok(spine) = Spine::from_json_str(text) {
            assert_eq!(spine.curve().digest(), curve.digest());
            assert_eq!(spine.to_json(), curve.to_json());
        }
    }
});
