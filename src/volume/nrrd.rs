//! NRRD, attached (`.nrrd`) and detached (`.nhdr`).
//!
//! *Based on:* G. Kindlmann, "Definition of NRRD File Format", teem.sourceforge.net/nrrd/format.html,
//! versions 1 to 5. Read are three axes of numbers, encoded as raw, gzip or text.

use std::{
    fs::File,
    io::{BufRead as _, BufReader, Seek as _, SeekFrom},
    path::Path,
};

use glam::{DMat3, DVec3};

use super::{
    ByteOrder, Refusal, SampleType, Volume,
    bytes::{Packing, Stored},
    checked_size,
    header::{Header, Line, open_data, unusable},
    placing::placing,
};

pub(super) fn read(path: &Path, max_memory: Option<u64>) -> Result<Volume, Refusal> {
    let header = Header::read(path, line)?;
    let size = size(&header)?;
    let (steps, first) = grid(&header, size)?;
    let placing = placing(steps, first)?;
    let data = header.get("data file");
    if let Some(name) = data
        && (name.split_ascii_whitespace().next() == Some("LIST") || name.contains('%'))
    {
        return Err("its samples lie in several files; only one can be read".to_owned());
    }
    let (mut file, length) = open_data(path, data)?;
    let mut stored = Stored {
        size,
        sample_type: sample_type(&header)?,
        byte_order: byte_order(&header)?,
        packing: packing(&header)?,
        start: if data.is_none() { header.end } else { 0 },
        skip: 0,
    };
    if let Some([n]) = header.numbers::<u64, 1>("line skip")? {
        stored.start += bytes_of_lines(&mut file, stored.start, n)?;
    }
    match header.numbers::<i64, 1>("byte skip")? {
        // The samples end with the file.
        Some([-1]) if stored.packing == Packing::Plain => {
            let held = length.saturating_sub(stored.start);
            stored.skip = held.saturating_sub(stored.n_bytes());
        }
        Some([n]) => {
            stored.skip = u64::try_from(n).map_err(|_| {
                unusable("byte skip", &n.to_string(), "a number of bytes, or -1 with raw encoding")
            })?;
        }
        None => {}
    }
    let samples = stored.samples((file, length), max_memory)?;
    Ok(Volume { size, samples, placing })
}

/// One line of the header.
fn line(number: usize, text: &str) -> Result<Line, Refusal> {
    if number == 0 {
        let version = text.trim_end().strip_prefix("NRRD").and_then(|v| v.parse::<u32>().ok());
        return match version {
            Some(1..=5) => Ok(Line::Other),
            _ => Err("it does not start with NRRD0001 to NRRD0005".to_owned()),
        };
    }
    if text.is_empty() {
        return Ok(Line::End);
    }
    // Pairs of a key and a value are for programs, comments for people.
    let separator = text.find([':', '=']).filter(|_| !text.starts_with('#'));
    Ok(match separator.map(|at| (&text[..at], &text[at..])) {
        Some((name, rest)) if rest.starts_with(": ") => {
            Line::Field(name.to_owned(), rest[2..].to_owned())
        }
        _ => Line::Other,
    })
}

fn size(header: &Header) -> Result<[u32; 3], Refusal> {
    let dimension = header.need("dimension")?;
    if dimension != "3" {
        return Err(unusable("dimension", dimension, "3"));
    }
    header.need("sizes")?;
    checked_size(header.numbers("sizes")?.unwrap_or_default())
}

fn sample_type(header: &Header) -> Result<SampleType, Refusal> {
    let name = header.need("type")?;
    SampleType::from_name(name)
        .ok_or_else(|| unusable("type", name, "integers of 8, 16 or 32 bits, float or double"))
}

/// In which order bytes are; of single bytes and of text nobody asks.
fn byte_order(header: &Header) -> Result<ByteOrder, Refusal> {
    match header.get("endian") {
        Some("little") => Ok(ByteOrder::Little),
        Some("big") => Ok(ByteOrder::Big),
        Some(other) => Err(unusable("endian", other, "little or big")),
        None if sample_type(header)?.n_bytes() == 1 || packing(header)? == Packing::Text => {
            Ok(ByteOrder::Little)
        }
        None => Err("its header has no `endian`: little or big".to_owned()),
    }
}

fn packing(header: &Header) -> Result<Packing, Refusal> {
    let name = header.need("encoding")?;
    match name.to_lowercase().as_str() {
        "raw" => Ok(Packing::Plain),
        "gz" | "gzip" => Ok(Packing::Gzip),
        "txt" | "text" | "ascii" => Ok(Packing::Text),
        _ => Err(unusable("encoding", name, "raw, gzip or text")),
    }
}

