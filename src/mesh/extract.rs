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

use rayon::prelude::*;

use super::{
    cases::{CASES, N_EDGES, axis_of, faces_of, fan, lower_octant},
    grid::{Border, Grid, Leaf, VOXELS, index_of},
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The ends of the dual edge, in the finest voxels from the grid's first corner.
    pub ends: [[f64; 3]; 2],
    /// The values there.
    pub values: [f64; 2],
    /// Where between the ends it is, in (0, 1].
    pub part: f64,
    /// Whether one of the ends is what a capped border has beyond it.
    pub is_cap: bool,
}

impl Crossing {
    /// Where it is, in the finest voxels from the grid's first corner.
    #[must_use]
    pub fn point(&self) -> [f64; 3] {
        let [a, b] = self.ends;
        [0, 1, 2].map(|axis| a[axis] + self.part * (b[axis] - a[axis]))
    }
}

/// Vertices and triangles, counter-clockwise as seen from outside. Cells that have collapsed may leave
/// a vertex that no triangle has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extraction {
    /// In the order of bricks, directions and voxels.
    pub crossings: Vec<Crossing>,
    /// In the order of bricks and cells.
    pub triangles: Vec<[u32; 3]>,
}

/// Finds the surface where values are the isovalue of `grid`.
#[must_use]
pub fn extract(grid: &Grid) -> Extraction {
    let n = grid.bricks.len();
    let cuts: Vec<Cuts> =
        (0..n).into_par_iter().map(|number| Cuts::of(&Halo::new(grid, number))).collect();
    let mut first = 0;
    let firsts: Vec<u32> = cuts
        .iter()
        .map(|cuts| {
            let own = first;
            first += cuts.count();
            own
        })
        .collect();
    let edges = Edges { grid, cuts, firsts };
    let crossings: Vec<Vec<Crossing>> = (0..n)
        .into_par_iter()
        .map(|number| edges.crossings(&Halo::new(grid, number), number))
        .collect();
    let triangles: Vec<Vec<[u32; 3]>> =
        (0..n).into_par_iter().map(|number| edges.triangles(&Halo::new(grid, number))).collect();
    Extraction { crossings: crossings.concat(), triangles: triangles.concat() }
}

/// Which dual edges of a brick's own are cut.
struct Cuts {
    /// Bit voxel + 512 direction.
    bits: Box<[u64; WORDS]>,
    /// Set bits before each word.
    before: Box<[u16; WORDS]>,
}

impl Cuts {
    fn of(halo: &Halo<'_>) -> Self {
        let mut bits = Box::new([0_u64; WORDS]);
        for axis in 0..3 {
            for z in 0..WIDTH - 1 {
                for y in 0..WIDTH - 1 {
                    let cut = halo.cut(axis, y, z);
                    if halo.is_finest {
                        // The lower voxel of each edge is its owner.
                        if y > 0 && z > 0 {
                            bits[8 * axis + z - 1] |= u64::from(cut >> 1 & 0xff) << (8 * (y - 1));
                        }
                        continue;
                    }
                    for x in (0..WIDTH - 1).filter(|x| cut >> x & 1 == 1) {
                        let edge = halo.edge([x, y, z], axis);
                        if halo.owns(edge.owner.base) {
                            let slot = edge.slot();
                            bits[slot / 64] |= 1 << (slot % 64);
                        }
                    }
                }
            }
        }
        let mut n = 0;
        let before = Box::new(std::array::from_fn(|word| {
            let own = n;
            n += bits[word].count_ones() as u16;
            own
        }));
        Self { bits, before }
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
}

/// A dual edge.
#[derive(Clone, Copy, Debug)]
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
    fn crossings(&self, halo: &Halo<'_>, number: usize) -> Vec<Crossing> {
        let cuts = &self.cuts[number];
        let mut crossings = Vec::with_capacity(cuts.count() as usize);
        for (word, &bits) in cuts.bits.iter().enumerate() {
            let mut rest = bits;
            while rest != 0 {
                let slot = 64 * word + rest.trailing_zeros() as usize;
                rest &= rest - 1;
                crossings.push(self.crossing(halo, slot % VOXELS, slot / VOXELS));
            }
        }
        crossings
    }

