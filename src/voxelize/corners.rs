//! The lattice's corner planes in the float type of the intervals, rounded outwards.

use crate::{
    eval::Boxes,
    math::{Lattice, Scalar},
};

/// Corner planes of every axis, each as a lower and an upper bound. Where the type holds a
/// coordinate exactly the two are equal.
pub(super) struct Corners<T> {
    below: [Vec<T>; 3],
    above: [Vec<T>; 3],
    n_voxels: [u32; 3],
}

impl<T: Scalar> Corners<T> {
    pub(super) fn new(lattice: &Lattice) -> Self {
        let n_voxels = lattice.n_voxels();
        let planes = |round: fn(f64) -> T| {
            [0, 1, 2]
                .map(|axis| (0..=n_voxels[axis]).map(|i| round(lattice.corner(axis, i))).collect())
        };
        Self { below: planes(T::below), above: planes(T::above), n_voxels }
    }

    /// Writes the eight children of a node to lanes `first` to `first + 7` of `boxes`, in child
    /// order. `ijk` counts the node in nodes of its level, `edge` is a child's edge in voxels.
    #[inline(always)]
    pub(super) fn write_children(
        &self,
        boxes: &mut Boxes<T>,
        first: usize,
        ijk: [u32; 3],
        edge: u32,
    ) {
        for axis in 0..3 {
            let n = self.n_voxels[axis];
            let start = 2 * ijk[axis] * edge;
            let planes = [start, start + edge, start + 2 * edge].map(|i| i.min(n) as usize);
            let (below, above) = (&self.below[axis], &self.above[axis]);
            let lo = [below[planes[0]], below[planes[1]]];
            let hi = [above[planes[1]], above[planes[2]]];
            let lanes = first..first + 8;
            let (los, his) = (&mut boxes.lo[axis][lanes.clone()], &mut boxes.hi[axis][lanes]);
            for c in 0..8 {
                let half = c >> axis & 1;
                los[c] = lo[half];
                his[c] = hi[half];
            }
        }
    }

    /// The children of a node that lie inside the lattice at least in part, as bits.
    #[inline(always)]
    pub(super) fn present_children(&self, ijk: [u32; 3], edge: u32) -> u8 {
        const UPPER_HALF: [u8; 3] = [0b1010_1010, 0b1100_1100, 0b1111_0000];
        let mut present = u8::MAX;
        for axis in 0..3 {
            if (2 * ijk[axis] + 1) * edge >= self.n_voxels[axis] {
                present &= !UPPER_HALF[axis];
            }
        }
        present
    }

    /// Writes a node to one lane, once rounded outwards and once inwards. `ijk` counts it in nodes
    /// of its level, whose edge is `edge` voxels.
    pub(super) fn write_node(
        &self,
        [outer, inner]: [&mut Boxes<T>; 2],
        lane: usize,
        ijk: [u32; 3],
        edge: u32,
    ) {
        for axis in 0..3 {
            let n = self.n_voxels[axis];
            let planes = [ijk[axis] * edge, (ijk[axis] + 1) * edge].map(|i| i.min(n) as usize);
            outer.lo[axis][lane] = self.below[axis][planes[0]];
            inner.lo[axis][lane] = self.above[axis][planes[0]];
            inner.hi[axis][lane] = self.below[axis][planes[1]];
            outer.hi[axis][lane] = self.above[axis][planes[1]];
        }
    }

    /// Writes the box from corner `first` of the lattice, of the given edge in voxels, to one lane.
    #[inline(always)]
    pub(super) fn write_box(&self, boxes: &mut Boxes<T>, lane: usize, first: [u32; 3], edge: u32) {
        for axis in 0..3 {
            let n = self.n_voxels[axis];
            let last = (first[axis] + edge).min(n);
            boxes.lo[axis][lane] = self.below[axis][first[axis].min(n) as usize];
            boxes.hi[axis][lane] = self.above[axis][last as usize];
        }
    }

    /// The bounds of a plane.
    pub(super) fn plane(&self, axis: usize, index: u32) -> [T; 2] {
        let i = index.min(self.n_voxels[axis]) as usize;
        [self.below[axis][i], self.above[axis][i]]
    }
}