/// The steps between samples, and where the first one is.
fn grid(header: &Header, size: [u32; 3]) -> Result<(DMat3, DVec3), Refusal> {
    if let Some(n) = header.get("space dimension")
        && n != "3"
    {
        return Err(unusable("space dimension", n, "3"));
    }
    let to_right_front_up = match header.get("space").map(str::to_lowercase).as_deref() {
        Some("left-posterior-superior" | "lps") => DVec3::new(-1.0, -1.0, 1.0),
        Some("left-anterior-superior" | "las") => DVec3::new(-1.0, 1.0, 1.0),
        _ => DVec3::ONE,
    };
    let turn = DMat3::from_diagonal(to_right_front_up);
    if let Some(text) = header.get("space directions") {
        let wanted = "three vectors such as (1,0,0)";
        let unusable = || unusable("space directions", text, wanted);
        let [x, y, z] = vectors(text).ok_or_else(unusable)?;
        let origin = match header.get("space origin") {
            None => DVec3::ZERO,
            Some(text) => {
                let [origin] = vectors(text)
                    .ok_or_else(|| self::unusable("space origin", text, "a vector (x,y,z)"))?;
                origin
            }
        };
        return Ok((turn * DMat3::from_cols(x, y, z), turn * origin));
    }
    let along = |name| Ok::<_, Refusal>(header.numbers::<f64, 3>(name)?.map(DVec3::from_array));
    let (spacings, mins, maxs) = (along("spacings")?, along("axis mins")?, along("axis maxs")?);
    let centers = header.get("centers").or_else(|| header.get("centerings")).unwrap_or_default();
    // Between the middles of the first and the last sample there is one step less than samples.
    let is_cell = |i: usize| centers.split_ascii_whitespace().nth(i) == Some("cell");
    let steps_less = DVec3::from_array([0, 1, 2].map(|i| if is_cell(i) { 0.0 } else { 1.0 }));
    let n_steps = DVec3::from_array(size.map(f64::from)) - steps_less;
    let spacings = match (spacings, mins, maxs) {
        (Some(spacings), ..) => spacings,
        (None, Some(mins), Some(maxs)) => (maxs - mins) / n_steps,
        _ => DVec3::ONE,
    };
    // An axis whose spacing nobody knows is written as nan.
    let spacings = DVec3::select(spacings.is_nan_mask(), DVec3::ONE, spacings);
    let mins = mins.map(|mins| DVec3::select(mins.is_nan_mask(), DVec3::ZERO, mins));
    let first = mins.unwrap_or_default() + 0.5 * (DVec3::ONE - steps_less) * spacings;
    let first = if mins.is_some() { first } else { DVec3::ZERO };
    Ok((turn * DMat3::from_diagonal(spacings), turn * first))
}

/// `N` vectors such as `(1,0,0)`.
fn vectors<const N: usize>(text: &str) -> Option<[DVec3; N]> {
    let vectors: Option<Vec<DVec3>> = text
        .trim()
        .split_terminator(')')
        .map(|vector| {
            let numbers = vector.trim().strip_prefix('(')?.split(',');
            let numbers: Option<Vec<f64>> = numbers.map(|v| v.trim().parse().ok()).collect();
            Some(DVec3::from_array(numbers?.try_into().ok()?))
        })
        .collect();
    vectors?.try_into().ok()
}

