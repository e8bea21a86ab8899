//! What the machine holds, asked before it is taken.

use crate::{
    Error, Result,
    math::Lattice,
    memory::{self, mebibytes},
    octree::{StorageKind, dense_grid_bytes},
    raster::ImageSettings,
};

pub use crate::memory::peak_bytes as peak_memory_bytes;

/// Bytes a voxel takes while the octree is put together: its parts and the whole at once.
const BYTES_PER_VOXEL: u64 = 11;
/// Bytes a voxel takes at most in another storage, besides the octree that it is made from.
const BYTES_PER_OTHER_VOXEL: u64 = 40;
/// Bytes a pixel takes: the layers of a frame, two z-buffers, and the rows being encoded.
const BYTES_PER_PIXEL: u64 = 120;

/// Bytes a pixel of a contact sheet takes: the page, and what it becomes in the file.
const BYTES_PER_SHEET_PIXEL: u64 = 6;

/// How much memory a run may take.
#[derive(Clone, Copy, Debug)]
pub struct Memory {
    /// Nothing where the user does not say and the system does not tell.
    bytes: Option<u64>,
}

impl Memory {
    /// As many bytes as given, or three quarters of the machine's.
    #[must_use]
    pub fn new(max_bytes: Option<u64>) -> Self {
        Self { bytes: max_bytes.or_else(memory::usual) }
    }

    /// Whether a picture of this size fits.
    ///
    /// # Errors
    /// [`Error::Limit`] if it does not.
    pub fn check_image(&self, image: &ImageSettings) -> Result<()> {
        let needed = image_bytes(image);
        match self.bytes {
            Some(bytes) if needed > bytes => Err(Error::Limit(format!(
                "a picture of {} x {} pixels needs {}, and {} are what it may take; lower `width` \
                 and `height` in [image]",
                image.width,
                image.height,
                mebibytes(needed),
                mebibytes(bytes),
            ))),
            _ => Ok(()),
        }
    }

    /// Whether a contact sheet of this size fits beside one of its pictures.
    ///
    /// # Errors
    /// [`Error::Limit`] if it does not.
    pub fn check_sheet(&self, size_px: [usize; 2], image: &ImageSettings) -> Result<()> {
        let [width, height] = size_px.map(|n| n as u64);
        let needed = width.saturating_mul(height).saturating_mul(BYTES_PER_SHEET_PIXEL);
        let room = self.room(image);
        if needed <= room {
            return Ok(());
        }
        Err(Error::Limit(format!(
            "a contact sheet of {width} x {height} pixels needs {}, and {} are what it may take; \
             write sheet = false in [output], or choose fewer with --frames",
            mebibytes(needed),
            mebibytes(room),
        )))
    }

    /// Whether some `n_voxels` voxels of `lattice` fit beside a picture.
    ///
    /// # Errors
    /// [`Error::Limit`] if they do not; it names the resolution that would fit.
    pub fn check_voxels(
        &self,
        n_voxels: u64,
        lattice: &Lattice,
        storage: StorageKind,
        image: &ImageSettings,
    ) -> Result<()> {
        let room = self.room(image);
        let grid = grid_bytes(storage, lattice.depth());
        let needed = grid.saturating_add(n_voxels.saturating_mul(bytes_per_voxel(storage)));
        let most = u64::from(u32::MAX);
        if needed <= room && n_voxels <= most {
            return Ok(());
        }
        let resolution = lattice.n_voxels().into_iter().max().unwrap_or(1);
        // Voxels grow as the square of the resolution.
        let fits = |n: u32| {
            let part = f64::from(n) / f64::from(resolution);
            let voxels = (n_voxels as f64 * part * part) as u64;
            let depth = n.next_power_of_two().ilog2().max(1);
            let needed = grid_bytes(storage, depth)
                .saturating_add(voxels.saturating_mul(bytes_per_voxel(storage)));
            needed <= room && voxels <= most
        };
        // Two digits are all that an estimate is worth.
        let rounded = |n: u32| n - n % 10_u32.pow(n.max(1).ilog10().saturating_sub(1));
        let advice = match (1..resolution).rev().find(|&n| fits(n)).map(rounded) {
            Some(n) => format!("resolution {n} would fit"),
            None => "no resolution would fit".to_owned(),
        };
        Err(Error::Limit(format!(
            "about {:.1} million voxels are to be expected at resolution {resolution}; they need \
             {}, and {} are what they may take: {advice}, or give more with --max-memory",
            n_voxels as f64 / 1e6,
            mebibytes(needed),
            mebibytes(room),
        )))
    }

