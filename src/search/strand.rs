//! Short stretches of the spine, exactly, also across a joint.

use super::dyadic::Dyadic;
use super::frame::{At, ExactForms, Frame};
use crate::bernstein::{Form, Vec3};
use crate::enclosure::Interval;
use crate::integer::Int;
use crate::spine::{Bezier, same_direction};

/// A short stretch of the spine, cut where it steps over a joint. The homogeneous points of the arcs agree at the joint,
/// and their hodographs times `pace` too, so that D, D.a(s) and D.a(t) are continuous across it.
pub(crate) struct Strand {
    pub(crate) ends: [At; 2],
    pub(crate) arcs: Vec<Bezier>,
    pub(crate) pace: Vec<Int>,
}

impl Strand {
    /// The lengths of the arcs in the parameter.
    pub(crate) fn sizes(&self) -> Vec<Interval> {
        let [from, to] = self.ends.each_ref().map(|at| &at.t);
        let near = |x: Dyadic| {
            let x = x.m.to_f64_shifted(-x.e);
            Interval::new(x.next_down(), x.next_up())
        };
        match self.arcs.len() {
            1 => vec![near(to.sub(from))],
            _ => vec![near(Dyadic::ONE.sub(from)), near(to.clone())],
        }
    }
}

/// The exact arcs of a stretch of less than one segment, from a parameter that may be below 0 to one that may be above 1:
/// across a joint or the closure then; `None` beyond an end of an open spine, or across a corner.
pub(crate) fn strand(frame: &Frame, segment: usize, from: &Dyadic, to: &Dyadic) -> Option<Strand> {
    let at = |t: &Dyadic| frame.step(&At { segment, t: Dyadic::ZERO }, t);
    let ends = [at(from)?, at(to)?];
    let cut = |segment: usize, from: &Dyadic, to: &Dyadic| frame.segments[segment].arc(from, to);
    if from.m.sign().is_ge() && to.cmp(&Dyadic::ONE).is_le() {
        return Some(Strand { ends, arcs: vec![cut(segment, from, to)], pace: vec![Int::ONE] });
    }
    let before = cut(ends[0].segment, &ends[0].t, &Dyadic::ONE);
    let after = cut(ends[1].segment, &Dyadic::ZERO, &ends[1].t);
    let (last, first) = (before.weight(before.degree()).clone(), after.weight(0).clone());
    let arcs = vec![times(before, &first), times(after, &last)];
    let (u, v) = (arcs[0].end_tangent(true), arcs[1].end_tangent(false));
    if !same_direction(&u, &v) {
        return None;
    }
    let along = (0..3).find(|&k| !u[k].is_zero())?;
    // end tangents are a(1) / n and a(0) / n
    let [m, n] = [&arcs[0], &arcs[1]].map(|arc| Int::from(arc.degree() as i64));
    let pace = vec![&v[along].abs() * &n, &u[along].abs() * &m];
    Some(Strand { ends, arcs, pace })
}

/// The same, but beyond an end of an open spine its last polynomial goes on.
pub(crate) fn strand_beyond(frame: &Frame, segment: usize, from: &Dyadic, to: &Dyadic) -> Option<Strand> {
    strand(frame, segment, from, to).or_else(|| {
        let beyond = |k: usize, out: bool| !frame.closed && segment == k && out;
        let out = beyond(0, from.m.sign().is_lt()) || beyond(frame.segments.len() - 1, to.cmp(&Dyadic::ONE).is_gt());
        // one joint at the other end would be passed as well
        let inside = beyond(0, true) || from.m.sign().is_ge();
        let inside = inside && (beyond(frame.segments.len() - 1, true) || to.cmp(&Dyadic::ONE).is_le());
        (out && inside).then(|| {
            let ends = [from, to].map(|t| At { segment, t: t.clone() });
            Strand { ends, arcs: vec![frame.segments[segment].arc(from, to)], pace: vec![Int::ONE] }
        })
    })
}

fn times(mut arc: Bezier, factor: &Int) -> Bezier {
    for c in arc.x.iter_mut().flatten().chain(&mut arc.w) {
        *c = &*c * factor;
    }
    arc
}

/// A map of two components on every pair of arcs of two strands, from D, a(s) and a(t): continuous across the joints.
pub(crate) fn over(
    x: &Strand,
    y: &Strand,
    map: impl Fn(&Vec3<Int>, &Vec3<Int>, &Vec3<Int>) -> [Form<Int>; 2],
) -> Vec<Vec<[Form<Int>; 2]>> {
    let forms = |strand: &Strand, other: bool| -> Vec<ExactForms> {
        let paced = |(arc, pace): (&Bezier, &Int)| {
            let forms = if other { arc.forms().transposed() } else { arc.forms() };
            let factor = Form::from_bernstein(std::slice::from_ref(pace));
            ExactForms { a: forms.a.map(|a| a.mul(&factor)), ..forms }
        };
        strand.arcs.iter().zip(&strand.pace).map(paced).collect()
    };
    let (xs, ys) = (forms(x, false), forms(y, true));
    let pair = |fx: &ExactForms, fy: &ExactForms| map(&fx.difference(fy), &fx.a, &fy.a);
    xs.iter().map(|fx| ys.iter().map(|fy| pair(fx, fy)).collect()).collect()
}
