//! Cells of a brick as bits: 64 voxels, or the cells from these on, are looked at together.

use std::array;

use super::grid::{SIDE, Slices};

/// Bits of the first voxels of a slice, along x and along y.
pub(super) const FIRST_X: u64 = 0x0101_0101_0101_0101;
pub(super) const FIRST_Y: u64 = 0xff;
/// And of the last ones.
pub(super) const LAST_X: u64 = FIRST_X << 7;
pub(super) const LAST_Y: u64 = FIRST_Y << 56;

/// Something that is true of the voxels of a brick and of the next ones: bit x + 8y of word i of slice
/// z is that of the voxel at (x + i & 1, y + i >> 1, z).
#[derive(Clone, Copy, Default)]
pub(super) struct Words([[u64; 4]; SIDE as usize + 1]);

impl Words {
    /// True of all.
    pub(super) const ALL: Self = Self([[u64::MAX; 4]; SIDE as usize + 1]);

    /// Of what `of` tells of the bricks from a brick on, by steps of x + 3y + 9z.
    #[inline]
    pub(super) fn new(of: impl Fn(usize) -> Slices) -> Self {
        let mut words = Self::default();
        for above in 0..2 {
            let [a, b, c, d] = [0, 1, 3, 4].map(|step| of(step + 9 * above));
            // Of the bricks above only the first slice.
            let n = if above == 0 { SIDE as usize } else { 1 };
            for (z, words) in words.0[8 * above..].iter_mut().take(n).enumerate() {
                let next_x = |own: u64, next: u64| own >> 1 & !LAST_X | next << 7 & LAST_X;
                let next_y = |own: u64, next: u64| own >> 8 | next << 56;
                let y = next_y(a[z], c[z]);
                *words = [a[z], next_x(a[z], b[z]), y, next_x(y, next_y(b[z], d[z]))];
            }
        }
        words
    }

    /// Of the voxels at the places of word `i` of a slice.
    #[inline]
    pub(super) fn at(&self, i: usize, z: usize) -> u64 {
        self.0[z][i]
    }

    /// Of those after these along `axis`.
    #[inline]
    pub(super) fn after(&self, i: usize, z: usize, axis: usize) -> u64 {
        if axis == 2 { self.0[z + 1][i] } else { self.0[z][i | 1 << axis] }
    }

    /// The rows along x of a slice: 9 bits each.
    #[inline]
    fn rows(&self, z: usize) -> [u16; 9] {
        let [own, x, y, both] = self.0[z];
        let row = |own: u64, x: u64, y: usize| {
            (own >> (8 * y)) as u16 & 0xff | ((x >> (8 * y)) as u16 & 0x80) << 1
        };
        array::from_fn(|i| if i < 8 { row(own, x, i) } else { row(y, both, 7) })
    }

    /// Whether all four words of a slice, or any, have a bit.
    #[inline]
    fn all(&self, z: usize) -> u64 {
        self.0[z].iter().fold(u64::MAX, |all, word| all & word)
    }

    #[inline]
    fn any(&self, z: usize) -> u64 {
        self.0[z].iter().fold(0, |any, word| any | word)
    }
}

/// What the cells of a brick are made of.
pub(super) struct CellBits {
    pub(super) inside: Words,
    /// There is a voxel or a phantom.
    pub(super) known: Words,
    /// Larger than the finest.
    pub(super) coarse: Words,
}

impl CellBits {
    /// Of the cells from the voxels of a slice on, those with voxels inside and voxels that are not. Those
    /// in the middle of an edge, or a face, of larger voxels are none.
    #[inline]
    pub(super) fn mixed(&self, z: usize) -> u64 {
        let (inside, known) = (&self.inside, &self.known);
        let (any, all) = (inside.any(z) | inside.any(z + 1), inside.all(z) & inside.all(z + 1));
        any & !all & known.all(z) & known.all(z + 1) & self.may_be_corners(z)
    }

    /// Of the cells from the voxels of a slice on, those around what may be the corner of a voxel: of one of
    /// the finest, or at even places.
    #[inline]
    fn may_be_corners(&self, z: usize) -> u64 {
        const EVEN: u64 = 0xaa00_aa00_aa00_aa00;
        !(self.coarse.all(z) & self.coarse.all(z + 1)) | if z % 2 == 1 { EVEN } else { 0 }
    }

    /// Calls `tell` with the place of each of these cells in a slice, and its octants that lie inside, as
    /// bits.
    #[inline]
    pub(super) fn each_mixed(&self, z: usize, mut tell: impl FnMut(usize, usize)) {
        let mut rest = self.mixed(z);
        if rest == 0 {
            return;
        }
        let [below, above] = [z, z + 1].map(|z| self.inside.rows(z));
        while rest != 0 {
            let bit = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let (x, y) = (bit % 8, bit / 8 % 8);
            let pair = |row: u16| usize::from(row >> x & 3);
            let octants = |rows: &[u16; 9]| pair(rows[y]) | pair(rows[y + 1]) << 2;
            tell(bit, octants(&below) | octants(&above) << 4);
        }
    }

    /// Which edges from the voxels of word `i` of a slice along `axis` are cut.
    #[inline]
    pub(super) fn cut(&self, i: usize, z: usize, axis: usize) -> u64 {
        let (inside, known) = (&self.inside, &self.known);
        (inside.at(i, z) ^ inside.after(i, z, axis)) & known.at(i, z) & known.after(i, z, axis)
    }

    /// Of these, those between two voxels that are larger than the finest.
    #[inline]
    pub(super) fn large(&self, i: usize, z: usize, axis: usize) -> u64 {
        self.cut(i, z, axis) & self.coarse.at(i, z) & self.coarse.after(i, z, axis)
    }

    /// Of the cells from the voxels of a slice on, those with such edges.
    #[inline]
    pub(super) fn at_large(&self, z: usize) -> u64 {
        let along_x = |z| self.large(0, z, 0) | self.large(2, z, 0);
        let along_y = |z| self.large(0, z, 1) | self.large(1, z, 1);
        let along_z = (0..4).fold(0, |any, i| any | self.large(i, z, 2));
        along_x(z) | along_x(z + 1) | along_y(z) | along_y(z + 1) | along_z
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn words_hold_the_bits_of_the_next_voxels(seed: u64) {
            let slices = |step: usize| -> Slices {
                array::from_fn(|z| {
                    seed.wrapping_mul((8 * step + z) as u64 | 1).rotate_left(31 + z as u32)
                })
            };
            let words = Words::new(slices);
            let voxel = |[x, y, z]: [usize; 3]| {
                let step = x / 8 + 3 * (y / 8) + 9 * (z / 8);
                slices(step)[z % 8] >> (x % 8 + 8 * (y % 8)) & 1
            };
            for z in 0..=8 {
                for (i, bit) in (0..4 * 64).map(|k| (k / 64, k % 64)) {
                    let at = [bit % 8 + (i & 1), bit / 8 + (i >> 1), z];
                    prop_assert_eq!(words.at(i, z) >> bit & 1, voxel(at), "{:?}", at);
                }
            }
        }
    }
}
