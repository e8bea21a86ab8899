//! Voxels in bricks of 8³: values in their middles and how large they are, near the surface only.
//!
//! Coordinates count the finest voxels from a brick before the grid's first, so that there is room
//! for the layer of phantoms around it: a phantom has the value of the voxel before it, or is outside
//! where the border is capped, and its middle lies on the border. A brick may be all of one voxel, or
//! of a part of one that is larger.
//!
//! *Based on:* A. León Salas, 2008, sections 2.3 and 2.4 (dual grids of voxels of different size,
//! wrapping cells).

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::math::morton_encode;

/// Voxels along an edge of a brick.
pub const SIDE: u32 = 8;
/// Voxels in a brick.
pub const VOXELS: usize = 512;

/// What surfaces do at the border of the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Border {
    /// They end there.
    #[default]
    Open,
    /// What is beyond counts as outside: solids are closed.
    Capped,
}

/// A voxel, or what stands for one beyond the border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leaf {
    /// Its first corner.
    pub base: [u32; 3],
    /// Its edge is `2^level` of the finest voxels.
    pub level: u8,
}

/// Values and sizes in one brick, x fastest.
#[derive(Clone, Debug)]
pub struct Brick {
    /// Counted in bricks.
    pub place: [u32; 3],
    /// Values in the middles of voxels: one for each of the finest, or one for all.
    pub values: Vec<f64>,
    /// Levels of the voxels: one for each of the finest, or one for all.
    pub levels: Vec<u8>,
    /// Bit x + 8 y of slice z: its value is the isovalue or above.
    pub inside: [u64; SIDE as usize],
}

impl Brick {
    /// A brick with these values and levels; what is no number is outside.
    #[must_use]
    pub fn new(place: [u32; 3], values: Vec<f64>, levels: Vec<u8>, isovalue: f64) -> Self {
        let mut inside = [0; SIDE as usize];
        match values.as_slice() {
            [value] => inside = [if *value >= isovalue { u64::MAX } else { 0 }; SIDE as usize],
            many => {
                for (slice, of_slice) in inside.iter_mut().zip(many.chunks(64)) {
                    for (i, &value) in of_slice.iter().enumerate() {
                        *slice |= u64::from(value >= isovalue) << i;
                    }
                }
            }
        }
        Self { place, values, levels, inside }
    }

    /// The value at a voxel of the brick.
    #[inline]
    pub(super) fn value(&self, index: usize) -> f64 {
        self.values[if self.values.len() == 1 { 0 } else { index }]
    }

    #[inline]
    fn level(&self, index: usize) -> u8 {
        self.levels[if self.levels.len() == 1 { 0 } else { index }]
    }

    /// Whether all voxels are of the finest.
    #[inline]
    pub(super) fn is_finest(&self) -> bool {
        self.levels == [0]
    }
}

/// The number of a voxel in its brick.
#[inline]
pub(super) fn index_of([x, y, z]: [u32; 3]) -> usize {
    let [x, y, z] = [x, y, z].map(|i| (i % SIDE) as usize);
    x + SIDE as usize * (y + SIDE as usize * z)
}

/// Bricks near a surface.
#[derive(Debug)]
pub struct Grid {
    /// In Morton order.
    pub(super) bricks: Vec<Brick>,
    numbers: FxHashMap<[u32; 3], u32>,
    /// The finest voxels along each axis.
    size: [u32; 3],
    pub(super) isovalue: f64,
    pub(super) border: Border,
}

impl Grid {
    /// A grid of `size` of the finest voxels, counted without phantoms. `bricks` hold every voxel that
    /// has a corner where the surface may cut a cell, and the first voxel of every larger one.
    #[must_use]
    pub fn new(mut bricks: Vec<Brick>, size: [u32; 3], isovalue: f64, border: Border) -> Self {
        bricks.par_sort_unstable_by_key(|brick| morton_encode(brick.place));
        bricks.dedup_by_key(|brick| brick.place);
        let numbers = bricks.iter().zip(0..).map(|(brick, number)| (brick.place, number)).collect();
        Self { bricks, numbers, size, isovalue, border }
    }

    /// The number of the brick at a place, if there is one.
    #[inline]
    pub(super) fn number_at(&self, place: [u32; 3]) -> Option<u32> {
        self.numbers.get(&place).copied()
    }

    /// Whether a coordinate is that of a voxel or a phantom.
    #[inline]
    pub(super) fn holds(&self, axis: usize, i: u32) -> bool {
        (SIDE - 1..=SIDE + self.size[axis]).contains(&i)
    }

    /// The voxel, or phantom, that holds the finest voxel at `p` of a brick.
    #[inline]
    pub(super) fn leaf(&self, brick: &Brick, p: [u32; 3]) -> Leaf {
        let level = brick.level(index_of(p));
        let base = [0, 1, 2].map(|axis| {
            let is_phantom = p[axis] < SIDE || p[axis] >= SIDE + self.size[axis];
            if is_phantom { p[axis] } else { ((p[axis] - SIDE) >> level << level) + SIDE }
        });
        Leaf { base, level }
    }

    /// The middle of a voxel in the finest voxels from the grid's first corner; a phantom's lies on
    /// the border.
    #[inline]
    pub(super) fn middle(&self, leaf: &Leaf) -> [f64; 3] {
        let half = 0.5 * f64::from(1_u32 << leaf.level);
        [0, 1, 2].map(|axis| {
            let (base, n) = (leaf.base[axis], self.size[axis]);
            if base < SIDE {
                0.0
            } else if base >= SIDE + n {
                f64::from(n)
            } else {
                f64::from(base - SIDE) + half
            }
        })
    }

    /// How far the middle of a voxel is from its faces across `axis`: nothing for phantoms beyond
    /// those.
    #[inline]
    pub(super) fn half_depth(&self, leaf: &Leaf, axis: usize) -> f64 {
        match self.is_beyond(leaf, axis) {
            true => 0.0,
            false => 0.5 * f64::from(1_u32 << leaf.level),
        }
    }

    /// The level of what a voxel takes along `axis`: phantoms are thin.
    #[inline]
    pub(super) fn thickness(&self, leaf: &Leaf, axis: usize) -> u8 {
        if self.is_beyond(leaf, axis) { 0 } else { leaf.level }
    }

    #[inline]
    fn is_beyond(&self, leaf: &Leaf, axis: usize) -> bool {
        !(SIDE..SIDE + self.size[axis]).contains(&leaf.base[axis])
    }

    /// Whether a voxel is beyond the border.
    #[inline]
    pub(super) fn is_phantom(&self, leaf: &Leaf) -> bool {
        (0..3).any(|axis| self.is_beyond(leaf, axis))
    }
}
