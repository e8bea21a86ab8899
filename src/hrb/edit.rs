//! Changes of some samples: their bricks are built anew, and the nodes above them put together again.
//!
//! What has been changed becomes one region only where it is equal: the samples of a region that had
//! a tolerance are not known any more, and a second tolerance would add to the first. So no sample is
//! ever further from its region than the tolerance of the first building.
//!
//! *Based on:* A. León Salas, 2008, section 4.2 (local updates of the IDDG-Octree).

use super::{
    HrbOctree, Region, Tolerance, Value,
    build::Builder,
    octree::{BRICK_LEVEL, Node, Tree, child},
};
use crate::mesh::SIDE;

/// A box of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Samples {
    /// The first one.
    pub first: [u32; 3],
    /// Behind the last one, along each axis.
    pub end: [u32; 3],
}

impl Samples {
    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        (0..3).any(|axis| self.first[axis] >= self.end[axis])
    }

    /// Samples along each axis.
    #[must_use]
    pub fn size(&self) -> [usize; 3] {
        [0, 1, 2].map(|axis| self.end[axis].saturating_sub(self.first[axis]) as usize)
    }

    /// How many there are.
    #[must_use]
    pub fn n(&self) -> usize {
        self.size().iter().product()
    }

    /// All of them, x fastest.
    pub fn iter(&self) -> impl Iterator<Item = [u32; 3]> + use<> {
        let Self { first, end } = *self;
        (first[2]..end[2]).flat_map(move |z| {
            (first[1]..end[1]).flat_map(move |y| (first[0]..end[0]).map(move |x| [x, y, z]))
        })
    }

    /// The number of one of them.
    #[inline]
    #[must_use]
    pub fn index(&self, p: [u32; 3]) -> usize {
        let [nx, ny, _] = self.size();
        let [x, y, z] = [0, 1, 2].map(|axis| (p[axis] - self.first[axis]) as usize);
        x + nx * (y + ny * z)
    }

    /// Those that another box has too.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        Self {
            first: [0, 1, 2].map(|axis| self.first[axis].max(other.first[axis])),
            end: [0, 1, 2].map(|axis| self.end[axis].min(other.end[axis])),
        }
    }

    /// The least box with these and those of another, which may be empty.
    #[must_use]
    pub fn with(&self, other: &Self) -> Self {
        if self.is_empty() {
            return *other;
        }
        Self {
            first: [0, 1, 2].map(|axis| self.first[axis].min(other.first[axis])),
            end: [0, 1, 2].map(|axis| self.end[axis].max(other.end[axis])),
        }
    }

    /// With `n` more on every side, as far as numbers reach.
    #[must_use]
    pub fn grown(&self, n: u32) -> Self {
        Self { first: self.first.map(|i| i.saturating_sub(n)), end: self.end.map(|i| i + n) }
    }

    /// None.
    const NONE: Self = Self { first: [0; 3], end: [0; 3] };

    /// Those of a node.
    fn of_node(base: [u32; 3], level: u8) -> Self {
        Self { first: base, end: base.map(|i| i + (1 << level)) }
    }

    /// Whether a node reaches into the box.
    #[inline]
    pub(super) fn meets(&self, base: [u32; 3], level: u8) -> bool {
        (0..3)
            .all(|axis| base[axis] < self.end[axis] && base[axis] + (1 << level) > self.first[axis])
    }
}

impl<V: Value> HrbOctree<V> {
    /// All samples of the volume.
    #[must_use]
    pub fn samples(&self) -> Samples {
        Samples { first: [0; 3], end: self.size }
    }

    /// What regions say of samples of the volume, x fastest.
    #[must_use]
    pub fn values(&self, samples: &Samples) -> Vec<V> {
        let mut values = vec![V::default(); samples.n()];
        read(&self.root, [0; 3], self.depth, samples, &mut values);
        values
    }

    /// Changes samples of the volume to `values`, x fastest. Corners are found again where they were
    /// assigned. Returns the box of all regions that were there and are not, or the other way round; it
    /// may be empty.
    pub fn set(&mut self, samples: &Samples, values: &[V]) -> Samples {
        let mut change = Change { size: self.size, samples, values, changed: Samples::NONE };
        change.node(&mut self.root, [0; 3], self.depth);
        let changed = change.changed;
        if !changed.is_empty() {
            self.assign_corners_within(&changed.grown(1));
        }
        changed
    }

