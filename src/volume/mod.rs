//! Sampled volumes, such as CT scans: numbers on a regular grid, read from files or made of
//! formulas.
//!
//! | file | what tells its size and type |
//! |---|---|
//! | anything | [`RawFormat`], which the user gives |
//! | `.nrrd`, `.nhdr` | NRRD: the file itself, or a header beside it |
//! | `.mha`, `.mhd` | MetaImage, likewise |
//! | `.nii`, `.nii.gz`, `.hdr` | NIfTI-1, likewise |
//! | `.cube`, `.cub` | Gaussian cube files |
//!
//! **Places.** Sample (i, j, k) stands at (i + ½, j + ½, k + ½): in the middle of a voxel, so that the
//! grid fills the box from 0 to its size. [`Volume::placing`] leads from there to the scene, whose
//! coordinates are those of the file (x to the right, y to the front, z up in medical files that say
//! so). It may be a reflection: a file may count its rows from the other side.
//!
//! **Inside** is where samples are at or above an isovalue. NaN is outside.

mod band;
mod bytes;
mod components;
mod cube;
mod fit;
mod header;
mod metaimage;
mod nifti;
mod nrrd;
mod placing;
mod raw;
mod room;
mod sampled;
mod samples;
#[cfg(test)]
mod tests;
mod text;
pub mod thesis;

use std::path::Path;

pub use self::{
    bytes::ByteOrder,
    components::{Keep, Kept},
    cube::{BOHR, CubeHeader},
    raw::RawFormat,
    sampled::Quantize,
    samples::{Sample, SampleType, Samples},
};
use glam::{DAffine3, DVec3};

pub(crate) use self::samples::with_samples;
use crate::math::Aabb;

/// Why a file holds no volume or nothing can be had from it, as a sentence without its name.
pub type Refusal = String;

/// The most samples of a volume.
pub const MAX_SAMPLES: u64 = 1 << 31;

/// Samples on a regular grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    /// The number of samples along x, y and z; none is 0, and their product is at most
    /// [`MAX_SAMPLES`].
    pub size: [u32; 3],
    /// As many as `size` says, x fastest.
    pub samples: Samples,
    /// From the coordinates of samples (the first is at (½, ½, ½)) to those of the scene; it is
    /// finite and invertible, and its determinant may be negative.
    pub placing: DAffine3,
}

impl Volume {
    /// Reads a file: as `raw` says, else by its ending.
    ///
    /// # Errors
    /// Why it cannot be read, or what is wrong in it and what would be right.
    pub fn read(path: &Path, raw: Option<&RawFormat>) -> Result<Self, Refusal> {
        Self::read_within(path, raw, None)
    }

    /// As [`Self::read`]; samples and their octree may take `max_memory` bytes, or three quarters of the
    /// machine's where it is `None`.
    ///
    /// # Errors
    /// As [`Self::read`]; also if they need more.
    pub fn read_within(
        path: &Path,
        raw: Option<&RawFormat>,
        max_memory: Option<u64>,
    ) -> Result<Self, Refusal> {
        if let Some(format) = raw {
            return raw::read(path, format, max_memory);
        }
        let name = unpacked_name(path);
        match ending(&name) {
            Some("nrrd" | "nhdr") => nrrd::read(path, max_memory),
            Some("mha" | "mhd") => metaimage::read(path, max_memory),
            Some("nii" | "hdr") => nifti::read(path, max_memory),
            Some("cube" | "cub") => cube::read(path, None, max_memory),
            Some("raw") => Err(raw::unknown(&name)),
            Some("xz") => Err("it is packed with xz: unpack it first (xz -dk)".to_owned()),
            _ => Err("the name must end in .nrrd, .nhdr, .mha, .mhd, .nii, .nii.gz, .hdr, .cube \
                      or .cub; any other file needs its size and type of samples"
                .to_owned()),
        }
    }

    /// Reads one orbital of a cube file: the one that has this number in the file's list.
    ///
    /// # Errors
    /// As [`Self::read_within`]; also if there is no such orbital.
    pub fn read_orbital(
        path: &Path,
        orbital: i64,
        max_memory: Option<u64>,
    ) -> Result<Self, Refusal> {
        cube::read(path, Some(orbital), max_memory)
    }

