//! The bricks near an isosurface, found through the octree.

use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::{
    HrbOctree, Samples, Value,
    near::{Beyond, NearBrick, NearVoxels},
    octree::{BRICK_LEVEL, Tree, child},
};
use crate::mesh::{Border, Brick, Grid, SIDE, Voxels};

/// Some samples of a brick are inside, some are not.
const INSIDE: u8 = 1;
const OUTSIDE: u8 = 2;
const BOTH: u8 = INSIDE | OUTSIDE;

/// On which sides the samples of bricks in a box are; around the volume is a layer of bricks.
struct Sides {
    /// The place of the first brick.
    first: [u32; 3],
    /// Bricks along each axis, x fastest.
    n: [usize; 3],
    sides: Vec<u8>,
}

impl<V: Value> HrbOctree<V> {
    /// Everything that a mesh of the isosurface needs: what is `isovalue` or above is inside.
    #[must_use]
    pub fn grid(&self, isovalue: f64, border: Border) -> Grid<NearVoxels<'_, V>> {
        let end = self.size.map(|n| n.div_ceil(SIDE) + 2);
        self.grid_within(isovalue, border, [0; 3], end)
    }

    /// The same for the bricks of a box, without those at its border.
    pub(crate) fn grid_within(
        &self,
        isovalue: f64,
        border: Border,
        first: [u32; 3],
        end: [u32; 3],
    ) -> Grid<NearVoxels<'_, V>> {
        let sides = self.sides(isovalue, border, first, end);
        let brick = |&slot: &usize| self.brick(sides.place(slot), isovalue, border);
        let (mixed, others): (Vec<usize>, Vec<usize>) =
            sides.near().into_iter().partition(|&slot| sides.sides[slot] == BOTH);
        let mut bricks: Vec<NearBrick<'_, V>> = mixed.par_iter().map(brick).collect();
        let mut numbers = vec![usize::MAX; sides.sides.len()];
        mixed.iter().enumerate().for_each(|(number, &slot)| numbers[slot] = number);
        let is_met = |slot: &&usize| {
            // What lies beyond the volume is like the samples at its border.
            self.whole_brick(sides.place(**slot)).is_none()
                || sides.is_met(**slot, |slot| bricks.get(numbers[slot]))
        };
        let met: Vec<NearBrick<'_, V>> = others.par_iter().filter(is_met).map(brick).collect();
        bricks.extend(met);
        let mut places: FxHashSet<[u32; 3]> = bricks.iter().map(|brick| brick.place).collect();
        let mut bases = Vec::new();
        for brick in &bricks {
            self.bases(brick.place, |place| {
                if places.insert(place) {
                    bases.push(place);
                }
            });
        }
        let last = self.size.map(|n| n.div_ceil(SIDE) + 1);
        bases.retain(|place| (0..3).all(|axis| place[axis] <= last[axis]));
        bricks.par_extend(bases.into_par_iter().map(|place| self.brick(place, isovalue, border)));
        Grid::new(bricks, self.size, border)
    }

    /// On which sides the samples of every brick from `first` to before `end` are.
    fn sides(&self, isovalue: f64, border: Border, first: [u32; 3], end: [u32; 3]) -> Sides {
        let of_volume = self.size.map(|n| n.div_ceil(SIDE) + 2);
        let end = [0, 1, 2].map(|axis| end[axis].min(of_volume[axis]));
        let n = [0, 1, 2].map(|axis| (end[axis] - first[axis]) as usize);
        let beyond = if border == Border::Capped { OUTSIDE } else { 0 };
        let mut all = Sides { first, n, sides: vec![beyond; n.iter().product()] };
        let reach = Samples {
            first: first.map(|i| i.saturating_sub(1) * SIDE),
            end: end.map(|i| i.saturating_sub(1) * SIDE),
        };
        self.mark(&self.root, [0; 3], self.depth, isovalue, &reach, &mut |base, level, side| {
            let own = base.map(|i| i / SIDE + 1);
            let count = ((1 << level) / SIDE).max(1);
            // Without the layers around the volume.
            let [xs, ys, zs] = [0, 1, 2].map(|axis| {
                let last = end[axis].min(of_volume[axis] - 1);
                let from = own[axis].max(first[axis]) - first[axis];
                let to = (own[axis] + count).min(last).saturating_sub(first[axis]);
                from as usize..to.max(from) as usize
            });
            for z in zs {
                for y in ys.clone() {
                    let row = n[0] * (y + n[1] * z);
                    all.sides[row + xs.start..row + xs.end].fill(side);
                }
            }
        });
        if border == Border::Capped {
            // A brick that the border cuts has phantoms of its own.
            for axis in (0..3).filter(|&axis| !self.size[axis].is_multiple_of(SIDE)) {
                for slot in 0..all.sides.len() {
                    if all.place(slot)[axis] == of_volume[axis] - 2 {
                        all.sides[slot] |= OUTSIDE;
                    }
                }
            }
        }
        all
    }

    /// Tells of every brick, and of parts that are larger, on which sides samples are.
    fn mark(
        &self,
        tree: &Tree<V>,
        base: [u32; 3],
        level: u8,
        isovalue: f64,
        reach: &Samples,
        tell: &mut dyn FnMut([u32; 3], u8, u8),
    ) {
        if !self.holds(base) || !reach.meets(base, level) {
            return;
        }
        let side = |[least, most]: [V; 2]| {
            let (least, most) = (least.to_f64(), most.to_f64());
            // Without a number nothing is known.
            if least.is_nan() || most.is_nan() {
                return BOTH;
            }
            let inside = if most >= isovalue { INSIDE } else { 0 };
            inside | if least >= isovalue { 0 } else { OUTSIDE }
        };
        match tree {
            Tree::Region { value, .. } if value.to_f64().is_nan() => tell(base, level, OUTSIDE),
            Tree::Region { value, .. } => tell(base, level, side([*value; 2])),
            Tree::Brick(brick) => tell(base, BRICK_LEVEL, side(brick.range)),
            Tree::Node(node) => match side(node.range) {
                BOTH => {
                    for (c, tree) in node.children.iter().enumerate() {
                        let base = child(base, level, c);
                        self.mark(tree, base, level - 1, isovalue, reach, tell);
                    }
                }
                own => tell(base, level, own),
            },
        }
    }

    /// Tells of the brick that holds the first sample of the region of a brick that is all of one
    /// region, and of those before and behind it, where its dual edges end. What lies beyond the
    /// volume is like the region beside it, but thin.
    fn bases(&self, place: [u32; 3], mut tell: impl FnMut([u32; 3])) {
        let clamped = |axis: usize| place[axis].clamp(1, self.size[axis].div_ceil(SIDE)) - 1;
        let first = [0, 1, 2].map(|axis| clamped(axis) * SIDE);
        let (Tree::Region { .. }, level) = self.brick_at(first) else { return };
        if 1 << level <= SIDE {
            return;
        }
        let base = first.map(|i| (i >> level << level) / SIDE + 1);
        let bricks = (1 << level) / SIDE;
        for beyond in 0..8 {
            let is_beyond = |axis: usize| beyond >> axis & 1 == 1;
            let has_phantoms =
                |axis: usize| place[axis] == 0 || place[axis] * SIDE > self.size[axis];
            if !(0..3).all(|axis| has_phantoms(axis) || !is_beyond(axis)) {
                continue;
            }
            let own = [0, 1, 2].map(|axis| if is_beyond(axis) { place[axis] } else { base[axis] });
            tell(own);
            for axis in 0..3 {
                let n = if is_beyond(axis) { 1 } else { bricks };
                for beside in [own[axis].checked_sub(1), Some(own[axis] + n)].into_iter().flatten()
                {
                    let mut place = own;
                    place[axis] = beside;
                    tell(place);
                }
            }
        }
    }

    /// The first sample of a brick of the volume.
    fn first_sample(&self, place: [u32; 3]) -> Option<[u32; 3]> {
        let first = place.map(|i| i.wrapping_sub(1).wrapping_mul(SIDE));
        self.holds(first).then_some(first)
    }

    /// The first sample of a brick that is in the volume wholly.
    fn whole_brick(&self, place: [u32; 3]) -> Option<[u32; 3]> {
        self.first_sample(place)
            .filter(|first| (0..3).all(|axis| first[axis] + SIDE <= self.size[axis]))
    }

    /// The values and levels of a brick.
    pub(super) fn brick(&self, place: [u32; 3], isovalue: f64, border: Border) -> NearBrick<'_, V> {
        let (beyond, first) = match self.whole_brick(place) {
            Some(first) => (None, first),
            None => {
                let (beyond, first) = Beyond::new(place, self.size, border);
                (Some(beyond), first)
            }
        };
        NearVoxels::brick(place, self.brick_at(first), isovalue, beyond)
    }
}

