//! Where a surface may be singular: where it is not proven to be one sheet.
//!
//! If F is continuous and rises along one direction all over a box, no line along it meets the surface
//! twice: there it is a single sheet, smooth or with an edge, that neither touches nor crosses itself
//! and does not end. Boxes of 8³ voxels are asked first, and halved while no such direction is found
//! and the surface is not disproved in them, down to sixteenths of a voxel. What is left then is in
//! doubt: singular points and curves, places where sheets touch, jumps, and formulas that are too
//! involved for intervals of that size.
//!
//! *Based on:* J. Snyder, "Interval Analysis for Computer Graphics", SIGGRAPH 1992 (a box in which a
//! partial derivative has one sign holds a graph).

use fearless_simd::{Simd, f64x8};
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use crate::{
    eval::{BATCH, BoxEvaluator, Boxes, SlopeEvaluator},
    expr::Tape,
    math::{Lattice, SimdLevel, SimdTask, morton_encode},
    octree::Storage,
};

/// Voxels side by side in which a surface is not proven to be one sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SingularPlace {
    /// The first of them in Morton order.
    pub first: [u32; 3],
    /// How many they are; those that share a corner belong together.
    pub n_voxels: u64,
}

/// Finds the places where the surface of `tape`, whose voxels are `storage`, may be singular; in
/// Morton order of their first voxels.
#[must_use]
pub fn singular_places(
    tape: &Tape,
    storage: &dyn Storage,
    lattice: &Lattice,
    simd: SimdLevel,
) -> Vec<SingularPlace> {
    let cubes = cubes(storage);
    let voxels = simd.run(Task { tape, storage, lattice, cubes: &cubes });
    places(&voxels)
}

/// Edge of the boxes that are asked first, in voxels.
const CUBE: u32 = 8;

/// Edges of the groups of cubes for which F is shortened, in cubes: one after the other, so that a long
/// formula is gone through rarely, and small boxes have little of it.
const BLOCK: u32 = 4;
const PAIR: u32 = 2;

/// A cube with more voxels in doubt than this is given up: the formula is too involved for it.
const MAX_VOXELS: usize = 384;

/// How often a voxel is halved.
const MAX_HALVINGS: u32 = 4;

/// A voxel with more parts than this left is given up: around a singular point no more of them touch
/// it, and are close enough to be undecided.
const MAX_PARTS: usize = 16;

/// Directions beside the axes, of which kinks may need one: those of a cube's diagonals.
const DIAGONALS: [[[f64; 3]; 3]; 4] = [
    [[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0], [1.0, -1.0, 1.0]],
    [[1.0, 1.0, -1.0], [0.0, 1.0, 1.0], [0.0, -1.0, 1.0]],
    [[1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [1.0, 1.0, 0.0]],
    [[-1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
];

/// The cubes that hold stored voxels, each once, in Morton order.
fn cubes(storage: &dyn Storage) -> Vec<[u32; 3]> {
    let of_part = |part| {
        let mut cubes: Vec<[u32; 3]> = Vec::new();
        storage.visit(part, &mut |voxel| {
            let cube = voxel.ijk.map(|i| i / CUBE);
            if cubes.last() != Some(&cube) {
                cubes.push(cube);
            }
        });
        cubes
    };
    let mut cubes: Vec<[u32; 3]> = storage.parts().into_par_iter().flat_map_iter(of_part).collect();
    cubes.dedup();
    cubes
}

struct Task<'a> {
    tape: &'a Tape,
    storage: &'a dyn Storage,
    lattice: &'a Lattice,
    cubes: &'a [[u32; 3]],
}

impl SimdTask for Task<'_> {
    type Output = Vec<[u32; 3]>;

    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let blocks: Vec<&[[u32; 3]]> = groups(self.cubes, BLOCK).collect();
        let find = |look: &mut Look<S>, cubes: &[[u32; 3]]| self.find_in_block(look, cubes);
        blocks.into_par_iter().map_init(|| Look::new(simd), find).flatten_iter().collect()
    }
}

