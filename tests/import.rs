//! Files of other programs as scenes: what they mean, and what is said of those that mean nothing.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

use proptest::prelude::*;
use zeroset::{
    Error,
    diagnostic::Rejection,
    import,
    pipeline::{self, Options},
    progress::Unwatched,
    raster::Placement,
    scene::{self, Scene},
};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/imports")
}

/// The scene of a file with this text, and the notes about it.
fn converted(name: &str, text: &str) -> (Scene, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, text).unwrap();
    let converted = import::convert(&path).unwrap();
    let loaded = scene::parse(Path::new("scene.toml"), &converted.scene);
    let scene = loaded.unwrap_or_else(|mistakes| panic!("{}\n{mistakes:?}", converted.scene));
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    (scene, converted.notes)
}

/// What is wrong with a file with this text.
fn refused(name: &str, text: &str) -> Rejection {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, text).unwrap();
    match import::convert(&path) {
        Err(Error::Scene(rejection)) => *rejection,
        other => panic!("{text}: {other:?}"),
    }
}

fn convert(arguments: &[&str], folder: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_render"));
    command.arg("convert").args(arguments).current_dir(folder).output().unwrap()
}

#[test]
fn all_examples_are_scenes() {
    let mut n = 0;
    for entry in fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        let converted = import::convert(&path).unwrap();
        let scene = scene::parse(Path::new("scene.toml"), &converted.scene).unwrap();
        assert!(scene.warnings.is_empty(), "{}: {:?}", path.display(), scene.warnings);
        n += 1;
    }
    assert!(n >= 3, "{n} examples");
}

#[test]
fn the_scene_in_configs_is_what_its_file_becomes() {
    let scene = import::convert(&folder().join("tubes.jsurf")).unwrap().scene;
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/tubes.toml");
    // An editor's first line stands before it.
    let text = fs::read_to_string(path).unwrap();
    assert_eq!(text.split_once('\n').unwrap().1, scene);
}

/// Where a small ball at (x, y, z) of the formula is in Surfer's picture, from -1 to 1.
fn expected_place(rows: [[f64; 3]; 3], scale: f64, ball: [f64; 3]) -> [f64; 2] {
    // Surfer's rays go from camera to ball by the matrix, and to the formula by the scale: the way
    // back is the transposed matrix.
    let along = |column: usize| (0..3).map(|row| rows[row][column] * ball[row] / scale).sum();
    [along(0), along(1)]
}

#[test]
fn things_are_where_surfer_shows_them() {
    let s = 0.5_f64.sqrt();
    let turns = [
        ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], 0.0),
        ([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], 0.3),
        ([[s, -s, 0.0], [0.5, 0.5, -s], [0.5, 0.5, s]], -0.2),
    ];
    for (rows, exponent) in turns {
        let scale = libm::pow(10.0, exponent);
        let ball = [0.3, 0.5, -0.2].map(|v| v * scale);
        let [x, y, z] = ball;
        let matrix: Vec<String> = rows.iter().map(|[a, b, c]| format!("{a} {b} {c} 0")).collect();
        let text = format!(
            "surface_equation=(x-{x})^2+(y-{y})^2+(z+{})^2-{}\nscale_factor={exponent}\n\
             rotation_matrix={} 0 0 0 1\n",
            -z,
            0.01 * scale * scale,
            matrix.join(" ")
        );
        let (mut scene, notes) = converted("ball.jsurf", &text);
        assert!(notes.is_empty(), "{notes:?}");
        (scene.image.width, scene.image.height) = (100, 100);
        let options = Options { resolution: Some(32), ..Options::default() };
        let frame = pipeline::render(&scene, &options, &Unwatched).unwrap().frame;
        let shown = (0..100 * 100).filter(|&i| frame.surface[i] > 0.0);
        let places: Vec<[f64; 2]> = shown
            .map(|i| [(i % 100) as f64 / 50.0 - 0.99, 0.99 - (i / 100) as f64 / 50.0])
            .collect();
        let mean = [0, 1]
            .map(|axis| places.iter().map(|place| place[axis]).sum::<f64>() / places.len() as f64);
        let want = expected_place(rows, scale, ball);
        assert!((mean[0] - want[0]).abs() < 0.01, "{rows:?}: {mean:?} and not {want:?}");
        assert!((mean[1] - want[1]).abs() < 0.01, "{rows:?}: {mean:?} and not {want:?}");
    }
}

#[test]
fn surfaces_end_at_the_ball() {
    let text = "surface_equation=z\n\
                surface_transform_matrix=3 0 0 0.5 0 3 0 -0.25 0 0 3 0 0 0 0 1\n";
    let (mut scene, _) = converted("plane.jsurf", text);
    (scene.image.width, scene.image.height) = (100, 100);
    let options = Options { resolution: Some(64), ..Options::default() };
    let frame = pipeline::render(&scene, &options, &Unwatched).unwrap().frame;
    let covered = frame.surface.iter().filter(|&&number| number > 0.0).count() as f64;
    // A disc that touches the picture's borders.
    let share = covered / 10_000.0 / std::f64::consts::FRAC_PI_4;
    assert!((share - 1.0).abs() < 0.02, "{share}");
}

