//! From voxels to triangles: the dual grid's cells, one after the other, never stored.
//!
//! A cell belongs to each corner that voxels have in common; it joins the middles of the eight voxels
//! around, of which large ones count several times. Where the ends of a *dual edge*, the line
//! between the middles of two voxels that share a face, lie on different sides, the mesh has a
//! vertex. It belongs to the smaller voxel, or of equal ones to the lower one, so that its number is
//! known in all cells around the edge without any search: the number of the brick's first vertex,
//! plus the count of bits before it among those that mark the brick's cut edges.
//!
//! *Invariant:* a face between two cells has the same voxels in the same order for both, and what is
//! done in it depends on nothing else; so there are no cracks, whatever the sizes of the voxels.
//!
//! *Based on:* A. León Salas, 2008, sections 2.3 and 2.4 (the dual grid, and crossings within half a
//! voxel of the face that two voxels share).

use std::{iter, ops::Range};

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::{
    cases::{CASES, Case, Loop, N_EDGES, axis_of, lower_octant},
    grid::{Border, Grid, Leaf, RUN, SIDE, VOXELS, index_of},
    halo::{Halo, WIDTH},
};

/// Cut edges stay away from both ends of the zone in which they are looked for by this part of it:
/// large enough for f32 to tell them apart in grids of 16384 voxels, so that values equal to the
/// isovalue leave no triangle without area.
pub const LEAST_PART: f64 = 1.0 / 256.0;

/// Directions from a voxel to its neighbours: +x, +y, +z, −x, −y, −z.
const DIRECTIONS: usize = 6;
const WORDS: usize = DIRECTIONS * VOXELS / 64;

/// A vertex on a dual edge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Crossing {
    /// The ends of the dual edge, in the finest voxels from the grid's first corner.
    pub ends: [[f32; 3]; 2],
    /// How far the values there are above the isovalue.
    pub offsets: [f32; 2],
    /// Where between the ends it is, in (0, 1].
    pub part: f64,
    /// Whether one of the ends is what a capped border has beyond it.
    pub is_cap: bool,
}

impl Crossing {
    /// Where it is, in the finest voxels from the grid's first corner.
    #[must_use]
    #[inline]
    pub fn point(&self) -> [f64; 3] {
        let [a, b] = self.ends.map(|end| end.map(f64::from));
        [0, 1, 2].map(|axis| a[axis] + self.part * (b[axis] - a[axis]))
    }

    /// The dual edge, from its inside end to the outside one.
    pub(crate) fn outwards(&self) -> DVec3 {
        let [a, b] = self.ends.map(|end| Vec3::from_array(end).as_dvec3());
        if self.offsets[0] >= self.offsets[1] { b - a } else { a - b }
    }
}

/// Vertices and triangles, counter-clockwise as seen from outside. Cells that have collapsed may leave
/// a vertex that no triangle has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extraction<T = Crossing> {
    /// In the order of bricks, directions and voxels.
    pub vertices: Vec<T>,
    /// In the order of bricks and cells.
    pub triangles: Vec<[u32; 3]>,
}

/// Finds the surface where values are the isovalue of `grid`; `vertex` makes what is kept of every
/// crossing.
#[must_use]
pub fn extract<T: Copy + Default + Send>(
    grid: &Grid,
    vertex: impl Fn(&Crossing) -> T + Sync,
) -> Extraction<T> {
    let n = grid.bricks.len();
    let halos: Vec<Halo<'_>> =
        (0..n).into_par_iter().map(|number| Halo::new(grid, number)).collect();
    let cuts = Cuts::of_all(grid, &halos);
    let firsts = Cuts::firsts(&cuts);
    let n_vertices: u32 = cuts.iter().map(Cuts::count).sum();
    let edges = Edges { grid, cuts, firsts };
    let mut vertices = vec![T::default(); n_vertices as usize];
    let mut rest = vertices.as_mut_slice();
    let mut runs = Vec::with_capacity(n.div_ceil(RUN));
    for first in (0..n).step_by(RUN) {
        let bricks = first..(first + RUN).min(n);
        let count: u32 = edges.cuts[bricks.clone()].iter().map(Cuts::count).sum();
        let (own, others) = rest.split_at_mut(count as usize);
        runs.push((bricks, own));
        rest = others;
    }
    let triangles_of = |(bricks, own): (Range<usize>, &mut [T])| {
        let mut triangles = Vec::with_capacity(5 * own.len() / 2);
        let mut own = own.iter_mut();
        let mut numbers = Numbers::default();
        for number in bricks {
            let halo = &halos[number];
            // In this order nothing of `own` is taken for an end.
            for (crossing, place) in edges.crossings(halo, number).zip(own.by_ref()) {
                *place = vertex(&crossing);
            }
            edges.triangles(halo, &mut numbers, &mut triangles);
        }
        triangles
    };
    let triangles: Vec<Vec<[u32; 3]>> = runs.into_par_iter().map(triangles_of).collect();
    Extraction { vertices, triangles: triangles.concat() }
}

