//! Edits of the text of a certificate, one line at a time.

use tubecert::Rational;
use tubecert::number::{parse_rational, to_fraction_text};

/// The text without one line, with one twice, and with one in another spelling, for every line; none is the text itself.
pub fn mutants(text: &str, others: impl Fn(&str) -> Vec<String>) -> Vec<String> {
    let lines: Vec<&str> = text.lines().collect();
    let mut found = vec![];
    for (i, line) in lines.iter().enumerate() {
        let edits = [None, Some(format!("{line}\n{line}"))].into_iter().chain(others(line).into_iter().map(Some));
        for edit in edits {
            let all = lines.iter().enumerate();
            let all = all.filter_map(|(j, line)| if i == j { edit.clone() } else { Some((*line).to_string()) });
            let mutant: String = all.map(|line| line + "\n").collect();
            if mutant != text {
                found.push(mutant);
            }
        }
    }
    found
}

/// The line with one field in another spelling, for every field and all that `change` makes of it.
pub fn with_fields(line: &str, change: impl Fn(&str) -> Vec<String>) -> Vec<String> {
    let fields: Vec<&str> = line.split(' ').collect();
    let with = |k: usize, text: &String| {
        let mut fields = fields.clone();
        fields[k] = text;
        fields.join(" ")
    };
    let each = fields.iter().enumerate();
    each.flat_map(|(k, field)| change(field).iter().map(|text| with(k, text)).collect::<Vec<_>>()).collect()
}

/// What `change` makes of a field that is a number.
pub fn numbers(field: &str, change: impl Fn(&Rational) -> Vec<Rational>) -> Vec<String> {
    parse_rational(field).map_or(vec![], |x| change(&x).iter().map(to_fraction_text).collect())
}
