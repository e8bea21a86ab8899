//! The z-buffer of a tile: for every sample, the nearest voxel of two kinds.
//!
//! An entry is one integer, the bits of the depth (positive `f32`, so that their order is the
//! order of depths) above the voxel's identity. The smaller integer wins, equal depths go to the
//! smaller identity, so that what is drawn does not depend on the order of drawing.

use super::tile::Tile;

/// What a sample's ray meets at some depth.
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

/// One cell a sample of the nearest hit of a kind.
pub(super) struct Plane(Vec<u64>);

impl Plane {
    fn new(n_samples: usize) -> Self {
        Self(vec![u64::MAX; n_samples])
    }

    /// Keeps the nearer of what is there and `key`.
    #[inline]
    pub(super) fn offer(&mut self, sample: usize, key: Key) {
        let cell = &mut self.0[sample];
        *cell = (*cell).min(key.0);
    }

    /// Whether what is there is nearer than `key`.
    #[inline]
    pub(super) fn beats(&self, sample: usize, key: Key) -> bool {
        self.0[sample] < key.0
    }

    /// What is there.
    pub(super) fn get(&self, sample: usize) -> Option<Hit> {
        let bits = self.0[sample];
        let hit = Hit { depth: f32::from_bits((bits >> 32) as u32), id: bits as u32 };
        (bits != u64::MAX).then_some(hit)
    }
}

/// The nearest hits of all samples of a tile.
pub(super) struct ZBuffer {
    /// Voxels in whose cube the ray gets to the tangent plane or beyond.
    pub(super) met: Plane,
    /// Voxels whose cube the ray leaves before it gets to the tangent plane.
    pub(super) covered: Plane,
}

impl ZBuffer {
    pub(super) fn new(tile: &Tile) -> Self {
        Self { met: Plane::new(tile.n_samples()), covered: Plane::new(tile.n_samples()) }
    }

    /// Whether every sample of `part`, a part of `tile`, shows something nearer than `depth`.
    pub(super) fn hides(&self, tile: &Tile, part: &Tile, depth: f64) -> bool {
        let key = Key::new(depth, 0).0;
        part.rows.clone().all(|row| {
            let first = tile.sample(part.columns.start, row);
            self.met.0[first..first + part.columns.len()].iter().all(|&cell| cell < key)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_wins_and_ties_go_to_the_smaller_id() {
        let mut plane = Plane::new(1);
        assert_eq!(plane.get(0), None);
        for (depth, id) in [(2.0, 3), (1.0, 9), (1.0, 7), (1.0, 8), (f64::from(f32::MAX), 0)] {
            plane.offer(0, Key::new(depth, id));
        }
        assert_eq!(plane.get(0), Some(Hit { depth: 1.0, id: 7 }));
        assert!(plane.beats(0, Key::new(1.0, 8)) && !plane.beats(0, Key::new(0.5, u32::MAX)));
    }
}
