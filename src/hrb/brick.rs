//! A divided node of 8³ samples: which of its parts are divided, and the values of its regions.

use super::{
    octree::{Region, Storage, octant},
    sample::Value,
};
use crate::mesh::{SIDE, Slices, VOXELS, index_of, slices};

/// See the file's text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Brick<V> {
    /// Bit c: the part of 4³ samples number x + 2y + 4z is divided.
    pub(super) fours: u8,
    /// Bit 8c + d: part d of 2³ samples of it is divided; only where it is divided itself.
    pub(super) twos: u64,
    /// The values of the regions: in Morton order or, where all are single samples, x fastest.
    pub(super) values: Box<[V]>,
    /// Of each region, the corners that it answers for; empty before they are assigned.
    pub(super) corners: Box<[u8]>,
    /// The least and the largest sample.
    pub(super) range: [V; 2],
}

/// Samples in a row and in a slice of a brick.
const ROW: usize = SIDE as usize;
const SLICE: usize = ROW * ROW;

/// Where the samples of a brick, in Morton order, stand in it, x fastest.
pub(super) static PLACES: [u16; VOXELS] = {
    let mut places = [0; VOXELS];
    let mut m = 0;
    while m < VOXELS {
        // Bit 3i + axis becomes bit i + 3 axis.
        let mut bit = 0;
        while bit < 9 {
            places[m] |= ((m >> bit & 1) << (bit / 3 + 3 * (bit % 3))) as u16;
            bit += 1;
        }
        m += 1;
    }
    places
};

impl<V: Value> Brick<V> {
    /// The number of the region that holds a sample, and its level.
    #[inline]
    fn find(&self, p: [u32; 3]) -> (usize, u8) {
        if self.is_finest() {
            return (index_of(p), 0);
        }
        let (c, d) = (octant(p, 2), octant(p, 1));
        let of_four = c
            + 7 * (self.fours & ((1 << c) - 1)).count_ones() as usize
            + 7 * (self.twos & ((1 << (8 * c)) - 1)).count_ones() as usize;
        if self.fours >> c & 1 == 0 {
            return (of_four, 2);
        }
        let within = (self.twos >> (8 * c)) as u8;
        let of_two = of_four + d + 7 * (within & ((1 << d) - 1)).count_ones() as usize;
        if within >> d & 1 == 0 { (of_two, 1) } else { (of_two + octant(p, 0), 0) }
    }

    /// The level of the region that holds a sample.
    #[inline]
    pub(super) fn level_at(&self, p: [u32; 3]) -> u8 {
        let (c, d) = (octant(p, 2), octant(p, 1));
        match (self.fours >> c & 1, self.twos >> (8 * c + d) & 1) {
            (0, _) => 2,
            (_, 0) => 1,
            _ => 0,
        }
    }

    /// The region that holds a sample.
    #[inline]
    pub(super) fn region_at(&self, p: [u32; 3]) -> Region<V> {
        let (number, level) = self.find(p);
        Region {
            base: p.map(|i| i >> level << level),
            level,
            value: self.values[number],
            corners: self.corners.get(number).copied().unwrap_or(0),
        }
    }

    /// The value of the region that holds a sample, counted x fastest.
    #[inline]
    pub(super) fn value(&self, index: usize) -> V {
        let number = if self.is_finest() { index } else { self.find(place_of(index)).0 };
        self.values[number]
    }

    /// Which samples have regions with such a value.
    #[inline]
    pub(super) fn slices(&self, is: impl Fn(V) -> bool) -> Slices {
        if self.is_finest() {
            return slices(&self.values, |value| is(*value));
        }
        let mut slices = [0; SIDE as usize];
        self.parts(|values, first, level| match values.first_chunk() {
            Some(eight) if level == 0 => mark_some(&mut slices, first, eight.map(&is)),
            _ if is(values[0]) => mark(&mut slices, first, level),
            _ => {}
        });
        slices
    }

    /// Whether all regions are single samples.
    #[inline]
    pub(super) fn is_finest(&self) -> bool {
        self.twos == u64::MAX
    }

    /// The level of its largest regions.
    pub(super) fn largest(&self) -> u8 {
        [2, 1, 0].into_iter().find(|&level| self.has_level(level)).unwrap_or(0)
    }

    /// Bit 8c + d: its part d of 2³ samples of part c of 4³ is divided otherwise than that of another
    /// brick, or within another.
    pub(super) fn divided_otherwise(&self, other: &Self) -> u64 {
        let fours = self.fours ^ other.fours;
        (0..8).fold(self.twos ^ other.twos, |parts, c| {
            parts | if fours >> c & 1 == 1 { 0xff << (8 * c) } else { 0 }
        })
    }

    /// Whether a region of this level, below a brick's, is in it.
    #[inline]
    pub(super) fn has_level(&self, level: u8) -> bool {
        match level {
            0 => self.twos != 0,
            1 => self.twos.count_ones() < 8 * self.fours.count_ones(),
            _ => self.fours != u8::MAX,
        }
    }

