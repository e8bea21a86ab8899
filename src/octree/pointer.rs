//! The paper's own octree: cells of eight slots that point to cells, filled voxel by voxel.
//!
//! A voxel is stored from the cell that its predecessor ended in: one climbs to the common ancestor
//! of the two, which two masks find, and descends from there. Voxels that come in Morton order
//! climb little; any order gives the same octree. Cells are allocated in blocks and never move.
//!
//! *Based on:* N. Stolte, A. Kaufman, "Parallel Spatial Enumeration of Implicit Surfaces Using
//! Interval Arithmetic for Octree Generation and Its Direct Visualization", 1998, section 4 and
//! figure 2 (storing), section 5 and figure 6 (traversal with a stack).

use fixedbitset::FixedBitSet;

use super::{Bytes, Occupancy, OctNormal, Part, Storage, StoreVoxels, Voxel};

/// Eight slots, of the children x + 2y + 4z. A slot holds the index of a cell, or in cells of the
/// last level the rank of a voxel plus one.
type Cell = [u32; 8];

/// The slot of a child without a surface that lies outside.
const EMPTY: u32 = 0;
/// The slot of a child without a surface that lies inside.
const INSIDE: u32 = u32::MAX;
/// Cells of a block.
const BLOCK: usize = 1 << 12;
/// A part covers cells of this many levels above the voxels: 32³ voxels.
const PART_LEVELS: u32 = 5;

/// An octree of cells; see the file's text.
#[derive(Clone, Debug)]
pub struct PointerOctree {
    cells: Cells,
    depth: u32,
    normals: Vec<OctNormal>,
    certified: FixedBitSet,
}

/// Cells in blocks that never move. Cell 0 is the root.
#[derive(Clone, Debug, Default)]
struct Cells(Vec<Vec<Cell>>);

impl Cells {
    fn allocate(&mut self) -> u32 {
        if self.0.last().is_none_or(|block| block.len() == BLOCK) {
            self.0.push(Vec::with_capacity(BLOCK));
        }
        let before = (self.0.len() - 1) * BLOCK;
        let Some(block) = self.0.last_mut() else { return 0 };
        block.push([EMPTY; 8]);
        (before + block.len() - 1) as u32
    }

    fn slot(&self, cell: u32, child: u32) -> u32 {
        self.0[cell as usize / BLOCK][cell as usize % BLOCK][child as usize]
    }

    fn slot_mut(&mut self, cell: u32, child: u32) -> &mut u32 {
        &mut self.0[cell as usize / BLOCK][cell as usize % BLOCK][child as usize]
    }
}

/// Fills a [`PointerOctree`], from voxels in any order.
pub struct PointerOctreeBuilder {
    octree: PointerOctree,
    certified: Vec<bool>,
    /// The cells from the root down to the one that holds the last voxel or node.
    path: Vec<u32>,
    last: [u32; 3],
}

impl PointerOctreeBuilder {
    /// An empty octree with `depth` levels below the root.
    #[must_use]
    pub fn new(depth: u32) -> Self {
        let mut cells = Cells::default();
        let path = vec![cells.allocate()];
        let (normals, certified) = (Vec::new(), FixedBitSet::new());
        let octree = PointerOctree { cells, depth, normals, certified };
        Self { octree, certified: Vec::new(), path, last: [0; 3] }
    }

    /// The slot of the node at `ijk` on `level`, not the root; the cells that lead to it are
    /// allocated.
    fn slot(&mut self, level: u32, ijk: [u32; 3]) -> &mut u32 {
        let depth = self.octree.depth;
        let place = ijk.map(|i| i << (depth - level));
        // The bit that tells the children of the last cell of the path apart, and those above it,
        // which tell whether the cell holds the place.
        let mut mask1 = 1 << (depth - self.path.len() as u32);
        let mut mask2 = u32::MAX << 1 << (depth - self.path.len() as u32);
        while (0..3).any(|axis| place[axis] & mask2 != self.last[axis] & mask2)
            || self.path.len() as u32 > level
        {
            self.path.pop();
            mask1 <<= 1;
            mask2 <<= 1;
        }
        self.last = place;
        let child = |mask: u32| {
            let bit = |axis: usize| u32::from(place[axis] & mask != 0);
            bit(0) + 2 * bit(1) + 4 * bit(2)
        };
        let mut cell = self.path.last().copied().unwrap_or(0);
        while (self.path.len() as u32) < level {
            let next = match self.octree.cells.slot(cell, child(mask1)) {
                EMPTY => {
                    let next = self.octree.cells.allocate();
                    *self.octree.cells.slot_mut(cell, child(mask1)) = next;
                    next
                }
                next => next,
            };
            self.path.push(next);
            cell = next;
            mask1 >>= 1;
        }
        self.octree.cells.slot_mut(cell, child(mask1))
    }
}