/// Some bricks of a grid, extracted by themselves.
pub(super) struct Parts {
    /// Of all bricks of the grid, the edges that are cut.
    pub(super) cuts: Vec<Cuts>,
    /// The number of the first vertex of each brick.
    pub(super) firsts: Vec<u32>,
    /// The vertices and triangles of runs of wanted bricks.
    pub(super) runs: Vec<Run>,
}

/// What some bricks give to a mesh.
pub(super) struct Run {
    /// The numbers of the bricks, and how many triangles each has.
    pub(super) bricks: Vec<(usize, usize)>,
    /// All vertices of one brick after the other.
    pub(super) vertices: Vec<Crossing>,
    /// The same for triangles.
    pub(super) triangles: Vec<[u32; 3]>,
}

/// What the `wanted` bricks of a grid, in order, give to a mesh; `known` has the cut edges of others,
/// if any. All around a wanted brick must be there.
pub(super) fn extract_parts(
    grid: &Grid,
    wanted: &[usize],
    known: impl Fn(usize) -> Option<Cuts>,
) -> Parts {
    let halos: Vec<Halo<'_>> = wanted.par_iter().map(|&number| Halo::new(grid, number)).collect();
    let (found, far): (Vec<Cuts>, Vec<Vec<DualEdge>>) = halos.par_iter().map(Cuts::of).unzip();
    let mut found = wanted.iter().zip(found).peekable();
    let of_brick = |number| match found.next_if(|&(&wanted, _)| wanted == number) {
        Some((_, cuts)) => cuts,
        None => known(number).unwrap_or_default(),
    };
    let mut cuts: Vec<Cuts> = (0..grid.bricks.len()).map(of_brick).collect();
    Cuts::mark_far(&mut cuts, grid, far.iter().flatten());
    wanted.iter().for_each(|&number| cuts[number].number());
    let firsts = Cuts::firsts(&cuts);
    let edges = Edges { grid, cuts, firsts };
    let run = |(wanted, halos): (&[usize], &[Halo<'_>])| {
        let n: u32 = wanted.iter().map(|&number| edges.cuts[number].count()).sum();
        let mut vertices = Vec::with_capacity(n as usize);
        let mut triangles = Vec::with_capacity(5 * n as usize / 2);
        let mut numbers = Numbers::default();
        let of_brick = |(&number, halo): (&usize, &Halo<'_>)| {
            let before = triangles.len();
            vertices.extend(edges.crossings(halo, number));
            edges.triangles(halo, &mut numbers, &mut triangles);
            (number, triangles.len() - before)
        };
        let bricks = wanted.iter().zip(halos).map(of_brick).collect();
        Run { bricks, vertices, triangles }
    };
    let runs = wanted.par_chunks(RUN).zip(halos.par_chunks(RUN)).map(run).collect();
    let Edges { cuts, firsts, .. } = edges;
    Parts { cuts, firsts, runs }
}

/// Which dual edges of a brick's own are cut.
#[derive(Clone, Debug)]
pub(super) struct Cuts {
    /// Bit voxel + 512 direction.
    bits: Box<[u64; WORDS]>,
    /// Set bits before each word.
    before: Box<[u16; WORDS]>,
}

impl Default for Cuts {
    fn default() -> Self {
        Self { bits: Box::new([0; WORDS]), before: Box::new([0; WORDS]) }
    }
}

impl Cuts {
    /// Those of all bricks.
    fn of_all(grid: &Grid, halos: &[Halo<'_>]) -> Vec<Self> {
        let (mut cuts, far): (Vec<Self>, Vec<Vec<DualEdge>>) =
            halos.par_iter().map(Self::of).unzip();
        Self::mark_far(&mut cuts, grid, far.iter().flatten());
        cuts.par_iter_mut().for_each(Self::number);
        cuts
    }

    /// Marks edges whose owners begin in other bricks than they were found in.
    fn mark_far<'a>(cuts: &mut [Self], grid: &Grid, far: impl IntoIterator<Item = &'a DualEdge>) {
        for edge in far {
            if let Some(number) = grid.number_at(edge.owner.base.map(|i| i / SIDE)) {
                cuts[number as usize].mark(edge);
            }
        }
    }

    /// The number of the first edge of each brick, if all are numbered one after the other.
    fn firsts(cuts: &[Self]) -> Vec<u32> {
        let mut n = 0;
        let first = |cuts: &Self| {
            n += cuts.count();
            n - cuts.count()
        };
        cuts.iter().map(first).collect()
    }

    /// Those of a brick, and edges whose owners are larger than bricks and begin in another.
    fn of(halo: &Halo<'_>) -> (Self, Vec<DualEdge>) {
        let mut cuts = Self::default();
        let mut far = Vec::new();
        let bits = &mut cuts.bits;
        for axis in 0..3 {
            for z in 1..WIDTH - 1 {
                for y in 1..WIDTH - 1 {
                    // Of equal voxels the lower one is the owner.
                    let cut = halo.cut(axis, y, z) & !halo.stretched(axis, y, z);
                    bits[8 * axis + z - 1] |= u64::from(cut >> 1 & 0xff) << (8 * (y - 1));
                }
            }
        }
        if halo.has_coarse {
            for (axis, z, y) in (0..3 * (WIDTH - 1) * (WIDTH - 1))
                .map(|i| (i % 3, i / 3 / (WIDTH - 1), i / 3 % (WIDTH - 1)))
            {
                let mut cut = halo.cut(axis, y, z) & halo.stretched(axis, y, z);
                while cut != 0 {
                    let x = cut.trailing_zeros() as usize;
                    cut &= cut - 1;
                    let edge = halo.edge([x, y, z], axis);
                    if halo.owns(edge.owner.base) {
                        cuts.mark(&edge);
                    } else if 1 << edge.owner.level > SIDE && far.last() != Some(&edge) {
                        far.push(edge);
                    }
                }
            }
        }
        (cuts, far)
    }

    fn mark(&mut self, edge: &DualEdge) {
        let slot = edge.slot();
        self.bits[slot / 64] |= 1 << (slot % 64);
    }

    /// Counts bits once all edges are marked.
    fn number(&mut self) {
        let mut n = 0;
        for (before, bits) in self.before.iter_mut().zip(&*self.bits) {
            *before = n;
            n += bits.count_ones() as u16;
        }
    }

    /// The places of all that are cut.
    fn slots(&self) -> impl Iterator<Item = usize> {
        let mut word = 0;
        let mut rest = self.bits[0];
        iter::from_fn(move || {
            while rest == 0 {
                word += 1;
                rest = *self.bits.get(word)?;
            }
            let slot = 64 * word + rest.trailing_zeros() as usize;
            rest &= rest - 1;
            Some(slot)
        })
    }

    pub(super) fn count(&self) -> u32 {
        u32::from(self.before[WORDS - 1]) + self.bits[WORDS - 1].count_ones()
    }

    /// The number of an edge among those of the brick.
    #[inline]
    fn rank(&self, slot: usize) -> u32 {
        let (word, bit) = (slot / 64, slot % 64);
        debug_assert!(self.bits[word] >> bit & 1 == 1, "every cut edge was marked");
        u32::from(self.before[word]) + (self.bits[word] & ((1 << bit) - 1)).count_ones()
    }

    /// Of every edge that is cut here or in another, in order, whether it is here and whether there.
    pub(super) fn merge(&self, other: &Self, mut tell: impl FnMut(bool, bool)) {
        for (&own, &others) in self.bits.iter().zip(&*other.bits) {
            let mut rest = own | others;
            while rest != 0 {
                let bit = rest & rest.wrapping_neg();
                rest ^= bit;
                tell(own & bit != 0, others & bit != 0);
            }
        }
    }

    /// Whether an edge of a voxel is cut.
    pub(super) fn has_vertices_at(&self, voxel: usize) -> bool {
        (0..DIRECTIONS).any(|k| self.bits[(VOXELS * k + voxel) / 64] >> (voxel % 64) & 1 == 1)
    }

    /// Calls `tell` with each cut edge of a word and its number, in order; `of` has bits for those
    /// that are wanted.
    #[inline]
    fn each(&self, word: usize, of: u64, mut tell: impl FnMut(usize, u32)) {
        let mut rest = self.bits[word] & of;
        while rest != 0 {
            let bit = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            tell(bit, self.rank(64 * word + bit));
        }
    }
}

/// Cells of a brick along an edge, and the layer of voxels behind them.
const CELLS: usize = SIDE as usize + 1;

/// The vertices of edges between the finest voxels of a brick and the layers behind it, by axis and
/// lower voxel, x fastest. Of edges that are not cut anything may stand there.
struct Numbers(Box<[[u32; CELLS * CELLS * CELLS]; 3]>);

impl Default for Numbers {
    fn default() -> Self {
        Self(Box::new([[0; CELLS * CELLS * CELLS]; 3]))
    }
}

impl Numbers {
    /// Looks up all that cells of a brick may ask for.
    fn fill(&mut self, edges: &Edges<'_>, halo: &Halo<'_>) {
        for k in 0..8 {
            let step = [k & 1, k >> 1 & 1, k >> 2];
            // From the brick itself on.
            let number = halo.numbers[13 + step[0] + 3 * step[1] + 9 * step[2]];
            let Some(cuts) = edges.cuts.get(number as usize) else { continue };
            let first = edges.firsts[number as usize];
            let of = if step[0] == 1 { 0x0101_0101_0101_0101 } else { u64::MAX };
            let of = if step[1] == 1 { of & 0xff } else { of };
            let slices = if step[2] == 1 { 1 } else { 8 };
            let base = 8 * step[0] + CELLS * (8 * step[1] + CELLS * 8 * step[2]);
            // Edges that leave the layers behind are no cell's.
            for axis in (0..3).filter(|&axis| step[axis] == 0) {
                let numbers = &mut self.0[axis];
                for z in 0..slices {
                    cuts.each(8 * axis + z, of, |bit, rank| {
                        numbers[base + bit % 8 + CELLS * (bit / 8 + CELLS * z)] = first + rank;
                    });
                }
            }
        }
    }

    /// The vertex on an edge of the cell whose first voxel is at a place of the brick.
    #[inline]
    fn of(&self, cell: usize, edge: usize) -> u32 {
        self.0[axis_of(edge)][cell + EDGE_STEPS[edge]]
    }
}

/// From a cell to the lower ends of its edges.
const EDGE_STEPS: [usize; N_EDGES] = {
    let mut steps = [0; N_EDGES];
    let mut edge = 0;
    while edge < N_EDGES {
        let low = lower_octant(edge);
        steps[edge] = (low & 1) + CELLS * (low >> 1 & 1) + CELLS * CELLS * (low >> 2);
        edge += 1;
    }
    steps
};

/// A dual edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DualEdge {
    /// The smaller voxel, or of equal ones the lower.
    pub(super) owner: Leaf,
    /// The way to the other one.
    pub(super) direction: usize,
}