    /// The vertex on the edge that leaves the voxel number `index` of a brick in a direction.
    fn crossing(&self, halo: &Halo<'_>, index: usize, direction: usize) -> Crossing {
        let at = [1 + index % 8, 1 + index / 8 % 8, 1 + index / 64];
        let (owner, own_value) = halo.voxel(at);
        let (axis, is_up) = (direction % 3, direction < 3);
        let mut beside = owner.base;
        beside[axis] = match is_up {
            true => beside[axis] + (1 << self.grid.thickness(&owner, axis)),
            false => beside[axis] - 1,
        };
        let (other, other_value) = halo.voxel_at(beside);
        let ((lower, lower_value), (upper, upper_value)) = match is_up {
            true => ((owner, own_value), (other, other_value)),
            false => ((other, other_value), (owner, own_value)),
        };
        let grid = self.grid;
        let ends = [grid.middle(&lower), grid.middle(&upper)];
        let is_cap =
            grid.border == Border::Capped && (grid.is_phantom(&lower) || grid.is_phantom(&upper));
        let part = if is_cap {
            // The cap lies on the border.
            if grid.is_phantom(&upper) { 1.0 } else { 0.0 }
        } else {
            let zone = (grid.isovalue - lower_value) / (upper_value - lower_value);
            // Without a number at one end, the middle.
            let zone = if zone.is_finite() { zone } else { 0.5 };
            let zone = zone.clamp(LEAST_PART, 1.0 - LEAST_PART);
            // From the face that both share to the middles, and to the borders of the zone: half a
            // finest voxel on either side, or nothing where there is only a border.
            let [to_lower, to_upper] = [&lower, &upper].map(|leaf| grid.half_depth(leaf, axis));
            let [before, behind] = [to_lower, to_upper].map(|depth| depth.min(0.5));
            (to_lower - before + zone * (before + behind)) / (to_lower + to_upper)
        };
        Crossing { ends, values: [lower_value, upper_value], part, is_cap }
    }

    /// The triangles of the cells at a brick's corners.
    fn triangles(&self, halo: &Halo<'_>) -> Vec<[u32; 3]> {
        let mut triangles = Vec::new();
        for z in 0..WIDTH - 2 {
            for y in 0..WIDTH - 2 {
                let mut mixed = halo.mixed(y, z);
                while mixed != 0 {
                    let x = mixed.trailing_zeros() as usize;
                    mixed &= mixed - 1;
                    if halo.is_finest {
                        self.cell(halo, [x, y, z], &mut triangles);
                    } else {
                        self.stretched_cell(halo, [x, y, z], &mut triangles);
                    }
                }
            }
        }
        triangles
    }

    /// A cell between eight of the finest voxels, the first at `at`.
    fn cell(&self, halo: &Halo<'_>, at: [usize; 3], triangles: &mut Vec<[u32; 3]>) {
        let mut inside = 0;
        for octant in 0..8 {
            inside |= usize::from(halo.is_inside(octant_at(at, octant))) << octant;
        }
        let case = &CASES[inside];
        let mut vertices = [u32::MAX; N_EDGES];
        for &edge in case.loops.iter().flatten() {
            let (edge, lower) = (edge as usize, octant_at(at, lower_octant(edge as usize)));
            let (number, index) = halo.place(lower);
            let slot = VOXELS * axis_of(edge) + index;
            vertices[edge] = self.firsts[number] + self.cuts[number].rank(slot);
        }
        let corners = |edges: &[u8; 3]| edges.map(|edge| vertices[edge as usize]);
        triangles.extend(case.triangles.iter().map(corners));
    }

    /// A cell between voxels of which some are larger.
    fn stretched_cell(&self, halo: &Halo<'_>, at: [usize; 3], triangles: &mut Vec<[u32; 3]>) {
        let mut leaves = [Leaf { base: [0; 3], level: 0 }; 8];
        let mut inside = 0;
        for (octant, leaf) in leaves.iter_mut().enumerate() {
            let place = octant_at(at, octant);
            *leaf = halo.voxel(place).0;
            inside |= usize::from(halo.is_inside(place)) << octant;
        }
        if !halo.is_corner(at, &leaves) {
            return;
        }
        let mut corners: Vec<(u32, u8)> = Vec::new();
        for edges in &CASES[inside].loops {
            corners.clear();
            for &edge in edges {
                let (edge, low) = (edge as usize, lower_octant(edge as usize));
                let axis = axis_of(edge);
                let edge_of = DualEdge::between(leaves[low], leaves[low | 1 << axis], axis);
                let corner = (self.number(halo, &edge_of), faces_of(edge));
                // Cells that are collapsed have the same edge several times.
                match corners.last_mut() {
                    Some(last) if last.0 == corner.0 => last.1 |= corner.1,
                    _ => corners.push(corner),
                }
            }
            if corners.len() > 1 && corners[0].0 == corners[corners.len() - 1].0 {
                corners[0].1 |= corners[corners.len() - 1].1;
                corners.pop();
            }
            let faces: Vec<u8> = corners.iter().map(|corner| corner.1).collect();
            triangles.extend(fan(&faces).map(|triangle| triangle.map(|i| corners[i].0)));
        }
    }

    /// The number of the vertex on a cut edge.
    fn number(&self, halo: &Halo<'_>, edge: &DualEdge) -> u32 {
        let brick = halo.number_of(edge.owner.base);
        self.firsts[brick] + self.cuts[brick].rank(edge.slot())
    }
}

/// An octant of the cell whose first voxel is at `at`.
#[inline]
fn octant_at([x, y, z]: [usize; 3], octant: usize) -> [usize; 3] {
    [x + (octant & 1), y + (octant >> 1 & 1), z + (octant >> 2)]
}
