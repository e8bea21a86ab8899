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

use std::{ops::Range, sync::LazyLock};

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::{
    cases::{CASES, Case, N_EDGES, faces_of, fan},
    cells::CellBits,
    cuts::{Cuts, DualEdge, WORDS},
    grid::{Border, Grid, Leaf, RUN, SIDE, VOXELS, Voxels},
    halo::Halo,
    numbers::{Numbers, STEPS_TO, cell_at},
};
use crate::math::morton_encode;

/// Cut edges stay away from both ends of the zone in which they are looked for by this part of it:
/// large enough for f32 to tell them apart in grids of 16384 voxels, so that values equal to the
/// isovalue leave no triangle without area.
pub const LEAST_PART: f64 = 1.0 / 256.0;

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
pub fn extract<B: Voxels, T: Copy + Default + Send>(
    grid: &Grid<B>,
    vertex: impl Fn(&Crossing) -> T + Sync,
) -> Extraction<T> {
    let n = grid.bricks.len();
    let cuts = Cuts::of_all(grid);
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
            let halo = Halo::new(grid, number);
            let cells = halo.cells();
            edges.each_crossing(&halo, &cells, |_, crossing| {
                if let Some(place) = own.next() {
                    *place = vertex(crossing);
                }
            });
            edges.triangles(&halo, &cells, &mut numbers, &mut triangles);
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
pub fn extract_bricks<B: Voxels>(
    grid: &Grid<B>,
    wanted: impl Fn([u32; 3]) -> bool + Sync,
) -> Vec<BrickMesh> {
    let n = grid.bricks.len();
    let cuts = Cuts::of_all(grid);
    let mut keys = Vec::new();
    let mut firsts = Vec::with_capacity(n);
    for (brick, cuts) in grid.bricks.iter().zip(&cuts) {
        firsts.push(keys.len() as u32);
        let of_brick = morton_encode(brick.place) << EDGE_BITS;
        keys.extend(cuts.slots().map(|slot| of_brick | slot as u64));
    }
    let edges = Edges { grid, cuts, firsts };
    let of_brick = |numbers: &mut Numbers, number: usize| {
        let (halo, brick) = (Halo::new(grid, number), morton_encode(grid.bricks[number].place));
        let cells = halo.cells();
        let mut vertices = Vec::with_capacity(edges.cuts[number].count() as usize);
        edges.each_crossing(&halo, &cells, |slot, crossing| {
            vertices.push((brick << EDGE_BITS | slot as u64, *crossing));
        });
        let mut triangles = Vec::new();
        edges.triangles(&halo, &cells, numbers, &mut triangles);
        let triangles = triangles.iter().map(|corners| corners.map(|v| keys[v as usize])).collect();
        BrickMesh { brick, vertices, triangles }
    };
    (0..n)
        .into_par_iter()
        .filter(|&number| wanted(grid.bricks[number].place))
        .map_init(Numbers::default, of_brick)
        .filter(|mesh| !mesh.vertices.is_empty() || !mesh.triangles.is_empty())
        .collect()
}

/// All cut dual edges, with numbers.
pub(super) struct Edges<'a, B> {
    grid: &'a Grid<B>,
    /// By brick.
    pub(super) cuts: Vec<Cuts>,
    /// The number of the first vertex of each brick.
    pub(super) firsts: Vec<u32>,
}

