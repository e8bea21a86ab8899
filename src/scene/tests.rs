//! Tests of scene files as a whole; the words for mistakes are tested in `tests/diagnostics`.

use std::path::Path;

use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::{
    Error,
    diagnostic::Origin,
    math::Aabb,
    raster::{Axes, Light, Placement, Projection},
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
    assert_eq!(scene.domain, None);
    assert!(scene.image.lights.is_empty() && scene.warnings.is_empty());
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
        [params]
        a = 1_000.5e-1
        b = "a/2"
        [let]
        square = "x^2 + y^2 + b"
        [[surface]]
        name = "ball"
        f = "1 - x^2 - y^2 - z^2"
        inside = "positive"
        color = "#ff8000"
        back_color = "#ffffff"
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
        [[light]]
        direction = [0, 0, 2]
        [[light]]
        direction = [-1, 1, 1]
        relative_to = "camera"
        color = [0, 0, 1]
        intensity = 0.5
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
    let domain = Aabb { min: DVec3::new(-2.0, -3.5, 0.0), max: DVec3::new(2.0, 3.5, 10.0) };
    assert_eq!(scene.domain, Some(domain));
    assert_eq!(scene.surfaces[0].material.back_color, Some([1.0; 3]));
    let back = Light {
        direction: DVec3::new(-1.0, 1.0, 1.0),
        axes: Axes::Camera,
        color: [0.0, 0.0, 1.0],
        intensity: 0.5,
    };
    let front =
        Light { direction: 2.0 * DVec3::Z, axes: Axes::Scene, color: [1.0; 3], intensity: 1.0 };
    assert_eq!(scene.image.lights, [front, back]);
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

const PARAMS: &str = "version = 1\n[params]\na = 1\nb = 'a/2'\n[let]\nq = 'x^2 + a'\n\
    [[surface]]\nf = 'q + b'\n[[surface]]\nf = 'y = a'\n";

/// The complaints about `settings`, with the texts that they mark.
fn refused(settings: &[&str]) -> Vec<(String, String)> {
    let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
    let rejection = parse_with(Path::new("a.toml"), PARAMS, &settings, None).unwrap_err();
    let sources = rejection.sources;
    let marked = |mistake: Diagnostic| {
        let (_, text) = sources.get(mistake.origin);
        (mistake.message, text[mistake.span].to_owned())
    };
    rejection.diagnostics.into_iter().map(marked).collect()
}

#[test]
fn settings_take_the_place_of_parameters() {
    let tape = |settings: &[&str]| {
        let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
        let scene = parse_with(Path::new("a.toml"), PARAMS, &settings, None).unwrap();
        format!("{:?}", scene.surfaces[1].expr.tape())
    };
    assert_eq!(tape(&[]), tape(&["a=1"]));
    assert_ne!(tape(&[]), tape(&["a=2"]));
    assert_eq!(tape(&["a=2"]), tape(&["a = 1+1"]));
    assert_eq!(tape(&["a=5", "a=2"]), tape(&["a=2"]), "the last one counts");
}

#[test]
fn mistakes_in_settings_are_shown_in_the_setting() {
    let refused = |setting| refused(&[setting]).remove(0);
    let found = |message: &str, text: &str| (message.to_owned(), text.to_owned());
    assert_eq!(refused("c=1"), found("the scene has no parameter `c`", "c"));
    assert_eq!(refused("q=1"), found("the scene has no parameter `q`", "q"));
    assert_eq!(refused("a"), found("the setting has no value", "a"));
    assert_eq!(refused("a=1+*2"), found("nothing stands between `+` and `*`", "+*"));
    assert_eq!(refused("a=1+foo"), found("unknown name `foo`", "foo"));
}

#[test]
fn names_are_checked() {
    let scene = |rest: &str| format!("{MINIMAL}{rest}");
    assert_eq!(mistakes(&scene("[params]\nx = 1")), ["`x` is a coordinate"]);
    assert_eq!(mistakes(&scene("[params]\n'a b' = 1")), ["`a b` is no name"]);
    assert_eq!(mistakes(&scene("[params]\na = 1\n[let]\na = 'x'")), ["`a` is defined twice"]);
    assert_eq!(
        mistakes(&scene("[params]\na = [1]\nb = nan")),
        ["expected a number or a formula in quotes", "expected a finite number"]
    );
    assert_eq!(mistakes(&scene("[[params]]\na = 1")), ["[params] is written in single brackets"]);
}

#[test]
fn caps_need_clips() {
    let scene = |rest: &str| format!("{MINIMAL}{rest}");
    assert_eq!(mistakes(&scene("cap = true")), ["`cap` stands without `clip`"]);
    assert_eq!(mistakes(&scene("[domain]\ncap = true")), ["`cap` stands without `clip`"]);
    assert_eq!(mistakes(&scene("clip = 'x'")), ["`clip` must be an inequality"]);
    assert_eq!(mistakes(&scene("[domain]\nclip = 'x = 1'")), ["`clip` must be an inequality"]);
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

/// A folder with the model `file` and what a scene in it with this model says.
fn with_model(file: &str, text: &[u8]) -> (tempfile::TempDir, Result<Scene, Error>) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(file), text).unwrap();
    let path = folder.path().join("a.toml");
    std::fs::write(&path, format!("version = 1\n[[surface]]\nfile = '{file}'\n")).unwrap();
    let scene = load(&path);
    (folder, scene)
}

