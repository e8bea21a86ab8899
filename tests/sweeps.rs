//! Sweeps: which values in which frame, one camera for all, the contact sheet, files.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]

use std::{
    collections::BTreeSet,
    fs,
    path::Path,
    process::{Command, Output},
};

use serde_json::Value;
use zeroset::{
    film::Film,
    pipeline::{self, Options},
    progress::Unwatched,
    raster::Frame,
    scene,
};

/// Balls of three sizes at two heights, in front of a blue wall.
const BALLS: &str = "version = 1\n[params]\nheight = 0\nsize = 1\n[[surface]]\n\
    f = \"x^2 + y^2 + (z - height)^2 = size^2\"\n[voxels]\nresolution = 48\n\
    [image]\nwidth = 40\nheight = 30\nbackground = \"#000080\"\n\
    [sweep]\nheight = { values = [2, -2] }\nsize = [0.5, 1, 3]\n";

fn render(scene: &str, arguments: &[&str]) -> (Output, tempfile::TempDir) {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("balls.toml"), scene).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_render"));
    command.current_dir(directory.path()).arg("balls.toml").args(arguments);
    (command.output().unwrap(), directory)
}

fn names(directory: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(directory.join("out")).unwrap();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

/// A frame is the scene with its values, but for the domain and the camera, which are those of all.
#[test]
fn frames_are_the_scene_with_other_values() {
    let fixed = "[domain]\nmin = [-3, -3, -3]\nmax = [3, 3, 3]\n\
                 [camera]\neye = [0, -9, 1]\ntarget = [0, 0, 0]\n";
    let sweep = scene::parse(Path::new("balls.toml"), &format!("{BALLS}{fixed}")).unwrap();
    let still = format!("{}{fixed}", BALLS.split("[sweep]").next().unwrap());
    let options = Options::default();
    let film = Film::new(&sweep, &options, &Unwatched).unwrap();
    assert_eq!(sweep.n_frames(), 6);
    let values = [2.0, -2.0].into_iter().flat_map(|h| [0.5, 0.75, 1.0].map(|s| (h, s)));
    for (number, (height, size)) in (1..).zip(values) {
        let settings = [format!("height={height}"), format!("size={size}")];
        let alone = scene::parse_with(Path::new("ball.toml"), &still, &settings, None).unwrap();
        let expected = pipeline::render(&alone, &options, &Unwatched).unwrap().frame;
        assert_eq!(film.picture(number, &Unwatched).unwrap().frame, expected, "{number}");
    }
}

/// A fitted camera is the same in all frames, and nothing is cut off.
#[test]
fn variants_are_seen_from_one_place() {
    let scene = scene::parse(Path::new("balls.toml"), BALLS).unwrap();
    let options = Options::default();
    let film = Film::new(&scene, &options, &Unwatched).unwrap();
    let pictures = [1, 3, 6].map(|number| film.picture(number, &Unwatched).unwrap());
    let rows = pictures.each_ref().map(|picture| {
        assert_eq!(picture.camera.eye(), pictures[0].camera.eye());
        let covers = |pixel: usize| picture.frame.depth[pixel] != Frame::FAR;
        let is_row_covered = |y: &usize| (0..40).any(|x| covers(40 * y + x));
        assert!(!is_row_covered(&0) && !is_row_covered(&29));
        (0..30).filter(is_row_covered).collect::<Vec<_>>()
    });
    assert!(rows[0].len() < rows[1].len(), "the second is larger");
    assert!(rows[1].iter().all(|y| !rows[2].contains(y)), "the third is lower");
}

#[test]
fn files_are_numbered_and_the_sheet_holds_all() {
    let (output, directory) = render(BALLS, &["--stats", "-"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let said = String::from_utf8(output.stderr).unwrap();
    let expected = "balls.toml: wrote 6 frames: out/balls_0001.png to out/balls_0006.png, \
                    out/balls_0001.exr to out/balls_0006.exr, out/balls.sheet.png in ";
    assert!(said.lines().last().unwrap().starts_with(expected), "{said}");
    let numbered = |number| ["png", "exr"].map(|ending| format!("balls_000{number}.{ending}"));
    let sheet = "balls.sheet.png".to_owned();
    assert_eq!(names(directory.path()), (1..=6).flat_map(numbered).chain([sheet]).collect());

    let lines: Vec<Value> = String::from_utf8(output.stdout)
        .unwrap()
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(lines.len(), 6);
    assert_eq!(lines[4]["frame"]["number"], 5);
    assert_eq!(lines[4]["frame"]["params"], serde_json::json!({"height": -2.0, "size": 0.75}));

    // Rows are heights. A picture is in the middle of its cell, which is wider for the words.
    let out = directory.path().join("out");
    let sheet = image::open(out.join("balls.sheet.png")).unwrap().into_rgb8();
    let (width, height) = (sheet.width() / 3, sheet.height() / 2);
    assert!(width >= 40 + 8 && height >= 30 + 2 * 16, "{width} x {height}");
    for number in 1..=6 {
        let single = image::open(out.join(format!("balls_000{number}.png"))).unwrap().into_rgb8();
        let (left, top) = ((number - 1) % 3 * width + (width - 40) / 2, (number - 1) / 3 * height);
        for (x, y, pixel) in single.enumerate_pixels() {
            assert_eq!(sheet.get_pixel(left + x, top + y), pixel, "{number}: {x}, {y}");
        }
        let ink =
            |y: u32| (0..width).any(|x| sheet.get_pixel(left + x - (width - 40) / 2, y).0[0] < 128);
        assert!((top + 30..top + height).any(ink), "words below {number}");
    }
}

/// The sheet has the rows of the frames that are drawn; a frame alone is that of the whole.
#[test]
fn some_frames_can_be_drawn() {
    let (_, whole) = render(BALLS, &[]);
    let (output, part) = render(BALLS, &["--frames", "5-6", "--threads", "1"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    for name in names(part.path()).iter().filter(|name| !name.contains("sheet")) {
        let read = |folder: &Path| fs::read(folder.join("out").join(name)).unwrap();
        assert_eq!(read(whole.path()), read(part.path()), "{name}");
    }
    let sheet =
        |folder: &Path| image::open(folder.join("out/balls.sheet.png")).unwrap().into_rgb8();
    let (whole, part) = (sheet(whole.path()), sheet(part.path()));
    assert_eq!((part.width(), 2 * part.height()), whole.dimensions());
    for (x, y, pixel) in part.enumerate_pixels() {
        let is_drawn = x >= part.width() / 3;
        let expected = if is_drawn { whole.get_pixel(x, y + part.height()).0 } else { [255; 3] };
        assert_eq!(pixel.0, expected, "{x}, {y}");
    }
    let (output, _) = render(BALLS, &["--frames", "7"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(said.contains("there is no frame 7: the sweep has 6"), "{said}");
}

/// Large pictures are reduced, so that a sheet stays below 4096 pixels.
#[test]
fn large_pictures_are_reduced() {
    let text = BALLS.replace("width = 40\nheight = 30", "width = 3000\nheight = 1500");
    let scene = scene::parse(Path::new("balls.toml"), &text).unwrap();
    let (grid, factor) = scene.sweep.as_ref().unwrap().sheet(&scene.image);
    assert_eq!((factor, grid.picture_px), (3, [1000, 500]));
    assert!(grid.size_px().iter().all(|&n| n <= 4096));
}

#[test]
fn each_variant_becomes_a_mesh() {
    let scene = format!("{BALLS}[output]\npng = false\nexr = false\nsheet = false\nstl = true\n");
    let (output, directory) = render(&scene, &["--stats", "-", "--resolution", "96"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert_eq!(names(directory.path()), (1..=6).map(|n| format!("balls_000{n}.stl")).collect());
    let lines = String::from_utf8(output.stdout).unwrap();
    let volumes: Vec<f64> = lines
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap())
        .map(|line| line["meshes"][0]["volume"].as_f64().unwrap())
        .collect();
    for (volume, size) in volumes.iter().zip([0.5_f64, 0.75, 1.0, 0.5, 0.75, 1.0]) {
        let expected = 4.0 / 3.0 * std::f64::consts::PI * size * size * size;
        assert!((volume / expected - 1.0).abs() < 0.02, "{volume}, not {expected}");
    }
}

#[test]
fn more_than_two_parameters_make_rows_of_the_last() {
    let text = BALLS.replace("[params]\n", "[params]\nw = 1\n").replace("x^2", "w*x^2")
        + "w = { values = [1, 2, 3, 4, 5] }\n";
    let scene = scene::parse(Path::new("balls.toml"), &text).unwrap();
    let sweep = scene.sweep.as_ref().unwrap();
    let (grid, _) = sweep.sheet(&scene.image);
    assert_eq!((sweep.n_frames(), grid.n_columns, grid.n_rows), (30, 5, 6));
    assert_eq!(sweep.caption(7), ["height = 2", "size = 0.75", "w = 2"]);
}
