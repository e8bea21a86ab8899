//! Voxels where they are asked for: blocks of 32³, found by themselves.
//!
//! A picture needs only what it shows. [`find_blocks`] searches from the root by values alone, and
//! asks of every octant whether it is wanted, and whether its cells are small enough; what is left
//! are blocks. [`FindVoxels`] searches one of them with everything that voxelization has.
//!
//! A block has a lattice of its own, with its own origin and level: octants are counted in 64 bits
//! and cells from the block's first corner, so that nothing limits how small cells are but f64. On
//! the levels of the whole lattice they are the same voxels, bit for bit.

use std::sync::Arc;

use fearless_simd::{Simd, f32x16, f64x8};
use rayon::prelude::*;

use super::{
    Precision, assemble,
    brick::BRICK_LEVELS,
    cells::BlockCells,
    corners::Corners,
    normals::fill_missing,
    schedule::Found,
    search::{Effort, Run, Search},
    shortened::ShortenedTapes,
};
use crate::{
    eval::{BATCH, BoxEvaluator, Boxes},
    expr::Tape,
    math::{Aabb, Lanes, Lattice, SimdLevel, SimdTask},
    octree::MortonOctree,
};

/// Levels of a block.
pub const BLOCK_LEVELS: u32 = 5;

/// What is to become of an octant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// It is not needed.
    Skip,
    /// It is needed in smaller cells than 32³.
    Divide,
    /// It is needed as a block.
    Keep,
}

/// An octant that may meet the surface.
#[derive(Clone, Debug)]
pub struct Octant {
    /// Its level; the root has level 0.
    pub level: u32,
    /// Its place in octants of its level.
    pub ijk: [u64; 3],
    /// F in it.
    pub tape: Arc<Tape>,
}

/// What was found in a block.
#[derive(Clone, Debug)]
pub struct BlockVoxels {
    /// The block's own lattice.
    pub lattice: Lattice,
    /// Its voxels.
    pub octree: MortonOctree,
    /// What it took.
    pub effort: Effort,
}

/// The octants that `wish` keeps, of those that the surface of `tape` may meet: level by level, each in
/// Morton order. The root is divided without asking.
#[must_use]
pub fn find_blocks(
    tape: Tape,
    lattice: &Lattice,
    simd: SimdLevel,
    wish: &(dyn Fn(u32, &Aabb) -> Wish + Sync),
) -> Vec<Octant> {
    struct Task<'a>(Tape, &'a Lattice, &'a (dyn Fn(u32, &Aabb) -> Wish + Sync));
    impl SimdTask for Task<'_> {
        type Output = Vec<Octant>;

        fn run<S: Simd>(self, simd: S) -> Vec<Octant> {
            let Self(tape, lattice, wish) = self;
            let root = Octant { level: 0, ijk: [0; 3], tape: Arc::new(tape) };
            let mut open = vec![root];
            let mut kept = Vec::new();
            // Level by level: a level is searched by all threads.
            while !open.is_empty() {
                let divided: Vec<Vec<(Octant, Wish)>> = open
                    .into_par_iter()
                    .map_init(
                        || Divider::<S>::new(simd),
                        |divider, octant| divider.divide(&octant, lattice, wish),
                    )
                    .collect();
                open = Vec::new();
                for (octant, wish) in divided.into_iter().flatten() {
                    if wish == Wish::Keep { kept.push(octant) } else { open.push(octant) }
                }
            }
            kept
        }
    }
    simd.run(Task(tape, lattice, wish))
}

/// One thread's means of dividing octants.
struct Divider<S: Simd> {
    values: BoxEvaluator<f64x8<S>, { BATCH / 8 }>,
    boxes: Boxes<f64>,
    tapes: ShortenedTapes,
}

impl<S: Simd> Divider<S> {
    fn new(simd: S) -> Self {
        Self {
            values: BoxEvaluator::new(simd),
            boxes: Boxes::default(),
            tapes: ShortenedTapes::default(),
        }
    }

    /// The children that are wanted and may meet the surface.
    fn divide(
        &mut self,
        octant: &Octant,
        lattice: &Lattice,
        wish: &(dyn Fn(u32, &Aabb) -> Wish + Sync),
    ) -> Vec<(Octant, Wish)> {
        let level = octant.level + 1;
        let children = (0..8_u64).filter_map(|c| {
            let ijk = [0, 1, 2].map(|axis| 2 * octant.ijk[axis] + (c >> axis & 1));
            let bounds = lattice.octant_bounds(level, ijk)?;
            let wish = wish(level, &bounds);
            (wish != Wish::Skip).then_some((ijk, bounds, wish))
        });
        let children: Vec<([u64; 3], Aabb, Wish)> = children.collect();
        for (lane, (_, bounds, _)) in children.iter().enumerate() {
            for axis in 0..3 {
                self.boxes.lo[axis][lane] = bounds.min[axis];
                self.boxes.hi[axis][lane] = bounds.max[axis];
            }
        }
        let split = octant.tape.n_choices() > 0;
        let verdict = self.values.eval(&octant.tape, &self.boxes, children.len(), split);
        let dropped = verdict.empty | verdict.inside();
        let left = children.into_iter().enumerate().filter(|(lane, _)| dropped >> lane & 1 == 0);
        let keep = |(lane, (ijk, _, wish)): (usize, ([u64; 3], Aabb, Wish))| {
            let tape = if split {
                let choices: Vec<_> = self.values.choices(lane).collect();
                self.tapes.shortened(&octant.tape, &choices)
            } else {
                octant.tape.clone()
            };
            (Octant { level, ijk, tape }, wish)
        };
        left.map(keep).collect()
    }
}

