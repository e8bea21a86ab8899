//! Changes of some samples: their bricks are built anew, and the nodes above them put together again.
//!
//! What has been changed becomes one region only where it is equal: the samples of a region that had
//! a tolerance are not known any more, and a second tolerance would add to the first. So no sample is
//! ever further from its region than the tolerance of the first building.
//!
//! *Based on:* A. León Salas, 2008, section 4.2 (local updates of the IDDG-Octree).

use std::ops::RangeInclusive;

use super::{
    HrbOctree, Samples, Tolerance, Value,
    build::Builder,
    octree::{BRICK_LEVEL, Node, Tree, child},
    samples::copy,
};
use crate::mesh::VOXELS;

/// What a change has made of an octree: regions that were there and are not, or the other way round,
/// and those that have other values.
#[derive(Clone, Debug, Default)]
pub struct Changes {
    /// Boxes of samples, each in one brick.
    pub bricks: Vec<Samples>,
    /// Regions larger than bricks that were divided, or joined.
    pub large: Vec<Samples>,
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

    /// What all samples in a box are, if they are known to be alike.
    pub(crate) fn alike(&self, samples: &Samples) -> Option<V> {
        let value = self.region_at(samples.first).value;
        let is_same = |[least, most]: [V; 2]| least == value && most == value;
        is_all(&self.root, [0; 3], self.depth, (samples, self.size), &is_same).then_some(value)
    }

    /// Changes samples of the volume to `values`, x fastest, and the corners that regions answer for.
    pub fn set(&mut self, samples: &Samples, values: &[V]) -> Changes {
        let mut change = Change {
            size: self.size,
            samples,
            values,
            changes: Changes::default(),
            divisions: Vec::new(),
        };
        change.node(&mut self.root, [0; 3], self.depth);
        let Change { changes, divisions, .. } = change;
        self.assign_corners_around(&divisions);
        changes
    }

    /// All regions larger than a brick that reach into a box: their samples.
    pub(crate) fn large_regions(&self, within: &Samples) -> Vec<Samples> {
        let mut found = Vec::new();
        self.each_part(within, BRICK_LEVEL + 1..=u8::MAX, &mut |base, level| {
            found.push(Samples::of_node(base, level));
        });
        found
    }
}

fn read<V: Value>(tree: &Tree<V>, base: [u32; 3], level: u8, samples: &Samples, values: &mut [V]) {
    if !samples.meets(base, level) {
        return;
    }
    let node = Samples::of_node(base, level);
    match tree {
        Tree::Node(node) => {
            for (c, tree) in node.children.iter().enumerate() {
                read(tree, child(base, level, c), level - 1, samples, values);
            }
        }
        Tree::Region { value, .. } => {
            let own = samples.and(&node);
            for row in own.rows() {
                let start = samples.index(row);
                values[start..start + own.size()[0]].fill(*value);
            }
        }
        Tree::Brick(brick) => copy(&brick.samples(), &node, values, samples),
    }
}

/// Whether the least and the largest value of everything that reaches into a box are such.
fn is_all<V: Value>(
    tree: &Tree<V>,
    base: [u32; 3],
    level: u8,
    wanted: (&Samples, [u32; 3]),
    is: &impl Fn([V; 2]) -> bool,
) -> bool {
    let (within, size) = wanted;
    if !within.meets(base, level) || (0..3).any(|axis| base[axis] >= size[axis]) {
        return true;
    }
    match tree {
        Tree::Region { value, .. } => is([*value; 2]),
        Tree::Brick(brick) => is(brick.range),
        Tree::Node(node) => {
            is(node.range)
                || (0..8).all(|c| {
                    is_all(&node.children[c], child(base, level, c), level - 1, wanted, is)
                })
        }
    }
}

/// A change under way.
struct Change<'a, V> {
    size: [u32; 3],
    samples: &'a Samples,
    values: &'a [V],
    changes: Changes,
    divisions: Vec<Division>,
}

/// Where regions are others than before.
pub(super) struct Division {
    /// Their samples.
    pub(super) samples: Samples,
    /// Their levels, before or after: for a region that is smaller or larger than all of them nothing
    /// changes.
    pub(super) levels: RangeInclusive<u8>,
}

