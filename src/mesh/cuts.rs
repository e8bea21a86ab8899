//! Which dual edges of a brick the surface cuts, and their numbers in it.
//!
//! The line between the middles of two voxels that share a face is a *dual edge*. It belongs to the
//! smaller voxel, or of equal ones to the lower one, and is a bit of that voxel's brick: its number is
//! the count of bits before it.

use std::ops::Range;

use rayon::prelude::*;

use super::{
    cases::N_TRIANGLES,
    grid::{Grid, Leaf, SIDE, VOXELS, Voxels, index_of},
    halo::Halo,
};

/// Directions from a voxel to its neighbours: +x, +y, +z, −x, −y, −z.
const DIRECTIONS: usize = 6;
/// Eight for each direction, one for each slice of the brick.
const WORDS: usize = DIRECTIONS * VOXELS / 64;
/// Those of three directions.
const HALF: usize = WORDS / 2;

/// A dual edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DualEdge {
    /// The smaller voxel, or of equal ones the lower.
    pub(super) owner: Leaf,
    /// The way to the other one.
    pub(super) direction: usize,
}

impl DualEdge {
    /// Between two voxels that share a face, from the lower to the upper one along `axis`.
    #[inline]
    pub(super) fn between(lower: Leaf, upper: Leaf, axis: usize) -> Self {
        if upper.level < lower.level {
            Self { owner: upper, direction: axis + 3 }
        } else {
            Self { owner: lower, direction: axis }
        }
    }

    /// Where it is marked in the brick of its owner.
    #[inline]
    pub(super) fn slot(&self) -> usize {
        VOXELS * self.direction + index_of(self.owner.base)
    }
}

/// Which dual edges of a brick's own are cut.
#[derive(Clone, Debug, Default)]
pub(super) struct Cuts {
    upwards: Marks,
    /// Edges that leave voxels against an axis, if any are cut: they lead to larger voxels.
    downwards: Option<Box<Marks>>,
    /// How many there are.
    n: u16,
    /// Whether voxels of the brick that are larger than the finest have cut edges to others that are.
    pub(super) has_large: bool,
    /// As many triangles as its cells have, or more where some of them are collapsed.
    room: u16,
}

/// Edges in three directions.
#[derive(Clone, Debug, Default)]
struct Marks {
    /// Bit voxel + 512 direction.
    bits: [u64; HALF],
    /// Set bits before each word, of all directions.
    before: [u16; HALF],
}

impl Marks {
    /// Counts bits, of which there are `n` before. How many there are then.
    fn number(&mut self, mut n: u16) -> u16 {
        for (before, bits) in self.before.iter_mut().zip(&self.bits) {
            *before = n;
            n += bits.count_ones() as u16;
        }
        n
    }
}

impl Cuts {
    /// Those of `wanted` bricks; `cuts` has those of all others.
    pub(super) fn find<B: Voxels>(
        cuts: &mut [Self],
        grid: &Grid<B>,
        wanted: impl Fn(usize) -> bool + Sync,
    ) {
        let far: Vec<Vec<DualEdge>> = cuts
            .par_iter_mut()
            .enumerate()
            .filter(|&(number, _)| wanted(number))
            .map(|(number, cuts)| cuts.mark_all(&Halo::new(grid, number)))
            .collect();
        for edge in far.iter().flatten() {
            if let Some(number) = grid.number_at(edge.owner.base.map(|i| i / SIDE)) {
                let cuts = &mut cuts[number as usize];
                cuts.mark(edge);
                cuts.number();
            }
        }
    }

    /// The number of the first edge of each brick, if all are numbered one after the other.
    pub(super) fn firsts(cuts: &[Self]) -> Vec<u32> {
        let mut n = 0;
        let first = |cuts: &Self| {
            n += cuts.count();
            n - cuts.count()
        };
        cuts.iter().map(first).collect()
    }