#[test]
fn models_lie_beside_the_scene() {
    let (folder, scene) = with_model("x.vm", b"_x var-x\n_1 const 1\n_ sub _x _1");
    let expr = scene.unwrap().surfaces.remove(0).expr;
    let text = "version = 1\n[[surface]]\nf = 'x - 1'\n[[surface]]\nfile = 'x.vm'\n\
                [[surface]]\nfile = 'x.vm'\ninside = 'positive'\n[[surface]]\nf = '1 - x'\n";
    let scene = parse_with(Path::new("b.toml"), text, &[], Some(folder.path())).unwrap();
    let program = |expr: &Expr| format!("{:?}", expr.tape().instructions());
    let programs: Vec<String> = scene.surfaces.iter().map(|s| program(&s.expr)).collect();
    assert_eq!(programs[0], programs[1]);
    assert_eq!(programs[1], program(&expr));
    assert_ne!(programs[1], programs[2]);
    assert_eq!(scene.sources.models.len(), 1, "read once");
}

#[test]
fn a_text_without_a_folder_opens_no_file() {
    let text = "version = 1\n[[surface]]\nfile = 'Cargo.vm'\n[[surface]]\nfile = '/dev/zero'\n";
    let expected = ["a scene without a folder names a file", "the name must end in `.vm`"];
    assert_eq!(mistakes(text), expected);
}

#[test]
fn mistakes_of_models_belong_to_them() {
    let (_folder, scene) = with_model("x.vm", b"_x var-q");
    let Err(Error::Scene(rejection)) = scene else { panic!("{scene:?}") };
    let mistake = &rejection.diagnostics[0];
    assert_eq!(mistake.origin, Origin::Model(0));
    let (name, text) = rejection.sources.get(mistake.origin);
    assert!(name.ends_with("x.vm") && &text[mistake.span.clone()] == "var-q", "{name}");
}

#[test]
fn models_too_large_are_not_read() {
    let (folder, scene) = with_model("x.vm", b"_x var-x");
    assert!(scene.is_ok());
    let model = |name: &str, mib: u64| {
        let file = std::fs::File::create(folder.path().join(name)).unwrap();
        file.set_len(mib << 20).unwrap();
    };
    model("a.vm", 9);
    model("b.vm", 9);
    model("c.vm", 1 << 20);
    let said = |text: &str| {
        let text = format!("version = 1\n{text}");
        let scene = parse_with(Path::new("a.toml"), &text, &[], Some(folder.path()));
        scene.unwrap_err().diagnostics.into_iter().map(|m| m.message).collect::<Vec<_>>()
    };
    assert!(said("[[surface]]\nfile = 'c.vm'\n")[0].ends_with("c.vm: it is too large"));
    let both = said("[[surface]]\nfile = 'a.vm'\n[[surface]]\nfile = 'b.vm'\n");
    assert!(both[0].ends_with("b.vm: it is too large"), "{both:?}");
}

/// What is wrong with a scene whose folder has these files.
fn with_files(files: &[(&str, &str)], allow_outside: bool) -> Result<Scene, Vec<String>> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, format!("version = 1\n{text}")).unwrap();
    }
    match load_with(
        &folder.path().join(files[0].0),
        &Loading { allow_outside, ..Loading::default() },
    ) {
        Ok(scene) => Ok(scene),
        Err(Error::Scene(rejection)) => {
            let place = folder.path().to_string_lossy().into_owned() + "/";
            let said = |mistake: Diagnostic| {
                let (name, text) = rejection.sources.get(mistake.origin);
                let name = name.replace(&place, "");
                let marked = text[mistake.span.clone()].to_owned();
                format!("{name}: {marked}: {}", mistake.message.replace(&place, ""))
            };
            Err(rejection.diagnostics.iter().cloned().map(said).collect())
        }
        Err(error) => panic!("{error}"),
    }
}

const USES_BALL: &str = "include = ['parts/a.toml']\n[[surface]]\nshape = 'ball'\n";

