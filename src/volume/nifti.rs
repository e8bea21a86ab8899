//! NIfTI-1: one file (`.nii`, `.nii.gz`) or a header (`.hdr`) beside its samples (`.img`).
//!
//! *Based on:* R. Cox and others, "nifti1.h", nifti.nimh.nih.gov/nifti-1: the layout of the header and
//! the three methods of orientation. World coordinates are x to the right, y to the front, z up.

use std::path::Path;

use glam::{DMat3, DVec3};

use super::{
    ByteOrder, Refusal, Sample, SampleType, Samples, Volume,
    bytes::{Packing, Stored, head},
    checked_size,
    placing::placing,
    with_samples,
};
use crate::files;

/// The bytes of a header.
const N_BYTES: usize = 348;

pub(super) fn read(path: &Path, max_memory: Option<u64>) -> Result<Volume, Refusal> {
    let header = Header::read(path)?;
    let size = header.size()?;
    let (steps, first) = header.grid();
    let placing = placing(steps, first)?;
    let (data, usual_offset) = match header.bytes[344..] {
        [b'n', b'+', b'1', 0] => (path.to_owned(), 352.0),
        [b'n', b'i', b'1', 0] => (path.with_extension("img"), 0.0),
        _ => return Err("it is ANALYZE or damaged: its header does not end with n+1 or ni1".into()),
    };
    let offset = match header.f32_at(108) {
        0.0 => usual_offset,
        offset => offset,
    };
    if offset < usual_offset.min(N_BYTES as f64) || offset.fract() != 0.0 || offset > 1e15 {
        return Err(format!("its samples start at byte {offset}; {usual_offset} is usual"));
    }
    let stored = Stored {
        size,
        sample_type: header.sample_type()?,
        byte_order: header.byte_order,
        packing: packing(&data)?,
        start: 0,
        skip: offset as u64,
    };
    let samples = header.scaled(stored.samples(files::open(&data)?, max_memory)?);
    Ok(Volume { size, samples, placing })
}

/// Packed files start with gzip's two bytes, whatever their name is; the first byte of a header is 0,
/// 1 or 92.
fn packing(path: &Path) -> Result<Packing, Refusal> {
    let first = head(files::open(path)?.0, Packing::Plain, 2)?;
    Ok(if first == [0x1f, 0x8b] { Packing::Gzip } else { Packing::Plain })
}

struct Header {
    bytes: [u8; N_BYTES],
    byte_order: ByteOrder,
}

impl Header {
    fn read(path: &Path) -> Result<Self, Refusal> {
        let bytes = head(files::open(path)?.0, packing(path)?, N_BYTES)?;
        let bytes: [u8; N_BYTES] = bytes
            .try_into()
            .map_err(|bytes: Vec<u8>| format!("it ends after {} bytes of 348", bytes.len()))?;
        let byte_order = match bytes[..4] {
            [0x5c, 1, 0, 0] => ByteOrder::Little,
            [0, 0, 1, 0x5c] => ByteOrder::Big,
            [0x1c, 2, 0, 0] | [0, 0, 2, 0x1c] => {
                return Err("it is NIfTI-2; NIfTI-1 can be read".to_owned());
            }
            _ => return Err("it does not start with 348, the length of its header".to_owned()),
        };
        Ok(Self { bytes, byte_order })
    }

    fn number<const N: usize>(&self, at: usize) -> [u8; N] {
        let mut number = [0; N];
        number.copy_from_slice(&self.bytes[at..at + N]);
        if self.byte_order == ByteOrder::Big {
            number.reverse();
        }
        number
    }

    fn i16_at(&self, at: usize) -> i16 {
        i16::from_le_bytes(self.number(at))
    }

    fn f32_at(&self, at: usize) -> f64 {
        f64::from(f32::from_le_bytes(self.number(at)))
    }

    fn vector_at(&self, at: usize) -> DVec3 {
        DVec3::from_array([0, 4, 8].map(|i| self.f32_at(at + i)))
    }

    /// The sides of three axes; further ones must be 1 long.
    fn size(&self) -> Result<[u32; 3], Refusal> {
        let n_axes = self.i16_at(40);
        if !(3..=7).contains(&n_axes) {
            return Err(format!("it has {n_axes} axes instead of 3"));
        }
        let sides: Vec<i16> = (1..=n_axes as usize).map(|i| self.i16_at(40 + 2 * i)).collect();
        if sides[3..].iter().any(|&side| side != 1) {
            let sides: Vec<String> = sides.iter().map(i16::to_string).collect();
            let sides = sides.join(" x ");
            return Err(format!("its size is {sides}; it would have to be one volume of 3 axes"));
        }
        match [sides[0], sides[1], sides[2]].map(u64::try_from) {
            [Ok(x), Ok(y), Ok(z)] => checked_size([x, y, z]),
            _ => Err(format!("its size is {} x {} x {}", sides[0], sides[1], sides[2])),
        }
    }

