//! The bricks near an isosurface, found through the octree.

use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::{
    HrbOctree, Samples, Value,
    near::{Beyond, NearBrick, NearVoxels},
    octree::{BRICK_LEVEL, Tree, child},
    window::Window,
};
use crate::mesh::{Border, Grid, SIDE};

/// Some samples of a brick are inside, some are not.
const INSIDE: u8 = 1;
const OUTSIDE: u8 = 2;
const BOTH: u8 = INSIDE | OUTSIDE;

impl<V: Value> HrbOctree<V> {
    /// Everything that a mesh of the isosurface needs: what is `isovalue` or above is inside.
    #[must_use]
    pub fn grid(&self, isovalue: f64, border: Border) -> Grid<NearVoxels<'_, V>> {
        let end = self.size.map(|n| n.div_ceil(SIDE) + 2);
        self.grid_around(isovalue, border, &Window::new([0; 3], end, true))
    }

    /// The same for some bricks: with those around them.
    pub(crate) fn grid_around(
        &self,
        isovalue: f64,
        border: Border,
        wanted: &Window<bool>,
    ) -> Grid<NearVoxels<'_, V>> {
        // What is around those that are around decides whether they are near the surface.
        let first = wanted.first.map(|i| i.saturating_sub(2));
        let sides = self.sides(isovalue, border, first, wanted.end().map(|i| i + 2));
        let near = sides.spread();
        let mut chosen = Window::new(near.first, near.end(), 0);
        for slot in wanted.chosen().filter_map(|place| near.slot(place)) {
            chosen.all[slot] = u8::from(near.all[slot] == BOTH);
        }
        let chosen = chosen.spread();
        let is_near = |&slot: &usize| chosen.all[slot] == 1 && near.all[slot] == BOTH;
        let slots = (0..near.all.len()).filter(is_near).map(|slot| (slot, near.place(slot)));
        let (mixed, others): (Vec<_>, Vec<_>) =
            slots.partition(|&(slot, _)| sides.all[slot] == BOTH);
        let brick = |&(_, place): &(usize, [u32; 3])| self.brick(place, isovalue, border);
        let mut bricks: Vec<NearBrick<'_, V>> = mixed.par_iter().map(brick).collect();
        let beside = sides.beside(&bricks);
        let is_met = |&&(slot, place): &&(usize, [u32; 3])| {
            // What lies beyond the volume is like the samples at its border.
            self.whole_brick(place).is_none() || sides.all[slot] | beside.all[slot] == BOTH
        };
        let met: Vec<NearBrick<'_, V>> = others.par_iter().filter(is_met).map(brick).collect();
        bricks.extend(met);
        bricks.par_extend(
            self.around_large(&bricks)
                .into_par_iter()
                .map(|place| self.brick(place, isovalue, border)),
        );
        Grid::new(bricks, self.size, border)
    }

    /// The places of bricks that larger regions need, which begin elsewhere than where they meet the
    /// surface, but for those of `bricks`.
    fn around_large(&self, bricks: &[NearBrick<'_, V>]) -> Vec<[u32; 3]> {
        let large: Vec<[u32; 3]> =
            bricks.iter().filter(|brick| brick.is_part()).map(|brick| brick.place).collect();
        if large.is_empty() {
            return large;
        }
        let mut places: FxHashSet<[u32; 3]> = bricks.iter().map(|brick| brick.place).collect();
        let mut bases = Vec::new();
        for place in large {
            self.bases(place, |place| {
                if places.insert(place) {
                    bases.push(place);
                }
            });
        }
        let last = self.size.map(|n| n.div_ceil(SIDE) + 1);
        bases.retain(|place| (0..3).all(|axis| place[axis] <= last[axis]));
        bases
    }

    /// On which sides the samples of every brick from `first` to before `end` are.
    fn sides(&self, isovalue: f64, border: Border, first: [u32; 3], end: [u32; 3]) -> Window<u8> {
        let of_volume = self.size.map(|n| n.div_ceil(SIDE) + 2);
        let end = [0, 1, 2].map(|axis| end[axis].min(of_volume[axis]));
        let beyond = if border == Border::Capped { OUTSIDE } else { 0 };
        let mut all = Window::new(first, end, beyond);
        let reach = Samples {
            first: first.map(|i| i.saturating_sub(1) * SIDE),
            end: end.map(|i| i.saturating_sub(1) * SIDE),
        };
        self.mark(&self.root, [0; 3], self.depth, isovalue, &reach, &mut |base, level, side| {
            let own = base.map(|i| i / SIDE + 1);
            let count = ((1 << level) / SIDE).max(1);
            // Without the layers around the volume.
            all.fill(own, [0, 1, 2].map(|axis| (own[axis] + count).min(of_volume[axis] - 1)), side);
        });
        if border == Border::Capped {
            // A brick that the border cuts has phantoms of its own.
            for axis in (0..3).filter(|&axis| !self.size[axis].is_multiple_of(SIDE)) {
                for (place, sides) in all.places().zip(&mut all.all) {
                    if place[axis] == of_volume[axis] - 2 {
                        *sides |= OUTSIDE;
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

impl Window<u8> {
    /// Of every brick, on which sides samples next to it are, as far as those are in bricks on one side or
    /// in `mixed` ones.
    fn beside<V: Value>(&self, mixed: &[NearBrick<'_, V>]) -> Self {
        let mut pure = self.clone();
        pure.all.iter_mut().filter(|sides| **sides == BOTH).for_each(|sides| *sides = 0);
        let mut beside = pure.spread();
        for brick in mixed {
            for step in (0..27).map(|k| [k % 3, k / 3 % 3, k / 9]) {
                let at = |axis: usize| (brick.place[axis] + 1).wrapping_sub(step[axis] as u32);
                let Some(slot) = beside.slot([at(0), at(1), at(2)]) else { continue };
                let [inside, outside] = brick.shows(step);
                beside.all[slot] |=
                    if inside { INSIDE } else { 0 } | if outside { OUTSIDE } else { 0 };
            }
        }
        beside
    }
}
