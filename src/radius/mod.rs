//! The tube radius delta: options in, enclosure out (theory.md, sections 2 to 5).

mod answer;
mod evidence;

pub(crate) use evidence::tube;

pub use answer::{LimitedBy, Location, Radius, RadiusOptions, Rim, SpineEnd, Terms};

use crate::certificate::Upper;
use crate::error::Error;
use crate::integer::ldexp;
use crate::number::{Rational, f64_above, f64_below, rational_from_f64, same};
use crate::options::{self, Enclosure};
use crate::search::body;
use crate::search::contact::Touch;
use crate::search::curvature::{self, Peak};
use crate::search::ends::{self, Contact, Of};
use crate::search::frame::{At, Frame};
use crate::search::meter::Meter;
use crate::search::newton::{self, Candidate};
use crate::search::rims;
use crate::search::tree::Tree;
use crate::search::witness::{Exact, Witness};
use crate::spine::Spine;

/// Encloses delta, the largest radius for which the solid tube around the spine does not self-intersect
/// (theory.md, section 2): the thickness of a closed spine, and for an open one the same with its end disks.
///
/// Both bounds are proved. They never depend on the search having found anything: the search only makes them narrow.
///
/// # Errors
/// [`Option`](crate::ErrorKind::Option) for a width that is not a positive number, [`Rounding`](crate::ErrorKind::Rounding) if the processor does not
/// round as IEEE 754 says.
///
/// ```
/// use tubecert::{RadiusOptions, Spine, radius};
/// let parabola = Spine::from_json_str(r#"{"degree": 2, "control_points": [[-1, 1], [0, -1], [1, 1]]}"#)?;
/// let answer = radius(&parabola, &RadiusOptions::new())?;
/// assert!(answer.delta.lo <= 0.5 && 0.5 <= answer.delta.hi && answer.delta.is_within(1e-9));
/// # Ok::<(), tubecert::Error>(())
/// ```
pub fn radius(spine: &Spine, options: &RadiusOptions) -> Result<Radius, Error> {
    options::check(options.rel_width)?;
    let frame = Frame::new(spine);
    let job = || Job::new(&frame, options);
    let (mut answer, upper) = match &spine.corner {
        Some(corner) => job().corner(corner.joint),
        None if curvature::straight(&frame) => (straight(options), Upper::None),
        None => job().run(),
    };
    if options.certificate {
        answer.certificate = evidence::certificate(spine, &frame, &answer.delta, upper, margin(options));
    }
    Ok(answer)
}

fn straight(options: &RadiusOptions) -> Radius {
    let none = Enclosure::INFINITE;
    let terms = Terms { curvature: none, body_to_body: none, end_to_body: none, end_to_end: none };
    let rim = options.all_terms.then_some(Rim { end_to_body: none, end_to_end: none, delta: none });
    Radius {
        delta: none,
        limited_by: LimitedBy::None,
        also: vec![],
        closed: false,
        at: None,
        terms,
        rim,
        complete: true,
        certificate: None,
        cells: 0,
        stopped: None,
    }
}

/// The terms, other than the one that binds, whose enclosures meet that of delta.
fn meeting(terms: &Terms, delta: &Enclosure, limited_by: LimitedBy) -> Vec<LimitedBy> {
    let all = [
        (LimitedBy::Curvature, terms.curvature),
        (LimitedBy::BodyToBody, terms.body_to_body),
        (LimitedBy::EndToBody, terms.end_to_body),
        (LimitedBy::EndToEnd, terms.end_to_end),
    ];
    all.into_iter().filter(|(term, e)| *term != limited_by && e.meets(delta)).map(|(term, _)| term).collect()
}

fn rim_of(terms: &Terms, end_to_body: Enclosure, end_to_end: Enclosure) -> Rim {
    let all = [terms.curvature, terms.body_to_body, end_to_body, end_to_end];
    let least = |pick: fn(&Enclosure) -> f64| all.iter().map(pick).fold(f64::INFINITY, f64::min);
    Rim { end_to_body, end_to_end, delta: Enclosure { lo: least(|e| e.lo), hi: least(|e| e.hi) } }
}

/// The share below a candidate at which the lower bound is tried.
fn margin(options: &RadiusOptions) -> f64 {
    0.39 * options.rel_width
}

struct Job<'a> {
    frame: &'a Frame,
    options: &'a RadiusOptions,
    tree: Tree<'a>,
    exact: Exact<'a>,
    meter: Meter,
    margin: f64,
}

