//! What values F takes over the domain: for telling why nothing was found.

use std::fmt;

use fearless_simd::Simd;
use glam::DVec3;

use crate::{
    eval::{POINT_BATCH, PointEvaluator, Points},
    expr::{Expr, Tape},
    math::{Aabb, SimdLevel, SimdTask},
};

/// The values of F on a lattice of points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldRange {
    /// The smallest value and its place; nothing if F is undefined at every point.
    pub least: Option<(f64, DVec3)>,
    /// The largest value and its place.
    pub most: Option<(f64, DVec3)>,
    /// Points at which F is undefined or infinite.
    pub n_undefined: u32,
    /// Points in all.
    pub n_points: u32,
}

/// Points along each axis.
const POINTS: u32 = 33;

/// Evaluates F on 33³ points of the domain, its corners included.
#[must_use]
pub fn sample_field(expr: &Expr, domain: Aabb, simd: SimdLevel) -> FieldRange {
    simd.run(Task { tape: expr.tape(), domain })
}

struct Task {
    tape: Tape,
    domain: Aabb,
}

impl SimdTask for Task {
    type Output = FieldRange;

    fn run<S: Simd>(self, simd: S) -> FieldRange {
        let mut evaluator = PointEvaluator::new(simd);
        let n_points = POINTS * POINTS * POINTS;
        let mut range = FieldRange { least: None, most: None, n_undefined: 0, n_points };
        let step = self.domain.size() / f64::from(POINTS - 1);
        let point = |i: u32| {
            let index = [i % POINTS, i / POINTS % POINTS, i / (POINTS * POINTS)].map(f64::from);
            self.domain.min + DVec3::from_array(index) * step
        };
        for first in (0..n_points).step_by(POINT_BATCH) {
            let mut points: Points = [[0.0; POINT_BATCH]; 3];
            let lanes = (first..n_points).take(POINT_BATCH);
            for (lane, i) in lanes.clone().enumerate() {
                (0..3).for_each(|axis| points[axis][lane] = point(i)[axis]);
            }
            let values = evaluator.eval(&self.tape, &points);
            for (value, i) in values.into_iter().zip(lanes) {
                range.add(value, point(i));
            }
        }
        range
    }
}

impl FieldRange {
    fn add(&mut self, value: f64, place: DVec3) {
        if !value.is_finite() {
            self.n_undefined += 1;
            return;
        }
        if self.least.is_none_or(|(least, _)| value < least) {
            self.least = Some((value, place));
        }
        if self.most.is_none_or(|(most, _)| value > most) {
            self.most = Some((value, place));
        }
    }
}

/// Such as: F lies between 0.5 at (0, 0, 0) and 3 at (1, 1, 1) on 35937 points.
impl fmt::Display for FieldRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Some((least, at_least)), Some((most, at_most))) = (self.least, self.most) else {
            return write!(f, "F is undefined at all of {} points", self.n_points);
        };
        let place = |p: DVec3| format!("({:.4}, {:.4}, {:.4})", p.x, p.y, p.z);
        write!(
            f,
            "F lies between {least:.6} at {} and {most:.6} at {} on {} points",
            place(at_least),
            place(at_most),
            self.n_points
        )?;
        if self.n_undefined > 0 {
            write!(f, "; it is undefined at {} of them", self.n_undefined)?;
        }
        Ok(())
    }
}
