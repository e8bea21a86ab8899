//! Text files, read within limits.

use std::{fs::File, io, io::Read, path::Path};

use crate::diagnostic::Diagnostic;

/// The bytes of a file; nothing if there are more than `limit`.
pub(super) fn read(path: &Path, limit: u64) -> io::Result<Option<Vec<u8>>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(limit + 1).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= limit).then_some(bytes))
}

/// The text that a file holds, and what is wrong if it is not all text.
pub(super) fn decode(bytes: Vec<u8>) -> (String, Option<Diagnostic>) {
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