    fn sample_type(&self) -> Result<SampleType, Refusal> {
        Ok(match self.i16_at(70) {
            2 => SampleType::U8,
            4 => SampleType::I16,
            8 => SampleType::I32,
            16 => SampleType::F32,
            64 => SampleType::F64,
            256 => SampleType::I8,
            512 => SampleType::U16,
            768 => SampleType::U32,
            other => {
                return Err(format!(
                    "its datatype is {other} instead of 2, 4, 8, 16, 64, 256, 512 or 768: \
                     integers of 8, 16 or 32 bits, or floats"
                ));
            }
        })
    }

    /// The steps between samples, and where the first one is: by the affine map of the header, else
    /// by its quaternion, else by spacings alone.
    fn grid(&self) -> (DMat3, DVec3) {
        if self.i16_at(254) > 0 {
            let rows = [280, 296, 312].map(|at| self.vector_at(at));
            let first = DVec3::new(self.f32_at(292), self.f32_at(308), self.f32_at(324));
            return (DMat3::from_cols(rows[0], rows[1], rows[2]).transpose(), first);
        }
        let spacing = self.vector_at(80);
        // Spacings that are missing are 1, as in the library that comes with the standard.
        let spacing = DVec3::select(spacing.cmpgt(DVec3::ZERO), spacing, DVec3::ONE);
        let scale = DMat3::from_diagonal(spacing);
        if self.i16_at(252) <= 0 {
            return (scale, DVec3::ZERO);
        }
        let is_mirrored = self.f32_at(76) < 0.0;
        let mirror = DVec3::new(1.0, 1.0, if is_mirrored { -1.0 } else { 1.0 });
        let turn = rotation(self.vector_at(256));
        (turn * DMat3::from_diagonal(mirror) * scale, self.vector_at(268))
    }

    /// The values that samples stand for: slope times sample plus intercept, if the header has any.
    fn scaled(&self, samples: Samples) -> Samples {
        let [slope, intercept] = [112, 116].map(|at| self.f32_at(at));
        let is_used = slope.is_finite() && slope != 0.0 && intercept.is_finite();
        if !is_used || (slope, intercept) == (1.0, 0.0) {
            return samples;
        }
        let value = |sample: f64| (slope * sample + intercept) as f32;
        Samples::F32(with_samples!(&samples, |list| list
            .iter()
            .map(|v| value(v.to_f64()))
            .collect()))
    }
}

