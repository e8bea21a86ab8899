//! Zeroset beside Fidget on the same functions, domains and resolution.
//!
//!     just bench-peers [part of a surface's name]...
//!     just bench-peers pictures [part of a surface's name]...
//!     just bench-peers meshes [part of a surface's name]...
//!
//! Tables for BENCHMARKS.md go to the standard output. For each surface the two programs are checked
//! to hold the same function, Fidget's best setting is looked for, and both take turns with one
//! thread and with two.
//!
//! The first compares the enumeration of all voxels that a surface may meet, with the gradient in
//! each. Zeroset's time includes scheduling its tape, and the octree and the unit normals that it
//! makes of what it finds; Fidget's begins when its function is ready, and makes nothing of what it
//! finds: see `enumeration`. The second compares pictures with Fidget's own renderer, the third meshes with
//! its mesher: see `pictures` and `meshes`.
//!
//! Both are built for the machine at hand: Fidget's intervals of sines and cosines gain up to a third.

#![expect(clippy::unwrap_used, reason = "a benchmark that cannot run has failed")]

mod agreement;
mod enumeration;
mod meshes;
mod pictures;
mod program;
mod report;
mod throughput;
mod timing;
mod tuning;
mod workloads;

use std::env;

use rayon::ThreadPool;
use zeroset::{
    math::Lattice,
    octree::Storage as _,
    progress::Unwatched,
    voxelize::{Settings, Voxelization, voxelize},
};

use report::Outcome;
use timing::{take_turns, time};
use tuning::Fidget;
use workloads::{RESOLUTION, Workload};

const THREADS: [usize; 2] = [1, 2];

/// Of so many threads.
type Pools = [ThreadPool; THREADS.len()];

fn main() {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let (verb, names) = match arguments.split_first() {
        Some((verb, names)) if ["pictures", "meshes"].contains(&verb.as_str()) => (&**verb, names),
        _ => ("", &*arguments),
    };
    let is_wanted = |workload: &Workload| {
        names.is_empty() || names.iter().any(|part| workload.name.contains(part))
    };
    let pools = THREADS.map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap());
    match verb {
        "pictures" => {
            let workloads = workloads::pictured().into_iter().filter(is_wanted);
            let pictured: Vec<_> = workloads.map(|w| pictures::measure(&w, &pools)).collect();
            report::print_pictures(&pictured);
        }
        "meshes" => {
            let workloads = workloads::meshed().into_iter().filter(is_wanted);
            let meshed: Vec<_> = workloads.map(|w| meshes::measure(&w, &pools)).collect();
            report::print_meshes(&meshed, THREADS);
        }
        _ => {
            let workloads = workloads::enumerated().into_iter().filter(is_wanted);
            let outcomes: Vec<_> = workloads.map(|w| measure(&w, &pools)).collect();
            report::print(&outcomes, THREADS);
        }
    }
}

fn measure(workload: &Workload, pools: &Pools) -> Outcome {
    let name = workload.name;
    eprintln!("{name}: comparing values");
    agreement::check(workload);
    eprintln!("{name}: looking for Fidget's best setting");
    let setting = tuning::best_setting(workload, &pools[0]);
    eprintln!("{name}: timing against {setting}");
    let lattice = workload.lattice(RESOLUTION);
    let fidget = Fidget::new(workload, &lattice);
    let ours =
        |pool: &ThreadPool, certify| pool.install(|| time(|| zeroset(workload, &lattice, certify)));
    let theirs = |pool: &ThreadPool| pool.install(|| time(|| fidget.run(setting)));
    let [a, b, c, d, e, f] = take_turns([
        &mut || ours(&pools[0], true),
        &mut || ours(&pools[0], false),
        &mut || theirs(&pools[0]),
        &mut || ours(&pools[1], true),
        &mut || ours(&pools[1], false),
        &mut || theirs(&pools[1]),
    ]);
    let [certified, by_values] = [true, false].map(|certify| zeroset(workload, &lattice, certify));
    let found = fidget.run(setting);
    let times = [[a, b, c], [d, e, f]];
    eprintln!("{name}: {}", report::summary(&times));
    Outcome {
        name,
        setting,
        times,
        n_boxes: [by_values.effort.boxes.iter().sum(), found.n_boxes],
        n_voxels: [certified.octree.voxel_count(), certified.octree.certified_count()],
        kept: agreement::compare(&by_values.octree, &found),
        throughput: throughput::measure(workload, &lattice, &fidget, &found),
    }
}

fn zeroset(workload: &Workload, lattice: &Lattice, certify: bool) -> Voxelization {
    let settings = Settings { certify, ..Settings::default() };
    voxelize(&workload.expr, lattice, &settings, &Unwatched).unwrap()
}
