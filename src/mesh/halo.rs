//! A brick with one layer of voxels of its neighbours around it.
//!
//! Places in it are counted from the layer before the brick: 0 to 9 along each axis.

use super::{
    extract::DualEdge,
    grid::{Brick, Grid, Leaf, NO_BRICK, SIDE, index_of},
};

/// Voxels along an edge, with both layers.
pub(super) const WIDTH: usize = SIDE as usize + 2;

/// The brick itself among the 27.
const MIDDLE: usize = 13;

/// See the file's text. Bit x of row y and slice z belongs to the voxel there.
pub(super) struct Halo<'a> {
    grid: &'a Grid,
    /// The place of the first voxel; 2³² − 1 where that is before all bricks.
    origin: [u32; 3],
    /// The numbers of the bricks around, x + 3y + 9z.
    pub(super) numbers: &'a [u32; 27],
    /// There is a voxel or a phantom.
    known: Rows,
    inside: Rows,
    /// Larger than the finest.
    coarse: Rows,
    /// Whether any is.
    pub(super) has_coarse: bool,
    /// Whether phantoms may be among them.
    is_bordering: bool,
}

/// Rows of 10 bits along x, by z and y: a brick of 8³ with one layer of its neighbours around it.
pub(crate) type Rows = [[u16; WIDTH]; WIDTH];

impl<'a> Halo<'a> {
    /// Around the brick with this number.
    pub(super) fn new(grid: &'a Grid, number: usize) -> Self {
        let place = grid.bricks[number].place;
        let numbers = &grid.around[number];
        let bricks: [Option<&Brick>; 27] = numbers.map(|number| grid.bricks.get(number as usize));
        let origin = place.map(|i| (i * SIDE).wrapping_sub(1));
        let has_coarse = bricks.iter().flatten().any(|brick| brick.coarse != [0; 8]);
        let known = rows_around(&bricks, |_, _| u64::MAX);
        let inside = rows_around(&bricks, |brick, z| brick.inside[z]);
        let coarse = match has_coarse {
            true => rows_around(&bricks, |brick, z| brick.coarse[z]),
            false => Rows::default(),
        };
        let is_bordering = (0..3).any(|axis| {
            let last = origin[axis].wrapping_add(WIDTH as u32 - 1);
            !grid.is_voxel(axis, origin[axis]) || !grid.is_voxel(axis, last)
        });
        let mut halo =
            Self { grid, origin, numbers, known, inside, coarse, has_coarse, is_bordering };
        if is_bordering {
            halo.forget_beyond();
        }
        halo
    }

