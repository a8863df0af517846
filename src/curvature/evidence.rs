//! From an answer to its certificate. Nothing here is trusted: a wrong cut is a rejection.

use super::{Arc, Curvature, Inner};
use crate::bernstein::{Form, dot};
use crate::certificate::{Certificate, Evidence, curvature::Course};
use crate::claim::{Bounds, Critical, CriticalPoints, Stretch};
use crate::integer::Int;
use crate::number::{lower_text, parse_rational, upper_text};
use crate::options::Enclosure;
use crate::roots::common_factor;
use crate::search::critical::{Bend, part};
use crate::search::dyadic::{Dyadic, step};
use crate::search::meter::Meter;
use crate::spine::Spine;
use num_traits::Signed;
use std::cmp::Ordering;

/// The most cuts of a span.
const MAX_CUTS: usize = 2_000;

/// The evidence for the answer as it is printed; `None` if it takes too many cuts, or the meter runs out.
pub(super) fn certificate(
    spine: &Spine,
    arcs: &[Arc],
    (span, t): (usize, Dyadic),
    answer: &Curvature,
    meter: &Meter,
) -> Option<Certificate> {
    let (mut cuts, mut factors) = (vec![], vec![]);
    for (k, (segment, arc)) in spine.segments.iter().zip(arcs).enumerate() {
        let bend = Bend::new(&segment.bezier);
        let mut span = Cuts::new(&bend, meter);
        span.all(arc)?;
        cuts.push(span.cuts.iter().map(Dyadic::rational).collect());
        if arc.inner.iter().any(|inner| inner.inflection && inner.zero.lo != inner.zero.hi) {
            factors.push((k, factor(&bend)));
        }
    }
    let course = Course { claim: claim(answer), cuts, factors, witness: (span, t.rational()) };
    Some(Certificate { digest: spine.curve().digest(), evidence: Evidence::Curvature(course) })
}

/// What the answer says, in the numbers that are printed.
fn claim(answer: &Curvature) -> CriticalPoints {
    let number = |text: String| parse_rational(&text).ok();
    let bounds = |e: &Enclosure| -> Bounds { [number(lower_text(e.lo)), number(upper_text(e.hi))] };
    let point = |p: &super::CriticalPoint| Critical {
        t: bounds(&p.t),
        kappa: bounds(&p.kappa),
        kind: p.kind,
        unique: p.unique,
    };
    let stretch = |s: &super::ConstantStretch| Stretch {
        from: number(upper_text(s.from)),
        to: number(lower_text(s.to)),
        kappa: bounds(&s.kappa),
    };
    CriticalPoints {
        kappa_max: bounds(&answer.kappa_max),
        at: bounds(&answer.at),
        points: answer.critical_points.iter().map(point).collect(),
        constant: answer.constant.iter().map(stretch).collect(),
    }
}

/// The common factor of the coordinates of b, as the coefficients of t^i (1-t)^(n-i), without zeros at 0 and 1.
fn factor(bend: &Bend) -> Vec<num_bigint::BigInt> {
    let b: Vec<Vec<Int>> = bend.b.iter().filter(|f| !f.is_zero()).map(Form::bernstein).collect();
    let g = Form::from_bernstein(&common_factor(&b)).c;
    let zeros = |c: &[Int]| c.iter().take_while(|c| c.is_zero()).count();
    let (start, reversed) = (zeros(&g), g.iter().rev().cloned().collect::<Vec<_>>());
    g[start..g.len() - zeros(&reversed)].iter().map(Int::big).collect()
}

/// The cuts of one span, in order as they are found.
struct Cuts<'a> {
    meter: &'a Meter,
    /// N times w^2, as the checker has it.
    form: Form<Int>,
    /// These must be positive on every cell.
    positive: [Form<Int>; 2],
    /// |a|^6 and |b|^2 w^6 in one degree.
    curvature: [Form<Int>; 2],
    cuts: Vec<Dyadic>,
}