#[test]
fn what_surfer_writes_twice_counts_once() {
    let turn = "0 0 1 0  1 0 0 0  0 1 0 0  0 0 0 1";
    let scale = "2 0 0 0  0 2 0 0  0 0 2 0  0 0 0 1";
    let formula = "surface_equation=x^2+y^2-z\n";
    let first = format!("{formula}scale_factor=0.30103\nrotation_matrix={turn}\n");
    let second = format!("{formula}surface_transform_matrix={scale}\ntransform_matrix={turn}\n");
    let both = format!("{first}surface_transform_matrix={scale}\ntransform_matrix={turn}\n");
    let scene = |text: &str| import::convert_text(Path::new("a.jsurf"), text.to_owned()).unwrap();
    assert_eq!(scene(&first), scene(&both));
    // Numbers differ after the sixth digit.
    let loaded = |text: &str| scene::parse(Path::new("a.toml"), &scene(text).scene).unwrap();
    let views = [&first, &second].map(|text| match loaded(text).view.placement {
        Placement::LookAt { eye, .. } => eye,
        Placement::Fit { .. } => panic!("the camera is not fixed"),
    });
    assert!(views[0].distance(views[1]) < 1e-5, "{views:?}");
    assert!((views[0].length() - 2.0).abs() < 1e-5, "{views:?}");
    let other = format!("{first}transform_matrix=0 1 0 0 0 0 1 0 1 0 0 0 0 0 0 1\n");
    assert_eq!(
        scene(&other).notes,
        ["`transform_matrix` is ignored, as in Surfer, for `rotation_matrix`"]
    );
}

#[test]
fn parameters_keep_their_values() {
    let text = "surface_equation=x^2+y^2+z^2-log(a)*r\nsurface_parameter_a=2.5\n\
                surface_parameter_r=0.25\n";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ball.jsurf");
    fs::write(&path, text).unwrap();
    let scene = import::convert(&path).unwrap().scene;
    // `r` is the distance from the origin here, and `log` is not said to which base.
    for line in ["a = 2.5", "r_ = 0.25", "f = \"x^2+y^2+z^2-ln(a)*r_\""] {
        assert!(scene.lines().any(|found| found == line), "{line} is not in\n{scene}");
    }
}

#[test]
fn colours_of_both_sides_and_lights_are_kept() {
    let text = fs::read_to_string(folder().join("citrus.jsurf")).unwrap();
    let (scene, notes) = converted("citrus.jsurf", &text);
    let material = &scene.surfaces[0].material;
    assert!(material.color[0] > 0.9 && material.color[2] < 0.1, "{:?}", material.color);
    let back = material.back_color.unwrap();
    assert!(back[1] > back[0], "{back:?}");
    assert_eq!(scene.image.lights.len(), 1);
    assert_eq!(notes, ["light 0 is near the surface; here it is far away, on the same side"]);
}

#[test]
fn mistakes_are_named_where_they_are() {
    let formula = "surface_equation=x^2+y^2+z^2-1\n";
    for (text, message, marked) in [
        ("a=1\n", "the file has no `surface_equation`", ""),
        ("surface_equation=x^2+b*y\n", "the parameter `b` has no value", "b"),
        ("surface_equation=x^2+*y\n", "", "+*"),
        ("surface_equation=x+sinh(y)\n", "`sinh` is no function of Surfer", "sinh"),
        (&format!("{formula}scale_factor=big\n"), "`scale_factor` is `big`, not a number", "big"),
        (&format!("{formula}scale_factor=40\n"), "`scale_factor` is 40", "40"),
        (&format!("{formula}background_color=1 2\n"), "", "1 2"),
        (&format!("{formula}background_color=1 2 3\n"), "`background_color` is no colour", "1 2 3"),
        (&format!("{formula}camera_type=FISHEYE\n"), "`camera_type` is `FISHEYE`", "FISHEYE"),
        (&format!("{formula}camera_height=-1\n"), "`camera_height` is -1", "-1"),
        (&format!("{formula}light_status_0=on\n"), "`light_status_0` is `on`", "on"),
        (
            &format!("{formula}rotation_matrix=2 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n"),
            "the matrices stretch or mirror space",
            "2 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1",
        ),
        (
            &format!("{formula}transform_matrix=-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n"),
            "the matrices stretch or mirror space",
            "-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1",
        ),
        (&format!("{formula}a=\\u12"), "`\\u` stands without its code", "\\u"),
    ] {
        let Rejection { sources, diagnostics } = refused("bad.jsurf", text);
        assert_eq!(diagnostics.len(), 1, "{text}: {diagnostics:?}");
        assert!(diagnostics[0].message.contains(message), "{text}: {diagnostics:?}");
        assert_eq!(&sources.text[diagnostics[0].span.clone()], marked, "{text}");
    }
}

