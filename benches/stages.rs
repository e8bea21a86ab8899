//! Every stage of the paper's scenes at 512³, into a picture of 1024 x 1024 pixels.

#![expect(clippy::unwrap_used, reason = "a benchmark without its scene has failed")]

use std::{io::Cursor, path::Path};

use divan::Bencher;
use rayon::ThreadPool;
use zeroset::{
    math::{Lattice, SimdLevel},
    octree::{Detail, MortonOctree},
    output::{exr, png},
    progress::Unwatched,
    raster::{self, Camera, Coloring, Contents, Drawn, Frame, Layer, Source},
    scene::{self, Scene},
    voxelize::{Settings, voxelize},
};

const SCENES: [&str; 3] = ["scene1", "scene2", "scene3"];
const THREADS: [usize; 2] = [1, 2];

fn main() {
    divan::main();
}

fn load(name: &str) -> Scene {
    let configs = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs");
    scene::load(&configs.join(name).with_extension("toml")).unwrap()
}

fn pool(threads: usize) -> ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

fn lattice(scene: &Scene) -> Lattice {
    Lattice::new(scene.domain.unwrap(), scene.resolution)
}

fn find(scene: &Scene, lattice: &Lattice) -> MortonOctree {
    let expr = &scene.surfaces[0].expr;
    voxelize(expr, lattice, &Settings::default(), &Unwatched).unwrap().octree
}

fn draw(scene: &Scene, lattice: &Lattice, octree: &MortonOctree) -> Frame {
    let material = scene.surfaces[0].material;
    let tape = scene.surfaces[0].expr.tape();
    let detail = Detail::new(octree, lattice);
    let layers = [Layer {
        source: Source::Stored(&detail),
        lattice,
        material,
        coloring: &Coloring::Plain,
        tape: Some(&tape),
    }];
    let content = Drawn { voxels: vec![(octree, lattice)], ..Drawn::default() };
    let camera = Camera::new(&scene.view, 1.0, &content);
    let simd = SimdLevel::detect();
    let contents = Contents { layers: &layers, ..Contents::default() };
    raster::render(&contents, &camera, &scene.image, simd, &Unwatched).unwrap().0
}

#[divan::bench(args = SCENES)]
fn scene_file(name: &str) -> Scene {
    load(name)
}

#[divan::bench(args = SCENES, consts = THREADS)]
fn voxelization<const N: usize>(bencher: Bencher<'_, '_>, name: &str) {
    let (scene, pool) = (load(name), pool(N));
    let lattice = lattice(&scene);
    bencher.bench(|| pool.install(|| find(&scene, &lattice)));
}

#[divan::bench(args = SCENES, consts = THREADS)]
fn rasterization<const N: usize>(bencher: Bencher<'_, '_>, name: &str) {
    let (scene, pool) = (load(name), pool(N));
    let lattice = lattice(&scene);
    let octree = find(&scene, &lattice);
    bencher.bench(|| pool.install(|| draw(&scene, &lattice, &octree)));
}

#[divan::bench(args = SCENES)]
fn png_file(bencher: Bencher<'_, '_>, name: &str) {
    let frame = frame(name);
    bencher.bench(|| png::write(&frame, &png::PngOptions::default(), Vec::new()).is_ok());
}

#[divan::bench(args = SCENES, consts = THREADS)]
fn exr_file<const N: usize>(bencher: Bencher<'_, '_>, name: &str) {
    let (frame, pool) = (frame(name), pool(N));
    let write = || exr::write(&frame, &exr::ExrOptions::default(), Cursor::new(Vec::new()));
    bencher.bench(|| pool.install(|| write().is_ok()));
}

fn frame(name: &str) -> Frame {
    let scene = load(name);
    let lattice = lattice(&scene);
    draw(&scene, &lattice, &find(&scene, &lattice))
}
