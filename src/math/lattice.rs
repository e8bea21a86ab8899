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
    /// The middle of the domain.
    middle: DVec3,
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
            let n = f64::from(n_voxels[axis]);
            (0..=n_voxels[axis]).map(|i| corner(center[axis], f64::from(i), n, half)).collect()
        });
        let depth =
            n_voxels.iter().fold(2, |depth: u32, n| depth.max(n.next_power_of_two().ilog2()));
        Self { n_voxels, depth, voxel_size, middle: center, centers: centers(&corners), corners }
    }

    /// The lattice of the cells `depth` levels below an octant, at least 2, counted in octants of its
    /// level; its voxels are those of this lattice where the level is so many above the voxels.
    /// Cells that are larger than voxels may overhang the domain.
    #[must_use]
    pub fn block(&self, level: u32, ijk: [u64; 3], depth: u32) -> Self {
        self.octant(level, ijk, depth)
    }

    /// The same domain with voxels that are `2^levels` times as large; they may overhang it.
    ///
    /// # Panics
    /// If there are not so many levels.
    #[must_use]
    pub fn coarser(&self, levels: u32) -> Self {
        self.octant(0, [0; 3], self.depth - levels)
    }

    /// The lattice of the cells `depth` levels below an octant.
    fn octant(&self, level: u32, ijk: [u64; 3], depth: u32) -> Self {
        let side = 1 << depth;
        let (cells, half) = self.cells(level + depth);
        let first = ijk.map(|i| i as f64 * f64::from(side));
        let n_voxels = [0, 1, 2].map(|axis| {
            let left = (cells[axis] - first[axis]).ceil();
            left.clamp(1.0, f64::from(side)) as u32
        });
        let corners = [0, 1, 2].map(|axis| {
            let plane = |i: u32| first[axis] + f64::from(i);
            let at = |i| corner(self.middle[axis], plane(i), cells[axis], half);
            (0..=n_voxels[axis]).map(at).collect()
        });
        Self {
            n_voxels,
            depth,
            voxel_size: 2.0 * half,
            middle: self.middle,
            centers: centers(&corners),
            corners,
        }
    }

    /// The box of an octant, cut to the domain; `None` if it lies outside.
    #[must_use]
    pub fn octant_bounds(&self, level: u32, ijk: [u64; 3]) -> Option<Aabb> {
        let (cells, half) = self.cells(level);
        let at = |end: f64| {
            DVec3::from_array([0, 1, 2].map(|axis| {
                let plane = (ijk[axis] as f64 + end).min(cells[axis]);
                corner(self.middle[axis], plane, cells[axis], half)
            }))
        };
        let is_in = (0..3).all(|axis| (ijk[axis] as f64) < cells[axis]);
        is_in.then(|| Aabb { min: at(0.0), max: at(1.0) })
    }

    /// Edge of the octants of a level, in scene units.
    #[must_use]
    pub fn octant_edge(&self, level: u32) -> f64 {
        2.0 * self.cells(level).1
    }

    /// How many octants of a level the domain is long along each axis, and half their edge.
    fn cells(&self, level: u32) -> ([f64; 3], f64) {
        // Powers of two: nothing is rounded.
        let per_voxel = power_of_two(level as i32 - self.depth as i32);
        (self.n_voxels.map(|n| f64::from(n) * per_voxel), 0.5 * self.voxel_size / per_voxel)
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

/// The coordinate of a plane, counted from the first of `n` cells whose edge is twice `half`. On
/// finer and coarser levels of a lattice the same planes have the same coordinates: all numbers but
/// the last differ by powers of two.
fn corner(middle: f64, plane: f64, n: f64, half: f64) -> f64 {
    middle + (2.0 * plane - n) * half
}

/// The middles between planes.
fn centers(corners: &[Vec<f64>; 3]) -> [Vec<f64>; 3] {
    let middles = |planes: &Vec<f64>| planes.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
    corners.each_ref().map(middles)
}

/// 2 to the power `n`, which must be that of a normal number.
fn power_of_two(n: i32) -> f64 {
    f64::from_bits(((n + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Blocks of the last levels have the corners of the lattice.
    #[test]
    fn blocks_are_parts_of_the_lattice() {
        let l = lattice([-1.3, 0.1, 0.0], [1.3, 2.0, 0.7], 300);
        let level = l.depth() - 5;
        for ijk in [[0, 0, 0], [3, 2, 1], [9, 6, 2]] {
            let block = l.block(level, ijk, 5);
            for axis in 0..3 {
                let first = ijk[axis] as u32 * 32;
                let n = block.n_voxels()[axis];
                assert_eq!(n, 32.min(l.n_voxels()[axis] - first));
                for i in 0..=n {
                    assert_eq!(block.corner(axis, i), l.corner(axis, first + i));
                }
            }
            let bounds = l.octant_bounds(level, ijk).unwrap();
            assert_eq!(bounds, block.bounds());
        }
        assert_eq!(l.octant_bounds(level, [10, 0, 0]), None);
        // Two levels up, and thirty down.
        let coarse = l.block(level - 2, [2, 1, 0], 5);
        assert_eq!(coarse.corner(0, 3), l.corner(0, 4 * (64 + 3)));
        let deep = l.block(level + 30, [(5 << 30) + 1, 7 << 28, 0], 5);
        assert_eq!(deep.corner(1, 0), l.corner(1, 7 * 8));
        assert!(deep.corner(0, 0) > l.corner(0, 160) && deep.corner(0, 0) < l.corner(0, 161));
    }

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
