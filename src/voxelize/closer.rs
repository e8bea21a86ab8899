//! A closer look at voxels of which it is not known whether the surface meets them.
//!
//! They are searched in parts of half, a quarter and an eighth of their edge, and only to decide
//! about the voxel: one part that the surface provably passes through certifies it, and if no part
//! is left the voxel is dropped. What is still open then is kept as a candidate: a tangency, a
//! singular point, a jump.
//!
//! Voxels in which F is monotone are looked at in f64, whole first: of them only a corner's sign was
//! too close to tell.

use std::sync::Arc;

use fearless_simd::{Simd, f64x8};

use super::node::Finding;
use crate::{
    eval::{BATCH, BoxEvaluator, Boxes, SlopeEvaluator},
    expr::Tape,
    math::{Lanes, Lattice, Scalar},
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
    fn whole(voxel: usize, ijk: [u32; 3], lattice: &Lattice) -> Self {
        let plane = |end: u32| [0, 1, 2].map(|axis| lattice.corner(axis, ijk[axis] + end));
        Self { voxel, lo: plane(0), hi: plane(1) }
    }

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

/// One thread's means for looking closer, with vectors of type L.
pub(super) struct CloserLook<L: Lanes, const G: usize> {
    lattice: Arc<Lattice>,
    values: BoxEvaluator<L, G>,
    slopes: SlopeEvaluator<L, G>,
    outer: Boxes<L::Scalar>,
    inner: Boxes<L::Scalar>,
}

/// In f64, whatever the rest of the search uses.
pub(super) type ExactLook<S> = CloserLook<f64x8<S>, { BATCH / 8 }>;

impl<S: Simd, L: Lanes<Token = S>, const G: usize> CloserLook<L, G> {
    pub(super) fn new(simd: S, lattice: Arc<Lattice>) -> Self {
        Self {
            lattice,
            values: BoxEvaluator::new(simd),
            slopes: SlopeEvaluator::new(simd),
            outer: Boxes::default(),
            inner: Boxes::default(),
        }
    }

    /// Goes on to another lattice.
    pub(super) fn enter(&mut self, lattice: Arc<Lattice>) {
        self.lattice = lattice;
    }

    /// What is found in each of `voxels`, which have no trend. Adds the gradients that it takes to
    /// `n_gradients`.
    pub(super) fn look_at_parts(
        &mut self,
        tape: &Tape,
        voxels: &[[u32; 3]],
        n_gradients: &mut u64,
    ) -> Vec<Finding> {
        let whole = |(voxel, &ijk)| Part::whole(voxel, ijk, &self.lattice);
        let parts = voxels.iter().enumerate().flat_map(|voxel| whole(voxel).halves()).collect();
        self.look(tape, voxels.len(), parts, n_gradients)
    }

    /// The same for voxels that have a trend.
    pub(super) fn look_at_whole(
        &mut self,
        tape: &Tape,
        voxels: &[[u32; 3]],
        n_gradients: &mut u64,
    ) -> Vec<Finding> {
        let whole = |(voxel, &ijk)| Part::whole(voxel, ijk, &self.lattice);
        let parts = voxels.iter().enumerate().map(whole).collect();
        self.look(tape, voxels.len(), parts, n_gradients)
    }

    fn look(
        &mut self,
        tape: &Tape,
        n_voxels: usize,
        mut parts: Vec<Part>,
        n_gradients: &mut u64,
    ) -> Vec<Finding> {
        let mut findings = vec![Finding::Empty; n_voxels];
        for halvings in 1.. {
            let by_value = self.survivors(&parts, &mut findings, |look, batch| {
                let verdict = look.values.eval(tape, &look.outer, batch, false);
                (verdict.empty, verdict.negative, 0)
            });
            *n_gradients += by_value.len() as u64;
            let mut left = self.survivors(&by_value, &mut findings, |look, batch| {
                let Self { values, slopes, outer, inner, .. } = look;
                let found = slopes.eval(values, tape, outer, inner, batch);
                let crossed = found.crossed & found.verdict.in_region;
                (found.verdict.empty, found.verdict.negative, crossed)
            });
            left.retain(|part| findings[part.voxel] != Finding::Certified);
            if left.is_empty() {
                break;
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

    /// The parts that the surface may meet. `test` tells of a batch, as bits, which are empty, in
    /// which F < 0, and through which the surface passes; voxels with the latter are certified.
    fn survivors(
        &mut self,
        parts: &[Part],
        findings: &mut [Finding],
        mut test: impl FnMut(&mut Self, usize) -> (u64, u64, u64),
    ) -> Vec<Part> {
        let mut left = Vec::new();
        for batch in parts.chunks(BATCH) {
            for (lane, part) in batch.iter().enumerate() {
                self.write(lane, part);
            }
            let (empty, negative, crossed) = test(self, batch.len());
            for (lane, part) in batch.iter().enumerate() {
                let is = |lanes: u64| lanes >> lane & 1 == 1;
                let finding = &mut findings[part.voxel];
                if *finding == Finding::Certified || is(empty) {
                } else if is(negative) {
                    *finding = Finding::Inside;
                } else if is(crossed) {
                    *finding = Finding::Certified;
                } else {
                    left.push(*part);
                }
            }
        }
        left
    }

    fn write(&mut self, lane: usize, part: &Part) {
        for axis in 0..3 {
            let (lo, hi) = (part.lo[axis], part.hi[axis]);
            self.outer.lo[axis][lane] = L::Scalar::below(lo);
            self.inner.lo[axis][lane] = L::Scalar::above(lo);
            self.inner.hi[axis][lane] = L::Scalar::below(hi);
            self.outer.hi[axis][lane] = L::Scalar::above(hi);
        }
    }
}
