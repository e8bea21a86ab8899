//! The property between samples: constant in regions, trilinear in cells, and blended between regions.
//!
//! *Based on:* A. León Salas, 2008, sections 2.2 and 2.5 (interpolation, and the error of HRB octrees
//! beside the trilinear interpolation of all samples).

use colorous::VIRIDIS;
use rayon::prelude::*;

use super::{cells::CellOctree, surface::octree};
use crate::{
    hrb::{Criterion, Sample, Tolerance},
    math::linear_from_srgb,
    raster::Frame,
    volume::{Volume, with_samples},
};

/// A value at every point, in samples from the volume's first corner.
type Property<'a> = Box<dyn Fn([f64; 3]) -> f64 + Sync + 'a>;

/// The ways to interpolate that are compared.
pub struct Properties<'a> {
    volume: &'a Volume,
    cells: CellOctree<'a>,
    /// Names, and what they stand for.
    pub all: [(&'static str, Property<'a>); 3],
    /// The trilinear interpolation of all samples.
    pub exact: Property<'a>,
}

/// How one way to interpolate differs from that of all samples.
#[derive(Clone, Copy, Debug)]
pub struct Difference {
    /// What it is called.
    pub name: &'static str,
    /// The largest difference at points of a lattice and at samples.
    pub largest: f64,
    /// The root of the mean square.
    pub rms: f64,
    /// The largest jump between neighbours.
    pub jump: f64,
}

/// Points along each axis in which differences are looked for.
const LATTICE: u32 = 48;

