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

use std::sync::LazyLock;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::{
    cases::{CASES, Case, Loop},
    cells::CellBits,
    cuts::{Cuts, DualEdge},
    grid::{Border, Grid, Leaf, RUN, SIDE, VOXELS, Voxels},
    halo::Halo,
    numbers::{Numbers, STEPS_TO, cell_at},
    runs::{Part, close_up, shared_out},
    values::Values,
};

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
    let mut cuts = vec![Cuts::default(); grid.bricks.len()];
    Cuts::find(&mut cuts, grid, |_| true);
    let firsts = Cuts::firsts(&cuts);
    let edges = Edges { grid, cuts, firsts };
    let n_vertices: u32 = edges.cuts.iter().map(Cuts::count).sum();
    let room: usize = edges.cuts.iter().map(Cuts::room).sum();
    let mut vertices = vec![T::default(); n_vertices as usize];
    let mut triangles = vec![[0; 3]; room];
    let parts = shared_out(&edges.cuts, &mut vertices, &mut triangles);
    let extract = |(bricks, vertices, triangles): Part<'_, T>| {
        let (room, mut vertices) = (triangles.len(), vertices.iter_mut());
        let mut triangles = triangles.iter_mut();
        let (mut values, mut numbers) = (Values::default(), Numbers::default());
        for number in bricks.filter(|&number| !edges.cuts[number].is_empty()) {
            let halo = Halo::new(grid, number);
            let cells = halo.cells();
            edges.each_crossing(&halo, &cells, (&mut values, &mut numbers), |crossing| {
                if let Some(place) = vertices.next() {
                    *place = vertex(crossing);
                }
            });
            edges.each_triangle(&halo, &cells, &mut numbers, |triangle| {
                if let Some(place) = triangles.next() {
                    *place = triangle;
                }
            });
        }
        [room, room - triangles.len()]
    };
    let found: Vec<[usize; 2]> = parts.into_par_iter().map(extract).collect();
    close_up(&mut triangles, &found);
    Extraction { vertices, triangles }
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
pub(super) fn extract_parts<B: Voxels>(
    grid: &Grid<B>,
    wanted: &[usize],
    known: impl Fn(usize) -> Option<Cuts>,
) -> Parts {
    let is_wanted = |number: usize| wanted.binary_search(&number).is_ok();
    let of_brick = |number: usize| match is_wanted(number) {
        true => Cuts::default(),
        false => known(number).unwrap_or_default(),
    };
    let mut cuts: Vec<Cuts> = (0..grid.bricks.len()).map(of_brick).collect();
    Cuts::find(&mut cuts, grid, is_wanted);
    let firsts = Cuts::firsts(&cuts);
    let edges = Edges { grid, cuts, firsts };
    let run = |wanted: &[usize]| {
        let n: u32 = wanted.iter().map(|&number| edges.cuts[number].count()).sum();
        let mut vertices = Vec::with_capacity(n as usize);
        let mut triangles = Vec::with_capacity(5 * n as usize / 2);
        let (mut values, mut numbers) = (Values::default(), Numbers::default());
        let of_brick = |&number: &usize| {
            let before = triangles.len();
            let halo = Halo::new(grid, number);
            let cells = halo.cells();
            let push = |crossing: &Crossing| vertices.push(*crossing);
            edges.each_crossing(&halo, &cells, (&mut values, &mut numbers), push);
            edges.each_triangle(&halo, &cells, &mut numbers, |triangle| triangles.push(triangle));
            (number, triangles.len() - before)
        };
        let bricks = wanted.iter().map(of_brick).collect();
        Run { bricks, vertices, triangles }
    };
    let runs = wanted.par_chunks(RUN).map(run).collect();
    let Edges { cuts, firsts, .. } = edges;
    Parts { cuts, firsts, runs }
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
    /// Calls `tell` with the vertex on every cut edge of a brick's own, in order, and sets the numbers of
    /// those on edges that leave voxels along an axis.
    #[inline]
    fn each_crossing(
        &self,
        halo: &Halo<'_, B>,
        cells: &CellBits,
        mut own: (&mut Values<B>, &mut Numbers),
        mut tell: impl FnMut(&Crossing),
    ) {
        self.each_upwards::<0>(halo, cells, &mut own, &mut tell);
        self.each_upwards::<1>(halo, cells, &mut own, &mut tell);
        self.each_upwards::<2>(halo, cells, &mut own, &mut tell);
        let cuts = &self.cuts[halo.number()];
        for word in cuts.downwards() {
            cuts.each(word, u64::MAX, |bit, _| {
                let slot = 64 * word + bit;
                tell(&self.crossing(halo, slot % VOXELS, slot / VOXELS));
            });
        }
    }

    /// Those that leave voxels along an axis.
    #[inline]
    fn each_upwards<const AXIS: usize>(
        &self,
        halo: &Halo<'_, B>,
        cells: &CellBits,
        (values, numbers): &mut (&mut Values<B>, &mut Numbers),
        tell: &mut impl FnMut(&Crossing),
    ) {
        let (cuts, first_number) = (&self.cuts[halo.number()], self.firsts[halo.number()]);
        let first = [0, 1, 2].map(|axis| halo.first(axis).wrapping_sub(SIDE) as f32 + 0.5);
        let inner = halo.without_phantoms(AXIS);
        for z in 0..SIDE as usize {
            // Edges between two of the finest voxels, which are most.
            let coarse = cells.coarse.at(0, z) | cells.coarse.after(0, z, AXIS);
            let plain = inner[z] & !coarse;
            cuts.each(8 * AXIS + z, u64::MAX, |bit, rank| {
                let (index, steps) = (64 * z + bit, [bit % 8, bit / 8, z]);
                numbers.set::<AXIS>(steps, first_number + rank);
                if plain >> bit & 1 == 0 {
                    return tell(&self.crossing(halo, index, AXIS));
                }
                let offsets = values.along::<AXIS>(halo, index);
                let lower = [0, 1, 2].map(|axis| first[axis] + steps[axis] as f32);
                let mut upper = lower;
                upper[AXIS] += 1.0;
                let (ends, part) = ([lower, upper], zone(offsets));
                tell(&Crossing { ends, offsets, part, is_cap: false });
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

    /// Calls `tell` with the triangles of the cells whose first voxel is in a brick.
    #[inline]
    fn each_triangle(
        &self,
        halo: &Halo<'_, B>,
        cells: &CellBits,
        numbers: &mut Numbers,
        mut tell: impl FnMut([u32; 3]),
    ) {
        numbers.fill(self, halo, cells);
        let plain = &*PLAIN;
        for z in 0..SIDE as usize {
            let collapsed = if halo.has_coarse { cells.at_large(z) } else { 0 };
            cells.each_mixed(z, |bit, case| {
                let at = [1 + bit % 8, 1 + bit / 8, 1 + z];
                if collapsed >> bit & 1 == 1 {
                    return each_collapsed(halo, at, &CASES[case], numbers, &mut tell);
                }
                let Plain { n, corners } = &plain[case];
                let cell = cell_at(at);
                for corners in &corners[..*n] {
                    tell(corners.map(|steps| numbers.of(cell, steps)));
                }
            });
        }
    }

    /// The number of the vertex on a cut edge.
    pub(super) fn number(&self, halo: &Halo<'_, B>, edge: &DualEdge) -> u32 {
        let brick = halo.number_of(edge.owner.base);
        self.firsts[brick] + self.cuts[brick].rank(edge.slot())
    }
}

/// Calls `tell` with the triangles of a cell with vertices on edges between voxels that are larger than
/// the finest, of which some may be one.
fn each_collapsed<B: Voxels>(
    halo: &Halo<'_, B>,
    at: [usize; 3],
    case: &Case,
    numbers: &Numbers,
    tell: &mut impl FnMut([u32; 3]),
) {
    if !halo.is_corner(at) {
        return;
    }
    let cell = cell_at(at);
    for edges in &case.loops {
        let vertex = |edge: u8| numbers.of(cell, STEPS_TO[usize::from(edge)]);
        Loop::collapsed(edges, vertex).triangles().for_each(&mut *tell);
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
