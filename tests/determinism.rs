//! The same bits for any number of threads and any instruction set.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]

use std::{num::NonZeroUsize, path::Path};

use zeroset::{
    math::SimdLevel,
    pipeline::{self, Options, Picture},
    progress::Unwatched,
    scene::{self, Scene},
};

fn load(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs").join(name);
    let mut scene = scene::load(&path).unwrap();
    scene.image.width /= 4;
    scene.image.height /= 4;
    scene
}

fn render(scene: &Scene, threads: usize, simd: Option<SimdLevel>) -> Picture {
    let options = Options {
        out_dir: "unused".into(),
        threads: NonZeroUsize::new(threads),
        resolution: Some(150),
        simd,
        max_memory: None,
    };
    pipeline::render(scene, &options, &Unwatched).unwrap()
}

/// What must not change, down to the last bit of every layer.
fn bits(picture: &Picture) -> String {
    let statistics = &picture.statistics;
    format!("{:?} {:?} {:?}", statistics.octree, statistics.boxes, picture.frame.digest())
}

#[test]
fn threads_do_not_show() {
    for name in ["scene1.toml", "scene2.toml", "solids.toml"] {
        let scene = load(name);
        let alone = bits(&render(&scene, 1, None));
        for threads in [2, 7] {
            assert_eq!(bits(&render(&scene, threads, None)), alone, "{name}, {threads} threads");
        }
    }
}

#[test]
fn instruction_sets_do_not_show() {
    for name in ["scene1.toml", "scene3.toml", "gyroid.toml", "solids.toml"] {
        let scene = load(name);
        let best = bits(&render(&scene, 2, None));
        for level in SimdLevel::available() {
            assert_eq!(bits(&render(&scene, 2, Some(level))), best, "{name}, {}", level.name());
        }
    }
}
