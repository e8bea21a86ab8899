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

mod affine;
mod bounds;
mod brick;
mod bricks;
mod cells;
mod closer;
mod closer_points;
mod corners;
mod node;
mod normals;
mod on_demand;
mod open;
mod outline;
mod sampling;
mod schedule;
mod search;
mod shortened;
mod signs;
mod singular;

use std::sync::Arc;

use fearless_simd::{Simd, f32x16, f64x8};
use fixedbitset::FixedBitSet;

pub use bounds::{Extent, find_extent};
pub use brick::BRICK_LEVELS;
pub use cells::{BlockCells, Cell, CellBounds, CellGroup};
pub use on_demand::{BLOCK_LEVELS, BlockVoxels, FindVoxels, Octant, Wish, find_blocks, finder};
pub use open::{OpenBrick, OpenVoxels, open_voxels};
pub use outline::Outline;
pub use sampling::{FieldRange, sample_field};
pub use schedule::Schedule;
pub use search::Effort;
pub use singular::{SingularPlace, singular_places};

use crate::{
    Result,
    eval::BATCH,
    expr::{Expr, Tape},
    math::{Lanes, Lattice, SimdLevel, SimdTask},
    octree::{LevelMasks, MortonOctree, NodeState, Storage as _},
    progress::{Progress, Unwatched},
};
use corners::Corners;
use schedule::{Found, Watch};
use search::{Run, Search};

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

/// How to voxelize.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Instruction set.
    pub simd: SimdLevel,
    /// How work is shared out.
    pub schedule: Schedule,
    /// Whether gradients and values at corners are looked at, which drop voxels that the surface
    /// does not meet, and certify the others. The voxels depend on this alone.
    pub certify: bool,
    /// More voxels are an error.
    pub max_voxels: u32,
}

impl Default for Settings {
    fn default() -> Self {
        let (simd, schedule) = (SimdLevel::detect(), Schedule::default());
        Self { simd, schedule, certify: true, max_voxels: u32::MAX }
    }
}

/// Finds all voxels of `lattice` that the surface of `expr` may meet, with as many threads as the
/// current rayon pool has.
///
/// # Errors
/// [`crate::Error::Interrupted`] if `progress` says so; [`crate::Error::Limit`] as soon as there
/// are too many voxels.
pub fn voxelize(
    expr: &Expr,
    lattice: &Lattice,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Voxelization> {
    let precision = Precision::for_lattice(lattice);
    settings.simd.run(Task { tape: expr.tape(), lattice, precision, settings, progress })
}

/// From this resolution on it pays to ask a coarse lattice first how many voxels there will be.
const WORTH_ASKING: u32 = 1024;
/// The resolution of that lattice, at most.
const COARSE: u32 = 128;

/// How many voxels of `lattice` the surface of `expr` is expected to meet: four times as many for
/// each level as coarse voxels; 0 if the lattice is so small that finding them costs hardly more.
///
/// # Errors
/// As [`voxelize`].
pub fn expected_voxels(expr: &Expr, lattice: &Lattice, settings: &Settings) -> Result<u64> {
    let resolution = lattice.n_voxels().into_iter().max().unwrap_or(1);
    if resolution < WORTH_ASKING {
        return Ok(0);
    }
    let levels = resolution.div_ceil(COARSE).next_power_of_two().ilog2();
    let coarse = Lattice::new(lattice.bounds(), (resolution >> levels).max(1));
    let settings = Settings { max_voxels: u32::MAX, ..*settings };
    let found = voxelize(expr, &coarse, &settings, &Unwatched)?;
    Ok(u64::from(found.octree.voxel_count()) << (2 * levels))
}

struct Task<'a> {
    tape: Tape,
    lattice: &'a Lattice,
    precision: Precision,
    settings: &'a Settings,
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
        let Self { tape, lattice, precision, settings, progress } = self;
        let (corners, shared) = (Arc::new(Corners::new(lattice)), Arc::new(lattice.clone()));
        let certify = settings.certify;
        let new_search = || Search::<S, L, G>::new(simd, shared.clone(), corners.clone(), certify);
        let root = Run::root(Arc::new(tape));
        let frontier = frontier_level(lattice.depth());
        let watch = Watch::new(progress, settings.max_voxels);
        let found = match settings.schedule {
            Schedule::Stealing => schedule::stealing(new_search, root, frontier, &watch),
            Schedule::MasterSlave => {
                let n_slaves = rayon::current_num_threads();
                schedule::master_slave(new_search, root, frontier, n_slaves, &watch)
            }
        }?;
        let effort = found.effort.clone();
        let (mut octree, missing_normals) = assemble(found, frontier, lattice.depth());
        normals::fill_missing(&mut octree, &missing_normals, lattice);
        Ok(Voxelization { octree, effort, precision })
    }
}

/// Joins the trunk and the subtrees in Morton order; also returns the ranks of the voxels that
/// have no normal of their own.
fn assemble(found: Found, frontier: u32, depth: u32) -> (MortonOctree, Vec<u32>) {
    let Found { mut trunk, subtrees, .. } = found;
    let mut states: Vec<NodeState> = subtrees.iter().map(|subtree| subtree.root).collect();
    for level in trunk.iter_mut().rev() {
        states = level.settle(&states);
    }
    let root = states.first().copied().unwrap_or(NodeState::Empty);
    let mut levels = trunk;
    levels.resize_with(depth as usize, LevelMasks::default);
    let n_voxels = subtrees.iter().map(|s| s.normals.len()).sum();
    let mut normals = Vec::with_capacity(n_voxels);
    let mut certified = FixedBitSet::with_capacity(n_voxels);
    certified.insert_range(..);
    let mut missing = Vec::new();
    for mut subtree in subtrees {
        missing.extend(subtree.missing_normals.iter().map(|&i| i + normals.len() as u32));
        for &i in &subtree.candidates {
            certified.remove(normals.len() + i as usize);
        }
        normals.append(&mut subtree.normals);
        for (level, part) in levels[frontier as usize..].iter_mut().zip(subtree.levels) {
            level.append(part);
        }
    }
    (MortonOctree::new(root, levels, normals, certified), missing)
}