/// An upper bound found for delta, in the unit box.
#[derive(Debug, Clone)]
struct Bound {
    term: LimitedBy,
    witness: Witness,
    end: Option<SpineEnd>,
}

impl<'a> Job<'a> {
    fn new(frame: &'a Frame, options: &'a RadiusOptions) -> Self {
        Self {
            frame,
            options,
            tree: Tree::new(frame),
            exact: Exact::new(frame),
            meter: options.meter(),
            margin: margin(options),
        }
    }

    fn run(mut self) -> (Radius, Upper) {
        let (bend, peak) = curvature::curvature(&mut self.exact, 0.5 * self.margin, &mut self.meter);
        // searches start a little above what binds already: a term that ties is met, one that does not is proved above
        let a_little = 1.0 + 1.6 * self.options.rel_width;
        let body = body::body_to_body(&mut self.tree, bend * a_little, self.margin, &mut self.meter);
        let contact = body.candidate.filter(|_| body.radius < 1e-12);
        if let Some(touch) = contact.and_then(|pair| self.exact.self_contact(&pair)) {
            return self.touching(bend, peak, touch);
        }
        let before_ends = bend.min(body.radius);
        let mut ends = f64::INFINITY;
        let mut contacts: Vec<Contact> = body.candidate.and_then(|pair| self.end_contact(&pair)).into_iter().collect();
        if !self.frame.closed {
            for finish in [false, true] {
                let start = before_ends.min(ends);
                let (mut proved, contact) = self.end_to_body(finish, Of::Disks, start * a_little, false);
                contacts.extend(contact);
                if proved < start && contact.is_none() {
                    proved = self.end_to_body(finish, Of::Disks, start, false).0;
                }
                ends = ends.min(proved);
            }
        }
        let radius = before_ends.min(ends);
        let curved = peak.and_then(|peak| self.exact.curved(&peak));
        let ceiling = curved.as_ref().map_or(f64::INFINITY, |w| w.radius);
        let mut uppers: Vec<Bound> = vec![];
        for contact in contacts.iter().filter(|c| c.radius < ceiling) {
            let witness = self.exact.disks(contact).into_iter().chain(self.exact.end_valley(contact));
            let Some(witness) = witness.min_by(|a, b| a.radius.total_cmp(&b.radius)) else { continue };
            let term = self.term(contact);
            let end = Some(if contact.finish { SpineEnd::Finish } else { SpineEnd::Start });
            uppers.push(Bound { term, witness, end });
        }
        if let Some(pair) = body.candidate.filter(|c| c.radius < ceiling * (1.0 - 1e-12)) {
            let witness = self.exact.valleys(&pair);
            uppers.extend(witness.map(|witness| Bound { term: LimitedBy::BodyToBody, witness, end: None }));
        }
        uppers.extend(curved.map(|witness| Bound { term: LimitedBy::Curvature, witness, end: None }));
        // of witnesses that tie within what is asked, the last: curvature, then body to body
        let least = uppers.iter().map(|u| u.witness.radius).fold(f64::INFINITY, f64::min);
        let best = uppers.iter().rfind(|u| u.witness.radius <= least * (1.0 + self.margin));
        let above = best.map_or(f64::INFINITY, |u| u.witness.radius);
        let delta = self.enclosure(radius, above);

        let mut terms = Terms {
            curvature: self.enclosure(bend, ceiling),
            body_to_body: self.enclosure(body.radius, f64::INFINITY),
            end_to_body: Enclosure::INFINITE,
            end_to_end: Enclosure::INFINITE,
        };
        if !self.frame.closed {
            // below 1/kappa_max no contact of disks is local
            let hi = |term| {
                let of_term = uppers.iter().filter(|u| u.term == term && u.witness.radius < bend);
                of_term.map(|u| u.witness.radius).fold(f64::INFINITY, f64::min)
            };
            terms.end_to_body = self.enclosure(ends, hi(LimitedBy::EndToBody));
            let met = self.exact.meeting(&self.exact.end(false), &self.exact.end(true), Of::Disks);
            let lo = met.map_or(f64::INFINITY, |(lo, _)| lo);
            terms.end_to_end = self.enclosure(lo, hi(LimitedBy::EndToEnd));
        }
        let width = self.options.rel_width;
        let narrow = delta.is_within(width);
        let mut complete = narrow;
        let mut rim = None;
        if let Some(pair) = body.candidate.filter(|pair| pair.radius * (1.0 - width) <= above) {
            terms.body_to_body.hi = self.body_above(&pair, best.filter(|u| u.witness.radius < bend.min(ends)));
        }
        if self.options.all_terms {
            complete &= self.all_terms(&mut terms, &mut rim);
        }
        let limited_by = best.filter(|_| narrow).map_or(LimitedBy::Undecided, |u| u.term);
        let wanted = best.filter(|_| self.options.certificate && delta.hi.is_finite());
        let upper = wanted.map_or(Upper::None, |u| u.witness.upper(self.frame));
        let answer = Radius {
            delta,
            limited_by,
            also: meeting(&terms, &delta, limited_by),
            closed: self.frame.closed,
            at: best.map(|u| self.location(&u.witness, u.end)),
            terms,
            rim,
            complete,
            certificate: None,
            cells: self.meter.cells,
            stopped: self.meter.stopped,
        };
        (answer, upper)
    }