impl<B: Voxels> Edges<'_, B> {
    /// Calls `tell` with the place and the vertex of every cut edge of a brick's own, in order.
    #[inline]
    fn each_crossing(
        &self,
        halo: &Halo<'_, B>,
        cells: &CellBits,
        mut tell: impl FnMut(usize, &Crossing),
    ) {
        let cuts = &self.cuts[halo.number()];
        self.each_upwards::<0>(halo, cells, cuts, &mut tell);
        self.each_upwards::<1>(halo, cells, cuts, &mut tell);
        self.each_upwards::<2>(halo, cells, cuts, &mut tell);
        for word in WORDS / 2..WORDS {
            cuts.each(word, u64::MAX, |bit, _| {
                let slot = 64 * word + bit;
                tell(slot, &self.crossing(halo, slot % VOXELS, slot / VOXELS));
            });
        }
    }

    /// Those that leave voxels along an axis.
    #[inline]
    fn each_upwards<const AXIS: usize>(
        &self,
        halo: &Halo<'_, B>,
        cells: &CellBits,
        cuts: &Cuts,
        tell: &mut impl FnMut(usize, &Crossing),
    ) {
        let first = halo.origin.map(|i| i.wrapping_add(1).wrapping_sub(SIDE) as f32 + 0.5);
        for z in 0..SIDE as usize {
            // Edges between two of the finest voxels, which are most.
            let coarse = cells.coarse.at(0, z) | cells.coarse.after(0, z, AXIS);
            let plain = if halo.is_bordering { 0 } else { !coarse };
            let word = 8 * AXIS + z;
            cuts.each(word, u64::MAX, |bit, _| {
                let index = 64 * z + bit;
                let slot = VOXELS * AXIS + index;
                if plain >> bit & 1 == 0 {
                    return tell(slot, &self.crossing(halo, index, AXIS));
                }
                let offsets = halo.offsets_along::<AXIS>(index);
                let steps = [bit % 8, bit / 8, z];
                let lower = [0, 1, 2].map(|axis| first[axis] + steps[axis] as f32);
                let mut upper = lower;
                upper[AXIS] += 1.0;
                let (ends, part) = ([lower, upper], zone(offsets));
                tell(slot, &Crossing { ends, offsets, part, is_cap: false });
            });
        }
    }

    /// The vertex on the edge that leaves the voxel number `index` of a brick in a direction.
    #[inline]
    fn crossing(&self, halo: &Halo<'_, B>, index: usize, direction: usize) -> Crossing {
        let at = [1 + index % 8, 1 + index / 8 % 8, 1 + index / 64];
        let (axis, is_up) = (direction % 3, direction < 3);
        let own = halo.voxel(at);
        let other = halo.beside(at, &own.0, axis, is_up);
        let ((lower, f), (upper, g)) = if is_up { (own, other) } else { (other, own) };
        if !halo.is_bordering {
            let half = |leaf: &Leaf| 0.5 * (1_u32 << leaf.level) as f32;
            let middle = |leaf: &Leaf| {
                let along = |axis: usize| (leaf.base[axis] - SIDE) as f32 + half(leaf);
                [along(0), along(1), along(2)]
            };
            let halves = [&lower, &upper].map(|leaf| half(leaf).into());
            let ends = [middle(&lower), middle(&upper)];
            return Crossing { ends, offsets: [f, g], part: part(halves, [f, g]), is_cap: false };
        }
        let grid = self.grid;
        let ends = [grid.middle(&lower), grid.middle(&upper)];
        let is_cap =
            grid.border == Border::Capped && (grid.is_phantom(&lower) || grid.is_phantom(&upper));
        let part = if is_cap {
            // The cap lies on the border.
            if grid.is_phantom(&upper) { 1.0 } else { 0.0 }
        } else {
            part([&lower, &upper].map(|leaf| grid.half_depth(leaf, axis)), [f, g])
        };
        Crossing { ends, offsets: [f, g], part, is_cap }
    }

    /// The triangles of the cells whose first voxel is in a brick.
    #[inline]
    fn triangles(
        &self,
        halo: &Halo<'_, B>,
        cells: &CellBits,
        numbers: &mut Numbers,
        triangles: &mut Vec<[u32; 3]>,
    ) {
        numbers.fill(self, halo, cells);
        let plain = &*PLAIN;
        for z in 0..SIDE as usize {
            let mut rest = cells.mixed(z);
            if rest == 0 {
                continue;
            }
            let collapsed = if halo.has_coarse { cells.at_large(z) } else { 0 };
            while rest != 0 {
                let bit = rest.trailing_zeros() as usize;
                rest &= rest - 1;
                let (case, at) = (cells.case(z, bit), [1 + bit % 8, 1 + bit / 8, 1 + z]);
                if collapsed >> bit & 1 == 1 {
                    collapsed_cell(halo, at, &CASES[case], numbers, triangles);
                    continue;
                }
                let Plain { n, corners } = &plain[case];
                let cell = cell_at(at);
                for &[a, b, c] in &corners[..*n] {
                    let corner = |steps| numbers.of(cell, steps);
                    triangles.push([corner(a), corner(b), corner(c)]);
                }
            }
        }
    }

    /// The number of the vertex on a cut edge.
    pub(super) fn number(&self, halo: &Halo<'_, B>, edge: &DualEdge) -> u32 {
        let brick = halo.number_of(edge.owner.base);
        self.firsts[brick] + self.cuts[brick].rank(edge.slot())
    }
}

