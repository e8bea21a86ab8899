//! From a file to a [`Scene`].

use std::{fs::File, io::Read, path::Path};

use super::{Scene, lower::Lower, read::read};
use crate::{
    Error, Result,
    diagnostic::{Diagnostic, Rejection},
};

/// The largest scene file.
const MAX_BYTES: u64 = 4 << 20;

/// Reads the scene in the file `path`.
///
/// # Errors
/// The file cannot be read, is larger than 4 MiB, or does not hold a valid scene.
pub fn load(path: &Path) -> Result<Scene> {
    let bytes = read_bytes(path)?;
    let source = String::from_utf8(bytes).map_err(|error| {
        // Up to the first foreign byte the replacement text is the file's own.
        let at = error.utf8_error().valid_up_to();
        let source = String::from_utf8_lossy(error.as_bytes()).into_owned();
        let width = char::REPLACEMENT_CHARACTER.len_utf8();
        let diagnostic = Diagnostic::new(at..at + width, "the file is not text in UTF-8")
            .label("this byte cannot stand here")
            .help("save the file with the encoding UTF-8");
        reject(path, &source, vec![diagnostic])
    });
    source
        .and_then(|source| parse(path, &source))
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
    let mut errors = Vec::new();
    let name = path.file_stem().map_or("scene".into(), |stem| stem.to_string_lossy());
    let spec = read(source, &mut errors);
    let scene = spec.map(|spec| Lower { source, errors: &mut errors }.scene(&name, &spec));
    match scene {
        Some(scene) if errors.is_empty() => Ok(scene),
        _ => Err(reject(path, source, errors)),
    }
}

fn reject(path: &Path, source: &str, mut diagnostics: Vec<Diagnostic>) -> Rejection {
    diagnostics.sort_by_key(|diagnostic| diagnostic.span.start);
    Rejection { path: path.to_owned(), source: source.to_owned(), diagnostics }
}
