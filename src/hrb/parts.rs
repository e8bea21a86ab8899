//! The samples of a brick by parts of 2³: of which it is known what they are between.

use std::array;

use super::{brick::PLACES, sample::Sample};
use crate::mesh::{SIDE, VOXELS, byte_bits};

/// Parts of 2³ samples in a brick.
pub(super) const PARTS: usize = 64;

/// The samples of a brick, and what is known of its parts of 2³ samples. What is beyond the volume
/// stands there like the brick's first sample.
pub(super) struct Parts<T> {
    /// x fastest.
    pub(super) samples: [T; VOXELS],
    /// Of every part, x fastest, the least and the largest sample.
    least: [T; PARTS],
    most: [T; PARTS],
    /// Samples of the volume along each axis.
    left: [usize; 3],
}

impl<T: Sample> Parts<T> {
    #[inline]
    pub(super) fn of<'a>(first: T, left: [usize; 3], row: impl Fn(usize, usize) -> &'a [T]) -> Self
    where
        T: 'a,
    {
        let mut samples = [first; VOXELS];
        let (rows, _) = samples.as_chunks_mut::<8>();
        for (i, own) in rows.iter_mut().enumerate() {
            let [y, z] = [i % 8, i / 8];
            if y < left[1] && z < left[2] {
                match row(y, z).try_into() {
                    Ok(row) => *own = row,
                    Err(_) => own[..left[0]].copy_from_slice(row(y, z)),
                }
            }
        }
        let (mut least, mut most) = ([first; PARTS], [first; PARTS]);
        let (slices, _) = samples.as_chunks::<64>();
        // One axis after the other, many samples at once.
        for z in 0..4 {
            let (below, above) = (&slices[2 * z], &slices[2 * z + 1]);
            let (mut low, mut high) = (*below, *below);
            join(&mut low, &mut high, above, above);
            for y in 0..4 {
                let start = 16 * y;
                let of_row =
                    |all: &[T; 64], start: usize| -> [T; 8] { array::from_fn(|x| all[start + x]) };
                let (mut of_rows, mut most_of_rows) = (of_row(&low, start), of_row(&high, start));
                let (next, most_of_next) = (of_row(&low, start + 8), of_row(&high, start + 8));
                join(&mut of_rows, &mut most_of_rows, &next, &most_of_next);
                for x in 0..4 {
                    let at = x + 4 * y + 16 * z;
                    least[at] = of_rows[2 * x].least(of_rows[2 * x + 1]);
                    most[at] = most_of_rows[2 * x].most(most_of_rows[2 * x + 1]);
                }
            }
        }
        Self { samples, least, most, left }
    }

    /// The least and the largest sample of a part.
    #[inline]
    pub(super) fn range(&self, g: usize) -> [T; 2] {
        let place = usize::from(PARTS_IN_ROWS[g]);
        [self.least[place], self.most[place]]
    }

    /// Bit g: the samples of part g are not all equal. No number differs from itself.
    #[inline]
    pub(super) fn mixed(&self) -> u64 {
        let is_mixed = array::from_fn(|place| u8::from(self.least[place] != self.most[place]));
        // Bits are at x + 4y + 16z; the low bits of the three go before the high ones.
        let bits = swapped(swapped(byte_bits(&is_mixed), 1, 2), 3, 4);
        swapped(bits, 2, 3)
    }

    /// Sample c of a part.
    #[inline]
    pub(super) fn sample(&self, g: usize, c: usize) -> T {
        self.samples[usize::from(PLACES[8 * g + c])]
    }

    /// Whether all samples are the volume's.
    #[inline]
    pub(super) fn is_whole(&self) -> bool {
        self.left == [SIDE as usize; 3]
    }

    /// Whether a sample is one of the volume's.
    #[inline]
    pub(super) fn holds(&self, g: usize, c: usize) -> bool {
        (0..3).all(|axis| first_of(g, axis) + (c >> axis & 1) < self.left[axis])
    }

    /// Whether of `n` parts some samples are the volume's and some are not.
    #[inline]
    pub(super) fn is_cut(&self, first: usize, n: usize) -> bool {
        if self.is_whole() {
            return false;
        }
        let side = [2, 4, 8][n.ilog2() as usize / 3];
        (0..3).all(|axis| first_of(first, axis) < self.left[axis])
            && (0..3).any(|axis| first_of(first, axis) + side > self.left[axis])
    }
}

/// Where a part of a brick begins along an axis.
#[inline]
fn first_of(g: usize, axis: usize) -> usize {
    2 * (g >> axis & 1) + 4 * (g >> (axis + 3) & 1)
}

/// The bits of a word, each at the place with bits `a` and `b` of its number, a < b, swapped.
#[inline]
fn swapped(word: u64, a: u32, b: u32) -> u64 {
    // Places with bit a, but without bit b, and how far they are from those with the other.
    const SET: [u64; 6] = [
        0xaaaa_aaaa_aaaa_aaaa,
        0xcccc_cccc_cccc_cccc,
        0xf0f0_f0f0_f0f0_f0f0,
        0xff00_ff00_ff00_ff00,
        0xffff_0000_ffff_0000,
        0xffff_ffff_0000_0000,
    ];
    let low = SET[a as usize] & !SET[b as usize];
    let step = (1 << b) - (1 << a);
    let differing = (word ^ word >> step) & low;
    word ^ differing ^ differing << step
}

/// The least of samples and of others at the same places, and the largest.
#[inline]
fn join<T: Sample, const N: usize>(
    least: &mut [T; N],
    most: &mut [T; N],
    least_others: &[T; N],
    most_others: &[T; N],
) {
    for (own, other) in least.iter_mut().zip(least_others) {
        *own = own.least(*other);
    }
    for (own, other) in most.iter_mut().zip(most_others) {
        *own = own.most(*other);
    }
}

/// Where the parts, in Morton order, stand x fastest.
const PARTS_IN_ROWS: [u8; PARTS] = {
    let mut places = [0; PARTS];
    let mut g = 0;
    while g < PARTS {
        // Bit 3i + axis becomes bit i + 2 axis.
        let mut bit = 0;
        while bit < 6 {
            places[g] |= ((g >> bit & 1) << (bit / 3 + 2 * (bit % 3))) as u8;
            bit += 1;
        }
        g += 1;
    }
    places
};
