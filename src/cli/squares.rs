//! The command `squares`.

use serde_json::value::RawValue;
use tubecert::claim::{self, RootBox, TwoSquares};
use tubecert::number::{exact_text, lower_text, parse_rational, upper_text};
use tubecert::{Axis, Enclosure, Rational, SegmentSquares, Squares, SquaresOptions, Statement};

use super::args::SquaresArgs;
use super::enclosed::near;
use super::job::Job;
use super::json::{self, E, rational};
use super::text::unit;
use super::{DONE, Said, UNDECIDED};

pub fn run(args: &SquaresArgs) -> Said {
    let common = &args.common;
    let job = Job::load(common)?;
    let options = SquaresOptions::new()
        .rel_width(common.limits.rel_width)
        .limit(args.limit)
        .certificate(common.certificate.is_some())
        .max_cells(common.limits.max_cells)
        .budget(job.budget())
        .progress(job.progress());
    let answer = job.done(tubecert::squares(&job.spine, &options))?;
    job.certify(answer.certificate.as_ref(), Statement::Squares(answer.segments.iter().map(claimed).collect()))?;
    let code = if answer.complete { DONE } else { UNDECIDED };
    let text = if common.json { as_json(&job, &answer) } else { as_text(&job, &answer) };
    Ok((text, code))
}

/// What is claimed by what will be printed.
fn claimed(segment: &SegmentSquares) -> claim::Squares {
    // what is not finite is not listed
    let number = |text: String| parse_rational(&text).unwrap_or_default();
    let range = |e: &Enclosure| [number(lower_text(e.lo)), number(upper_text(e.hi))];
    let all = |list: &[Enclosure]| list.iter().map(range).collect();
    let roots = segment.roots.iter();
    let roots = roots.map(|root| RootBox { re: range(&root.re), im: range(&root.im), multiplicity: root.multiplicity });
    let decompositions = segment.decompositions.iter();
    let decompositions = decompositions.map(|two| TwoSquares { alpha: all(&two.alpha), beta: all(&two.beta) });
    let (from, to) = (segment.from.clone(), segment.to.clone());
    claim::Squares { from, to, roots: roots.collect(), count: segment.count, decompositions: decompositions.collect() }
}

#[derive(serde::Serialize)]
struct SquaresData {
    segments: Vec<SegmentData>,
    complete: bool,
}

#[derive(serde::Serialize)]
struct SegmentData {
    from: Box<RawValue>,
    to: Box<RawValue>,
    roots: Vec<RootData>,
    count: Box<RawValue>,
    decompositions: Vec<DecompositionData>,
    axes: Vec<AxisData>,
}

/// On this part of the segment's parameter twists are about this axis.
#[derive(serde::Serialize)]
struct AxisData {
    from: f64,
    to: f64,
    axis: [i64; 3],
}

#[derive(serde::Serialize)]
struct RootData {
    re: E,
    im: E,
    multiplicity: usize,
}

#[derive(serde::Serialize)]
struct DecompositionData {
    alpha: Vec<E>,
    beta: Vec<E>,
    twist: [E; 2],
}

fn as_json(job: &Job, answer: &Squares) -> String {
    let all = |list: &[Enclosure]| list.iter().copied().map(E).collect();
    let segment = |segment: &SegmentSquares| {
        let roots = segment.roots.iter();
        let roots = roots.map(|root| RootData { re: E(root.re), im: E(root.im), multiplicity: root.multiplicity });
        let decompositions = segment.decompositions.iter().map(|two| DecompositionData {
            alpha: all(&two.alpha),
            beta: all(&two.beta),
            twist: two.twist.map(E),
        });
        SegmentData {
            from: rational(&segment.from),
            to: rational(&segment.to),
            roots: roots.collect(),
            count: json::raw(segment.count.to_string()),
            decompositions: decompositions.collect(),
            axes: segment.axes.iter().map(|&Axis { from, to, axis, .. }| AxisData { from, to, axis }).collect(),
        }
    };
    let segments = answer.segments.iter().map(segment).collect();
    json::answer("squares", job.spine.curve(), SquaresData { segments, complete: answer.complete })
}

fn as_text(job: &Job, answer: &Squares) -> String {
    let mut lines = vec![];
    for (number, segment) in answer.segments.iter().enumerate() {
        let SegmentSquares { roots, count, decompositions, .. } = segment;
        let [from, to] = [&segment.from, &segment.to].map(|x: &Rational| exact_text(x));
        let listed = if *count == decompositions.len() as u128 {
            String::new()
        } else {
            format!(", {} of them listed", decompositions.len())
        };
        let ways = if *count == 1 { "1 way".to_string() } else { format!("{count} ways") };
        lines.push(format!(
            "segment {number}, t = {from} .. {to}: {} = alpha^2 + beta^2 in {ways}{listed}        ({})",
            if job.spine.curve().weights().windows(2).all(|w| w[0] == w[1]) {
                "|C'|^2"
            } else {
                "|C'|^2 w^4, w = 1 at its start,"
            },
            unit(job.spine.curve())
        ));
        for root in roots {
            let im = if root.im.hi == 0.0 && root.im.lo == 0.0 { None } else { Some(near(&root.im, 10)) };
            let im = im.map_or(String::new(), |im| format!("{}{im} i", if im.starts_with('-') { " " } else { " +" }));
            let times = if root.multiplicity == 1 { String::new() } else { format!(", {} times", root.multiplicity) };
            lines.push(format!("  root {}{im}{times}", near(&root.re, 10)));
        }
        for two in decompositions {
            let list = |all: &[Enclosure]| all.iter().map(|e| near(e, 10)).collect::<Vec<_>>().join(", ");
            lines.push(format!("  alpha = [{}], beta = [{}]", list(&two.alpha), list(&two.beta)));
            let twist = |e: &Enclosure| {
                if e.hi.is_finite() { near(e, 5) } else { "unknown".to_string() }
            };
            lines.push(format!("    twist {} and, with -beta, {}", twist(&two.twist[0]), twist(&two.twist[1])));
        }
    }
    if !answer.segments.is_empty() {
        lines.push("coefficients by rising powers of the segment's own parameter in 0 .. 1".to_string());
    }
    if !answer.complete {
        let limit = job.limit(answer.stopped);
        lines.push(format!(
            "help: what is printed is true all the same, but not all is known or as narrow as asked; {limit}, or a twist is unknown"
        ));
    }
    lines.join("\n") + "\n"
}
