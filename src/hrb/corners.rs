//! Responsibilities: which region answers for which dual cell.
//!
//! A dual cell belongs to each corner that regions have. Of the regions around it the smallest answers
//! for it, and of equal ones the one in the lowest octant; one bit for each corner of a region says
//! so, and no cell is stored. The smallest region around a corner has it for a corner too, so that
//! there is always one to answer. The bits depend on the eight regions alone: after a change they are
//! found again for what has changed and what touches it.
//!
//! *Based on:* A. León Salas, 2008, section 2.3.

use std::ops::RangeInclusive;

use rayon::prelude::*;

use super::{
    HrbOctree, Samples, Value,
    brick::Brick,
    edit::Division,
    octree::{BRICK_LEVEL, Tree, child},
    rows::{Rows, rows_around},
};
use crate::mesh::{SIDE, VOXELS};

/// Rows of samples in a brick.
const ROWS: usize = VOXELS / SIDE as usize;

/// The level of what lies beyond the volume: it answers for nothing.
const BEYOND: u8 = u8::MAX;

impl<V: Value> HrbOctree<V> {
    /// Finds for every region the corners that it answers for.
    pub fn assign_corners(&mut self) {
        let mut bases = Vec::new();
        self.each_part(&self.samples(), 0..=u8::MAX, &mut |base, _| bases.push(base));
        self.assign_corners_at(&bases);
    }

    /// The same where regions are others than before, and around.
    pub(super) fn assign_corners_around(&mut self, divisions: &[Division]) {
        let mut bases = Vec::new();
        for Division { samples, levels } in divisions {
            self.each_part(&samples.grown(1), levels.clone(), &mut |base, _| bases.push(base));
        }
        bases.sort_unstable();
        bases.dedup();
        self.assign_corners_at(&bases);
    }

    /// The same for bricks and larger regions that begin there.
    fn assign_corners_at(&mut self, bases: &[[u32; 3]]) {
        let found: Vec<Box<[u8]>> = bases.par_iter().map(|&base| self.corners_at(base)).collect();
        for (&base, bits) in bases.iter().zip(found) {
            match self.brick_at_mut(base) {
                Tree::Brick(brick) => brick.corners = bits,
                Tree::Region { corners, .. } => *corners = bits.first().copied().unwrap_or(0),
                Tree::Node(_) => unreachable!("nodes end in bricks and regions"),
            }
        }
    }

    /// Tells of all bricks, and larger regions, that reach into a box: the first sample and the level.
    /// Those without regions of some `levels` are left out.
    pub(super) fn each_part(
        &self,
        within: &Samples,
        levels: RangeInclusive<u8>,
        tell: &mut dyn FnMut([u32; 3], u8),
    ) {
        self.each_part_of(&self.root, [0; 3], self.depth, (within, &levels), tell);
    }

    fn each_part_of(
        &self,
        tree: &Tree<V>,
        base: [u32; 3],
        level: u8,
        wanted: (&Samples, &RangeInclusive<u8>),
        tell: &mut dyn FnMut([u32; 3], u8),
    ) {
        let (within, levels) = wanted;
        if !within.meets(base, level) || !self.holds(base) {
            return;
        }
        match tree {
            Tree::Node(node) if level > *levels.start() => {
                for (c, tree) in node.children.iter().enumerate() {
                    self.each_part_of(tree, child(base, level, c), level - 1, wanted, tell);
                }
            }
            Tree::Brick(_) if *levels.start() < BRICK_LEVEL => tell(base, level),
            Tree::Region { .. } if levels.contains(&level) => tell(base, level),
            _ => {}
        }
    }

    /// The bits of a brick, one byte for each of its regions, or of a larger region.
    fn corners_at(&self, base: [u32; 3]) -> Box<[u8]> {
        match self.brick_at(base) {
            (Tree::Brick(brick), _) => self.corners_of_brick(brick, base),
            (_, level) => Box::new([self.corners_of_region(base, level)]),
        }
    }

    fn corners_of_region(&self, base: [u32; 3], level: u8) -> u8 {
        let level_at = |c: usize, k: usize| {
            let p = [0, 1, 2].map(|axis| {
                let corner = base[axis] + ((c as u32 >> axis & 1) << level);
                (corner + (k as u32 >> axis & 1)).wrapping_sub(1)
            });
            if self.holds(p) { self.level_at(p) } else { BEYOND }
        };
        // Of the octants around corner c the region itself is in this one.
        let own = |c: usize| 7 - c;
        let answers = |c: usize| {
            (0..own(c)).all(|k| level_at(c, k) > level)
                && (own(c) + 1..8).all(|k| level_at(c, k) >= level)
        };
        (0..8).fold(0, |bits, c| bits | u8::from(answers(c)) << c)
    }

