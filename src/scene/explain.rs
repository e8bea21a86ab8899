//! serde's complaints in the words of a scene file.

use std::ops::Range;

use toml::de::DeValue;

use super::read::Entry;
use crate::diagnostic::{Diagnostic, did_you_mean};

/// The sections of a scene file.
const SECTIONS: [&str; 19] = [
    "version",
    "params",
    "let",
    "shapes",
    "include",
    "surface",
    "model",
    "volume",
    "sculpture",
    "domain",
    "voxels",
    "camera",
    "light",
    "image",
    "output",
    "mesh",
    "animation",
    "sweep",
    "about",
];

/// A key outside the sections, or a section, that does not exist.
pub(super) fn unknown_section(key: &str, span: Range<usize>) -> Diagnostic {
    if let Some(place) = place_of(key) {
        return Diagnostic::new(span, format!("`{key}` stands outside its section"))
            .label("not part of a scene by itself")
            .help(format!("write it below {place}"));
    }
    Diagnostic::new(span, format!("unknown key or section `{key}`"))
        .label("not part of a scene")
        .help(choices_help(key, &SECTIONS, "a scene has"))
}

/// Where a key belongs that people write without its section.
fn place_of(key: &str) -> Option<&'static str> {
    Some(match key {
        "f" | "shape" | "blend" | "spheres" | "file" | "inside" | "color" | "back_color" => {
            "[[surface]]"
        }
        "clip" | "cap" => "[domain], for all surfaces, or below a [[surface]]",
        "min" | "max" => "[domain]",
        "resolution" => "[voxels]",
        "width" | "height" | "background" => "[image]",
        "fov" | "eye" | "target" | "projection" => "[camera]",
        "frames" | "turntable" | "fps" => "[animation]",
        "title" | "source" | "note" => "[about]",
        _ => return None,
    })
}

/// How to name the table in which a mistake was made: the section, or the inline table that is
/// the value of `entry`.
pub(super) fn place_of_key(
    section: &str,
    entry: Option<Entry<'_, '_>>,
    at: &Range<usize>,
) -> String {
    match entry {
        Some((key, value))
            if matches!(value.get_ref(), DeValue::Table(_)) && value.span().start <= at.start =>
        {
            format!("`{}`", key.get_ref())
        }
        _ => section.to_owned(),
    }
}

/// The diagnostic for an error of serde at `at` in `place`.
pub(super) fn refused(error: &toml::de::Error, at: Range<usize>, place: &str) -> Diagnostic {
    let text = error.message();
    if let Some((key, choices)) = split(text, "unknown field `", "`, ") {
        return Diagnostic::new(at, format!("unknown key `{key}` in {place}"))
            .label(format!("not a key of {place}"))
            .help(choices_help(key, &quoted(choices), &format!("{place} has")));
    }
    if let Some((word, choices)) = split(text, "unknown variant `", "`, ") {
        return Diagnostic::new(at, format!("unknown value `{word}`"))
            .label("not one of the choices")
            .help(choices_help(word, &quoted(choices), "choose from"));
    }
    if let Some((key, _)) = split(text, "missing field `", "`") {
        return Diagnostic::new(at, format!("{place} lacks the key `{key}`"))
            .label(format!("no `{key}` in here"));
    }
    if let Some((found, expected)) = split(text, "invalid type: ", ", expected ") {
        return wrong_type(at, found, expected);
    }
    match text {
        "wanted string or table" => Diagnostic::new(at, "expected a word in quotes"),
        _ => with_help(at, text, None),
    }
}

fn wrong_type(at: Range<usize>, found: &str, expected: &str) -> Diagnostic {
    let expected = match expected {
        "a boolean" => "true or false",
        "a sequence" => "an array of numbers",
        other => other,
    };
    let diagnostic = with_help(at, &format!("expected {expected}"), Some(found));
    if expected.starts_with("an array of") {
        return diagnostic.help("write numbers in square brackets, as in [0, -1.5, 2]");
    }
    match expected.ends_with("number") && is_text_with_digits(found) {
        true => diagnostic.help("write numbers without quotes and without a unit, as in 0.5"),
        false => diagnostic,
    }
}

/// The parts of `text` between `start` and the first `middle`, and after that.
fn split<'a>(text: &'a str, start: &str, middle: &str) -> Option<(&'a str, &'a str)> {
    text.strip_prefix(start)?.split_once(middle)
}

/// The words in backticks.
fn quoted(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}

/// A diagnostic from a text whose second line is help.
fn with_help(at: Range<usize>, text: &str, found: Option<&str>) -> Diagnostic {
    let (message, help) = match text.split_once('\n') {
        Some((message, help)) => (message, Some(help)),
        None => (text, None),
    };
    let mut diagnostic = Diagnostic::new(at, message);
    if let Some(found) = found {
        diagnostic = diagnostic.label(format!("this is {}", kind_of(found)));
    }
    match help {
        Some(help) => diagnostic.help(help),
        None => diagnostic,
    }
}

/// Whether serde found text that begins like a number: `string "3mm"`.
fn is_text_with_digits(found: &str) -> bool {
    let text = found.strip_prefix("string \"").unwrap_or_default();
    text.trim_start_matches(['+', '-', '.']).starts_with(|c: char| c.is_ascii_digit())
}

/// The kind of value that serde's description stands for.
fn kind_of(found: &str) -> &'static str {
    match found.split(' ').next() {
        Some("string") => "text",
        Some("integer") => "a whole number",
        Some("floating") => "a number with a point",
        Some("boolean") => "true or false",
        Some("sequence") => "an array",
        _ => "a table or a date",
    }
}

/// The kind of a value of the file.
pub(super) fn kind_of_value(value: &DeValue<'_>) -> &'static str {
    kind_of(match value {
        DeValue::String(_) => "string",
        DeValue::Integer(_) => "integer",
        DeValue::Float(_) => "floating",
        DeValue::Boolean(_) => "boolean",
        DeValue::Array(_) => "sequence",
        DeValue::Datetime(_) | DeValue::Table(_) => "map",
    })
}

/// What could have been meant, and everything that could be written.
fn choices_help(word: &str, choices: &[&str], introduction: &str) -> String {
    let list: Vec<String> = choices.iter().map(|choice| format!("`{choice}`")).collect();
    let list = format!("{introduction} {}", list.join(", "));
    match did_you_mean(word, choices.iter().copied()) {
        Some(meant) => format!("did you mean `{meant}`?\n{list}"),
        None => list,
    }
}
