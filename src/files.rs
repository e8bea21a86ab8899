//! Files that are read: opened without waiting, within limits, and found only beside what names them.

use std::{
    fs::{self, File},
    io::{self, Read},
    path::{Component, Path, PathBuf},
};

use crate::diagnostic::Diagnostic;

/// The bytes of a file; nothing if there are more than `limit`.
///
/// # Errors
/// The file cannot be opened or read.
pub fn read(path: &Path, limit: u64) -> io::Result<Option<Vec<u8>>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(limit + 1).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= limit).then_some(bytes))
}

/// The text that a file holds, and what is wrong if it is not all text.
#[must_use]
pub fn decode(bytes: Vec<u8>) -> (String, Option<Diagnostic>) {
    let error = match String::from_utf8(bytes) {
        Ok(text) => return (text, None),
        Err(error) => error,
    };
    // Up to the first foreign byte the replacement text is the file's own.
    let at = error.utf8_error().valid_up_to();
    let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
    let width = char::REPLACEMENT_CHARACTER.len_utf8();
    let mistake = Diagnostic::new(at..at + width, "the file is not text in UTF-8")
        .label("this byte cannot stand here")
        .help("save the file with the encoding UTF-8");
    (text, Some(mistake))
}

/// Opens a file to be read, and tells its length in bytes.
///
/// # Errors
/// A sentence that says why it cannot be opened; a pipe is refused, since it would be waited for.
pub fn open(path: &Path) -> Result<(File, u64), String> {
    let failed = |error: io::Error| match error.kind() {
        io::ErrorKind::NotFound => format!("there is no file {}", path.display()),
        _ => format!("cannot read {}: {error}", path.display()),
    };
    let metadata = fs::metadata(path).map_err(failed)?;
    if !metadata.is_file() {
        return Err(format!("{} is not a file", path.display()));
    }
    Ok((File::open(path).map_err(failed)?, metadata.len()))
}

/// The file `name` beside or below `path`; none if the name leads anywhere else.
#[must_use]
pub fn beside(path: &Path, name: &str) -> Option<PathBuf> {
    let mut parts = Path::new(name).components();
    let is_below = parts.all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    let folder = path.parent().unwrap_or(Path::new(""));
    (is_below && !name.is_empty()).then(|| folder.join(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_no_further_than_below() {
        let found = |name| beside(Path::new("a/b.nhdr"), name);
        assert_eq!(found("c.raw"), Some(PathBuf::from("a/c.raw")));
        assert_eq!(found("./d/c.raw"), Some(PathBuf::from("a/./d/c.raw")));
        assert_eq!([found("../c.raw"), found("/c.raw"), found("")], [None, None, None]);
    }
}
