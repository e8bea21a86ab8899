//! From a file to a [`Scene`].

use std::path::Path;

use super::{Scan, Scene, include::Includes, lower::Lower, read::read};
use crate::{
    Error, Result,
    diagnostic::{Diagnostic, Rejection, Sources},
    files,
};

/// The largest scene file.
const MAX_BYTES: u64 = 4 << 20;

/// Reads the scene in the file `path`, and the files that it names, relative to its folder.
///
/// # Errors
/// The file cannot be read, is larger than 4 MiB, or does not hold a valid scene.
pub fn load(path: &Path) -> Result<Scene> {
    load_with(path, &Loading::default())
}

/// What the user may change about a scene for one run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Loading<'a> {
    /// Parameters set to other values, each as `name=value`, where the value is a number or a formula.
    /// The last one of a name counts.
    pub settings: &'a [String],
    /// Whether files outside the scene's folder may be included.
    pub allow_outside: bool,
    /// Bytes of memory that a volume and its octree may take; three quarters of the machine's where
    /// `None`.
    pub max_memory: Option<u64>,
}

/// As [`load`], with changes.
///
/// # Errors
/// As [`load`]; also if a setting is malformed or sets what the scene does not have.
pub fn load_with(path: &Path, loading: &Loading<'_>) -> Result<Scene> {
    let (source, mistake) = files::decode(read_bytes(path)?);
    let scene = match mistake {
        None => parse_in(path, &source, path.parent(), loading),
        Some(mistake) => {
            let sources = Sources { path: path.to_owned(), text: source, ..Sources::default() };
            Err(reject(sources, vec![mistake]))
        }
    };
    scene.map_err(|rejection| Error::Scene(Box::new(rejection)))
}

/// The sampled volumes of the scene in the file `path`, and nothing else of it.
///
/// # Errors
/// As [`load`], with the mistakes of its `[[volume]]` sections alone.
pub fn load_volumes(path: &Path) -> Result<Vec<Scan>> {
    let (text, mistake) = files::decode(read_bytes(path)?);
    let sources = Sources { path: path.to_owned(), text, ..Sources::default() };
    let mut errors: Vec<Diagnostic> = mistake.into_iter().collect();
    let spec = if errors.is_empty() { read(&sources.text, &mut errors) } else { None };
    let mut lower = Lower::new(&sources.text, &[], path.parent(), errors);
    let sections = spec.iter().flat_map(|spec| &spec.volumes);
    let scans: Vec<Scan> = sections.filter_map(|section| lower.scan(section)).collect();
    match std::mem::take(&mut lower.errors) {
        errors if errors.is_empty() => Ok(scans),
        errors => Err(Error::Scene(Box::new(reject(sources, errors)))),
    }
}

fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    let failed = |source| Error::Io { action: "read", path: path.to_owned(), source };
    files::read(path, MAX_BYTES).map_err(failed)?.ok_or_else(|| {
        let limit = MAX_BYTES >> 20;
        Error::Limit(format!("the file is larger than {limit} MiB: this is no scene file"))
    })
}

/// Makes a scene of the text `source` of the file `path`, which gives it its name. Nothing is read
/// from disk: a surface that names a file is a mistake here.
///
/// # Errors
/// All mistakes that were found, in the order of their places.
pub fn parse(path: &Path, source: &str) -> std::result::Result<Scene, Rejection> {
    parse_with(path, source, &[], None)
}

/// As [`parse`], with parameters set to other values as in [`Loading`]. The files that surfaces
/// name are read, relative names from `folder`, if there is one.
///
/// # Errors
/// All mistakes that were found: those of the file in the order of their places, then those of the
/// files that it names, then those of the settings.
pub fn parse_with(
    path: &Path,
    source: &str,
    settings: &[String],
    folder: Option<&Path>,
) -> std::result::Result<Scene, Rejection> {
    parse_in(path, source, folder, &Loading { settings, ..Loading::default() })
}

fn parse_in(
    path: &Path,
    source: &str,
    folder: Option<&Path>,
    loading: &Loading<'_>,
) -> std::result::Result<Scene, Rejection> {
    let Loading { settings, allow_outside, max_memory } = *loading;
    let mut errors = Vec::new();
    let name = path.file_stem().map_or("scene".into(), |stem| stem.to_string_lossy());
    let mut sources = Sources {
        path: path.to_owned(),
        text: source.to_owned(),
        settings: settings.to_vec(),
        models: Vec::new(),
    };
    let Some(mut spec) = read(source, &mut errors) else { return Err(reject(sources, errors)) };
    let included = Includes::new(path, folder, allow_outside).read(&mut spec, &mut errors);
    let mut lower = Lower::new(source, settings, folder, errors);
    lower.n_included = included.len();
    lower.max_memory = max_memory;
    let mut scene = lower.scene(&name, &spec);
    scene.script = lower.script(scene.n_frames(), spec);
    let graphs = lower.graphs.into_iter().map(|(graph, _)| graph);
    sources.models = included.into_iter().chain(graphs).collect();
    match lower.errors.is_empty() {
        true => Ok(Scene { sources, warnings: in_order(lower.warnings), ..scene }),
        false => Err(reject(sources, lower.errors)),
    }
}

fn reject(sources: Sources, diagnostics: Vec<Diagnostic>) -> Rejection {
    Rejection { sources, diagnostics: in_order(diagnostics) }
}

/// As they stand in the texts.
fn in_order(mut diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    diagnostics.sort_by_key(|diagnostic| (diagnostic.origin, diagnostic.span.start));
    diagnostics
}
