//! The signs of F at lattice corners, each evaluated once in a block of 32³ voxels.
//!
//! Neighbouring voxels share corners, and so do nodes of different levels. A corner's sign is
//! certain: it is that of an interval around the value, or unknown.

use fearless_simd::Simd;

use super::corners::Corners;
use crate::{
    eval::{BATCH, BoxEvaluator, Boxes},
    expr::Tape,
    math::Lanes,
};

/// Levels of a block; it has 2^5 voxels along an edge.
pub(super) const BLOCK_LEVELS: u32 = 5;
/// Corners along an edge of a block.
const SIDE: u32 = (1 << BLOCK_LEVELS) + 1;

/// What is known of F at a corner.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Sign {
    /// Nobody asked yet.
    #[default]
    Untold,
    /// Asked for, and to be evaluated with the next batch.
    Queued,
    /// F < 0.
    Negative,
    /// F > 0.
    Positive,
    /// Not to be told: F is too close to 0, or undefined.
    Unknown,
}

/// The corners of one block.
pub(super) struct CornerSigns {
    /// The block's first corner on the lattice.
    origin: [u32; 3],
    signs: Vec<Sign>,
    /// Where `signs` is to be cleared for the next block.
    touched: Vec<u32>,
    /// How many of `touched` have been evaluated.
    n_told: usize,
}

impl CornerSigns {
    pub(super) fn new() -> Self {
        let signs = vec![Sign::default(); SIDE.pow(3) as usize];
        Self { origin: [0; 3], signs, touched: Vec::new(), n_told: 0 }
    }

    /// Forgets everything and moves to the block whose first corner is `origin`.
    pub(super) fn enter(&mut self, origin: [u32; 3]) {
        self.origin = origin;
        self.n_told = 0;
        for index in self.touched.drain(..) {
            self.signs[index as usize] = Sign::Untold;
        }
    }

    /// The place of a corner of the lattice, which lies in the block.
    #[inline(always)]
    pub(super) fn index_of(&self, corner: [u32; 3]) -> u32 {
        let [x, y, z] = [0, 1, 2].map(|axis| corner[axis] - self.origin[axis]);
        x + SIDE * (y + SIDE * z)
    }

    /// How much further the place of a corner is that lies `steps` further.
    #[inline(always)]
    pub(super) fn offset(steps: [u32; 3]) -> u32 {
        steps[0] + SIDE * (steps[1] + SIDE * steps[2])
    }

    /// Asks for the sign at a place.
    #[inline(always)]
    pub(super) fn request(&mut self, index: u32) {
        let sign = &mut self.signs[index as usize];
        if *sign == Sign::Untold {
            *sign = Sign::Queued;
            self.touched.push(index);
        }
    }

    /// The sign at a place that was asked for before the last [`CornerSigns::tell`].
    #[inline(always)]
    pub(super) fn get(&self, index: u32) -> Sign {
        self.signs[index as usize]
    }

    /// Evaluates what was asked for, and returns how many corners that were.
    pub(super) fn tell<S: Simd, L: Lanes<Token = S>, const G: usize>(
        &mut self,
        evaluator: &mut BoxEvaluator<L, G>,
        corners: &Corners<L::Scalar>,
        tape: &Tape,
        boxes: &mut Boxes<L::Scalar>,
    ) -> u64 {
        let asked = &self.touched[self.n_told..];
        self.n_told = self.touched.len();
        for batch in asked.chunks(BATCH) {
            for (lane, &index) in batch.iter().enumerate() {
                let steps = [index % SIDE, index / SIDE % SIDE, index / (SIDE * SIDE)];
                let corner = [0, 1, 2].map(|axis| self.origin[axis] + steps[axis]);
                corners.write_corner(boxes, lane, corner);
            }
            let verdict = evaluator.eval(tape, boxes, batch.len(), false);
            for (lane, &index) in batch.iter().enumerate() {
                // Corners that are asked for lie in the tape's region, so that only F can be empty.
                let is = |lanes: u64| (lanes & verdict.continuous) >> lane & 1 == 1;
                self.signs[index as usize] = if is(verdict.negative) {
                    Sign::Negative
                } else if is(verdict.empty) {
                    Sign::Positive
                } else {
                    Sign::Unknown
                };
            }
        }
        asked.len() as u64
    }
}
