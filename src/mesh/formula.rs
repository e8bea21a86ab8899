//! Meshes of formulas: values in the middles of the voxels that the surface may meet and of their
//! neighbours, and vertices moved onto the surface itself.
//!
//! Where the values of two neighbours differ in sign, the line between their middles meets the surface in
//! one of the two, which is stored then: no cut edge is missing.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::{
    Border, Brick, Crossing, Extraction, Grid, LEAST_PART, Mesh, SIDE, VOXELS,
    cut::cut_to_region,
    extract,
    grid::is_inside,
    near::{ALL, Bits, Voxels, near, sides},
    offset,
};
use crate::{
    eval::{Sample, sampler},
    expr::Tape,
    math::{Aabb, Lattice, SimdLevel},
    octree::{Occupancy, Storage},
    voxelize::{BLOCK_LEVELS, Wish, find_blocks},
};

/// Where vertices are put on dual edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VertexPlace {
    /// On the surface, found along the dual edge.
    #[default]
    Polished,
    /// Where a value between those at the ends would be 0, as for samples.
    Linear,
}

/// How a formula becomes a mesh.
#[derive(Clone, Copy, Debug)]
pub struct FormulaSettings {
    /// What the surface does at the border of the domain.
    pub border: Border,
    /// Where vertices are put.
    pub vertex: VertexPlace,
    /// The instruction set.
    pub simd: SimdLevel,
}

/// The mesh of F = 0, with F < 0 inside, from the voxels that it may meet.
#[must_use]
pub fn of_formula(
    tape: &Tape,
    storage: &dyn Storage,
    lattice: &Lattice,
    settings: &FormulaSettings,
) -> Mesh {
    let tapes = Tapes::new(tape, lattice, settings.simd);
    let grid = grid(&tapes, storage, lattice, settings);
    let Extraction { vertices: crossings, triangles } = extract(&grid, |crossing| *crossing);
    drop(grid);
    let (first, edges) = (lattice.bounds().min, lattice.voxel_size());
    let to_scene = |p: [f64; 3]| first + edges * DVec3::from_array(p);
    let n = crossings.len();
    let mut mesh =
        Mesh { positions: vec![[0.0; 3]; n], normals: vec![[0.0; 3]; n], ..Mesh::default() };
    mesh.triangles = triangles;
    let places = mesh.positions.par_chunks_mut(CHUNK).zip(mesh.normals.par_chunks_mut(CHUNK));
    crossings.par_chunks(CHUNK).zip(places).for_each_init(
        || sampler(settings.simd),
        |sampler, (some, (positions, normals))| {
            for (tape, members) in tapes.of_edges(some) {
                let some: Vec<Crossing> = members.iter().map(|&i| some[i]).collect();
                let points = match settings.vertex {
                    VertexPlace::Polished => polished(&some, tape, &to_scene, &mut **sampler),
                    VertexPlace::Linear => some.iter().map(|c| to_scene(c.point())).collect(),
                };
                let gradients = sampler.gradients(tape, &points);
                for (((i, crossing), point), gradient) in
                    members.into_iter().zip(&some).zip(points).zip(gradients)
                {
                    positions[i] = point.as_vec3().to_array();
                    normals[i] = normal(crossing, gradient).as_vec3().to_array();
                }
            }
        },
    );
    cut_to_region(&mut mesh, tape, &mut *sampler(settings.simd));
    mesh.drop_unused();
    mesh
}

/// Vertices that a thread places at a time.
const CHUNK: usize = 1 << 10;

