//! A brick with the voxels of its neighbours around it, as bits: 64 voxels are looked at together.
//!
//! Places in it are counted from the layer before the brick: 0 to 9 along each axis.

use std::{array, ops::Range};

use super::{
    cells::{CellBits, FIRST_X, Words},
    cuts::DualEdge,
    grid::{Brick, Grid, Leaf, NO_BRICK, SIDE, Slices, Voxels, index_of},
};

/// Voxels along an edge, with both layers.
const WIDTH: usize = SIDE as usize + 2;

/// The brick itself among the 27.
const MIDDLE: usize = 13;
/// From brick to brick among the 27.
const STEPS: [usize; 3] = [1, 3, 9];

/// See the file's text.
pub(super) struct Halo<'a, B> {
    grid: &'a Grid<B>,
    /// The place of the first voxel; 2³² − 1 where that is before all bricks.
    pub(super) origin: [u32; 3],
    /// The numbers of the bricks around, x + 3y + 9z.
    pub(super) numbers: &'a [u32; 27],
    /// Whether any voxel is larger than the finest.
    pub(super) has_coarse: bool,
    /// Whether phantoms may be among them.
    pub(super) is_bordering: bool,
}

impl<'a, B: Voxels> Halo<'a, B> {
    /// Around the brick with this number.
    #[inline]
    pub(super) fn new(grid: &'a Grid<B>, number: usize) -> Self {
        let place = grid.bricks[number].place;
        let numbers = &grid.around[number];
        let bricks = || numbers.iter().filter_map(|&number| grid.bricks.get(number as usize));
        let has_coarse = bricks().any(|brick| brick.has_coarse);
        let origin = place.map(|i| (i * SIDE).wrapping_sub(1));
        let is_bordering = (0..3).any(|axis| {
            let last = origin[axis].wrapping_add(WIDTH as u32 - 1);
            !grid.is_voxel(axis, origin[axis]) || !grid.is_voxel(axis, last)
        });
        Self { grid, origin, numbers, has_coarse, is_bordering }
    }

    /// What cells are made of.
    #[inline]
    pub(super) fn cells(&self) -> CellBits {
        CellBits {
            inside: Words::new(|step| self.inside(MIDDLE + step)),
            known: match self.is_bordering || self.numbers.contains(&NO_BRICK) {
                true => Words::new(|step| self.known(MIDDLE + step)),
                false => Words::ALL,
            },
            coarse: match self.has_coarse {
                true => Words::new(|step| self.coarse(MIDDLE + step)),
                false => Words::default(),
            },
        }
    }

    /// Which edges from the voxels before those of a brick along `axis` are cut, if they begin at larger
    /// voxels, by slices.
    #[inline]
    pub(super) fn cut_from_large(&self, axis: usize) -> Slices {
        let before = MIDDLE - STEPS[axis];
        let [own, other] = [MIDDLE, before].map(|k| (self.inside(k), self.known(k)));
        let (coarse, other_coarse) = (self.coarse(MIDDLE), self.coarse(before));
        let inside = shifted(&own.0, &other.0, axis);
        let known = shifted(&own.1, &other.1, axis);
        let coarse = shifted(&coarse, &other_coarse, axis);
        let cut = |z: usize| (own.0[z] ^ inside[z]) & own.1[z] & known[z] & coarse[z];
        array::from_fn(cut)
    }

    /// Which voxels of the brick are larger than the finest.
    #[inline]
    pub(super) fn own_coarse(&self) -> Slices {
        self.coarse(MIDDLE)
    }

