//! How well threads share the work: the paper's Table 1, for any scene.
//!
//! The *yield* of n threads is t₁ / (n tₙ): 1 if the work is done n times as fast. Threads also share
//! a machine, its memory and its clock, whatever the schedule is. So n runs of one thread each are
//! timed side by side as well: the *share* is the throughput of n threads on one run after the other,
//! as a part of that of n runs at once. What it lacks to 1 is what the schedule costs.
//!
//! *Based on:* N. Stolte, A. Kaufman, "Parallel Spatial Enumeration of Implicit Surfaces Using
//! Interval Arithmetic for Octree Generation and Its Direct Visualization", 1998, section 3 and
//! table 1.

use std::time::{Duration, Instant};

use crate::{
    Error, Result,
    math::Lattice,
    progress::{Progress, Unwatched},
    scene::Scene,
    voxelize::{Settings, voxelize},
};

/// The times of one number of threads, medians.
#[derive(Clone, Copy, Debug)]
pub struct Yield {
    /// Number of threads.
    pub threads: usize,
    /// Seconds of a run with so many threads.
    pub seconds: f64,
    /// t₁ / (n tₙ)
    pub plain: f64,
    /// The throughput as a part of that of n runs of one thread each, side by side.
    pub share: f64,
}

/// Times the voxelization of all surfaces of `scene` with each number of threads, `runs` times in
/// turn.
///
/// # Errors
/// [`Error::Limit`] if the threads cannot be started, [`Error::Interrupted`] if `progress` asks to
/// stop.
pub fn measure(
    scene: &Scene,
    lattice: &Lattice,
    threads: &[usize],
    runs: u32,
    progress: &dyn Progress,
) -> Result<Vec<Yield>> {
    let with_one = pool(1)?;
    let pools = threads.iter().map(|&n| pool(n)).collect::<Result<Vec<_>>>()?;
    let work = || find_all(scene, lattice);
    // What is measured first would pay for the machine's waking up.
    with_one.install(work)?;
    let mut single = Vec::new();
    let mut together = vec![Vec::new(); threads.len()];
    let mut apart = vec![Vec::new(); threads.len()];
    progress.begin("measure", u64::from(runs) * threads.len() as u64, "runs");
    for _ in 0..runs {
        single.push(time(|| with_one.install(work))?);
        for (i, (&n, pool)) in threads.iter().zip(&pools).enumerate() {
            if progress.is_cancelled() {
                return Err(Error::Interrupted);
            }
            together[i].push(time(|| pool.install(work))?);
            apart[i].push(time(|| side_by_side(n, work))?);
            progress.advance(1);
        }
    }
    progress.end();
    let alone = median(&mut single);
    let row = |(i, &threads): (usize, &usize)| {
        let (seconds, apart) = (median(&mut together[i]), median(&mut apart[i]));
        let n = threads as f64;
        Yield { threads, seconds, plain: alone / (n * seconds), share: apart / (n * seconds) }
    };
    Ok(threads.iter().enumerate().map(row).collect())
}

fn pool(n_threads: usize) -> Result<rayon::ThreadPool> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build();
    pool.map_err(|error| Error::Limit(format!("cannot start {n_threads} threads: {error}")))
}

fn find_all(scene: &Scene, lattice: &Lattice) -> Result<()> {
    let Scene { schedule, certify, .. } = *scene;
    let settings = Settings { schedule, certify, ..Settings::default() };
    scene
        .surfaces
        .iter()
        .try_for_each(|surface| voxelize(&surface.expr, lattice, &settings, &Unwatched).map(drop))
}

/// Does `work` in `n` pools of one thread each, all at once.
fn side_by_side(n: usize, work: impl Fn() -> Result<()> + Sync) -> Result<()> {
    let pools = (0..n).map(|_| pool(1)).collect::<Result<Vec<_>>>()?;
    std::thread::scope(|scope| {
        let runs: Vec<_> = pools.iter().map(|pool| scope.spawn(|| pool.install(&work))).collect();
        runs.into_iter()
            .try_for_each(|run| run.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    })
}

fn time(work: impl FnOnce() -> Result<()>) -> Result<Duration> {
    let start = Instant::now();
    work()?;
    Ok(start.elapsed())
}

/// In seconds.
fn median(times: &mut [Duration]) -> f64 {
    times.sort_unstable();
    times.get(times.len() / 2).map_or(0.0, Duration::as_secs_f64)
}
