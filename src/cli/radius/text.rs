//! The human text of a radius: the number first, then why, then where, then what it means.

use tubecert::number::{f64_above, f64_below};
use tubecert::{Enclosure, LimitedBy, Location, Radius, Spine, SpineEnd};

use crate::cli::args::RadiusArgs;
use crate::cli::enclosed::{bounds, nearest, parameter_places, relation};
use crate::cli::job::Job;
use crate::cli::text::unit;

pub fn radius(job: &Job, answer: &Radius, args: &RadiusArgs) -> String {
    let (spine, delta) = (&job.spine, &answer.delta);
    let mut lines = vec![format!("delta {}        ({})", relation(delta), unit(spine.curve())), why(spine, answer)];
    if !answer.also.is_empty() && answer.delta.hi > 0.0 {
        let also: Vec<String> = answer.also.iter().copied().map(words).collect();
        lines.push(format!("also within these bounds: {}", also.join(", ")));
    }
    lines.push(if delta.lo == f64::INFINITY {
        "every radius is proved free of self-intersection".to_string()
    } else if delta.hi == 0.0 {
        "no positive radius is free of self-intersection".to_string()
    } else if delta.lo == 0.0 {
        "no radius is proved free of self-intersection".to_string()
    } else {
        format!("every radius below {} is proved free of self-intersection", bounds(delta).0)
    });
    if !answer.complete && delta.hi.is_finite() {
        lines.push(format!("every radius above {} is proved to self-intersect", bounds(delta).1));
    }
    if answer.closed {
        lines.push("the spine is closed: it has no end disks".to_string());
    }
    if args.terms.all_terms {
        terms(&mut lines, answer);
    }
    if !answer.complete {
        lines.push(format!("help: {}", advice(job, answer)));
    }
    lines.join("\n") + "\n"
}

fn why(spine: &Spine, answer: &Radius) -> String {
    let place = answer.at.as_ref().map(|at| place(spine, answer.limited_by, at));
    match (answer.limited_by, place) {
        (LimitedBy::None, _) => "limited by nothing: the spine is straight".to_string(),
        (LimitedBy::Undecided, Some(place)) => format!("undecided: wider than asked; the upper bound: {place}"),
        (LimitedBy::Undecided, None) => "undecided: wider than asked; no upper bound is at hand".to_string(),
        (term, Some(place)) => format!("limited by {}: {place}", words(term)),
        (term, None) => format!("limited by {}, at a place too far out to print", words(term)),
    }
}

/// What happens where. Parameters are rounded, to a millionth of the domain or finer; the JSON encloses them.
fn place(spine: &Spine, term: LimitedBy, at: &Location) -> String {
    let (start, _) = spine.curve().domain();
    let places = parameter_places(spine.curve());
    let named = |name: &str, e: &Enclosure| format!("{name} = {}", nearest(e.lo, places));
    let t = named("t", &at.t);
    let at_start = at.t == Enclosure { lo: f64_below(start), hi: f64_above(start) };
    match (term, at.end, &at.s) {
        (LimitedBy::Corner, ..) if at_start => format!("the ends meet, at {t}, without a common tangent"),
        (LimitedBy::Corner, ..) => format!("the tangent jumps at {t}"),
        (LimitedBy::SelfContact, _, Some(s)) => format!("the spine touches itself at {} and {t}", named("s", s)),
        (LimitedBy::EndToEnd, ..) => "the start disk meets the finish disk".to_string(),
        (_, Some(SpineEnd::Start), _) => format!("the start disk meets the body at {t}"),
        (_, Some(SpineEnd::Finish), _) => format!("the finish disk meets the body at {t}"),
        (_, None, Some(s)) => format!("the disks at {} and {t} meet", named("s", s)),
        (_, None, None) => format!("the radius of curvature at {t}"),
    }
}

fn terms(lines: &mut Vec<String>, answer: &Radius) {
    let row = |(name, e): (&str, Enclosure)| format!("  {name:<14}{}", relation(&e));
    let terms = &answer.terms;
    lines.push("terms:".to_string());
    lines.extend(
        [
            ("curvature", terms.curvature),
            ("body to body", terms.body_to_body),
            ("end to body", terms.end_to_body),
            ("end to end", terms.end_to_end),
        ]
        .map(row),
    );
    if let Some(rim) = &answer.rim {
        lines.push("where only the rims of the disks count (Theorem 3.1 of Maekawa et al. 1998):".to_string());
        lines.extend(
            [("end to body", rim.end_to_body), ("end to end", rim.end_to_end), ("least of all", rim.delta)].map(row),
        );
    }
}

fn advice(job: &Job, answer: &Radius) -> String {
    if answer.stopped.is_none() && answer.delta.lo == 0.0 && answer.delta.hi > 0.0 && answer.delta.hi.is_finite() {
        return "neither a self-contact nor a gap could be proved; see whether the spine is meant to touch itself"
            .into();
    }
    format!("what is printed is true all the same; to have it narrower or complete, {}", job.limit(answer.stopped))
}

fn words(term: LimitedBy) -> String {
    term.word().replace('_', " ")
}