    #[inline]
    fn brick(&self, k: usize) -> Option<&'a Brick<B>> {
        self.grid.bricks.get(self.numbers[k] as usize)
    }

    #[inline]
    fn inside(&self, k: usize) -> Slices {
        self.brick(k).map_or_else(Slices::default, |brick| brick.inside)
    }

    #[inline]
    fn coarse(&self, k: usize) -> Slices {
        self.brick(k).map_or_else(Slices::default, |brick| brick.coarse)
    }

    /// Where a brick has voxels and phantoms.
    #[inline]
    fn known(&self, k: usize) -> Slices {
        if self.numbers[k] == NO_BRICK {
            return Slices::default();
        }
        if !self.is_bordering {
            return [u64::MAX; SIDE as usize];
        }
        in_brick(|axis| {
            let first = self.first(axis) + (k / STEPS[axis] % 3) as u32 * SIDE - SIDE;
            bits_of(first, self.grid.held(axis))
        })
    }

    /// Which edges from the voxels of the brick along `axis` are between voxels, not phantoms.
    #[inline]
    pub(super) fn without_phantoms(&self, axis: usize) -> Slices {
        if !self.is_bordering {
            return [u64::MAX; SIDE as usize];
        }
        in_brick(|along| {
            let Range { start, end } = self.grid.voxels(along);
            bits_of(self.first(along), start..if along == axis { end - 1 } else { end })
        })
    }

    /// The coordinate of the brick's first voxels.
    #[inline]
    pub(super) fn first(&self, axis: usize) -> u32 {
        self.origin[axis].wrapping_add(1)
    }

    /// The voxel that holds a place.
    #[inline]
    pub(super) fn leaf(&self, at: [usize; 3]) -> Leaf {
        self.leaf_in(&self.grid.bricks[self.number_at(at)], at)
    }

    /// The voxel that holds a place, and how far its value is above the isovalue.
    #[inline]
    pub(super) fn voxel(&self, at: [usize; 3]) -> (Leaf, f32) {
        let brick = &self.grid.bricks[self.number_at(at)];
        (self.leaf_in(brick, at), brick.voxels.offset(index_at(at)))
    }

    #[inline]
    fn leaf_in(&self, brick: &Brick<B>, at: [usize; 3]) -> Leaf {
        let p = |axis: usize| self.origin[axis].wrapping_add(at[axis] as u32);
        let (p, index) = ([p(0), p(1), p(2)], index_at(at));
        match brick.coarse[index / 64] >> (index % 64) & 1 == 1 {
            true => self.grid.leaf(brick, p),
            false => Leaf { base: p, level: 0 },
        }
    }

    /// The same of the voxel after, or before, the one that begins at a place of the brick.
    #[inline]
    pub(super) fn beside(
        &self,
        at: [usize; 3],
        leaf: &Leaf,
        axis: usize,
        is_up: bool,
    ) -> (Leaf, f32) {
        let thickness = 1_u32 << self.grid.thickness(leaf, axis);
        let mut next = at;
        next[axis] = if is_up { at[axis] + thickness as usize } else { at[axis] - 1 };
        if next[axis] < WIDTH {
            return self.voxel(next);
        }
        let mut p = leaf.base;
        p[axis] += thickness;
        let brick = &self.grid.bricks[self.number_of(p)];
        (self.grid.leaf(brick, p), brick.voxels.offset(index_of(p)))
    }

    /// The voxels of the brick.
    #[inline]
    pub(super) fn voxels(&self) -> &'a B {
        &self.grid.bricks[self.number()].voxels
    }

    /// Those of the next brick along an axis; there must be one.
    #[inline]
    pub(super) fn voxels_after<const AXIS: usize>(&self) -> &'a B {
        &self.grid.bricks[self.numbers[MIDDLE + STEPS[AXIS]] as usize].voxels
    }

    /// The dual edge between the voxels at a place and the next one along `axis`.
    pub(super) fn edge(&self, at: [usize; 3], axis: usize) -> DualEdge {
        let mut next = at;
        next[axis] += 1;
        DualEdge::between(self.leaf(at), self.leaf(next), axis)
    }

    /// Whether a voxel of the brick has this first corner.
    pub(super) fn owns(&self, base: [u32; 3]) -> bool {
        base.map(|i| i / SIDE) == self.grid.bricks[self.number()].place
    }

    /// Whether the corner that the eight places from `at` on have in common is one of a voxel. The
    /// smallest voxel around a corner of any has it for a corner too.
    pub(super) fn is_corner(&self, at: [usize; 3]) -> bool {
        let level =
            |octant: usize| self.leaf([0, 1, 2].map(|axis| at[axis] + (octant >> axis & 1))).level;
        let least = (0..8).map(level).min().unwrap_or(0);
        (0..3).all(|axis| {
            let corner = self.origin[axis].wrapping_add(at[axis] as u32 + 1);
            corner.wrapping_sub(SIDE) & ((1 << least) - 1) == 0
        })
    }

    /// The number of the brick that holds the finest voxel at `p`.
    pub(super) fn number_of(&self, p: [u32; 3]) -> usize {
        let place = p.map(|i| i / SIDE);
        let near = [0, 1, 2].map(|axis| {
            (place[axis] + 1).wrapping_sub(self.grid.bricks[self.number()].place[axis])
        });
        let number = if near.iter().all(|&i| i < 3) {
            self.numbers[(near[0] + 3 * near[1] + 9 * near[2]) as usize]
        } else {
            self.grid.number_at(place).unwrap_or(NO_BRICK)
        };
        number as usize
    }

    /// The number of the brick that holds a place.
    #[inline]
    fn number_at(&self, at: [usize; 3]) -> usize {
        let [x, y, z] = at.map(|i| i.div_ceil(8));
        self.numbers[x + 3 * y + 9 * z] as usize
    }

    /// The number of the brick.
    #[inline]
    pub(super) fn number(&self) -> usize {
        self.numbers[MIDDLE] as usize
    }
}

/// The voxels of a brick of which something is true along each axis.
#[inline]
fn in_brick(bits: impl Fn(usize) -> u64) -> Slices {
    let (xs, ys, zs) = (bits(0), bits(1), bits(2));
    let slice = (0..8).fold(0, |slice, y| slice | (xs * (ys >> y & 1)) << (8 * y));
    array::from_fn(|z| slice * (zs >> z & 1))
}

/// Which of the eight coordinates from `first` on are in a range.
#[inline]
fn bits_of(first: u32, range: Range<u32>) -> u64 {
    let [start, end] = [range.start, range.end].map(|i| i.saturating_sub(first).min(SIDE));
    (1 << end) - (1 << start)
}

/// The number in its brick of the voxel at a place.
#[inline]
fn index_at(at: [usize; 3]) -> usize {
    let [x, y, z] = at.map(|i| (i + 7) % 8);
    x + 8 * (y + 8 * z)
}

/// The bits of the voxels before those of a brick along `axis`; `other` has those of the brick before.
#[inline]
fn shifted(own: &Slices, other: &Slices, axis: usize) -> Slices {
    let slice = |z: usize| match axis {
        0 => own[z] << 1 & !FIRST_X | other[z] >> 7 & FIRST_X,
        1 => own[z] << 8 | other[z] >> 56,
        _ if z == 0 => other[7],
        _ => own[z - 1],
    };
    array::from_fn(slice)
}
