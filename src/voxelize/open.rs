//! Voxels that one look at each brick leaves open: a mesh needs no more.
//!
//! Where F is continuous it has one sign in every voxel that is not open, so that two neighbours whose
//! middles differ in sign are not both closed. Which of the open ones meet the surface the values in
//! their middles tell at less cost than intervals, corners and gradients of every voxel.
//!
//! Where F ends with negative values, the inside ends without a surface. Voxels there are not stored,
//! and a mesh has a piece of that end only where the stored ones reach it; so that it is the same,
//! they are certified then, all of them.

use std::sync::Arc;

use fearless_simd::{Simd, f32x16, f64x8};

use super::{
    Precision, Settings, Voxelization,
    brick::{BRICK_LEVELS, Brick, places},
    bricks::OpenVoxel,
    corners::Corners,
    frontier_level,
    schedule::{self, Watch},
    search::{Effort, Run, Search},
    voxelize,
};
use crate::{
    Result,
    eval::BATCH,
    expr::{Expr, Tape},
    math::{Lanes, Lattice, SimdTask, morton_encode},
    octree::{MortonOctree, Storage as _},
    progress::Progress,
};

/// A brick of 4³ voxels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OpenBrick {
    /// Its first voxel.
    pub first: [u32; 3],
    /// The voxels that the surface may meet, in Morton order.
    pub voxels: u64,
}

impl OpenBrick {
    /// Voxels along an edge.
    pub const EDGE: u32 = super::brick::BRICK_EDGE;

    /// Those of slice `z`, below [`OpenBrick::EDGE`], as bits x + 8y.
    #[must_use]
    pub fn slice(&self, z: u32) -> u64 {
        // Two rows of two voxels in each byte, of which the next one is beside it, and the two after
        // that are behind.
        let octants = self.voxels >> (32 * (z / 2) + 4 * (z % 2));
        let beside = |rows: u64| rows & 0x0003_0003 | rows >> 6 & 0x000c_000c;
        beside(octants & 0x0303_0303) | beside(octants >> 2 & 0x0303_0303) << 8
    }
}

/// What was found, and what it took.
#[derive(Clone, Debug, Default)]
pub struct OpenVoxels {
    /// Bricks with open voxels, in Morton order.
    pub bricks: Vec<OpenBrick>,
    /// What it took.
    pub effort: Effort,
    /// Whether F may end in some voxel, not positive.
    pub(super) meets_end: bool,
}

/// Finds the voxels of `lattice` that bounds of the formula over bricks leave open, among them all that
/// [`super::voxelize`] keeps.
///
/// # Errors
/// [`crate::Error::Interrupted`] if `progress` says so; [`crate::Error::Limit`] as soon as there are too
/// many voxels.
pub fn open_voxels(
    expr: &Expr,
    lattice: &Lattice,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<OpenVoxels> {
    if lattice.depth() < BRICK_LEVELS {
        let Brick { first, present, .. } = Brick::new([0; 3], lattice.n_voxels());
        let bricks = vec![OpenBrick { first, voxels: present }];
        return Ok(OpenVoxels { bricks, ..OpenVoxels::default() });
    }
    let found = settings.simd.run(Task { tape: expr.tape(), lattice, settings, progress })?;
    if !found.meets_end {
        return Ok(found);
    }
    let settings = Settings { certify: true, ..*settings };
    let Voxelization { octree, mut effort, .. } = voxelize(expr, lattice, &settings, progress)?;
    effort.add(&found.effort);
    Ok(OpenVoxels { bricks: bricks(&octree), effort, meets_end: true })
}

/// The bricks of stored voxels.
fn bricks(octree: &MortonOctree) -> Vec<OpenBrick> {
    let mut bricks: Vec<OpenBrick> = Vec::new();
    for part in octree.parts() {
        octree.visit(part, &mut |voxel| {
            let first = voxel.ijk.map(|i| i / OpenBrick::EDGE * OpenBrick::EDGE);
            let bit = 1 << morton_encode(voxel.ijk.map(|i| i % OpenBrick::EDGE));
            match bricks.last_mut() {
                Some(brick) if brick.first == first => brick.voxels |= bit,
                _ => bricks.push(OpenBrick { first, voxels: bit }),
            }
        });
    }
    bricks
}

struct Task<'a> {
    tape: Tape,
    lattice: &'a Lattice,
    settings: &'a Settings,
    progress: &'a dyn Progress,
}

