//! The default storage: an octree without pointers, its nodes in Morton order.
//!
//! A level holds one byte of mixed children and one of inside children for every node, and for
//! every eight nodes the number of children before them; from that and a population count follows
//! where a node's children stand. Voxels are the children of the last level; their normals stand
//! in the same order. Shape takes 2.5 bytes a node, 0.7 bytes a voxel on the paper's scenes; normals
//! take 4 bytes a voxel, and certificates one bit.

use std::{hash::Hasher, ops::Range};

use fixedbitset::FixedBitSet;
use siphasher::sip128::{Hasher128, SipHasher13};

use super::{
    Bytes, LevelMasks, NodeState, Occupancy, OctNormal, Part, Storage, Voxel,
    masks::{bits, masks_above},
};
use crate::math::{child_of, morton_encode};

/// An octree of voxels; see the file's text.
#[derive(Clone, Debug)]
pub struct MortonOctree {
    levels: Vec<Level>,
    normals: Vec<OctNormal>,
    certified: FixedBitSet,
    /// What the root is; nothing else is stored unless it is mixed.
    root: NodeState,
}

#[derive(Clone, Debug)]
struct Level {
    masks: LevelMasks,
    /// Number of children before every eighth node.
    children_before: Vec<u32>,
}

impl Level {
    fn new(masks: LevelMasks) -> Self {
        let mut sum = 0;
        let children_before = masks
            .mixed
            .chunks(8)
            .map(|nodes| {
                let before = sum;
                sum += nodes.iter().map(|mask| mask.count_ones()).sum::<u32>();
                before
            })
            .collect();
        Self { masks, children_before }
    }

    /// Index of the first child of `node` in the next level.
    fn first_child(&self, node: usize) -> usize {
        let group = node / 8 * 8;
        let within: u32 = self.masks.mixed[group..node].iter().map(|mask| mask.count_ones()).sum();
        (self.children_before[node / 8] + within) as usize
    }

    /// Index of child `c` of `node` in the next level, if it is mixed.
    fn child(&self, node: usize, c: u32) -> Option<usize> {
        let mask = self.masks.mixed[node];
        let before = mask & ((1_u8 << c) - 1);
        (mask >> c & 1 == 1).then(|| self.first_child(node) + before.count_ones() as usize)
    }
}

/// A part covers nodes of this many levels above the voxels: 32³ voxels.
const PART_LEVELS: u32 = 5;

impl MortonOctree {
    /// Puts an octree together from the nodes of all its levels, the root's first, and the normals
    /// and certificates of the voxels, all in Morton order. `root` is what became of the root.
    ///
    /// # Panics
    /// If a level does not have as many nodes as the one above has mixed children, or the number
    /// of normals or certificates is not that of the last level's mixed children.
    #[must_use]
    pub fn new(
        root: NodeState,
        levels: Vec<LevelMasks>,
        normals: Vec<OctNormal>,
        certified: FixedBitSet,
    ) -> Self {
        let counts = levels.iter().map(LevelMasks::len).skip(1).chain([normals.len()]);
        for (level, count) in levels.iter().zip(counts) {
            let children: usize = level.mixed.iter().map(|mask| mask.count_ones() as usize).sum();
            assert_eq!(children, count, "every mixed child has a node");
        }
        assert_eq!(certified.len(), normals.len(), "every voxel has a certificate or none");
        assert!(u32::try_from(normals.len()).is_ok(), "voxels are counted in 32 bits");
        let stored = levels.first().is_some_and(|level| level.len() == 1);
        assert_eq!(stored, root == NodeState::Mixed, "the root is stored if it is mixed");
        Self { levels: levels.into_iter().map(Level::new).collect(), normals, certified, root }
    }

