//! From a file to a [`Scene`].

use std::{fs::File, io::Read, path::Path};

use super::{Scene, lower::Lower, read::read};
use crate::{
    Error, Result,
    diagnostic::{Diagnostic, Rejection, Sources},
};

/// The largest scene file.
const MAX_BYTES: u64 = 4 << 20;

/// Reads the scene in the file `path`.
///
/// # Errors
/// The file cannot be read, is larger than 4 MiB, or does not hold a valid scene.
pub fn load(path: &Path) -> Result<Scene> {
    load_with(path, &[])
}

/// As [`load`], with parameters set to other values: each of `settings` is `name=value`, where the
/// value is a number or a formula. The last one of a name counts.
///
/// # Errors
/// As [`load`]; also if a setting is malformed or sets what the scene does not have.
pub fn load_with(path: &Path, settings: &[String]) -> Result<Scene> {
    let bytes = read_bytes(path)?;
    let source = String::from_utf8(bytes).map_err(|error| {
        // Up to the first foreign byte the replacement text is the file's own.
        let at = error.utf8_error().valid_up_to();
        let source = String::from_utf8_lossy(error.as_bytes()).into_owned();
        let width = char::REPLACEMENT_CHARACTER.len_utf8();
        let diagnostic = Diagnostic::new(at..at + width, "the file is not text in UTF-8")
            .label("this byte cannot stand here")
            .help("save the file with the encoding UTF-8");
        reject(sources(path, &source, settings), vec![diagnostic])
    });
    source
        .and_then(|source| parse_with(path, &source, settings))
        .map_err(|rejection| Error::Scene(Box::new(rejection)))
}

fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    let failed = |source| Error::Io { action: "read", path: path.to_owned(), source };
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(failed)?;
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > MAX_BYTES {
        let limit = MAX_BYTES >> 20;
        return Err(Error::Limit(format!(
            "the file is larger than {limit} MiB: this is no scene file"
        )));
    }
    Ok(bytes)
}

/// Makes a scene of the text `source` of the file `path`, which gives it its name.
///
/// # Errors
/// All mistakes that were found, in the order of their places.
pub fn parse(path: &Path, source: &str) -> std::result::Result<Scene, Rejection> {
    parse_with(path, source, &[])
}

/// As [`parse`], with parameters set to other values as in [`load_with`].
///
/// # Errors
/// All mistakes that were found: those of the file in the order of their places, then those of
/// the settings.
pub fn parse_with(
    path: &Path,
    source: &str,
    settings: &[String],
) -> std::result::Result<Scene, Rejection> {
    let mut errors = Vec::new();
    let name = path.file_stem().map_or("scene".into(), |stem| stem.to_string_lossy());
    let sources = sources(path, source, settings);
    let Some(spec) = read(source, &mut errors) else { return Err(reject(sources, errors)) };
    let mut lower = Lower::new(source, settings, errors);
    let scene = lower.scene(&name, &spec);
    match lower.errors.is_empty() {
        true => Ok(Scene { sources, warnings: in_order(lower.warnings), ..scene }),
        false => Err(reject(sources, lower.errors)),
    }
}

fn sources(path: &Path, text: &str, settings: &[String]) -> Sources {
    Sources { path: path.to_owned(), text: text.to_owned(), settings: settings.to_vec() }
}

fn reject(sources: Sources, diagnostics: Vec<Diagnostic>) -> Rejection {
    Rejection { sources, diagnostics: in_order(diagnostics) }
}

/// As they stand in the texts.
fn in_order(mut diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    diagnostics.sort_by_key(|diagnostic| (diagnostic.origin, diagnostic.span.start));
    diagnostics
}