impl<'a> Properties<'a> {
    /// Samples that differ by `epsilon` at most are joined.
    #[must_use]
    pub fn new(volume: &'a Volume, epsilon: f64) -> Self {
        let tolerance = Tolerance { epsilon, criterion: Criterion::Range };
        let cells = CellOctree::build(volume, epsilon);
        let [zero_order, blended, exact] = with_samples!(&volume.samples, |samples| {
            let regions = octree(samples, volume.size, tolerance);
            let same = regions.clone();
            let all = octree(samples, volume.size, Tolerance::default());
            let last = volume.size.map(|n| n - 1);
            let constant: Property<'a> = Box::new(move |p: [f64; 3]| {
                let sample = [0, 1, 2].map(|axis| (p[axis].max(0.0) as u32).min(last[axis]));
                regions.region_at(sample).value.to_f64()
            });
            let blended: Property<'a> = Box::new(move |p| same.value_at(p));
            let exact: Property<'a> = Box::new(move |p| all.value_at(p));
            [constant, blended, exact]
        });
        let own = cells.clone();
        let trilinear: Property<'a> = Box::new(move |p| own.value_at(p));
        let all = [
            ("constant in regions", zero_order),
            ("trilinear in cells", trilinear),
            ("HRB", blended),
        ];
        Self { volume, cells, all, exact }
    }

    /// How each differs from the interpolation of all samples.
    #[must_use]
    pub fn differences(&self) -> Vec<Difference> {
        let size = self.volume.size;
        let n_samples: u32 = size.iter().product();
        let sample = |i: u32| {
            let p = [i % size[0], i / size[0] % size[1], i / size[0] / size[1]];
            p.map(|i| f64::from(i) + 0.5)
        };
        let point = |i: u32| {
            let p = [i % LATTICE, i / LATTICE % LATTICE, i / LATTICE / LATTICE];
            let place = |axis: usize| {
                let part = (f64::from(p[axis]) + 0.5) / f64::from(LATTICE);
                0.5 + part * f64::from(size[axis] - 1)
            };
            [0, 1, 2].map(place)
        };
        let difference = |(name, property): &(&'static str, Property<'a>)| {
            let differ = |p: [f64; 3]| (property(p) - (self.exact)(p)).abs();
            let finite = |difference: f64| if difference.is_nan() { 0.0 } else { difference };
            let at_samples = (0..n_samples)
                .into_par_iter()
                .map(|i| finite(differ(sample(i))))
                .reduce(|| 0.0, f64::max);
            let at_points: Vec<f64> =
                (0..LATTICE.pow(3)).into_par_iter().map(|i| finite(differ(point(i)))).collect();
            let squares: f64 = at_points.iter().map(|difference| difference * difference).sum();
            let jump = match *name {
                "constant in regions" => self.largest_step(property),
                "trilinear in cells" => self.cells.largest_jump(),
                _ => 0.0,
            };
            Difference {
                name,
                largest: at_points.iter().copied().fold(at_samples, f64::max),
                rms: (squares / at_points.len() as f64).sqrt(),
                jump,
            }
        };
        self.all.iter().map(difference).collect()
    }

    /// The largest difference between neighbouring samples.
    fn largest_step(&self, property: &Property<'a>) -> f64 {
        let [nx, ny, nz] = self.volume.size;
        let of_slice = |z: u32| {
            let mut largest = 0.0_f64;
            for y in 0..ny {
                for x in 0..nx {
                    let p = [x, y, z];
                    let own = property(p.map(|i| f64::from(i) + 0.5));
                    for axis in (0..3).filter(|&axis| p[axis] + 1 < self.volume.size[axis]) {
                        let mut next = p;
                        next[axis] += 1;
                        let step = (property(next.map(|i| f64::from(i) + 0.5)) - own).abs();
                        largest = largest.max(step);
                    }
                }
            }
            largest
        };
        (0..nz).into_par_iter().map(of_slice).reduce(|| 0.0, f64::max)
    }

    /// The slice across z in which samples change most, `width` pixels wide; the least and the largest
    /// sample have the first and the last colour.
    #[must_use]
    pub fn slice(&self, property: &Property<'a>, width: u32) -> Frame {
        let [nx, ny, _] = self.volume.size.map(f64::from);
        let height = ((f64::from(width) * ny / nx).round() as u32).max(1);
        let [low, high] = self.volume.range();
        let mut frame = Frame::filled(width, height, [0.0, 0.0, 0.0, 1.0]);
        let [_, z] = self.busiest();
        frame.rgba.par_iter_mut().enumerate().for_each(|(i, pixel)| {
            let (column, row) = (i as u32 % width, i as u32 / width);
            let x = (f64::from(column) + 0.5) / f64::from(width) * nx;
            let y = (1.0 - (f64::from(row) + 0.5) / f64::from(height)) * ny;
            let part = (property([x, y, z]) - low) / (high - low);
            let part = if part.is_nan() { 0.0 } else { part };
            let color = VIRIDIS.eval_continuous(part.clamp(0.0, 1.0));
            let of = |component: u8| linear_from_srgb(f64::from(component) / 255.0) as f32;
            *pixel = [of(color.r), of(color.g), of(color.b), 1.0];
        });
        frame
    }

    /// Values along the row of the slice in which samples change most.
    #[must_use]
    pub fn profile(&self, property: &Property<'a>) -> Vec<(f64, f64)> {
        let n = 8 * self.volume.size[0];
        let [y, z] = self.busiest();
        let at = |i: u32| {
            let x = (f64::from(i) + 0.5) / 8.0;
            (x, property([x, y, z]))
        };
        (0..n).map(at).filter(|(_, value)| value.is_finite()).collect()
    }

    /// The place in y and z of the row along x in the busiest slice in which samples change most.
    fn busiest(&self) -> [f64; 2] {
        let [nx, ny, nz] = self.volume.size;
        let change = |y: u32, z: u32| {
            let step = |x: u32| self.volume.value([x, y, z]) - self.volume.value([x - 1, y, z]);
            (1..nx).map(|x| step(x).abs()).filter(|step| step.is_finite()).sum::<f64>()
        };
        let of_slice = |z: u32| (0..ny).map(|y| change(y, z)).sum();
        // Of equal ones that in the middle.
        let most = |n: u32, of: &dyn Fn(u32) -> f64| {
            let key = |i: u32| (of(i), std::cmp::Reverse(i.abs_diff(n / 2)));
            (0..n).map(|i| (key(i), i)).fold(None, |best: Option<((f64, _), u32)>, next| match best
            {
                Some(best) if best.0 >= next.0 => Some(best),
                _ => Some(next),
            })
        };
        let z = most(nz, &of_slice).map_or(0, |(_, z)| z);
        let y = most(ny, &|y| change(y, z)).map_or(0, |(_, y)| y);
        [y, z].map(|i| f64::from(i) + 0.5)
    }
}
