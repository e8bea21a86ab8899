//! MetaImage: header and samples in one file (`.mha`) or in two (`.mhd`).
//!
//! *Based on:* the MetaIO library of ITK, itk.org/Wiki/MetaIO/Documentation. Coordinates are taken
//! as they stand: the format does not say where its axes point.

use std::path::Path;

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
    for (name, right) in [("ObjectType", "Image"), ("NDims", "3"), ("ElementNumberOfChannels", "1")]
    {
        match header.get(name) {
            Some(value) if value != right => return Err(unusable(name, value, right)),
            None if name == "NDims" => return Err(format!("its header has no `{name}`")),
            _ => {}
        }
    }
    header.need("DimSize")?;
    let size = checked_size(header.numbers("DimSize")?.unwrap_or_default())?;
    let placing = placing(steps(&header)?, first(&header)?)?;
    let data = match header.need("ElementDataFile")? {
        "LOCAL" | "Local" | "local" => None,
        name if name.starts_with("LIST") || name.contains('%') => {
            return Err("its samples lie in several files; only one can be read".to_owned());
        }
        name => Some(name),
    };
    let (file, length) = open_data(path, data)?;
    let is_packed = flag(&header, "CompressedData", false)?;
    let is_binary = flag(&header, "BinaryData", true)?;
    let mut stored = Stored {
        size,
        sample_type: sample_type(&header)?,
        byte_order: byte_order(&header)?,
        packing: match (is_binary, is_packed) {
            (false, _) => Packing::Text,
            (true, true) => Packing::Zlib,
            (true, false) => Packing::Plain,
        },
        start: if data.is_none() { header.end } else { 0 },
        skip: 0,
    };
    match header.numbers::<i64, 1>("HeaderSize")? {
        // The samples end with the file.
        Some([-1]) if stored.packing == Packing::Plain => {
            stored.start = length.saturating_sub(stored.n_bytes());
        }
        Some([n]) if data.is_some() => {
            stored.start = u64::try_from(n).map_err(|_| {
                unusable("HeaderSize", &n.to_string(), "a number of bytes, or -1 without packing")
            })?;
        }
        _ => {}
    }
    let samples = stored.samples((file, length), max_memory)?;
    Ok(Volume { size, samples, placing })
}

/// One line of the header; the last one says where the samples are.
fn line(number: usize, text: &str) -> Result<Line, Refusal> {
    let Some((name, value)) = text.split_once('=') else {
        return match text.trim().is_empty() {
            true => Ok(Line::Other),
            false => Err(format!("line {} of its header is not `name = value`", number + 1)),
        };
    };
    let field = (name.trim().to_owned(), value.to_owned());
    Ok(match field.0.as_str() {
        "ElementDataFile" => Line::Last(field.0, field.1),
        // There may be many.
        "Comment" => Line::Other,
        _ => Line::Field(field.0, field.1),
    })
}

fn sample_type(header: &Header) -> Result<SampleType, Refusal> {
    let name = header.need("ElementType")?;
    Ok(match name {
        "MET_UCHAR" => SampleType::U8,
        "MET_CHAR" => SampleType::I8,
        "MET_USHORT" => SampleType::U16,
        "MET_SHORT" => SampleType::I16,
        // Long is 32 bits in MetaIO.
        "MET_UINT" | "MET_ULONG" => SampleType::U32,
        "MET_INT" | "MET_LONG" => SampleType::I32,
        "MET_FLOAT" => SampleType::F32,
        "MET_DOUBLE" => SampleType::F64,
        _ => {
            let wanted = "MET_UCHAR, MET_CHAR, MET_USHORT, MET_SHORT, MET_UINT, MET_INT, \
                          MET_FLOAT or MET_DOUBLE";
            return Err(unusable("ElementType", name, wanted));
        }
    })
}

fn byte_order(header: &Header) -> Result<ByteOrder, Refusal> {
    let is_big = match header.get("ElementByteOrderMSB") {
        Some(_) => flag(header, "ElementByteOrderMSB", false)?,
        None => flag(header, "BinaryDataByteOrderMSB", false)?,
    };
    Ok(if is_big { ByteOrder::Big } else { ByteOrder::Little })
}

fn flag(header: &Header, name: &str, usual: bool) -> Result<bool, Refusal> {
    let Some(value) = header.get(name) else { return Ok(usual) };
    match value.to_lowercase().as_str() {
        "true" | "t" | "1" => Ok(true),
        "false" | "f" | "0" => Ok(false),
        _ => Err(unusable(name, value, "True or False")),
    }
}

/// The field that is there, under the first of its names.
fn any<'a>(header: &Header, names: &[&'a str]) -> Option<&'a str> {
    names.iter().copied().find(|name| header.get(name).is_some())
}

