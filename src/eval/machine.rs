//! Runs a tape on G vectors of any kind of number at once.
//!
//! The vectors of a slot lie side by side, so that one look at an instruction pays for all of
//! them, and the steps of one vector do not wait for the last step of the same vector.

use crate::{
    expr::{Instruction, Tape},
    math::{Binary, Constant, Mask, Notes, NotesOf, Number, Slot, Token, Unary},
};

/// The memory that tapes run in; reused from run to run.
pub struct Machine<N: Number, const G: usize> {
    slots: Vec<Slot<N, G>>,
    choices: Vec<[u64; 2]>,
}

impl<N: Number, const G: usize> Default for Machine<N, G> {
    fn default() -> Self {
        Self { slots: Vec::new(), choices: Vec::new() }
    }
}

impl<N: Number, const G: usize> Machine<N, G> {
    /// Evaluates `tape` where the coordinates are `inputs`. Where `trace`, the outcome of every
    /// choice is kept for [`Machine::choices`].
    #[inline(always)]
    pub fn run(
        &mut self,
        token: Token<N>,
        tape: &Tape,
        inputs: &[Slot<N, G>; 3],
        trace: bool,
    ) -> [NotesOf<N>; G] {
        self.run_first(token, tape, inputs, G, trace)
    }

    /// As [`Machine::run`], for the first `n_vectors` vectors alone; the others mean nothing.
    #[inline(always)]
    pub fn run_first(
        &mut self,
        token: Token<N>,
        tape: &Tape,
        inputs: &[Slot<N, G>; 3],
        n_vectors: usize,
        trace: bool,
    ) -> [NotesOf<N>; G] {
        if self.slots.len() < tape.n_slots() {
            let zero = N::constant(token, &Constant::exact(0.0));
            self.slots.resize(tape.n_slots(), [zero; G]);
        }
        self.choices.clear();
        let slots = &mut self.slots[..tape.n_slots()];
        slots[..3].copy_from_slice(inputs);
        let mut all_notes = [Notes::clear::<N::Lanes>(token); G];
        let notes = &mut all_notes[..n_vectors];
        for instruction in tape.instructions() {
            match *instruction {
                Instruction::Constant(ref c, out) => {
                    slots[out as usize] = [N::constant(token, c); G];
                }
                Instruction::Unary(op, a, out) => {
                    if trace && op == Unary::Abs {
                        let zero = [N::constant(token, &Constant::exact(0.0)); G];
                        self.choices.push(order(&zero, &slots[a as usize]));
                    }
                    op.apply(slots, notes, (a as usize, out as usize));
                }
                Instruction::Binary(op, a, b, out) => {
                    let (a, b) = (a as usize, b as usize);
                    if trace && let Some(choice) = decide(op, &slots[a], &slots[b]) {
                        self.choices.push(choice);
                    }
                    op.apply(slots, notes, (a, b, out as usize));
                }
                Instruction::BinaryConstant(op, a, ref c, out) => {
                    if trace
                        && let Some(choice) =
                            decide(op, &slots[a as usize], &[N::constant(token, c); G])
                    {
                        self.choices.push(choice);
                    }
                    op.apply_constant(slots, notes, (a as usize, out as usize), c);
                }
            }
        }
        all_notes
    }

    /// A slot of the last run, such as [`Tape::result`].
    #[inline(always)]
    pub fn slot(&self, index: usize) -> &Slot<N, G> {
        &self.slots[index]
    }

    /// The outcomes of the last traced run, one entry for each choice of the tape: the lanes for
    /// which the first operand wins, and those for which the second does.
    pub fn choices(&self) -> &[[u64; 2]] {
        &self.choices
    }
}

/// Which operand of a minimum or maximum wins, as bits of all lanes.
#[inline(always)]
fn decide<N: Number, const G: usize>(
    op: Binary,
    a: &Slot<N, G>,
    b: &Slot<N, G>,
) -> Option<[u64; 2]> {
    match op {
        Binary::Min => Some(order(a, b)),
        Binary::Max => Some(order(b, a)),
        _ => None,
    }
}

/// The lanes where a lies below b, and those where b lies below a.
#[inline(always)]
fn order<N: Number, const G: usize>(a: &Slot<N, G>, b: &Slot<N, G>) -> [u64; 2] {
    let len = <N::Lanes as crate::math::Lanes>::LEN;
    let mut bits = [0; 2];
    for g in 0..G {
        let (first, second) = a[g].order(b[g]);
        bits[0] |= first.bits() << (g * len);
        bits[1] |= second.bits() << (g * len);
    }
    bits
}
