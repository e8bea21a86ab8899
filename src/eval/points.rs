//! Values and gradients at points, in f64, 16 points a pass.

use fearless_simd::{Simd, f64x8};
use glam::DVec3;

use super::Machine;
use crate::{
    expr::Tape,
    math::{Constant, Dual, Lanes, Mask as _, Number, Point},
};

/// Points evaluated in one pass.
pub const POINT_BATCH: usize = 16;
const GROUPS: usize = POINT_BATCH / 8;

/// The coordinates of up to [`POINT_BATCH`] points, axis by axis.
pub type Points = [[f64; POINT_BATCH]; 3];

/// Up to [`POINT_BATCH`] points, axis by axis; the rest is 0.
#[must_use]
pub fn batch(some: &[DVec3]) -> Points {
    let mut batch: Points = [[0.0; POINT_BATCH]; 3];
    for (k, p) in some.iter().enumerate() {
        (0..3).for_each(|axis| batch[axis][k] = p[axis]);
    }
    batch
}

/// Evaluates tapes at points; NaN where the formula is undefined.
pub struct PointEvaluator<S: Simd> {
    simd: S,
    machine: Machine<Point<f64x8<S>>, GROUPS>,
    in_region: u64,
}

impl<S: Simd> PointEvaluator<S> {
    /// An evaluator for one instruction set.
    pub fn new(simd: S) -> Self {
        Self { simd, machine: Machine::default(), in_region: 0 }
    }

    /// Which of the last points lie in the tape's region, as bits; all if it has none.
    pub fn in_region(&self) -> u64 {
        self.in_region
    }

    /// The values of `tape` at `points`.
    pub fn eval(&mut self, tape: &Tape, points: &Points) -> [f64; POINT_BATCH] {
        let Self { simd, machine, in_region } = self;
        simd.vectorize(
            #[inline(always)]
            || {
                let mut inputs = [[Point(f64x8::splat(*simd, 0.0)); GROUPS]; 3];
                for axis in 0..3 {
                    for g in 0..GROUPS {
                        inputs[axis][g] = Point(f64x8::load(*simd, &points[axis][8 * g..]));
                    }
                }
                machine.run(*simd, tape, &inputs, false);
                let values = machine.slot(tape.result());
                let mut out = [0.0; POINT_BATCH];
                for (g, value) in values.iter().enumerate() {
                    value.0.store(&mut out[8 * g..]);
                }
                *in_region = u64::MAX;
                if let Some(slot) = tape.region() {
                    *in_region = 0;
                    for (g, value) in machine.slot(slot).iter().enumerate() {
                        *in_region |= value.0.le(value.0.same(0.0)).bits() << (8 * g);
                    }
                }
                out
            },
        )
    }
}

/// Evaluates the gradients of tapes at points; not finite where there is none.
pub struct GradientEvaluator<S: Simd> {
    simd: S,
    machine: Machine<Dual<Point<f64x8<S>>>, GROUPS>,
}

impl<S: Simd> GradientEvaluator<S> {
    /// An evaluator for one instruction set.
    pub fn new(simd: S) -> Self {
        Self { simd, machine: Machine::default() }
    }

    /// The gradients of `tape` at `points`, axis by axis.
    pub fn eval(&mut self, tape: &Tape, points: &Points) -> Points {
        let Self { simd, machine } = self;
        simd.vectorize(
            #[inline(always)]
            || {
                let zero = Dual::constant(*simd, &Constant::exact(0.0));
                let mut inputs = [[zero; GROUPS]; 3];
                for axis in 0..3 {
                    for g in 0..GROUPS {
                        let value = Point(f64x8::load(*simd, &points[axis][8 * g..]));
                        inputs[axis][g] = Dual::variable(value, axis);
                    }
                }
                machine.run(*simd, tape, &inputs, false);
                let values = machine.slot(tape.result());
                let mut out = [[0.0; POINT_BATCH]; 3];
                for (axis, partials) in out.iter_mut().enumerate() {
                    for (g, value) in values.iter().enumerate() {
                        value.gradient[axis].0.store(&mut partials[8 * g..]);
                    }
                }
                out
            },
        )
    }

    /// The same of length 1, or 0 where there is none or it has no direction.
    pub fn directions(&mut self, tape: &Tape, points: &Points) -> Points {
        let mut all = self.eval(tape, points);
        let Self { simd, .. } = self;
        simd.vectorize(
            #[inline(always)]
            || {
                for k in (0..POINT_BATCH).step_by(8) {
                    let mut gradient = [f64x8::splat(*simd, 0.0); 3];
                    for axis in 0..3 {
                        gradient[axis] = f64x8::load(*simd, &all[axis][k..]);
                    }
                    let direction = direction(gradient);
                    for axis in 0..3 {
                        direction[axis].store(&mut all[axis][k..]);
                    }
                }
            },
        );
        all
    }
}

/// A vector of length 1, without overflow on the way, or 0.
#[inline(always)]
fn direction<L: Lanes>([x, y, z]: [L; 3]) -> [L; 3] {
    let (zero, one) = (x.same(0.0), x.same(1.0));
    let largest = x.abs().max(y.abs()).max(z.abs());
    let most = x.same(f64::MAX);
    let is_finite = x.abs().le(most) & y.abs().le(most) & z.abs().le(most);
    let has_direction = is_finite & x.same(f64::MIN_POSITIVE).lt(largest);
    let (x, y, z) = (x / largest, y / largest, z / largest);
    let scale = one / (x * x + y * y + z * z).sqrt();
    [
        L::pick(has_direction, x * scale, zero),
        L::pick(has_direction, y * scale, zero),
        L::pick(has_direction, z * scale, zero),
    ]
}
