//! Tests of scene files as a whole; the words for mistakes are tested in `tests/diagnostics`.

use std::path::Path;

use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::{
    Error,
    raster::{Placement, Projection},
};

fn scene(text: &str) -> Scene {
    parse(Path::new("some/where/heart.v2.toml"), text).unwrap()
}

fn mistakes(text: &str) -> Vec<String> {
    let rejection = parse(Path::new("a.toml"), text).unwrap_err();
    rejection.diagnostics.into_iter().map(|mistake| mistake.message).collect()
}

const MINIMAL: &str = "version = 1\n[[surface]]\nf = \"x^2 + y^2 + z^2 = 1\"\n";

#[test]
fn three_lines_are_enough() {
    let scene = scene(MINIMAL);
    assert_eq!(scene.name, "heart.v2");
    assert_eq!(scene.surfaces.len(), 1);
    assert_eq!(scene.surfaces[0].name, "surface 1");
    assert_eq!((scene.domain.min, scene.domain.max), (-DVec3::ONE, DVec3::ONE));
    assert_eq!(scene.resolution, 512);
    assert_eq!(scene.view.projection, Projection::Perspective { fov_degrees: 35.0 });
    assert!(matches!(scene.view.placement, Placement::Fit { margin: 0.05, .. }));
    assert_eq!(scene.view.up, DVec3::Z);
    assert_eq!((scene.image.width, scene.image.height), (1024, 1024));
    assert_eq!(scene.image.background, Some([1.0; 3]));
    assert_eq!(scene.outputs.png.as_deref(), Some(Path::new("heart.v2.png")));
    assert_eq!(scene.outputs.exr.as_deref(), Some(Path::new("heart.v2.exr")));
}

#[test]
fn every_key_can_be_given() {
    let scene = scene(
        r##"
        version = 1
        [[surface]]
        name = "ball"
        f = "1 - x^2 - y^2 - z^2"
        inside = "positive"
        color = "#ff8000"
        specular = 0
        shininess = 100
        [[surface]]
        blend = { threshold = 0.25, radius = 1, spheres = [[0, 0, 0, 1], [0.5, 0, 0, 1.5]] }
        color = [0, 1, 0.5]
        [domain]
        min = [-2, -3.5, 0]
        max = [2, 3.5, 1e1]
        [voxels]
        resolution = 64
        [camera]
        projection = "orthographic"
        height = 3
        eye = [0, 0, 9]
        target = [0, 0, 0]
        [image]
        width = 640
        height = 480
        background = "transparent"
        [output]
        png = "pictures/ball.png"
        exr = false
        "##,
    );
    assert_eq!(scene.surfaces[0].name, "ball");
    assert_eq!(scene.surfaces[0].material.specular, 0.0);
    assert_eq!(scene.surfaces[0].material.shininess, 100);
    assert_eq!(scene.surfaces[1].material.color, [0.0, 1.0, 0.214_041_14]);
    assert_eq!(scene.domain.max, DVec3::new(2.0, 3.5, 10.0));
    assert_eq!(scene.view.projection, Projection::Orthographic { height: Some(3.0) });
    assert_eq!(scene.view.up, DVec3::Y, "z is not up for who looks along it");
    assert_eq!(scene.image.background, None);
    assert_eq!(scene.outputs.png.as_deref(), Some(Path::new("pictures/ball.png")));
    assert_eq!(scene.outputs.exr, None);
}

#[test]
fn refused_entries_are_not_missed_again() {
    let scene = |rest: &str| format!("version = 1\n[[surface]]\n{rest}");
    assert_eq!(mistakes(&scene("f = 7")), ["expected a string"]);
    let camera = "f = 'x'\n[camera]\neye = 3\ntarget = [0, 0, 0]";
    assert_eq!(mistakes(&scene(camera)), ["expected an array of 3 numbers"]);
    let domain = "f = 'x'\n[domain]\nmin = 3\nmax = [-5, -5, -5]";
    assert_eq!(mistakes(&scene(domain)), ["expected an array of 3 numbers"]);
}

#[test]
fn a_section_full_of_nonsense_is_given_up() {
    let keys: String = (0..1000).map(|n| format!("key{n} = 0\n")).collect();
    assert!(mistakes(&format!("{MINIMAL}[image]\n{keys}")).len() < 20);
}

#[test]
fn sections_are_tables() {
    assert_eq!(mistakes(&format!("voxels = [64]\n{MINIMAL}")), ["[voxels] is a section"]);
    assert_eq!(mistakes("version = 1\nsurface = []\n"), ["the scene has no surface"]);
    assert_eq!(mistakes("version = 1\nsurface = [3]\n"), ["[[surface]] is a section"]);
}

#[test]
fn files_too_large_to_be_scenes_are_not_read() {
    let file = tempfile::NamedTempFile::new().unwrap();
    file.as_file().set_len(5 << 20).unwrap();
    let error = load(file.path()).unwrap_err();
    assert!(matches!(&error, Error::Limit(text) if text.contains("larger than 4 MiB")), "{error}");
}

proptest! {
    #[test]
    fn soup_gives_an_answer_with_spans_in_the_text(
        soup in r#"(version = 1
|version|\[\[surface\]\]
|\[camera\]
|\[image\]
|f = "x"
|f|eye|up|color|width|png|[0-9]|nan|inf|=|=|"|'|\{|\}|\[|\]|,|\.|-|é| |
){0,60}"#,
    ) {
        if let Err(rejection) = parse(Path::new("a.toml"), &soup) {
            for mistake in &rejection.diagnostics {
                prop_assert!(soup.get(mistake.span.clone()).is_some(), "{mistake:?}");
            }
        }
    }
}
