//! The operations of a formula as data, and the one place that carries them out.
//!
//! A slot holds G vectors, so that one look at an operation pays for many boxes: the loop over the
//! vectors is inside every case. It goes over as many vectors as there are notes, which may be fewer
//! than G: the last batch of a run is rarely full.

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
    /// The distance to the nearest integer.
    Triangle,
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

/// Runs an expression of `$a` and the notes `$n` for every vector of a slot. A macro, because a
/// closure would have to be told to be inlined at every use.
macro_rules! each {
    ($slots:ident, $notes:ident, ($a_at:expr => $out:expr), |$a:ident, $n:pat_param| $result:expr) => {
        for g in 0..$notes.len().min(G) {
            let $a = $slots[$a_at][g];
            let $n = &mut $notes[g];
            $slots[$out][g] = $result;
        }
    };
    (
        $slots:ident, $notes:ident, ($a_at:expr, $b_at:expr => $out:expr),
        |$a:ident, $b:ident, $n:pat_param| $result:expr
    ) => {
        for g in 0..$notes.len().min(G) {
            let ($a, $b) = ($slots[$a_at][g], $slots[$b_at][g]);
            let $n = &mut $notes[g];
            $slots[$out][g] = $result;
        }
    };
}

impl Unary {
    /// `slots[out] = op slots[a]`
    #[inline(always)]
    pub fn apply<N: Number, const G: usize>(
        self,
        slots: &mut [Slot<N, G>],
        notes: &mut [NotesOf<N>],
        (at, out): (usize, usize),
    ) {
        match self {
            Self::Neg => each!(slots, notes, (at => out), |a, _| a.neg()),
            Self::Recip => each!(slots, notes, (at => out), |a, n| a.recip(n)),
            Self::Square => each!(slots, notes, (at => out), |a, _| a.square()),
            Self::Powi(exponent) => each!(slots, notes, (at => out), |a, _| a.powi(exponent)),
            Self::Sqrt => each!(slots, notes, (at => out), |a, n| a.sqrt(n)),
            Self::Abs => each!(slots, notes, (at => out), |a, _| a.abs()),
            Self::Wave(Wave::Sin) => each!(slots, notes, (at => out), |a, _| a.wave(Wave::Sin)),
            Self::Wave(Wave::Cos) => each!(slots, notes, (at => out), |a, _| a.wave(Wave::Cos)),
            Self::Exp => each!(slots, notes, (at => out), |a, _| a.exp()),
            Self::Ln => each!(slots, notes, (at => out), |a, n| a.ln(n)),
            Self::Acos => each!(slots, notes, (at => out), |a, n| a.acos(n)),
            Self::Asin => each!(slots, notes, (at => out), |a, n| a.asin(n)),
            Self::Atan => each!(slots, notes, (at => out), |a, _| a.atan()),
            Self::Tan => each!(slots, notes, (at => out), |a, n| a.tan(n)),
            Self::Hyperbolic(f) => each!(slots, notes, (at => out), |a, _| a.hyperbolic(f)),
            Self::Cbrt => each!(slots, notes, (at => out), |a, _| a.cbrt()),
            Self::Step(step) => each!(slots, notes, (at => out), |a, n| a.step(step, n)),
            Self::Smoothstep => each!(slots, notes, (at => out), |a, _| a.smoothstep()),
            Self::Triangle => each!(slots, notes, (at => out), |a, _| a.triangle()),
        }
    }
}

impl Binary {
    /// `slots[out] = slots[a] op slots[b]`
    #[inline(always)]
    pub fn apply<N: Number, const G: usize>(
        self,
        slots: &mut [Slot<N, G>],
        notes: &mut [NotesOf<N>],
        (at, with, out): (usize, usize, usize),
    ) {
        match self {
            Self::Add => each!(slots, notes, (at, with => out), |a, b, _| a.add(b)),
            Self::Sub => each!(slots, notes, (at, with => out), |a, b, _| a.sub(b)),
            Self::Mul => each!(slots, notes, (at, with => out), |a, b, _| a.mul(b)),
            Self::Min => each!(slots, notes, (at, with => out), |a, b, _| a.min(b)),
            Self::Max => each!(slots, notes, (at, with => out), |a, b, _| a.max(b)),
            Self::Atan2 { lifted } => {
                each!(slots, notes, (at, with => out), |a, b, n| a.atan2(b, lifted, n));
            }
            Self::Harmonic { wave, n: times } => {
                each!(slots, notes, (at, with => out), |a, b, n| a.harmonic(b, wave, times, n));
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
        notes: &mut [NotesOf<N>],
        (at, out): (usize, usize),
        c: &Constant,
    ) {
        let value = N::constant(slots[at][0].token(), c);
        match self {
            Self::Add => each!(slots, notes, (at => out), |a, _| a.add_constant(c)),
            Self::Mul => each!(slots, notes, (at => out), |a, _| a.mul_constant(c)),
            Self::Min => each!(slots, notes, (at => out), |a, _| a.min(value)),
            Self::Max => each!(slots, notes, (at => out), |a, _| a.max(value)),
            _ => unreachable!("operands of {self:?} do not commute"),
        }
    }
}
