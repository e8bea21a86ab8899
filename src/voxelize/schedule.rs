//! How the subtrees of the frontier are found and shared out among threads.
//!
//! *Stealing* is the default: one thread searches the trunk, and all threads take subtrees from
//! rayon's deques. Nobody owns the octree; every subtree is built by the thread that searches it.
//!
//! *Master and slaves* is the paper's scheme: a master holds a stack of octants and gives one at a
//! time to every slave that has none; a slave divides its octant and hands the children back
//! through a queue of eight slots with two indices, one for each side. Octants of the frontier are
//! searched whole by the slave, as voxels are in the paper.
//!
//! Both find the same trunk and the same subtrees, so the octree is the same.
//!
//! *Based on:* N. Stolte, A. Kaufman, "Parallel Spatial Enumeration of Implicit Surfaces Using
//! Interval Arithmetic for Octree Generation and Its Direct Visualization", 1998, section 3.

use std::{
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering},
    },
    thread::{self, Thread},
};

use fearless_simd::Simd;
use rayon::prelude::*;

use super::search::{Effort, Run, Search, Subtree};
use crate::{
    Error, Result,
    math::{Lanes, morton_encode},
    octree::LevelMasks,
    progress::Progress,
};

/// How work is shared out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Schedule {
    /// By work stealing over subtrees.
    #[default]
    Stealing,
    /// By a master that hands out octants, as in the paper.
    MasterSlave,
}

/// What a search found above the frontier and in the subtrees below, in Morton order.
pub(super) struct Found {
    /// The masks of the levels above the frontier.
    pub(super) trunk: Vec<LevelMasks>,
    pub(super) subtrees: Vec<Subtree>,
    pub(super) effort: Effort,
}

/// Counts voxels, and stops everybody if there are too many or the user wants to stop.
pub(super) struct Watch<'a> {
    pub(super) progress: &'a dyn Progress,
    pub(super) max_voxels: u32,
    n_voxels: AtomicU64,
}

impl<'a> Watch<'a> {
    pub(super) fn new(progress: &'a dyn Progress, max_voxels: u32) -> Self {
        Self { progress, max_voxels, n_voxels: AtomicU64::new(0) }
    }

    fn check(&self) -> Result<()> {
        if self.progress.is_cancelled() { Err(Error::Interrupted) } else { Ok(()) }
    }

    /// Adds the voxels of a subtree.
    pub(super) fn add(&self, found: u64) -> Result<()> {
        let found = self.n_voxels.fetch_add(found, Ordering::Relaxed) + found;
        if found > u64::from(self.max_voxels) {
            return Err(Error::Limit(format!(
                "there are more than {} voxels, which is what the memory holds; lower \
                 `resolution` in [voxels]",
                self.max_voxels
            )));
        }
        self.progress.advance(1);
        Ok(())
    }
}

/// Searches the trunk with one thread and the subtrees with all threads of the current pool.
pub(super) fn stealing<S: Simd, L: Lanes<Token = S>, const G: usize>(
    new_search: impl Fn() -> Search<S, L, G> + Send + Sync,
    root: Run,
    frontier: u32,
    watch: &Watch<'_>,
) -> Result<Found> {
    let find = |search: &mut Search<S, L, G>, run| {
        let subtree = search.subtree(run, frontier);
        watch.add(subtree.normals.len() as u64)?;
        Ok(subtree)
    };
    let (mut search, subtrees) = steal(new_search, root, frontier, watch, find)?;
    let mut effort = search.take_effort();
    subtrees.iter().for_each(|subtree| effort.add(&subtree.effort));
    let mut trunk = search.take_masks();
    trunk.truncate(frontier as usize);
    Ok(Found { trunk, subtrees, effort })
}

