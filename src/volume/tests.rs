//! Small files of every format, and files that are damaged.

use std::{fs, io::Write as _, path::PathBuf};

use flate2::{
    Compression,
    write::{GzEncoder, ZlibEncoder},
};
use glam::DVec3;
use proptest::prelude::*;
use tempfile::TempDir;

use super::*;

/// Files in a folder that goes when they do.
pub(super) struct Folder(TempDir);

impl Folder {
    pub(super) fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    pub(super) fn with(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join(name);
        fs::write(&path, bytes).unwrap();
        path
    }
}

/// What is read from the only file of a folder.
pub(super) fn read(name: &str, bytes: &[u8]) -> Result<Volume, Refusal> {
    Volume::read(&Folder::new().with(name, bytes), None)
}

pub(super) fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

pub(super) fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// 2 x 3 x 1 samples of i16 and their bytes in both orders.
pub(super) const NUMBERS: [i16; 6] = [0, -1, 258, 3, -32768, 5];

pub(super) fn bytes(order: ByteOrder) -> Vec<u8> {
    let of = |v: i16| match order {
        ByteOrder::Little => v.to_le_bytes(),
        ByteOrder::Big => v.to_be_bytes(),
    };
    NUMBERS.iter().flat_map(|&v| of(v)).collect()
}

pub(super) const ORDERS: [ByteOrder; 2] = [ByteOrder::Little, ByteOrder::Big];

/// The place of the sample (i, j, k).
pub(super) fn place(volume: &Volume, ijk: [u32; 3]) -> DVec3 {
    volume.placing.transform_point3(DVec3::from_array(ijk.map(f64::from)) + 0.5)
}

pub(super) fn expect(volume: &Volume) {
    assert_eq!(volume.size, [2, 3, 1]);
    assert_eq!(volume.samples, Samples::I16(NUMBERS.to_vec()));
    assert_eq!(volume.value([1, 2, 0]), 5.0);
}

proptest! {
    #[test]
    fn no_damaged_header_makes_it_panic(
        which in 0_usize..2,
        places in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..8),
        length: prop::sample::Index,
    ) {
        let (name, header) = [
            (
                "a.nrrd",
                "NRRD0005\ntype: int16\ndimension: 3\nspace: LPS\nsizes: 2 3 1\nline skip: 0\n\
                 space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nbyte skip: -1\n\
                 encoding: raw\nendian: big\n\n",
            ),
            (
                "a.mha",
                "NDims = 3\nDimSize = 2 3 1\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 1 2 3\n\
                 ElementSpacing = 1 1 1\nElementType = MET_SHORT\nHeaderSize = -1\n\
                 ElementDataFile = LOCAL\n",
            ),
        ][which];
        let mut whole = [header.as_bytes(), &bytes(ByteOrder::Big)].concat();
        prop_assert!(read(name, &whole).is_ok());
        for (place, byte) in places {
            let at = place.index(whole.len());
            whole[at] = byte;
        }
        let _ = read(name, &whole);
        let _ = read(name, &whole[..length.index(whole.len())]);
    }

    #[test]
    fn what_is_written_is_read(
        size in prop::array::uniform3(1_u32..9),
        kind in 0_usize..7,
        is_big: bool,
        noise in prop::collection::vec(any::<u32>(), 512),
    ) {
        let n = size.iter().product::<u32>() as usize;
        let noise = &noise[..n];
        let number = |v: u32| if v >> 23 & 0xff == 0xff { 0.5 } else { f32::from_bits(v) };
        let f32s = || noise.iter().map(|&v| number(v));
        let samples = match kind {
            0 => Samples::U8(noise.iter().map(|&v| v as u8).collect()),
            1 => Samples::I8(noise.iter().map(|&v| v as i8).collect()),
            2 => Samples::U16(noise.iter().map(|&v| v as u16).collect()),
            3 => Samples::I16(noise.iter().map(|&v| v as i16).collect()),
            4 => Samples::U32(noise.to_vec()),
            5 => Samples::I32(noise.iter().map(|&v| v as i32).collect()),
            _ => Samples::F32(f32s().collect()),
        };
        let n_bytes = samples.sample_type().n_bytes() as usize;
        let bits: Vec<u32> = match kind {
            6 => f32s().map(f32::to_bits).collect(),
            _ => noise.to_vec(),
        };
        let bytes: Vec<u8> = bits
            .iter()
            .flat_map(|v| {
                let mut bytes = v.to_le_bytes()[..n_bytes].to_vec();
                if is_big {
                    bytes.reverse();
                }
                bytes
            })
            .collect();
        let [x, y, z] = size;
        let sample_type = samples.sample_type();
        let order = if is_big { "big" } else { "little" };
        let nrrd = format!(
            "NRRD0001\ntype: {}\ndimension: 3\nsizes: {x} {y} {z}\n\
             encoding: gzip\nendian: {order}\n\n",
            ["uchar", "int8", "ushort", "short", "uint", "int", "float"][kind],
        );
        let from_nrrd = read("a.nrrd", &[nrrd.as_bytes(), &gzip(&bytes)].concat()).unwrap();
        prop_assert_eq!(from_nrrd.size, size);
        prop_assert_eq!(&from_nrrd.samples, &samples);
        let format = RawFormat {
            byte_order: if is_big { ByteOrder::Big } else { ByteOrder::Little },
            ..RawFormat::new(size, sample_type)
        };
        let from_raw = Volume::read(&Folder::new().with("a", &bytes), Some(&format));
        prop_assert_eq!(from_raw.unwrap(), from_nrrd);
    }
}

#[test]
fn isovalues_out_of_range_are_told_the_range() {
    let volume = read(
        "a.nrrd",
        b"NRRD0001\ntype: uchar\ndimension: 3\nsizes: 2 1 1\nencoding: raw\n\n\x05\x09",
    );
    let volume = volume.unwrap();
    assert_eq!(volume.check_isovalue(5.0), Ok(()));
    assert_eq!(volume.check_isovalue(9.0), Ok(()));
    assert_eq!(
        volume.check_isovalue(9.5).unwrap_err(),
        "9.5 is no isovalue of it: its samples go from 5 to 9"
    );
    let nothing = Volume { samples: Samples::F32(vec![f32::NAN; 2]), ..volume };
    assert_eq!(nothing.check_isovalue(9.0).unwrap_err(), "none of its samples is a number");
}