impl DualEdge {
    /// Between two voxels that share a face, from the lower to the upper one along `axis`.
    #[inline]
    pub(super) fn between(lower: Leaf, upper: Leaf, axis: usize) -> Self {
        if upper.level < lower.level {
            Self { owner: upper, direction: axis + 3 }
        } else {
            Self { owner: lower, direction: axis }
        }
    }

    /// Where it is marked in the brick of its owner.
    #[inline]
    fn slot(&self) -> usize {
        VOXELS * self.direction + index_of(self.owner.base)
    }
}

/// All cut dual edges, with numbers.
struct Edges<'a> {
    grid: &'a Grid,
    /// By brick.
    cuts: Vec<Cuts>,
    /// The number of the first vertex of each brick.
    firsts: Vec<u32>,
}

impl Edges<'_> {
    /// The vertices of a brick, in order.
    fn crossings(&self, halo: &Halo<'_>, number: usize) -> impl Iterator<Item = Crossing> {
        let slots = self.cuts[number].slots();
        slots.map(|slot| self.crossing(halo, slot % VOXELS, slot / VOXELS))
    }

    /// The vertex on the edge that leaves the voxel number `index` of a brick in a direction.
    #[inline]
    fn crossing(&self, halo: &Halo<'_>, index: usize, direction: usize) -> Crossing {
        let at = [1 + index % 8, 1 + index / 8 % 8, 1 + index / 64];
        let (axis, is_up) = (direction % 3, direction < 3);
        if let Some((lower, offsets)) = halo.plain_edge(at, direction) {
            let mut upper = lower;
            upper[axis] += 1.0;
            let part = zone(offsets);
            return Crossing { ends: [lower, upper], offsets, part, is_cap: false };
        }
        let owner = halo.leaf(at);
        let mut beside = owner.base;
        beside[axis] = match is_up {
            true => beside[axis] + (1 << self.grid.thickness(&owner, axis)),
            false => beside[axis] - 1,
        };
        let own_offset = halo.offset(index);
        let (other, other_offset) = halo.voxel_at(beside);
        let ((lower, f), (upper, g)) = match is_up {
            true => ((owner, own_offset), (other, other_offset)),
            false => ((other, other_offset), (owner, own_offset)),
        };
        let grid = self.grid;
        let ends = [grid.middle(&lower), grid.middle(&upper)];
        let is_cap =
            grid.border == Border::Capped && (grid.is_phantom(&lower) || grid.is_phantom(&upper));
        let part = if is_cap {
            // The cap lies on the border.
            if grid.is_phantom(&upper) { 1.0 } else { 0.0 }
        } else {
            // From the face that both share to the middles, and to the borders of the zone: half a
            // finest voxel on either side, or nothing where there is only a border.
            let [to_lower, to_upper] = [&lower, &upper].map(|leaf| grid.half_depth(leaf, axis));
            let [before, behind] = [to_lower, to_upper].map(|depth| depth.min(0.5));
            (to_lower - before + zone([f, g]) * (before + behind)) / (to_lower + to_upper)
        };
        Crossing { ends, offsets: [f, g], part, is_cap }
    }

    /// The triangles of the cells whose first voxel is in a brick.
    fn triangles(&self, halo: &Halo<'_>, numbers: &mut Numbers, triangles: &mut Vec<[u32; 3]>) {
        numbers.fill(self, halo);
        let cases = &*CASES;
        for z in 1..WIDTH - 1 {
            for y in 1..WIDTH - 1 {
                let mixed = halo.mixed(y, z) & 0x1fe;
                if mixed == 0 {
                    continue;
                }
                let stretched = if halo.has_coarse { halo.stretched_cells(y, z) } else { 0 };
                let rows = halo.rows(y, z).map(usize::from);
                let first = CELLS * (y - 1 + CELLS * (z - 1));
                let mut rest = mixed;
                while rest != 0 {
                    let x = rest.trailing_zeros() as usize;
                    rest &= rest - 1;
                    let [a, b, c, d] = rows.map(|row| row >> x & 3);
                    let case = &cases[a | b << 2 | c << 4 | d << 6];
                    let number = |edge: u8| numbers.of(first + x - 1, edge.into());
                    if stretched >> x & 1 == 1 {
                        self.stretched_cell(halo, [x, y, z], case, number, triangles);
                        continue;
                    }
                    let corners = |edges: &[u8; 3]| edges.map(number);
                    triangles.extend(case.triangles.iter().map(corners));
                }
            }
        }
    }

    /// A cell between voxels of which some are larger; `number` tells the vertices on edges between
    /// others.
    fn stretched_cell(
        &self,
        halo: &Halo<'_>,
        at: [usize; 3],
        case: &Case,
        number: impl Fn(u8) -> u32,
        triangles: &mut Vec<[u32; 3]>,
    ) {
        let coarse = halo.coarse_octants(at);
        let leaf = |octant: usize| halo.leaf(octant_at(at, octant));
        // The finest voxels have corners everywhere.
        if coarse == u8::MAX && !halo.is_corner(at, &std::array::from_fn(leaf)) {
            return;
        }
        for edges in &case.loops {
            let collapsed = Loop::collapsed(edges, |edge| {
                let (low, axis) = (lower_octant(edge.into()), axis_of(edge.into()));
                let high = low | 1 << axis;
                match coarse & (1 << low | 1 << high) {
                    0 => number(edge),
                    _ => self.number(halo, &DualEdge::between(leaf(low), leaf(high), axis)),
                }
            });
            triangles.extend(collapsed.triangles());
        }
    }

    /// The number of the vertex on a cut edge.
    fn number(&self, halo: &Halo<'_>, edge: &DualEdge) -> u32 {
        let brick = halo.number_of(edge.owner.base);
        self.firsts[brick] + self.cuts[brick].rank(edge.slot())
    }
}

/// Where between two values, as they are above the isovalue, the isovalue is.
#[inline]
pub(super) fn zone([f, g]: [f32; 2]) -> f64 {
    let zone = f64::from(f) / (f64::from(f) - f64::from(g));
    // Without a number at one end, the middle.
    let zone = if zone.is_finite() { zone } else { 0.5 };
    zone.clamp(LEAST_PART, 1.0 - LEAST_PART)
}

/// An octant of the cell whose first voxel is at `at`.
#[inline]
fn octant_at([x, y, z]: [usize; 3], octant: usize) -> [usize; 3] {
    [x + (octant & 1), y + (octant >> 1 & 1), z + (octant >> 2)]
}
