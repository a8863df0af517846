//! The claim about f = |C'|^2 as a sum of two squares: docs/certificate-format.md, section 9. Disks with one root each give all
//! roots of f; alpha + i beta is sqrt(lead f) times a product of (t - root), evaluated in disks.

use std::collections::BTreeSet;

use num_bigint::{BigInt, Sign};
use num_traits::{One, Signed, Zero};

use super::arc::{Piece, Spine};
use super::poly::{Poly, dot};
use super::rules::{Why, check};
use super::{Rejection, wanted};
use crate::certificate::squares::{Disk as Given, Factor, Segment};
use crate::claim::{RootBox, Squares, TwoSquares};
use crate::curve::Curve;
use crate::number::Rational;

/// Disks are no finer than 2^-MAX_BITS.
const MAX_BITS: u32 = 1 << 14;

/// Whether the evidence proves the claim, segment by segment.
pub(super) fn verify(curve: &Curve, spine: &Spine, claim: &[Squares], of: &[Segment]) -> Result<(), Rejection> {
    let (spans, knots) = (spine.spans.len(), Spine::knots(curve));
    wanted(claim.len() == spans && of.len() == spans, "segment", "there must be one for each span")?;
    for (number, (span, (claimed, found))) in spine.spans.iter().zip(claim.iter().zip(of)).enumerate() {
        let place = [claimed.from.clone(), claimed.to.clone()];
        let numbers = place.iter().all(|x| x.denom().is_positive());
        wanted(numbers && knots.get(number..number + 2) == Some(&place), "segment", "it is not where the claim says")?;
        segment(span, claimed, found).map_err(|why| Rejection::of("segment", why).at(number + 1, &"segment"))?;
    }
    Ok(())
}

/// A disk about a point, all over 2^bits.
#[derive(Clone)]
struct Disk {
    re: BigInt,
    im: BigInt,
    radius: BigInt,
}

/// A disk with one root of f, which is real iff the centre is.
struct Root {
    multiplicity: usize,
    factor: usize,
    disk: Disk,
}

fn segment(span: &Piece, claim: &Squares, found: &Segment) -> Result<(), Why> {
    let rationals = |root: &RootBox| root.re.iter().chain(&root.im).all(|x| x.denom().is_positive());
    let bounds = |two: &TwoSquares| two.alpha.iter().chain(&two.beta).flatten().all(|x| x.denom().is_positive());
    let positive = claim.roots.iter().all(rationals) && claim.decompositions.iter().all(bounds);
    check(positive, "a number has no positive denominator")?;
    check(found.bits <= MAX_BITS, "the disks are too fine")?;
    let (f, lead) = speed_squared(span)?;
    check(product(&found.factors, f.len()).is_some_and(|p| proportional(&p, &f)), "the factors do not make up f")?;

    check(found.disks.len() < f.len(), "there are more disks than roots")?;
    // every root, in the order of the claim: of a pair the upper one, then its conjugate
    let mut roots: Vec<Root> = vec![];
    for disk in &found.disks {
        let factor = found.factors.get(disk.factor).ok_or("there is no such factor")?;
        holds_a_root(factor, disk, found.bits)?;
        let Given { factor: number, re, im, radius } = disk;
        let mut push = |im: BigInt| {
            let disk = Disk { re: re.clone(), im, radius: radius.clone() };
            roots.push(Root { multiplicity: factor.multiplicity, factor: *number, disk });
        };
        push(im.clone());
        if im.is_positive() {
            push(-im);
        }
    }
    for (i, root) in roots.iter().enumerate() {
        check(roots.iter().take(i).all(|other| apart(&root.disk, &other.disk)), "two disks meet")?;
    }
    for (number, factor) in found.factors.iter().enumerate() {
        let count = roots.iter().filter(|root| root.factor == number).count();
        check(count + 1 == factor.coefficients.len(), "a factor has more roots than disks")?;
    }

    check(claim.roots.len() == roots.len(), "the roots claimed are not as many as those proved")?;
    for (root, claimed) in roots.iter().zip(&claim.roots) {
        check(claimed.multiplicity == root.multiplicity, "a root has another multiplicity")?;
        let Disk { re, im, radius } = &root.disk;
        // a real root is nowhere else
        let of_im = if im.is_zero() { BigInt::zero() } else { radius.clone() };
        let unit = BigInt::one() << found.bits;
        let inside = within(&claimed.re, &(re - radius), &(re + radius), &unit)
            && within(&claimed.im, &(im - &of_im), &(im + &of_im), &unit);
        check(inside, "a root may lie outside its box")?;
    }

    let pairs: Vec<usize> = roots.iter().filter(|r| r.disk.im.is_positive()).map(|r| r.multiplicity).collect();
    let choices = pairs.iter().try_fold(1_u128, |all, k| all.checked_mul(*k as u128 + 1));
    let even = pairs.iter().all(|k| k % 2 == 0);
    let count = choices.and_then(|all| all.checked_add(u128::from(even))).map(|all| all / 2);
    check(count == Some(claim.count), "the number of decompositions is another one")?;
    check(claim.decompositions.len() == found.choices.len(), "there must be a choice for each decomposition")?;
    let mut seen = BTreeSet::new();
    for (choice, claimed) in found.choices.iter().zip(&claim.decompositions) {
        check(choice.len() == pairs.len(), "a choice is not about all pairs")?;
        let rest = choice.iter().zip(&pairs).map(|(j, k)| k.checked_sub(*j));
        let rest = rest.collect::<Option<Vec<usize>>>().ok_or("a root is taken too often")?;
        check(!seen.contains(choice) && !seen.contains(&rest), "two decompositions are the same")?;
        decomposition(&roots, choice, found.bits, &lead, claimed)?;
        seen.insert(choice.clone());
        seen.insert(rest);
    }
    Ok(())
}

