//! Meshes of formulas: values in the middles of the voxels that the surface may meet and of their
//! neighbours, and vertices moved onto the surface itself.
//!
//! Where the values of two neighbours differ in sign, the line between their middles meets the surface in
//! one of the two, which is among those that it may meet then: no cut edge is missing, and which other
//! voxels are among them does not matter.

use glam::DVec3;
use rayon::prelude::*;

use super::{
    Border, Crossing, Extraction, LEAST_PART, Mesh,
    cut::cut_to_region,
    extract,
    middles::grid,
    near::{Voxels, near_open, near_stored},
    tapes::Tapes,
};
use crate::{
    eval::{Sample, Segment, sampler},
    expr::Tape,
    math::{Lattice, SimdLevel},
    octree::{Occupancy, Storage},
    voxelize::OpenVoxels,
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
    let mut is_inside = |voxel| storage.occupancy(voxel) == Occupancy::Inside;
    mesh(tape, near_stored(storage), &mut is_inside, lattice, settings)
}

/// The same mesh from the voxels that bounds leave open, which are found sooner.
#[must_use]
pub fn of_open_voxels(
    tape: &Tape,
    open: &OpenVoxels,
    lattice: &Lattice,
    settings: &FormulaSettings,
) -> Mesh {
    let mut sampler = sampler(settings.simd);
    let mut is_inside = |voxel| {
        let middle = [lattice.voxel_center(voxel)];
        sampler.values(tape, &middle)[0] <= 0.0 && sampler.are_in_region(tape, &middle)[0]
    };
    mesh(tape, near_open(&open.bricks), &mut is_inside, lattice, settings)
}

/// Makes the mesh from values in the voxels `near` the surface; `is_inside` tells of others.
fn mesh(
    tape: &Tape,
    near: Voxels,
    is_inside: &mut dyn FnMut([u32; 3]) -> bool,
    lattice: &Lattice,
    settings: &FormulaSettings,
) -> Mesh {
    // The same for the same mesh: where operands tie, which gradient counts is a matter of the tape.
    let tapes = Tapes::new(tape, lattice, settings.simd);
    let grid = grid(&tapes, near, is_inside, lattice, settings);
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
                let directions = sampler.directions(tape, &points);
                for (((i, crossing), point), direction) in
                    members.into_iter().zip(&some).zip(points).zip(directions)
                {
                    positions[i] = point.as_vec3().to_array();
                    normals[i] = normal(crossing, direction).as_vec3().to_array();
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

/// Part of a dual edge to which vertices are found; files keep fewer digits.
const PRECISION: f64 = 1e-7;

/// Where F is 0 on dual edges; the value between where that does not come to an end.
fn polished(
    crossings: &[Crossing],
    tape: &Tape,
    to_scene: &impl Fn([f64; 3]) -> DVec3,
    sampler: &mut dyn Sample,
) -> Vec<DVec3> {
    let is_open = |crossing: &&Crossing| {
        !crossing.is_cap && crossing.offsets.iter().all(|offset| !offset.is_nan())
    };
    let ends = |crossing: &Crossing| crossing.ends.map(|end| to_scene(end.map(f64::from)));
    let segment = |crossing: &Crossing| Segment {
        ends: ends(crossing),
        values: crossing.offsets.map(|offset| -f64::from(offset)),
        part: crossing.part,
    };
    let open: Vec<Segment> = crossings.iter().filter(is_open).map(segment).collect();
    let mut roots = sampler.roots(tape, &open, PRECISION).into_iter();
    let place = |crossing: &Crossing| {
        let root = if is_open(&crossing) { roots.next() } else { None };
        let within = |part: f64| part.clamp(LEAST_PART, 1.0 - LEAST_PART);
        let ([a, b], part) = (ends(crossing), root.map_or(crossing.part, within));
        a + part * (b - a)
    };
    crossings.iter().map(place).collect()
}

/// Outwards, of length 1; where the gradient has no direction, along the edge.
fn normal(crossing: &Crossing, direction: DVec3) -> DVec3 {
    match direction == DVec3::ZERO || crossing.is_cap {
        true => crossing.outwards().normalize_or(DVec3::Z),
        false => direction,
    }
}