    /// The voxels of `storage`, without what lies inside.
    #[must_use]
    pub fn of(storage: &dyn Storage) -> Self {
        let mut codes = Vec::with_capacity(storage.voxel_count() as usize);
        let mut normals = Vec::with_capacity(codes.capacity());
        let mut certified = FixedBitSet::with_capacity(codes.capacity());
        for part in storage.parts() {
            storage.visit(part, &mut |voxel| {
                codes.push(morton_encode(voxel.ijk));
                normals.push(voxel.normal);
                certified.set(voxel.rank as usize, voxel.certified);
            });
        }
        let root = if codes.is_empty() { NodeState::Empty } else { NodeState::Mixed };
        Self::new(root, masks_above(codes, storage.depth()), normals, certified)
    }

    /// The number of nodes whose children are voxels.
    pub(super) fn n_parents(&self) -> usize {
        self.levels.last().map_or(0, |level| level.masks.len())
    }

    /// The ranks of the voxels in such a node.
    pub(super) fn siblings(&self, node: usize) -> Range<u32> {
        let Some(last) = self.levels.last() else { return 0..0 };
        let first = last.first_child(node) as u32;
        first..first + last.masks.mixed[node].count_ones()
    }

    /// The octree whose voxels are the nodes that have voxels here.
    pub(super) fn without_last_level(
        &self,
        normals: Vec<OctNormal>,
        certified: FixedBitSet,
    ) -> Self {
        let levels = self.levels[..self.levels.len().saturating_sub(1)].to_vec();
        assert_eq!((normals.len(), certified.len()), (self.n_parents(), self.n_parents()));
        Self { levels, normals, certified, root: self.root }
    }

    /// Number of voxels that the surface provably passes through.
    #[must_use]
    pub fn certified_count(&self) -> u32 {
        self.certified.count_ones(..) as u32
    }

    /// Replaces the normal of a voxel.
    pub fn set_normal(&mut self, rank: u32, normal: OctNormal) {
        self.normals[rank as usize] = normal;
    }

    /// A digest of the whole content; equal octrees have equal digests on every machine.
    #[must_use]
    pub fn digest(&self) -> u128 {
        let mut hasher = SipHasher13::new();
        for level in &self.levels {
            hasher.write(&level.masks.mixed);
            hasher.write(&level.masks.inside);
        }
        for normal in &self.normals {
            hasher.write_u32(normal.to_bits().to_le());
        }
        for block in self.certified.as_slice() {
            hasher.write_u64((*block as u64).to_le());
        }
        hasher.finish128().as_u128()
    }

    /// The voxels with the smallest and the largest coordinates on each axis.
    #[must_use]
    pub fn bounds(&self) -> Option<([u32; 3], [u32; 3])> {
        let mut bounds = ([u32::MAX; 3], [0; 3]);
        for part in self.parts() {
            self.visit(part, &mut |voxel| {
                for axis in 0..3 {
                    bounds.0[axis] = bounds.0[axis].min(voxel.ijk[axis]);
                    bounds.1[axis] = bounds.1[axis].max(voxel.ijk[axis]);
                }
            });
        }
        (!self.normals.is_empty()).then_some(bounds)
    }

    /// The mixed nodes of `level` with their coordinates on that level's lattice.
    #[must_use]
    pub fn nodes(&self, level: u32) -> Vec<Part> {
        let mut nodes = vec![[0; 3]];
        if self.root != NodeState::Mixed {
            return Vec::new();
        }
        for level in &self.levels[..level as usize] {
            nodes = nodes
                .iter()
                .zip(&level.masks.mixed)
                .flat_map(|(&ijk, &mask)| bits(mask).map(move |c| child_of(ijk, c)))
                .collect();
        }
        nodes.into_iter().zip(0..).map(|(ijk, index)| Part { level, index, ijk }).collect()
    }

    /// Calls `visit` with level and coordinates of every largest node that lies inside.
    pub fn visit_inside(&self, visit: &mut dyn FnMut(u32, [u32; 3])) {
        match self.root {
            NodeState::Empty => {}
            NodeState::Inside => visit(0, [0; 3]),
            NodeState::Mixed => self.walk_inside(0, 0, [0; 3], visit),
        }
    }

