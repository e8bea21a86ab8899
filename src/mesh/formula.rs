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
    Border, Brick, Crossing, Extraction, Grid, LEAST_PART, Mesh, SIDE, VOXELS, cut::cut_to_region,
    extract, offset,
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
    let grid = grid(tape, storage, lattice, settings);
    let Extraction { vertices: crossings, triangles } = extract(&grid, |crossing| *crossing);
    let bounds = lattice.bounds();
    let to_scene = |p: [f64; 3]| bounds.min + lattice.voxel_size() * DVec3::from_array(p);
    let placed: Vec<(Vec<DVec3>, Vec<DVec3>)> = crossings
        .par_chunks(CHUNK)
        .map_init(
            || sampler(settings.simd),
            |sampler, some| {
                let points = match settings.vertex {
                    VertexPlace::Polished => polished(some, tape, &to_scene, &mut **sampler),
                    VertexPlace::Linear => some.iter().map(|c| to_scene(c.point())).collect(),
                };
                let gradients = sampler.gradients(tape, &points);
                let normals = some.iter().zip(gradients).map(|(c, g)| normal(c, g)).collect();
                (points, normals)
            },
        )
        .collect();
    let mut mesh = Mesh { triangles, ..Mesh::default() };
    for (points, normals) in placed {
        mesh.positions.extend(points.iter().map(|p| p.as_vec3().to_array()));
        mesh.normals.extend(normals.iter().map(|n| n.as_vec3().to_array()));
    }
    cut_to_region(&mut mesh, tape, &mut *sampler(settings.simd));
    mesh.drop_unused();
    mesh
}

/// Vertices that a thread places at a time.
const CHUNK: usize = 1 << 12;

/// The grid of the values of −F: inside is what is not negative.
fn grid(tape: &Tape, storage: &dyn Storage, lattice: &Lattice, settings: &FormulaSettings) -> Grid {
    let mut places = bricks_near(storage);
    if settings.border == Border::Capped {
        let of_caps = bricks_of_caps(storage, lattice.n_voxels(), &places);
        places.extend(of_caps);
    }
    let tapes = tapes_of_blocks(tape, lattice, settings.simd);
    let size = lattice.n_voxels();
    let bounds = lattice.bounds();
    // Coordinates along each axis, those of phantoms on the border.
    let at = |axis: usize, i: u32| match i.checked_sub(SIDE) {
        None => bounds.min[axis],
        Some(i) if i >= size[axis] => bounds.max[axis],
        Some(i) => 0.5 * (lattice.corner(axis, i) + lattice.corner(axis, i + 1)),
    };
    let brick = |sampler: &mut Box<dyn Sample>, place: [u32; 3]| {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let at = |i| at(axis, place[axis] * SIDE + i);
            std::array::from_fn::<f64, { SIDE as usize }, _>(|i| at(i as u32))
        });
        let side = SIDE as usize;
        let point = |i: usize| DVec3::new(x[i % side], y[i / side % side], z[i / side / side]);
        let points: Vec<DVec3> = (0..VOXELS).map(point).collect();
        let block = place.map(|i| (i.wrapping_sub(1)) >> (BLOCK_LEVELS - SIDE.ilog2()));
        let values = sampler.values(tapes.get(&block).unwrap_or(tape), &points);
        let mut offsets: Vec<f32> = values.into_iter().map(|value| offset(0.0, value)).collect();
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
    let places: Vec<[u32; 3]> = places.into_iter().collect();
    let bricks = places.into_par_iter().map_init(|| sampler(settings.simd), brick).collect();
    Grid::new(bricks, size, settings.border)
}

