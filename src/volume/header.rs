//! Headers of lines of text: a name, a sign, a value.

use std::{fs::File, io::Read as _, path::Path, str::FromStr};

use super::Refusal;
use crate::files;

/// The longest header.
const MAX_BYTES: u64 = 1 << 20;

/// The fields of a header, in order.
pub(super) struct Header {
    /// Names in small letters and without spaces, with their values.
    fields: Vec<(String, String)>,
    /// Bytes of the file up to the end of the header.
    pub(super) end: u64,
}

/// What one line of a header is.
pub(super) enum Line {
    /// A name and a value.
    Field(String, String),
    /// A field after which the header ends.
    Last(String, String),
    /// Nothing of interest.
    Other,
    /// The header ends.
    End,
}

impl Header {
    /// Reads the lines that `line` understands.
    pub(super) fn read(
        path: &Path,
        mut line: impl FnMut(usize, &str) -> Result<Line, Refusal>,
    ) -> Result<Self, Refusal> {
        let (file, _): (File, u64) = files::open(path)?;
        let mut bytes = Vec::new();
        file.take(MAX_BYTES)
            .read_to_end(&mut bytes)
            .map_err(|error| format!("its header cannot be read: {error}"))?;
        let mut header = Self { fields: Vec::new(), end: 0 };
        for (number, text) in bytes.split_inclusive(|&b| b == b'\n').enumerate() {
            header.end += text.len() as u64;
            let text = String::from_utf8_lossy(text);
            match line(number, text.trim_end_matches(['\r', '\n']))? {
                Line::Other => {}
                Line::Field(name, value) => header.add(&name, &value)?,
                Line::Last(name, value) => {
                    header.add(&name, &value)?;
                    return Ok(header);
                }
                Line::End => return Ok(header),
            }
        }
        if header.end == MAX_BYTES {
            return Err(format!("its header does not end within {} KiB", MAX_BYTES >> 10));
        }
        Ok(header)
    }

    fn add(&mut self, name: &str, value: &str) -> Result<(), Refusal> {
        let key = key(name);
        if self.fields.iter().any(|(other, _)| *other == key) {
            return Err(format!("its header has `{}` twice", name.trim()));
        }
        self.fields.push((key, value.trim().to_owned()));
        Ok(())
    }

    /// The value of a field.
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        let key = key(name);
        self.fields.iter().find(|(other, _)| *other == key).map(|(_, value)| value.as_str())
    }

    /// The value of a field that must be there.
    pub(super) fn need(&self, name: &str) -> Result<&str, Refusal> {
        self.get(name).ok_or_else(|| format!("its header has no `{name}`"))
    }

    /// The numbers of a field, if it is there: as many as there must be.
    pub(super) fn numbers<T: FromStr, const N: usize>(
        &self,
        name: &str,
    ) -> Result<Option<[T; N]>, Refusal> {
        let Some(text) = self.get(name) else { return Ok(None) };
        let numbers: Option<Vec<T>> =
            text.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
        match numbers.map(<[T; N]>::try_from) {
            Some(Ok(numbers)) => Ok(Some(numbers)),
            _ => Err(unusable(name, text, &numbers_wanted::<T>(N))),
        }
    }
}

/// What `N` numbers are called.
fn numbers_wanted<T>(n: usize) -> String {
    let is_float = std::any::type_name::<T>() == "f64";
    match (n, is_float) {
        (1, true) => "a number".to_owned(),
        (1, false) => "a whole number".to_owned(),
        (n, true) => format!("{n} numbers"),
        (n, false) => format!("{n} whole numbers"),
    }
}

/// What to say of a field with a value that is of no use.
pub(super) fn unusable(name: &str, value: &str, wanted: &str) -> Refusal {
    let mut excerpt: String = value.chars().take(60).collect();
    if excerpt.len() < value.len() {
        excerpt.push('…');
    }
    format!("its `{name}` is `{excerpt}` instead of {wanted}")
}

/// A name as it is compared.
fn key(name: &str) -> String {
    name.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_lowercase()
}

/// The file with the samples, and its length: `path` itself, or the file `data` beside it.
pub(super) fn open_data(path: &Path, data: Option<&str>) -> Result<(File, u64), Refusal> {
    let Some(name) = data else { return files::open(path) };
    let beside = files::beside(path, name)
        .ok_or_else(|| format!("its samples do not lie beside it: {name}"))?;
    files::open(&beside)
}
