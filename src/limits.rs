//! What the machine holds, asked before it is taken.

use std::fs;

use crate::{Error, Result, raster::ImageSettings};

/// The part of the machine's memory that one of the two large things, voxels or picture, may take.
const SHARE: f64 = 0.375;

/// Bytes a voxel takes while the octree is put together: its parts and the whole at once.
const BYTES_PER_VOXEL: u64 = 12;

/// Bytes a pixel takes: the layers of a frame, two z-buffers, and the rows being encoded.
const BYTES_PER_PIXEL: u64 = 96;

/// How many voxels the memory holds, at most what 32 bits count.
#[must_use]
pub fn max_voxels() -> u32 {
    let fitting = room().map_or(u64::MAX, |bytes| bytes / BYTES_PER_VOXEL);
    u32::try_from(fitting).unwrap_or(u32::MAX)
}

/// Whether the memory holds a picture of this size.
///
/// # Errors
/// [`Error::Limit`] if it does not.
pub fn check_image(image: &ImageSettings) -> Result<()> {
    let n_pixels = u64::from(image.width) * u64::from(image.height);
    let needed = n_pixels.saturating_mul(BYTES_PER_PIXEL);
    match room() {
        Some(room) if needed > room => Err(Error::Limit(format!(
            "a picture of {} x {} pixels needs {} MiB, and {} MiB are what the machine has for \
             it; lower `width` and `height` in [image]",
            image.width,
            image.height,
            needed >> 20,
            room >> 20,
        ))),
        _ => Ok(()),
    }
}

/// Bytes that one large thing may take; nothing where the system does not tell.
fn room() -> Option<u64> {
    let total = kibibytes("/proc/meminfo", "MemTotal:")?;
    Some((total as f64 * 1024.0 * SHARE) as u64)
}

/// The most memory this process has held; nothing where the system does not tell (all but Linux).
#[must_use]
pub fn peak_memory_bytes() -> Option<u64> {
    Some(1024 * kibibytes("/proc/self/status", "VmHWM:")?)
}

/// The number behind `key` in one of the kernel's tables.
fn kibibytes(table: &str, key: &str) -> Option<u64> {
    let text = fs::read_to_string(table).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    line.trim().strip_suffix("kB")?.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_larger_than_any_memory_is_refused() {
        let image = |side| ImageSettings {
            width: side,
            height: side,
            background: None,
            lights: Vec::new(),
        };
        assert!(check_image(&image(64)).is_ok());
        if room().is_some() {
            let error = check_image(&image(u32::MAX)).unwrap_err().to_string();
            assert!(error.contains("lower `width` and `height`"), "{error}");
        }
    }
}