/// Finds the voxels of blocks; a thread's own.
pub trait FindVoxels: Send {
    /// The voxels of the block at an octant of `lattice`.
    fn find(&mut self, octant: &Octant, lattice: &Lattice) -> BlockVoxels;

    /// The same by values alone: the places of voxels in the block, and its lattice.
    fn find_by_values(
        &mut self,
        octant: &Octant,
        lattice: &Lattice,
    ) -> (Vec<[u32; 3]>, Lattice, Effort);

    /// The cells of the same block, as large as bricks, with bounds that hold up to `margin` beyond
    /// each.
    fn find_cells(&mut self, octant: &Octant, lattice: &Lattice, margin: f64) -> BlockCells;
}

/// A finder for the instruction set.
#[must_use]
pub fn finder(simd: SimdLevel) -> Box<dyn FindVoxels> {
    struct New;
    impl SimdTask for New {
        type Output = Box<dyn FindVoxels>;

        fn run<S: Simd>(self, simd: S) -> Box<dyn FindVoxels> {
            Box::new(Finder::<S> { simd, voxels: Searches::default(), cells: Searches::default() })
        }
    }
    simd.run(New)
}

type Single<S> = Search<S, f32x16<S>, { BATCH / 16 }>;
type Double<S> = Search<S, f64x8<S>, { BATCH / 8 }>;

/// A search of each precision, made when it is needed.
struct Searches<S: Simd> {
    single: Option<Box<Single<S>>>,
    double: Option<Box<Double<S>>>,
}

impl<S: Simd> Default for Searches<S> {
    fn default() -> Self {
        Self { single: None, double: None }
    }
}

struct Finder<S: Simd> {
    simd: S,
    voxels: Searches<S>,
    cells: Searches<S>,
}

impl<S: Simd> FindVoxels for Finder<S> {
    fn find(&mut self, octant: &Octant, lattice: &Lattice) -> BlockVoxels {
        let block = Arc::new(lattice.block(octant.level, octant.ijk, BLOCK_LEVELS));
        let tape = octant.tape.clone();
        let Self { simd, voxels: Searches { single, double }, .. } = self;
        match Precision::for_lattice(&block) {
            Precision::Single => voxels(enter(*simd, single, &block), block, tape),
            Precision::Double => voxels(enter(*simd, double, &block), block, tape),
        }
    }

    fn find_by_values(
        &mut self,
        octant: &Octant,
        lattice: &Lattice,
    ) -> (Vec<[u32; 3]>, Lattice, Effort) {
        let block = Arc::new(lattice.block(octant.level, octant.ijk, BLOCK_LEVELS));
        let root = Run::root(octant.tape.clone());
        let Self { simd, voxels: Searches { single, double }, .. } = self;
        let (places, effort) = match Precision::for_lattice(&block) {
            Precision::Single => enter(*simd, single, &block).places(root),
            Precision::Double => enter(*simd, double, &block).places(root),
        };
        (places, Arc::unwrap_or_clone(block), effort)
    }

    fn find_cells(&mut self, octant: &Octant, lattice: &Lattice, margin: f64) -> BlockCells {
        let levels = BLOCK_LEVELS - BRICK_LEVELS;
        let block = Arc::new(lattice.block(octant.level, octant.ijk, levels));
        let root = Run::root(octant.tape.clone());
        let Self { simd, cells: Searches { single, double }, .. } = self;
        let (groups, effort) = match Precision::for_lattice(&block) {
            Precision::Single => enter(*simd, single, &block).cells(root, margin),
            Precision::Double => enter(*simd, double, &block).cells(root, margin),
        };
        BlockCells { lattice: Arc::unwrap_or_clone(block), groups, effort }
    }
}

/// A search that goes on to a block, made if there is none.
fn enter<'s, S: Simd, L: Lanes<Token = S>, const G: usize>(
    simd: S,
    slot: &'s mut Option<Box<Search<S, L, G>>>,
    block: &Arc<Lattice>,
) -> &'s mut Search<S, L, G> {
    let corners = Arc::new(Corners::new(block));
    match slot {
        Some(search) => {
            search.enter(block.clone(), corners);
            search
        }
        None => slot.insert(Box::new(Search::new(simd, block.clone(), corners, true))),
    }
}

/// The voxels of a block that `search` has entered.
fn voxels<S: Simd, L: Lanes<Token = S>, const G: usize>(
    search: &mut Search<S, L, G>,
    block: Arc<Lattice>,
    tape: Arc<Tape>,
) -> BlockVoxels {
    let subtree = search.subtree(Run::root(tape), 0);
    let effort = subtree.effort.clone();
    let found = Found { trunk: Vec::new(), subtrees: vec![subtree], effort: effort.clone() };
    let (mut octree, missing) = assemble(found, 0, block.depth());
    fill_missing(&mut octree, &missing, &block);
    BlockVoxels { lattice: Arc::unwrap_or_clone(block), octree, effort }
}