/// Cubes that follow each other in groups with edges of so many, a power of two.
fn groups(cubes: &[[u32; 3]], edge: u32) -> impl Iterator<Item = &[[u32; 3]]> {
    let place = move |cube: &[u32; 3]| cube.map(|i| i / edge);
    cubes.chunk_by(move |a, b| place(a) == place(b))
}

impl Task<'_> {
    /// The voxels of the cubes of a block that are in doubt, in Morton order.
    fn find_in_block<S: Simd>(&self, look: &mut Look<S>, cubes: &[[u32; 3]]) -> Vec<[u32; 3]> {
        if self.tape.n_choices() == 0 {
            return self.find(look, self.tape, cubes);
        }
        let around = |cubes: &[[u32; 3]], edge| {
            self.part(cubes[0].map(|i| i / edge * edge * CUBE), edge * CUBE)
        };
        let of_block = look.shortened(self.tape, around(cubes, BLOCK));
        let mut voxels = Vec::new();
        for cubes in groups(cubes, PAIR) {
            let tape = look.shortened(&of_block, around(cubes, PAIR));
            voxels.extend(self.find(look, &tape, cubes));
        }
        voxels
    }

    /// The voxels of some cubes that are in doubt, in Morton order; `tape` is F in them.
    fn find<S: Simd>(&self, look: &mut Look<S>, tape: &Tape, cubes: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let n = self.lattice.n_voxels();
        let mut parts: Vec<Part> =
            cubes.iter().map(|cube| self.part(cube.map(|i| i * CUBE), CUBE)).collect();
        let mut edge = CUBE;
        while edge > 1 {
            edge /= 2;
            let of_part = |part: Part| {
                (0..8).map(move |c| [0, 1, 2].map(|axis| part.ijk[axis] + edge * (c >> axis & 1)))
            };
            let is_there = |ijk: &[u32; 3]| match edge {
                1 => self.storage.find(*ijk).is_some(),
                _ => (0..3).all(|axis| ijk[axis] < n[axis]),
            };
            let halves = look.doubtful(tape, parts).into_iter().flat_map(of_part);
            parts = halves.filter(is_there).map(|ijk| self.part(ijk, edge)).collect();
        }
        let (mut left, mut voxels) = (Vec::new(), Vec::new());
        for of_cube in look.doubtful(tape, parts).chunk_by(|a, b| a.cube() == b.cube()) {
            match of_cube.len() > MAX_VOXELS {
                true => voxels.extend(of_cube.iter().map(|part| part.ijk)),
                false => left.extend_from_slice(of_cube),
            }
        }
        for _ in 0..MAX_HALVINGS {
            let halves = left.iter().flat_map(|part| part.halves()).collect();
            left = look.doubtful(tape, halves);
            let mut next = Vec::new();
            for of_voxel in left.chunk_by(|a, b| a.ijk == b.ijk) {
                match of_voxel.len() > MAX_PARTS {
                    true => voxels.push(of_voxel[0].ijk),
                    false => next.extend_from_slice(of_voxel),
                }
            }
            left = next;
        }
        voxels.extend(left.iter().map(|part| part.ijk));
        voxels.sort_unstable_by_key(|&ijk| morton_encode(ijk));
        voxels.dedup();
        voxels
    }

    /// The box of `edge` voxels an axis from the voxel `ijk`, as far as it lies in the lattice.
    fn part(&self, ijk: [u32; 3], edge: u32) -> Part {
        let n = self.lattice.n_voxels();
        let corner = |axis: usize, i: u32| self.lattice.corner(axis, i.min(n[axis]));
        let [lo, hi] = [0, edge].map(|step| [0, 1, 2].map(|axis| corner(axis, ijk[axis] + step)));
        Part { ijk, lo, hi }
    }
}

/// A box, and the first voxel that it is made of or lies in.
#[derive(Clone, Copy)]
struct Part {
    ijk: [u32; 3],
    lo: [f64; 3],
    hi: [f64; 3],
}

impl Part {
    fn cube(&self) -> [u32; 3] {
        self.ijk.map(|i| i / CUBE)
    }

