//! The signs of F at lattice corners, each evaluated once in a block of 32³ voxels.
//!
//! Neighbouring voxels share corners, and so do nodes of different levels. A corner's sign is
//! certain: it is that of an interval around the value, or unknown.

use fearless_simd::Simd;

use super::corners::Corners;
use crate::{
    eval::{BATCH, BoxEvaluator, Boxes},
    expr::Tape,
    math::{Lanes, Scalar},
};

/// Levels of a block; it has 2^5 voxels along an edge.
pub(super) const BLOCK_LEVELS: u32 = 5;
/// Corners along an edge of a block.
const SIDE: u32 = (1 << BLOCK_LEVELS) + 1;
/// Places stand in rows of 2^6, so that shifts take them apart.
const ROW_BITS: u32 = BLOCK_LEVELS + 1;
const PLACES: usize = ((SIDE - 1) << (2 * ROW_BITS) | (SIDE - 1) << ROW_BITS | SIDE) as usize;

/// What is known of F at one or several corners, as flags.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Signs(u8);

impl Signs {
    /// F < 0 at one of them.
    pub(super) const NEGATIVE: Self = Self(1);
    /// F > 0 at one of them.
    pub(super) const POSITIVE: Self = Self(2);
    /// Both.
    pub(super) const BOTH: Self = Self(3);
    /// Not to be told: F is too close to 0, or undefined.
    const UNKNOWN: Self = Self(4);
    /// Asked for, and to be evaluated with the next batch.
    const QUEUED: Self = Self(8);

    /// All that is known of this and the other.
    #[inline(always)]
    pub(super) fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether all of `signs` are among these.
    #[inline(always)]
    pub(super) fn have(self, signs: Self) -> bool {
        self.0 & signs.0 == signs.0
    }
}

/// The corners of one block.
pub(super) struct CornerSigns<T> {
    /// The block's first corner on the lattice.
    origin: [u32; 3],
    /// The block's corner planes.
    below: [[T; SIDE as usize]; 3],
    above: [[T; SIDE as usize]; 3],
    signs: Vec<Signs>,
    /// The places that were asked for, `n_asked` of them, and room for one more.
    asked: Vec<u32>,
    n_asked: usize,
    /// How many of them have been evaluated.
    n_told: usize,
}

impl<T: Scalar> CornerSigns<T> {
    pub(super) fn new() -> Self {
        Self {
            origin: [0; 3],
            below: [[T::default(); SIDE as usize]; 3],
            above: [[T::default(); SIDE as usize]; 3],
            signs: vec![Signs::default(); PLACES],
            asked: vec![0; SIDE.pow(3) as usize + 1],
            n_asked: 0,
            n_told: 0,
        }
    }

    /// Forgets everything and moves to the block whose first corner is `origin`.
    pub(super) fn enter(&mut self, origin: [u32; 3], corners: &Corners<T>) {
        for &place in &self.asked[..self.n_asked] {
            self.signs[place as usize] = Signs::default();
        }
        (self.n_asked, self.n_told) = (0, 0);
        self.origin = origin;
        for axis in 0..3 {
            for step in 0..SIDE {
                let bounds = corners.plane(axis, origin[axis] + step);
                [self.below[axis][step as usize], self.above[axis][step as usize]] = bounds;
            }
        }
    }

    /// The place of a corner of the lattice, which lies in the block.
    #[inline(always)]
    pub(super) fn place(&self, corner: [u32; 3]) -> u32 {
        steps_to([0, 1, 2].map(|axis| corner[axis] - self.origin[axis]))
    }

    /// Asks for the signs at the places `steps` further than `first`.
    #[inline(always)]
    pub(super) fn ask<const N: usize>(&mut self, first: u32, steps: &[u32; N]) {
        for step in steps {
            self.ask_if(true, first + step);
        }
    }

    /// Asks for the sign at a place if it is needed.
    #[inline(always)]
    pub(super) fn ask_if(&mut self, is_needed: bool, place: u32) {
        // Without a branch: half of the corners are known, and none can tell which.
        let signs = &mut self.signs[place as usize];
        let is_new = is_needed & (*signs == Signs::default());
        self.asked[self.n_asked] = place;
        self.n_asked += usize::from(is_new);
        signs.0 |= u8::from(is_new) * Signs::QUEUED.0;
    }

    /// The signs at places that were asked for before the last [`CornerSigns::tell`].
    #[inline(always)]
    pub(super) fn get<const N: usize>(&self, first: u32, steps: &[u32; N]) -> [Signs; N] {
        steps.map(|step| self.signs[(first + step) as usize])
    }

    /// Evaluates what was asked for, and returns how many corners that were.
    pub(super) fn tell<S: Simd, L: Lanes<Token = S, Scalar = T>, const G: usize>(
        &mut self,
        evaluator: &mut BoxEvaluator<L, G>,
        tape: &Tape,
        boxes: &mut Boxes<T>,
    ) -> u64 {
        let asked = &self.asked[self.n_told..self.n_asked];
        self.n_told = self.n_asked;
        for batch in asked.chunks(BATCH) {
            for (lane, &place) in batch.iter().enumerate() {
                for axis in 0..3 {
                    let step = place as usize >> (axis as u32 * ROW_BITS) & ((1 << ROW_BITS) - 1);
                    boxes.lo[axis][lane] = self.below[axis][step];
                    boxes.hi[axis][lane] = self.above[axis][step];
                }
            }
            let verdict = evaluator.eval(tape, boxes, batch.len(), false);
            let negative = verdict.negative & verdict.continuous;
            // Corners that are asked for lie in the tape's region: only F > 0 makes them empty.
            let positive = verdict.empty & verdict.continuous;
            let unknown = !(negative | positive);
            for (lane, &place) in batch.iter().enumerate() {
                let flag = |lanes: u64, signs: Signs| (lanes >> lane & 1) as u8 * signs.0;
                self.signs[place as usize] = Signs(
                    flag(negative, Signs::NEGATIVE)
                        | flag(positive, Signs::POSITIVE)
                        | flag(unknown, Signs::UNKNOWN),
                );
            }
        }
        asked.len() as u64
    }
}

/// From the first corner of a node to those of its children of the given edge, and from the first
/// corner of a child to all its corners.
#[inline(always)]
pub(super) fn steps_to_children(edge: u32) -> [u32; 8] {
    [0, 1, 2, 3, 4, 5, 6, 7].map(|c| steps_to([c & 1, c >> 1 & 1, c >> 2].map(|bit| bit * edge)))
}

/// How much further the place of a corner is that lies `steps` further.
#[inline(always)]
pub(super) const fn steps_to(steps: [u32; 3]) -> u32 {
    steps[0] | steps[1] << ROW_BITS | steps[2] << (2 * ROW_BITS)
}
