//! The z-buffer: for every pixel, the nearest voxel of two kinds.
//!
//! An entry is one integer, the bits of the depth (positive `f32`, so that their order is the
//! order of depths) above the voxel's identity. The smaller integer wins, equal depths go to the
//! smaller identity. A minimum does not depend on the order of its operands, so neither does the
//! buffer on threads.

use std::sync::atomic::{AtomicU64, Ordering};

/// What a pixel's ray meets at some depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hit {
    pub(super) depth: f32,
    pub(super) id: u32,
}

/// Depth and identity as one number whose order is that of depth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Key(u64);

impl Key {
    #[inline]
    pub(super) fn new(depth: f64, id: u32) -> Self {
        Self((u64::from((depth as f32).to_bits()) << 32) | u64::from(id))
    }
}

/// One cell a pixel of the nearest hit of a kind.
pub(super) struct Plane(Vec<AtomicU64>);

impl Plane {
    fn new(n_pixels: usize) -> Self {
        Self((0..n_pixels).map(|_| AtomicU64::new(u64::MAX)).collect())
    }

    /// Keeps the nearer of what is there and `key`.
    #[inline]
    pub(super) fn offer(&self, pixel: usize, key: Key) {
        // Most offers lose, and a load is far cheaper than a locked instruction.
        if !self.beats(pixel, key) {
            self.0[pixel].fetch_min(key.0, Ordering::Relaxed);
        }
    }

    /// Whether what is there is nearer than `key`.
    #[inline]
    pub(super) fn beats(&self, pixel: usize, key: Key) -> bool {
        self.0[pixel].load(Ordering::Relaxed) < key.0
    }

    /// What is there.
    pub(super) fn get(&self, pixel: usize) -> Option<Hit> {
        let bits = self.0[pixel].load(Ordering::Relaxed);
        let hit = Hit { depth: f32::from_bits((bits >> 32) as u32), id: bits as u32 };
        (bits != u64::MAX).then_some(hit)
    }
}

/// The nearest hits of all pixels.
pub(super) struct ZBuffer {
    /// Voxels in whose cube the ray gets to the tangent plane or beyond.
    pub(super) met: Plane,
    /// Voxels whose cube the ray leaves before it gets to the tangent plane.
    pub(super) covered: Plane,
}

impl ZBuffer {
    pub(super) fn new(n_pixels: usize) -> Self {
        Self { met: Plane::new(n_pixels), covered: Plane::new(n_pixels) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_wins_and_ties_go_to_the_smaller_id() {
        let plane = Plane::new(1);
        assert_eq!(plane.get(0), None);
        for (depth, id) in [(2.0, 3), (1.0, 9), (1.0, 7), (1.0, 8), (f64::from(f32::MAX), 0)] {
            plane.offer(0, Key::new(depth, id));
        }
        assert_eq!(plane.get(0), Some(Hit { depth: 1.0, id: 7 }));
        assert!(plane.beats(0, Key::new(1.0, 8)) && !plane.beats(0, Key::new(0.5, u32::MAX)));
    }
}
