//! `render evaluate`: figures that repeat, histograms that add up, errors of the size that samples
//! allow.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]

use std::{
    collections::BTreeMap,
    fs,
    path::Path,
    process::{Command, Output},
};

use glam::DVec3;
use zeroset::{
    evaluate::{CellOctree, Counts, Errors, GRID, Histogram, Properties, Surface, Truth},
    expr::{self, Expr},
    hrb::Tolerance,
    math::Aabb,
    progress::Unwatched,
    volume::{
        Quantize, Volume,
        thesis::{Alpha, MODELS},
    },
};

const CUBE: Aabb = Aabb { min: DVec3::NEG_ONE, max: DVec3::ONE };

fn formula(text: &str) -> Expr {
    Expr::resolve(&expr::parse(text).unwrap(), &[]).unwrap().expr
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_render"))
        .current_dir(folder)
        .arg("evaluate")
        .args(arguments)
        .output()
        .unwrap()
}

/// All files of a report but times; of the report itself what is not about them.
fn figures(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        let bytes = fs::read(&path).unwrap();
        if name == "report.md" {
            let text = String::from_utf8(bytes).unwrap();
            let without_times = text.split("\n## ").filter(|part| !part.starts_with("Time"));
            files.insert(name, without_times.collect::<String>().into_bytes());
        } else if !name.starts_with("time.") {
            files.insert(name, bytes);
        }
    }
    files
}

#[test]
fn figures_repeat_but_for_times() {
    let folder = tempfile::tempdir().unwrap();
    let mut all = Vec::new();
    for name in ["a", "b"] {
        let output =
            run(folder.path(), &["esfera", "--sizes", "16,32", "--runs", "1", "--out", name]);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        all.push(figures(&folder.path().join(name)));
    }
    assert_eq!(all[0].keys().collect::<Vec<_>>(), all[1].keys().collect::<Vec<_>>());
    for (name, bytes) in &all[0] {
        assert!(*bytes == all[1][name], "{name} differs");
    }
    // Counts that another program found as well.
    let space = String::from_utf8(all[0]["space.csv"].clone()).unwrap();
    for row in ["esfera α1,32³,ε = 0,873,6112,21828", "esfera α2,32³,ε = 0,2921,20448,73028"]
    {
        assert!(space.contains(row), "{row} is not in {space}");
    }
    let report = String::from_utf8(all[0]["report.md"].clone()).unwrap();
    for link in report.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
        let is_there = all[0].contains_key(link) || link.starts_with("time.") || link == "#time";
        assert!(is_there, "{link} is named and not there");
    }
}