/// The grid of the values of −F: inside is what is not negative.
fn grid(
    tapes: &Tapes<'_>,
    storage: &dyn Storage,
    lattice: &Lattice,
    settings: &FormulaSettings,
) -> Grid {
    let mut needed = near(storage);
    if tapes.whole.region().is_some() {
        // What lies beyond the region is not stored.
        needed.values_mut().for_each(|bits| *bits = ALL);
    }
    if settings.border == Border::Capped {
        let caps = bricks_of_caps(storage, lattice.n_voxels(), &needed);
        needed.extend(caps.into_iter().map(|place| (place, ALL)));
    }
    let size = lattice.n_voxels();
    let bounds = lattice.bounds();
    // Coordinates along each axis, those of phantoms on the border.
    let at = |axis: usize, i: u32| match i.checked_sub(SIDE) {
        None => bounds.min[axis],
        Some(i) if i >= size[axis] => bounds.max[axis],
        Some(i) => 0.5 * (lattice.corner(axis, i) + lattice.corner(axis, i + 1)),
    };
    let brick = |sampler: &mut Box<dyn Sample>, (place, needed): ([u32; 3], Bits)| {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let at = |i| at(axis, place[axis] * SIDE + i);
            std::array::from_fn::<f64, { SIDE as usize }, _>(|i| at(i as u32))
        });
        let side = SIDE as usize;
        let point = |i: usize| DVec3::new(x[i % side], y[i / side % side], z[i / side / side]);
        let voxels = voxels_of(&needed);
        let points: Vec<DVec3> = voxels.iter().map(|&i| point(i)).collect();
        let values = sampler.values(tapes.of_brick(place), &points);
        let mut offsets = [0.0; VOXELS];
        let mut inside = Bits::default();
        for (&i, value) in voxels.iter().zip(values) {
            offsets[i] = offset(0.0, value);
            inside[i / 64] |= u64::from(is_inside(offsets[i])) << (i % 64);
        }
        if needed != ALL {
            let inside = sides(needed, inside);
            let others = needed.map(|bits| !bits);
            for i in voxels_of(&others) {
                offsets[i] = if inside[i / 64] >> (i % 64) & 1 == 1 { f32::MAX } else { f32::MIN };
            }
        }
        if settings.border == Border::Capped {
            for (i, offset) in offsets.iter_mut().enumerate() {
                let within = [i % side, i / side % side, i / side / side];
                let is_beyond = (0..3).any(|axis| {
                    !(SIDE..SIDE + size[axis]).contains(&(place[axis] * SIDE + within[axis] as u32))
                });
                if is_beyond {
                    *offset = f32::MIN;
                }
            }
        }
        Brick::new(place, &offsets, &[0])
    };
    // The grid sorts them.
    let needed: Vec<([u32; 3], Bits)> = needed.into_iter().collect();
    let bricks = needed.into_par_iter().map_init(|| sampler(settings.simd), brick).collect();
    Grid::new(bricks, size, settings.border)
}

/// The numbers of the voxels of a brick that have a bit.
fn voxels_of(bits: &Bits) -> Vec<usize> {
    let mut voxels = Vec::with_capacity(VOXELS);
    for (z, &slice) in bits.iter().enumerate() {
        let mut rest = slice;
        while rest != 0 {
            voxels.push(64 * z + rest.trailing_zeros() as usize);
            rest &= rest - 1;
        }
    }
    voxels
}

/// The bricks at the border that may hold voxels inside, and their neighbours: caps run through them.
/// Those in `near` may, whatever their first voxel is.
fn bricks_of_caps(storage: &dyn Storage, size: [u32; 3], near: &Voxels) -> FxHashSet<[u32; 3]> {
    let mut bricks = FxHashSet::default();
    let n = size.map(|n| n.div_ceil(SIDE));
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for side in [0, n[axis] - 1] {
            for i in 0..n[u] {
                for j in 0..n[v] {
                    let mut place = [0; 3];
                    (place[axis], place[u], place[v]) = (side, i, j);
                    // Bricks without stored voxels are all inside or all outside.
                    if near.contains_key(&place.map(|i| i + 1))
                        || storage.occupancy(place.map(|i| i * SIDE)) == Occupancy::Inside
                    {
                        let around = |k: u32| [k % 3, k / 3 % 3, k / 9];
                        let places = (0..27).map(around);
                        bricks.extend(places.map(|k| [0, 1, 2].map(|axis| place[axis] + k[axis])));
                    }
                }
            }
        }
    }
    bricks
}

/// F, and what it is in blocks of 32³ voxels.
struct Tapes<'a> {
    whole: &'a Tape,
    /// Those of the blocks that the surface may meet, if F can be shortened.
    of_blocks: HashMap<[u32; 3], Tape>,
    /// The number of the last voxel along each axis.
    last: [u32; 3],
}

impl<'a> Tapes<'a> {
    fn new(whole: &'a Tape, lattice: &Lattice, simd: SimdLevel) -> Self {
        let last = lattice.n_voxels().map(|n| n - 1);
        let mut of_blocks = HashMap::new();
        if whole.n_choices() > 0 && lattice.depth() > BLOCK_LEVELS {
            let wish = |level: u32, _: &Aabb| match level + BLOCK_LEVELS >= lattice.depth() {
                true => Wish::Keep,
                false => Wish::Divide,
            };
            for block in find_blocks(whole.clone(), lattice, simd, &wish) {
                of_blocks.insert(block.ijk.map(|i| i as u32), (*block.tape).clone());
            }
        }
        Self { whole, of_blocks, last }
    }

    /// F in a brick.
    fn of_brick(&self, place: [u32; 3]) -> &Tape {
        let block = place.map(|i| i.wrapping_sub(1) >> (BLOCK_LEVELS - SIDE.ilog2()));
        self.of_blocks.get(&block).unwrap_or(self.whole)
    }

