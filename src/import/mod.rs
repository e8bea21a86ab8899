//! Files of other programs as scenes: each format's importer writes the text of a scene file.
//!
//! What a scene cannot say is left out, with a comment in the scene and a note to the user.

mod camera;
mod jsurf;
mod properties;
mod similarity;
mod values;

use std::{fmt::Write as _, path::Path};

use glam::DVec3;

use crate::{
    Error, Result,
    diagnostic::{Diagnostic, Rejection, Sources},
    files,
};

/// A file as a scene.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Converted {
    /// The text of the scene file.
    pub scene: String,
    /// What the user should know: what was left out or guessed, a sentence each without a full stop.
    pub notes: Vec<String>,
}

/// What an importer reads.
struct Source<'a> {
    path: &'a Path,
    text: &'a str,
}

/// A format that can be converted.
struct Format {
    /// How names of its files end, in small letters.
    ending: &'static str,
    /// What such a file is.
    what: &'static str,
    /// The largest file, in bytes.
    max_bytes: u64,
    /// What makes a scene of one; the mistakes are those of its text, in any order.
    import: fn(&Source<'_>) -> std::result::Result<Converted, Vec<Diagnostic>>,
}

/// All formats, in the order in which they are listed to the user.
const FORMATS: [Format; 1] =
    [Format { ending: "jsurf", what: "Surfer", max_bytes: 4 << 20, import: jsurf::import }];

/// Makes a scene of the file at `path`; the ending of its name tells the format.
///
/// # Errors
/// The ending belongs to no format, or the file cannot be read, is too large or has mistakes.
pub fn convert(path: &Path) -> Result<Converted> {
    let format = format(path)?;
    let failed = |source| Error::Io { action: "read", path: path.to_owned(), source };
    let bytes = files::read(path, format.max_bytes).map_err(failed)?.ok_or_else(|| {
        let (what, limit) = (format.what, format.max_bytes >> 20);
        Error::Limit(format!("the file is larger than {limit} MiB: this is no {what} file"))
    })?;
    convert_text(path, decode(bytes))
}

/// As [`convert`], with the text that the file holds. Nothing is read from disk.
///
/// # Errors
/// As [`convert`].
pub fn convert_text(path: &Path, text: String) -> Result<Converted> {
    let converted = (format(path)?.import)(&Source { path, text: &text });
    converted.map_err(|mut diagnostics| {
        diagnostics.sort_by_key(|diagnostic| diagnostic.span.start);
        let sources = Sources { path: path.to_owned(), text, ..Sources::default() };
        Error::Scene(Box::new(Rejection { sources, diagnostics }))
    })
}

/// The endings of files that can be converted, with what they are.
#[must_use]
pub fn formats() -> String {
    let named = |format: &Format| format!(".{} ({})", format.ending, format.what);
    FORMATS.iter().map(named).collect::<Vec<_>>().join(", ")
}

fn format(path: &Path) -> Result<&'static Format> {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    FORMATS.iter().find(|format| format.ending == ending).ok_or_else(|| {
        let path = path.display();
        Error::Unknown(format!("{path} cannot be converted; what can be: {}", formats()))
    })
}

/// Text in UTF-8, or else in Latin-1, which is what old programs write.
fn decode(bytes: Vec<u8>) -> String {
    String::from_utf8(bytes)
        .unwrap_or_else(|error| error.as_bytes().iter().copied().map(char::from).collect())
}

/// The first line of a scene: the file that it was made of, and what that is.
fn header(source: &Source<'_>, what: &str) -> String {
    let name = source.path.file_name().unwrap_or_default().to_string_lossy();
    format!("# Converted from {}, {what}.\n", line(&name))
}

/// `value` with nine digits, which is more than other programs' files have.
fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.8e}").parse().unwrap_or(value);
    // Not -0.
    (rounded + 0.0).to_string()
}

/// `v` without parts that are nothing beside `size`.
fn snapped(v: DVec3, size: f64) -> DVec3 {
    let part = |part: f64| if part.abs() > 1e-9 * size { part } else { 0.0 };
    DVec3::from(v.to_array().map(part))
}

/// A vector of TOML.
fn vector(v: DVec3) -> String {
    format!("[{}]", v.to_array().map(number).join(", "))
}

/// A string of TOML that holds `text`.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// A key of TOML.
fn key(name: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-');
    if !name.is_empty() && name.chars().all(is_bare) { name.to_owned() } else { quoted(name) }
}

/// `text` as a part of one line of a comment.
fn line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// Adds each note as a comment, which tells the reader of the scene what it lacks.
fn comments(scene: &mut String, notes: &[String]) {
    for note in notes {
        // Text that is in memory can always grow.
        let _ = writeln!(scene, "# Note: {}.", line(note));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_tell_the_format() {
        assert_eq!(format(Path::new("a/B.JSURF")).unwrap().ending, "jsurf");
        for name in ["a", "a.png", "jsurf"] {
            assert!(matches!(format(Path::new(name)), Err(Error::Unknown(_))), "{name}");
        }
    }

    #[test]
    fn any_bytes_are_text() {
        assert_eq!(decode("é".as_bytes().to_vec()), "é");
        assert_eq!(decode(vec![b'a', 0xe9]), "aé");
    }
}
