//! A brick with one layer of voxels of its neighbours around it.
//!
//! Places in it are counted from the layer before the brick: 0 to 9 along each axis.

use super::{
    extract::DualEdge,
    grid::{Brick, Grid, Leaf, SIDE, index_of},
};

/// Voxels along an edge, with both layers.
pub(super) const WIDTH: usize = SIDE as usize + 2;

/// The brick itself among the 27.
const MIDDLE: usize = 13;

/// See the file's text.
pub(super) struct Halo<'a> {
    grid: &'a Grid,
    /// The place of the first voxel; 2³² − 1 where that is before all bricks.
    origin: [u32; 3],
    /// The numbers of the bricks around, x + 3y + 9z, where there are any.
    numbers: [Option<u32>; 27],
    /// Whether none of them has voxels that are larger than the finest.
    pub(super) is_finest: bool,
    /// Bit x of row y and slice z: inside.
    inside: [[u16; WIDTH]; WIDTH],
    /// The same: there is a voxel or a phantom.
    known: [[u16; WIDTH]; WIDTH],
}

impl<'a> Halo<'a> {
    /// Around the brick with this number.
    pub(super) fn new(grid: &'a Grid, number: usize) -> Self {
        let place = grid.bricks[number].place;
        let numbers: [Option<u32>; 27] = std::array::from_fn(|k| {
            if k == MIDDLE {
                return Some(number as u32);
            }
            let step = [k % 3, k / 3 % 3, k / 9];
            let mut around = place;
            for axis in 0..3 {
                around[axis] = (place[axis] + step[axis] as u32).checked_sub(1)?;
            }
            grid.number_at(around)
        });
        let brick_at = |k: usize| numbers[k].map(|number| &grid.bricks[number as usize]);
        let is_finest = (0..27).filter_map(brick_at).all(Brick::is_finest);
        let origin = place.map(|i| (i * SIDE).wrapping_sub(1));
        let (mut inside, mut known) = ([[0; WIDTH]; WIDTH], [[0; WIDTH]; WIDTH]);
        let held = |axis: usize, i: usize| grid.holds(axis, origin[axis].wrapping_add(i as u32));
        let columns: u16 =
            (0..WIDTH).map(|x| u16::from(held(0, x)) << x).fold(0, |bits, bit| bits | bit);
        for z in (0..WIDTH).filter(|&z| held(2, z)) {
            for y in (0..WIDTH).filter(|&y| held(1, y)) {
                let (k, row) = (3 * part(y) + 9 * part(z), 8 * within(y));
                let bits = |step: usize| match brick_at(k + step) {
                    Some(brick) => ((brick.inside[within(z)] >> row) as u16 & 0xff, 0xff),
                    None => (0, 0),
                };
                let [(a, has_a), (b, has_b), (c, has_c)] = [0, 1, 2].map(bits);
                inside[z][y] = a >> 7 | b << 1 | (c & 1) << 9;
                known[z][y] = (has_a >> 7 | has_b << 1 | (has_c & 1) << 9) & columns;
            }
        }
        Self { grid, origin, numbers, is_finest, inside, known }
    }

    /// Bit x: the edge from the voxel at (x, y, z) along `axis` is cut.
    #[inline]
    pub(super) fn cut(&self, axis: usize, y: usize, z: usize) -> u16 {
        let (inside, known) = (&self.inside, &self.known);
        let row = (inside[z][y], known[z][y]);
        let next = match axis {
            0 => (row.0 >> 1, row.1 >> 1),
            1 => (inside[z][y + 1], known[z][y + 1]),
            _ => (inside[z + 1][y], known[z + 1][y]),
        };
        (row.0 ^ next.0) & row.1 & next.1
    }

    /// Bit x: of the eight voxels from (x, y, z) on some are inside and some are not.
    #[inline]
    pub(super) fn mixed(&self, y: usize, z: usize) -> u16 {
        let rows = [(y, z), (y + 1, z), (y, z + 1), (y + 1, z + 1)];
        let (mut any, mut all, mut known) = (0, u16::MAX, u16::MAX);
        for (y, z) in rows {
            any |= self.inside[z][y];
            all &= self.inside[z][y];
            known &= self.known[z][y];
        }
        (any | any >> 1) & !(all & all >> 1) & known & known >> 1 & 0xff
    }

    #[inline]
    pub(super) fn is_inside(&self, [x, y, z]: [usize; 3]) -> bool {
        self.inside[z][y] >> x & 1 == 1
    }

    /// The number of the brick that holds a place, and that of the voxel in it.
    #[inline]
    pub(super) fn place(&self, [x, y, z]: [usize; 3]) -> (usize, usize) {
        let k = part(x) + 3 * part(y) + 9 * part(z);
        let index = within(x) + 8 * (within(y) + 8 * within(z));
        (self.numbers[k].map_or(usize::MAX, |number| number as usize), index)
    }

    /// The voxel that holds a place, and its value.
    pub(super) fn voxel(&self, at: [usize; 3]) -> (Leaf, f64) {
        let (number, index) = self.place(at);
        let brick = &self.grid.bricks[number];
        let p = [0, 1, 2].map(|axis| self.origin[axis].wrapping_add(at[axis] as u32));
        (self.grid.leaf(brick, p), brick.value(index))
    }

    /// The voxel that holds the finest voxel at `p`, and its value; its brick must be there.
    pub(super) fn voxel_at(&self, p: [u32; 3]) -> (Leaf, f64) {
        let brick = &self.grid.bricks[self.number_of(p)];
        (self.grid.leaf(brick, p), brick.value(index_of(p)))
    }

    /// The dual edge between the voxels at a place and the next one along `axis`.
    pub(super) fn edge(&self, at: [usize; 3], axis: usize) -> DualEdge {
        let mut next = at;
        next[axis] += 1;
        DualEdge::between(self.voxel(at).0, self.voxel(next).0, axis)
    }

    /// Whether a voxel of the brick has this first corner.
    pub(super) fn owns(&self, base: [u32; 3]) -> bool {
        base.map(|i| i / SIDE) == self.grid.bricks[self.middle()].place
    }

    /// Whether the corner that the eight places from `at` on have in common is one of a voxel. The
    /// smallest voxel around a corner of any has it for a corner too.
    pub(super) fn is_corner(&self, at: [usize; 3], leaves: &[Leaf; 8]) -> bool {
        let least = leaves.iter().map(|leaf| leaf.level).min().unwrap_or(0);
        (0..3).all(|axis| {
            let corner = self.origin[axis].wrapping_add(at[axis] as u32 + 1);
            corner.wrapping_sub(SIDE) & ((1 << least) - 1) == 0
        })
    }

    /// The number of the brick that holds the finest voxel at `p`.
    pub(super) fn number_of(&self, p: [u32; 3]) -> usize {
        let place = p.map(|i| i / SIDE);
        let near = [0, 1, 2].map(|axis| {
            (place[axis] + 1).wrapping_sub(self.grid.bricks[self.middle()].place[axis])
        });
        let number = if near.iter().all(|&i| i < 3) {
            self.numbers[(near[0] + 3 * near[1] + 9 * near[2]) as usize]
        } else {
            self.grid.number_at(place)
        };
        number.map_or(usize::MAX, |number| number as usize)
    }

    fn middle(&self) -> usize {
        self.numbers[MIDDLE].map_or(usize::MAX, |number| number as usize)
    }
}

/// Which of three bricks in a row holds a place.
#[inline]
fn part(i: usize) -> usize {
    i.div_ceil(8)
}

/// Which voxel of it that is.
#[inline]
fn within(i: usize) -> usize {
    (i + 7) % 8
}
