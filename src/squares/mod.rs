//! |C'|^2 as a sum of two squares of polynomials (theory.md, section 6): options in, roots and decompositions out.

mod answer;
mod evidence;

pub use crate::search::twist::Axis;
pub use answer::{Decomposition, SegmentSquares, SquareRoot, Squares, SquaresOptions};

use crate::error::Error;
use crate::number::{Rational, compare, rational_from_f64};
use crate::options::{self, Enclosure};
use crate::roots::ComplexRoot;
use crate::search::meter::Meter;
use crate::search::squares::{Choice, Choices, Coefficients, Square, is_real};
use crate::search::twist::Twist;
use crate::spine::{Segment, Spine};
use num_traits::{Signed, Zero};

/// Up to so many decompositions are all ranked before the list is cut.
const RANKED: u128 = 4096;
/// The first precision of products, in bits, and the last: what f64 cannot hold then is left wide.
const BITS: (u64, u64) = (62, 1984);

/// Writes f = |C'|^2 of every Bezier segment as alpha^2 + beta^2, in all ways, and encloses its complex roots.
///
/// *Meaning.* On each segment, with its own parameter t in 0 .. 1, C = r / w with w = 1 at t = 0 (weights divided by the one at the
/// start of the segment) and C' = a / w^2, a = r' w - r w'. f = |a|^2: for an integral segment |C'|^2 itself, for a truly rational one
/// |C'|^2 w^4. With f = lead prod (t - root) over all roots, and for each pair tau, conj tau of multiplicity k a number j in 0 .. k,
/// alpha + i beta = sqrt(lead) prod_real (t - rho)^(k/2) prod (t - tau)^j (t - conj tau)^(k - j), so alpha^2 + beta^2 = f. Up to a
/// rotation of (alpha, beta) and the sign of beta there are no others.
///
/// *Exactness.* Multiplicities are exact (square-free factors over Q), everything else is enclosed: roots to `rel_width` times the
/// size of the greatest root, coefficients to `rel_width` times the greatest coefficient of alpha and beta. The decompositions
/// exist, being products of roots; their coefficients are in general not rational.
///
/// *Order and limit.* A segment has up to 2^125 decompositions; at most `limit` are listed. If it has 4096 or fewer, all are ranked, the
/// least twist first (of the two twists the less counts), and the list is cut then. If it has more, the first `limit` in the
/// order of the choices are taken, the last pair changing first, from all j = 0 on, and ranked among themselves.
///
/// *Twist.* For N of theory.md, section 6, made of A = alpha + i beta, with u = tan(phi / 2), the mean over phi of the integral over
/// t in 0 .. 1 of ((N x N').T)^2, ' being d/dt. The second number is that of alpha - i beta. If z' has a zero on the segment, N is made
/// in rotated coordinates: with the axis x, else y, else one of (1, 2, 2)/3 and its like, in place of z; where the tangents meet the
/// great circles across all of them, the segment is halved, and its parts have axes of their own.
///
/// *Units.* alpha and beta are lengths; twists and t have no unit.
///
/// # Errors
/// As [`radius`](fn@crate::radius).
///
/// ```
/// use tubecert::{Spine, SquaresOptions, squares};
/// let cubic = Spine::from_json_str(
///     r#"{"degree": 3, "control_points": [[2, -3, 0], [4, 1.5, 2], [7, 4, 4], [10, 2, 6]]}"#)?;
/// let answer = squares(&cubic, &SquaresOptions::new())?;
/// let segment = &answer.segments[0];
/// assert_eq!((segment.roots.len(), segment.count, segment.decompositions.len()), (4, 2, 2));
/// # Ok::<(), tubecert::Error>(())
/// ```
pub fn squares(spine: &Spine, options: &SquaresOptions) -> Result<Squares, Error> {
    options::check(options.rel_width)?;
    let mut meter = options.meter();
    let (mut segments, mut found, mut complete) = (vec![], vec![], true);
    for segment in &spine.segments {
        if !meter.tick() {
            complete = false;
            break;
        }
        let Some(one) = Found::of(segment, options, &mut meter)? else {
            complete = false;
            break;
        };
        complete &= one.complete;
        segments.push(one.answer(segment));
        found.push(one);
    }
    complete &= meter.stopped.is_none();
    let mut answer = Squares { segments, complete, certificate: None, cells: meter.cells, stopped: meter.stopped };
    if options.certificate && answer.segments.len() == spine.segments.len() {
        answer.certificate = evidence::certificate(spine, &answer, &found, &meter);
    }
    Ok(answer)
}

/// What is known of one segment.
struct Found {
    roots: Vec<ComplexRoot>,
    count: u128,
    /// With the twists where they are known.
    list: Vec<(Choice, Coefficients, [Enclosure; 2])>,
    axes: Vec<Axis>,
    complete: bool,
}

