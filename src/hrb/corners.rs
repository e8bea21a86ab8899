//! Responsibilities: which region answers for which dual cell.
//!
//! A dual cell belongs to each corner that regions have. Of the regions around it the smallest answers
//! for it, and of equal ones the one in the lowest octant; one bit for each corner of a region says
//! so, and no cell is stored. The smallest region around a corner has it for a corner too, so that
//! there is always one to answer. The bits depend on the eight regions alone: after a change they are
//! found again for what has changed and what touches it.
//!
//! *Based on:* A. León Salas, 2008, section 2.3.

use rayon::prelude::*;

use super::{
    HrbOctree, Value,
    brick::Brick,
    edit::Samples,
    octree::{BRICK_LEVEL, Tree, child},
};
use crate::mesh::SIDE;

/// Samples along an edge of a brick with a layer of its neighbours around it.
const WIDTH: usize = SIDE as usize + 2;

/// The level of what lies beyond the volume: it answers for nothing.
const BEYOND: u8 = u8::MAX;

/// A region that is larger than a brick or as large, or the regions of a brick.
struct Part<'a, V> {
    base: [u32; 3],
    level: u8,
    brick: Option<&'a Brick<V>>,
}

impl<V: Value> HrbOctree<V> {
    /// Finds for every region the corners that it answers for.
    pub fn assign_corners(&mut self) {
        self.assign_corners_within(&Samples { first: [0; 3], end: [1 << self.depth; 3] });
    }

    /// The same for all regions that reach into a box.
    pub(super) fn assign_corners_within(&mut self, samples: &Samples) {
        let mut parts = Vec::new();
        collect(&self.root, [0; 3], self.depth, samples, &mut parts);
        let found: Vec<Box<[u8]>> = parts.par_iter().map(|part| self.corners_of(part)).collect();
        assign(&mut self.root, [0; 3], self.depth, samples, &mut found.into_iter());
    }

    /// The bits of a part, one byte for each of its regions.
    fn corners_of(&self, part: &Part<'_, V>) -> Box<[u8]> {
        let &Part { base, level, brick } = part;
        let Some(brick) = brick else {
            let is_real = self.holds(base);
            let own = if is_real { self.corners_of_region(base, level) } else { 0 };
            return Box::new([own]);
        };
        self.corners_of_brick(brick, base)
    }

    fn corners_of_region(&self, base: [u32; 3], level: u8) -> u8 {
        let level_at = |p: [u32; 3]| if self.holds(p) { self.region_at(p).level } else { BEYOND };
        corners(level, |c, k| {
            level_at([0, 1, 2].map(|axis| {
                let corner = base[axis] + ((c as u32 >> axis & 1) << level);
                (corner + (k as u32 >> axis & 1)).wrapping_sub(1)
            }))
        })
    }

    pub(super) fn corners_of_brick(&self, brick: &Brick<V>, base: [u32; 3]) -> Box<[u8]> {
        let around: [_; 27] = std::array::from_fn(|k| self.part_at(base, k));
        let is_finest = |part: &Option<(&Tree<V>, u8)>| matches!(part, Some((Tree::Brick(brick), _)) if brick.is_finest());
        if around.iter().all(is_finest) {
            // Of eight samples the first answers.
            return vec![1 << 7; brick.values.len()].into();
        }
        let mut levels = [[[BEYOND; WIDTH]; WIDTH]; WIDTH];
        for (k, part) in around.into_iter().enumerate() {
            let Some((part, level)) = part else { continue };
            let range = |axis: usize| match k / [1, 3, 9][axis] % 3 {
                0 => 0..1,
                1 => 1..WIDTH - 1,
                _ => WIDTH - 1..WIDTH,
            };
            for z in range(2) {
                for y in range(1) {
                    for x in range(0) {
                        let p = [x, y, z].map(|i| i as u32);
                        let p = [0, 1, 2].map(|axis| (base[axis] + p[axis]).wrapping_sub(1));
                        if self.holds(p) {
                            levels[z][y][x] = match part {
                                Tree::Brick(brick) => brick.region_at(p).level,
                                _ => level,
                            };
                        }
                    }
                }
            }
        }
        let mut all = vec![0; brick.values.len()];
        brick.regions(|number, first, level| {
            let at = [first % 8, first / 8 % 8, first / 64].map(|i| i + 1);
            if levels[at[2]][at[1]][at[0]] == BEYOND {
                return;
            }
            all[number] = corners(level, |c, k| {
                let [x, y, z] = [0, 1, 2]
                    .map(|axis| at[axis] + ((c >> axis & 1) << level) + (k >> axis & 1) - 1);
                levels[z][y][x]
            });
        });
        all.into()
    }

    /// The part of the octree, and its level, at brick x + 3y + 9z of the 27 around one.
    fn part_at(&self, base: [u32; 3], k: usize) -> Option<(&Tree<V>, u8)> {
        let step = [k % 3, k / 3 % 3, k / 9];
        let p = [0, 1, 2].map(|axis| (base[axis] + SIDE * step[axis] as u32).wrapping_sub(SIDE));
        self.holds(p).then(|| self.brick_at(p))
    }
}

/// The corners that a region of this level answers for, given the level of the region in octant k
/// around its corner c.
#[inline]
fn corners(level: u8, at: impl Fn(usize, usize) -> u8) -> u8 {
    let answers = |c: usize| {
        let own = 7 - c;
        (0..own).all(|k| at(c, k) > level) && (own + 1..8).all(|k| at(c, k) >= level)
    };
    (0..8).fold(0, |bits, c| bits | u8::from(answers(c)) << c)
}

fn collect<'a, V>(
    tree: &'a Tree<V>,
    base: [u32; 3],
    level: u8,
    within: &Samples,
    parts: &mut Vec<Part<'a, V>>,
) {
    if !within.meets(base, level) {
        return;
    }
    match tree {
        Tree::Region { .. } => parts.push(Part { base, level, brick: None }),
        Tree::Brick(brick) => parts.push(Part { base, level: BRICK_LEVEL, brick: Some(brick) }),
        Tree::Node(node) => {
            for (c, tree) in node.children.iter().enumerate() {
                collect(tree, child(base, level, c), level - 1, within, parts);
            }
        }
    }
}

/// Puts the bits of all parts where they belong, in the order of [`collect`].
fn assign<V>(
    tree: &mut Tree<V>,
    base: [u32; 3],
    level: u8,
    within: &Samples,
    found: &mut impl Iterator<Item = Box<[u8]>>,
) {
    if !within.meets(base, level) {
        return;
    }
    match tree {
        Tree::Node(node) => {
            for (c, tree) in node.children.iter_mut().enumerate() {
                assign(tree, child(base, level, c), level - 1, within, found);
            }
        }
        Tree::Brick(brick) => brick.corners = found.next().unwrap_or_default(),
        Tree::Region { corners, .. } => {
            *corners = found.next().and_then(|bits| bits.first().copied()).unwrap_or(0);
        }
    }
}
