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
    cases::{CASES, Case, N_EDGES, axis_of, faces_of, fan, lower_octant},
    grid::{Border, Grid, Leaf, RUN, SIDE, VOXELS, index_of},
    halo::{Halo, WIDTH},
};
use crate::math::morton_encode;

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
    let mut n_vertices = 0;
    let firsts: Vec<u32> = cuts
        .iter()
        .map(|cuts| {
            n_vertices += cuts.count();
            n_vertices - cuts.count()
        })
        .collect();
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

/// A dual edge, whatever else the grid holds: the Morton code of its owner's brick, times 2^12, and
/// its place in that.
pub type EdgeKey = u64;

/// What a brick gives to a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct BrickMesh {
    /// Its Morton code.
    pub brick: u64,
    /// In order of their edges.
    pub vertices: Vec<(EdgeKey, Crossing)>,
    /// In order of their cells.
    pub triangles: Vec<[EdgeKey; 3]>,
}

/// Bits of a key for the place of an edge in its brick.
const EDGE_BITS: u32 = 12;

/// The Morton code of the brick of an edge.
pub(super) fn brick_of(key: EdgeKey) -> u64 {
    key >> EDGE_BITS
}

/// The parts of a mesh that `wanted` bricks give, in Morton order, without those that give nothing.
/// The bricks around them must be complete in the grid.
#[must_use]
pub fn extract_bricks(grid: &Grid, wanted: impl Fn([u32; 3]) -> bool + Sync) -> Vec<BrickMesh> {
    let n = grid.bricks.len();
    let halos: Vec<Halo<'_>> =
        (0..n).into_par_iter().map(|number| Halo::new(grid, number)).collect();
    let cuts = Cuts::of_all(grid, &halos);
    let mut keys = Vec::new();
    let mut firsts = Vec::with_capacity(n);
    for (brick, cuts) in grid.bricks.iter().zip(&cuts) {
        firsts.push(keys.len() as u32);
        let of_brick = morton_encode(brick.place) << EDGE_BITS;
        keys.extend(cuts.slots().map(|slot| of_brick | slot as u64));
    }
    let edges = Edges { grid, cuts, firsts };
    let of_brick = |numbers: &mut Numbers, number: usize| {
        let (halo, first) = (&halos[number], edges.firsts[number] as usize);
        let vertices = keys[first..].iter().copied().zip(edges.crossings(halo, number)).collect();
        let mut triangles = Vec::new();
        edges.triangles(halo, numbers, &mut triangles);
        let triangles = triangles.iter().map(|corners| corners.map(|v| keys[v as usize])).collect();
        BrickMesh { brick: morton_encode(grid.bricks[number].place), vertices, triangles }
    };
    (0..n)
        .into_par_iter()
        .filter(|&number| wanted(grid.bricks[number].place))
        .map_init(Numbers::default, of_brick)
        .filter(|mesh| !mesh.vertices.is_empty() || !mesh.triangles.is_empty())
        .collect()
}

/// Which dual edges of a brick's own are cut.
struct Cuts {
    /// Bit voxel + 512 direction.
    bits: Box<[u64; WORDS]>,
    /// Set bits before each word.
    before: Box<[u16; WORDS]>,
}

impl Cuts {
    /// Those of all bricks.
    fn of_all(grid: &Grid, halos: &[Halo<'_>]) -> Vec<Self> {
        let (mut cuts, far): (Vec<Self>, Vec<Vec<DualEdge>>) =
            halos.par_iter().map(Self::of).unzip();
        for edge in far.iter().flatten() {
            if let Some(number) = grid.number_at(edge.owner.base.map(|i| i / SIDE)) {
                cuts[number as usize].mark(edge);
            }
        }
        cuts.par_iter_mut().for_each(Self::number);
        cuts
    }

    /// Those of a brick, and edges whose owners are larger than bricks and begin in another.
    fn of(halo: &Halo<'_>) -> (Self, Vec<DualEdge>) {
        let mut cuts = Self { bits: Box::new([0; WORDS]), before: Box::new([0; WORDS]) };
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

    fn count(&self) -> u32 {
        u32::from(self.before[WORDS - 1]) + self.bits[WORDS - 1].count_ones()
    }

    /// The number of an edge among those of the brick.
    #[inline]
    fn rank(&self, slot: usize) -> u32 {
        let (word, bit) = (slot / 64, slot % 64);
        debug_assert!(self.bits[word] >> bit & 1 == 1, "every cut edge was marked");
        u32::from(self.before[word]) + (self.bits[word] & ((1 << bit) - 1)).count_ones()
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
                    if stretched >> x & 1 == 1 {
                        self.stretched_cell(halo, [x, y, z], case, triangles);
                        continue;
                    }
                    let cell = first + x - 1;
                    let corners = |edges: &[u8; 3]| edges.map(|edge| numbers.of(cell, edge.into()));
                    triangles.extend(case.triangles.iter().map(corners));
                }
            }
        }
    }

    /// A cell between voxels of which some are larger.
    fn stretched_cell(
        &self,
        halo: &Halo<'_>,
        at: [usize; 3],
        case: &Case,
        triangles: &mut Vec<[u32; 3]>,
    ) {
        let leaves: [Leaf; 8] = std::array::from_fn(|octant| halo.leaf(octant_at(at, octant)));
        if !halo.is_corner(at, &leaves) {
            return;
        }
        for edges in &case.loops {
            // Of a loop, vertices and the faces that they lie on.
            let (mut vertices, mut faces) = ([0; N_EDGES], [0; N_EDGES]);
            let mut n = 0;
            for &edge in edges {
                let (edge, low) = (edge as usize, lower_octant(edge as usize));
                let axis = axis_of(edge);
                let edge_of = DualEdge::between(leaves[low], leaves[low | 1 << axis], axis);
                let vertex = self.number(halo, &edge_of);
                // Cells that are collapsed have the same edge several times.
                if n == 0 || vertices[n - 1] != vertex {
                    (vertices[n], faces[n]) = (vertex, 0);
                    n += 1;
                }
                faces[n - 1] |= faces_of(edge);
            }
            if n > 1 && vertices[0] == vertices[n - 1] {
                n -= 1;
                faces[0] |= faces[n];
            }
            triangles.extend(fan(&faces[..n]).map(|triangle| triangle.map(|i| vertices[i])));
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