impl Found {
    /// `None` if the meter ran out before the roots are known.
    fn of(segment: &Segment, options: &SquaresOptions, meter: &mut Meter) -> Result<Option<Self>, Error> {
        let square = Square::of(&segment.bezier);
        let Some(mut roots) = square.roots(meter)? else { return Ok(None) };
        let width = rational_from_f64(options.rel_width).unwrap_or_default();
        // a lower bound of the greatest root
        let size =
            roots.iter().map(|root| (root.re().abs().max(root.im().abs()) - root.radius()).max(Rational::zero()));
        // for twists as well
        let share =
            rational_from_f64(options.rel_width.min(1e-12)).unwrap_or_default() / Rational::from_integer(2.into());
        let narrow = size.max().unwrap_or_default() * share;
        for root in &mut roots {
            root.refine(&narrow);
        }
        let upper = |root: &&ComplexRoot| !is_real(root) && root.im().is_positive();
        let choices = Choices::new(roots.iter().filter(upper).map(ComplexRoot::multiplicity).collect());
        let count = choices.total();
        let twist = if options.limit > 0 { Twist::of(&segment.bezier, &roots, meter) } else { None };
        let listed = if count <= RANKED && twist.is_some() { usize::MAX } else { options.limit };
        let unknown = Enclosure { lo: 0.0, hi: f64::INFINITY };
        let with_twist = |choice: Choice| {
            let twists = twist.as_ref().map(|twist| twist.twists(&choice).map(|[lo, hi]| Enclosure { lo, hi }));
            (choice, twists.unwrap_or([unknown; 2]))
        };
        let mut ranked: Vec<(Choice, [Enclosure; 2])> = choices.take(listed).map(with_twist).collect();
        if twist.is_some() {
            let least = |twists: &[Enclosure; 2]| twists[0].lo.min(twists[1].lo);
            ranked.sort_by(|(_, a), (_, b)| least(a).total_cmp(&least(b)));
        }
        ranked.truncate(options.limit);
        let mut complete = twist.is_some() || options.limit == 0;
        let (mut list, mut bits, mut sharp) = (vec![], BITS.0, roots.clone());
        for (choice, twists) in ranked {
            if !meter.tick() {
                complete = false;
                break;
            }
            let mut coefficients = Coefficients::of(&square, &sharp, &choice, bits);
            while !coefficients.narrow(options.rel_width) && bits < BITS.1 {
                bits *= 2;
                sharpen(&mut sharp, bits);
                coefficients = Coefficients::of(&square, &sharp, &choice, bits);
            }
            complete &= coefficients.narrow(options.rel_width);
            // what overflows cannot be told
            if coefficients.finite() {
                list.push((choice, coefficients, twists));
            }
        }
        let mut found = Self { roots, count, list, axes: twist.map_or(vec![], |twist| twist.axes), complete };
        found.complete &= found.roots_narrow(&width);
        Ok(Some(found))
    }

    /// Is every root told to `width` times the greatest one?
    fn roots_narrow(&self, width: &Rational) -> bool {
        let boxes: Vec<[Enclosure; 2]> = self.roots.iter().map(enclosed).collect();
        let size = boxes.iter().flatten().map(|e| e.lo.max(-e.hi)).fold(0.0, f64::max);
        let limit = rational_from_f64(size).unwrap_or_default() * width * Rational::from_integer(2.into());
        let exact = |x: f64| rational_from_f64(x);
        boxes.iter().flatten().all(|e| match (exact(e.lo), exact(e.hi)) {
            (Some(lo), Some(hi)) => compare(&(hi - lo), &limit).is_le(),
            _ => false,
        })
    }

    fn answer(&self, segment: &Segment) -> SegmentSquares {
        let enclosures = |list: &[[f64; 2]]| list.iter().map(|&[lo, hi]| Enclosure { lo, hi }).collect();
        let decomposition = |(_, coefficients, twist): &(Choice, Coefficients, [Enclosure; 2])| Decomposition {
            alpha: enclosures(&coefficients.alpha),
            beta: enclosures(&coefficients.beta),
            twist: *twist,
        };
        let root = |root: &ComplexRoot| {
            let [re, im] = enclosed(root);
            SquareRoot { re, im, multiplicity: root.multiplicity() }
        };
        SegmentSquares {
            from: segment.from.clone(),
            to: segment.to.clone(),
            roots: self.roots.iter().map(root).filter(SquareRoot::is_finite).collect(),
            count: self.count,
            decompositions: self.list.iter().map(decomposition).collect(),
            axes: self.axes.clone(),
        }
    }
}

/// Disks far narrower than products with so many bits need them.
fn sharpen(roots: &mut [ComplexRoot], bits: u64) {
    let unit = Rational::new(1.into(), num_bigint::BigInt::from(1) << bits);
    for root in roots {
        let size = root.re().abs().max(root.im().abs());
        root.refine(&(size * &unit));
    }
}

impl SquareRoot {
    /// Else f64 cannot tell where it is.
    fn is_finite(&self) -> bool {
        [self.re, self.im].iter().all(|e| e.lo.is_finite() && e.hi.is_finite())
    }
}

fn enclosed(root: &ComplexRoot) -> [Enclosure; 2] {
    let around = |x: Rational| Enclosure::between(&(&x - root.radius()), &(&x + root.radius()));
    let im = if is_real(root) { Enclosure::ZERO } else { around(root.im()) };
    [around(root.re()), im]
}
