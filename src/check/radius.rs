//! The claim that delta lies in [lo, hi]: docs/certificate-format.md, sections 2 to 6.

use num_bigint::Sign;
use num_traits::Zero;

use super::arc::Spine;
use super::poly::Poly;
use super::rules::{bent, positive, side, slab};
use super::{Rejection, upper, walk, wanted};
use crate::certificate::{Node, Tube};
use crate::number::{Rational, compare};

/// Whether `a` <= `b`; `None` is +infinity. A caller's number may have any denominator, and `compare` wants positive ones.
fn at_most(a: Option<&Rational>, b: Option<&Rational>) -> bool {
    let positive = [a, b].into_iter().flatten().all(|bound| bound.denom().sign() == Sign::Plus);
    positive && b.is_none_or(|b| a.is_some_and(|a| compare(a, b).is_le()))
}

/// Whether the evidence proves the bounds.
pub(super) fn verify(
    spine: &Spine,
    [claim_lo, claim_hi]: [&Option<Rational>; 2],
    Tube { lo, hi, along, pairs, ends, upper }: &Tube,
) -> Result<(), Rejection> {
    let (zero, lo, hi) = (Rational::zero(), lo.as_ref(), hi.as_ref());
    wanted(at_most(Some(&zero), lo), "lo", "the bound is negative")?;
    wanted(at_most(Some(&zero), hi), "hi", "the bound is negative")?;
    wanted(at_most(claim_lo.as_ref(), lo), "lo", "the claim is more than what the certificate proves")?;
    wanted(at_most(hi, claim_hi.as_ref()), "hi", "the claim is less than what the certificate proves")?;

    let more = lo.is_none_or(|lo| !lo.is_zero());
    let smooth = || (1..spine.spans.len()).all(|joint| spine.is_smooth(joint));
    wanted(!more || smooth(), "lo", "a joint is not smooth")?;
    // the ends of an open spine then are two points: with b = 0 as C runs straight on; with pairs as no other rule than
    // `cone` closes a pair with D = 0, and C goes on along its axis. And with b = 0 no witness stands for hi < inf
    let straight = || spine.spans.iter().all(|span| span.wb().iter().all(Poly::is_zero));
    wanted(lo.is_some() || straight(), "lo", "the spine is not straight")?;
    let bounded = more && lo.is_some();
    wanted(pairs.is_some() == bounded, "pairs", "there must be pairs iff lo is > 0 and not inf")?;
    let open = bounded && !spine.closed;
    wanted(ends.is_some() == open, "start", "there must be ends iff lo is > 0 and not inf and the spine is open")?;

    let r = lo.unwrap_or(&zero).pow(2);
    walk::along(spine, &r, along)?;
    if let Some(pairs) = pairs {
        walk::pairs(spine, "pairs", pairs, |node, a, b| match node {
            Node::Slab(g) => slab(a, b, g, &r),
            Node::Side(fields) => side(walk::one(a)?, walk::one(b)?, *fields),
            Node::Bent(fields) => positive(&bent(walk::one(a)?, walk::one(b)?, *fields, &r)?),
            _ => Err(walk::MISPLACED),
        })?;
    }
    if let Some([start, finish]) = ends {
        walk::end(spine, &r, false, start)?;
        walk::end(spine, &r, true, finish)?;
    }
    upper::upper(spine, upper, hi).map_err(|why| Rejection::of("upper", why))
}
