//! How far vertices of an isosurface are from the surface that samples were taken of.
//!
//! E = (ν − f(X)) / |∇f(X)|, to first order the distance along the gradient: above 0 where the vertex
//! lies on the side of smaller values. The truth f is the formula, neither cut nor rounded, or the
//! trilinear interpolation of a finer grid, with gradients by central differences.
//!
//! *Based on:* A. León Salas, 2008, section 3.9.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::surface::Surface;
use crate::{eval::sampler, expr::Tape, math::SimdLevel, volume::Volume};

/// What samples were taken of.
#[derive(Clone, Copy, Debug)]
pub enum Truth<'a> {
    /// A density in scene coordinates.
    Formula(&'a Tape),
    /// A finer grid.
    Grid(&'a Volume),
}

/// The errors of all vertices of a surface.
#[derive(Clone, Debug)]
pub struct Errors {
    /// In voxels of the grid that was tested; NaN where there is no measure.
    pub signed: Vec<f64>,
    /// Vertices where samples differ so much more than the gradient explains that the truth jumps.
    pub n_at_jumps: u64,
    /// Vertices where the truth or its gradient is no number, or the gradient is 0.
    pub n_undefined: u64,
}

/// Samples differ by so many times the gradient where the truth jumps.
const JUMP: f64 = 8.0;

/// Vertices that a thread measures at a time.
const CHUNK: usize = 1 << 12;

impl Errors {
    /// Measures a surface at `isovalue`; lengths are counted in units of `voxel`.
    #[must_use]
    pub fn new(surface: &Surface, truth: Truth<'_>, isovalue: f64, voxel: f64) -> Self {
        let found: Vec<Vec<(f64, DVec3)>> =
            surface.positions.par_chunks(CHUNK).map(|points| truth.at(points)).collect();
        let mut errors = Self { signed: Vec::new(), n_at_jumps: 0, n_undefined: 0 };
        for ((value, gradient), &slope) in found.into_iter().flatten().zip(&surface.slopes) {
            let steepness = gradient.length();
            let error = (isovalue - value) / (steepness * voxel);
            let is_jump = matches!(truth, Truth::Formula(_)) && slope > JUMP * steepness;
            errors.n_undefined += u64::from(!error.is_finite());
            errors.n_at_jumps += u64::from(error.is_finite() && is_jump);
            errors.signed.push(if error.is_finite() && !is_jump { error } else { f64::NAN });
        }
        errors
    }

    /// Those that there is a measure of.
    pub fn measured(&self) -> impl Iterator<Item = f64> {
        self.signed.iter().copied().filter(|error| !error.is_nan())
    }

    /// Numbers that say most.
    #[must_use]
    pub fn summary(&self) -> Summary {
        let n = self.measured().count() as u64;
        let mean = |of: fn(f64) -> f64| self.measured().map(of).sum::<f64>() / n as f64;
        let mut sizes: Vec<f64> = self.measured().map(f64::abs).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        let quantile = |part: f64| {
            let i = (part * n as f64).ceil() as usize;
            sizes.get(i.saturating_sub(1)).copied().unwrap_or(f64::NAN)
        };
        Summary {
            n,
            mean: mean(f64::abs),
            signed_mean: mean(|error| error),
            median: quantile(0.5),
            most_of_all: quantile(0.99),
            largest: quantile(1.0),
        }
    }
}

/// Of the sizes of errors, in voxels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Vertices that were measured.
    pub n: u64,
    /// The mean size.
    pub mean: f64,
    /// The mean with signs.
    pub signed_mean: f64,
    /// Half of all are no larger.
    pub median: f64,
    /// 99 % are no larger.
    pub most_of_all: f64,
    /// None is larger.
    pub largest: f64,
}

impl Truth<'_> {
    /// Values and gradients at points, both in scene coordinates.
    fn at(self, points: &[DVec3]) -> Vec<(f64, DVec3)> {
        match self {
            Self::Formula(tape) => {
                let mut sampler = sampler(SimdLevel::detect());
                let values = sampler.values(tape, points);
                values.into_iter().zip(sampler.gradients(tape, points)).collect()
            }
            Self::Grid(volume) => {
                let to_grid = volume.placing.inverse();
                let turn: DMat3 = to_grid.matrix3.transpose();
                let at = |&point: &DVec3| {
                    let (value, gradient) = interpolated(volume, to_grid.transform_point3(point));
                    (value, turn * gradient)
                };
                points.iter().map(at).collect()
            }
        }
    }
}

/// The trilinear interpolation of samples at a point of the grid, and that of their central
/// differences.
fn interpolated(volume: &Volume, point: DVec3) -> (f64, DVec3) {
    let mut first = [0; 3];
    let mut part = [0.0; 3];
    for axis in 0..3 {
        let last = volume.size[axis] - 1;
        let at = (point[axis] - 0.5).clamp(0.0, f64::from(last));
        first[axis] = (at as u32).min(last.saturating_sub(1));
        part[axis] = at - f64::from(first[axis]);
    }
    let (mut value, mut gradient) = (0.0, DVec3::ZERO);
    for c in 0..8_u32 {
        let (mut p, mut weight) = (first, 1.0);
        for axis in 0..3 {
            let bit = c >> axis & 1;
            p[axis] = (first[axis] + bit).min(volume.size[axis] - 1);
            weight *= if bit == 1 { part[axis] } else { 1.0 - part[axis] };
        }
        value += weight * volume.value(p);
        gradient += weight * difference(volume, p);
    }
    (value, gradient)
}

/// Central differences at a sample; one-sided at the border.
fn difference(volume: &Volume, p: [u32; 3]) -> DVec3 {
    let along = |axis: usize| {
        let (mut lower, mut upper) = (p, p);
        lower[axis] = p[axis].saturating_sub(1);
        upper[axis] = (p[axis] + 1).min(volume.size[axis] - 1);
        let steps = upper[axis] - lower[axis];
        if steps == 0 {
            return 0.0;
        }
        (volume.value(upper) - volume.value(lower)) / f64::from(steps)
    };
    DVec3::new(along(0), along(1), along(2))
}