#[test]
fn definitions_are_included() {
    let a = "include = ['b.toml', '../parts/b.toml']\n[shapes]\nball = 'sphere(r_ball)'\n";
    let b = "[params]\nr_ball = 3\n";
    let scene =
        with_files(&[("s.toml", USES_BALL), ("parts/a.toml", a), ("parts/b.toml", b)], false);
    let program = |scene: &Scene| format!("{:?}", scene.surfaces[0].expr.tape().instructions());
    let scene = scene.unwrap();
    assert_eq!(scene.sources.models.len(), 2, "each is read once");
    let own = format!("{USES_BALL}[params]\nr_ball = 4\n");
    let other = with_files(&[("s.toml", &own), ("parts/a.toml", a), ("parts/b.toml", b)], false);
    let four = with_files(&[("s.toml", "[[surface]]\nshape = 'sphere(4)'\n")], false);
    assert_eq!(
        program(&other.unwrap()),
        program(&four.unwrap()),
        "the scene's own parameters count"
    );
    assert_ne!(program(&scene), "[]");
}

#[test]
fn circles_of_included_files_are_named() {
    let a = "include = ['b.toml']\n[shapes]\nball = 'sphere(1)'\n";
    let b = "include = ['a.toml']\n";
    let said =
        with_files(&[("s.toml", USES_BALL), ("parts/a.toml", a), ("parts/b.toml", b)], false);
    let expected = "parts/b.toml: 'a.toml': `parts/a.toml` includes itself: \
                    parts/a.toml -> b.toml -> parts/a.toml";
    assert_eq!(said.unwrap_err(), [expected]);
}

#[test]
fn files_outside_the_folder_are_included_only_if_allowed() {
    let files = [
        ("scenes/s.toml", "include = ['../a.toml']\n[[surface]]\nshape = 'ball'\n"),
        ("a.toml", "[shapes]\nball = 'sphere(1)'\n"),
    ];
    let said = with_files(&files, false).unwrap_err();
    assert_eq!(
        said[0],
        "scenes/s.toml: '../a.toml': scenes/../a.toml lies outside the scene's folder"
    );
    assert!(with_files(&files, true).is_ok());
}

#[test]
fn mistakes_of_included_files_belong_to_them() {
    let a = "ball = 3\n[shapes]\nball = 'sphere(q)'\n[[surface]]\nf = 'x'\n[let]\nball = 'x'\n";
    let said = with_files(&[("s.toml", USES_BALL), ("parts/a.toml", a)], false).unwrap_err();
    let expected = [
        "parts/a.toml: ball: `ball` stands in an included file",
        "parts/a.toml: ball: `ball` is defined twice",
        "parts/a.toml: surface: `surface` stands in an included file",
    ];
    assert_eq!(said, expected);
}

#[test]
fn a_text_without_a_folder_includes_nothing() {
    let text = "version = 1\ninclude = ['a.toml']\n[[surface]]\nf = 'x'\n";
    assert_eq!(mistakes(text), ["a scene without a folder includes a file"]);
}

#[test]
fn named_shapes_are_parts_of_formulas_and_shapes() {
    let text = "version = 1\n[params]\nscale = 2\n[shapes]\nbody = 'sphere(scale).scale(2)'\n\
        half = 'z <= 0'\n[let]\nq = 'body + 1'\n[[surface]]\nshape = 'body & half'\n\
        [[surface]]\nf = 'max(body, z) <= 0'\n[[surface]]\nf = 'q - 1'\n";
    let scene = parse(Path::new("a.toml"), text).unwrap();
    let program = |i: usize| format!("{:?}", scene.surfaces[i].expr.tape().instructions());
    assert_eq!(program(0), program(1));
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

proptest! {
    #[test]
    fn soup_gives_an_answer_with_spans_in_the_text(
        soup in r#"(version = 1
|version|\[\[surface\]\]
|\[camera\]
|\[image\]
|\[params\]
|\[let\]
|\[shapes\]
|include = ["a.toml"]
|shape = "a - sphere(1) | b.scale(2)"
|\[domain\]
|\[\[light\]\]
|a = "b"
|b = "2*a"
|clip = "x < a"
|file = "b.vm"
|f = "x"
|f|eye|up|color|width|png|[0-9]|nan|inf|=|=|"|'|\{|\}|\[|\]|,|\.|-|é| |
){0,60}"#,
    ) {
        if let Err(rejection) = parse(Path::new("a.toml"), &soup) {
            for mistake in &rejection.diagnostics {
                prop_assert_eq!(mistake.origin, Origin::File);
                prop_assert!(soup.get(mistake.span.clone()).is_some(), "{mistake:?}");
            }
        }
    }

    #[test]
    fn settings_give_an_answer_with_spans_in_them(setting in "[ab= x+(1é\"-]{0,12}") {
        let settings = [setting];
        if let Err(rejection) = parse_with(Path::new("a.toml"), PARAMS, &settings, None) {
            for mistake in &rejection.diagnostics {
                let (_, text) = rejection.sources.get(mistake.origin);
                prop_assert!(text.get(mistake.span.clone()).is_some(), "{mistake:?}");
            }
        }
    }
}
