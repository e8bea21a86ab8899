//! Fidget at its best: which evaluator suits a surface, and where shortening pays.

use std::{
    fmt,
    time::{Duration, Instant},
};

use fidget::{eval::Function, jit::JitFunction, vm::VmFunction};
use rayon::ThreadPool;
use zeroset::math::Lattice;

use crate::{
    enumeration::{Enumeration, Found},
    program::Shortening,
    timing::time,
    workloads::{RESOLUTION, Workload},
};

/// Fidget's evaluators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Engine {
    /// Machine code.
    Jit,
    /// An interpreter.
    Vm,
}

impl fmt::Display for Engine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Jit => "JIT",
            Self::Vm => "VM",
        })
    }
}

/// How Fidget is used.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    engine: Engine,
    shortening: Shortening,
}

/// Such as `JIT, shortened to 8³`.
impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.engine, self.shortening)
    }
}

/// A surface in both evaluators.
pub struct Fidget {
    /// F as machine code.
    pub jit: Enumeration<JitFunction>,
    /// F for the interpreter.
    pub vm: Enumeration<VmFunction>,
}

impl Fidget {
    /// Reads the function; this is not timed.
    pub fn new(workload: &Workload, lattice: &Lattice) -> Self {
        Self {
            jit: Enumeration::new(&workload.context, workload.root, lattice),
            vm: Enumeration::new(&workload.context, workload.root, lattice),
        }
    }

    /// Finds the voxels with the threads of the current pool.
    pub fn run(&self, setting: Setting) -> Found {
        match setting.engine {
            Engine::Jit => self.jit.run(setting.shortening),
            Engine::Vm => self.vm.run(setting.shortening),
        }
    }
}

/// Settings that are tried at the full resolution, and how often.
const FINALISTS: usize = 6;
const TRIALS: usize = 3;
/// No further trial begins after this time: what takes seconds is told apart by a single one.
const BUDGET: Duration = Duration::from_secs(20);

/// The setting that is fastest with one thread. All are tried at half the resolution, where voxels
/// look much the same to a tape, and the best of them at the full one.
pub fn best_setting(workload: &Workload, pool: &ThreadPool) -> Setting {
    let half = Fidget::new(workload, &workload.lattice(RESOLUTION / 2));
    let full = Fidget::new(workload, &workload.lattice(RESOLUTION));
    let measure = |fidget: &Fidget, setting| pool.install(|| time(|| fidget.run(setting)));
    let settings = settings(full.jit.function().can_simplify());
    best(settings, |setting| measure(&half, setting), |setting| measure(&full, setting))
}

/// The fastest of all settings: `glance` looks at each once, and `measure` at the best of them in
/// turn. A setting's least time counts, because whatever else the machine does can only add to it.
pub fn best<S: Copy>(
    mut settings: Vec<S>,
    glance: impl Fn(S) -> Duration,
    measure: impl Fn(S) -> Duration,
) -> S {
    settings.sort_by_cached_key(|&setting| glance(setting));
    settings.truncate(FINALISTS);
    let mut times = vec![Duration::MAX; settings.len()];
    let start = Instant::now();
    for trial in 0..TRIALS {
        if trial > 0 && start.elapsed() > BUDGET {
            break;
        }
        for (least, &setting) in times.iter_mut().zip(&settings) {
            *least = measure(setting).min(*least);
        }
    }
    settings.into_iter().zip(times).min_by_key(|&(_, time)| time).unwrap().0
}

/// All that are tried.
fn settings(can_simplify: bool) -> Vec<Setting> {
    let mut shortenings = vec![Shortening::NEVER];
    if can_simplify {
        for finest in 1..RESOLUTION.ilog2() {
            shortenings.extend([1, 2].map(|step| Shortening { finest, step }));
        }
    }
    let with = |engine| shortenings.iter().map(move |&shortening| Setting { engine, shortening });
    with(Engine::Jit).chain(with(Engine::Vm)).collect()
}