    /// The first samples of all regions larger than a brick that reach into a box.
    pub(crate) fn large_bases(&self, samples: &Samples) -> Vec<[u32; 3]> {
        let mut bases = Vec::new();
        let mut at = samples.and(&self.samples()).first.map(|i| i / SIDE * SIDE);
        let first = at;
        let end = samples.and(&self.samples()).end;
        while at[2] < end[2] {
            let Region { base, level, .. } = self.region_at(at);
            if level > BRICK_LEVEL && bases.last() != Some(&base) {
                bases.push(base);
            }
            at[0] += SIDE;
            for axis in 0..2 {
                if at[axis] >= end[axis] {
                    at[axis] = first[axis];
                    at[axis + 1] += SIDE;
                }
            }
        }
        bases.sort_unstable();
        bases.dedup();
        bases
    }
}

fn read<V: Value>(tree: &Tree<V>, base: [u32; 3], level: u8, samples: &Samples, values: &mut [V]) {
    if !samples.meets(base, level) {
        return;
    }
    let own = samples.and(&Samples::of_node(base, level));
    match tree {
        Tree::Node(node) => {
            for (c, tree) in node.children.iter().enumerate() {
                read(tree, child(base, level, c), level - 1, samples, values);
            }
        }
        Tree::Region { value, .. } => own.iter().for_each(|p| values[samples.index(p)] = *value),
        Tree::Brick(brick) => {
            own.iter().for_each(|p| values[samples.index(p)] = brick.region_at(p).value);
        }
    }
}

/// A change under way.
struct Change<'a, V> {
    size: [u32; 3],
    samples: &'a Samples,
    values: &'a [V],
    changed: Samples,
}

impl<V: Value> Change<'_, V> {
    fn node(&mut self, tree: &mut Tree<V>, base: [u32; 3], level: u8) {
        let of_volume = Samples { first: [0; 3], end: self.size };
        let own = Samples::of_node(base, level).and(&of_volume);
        let touched = self.samples.and(&own);
        if touched.is_empty() {
            return;
        }
        if let Tree::Region { value, .. } = tree {
            let is_same = |p| self.values[self.samples.index(p)] == *value;
            if touched.iter().all(is_same) {
                return;
            }
        }
        if level == BRICK_LEVEL {
            return self.brick(tree, base, &own, &touched);
        }
        let was_region = match *tree {
            Tree::Region { value, .. } => {
                let children = std::array::from_fn(|_| Tree::region(value));
                *tree = Tree::Node(Box::new(Node { children, range: [value; 2] }));
                true
            }
            _ => false,
        };
        let Tree::Node(node) = tree else { unreachable!("bricks are smaller") };
        for (c, tree) in node.children.iter_mut().enumerate() {
            self.node(tree, child(base, level, c), level - 1);
        }
        let is_whole = own == Samples::of_node(base, level);
        let merged = if is_whole { node.same() } else { None };
        if let Some(value) = merged {
            *tree = Tree::region(value);
        } else {
            node.range = range_of(node, base, level, self.size);
        }
        if was_region || merged.is_some() {
            self.changed = self.changed.with(&own);
        }
    }

    /// Builds a brick anew.
    fn brick(&mut self, tree: &mut Tree<V>, base: [u32; 3], own: &Samples, touched: &Samples) {
        let mut values = vec![V::default(); own.n()];
        read(tree, base, BRICK_LEVEL, own, &mut values);
        let mut is_same = true;
        for p in touched.iter() {
            let (old, new) = (&mut values[own.index(p)], self.values[self.samples.index(p)]);
            is_same &= *old == new;
            *old = new;
        }
        if is_same {
            return;
        }
        let size = own.size().map(|n| n as u32);
        let builder = Builder { samples: &values, size, tolerance: Tolerance::default() };
        (*tree, _) = builder.brick([0; 3]);
        self.changed = self.changed.with(own);
    }
}

impl<V: Value> Node<V> {
    /// What all children are, if they are regions with one value.
    fn same(&self) -> Option<V> {
        let value_of = |tree: &Tree<V>| match tree {
            Tree::Region { value, .. } => Some(*value),
            _ => None,
        };
        let first = value_of(&self.children[0])?;
        self.children.iter().all(|child| value_of(child) == Some(first)).then_some(first)
    }
}

/// The least and the largest sample of a node.
fn range_of<V: Value>(node: &Node<V>, base: [u32; 3], level: u8, size: [u32; 3]) -> [V; 2] {
    let of_child = |(c, tree): (usize, &Tree<V>)| {
        let first = child(base, level, c);
        let is_beyond = (0..3).any(|axis| first[axis] >= size[axis]);
        match tree {
            _ if is_beyond => None,
            Tree::Region { value, .. } => Some([*value; 2]),
            Tree::Brick(brick) => Some(brick.range),
            Tree::Node(node) => Some(node.range),
        }
    };
    let ranges = node.children.iter().enumerate().filter_map(of_child);
    ranges.reduce(|a, b| [a[0].least(b[0]), a[1].most(b[1])]).unwrap_or(node.range)
}