impl Sides {
    /// Where a brick is.
    fn place(&self, slot: usize) -> [u32; 3] {
        let [nx, ny, _] = self.n;
        let step = [slot % nx, slot / nx % ny, slot / nx / ny];
        [0, 1, 2].map(|axis| self.first[axis] + step[axis] as u32)
    }

    /// The bricks that have, with the 26 around, samples on both sides.
    fn near(&self) -> Vec<usize> {
        let mut near = self.sides.clone();
        // One axis after the other.
        let [nx, ny, _] = self.n;
        for (step, layer) in [(1, nx), (nx, nx * ny), (nx * ny, near.len())] {
            let before = near.clone();
            for (own, before) in near.chunks_exact_mut(layer).zip(before.chunks_exact(layer)) {
                for (side, lower) in own[step..].iter_mut().zip(before) {
                    *side |= lower;
                }
                for (side, upper) in own.iter_mut().zip(&before[step..]) {
                    *side |= upper;
                }
            }
        }
        (0..near.len()).filter(|&slot| near[slot] == BOTH).collect()
    }

    /// Whether samples next to a brick that is on one side are on the other; `mixed` has the bricks
    /// on both sides.
    fn is_met<'a, B: Voxels + 'a>(
        &self,
        slot: usize,
        mixed: impl Fn(usize) -> Option<&'a Brick<B>>,
    ) -> bool {
        let place = self.place(slot);
        (0..27).any(|k| {
            let step = [k % 3, k / 3 % 3, k / 9];
            let at = [0, 1, 2].map(|axis| {
                ((place[axis] - self.first[axis]) as usize + step[axis]).wrapping_sub(1)
            });
            if (0..3).any(|axis| at[axis] >= self.n[axis]) {
                return false;
            }
            let beside = at[0] + self.n[0] * (at[1] + self.n[1] * at[2]);
            match mixed(beside) {
                Some(brick) => brick.meets(step, self.sides[slot] == OUTSIDE),
                None => self.sides[slot] | self.sides[beside] == BOTH,
            }
        })
    }
}
