//! The command `curvature`.

use tubecert::claim::{Bounds, Critical, CriticalPoints, Stretch};
use tubecert::number::{lower_text, parse_rational, upper_text};
use tubecert::{Curvature, CurvatureOptions, Enclosure, Statement};

use super::args::CurvatureArgs;
use super::enclosed::{nearest, parameter_places, relation};
use super::job::Job;
use super::json::{self, E, raw};
use super::text::unit;
use super::{DONE, Said, UNDECIDED};
use serde_json::value::RawValue;

pub fn run(args: &CurvatureArgs) -> Said {
    answer(&Job::load(&args.common)?, args)
}

pub fn answer(job: &Job, args: &CurvatureArgs) -> Said {
    let common = &args.common;
    let options = CurvatureOptions::new()
        .rel_width(common.limits.rel_width)
        .certificate(common.certificate.is_some())
        .max_cells(common.limits.max_cells)
        .budget(job.budget())
        .progress(job.progress());
    let answer = job.done(tubecert::curvature(&job.spine, &options))?;
    job.certify(answer.certificate.as_ref(), Statement::Curvature(claimed(&answer)))?;
    let code = if answer.complete { DONE } else { UNDECIDED };
    let text = if common.json { as_json(job, &answer) } else { as_text(job, &answer) };
    Ok((text, code))
}

/// What is claimed by what will be printed.
fn claimed(answer: &Curvature) -> CriticalPoints {
    let number = |text: String| parse_rational(&text).ok();
    let bounds = |e: &Enclosure| -> Bounds { [number(lower_text(e.lo)), number(upper_text(e.hi))] };
    let points = answer.critical_points.iter().map(|point| Critical {
        t: bounds(&point.t),
        kappa: bounds(&point.kappa),
        kind: point.kind,
        unique: point.unique,
    });
    let constant = answer.constant.iter().map(|stretch| Stretch {
        from: number(upper_text(stretch.from)),
        to: number(lower_text(stretch.to)),
        kappa: bounds(&stretch.kappa),
    });
    CriticalPoints {
        kappa_max: bounds(&answer.kappa_max),
        at: bounds(&answer.at),
        points: points.collect(),
        constant: constant.collect(),
    }
}

#[derive(serde::Serialize)]
struct CurvatureData {
    kappa_max: E,
    at: E,
    critical_points: Vec<PointData>,
    constant: Vec<StretchData>,
    complete: bool,
}

#[derive(serde::Serialize)]
struct PointData {
    t: E,
    kappa: E,
    kind: Option<&'static str>,
    unique: bool,
}

#[derive(serde::Serialize)]
struct StretchData {
    from: Box<RawValue>,
    to: Box<RawValue>,
    kappa: E,
}

fn as_json(job: &Job, answer: &Curvature) -> String {
    let points = answer.critical_points.iter().map(|point| PointData {
        t: E(point.t),
        kappa: E(point.kappa),
        kind: point.kind.map(|kind| kind.word()),
        unique: point.unique,
    });
    let constant = answer.constant.iter().map(|stretch| StretchData {
        // inward: what is claimed lies in the segment
        from: raw(upper_text(stretch.from)),
        to: raw(lower_text(stretch.to)),
        kappa: E(stretch.kappa),
    });
    let data = CurvatureData {
        kappa_max: E(answer.kappa_max),
        at: E(answer.at),
        critical_points: points.collect(),
        constant: constant.collect(),
        complete: answer.complete,
    };
    json::answer("curvature", job.spine.curve(), data)
}

fn as_text(job: &Job, answer: &Curvature) -> String {
    let places = parameter_places(job.spine.curve());
    // rounded; the JSON encloses them
    let middle = |e: &Enclosure| nearest(e.lo.midpoint(e.hi), places);
    let kappa = relation(&answer.kappa_max);
    let mut lines = vec![format!("kappa_max {kappa}        (1 / {})", unit(job.spine.curve()))];
    if answer.kappa_max.hi > 0.0 {
        lines.push(format!("at t = {}", middle(&answer.at)));
    }
    lines.push(match answer.critical_points.len() {
        0 => "no critical point of curvature".to_string(),
        1 => "1 critical point of curvature".to_string(),
        n => format!("{n} critical points of curvature"),
    });
    for point in &answer.critical_points {
        let kind = point.kind.map_or("not decided", |kind| kind.word());
        let alone = if point.unique { "" } else { ", not proved to be one simple zero" };
        lines.push(format!("  t = {}: {kind}, kappa {}{alone}", middle(&point.t), relation(&point.kappa)));
    }
    for stretch in &answer.constant {
        let [from, to] = [stretch.from, stretch.to].map(|t| nearest(t, places));
        lines.push(format!("constant from t = {from} to {to}: kappa {}", relation(&stretch.kappa)));
    }
    if !answer.complete {
        let limit = job.limit(answer.stopped);
        lines.push(format!("help: what is printed is true all the same; to have it narrower or complete, {limit}"));
    }
    lines.join("\n") + "\n"
}
