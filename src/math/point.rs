//! Points: a formula at one place a lane, rounded to nearest. NaN where it is undefined.

use super::{
    elementary,
    lanes::Lanes,
    number::{Constant, Hyperbolic, MaskOf, NotesOf, Number, Step, Token, Wave, splat_nearest},
};

/// A value at one point a lane.
#[derive(Clone, Copy, Debug)]
pub struct Point<L>(pub L);

impl<L: Lanes> Number for Point<L> {
    type Lanes = L;

    #[inline(always)]
    fn constant(token: Token<Self>, c: &Constant) -> Self {
        Self(splat_nearest(token, c.value))
    }
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self(self.0 + b.0)
    }
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self(self.0 - b.0)
    }
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Self(self.0 * b.0)
    }
    #[inline(always)]
    fn recip(self, _: &mut NotesOf<Self>) -> Self {
        Self(self.0.same(1.0) / self.0)
    }
    #[inline(always)]
    fn square(self) -> Self {
        Self(self.0 * self.0)
    }
    #[inline(always)]
    fn powi(self, n: u32) -> Self {
        Self(elementary::powi(self.0, n))
    }
    #[inline(always)]
    fn sqrt(self, _: &mut NotesOf<Self>) -> Self {
        Self(self.0.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        Self::choose(self, b, self, b)
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        Self::choose(self, b, b, self)
    }
    #[inline(always)]
    fn wave(self, wave: Wave) -> Self {
        Self(match wave {
            Wave::Sin => elementary::sin(self.0),
            Wave::Cos => elementary::cos(self.0),
        })
    }
    #[inline(always)]
    fn exp(self) -> Self {
        Self(elementary::exp(self.0))
    }
    #[inline(always)]
    fn ln(self, _: &mut NotesOf<Self>) -> Self {
        Self(elementary::ln(self.0))
    }
    #[inline(always)]
    fn acos(self, _: &mut NotesOf<Self>) -> Self {
        Self(elementary::acos(self.0))
    }
    #[inline(always)]
    fn asin(self, _: &mut NotesOf<Self>) -> Self {
        Self(elementary::asin(self.0))
    }
    #[inline(always)]
    fn atan(self) -> Self {
        Self(elementary::atan(self.0))
    }
    #[inline(always)]
    fn tan(self, _: &mut NotesOf<Self>) -> Self {
        Self(elementary::sin(self.0) / elementary::cos(self.0))
    }
    #[inline(always)]
    fn hyperbolic(self, function: Hyperbolic) -> Self {
        Self(match function {
            Hyperbolic::Sinh => elementary::sinh(self.0),
            Hyperbolic::Cosh => elementary::cosh(self.0),
            Hyperbolic::Tanh => elementary::tanh(self.0),
        })
    }
    #[inline(always)]
    fn cbrt(self) -> Self {
        Self(elementary::cbrt(self.0))
    }
    #[inline(always)]
    fn step(self, step: Step, _: &mut NotesOf<Self>) -> Self {
        Self(step_function(step, self.0))
    }
    #[inline(always)]
    fn smoothstep(self) -> Self {
        Self(smooth_step(self.0))
    }
    #[inline(always)]
    fn triangle(self) -> Self {
        Self(triangle_wave(self.0))
    }
    #[inline(always)]
    fn atan2(self, x: Self, _lifted: bool, _: &mut NotesOf<Self>) -> Self {
        Self(elementary::atan2(self.0, x.0))
    }
    #[inline(always)]
    fn harmonic(self, x: Self, wave: Wave, n: u32, _: &mut NotesOf<Self>) -> Self {
        let (y, x) = (self.0, x.0);
        let length = (x * x + y * y).sqrt();
        let (c, s) = complex_powi((x / length, y / length), n);
        Self(match wave {
            Wave::Sin => s,
            Wave::Cos => c,
        })
    }
    #[inline(always)]
    fn order(self, b: Self) -> (MaskOf<Self>, MaskOf<Self>) {
        (self.0.lt(b.0), b.0.lt(self.0))
    }
    #[inline(always)]
    fn token(self) -> Token<Self> {
        self.0.token()
    }
    #[inline(always)]
    fn abs_slope(self) -> Self {
        let negative = self.0.lt(self.0.same(0.0));
        Self(L::pick(negative, self.0.same(-1.0), self.0.same(1.0)))
    }
    #[inline(always)]
    fn triangle_slope(self) -> Self {
        let rises = (self.0 - self.0.floor()).lt(self.0.same(0.5));
        Self(L::pick(rises, self.0.same(1.0), self.0.same(-1.0)))
    }
    #[inline(always)]
    fn choose(a: Self, b: Self, p: Self, q: Self) -> Self {
        // Where a or b is NaN neither comparison holds, and the sum carries the NaN on.
        let undecided = Self(L::pick(b.0.le(a.0), q.0, a.0 + b.0));
        Self(L::pick(a.0.lt(b.0), p.0, undecided.0))
    }
}

/// The value of a function that jumps.
#[inline(always)]
pub(super) fn step_function<L: Lanes>(step: Step, v: L) -> L {
    match step {
        Step::Floor => v.floor(),
        Step::Ceil => -((-v).floor()),
        Step::Round => elementary::round_half_away(v),
        Step::Sign => elementary::sign(v),
    }
}

/// t²(3 − 2t) with t = v cut to [0, 1]; relative error 3 u.
#[inline(always)]
pub(super) fn smooth_step<L: Lanes>(v: L) -> L {
    let t = v.max(v.same(0.0)).min(v.same(1.0));
    let smooth = t * t * (v.same(3.0) - (t + t));
    L::pick(v.eq(v), smooth, v)
}

/// The distance to the nearest integer, without rounding: either v or the difference is 0 or not
/// below half of the other in size.
#[inline(always)]
pub(super) fn triangle_wave<L: Lanes>(v: L) -> L {
    (v - elementary::round_half_away(v)).abs()
}

/// The unit complex number (c, s) to the power n, at least 1.
#[inline(always)]
fn complex_powi<L: Lanes>(direction: (L, L), n: u32) -> (L, L) {
    let mut result = direction;
    for bit in (0..n.ilog2()).rev() {
        result = complex_product(result, result);
        if n >> bit & 1 == 1 {
            result = complex_product(result, direction);
        }
    }
    result
}

#[inline(always)]
fn complex_product<L: Lanes>(a: (L, L), b: (L, L)) -> (L, L) {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}