/// |a|^2 by rising powers, the last not 0, and its leading coefficient where the weight is 1 at the start.
fn speed_squared(span: &Piece) -> Result<(Vec<BigInt>, Rational), Why> {
    let mut f = powers(&dot(span.a(), span.a()));
    while f.last().is_some_and(Zero::is_zero) {
        f.pop();
    }
    let last = f.last().ok_or("the hodograph is 0")?.clone();
    let weight = span.w.0.first().filter(|w| !w.is_zero()).ok_or("the weight is 0 at the start")?;
    Ok((f, Rational::new(last, weight.pow(4))))
}

/// The sum of c[k] t^k (1-t)^(n-k) by rising powers.
fn powers(p: &Poly) -> Vec<BigInt> {
    // sum (1 - t) + c t^k for one k after the other
    p.0.iter().fold(vec![], |sum, c| {
        let below = [BigInt::zero()].into_iter().chain(sum.clone());
        sum.into_iter().chain([c.clone()]).zip(below).map(|(same, below)| same - below).collect()
    })
}

/// The product of the factors as often as they count, if it has that many coefficients.
fn product(factors: &[Factor], length: usize) -> Option<Vec<BigInt>> {
    let mut degree = 1_usize;
    for factor in factors {
        let each = factor.coefficients.len().checked_sub(1).filter(|degree| *degree > 0)?;
        degree = degree.checked_add(each.checked_mul(factor.multiplicity).filter(|all| *all > 0)?)?;
    }
    let mut product = Poly::constant(1);
    for factor in factors.iter().filter(|_| degree == length) {
        // the coefficients of t^k, not of t^k (1-t)^(n-k): products are the same
        let once = Poly(factor.coefficients.clone());
        product = (0..factor.multiplicity).fold(product, |all, _| all.times(&once));
    }
    (degree == length).then_some(product.0)
}

fn proportional(p: &[BigInt], q: &[BigInt]) -> bool {
    let (Some(a), Some(b)) = (p.last(), q.last()) else { return false };
    !a.is_zero() && p.len() == q.len() && p.iter().zip(q).all(|(x, y)| x * b == y * a)
}

/// n |p(z) / p'(z)| <= radius, and the centre is not below the axis.
fn holds_a_root(factor: &Factor, disk: &Given, bits: u32) -> Result<(), Why> {
    let degree = BigInt::from(factor.coefficients.len() - 1);
    let slope = factor.coefficients.iter().enumerate().skip(1).map(|(k, c)| c * k).collect::<Vec<_>>();
    // |p(z)|^2 times 2^(2 bits degree)
    let size = |p: &[BigInt]| {
        let (mut re, mut im) = (BigInt::zero(), BigInt::zero());
        for (k, c) in p.iter().rev().enumerate() {
            let next = &re * &disk.re - &im * &disk.im + (c << (bits as usize * k));
            im = &re * &disk.im + &im * &disk.re;
            re = next;
        }
        re.pow(2) + im.pow(2)
    };
    let (value, rate) = (size(&factor.coefficients), size(&slope));
    check(!disk.im.is_negative() && !disk.radius.is_negative(), "a disk is below the axis, or has no radius")?;
    let near = rate.is_positive() && degree.pow(2) * value <= disk.radius.pow(2) * rate;
    check(near, "a disk may hold no root")
}

