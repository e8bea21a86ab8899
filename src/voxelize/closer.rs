//! A closer look at voxels of which it is not known whether the surface meets them.
//!
//! They are searched in f64, in parts of half, a quarter and an eighth of their edge, and only to
//! decide about the voxel: one part that the surface provably passes through certifies it, and if no
//! part is left the voxel is dropped. What is still open then is kept as a candidate: a tangency, a
//! singular point, a jump. Voxels in which F is monotone are looked at whole first: of them only a
//! corner's sign was too close to tell.

use fearless_simd::{Simd, f64x8};

use super::node::Finding;
use crate::{
    eval::{BATCH, BoxEvaluator, Boxes, SlopeEvaluator},
    expr::Tape,
    math::Lattice,
};

/// How often a voxel is halved.
const MAX_HALVINGS: u32 = 3;

/// A voxel with more parts than this left is given up: nearly all its parts meet the surface, as
/// around a singular point, or F is so involved that many more halvings would be needed.
const MAX_PARTS: usize = 4;

/// A part of the voxel number `voxel`.
#[derive(Clone, Copy)]
struct Part {
    voxel: usize,
    lo: [f64; 3],
    hi: [f64; 3],
}

impl Part {
    fn halves(self) -> impl Iterator<Item = Self> {
        (0..8_u32).map(move |c| {
            let mut half = self;
            for axis in 0..3 {
                let middle = self.lo[axis] + 0.5 * (self.hi[axis] - self.lo[axis]);
                if c >> axis & 1 == 0 {
                    half.hi[axis] = middle;
                } else {
                    half.lo[axis] = middle;
                }
            }
            half
        })
    }
}

/// One thread's means for looking closer.
pub(super) struct CloserLook<'a, S: Simd> {
    lattice: &'a Lattice,
    values: BoxEvaluator<f64x8<S>, { BATCH / 8 }>,
    slopes: SlopeEvaluator<f64x8<S>, { BATCH / 8 }>,
    boxes: Boxes<f64>,
}

impl<'a, S: Simd> CloserLook<'a, S> {
    pub(super) fn new(simd: S, lattice: &'a Lattice) -> Self {
        Self {
            lattice,
            values: BoxEvaluator::new(simd),
            slopes: SlopeEvaluator::new(simd),
            boxes: Boxes::default(),
        }
    }

    /// What is found in each of `voxels`, of which is told whether F has a trend there. Adds the
    /// gradients that it takes to `n_gradients`.
    pub(super) fn look(
        &mut self,
        tape: &Tape,
        voxels: &[([u32; 3], bool)],
        n_gradients: &mut u64,
    ) -> Vec<Finding> {
        let mut findings = vec![Finding::Empty; voxels.len()];
        let mut parts = Vec::new();
        for (voxel, &(ijk, has_trend)) in voxels.iter().enumerate() {
            let whole = self.whole(voxel, ijk);
            if has_trend { parts.push(whole) } else { parts.extend(whole.halves()) }
        }
        for halvings in 1.. {
            *n_gradients += parts.len() as u64;
            let mut left = self.survivors(tape, &parts, &mut findings);
            left.retain(|part| findings[part.voxel] != Finding::Certified);
            if left.is_empty() {
                return findings;
            }
            parts.clear();
            for of_voxel in left.chunk_by(|a, b| a.voxel == b.voxel) {
                if halvings == MAX_HALVINGS || of_voxel.len() > MAX_PARTS {
                    findings[of_voxel[0].voxel] = Finding::Candidate;
                } else {
                    parts.extend(of_voxel.iter().flat_map(|part| part.halves()));
                }
            }
        }
        findings
    }

    fn whole(&self, voxel: usize, ijk: [u32; 3]) -> Part {
        let plane = |end: u32| [0, 1, 2].map(|axis| self.lattice.corner(axis, ijk[axis] + end));
        Part { voxel, lo: plane(0), hi: plane(1) }
    }

    /// The parts that the surface may meet. Notes which voxels are certified, and which have parts
    /// inside.
    fn survivors(&mut self, tape: &Tape, parts: &[Part], findings: &mut [Finding]) -> Vec<Part> {
        let mut left = Vec::new();
        for batch in parts.chunks(BATCH) {
            for (lane, part) in batch.iter().enumerate() {
                for axis in 0..3 {
                    self.boxes.lo[axis][lane] = part.lo[axis];
                    self.boxes.hi[axis][lane] = part.hi[axis];
                }
            }
            let found = {
                let boxes = &self.boxes;
                self.slopes.eval(&mut self.values, tape, boxes, boxes, batch.len())
            };
            for (lane, part) in batch.iter().enumerate() {
                let is = |lanes: u64| lanes >> lane & 1 == 1;
                let finding = &mut findings[part.voxel];
                if *finding == Finding::Certified || is(found.verdict.empty) {
                } else if is(found.verdict.negative) {
                    *finding = Finding::Inside;
                } else if is(found.crossed & found.verdict.in_region) {
                    *finding = Finding::Certified;
                } else {
                    left.push(*part);
                }
            }
        }
        left
    }
}
