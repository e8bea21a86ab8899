//! A value with its gradient: forward-mode differentiation over any [`Number`].
//!
//! Over points this gives normals; over intervals it gives enclosures of the gradient on a box,
//! with generalised gradients (the hull of both sides) at the kinks of abs, min and max.
//!
//! *Based on:* L. Rall, "Automatic Differentiation: Techniques and Applications", 1981.

use super::number::{Constant, Hyperbolic, MaskOf, Notes, NotesOf, Number, Step, Token, Wave};

/// A value and its partial derivatives with respect to x, y and z.
#[derive(Clone, Copy, Debug)]
pub struct Dual<N> {
    /// The value.
    pub value: N,
    /// The partial derivatives.
    pub gradient: [N; 3],
}

impl<N: Number> Dual<N> {
    /// The coordinate `axis` (0, 1 or 2) with the given value.
    #[inline(always)]
    pub fn variable(value: N, axis: usize) -> Self {
        let token = value.token();
        let mut gradient = [N::constant(token, &Constant::exact(0.0)); 3];
        gradient[axis] = N::constant(token, &Constant::exact(1.0));
        Self { value, gradient }
    }

    /// The chain rule: `value` with derivative `slope` with respect to `self`.
    #[inline(always)]
    fn chain(self, value: N, slope: N) -> Self {
        let [x, y, z] = self.gradient;
        Self { value, gradient: [x.mul(slope), y.mul(slope), z.mul(slope)] }
    }

    #[inline(always)]
    fn zip(self, b: Self, value: N, f: impl Fn(N, N) -> N) -> Self {
        let ([ax, ay, az], [bx, by, bz]) = (self.gradient, b.gradient);
        Self { value, gradient: [f(ax, bx), f(ay, by), f(az, bz)] }
    }

    /// The gradient of the angle of (x, y), y being `self`: (x dy − y dx) / (x² + y²).
    #[inline(always)]
    fn angle_gradient(self, x: Self) -> [N; 3] {
        let scale = recip_in_slope(self.value.square().add(x.value.square()));
        let (along_y, along_x) = (x.value.mul(scale), self.value.mul(scale));
        let turn = self.zip(
            x,
            scale,
            #[inline(always)]
            |dy, dx| dy.mul(along_y).sub(dx.mul(along_x)),
        );
        turn.gradient
    }
}

/// 1 / v as a factor of a derivative. Where that is undefined the value itself may be defined and
/// continuous: the slope is unbounded there, which its interval says, and nothing is noted.
#[inline(always)]
fn recip_in_slope<N: Number>(v: N) -> N {
    v.recip(&mut Notes::clear::<N::Lanes>(v.token()))
}

/// The derivative of arcsin: 1 / √(1 − v²).
#[inline(always)]
fn arc_slope<N: Number>(v: N) -> N {
    let mut of_slope = Notes::clear::<N::Lanes>(v.token());
    let cosine = v.square().neg().add_constant(&Constant::exact(1.0)).sqrt(&mut of_slope);
    recip_in_slope(cosine)
}

impl<N: Number> Number for Dual<N> {
    type Lanes = N::Lanes;