    /// All samples, x fastest.
    pub(super) fn samples(&self) -> [V; VOXELS] {
        let mut samples = [V::default(); VOXELS];
        if self.is_finest() {
            samples.copy_from_slice(&self.values);
        } else {
            self.parts(|values, first, level| match (level, values.first_chunk()) {
                (0, Some(eight)) => put(&mut samples, first, eight),
                (2, _) => fill::<_, 4>(&mut samples, first, values[0]),
                _ => fill::<_, 2>(&mut samples, first, values[0]),
            });
        }
        samples
    }

    /// Bit x + 8y of slice z: the sample's region is of a lower level than this one, of at most 3.
    #[inline]
    pub(super) fn below(&self, level: u8, z: usize) -> u64 {
        match level {
            0 => 0,
            _ if self.is_finest() => u64::MAX,
            1 => (0..4).fold(0, |slice, y| {
                // Two parts each of the two parts of 4³ samples along x.
                let parts =
                    self.twos >> (16 * (y >> 1) + 2 * (y & 1) + 32 * (z >> 2) + 4 * (z >> 1 & 1));
                let bits =
                    parts & 1 | (parts & 2) << 1 | (parts & 0x100) >> 4 | (parts & 0x200) >> 3;
                slice | (bits * 0x0303) << (16 * y)
            }),
            2 => (0..4).fold(0, |slice, c| {
                let is_divided = u64::from(self.fours >> (c + 4 * (z >> 2)) & 1);
                slice | (is_divided * (0x0f0f_0f0f << (4 * (c & 1)))) << (32 * (c >> 1))
            }),
            _ => u64::MAX,
        }
    }

    /// Calls `tell` with the number of every region, the place of its first sample in the brick, x
    /// fastest, and its level.
    #[inline]
    pub(super) fn regions(&self, mut tell: impl FnMut(usize, usize, u8)) {
        if self.is_finest() {
            (0..VOXELS).for_each(|place| tell(place, place, 0));
            return;
        }
        let mut number = 0;
        self.parts(|_, first, level| {
            let n = if level == 0 { 8 } else { 1 };
            for place in &PLACES[..n] {
                tell(number, first + usize::from(*place), level);
                number += 1;
            }
        });
    }

    /// Calls `tell` with every part that is one region, or 2³ single samples: the values from its first
    /// one on, the place of its first sample in the brick, x fastest, and the level of its regions.
    #[inline]
    fn parts(&self, mut tell: impl FnMut(&[V], usize, u8)) {
        let mut values = &self.values[..];
        let mut next = |m: usize, level: u8| {
            tell(values, PLACES[m].into(), level);
            values = &values[if level == 0 { 8 } else { 1 }..];
        };
        for c in 0..8 {
            if self.fours >> c & 1 == 0 {
                next(64 * c, 2);
                continue;
            }
            for d in 8 * c..8 * c + 8 {
                next(8 * d, u8::from(self.twos >> d & 1 == 0));
            }
        }
    }

    pub(super) fn count(&self, storage: &mut Storage) {
        storage.nodes += u64::from(1 + self.fours.count_ones() + self.twos.count_ones());
        storage.regions += self.values.len() as u64;
        storage.cells += self.corners.iter().map(|c| u64::from(c.count_ones())).sum::<u64>();
        storage.resident_bytes +=
            (size_of::<Self>() + size_of_val(&*self.values) + self.corners.len()) as u64;
    }
}

/// The place of a sample in its brick.
#[inline]
pub(super) fn place_of(index: usize) -> [u32; 3] {
    [index % 8, index / 8 % 8, index / 64].map(|i| i as u32)
}

/// Fills a cube of N³ samples of a brick.
#[inline]
fn fill<T: Copy, const N: usize>(all: &mut [T; VOXELS], first: usize, value: T) {
    for z in 0..N {
        for y in 0..N {
            let row = first + ROW * y + SLICE * z;
            all[row..row + N].copy_from_slice(&[value; N]);
        }
    }
}

/// Puts 2³ samples, in Morton order, into a brick.
#[inline]
fn put<T: Copy>(all: &mut [T; VOXELS], first: usize, eight: &[T; 8]) {
    for (k, pair) in eight.chunks_exact(2).enumerate() {
        let row = first + ROW * (k & 1) + SLICE * (k >> 1);
        all[row..row + 2].copy_from_slice(pair);
    }
}

/// Sets the bits of a cube of a brick.
#[inline]
fn mark(slices: &mut Slices, first: usize, level: u8) {
    const SQUARES: [u64; 3] = [1, 0x0303, 0x0f0f_0f0f];
    let (z, level) = (first / SLICE, usize::from(level));
    for slice in &mut slices[z..z + (1 << level)] {
        *slice |= SQUARES[level] << (first % SLICE);
    }
}

/// Sets the bits of some of 2³ samples, which are in Morton order.
#[inline]
fn mark_some(slices: &mut Slices, first: usize, are: [bool; 8]) {
    let bits = (0..8).fold(0, |bits, d| bits | u64::from(are[d]) << d);
    let z = first / SLICE;
    slices[z] |= (bits & 0x03 | (bits & 0x0c) << 6) << (first % SLICE);
    slices[z + 1] |= (bits >> 4 & 0x03 | (bits & 0xc0) << 2) << (first % SLICE);
}
