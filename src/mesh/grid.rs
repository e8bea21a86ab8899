//! Voxels in bricks of 8³: values in their middles and how large they are, near the surface only.
//!
//! Coordinates count the finest voxels from a brick before the grid's first, so that there is room
//! for the layer of phantoms around it: a phantom has the value of the voxel before it, or is outside
//! where the border is capped, and its middle lies on the border. A brick may be all of one voxel, or
//! of a part of one that is larger.
//!
//! *Based on:* A. León Salas, 2008, sections 2.3 and 2.4 (dual grids of voxels of different size,
//! wrapping cells).

use std::{array, ops::Range};

use rayon::prelude::*;

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

/// How far a value is above the isovalue. Its sign says on which side it is, with the isovalue itself
/// inside; what is no number is outside.
#[must_use]
#[inline]
pub fn offset(value: f64, isovalue: f64) -> f32 {
    // Gradual underflow keeps the sign of a difference, f32 that of a number too small for it; a zero
    // difference is positive.
    (value - isovalue).clamp(f32::MIN.into(), f32::MAX.into()) as f32
}

/// Whether a value is the isovalue or above, from its [`offset`].
#[inline]
pub(super) fn is_inside(offset: f32) -> bool {
    offset >= 0.0 && offset.is_sign_positive()
}

/// Values and sizes of the voxels of a brick, which are asked for where the surface is.
pub trait Voxels: Send + Sync {
    /// A value as it is kept.
    type Value: Copy + Default;

    /// How far the value at a voxel, x fastest, is above the isovalue, as [`offset`].
    fn offset(&self, index: usize) -> f32;

    /// The values of all that are no phantoms.
    fn values(&self, all: &mut [Self::Value; VOXELS]);

    /// How far one of these is above the isovalue.
    fn offset_of(&self, value: Self::Value) -> f32;

    /// The voxel's edge is `2^level` of the finest.
    fn level(&self, index: usize) -> u8;
}

/// Values and sizes that are held: one for each of the finest voxels, or one for all.
#[derive(Clone, Debug)]
pub struct Stored {
    offsets: Box<[f32]>,
    levels: Box<[u8]>,
}

impl Voxels for Stored {
    type Value = f32;

    fn values(&self, all: &mut [f32; VOXELS]) {
        match &*self.offsets {
            [one] => all.fill(*one),
            offsets => all.copy_from_slice(offsets),
        }
    }

    #[inline]
    fn offset_of(&self, offset: f32) -> f32 {
        offset
    }

    #[inline]
    fn offset(&self, index: usize) -> f32 {
        self.offsets[if self.offsets.len() == 1 { 0 } else { index }]
    }

    #[inline]
    fn level(&self, index: usize) -> u8 {
        self.levels[if self.levels.len() == 1 { 0 } else { index }]
    }
}

/// Bit x + 8 y of slice z: something that is true of a voxel.
pub(crate) type Slices = [u64; SIDE as usize];

/// One brick.
#[derive(Clone, Debug)]
pub struct Brick<B = Stored> {
    /// Counted in bricks.
    pub place: [u32; 3],
    pub(super) voxels: B,
    /// Its value is the isovalue or above.
    pub(super) inside: Slices,
    /// It is larger than the finest.
    pub(super) coarse: Slices,
    /// Whether any is.
    pub(super) has_coarse: bool,
}

impl Brick {
    /// A brick with these values, as [`offset`], and levels: one for each of the finest voxels, or one
    /// for all.
    #[must_use]
    pub fn new(place: [u32; 3], offsets: &[f32], levels: &[u8]) -> Self {
        let inside = slices(offsets, |&offset| is_inside(offset));
        let coarse = slices(levels, |&level| level > 0);
        let voxels = Stored { offsets: offsets.into(), levels: levels.into() };
        Self::of(place, voxels, inside, coarse)
    }
}

impl<B: Voxels> Brick<B> {
    /// A brick of which is known already which voxels are inside, and which are larger than the finest.
    pub(crate) fn of(place: [u32; 3], voxels: B, inside: Slices, coarse: Slices) -> Self {
        Self { place, voxels, inside, coarse, has_coarse: coarse != [0; SIDE as usize] }
    }

    /// Whether a voxel is as large as a brick, or larger.
    fn has_large(&self) -> bool {
        // Then it is the only one.
        self.has_coarse && 1 << self.voxels.level(0) >= SIDE
    }