impl<V: Value> Change<'_, V> {
    fn node(&mut self, tree: &mut Tree<V>, base: [u32; 3], level: u8) {
        let of_volume = Samples { first: [0; 3], end: self.size };
        let node = Samples::of_node(base, level);
        let own = node.and(&of_volume);
        let touched = self.samples.and(&own);
        if touched.is_empty() {
            return;
        }
        if let Tree::Region { value, .. } = tree
            && self.is_all(&touched, *value)
        {
            return;
        }
        if level == BRICK_LEVEL {
            return self.brick(tree, &node, &own, &touched);
        }
        let was_region = match *tree {
            Tree::Region { value, .. } => {
                let children = std::array::from_fn(|_| Tree::region(value));
                *tree = Tree::Node(Box::new(Node { children, range: [value; 2] }));
                true
            }
            _ => false,
        };
        let Tree::Node(inner) = tree else { unreachable!("bricks are smaller") };
        for (c, tree) in inner.children.iter_mut().enumerate() {
            self.node(tree, child(base, level, c), level - 1);
        }
        let merged = if own == node { inner.same() } else { None };
        if let Some(value) = merged {
            *tree = Tree::region(value);
        } else {
            inner.range = range_of(inner, base, level, self.size);
        }
        if was_region || merged.is_some() {
            self.changes.large.push(own);
            // Children that are divided further tell of that themselves.
            self.divisions.push(Division { samples: own, levels: level - 1..=level });
        }
    }

    /// Whether all new values of some samples are this one.
    fn is_all(&self, touched: &Samples, value: V) -> bool {
        let n = touched.size()[0];
        touched.rows().all(|row| {
            let start = self.samples.index(row);
            self.values[start..start + n].iter().fold(true, |all, &new| all & (new == value))
        })
    }

    /// Builds a brick anew.
    fn brick(&mut self, tree: &mut Tree<V>, node: &Samples, own: &Samples, touched: &Samples) {
        let mut values = match tree {
            Tree::Brick(brick) => brick.samples(),
            Tree::Region { value, .. } => [*value; VOXELS],
            Tree::Node(_) => unreachable!("nodes are larger"),
        };
        let mut changed = Samples::NONE;
        let n = touched.size()[0];
        for row in touched.rows() {
            let (start, goal) = (self.samples.index(row), node.index(row));
            let (new, old) = (&self.values[start..start + n], &mut values[goal..goal + n]);
            if new != old {
                let end = [row[0] + n as u32, row[1] + 1, row[2] + 1];
                changed = changed.with(&Samples { first: row, end });
                old.copy_from_slice(new);
            }
        }
        if changed.is_empty() {
            return;
        }
        let mut clipped = Vec::new();
        let samples = if own == node {
            &values[..]
        } else {
            clipped.resize(own.n(), V::default());
            copy(&values, node, &mut clipped, own);
            &clipped
        };
        let size = own.size().map(|n| n as u32);
        let builder = Builder { samples, size, tolerance: Tolerance::default() };
        let (mut built, _) = builder.brick([0; 3]);
        // The largest regions that there may be, before or after, and where they are others.
        let (mut level, mut others) = (BRICK_LEVEL, *own);
        if let (Tree::Brick(old), Tree::Brick(new)) = (&mut *tree, &mut built) {
            level = old.largest().max(new.largest());
            others = parts(node.first, old.divided_otherwise(new)).and(own);
            if others.is_empty() {
                // Who answers for what has not changed.
                new.corners = std::mem::take(&mut old.corners);
            }
        }
        *tree = built;
        if !others.is_empty() {
            self.divisions.push(Division { samples: others, levels: 0..=level });
        }
        let changed = Samples {
            first: changed.first.map(|i| i >> level << level),
            end: changed.end.map(|i| (i + (1 << level) - 1) >> level << level),
        };
        self.changes.bricks.push(others.with(&changed.and(own)));
    }
}

/// The box of some parts, as bits in Morton order, of 2³ samples of the brick that begins there.
fn parts(first: [u32; 3], mut parts: u64) -> Samples {
    let mut all = Samples::NONE;
    while parts != 0 {
        let m = parts.trailing_zeros();
        parts &= parts - 1;
        let first =
            [0, 1, 2].map(|axis| first[axis] + 2 * (m >> axis & 1) + 4 * (m >> (axis + 3) & 1));
        all = all.with(&Samples { first, end: first.map(|i| i + 2) });
    }
    all
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