    /// delta = 0 for a corner: the theory of the other terms does not hold across it.
    fn corner(mut self, joint: usize) -> (Radius, Upper) {
        let open = Enclosure { lo: 0.0, hi: f64::INFINITY };
        let curvature = if !self.options.all_terms {
            open
        } else if curvature::straight(self.frame) {
            Enclosure::INFINITE
        } else {
            let (bend, peak) = curvature::curvature(&mut self.exact, 0.5 * self.margin, &mut self.meter);
            self.curvature_term(bend, peak)
        };
        let rim = self.options.all_terms.then_some(Rim { end_to_body: open, end_to_end: open, delta: Enclosure::ZERO });
        let complete = !self.options.all_terms || curvature.is_within(self.options.rel_width);
        let terms = Terms { curvature, body_to_body: open, end_to_body: open, end_to_end: open };
        let at = Location { s: None, t: Enclosure::of(&self.frame.knots[joint]), x: None, end: None };
        (self.nothing(LimitedBy::Corner, at, terms, rim, complete), Upper::Corner(joint))
    }

    /// delta = 0 for a proved self-contact, which is a doubly critical pair at the distance 0.
    fn touching(mut self, bend: f64, peak: Option<Peak>, touch: Touch) -> (Radius, Upper) {
        let curvature = self.curvature_term(bend, peak);
        let ends = if self.frame.closed { Enclosure::INFINITE } else { Enclosure { lo: 0.0, hi: f64::INFINITY } };
        let mut terms = Terms { curvature, body_to_body: Enclosure::ZERO, end_to_body: ends, end_to_end: ends };
        let outer = [self.exact.end(false), self.exact.end(true)];
        let joints = 0..self.frame.segments.len();
        let mut returns =
            |end: &At| joints.clone().any(|k| self.exact.is_at(end, (k, 0.0)) || self.exact.is_at(end, (k, 1.0)));
        let touched = touch.s.iter().chain(&touch.t).any(|at| outer.contains(at));
        if !self.frame.closed && (touched || outer.iter().any(&mut returns)) {
            // rho(e, t) = 0, and the rims about one centre meet at every radius
            terms.end_to_body = Enclosure::ZERO;
        }
        let mut rim = None;
        let complete = !self.options.all_terms || self.all_terms(&mut terms, &mut rim);
        let at = self.touch_location(&touch);
        (self.nothing(LimitedBy::SelfContact, at, terms, rim, complete), touch.upper)
    }

    fn nothing(self, limited_by: LimitedBy, at: Location, terms: Terms, rim: Option<Rim>, complete: bool) -> Radius {
        Radius {
            delta: Enclosure::ZERO,
            limited_by,
            also: meeting(&terms, &Enclosure::ZERO, limited_by),
            closed: self.frame.closed,
            at: Some(at),
            terms,
            rim,
            complete,
            certificate: None,
            cells: self.meter.cells,
            stopped: self.meter.stopped,
        }
    }

    fn curvature_term(&mut self, bend: f64, peak: Option<Peak>) -> Enclosure {
        let above = peak.and_then(|peak| self.exact.curved(&peak)).map_or(f64::INFINITY, |w| w.radius);
        self.enclosure(bend, above)
    }

    fn end_to_body(&mut self, finish: bool, of: Of, start: f64, own_term: bool) -> (f64, Option<Contact>) {
        ends::end_to_body(&mut self.tree, finish, of, start, own_term, self.margin, &mut self.meter)
    }

