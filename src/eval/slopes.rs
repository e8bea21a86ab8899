//! Gradients over boxes, 64 boxes a pass: what the value alone leaves open.

use fearless_simd::Simd;

use super::{
    BATCH, BoxEvaluator, Boxes, Machine, Verdict,
    boxes::{load, load_vectors, verdict},
};
use crate::{
    expr::Tape,
    math::{Constant, Dual, Interval, Lanes, Mask, MeanValue, Number, Scalar},
};

/// What gradients prove of each box; bit i is box i.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SlopeVerdict {
    /// What [`BoxEvaluator::eval`] says, which [`SlopeEvaluator::eval`] sharpens.
    pub verdict: Verdict,
    /// F is continuous and does not fall along x, y or z.
    pub rising: [u64; 3],
    /// F is continuous and does not rise along x, y or z.
    pub falling: [u64; 3],
    /// The surface passes through: F is continuous and has both signs in the box. Only
    /// [`SlopeEvaluator::eval`] tells.
    pub crossed: u64,
}

/// The directions of a gradient.
const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Evaluates gradients of tapes over boxes, with G vectors of type L; `G * L::LEN` is [`BATCH`].
pub struct SlopeEvaluator<L: Lanes, const G: usize> {
    token: L::Token,
    machine: Machine<Dual<Interval<L>>, G>,
    /// The slopes along each axis.
    slopes: Boxes<L::Scalar>,
    /// Where F is least and largest; see [`MeanValue`].
    low: Boxes<L::Scalar>,
    high: Boxes<L::Scalar>,
    /// How far F may leave its values there.
    spread: [L::Scalar; BATCH],
}

impl<S: Simd, L: Lanes<Token = S>, const G: usize> SlopeEvaluator<L, G> {
    /// An evaluator for the instruction set of `token`.
    pub fn new(token: S) -> Self {
        const { assert!(G * L::LEN == BATCH, "the vectors of a slot hold one batch") };
        let machine = Machine::default();
        let [slopes, low, high] = [(); 3].map(|()| Boxes::default());
        Self { token, machine, slopes, low, high, spread: [L::Scalar::default(); BATCH] }
    }

    /// Evaluates the value and the gradient of `tape` over the first `n` boxes, and, with `values`,
    /// the value at two points of each. The bounds of each box lie between those of `outer` and
    /// `inner`, which are the same where the type holds them.
    pub fn eval(
        &mut self,
        values: &mut BoxEvaluator<L, G>,
        tape: &Tape,
        outer: &Boxes<L::Scalar>,
        inner: &Boxes<L::Scalar>,
        n: usize,
    ) -> SlopeVerdict {
        let mut found = self.gradients(tape, outer, n);
        self.find_mean_values(outer, inner, n);
        let low = values.ranges(tape, &self.low, n);
        let high = values.ranges(tape, &self.high, n);
        let zero = L::Scalar::default();
        let verdict = &mut found.verdict;
        for i in (0..n).filter(|i| verdict.continuous >> i & 1 == 1) {
            let bit = 1 << i;
            if self.spread[i] < low.lo[i] {
                verdict.empty |= bit;
            } else if high.hi[i].to_f64() < -self.spread[i].to_f64() {
                verdict.negative |= bit;
            } else if low.hi[i] < zero && zero < high.lo[i] {
                found.crossed |= bit;
            }
        }
        found
    }

    /// Bounds of the slopes along each axis over the boxes of the last batch; infinite if unknown,
    /// and meaningless where F is not continuous.
    pub fn slopes(&self) -> &Boxes<L::Scalar> {
        &self.slopes
    }

    /// The largest absolute slopes over a box of the last batch; bounds, and +∞ if unknown.
    pub fn steepest(&self, lane: usize) -> [f64; 3] {
        let Boxes { lo, hi } = &self.slopes;
        [0, 1, 2].map(|axis| lo[axis][lane].to_f64().abs().max(hi[axis][lane].to_f64().abs()))
    }