    fn walk_inside(
        &self,
        level: usize,
        index: usize,
        ijk: [u32; 3],
        visit: &mut dyn FnMut(u32, [u32; 3]),
    ) {
        let Some(here) = self.levels.get(level) else { return };
        for c in bits(here.masks.inside[index]) {
            visit(level as u32 + 1, child_of(ijk, c));
        }
        let first = here.first_child(index);
        for (nth, c) in bits(here.masks.mixed[index]).enumerate() {
            self.walk_inside(level + 1, first + nth, child_of(ijk, c), visit);
        }
    }

    fn walk(&self, level: usize, index: usize, ijk: [u32; 3], visit: &mut dyn FnMut(Voxel)) {
        let Some(here) = self.levels.get(level) else {
            let certified = self.certified.contains(index);
            visit(Voxel { rank: index as u32, ijk, normal: self.normals[index], certified });
            return;
        };
        let first = here.first_child(index);
        for (nth, c) in bits(here.masks.mixed[index]).enumerate() {
            self.walk(level + 1, first + nth, child_of(ijk, c), visit);
        }
    }
}

impl Storage for MortonOctree {
    fn depth(&self) -> u32 {
        self.levels.len() as u32
    }

    fn voxel_count(&self) -> u32 {
        self.normals.len() as u32
    }

    fn bytes(&self) -> Bytes {
        let shape: usize = self
            .levels
            .iter()
            .map(|level| 2 * level.masks.len() + 4 * level.children_before.len())
            .sum();
        Bytes::new(shape, &self.normals, &self.certified)
    }

    fn parts(&self) -> Vec<Part> {
        self.nodes(self.depth().saturating_sub(PART_LEVELS))
    }

    fn visit(&self, part: Part, visit: &mut dyn FnMut(Voxel)) {
        self.walk(part.level as usize, part.index as usize, part.ijk, visit);
    }

    fn normal(&self, rank: u32) -> OctNormal {
        self.normals[rank as usize]
    }

    fn is_certified(&self, rank: u32) -> bool {
        self.certified[rank as usize]
    }

    fn as_morton(&self) -> Option<&MortonOctree> {
        Some(self)
    }

    fn find(&self, ijk: [u32; 3]) -> Option<u32> {
        if self.root != NodeState::Mixed {
            return None;
        }
        let mut node = 0;
        for (level, shift) in self.levels.iter().zip((0..self.depth()).rev()) {
            node = level.child(node, octant_of(ijk, shift))?;
        }
        Some(node as u32)
    }

    fn occupancy(&self, ijk: [u32; 3]) -> Occupancy {
        match self.root {
            NodeState::Empty => return Occupancy::Empty,
            NodeState::Inside => return Occupancy::Inside,
            NodeState::Mixed => {}
        }
        let mut node = 0;
        for (level, shift) in self.levels.iter().zip((0..self.depth()).rev()) {
            let c = octant_of(ijk, shift);
            match level.child(node, c) {
                Some(child) => node = child,
                None if level.masks.inside[node] >> c & 1 == 1 => return Occupancy::Inside,
                None => return Occupancy::Empty,
            }
        }
        Occupancy::Surface
    }
}

