//! The operations of a formula as data, and the one place that carries them out.
//!
//! A slot holds G vectors, so that one look at an operation pays for many boxes: the loop over the
//! vectors is inside every case.

use super::number::{Constant, Hyperbolic, NotesOf, Number, Step, Wave};

/// An operation on one operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unary {
    /// −a
    Neg,
    /// 1 / a
    Recip,
    /// a²
    Square,
    /// aⁿ, n at least 3.
    Powi(u32),
    /// √a
    Sqrt,
    /// |a|
    Abs,
    /// sin a or cos a
    Wave(Wave),
    /// eᵃ
    Exp,
    /// ln a
    Ln,
    /// arccos a
    Acos,
    /// arcsin a
    Asin,
    /// arctan a
    Atan,
    /// tan a
    Tan,
    /// sinh a, cosh a or tanh a
    Hyperbolic(Hyperbolic),
    /// The real cube root
    Cbrt,
    /// ⌊a⌋ and the like
    Step(Step),
    /// t²(3 − 2t), t = a cut to [0, 1]
    Smoothstep,
}

/// An operation on two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Binary {
    /// a + b
    Add,
    /// a − b
    Sub,
    /// a b
    Mul,
    /// The smaller one.
    Min,
    /// The larger one.
    Max,
    /// The angle of (x, y) = (b, a); see [`Number::atan2`] for `lifted`.
    Atan2 {
        /// Continuous across the cut.
        lifted: bool,
    },
    /// sin or cos of n times the angle of (x, y) = (b, a).
    Harmonic {
        /// Which.
        wave: Wave,
        /// At least 1.
        n: u32,
    },
}

impl Binary {
    /// Whether the operands may change places.
    #[must_use]
    pub fn commutes(self) -> bool {
        matches!(self, Self::Add | Self::Mul | Self::Min | Self::Max)
    }
}

/// G vectors of numbers.
pub type Slot<N, const G: usize> = [N; G];

#[inline(always)]
fn map<N: Number, const G: usize>(
    slots: &mut [Slot<N, G>],
    notes: &mut [NotesOf<N>; G],
    (a, out): (usize, usize),
    f: impl Fn(N, &mut NotesOf<N>) -> N,
) {
    for g in 0..G {
        slots[out][g] = f(slots[a][g], &mut notes[g]);
    }
}

#[inline(always)]
fn zip<N: Number, const G: usize>(
    slots: &mut [Slot<N, G>],
    notes: &mut [NotesOf<N>; G],
    (a, b, out): (usize, usize, usize),
    f: impl Fn(N, N, &mut NotesOf<N>) -> N,
) {
    for g in 0..G {
        slots[out][g] = f(slots[a][g], slots[b][g], &mut notes[g]);
    }
}

impl Unary {
    /// `slots[out] = op slots[a]`
    #[inline(always)]
    pub fn apply<N: Number, const G: usize>(
        self,
        slots: &mut [Slot<N, G>],
        notes: &mut [NotesOf<N>; G],
        at: (usize, usize),
    ) {
        match self {
            Self::Neg => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, _| a.neg(),
            ),
            Self::Recip => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, n| a.recip(n),
            ),
            Self::Square => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, _| a.square(),
            ),
            Self::Powi(n) => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, _| a.powi(n),
            ),
            Self::Sqrt => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, n| a.sqrt(n),
            ),
            Self::Abs => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, _| a.abs(),
            ),
            Self::Wave(Wave::Sin) => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, _| a.wave(Wave::Sin),
            ),
            Self::Wave(Wave::Cos) => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, _| a.wave(Wave::Cos),
            ),
            Self::Exp => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, _| a.exp(),
            ),
            Self::Ln => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, n| a.ln(n),
            ),
            Self::Acos => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, n| a.acos(n),
            ),
            Self::Asin => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, n| a.asin(n),
            ),
            Self::Atan => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, _| a.atan(),
            ),
            Self::Tan => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, n| a.tan(n),
            ),
            Self::Hyperbolic(Hyperbolic::Sinh) => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, _| a.hyperbolic(Hyperbolic::Sinh),
            ),
            Self::Hyperbolic(Hyperbolic::Cosh) => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, _| a.hyperbolic(Hyperbolic::Cosh),
            ),
            Self::Hyperbolic(Hyperbolic::Tanh) => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, _| a.hyperbolic(Hyperbolic::Tanh),
            ),
            Self::Cbrt => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, _| a.cbrt(),
            ),
            Self::Smoothstep => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, _| a.smoothstep(),
            ),
            Self::Step(step) => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, n| a.step(step, n),
            ),
        }
    }
}

impl Binary {
    /// `slots[out] = slots[a] op slots[b]`
    #[inline(always)]
    pub fn apply<N: Number, const G: usize>(
        self,
        slots: &mut [Slot<N, G>],
        notes: &mut [NotesOf<N>; G],
        at: (usize, usize, usize),
    ) {
        match self {
            Self::Add => zip(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, b, _| a.add(b),
            ),
            Self::Sub => zip(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, b, _| a.sub(b),
            ),
            Self::Mul => zip(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, b, _| a.mul(b),
            ),
            Self::Min => zip(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, b, _| a.min(b),
            ),
            Self::Max => zip(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, b, _| a.max(b),
            ),
            Self::Atan2 { lifted } => zip(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, b, n| a.atan2(b, lifted, n),
            ),
            Self::Harmonic { wave, n: times } => {
                zip(
                    slots,
                    notes,
                    at,
                    #[inline(always)]
                    |a, b, n| a.harmonic(b, wave, times, n),
                );
            }
        }
    }

    /// `slots[out] = slots[a] op c`, for the operations that commute.
    ///
    /// # Panics
    /// On the others.
    #[inline(always)]
    pub fn apply_constant<N: Number, const G: usize>(
        self,
        slots: &mut [Slot<N, G>],
        notes: &mut [NotesOf<N>; G],
        at: (usize, usize),
        c: &Constant,
    ) {
        let value = N::constant(slots[at.0][0].token(), c);
        match self {
            Self::Add => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, _| a.add_constant(c),
            ),
            Self::Mul => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, _| a.mul_constant(c),
            ),
            Self::Min => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, _| a.min(value),
            ),
            Self::Max => map(
                slots,
                notes,
                at,
                #[inline(always)]
                |a, _| a.max(value),
            ),
            _ => unreachable!("operands of {self:?} do not commute"),
        }
    }
}
