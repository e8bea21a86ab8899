//! Intervals over boxes, 64 boxes a pass: what can be said of a surface without looking closer.

use fearless_simd::Simd;

use super::Machine;
use crate::{
    expr::{Choice, Tape},
    math::{Interval, Lanes, Mask, MaskOf, Notes, NotesOf, Scalar, Slot},
};

/// Boxes evaluated in one pass. An experiment found one pass of 64 three times as fast as eight
/// passes of 8: the look at an instruction is shared, and no vector waits for itself.
pub const BATCH: usize = 64;

/// The bounds of up to [`BATCH`] boxes, axis by axis. Those that are not asked about must still be
/// boxes; a fresh one is all zeros.
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Verdict {
    /// F > 0 wherever it is defined, which may be nowhere, or the tape's region is elsewhere.
    pub empty: u64,
    /// F < 0 wherever it is defined, and it is defined somewhere.
    pub negative: u64,
    /// F is defined everywhere but for poles and cuts.
    pub defined: u64,
    /// F is defined and continuous everywhere: a change of its sign proves a surface.
    pub continuous: u64,
    /// The tape's region holds the whole box, or the tape has none.
    pub in_region: u64,
}

impl Verdict {
    /// The boxes that lie inside the solid.
    #[must_use]
    pub fn inside(&self) -> u64 {
        self.negative & self.defined & self.in_region & !self.empty
    }

    /// The boxes whose part in which F is defined lies inside; they have no surface either.
    #[must_use]
    pub fn inside_where_defined(&self) -> u64 {
        self.negative & !self.empty
    }
}

/// The ranges of F over a batch.
#[derive(Clone, Debug)]
pub struct Ranges<T> {
    /// Lower bounds.
    pub lo: [T; BATCH],
    /// Upper bounds.
    pub hi: [T; BATCH],
}

/// Evaluates tapes over boxes, with G vectors of type L; `G * L::LEN` is [`BATCH`].
pub struct BoxEvaluator<L: Lanes, const G: usize> {
    token: L::Token,
    machine: Machine<Interval<L>, G>,
    last: Verdict,
    /// Whether the last tape had a region.
    has_region: bool,
}

impl<S: Simd, L: Lanes<Token = S>, const G: usize> BoxEvaluator<L, G> {
    /// An evaluator for the instruction set of `token`.
    pub fn new(token: S) -> Self {
        const { assert!(G * L::LEN == BATCH, "the vectors of a slot hold one batch") };
        Self { token, machine: Machine::default(), last: Verdict::default(), has_region: false }
    }

    /// Evaluates `tape` over the first `n` boxes; where `trace`, [`BoxEvaluator::choices`] can be
    /// asked after.
    pub fn eval(
        &mut self,
        tape: &Tape,
        boxes: &Boxes<L::Scalar>,
        n: usize,
        trace: bool,
    ) -> Verdict {
        self.run(tape, boxes, n, trace, None)
    }

    /// The ranges of F over the first `n` boxes; the others mean nothing.
    pub fn ranges(&mut self, tape: &Tape, boxes: &Boxes<L::Scalar>, n: usize) -> Ranges<L::Scalar> {
        let zeros = [L::Scalar::default(); BATCH];
        let mut ranges = Ranges { lo: zeros, hi: zeros };
        self.run(tape, boxes, n, false, Some(&mut ranges));
        ranges
    }