/// The histogram holds every vertex that was measured, once.
#[test]
fn histograms_add_up() {
    let folder = tempfile::tempdir().unwrap();
    let output =
        run(folder.path(), &["tronco:alpha2", "--sizes", "32", "--runs", "1", "--out", "."]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let rows = |text: &str| -> Vec<Vec<String>> {
        text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
    };
    let histogram = read("tronco-alpha2-histogram.csv");
    let errors = read("error.csv").replace("1, dev", "1 dev").replace("2, dev", "2 dev");
    for (way, row) in rows(&errors).into_iter().enumerate() {
        let number = |i: usize| row[i].parse::<u64>().unwrap();
        let [vertices, jumps, undefined] = [3, 10, 11].map(number);
        let column = rows(&histogram).into_iter().map(|bin| bin[way + 1].parse::<u64>().unwrap());
        assert_eq!(column.sum::<u64>() + jumps + undefined, vertices, "{row:?}");
        assert!(undefined > 0, "the trunk is undefined in a cone that its surface touches");
    }
}

fn errors_of(formula: &Expr, n: u32, quantize: Quantize, tolerance: Tolerance) -> Errors {
    let volume = Volume::sampled(formula, CUBE, [n; 3], quantize, &Unwatched).unwrap();
    let surface = Surface::new(&volume, 60.0, tolerance);
    assert!(surface.triangles.len() > 1000);
    let tape = formula.tape();
    Errors::new(&surface, Truth::Formula(&tape), 60.0, 2.0 / f64::from(n))
}

/// Floats are met to a few thousandths of a voxel, by which chords leave a sphere, bytes to the quarter of one that 255 steps allow.
#[test]
fn errors_are_those_of_samples() {
    let density = formula(&MODELS[0].text(Alpha::Linear));
    let grid = Tolerance { epsilon: GRID, ..Tolerance::default() };
    let floats = errors_of(&density, 128, Quantize::None, grid).summary();
    assert!(floats.n > 40_000 && floats.largest < 0.003, "{floats:?}");
    let bytes = errors_of(&density, 128, Quantize::Floor, grid).summary();
    assert!((0.2..0.26).contains(&bytes.largest) && bytes.signed_mean < -0.1, "{bytes:?}");
    // One voxel farther out: the error is the distance.
    let larger = formula("255*(1 - r) + 255/64");
    let volume = Volume::sampled(&density, CUBE, [128; 3], Quantize::None, &Unwatched).unwrap();
    let surface = Surface::new(&volume, 60.0, grid);
    let (tape, voxel) = (larger.tape(), 2.0 / 128.0);
    let shifted = Errors::new(&surface, Truth::Formula(&tape), 60.0, voxel).summary();
    assert!((shifted.signed_mean + 1.0).abs() < 0.003, "{shifted:?}");
    let histogram = Histogram::new([1.0]);
    assert_eq!(histogram.counts[999], 1);
}

/// A finer grid of a formula that is linear is the formula.
#[test]
fn finer_grids_tell_the_truth_too() {
    let plane = formula("60 + 20*x + 7*y - 3*z");
    let [fine, coarse] = [64, 32]
        .map(|n| Volume::sampled(&plane, CUBE, [n; 3], Quantize::None, &Unwatched).unwrap());
    let surface = Surface::new(&coarse, 60.0, Tolerance::default());
    let errors = Errors::new(&surface, Truth::Grid(&fine), 60.0, 2.0 / 32.0);
    // But for the outermost half of a voxel, where samples go on as they are; vertices stay away from
    // the ends of edges by a 256th.
    let inner = surface
        .positions
        .iter()
        .zip(&errors.signed)
        .filter(|(p, _)| p.abs().max_element() < 1.0 - 2.0 / 32.0);
    assert!(inner.clone().count() > 1000);
    assert!(inner.into_iter().all(|(_, error)| error.abs() < 1.0 / 255.0));
}

/// HRB is continuous and within the tolerance; cells jump, and regions as such more.
#[test]
fn interpolations_differ_as_they_should() {
    let density = formula(&MODELS[2].text(Alpha::Linear));
    let volume = Volume::sampled(&density, CUBE, [32; 3], Quantize::Floor, &Unwatched).unwrap();
    let epsilon = 24.0;
    let [regions, cells, hrb] = Properties::new(&volume, epsilon).differences().try_into().unwrap();
    assert!(hrb.largest <= epsilon && hrb.largest > 0.0 && hrb.jump == 0.0);
    assert!(cells.jump > 1.0 && cells.jump <= epsilon);
    assert!(regions.jump > cells.jump && regions.rms > hrb.rms);
    let Counts { corners, .. } = CellOctree::build(&volume, epsilon).counts();
    assert!(corners < 32 * 32 * 32);
}

#[test]
fn mistakes_are_told() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("empty.toml"), "version = 1\n[[surface]]\nf = \"x\"\n").unwrap();
    for (arguments, words) in [
        (&["sphere"][..], "it is no file, no model"),
        (&["esfera:alpha9"], "alpha1 or alpha2"),
        (&["empty.toml"], "has no [[volume]] section"),
        (&["missing.toml"], "cannot read missing.toml"),
        (&["esfera", "--sizes", "4"], "4 is not in 8..=1024"),
        (&["esfera", "--criterion", "mean"], "it is range or deviation"),
        (&["--isovalue", "inf"], "write a number"),
    ] {
        let output = run(folder.path(), arguments);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.contains(words), "{arguments:?}: {said}");
        assert!(matches!(output.status.code(), Some(1 | 2)), "{arguments:?}");
        assert!(!folder.path().join("out").exists());
    }
}

#[test]
fn the_command_of_the_readme_runs() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let readme = fs::read_to_string(root.join("README.md")).unwrap();
    let command =
        readme.lines().find_map(|line| line.strip_prefix("render evaluate esfera")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let rest = command.split_whitespace().chain(["--runs", "1"]);
    let arguments: Vec<&str> = std::iter::once("esfera").chain(rest).collect();
    let output = run(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(folder.path().join("out/evaluation/report.md").exists());
}
