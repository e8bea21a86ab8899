//! Meshes: from a function to triangles, by Zeroset's voxels and by Fidget's own mesher,
//! `fidget::mesh` (manifold dual contouring).
//!
//! Both cut the domain into 256³ cells at the finest. Zeroset makes the same mesh from the voxels that
//! bounds leave open and from certified ones. Its time begins with the expression and ends with vertices that were moved onto the surface, normals and triangles; Fidget's begins with a
//! function that is ready and ends with vertices, which stand where planes through the edges' cuts
//! meet, and triangles. It makes no normals, and merges cells that are flat.

use fidget::{
    eval::MathFunction,
    jit::{JitFunction, JitShape},
    mesh::{Octree, Settings},
    render::{CancelToken, RenderHints, ThreadPool},
    shape::{Shape, ShapeVars},
    vm::{VmFunction, VmShape},
};
use glam::DVec3;
use zeroset::{
    eval::sampler,
    math::SimdLevel,
    mesh::{Border, FormulaSettings, Mesh, VertexPlace, of_formula, of_open_voxels},
    progress::Unwatched,
    voxelize::{self, open_voxels, voxelize},
};

use crate::{
    Pools, agreement, report,
    timing::{take_turns, time},
    tuning::{self, Engine},
    workloads::Workload,
};

/// Levels of Fidget's octree, and cells along an axis.
const DEPTH: u8 = 8;
const RESOLUTION: u32 = 1 << DEPTH;

/// What was measured of one surface's meshes.
pub struct Meshed {
    pub name: &'static str,
    /// Fidget's, for each number of threads.
    pub engines: [Engine; 2],
    /// Seconds of Zeroset from open voxels, of Zeroset from certified ones, and of Fidget, round by
    /// round, for each number of threads.
    pub times: [[Vec<f64>; 3]; 2],
    /// Of Zeroset's mesh, and of Fidget's.
    pub quality: [Quality; 2],
}

/// What a mesh is like.
#[derive(Clone, Copy, Debug)]
pub struct Quality {
    pub n_triangles: u64,
    /// Triangles that face the other way than the gradient at their middles.
    pub n_flipped: u64,
    /// Edges of one triangle alone.
    pub n_open: u64,
    /// Everything else that is wrong with a mesh that should be manifold.
    pub n_faults: u64,
    /// Pairs of triangles that pass through each other.
    pub n_crossings: u64,
    /// The mean distance of the triangles' middles from the surface, in cells: |F| / |grad F| there.
    pub distance: f64,
}

impl Quality {
    fn of(mesh: &Mesh, workload: &Workload) -> Self {
        let health = mesh.health();
        let corner = |v: u32| DVec3::from_array(mesh.positions[v as usize].map(f64::from));
        let corners: Vec<[DVec3; 3]> = mesh.triangles.iter().map(|t| t.map(corner)).collect();
        let middles: Vec<DVec3> = corners.iter().map(|[a, b, c]| (a + b + c) / 3.0).collect();
        let (tape, mut sampler) = (workload.expr.tape(), sampler(SimdLevel::detect()));
        let gradients = sampler.gradients(&tape, &middles);
        let values = sampler.values(&tape, &middles);
        let is_flipped = |([a, b, c], gradient): &(&[DVec3; 3], &DVec3)| {
            (*b - *a).cross(*c - *a).dot(**gradient) < 0.0
        };
        let cell = 2.0 * workload.half_edge() / f64::from(RESOLUTION);
        let distances: Vec<f64> = values
            .iter()
            .zip(&gradients)
            .map(|(value, gradient)| (value / gradient.length()).abs() / cell)
            .filter(|distance| distance.is_finite())
            .collect();
        Self {
            n_triangles: mesh.triangles.len() as u64,
            n_flipped: corners.iter().zip(&gradients).filter(is_flipped).count() as u64,
            n_open: health.open_edges,
            n_faults: health.crowded_edges
                + health.turned_edges
                + health.pinched_vertices
                + health.flat_triangles
                + health.not_finite,
            n_crossings: mesh.self_intersections(),
            distance: distances.iter().sum::<f64>() / distances.len() as f64,
        }
    }
}

