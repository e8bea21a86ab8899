//! Gradients over boxes, 64 boxes a pass: what the value alone leaves open.

use fearless_simd::Simd;

use super::{
    BATCH, BoxEvaluator, Boxes, Machine, Verdict,
    boxes::{load, verdict},
};
use crate::{
    expr::Tape,
    math::{Constant, Dual, Interval, Lanes, Mask, MeanValue, Number, Scalar},
};

/// What gradients prove of each box; bit i is box i.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SlopeVerdict {
    /// What [`BoxEvaluator::eval`] says, sharpened by the mean value form.
    pub verdict: Verdict,
    /// The surface passes through: F is continuous and has both signs in the box.
    pub crossed: u64,
    /// F is continuous and does not fall along x, y or z.
    pub rising: [u64; 3],
    /// F is continuous and does not rise along x, y or z.
    pub falling: [u64; 3],
}

/// Evaluates gradients of tapes over boxes, with G vectors of type L; `G * L::LEN` is [`BATCH`].
pub struct SlopeEvaluator<L: Lanes, const G: usize> {
    token: L::Token,
    machine: Machine<Dual<Interval<L>>, G>,
    /// Where F is least and largest; see [`MeanValue`].
    low: Boxes<L::Scalar>,
    high: Boxes<L::Scalar>,
    /// The largest slope along each axis.
    steepest: [[L::Scalar; BATCH]; 3],
}

impl<S: Simd, L: Lanes<Token = S>, const G: usize> SlopeEvaluator<L, G> {
    /// An evaluator for the instruction set of `token`.
    pub fn new(token: S) -> Self {
        const { assert!(G * L::LEN == BATCH, "the vectors of a slot hold one batch") };
        let (low, high) = (Boxes::default(), Boxes::default());
        let steepest = [[L::Scalar::default(); BATCH]; 3];
        Self { token, machine: Machine::default(), low, high, steepest }
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
        let mut spread = [L::Scalar::default(); BATCH];
        let mut found = self.gradients(tape, outer, inner, n, &mut spread);
        let low = values.ranges(tape, &self.low, n);
        let high = values.ranges(tape, &self.high, n);
        let zero = L::Scalar::default();
        let verdict = &mut found.verdict;
        for i in (0..n).filter(|i| verdict.continuous >> i & 1 == 1) {
            let bit = 1 << i;
            if spread[i] < low.lo[i] {
                verdict.empty |= bit;
            } else if high.hi[i].to_f64() < -spread[i].to_f64() {
                verdict.negative |= bit;
            } else if low.hi[i] < zero && zero < high.lo[i] {
                found.crossed |= bit;
            }
        }
        found
    }

    /// The largest absolute slopes over a box of the last batch; bounds, and +∞ if unknown.
    pub fn steepest(&self, lane: usize) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.steepest[axis][lane].to_f64())
    }

    fn gradients(
        &mut self,
        tape: &Tape,
        outer: &Boxes<L::Scalar>,
        inner: &Boxes<L::Scalar>,
        n: usize,
        spread: &mut [L::Scalar; BATCH],
    ) -> SlopeVerdict {
        let Self { token, machine, low, high, steepest } = self;
        token.vectorize(
            #[inline(always)]
            || {
                let n_vectors = n.div_ceil(L::LEN);
                let bounds = load::<L, G>(*token, outer);
                let within = load::<L, G>(*token, inner);
                let mut inputs = [[Dual::constant(*token, &Constant::exact(0.0)); G]; 3];
                for axis in 0..3 {
                    for g in 0..G {
                        inputs[axis][g] = Dual::variable(bounds[axis][g], axis);
                    }
                }
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
                for g in 0..n_vectors {
                    let first = g * L::LEN;
                    let of_box = [bounds[0][g], bounds[1][g], bounds[2][g]];
                    let within = [within[0][g], within[1][g], within[2][g]];
                    let mut gradient = result[g].gradient;
                    for axis in 0..3 {
                        if !tape.depends_on(axis) {
                            gradient[axis] = Interval::point(of_box[0].lo.same(0.0));
                        }
                    }
                    let form = MeanValue::new(&of_box, &within, &gradient);
                    form.spread.store(&mut spread[first..]);
                    for axis in 0..3 {
                        form.low[axis].lo.store(&mut low.lo[axis][first..]);
                        form.low[axis].hi.store(&mut low.hi[axis][first..]);
                        form.high[axis].lo.store(&mut high.lo[axis][first..]);
                        form.high[axis].hi.store(&mut high.hi[axis][first..]);
                        gradient[axis].magnitudes().1.store(&mut steepest[axis][first..]);
                        let of_axis = [form.rising[axis].bits(), form.falling[axis].bits()];
                        let [rising, falling] = of_axis.map(|bits| bits << first);
                        found.rising[axis] |= rising & verdict.continuous;
                        found.falling[axis] |= falling & verdict.continuous;
                    }
                }
                found
            },
        )
    }
}