/// The triangles of a cell with vertices on edges between voxels that are larger than the finest, of
/// which some may be one.
fn collapsed_cell<B: Voxels>(
    halo: &Halo<'_, B>,
    at: [usize; 3],
    case: &Case,
    numbers: &Numbers,
    triangles: &mut Vec<[u32; 3]>,
) {
    if !halo.is_corner(at) {
        return;
    }
    let cell = cell_at(at);
    for edges in &case.loops {
        // Of a loop, vertices and the faces that they lie on.
        let (mut vertices, mut faces) = ([0; N_EDGES], [0; N_EDGES]);
        let mut n = 0;
        for &edge in edges {
            let vertex = numbers.of(cell, STEPS_TO[usize::from(edge)]);
            // Cells that are collapsed have the same edge several times.
            if n == 0 || vertices[n - 1] != vertex {
                (vertices[n], faces[n]) = (vertex, 0);
                n += 1;
            }
            faces[n - 1] |= faces_of(edge.into());
        }
        if n > 1 && vertices[0] == vertices[n - 1] {
            n -= 1;
            faces[0] |= faces[n];
        }
        triangles.extend(fan(&faces[..n]).map(|triangle| triangle.map(|i| vertices[i])));
    }
}

/// The triangles of a cell that is not collapsed: where the numbers of their vertices stand after the
/// cell's place.
#[derive(Clone, Copy, Default)]
struct Plain {
    n: usize,
    corners: [[u16; 3]; 5],
}

/// By the octants that lie inside, as bits.
static PLAIN: LazyLock<Vec<Plain>> = LazyLock::new(|| {
    let plain = |case: &Case| {
        let mut plain = Plain { n: case.triangles.len(), ..Plain::default() };
        for (corners, edges) in plain.corners.iter_mut().zip(&case.triangles) {
            *corners = edges.map(|edge| STEPS_TO[usize::from(edge)]);
        }
        plain
    };
    CASES.iter().map(plain).collect()
});

/// Where between the middles of two voxels a vertex is, given how far they are from the face that both
/// share: at most half a finest voxel from that, on either side.
#[inline]
fn part([to_lower, to_upper]: [f64; 2], offsets: [f32; 2]) -> f64 {
    let [before, behind] = [to_lower, to_upper].map(|depth| depth.min(0.5));
    (to_lower - before + zone(offsets) * (before + behind)) / (to_lower + to_upper)
}

/// Where between two values, as they are above the isovalue, the isovalue is.
#[inline]
pub(super) fn zone([f, g]: [f32; 2]) -> f64 {
    let zone = f64::from(f) / (f64::from(f) - f64::from(g));
    // Without a number at one end, the middle.
    let zone = if zone.is_finite() { zone } else { 0.5 };
    zone.clamp(LEAST_PART, 1.0 - LEAST_PART)
}