/// Searches the trunk with one thread, and does with every subtree what `find` says with all threads.
/// Returns the search of the trunk, and what was found in the subtrees in Morton order.
pub(super) fn steal<S: Simd, L: Lanes<Token = S>, const G: usize, T: Send>(
    new_search: impl Fn() -> Search<S, L, G> + Send + Sync,
    root: Run,
    frontier: u32,
    watch: &Watch<'_>,
    find: impl Fn(&mut Search<S, L, G>, Run) -> Result<T> + Send + Sync,
) -> Result<(Search<S, L, G>, Vec<T>)> {
    let mut trunk = new_search();
    let runs = trunk.descend(root, frontier);
    let tasks: Vec<Run> = runs.into_iter().flat_map(Run::into_single_nodes).collect();
    watch.progress.begin("voxelize", tasks.len() as u64, "subtrees");
    let find = |search: &mut Search<S, L, G>, run| {
        watch.check()?;
        find(search, run)
    };
    let found: Result<Vec<T>> = tasks.into_par_iter().map_init(new_search, find).collect();
    let found = found?;
    watch.progress.end();
    Ok((trunk, found))
}

/// An octant to work on: a run of a single node.
struct Octant {
    run: Run,
    level: u32,
    /// Its place among the octants of its level.
    code: u64,
}

impl Octant {
    fn new(run: Run, level: u32) -> Self {
        let code = run.places().next().map_or(0, morton_encode);
        Self { run, level, code }
    }
}

/// Slots of a queue: an octant has that many children.
const QUEUE_SLOTS: usize = 8;

/// The way from a slave to the master: only one writes, only the other reads.
#[derive(Default)]
struct Queue {
    slots: [Mutex<Option<Octant>>; QUEUE_SLOTS],
    /// Octants written so far.
    written: AtomicUsize,
    /// Octants read so far.
    read: AtomicUsize,
}

impl Queue {
    /// Waits for a free slot; false if `stop` is set before there is one.
    fn push(&self, octant: Octant, stop: &AtomicBool) -> bool {
        let written = self.written.load(Ordering::Relaxed);
        while written - self.read.load(Ordering::Acquire) == QUEUE_SLOTS {
            if stop.load(Ordering::Relaxed) {
                return false;
            }
            thread::yield_now();
        }
        *lock(&self.slots[written % QUEUE_SLOTS]) = Some(octant);
        self.written.store(written + 1, Ordering::Release);
        true
    }

    fn pop(&self) -> Option<Octant> {
        let read = self.read.load(Ordering::Relaxed);
        if read == self.written.load(Ordering::Acquire) {
            return None;
        }
        let octant = lock(&self.slots[read % QUEUE_SLOTS]).take();
        self.read.store(read + 1, Ordering::Release);
        octant
    }
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What master and slave share.
#[derive(Default)]
struct Desk {
    /// The octant that the slave is to work on next.
    work: Mutex<Option<Octant>>,
    /// Set by the master with the work, cleared by the slave when all children are in the queue.
    is_busy: AtomicBool,
    children: Queue,
}

/// What a slave has found.
#[derive(Default)]
struct Findings {
    /// Level, place, mixed children and inside children of the octants divided.
    divided: Vec<(u32, u64, u8, u8)>,
    subtrees: Vec<(u64, Subtree)>,
    effort: Option<Effort>,
}

/// Searches with a master, the calling thread, and `n_slaves` other threads.
pub(super) fn master_slave<S: Simd, L: Lanes<Token = S>, const G: usize>(
    new_search: impl Fn() -> Search<S, L, G> + Send + Sync,
    root: Run,
    frontier: u32,
    n_slaves: usize,
    watch: &Watch<'_>,
) -> Result<Found> {
    let desks: Vec<Desk> = (0..n_slaves.max(1)).map(|_| Desk::default()).collect();
    let stop = AtomicBool::new(false);
    let master = thread::current();
    let found: Result<Vec<Findings>> = thread::scope(|scope| {
        let slaves: Vec<_> = desks
            .iter()
            .map(|desk| {
                scope.spawn(|| {
                    let findings = slave(new_search(), desk, frontier, &master, &stop, watch);
                    // A slave that fails stops everybody; one that is done was stopped.
                    stop.store(true, Ordering::Relaxed);
                    master.unpark();
                    findings
                })
            })
            .collect();
        let threads: Vec<&Thread> = slaves.iter().map(|slave| slave.thread()).collect();
        direct(Octant::new(root, 0), &desks, &threads, &stop);
        stop.store(true, Ordering::Relaxed);
        threads.iter().for_each(|thread| thread.unpark());
        let join = |slave: thread::ScopedJoinHandle<'_, Result<Findings>>| {
            slave.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        };
        slaves.into_iter().map(join).collect()
    });
    Ok(merge(found?, frontier))
}

