//! Levels of detail: an octree with coarser ones above it, each made when it is asked for.
//!
//! A node stands for the surface in it: its normal is the mean of those of its voxels, each with
//! the area of its piece, and the length of that mean tells how much the normals agree.
//!
//! *Based on:* N. Stolte, A. Kaufman, 1998, section 5 (upper levels of the octree for what is far
//! away); M. Toksvig, "Mipmapping Normal Maps", Journal of Graphics Tools 2005 (the mean's length).

use std::sync::OnceLock;

use fixedbitset::FixedBitSet;
use glam::DVec3;
use rayon::prelude::*;

use super::{MortonOctree, OctNormal, Part, Storage};
use crate::math::Lattice;

/// The levels of a coarser octree below its root, at least: those of one part.
const LEAST_DEPTH: u32 = 5;

/// Nodes that a thread makes at a time, at least.
const MIN_NODES: usize = 1 << 12;

/// Below this the normals of a node point all ways, as those of two sheets do.
const LEAST_COHERENCE: f64 = 0.1;

/// Voxels, and larger voxels for what is far away.
#[derive(Debug)]
pub struct Detail<'a> {
    storage: &'a dyn Storage,
    lattice: &'a Lattice,
    /// The voxels in Morton order, where the storage is another.
    sorted: OnceLock<MortonOctree>,
    coarser: Vec<OnceLock<Coarser>>,
}

/// One level of detail: voxels and where they lie.
#[derive(Clone, Copy, Debug)]
pub struct DetailLevel<'a> {
    /// The voxels.
    pub storage: &'a dyn Storage,
    /// Where they lie.
    pub lattice: &'a Lattice,
    /// By rank; nothing where all normals are those of one place.
    patches: &'a [Patch],
}

#[derive(Debug)]
struct Coarser {
    octree: MortonOctree,
    lattice: Lattice,
    patches: Vec<Patch>,
}

/// The surface in a node.
#[derive(Clone, Copy, Debug)]
struct Patch {
    /// The sum of unit normals times areas, in squares of the smallest voxels.
    sum: DVec3,
    /// The sum of the areas.
    area: f64,
}

impl<'a> Detail<'a> {
    /// The levels of `storage`, whose voxels lie on `lattice`.
    #[must_use]
    pub fn new(storage: &'a dyn Storage, lattice: &'a Lattice) -> Self {
        let n = storage.depth().saturating_sub(LEAST_DEPTH);
        let coarser = (0..n).map(|_| OnceLock::new()).collect();
        Self { storage, lattice, sorted: OnceLock::new(), coarser }
    }

    /// How many coarser levels there are.
    #[must_use]
    pub fn n_coarser(&self) -> u32 {
        self.coarser.len() as u32
    }

    /// The level whose voxels are `2^up` times as large; voxels of the finest at 0.
    ///
    /// # Panics
    /// If `up` is above [`Detail::n_coarser`].
    #[must_use]
    pub fn level(&self, up: u32) -> DetailLevel<'_> {
        let Some(above) = up.checked_sub(1) else {
            let Self { storage, lattice, .. } = *self;
            return DetailLevel { storage, lattice, patches: &[] };
        };
        let Coarser { octree, lattice, patches } = self.coarser(above);
        DetailLevel { storage: octree, lattice, patches }
    }

    /// The nodes of a level of the octree whose voxels are `2^up` times as large.
    ///
    /// # Panics
    /// If `up` is 0 or above [`Detail::n_coarser`].
    #[must_use]
    pub fn nodes(&self, up: u32, level: u32) -> Vec<Part> {
        self.coarser(up - 1).octree.nodes(level)
    }

    fn coarser(&self, above: u32) -> &Coarser {
        self.coarser[above as usize].get_or_init(|| {
            let lattice = self.lattice.coarser(above + 1);
            match above.checked_sub(1) {
                None => {
                    let sort = || MortonOctree::of(self.storage);
                    let sorted = self.storage.as_morton();
                    let finer = sorted.unwrap_or_else(|| self.sorted.get_or_init(sort));
                    Coarser::above(finer, &[], lattice)
                }
                Some(below) => {
                    let finer = self.coarser(below);
                    Coarser::above(&finer.octree, &finer.patches, lattice)
                }
            }
        })
    }
}

impl DetailLevel<'_> {
    /// How much the normals of the voxel at `rank` agree: from 0, not at all, to 1.
    #[must_use]
    pub fn coherence(&self, rank: u32) -> f64 {
        self.patches.get(rank as usize).map_or(1.0, Patch::coherence)
    }
}

impl Patch {
    /// Of a plane through the middle of a voxel, about: exactly so for those along its faces.
    fn of_voxel(normal: OctNormal) -> Self {
        let direction = normal.direction();
        // The sum is the unit normal times the area 1 / max |n|: no root is needed for it.
        let sum = direction / direction.abs().max_element();
        Self { sum, area: sum.length() }
    }

    fn coherence(&self) -> f64 {
        self.sum.length() / self.area
    }
}

