//! Files that others name: opened without waiting, found only beside what names them.

use std::{
    fs::{self, File},
    io,
    path::{Component, Path, PathBuf},
};

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