fn apart(a: &Disk, b: &Disk) -> bool {
    (&a.re - &b.re).pow(2) + (&a.im - &b.im).pow(2) > (&a.radius + &b.radius).pow(2)
}

/// Whether the bounds hold all from `from` to `to`, both over `unit`.
fn within([lo, hi]: &[Rational; 2], from: &BigInt, to: &BigInt, unit: &BigInt) -> bool {
    lo.numer() * unit <= from * lo.denom() && to * hi.denom() <= hi.numer() * unit
}

/// The coefficients of sqrt(lead) times the product of (t - root) are within the bounds claimed.
fn decomposition(roots: &[Root], choice: &[usize], bits: u32, lead: &Rational, claim: &TwoSquares) -> Result<(), Why> {
    let mut product = vec![Disk { re: BigInt::one() << bits, im: BigInt::zero(), radius: BigInt::zero() }];
    let (mut pairs, mut evenly) = (choice.iter(), true);
    let mut upper = 0;
    for Root { multiplicity, disk, .. } in roots {
        let times = match disk.im.sign() {
            Sign::NoSign => {
                check(multiplicity % 2 == 0, "f changes its sign")?;
                multiplicity / 2
            }
            Sign::Plus => {
                upper = pairs.next().copied().unwrap_or(0);
                evenly &= upper * 2 == *multiplicity;
                upper
            }
            // the conjugate makes up what the upper root leaves
            Sign::Minus => multiplicity - upper,
        };
        for _ in 0..times {
            product = times_root(&product, disk, bits);
        }
    }
    let degree = product.len() - 1;
    let lengths = claim.alpha.len() == degree + 1 && claim.beta.len() == degree.max(1);
    check(lengths, "a polynomial has another length")?;
    // root / 2^shift <= sqrt(lead) <= above / 2^shift
    let shift = u64::from(bits) + lead.denom().bits();
    let root = ((lead.numer() << (2 * shift)) / lead.denom()).sqrt();
    let exact = root.pow(2) * lead.denom() == lead.numer() << (2 * shift);
    let above = if exact { root.clone() } else { &root + 1 };
    let unit = BigInt::one() << (shift + u64::from(bits));
    let told = |bounds: &[Rational; 2], x: &BigInt, radius: &BigInt| {
        let scaled = |x: BigInt, outward: Sign| if x.sign() == outward { x * &above } else { x * &root };
        within(bounds, &scaled(x - radius, Sign::Minus), &scaled(x + radius, Sign::Plus), &unit)
    };
    let alpha = claim.alpha.iter().zip(&product).all(|(bounds, disk)| told(bounds, &disk.re, &disk.radius));
    let zero = BigInt::zero();
    let beta = claim.beta.iter().zip(&product).all(|(bounds, disk)| match evenly {
        true => told(bounds, &zero, &zero),
        false => told(bounds, &disk.im, &disk.radius),
    });
    check(alpha && beta, "a coefficient may lie outside its bounds")
}

/// p times (t - z), rounded: a product of disks with centres z, c lies within |z| r(c) + r(z) (|c| + r(c)) of z c.
fn times_root(p: &[Disk], z: &Disk, bits: u32) -> Vec<Disk> {
    let size = |disk: &Disk| disk.re.abs() + disk.im.abs();
    let nothing = Disk { re: BigInt::zero(), im: BigInt::zero(), radius: BigInt::zero() };
    let below = [&nothing].into_iter().chain(p);
    let terms = p.iter().chain([&nothing]).zip(below).map(|(c, below)| {
        let spread = size(z) * &c.radius + &z.radius * (size(c) + &c.radius);
        Disk {
            re: &below.re - ((&z.re * &c.re - &z.im * &c.im) >> bits),
            im: &below.im - ((&z.re * &c.im + &z.im * &c.re) >> bits),
            // rounding down takes less than 1 of each part, and of the spread
            radius: &below.radius + (spread >> bits) + 3,
        }
    });
    let mut terms: Vec<Disk> = terms.collect();
    if let (Some(top), Some(last)) = (terms.last_mut(), p.last()) {
        *top = last.clone();
    }
    terms
}
