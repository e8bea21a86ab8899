//! An octree of regions without pointers: a level holds a byte for every node that is divided, which
//! children are divided too, and the values of the others, all in Morton order.

use super::sample::Value;

/// A region of a volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region<V> {
    /// Its first sample.
    pub base: [u32; 3],
    /// Its edge is `2^level` samples.
    pub level: u8,
    /// What all its samples are, or their mean.
    pub value: V,
}

/// An octree of homogeneous regions. Nodes that lie beyond the volume count as regions; their values
/// mean nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct HrbOctree<V> {
    pub(super) size: [u32; 3],
    /// The root's edge is `2^depth` samples.
    pub(super) depth: u8,
    /// The root's first: the nodes with edges of `2^(depth - level)` samples that are divided.
    pub(super) levels: Vec<Level<V>>,
    /// What all is, if the root is not divided.
    pub(super) root: V,
}

/// The divided nodes of one level.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Level<V> {
    /// Bit c: child x + 2y + 4z is divided.
    pub(super) divided: Vec<u8>,
    /// Divided children before every eighth node.
    pub(super) before: Vec<u32>,
    /// The values of the children that are not divided.
    pub(super) values: Vec<V>,
    /// The least and the largest sample of each node.
    pub(super) ranges: Vec<[V; 2]>,
}

/// Counts and bytes, as the thesis has them and as they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Storage {
    /// Divided nodes.
    pub nodes: u64,
    /// Regions.
    pub regions: u64,
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
        let nodes: u64 = self.levels.iter().map(|level| level.divided.len() as u64).sum();
        let values: u64 = self.levels.iter().map(|level| level.values.len() as u64).sum();
        let regions = if nodes == 0 { 1 } else { values };
        let of_level = |level: &Level<V>| {
            level.divided.len()
                + 4 * level.before.len()
                + size_of_val(level.values.as_slice())
                + size_of_val(level.ranges.as_slice())
        };
        Storage {
            nodes,
            regions,
            thesis_bytes: 4 * nodes + 3 * regions,
            grid_bytes: 2 * self.size.iter().map(|&n| u64::from(n)).product::<u64>(),
            resident_bytes: self.levels.iter().map(|level| of_level(level) as u64).sum(),
        }
    }

    /// The region that holds a sample.
    ///
    /// # Panics
    /// If the sample lies beyond the root.
    #[must_use]
    pub fn region_at(&self, p: [u32; 3]) -> Region<V> {
        assert!(p.iter().all(|&i| i >> self.depth == 0), "the sample lies in the root");
        let (mut node, mut level) = (0, self.depth);
        for nodes in &self.levels {
            level -= 1;
            let c = (0..3).fold(0, |c, axis| c | (p[axis] >> level & 1) << axis);
            match nodes.child(node, c) {
                Child::Divided(child) => node = child,
                Child::Region(value) => {
                    let base = p.map(|i| i >> level << level);
                    return Region { base, level, value: nodes.values[value] };
                }
            }
        }
        Region { base: [0; 3], level: self.depth, value: self.root }
    }
}

/// A child of a divided node.
pub(super) enum Child {
    /// Its number among the nodes of the next level.
    Divided(usize),
    /// The number of its value.
    Region(usize),
}

impl<V> Level<V> {
    /// Divided children of all nodes before this one.
    #[inline]
    pub(super) fn divided_before(&self, node: usize) -> usize {
        let group = node / 8 * 8;
        let within: u32 = self.divided[group..node].iter().map(|mask| mask.count_ones()).sum();
        (self.before[node / 8] + within) as usize
    }

    /// Child `c` of a node.
    #[inline]
    pub(super) fn child(&self, node: usize, c: u32) -> Child {
        let mask = self.divided[node];
        let before = (mask & ((1_u8 << c) - 1)).count_ones() as usize;
        let divided = self.divided_before(node) + before;
        match mask >> c & 1 {
            1 => Child::Divided(divided),
            // All children before, less the divided ones.
            _ => Child::Region(8 * node + c as usize - divided),
        }
    }

    /// Drops the nodes and values beyond these numbers.
    pub(super) fn truncate(&mut self, [nodes, values]: [usize; 2]) {
        self.divided.truncate(nodes);
        self.ranges.truncate(nodes);
        self.values.truncate(values);
    }

    /// Adds the nodes of another subtree, which follow in Morton order.
    pub(super) fn append(&mut self, next: &Self)
    where
        V: Copy,
    {
        self.divided.extend_from_slice(&next.divided);
        self.ranges.extend_from_slice(&next.ranges);
        self.values.extend_from_slice(&next.values);
    }

    /// Counts children once all nodes are there.
    pub(super) fn count(&mut self) {
        let mut sum = 0;
        let count = |nodes: &[u8]| {
            let before = sum;
            sum += nodes.iter().map(|mask| mask.count_ones()).sum::<u32>();
            before
        };
        self.before = self.divided.chunks(8).map(count).collect();
    }
}
