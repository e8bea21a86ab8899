//! What a formula can be evaluated in.
//!
//! A [`Number`] is a value with all operations of the formula language: a point, an interval, or
//! either of them with its gradient. Formulas are evaluated by one machine, generic over this
//! trait, so that every kind of number sees the same program.

use super::lanes::{Lanes, Mask, Scalar};

/// A real constant: the nearest f64 and an enclosure of the true value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constant {
    /// Nearest f64.
    pub value: f64,
    /// Not above the true value.
    pub lo: f64,
    /// Not below the true value.
    pub hi: f64,
}

impl Constant {
    /// A constant that is an f64.
    #[must_use]
    pub const fn exact(value: f64) -> Self {
        Self { value, lo: value, hi: value }
    }

    /// A constant within half an ulp of an f64.
    #[must_use]
    pub fn rounded(value: f64) -> Self {
        Self { value, lo: value.next_down(), hi: value.next_up() }
    }

    /// The value, if it is known exactly.
    #[must_use]
    pub fn as_exact(&self) -> Option<f64> {
        (self.lo == self.hi).then_some(self.value)
    }

    /// The value, if it is exactly an integer small enough for an exponent or a harmonic.
    #[must_use]
    pub fn as_integer(&self) -> Option<i32> {
        self.as_exact().filter(|v| v.fract() == 0.0 && v.abs() <= 1e6).map(|v| v as i32)
    }
}

/// Which of the two circular functions of an angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Wave {
    /// sin
    Sin,
    /// cos
    Cos,
}

/// A function that is constant but for jumps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Step {
    /// The largest integer not above.
    Floor,
    /// The smallest integer not below.
    Ceil,
    /// The nearest integer, halves away from zero.
    Round,
    /// −1, 0 or 1.
    Sign,
}

/// A hyperbolic function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Hyperbolic {
    /// sinh
    Sinh,
    /// cosh
    Cosh,
    /// tanh
    Tanh,
}

/// What evaluation learnt about the boxes of one vector besides the values, per lane.
#[derive(Clone, Copy, Debug)]
pub struct Notes<M> {
    /// The formula is undefined everywhere in the box: it cannot meet a surface.
    pub undefined: M,
    /// The formula may be undefined in a part of the box, and not just on a surface such as a pole.
    pub partial: M,
    /// The formula was not shown to be defined and continuous everywhere in the box: a change of
    /// sign there proves nothing.
    pub discontinuous: M,
}

impl<M: Mask> Notes<M> {
    /// Nothing to note yet.
    #[inline(always)]
    pub fn clear<L: Lanes<Mask = M>>(token: L::Token) -> Self {
        let none = L::splat_mask(token, false);
        Self { undefined: none, partial: none, discontinuous: none }
    }
}