impl StoreVoxels for PointerOctreeBuilder {
    fn store(&mut self, ijk: [u32; 3], normal: OctNormal, certified: bool) {
        self.octree.normals.push(normal);
        self.certified.push(certified);
        let index = self.octree.normals.len() as u32;
        *self.slot(self.octree.depth, ijk) = index;
    }

    fn store_inside(&mut self, level: u32, ijk: [u32; 3]) {
        if level == 0 {
            for child in 0..8 {
                *self.octree.cells.slot_mut(0, child) = INSIDE;
            }
        } else {
            *self.slot(level, ijk) = INSIDE;
        }
    }

    fn finish(self: Box<Self>) -> Box<dyn Storage> {
        let Self { mut octree, certified, .. } = *self;
        let mut slots = Vec::with_capacity(octree.normals.len());
        octree.traverse(Part { level: 0, index: 0, ijk: [0; 3] }, octree.depth, &mut |node| {
            slots.push((node.cell, node.child));
        });
        let stored = std::mem::take(&mut octree.normals);
        octree.certified = FixedBitSet::with_capacity(stored.len());
        for (rank, (cell, child)) in slots.into_iter().enumerate() {
            let slot = octree.cells.slot_mut(cell, child);
            let index = (*slot - 1) as usize;
            octree.normals.push(stored[index]);
            octree.certified.set(rank, certified[index]);
            *slot = rank as u32 + 1;
        }
        Box::new(octree)
    }
}

/// What a traversal meets: a slot, what it holds, and where that lies.
struct Met {
    cell: u32,
    child: u32,
    content: u32,
    ijk: [u32; 3],
}

impl PointerOctree {
    /// Calls `visit` for everything below the cell of `from` that meets the surface and lies on
    /// `level`, in Morton order. The stack holds cells and the child to go on with; coordinates
    /// are built bit by bit.
    fn traverse(&self, from: Part, level: u32, visit: &mut dyn FnMut(Met)) {
        let mut stack: Vec<(u32, u32)> = Vec::new();
        let (mut cell, mut child) = (from.index, 0);
        let mut place = from.ijk;
        loop {
            if child == 8 {
                let Some(above) = stack.pop() else { return };
                (cell, child) = above;
                place = place.map(|i| i >> 1);
                continue;
            }
            let content = self.cells.slot(cell, child);
            if content != EMPTY && content != INSIDE {
                let bits = [child & 1, child >> 1 & 1, child >> 2];
                let ijk = [0, 1, 2].map(|axis| place[axis] << 1 | bits[axis]);
                if from.level + stack.len() as u32 + 1 == level {
                    visit(Met { cell, child, content, ijk });
                } else {
                    stack.push((cell, child + 1));
                    (cell, child, place) = (content, 0, ijk);
                    continue;
                }
            }
            child += 1;
        }
    }

    /// What the slot of the voxel at `ijk` holds, or that of the node without a surface around it.
    fn content(&self, ijk: [u32; 3]) -> u32 {
        let mut content = 0;
        for shift in (0..self.depth).rev() {
            let bit = |axis: usize| ijk[axis] >> shift & 1;
            content = self.cells.slot(content, bit(0) + 2 * bit(1) + 4 * bit(2));
            if content == EMPTY || content == INSIDE {
                break;
            }
        }
        content
    }
}

impl Storage for PointerOctree {
    fn depth(&self) -> u32 {
        self.depth
    }

    fn voxel_count(&self) -> u32 {
        self.normals.len() as u32
    }

    fn bytes(&self) -> Bytes {
        let cells = self.cells.0.len() * BLOCK * size_of::<Cell>();
        Bytes::new(cells, &self.normals, &self.certified)
    }

    fn parts(&self) -> Vec<Part> {
        let level = self.depth.saturating_sub(PART_LEVELS);
        let root = Part { level: 0, index: 0, ijk: [0; 3] };
        if level == 0 {
            return if self.normals.is_empty() { Vec::new() } else { vec![root] };
        }
        let mut parts = Vec::new();
        self.traverse(root, level, &mut |met| {
            parts.push(Part { level, index: met.content, ijk: met.ijk });
        });
        parts
    }

    fn visit(&self, part: Part, visit: &mut dyn FnMut(Voxel)) {
        self.traverse(part, self.depth, &mut |met| {
            let rank = met.content - 1;
            let (normal, certified) = (self.normal(rank), self.is_certified(rank));
            visit(Voxel { rank, ijk: met.ijk, normal, certified });
        });
    }

    fn normal(&self, rank: u32) -> OctNormal {
        self.normals[rank as usize]
    }

    fn is_certified(&self, rank: u32) -> bool {
        self.certified[rank as usize]
    }

    fn find(&self, ijk: [u32; 3]) -> Option<u32> {
        match self.content(ijk) {
            EMPTY | INSIDE => None,
            content => Some(content - 1),
        }
    }

    fn occupancy(&self, ijk: [u32; 3]) -> Occupancy {
        match self.content(ijk) {
            EMPTY => Occupancy::Empty,
            INSIDE => Occupancy::Inside,
            _ => Occupancy::Surface,
        }
    }
}