impl<'a> Cuts<'a> {
    fn new(bend: &Bend, meter: &'a Meter) -> Self {
        let form = bend.critical().mul(&bend.w).mul(&bend.w);
        let (a, w) = (dot(&bend.a, &bend.a), bend.w.sqr().mul(&bend.w));
        let curvature = [a.sqr().mul(&a), dot(&bend.b, &bend.b).mul(&w.sqr())];
        Self { meter, form, positive: [bend.w.clone(), a], curvature, cuts: vec![] }
    }

    fn all(&mut self, arc: &Arc) -> Option<()> {
        let mut from = Dyadic::ZERO;
        for inner in &arc.inner {
            let (lo, hi) = (&inner.zero.lo, &inner.zero.hi);
            self.gap(&from, lo)?;
            self.push(lo);
            if lo != hi {
                self.around(inner)?;
                self.push(hi);
            }
            from = hi.clone();
        }
        self.gap(&from, &Dyadic::ONE)
    }

    /// The ends of the span and places that are there already are no cuts.
    fn push(&mut self, t: &Dyadic) {
        if t.cmp(self.cuts.last().unwrap_or(&Dyadic::ZERO)).is_gt() && t.cmp(&Dyadic::ONE).is_lt() {
            self.cuts.push(t.clone());
        }
    }

    fn changes(&self, lo: &Dyadic, hi: &Dyadic) -> usize {
        let form = part(&self.form, lo, hi);
        let signs: Vec<_> = form.c.iter().map(Int::sign).filter(|sign| sign.is_ne()).collect();
        signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
    }

    fn is_regular(&self, lo: &Dyadic, hi: &Dyadic) -> bool {
        self.positive.iter().all(|form| part(form, lo, hi).positive() == Some(true))
    }

    /// Cuts a stretch so that every cell `holds`.
    fn until(&mut self, lo: &Dyadic, hi: &Dyadic, holds: impl Fn(&Self, &Dyadic, &Dyadic) -> bool) -> Option<()> {
        let mut open = if lo == hi { vec![] } else { vec![(lo.clone(), hi.clone())] };
        while let Some((lo, hi)) = open.pop() {
            if holds(self, &lo, &hi) {
                self.push(&hi);
                continue;
            }
            if self.cuts.len() + open.len() > MAX_CUTS || self.meter.is_late() {
                return None;
            }
            let middle = lo.add(&hi).mul(&step(1));
            open.push((middle.clone(), hi));
            open.push((lo, middle));
        }
        Some(())
    }

    /// A stretch without zeros inside.
    fn gap(&mut self, lo: &Dyadic, hi: &Dyadic) -> Option<()> {
        self.until(lo, hi, |cuts, lo, hi| cuts.changes(lo, hi) == 0 && cuts.is_regular(lo, hi))
    }

    /// A stretch with zeros inside, a simple one alone in its cell; the cells that hold them have the curvature told.
    fn around(&mut self, inner: &Inner) -> Option<()> {
        let number = |text: String| parse_rational(&text).ok();
        let told = [number(lower_text(inner.kappa.lo)), number(upper_text(inner.kappa.hi))];
        // bound^2 |a|^6 - |b|^2 w^6, times a positive number
        let bounds = told.map(|bound| {
            let bound = bound.filter(|bound| bound.is_positive())?;
            let [num, den] = [bound.numer(), bound.denom()].map(|x| Form::from_bernstein(&[Int::from(x.pow(2))]));
            Some(self.curvature[0].mul(&num).sub(&self.curvature[1].mul(&den)))
        });
        let has = |form: &Option<Form<Int>>, lo: &Dyadic, hi: &Dyadic, sign: Ordering| {
            form.as_ref().is_some_and(|form| part(form, lo, hi).c.iter().any(|c| c.sign() == sign))
        };
        let most = if inner.zero.simple { 1 } else { usize::MAX };
        self.until(&inner.zero.lo, &inner.zero.hi, |cuts, lo, hi| {
            let changes = cuts.changes(lo, hi);
            let told = || !has(&bounds[0], lo, hi, Ordering::Greater) && !has(&bounds[1], lo, hi, Ordering::Less);
            changes <= most && cuts.is_regular(lo, hi) && (changes == 0 || inner.inflection || told())
        })
    }
}
