//! The bricks near an isosurface, found through the octree.

use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::{HrbOctree, Value, octree::Child};
use crate::mesh::{Border, Brick, Grid, SIDE, VOXELS};

/// A brick of 8³ samples in the octree.
#[derive(Clone, Copy)]
enum Place {
    /// Divided: the number of its node.
    Divided(usize),
    /// All of it is in one region.
    Whole,
}

/// Some samples of a brick are inside, some are not.
const INSIDE: u8 = 1;
const OUTSIDE: u8 = 2;
const BOTH: u8 = INSIDE | OUTSIDE;

impl<V: Value> HrbOctree<V> {
    /// Everything that a mesh of the isosurface needs: what is `isovalue` or above is inside.
    #[must_use]
    pub fn grid(&self, isovalue: f64, border: Border) -> Grid {
        let near = self.near(isovalue, border);
        let mut places: FxHashSet<[u32; 3]> = near.iter().copied().collect();
        for &place in &near {
            self.add_base(place, &mut places);
        }
        let places: Vec<[u32; 3]> = places.into_iter().collect();
        let brick = |place: [u32; 3]| self.brick(place, isovalue, border);
        let bricks = places.into_par_iter().map(brick).collect();
        Grid::new(bricks, self.size, isovalue, border)
    }

    /// The bricks next to which the surface may be, with the layer around the volume.
    fn near(&self, isovalue: f64, border: Border) -> Vec<[u32; 3]> {
        let n = self.size.map(|n| n.div_ceil(SIDE) as usize + 2);
        let index = |[x, y, z]: [usize; 3]| x + n[0] * (y + n[1] * z);
        let beyond = if border == Border::Capped { OUTSIDE } else { 0 };
        let mut sides = vec![beyond; n.iter().product()];
        self.mark(0, 0, [0; 3], isovalue, &mut |base, level, side| {
            let first = base.map(|i| (i / SIDE) as usize + 1);
            let count = ((1_usize << level) / SIDE as usize).max(1);
            let end = |axis: usize| (first[axis] + count).min(n[axis] - 1);
            for z in first[2]..end(2) {
                for y in first[1]..end(1) {
                    for x in first[0]..end(0) {
                        sides[index([x, y, z])] = side;
                    }
                }
            }
        });
        if border == Border::Capped {
            // A brick that the border cuts has phantoms of its own.
            for axis in 0..3 {
                if !self.size[axis].is_multiple_of(SIDE) {
                    for i in 0..sides.len() {
                        let at = [i % n[0], i / n[0] % n[1], i / n[0] / n[1]];
                        if at[axis] == n[axis] - 2 {
                            sides[i] |= OUTSIDE;
                        }
                    }
                }
            }
        }
        // What is within one brick, along one axis after the other.
        for axis in 0..3 {
            let step = [1, n[0], n[0] * n[1]][axis];
            let before = sides.clone();
            for (i, side) in sides.iter_mut().enumerate() {
                let at = i / step % n[axis];
                let lower = if at > 0 { before[i - step] } else { 0 };
                let upper = if at + 1 < n[axis] { before[i + step] } else { 0 };
                *side |= lower | upper;
            }
        }
        let near = sides.iter().enumerate().filter(|&(_, &side)| side == BOTH);
        near.map(|(i, _)| [i % n[0], i / n[0] % n[1], i / n[0] / n[1]].map(|i| i as u32)).collect()
    }

    /// Tells of every brick, and of regions that are larger, on which sides samples are.
    fn mark(
        &self,
        depth: usize,
        node: usize,
        base: [u32; 3],
        isovalue: f64,
        tell: &mut dyn FnMut([u32; 3], u8, u8),
    ) {
        let side = |least: f64, most: f64| {
            let inside = if most >= isovalue { INSIDE } else { 0 };
            inside | if least >= isovalue { 0 } else { OUTSIDE }
        };
        let of_value = |value: V| side(value.to_f64(), value.to_f64());
        let level = self.depth - depth as u8;
        let Some(nodes) = self.levels.get(depth) else {
            return tell(base, level, of_value(self.root));
        };
        let [least, most] = nodes.ranges[node].map(V::to_f64);
        let own = side(least, most);
        if 1 << level == SIDE {
            return tell(base, level, own);
        }
        // Without a number nothing is known.
        if own != BOTH && !least.is_nan() {
            return tell(base, level, own);
        }
        for c in 0..8 {
            let half = 1 << (level - 1);
            let base = [0, 1, 2].map(|axis| base[axis] + half * (c >> axis & 1));
            if (0..3).any(|axis| base[axis] >= self.size[axis]) {
                continue;
            }
            match nodes.child(node, c) {
                Child::Divided(child) => self.mark(depth + 1, child, base, isovalue, tell),
                Child::Region(value) => tell(base, level - 1, of_value(nodes.values[value])),
            }
        }
    }

