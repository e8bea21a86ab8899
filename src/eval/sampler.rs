//! Values and gradients at any number of points, whatever the instruction set.

use fearless_simd::Simd;
use glam::DVec3;

use super::{GradientEvaluator, POINT_BATCH, PointEvaluator, Segment, batch, roots::RootFinder};
use crate::{
    expr::Tape,
    math::{SimdLevel, SimdTask},
};

/// Evaluates tapes at points; a thread's own.
pub trait Sample: Send {
    /// The values of `tape`; NaN where it is undefined.
    fn values(&mut self, tape: &Tape, points: &[DVec3]) -> Vec<f64>;

    /// The gradients of `tape`; not finite where there is none.
    fn gradients(&mut self, tape: &Tape, points: &[DVec3]) -> Vec<DVec3>;

    /// The gradients of `tape`, of length 1; 0 where there is none or it has no direction.
    fn directions(&mut self, tape: &Tape, points: &[DVec3]) -> Vec<DVec3>;

    /// Parts of segments at which `tape` is 0, each found to `precision`; where it is undefined, the part
    /// that was looked at last.
    fn roots(&mut self, tape: &Tape, segments: &[Segment], precision: f64) -> Vec<f64>;

    /// Whether each point lies in the tape's region; all do if it has none.
    fn are_in_region(&mut self, tape: &Tape, points: &[DVec3]) -> Vec<bool>;
}

/// A sampler for the instruction set.
#[must_use]
pub fn sampler(simd: SimdLevel) -> Box<dyn Sample> {
    struct New;
    impl SimdTask for New {
        type Output = Box<dyn Sample>;

        fn run<S: Simd>(self, simd: S) -> Box<dyn Sample> {
            let (values, gradients) = (PointEvaluator::new(simd), GradientEvaluator::new(simd));
            Box::new(Sampler { simd, values, gradients, roots: RootFinder::default() })
        }
    }
    simd.run(New)
}

struct Sampler<S: Simd> {
    simd: S,
    values: PointEvaluator<S>,
    gradients: GradientEvaluator<S>,
    roots: RootFinder,
}

impl<S: Simd> Sample for Sampler<S> {
    fn values(&mut self, tape: &Tape, points: &[DVec3]) -> Vec<f64> {
        let mut values = Vec::with_capacity(points.len());
        for some in points.chunks(POINT_BATCH) {
            values.extend_from_slice(&self.values.eval(tape, &batch(some))[..some.len()]);
        }
        values
    }

    fn gradients(&mut self, tape: &Tape, points: &[DVec3]) -> Vec<DVec3> {
        let mut gradients = Vec::with_capacity(points.len());
        for some in points.chunks(POINT_BATCH) {
            let [x, y, z] = self.gradients.eval(tape, &batch(some));
            gradients.extend((0..some.len()).map(|k| DVec3::new(x[k], y[k], z[k])));
        }
        gradients
    }

    fn directions(&mut self, tape: &Tape, points: &[DVec3]) -> Vec<DVec3> {
        let mut directions = Vec::with_capacity(points.len());
        for some in points.chunks(POINT_BATCH) {
            let [x, y, z] = self.gradients.directions(tape, &batch(some));
            directions.extend((0..some.len()).map(|k| DVec3::new(x[k], y[k], z[k])));
        }
        directions
    }

    fn roots(&mut self, tape: &Tape, segments: &[Segment], precision: f64) -> Vec<f64> {
        self.roots.find(self.simd, &mut self.values, tape, segments, precision)
    }

    fn are_in_region(&mut self, tape: &Tape, points: &[DVec3]) -> Vec<bool> {
        let mut are_in = Vec::with_capacity(points.len());
        for some in points.chunks(POINT_BATCH) {
            self.values.eval(tape, &batch(some));
            let bits = self.values.in_region();
            are_in.extend((0..some.len()).map(|k| bits >> k & 1 == 1));
        }
        are_in
    }
}