/// A surface for Fidget's mesher.
struct Fidget {
    jit: JitShape,
    vm: VmShape,
    half_edge: f32,
}

impl Fidget {
    fn new(workload: &Workload) -> Self {
        let Workload { context, root, .. } = workload;
        let jit = Shape::<JitFunction>::new(context, *root).unwrap();
        let vm = Shape::<VmFunction>::new(context, *root).unwrap();
        Self { jit, vm, half_edge: workload.half_edge() as f32 }
    }

    /// Makes a mesh with the threads of the current pool.
    fn run(&self, engine: Engine) -> fidget::mesh::Mesh {
        match engine {
            Engine::Jit => self.run_with(&self.jit),
            Engine::Vm => self.run_with(&self.vm),
        }
    }

    fn run_with<F: MathFunction + RenderHints + Clone>(
        &self,
        shape: &Shape<F>,
    ) -> fidget::mesh::Mesh {
        let is_shared = rayon::current_num_threads() > 1;
        let mut settings = Settings {
            depth: DEPTH,
            threads: is_shared.then_some(&ThreadPool::Global),
            cancel: CancelToken::new(),
            ..Settings::default()
        };
        for axis in 0..3 {
            settings.world_to_model[(axis, axis)] = self.half_edge;
        }
        let vars = ShapeVars::new();
        Octree::build(&shape.bind(&vars).unwrap(), &settings).unwrap().walk_dual()
    }
}

/// The same mesh as Zeroset keeps it, to be looked at.
fn taken_over(mesh: &fidget::mesh::Mesh) -> Mesh {
    Mesh {
        positions: mesh.vertices.iter().map(|v| [v.x, v.y, v.z]).collect(),
        triangles: mesh.triangles.iter().map(|t| [t.x, t.y, t.z].map(|v| v as u32)).collect(),
        ..Mesh::default()
    }
}

fn zeroset(workload: &Workload, certify: bool) -> Mesh {
    let (expr, lattice) = (&workload.expr, workload.lattice(RESOLUTION));
    let find = voxelize::Settings::default();
    let settings = FormulaSettings {
        border: Border::Open,
        vertex: VertexPlace::Polished,
        simd: SimdLevel::detect(),
    };
    if certify {
        let found = voxelize(expr, &lattice, &find, &Unwatched).unwrap();
        return of_formula(&expr.tape(), &found.octree, &lattice, &settings);
    }
    let found = open_voxels(expr, &lattice, &find, &Unwatched).unwrap();
    of_open_voxels(&expr.tape(), &found, &lattice, &settings)
}

/// Times both programs on one surface.
pub fn measure(workload: &Workload, pools: &Pools) -> Meshed {
    let name = workload.name;
    eprintln!("{name}: comparing values");
    agreement::check(workload);
    let fidget = Fidget::new(workload);
    let theirs = |i: usize, engine| pools[i].install(|| time(|| fidget.run(engine)));
    let ours = |i: usize, certify| pools[i].install(|| time(|| zeroset(workload, certify)));
    eprintln!("{name}: looking for Fidget's better engine");
    let engines = [0, 1].map(|i| {
        let measure = |engine| theirs(i, engine);
        tuning::best(vec![Engine::Jit, Engine::Vm], measure, measure)
    });
    eprintln!("{name}: timing against {} and {}", engines[0], engines[1]);
    let [a, b, c, d, e, f] = take_turns([
        &mut || ours(0, false),
        &mut || ours(0, true),
        &mut || theirs(0, engines[0]),
        &mut || ours(1, false),
        &mut || ours(1, true),
        &mut || theirs(1, engines[1]),
    ]);
    eprintln!("{name}: looking at both meshes");
    let meshes = [zeroset(workload, false), taken_over(&fidget.run(engines[0]))];
    let quality = meshes.each_ref().map(|mesh| Quality::of(mesh, workload));
    let meshed = Meshed { name, engines, times: [[a, b, c], [d, e, f]], quality };
    eprintln!("{}", report::mesh_summary(&meshed));
    meshed
}
