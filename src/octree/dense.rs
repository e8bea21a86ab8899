//! A dense grid: one bit for every place of the lattice whether the surface is there, and one
//! whether it lies inside, in Morton order.
//!
//! What is stored at a place is found by counting bits: a running count stands before every eight
//! words. The bits take 1/4 byte a place, however few voxels there are: 32 MiB at 512³.

use fixedbitset::FixedBitSet;

use super::{Bytes, Occupancy, OctNormal, Part, Storage, StoreVoxels, Voxel};
use crate::math::{morton_decode, morton_encode};

/// A dense grid of voxels; see the file's text.
#[derive(Clone, Debug)]
pub struct DenseGrid {
    depth: u32,
    surface: Vec<u64>,
    inside: Vec<u64>,
    /// Number of voxels before every eighth word.
    voxels_before: Vec<u32>,
    normals: Vec<OctNormal>,
    certified: FixedBitSet,
}

/// Bits of a word.
const WORD: u64 = u64::BITS as u64;
/// Words with one count.
const GROUP: usize = 8;
/// A part covers nodes of this many levels above the voxels: 32³ voxels.
const PART_LEVELS: u32 = 5;

/// Fills a [`DenseGrid`], from voxels in any order.
pub struct DenseGridBuilder {
    depth: u32,
    voxels: Vec<(u64, OctNormal, bool)>,
    inside: Vec<u64>,
}

impl DenseGridBuilder {
    /// An empty grid of `2^depth` places along an axis.
    #[must_use]
    pub fn new(depth: u32) -> Self {
        Self { depth, voxels: Vec::new(), inside: vec![0; n_words(depth)] }
    }
}

/// Bytes of the bits and counts of a grid, whatever it holds.
#[must_use]
pub const fn dense_grid_bytes(depth: u32) -> u64 {
    (1_u64 << (3 * depth)).div_ceil(8) * 2 + (1_u64 << (3 * depth)).div_ceil(128)
}

fn n_words(depth: u32) -> usize {
    (1_u64 << (3 * depth)).div_ceil(WORD) as usize
}

impl StoreVoxels for DenseGridBuilder {
    fn store(&mut self, ijk: [u32; 3], normal: OctNormal, certified: bool) {
        self.voxels.push((morton_encode(ijk), normal, certified));
    }

    fn store_inside(&mut self, level: u32, ijk: [u32; 3]) {
        let n = 1_u64 << (3 * (self.depth - level));
        let first = morton_encode(ijk) * n;
        if n < WORD {
            self.inside[(first / WORD) as usize] |= ((1 << n) - 1) << (first % WORD);
        } else {
            let words = (first / WORD) as usize..((first + n) / WORD) as usize;
            self.inside[words].fill(u64::MAX);
        }
    }

    fn finish(self: Box<Self>) -> Box<dyn Storage> {
        let Self { depth, mut voxels, inside } = *self;
        voxels.sort_unstable_by_key(|&(code, ..)| code);
        let mut surface = vec![0; n_words(depth)];
        let mut certified = FixedBitSet::with_capacity(voxels.len());
        for (rank, &(code, _, is_certified)) in voxels.iter().enumerate() {
            surface[(code / WORD) as usize] |= 1 << (code % WORD);
            certified.set(rank, is_certified);
        }
        let mut sum = 0;
        let voxels_before = surface
            .chunks(GROUP)
            .map(|words: &[u64]| {
                let before = sum;
                sum += words.iter().map(|word| word.count_ones()).sum::<u32>();
                before
            })
            .collect();
        let normals = voxels.into_iter().map(|(_, normal, _)| normal).collect();
        Box::new(DenseGrid { depth, surface, inside, voxels_before, normals, certified })
    }
}

impl DenseGrid {
    fn has(bits: &[u64], code: u64) -> bool {
        bits[(code / WORD) as usize] >> (code % WORD) & 1 == 1
    }

    /// Number of voxels before the place `code`.
    fn rank(&self, code: u64) -> u32 {
        let word = (code / WORD) as usize;
        let group = word / GROUP;
        let before: u32 =
            self.surface[group * GROUP..word].iter().map(|word| word.count_ones()).sum();
        let within = self.surface[word] & ((1 << (code % WORD)) - 1);
        self.voxels_before[group] + before + within.count_ones()
    }

    /// The places of a part.
    fn codes(&self, part: Part) -> std::ops::Range<u64> {
        let n = 1_u64 << (3 * (self.depth - part.level));
        let first = morton_encode(part.ijk) * n;
        first..first + n
    }
}

impl Storage for DenseGrid {
    fn depth(&self) -> u32 {
        self.depth
    }

    fn voxel_count(&self) -> u32 {
        self.normals.len() as u32
    }

    fn bytes(&self) -> Bytes {
        let bits = 8 * (self.surface.len() + self.inside.len()) + 4 * self.voxels_before.len();
        Bytes::new(bits, &self.normals, &self.certified)
    }

    fn parts(&self) -> Vec<Part> {
        let level = self.depth.saturating_sub(PART_LEVELS);
        let part = |index: u32| Part { level, index, ijk: morton_decode(index.into()) };
        let is_full = |part: &Part| {
            let codes = self.codes(*part);
            let words = (codes.start / WORD) as usize..codes.end.div_ceil(WORD) as usize;
            self.surface[words].iter().any(|&word| word != 0)
        };
        (0..1 << (3 * level)).map(part).filter(is_full).collect()
    }

    fn visit(&self, part: Part, visit: &mut dyn FnMut(Voxel)) {
        let codes = self.codes(part);
        let mut rank = self.rank(codes.start);
        for word in codes.start / WORD..codes.end.div_ceil(WORD) {
            let mut bits = self.surface[word as usize];
            while bits != 0 {
                let ijk = morton_decode(word * WORD + u64::from(bits.trailing_zeros()));
                let (normal, certified) = (self.normal(rank), self.is_certified(rank));
                visit(Voxel { rank, ijk, normal, certified });
                rank += 1;
                bits &= bits - 1;
            }
        }
    }

    fn normal(&self, rank: u32) -> OctNormal {
        self.normals[rank as usize]
    }

    fn is_certified(&self, rank: u32) -> bool {
        self.certified[rank as usize]
    }

    fn find(&self, ijk: [u32; 3]) -> Option<u32> {
        let code = morton_encode(ijk);
        Self::has(&self.surface, code).then(|| self.rank(code))
    }

    fn occupancy(&self, ijk: [u32; 3]) -> Occupancy {
        let code = morton_encode(ijk);
        if Self::has(&self.surface, code) {
            Occupancy::Surface
        } else if Self::has(&self.inside, code) {
            Occupancy::Inside
        } else {
            Occupancy::Empty
        }
    }
}
