//! A divided node of 8³ samples: which of its parts are divided, and the values of its regions.

use super::{
    octree::{Region, Storage},
    sample::Value,
};
use crate::mesh::{Slices, VOXELS, index_of, slices};

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

/// Where the samples of a brick, x fastest, stand in Morton order.
static IN_MORTON_ORDER: [u16; VOXELS] = {
    let mut order = [0; VOXELS];
    let mut m = 0;
    while m < VOXELS {
        order[PLACES[m] as usize] = m as u16;
        m += 1;
    }
    order
};

/// From the first sample of a part of 2³ to each, in Morton order.
pub(super) const STEPS: [usize; 8] = [0, 1, 8, 9, 64, 65, 72, 73];

impl<V: Value> Brick<V> {
    /// The number of the region that holds a sample, counted x fastest.
    #[inline]
    fn find(&self, index: usize) -> usize {
        if self.is_finest() {
            return index;
        }
        let m = usize::from(IN_MORTON_ORDER[index]);
        let (c, level) = (m / 64, self.level_at(index));
        // The first sample of its region.
        let first = m >> (3 * level) << (3 * level);
        // One of every part before it, and seven more of each that is divided.
        let fours = (self.fours & ((1 << c) - 1)).count_ones();
        let twos = (self.twos & ((1 << (first / 8)) - 1)).count_ones();
        c + first / 8 % 8 + first % 8 + 7 * (fours + twos) as usize
    }

    /// The level of the region that holds a sample, counted x fastest.
    #[inline]
    pub(super) fn level_at(&self, index: usize) -> u8 {
        let m = IN_MORTON_ORDER[index];
        match (self.fours >> (m / 64) & 1, self.twos >> (m / 8) & 1) {
            (0, _) => 2,
            (_, 0) => 1,
            _ => 0,
        }
    }

    /// The region that holds a sample.
    #[inline]
    pub(super) fn region_at(&self, p: [u32; 3]) -> Region<V> {
        let index = index_of(p);
        let (number, level) = (self.find(index), self.level_at(index));
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
        self.values[self.find(index)]
    }

    /// Which samples have regions with such a value.
    #[inline]
    pub(super) fn slices(&self, is: impl Fn(V) -> bool) -> Slices {
        match self.is_finest() {
            true => slices(&self.values, |value| is(*value)),
            false => slices(&self.samples(), |value| is(*value)),
        }
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
    #[inline]
    pub(super) fn samples(&self) -> [V; VOXELS] {
        let mut samples = [V::default(); VOXELS];
        if self.is_finest() {
            samples.copy_from_slice(&self.values);
            return samples;
        }
        let mut values = &*self.values;
        for g in 0..VOXELS / 8 {
            let place = usize::from(PLACES[8 * g]);
            let own = &mut samples[place..place + STEPS[7] + 1];
            if self.twos >> g & 1 == 1
                && let Some((eight, rest)) = values.split_first_chunk::<8>()
            {
                (0..8).for_each(|c| own[STEPS[c]] = eight[c]);
                values = rest;
                continue;
            }
            let Some((&one, rest)) = values.split_first() else { break };
            STEPS.into_iter().for_each(|step| own[step] = one);
            // The parts of one that is not divided have one region together.
            if self.fours >> (g / 8) & 1 == 1 || g % 8 == 7 {
                values = rest;
            }
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
        let mut next = |m: usize, level: u8| {
            tell(number, PLACES[m].into(), level);
            number += 1;
        };
        for c in 0..8 {
            if self.fours >> c & 1 == 0 {
                next(64 * c, 2);
                continue;
            }
            for d in 8 * c..8 * c + 8 {
                if self.twos >> d & 1 == 0 {
                    next(8 * d, 1);
                    continue;
                }
                (8 * d..8 * d + 8).for_each(|m| next(m, 0));
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