/// The bricks at the border that may hold voxels inside, and their neighbours: caps run through them.
/// Those in `near` may, whatever their first voxel is.
fn bricks_of_caps(
    storage: &dyn Storage,
    size: [u32; 3],
    near: &FxHashSet<[u32; 3]>,
) -> FxHashSet<[u32; 3]> {
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
                    if near.contains(&place.map(|i| i + 1))
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

/// The bricks that hold stored voxels and their neighbours.
fn bricks_near(storage: &dyn Storage) -> FxHashSet<[u32; 3]> {
    let near: Vec<FxHashSet<[u32; 3]>> = storage
        .parts()
        .into_par_iter()
        .map(|part| {
            let mut near = FxHashSet::default();
            let mut last = None;
            storage.visit(part, &mut |voxel| {
                let own = voxel.ijk.map(|i| i / SIDE + 1);
                if last != Some(own) {
                    near.insert(own);
                    last = Some(own);
                }
                let ranges = voxel.ijk.map(|i| match i % SIDE {
                    0 => -1..=0,
                    i if i == SIDE - 1 => 0..=1,
                    _ => 0..=0,
                });
                let [xs, ys, zs] = ranges;
                for dz in zs {
                    for dy in ys.clone() {
                        for dx in xs.clone() {
                            if (dx, dy, dz) != (0, 0, 0) {
                                let [x, y, z] = own;
                                near.insert([
                                    x.wrapping_add_signed(dx),
                                    y.wrapping_add_signed(dy),
                                    z.wrapping_add_signed(dz),
                                ]);
                            }
                        }
                    }
                }
            });
            near
        })
        .collect();
    let mut all = FxHashSet::default();
    near.into_iter().for_each(|some| all.extend(some));
    all
}

/// The shortened tapes of the blocks of 32³ voxels that the surface may meet, if F can be shortened.
fn tapes_of_blocks(tape: &Tape, lattice: &Lattice, simd: SimdLevel) -> HashMap<[u32; 3], Tape> {
    if tape.n_choices() == 0 || lattice.depth() <= BLOCK_LEVELS {
        return HashMap::new();
    }
    let wish = |level: u32, _: &Aabb| match level + BLOCK_LEVELS >= lattice.depth() {
        true => Wish::Keep,
        false => Wish::Divide,
    };
    let blocks = find_blocks(tape.clone(), lattice, simd, &wish);
    blocks.into_iter().map(|block| (block.ijk.map(|i| i as u32), (*block.tape).clone())).collect()
}

/// Steps that are enough for any bracket, by bisection alone.
const MAX_STEPS: usize = 50;

/// Part of a dual edge to which vertices are found.
const PRECISION: f64 = 1e-9;

/// Where F is 0 on dual edges; the value between where that does not come to an end.
fn polished(
    crossings: &[Crossing],
    tape: &Tape,
    to_scene: &impl Fn([f64; 3]) -> DVec3,
    sampler: &mut dyn Sample,
) -> Vec<DVec3> {
    struct Search {
        ends: [DVec3; 2],
        /// Parts of the edge between which F changes sign, and F there.
        parts: [f64; 2],
        values: [f64; 2],
        part: f64,
        is_found: bool,
    }
    let mut searches: Vec<Search> = crossings
        .iter()
        .map(|crossing| Search {
            ends: crossing.ends.map(|end| to_scene(end.map(f64::from))),
            parts: [0.0, 1.0],
            values: crossing.offsets.map(f64::from),
            part: crossing.part,
            is_found: crossing.is_cap || crossing.offsets.iter().any(|offset| offset.is_nan()),
        })
        .collect();
    for step in 0..MAX_STEPS {
        let open: Vec<usize> = (0..searches.len()).filter(|&i| !searches[i].is_found).collect();
        if open.is_empty() {
            break;
        }
        let point = |&i: &usize| {
            let Search { ends: [a, b], part, .. } = searches[i];
            a + part * (b - a)
        };
        let values = sampler.values(tape, &open.iter().map(point).collect::<Vec<DVec3>>());
        for (i, value) in open.into_iter().zip(values) {
            let search = &mut searches[i];
            let value = -value;
            if value == 0.0 || !value.is_finite() {
                search.is_found = true;
                continue;
            }
            let replaced = usize::from((value >= 0.0) == (search.values[1] >= 0.0));
            let moved = (search.part - search.parts[replaced]).abs();
            search.parts[replaced] = search.part;
            search.values[replaced] = value;
            // Illinois: an end that stays counts for half, so that both close in.
            search.values[1 - replaced] *= 0.5;
            let [a, b] = search.parts;
            let [f, g] = search.values;
            let next = a + (b - a) * (f / (f - g));
            let is_good = step % 4 != 3 && next > a && next < b;
            search.is_found = moved <= PRECISION || b - a <= PRECISION;
            if !search.is_found {
                search.part = if is_good { next } else { 0.5 * (a + b) };
            }
        }
    }
    let place = |search: Search, crossing: &Crossing| {
        let [a, b] = search.ends;
        let part = if crossing.is_cap {
            search.part
        } else {
            search.part.clamp(LEAST_PART, 1.0 - LEAST_PART)
        };
        a + part * (b - a)
    };
    searches.into_iter().zip(crossings).map(|(search, crossing)| place(search, crossing)).collect()
}

/// Outwards, of length 1; where the gradient has no direction, along the edge.
fn normal(crossing: &Crossing, gradient: DVec3) -> DVec3 {
    let along = crossing.outwards().normalize_or(DVec3::Z);
    let largest = gradient.abs().max_element();
    let has_direction = gradient.is_finite() && largest > f64::MIN_POSITIVE && !crossing.is_cap;
    if has_direction { (gradient / largest).normalize() } else { along }
}