/// The master: hands out octants until there are none and nobody is busy.
fn direct(root: Octant, desks: &[Desk], slaves: &[&Thread], stop: &AtomicBool) {
    let mut stack = vec![root];
    while !stop.load(Ordering::Relaxed) {
        let mut all_idle = true;
        for (desk, slave) in desks.iter().zip(slaves) {
            // Busy or not is asked first: what an idle slave has found is all in its queue.
            let is_busy = desk.is_busy.load(Ordering::Acquire);
            stack.extend(std::iter::from_fn(|| desk.children.pop()));
            if is_busy {
                all_idle = false;
            } else if let Some(octant) = stack.pop() {
                *lock(&desk.work) = Some(octant);
                desk.is_busy.store(true, Ordering::Release);
                slave.unpark();
                all_idle = false;
            }
        }
        if all_idle && stack.is_empty() {
            return;
        }
        thread::park_timeout(std::time::Duration::from_millis(1));
    }
}

/// A slave: works on one octant after the other until it is stopped.
fn slave<S: Simd, L: Lanes<Token = S>, const G: usize>(
    mut search: Search<S, L, G>,
    desk: &Desk,
    frontier: u32,
    master: &Thread,
    stop: &AtomicBool,
    watch: &Watch<'_>,
) -> Result<Findings> {
    let mut findings = Findings::default();
    while !stop.load(Ordering::Relaxed) {
        let Some(Octant { run, level, code }) = lock(&desk.work).take() else {
            thread::park();
            continue;
        };
        watch.check()?;
        if level == frontier {
            let subtree = search.subtree(run, frontier);
            watch.add(subtree.normals.len() as u64)?;
            findings.subtrees.push((code, subtree));
        } else {
            let children = search.divide(run, level);
            for masks in &search.take_masks()[level as usize..=level as usize] {
                let octants = masks.mixed.iter().zip(&masks.inside);
                findings
                    .divided
                    .extend(octants.map(|(&mixed, &inside)| (level, code, mixed, inside)));
            }
            for run in children.into_iter().flat_map(Run::into_single_nodes) {
                if !desk.children.push(Octant::new(run, level + 1), stop) {
                    break;
                }
                master.unpark();
            }
        }
        desk.is_busy.store(false, Ordering::Release);
        master.unpark();
    }
    findings.effort = Some(search.take_effort());
    Ok(findings)
}

/// Puts what the slaves have found in order.
fn merge(all: Vec<Findings>, frontier: u32) -> Found {
    let (mut divided, mut subtrees, mut efforts) = (Vec::new(), Vec::new(), Vec::new());
    for findings in all {
        divided.extend(findings.divided);
        subtrees.extend(findings.subtrees);
        efforts.extend(findings.effort);
    }
    divided.sort_unstable();
    subtrees.sort_by_key(|&(code, _)| code);
    let mut trunk = vec![LevelMasks::default(); frontier as usize];
    for (level, _, mixed, inside) in divided {
        trunk[level as usize].push(mixed, inside);
    }
    let subtrees: Vec<Subtree> = subtrees.into_iter().map(|(_, subtree)| subtree).collect();
    let mut effort = efforts.pop().unwrap_or_default();
    efforts.iter().for_each(|other| effort.add(other));
    subtrees.iter().for_each(|subtree| effort.add(&subtree.effort));
    Found { trunk, subtrees, effort }
}