    fn halves(self) -> impl Iterator<Item = Self> {
        (0..8_u32).map(move |c| {
            let mut half = self;
            for axis in 0..3 {
                let middle = self.lo[axis] + 0.5 * (self.hi[axis] - self.lo[axis]);
                match c >> axis & 1 {
                    0 => half.hi[axis] = middle,
                    _ => half.lo[axis] = middle,
                }
            }
            half
        })
    }
}

/// One thread's means.
struct Look<S: Simd> {
    values: BoxEvaluator<f64x8<S>, { BATCH / 8 }>,
    slopes: SlopeEvaluator<f64x8<S>, { BATCH / 8 }>,
    boxes: Boxes<f64>,
}

impl<S: Simd> Look<S> {
    fn new(simd: S) -> Self {
        let (values, slopes) = (BoxEvaluator::new(simd), SlopeEvaluator::new(simd));
        Self { values, slopes, boxes: Boxes::default() }
    }

    /// What is left of F in a box.
    fn shortened(&mut self, tape: &Tape, part: Part) -> Tape {
        self.write(&[part]);
        self.values.eval(tape, &self.boxes, 1, true);
        tape.shortened(self.values.choices(0))
    }

    /// The parts that the surface may meet, and in which it is not proven to be one sheet.
    fn doubtful(&mut self, tape: &Tape, mut parts: Vec<Part>) -> Vec<Part> {
        let mut left = Vec::new();
        for batch in parts.chunks(BATCH) {
            self.write(batch);
            let Self { values, slopes, boxes } = self;
            let verdict = slopes.eval(values, tape, boxes, boxes, batch.len()).verdict;
            let is_decided = |i: usize| (verdict.empty | verdict.negative) >> i & 1 == 1;
            let is_one_sheet =
                |i: usize| verdict.continuous >> i & 1 == 1 && is_monotone(slopes.slopes(), i);
            let is_left = |&(i, _): &(usize, &Part)| !is_decided(i) && !is_one_sheet(i);
            left.extend(batch.iter().enumerate().filter(is_left).map(|(_, part)| *part));
        }
        if tape.n_choices() == 0 {
            return left;
        }
        for directions in &DIAGONALS {
            parts = std::mem::take(&mut left);
            for batch in parts.chunks(BATCH) {
                self.write(batch);
                let found = self.slopes.along(tape, &self.boxes, batch.len(), directions);
                let continuous = found.verdict.continuous;
                let slopes = self.slopes.slopes();
                let is_left =
                    |&(i, _): &(usize, &Part)| continuous >> i & 1 == 0 || !is_monotone(slopes, i);
                left.extend(batch.iter().enumerate().filter(is_left).map(|(_, part)| *part));
            }
        }
        left
    }

    fn write(&mut self, batch: &[Part]) {
        for (lane, part) in batch.iter().enumerate() {
            for axis in 0..3 {
                self.boxes.lo[axis][lane] = part.lo[axis];
                self.boxes.hi[axis][lane] = part.hi[axis];
            }
        }
    }
}

/// Whether F rises along one of three directions in a box, or falls.
fn is_monotone(slopes: &Boxes<f64>, i: usize) -> bool {
    (0..3).any(|k| slopes.lo[k][i] > 0.0 || slopes.hi[k][i] < 0.0)
}

/// Puts voxels together that share a corner.
fn places(voxels: &[[u32; 3]]) -> Vec<SingularPlace> {
    let mut unseen: FxHashSet<[u32; 3]> = voxels.iter().copied().collect();
    let mut places = Vec::new();
    for &first in voxels {
        if !unseen.remove(&first) {
            continue;
        }
        let (mut n_voxels, mut open) = (0, vec![first]);
        while let Some(ijk) = open.pop() {
            n_voxels += 1;
            for k in 0..27_u32 {
                let step = [k % 3, k / 3 % 3, k / 9];
                let beside = [0, 1, 2].map(|axis| (ijk[axis] + step[axis]).wrapping_sub(1));
                if unseen.remove(&beside) {
                    open.push(beside);
                }
            }
        }
        places.push(SingularPlace { first, n_voxels });
    }
    places
}
