//! The certificate of an answer, replayed before it is given.

use num_bigint::BigInt;
use num_traits::Signed;

use super::{Found, Squares, sharpen};
use crate::certificate::squares::{self, Disk, Factor, Segment};
use crate::certificate::{Certificate, Evidence};
use crate::check::verify;
use crate::claim::{self, Claim, Statement};
use crate::number::{lower_text, parse_rational, upper_text};
use crate::options::Enclosure;
use crate::search::meter::Meter;
use crate::spine::Spine;

/// The first precision of the disks, and how often it is doubled until the checker needs no more.
const BITS: u32 = 128;
const DOUBLINGS: u32 = 5;

/// `None` if not all is told in the answer, no precision tried suffices, or the meter runs out.
pub(super) fn certificate(spine: &Spine, answer: &Squares, found: &[Found], meter: &Meter) -> Option<Certificate> {
    let claims: Vec<claim::Squares> = answer.segments.iter().map(claimed).collect::<Option<_>>()?;
    let claim = Claim { curve: spine.curve().clone(), statement: Statement::Squares(claims.clone()) };
    (0..=DOUBLINGS).take_while(|_| !meter.is_late()).find_map(|doublings| {
        let bits = BITS << doublings;
        let segments =
            found.iter().zip(&claims).map(|(found, claim)| segment(found, claim, bits)).collect::<Option<_>>()?;
        let evidence = Evidence::Squares(squares::Evidence { segments });
        let certificate = Certificate { digest: spine.curve().digest(), evidence };
        verify(&claim, &certificate).is_ok().then_some(certificate)
    })
}

/// What is claimed by the numbers as they are printed.
fn claimed(segment: &super::SegmentSquares) -> Option<claim::Squares> {
    let bounds =
        |e: &Enclosure| Some([parse_rational(&lower_text(e.lo)).ok()?, parse_rational(&upper_text(e.hi)).ok()?]);
    let all = |list: &[Enclosure]| list.iter().map(bounds).collect::<Option<Vec<_>>>();
    let root = |root: &super::SquareRoot| {
        Some(claim::RootBox { re: bounds(&root.re)?, im: bounds(&root.im)?, multiplicity: root.multiplicity })
    };
    let two = |two: &super::Decomposition| Some(claim::TwoSquares { alpha: all(&two.alpha)?, beta: all(&two.beta)? });
    Some(claim::Squares {
        from: segment.from.clone(),
        to: segment.to.clone(),
        roots: segment.roots.iter().map(root).collect::<Option<_>>()?,
        count: segment.count,
        decompositions: segment.decompositions.iter().map(two).collect::<Option<_>>()?,
    })
}

fn segment(found: &Found, claim: &claim::Squares, bits: u32) -> Option<Segment> {
    let mut roots = found.roots.clone();
    sharpen(&mut roots, u64::from(bits));
    let mut factors: Vec<Factor> = vec![];
    let mut disks = vec![];
    for root in roots.iter().filter(|root| !root.im().is_negative()) {
        let coefficients: Vec<BigInt> = root.factor().iter().map(|c| c.big()).collect();
        let known = factors.iter().position(|factor| factor.coefficients == coefficients);
        let factor = known.unwrap_or(factors.len());
        if known.is_none() {
            factors.push(Factor { multiplicity: root.multiplicity(), coefficients });
        }
        let [re, im, radius] = root.cut(u64::from(bits))?;
        disks.push(Disk { factor, re, im, radius });
    }
    let choices = found.list.iter().map(|(choice, ..)| choice.clone()).collect();
    Some(Segment { bits, factors, disks, choices, claim: claim.clone() })
}
