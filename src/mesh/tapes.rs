//! What a formula is in blocks of 32³ voxels: shorter, where it has choices.

use std::collections::HashMap;

use super::{Crossing, SIDE};
use crate::{
    expr::Tape,
    math::{Aabb, Lattice, SimdLevel},
    voxelize::{BLOCK_LEVELS, Wish, find_blocks},
};

/// F, and what it is in blocks of 32³ voxels.
pub(super) struct Tapes<'a> {
    pub(super) whole: &'a Tape,
    /// Those of the blocks that the surface may meet, if F can be shortened.
    of_blocks: HashMap<[u32; 3], Tape>,
    /// The number of the last voxel along each axis.
    last: [u32; 3],
}

impl<'a> Tapes<'a> {
    pub(super) fn new(whole: &'a Tape, lattice: &Lattice, simd: SimdLevel) -> Self {
        let last = lattice.n_voxels().map(|n| n - 1);
        let mut of_blocks = HashMap::new();
        if whole.n_choices() > 0 && lattice.depth() > BLOCK_LEVELS {
            let wish = |level: u32, _: &Aabb| match level + BLOCK_LEVELS >= lattice.depth() {
                true => Wish::Keep,
                false => Wish::Divide,
            };
            for block in find_blocks(whole.clone(), lattice, simd, &wish) {
                of_blocks.insert(block.ijk.map(|i| i as u32), (*block.tape).clone());
            }
        }
        Self { whole, of_blocks, last }
    }

    /// F in a brick.
    pub(super) fn of_brick(&self, place: [u32; 3]) -> &Tape {
        let block = place.map(|i| i.wrapping_sub(1) >> (BLOCK_LEVELS - SIDE.ilog2()));
        self.of_blocks.get(&block).unwrap_or(self.whole)
    }

    /// The numbers of edges that lie in one block, with F there, and of those that do not.
    pub(super) fn of_edges(&self, edges: &[Crossing]) -> Vec<(&Tape, Vec<usize>)> {
        if self.of_blocks.is_empty() {
            return vec![(self.whole, (0..edges.len()).collect())];
        }
        let block = |end: [f32; 3]| {
            [0, 1, 2].map(|axis| (end[axis] as u32).min(self.last[axis]) >> BLOCK_LEVELS)
        };
        let mut groups: Vec<([u32; 3], &Tape, Vec<usize>)> = Vec::new();
        let mut others = Vec::new();
        for (i, edge) in edges.iter().enumerate() {
            let [own, other] = edge.ends.map(block);
            let Some(tape) = self.of_blocks.get(&own).filter(|_| own == other) else {
                others.push(i);
                continue;
            };
            match groups.last_mut() {
                Some((block, _, members)) if *block == own => members.push(i),
                _ => groups.push((own, tape, vec![i])),
            }
        }
        let groups = groups.into_iter().map(|(_, tape, members)| (tape, members));
        groups.chain([(self.whole, others)]).collect()
    }
}