    /// Whether it is a part of a larger voxel.
    pub(crate) fn is_part(&self) -> bool {
        self.has_coarse && 1 << self.voxels.level(0) > SIDE
    }

    /// Whether of the voxels beside another brick some are inside, and whether some are outside; this
    /// brick is the one number x, y, z of the 27 around that.
    pub(crate) fn shows(&self, [x, y, z]: [usize; 3]) -> [bool; 2] {
        // The last, all, or the first in a row.
        const ROWS: [u64; 3] = [1 << 7, 0xff, 1];
        const COLUMN: u64 = 0x0101_0101_0101_0101;
        const COLUMNS: [u64; 3] = [0xff << 56, u64::MAX, 0xff];
        let layer = (COLUMN * ROWS[x]) & COLUMNS[y];
        let slices = &self.inside[[7..8, 0..8, 0..1][z].clone()];
        [0, u64::MAX].map(|flip| slices.iter().fold(0, |any, bits| any | bits ^ flip) & layer != 0)
    }
}

/// What is true of voxels, of which there is one for each or one for all.
#[inline]
pub(crate) fn slices<T>(all: &[T], is: impl Fn(&T) -> bool) -> Slices {
    let mut slices = [0; SIDE as usize];
    if let [one] = all {
        return [if is(one) { u64::MAX } else { 0 }; SIDE as usize];
    }
    for (slice, all) in slices.iter_mut().zip(all.as_chunks::<64>().0) {
        *slice = byte_bits(&array::from_fn(|i| u8::from(is(&all[i]))));
    }
    slices
}

/// A bit for each of the bytes, which are 0 or 1.
#[inline]
pub(crate) fn byte_bits(bytes: &[u8; 64]) -> u64 {
    let mut bits = 0;
    for (y, row) in bytes.as_chunks::<8>().0.iter().enumerate() {
        // Byte x goes to bit 56 + x, and no two sums meet below.
        let row = u64::from_le_bytes(*row).wrapping_mul(0x0102_0408_1020_4080) >> 56;
        bits |= row << (8 * y);
    }
    bits
}

/// The number of a voxel in its brick.
#[inline]
pub(crate) fn index_of([x, y, z]: [u32; 3]) -> usize {
    let [x, y, z] = [x, y, z].map(|i| (i % SIDE) as usize);
    x + SIDE as usize * (y + SIDE as usize * z)
}

/// The number of no brick.
pub(super) const NO_BRICK: u32 = u32::MAX;

/// Bricks near a surface.
#[derive(Debug)]
pub struct Grid<B = Stored> {
    /// In Morton order.
    pub(super) bricks: Vec<Brick<B>>,
    /// Of each, the numbers of the 27 around, x + 3y + 9z, or [`NO_BRICK`].
    pub(super) around: Vec<[u32; 27]>,
    /// The finest voxels along each axis.
    size: [u32; 3],
    pub(super) border: Border,
}

impl<B: Voxels> Grid<B> {
    /// A grid of `size` of the finest voxels, counted without phantoms. `bricks` hold every voxel that
    /// has a corner where the surface may cut a cell, and the first voxel of every larger one.
    #[must_use]
    pub fn new(mut bricks: Vec<Brick<B>>, size: [u32; 3], border: Border) -> Self {
        bricks.par_sort_by_cached_key(|brick| morton_encode(brick.place));
        bricks.dedup_by_key(|brick| brick.place);
        let around = around(&bricks);
        Self { bricks, around, size, border }
    }

    /// The bricks of voxels, counted from the first one; phantoms are where the voxels are that they
    /// are like. In order.
    pub(crate) fn bricks_of_voxels(&self) -> Vec<[u32; 3]> {
        let place = |brick: &Brick<B>| {
            [0, 1, 2].map(|axis| brick.place[axis].clamp(1, self.size[axis].div_ceil(SIDE)) - 1)
        };
        let mut places: Vec<[u32; 3]> = self.bricks.iter().map(place).collect();
        places.par_sort_unstable();
        places.dedup();
        places
    }

    /// The number of the brick at a place, if there is one.
    pub(super) fn number_at(&self, place: [u32; 3]) -> Option<u32> {
        let key = morton_encode(place);
        let found = self.bricks.binary_search_by_key(&key, |brick| morton_encode(brick.place));
        found.ok().map(|number| number as u32)
    }

