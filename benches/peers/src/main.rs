//! Zeroset beside Fidget: the enumeration of all voxels that a surface may meet, with the gradient
//! in each, on the same functions, domains and resolution.
//!
//!     just bench-peers [part of a surface's name]...
//!
//! Tables for BENCHMARKS.md go to the standard output. For each surface the two programs are checked
//! to hold the same function, Fidget's best setting is looked for, and both take turns with one
//! thread and with two. Zeroset's time includes scheduling its tape, and the octree and the unit
//! normals that it makes of what it finds; Fidget's begins when its function is ready, and makes
//! nothing of what it finds: see `enumeration`.
//!
//! Both are built for the machine at hand: Fidget's intervals of sines and cosines gain up to a third.

#![expect(clippy::unwrap_used, reason = "a benchmark that cannot run has failed")]

mod agreement;
mod enumeration;
mod program;
mod report;
mod throughput;
mod timing;
mod tuning;
mod vm;
mod workloads;

use std::env;

use rayon::ThreadPool;
use zeroset::{
    math::{Lattice, SimdLevel},
    progress::Unwatched,
    voxelize::{Voxelization, voxelize},
};

use report::Outcome;
use timing::{take_turns, time};
use tuning::Fidget;
use workloads::{RESOLUTION, Workload};

const THREADS: [usize; 2] = [1, 2];

fn main() {
    let wanted: Vec<String> = env::args().skip(1).collect();
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|part| name.contains(part));
    let pools = THREADS.map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap());
    let workloads = workloads::all().into_iter().filter(|workload| is_wanted(workload.name));
    let outcomes: Vec<Outcome> = workloads.map(|workload| measure(&workload, &pools)).collect();
    report::print(&outcomes, THREADS);
}

fn measure(workload: &Workload, pools: &[ThreadPool; 2]) -> Outcome {
    let name = workload.name;
    eprintln!("{name}: comparing values");
    agreement::check(workload);
    eprintln!("{name}: looking for Fidget's best setting");
    let setting = tuning::best_setting(workload, &pools[0]);
    eprintln!("{name}: timing against {setting}");
    let lattice = workload.lattice(RESOLUTION);
    let fidget = Fidget::new(workload, &lattice);
    let ours = |pool: &ThreadPool| pool.install(|| time(|| zeroset(workload, &lattice)));
    let theirs = |pool: &ThreadPool| pool.install(|| time(|| fidget.run(setting)));
    let [a, b, c, d] = take_turns([
        &mut || ours(&pools[0]),
        &mut || theirs(&pools[0]),
        &mut || ours(&pools[1]),
        &mut || theirs(&pools[1]),
    ]);
    let (voxelization, found) = (zeroset(workload, &lattice), fidget.run(setting));
    let times = [[a, b], [c, d]];
    eprintln!("{name}: {}", report::summary(&times));
    Outcome {
        name,
        setting,
        times,
        n_boxes: [voxelization.boxes_tested.iter().sum(), found.n_boxes],
        kept: agreement::compare(&voxelization.octree, &found),
        throughput: throughput::measure(workload, &lattice, &fidget, &found),
    }
}

fn zeroset(workload: &Workload, lattice: &Lattice) -> Voxelization {
    voxelize(&workload.expr, lattice, SimdLevel::detect(), u32::MAX, &Unwatched).unwrap()
}