impl SimdTask for Task<'_> {
    type Output = Result<OpenVoxels>;

    fn run<S: Simd>(self, simd: S) -> Self::Output {
        match Precision::for_lattice(self.lattice) {
            Precision::Single => self.search::<S, f32x16<S>, { BATCH / 16 }>(simd),
            Precision::Double => self.search::<S, f64x8<S>, { BATCH / 8 }>(simd),
        }
    }
}

impl Task<'_> {
    fn search<S: Simd, L: Lanes<Token = S>, const G: usize>(self, simd: S) -> Result<OpenVoxels> {
        let Self { tape, lattice, settings, progress } = self;
        let (corners, shared) = (Arc::new(Corners::new(lattice)), Arc::new(lattice.clone()));
        let new_search = || Search::<S, L, G>::new(simd, shared.clone(), corners.clone(), true);
        let frontier = frontier_level(lattice.depth());
        let watch = Watch::new(progress, settings.max_voxels);
        let find = |search: &mut Search<S, L, G>, run| {
            let found = search.open_voxels(run, frontier);
            let n_voxels = |brick: &OpenBrick| u64::from(brick.voxels.count_ones());
            watch.add(found.bricks.iter().map(n_voxels).sum())?;
            Ok(found)
        };
        let root = Run::root(Arc::new(tape));
        let (mut trunk, found) = schedule::steal(new_search, root, frontier, &watch, find)?;
        let mut all = OpenVoxels { effort: trunk.take_effort(), ..OpenVoxels::default() };
        for mut some in found {
            all.bricks.append(&mut some.bricks);
            all.effort.add(&some.effort);
            all.meets_end |= some.meets_end;
        }
        Ok(all)
    }
}

impl<S: Simd, L: Lanes<Token = S>, const G: usize> Search<S, L, G> {
    /// The open voxels below the single node of `run`, on `level`.
    fn open_voxels(&mut self, run: Run, level: u32) -> OpenVoxels {
        self.open = Some(OpenVoxels::default());
        self.search(run, level);
        self.forget();
        OpenVoxels { effort: self.take_effort(), ..self.open.take().unwrap_or_default() }
    }

    /// Finds the open voxels of the bricks of a run.
    pub(super) fn open_bricks(&mut self, run: &Run) {
        let tape = &*run.tape;
        let mut bricks = self.bricks_of(run);
        self.bound(tape, &mut bricks);
        self.test_octants(tape, &mut bricks);
        let mut irregular: Vec<OpenVoxel> = Vec::new();
        for (brick, of_brick) in bricks.iter().enumerate() {
            let open = places(of_brick.mixed & !of_brick.regular);
            irregular.extend(open.map(|m| OpenVoxel { brick, m }));
        }
        self.test_voxels(tape, &mut bricks, &mut irregular);
        let is_open = |brick: &&Brick| brick.mixed != 0;
        let open = bricks
            .iter()
            .filter(is_open)
            .map(|brick| OpenBrick { first: brick.first, voxels: brick.mixed });
        if let Some(found) = &mut self.open {
            found.bricks.extend(open);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::voxelize::brick::offset;

    proptest! {
        #[test]
        fn slices_hold_each_voxel_once(voxels: u64) {
            let brick = OpenBrick { first: [0; 3], voxels };
            for z in 0..OpenBrick::EDGE {
                let of_slice = places(voxels).map(offset).filter(|p| p[2] == z);
                let bits = of_slice.fold(0, |bits, [x, y, _]| bits | 1 << (x + 8 * y));
                prop_assert_eq!(brick.slice(z), bits);
            }
        }
    }
}