/// The steps along the axes: unit vectors, axis after axis, times the spacings.
fn steps(header: &Header) -> Result<DMat3, Refusal> {
    let axes = match any(header, &["TransformMatrix", "Rotation", "Orientation"]) {
        Some(name) => header.numbers::<f64, 9>(name)?,
        None => None,
    };
    let axes = axes.map_or(DMat3::IDENTITY, |axes| DMat3::from_cols_array(&axes));
    let spacing = match any(header, &["ElementSpacing", "ElementSize"]) {
        Some(name) => header.numbers::<f64, 3>(name)?,
        None => None,
    };
    Ok(axes * DMat3::from_diagonal(spacing.unwrap_or([1.0; 3]).into()))
}

/// Where the first sample is.
fn first(header: &Header) -> Result<DVec3, Refusal> {
    match any(header, &["Offset", "Position", "Origin"]) {
        Some(name) => Ok(header.numbers::<f64, 3>(name)?.unwrap_or_default().into()),
        None => Ok(DVec3::ZERO),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::tests::{Folder, ORDERS, bytes, expect, place, read, zlib};

    const START: &str = "ObjectType = Image\nNDims = 3\nDimSize = 2 3 1\nElementType = MET_SHORT\n";

    fn local(fields: &str, samples: &[u8]) -> Result<Volume, Refusal> {
        let header = format!("{START}{fields}ElementDataFile = LOCAL\n");
        read("a.mha", &[header.as_bytes(), samples].concat())
    }

    #[test]
    fn both_orders_plain_packed_and_text() {
        for (order, is_big) in ORDERS.into_iter().zip(["False", "True"]) {
            let fields = format!("BinaryData = True\nBinaryDataByteOrderMSB = {is_big}\n");
            expect(&local(&fields, &bytes(order)).unwrap());
            let fields = format!("CompressedData = True\nElementByteOrderMSB = {is_big}\n");
            expect(&local(&fields, &zlib(&bytes(order))).unwrap());
        }
        expect(&local("BinaryData = False\n", b"0 -1 258 3 -32768 5").unwrap());
    }

    #[test]
    fn samples_beside_the_header() {
        let folder = Folder::new();
        folder.with("a.raw", &[b"abc", bytes(ByteOrder::Little).as_slice()].concat());
        let read = |fields: &str, name: &str| {
            let header = format!("{START}{fields}ElementDataFile = {name}\n");
            Volume::read(&folder.with("a.mhd", header.as_bytes()), None)
        };
        expect(&read("HeaderSize = 3\n", "a.raw").unwrap());
        expect(&read("HeaderSize = -1\n", "a.raw").unwrap());
        assert_eq!(
            read("", "a.raw").unwrap_err(),
            "it holds 15 bytes of samples, and 2 x 3 x 1 of i16 are 12"
        );
        assert!(read("", "/a.raw").unwrap_err().contains("do not lie beside it"));
        assert!(read("", "LIST").unwrap_err().contains("several files"));
    }

    #[test]
    fn places() {
        let volume = local(
            "TransformMatrix = 0 1 0 -1 0 0 0 0 1\nElementSpacing = 2 3 4\nOffset = 10 20 30\n",
            &bytes(ByteOrder::Little),
        );
        let volume = volume.unwrap();
        assert_eq!(place(&volume, [0, 0, 0]), DVec3::new(10.0, 20.0, 30.0));
        assert_eq!(place(&volume, [1, 0, 0]), DVec3::new(10.0, 22.0, 30.0));
        assert_eq!(place(&volume, [0, 1, 1]), DVec3::new(7.0, 20.0, 34.0));
    }

    #[test]
    fn what_is_wrong_is_said() {
        let said = |text: &str| read("a.mhd", text.as_bytes()).unwrap_err();
        assert_eq!(said(""), "its header has no `NDims`");
        assert_eq!(said("NDims = 2\n"), "its `NDims` is `2` instead of 3");
        assert_eq!(said("NDims = 3\nhello\n"), "line 2 of its header is not `name = value`");
        assert_eq!(said("NDims = 3\nDimSize = 1 1 1\n"), "its header has no `ElementDataFile`");
        let said = |fields: &str| local(fields, &[0; 12]).unwrap_err();
        assert_eq!(
            said("CompressedData = x\n"),
            "its `CompressedData` is `x` instead of True or False"
        );
        assert_eq!(
            said("ElementNumberOfChannels = 3\n"),
            "its `ElementNumberOfChannels` is `3` instead of 1"
        );
        assert_eq!(
            said("ElementSpacing = 1 x 1\n"),
            "its `ElementSpacing` is `1 x 1` instead of 3 numbers"
        );
    }
}