/// The bytes of `n` lines after the first `start` bytes.
fn bytes_of_lines(file: &mut File, start: u64, n: u64) -> Result<u64, Refusal> {
    let failed = |error: std::io::Error| format!("its samples cannot be read: {error}");
    file.seek(SeekFrom::Start(start)).map_err(failed)?;
    let mut lines = BufReader::new(file);
    let mut bytes = 0;
    for _ in 0..n {
        match lines.skip_until(b'\n').map_err(failed)? {
            0 => return Err(format!("it has no {n} lines to skip")),
            found => bytes += found as u64,
        }
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::tests::{Folder, ORDERS, bytes, expect, gzip, place, read};

    const START: &str = "NRRD0004\n# by hand\ntype: short\ndimension: 3\nsizes: 2 3 1\n";

    fn attached(fields: &str, samples: &[u8]) -> Result<Volume, Refusal> {
        read("a.nrrd", &[format!("{START}{}\n\n", fields.trim_end()).as_bytes(), samples].concat())
    }

    #[test]
    fn both_orders_plain_packed_and_text() {
        for order in ORDERS {
            let name = format!("{order:?}").to_lowercase();
            let plain = attached(&format!("endian: {name}\nencoding: raw"), &bytes(order));
            expect(&plain.unwrap());
            let packed = gzip(&bytes(order));
            expect(&attached(&format!("endian: {name}\nencoding: gz"), &packed).unwrap());
        }
        expect(&attached("encoding: ascii", b" 0 -1 258\n3 -32768 5\n").unwrap());
    }

    #[test]
    fn samples_beside_the_header() {
        let folder = Folder::new();
        let data = [b"one\ntwo\n??", bytes(ByteOrder::Little).as_slice()].concat();
        folder.with("a b.raw", &data);
        let read = |skip: &str, name: &str| {
            let header = format!(
                "{START}encoding: raw\r\nendian: little\r\n{skip}data file: {name}\nkey:=value"
            );
            Volume::read(&folder.with("a.nhdr", header.as_bytes()), None)
        };
        expect(&read("line skip: 2\nbyteskip: 2\n", "./a b.raw").unwrap());
        expect(&read("byte skip: -1\n", "a b.raw").unwrap());
        assert_eq!(
            read("byte skip: 3\n", "a b.raw").unwrap_err(),
            "it holds 19 bytes of samples, and 2 x 3 x 1 of i16 are 12"
        );
        assert_eq!(read("line skip: 9\n", "a b.raw").unwrap_err(), "it has no 9 lines to skip");
        assert_eq!(
            read("byte skip: -2\n", "a b.raw").unwrap_err(),
            "its `byte skip` is `-2` instead of a number of bytes, or -1 with raw encoding"
        );
        assert_eq!(
            read("", "../a b.raw").unwrap_err(),
            "its samples do not lie beside it: ../a b.raw"
        );
        let several = "its samples lie in several files; only one can be read";
        assert_eq!(read("", "LIST").unwrap_err(), several);
        assert_eq!(read("", "a%03d.raw 1 9 1").unwrap_err(), several);
        assert!(read("", "c.raw").unwrap_err().starts_with("there is no file "));
    }

    #[test]
    fn places() {
        let placed = |fields: &str| {
            let fields = format!("encoding: raw\nendian: little\n{fields}");
            attached(&fields, &bytes(ByteOrder::Little))
        };
        let at = |fields: &str| {
            let volume = placed(fields).unwrap();
            [[0, 0, 0], [1, 1, 1]].map(|ijk| place(&volume, ijk).to_array())
        };
        assert_eq!(at(""), [[0.0; 3], [1.0; 3]]);
        assert_eq!(at("spacings: 2 0.5 nan"), [[0.0; 3], [2.0, 0.5, 1.0]]);
        let directions = "space directions: (0,2,0) (1, 0, 0) (0,0,3)\nspace origin: (5,6,7)";
        assert_eq!(at(directions), [[5.0, 6.0, 7.0], [6.0, 8.0, 10.0]]);
        // Left and back become right and front.
        let medical = format!("space: left-posterior-superior\n{directions}");
        assert_eq!(at(&medical), [[-5.0, -6.0, 7.0], [-6.0, -8.0, 10.0]]);
        let axes = "axis mins: -1 -1 -1\naxis maxs: 1 1 1\ncenters: cell cell cell";
        let near = |found: [[f64; 3]; 2], expected: [[f64; 3]; 2]| {
            for (a, b) in found.as_flattened().iter().zip(expected.as_flattened()) {
                assert!((a - b).abs() < 1e-12, "{found:?}");
            }
        };
        near(at(axes), [[-0.5, -2.0 / 3.0, 0.0], [0.5, 0.0, 2.0]]);
        assert_eq!(at("axis mins: 4 5 6\nspacings: 1 1 1"), [[4.0, 5.0, 6.0], [5.0, 6.0, 7.0]]);
        let flat = placed("space directions: (1,0,0) (1,0,0) (0,0,1)").unwrap_err();
        assert!(flat.starts_with("its samples lie in a plane"), "{flat}");
        assert_eq!(
            placed("space directions: none (1,0,0) (0,0,1)").unwrap_err(),
            "its `space directions` is `none (1,0,0) (0,0,1)` instead of three vectors such as \
             (1,0,0)"
        );
        assert!(placed("space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: x").is_err());
        assert!(placed("space dimension: 2").is_err());
    }

    #[test]
    fn what_is_wrong_is_said() {
        let said = |text: &str| read("a.nrrd", text.as_bytes()).unwrap_err();
        assert_eq!(said("NRRD0009\n"), "it does not start with NRRD0001 to NRRD0005");
        assert_eq!(said("NRRD0004\n"), "its header has no `dimension`");
        assert_eq!(said("NRRD0004\ndimension: 4\n"), "its `dimension` is `4` instead of 3");
        assert_eq!(said("NRRD0004\ndimension: 3\n"), "its header has no `sizes`");
        assert_eq!(
            said("NRRD0004\ndimension: 3\nsizes: 1 2\n"),
            "its `sizes` is `1 2` instead of 3 whole numbers"
        );
        assert_eq!(
            said("NRRD0004\ndimension: 3\nsizes: 1 2 3\nsizes: 3 2 1"),
            "its header has `sizes` twice"
        );
        let said = |fields: &str| attached(fields, &[0; 12]).unwrap_err();
        assert_eq!(said("encoding: raw"), "its header has no `endian`: little or big");
        assert_eq!(
            said("encoding: bzip2\nendian: big"),
            "its `encoding` is `bzip2` instead of raw, gzip or text"
        );
        assert_eq!(
            read("a.nrrd", b"NRRD0004\ndimension: 3\nsizes: 1 1 1\ntype: long long int\n\n")
                .unwrap_err(),
            "its `type` is `long long int` instead of integers of 8, 16 or 32 bits, float or double"
        );
        let text = |samples: &[u8]| attached("encoding: text", samples).unwrap_err();
        assert_eq!(text(b"1 2 3"), "it holds 3 numbers instead of 6");
        assert_eq!(text(b"1 2 3 4 5 99999"), "sample 6 is `99999`, which is no i16");
        assert_eq!(text(b"1 2 3 4 5 \xff"), "its samples are not text");
    }
}