    /// The bytes that the samples and an octree of them take, at most.
    #[must_use]
    pub fn bytes_with_octree(&self) -> u64 {
        room::bytes_with_octree(self.samples.len() as u64, self.samples.sample_type())
    }

    /// Whether some sample is below `isovalue`, or no number.
    #[must_use]
    pub fn has_outside(&self, isovalue: f64) -> bool {
        with_samples!(&self.samples, |values| values
            .iter()
            .any(|value| value.to_f64() < isovalue || value.to_f64().is_nan()))
    }

    /// The smallest and the largest sample; NaN is left out, and stands for both where there is no
    /// number.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        self.samples.range()
    }

    /// One sample; `ijk` must be below `size`.
    #[must_use]
    pub fn value(&self, [i, j, k]: [u32; 3]) -> f64 {
        let [nx, ny, _] = self.size.map(|n| n as usize);
        let index = (k as usize * ny + j as usize) * nx + i as usize;
        with_samples!(&self.samples, |values| values[index].to_f64())
    }

    /// The smallest box of the scene that holds all voxels.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let size = DVec3::from_array(self.size.map(f64::from));
        let corner = |c: u32| {
            let sides = DVec3::new(f64::from(c & 1), f64::from(c >> 1 & 1), f64::from(c >> 2));
            self.placing.transform_point3(size * sides)
        };
        let first = corner(0);
        (1..8).map(corner).fold(Aabb { min: first, max: first }, |bounds, corner| Aabb {
            min: bounds.min.min(corner),
            max: bounds.max.max(corner),
        })
    }

    /// Whether some sample is at or above `isovalue` and none of them all are beyond it.
    ///
    /// # Errors
    /// The range of the samples, where `isovalue` is not in it.
    pub fn check_isovalue(&self, isovalue: f64) -> Result<(), Refusal> {
        let [low, high] = self.range();
        if low <= isovalue && isovalue <= high {
            Ok(())
        } else if low.is_nan() {
            Err("none of its samples is a number".to_owned())
        } else {
            Err(format!("{isovalue} is no isovalue of it: its samples go from {low} to {high}"))
        }
    }
}

/// Whether a file is a Gaussian cube file, by its name.
#[must_use]
pub fn is_cube(path: &Path) -> bool {
    matches!(ending(&unpacked_name(path)), Some("cube" | "cub"))
}

/// The name of a file in small letters, without `.gz`.
fn unpacked_name(path: &Path) -> String {
    let name = path.file_name().map(|name| name.to_string_lossy().to_lowercase());
    let name = name.unwrap_or_default();
    name.strip_suffix(".gz").map_or(name.clone(), str::to_owned)
}

/// What follows the last dot of a name.
fn ending(name: &str) -> Option<&str> {
    name.rsplit_once('.').map(|(_, ending)| ending)
}

/// A size that can be had.
///
/// # Errors
/// What is wrong with it.
fn checked_size(size: [u64; 3]) -> Result<[u32; 3], Refusal> {
    let n = size.iter().try_fold(1_u64, |n, &along| n.checked_mul(along));
    match n {
        Some(1..=MAX_SAMPLES) => Ok(size.map(|n| n as u32)),
        Some(0) => Err(format!("its size is {}, and no side may be 0", times(size))),
        _ => Err(format!(
            "its size is {}, and volumes have {MAX_SAMPLES} samples at most",
            times(size)
        )),
    }
}

/// A size in words.
fn times([x, y, z]: [u64; 3]) -> String {
    format!("{x} x {y} x {z}")
}

/// An empty list with room for `n` values, whose name is `what`.
///
/// # Errors
/// There is no memory.
fn with_room<T>(n: usize, what: &str) -> Result<Vec<T>, Refusal> {
    let mut list = Vec::new();
    match list.try_reserve_exact(n) {
        Ok(()) => Ok(list),
        Err(_) => Err(format!("there is no memory for its {n} {what}")),
    }
}
