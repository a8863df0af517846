//! The command `polyline`.

use std::path::Path;

use serde_json::value::RawValue;
use tubecert::number::nearest_text;
use tubecert::{ErrorKind, Polyline, PolylineOptions, Statement};

use super::args::PolylineArgs;
use super::enclosed::{bounds, relation};
use super::job::Job;
use super::json::{self, E, raw};
use super::text::unit;
use super::{DONE, Failure, NO_CLAIM, Said, UNDECIDED, UNUSABLE};

pub fn run(args: &PolylineArgs) -> Said {
    answer(&Job::load(&args.common)?, args)
}

pub fn answer(job: &Job, args: &PolylineArgs) -> Said {
    let common = &args.common;
    let options = PolylineOptions::new()
        .rel_width(common.limits.rel_width)
        .certificate(common.certificate.is_some())
        .max_cells(common.limits.max_cells)
        .budget(job.budget())
        .progress(job.progress());
    let answer = job.done(tubecert::polyline(&job.spine, args.tolerance, &options))?;
    if !answer.is_certified() {
        return Ok((if common.json { as_json(job, &answer) } else { nothing(job, &answer) }, UNDECIDED));
    }
    if let Some(claim) = common.certificate.as_ref().and_then(|_| answer.claim()) {
        job.certify(answer.certificate.as_ref(), Statement::Polyline(claim))?;
    }
    if let Some(path) = &args.output {
        let text = written(path, job, &answer).ok_or_else(|| unknown_format(path))?;
        std::fs::write(path, text).map_err(|error| {
            let message = format!("the polyline cannot be written: {error}");
            let help = Some("nothing is claimed: give a file that can be written".to_string());
            let file = Some(path.display().to_string());
            Box::new(Failure { file, help, ..Failure::new(ErrorKind::Io.word(), message, NO_CLAIM) })
        })?;
    }
    Ok((if common.json { as_json(job, &answer) } else { as_text(job, &answer, args.tolerance) }, DONE))
}

/// The polyline as a file, by the ending of its name.
fn written(path: &Path, job: &Job, answer: &Polyline) -> Option<String> {
    let line = |[x, y, z]: &[f64; 3], by: &str| [x, y, z].map(|x| nearest_text(*x)).join(by);
    let mut text = String::new();
    let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
    match ending.as_deref() {
        Some("json") => return Some(as_json(job, answer)),
        Some("csv") => answer.vertices.iter().for_each(|vertex| text += &(line(vertex, ",") + "\n")),
        Some("obj") => {
            answer.vertices.iter().for_each(|vertex| text += &format!("v {}\n", line(vertex, " ")));
            text.push('l');
            let first = answer.closed.then_some(1);
            // writing to a String cannot fail
            (1..=answer.vertices.len()).chain(first).for_each(|k| text += &format!(" {k}"));
            text.push('\n');
        }
        _ => return None,
    }
    Some(text)
}

fn unknown_format(path: &Path) -> Box<Failure> {
    let help = Some("give a name that ends in .json, .csv or .obj".to_string());
    let message = "this version writes no polylines of that format".to_string();
    let file = Some(path.display().to_string());
    Box::new(Failure { file, help, ..Failure::new(ErrorKind::Option.word(), message, UNUSABLE) })
}

#[derive(serde::Serialize)]
struct PolylineData {
    vertices: Vec<[Box<RawValue>; 3]>,
    parameters: Vec<Box<RawValue>>,
    closed: bool,
    distance: E,
    tube_radius: E,
    edges: usize,
    edges_lower_bound: Option<u64>,
    edges_lower_bound_is: &'static str,
    a_priori_edges: Option<u64>,
    complete: bool,
}

fn as_json(job: &Job, answer: &Polyline) -> String {
    let number = |x: &f64| raw(nearest_text(*x));
    let count = |x: f64| (x < 1e18).then_some(x as u64);
    let data = PolylineData {
        vertices: answer.vertices.iter().map(|vertex| vertex.each_ref().map(number)).collect(),
        parameters: answer.parameters.iter().map(number).collect(),
        closed: answer.closed,
        distance: E(answer.distance),
        tube_radius: E(answer.tube_radius),
        edges: answer.edges,
        edges_lower_bound: count(answer.edges_lower_bound),
        edges_lower_bound_is: "asymptotic",
        a_priori_edges: count(answer.a_priori_edges),
        complete: answer.is_certified(),
    };
    json::answer("polyline", job.spine.curve(), data)
}

fn as_text(job: &Job, answer: &Polyline, tolerance: f64) -> String {
    let (_, most) = bounds(&answer.distance);
    let edges = |n: f64| if n < 1e15 { format!("{n}") } else { format!("{n:.1e}") };
    let mut text = format!(
        "{} edges, Frechet distance <= {most}        ({})\n\
         isotopic to the spine inside its tube: delta {}\n\
         about {} edges are needed (asymptotic law, not a proof); uniform subdivision until control polygons are as near takes {}\n",
        answer.edges,
        unit(job.spine.curve()),
        relation(&answer.tube_radius),
        edges(answer.edges_lower_bound),
        edges(answer.a_priori_edges),
    );
    if answer.tube_radius.lo < tolerance {
        text += "the tube is narrower than the tolerance: it keeps the polyline nearer\n";
    }
    text
}

fn nothing(job: &Job, answer: &Polyline) -> String {
    let radius = &answer.tube_radius;
    let help = match answer.stopped {
        Some(_) => job.limit(answer.stopped),
        None if radius.lo == 0.0 => "delta may be 0; ask radius".to_string(),
        None => "the tolerance may be below the rounding of coordinates; give a greater one".to_string(),
    };
    format!("no polyline was proved        ({})\ndelta {}\nhelp: {help}\n", unit(job.spine.curve()), relation(radius))
}
