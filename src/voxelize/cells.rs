//! Cells of a block, each with bounds of F in it: all that rays need.
//!
//! A ray is followed to the surface itself, so that it does not need voxels: only cells in which the
//! surface was not disproved. They are as large as bricks, which are found by values alone. One
//! value and one gradient for each then bound F along every ray that passes through it; see
//! `affine`.

use std::sync::Arc;

use fearless_simd::Simd;
use glam::DVec3;

use super::search::{Effort, Run, Search};
use crate::{
    eval::BATCH,
    expr::Tape,
    math::{Lanes, Lattice, Scalar},
};

/// A cell that the surface may meet.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    /// Its place in the block.
    pub ijk: [u32; 3],
    /// Bounds of F around its middle; `None` unless F is continuous.
    pub bounds: Option<CellBounds>,
    /// Whether the region of the block's tape holds it.
    pub in_region: bool,
}

/// What is known of F in a cell: F(x) lies in `value` + `slopes` · (x − `middle`).
#[derive(Clone, Copy, Debug)]
pub struct CellBounds {
    /// A point of the cell.
    pub middle: DVec3,
    /// F there, between two numbers.
    pub value: [f64; 2],
    /// The slopes along each axis, between two numbers.
    pub slopes: [[f64; 2]; 3],
}

/// Cells that share a shortened tape.
#[derive(Clone, Debug)]
pub struct CellGroup {
    /// F in them.
    pub tape: Arc<Tape>,
    /// At least one.
    pub cells: Vec<Cell>,
}

/// What was found in a block.
#[derive(Clone, Debug)]
pub struct BlockCells {
    /// The cells' lattice.
    pub lattice: Lattice,
    /// Those that the surface may meet.
    pub groups: Vec<CellGroup>,
    /// What it took.
    pub effort: Effort,
}

impl CellBounds {
    /// The values that F may have where x − `middle` lies between `-reach` and `reach`; rounding
    /// is not accounted for.
    fn range(&self, reach: DVec3) -> [f64; 2] {
        let [mut least, mut most] = self.value;
        for axis in 0..3 {
            let [lo, hi] = self.slopes[axis];
            let departure = lo.abs().max(hi.abs()) * reach[axis];
            (least, most) = (least - departure, most + departure);
        }
        [least, most]
    }

    /// Whether F is not 0 in a cell with these half edges.
    fn excludes(&self, half: DVec3) -> bool {
        let [least, most] = self.range(half * (1.0 + 1e-6));
        least > 0.0 || most < 0.0
    }

    fn is_finite(&self) -> bool {
        let all = self.value.iter().chain(self.slopes.iter().flatten());
        all.copied().all(f64::is_finite)
    }
}

impl<S: Simd, L: Lanes<Token = S>, const G: usize> Search<S, L, G> {
    /// The cells of the lattice that the surface may meet, by the tapes that they share. Bounds hold
    /// up to `margin` beyond each.
    pub(super) fn cells(&mut self, root: Run, margin: f64) -> (Vec<CellGroup>, Effort) {
        let mut groups: Vec<CellGroup> = Vec::new();
        for run in self.descend(root, self.depth) {
            let mut cells = self.bound_cells(&run, margin);
            match groups.last_mut() {
                _ if cells.is_empty() => {}
                Some(group) if Arc::ptr_eq(&group.tape, &run.tape) => {
                    group.cells.append(&mut cells);
                }
                _ => groups.push(CellGroup { tape: run.tape, cells }),
            }
        }
        self.forget();
        (groups, self.take_effort())
    }

    /// Those cells of a run that their bounds do not disprove.
    fn bound_cells(&mut self, run: &Run, margin: f64) -> Vec<Cell> {
        let nodes: Vec<[u32; 3]> = run.places().collect();
        let mut cells = Vec::with_capacity(nodes.len());
        self.effort.gradients += nodes.len() as u64;
        for batch in nodes.chunks(BATCH) {
            let mut middles = [DVec3::ZERO; BATCH];
            let mut halves = [DVec3::ZERO; BATCH];
            for (lane, &ijk) in batch.iter().enumerate() {
                for axis in 0..3 {
                    let lo = self.lattice.corner(axis, ijk[axis]) - margin;
                    let hi = self.lattice.corner(axis, ijk[axis] + 1) + margin;
                    let middle = L::Scalar::nearest(0.5 * (lo + hi));
                    self.boxes.lo[axis][lane] = L::Scalar::below(lo);
                    self.boxes.hi[axis][lane] = L::Scalar::above(hi);
                    self.inner_boxes.lo[axis][lane] = middle;
                    self.inner_boxes.hi[axis][lane] = middle;
                    middles[lane][axis] = middle.to_f64();
                    halves[lane][axis] = (hi - middle.to_f64()).max(middle.to_f64() - lo);
                }
            }
            let n = batch.len();
            let verdict = self.slopes.gradients(&run.tape, &self.boxes, n).verdict;
            let values = self.values.ranges(&run.tape, &self.inner_boxes, n);
            let slopes = self.slopes.slopes();
            for (lane, &ijk) in batch.iter().enumerate() {
                let is = |lanes: u64| lanes >> lane & 1 == 1;
                if is(verdict.empty | verdict.inside_where_defined()) {
                    continue;
                }
                let of_axis = |axis: usize| {
                    [slopes.lo[axis][lane], slopes.hi[axis][lane]].map(Scalar::to_f64)
                };
                let bounds = CellBounds {
                    middle: middles[lane],
                    value: [values.lo[lane], values.hi[lane]].map(Scalar::to_f64),
                    slopes: [0, 1, 2].map(of_axis),
                };
                let bounds = Some(bounds).filter(|b| is(verdict.continuous) && b.is_finite());
                if !bounds.is_some_and(|bounds| bounds.excludes(halves[lane])) {
                    cells.push(Cell { ijk, bounds, in_region: is(verdict.in_region) });
                }
            }
        }
        cells
    }
}
