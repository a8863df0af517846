//! From an answer to its certificate.

use crate::certificate::{Certificate, Evidence, Tube, Upper};
use crate::number::{Rational, f64_above, lower_text, parse_rational, upper_text};
use crate::options::Enclosure;
use crate::search::dyadic::shifted;
use crate::search::evidence;
use crate::search::frame::Frame;
use crate::search::tree::Tree;
use crate::spine::Spine;
use num_traits::Zero;

/// The evidence for the bounds of `delta` as they are printed; `None` where the format has no rule for it.
pub(super) fn certificate(
    spine: &Spine,
    frame: &Frame,
    delta: &Enclosure,
    upper: Upper,
    margin: f64,
) -> Option<Certificate> {
    let printed = |text: String| parse_rational(&text).ok();
    let (lo, hi) = (printed(lower_text(delta.lo)), printed(upper_text(delta.hi)));
    if hi.is_some() && upper == Upper::None {
        return None;
    }
    let evidence = Evidence::Radius(proof(frame, lo, hi, upper, margin)?);
    Some(Certificate { digest: spine.curve().digest(), evidence })
}

/// The evidence that delta is at least `lo`, of which no more is said; infinite: that the spine is straight.
pub(crate) fn tube(frame: &Frame, lo: f64) -> Option<Tube> {
    proof(frame, parse_rational(&lower_text(lo)).ok(), None, Upper::None, 1e-6)
}

/// `None` for a bound is +infinity.
fn proof(frame: &Frame, lo: Option<Rational>, hi: Option<Rational>, upper: Upper, margin: f64) -> Option<Tube> {
    // the searches run in the unit box
    let r = lo.as_ref().map_or(0.0, |lo: &Rational| f64_above(&shifted(lo, frame.scale)));
    let along = evidence::along(frame, r)?;
    let bounded = lo.as_ref().is_some_and(|lo| !lo.is_zero());
    let (mut pairs, mut ends) = (None, None);
    if bounded {
        let mut tree = Tree::new(frame);
        pairs = Some(evidence::pairs(&mut tree, r, margin)?);
        if !frame.closed {
            ends = Some([evidence::end(&mut tree, false, r)?, evidence::end(&mut tree, true, r)?]);
        }
    }
    Some(Tube { lo, hi, along, pairs, ends, upper })
}

#[cfg(test)]
mod tests {
    use super::{Evidence, Rational, Tube, Upper};
    use crate::check::verify;
    use crate::curve::Curve;
    use crate::radius::{RadiusOptions, radius};
    use crate::search::evidence::{FAULT, Fault};
    use crate::spine::Spine;

    const CURVATURE: &str = include_str!("../../tests/curves/m98_5_3.json");
    const BODY: &str = include_str!("../../tests/curves/trefoil.json");
    const END: &str = include_str!("../../tests/curves/m98_5_2.json");

    /// The verdict on what a search with a fault writes, after a change of it.
    fn accepted(text: &str, fault: Option<Fault>, change: impl Fn(&mut Tube)) -> bool {
        let curve = Curve::from_json_str(text).expect("a curve");
        let spine = Spine::from_curve(curve.clone()).expect("a spine");
        FAULT.set(fault);
        let answer = radius(&spine, &RadiusOptions::new().certificate(true)).expect("an answer");
        FAULT.set(None);
        let mut certificate = answer.certificate.expect("a certificate");
        let Evidence::Radius(tube) = &mut certificate.evidence else { panic!("{certificate:?}") };
        change(tube);
        verify(&certificate.claim(curve), &certificate).is_ok()
    }

    #[test]
    fn every_planted_fault_is_rejected() {
        for text in [CURVATURE, BODY, END] {
            assert!(accepted(text, None, |_| {}));
        }
        for (fault, text) in [
            (Fault::CurvatureUnproved, CURVATURE),
            (Fault::SignFlipped, BODY),
            (Fault::SignFlipped, CURVATURE),
            (Fault::RadiusForgotten, BODY),
            (Fault::RadiusForgotten, END),
            (Fault::CellDropped, BODY),
            (Fault::CellRepeated, BODY),
            (Fault::LocalUnproved, END),
            (Fault::ShareUnproved, END),
        ] {
            assert!(!accepted(text, Some(fault), |_| {}), "{fault:?}\n{text}");
        }
    }

    /// Bounds rounded inward, and witnesses a little off.
    #[test]
    fn every_wrong_bound_is_rejected() {
        let scale = |x: &mut Rational, num: i64| *x = &*x * Rational::new(num.into(), 1_000_000.into());
        for text in [CURVATURE, BODY, END] {
            assert!(!accepted(text, None, |c| scale(c.lo.as_mut().expect("lo"), 1_000_001)));
            assert!(!accepted(text, None, |c| scale(c.hi.as_mut().expect("hi"), 999_999)));
            assert!(!accepted(text, None, |c| match &mut c.upper {
                Upper::Curvature { t, .. } => scale(t, 1_001_000),
                Upper::Contact { x, .. } => x.iter_mut().for_each(|x| scale(x, 1_001_000)),
                other => panic!("{other:?}"),
            }));
        }
    }
}
