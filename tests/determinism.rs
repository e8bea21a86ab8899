//! The same bits for any number of threads and any instruction set.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]

use std::{num::NonZeroUsize, path::Path};

use zeroset::{
    math::SimdLevel,
    pipeline::{self, Options, Picture},
    progress::Unwatched,
    scene::{self, Scene},
    statistics::Statistics,
};

fn load(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs").join(name);
    let mut scene = scene::load(&path).unwrap();
    scene.image.width /= 4;
    scene.image.height /= 4;
    scene
}

fn render(scene: &Scene, threads: usize, simd: Option<SimdLevel>, find_all: bool) -> Picture {
    let options = Options {
        out_dir: "unused".into(),
        threads: NonZeroUsize::new(threads),
        resolution: Some(150),
        simd,
        max_memory: None,
        find_all,
        frames: None,
    };
    pipeline::render(scene, &options, &Unwatched).unwrap()
}

/// What must not change, down to the last bit of every layer.
fn bits(picture: &Picture) -> String {
    let statistics = &picture.statistics;
    let Statistics { octree, boxes, voxels, .. } = statistics;
    format!("{octree:?} {boxes:?} {voxels:?} {:?}", picture.frame.digest())
}

#[test]
fn threads_do_not_show() {
    for name in ["scene1.toml", "scene2.toml", "solids.toml", "still_life.toml"] {
        let scene = load(name);
        for find_all in [true, false] {
            let bits = |threads| bits(&render(&scene, threads, None, find_all));
            let alone = bits(1);
            for threads in [2, 7] {
                assert_eq!(bits(threads), alone, "{name}, {threads} threads");
            }
        }
    }
}

#[test]
fn instruction_sets_do_not_show() {
    for name in ["scene1.toml", "scene3.toml", "gyroid.toml", "solids.toml", "still_life.toml"] {
        let scene = load(name);
        for find_all in [true, false] {
            let best = bits(&render(&scene, 2, None, find_all));
            for level in SimdLevel::available() {
                let other = bits(&render(&scene, 2, Some(level), find_all));
                assert_eq!(other, best, "{name}, {}", level.name());
            }
        }
    }
}