    // Once for both: the machine is large.
    #[inline(never)]
    fn run(
        &mut self,
        tape: &Tape,
        boxes: &Boxes<L::Scalar>,
        n: usize,
        trace: bool,
        ranges: Option<&mut Ranges<L::Scalar>>,
    ) -> Verdict {
        let Self { token, machine, .. } = self;
        let verdict = token.vectorize(
            #[inline(always)]
            || {
                let inputs = load(*token, boxes);
                let n_vectors = n.div_ceil(L::LEN);
                let notes = machine.run_first(*token, tape, &inputs, n_vectors, trace);
                let result = machine.slot(tape.result());
                if let Some(ranges) = ranges {
                    for (g, range) in result[..n_vectors].iter().enumerate() {
                        range.lo.store(&mut ranges.lo[g * L::LEN..]);
                        range.hi.store(&mut ranges.hi[g * L::LEN..]);
                    }
                }
                let region = tape.region().map(|slot| machine.slot(slot));
                verdict(result, region, &notes[..n_vectors])
            },
        );
        (self.last, self.has_region) = (verdict, tape.region().is_some());
        verdict
    }

    /// How the choices of the last traced tape went for the box `lane`. None is decided where F is
    /// undefined in part: the operand that loses may be what is undefined, and F with it.
    pub fn choices(&self, lane: usize) -> impl Iterator<Item = Choice> {
        let is = move |lanes: u64| lanes >> lane & 1 == 1;
        let is_defined = is(self.last.defined);
        let of_operations = self.machine.choices().iter().map(move |&[first, second]| {
            match (is_defined && is(first), is_defined && is(second)) {
                (true, _) => Choice::First,
                (_, true) => Choice::Second,
                _ => Choice::Both,
            }
        });
        let of_region = self.has_region.then(|| {
            if is_defined && is(self.last.in_region) { Choice::First } else { Choice::Both }
        });
        of_operations.chain(of_region)
    }
}

/// The boxes as slots.
#[inline(always)]
pub(super) fn load<L: Lanes, const G: usize>(
    token: L::Token,
    boxes: &Boxes<L::Scalar>,
) -> [Slot<Interval<L>, G>; 3] {
    let zero = Interval::point(L::splat(token, L::Scalar::default()));
    let mut inputs = [[zero; G]; 3];
    for g in 0..G {
        let vectors = load_vectors(token, boxes, g * L::LEN);
        for axis in 0..3 {
            inputs[axis][g] = vectors[axis];
        }
    }
    inputs
}

/// One vector of boxes, from the box `first`.
#[inline(always)]
pub(super) fn load_vectors<L: Lanes>(
    token: L::Token,
    boxes: &Boxes<L::Scalar>,
    first: usize,
) -> [Interval<L>; 3] {
    let mut vectors = [Interval::point(L::splat(token, L::Scalar::default())); 3];
    for axis in 0..3 {
        let lo = L::load(token, &boxes.lo[axis][first..]);
        let hi = L::load(token, &boxes.hi[axis][first..]);
        vectors[axis] = Interval { lo, hi };
    }
    vectors
}

/// What the ranges of F and of the region tell, with what was noted on the way.
#[inline(always)]
pub(super) fn verdict<L: Lanes, const G: usize>(
    range: &Slot<Interval<L>, G>,
    region: Option<&Slot<Interval<L>, G>>,
    notes: &[NotesOf<Interval<L>>],
) -> Verdict {
    let mut verdict = Verdict { in_region: u64::MAX, ..Verdict::default() };
    for (g, &Notes { undefined, partial, discontinuous }) in notes.iter().enumerate() {
        let zero = range[g].lo.same(0.0);
        let set = |mask: MaskOf<Interval<L>>| mask.bits() << (g * L::LEN);
        verdict.empty |= set(undefined | zero.lt(range[g].lo));
        verdict.negative |= set(range[g].hi.lt(zero) & !undefined);
        verdict.defined |= set(!partial & !undefined);
        verdict.continuous |= set(!discontinuous);
    }
    if let Some(region) = region {
        verdict.in_region = 0;
        for g in 0..notes.len() {
            let zero = region[g].lo.same(0.0);
            verdict.empty |= zero.lt(region[g].lo).bits() << (g * L::LEN);
            verdict.in_region |= region[g].hi.le(zero).bits() << (g * L::LEN);
        }
    }
    verdict
}
