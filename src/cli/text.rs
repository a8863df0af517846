//! What all commands say alike.

use std::fmt::Write;

use tubecert::Curve;

use super::Failure;

/// Free text from a file, made harmless for a terminal and short.
pub fn plain(text: &str) -> String {
    let mut plain: String = text.chars().take(60).map(|c| if c.is_control() { '?' } else { c }).collect();
    if text.chars().nth(60).is_some() {
        plain.push_str("...");
    }
    plain
}

/// The unit of lengths.
pub fn unit(curve: &Curve) -> String {
    curve.unit().map_or("file units".to_string(), plain)
}

pub fn failure(failure: &Failure) -> String {
    let mut text = format!("error: {}\n", failure.message);
    let index = failure.index.map_or(String::new(), |index| format!("[{index}]"));
    let place = [
        failure.file.as_deref().map(|file| if file == "-" { "standard input".to_string() } else { plain(file) }),
        failure.key.as_deref().map(|key| format!("{}{index}", plain(key))),
        failure.offset.map(|offset| format!("byte {offset}")),
    ];
    let place: Vec<String> = place.into_iter().flatten().collect();
    if !place.is_empty() {
        let _ = writeln!(text, "  at {}", place.join(", "));
    }
    if let Some(help) = &failure.help {
        let _ = writeln!(text, "help: {help}");
    }
    text
}