    /// Evaluates the value and the gradient of `tape` over the first `n` boxes, for
    /// [`SlopeEvaluator::slopes`].
    pub fn gradients(&mut self, tape: &Tape, boxes: &Boxes<L::Scalar>, n: usize) -> SlopeVerdict {
        self.along(tape, boxes, n, &AXES)
    }

    /// The same with three directions instead of the axes. At kinks that tells more than a gradient: the
    /// bounds of its components do not know which of them go together.
    #[inline(never)]
    pub fn along(
        &mut self,
        tape: &Tape,
        boxes: &Boxes<L::Scalar>,
        n: usize,
        directions: &[[f64; 3]; 3],
    ) -> SlopeVerdict {
        let Self { token, machine, slopes, .. } = self;
        token.vectorize(
            #[inline(always)]
            || {
                let n_vectors = n.div_ceil(L::LEN);
                let bounds = load::<L, G>(*token, boxes);
                let mut inputs = [[Dual::constant(*token, &Constant::exact(0.0)); G]; 3];
                for axis in 0..3 {
                    let part = |d: [f64; 3]| Interval::constant(*token, &Constant::exact(d[axis]));
                    let gradient = directions.map(part);
                    for g in 0..G {
                        inputs[axis][g] = Dual { value: bounds[axis][g], gradient };
                    }
                }
                let is_flat =
                    directions.map(|d| (0..3).all(|axis| d[axis] == 0.0 || !tape.depends_on(axis)));
                let notes = machine.run_first(*token, tape, &inputs, n_vectors, false);
                let result = machine.slot(tape.result());
                let mut range = [bounds[0][0]; G];
                let mut region = range;
                for g in 0..n_vectors {
                    range[g] = result[g].value;
                    if let Some(slot) = tape.region() {
                        region[g] = machine.slot(slot)[g].value;
                    }
                }
                let region = tape.region().map(|_| &region);
                let verdict = verdict(&range, region, &notes[..n_vectors]);
                let mut found =
                    SlopeVerdict { verdict, crossed: 0, rising: [0; 3], falling: [0; 3] };
                let zero = L::splat(*token, L::Scalar::default());
                for g in 0..n_vectors {
                    let first = g * L::LEN;
                    for axis in 0..3 {
                        let mut slope = result[g].gradient[axis];
                        if is_flat[axis] {
                            slope = Interval::point(zero);
                        }
                        slope.lo.store(&mut slopes.lo[axis][first..]);
                        slope.hi.store(&mut slopes.hi[axis][first..]);
                        let rising = zero.le(slope.lo).bits() << first;
                        let falling = slope.hi.le(zero).bits() << first;
                        found.rising[axis] |= rising & verdict.continuous;
                        found.falling[axis] |= falling & verdict.continuous;
                    }
                }
                found
            },
        )
    }

    /// The mean value forms of the first `n` boxes, whose gradients were found.
    #[inline(never)]
    fn find_mean_values(&mut self, outer: &Boxes<L::Scalar>, inner: &Boxes<L::Scalar>, n: usize) {
        let Self { token, slopes, low, high, spread, .. } = self;
        token.vectorize(
            #[inline(always)]
            || {
                for first in (0..n).step_by(L::LEN) {
                    let outer = load_vectors::<L>(*token, outer, first);
                    let inner = load_vectors(*token, inner, first);
                    let slopes = load_vectors(*token, slopes, first);
                    let form = MeanValue::new(&outer, &inner, &slopes);
                    form.spread.store(&mut spread[first..]);
                    for axis in 0..3 {
                        form.low[axis].lo.store(&mut low.lo[axis][first..]);
                        form.low[axis].hi.store(&mut low.hi[axis][first..]);
                        form.high[axis].lo.store(&mut high.lo[axis][first..]);
                        form.high[axis].hi.store(&mut high.hi[axis][first..]);
                    }
                }
            },
        );
    }
}
