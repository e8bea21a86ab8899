//! The samples of a brick by parts of 2³: of which it is known what they are between.

use std::array;

use super::{
    brick::{PLACES, STEPS},
    sample::Sample,
};
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
        let (slices, _) = samples.as_chunks::<64>();
        // One axis after the other, many samples at once.
        let (mut low, mut high) = ([first; 2 * PARTS], [first; 2 * PARTS]);
        for z in 0..4 {
            let (below, above) = (&slices[2 * z], &slices[2 * z + 1]);
            let (mut least, mut most) = (*below, *below);
            join(&mut least, &mut most, above, above);
            for y in 0..4 {
                let own = 8 * (y + 4 * z);
                let rows = 16 * y..16 * y + 16;
                join_rows(&mut low[own..own + 8], &least[rows.clone()], T::least);
                join_rows(&mut high[own..own + 8], &most[rows], T::most);
            }
        }
        let [low, high] = [&low, &high].map(|all| all.as_chunks::<2>().0);
        let least = array::from_fn(|at| low[at][0].least(low[at][1]));
        let most = array::from_fn(|at| high[at][0].most(high[at][1]));
        Self { samples, least, most, left }
    }

    /// The least and the largest sample of a part.
    #[inline]
    pub(super) fn range(&self, g: usize) -> [T; 2] {
        let place = usize::from(PARTS_IN_ROWS[g]);
        [self.least[place], self.most[place]]
    }

    /// The same of all parts.
    #[inline]
    pub(super) fn range_of_all(&self) -> [T; 2] {
        let (first, last) = (self.least[0], self.most[0]);
        [self.least.into_iter().fold(first, T::least), self.most.into_iter().fold(last, T::most)]
    }

    /// Bit g: the samples of part g are not all equal. No number differs from itself.
    #[inline]
    pub(super) fn mixed(&self) -> u64 {
        let is_mixed = array::from_fn(|place| u8::from(self.least[place] != self.most[place]));
        // Bits are at x + 4y + 16z; the low bits of the three go before the high ones.
        let bits = swapped(swapped(byte_bits(&is_mixed), 1, 2), 3, 4);
        swapped(bits, 2, 3)
    }

    /// The sum of the volume's samples in `n` parts, one after the other, if there are any.
    #[inline]
    pub(super) fn sum(&self, first: usize, n: usize) -> Option<T::Sum> {
        let is_whole = self.is_whole();
        let mut all = None;
        for g in first..first + n {
            for (c, sample) in self.eight(g).into_iter().enumerate() {
                if is_whole || self.holds(g, c) {
                    let sum = sample.sum();
                    all = Some(all.map_or(sum, |all| T::add(all, sum)));
                }
            }
        }
        all
    }

    /// All samples of a part.
    #[inline]
    pub(super) fn eight(&self, g: usize) -> [T; 8] {
        let first = usize::from(PLACES[8 * g]);
        let own = &self.samples[first..first + STEPS[7] + 1];
        STEPS.map(|step| own[step])
    }

    /// Whether all samples are the volume's.
    #[inline]
    pub(super) fn is_whole(&self) -> bool {
        self.left == [SIDE as usize; 3]
    }

    /// Whether a sample is one of the volume's.
    #[inline]
    fn holds(&self, g: usize, c: usize) -> bool {
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

/// One row of samples of two.
#[inline]
fn join_rows<T: Sample>(joined: &mut [T], rows: &[T], join: impl Fn(T, T) -> T) {
    let (one, other) = rows.split_at(8);
    for ((joined, one), other) in joined.iter_mut().zip(one).zip(other) {
        *joined = join(*one, *other);
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn parts_are_known_by_their_samples(seed: u64, n_values in 1..4_u64) {
            let sample = |i: usize| {
                (seed.wrapping_mul(2 * i as u64 + 1).rotate_left(29) % (7 * n_values) / 7) as u8
            };
            let samples: Vec<u8> = (0..VOXELS).map(sample).collect();
            let row = |y: usize, z: usize| &samples[8 * (y + 8 * z)..][..8];
            let parts = Parts::of(samples[0], [8; 3], row);
            for g in 0..PARTS {
                let own: Vec<u8> = (0..8)
                    .map(|c| {
                        let [x, y, z] = [0, 1, 2].map(|axis| first_of(g, axis) + (c >> axis & 1));
                        samples[x + 8 * (y + 8 * z)]
                    })
                    .collect();
                prop_assert_eq!(&own, &parts.eight(g));
                let range = [own.iter().min(), own.iter().max()].map(|one| *one.unwrap());
                prop_assert_eq!(parts.range(g), range);
                prop_assert_eq!(parts.mixed() >> g & 1 == 1, range[0] < range[1]);
            }
        }
    }
}