/// A value that formulas can be evaluated in; see the file's text.
pub trait Number: Copy + 'static {
    /// The vectors that it is made of.
    type Lanes: Lanes;

    /// The same constant in every lane.
    fn constant(token: Token<Self>, c: &Constant) -> Self;

    /// −a
    #[must_use]
    fn neg(self) -> Self;
    /// a + b
    #[must_use]
    fn add(self, b: Self) -> Self;
    /// a − b
    #[must_use]
    fn sub(self, b: Self) -> Self;
    /// a b
    #[must_use]
    fn mul(self, b: Self) -> Self;
    /// a + c
    #[inline(always)]
    #[must_use]
    fn add_constant(self, c: &Constant) -> Self {
        self.add(Self::constant(self.token(), c))
    }
    /// a c
    #[inline(always)]
    #[must_use]
    fn mul_constant(self, c: &Constant) -> Self {
        self.mul(Self::constant(self.token(), c))
    }
    /// 1 / a
    #[must_use]
    fn recip(self, notes: &mut NotesOf<Self>) -> Self;
    /// a²
    #[must_use]
    fn square(self) -> Self;
    /// aⁿ, n at least 1.
    #[must_use]
    fn powi(self, n: u32) -> Self;
    /// √a
    #[must_use]
    fn sqrt(self, notes: &mut NotesOf<Self>) -> Self;
    /// |a|
    #[must_use]
    fn abs(self) -> Self;
    /// The smaller of a and b.
    #[must_use]
    fn min(self, b: Self) -> Self;
    /// The larger of a and b.
    #[must_use]
    fn max(self, b: Self) -> Self;
    /// sin a or cos a.
    #[must_use]
    fn wave(self, wave: Wave) -> Self;
    /// eᵃ
    #[must_use]
    fn exp(self) -> Self;
    /// ln a, with ln 0 = −∞
    #[must_use]
    fn ln(self, notes: &mut NotesOf<Self>) -> Self;
    /// arccos a
    #[must_use]
    fn acos(self, notes: &mut NotesOf<Self>) -> Self;
    /// arcsin a
    #[must_use]
    fn asin(self, notes: &mut NotesOf<Self>) -> Self;
    /// arctan a
    #[must_use]
    fn atan(self) -> Self;
    /// tan a
    #[must_use]
    fn tan(self, notes: &mut NotesOf<Self>) -> Self;
    /// sinh a, cosh a or tanh a.
    #[must_use]
    fn hyperbolic(self, function: Hyperbolic) -> Self;
    /// The real cube root of a.
    #[must_use]
    fn cbrt(self) -> Self;
    /// A function that jumps.
    #[must_use]
    fn step(self, step: Step, notes: &mut NotesOf<Self>) -> Self;
    /// t²(3 − 2t) with t = a cut to [0, 1]: rises smoothly from 0 to 1.
    #[must_use]
    fn smoothstep(self) -> Self;
    /// The distance to the nearest integer, a wave of straight lines from 0 to 1/2.
    #[must_use]
    fn triangle(self) -> Self;
    /// The angle of (x, y) in [−π, π], y being `self`. Where `lifted`, the angle may leave that
    /// range by whole turns so that it is continuous across the cut: such a value may only reach
    /// functions of period 2π.
    #[must_use]
    fn atan2(self, x: Self, lifted: bool, notes: &mut NotesOf<Self>) -> Self;
    /// sin or cos of n times the angle of (x, y), y being `self`, n at least 1, without the angle.
    #[must_use]
    fn harmonic(self, x: Self, wave: Wave, n: u32, notes: &mut NotesOf<Self>) -> Self;

    /// The lanes where a lies wholly below b, and where b lies wholly below a: there min and max
    /// are decided for the whole box. For a point this is a comparison.
    fn order(self, b: Self) -> (MaskOf<Self>, MaskOf<Self>);
    /// The token of the vectors inside.
    fn token(self) -> Token<Self>;

    /// The derivative of |a|: −1, 1, or everything between where the sign is not decided.
    #[must_use]
    fn abs_slope(self) -> Self;
    /// The derivative of the distance to the nearest integer, likewise.
    #[must_use]
    fn triangle_slope(self) -> Self;
    /// `p` where a lies below b, `q` where above, the hull of both where neither is decided.
    #[must_use]
    fn choose(a: Self, b: Self, p: Self, q: Self) -> Self;
}

/// The token of a number's vectors.
pub type Token<N> = <<N as Number>::Lanes as Lanes>::Token;
/// The masks of a number's vectors.
pub type MaskOf<N> = <<N as Number>::Lanes as Lanes>::Mask;
/// The notes of a number's vectors.
pub type NotesOf<N> = Notes<MaskOf<N>>;
/// The scalars of a number's vectors.
pub type ScalarOf<N> = <<N as Number>::Lanes as Lanes>::Scalar;

/// Rounds a constant to the vectors' type, to nearest.
#[inline(always)]
pub(super) fn splat_nearest<L: Lanes>(token: L::Token, v: f64) -> L {
    L::splat(token, L::Scalar::nearest(v))
}
