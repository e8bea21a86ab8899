//! An octree of regions: nodes down to bricks of 8³ samples, and in every brick that is divided two
//! masks and the values of its regions, in Morton order.
//!
//! A brick owns what it holds, so that a change of some samples touches their bricks and the nodes
//! above them alone.

use super::{brick::Brick, sample::Value};
use crate::mesh::index_of;

/// Edge of a brick, as a power of two.
pub(super) const BRICK_LEVEL: u8 = 3;

/// A region of a volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region<V> {
    /// Its first sample.
    pub base: [u32; 3],
    /// Its edge is `2^level` samples.
    pub level: u8,
    /// What all its samples are, or their mean.
    pub value: V,
    /// Bit x + 2y + 4z: it answers for the dual cell at this corner; see
    /// [`HrbOctree::assign_corners`].
    pub corners: u8,
}

/// An octree of homogeneous regions. Nodes that lie beyond the volume count as regions; their values
/// mean nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct HrbOctree<V> {
    pub(super) size: [u32; 3],
    /// The root's edge is `2^depth` samples.
    pub(super) depth: u8,
    pub(super) root: Tree<V>,
}

/// A part of an octree.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Tree<V> {
    /// Everything in it is alike, or lies beyond the volume.
    Region { value: V, corners: u8 },
    /// A divided node of 8³ samples.
    Brick(Box<Brick<V>>),
    /// A larger one.
    Node(Box<Node<V>>),
}

/// A divided node that is larger than a brick.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Node<V> {
    /// Child x + 2y + 4z.
    pub(super) children: [Tree<V>; 8],
    /// The least and the largest sample.
    pub(super) range: [V; 2],
}

/// Counts and bytes, as the thesis has them and as they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Storage {
    /// Divided nodes.
    pub nodes: u64,
    /// Regions.
    pub regions: u64,
    /// Dual cells: corners that regions answer for; 0 before they are assigned.
    pub cells: u64,
    /// Four bytes a node and three a region: a pointer, a value of two bytes and responsibilities.
    pub thesis_bytes: u64,
    /// Two bytes a sample.
    pub grid_bytes: u64,
    /// Bytes held on the heap.
    pub resident_bytes: u64,
}

impl<V: Value> HrbOctree<V> {
    /// Samples along each axis.
    #[must_use]
    pub fn size(&self) -> [u32; 3] {
        self.size
    }

    /// Counts and bytes.
    #[must_use]
    pub fn storage(&self) -> Storage {
        let mut storage = Storage {
            grid_bytes: 2 * self.size.iter().map(|&n| u64::from(n)).product::<u64>(),
            ..Storage::default()
        };
        self.root.count(&mut storage);
        storage.thesis_bytes = 4 * storage.nodes + 3 * storage.regions;
        storage
    }

    /// The region that holds a sample.
    ///
    /// # Panics
    /// If the sample lies beyond the root.
    #[must_use]
    pub fn region_at(&self, p: [u32; 3]) -> Region<V> {
        assert!(p.iter().all(|&i| i >> self.depth == 0), "the sample lies in the root");
        let (tree, level) = self.brick_at(p);
        match tree {
            Tree::Brick(brick) => brick.region_at(p),
            Tree::Region { value, corners } => {
                let base = p.map(|i| i >> level << level);
                Region { base, level, value: *value, corners: *corners }
            }
            Tree::Node(_) => unreachable!("nodes end in bricks and regions"),
        }
    }

    /// The level of the region that holds a sample.
    pub(super) fn level_at(&self, p: [u32; 3]) -> u8 {
        match self.brick_at(p) {
            (Tree::Brick(brick), _) => brick.level_at(index_of(p)),
            (_, level) => level,
        }
    }

    /// The brick that holds a sample, or the region if it is larger; and its level.
    pub(super) fn brick_at(&self, p: [u32; 3]) -> (&Tree<V>, u8) {
        let (mut tree, mut level) = (&self.root, self.depth);
        while let Tree::Node(node) = tree {
            level -= 1;
            tree = &node.children[octant(p, level)];
        }
        (tree, level)
    }

    /// The same, to be changed.
    pub(super) fn brick_at_mut(&mut self, p: [u32; 3]) -> &mut Tree<V> {
        let (mut tree, mut level) = (&mut self.root, self.depth);
        while let Tree::Node(node) = tree {
            level -= 1;
            tree = &mut node.children[octant(p, level)];
        }
        tree
    }

    /// Whether a sample, counted with wrapping, is one of the volume's.
    pub(super) fn holds(&self, p: [u32; 3]) -> bool {
        (0..3).all(|axis| p[axis] < self.size[axis])
    }
}

impl<V: Value> Tree<V> {
    pub(super) fn region(value: V) -> Self {
        Self::Region { value, corners: 0 }
    }

    fn count(&self, storage: &mut Storage) {
        match self {
            Self::Region { corners, .. } => {
                storage.regions += 1;
                storage.cells += u64::from(corners.count_ones());
            }
            Self::Brick(brick) => brick.count(storage),
            Self::Node(node) => {
                storage.nodes += 1;
                storage.resident_bytes += size_of::<Node<V>>() as u64;
                node.children.iter().for_each(|child| child.count(storage));
            }
        }
    }
}

/// The child, x + 2y + 4z, of a node that holds a sample; children have edges of `2^level`.
#[inline]
pub(super) fn octant(p: [u32; 3], level: u8) -> usize {
    (0..3).fold(0, |c, axis| c | ((p[axis] >> level & 1) << axis) as usize)
}

/// The first sample of child `c` of a node with edges of `2^level` samples.
#[inline]
pub(super) fn child(base: [u32; 3], level: u8, c: usize) -> [u32; 3] {
    let half = 1 << (level - 1);
    [0, 1, 2].map(|axis| base[axis] + half * (c as u32 >> axis & 1))
}
