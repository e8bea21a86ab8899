//! The voxel lattice: where the corners of voxels lie, once and for all.
//!
//! Every corner coordinate is computed by one expression from its lattice index, so that voxels of
//! all octree levels share bit-identical corners and tile the domain without gap or overlap. The
//! expression is odd about the middle of the domain: a symmetric domain has a symmetric lattice.

use glam::DVec3;

/// An axis-aligned box, `min <= max` on every axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The corner with the smallest coordinates.
    pub min: DVec3,
    /// The corner with the largest coordinates.
    pub max: DVec3,
}

impl Aabb {
    /// The middle.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }

    /// Edge lengths.
    #[must_use]
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }
}

/// A box cut into cubic voxels.
#[derive(Clone, Debug)]
pub struct Lattice {
    n_voxels: [u32; 3],
    depth: u32,
    voxel_size: f64,
    corners: [Vec<f64>; 3],
    centers: [Vec<f64>; 3],
}

impl Lattice {
    /// The largest resolution: Morton codes hold 21 bits an axis.
    pub const MAX_RESOLUTION: u32 = 1 << 20;

    /// Cuts `domain` into cubes, `resolution` of them along the longest axis. The other axes get
    /// as many as cover them, to 12 digits; where that is not a whole number the lattice overhangs
    /// equally on both sides.
    ///
    /// # Panics
    /// If the domain is empty or not finite, or `resolution` is 0 or above
    /// [`Lattice::MAX_RESOLUTION`].
    #[must_use]
    pub fn new(domain: Aabb, resolution: u32) -> Self {
        let size = domain.size();
        assert!(size.is_finite() && size.min_element() > 0.0, "the domain must be a finite box");
        assert!((1..=Self::MAX_RESOLUTION).contains(&resolution), "resolution out of range");
        let voxel_size = size.max_element() / f64::from(resolution);
        let center = domain.center();
        // An axis as long as the longest must not gain a voxel by the rounding of the division.
        let n_voxels = size.to_array().map(|s| {
            let n = s / voxel_size;
            ((n - n * 1e-12).ceil() as u32).clamp(1, resolution)
        });
        let half = 0.5 * voxel_size;
        let corners: [Vec<f64>; 3] = [0, 1, 2].map(|axis| {
            let n = i64::from(n_voxels[axis]);
            (0..=n).map(|i| center[axis] + (2 * i - n) as f64 * half).collect()
        });
        let middles = |planes: &Vec<f64>| planes.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
        let centers = corners.each_ref().map(middles);
        let depth =
            n_voxels.iter().fold(2, |depth: u32, n| depth.max(n.next_power_of_two().ilog2()));
        Self { n_voxels, depth, voxel_size, corners, centers }
    }

    /// Voxels along each axis.
    #[must_use]
    pub fn n_voxels(&self) -> [u32; 3] {
        self.n_voxels
    }

    /// Levels of the octree below its root, at least 2: the least with `2^depth` at least every
    /// count.
    #[must_use]
    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// Edge length of a voxel, in scene units.
    #[must_use]
    pub fn voxel_size(&self) -> f64 {
        self.voxel_size
    }

    /// Coordinate of corner plane `index` of `axis`; indices beyond the lattice give its last
    /// plane, so that octree nodes that overhang the domain are cut to it.
    #[must_use]
    pub fn corner(&self, axis: usize, index: u32) -> f64 {
        self.corners[axis][index.min(self.n_voxels[axis]) as usize]
    }

    /// The voxel that a point lies in; the nearest one if it lies outside.
    #[must_use]
    pub fn voxel_at(&self, p: DVec3) -> [u32; 3] {
        [0, 1, 2].map(|axis| {
            // Negative numbers become 0.
            let at = ((p[axis] - self.corners[axis][0]) / self.voxel_size) as u32;
            at.min(self.n_voxels[axis] - 1)
        })
    }

    /// Centre of a voxel.
    ///
    /// # Panics
    /// If the voxel is not in the lattice.
    #[inline]
    #[must_use]
    pub fn voxel_center(&self, ijk: [u32; 3]) -> DVec3 {
        let [x, y, z] = &self.centers;
        DVec3::new(x[ijk[0] as usize], y[ijk[1] as usize], z[ijk[2] as usize])
    }

    /// The box that all voxels together fill.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let at =
            |end: fn(&Vec<f64>) -> f64| DVec3::from_array([0, 1, 2].map(|a| end(&self.corners[a])));
        Aabb { min: at(|c| c[0]), max: at(|c| c[c.len() - 1]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(min: [f64; 3], max: [f64; 3], resolution: u32) -> Lattice {
        Lattice::new(Aabb { min: min.into(), max: max.into() }, resolution)
    }

    #[test]
    fn cube_gets_the_resolution_on_every_axis() {
        let l = lattice([-1.1; 3], [1.1; 3], 500);
        assert_eq!((l.n_voxels(), l.depth()), ([500; 3], 9));
    }

    #[test]
    fn short_axes_overhang_equally() {
        let l = lattice([0.0, 0.0, 0.0], [4.0, 1.0, 0.9], 4);
        assert_eq!(l.n_voxels(), [4, 1, 1]);
        assert_eq!(l.bounds().min.to_array(), [0.0, 0.0, 0.45 - 0.5]);
        assert_eq!(l.bounds().max.to_array(), [4.0, 1.0, 0.45 + 0.5]);
    }

    #[test]
    fn symmetric_domain_has_a_symmetric_lattice() {
        let l = lattice([-1.3; 3], [1.3; 3], 37);
        for i in 0..=37 {
            assert_eq!(l.corner(0, i), -l.corner(0, 37 - i));
        }
    }
}