    #[inline(always)]
    fn constant(token: Token<Self>, c: &Constant) -> Self {
        let zero = N::constant(token, &Constant::exact(0.0));
        Self { value: N::constant(token, c), gradient: [zero; 3] }
    }
    #[inline(always)]
    fn neg(self) -> Self {
        let [x, y, z] = self.gradient;
        Self { value: self.value.neg(), gradient: [x.neg(), y.neg(), z.neg()] }
    }
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        self.zip(
            b,
            self.value.add(b.value),
            #[inline(always)]
            |da, db| da.add(db),
        )
    }
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        self.zip(
            b,
            self.value.sub(b.value),
            #[inline(always)]
            |da, db| da.sub(db),
        )
    }
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        let product = self.value.mul(b.value);
        self.zip(
            b,
            product,
            #[inline(always)]
            |da, db| da.mul(b.value).add(db.mul(self.value)),
        )
    }
    #[inline(always)]
    fn add_constant(self, c: &Constant) -> Self {
        Self { value: self.value.add_constant(c), gradient: self.gradient }
    }
    #[inline(always)]
    fn mul_constant(self, c: &Constant) -> Self {
        let [x, y, z] = self.gradient;
        let gradient = [x.mul_constant(c), y.mul_constant(c), z.mul_constant(c)];
        Self { value: self.value.mul_constant(c), gradient }
    }
    #[inline(always)]
    fn recip(self, notes: &mut NotesOf<Self>) -> Self {
        let inverse = self.value.recip(notes);
        self.chain(inverse, inverse.square().neg())
    }
    #[inline(always)]
    fn square(self) -> Self {
        self.chain(self.value.square(), self.value.add(self.value))
    }
    #[inline(always)]
    fn powi(self, n: u32) -> Self {
        if n == 1 {
            return self;
        }
        let slope = self.value.powi(n - 1).mul_constant(&Constant::exact(f64::from(n)));
        self.chain(self.value.powi(n), slope)
    }
    #[inline(always)]
    fn sqrt(self, notes: &mut NotesOf<Self>) -> Self {
        let root = self.value.sqrt(notes);
        self.chain(root, recip_in_slope(root.add(root)))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.chain(self.value.abs(), self.value.abs_slope())
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        let value = self.value.min(b.value);
        self.zip(
            b,
            value,
            #[inline(always)]
            |da, db| N::choose(self.value, b.value, da, db),
        )
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        let value = self.value.max(b.value);
        self.zip(
            b,
            value,
            #[inline(always)]
            |da, db| N::choose(self.value, b.value, db, da),
        )
    }
    #[inline(always)]
    fn wave(self, wave: Wave) -> Self {
        let slope = match wave {
            Wave::Sin => self.value.wave(Wave::Cos),
            Wave::Cos => self.value.wave(Wave::Sin).neg(),
        };
        self.chain(self.value.wave(wave), slope)
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let e = self.value.exp();
        self.chain(e, e)
    }
    #[inline(always)]
    fn ln(self, notes: &mut NotesOf<Self>) -> Self {
        let value = self.value.ln(notes);
        self.chain(value, recip_in_slope(self.value))
    }
    #[inline(always)]
    fn acos(self, notes: &mut NotesOf<Self>) -> Self {
        let value = self.value.acos(notes);
        let slope = arc_slope(self.value);
        self.chain(value, slope.neg())
    }
    #[inline(always)]
    fn asin(self, notes: &mut NotesOf<Self>) -> Self {
        let value = self.value.asin(notes);
        let slope = arc_slope(self.value);
        self.chain(value, slope)
    }
    #[inline(always)]
    fn atan(self) -> Self {
        let slope = recip_in_slope(self.value.square().add_constant(&Constant::exact(1.0)));
        self.chain(self.value.atan(), slope)
    }
    #[inline(always)]
    fn tan(self, notes: &mut NotesOf<Self>) -> Self {
        let value = self.value.tan(notes);
        self.chain(value, value.square().add_constant(&Constant::exact(1.0)))
    }
    #[inline(always)]
    fn hyperbolic(self, function: Hyperbolic) -> Self {
        let value = self.value.hyperbolic(function);
        let slope = match function {
            Hyperbolic::Sinh => self.value.hyperbolic(Hyperbolic::Cosh),
            Hyperbolic::Cosh => self.value.hyperbolic(Hyperbolic::Sinh),
            Hyperbolic::Tanh => value.square().neg().add_constant(&Constant::exact(1.0)),
        };
        self.chain(value, slope)
    }
    #[inline(always)]
    fn cbrt(self) -> Self {
        let root = self.value.cbrt();
        let slope = recip_in_slope(root.square().mul_constant(&Constant::exact(3.0)));
        self.chain(root, slope)
    }
    #[inline(always)]
    fn step(self, step: Step, notes: &mut NotesOf<Self>) -> Self {
        // Between the jumps; a jump itself is noted.
        let zero = N::constant(self.token(), &Constant::exact(0.0));
        Self { value: self.value.step(step, notes), gradient: [zero; 3] }
    }
    #[inline(always)]
    fn smoothstep(self) -> Self {
        // 6 t (1 − t) = 3/2 − 6 (t − 1/2)²
        let token = self.token();
        let [zero, one] = [0.0, 1.0].map(|v| N::constant(token, &Constant::exact(v)));
        let t = self.value.max(zero).min(one);
        let from_middle = t.add_constant(&Constant::exact(-0.5)).square();
        let slope = from_middle.mul_constant(&Constant::exact(-6.0));
        self.chain(self.value.smoothstep(), slope.add_constant(&Constant::exact(1.5)))
    }
    #[inline(always)]
    fn triangle(self) -> Self {
        self.chain(self.value.triangle(), self.value.triangle_slope())
    }
    #[inline(always)]
    fn atan2(self, x: Self, lifted: bool, notes: &mut NotesOf<Self>) -> Self {
        let value = self.value.atan2(x.value, lifted, notes);
        Self { value, gradient: self.angle_gradient(x) }
    }
    #[inline(always)]
    fn harmonic(self, x: Self, wave: Wave, n: u32, notes: &mut NotesOf<Self>) -> Self {
        let value = self.value.harmonic(x.value, wave, n, notes);
        let slope = match wave {
            Wave::Sin => self.value.harmonic(x.value, Wave::Cos, n, notes),
            Wave::Cos => self.value.harmonic(x.value, Wave::Sin, n, notes).neg(),
        };
        let slope = slope.mul_constant(&Constant::exact(f64::from(n)));
        Self { value, gradient: self.angle_gradient(x) }.chain(value, slope)
    }
    #[inline(always)]
    fn order(self, b: Self) -> (MaskOf<Self>, MaskOf<Self>) {
        self.value.order(b.value)
    }
    #[inline(always)]
    fn token(self) -> Token<Self> {
        self.value.token()
    }
    #[inline(always)]
    fn abs_slope(self) -> Self {
        let slope = self.value.abs_slope();
        let zero = N::constant(self.token(), &Constant::exact(0.0));
        Self { value: slope, gradient: [zero; 3] }
    }
    #[inline(always)]
    fn triangle_slope(self) -> Self {
        let slope = self.value.triangle_slope();
        let zero = N::constant(self.token(), &Constant::exact(0.0));
        Self { value: slope, gradient: [zero; 3] }
    }
    #[inline(always)]
    fn choose(a: Self, b: Self, p: Self, q: Self) -> Self {
        let value = N::choose(a.value, b.value, p.value, q.value);
        p.zip(
            q,
            value,
            #[inline(always)]
            |p, q| N::choose(a.value, b.value, p, q),
        )
    }
}
