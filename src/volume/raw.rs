//! Raw files: samples alone. What they are is known to the user only.

use std::path::Path;

use glam::{DMat3, DVec3};

use super::{
    ByteOrder, Refusal, SampleType, Volume,
    bytes::{Failure, Packing, Stored},
    checked_size, fit,
    placing::placing,
};
use crate::files;

/// What a raw file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct RawFormat {
    /// The number of samples along x, y and z.
    pub size: [u32; 3],
    /// How a sample is stored.
    pub sample_type: SampleType,
    /// In which order the bytes of a sample are.
    pub byte_order: ByteOrder,
    /// The distances between samples along x, y and z; negative where an axis runs backwards.
    pub spacing: [f64; 3],
    /// Where the first sample stands in the scene.
    pub origin: [f64; 3],
    /// Bytes before the samples, such as a header that nobody needs; of `.gz` files, unpacked.
    pub skip: u64,
}

impl RawFormat {
    /// Samples of a size and type, little endian, a unit apart, the first one in the origin.
    #[must_use]
    pub fn new(size: [u32; 3], sample_type: SampleType) -> Self {
        Self {
            size,
            sample_type,
            byte_order: ByteOrder::Little,
            spacing: [1.0; 3],
            origin: [0.0; 3],
            skip: 0,
        }
    }

    /// Size and type, where a file's name tells them, as in `lobster_301x324x56_uint8.raw`.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let stem = name.split('.').next().unwrap_or_default();
        let parts: Vec<&str> = stem.split(['_', '-']).collect();
        let size = parts.iter().find_map(|part| {
            let sides: Option<Vec<u32>> = part.split('x').map(|side| side.parse().ok()).collect();
            <[u32; 3]>::try_from(sides?).ok()
        });
        let sample_type = parts.iter().find_map(|part| SampleType::from_name(part));
        Some(Self::new(size?, sample_type?))
    }
}

/// Reads the file as `format` says; it is unpacked if its name ends in `.gz`.
pub(super) fn read(
    path: &Path,
    format: &RawFormat,
    max_memory: Option<u64>,
) -> Result<Volume, Refusal> {
    let packing = match path.extension() {
        Some(ending) if ending.eq_ignore_ascii_case("gz") => Packing::Gzip,
        _ => Packing::Plain,
    };
    let size = checked_size(format.size.map(u64::from))?;
    let RawFormat { sample_type, byte_order, spacing, origin, skip, .. } = *format;
    let steps = DMat3::from_diagonal(spacing.into());
    let placing = placing(steps, DVec3::from_array(origin))?;
    let stored = Stored { size, sample_type, byte_order, packing, start: 0, skip };
    let samples = stored.read(files::open(path)?, max_memory).map_err(|failure| match failure {
        Failure::Length(found) => fit::wrong_length(&stored, found),
        other => other.words(&stored),
    })?;
    Ok(Volume { size, samples, placing })
}

/// What to say of a raw file of which nothing is known.
pub(super) fn unknown(name: &str) -> Refusal {
    let guess = RawFormat::from_name(name).map(|format| {
        let [x, y, z] = format.size;
        format!("; its name suggests {x} x {y} x {z} samples of {}", format.sample_type)
    });
    let guess = guess.unwrap_or_default();
    format!("a raw file does not tell its size and type of samples: say them{guess}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::tests::{Folder, ORDERS, bytes, expect, gzip, place, read};

    #[test]
    fn both_orders_headers_and_packing() {
        let folder = Folder::new();
        for byte_order in ORDERS {
            let format = RawFormat {
                byte_order,
                spacing: [1.0, 2.0, -0.5],
                origin: [7.0, 8.0, 9.0],
                skip: 3,
                ..RawFormat::new([2, 3, 1], SampleType::I16)
            };
            let bytes = [b"abc", bytes(byte_order).as_slice()].concat();
            let plain = Volume::read(&folder.with("a.raw", &bytes), Some(&format)).unwrap();
            expect(&plain);
            assert_eq!(place(&plain, [0, 0, 0]), DVec3::new(7.0, 8.0, 9.0));
            assert_eq!(place(&plain, [1, 1, 1]), DVec3::new(8.0, 10.0, 8.5));
            let packed = Volume::read(&folder.with("a.raw.gz", &gzip(&bytes)), Some(&format));
            assert_eq!(packed.unwrap(), plain);
        }
    }

    #[test]
    fn every_type() {
        let folder = Folder::new();
        let read = |kind, bytes: &[u8]| {
            let format = RawFormat::new([1, 1, 1], kind);
            Volume::read(&folder.with("a.raw", bytes), Some(&format)).unwrap().value([0; 3])
        };
        assert_eq!(read(SampleType::U8, &[200]), 200.0);
        assert_eq!(read(SampleType::I8, &[200]), -56.0);
        assert_eq!(read(SampleType::U16, &40000_u16.to_le_bytes()), 40000.0);
        assert_eq!(read(SampleType::U32, &4_000_000_001_u32.to_le_bytes()), 4_000_000_001.0);
        assert_eq!(read(SampleType::I32, &(-70000_i32).to_le_bytes()), -70000.0);
        assert_eq!(read(SampleType::F32, &0.1_f32.to_le_bytes()), f64::from(0.1_f32));
        assert_eq!(read(SampleType::F64, &0.1_f64.to_le_bytes()), f64::from(0.1_f32));
    }

    #[test]
    fn packed_bytes_are_counted_too() {
        let folder = Folder::new();
        let format = RawFormat::new([2, 3, 1], SampleType::U8);
        let said = |n| {
            let path = folder.with("a.raw.gz", &gzip(&vec![0; n]));
            Volume::read(&path, Some(&format)).unwrap_err()
        };
        assert_eq!(
            said(4),
            "it holds 4 bytes, and 2 x 3 x 1 samples of u8 are 6; what would fit: 2 x 2 x 1, \
             1 x 4 x 1 samples of u8"
        );
        let bomb = "it holds more bytes of samples than the 6 that 2 x 3 x 1 of u8 are";
        assert_eq!([said(7), said(10_000_000)], [bomb, bomb]);
        let path = folder.with("a.raw.gz", b"nothing packed");
        let error = Volume::read(&path, Some(&format)).unwrap_err();
        assert_eq!(error, "its samples cannot be read: invalid gzip header");
    }

    #[test]
    fn sizes_that_cannot_be_had() {
        let path = Folder::new().with("a.raw", b"");
        let said =
            |size| Volume::read(&path, Some(&RawFormat::new(size, SampleType::U8))).unwrap_err();
        assert_eq!(said([4, 0, 4]), "its size is 4 x 0 x 4, and no side may be 0");
        assert_eq!(
            said([u32::MAX; 3]),
            "its size is 4294967295 x 4294967295 x 4294967295, and volumes have 2147483648 \
             samples at most"
        );
    }

    #[test]
    fn names_tell_a_size() {
        assert_eq!(
            read("lobster_301x324x56_uint8.raw", b"").unwrap_err(),
            "a raw file does not tell its size and type of samples: say them; its name suggests \
             301 x 324 x 56 samples of u8"
        );
        assert_eq!(
            read("lobster.raw", b"").unwrap_err(),
            "a raw file does not tell its size and type of samples: say them"
        );
        assert_eq!(RawFormat::from_name("a_1x2_uint8.raw"), None);
        assert!(read("a.raw.xz", b"").unwrap_err().contains("xz -dk"));
        assert!(read("a.tiff", b"").unwrap_err().starts_with("the name must end in .nrrd"));
    }
}