/// Other values for some lines of a file.
fn other_values() -> impl Strategy<Value = Vec<(usize, &'static str)>> {
    let values = prop::sample::select(vec![
        "",
        "0",
        "-1",
        "1e300",
        "1e-300",
        "x",
        "ON",
        "1 1 1",
        "0 0 0",
        "f(x)",
        "x^y",
        "\\u",
        "\\",
        "2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1",
        "1 0 0 9 0 1 0 9 0 0 1 9 0 0 0 1",
        "-1e308 1e308 0",
    ]);
    prop::collection::vec((0..100_usize, values), 0..4)
}

/// Characters that are put in at some places.
fn signs() -> impl Strategy<Value = Vec<(usize, char)>> {
    let signs =
        prop::sample::select(vec!['=', '\\', ' ', '\n', '-', '9', 'é', '(', 'x', '#', '\0']);
    prop::collection::vec((0..2000_usize, signs), 0..4)
}

proptest! {
    /// A damaged file is a scene, or is refused with reasons that mark places of the file.
    #[test]
    fn damaged_files_do_no_harm(
        lines in other_values(),
        signs in signs(),
        example in 0..2_usize,
    ) {
        let text = fs::read_to_string(folder().join(["tubes.jsurf", "citrus.jsurf"][example])).unwrap();
        let mut all: Vec<String> = text.lines().map(str::to_owned).collect();
        let n = all.len();
        for (line, value) in lines {
            let line = &mut all[line % n];
            *line = format!("{}={value}", line.split('=').next().unwrap_or_default());
        }
        let mut text = all.join("\n");
        for (at, sign) in signs {
            let at = text.floor_char_boundary(at % text.len());
            text.insert(at, sign);
        }
        match import::convert_text(Path::new("a.jsurf"), text) {
            Ok(converted) => {
                let scene = scene::parse(Path::new("a.toml"), &converted.scene);
                prop_assert!(scene.is_ok(), "{}\n{:?}", converted.scene, scene.err());
            }
            Err(Error::Scene(rejection)) => {
                prop_assert!(!rejection.diagnostics.is_empty());
                for mistake in &rejection.diagnostics {
                    prop_assert!(rejection.sources.text.get(mistake.span.clone()).is_some());
                }
            }
            Err(other) => prop_assert!(false, "{other:?}"),
        }
    }
}

#[test]
fn unknown_keys_are_noted() {
    let (_, notes) = converted("a.jsurf", "surface_equation=x^2+y^2+z^2-0.5\nscale_facter=1\n");
    assert_eq!(notes, ["`scale_facter` is unknown and ignored; did you mean `scale_factor`?"]);
}

#[test]
fn the_command_writes_whole_scenes_that_render() {
    let directory = tempfile::tempdir().unwrap();
    fs::copy(folder().join("citrus.jsurf"), directory.path().join("citrus.jsurf")).unwrap();
    let printed = convert(&["citrus.jsurf"], directory.path());
    assert_eq!(printed.status.code(), Some(0), "{printed:?}");
    assert!(String::from_utf8_lossy(&printed.stderr).contains("note: citrus.jsurf: light 0"));

    let scene = directory.path().join("citrus.toml");
    fs::write(&scene, "an old file").unwrap();
    let written = convert(&["citrus.jsurf", "-o", "citrus.toml", "--quiet"], directory.path());
    assert_eq!(written.status.code(), Some(0), "{written:?}");
    assert_eq!((written.stdout, written.stderr), (vec![], vec![]));
    assert_eq!(fs::read(&scene).unwrap(), printed.stdout);
    assert!(scene::load(&scene).is_ok());
}

#[test]
fn what_cannot_be_converted_exits_with_2() {
    let directory = tempfile::tempdir().unwrap();
    for (name, text) in [("bad.jsurf", "a=1"), ("scene.toml", "version = 1"), ("large.jsurf", "")] {
        fs::write(directory.path().join(name), text).unwrap();
    }
    let large = fs::File::create(directory.path().join("large.jsurf")).unwrap();
    large.set_len(1 << 23).unwrap();
    for (arguments, words) in [
        (&["bad.jsurf"][..], "error: the file has no `surface_equation`\n --> bad.jsurf:1:1"),
        (&["scene.toml"], "error: scene.toml cannot be converted; what can be: .jsurf (Surfer)"),
        (&["large.jsurf"], "error: large.jsurf: the file is larger than 4 MiB"),
        (&["bad.jsurf", "-o", "bad.jsurf"], "the name of a scene file ends in .toml"),
        (&[], "FILE"),
    ] {
        let output = convert(arguments, directory.path());
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.contains(words), "{said}");
    }
    let missing = convert(&["missing.jsurf"], directory.path());
    assert_eq!(missing.status.code(), Some(1), "{missing:?}");
}