    /// Adds the brick that holds the first sample of the region of a brick that is all of one region,
    /// and those before and behind it, where its dual edges end.
    fn add_base(&self, place: [u32; 3], places: &mut FxHashSet<[u32; 3]>) {
        let Some(p) = self.first_sample(place) else { return };
        let region = self.region_at(p);
        if 1 << region.level <= SIDE {
            return;
        }
        let base = region.base.map(|i| i / SIDE + 1);
        places.insert(base);
        let bricks = (1 << region.level) / SIDE;
        for axis in 0..3 {
            for beside in [base[axis] - 1, base[axis] + bricks] {
                let mut place = base;
                place[axis] = beside;
                places.insert(place);
            }
        }
    }

    /// The first sample of a brick of the volume.
    fn first_sample(&self, place: [u32; 3]) -> Option<[u32; 3]> {
        let mut first = [0; 3];
        for axis in 0..3 {
            first[axis] = place[axis].checked_sub(1)? * SIDE;
            if first[axis] >= self.size[axis] {
                return None;
            }
        }
        Some(first)
    }

    /// The values and levels of a brick.
    pub(super) fn brick(&self, place: [u32; 3], isovalue: f64, border: Border) -> Brick {
        let first = self.first_sample(place);
        let whole = first.filter(|first| (0..3).all(|axis| first[axis] + SIDE <= self.size[axis]));
        let Some(first) = whole else { return self.border_brick(place, isovalue, border) };
        match self.find(first) {
            Place::Whole => {
                let region = self.region_at(first);
                Brick::new(place, vec![region.value.to_f64()], vec![region.level], isovalue)
            }
            Place::Divided(node) => {
                let (mut values, mut levels) = (vec![0.0; VOXELS], vec![0; VOXELS]);
                let depth = usize::from(self.depth) - SIDE.ilog2() as usize;
                self.fill(depth, node, 0, 8, &mut values, &mut levels);
                if levels.iter().all(|&level| level == 0) {
                    levels = vec![0];
                }
                Brick::new(place, values, levels, isovalue)
            }
        }
    }

    /// Where a brick of the volume is in the octree.
    fn find(&self, first: [u32; 3]) -> Place {
        let mut node = 0;
        let n = usize::from(self.depth) - SIDE.ilog2() as usize;
        for (nodes, level) in
            self.levels[..n.min(self.levels.len())].iter().zip((0..self.depth).rev())
        {
            let c = (0..3).fold(0, |c, axis| c | (first[axis] >> level & 1) << axis);
            match nodes.child(node, c) {
                Child::Divided(child) => node = child,
                Child::Region(_) => return Place::Whole,
            }
        }
        if self.levels.is_empty() { Place::Whole } else { Place::Divided(node) }
    }

    /// Writes the values and levels of a node, whose first voxel is number `first` of the brick.
    fn fill(
        &self,
        depth: usize,
        node: usize,
        first: usize,
        side: usize,
        values: &mut [f64],
        levels: &mut [u8],
    ) {
        let nodes = &self.levels[depth];
        let half = side / 2;
        for c in 0..8 {
            let first = first + half * ((c & 1) + 8 * (c >> 1 & 1) + 64 * (c >> 2));
            match nodes.child(node, c as u32) {
                Child::Divided(child) => self.fill(depth + 1, child, first, half, values, levels),
                Child::Region(value) => {
                    let (value, level) = (nodes.values[value].to_f64(), half.ilog2() as u8);
                    for z in 0..half {
                        for y in 0..half {
                            let row = first + 8 * y + 64 * z;
                            values[row..row + half].fill(value);
                            levels[row..row + half].fill(level);
                        }
                    }
                }
            }
        }
    }

    /// A brick with phantoms.
    fn border_brick(&self, place: [u32; 3], isovalue: f64, border: Border) -> Brick {
        let (mut values, mut levels) = (Vec::with_capacity(VOXELS), Vec::with_capacity(VOXELS));
        for i in 0..VOXELS as u32 {
            let within = [i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE];
            let mut is_beyond = false;
            let p = [0, 1, 2].map(|axis| {
                let at = place[axis] * SIDE + within[axis];
                let inside = at.clamp(SIDE, SIDE + self.size[axis] - 1);
                is_beyond |= inside != at;
                inside - SIDE
            });
            let region = self.region_at(p);
            let is_outside = is_beyond && border == Border::Capped;
            values.push(if is_outside { f64::NEG_INFINITY } else { region.value.to_f64() });
            levels.push(region.level);
        }
        Brick::new(place, values, levels, isovalue)
    }
}
