//! Intervals over boxes, 64 boxes a pass: what can be said of a surface without looking closer.

use fearless_simd::Simd;

use super::Machine;
use crate::{
    expr::{Choice, Tape},
    math::{Interval, Lanes, Mask, Scalar},
};

/// Boxes evaluated in one pass. An experiment found one pass of 64 three times as fast as eight
/// passes of 8: the look at an instruction is shared, and no vector waits for itself.
pub const BATCH: usize = 64;

/// The bounds of up to [`BATCH`] boxes, axis by axis.
#[derive(Clone, Debug)]
pub struct Boxes<T> {
    /// Lower bounds in x, y and z.
    pub lo: [[T; BATCH]; 3],
    /// Upper bounds in x, y and z.
    pub hi: [[T; BATCH]; 3],
}

impl<T: Scalar> Default for Boxes<T> {
    fn default() -> Self {
        Self { lo: [[T::default(); BATCH]; 3], hi: [[T::default(); BATCH]; 3] }
    }
}

/// What is proven of each box; bit i is box i.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// F > 0 everywhere, or F is defined nowhere, or the box is outside the tape's region.
    pub empty: u64,
    /// F is defined but for poles and cuts, F < 0, and the box is in the tape's region.
    pub inside: u64,
    /// F < 0 wherever it is defined, which may not be everywhere.
    pub inside_where_defined: u64,
    /// The tape's region holds the whole box, or the tape has none.
    pub in_region: u64,
}

/// Evaluates tapes over boxes, with G vectors of type L; `G * L::LEN` is [`BATCH`].
pub struct BoxEvaluator<L: Lanes, const G: usize> {
    token: L::Token,
    machine: Machine<Interval<L>, G>,
    /// The last verdict's, if the tape had a region.
    in_region: Option<u64>,
}

impl<S: Simd, L: Lanes<Token = S>, const G: usize> BoxEvaluator<L, G> {
    /// An evaluator for the instruction set of `token`.
    pub fn new(token: S) -> Self {
        const { assert!(G * L::LEN == BATCH, "the vectors of a slot hold one batch") };
        Self { token, machine: Machine::default(), in_region: None }
    }

    /// Evaluates `tape` over `boxes`; where `trace`, [`BoxEvaluator::choices`] can be asked after.
    pub fn eval(&mut self, tape: &Tape, boxes: &Boxes<L::Scalar>, trace: bool) -> Verdict {
        let Self { token, machine, .. } = self;
        let verdict = token.vectorize(
            #[inline(always)]
            || run(*token, machine, tape, boxes, trace),
        );
        self.in_region = tape.region().map(|_| verdict.in_region);
        verdict
    }

    /// How the choices of the last traced tape went for the box `lane`.
    pub fn choices(&self, lane: usize) -> impl Iterator<Item = Choice> {
        let of_operations = self.machine.choices().iter().map(move |&[first, second]| {
            match (first >> lane & 1, second >> lane & 1) {
                (1, _) => Choice::First,
                (_, 1) => Choice::Second,
                _ => Choice::Both,
            }
        });
        let of_region = self.in_region.map(|lanes| match lanes >> lane & 1 {
            1 => Choice::First,
            _ => Choice::Both,
        });
        of_operations.chain(of_region)
    }
}

#[inline(always)]
fn run<L: Lanes, const G: usize>(
    token: L::Token,
    machine: &mut Machine<Interval<L>, G>,
    tape: &Tape,
    boxes: &Boxes<L::Scalar>,
    trace: bool,
) -> Verdict {
    let zero = Interval::point(L::splat(token, L::Scalar::default()));
    let mut inputs = [[zero; G]; 3];
    for axis in 0..3 {
        for g in 0..G {
            let lo = L::load(token, &boxes.lo[axis][g * L::LEN..]);
            let hi = L::load(token, &boxes.hi[axis][g * L::LEN..]);
            inputs[axis][g] = Interval { lo, hi };
        }
    }
    let notes = machine.run(token, tape, &inputs, trace);
    let range = machine.slot(tape.result());
    let mut verdict = Verdict { empty: 0, inside: 0, inside_where_defined: 0, in_region: u64::MAX };
    for g in 0..G {
        let empty = notes[g].undefined | zero.lo.lt(range[g].lo);
        let negative = range[g].hi.lt(zero.lo) & !notes[g].undefined;
        let inside = negative & !notes[g].partial;
        verdict.empty |= empty.bits() << (g * L::LEN);
        verdict.inside |= inside.bits() << (g * L::LEN);
        verdict.inside_where_defined |= negative.bits() << (g * L::LEN);
    }
    if let Some(region) = tape.region() {
        let region = machine.slot(region);
        verdict.in_region = 0;
        for g in 0..G {
            verdict.empty |= zero.lo.lt(region[g].lo).bits() << (g * L::LEN);
            verdict.in_region |= region[g].hi.le(zero.lo).bits() << (g * L::LEN);
        }
        verdict.inside &= verdict.in_region & !verdict.empty;
        verdict.inside_where_defined &= !verdict.empty;
    }
    verdict
}