/// Which child holds `ijk` in the node whose children have edges of 2^shift voxels.
fn octant_of(ijk: [u32; 3], shift: u32) -> u32 {
    let bit = |v: u32| v >> shift & 1;
    bit(ijk[0]) | bit(ijk[1]) << 1 | bit(ijk[2]) << 2
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        math::morton_encode,
        octree::{DenseGridBuilder, PointerOctreeBuilder, StoreVoxels},
    };
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    const DEPTH: u32 = 6;

    /// The octree of a set of Morton codes, each voxel's normal telling its code.
    fn octree(codes: &BTreeSet<u64>) -> MortonOctree {
        let mut levels = masks_above(codes.iter().copied().collect(), DEPTH);
        let normals = codes.iter().map(|&code| OctNormal::from_bits(code as u32)).collect();
        let certified = codes.iter().map(|code| code.is_multiple_of(3));
        let certified = certified.enumerate().filter(|&(_, is)| is).map(|(i, _)| i);
        let mut set = FixedBitSet::with_capacity(codes.len());
        set.extend(certified);
        // Some of the children without voxels lie inside.
        for level in &mut levels {
            for i in 0..level.len() {
                level.inside[i] = !level.mixed[i] & 0b0101_0011;
            }
        }
        let root = if codes.is_empty() { NodeState::Inside } else { NodeState::Mixed };
        MortonOctree::new(root, levels, normals, set)
    }

    /// All that a storage tells, in its order.
    fn content(storage: &dyn Storage) -> (Vec<Voxel>, Vec<Part>) {
        let mut voxels = Vec::new();
        let parts = storage.parts();
        for &part in &parts {
            storage.visit(part, &mut |voxel| voxels.push(voxel));
        }
        let places = parts.into_iter().map(|part| Part { index: 0, ..part }).collect();
        (voxels, places)
    }

    proptest! {
        #[test]
        fn visits_and_finds_exactly_what_is_stored(
            codes in prop::collection::btree_set(0..1_u64 << (3 * DEPTH), 1..200),
            other in 0..1_u64 << (3 * DEPTH),
        ) {
            let octree = octree(&codes);
            let mut seen = Vec::new();
            for part in octree.parts() {
                octree.visit(part, &mut |voxel| seen.push(voxel));
            }
            let order: Vec<u64> = seen.iter().map(|v| morton_encode(v.ijk)).collect();
            prop_assert!(order.iter().eq(&codes));
            for (rank, voxel) in seen.iter().enumerate() {
                prop_assert_eq!(voxel.rank as usize, rank);
                prop_assert_eq!(octree.find(voxel.ijk), Some(voxel.rank));
                prop_assert_eq!(voxel.normal.to_bits() as u64, morton_encode(voxel.ijk));
                prop_assert_eq!(voxel.certified, morton_encode(voxel.ijk).is_multiple_of(3));
                prop_assert_eq!(octree.is_certified(voxel.rank), voxel.certified);
            }
            let ijk = crate::math::morton_decode(other);
            prop_assert_eq!(octree.find(ijk).is_some(), codes.contains(&other));
            prop_assert_eq!(octree.occupancy(ijk) == Occupancy::Surface, codes.contains(&other));
        }

        /// The other storages, filled in any order, hold the same and say the same.
        #[test]
        fn storages_agree(
            codes in prop::collection::btree_set(0..1_u64 << (3 * DEPTH), 0..300),
            order in any::<u64>(),
            others in prop::collection::vec(0..1_u64 << (3 * DEPTH), 50),
        ) {
            let octree = octree(&codes);
            let (voxels, _) = content(&octree);
            let mut shuffled = voxels;
            shuffled.sort_by_key(|v| u64::from(v.rank).wrapping_mul(order | 1) >> 7 & 0xffff);
            let builders: [Box<dyn StoreVoxels>; 2] = [
                Box::new(PointerOctreeBuilder::new(DEPTH)),
                Box::new(DenseGridBuilder::new(DEPTH)),
            ];
            for mut builder in builders {
                let (first, last) = shuffled.split_at(shuffled.len() / 2);
                first.iter().for_each(|v| builder.store(v.ijk, v.normal, v.certified));
                octree.visit_inside(&mut |level, ijk| builder.store_inside(level, ijk));
                last.iter().for_each(|v| builder.store(v.ijk, v.normal, v.certified));
                let storage = builder.finish();
                prop_assert_eq!(content(&*storage), content(&octree));
                for &code in others.iter().chain(&codes) {
                    let ijk = crate::math::morton_decode(code);
                    prop_assert_eq!(storage.occupancy(ijk), octree.occupancy(ijk));
                    prop_assert_eq!(storage.find(ijk), octree.find(ijk));
                }
            }
        }
    }
}
