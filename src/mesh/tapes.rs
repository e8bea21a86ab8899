//! What a formula is in blocks of voxels: shorter, where it has choices.

use std::{ptr, sync::Arc};

use rustc_hash::FxHashMap;

use super::{Crossing, SIDE};
use crate::{
    expr::Tape,
    math::{Aabb, Lattice, SimdLevel},
    voxelize::{BLOCK_LEVELS, Octant, Wish, find_blocks},
};

/// F, and what it is in blocks.
pub(super) struct Tapes<'a> {
    pub(super) whole: &'a Tape,
    /// Small blocks first: the levels of one, and those by their places.
    of_blocks: Vec<(u32, FxHashMap<[u32; 3], Arc<Tape>>)>,
    /// The number of the last voxel along each axis.
    last: [u32; 3],
}

impl<'a> Tapes<'a> {
    /// Looks for F in blocks of 32³ voxels, if it can be shortened.
    pub(super) fn find(whole: &'a Tape, lattice: &Lattice, simd: SimdLevel) -> Self {
        let mut found = Vec::new();
        if whole.n_choices() > 0 && lattice.depth() > BLOCK_LEVELS {
            let wish = |level: u32, _: &Aabb| match level + BLOCK_LEVELS >= lattice.depth() {
                true => Wish::Keep,
                false => Wish::Divide,
            };
            found = find_blocks(whole.clone(), lattice, simd, &wish);
        }
        Self::new(whole, lattice, found.into_iter())
    }

    /// Takes F in octants of `lattice`, no smaller than a brick.
    pub(super) fn new(
        whole: &'a Tape,
        lattice: &Lattice,
        octants: impl Iterator<Item = Octant>,
    ) -> Self {
        let mut of_blocks: Vec<(u32, FxHashMap<[u32; 3], Arc<Tape>>)> = Vec::new();
        for Octant { level, ijk, tape } in octants {
            let levels = lattice.depth() - level;
            let i = of_blocks.partition_point(|of_size| of_size.0 < levels);
            if of_blocks.get(i).is_none_or(|of_size| of_size.0 != levels) {
                of_blocks.insert(i, (levels, FxHashMap::default()));
            }
            of_blocks[i].1.insert(ijk.map(|i| i as u32), tape);
        }
        Self { whole, of_blocks, last: lattice.n_voxels().map(|n| n - 1) }
    }

    /// F in a brick.
    pub(super) fn of_brick(&self, place: [u32; 3]) -> &Tape {
        let first = place.map(|i| i.wrapping_sub(1).wrapping_mul(SIDE));
        self.of_box(first, first)
    }

    /// F between two voxels.
    fn of_box(&self, first: [u32; 3], last: [u32; 3]) -> &Tape {
        let shortest = self.of_blocks.iter().find_map(|(levels, tapes)| {
            let [own, other] = [first, last].map(|voxel| voxel.map(|i| i >> levels));
            tapes.get(&own).filter(|_| own == other)
        });
        shortest.map_or(self.whole, |tape| tape)
    }

    /// The numbers of edges by F there.
    pub(super) fn of_edges(&self, edges: &[Crossing]) -> Vec<(&Tape, Vec<usize>)> {
        if self.of_blocks.is_empty() {
            return vec![(self.whole, (0..edges.len()).collect())];
        }
        let voxel = |end: [f32; 3]| [0, 1, 2].map(|axis| (end[axis] as u32).min(self.last[axis]));
        let mut groups: Vec<(&Tape, Vec<usize>)> = Vec::new();
        for (i, edge) in edges.iter().enumerate() {
            let [first, last] = edge.ends.map(voxel);
            let tape = self.of_box(first, last);
            // Edges stand brick by brick, so that those before had the same one.
            match groups.iter_mut().rev().find(|(of_group, _)| ptr::eq(*of_group, tape)) {
                Some((_, members)) => members.push(i),
                None => groups.push((tape, vec![i])),
            }
        }
        groups
    }
}