/// The rotation of a unit quaternion whose first part is not negative and left out.
fn rotation(v: DVec3) -> DMat3 {
    let rest = 1.0 - v.length_squared();
    // Close to half a turn, rounding may leave nothing for the first part.
    let (a, v) = if rest < 1e-7 { (0.0, v.normalize_or(DVec3::X)) } else { (rest.sqrt(), v) };
    let DVec3 { x: b, y: c, z: d } = v;
    DMat3::from_cols(
        DVec3::new(a * a + b * b - c * c - d * d, 2.0 * (b * c + a * d), 2.0 * (b * d - a * c)),
        DVec3::new(2.0 * (b * c - a * d), a * a + c * c - b * b - d * d, 2.0 * (c * d + a * b)),
        DVec3::new(2.0 * (b * d + a * c), 2.0 * (c * d - a * b), a * a + d * d - b * b - c * c),
    )
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::volume::tests::{Folder, NUMBERS, ORDERS, bytes, expect, gzip, place, read};

    /// A header, and a way to change it.
    struct Header(Vec<u8>, ByteOrder);

    impl Header {
        fn new(order: ByteOrder) -> Self {
            let mut header = Self(vec![0; 352], order);
            header.put(0, 348_i32.to_le_bytes());
            header.shorts(40, &[3, 2, 3, 1]);
            header.shorts(70, &[4, 16]);
            header.floats(76, &[1.0; 4]);
            header.floats(108, &[352.0, 1.0, 0.0]);
            header.0[344..347].copy_from_slice(b"n+1");
            header
        }

        fn put<const N: usize>(&mut self, at: usize, mut bytes: [u8; N]) {
            if self.1 == ByteOrder::Big {
                bytes.reverse();
            }
            self.0[at..at + N].copy_from_slice(&bytes);
        }

        fn shorts(&mut self, at: usize, values: &[i16]) {
            for (i, v) in values.iter().enumerate() {
                self.put(at + 2 * i, v.to_le_bytes());
            }
        }

        fn floats(&mut self, at: usize, values: &[f32]) {
            for (i, v) in values.iter().enumerate() {
                self.put(at + 4 * i, v.to_le_bytes());
            }
        }

        fn read(&self) -> Result<Volume, Refusal> {
            read("a.nii", &[self.0.as_slice(), &bytes(self.1)].concat())
        }
    }

    fn changed(change: impl Fn(&mut Header)) -> Result<Volume, Refusal> {
        let mut header = Header::new(ByteOrder::Little);
        change(&mut header);
        header.read()
    }

    #[test]
    fn both_orders_plain_packed_and_in_two_files() {
        let folder = Folder::new();
        for order in ORDERS {
            let mut header = Header::new(order);
            expect(&header.read().unwrap());
            let whole = [header.0.as_slice(), &bytes(order)].concat();
            expect(&read("a.nii.gz", &gzip(&whole)).unwrap());
            header.0[344..347].copy_from_slice(b"ni1");
            header.floats(108, &[0.0]);
            folder.with("a.img", &bytes(order));
            expect(&Volume::read(&folder.with("a.hdr", &header.0), None).unwrap());
        }
    }

    #[test]
    fn places() {
        let at = |change: fn(&mut Header)| {
            let volume = changed(change).unwrap();
            [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|ijk| place(&volume, ijk).to_array())
        };
        let spacings = at(|header| header.floats(80, &[2.0, 3.0, 0.0]));
        assert_eq!(spacings, [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 1.0]]);
        // The affine map goes before the quaternion; this one is a reflection.
        let affine = at(|header| {
            header.shorts(252, &[1, 1]);
            let rows = [-2.0, 0.0, 0.0, 90.0, 0.0, 0.0, 3.0, -10.0, 0.0, 4.0, 0.0, 5.0];
            header.floats(280, &rows);
        });
        assert_eq!(
            affine,
            [[90.0, -10.0, 5.0], [88.0, -10.0, 5.0], [90.0, -10.0, 9.0], [90.0, -7.0, 5.0]]
        );
        // A quarter of a turn about z, with the third axis reversed.
        let turned = at(|header| {
            header.shorts(252, &[1, 0]);
            header.floats(76, &[-1.0, 2.0, 3.0, 4.0]);
            header.floats(256, &[0.0, 0.0, std::f32::consts::FRAC_1_SQRT_2, 1.0, 2.0, 3.0]);
        });
        let expected = [[1.0, 2.0, 3.0], [1.0, 4.0, 3.0], [-2.0, 2.0, 3.0], [1.0, 2.0, -1.0]];
        for (a, b) in turned.as_flattened().iter().zip(expected.as_flattened()) {
            assert!((a - b).abs() < 1e-6, "{turned:?}");
        }
    }

    #[test]
    fn values_are_scaled() {
        let volume = changed(|header| header.floats(112, &[0.5, 10.0])).unwrap();
        assert_eq!(volume.samples, Samples::F32(NUMBERS.map(|v| f32::from(v) * 0.5 + 10.0).into()));
        expect(&changed(|header| header.floats(112, &[0.0, 10.0])).unwrap());
        expect(&changed(|header| header.floats(112, &[f32::NAN, 10.0])).unwrap());
    }

    #[test]
    fn what_is_wrong_is_said() {
        let said = |change: fn(&mut Header)| changed(change).unwrap_err();
        assert_eq!(read("a.nii", &[0; 9]).unwrap_err(), "it ends after 9 bytes of 348");
        assert_eq!(
            read("a.nii", &[7; 400]).unwrap_err(),
            "it does not start with 348, the length of its header"
        );
        assert_eq!(
            said(|header| header.put(0, 540_i32.to_le_bytes())),
            "it is NIfTI-2; NIfTI-1 can be read"
        );
        assert_eq!(said(|header| header.shorts(40, &[2])), "it has 2 axes instead of 3");
        expect(&changed(|header| header.shorts(40, &[4, 2, 3, 1, 1])).unwrap());
        assert_eq!(
            said(|header| header.shorts(40, &[4, 2, 3, 1, 5])),
            "its size is 2 x 3 x 1 x 5; it would have to be one volume of 3 axes"
        );
        assert_eq!(said(|header| header.shorts(42, &[-2])), "its size is -2 x 3 x 1");
        assert_eq!(
            said(|header| header.shorts(70, &[128])),
            "its datatype is 128 instead of 2, 4, 8, 16, 64, 256, 512 or 768: integers of 8, 16 or \
             32 bits, or floats"
        );
        assert_eq!(
            said(|header| header.floats(108, &[12.5])),
            "its samples start at byte 12.5; 352 is usual"
        );
        assert!(said(|header| header.floats(108, &[f32::NAN])).contains("start at byte NaN"));
        assert_eq!(
            said(|header| header.shorts(46, &[2])),
            "it holds 12 bytes of samples, and 2 x 3 x 2 of i16 are 24"
        );
        assert!(said(|header| header.0[344] = 0).starts_with("it is ANALYZE"));
        assert_eq!(
            said(|header| {
                header.shorts(254, &[1]);
                header.floats(280, &[f32::INFINITY]);
            }),
            "its samples have no finite places"
        );
    }

    proptest! {
        #[test]
        fn no_damage_makes_it_panic(
            places in prop::collection::vec((0_usize..364, any::<u8>()), 1..6),
            length in 0_usize..365,
            is_packed: bool,
        ) {
            let header = Header::new(ByteOrder::Big);
            let mut whole = [header.0.as_slice(), &bytes(ByteOrder::Big)].concat();
            if is_packed {
                whole = gzip(&whole);
            }
            for (at, byte) in places {
                let n = whole.len();
                whole[at % n] = byte;
            }
            let _ = read("a.nii", &whole[..length.min(whole.len())]);
            let _ = read("a.nii", &whole);
        }
    }
}
