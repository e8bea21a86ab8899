//! The numbers of the vertices around the cells of a brick.

use super::{
    cases::{N_EDGES, axis_of, lower_octant},
    cells::{CellBits, FIRST_X, FIRST_Y, LAST_X, LAST_Y},
    cuts::Cuts,
    extract::Edges,
    grid::{SIDE, Voxels},
    halo::Halo,
};

/// Cells of a brick along an edge, and the layer of voxels behind them.
const CELLS: usize = SIDE as usize + 1;
/// From voxel to voxel along each axis.
const STEPS: [usize; 3] = [1, CELLS, CELLS * CELLS];
const OF_AXIS: usize = CELLS * CELLS * CELLS;

/// The vertices of edges between the finest voxels of a brick and the layers behind it, by axis and
/// lower voxel, x fastest: those of larger voxels are there several times. Of edges that are not cut
/// anything may stand there.
pub(super) struct Numbers(Box<[u32; 3 * OF_AXIS]>);

impl Default for Numbers {
    fn default() -> Self {
        Self(Box::new([0; 3 * OF_AXIS]))
    }
}

impl Numbers {
    /// Sets the number of the vertex on the edge that leaves a voxel of the brick along an axis.
    #[inline]
    pub(super) fn set<const AXIS: usize>(&mut self, [x, y, z]: [usize; 3], number: u32) {
        self.0[AXIS * OF_AXIS + x + CELLS * (y + CELLS * z)] = number;
    }

    /// Looks up all that cells of a brick may ask for, but for what is [set](Self::set).
    pub(super) fn fill<B: Voxels>(
        &mut self,
        edges: &Edges<'_, B>,
        halo: &Halo<'_, B>,
        cells: &CellBits,
    ) {
        let mut has_large = false;
        for k in 0..8 {
            let step = [k & 1, k >> 1 & 1, k >> 2];
            // From the brick itself on.
            let number = halo.numbers[13 + step[0] + 3 * step[1] + 9 * step[2]];
            let Some(cuts) = edges.cuts.get(number as usize) else { continue };
            has_large |= cuts.has_large;
            if cuts.count() == 0 {
                continue;
            }
            let first = edges.firsts[number as usize];
            for axis in 0..3 {
                // Edges that leave the layers behind are no cell's.
                if k > 0 && step[axis] == 0 {
                    self.take(cuts, first, axis, step);
                }
                if !cuts.downwards().is_empty() {
                    self.take(cuts, first, axis + 3, step);
                }
            }
        }
        if has_large {
            self.take_large(edges, halo, cells);
        }
    }

    /// Takes the edges that leave the finest voxels of the brick that is `step` further in a direction.
    #[inline]
    fn take(&mut self, cuts: &Cuts, first: u32, direction: usize, step: [usize; 3]) {
        let (axis, is_down) = (direction % 3, direction >= 3);
        let mut of = u64::MAX;
        let mut slices = 0..8;
        if step[0] == 1 {
            of &= FIRST_X;
        } else if is_down && axis == 0 {
            of &= !FIRST_X;
        }
        if step[1] == 1 {
            of &= FIRST_Y;
        } else if is_down && axis == 1 {
            of &= !FIRST_Y;
        }
        if step[2] == 1 {
            slices = 0..1;
        } else if is_down && axis == 2 {
            slices = 1..8;
        }
        // Edges stand at their lower ends.
        let base = axis * OF_AXIS + 8 * (0..3).map(|axis| step[axis] * STEPS[axis]).sum::<usize>();
        for z in slices {
            let slice = base + STEPS[2] * z - if is_down { STEPS[axis] } else { 0 };
            cuts.each(8 * direction + z, of, |bit, rank| {
                self.0[slice + bit % 8 + CELLS * (bit / 8)] = first + rank;
            });
        }
    }

    /// Takes the edges between voxels that are larger than the finest.
    fn take_large<B: Voxels>(
        &mut self,
        edges: &Edges<'_, B>,
        halo: &Halo<'_, B>,
        cells: &CellBits,
    ) {
        // Of voxels behind the brick only those next to it.
        const PARTS: [u64; 4] = [u64::MAX, LAST_X, LAST_Y, LAST_X & LAST_Y];
        for (axis, z) in (0..3 * CELLS).map(|i| (i / CELLS, i % CELLS)) {
            for (i, part) in PARTS.into_iter().enumerate() {
                // Edges that leave the layers behind are no cell's.
                if i & 1 << axis != 0 || axis == 2 && z == CELLS - 1 {
                    continue;
                }
                let mut rest = cells.large(i, z, axis) & part;
                while rest != 0 {
                    let bit = rest.trailing_zeros() as usize;
                    rest &= rest - 1;
                    let at = [1 + bit % 8 + (i & 1), 1 + bit / 8 + (i >> 1), 1 + z];
                    let number = edges.number(halo, &halo.edge(at, axis));
                    self.0[axis * OF_AXIS + cell_at(at)] = number;
                }
            }
        }
    }

    /// The vertex on an edge, of which [`STEPS_TO`] tells the steps, of a cell.
    #[inline]
    pub(super) fn of(&self, cell: usize, steps: u16) -> u32 {
        self.0[cell + usize::from(steps)]
    }
}

/// The place of a cell whose first voxel is at a place of the halo.
#[inline]
pub(super) fn cell_at([x, y, z]: [usize; 3]) -> usize {
    x - 1 + CELLS * (y - 1 + CELLS * (z - 1))
}

/// How far after a cell's place the number of the vertex on an edge stands.
pub(super) const STEPS_TO: [u16; N_EDGES] = {
    let mut steps = [0; N_EDGES];
    let mut edge = 0;
    while edge < N_EDGES {
        let low = lower_octant(edge);
        let place = (low & 1) + CELLS * (low >> 1 & 1) + CELLS * CELLS * (low >> 2);
        steps[edge] = (axis_of(edge) * OF_AXIS + place) as u16;
        edge += 1;
    }
    steps
};
