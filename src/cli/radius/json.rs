//! The JSON answer of a radius.

use tubecert::{Radius, Spine, SpineEnd};

use crate::cli::json::{self, E};

#[derive(serde::Serialize)]
struct RadiusData {
    delta: E,
    limited_by: &'static str,
    also: Vec<&'static str>,
    closed: bool,
    at: Option<At>,
    terms: Terms,
    #[serde(skip_serializing_if = "Option::is_none")]
    rim: Option<Rim>,
}

#[derive(serde::Serialize)]
struct At {
    #[serde(skip_serializing_if = "Option::is_none")]
    s: Option<E>,
    t: E,
    #[serde(skip_serializing_if = "Option::is_none")]
    x: Option<[E; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    end: Option<&'static str>,
}

#[derive(serde::Serialize)]
struct Terms {
    curvature: E,
    body_to_body: E,
    end_to_body: E,
    end_to_end: E,
}

#[derive(serde::Serialize)]
struct Rim {
    end_to_body: E,
    end_to_end: E,
    delta: E,
}

pub fn radius(spine: &Spine, answer: &Radius) -> String {
    let at = answer.at.as_ref().map(|at| At {
        s: at.s.map(E),
        t: E(at.t),
        x: at.x.map(|x| x.map(E)),
        end: at.end.map(|end| match end {
            SpineEnd::Start => "start",
            SpineEnd::Finish => "finish",
        }),
    });
    let terms = &answer.terms;
    let rim = answer.rim.as_ref();
    json::answer(
        "radius",
        spine.curve(),
        RadiusData {
            delta: E(answer.delta),
            limited_by: answer.limited_by.word(),
            also: answer.also.iter().map(|term| term.word()).collect(),
            closed: answer.closed,
            at,
            terms: Terms {
                curvature: E(terms.curvature),
                body_to_body: E(terms.body_to_body),
                end_to_body: E(terms.end_to_body),
                end_to_end: E(terms.end_to_end),
            },
            rim: rim.map(|rim| Rim {
                end_to_body: E(rim.end_to_body),
                end_to_end: E(rim.end_to_end),
                delta: E(rim.delta),
            }),
        },
    )
}
