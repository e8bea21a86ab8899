//! Pictures: from a function to depths and normals, by Zeroset's pipeline and by Fidget's own voxel
//! renderer, `fidget::raster::voxel`.
//!
//! Both look along z at the whole domain with parallel rays, one through each of 512 x 512 pixels,
//! with 512 voxels along it. Zeroset takes a scene that was read to a frame: it finds the voxels that
//! show, follows rays to the surface, and shades it. Fidget's depth is the nearest of 512 points of
//! the ray at which F is negative; its normal is the gradient there. It makes no colours.

use fidget::{
    eval::MathFunction,
    jit::{JitFunction, JitShape},
    raster::voxel::{EvalConfig, Image, RenderConfig, render},
    render::{RenderHints, ThreadPool, TileSizes},
    shape::{Shape, ShapeVars},
    vm::{VmFunction, VmShape},
};
use std::{fmt, num::NonZeroUsize, path::Path};
use zeroset::{
    pipeline::{self, Options},
    progress::Unwatched,
    raster::Frame,
    scene::{self, Scene},
};

use crate::{
    Pools, agreement,
    report::{self, Pictured},
    timing::{take_turns, time},
    tuning::{self, Engine},
    workloads::{RESOLUTION, Workload},
};

/// Tiles that Fidget may cut the picture into; where `None`, those that it recommends itself.
type Tiles = Option<&'static [usize]>;
const TILES: [Tiles; 8] = [
    None,
    Some(&[128, 64, 32, 16, 8]),
    Some(&[64, 32, 16, 8]),
    Some(&[32, 16, 8, 4]),
    Some(&[64, 32, 16, 8, 4, 2]),
    Some(&[64, 16, 4]),
    Some(&[64, 32, 16, 8, 4]),
    Some(&[32, 8]),
];

/// How Fidget is used.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    engine: Engine,
    tiles: Tiles,
}

/// Such as `JIT, tiles of 64, 16, 8`.
impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { engine, tiles } = self;
        let Some(tiles) = tiles else { return write!(f, "{engine}") };
        let tiles: Vec<String> = tiles.iter().map(usize::to_string).collect();
        write!(f, "{engine}, tiles of {}", tiles.join(", "))
    }
}

/// A surface for Fidget's renderer.
struct Fidget {
    jit: JitShape,
    vm: VmShape,
    config: RenderConfig,
}

impl Fidget {
    fn new(workload: &Workload) -> Self {
        let Workload { context, root, .. } = workload;
        let mut config = RenderConfig::from_size(RESOLUTION.into());
        let half_edge = workload.half_edge() as f32;
        for axis in 0..3 {
            config.world_to_model[(axis, axis)] = half_edge;
        }
        // Fidget's rays go through corners of pixels, Zeroset's through their centres.
        for axis in 0..2 {
            config.world_to_model[(axis, 3)] = half_edge / RESOLUTION as f32;
        }
        let jit = Shape::<JitFunction>::new(context, *root).unwrap();
        let vm = Shape::<VmFunction>::new(context, *root).unwrap();
        Self { jit, vm, config }
    }

    /// Renders with the threads of the current pool.
    fn run(&self, setting: Setting) -> Image {
        match setting.engine {
            Engine::Jit => self.run_with(&self.jit, setting.tiles),
            Engine::Vm => self.run_with(&self.vm, setting.tiles),
        }
    }

    fn run_with<F: MathFunction + RenderHints + Clone>(
        &self,
        shape: &Shape<F>,
        tiles: Tiles,
    ) -> Image {
        let is_shared = rayon::current_num_threads() > 1;
        let settings = EvalConfig {
            tile_sizes: tiles.map(|tiles| TileSizes::new(tiles).unwrap()),
            threads: is_shared.then_some(&ThreadPool::Global),
            ..EvalConfig::default()
        };
        let vars = ShapeVars::new();
        render(shape.bind(&vars).unwrap(), &self.config, &settings).unwrap()
    }
}

/// The workload as a scene that is seen as Fidget sees it.
fn scene(workload: &Workload) -> Scene {
    let half_edge = workload.half_edge();
    let text = format!(
        r#"
        version = 1
        [[surface]]
        f = "x^2 + y^2 + z^2 = 1"  # the workload's takes its place
        [voxels]
        resolution = {RESOLUTION}
        [camera]
        projection = "orthographic"
        height = {}
        eye = [0, 0, {}]
        target = [0, 0, 0]
        up = [0, 1, 0]
        [image]
        width = {RESOLUTION}
        height = {RESOLUTION}
        samples = 1
        [output]
        exr = false  # no curvatures either
        "#,
        2.0 * half_edge,
        4.0 * half_edge,
    );
    let mut scene = scene::parse(Path::new("picture.toml"), &text).unwrap();
    scene.surfaces[0].expr = workload.expr.clone();
    scene.domain = Some(workload.domain);
    scene
}

fn zeroset(scene: &Scene, n_threads: usize) -> Frame {
    let options = Options { threads: NonZeroUsize::new(n_threads), ..Options::default() };
    pipeline::render(scene, &options, &Unwatched).unwrap().frame
}

/// Times both programs on one surface.
pub fn measure(workload: &Workload, pools: &Pools) -> Pictured {
    let name = workload.name;
    eprintln!("{name}: comparing values");
    agreement::check(workload);
    let (scene, fidget) = (scene(workload), Fidget::new(workload));
    eprintln!("{name}: looking for Fidget's best settings");
    let theirs = |i: usize, setting| pools[i].install(|| time(|| fidget.run(setting)));
    let best_of = |i: usize, tiles: &[Tiles]| {
        let with = |engine| tiles.iter().map(move |&tiles| Setting { engine, tiles });
        let settings = [Engine::Jit, Engine::Vm].into_iter().flat_map(with).collect();
        let measure = |setting| theirs(i, setting);
        tuning::best(settings, measure, measure)
    };
    let settings = [0, 1].map(|i| [best_of(i, &[None]), best_of(i, &TILES)]);
    eprintln!("{name}: timing against {} and {}", settings[0][1], settings[1][1]);
    let ours = |i: usize| time(|| zeroset(&scene, pools[i].current_num_threads()));
    let [a, b, c, d, e, f] = take_turns([
        &mut || ours(0),
        &mut || theirs(0, settings[0][0]),
        &mut || theirs(0, settings[0][1]),
        &mut || ours(1),
        &mut || theirs(1, settings[1][0]),
        &mut || theirs(1, settings[1][1]),
    ]);
    let (frame, image) = (zeroset(&scene, 1), fidget.run(settings[0][1]));
    let likeness = agreement::compare_pictures(&frame, &image, workload.half_edge());
    let pictured = Pictured { name, settings, times: [[a, b, c], [d, e, f]], likeness };
    eprintln!("{}", report::picture_summary(&pictured));
    pictured
}
