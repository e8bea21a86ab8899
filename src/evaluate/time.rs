//! How long it takes to simplify samples and to extract an isosurface, beside plain Marching Cubes on
//! the same samples.
//!
//! Everything is timed with one thread, in turn, several times; medians count.
//!
//! *Based on:* A. León Salas, 2008, sections 3.6 and 3.7.

use std::{
    hint::black_box,
    time::{Duration, Instant},
};

use super::surface::octree;
use crate::{
    Error, Result,
    hrb::{Sample, Tolerance},
    mesh::{Border, Grid, Threshold, Voxels, extract, uniform},
    progress::Progress,
    volume::{Volume, with_samples},
};

/// Times as multiples of that of Marching Cubes on the samples.
#[derive(Clone, Copy, Debug)]
pub struct Times {
    /// When samples were joined.
    pub tolerance: Tolerance,
    /// Regions of the octree.
    pub n_regions: u64,
    /// Triangles of its surface.
    pub n_triangles: u64,
    /// From samples to the octree.
    pub simplify: f64,
    /// Finding which region answers for which dual cell.
    pub answer: f64,
    /// From the octree to triangles, with nodes without a part of the surface passed over.
    pub extract: f64,
    /// The same with nothing passed over: the thesis's condition.
    pub extract_all: f64,
}

/// All of a grid.
#[derive(Clone, Debug)]
pub struct OfGrid {
    /// One for each tolerance.
    pub times: Vec<Times>,
    /// Triangles of plain Marching Cubes.
    pub n_triangles: u64,
}

/// Times the octrees of a volume.
///
/// # Errors
/// [`Error::Limit`] if no thread can be started, [`Error::Interrupted`] if `progress` asks to stop.
pub(super) fn measure(
    volume: &Volume,
    isovalue: f64,
    tolerances: &[Tolerance],
    runs: u32,
    progress: &dyn Progress,
) -> Result<OfGrid> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.map_err(|error| Error::Limit(format!("cannot start a thread: {error}")))?;
    with_samples!(&volume.samples, |samples| {
        pool.install(|| of_samples(samples, volume.size, isovalue, tolerances, runs, progress))
    })
}

fn of_samples<T: Sample + Threshold>(
    samples: &[T],
    size: [u32; 3],
    isovalue: f64,
    tolerances: &[Tolerance],
    runs: u32,
    progress: &dyn Progress,
) -> Result<OfGrid> {
    let mut of_grid = Vec::new();
    let mut simplify = vec![Vec::new(); tolerances.len()];
    let mut answer = simplify.clone();
    let (mut extract, mut extract_all) = (simplify.clone(), simplify.clone());
    let mut times = Vec::new();
    let mut n_triangles = 0;
    // What is timed first pays for the machine's waking up.
    for run in 0..=runs {
        if progress.is_cancelled() {
            return Err(Error::Interrupted);
        }
        let is_first = run == 0;
        let times_each = if is_first { 1 } else { SAMPLES.div_ceil(samples.len()) as u32 };
        let (time, found) = timed(times_each, || uniform(samples, size, isovalue, Border::Open));
        n_triangles = found.triangles.len() as u64;
        if !is_first {
            of_grid.push(time);
        }
        drop(found);
        for (i, &tolerance) in tolerances.iter().enumerate() {
            let (to_simplify, mut tree) = timed(times_each, || octree(samples, size, tolerance));
            let (to_answer, ()) = timed(times_each, || tree.assign_corners());
            let (to_extract, n_triangles) =
                timed(times_each, || surface(&tree.grid(isovalue, Border::Open)));
            let (to_extract_all, _) =
                timed(times_each, || surface(&tree.whole_grid(isovalue, Border::Open)));
            if is_first {
                let n_regions = tree.storage().regions;
                times.push(Times {
                    tolerance,
                    n_regions,
                    n_triangles,
                    simplify: 0.0,
                    answer: 0.0,
                    extract: 0.0,
                    extract_all: 0.0,
                });
            } else {
                simplify[i].push(to_simplify);
                answer[i].push(to_answer);
                extract[i].push(to_extract);
                extract_all[i].push(to_extract_all);
            }
        }
    }
    let unit = median(&mut of_grid);
    for (i, times) in times.iter_mut().enumerate() {
        times.simplify = median(&mut simplify[i]) / unit;
        times.answer = median(&mut answer[i]) / unit;
        times.extract = median(&mut extract[i]) / unit;
        times.extract_all = median(&mut extract_all[i]) / unit;
    }
    Ok(OfGrid { times, n_triangles })
}

/// Makes what a mesh is: positions of the precision of files, and triangles. Counts these.
fn surface<B: Voxels>(grid: &Grid<B>) -> u64 {
    let found = black_box(extract(grid, |crossing| crossing.point().map(|x| x as f32)));
    found.triangles.len() as u64
}

/// The mean time of doing some work so many times, and what came of the last.
fn timed<R>(times: u32, mut work: impl FnMut() -> R) -> (Duration, R) {
    let start = Instant::now();
    for _ in 1..times {
        black_box(work());
    }
    let result = black_box(work());
    (start.elapsed() / times, result)
}

/// Work on fewer samples is done several times, so that a clock and other work matter less.
const SAMPLES: usize = 1 << 20;

/// In seconds.
fn median(times: &mut [Duration]) -> f64 {
    times.sort_unstable();
    times.get(times.len() / 2).map_or(f64::NAN, Duration::as_secs_f64)
}