    /// A doubly critical pair at an end of an open spine is a contact of that end's disk.
    fn end_contact(&self, pair: &Candidate) -> Option<Contact> {
        let last = self.frame.segments.len() - 1;
        let finish = |(segment, t): (usize, f64)| match (segment, t) {
            (0, t) if t < 1e-9 => Some(false),
            (segment, t) if segment == last && t > 1.0 - 1e-9 => Some(true),
            _ => None,
        };
        if self.frame.closed {
            return None;
        }
        let (side, mut t) = finish(pair.s).map(|side| (side, pair.t)).or(finish(pair.t).map(|side| (side, pair.s)))?;
        if let Some(other) = finish(t) {
            t.1 = f64::from(u8::from(other));
        }
        Some(Contact { finish: side, t, radius: pair.radius })
    }

    /// Is the contact with the other end, or with the body?
    fn term(&self, contact: &Contact) -> LimitedBy {
        let other = self.exact.end(!contact.finish);
        let same = contact.t.0 == other.segment && contact.t.1 == f64::from(u8::from(!contact.finish));
        if same { LimitedBy::EndToEnd } else { LimitedBy::EndToBody }
    }

    /// Encloses every term by a search of its own, whatever binds; says whether all became as narrow as they can.
    fn all_terms(&mut self, terms: &mut Terms, rim: &mut Option<Rim>) -> bool {
        let width = self.options.rel_width;
        if terms.body_to_body.hi > 0.0 {
            let body = body::body_to_body(&mut self.tree, f64::INFINITY, self.margin, &mut self.meter);
            let hi = body.candidate.map_or(f64::INFINITY, |pair| self.body_above(&pair, None));
            let found = Enclosure { lo: self.enclosure(body.radius, f64::INFINITY).lo, hi };
            terms.body_to_body = terms.body_to_body.and(&found);
        }
        let mut complete = terms.body_to_body.is_within(width);
        if self.frame.closed || rims::all_local(self.frame) {
            // no end, or no pair with an end that is not local
            (terms.end_to_body, terms.end_to_end) = (Enclosure::INFINITE, Enclosure::INFINITE);
            *rim = Some(rim_of(terms, Enclosure::INFINITE, Enclosure::INFINITE));
            return complete;
        }
        let (start, finish) = (self.exact.end(false), self.exact.end(true));
        let not_local = self.exact.not_local(&start, &finish);
        let [of_disks, of_rims] = [Of::Disks, Of::Rims].map(|of| self.exact.meeting(&start, &finish, of));
        let mut all_local = false;
        let on_body = terms.end_to_body.hi == 0.0;
        let mut both = |of: Of, ends: Option<(f64, f64)>| {
            if on_body {
                return Enclosure::ZERO;
            }
            // the other end is a point of the body; there rims that meet on a line say nothing about those nearby
            let ends = ends.filter(|_| not_local);
            let (mut lo, mut hi) =
                ends.map_or((f64::INFINITY, f64::INFINITY), |(lo, hi)| (lo * (1.0 - self.margin), hi));
            let mut met = true;
            for side in [false, true] {
                let (proved, contact) = self.end_to_body(side, of, lo.min(1e9), true);
                // then the pair of both ends is local as well
                all_local |= proved == f64::INFINITY;
                // of the two ends that with the least value: it is a contact, or at the frontier of its local pairs
                if proved < lo {
                    lo = proved;
                    hi = contact.and_then(|c| self.contact_above(&c, of)).unwrap_or(f64::INFINITY);
                    met = contact.is_some();
                }
            }
            let term = self.enclosure(lo, hi);
            // without a bound above: the least value is at the frontier of the local pairs
            let frontier = hi == f64::INFINITY && (met || of == Of::Rims);
            complete &= term.is_within(width) || (frontier && self.meter.stopped.is_none());
            term
        };
        terms.end_to_body = terms.end_to_body.and(&both(Of::Disks, of_disks));
        let rim_body = both(Of::Rims, of_rims);
        let both_ends = |met: Option<(f64, f64)>| {
            let (lo, hi) = met.filter(|_| !all_local).unwrap_or((f64::INFINITY, f64::INFINITY));
            // a pair that may be local or not has this value or none
            self.enclosure(lo, if not_local { hi } else { f64::INFINITY })
        };
        terms.end_to_end = both_ends(of_disks);
        let rim_ends = both_ends(of_rims);
        complete &= terms.end_to_end.is_within(width) && rim_ends.is_within(width);
        *rim = Some(rim_of(terms, rim_body, rim_ends));
        complete
    }