    /// Marks those of a brick, and tells of edges whose owners are larger than bricks and begin in
    /// another.
    fn mark_all<B: Voxels>(&mut self, halo: &Halo<'_, B>) -> Vec<DualEdge> {
        let cells = halo.cells();
        let mut far = Vec::new();
        let coarse = halo.own_coarse();
        for axis in 0..3 {
            for z in 0..SIDE as usize {
                // The finest voxels own the edges to all that are not lower and as small.
                self.upwards.bits[8 * axis + z] = cells.cut(0, z, axis) & !coarse[z];
            }
            if !halo.has_coarse {
                continue;
            }
            let from_large = halo.cut_from_large(axis);
            for z in 0..SIDE as usize {
                if from_large[z] & !coarse[z] != 0 {
                    *self.word_mut(8 * (axis + 3) + z) |= from_large[z] & !coarse[z];
                }
                // Of others their ends tell who is the owner.
                let upwards = cells.large(0, z, axis);
                for (is_up, mut rest) in [(true, upwards), (false, from_large[z] & coarse[z])] {
                    self.has_large |= rest != 0;
                    while rest != 0 {
                        let bit = rest.trailing_zeros() as usize;
                        rest &= rest - 1;
                        let mut at = [1 + bit % 8, 1 + bit / 8, 1 + z];
                        at[axis] -= usize::from(!is_up);
                        let edge = halo.edge(at, axis);
                        if halo.owns(edge.owner.base) {
                            self.mark(&edge);
                        } else if 1 << edge.owner.level > SIDE && far.last() != Some(&edge) {
                            far.push(edge);
                        }
                    }
                }
            }
        }
        self.number();
        let n_triangles = &*N_TRIANGLES;
        for z in 0..SIDE as usize {
            cells.each_mixed(z, |_, case| self.room += u16::from(n_triangles[case]));
        }
        far
    }

    fn mark(&mut self, edge: &DualEdge) {
        let slot = edge.slot();
        *self.word_mut(slot / 64) |= 1 << (slot % 64);
    }

    /// Counts bits once edges are marked.
    fn number(&mut self) {
        self.n = self.upwards.number(0);
        if let Some(downwards) = &mut self.downwards {
            self.n = downwards.number(self.n);
        }
    }

    /// The marks that a word is among, if there are any, and its number there.
    #[inline]
    fn marks(&self, word: usize) -> Option<(&Marks, usize)> {
        match word.checked_sub(HALF) {
            None => Some((&self.upwards, word)),
            Some(word) => self.downwards.as_deref().map(|marks| (marks, word)),
        }
    }

    fn word(&self, word: usize) -> u64 {
        self.marks(word).map_or(0, |(marks, word)| marks.bits[word])
    }

    fn word_mut(&mut self, word: usize) -> &mut u64 {
        match word.checked_sub(HALF) {
            None => &mut self.upwards.bits[word],
            Some(word) => &mut self.downwards.get_or_insert_default().bits[word],
        }
    }

    /// Whether the brick has no vertices and no triangles.
    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.count() == 0 && self.room == 0
    }

    /// As many triangles as its cells have, or more.
    pub(super) fn room(&self) -> usize {
        self.room.into()
    }

    #[inline]
    pub(super) fn count(&self) -> u32 {
        self.n.into()
    }

    /// The words of edges that leave voxels against an axis, if there are any.
    #[inline]
    pub(super) fn downwards(&self) -> Range<usize> {
        if self.downwards.is_some() { HALF..WORDS } else { 0..0 }
    }

    /// The number of an edge among those of the brick.
    #[inline]
    pub(super) fn rank(&self, slot: usize) -> u32 {
        let (word, bit) = (slot / 64, slot % 64);
        debug_assert!(self.word(word) >> bit & 1 == 1, "every cut edge was marked");
        let Some((marks, word)) = self.marks(word) else { return 0 };
        u32::from(marks.before[word]) + (marks.bits[word] & ((1 << bit) - 1)).count_ones()
    }

    /// Of every edge that is cut here or in another, in order, whether it is here and whether there.
    pub(super) fn merge(&self, other: &Self, mut tell: impl FnMut(bool, bool)) {
        for word in 0..WORDS {
            let (own, others) = (self.word(word), other.word(word));
            let mut rest = own | others;
            while rest != 0 {
                let bit = rest & rest.wrapping_neg();
                rest ^= bit;
                tell(own & bit != 0, others & bit != 0);
            }
        }
    }

    /// Whether an edge of a voxel is cut.
    pub(super) fn has_vertices_at(&self, voxel: usize) -> bool {
        (0..DIRECTIONS).any(|k| self.word((VOXELS * k + voxel) / 64) >> (voxel % 64) & 1 == 1)
    }

    /// Calls `tell` with each cut edge of a word and its number, in order; `of` has bits for those
    /// that are wanted.
    #[inline]
    pub(super) fn each(&self, word: usize, of: u64, mut tell: impl FnMut(usize, u32)) {
        let Some((marks, own)) = self.marks(word) else { return };
        let bits = marks.bits[own];
        let mut rest = bits & of;
        if rest == bits {
            let mut rank = u32::from(marks.before[own]);
            while rest != 0 {
                tell(rest.trailing_zeros() as usize, rank);
                rest &= rest - 1;
                rank += 1;
            }
            return;
        }
        while rest != 0 {
            let bit = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            tell(bit, self.rank(64 * word + bit));
        }
    }
}