    /// Whether a brick, or one around it, has a voxel as large as a brick.
    pub(super) fn is_beside_large(&self, number: usize) -> bool {
        let around = &self.around[number];
        around.iter().filter_map(|&beside| self.bricks.get(beside as usize)).any(Brick::has_large)
    }

    /// Whether nowhere a voxel is as large as a brick.
    #[must_use]
    pub fn is_of_small_voxels(&self) -> bool {
        !self.bricks.iter().any(Brick::has_large)
    }

    /// The coordinates of voxels and phantoms.
    #[inline]
    pub(super) fn held(&self, axis: usize) -> Range<u32> {
        SIDE - 1..SIDE + self.size[axis] + 1
    }

    /// The coordinates of voxels.
    #[inline]
    pub(super) fn voxels(&self, axis: usize) -> Range<u32> {
        SIDE..SIDE + self.size[axis]
    }

    /// Whether a coordinate is that of a voxel.
    #[inline]
    pub(super) fn is_voxel(&self, axis: usize, i: u32) -> bool {
        self.voxels(axis).contains(&i)
    }

    /// The voxel, or phantom, that holds the finest voxel at `p` of a brick.
    #[inline]
    pub(super) fn leaf(&self, brick: &Brick<B>, p: [u32; 3]) -> Leaf {
        let level = brick.voxels.level(index_of(p));
        let base = |axis: usize| match self.is_voxel(axis, p[axis]) {
            true => ((p[axis] - SIDE) >> level << level) + SIDE,
            false => p[axis],
        };
        Leaf { base: [base(0), base(1), base(2)], level }
    }

    /// The middle of a voxel in the finest voxels from the grid's first corner; a phantom's lies on
    /// the border.
    #[inline]
    pub(super) fn middle(&self, leaf: &Leaf) -> [f32; 3] {
        let half = 0.5 * (1_u32 << leaf.level) as f32;
        [0, 1, 2].map(|axis| {
            let (base, n) = (leaf.base[axis], self.size[axis]);
            // Exact: there are no more than 2^20 voxels along an axis.
            if base < SIDE {
                0.0
            } else if base >= SIDE + n {
                n as f32
            } else {
                (base - SIDE) as f32 + half
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
        !self.is_voxel(axis, leaf.base[axis])
    }

    /// Whether a voxel is beyond the border.
    #[inline]
    pub(super) fn is_phantom(&self, leaf: &Leaf) -> bool {
        (0..3).any(|axis| self.is_beyond(leaf, axis))
    }
}

/// The numbers of the bricks around each, x + 3y + 9z.
fn around<B: Sync>(bricks: &[Brick<B>]) -> Vec<[u32; 27]> {
    // Bricks one after the other along x, y and z: those beside them in a direction follow each other
    // in the same order.
    let row = |[y, z]: [i64; 2]| (y + (z << 21)) << 21;
    let mut keys: Vec<(i64, u32)> = bricks
        .iter()
        .zip(0..)
        .map(|(brick, number)| {
            let [x, y, z] = brick.place.map(i64::from);
            (x + row([y, z]), number)
        })
        .collect();
    keys.par_sort_unstable();
    let of_run = |run: &[(i64, u32)]| {
        let mut around = vec![[NO_BRICK; 27]; run.len()];
        for k in 0..9 {
            let step = row([k % 3 - 1, k / 3 - 1]);
            let mut at = keys.partition_point(|&(key, _)| key < run[0].0 + step - 1);
            for (&(key, _), around) in run.iter().zip(&mut around) {
                while keys.get(at).is_some_and(|next| next.0 < key + step - 1) {
                    at += 1;
                }
                for &(next, number) in keys[at..].iter().take(3) {
                    let i = next - (key + step - 1);
                    if i < 3 {
                        around[(i + 3 * k) as usize] = number;
                    }
                }
            }
        }
        around
    };
    let in_rows: Vec<Vec<[u32; 27]>> = keys.par_chunks(RUN).map(of_run).collect();
    let mut all = vec![[NO_BRICK; 27]; bricks.len()];
    for (&(_, number), around) in keys.iter().zip(in_rows.iter().flatten()) {
        all[number as usize] = *around;
    }
    all
}

/// Bricks that a thread takes at a time.
pub(super) const RUN: usize = 64;
