//! From an answer to its certificate.

use super::Enclosure;
use crate::certificate::{Certificate, Upper};
use crate::number::{Rational, f64_above, lower_text, parse_rational, upper_text};
use crate::search::dyadic::power_of_two;
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
    // `null` is +infinity
    let (lo, hi) = (printed(lower_text(delta.lo)), printed(upper_text(delta.hi)));
    if hi.is_some() && upper == Upper::None {
        return None;
    }
    // the searches run in the unit box
    let r = lo.as_ref().map_or(0.0, |lo: &Rational| f64_above(&(lo * power_of_two(frame.scale))));
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
    Some(Certificate { digest: spine.curve().digest(), lo, hi, along, pairs, ends, upper })
}
