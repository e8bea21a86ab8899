//! Files of other programs as scenes: each format's importer writes the text of a scene file.
//!
//! What a scene cannot say is left out, with a comment in the scene and a note to the user.

mod camera;
mod cube;
mod elements;
mod jsurf;
mod molecule;
mod pdb;
mod properties;
mod similarity;
mod values;
mod xyz;

use std::{
    fmt::Write as _,
    ops::Range,
    path::{Component, Path, PathBuf},
};

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

/// How a file becomes a scene.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Where the scene will be: if it names the file, then as it is found from there; without it, as the
    /// file was named.
    pub scene: Option<PathBuf>,
    /// Whether atoms are small balls with bonds between them.
    pub has_sticks: bool,
}

/// What an importer reads.
struct Source<'a> {
    path: &'a Path,
    text: &'a str,
    /// Whether atoms are small balls with bonds between them.
    has_sticks: bool,
}

/// A format that can be converted.
struct Format {
    /// How names of its files end, in small letters.
    ending: &'static str,
    /// What such a file is.
    what: &'static str,
    /// The largest file, in bytes.
    max_bytes: u64,
    import: Import,
}

/// What makes a scene of a file.
enum Import {
    /// Reads its text; the mistakes are those of the text, in any order.
    Text(OfText),
    /// Leaves its content where it is: the scene names the file, as the second argument does. The
    /// mistake is a sentence without the name of the file.
    Named(OfFile),
}

type OfText = fn(&Source<'_>) -> std::result::Result<Converted, Vec<Diagnostic>>;
type OfFile = fn(&Source<'_>, &str) -> std::result::Result<Converted, String>;

/// All formats, in the order in which they are listed to the user.
const FORMATS: [Format; 6] = [
    text("jsurf", "Surfer", 4, jsurf::import),
    text("xyz", "XYZ molecule", 256, xyz::import),
    text("pdb", "PDB molecule", 256, pdb::import),
    text("ent", "PDB molecule", 256, pdb::import),
    named("cube", "Gaussian cube", cube::import),
    named("cub", "Gaussian cube", cube::import),
];

const fn text(ending: &'static str, what: &'static str, max_mib: u64, import: OfText) -> Format {
    Format { ending, what, max_bytes: max_mib << 20, import: Import::Text(import) }
}

const fn named(ending: &'static str, what: &'static str, import: OfFile) -> Format {
    Format { ending, what, max_bytes: 0, import: Import::Named(import) }
}

/// Makes a scene of the file at `path`; the ending of its name tells the format.
///
/// # Errors
/// The ending belongs to no format, or the file cannot be read, is too large or has mistakes.
pub fn convert(path: &Path) -> Result<Converted> {
    convert_with(path, &Options::default())
}

/// As [`convert`], with options.
///
/// # Errors
/// As [`convert`].
pub fn convert_with(path: &Path, options: &Options) -> Result<Converted> {
    let format = format(path)?;
    let import = match format.import {
        Import::Text(import) => return of_text(import, path, read(path, format)?, options),
        Import::Named(import) => import,
    };
    let name = match &options.scene {
        Some(scene) => name_from(path, scene),
        None => path.to_string_lossy().into_owned(),
    };
    let source = Source { path, text: "", has_sticks: options.has_sticks };
    import(&source, &name).map_err(|why| {
        let message = format!("the file cannot be used: {why}");
        rejected(path, String::new(), vec![Diagnostic::new(0..0, message)])
    })
}

/// As [`convert`], with the text that the file holds. Nothing is read from disk.
///
/// # Errors
/// As [`convert`]; also if such files are more than a text.
pub fn convert_text(path: &Path, text: String) -> Result<Converted> {
    match format(path)?.import {
        Import::Text(import) => of_text(import, path, text, &Options::default()),
        Import::Named(_) => {
            Err(Error::Unknown(format!("{} is looked at on disk alone", path.display())))
        }
    }
}

fn of_text(import: OfText, path: &Path, text: String, options: &Options) -> Result<Converted> {
    let converted = import(&Source { path, text: &text, has_sticks: options.has_sticks });
    converted.map_err(|diagnostics| rejected(path, text, diagnostics))
}

fn rejected(path: &Path, text: String, mut diagnostics: Vec<Diagnostic>) -> Error {
    diagnostics.sort_by_key(|diagnostic| diagnostic.span.start);
    let sources = Sources { path: path.to_owned(), text, ..Sources::default() };
    Error::Scene(Box::new(Rejection { sources, diagnostics }))
}

/// The text of a file.
fn read(path: &Path, format: &Format) -> Result<String> {
    let failed = |source| Error::Io { action: "read", path: path.to_owned(), source };
    let bytes = files::read(path, format.max_bytes).map_err(failed)?.ok_or_else(|| {
        let (what, limit) = (format.what, format.max_bytes >> 20);
        Error::Limit(format!("the file is larger than {limit} MiB: this is no {what} file"))
    })?;
    Ok(decode(bytes))
}

/// What the file at `path` is called in the file `scene`.
fn name_from(path: &Path, scene: &Path) -> String {
    let written = |path: &Path| path.to_string_lossy().into_owned();
    let folder = match scene.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    // A folder that is not there is a mistake that is told when the scene is written.
    let (Ok(file), Ok(folder)) = (path.canonicalize(), folder.canonicalize()) else {
        return written(path);
    };
    let n_shared = file.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    let up = folder.components().skip(n_shared).map(|_| Component::ParentDir);
    written(&up.chain(file.components().skip(n_shared)).collect::<PathBuf>())
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

/// The lines of a text, and where they stand.
fn lines(text: &str) -> impl Iterator<Item = (&str, Range<usize>)> {
    let mut start = 0;
    text.split_inclusive('\n').map(move |whole| {
        let line = whole.trim_end_matches(['\r', '\n']);
        let at = start..start + line.len();
        start += whole.len();
        (line, at)
    })
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
    fn files_are_named_from_where_the_scene_is() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir_all(at("a/b")).unwrap();
        std::fs::write(at("a/c.cube"), "").unwrap();
        let name = |scene: &str| name_from(&at("a/c.cube"), &at(scene));
        assert_eq!(name("a/s.toml"), "c.cube");
        assert_eq!(name("s.toml"), "a/c.cube");
        assert_eq!(name("a/b/s.toml"), "../c.cube");
    }

    #[test]
    fn any_bytes_are_text() {
        assert_eq!(decode("é".as_bytes().to_vec()), "é");
        assert_eq!(decode(vec![b'a', 0xe9]), "aé");
    }
}