    pub(super) fn corners_of_brick(&self, brick: &Brick<V>, base: [u32; 3]) -> Box<[u8]> {
        let around: [_; 27] = std::array::from_fn(|k| self.divided_at(base, k));
        // Which samples have regions below a level, with a layer around the brick.
        let is_inner = self.holds(base.map(|i| i + 2 * SIDE - 1));
        let below = |level: u8| -> Rows {
            rows_around(&around, |(brick, base), z| match is_inner {
                true => brick.below(level, z),
                false => brick.below(level, z) & self.held(*base, z),
            })
        };
        let mut all = vec![0; brick.values.len()].into_boxed_slice();
        let mut same = below(1);
        if same.as_flattened().iter().all(|&row| row == (1 << 10) - 1) {
            // Of eight samples the first answers.
            all.fill(1 << 7);
            return all;
        }
        let mut lower = Rows::default();
        let mut found = [0; ROWS];
        for level in 0..BRICK_LEVEL {
            if level > 0 {
                lower = same;
                same = below(level + 1);
            }
            if brick.has_level(level) {
                answers(level, &lower, &same, &mut found);
            }
        }
        brick.regions(|number, first, _| {
            all[number] = (found[first / 8] >> (8 * (first % 8))) as u8;
        });
        all
    }

    /// The brick, and its first sample, at x + 3y + 9z of the 27 around one, if it is divided.
    fn divided_at(&self, base: [u32; 3], k: usize) -> Option<(&Brick<V>, [u32; 3])> {
        let step = [k % 3, k / 3 % 3, k / 9];
        let p = [0, 1, 2].map(|axis| (base[axis] + SIDE * step[axis] as u32).wrapping_sub(SIDE));
        match self.holds(p).then(|| self.brick_at(p).0) {
            Some(Tree::Brick(brick)) => Some((brick, p)),
            _ => None,
        }
    }

    /// Bit x + 8y of slice z of the brick that begins there: the sample is one of the volume's.
    #[inline]
    fn held(&self, base: [u32; 3], z: usize) -> u64 {
        let n = [0, 1, 2].map(|axis| self.size[axis] - base[axis]);
        if n.iter().all(|&n| n >= SIDE) {
            return u64::MAX;
        }
        let row = (1_u64 << n[0].min(SIDE)) - 1;
        let is_held = |y: u32| y < n[1] && (z as u32) < n[2];
        (0..SIDE).fold(0, |slice, y| slice | if is_held(y) { row << (8 * y) } else { 0 })
    }
}

/// For regions of a level in a brick, at the places of their first samples, a byte each, the corners
/// that they answer for. `lower` and `same` have the samples of regions below that level and up to it.
fn answers(level: u8, lower: &Rows, same: &Rows, found: &mut [u64; ROWS]) {
    let size = 1 << level;
    for z in (0..8).step_by(size) {
        let own = |rows: &Rows| eight(&rows[z + 1], 1) >> 1;
        let begin = own(same) & !own(lower) & BEGIN[usize::from(level)];
        for side in 0..4 {
            // The corners on an edge along x; four pairs of octants are around them.
            let corner = [side & 1, side >> 1].map(|step| step << level);
            let pair =
                |rows: &Rows, k: usize| eight(&rows[z + corner[1] + (k >> 1)], corner[0] + (k & 1));
            // Another answers if it is smaller, or as small and before.
            let own = 3 - side;
            let around = (0..4).filter(|&k| k != own).fold(0, |others, k| {
                let pair = pair(if k < own { same } else { lower }, k);
                others | pair | pair >> 1
            });
            let others = [around | pair(same, own), (around | pair(lower, own) >> 1) >> size];
            for (c, others) in (2 * side..).zip(others) {
                mark(begin & !others, c, &mut found[8 * z..8 * z + 8]);
            }
        }
    }
}

/// Of eight rows in a slice, 16 bits each, where regions of each level may begin.
const BEGIN: [u128; BRICK_LEVEL as usize] = [
    u128::MAX / 0xffff * 0xff,
    u128::MAX / 0xffff_ffff * 0x55,
    u128::MAX / u64::MAX as u128 * 0x11,
];

/// Eight rows of a slice, 16 bits each; nothing where there are no more.
#[inline]
fn eight(slice: &[u16; 10], first: usize) -> u128 {
    let start = first.min(2);
    let Some(rows) = slice[start..].first_chunk::<8>() else { return 0 };
    // One load each.
    let four = |i: usize| (0..4).fold(0, |four, k| four | u64::from(rows[i + k]) << (16 * k));
    (u128::from(four(0)) | u128::from(four(4)) << 64) >> (16 * (first - start))
}

/// Marks corner c of the regions that begin in a slice at these places, eight rows of 16 bits.
#[inline]
fn mark(rows: u128, c: usize, slice: &mut [u64]) {
    let mut rest = rows;
    for row in slice {
        if rest == 0 {
            return;
        }
        // A bit in each of eight bytes.
        let eight = (rest as u64 & 0xff) * 0x0101_0101_0101_0101;
        let bits = eight & 0x8040_2010_0804_0201;
        let set = (bits + 0x7f7f_7f7f_7f7f_7f7f) >> 7 & 0x0101_0101_0101_0101;
        *row |= set << c;
        rest >>= 16;
    }
}