    /// The numbers of edges that lie in one block, with F there, and of those that do not.
    fn of_edges(&self, edges: &[Crossing]) -> Vec<(&Tape, Vec<usize>)> {
        if self.of_blocks.is_empty() {
            return vec![(self.whole, (0..edges.len()).collect())];
        }
        let block = |end: [f32; 3]| {
            [0, 1, 2].map(|axis| (end[axis] as u32).min(self.last[axis]) >> BLOCK_LEVELS)
        };
        let mut groups: Vec<([u32; 3], &Tape, Vec<usize>)> = Vec::new();
        let mut others = Vec::new();
        for (i, edge) in edges.iter().enumerate() {
            let [own, other] = edge.ends.map(block);
            let Some(tape) = self.of_blocks.get(&own).filter(|_| own == other) else {
                others.push(i);
                continue;
            };
            match groups.last_mut() {
                Some((block, _, members)) if *block == own => members.push(i),
                _ => groups.push((own, tape, vec![i])),
            }
        }
        let groups = groups.into_iter().map(|(_, tape, members)| (tape, members));
        groups.chain([(self.whole, others)]).collect()
    }
}

/// Steps that are enough for any bracket, by bisection alone.
const MAX_STEPS: usize = 50;

/// Part of a dual edge to which vertices are found; files keep fewer digits.
const PRECISION: f64 = 1e-7;

/// Where F is 0 between the ends of a dual edge, and what is known of it.
///
/// *Based on:* T. Chandrupatla, "A new hybrid quadratic/bisection algorithm for finding the zero of a
/// nonlinear function without using derivatives", Advances in Engineering Software 1997.
struct Search {
    /// The number of the edge.
    number: usize,
    ends: [DVec3; 2],
    /// Parts of the edge between which F changes sign, the newer one first, and the last one that was
    /// given up; and −F there.
    parts: [f64; 3],
    values: [f64; 3],
    /// Where to look next.
    part: f64,
}

impl Search {
    fn new(number: usize, crossing: &Crossing, ends: [DVec3; 2]) -> Self {
        let [a, b] = crossing.offsets.map(f64::from);
        Self { number, ends, parts: [0.0, 1.0, 0.0], values: [a, b, a], part: crossing.part }
    }

    fn point(&self) -> DVec3 {
        let [a, b] = self.ends;
        a + self.part * (b - a)
    }

    /// Takes note of −F at the point, and says whether that is near enough, or else where to look.
    fn take(&mut self, value: f64) -> bool {
        if value == 0.0 || !value.is_finite() {
            return true;
        }
        let Self { parts: [a, b, _], values: [f, g, _], part, .. } = *self;
        let is_like_first = (value >= 0.0) == (f >= 0.0);
        (self.parts, self.values) = if is_like_first {
            ([part, b, a], [value, g, f])
        } else {
            ([part, a, b], [value, f, g])
        };
        let Self { parts: [a, b, c], values: [f, g, h], .. } = *self;
        // The parabola through all three, part as a function of F, where it has no turn between them.
        let [x, y, z] = [b - a, c - a, c - b];
        let [p, q, r] = [g - f, h - f, h - g];
        let (xi, phi) = (-x / z, -p / r);
        let is_smooth = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
        let step = if is_smooth { f / r * (y * g / (x * q) - h / p) } else { 0.5 };
        self.part = a + step * (b - a);
        (self.part - a).abs() <= PRECISION
    }
}

/// Where F is 0 on dual edges; the value between where that does not come to an end.
fn polished(
    crossings: &[Crossing],
    tape: &Tape,
    to_scene: &impl Fn([f64; 3]) -> DVec3,
    sampler: &mut dyn Sample,
) -> Vec<DVec3> {
    let mut parts: Vec<f64> = crossings.iter().map(|crossing| crossing.part).collect();
    let ends = |crossing: &Crossing| crossing.ends.map(|end| to_scene(end.map(f64::from)));
    let is_open = |(_, crossing): &(usize, &Crossing)| {
        !crossing.is_cap && crossing.offsets.iter().all(|offset| !offset.is_nan())
    };
    let mut open: Vec<Search> = crossings
        .iter()
        .enumerate()
        .filter(is_open)
        .map(|(number, crossing)| Search::new(number, crossing, ends(crossing)))
        .collect();
    let mut points = Vec::with_capacity(open.len());
    for _ in 0..MAX_STEPS {
        if open.is_empty() {
            break;
        }
        points.clear();
        points.extend(open.iter().map(Search::point));
        let mut values = sampler.values(tape, &points).into_iter();
        open.retain_mut(|search| {
            let is_found = search.take(-values.next().unwrap_or(0.0));
            parts[search.number] = search.part.clamp(LEAST_PART, 1.0 - LEAST_PART);
            !is_found
        });
    }
    let place = |(crossing, part): (&Crossing, f64)| {
        let [a, b] = ends(crossing);
        a + part * (b - a)
    };
    crossings.iter().zip(parts).map(place).collect()
}

/// Outwards, of length 1; where the gradient has no direction, along the edge.
fn normal(crossing: &Crossing, gradient: DVec3) -> DVec3 {
    let largest = gradient.abs().max_element();
    let has_direction = gradient.is_finite() && largest > f64::MIN_POSITIVE && !crossing.is_cap;
    match has_direction {
        true => (gradient / largest).normalize(),
        false => crossing.outwards().normalize_or(DVec3::Z),
    }
}
