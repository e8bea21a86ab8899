//! A brick: an octant of 4³ voxels, which are decided together, as bits in Morton order.

use crate::octree::LevelMasks;

use super::{
    affine::VoxelVerdict,
    node::{Finding, Trend},
};

/// Levels of a brick.
pub const BRICK_LEVELS: u32 = 2;
/// Voxels along an edge of a brick.
pub(super) const BRICK_EDGE: u32 = 1 << BRICK_LEVELS;
/// Voxels of a brick.
pub(super) const BRICK_VOXELS: usize = BRICK_EDGE.pow(3) as usize;

/// From a brick's first voxel to voxel `m`.
pub(super) const fn offset(m: u32) -> [u32; 3] {
    [m & 1 | m >> 2 & 2, m >> 1 & 1 | m >> 3 & 2, m >> 2 & 1 | m >> 4 & 2]
}

/// The bits of octant `c` of a brick, from those of 8 voxels.
#[inline(always)]
pub(super) fn of_octant(bits: u64, c: u32) -> u64 {
    bits << (8 * c)
}

/// The bits of the 8 voxels of octant `c`.
#[inline(always)]
pub(super) fn octant(bits: u64, c: u32) -> u8 {
    (bits >> (8 * c)) as u8
}

/// What is known of the voxels of a brick; bit m is voxel m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Brick {
    /// The first voxel.
    pub(super) first: [u32; 3],
    /// The voxels that lie in the lattice.
    pub(super) present: u64,
    /// The surface may pass through.
    pub(super) mixed: u64,
    /// F < 0.
    pub(super) inside: u64,
    /// The surface provably passes through.
    pub(super) certified: u64,
    /// F is continuous, and the tape's region holds the voxel.
    pub(super) regular: u64,
    /// F < 0 at a corner.
    pub(super) negative: u64,
    /// F > 0 at a corner.
    pub(super) positive: u64,
    /// How F runs through each octant.
    pub(super) trends: [Trend; 8],
}

impl Brick {
    /// Nothing found yet, for a lattice of `n_voxels`.
    pub(super) fn new(first: [u32; 3], n_voxels: [u32; 3]) -> Self {
        let mut present = u64::MAX;
        for axis in 0..3 {
            if first[axis] + BRICK_EDGE > n_voxels[axis] {
                for m in 0..BRICK_VOXELS as u32 {
                    let is_beyond = first[axis] + offset(m)[axis] >= n_voxels[axis];
                    present &= !(u64::from(is_beyond) << m);
                }
            }
        }
        Self {
            first,
            present,
            mixed: present,
            inside: 0,
            certified: 0,
            regular: 0,
            negative: 0,
            positive: 0,
            trends: [Trend::UNKNOWN; 8],
        }
    }

    /// Takes over what is proven of voxels in which F is continuous.
    pub(super) fn tell(&mut self, verdict: &VoxelVerdict) {
        let VoxelVerdict { empty, inside, negative, positive } = *verdict;
        self.mixed &= !(empty | inside);
        self.inside |= inside;
        self.certified |= self.mixed & negative & positive;
        self.negative |= negative;
        self.positive |= positive;
    }

    /// Whether it lies in the lattice whole.
    pub(super) fn is_whole(&self) -> bool {
        self.present == u64::MAX
    }

    /// Whether octant `c` has a trend.
    pub(super) fn has_trend(&self, c: u32) -> bool {
        self.trends[c as usize].is_known()
    }

    /// The voxels in octants that have a trend.
    pub(super) fn with_trend(&self) -> u64 {
        let bits = |c: u32| u64::from(self.has_trend(c)) * of_octant(u64::from(u8::MAX), c);
        (0..8).map(bits).sum()
    }

    /// The place of voxel `m`.
    #[inline(always)]
    pub(super) fn voxel(&self, m: u32) -> [u32; 3] {
        let offset = offset(m);
        [0, 1, 2].map(|axis| self.first[axis] + offset[axis])
    }

    /// The voxels that are not decided.
    #[inline(always)]
    pub(super) fn open(&self) -> u64 {
        self.mixed & !self.certified
    }

    /// Notes what was found of voxel `m`.
    pub(super) fn conclude(&mut self, m: u32, finding: Finding) {
        match finding {
            Finding::Candidate => {}
            Finding::Certified => self.certified |= 1 << m,
            Finding::Empty => self.mixed &= !(1 << m),
            Finding::Inside => {
                self.mixed &= !(1 << m);
                self.inside |= 1 << m;
            }
        }
    }

    /// Adds its nodes to the last two levels of an octree, which end where it begins. Returns the
    /// voxels of the octants that are divided.
    pub(super) fn push_masks(&self, [octants, voxels]: [&mut LevelMasks; 2]) -> u64 {
        let (mut mixed, mut inside, mut divided) = (0, 0, 0);
        for c in 0..8 {
            let (is_mixed, is_inside) = (octant(self.mixed, c), octant(self.inside, c));
            let is_present = octant(self.present, c);
            if is_present != 0 && is_inside == is_present {
                inside |= 1 << c;
            } else if is_mixed | is_inside != 0 {
                mixed |= 1 << c;
                divided |= of_octant(u64::from(u8::MAX), c);
                voxels.push(is_mixed, is_inside);
            }
        }
        octants.push(mixed, inside);
        divided
    }
}

/// The places of the set bits, ascending.
#[inline(always)]
pub(super) fn places(mask: u64) -> impl Iterator<Item = u32> {
    let mut rest = mask;
    std::iter::from_fn(move || {
        let place = rest.trailing_zeros();
        rest &= rest.wrapping_sub(1);
        (place < 64).then_some(place)
    })
}