    /// Takes away what is beyond the phantoms.
    fn forget_beyond(&mut self) {
        let held =
            |axis: usize, i: usize| self.grid.holds(axis, self.origin[axis].wrapping_add(i as u32));
        let columns: u16 = (0..WIDTH).fold(0, |bits, x| bits | u16::from(held(0, x)) << x);
        let rows = [1, 2].map(|axis| std::array::from_fn::<bool, WIDTH, _>(|i| held(axis, i)));
        for (z, slice) in self.known.iter_mut().enumerate() {
            for (y, row) in slice.iter_mut().enumerate() {
                *row &= if rows[0][y] && rows[1][z] { columns } else { 0 };
            }
        }
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

    /// Bit x: the voxel at (x, y, z) or the next one along `axis` is larger than the finest.
    #[inline]
    pub(super) fn stretched(&self, axis: usize, y: usize, z: usize) -> u16 {
        let coarse = &self.coarse;
        let next = match axis {
            0 => coarse[z][y] >> 1,
            1 => coarse[z][y + 1],
            _ => coarse[z + 1][y],
        };
        coarse[z][y] | next
    }

    /// Bit x: of the eight voxels from (x, y, z) on some are larger than the finest.
    #[inline]
    pub(super) fn stretched_cells(&self, y: usize, z: usize) -> u16 {
        let rows = self.stretched(1, y, z) | self.stretched(1, y, z + 1);
        rows | rows >> 1
    }

    /// Bit x + 2y + 4z: that one of the eight voxels from a place on is larger than the finest.
    #[inline]
    pub(super) fn coarse_octants(&self, [x, y, z]: [usize; 3]) -> u8 {
        let row = |y: usize, z: usize| (self.coarse[z][y] >> x & 3) as u8;
        row(y, z) | row(y + 1, z) << 2 | row(y, z + 1) << 4 | row(y + 1, z + 1) << 6
    }

    /// The rows of the inside of the four edges along x of a cell.
    #[inline]
    pub(super) fn rows(&self, y: usize, z: usize) -> [u16; 4] {
        let inside = &self.inside;
        [inside[z][y], inside[z][y + 1], inside[z + 1][y], inside[z + 1][y + 1]]
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
        (any | any >> 1) & !(all & all >> 1) & known & known >> 1
    }

    /// The voxel that holds a place.
    #[inline]
    pub(super) fn leaf(&self, [x, y, z]: [usize; 3]) -> Leaf {
        let p = [x, y, z].map(|i| i as u32);
        let p = [0, 1, 2].map(|axis| self.origin[axis].wrapping_add(p[axis]));
        if !self.is_coarse([x, y, z]) {
            return Leaf { base: p, level: 0 };
        }
        let number = self.numbers[part(x) + 3 * part(y) + 9 * part(z)] as usize;
        self.grid.leaf(&self.grid.bricks[number], p)
    }

    /// The middle of the lower one of two of the finest voxels inside the border, and how far their
    /// values are above the isovalue, if the edge from a voxel of the brick in a direction is such.
    #[inline]
    pub(super) fn plain_edge(
        &self,
        at: [usize; 3],
        direction: usize,
    ) -> Option<([f32; 3], [f32; 2])> {
        let axis = direction;
        if self.is_bordering || axis > 2 {
            return None;
        }
        let mut next = at;
        next[axis] += 1;
        if self.has_coarse && (self.is_coarse(at) || self.is_coarse(next)) {
            return None;
        }
        let middle = |axis: usize| (self.origin[axis] + at[axis] as u32 - SIDE) as f32 + 0.5;
        let offset = |[x, y, z]: [usize; 3]| {
            let number = self.numbers[part(x) + 3 * part(y) + 9 * part(z)];
            let index = within(x) + 8 * (within(y) + 8 * within(z));
            self.grid.bricks[number as usize].offset(index)
        };
        Some(([0, 1, 2].map(middle), [offset(at), offset(next)]))
    }

    #[inline]
    fn is_coarse(&self, [x, y, z]: [usize; 3]) -> bool {
        self.coarse[z][y] >> x & 1 == 1
    }

    /// How far the value at a voxel of the brick is above the isovalue.
    #[inline]
    pub(super) fn offset(&self, index: usize) -> f32 {
        self.grid.bricks[self.middle()].offset(index)
    }

    /// The voxel that holds the finest voxel at `p`, and how far its value is above the isovalue; its
    /// brick must be there.
    #[inline]
    pub(super) fn voxel_at(&self, p: [u32; 3]) -> (Leaf, f32) {
        let brick = &self.grid.bricks[self.number_of(p)];
        (self.grid.leaf(brick, p), brick.offset(index_of(p)))
    }

    /// The dual edge between the voxels at a place and the next one along `axis`.
    pub(super) fn edge(&self, at: [usize; 3], axis: usize) -> DualEdge {
        let mut next = at;
        next[axis] += 1;
        DualEdge::between(self.leaf(at), self.leaf(next), axis)
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
            self.grid.number_at(place).unwrap_or(NO_BRICK)
        };
        number as usize
    }

    fn middle(&self) -> usize {
        self.numbers[MIDDLE] as usize
    }
}

/// The bits of 27 bricks, those of slice z as `of` gives them; nothing where there is no brick.
#[inline]
pub(crate) fn rows_around<B>(bricks: &[Option<B>; 27], of: impl Fn(&B, usize) -> u64) -> Rows {
    let mut rows = Rows::default();
    for (z, slice) in rows.iter_mut().enumerate() {
        for k in 0..3 {
            let first = 3 * k + 9 * part(z);
            let bits = |x: usize| match &bricks[first + x] {
                Some(brick) => of(brick, within(z)),
                None => 0,
            };
            let (a, b, c) = (bits(0), bits(1), bits(2));
            let row = |y: usize| {
                let [a, b, c] = [a, b, c].map(|bits| (bits >> (8 * y)) as u16 & 0xff);
                a >> 7 | b << 1 | (c & 1) << 9
            };
            match k {
                0 => slice[0] = row(7),
                1 => (0..8).for_each(|y| slice[1 + y] = row(y)),
                _ => slice[9] = row(0),
            }
        }
    }
    rows
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