    /// Whether solids of samples fit beside a picture that take so many bytes with their octrees.
    ///
    /// # Errors
    /// [`Error::Limit`] if they do not.
    pub fn check_solids(&self, needed: u64, image: &ImageSettings) -> Result<()> {
        let room = self.room(image);
        if needed <= room {
            return Ok(());
        }
        Err(Error::Limit(format!(
            "the volumes and sculptures need {} with their octrees, and {} are what they may take: give \
             more with --max-memory, or lower `size` in [[sculpture]]",
            mebibytes(needed),
            mebibytes(room),
        )))
    }

    /// How many voxels fit beside a picture, at most what 32 bits count.
    #[must_use]
    pub fn max_voxels(
        &self,
        lattice: &Lattice,
        storage: StorageKind,
        image: &ImageSettings,
    ) -> u32 {
        let room = self.room(image).saturating_sub(grid_bytes(storage, lattice.depth()));
        u32::try_from(room / bytes_per_voxel(storage)).unwrap_or(u32::MAX)
    }

    /// Bytes that are left for voxels.
    fn room(&self, image: &ImageSettings) -> u64 {
        self.bytes.map_or(u64::MAX, |bytes| bytes.saturating_sub(image_bytes(image)))
    }
}

fn image_bytes(image: &ImageSettings) -> u64 {
    let n_pixels = u64::from(image.width) * u64::from(image.height);
    n_pixels.saturating_mul(BYTES_PER_PIXEL)
}

fn bytes_per_voxel(storage: StorageKind) -> u64 {
    match storage {
        StorageKind::Morton => BYTES_PER_VOXEL,
        StorageKind::Pointer | StorageKind::Dense => BYTES_PER_VOXEL + BYTES_PER_OTHER_VOXEL,
    }
}

/// Bytes of a storage of `depth` levels that holds nothing.
fn grid_bytes(storage: StorageKind, depth: u32) -> u64 {
    match storage {
        StorageKind::Morton | StorageKind::Pointer => 0,
        StorageKind::Dense => dense_grid_bytes(depth),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{math::Aabb, raster::Shade};
    use glam::DVec3;

    fn image(side: u32) -> ImageSettings {
        ImageSettings {
            width: side,
            height: side,
            background: None,
            lights: Vec::new(),
            shadows: false,
            occlusion: 0.0,
            matcap: None,
            shade: Shade::Voxel,
            samples: 1,
            candidates: true,
            certificate: true,
            curvature: false,
        }
    }

    #[test]
    fn a_picture_larger_than_any_memory_is_refused() {
        let memory = Memory::new(Some(1 << 30));
        assert!(memory.check_image(&image(64)).is_ok());
        let error = memory.check_image(&image(u32::MAX)).unwrap_err().to_string();
        assert!(error.contains("lower `width` and `height`"), "{error}");
    }

    #[test]
    fn a_sheet_larger_than_any_memory_is_refused() {
        let memory = Memory::new(Some(1 << 20));
        assert!(memory.check_sheet([400, 400], &image(8)).is_ok());
        let error = memory.check_sheet([500, 500], &image(8)).unwrap_err().to_string();
        assert!(error.contains("sheet = false"), "{error}");
    }

    #[test]
    fn a_resolution_that_fits_is_named() {
        let lattice = Lattice::new(Aabb { min: DVec3::NEG_ONE, max: DVec3::ONE }, 1024);
        let memory = Memory::new(Some(100 << 20));
        let check =
            |n_voxels, storage| memory.check_voxels(n_voxels, &lattice, storage, &image(64));
        assert!(check(9_000_000, StorageKind::Morton).is_ok());
        let error = check(40_000_000, StorageKind::Morton).unwrap_err().to_string();
        assert!(error.contains("resolution 490 would fit"), "{error}");
        // A grid of 1024³ bits does not fit at all.
        let error = check(1_000_000, StorageKind::Dense).unwrap_err().to_string();
        assert!(error.contains("resolution 510 would fit"), "{error}");
        assert!(memory.max_voxels(&lattice, StorageKind::Morton, &image(64)) > 9_000_000);
    }
}