    /// An upper bound for an end term: the contact is exact, and its pair is not local.
    fn contact_above(&mut self, contact: &Contact, of: Of) -> Option<f64> {
        let end = self.exact.end(contact.finish);
        if self.exact.is_at(&end, contact.t) {
            return Some(0.0);
        }
        let at = At::near(contact.t);
        if !self.exact.not_local(&end, &at) {
            return None;
        }
        match of {
            Of::Disks => {
                // where the planes are parallel at an irrational t alone, a valley: all of it is as far along the spine
                let valley = self.exact.end_valley(contact).filter(|valley| {
                    let near = valley.valley_end(self.frame, contact.finish);
                    near.is_some_and(|near| self.exact.not_local(&end, &near))
                });
                self.exact.disks(contact).into_iter().chain(valley).map(|w| w.radius).min_by(f64::total_cmp)
            }
            Of::Rims => self.exact.planar_rims(contact).or_else(|| Some(self.exact.meeting(&end, &at, Of::Rims)?.1)),
        }
    }

    /// An upper bound for the body term: a doubly critical pair is proved to exist near the candidate.
    fn body_above(&mut self, pair: &Candidate, best: Option<&Bound>) -> f64 {
        // a valley below all other terms can be nothing else
        if let Some(upper) = best.filter(|u| u.term == LimitedBy::BodyToBody) {
            return self.enclosure(0.0, upper.witness.radius).hi;
        }
        let above = self.exact.critical_box(pair).or_else(|| {
            // of a family of pairs, one at simple parameters: the ends of two strands among them
            let ends = Candidate { s: (0, 0.0), t: (self.frame.segments.len() - 1, 1.0), radius: pair.radius };
            let mut members = std::iter::once(*pair).chain(newton::snapped(&self.tree, pair)).chain([ends]);
            members.find_map(|pair| self.exact.exactly_critical(&pair))
        });
        self.enclosure(0.0, above.unwrap_or(f64::INFINITY)).hi
    }

    /// From the unit box to the curve's unit, outward.
    fn enclosure(&self, lo: f64, hi: f64) -> Enclosure {
        let scaled = |x: f64, round: fn(&Rational) -> f64| {
            let near = ldexp(x, -self.frame.scale);
            // then exact; or an infinity
            if near.is_normal() || !x.is_finite() {
                return near;
            }
            rational_from_f64(x).map_or(x, |x| round(&self.frame.length(&x)))
        };
        Enclosure { lo: scaled(lo, f64_below), hi: scaled(hi, f64_above) }
    }

    /// A seam parameter is given as the start.
    fn parameter(&self, at: &At) -> Enclosure {
        let t = self.frame.parameter(at);
        let last = self.frame.closed && self.frame.knots.last().is_some_and(|end| same(&t, end));
        Enclosure::of(if last { &self.frame.knots[0] } else { &t })
    }

    fn touch_location(&self, touch: &Touch) -> Location {
        let between = |[from, to]: &[At; 2]| {
            if from == to {
                return self.parameter(from);
            }
            let (mut low, high) = (self.frame.parameter(from), self.frame.parameter(to));
            if from.segment > to.segment || (from.segment == to.segment && from.t.cmp(&to.t).is_gt()) {
                // across the closure: round the start, from below it
                low += &self.frame.knots[0] - &self.frame.knots[self.frame.segments.len()];
            }
            Enclosure { lo: f64_below(&low), hi: f64_above(&high) }
        };
        let x = touch.points.as_ref().map(|points| {
            let points: Vec<_> = points.iter().map(|x| self.frame.point(x)).collect();
            [0, 1, 2].map(|k| Enclosure {
                lo: points.iter().map(|x| f64_below(&x[k])).fold(f64::INFINITY, f64::min),
                hi: points.iter().map(|x| f64_above(&x[k])).fold(f64::NEG_INFINITY, f64::max),
            })
        });
        Location { s: Some(between(&touch.s)), t: between(&touch.t), x, end: None }
    }

    fn location(&self, witness: &Witness, end: Option<SpineEnd>) -> Location {
        let parameter = |at: &At| self.parameter(at);
        Location {
            s: witness.s.as_ref().map(parameter),
            t: parameter(&witness.t),
            x: witness.x.as_ref().map(|x| self.frame.point(x).each_ref().map(Enclosure::of)),
            end,
        }
    }
}
