//! The voxels of a brick near an isosurface, as the octree has them.

use std::array;

use super::{brick::Brick, octree::Tree, sample::Value};
use crate::mesh::{self, Border, SIDE, Slices, VOXELS, Voxels, offset};

/// See the file's text; what lies beyond the volume is like the samples at its border, which are those
/// of one brick, or outside.
#[derive(Debug)]
pub struct NearVoxels<'a, V> {
    own: Own<'a, V>,
    isovalue: f64,
    beyond: Option<Beyond>,
}

/// What the samples are.
#[derive(Debug)]
enum Own<'a, V> {
    /// All of one region, or of a part of one: its value and its level.
    Region(V, u8),
    /// Of several.
    Brick(&'a Brick<V>),
}

/// Which voxels of a brick lie beyond the volume.
#[derive(Debug)]
pub(super) struct Beyond {
    /// Along each axis, like which voxel a voxel is.
    like: [[u8; SIDE as usize]; 3],
    /// Along each axis, a bit for each that lies beyond.
    beyond: [u8; 3],
    border: Border,
}

/// A brick near an isosurface of an octree.
pub(super) type NearBrick<'a, V> = mesh::Brick<NearVoxels<'a, V>>;

impl<'a, V: Value> NearVoxels<'a, V> {
    /// The brick at a place of which `tree`, of this level, has the samples.
    pub(super) fn brick(
        place: [u32; 3],
        (tree, level): (&'a Tree<V>, u8),
        isovalue: f64,
        beyond: Option<Beyond>,
    ) -> NearBrick<'a, V> {
        let all = |is: bool| [if is { u64::MAX } else { 0 }; SIDE as usize];
        let least = V::at_least(isovalue);
        let is_inside = |value: V| least.is_some_and(|least| value >= least);
        let (own, mut inside, mut coarse) = match tree {
            Tree::Brick(brick) => {
                (Own::Brick(brick), brick.slices(is_inside), array::from_fn(|z| !brick.below(1, z)))
            }
            Tree::Region { value, .. } => {
                (Own::Region(*value, level), all(is_inside(*value)), all(level > 0))
            }
            Tree::Node(_) => unreachable!("nodes end in bricks and regions"),
        };
        if let Some(beyond) = &beyond {
            inside = beyond.spread(&inside);
            coarse = beyond.spread(&coarse);
            if beyond.border == Border::Capped {
                (0..SIDE as usize).for_each(|z| inside[z] &= !beyond.slice(z));
            }
        }
        mesh::Brick::of(place, Self { own, isovalue, beyond }, inside, coarse)
    }

    /// The voxel that one is like, if it is not outside.
    #[inline]
    fn like(&self, index: usize) -> Option<usize> {
        match &self.beyond {
            None => Some(index),
            Some(beyond) => beyond.like(index),
        }
    }
}

impl<V: Value> Voxels for NearVoxels<'_, V> {
    type Value = V;

    #[inline]
    fn offset(&self, index: usize) -> f32 {
        let Some(index) = self.like(index) else { return f32::MIN };
        self.offset_of(match &self.own {
            Own::Brick(brick) => brick.value(index),
            Own::Region(value, _) => *value,
        })
    }

    #[inline]
    fn offset_of(&self, value: V) -> f32 {
        offset(value.to_f64(), self.isovalue)
    }

    #[inline]
    fn values(&self, all: &mut [V; VOXELS]) {
        match &self.own {
            Own::Brick(brick) => *all = brick.samples(),
            Own::Region(value, _) => all.fill(*value),
        }
        if let Some(beyond) = &self.beyond {
            let own = *all;
            (0..VOXELS).for_each(|index| all[index] = own[beyond.place(index)]);
        }
    }

    #[inline]
    fn level(&self, index: usize) -> u8 {
        let like = self.beyond.as_ref().map_or(index, |beyond| beyond.place(index));
        match &self.own {
            Own::Brick(brick) => brick.level_at(like),
            Own::Region(_, level) => *level,
        }
    }
}

impl Beyond {
    /// Of the brick at a place, counted from the layer before the volume, and the first sample of the
    /// brick that it is like.
    pub(super) fn new(place: [u32; 3], size: [u32; 3], border: Border) -> (Self, [u32; 3]) {
        let at = |axis: usize, i: u32| place[axis] * SIDE + i;
        let clamped = |axis: usize, i| at(axis, i).clamp(SIDE, SIDE + size[axis] - 1);
        let first = [0, 1, 2].map(|axis| clamped(axis, 0) / SIDE * SIDE - SIDE);
        let (mut like, mut beyond) = ([[0; SIDE as usize]; 3], [0; 3]);
        for axis in 0..3 {
            for i in 0..SIDE {
                like[axis][i as usize] = (clamped(axis, i) - SIDE - first[axis]) as u8;
                beyond[axis] |= u8::from(clamped(axis, i) != at(axis, i)) << i;
            }
        }
        (Self { like, beyond, border }, first)
    }

    /// The place of the voxel that one is like.
    #[inline]
    fn place(&self, index: usize) -> usize {
        let [x, y, z] = [index % 8, index / 8 % 8, index / 64];
        let [x, y, z] = [self.like[0][x], self.like[1][y], self.like[2][z]].map(usize::from);
        x + 8 * (y + 8 * z)
    }

    /// The same, if it is not outside.
    #[inline]
    fn like(&self, index: usize) -> Option<usize> {
        let is_beyond = self.slice(index / 64) >> (index % 64) & 1 == 1;
        (!is_beyond || self.border == Border::Open).then(|| self.place(index))
    }

    /// Which voxels of a slice lie beyond.
    #[inline]
    fn slice(&self, z: usize) -> u64 {
        let [xs, ys, zs] = self.beyond.map(u64::from);
        if zs >> z & 1 == 1 {
            return u64::MAX;
        }
        (0..8).fold(0, |slice, y| slice | (xs | (0xff * (ys >> y & 1))) << (8 * y))
    }

    /// What is true of each voxel's like.
    fn spread(&self, own: &Slices) -> Slices {
        const FIRST_X: u64 = 0x0101_0101_0101_0101;
        let [xs, ys, zs] = &self.like;
        let slice = |own: u64| {
            let rows = (0..8).fold(0, |bits, x| bits | (own >> xs[x] & FIRST_X) << x);
            (0..8).fold(0, |bits, y| bits | (rows >> (8 * ys[y]) & 0xff) << (8 * y))
        };
        array::from_fn(|z| slice(own[usize::from(zs[z])]))
    }
}
