//! Parallel spatial enumeration: all voxels that a surface may meet, and no voxel lost.
//!
//! An octant is dropped only if interval arithmetic proves that F does not vanish there; the others
//! are cut into eight, down to voxels. A voxel's normal is the analytic gradient at its centre.
//!
//! The first levels are searched by one thread, down to a frontier that depends on the depth alone.
//! The subtrees of the frontier are searched by all threads, each by one, and collected in order,
//! so that the result does not depend on the number of threads or on who finished first.
//!
//! *Based on:* N. Stolte, A. Kaufman, "Parallel Spatial Enumeration of Implicit Surfaces using
//! Interval Arithmetic for Octree Generation and its Direct Visualization", 1998, sections 2 to 4.

mod bounds;
mod closer;
mod corners;
mod node;
mod normals;
mod sampling;
mod search;
mod shortened;
mod signs;

use std::sync::{
    Arc,
    atomic::{AtomicU64, Ordering},
};

use fearless_simd::{Simd, f32x16, f64x8};
use fixedbitset::FixedBitSet;
use rayon::prelude::*;

pub use bounds::{Extent, find_extent};
pub use sampling::{FieldRange, sample_field};
pub use search::Effort;

use crate::{
    Error, Result,
    eval::BATCH,
    expr::{Expr, Tape},
    math::{Lanes, Lattice, SimdLevel, SimdTask},
    octree::{LevelMasks, MortonOctree, NodeState},
    progress::Progress,
};
use corners::Corners;
use search::{Run, Search, Subtree};

/// What voxelization found, and what it cost.
#[derive(Clone, Debug)]
pub struct Voxelization {
    /// The voxels that the surface may meet.
    pub octree: MortonOctree,
    /// What it took.
    pub effort: Effort,
    /// The float type of the intervals.
    pub precision: Precision,
}

/// The float type of the intervals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// f32, where a voxel is far larger than the spacing of f32 numbers in the domain.
    Single,
    /// f64, beyond.
    Double,
}

impl Precision {
    /// Chooses by how many f32 numbers an edge of a voxel holds at least: 1024 leave the rounding
    /// of a formula of ordinary length invisible.
    #[must_use]
    pub fn for_lattice(lattice: &Lattice) -> Self {
        let bounds = lattice.bounds();
        let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
        let spacing = largest * f64::from(f32::EPSILON);
        if lattice.voxel_size() >= 1024.0 * spacing { Self::Single } else { Self::Double }
    }

    /// Such as `f32`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "f32",
            Self::Double => "f64",
        }
    }
}

/// Finds all voxels of `lattice` that the surface of `expr` may meet. Uses the threads of the
/// current rayon pool.
///
/// # Errors
/// [`Error::Interrupted`] if `progress` says so; [`Error::Limit`] as soon as there are more than
/// `max_voxels` voxels.
pub fn voxelize(
    expr: &Expr,
    lattice: &Lattice,
    simd: SimdLevel,
    max_voxels: u32,
    progress: &dyn Progress,
) -> Result<Voxelization> {
    let precision = Precision::for_lattice(lattice);
    simd.run(Task { tape: expr.tape(), lattice, precision, max_voxels, progress })
}

struct Task<'a> {
    tape: Tape,
    lattice: &'a Lattice,
    precision: Precision,
    max_voxels: u32,
    progress: &'a dyn Progress,
}

impl SimdTask for Task<'_> {
    type Output = Result<Voxelization>;

    fn run<S: Simd>(self, simd: S) -> Self::Output {
        match self.precision {
            Precision::Single => self.search::<S, f32x16<S>, { BATCH / 16 }>(simd),
            Precision::Double => self.search::<S, f64x8<S>, { BATCH / 8 }>(simd),
        }
    }
}

/// The frontier's level for an octree of this depth. Subtrees of 32³ voxels are small enough to
/// share out evenly and large enough to fill batches; beyond 64³ of them they grow.
fn frontier_level(depth: u32) -> u32 {
    depth.saturating_sub(5).min(6)
}

impl Task<'_> {
    fn search<S: Simd, L: Lanes<Token = S>, const G: usize>(self, simd: S) -> Result<Voxelization> {
        let Self { tape, lattice, precision, max_voxels, progress } = self;
        let corners = Corners::<L::Scalar>::new(lattice);
        let new_search = || Search::<S, L, G>::new(simd, lattice, &corners);
        let frontier = frontier_level(lattice.depth());

        let mut trunk = new_search();
        let runs = trunk.descend(Run::root(Arc::new(tape)), frontier);
        let tasks: Vec<Run> = runs.into_iter().flat_map(Run::into_single_nodes).collect();

        progress.begin("voxelize", tasks.len() as u64, "subtrees");
        let n_voxels = AtomicU64::new(0);
        let subtrees: Result<Vec<Subtree>> = tasks
            .into_par_iter()
            .map_init(new_search, |search, run| {
                if progress.is_cancelled() {
                    return Err(Error::Interrupted);
                }
                let subtree = search.subtree(run, frontier);
                progress.advance(1);
                let found = subtree.normals.len() as u64;
                let found = n_voxels.fetch_add(found, Ordering::Relaxed) + found;
                if found > u64::from(max_voxels) {
                    return Err(too_many(max_voxels));
                }
                Ok(subtree)
            })
            .collect();
        let subtrees = subtrees?;
        progress.end();

        let mut effort = trunk.take_effort();
        subtrees.iter().for_each(|subtree| effort.add(&subtree.effort));
        let (mut octree, missing_normals) =
            assemble(trunk.take_masks(), subtrees, frontier, lattice.depth());
        normals::fill_missing(&mut octree, &missing_normals, lattice);
        Ok(Voxelization { octree, effort, precision })
    }
}

fn too_many(max_voxels: u32) -> Error {
    Error::Limit(format!(
        "there are more than {max_voxels} voxels, which is what the memory holds; lower \
         `resolution` in [voxels]"
    ))
}

/// Joins the trunk and the subtrees in Morton order; also returns the ranks of the voxels that
/// have no normal of their own.
fn assemble(
    mut trunk: Vec<LevelMasks>,
    subtrees: Vec<Subtree>,
    frontier: u32,
    depth: u32,
) -> (MortonOctree, Vec<u32>) {
    let mut states: Vec<NodeState> = subtrees.iter().map(|subtree| subtree.root).collect();
    trunk.truncate(frontier as usize);
    for level in trunk.iter_mut().rev() {
        states = level.settle(&states);
    }
    let root = states.first().copied().unwrap_or(NodeState::Empty);
    let mut levels = trunk;
    levels.resize_with(depth as usize, LevelMasks::default);
    let n_voxels = subtrees.iter().map(|s| s.normals.len()).sum();
    let mut normals = Vec::with_capacity(n_voxels);
    let mut certified = FixedBitSet::with_capacity(n_voxels);
    let mut missing = Vec::new();
    for mut subtree in subtrees {
        missing.extend(subtree.missing_normals.iter().map(|&i| i + normals.len() as u32));
        for (i, &is_certified) in subtree.certified.iter().enumerate() {
            certified.set(normals.len() + i, is_certified);
        }
        normals.append(&mut subtree.normals);
        for (level, part) in levels[frontier as usize..].iter_mut().zip(subtree.levels) {
            level.append(part);
        }
    }
    (MortonOctree::new(root, levels, normals, certified), missing)
}