impl Coarser {
    /// The octree whose voxels are the parents of those of `finer`, which are `patches` unless
    /// they are those of one place.
    fn above(finer: &MortonOctree, patches: &[Patch], lattice: Lattice) -> Self {
        let node = |node: usize| {
            let ranks = finer.siblings(node);
            let patch_of = |rank: u32| match patches.get(rank as usize) {
                Some(patch) => *patch,
                None => Patch::of_voxel(finer.normal(rank)),
            };
            let mut whole = Patch { sum: DVec3::ZERO, area: 0.0 };
            for patch in ranks.clone().map(patch_of) {
                whole.sum += patch.sum;
                whole.area += patch.area;
            }
            let normal = if whole.coherence() >= LEAST_COHERENCE {
                OctNormal::encode(whole.sum)
            } else {
                // The largest piece; of equal ones the first.
                let larger =
                    |a: u32, b: u32| if patch_of(b).area > patch_of(a).area { b } else { a };
                finer.normal(ranks.clone().fold(ranks.start, larger))
            };
            (normal, whole, ranks.clone().any(|rank| finer.is_certified(rank)))
        };
        let nodes: Vec<(OctNormal, Patch, bool)> =
            (0..finer.n_parents()).into_par_iter().with_min_len(MIN_NODES).map(node).collect();
        let mut certified = FixedBitSet::with_capacity(nodes.len());
        certified.extend((0..nodes.len()).filter(|&i| nodes[i].2));
        let normals = nodes.iter().map(|node| node.0).collect();
        let octree = finer.without_last_level(normals, certified);
        Self { octree, lattice, patches: nodes.iter().map(|node| node.1).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        math::{Aabb, morton_decode},
        octree::{NodeState, StorageKind, masks::masks_above},
    };
    use proptest::prelude::*;
    use std::collections::{BTreeMap, BTreeSet};

    const DEPTH: u32 = 7;

    fn octree(voxels: &BTreeMap<u64, DVec3>) -> MortonOctree {
        let normals = voxels.values().map(|&n| OctNormal::encode(n)).collect();
        let mut certified = FixedBitSet::with_capacity(voxels.len());
        certified.extend((0..voxels.len()).step_by(3));
        MortonOctree::new(
            NodeState::Mixed,
            masks_above(voxels.keys().copied().collect(), DEPTH),
            normals,
            certified,
        )
    }

    fn lattice() -> Lattice {
        Lattice::new(Aabb { min: DVec3::ZERO, max: DVec3::ONE }, 1 << DEPTH)
    }

    proptest! {
        /// A node is stored exactly where one of its voxels is, and certified where one of them is.
        #[test]
        fn coarser_levels_cover_the_same(
            codes in prop::collection::btree_set(0..1_u64 << (3 * DEPTH), 1..300),
        ) {
            let voxels = codes.iter().map(|&code| (code, DVec3::X)).collect();
            let (octree, lattice) = (octree(&voxels), lattice());
            let detail = Detail::new(&octree, &lattice);
            for up in 1..=detail.n_coarser() {
                let DetailLevel { storage, lattice, .. } = detail.level(up);
                let expected: BTreeSet<u64> = codes.iter().map(|code| code >> (3 * up)).collect();
                let certified: BTreeSet<u64> =
                    codes.iter().step_by(3).map(|code| code >> (3 * up)).collect();
                prop_assert_eq!(storage.voxel_count() as usize, expected.len());
                for &code in &expected {
                    let rank = storage.find(morton_decode(code)).unwrap();
                    prop_assert_eq!(storage.is_certified(rank), certified.contains(&code));
                    prop_assert_eq!(storage.normal(rank).decode(), DVec3::X);
                }
                prop_assert_eq!(lattice.depth(), DEPTH - up);
            }
        }

        /// Whatever the storage is.
        #[test]
        fn storages_have_the_same_levels(
            codes in prop::collection::btree_map(0..1_u64 << (3 * DEPTH), any::<u32>(), 1..200),
        ) {
            let normal = |bits: &u32| OctNormal::from_bits(*bits & 0x7fff_7fff).decode();
            let voxels = codes.iter().map(|(&code, bits)| (code, normal(bits))).collect();
            let (octree, lattice) = (octree(&voxels), lattice());
            let dense = StorageKind::Dense.keep(octree.clone());
            let (of_octree, of_dense) =
                (Detail::new(&octree, &lattice), Detail::new(&*dense, &lattice));
            let (a, b) = (of_octree.coarser(1), of_dense.coarser(1));
            prop_assert_eq!(a.octree.digest(), b.octree.digest());
        }
    }

    #[test]
    fn normals_are_weighed_by_area_and_opposite_ones_do_not_cancel() {
        let slanted = DVec3::new(1.0, 1.0, 0.0).normalize();
        let of = |a: DVec3, b: DVec3| {
            let (octree, lattice) = (octree(&[(0, a), (5, b)].into()), lattice());
            let detail = Detail::new(&octree, &lattice);
            let level = detail.level(1);
            (level.storage.normal(0).decode(), level.coherence(0))
        };
        let (normal, coherence) = of(DVec3::X, slanted);
        // A plane at 45 degrees has √2 times the area.
        assert!((normal - DVec3::new(2.0, 1.0, 0.0).normalize()).length() < 1e-3, "{normal}");
        let expected = 5.0_f64.sqrt() / (1.0 + 2.0_f64.sqrt());
        assert!((coherence - expected).abs() < 1e-3, "{coherence}");
        let (normal, coherence) = of(DVec3::Z, DVec3::NEG_Z);
        assert_eq!((normal, coherence), (DVec3::Z, 0.0));
        assert_eq!(
            Detail::new(&octree(&[(0, slanted)].into()), &lattice()).level(0).coherence(0),
            1.0
        );
    }
}
