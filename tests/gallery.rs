//! The gallery: what is in it, that all of it can be seen, and the command around it.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]

use std::{
    collections::BTreeSet,
    fs,
    path::Path,
    process::{Command, Output},
};

use serde_json::Value;
use zeroset::{
    gallery::{self, ENTRIES},
    pipeline::{self, Options},
    progress::Unwatched,
};

/// Surfaces with known truths, which are among them.
const KNOWN: &[&str] = &[
    "sphere",
    "ellipsoid_321",
    "torus_1_04",
    "superellipsoid_4",
    "octahedron",
    "astroidal_ellipsoid",
    "steinmetz_2",
    "steinmetz_3",
    "napkin_ring",
    "menger_3",
    "csg_fogleman",
    "ding_dong",
    "piriform",
    "pseudosphere",
    "helicoid",
    "moebius",
    "heart",
    "distel",
    "tanglecube",
    "banchoff_chmutov_4",
    "trefoil_knot",
    "hunt",
    "double_cone",
    "cayley",
    "clebsch",
    "kummer",
    "chmutov_quartic_12",
    "togliatti",
    "barth_sextic",
    "barth_sextic_30_cusps",
    "barth_decic",
    "whitney_umbrella",
    "steiner_roman",
    "klein",
    "boy_surface",
    "seed_pod",
    "gyroid",
    "schwarz_P",
    "schwarz_D",
    "scene2",
    "scene3",
];

fn names() -> BTreeSet<&'static str> {
    ENTRIES.iter().map(gallery::Entry::name).collect()
}

fn render(directory: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_render"));
    command.current_dir(directory).arg("gallery").args(arguments).output().unwrap()
}

#[test]
fn every_scene_of_the_folder_is_in_it() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("gallery");
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let scenes = files.filter(|path| path.extension().is_some_and(|ending| ending == "toml"));
    for path in scenes {
        let name = path.file_stem().unwrap().to_str().unwrap();
        assert!(names().contains(name), "{name} is not in the list");
    }
    assert_eq!(names().len(), ENTRIES.len(), "two have the same name");
}

#[test]
fn sixty_surfaces_are_in_it_and_all_with_known_truths() {
    assert!(ENTRIES.len() >= 60);
    for name in KNOWN {
        assert!(names().contains(name), "{name}");
    }
}

#[test]
fn each_says_what_it_is_without_a_warning() {
    for entry in ENTRIES {
        let scene = entry.scene(&[]).unwrap();
        pipeline::check(&scene).unwrap();
        // One is there to show that a golden ratio may hide an angle.
        let is_warned = !scene.warnings.is_empty();
        assert_eq!(is_warned, entry.name() == "barth_sextic", "{:?}", scene.warnings);
        let about = scene.about;
        for words in [about.title, about.source, about.note] {
            assert!(words.is_some_and(|words| words.len() > 2), "{}", entry.name());
        }
    }
}

#[test]
fn each_is_seen() {
    for entry in ENTRIES {
        let mut scene = entry.scene(&[]).unwrap();
        scene.image.width = 40;
        scene.image.height = 40;
        scene.image.samples = 1;
        let options = Options { resolution: Some(64), ..Options::default() };
        let picture = pipeline::render(&scene, &options, &Unwatched).unwrap();
        let n_covered = picture.frame.surface.iter().filter(|&&surface| surface > 0.0).count();
        assert!(n_covered > 40 * 40 / 20, "{}: {n_covered} pixels", entry.name());
    }
}

#[test]
fn the_list_has_a_line_for_each() {
    let output = render(Path::new("."), &[]);
    let list = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(list.lines().count(), ENTRIES.len());
    let heart = list.lines().find(|line| line.starts_with("heart ")).unwrap();
    assert!(heart.contains(" Heart. A sextic"), "{heart}");
}

#[test]
fn names_are_rendered() {
    let directory = tempfile::tempdir().unwrap();
    let output = render(directory.path(), &["kummer", "sphere", "--resolution", "32", "--quiet"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    for file in ["kummer.png", "sphere.png"] {
        assert!(directory.path().join("out").join(file).exists());
    }
}

#[test]
fn parameters_can_be_set() {
    let directory = tempfile::tempdir().unwrap();
    let set = |value: &str| {
        let output = render(directory.path(), &["kummer", "--resolution", "32", "--set", value]);
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    assert_eq!(set("mu=1.2").0, Some(0));
    let (code, words) = set("nu=1.2");
    assert_eq!(code, Some(2));
    assert!(words.contains("`nu`"), "{words}");
}

#[test]
fn who_misspells_a_name_is_told_another() {
    for (name, words) in [
        ("klien", "`klien` is not in the gallery: did you mean `klein`?"),
        ("barth", "did you mean `barth_sextic`?"),
        ("quux", "`render gallery` lists what is"),
    ] {
        for more in [&[][..], &["--sheet", "sheet.png"]] {
            let output = render(Path::new("."), &[&[name], more].concat());
            let said = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.code(), Some(2), "{said}");
            assert!(said.contains(words), "{said}");
        }
    }
}

#[test]
fn a_sheet_is_a_picture_of_all_that_are_named() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("sheet.png");
    let arguments = ["sphere", "heart", "torus_1_04", "--sheet", "sheet.png", "--resolution", "32"];
    let output = render(directory.path(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let sheet = image::open(path).unwrap().into_rgb8();
    assert_eq!(sheet.dimensions(), (2 * 120, 2 * 152));
    let is_white = |x, y| sheet.get_pixel(x, y).0 == [255; 3];
    assert!(!is_white(60, 60) && !is_white(120 + 60, 60), "the middles of two pictures");
    let has_ink = |left: u32, top: u32| {
        (0..120 * 16).any(|i| sheet.get_pixel(left + i % 120, top + i / 120).0[0] < 128)
    };
    assert!(has_ink(0, 120) && has_ink(0, 152 + 120), "their titles");
    assert!(!has_ink(120, 152) && !has_ink(120, 152 + 120), "there is no fourth");
}

#[test]
fn a_page_holds_pictures_models_and_numbers() {
    let directory = tempfile::tempdir().unwrap();
    let arguments = ["sphere", "orbital", "--page", "page", "--resolution", "48"];
    let output = render(directory.path(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let page = directory.path().join("page");
    for file in ["viewer/model-viewer.js", "viewer/LICENSE", "pictures/sphere.png"] {
        assert!(page.join(file).exists(), "{file}");
    }
    let html = fs::read_to_string(page.join("index.html")).unwrap();
    let (_, data) = html.split_once("const surfaces = ").unwrap();
    let surfaces: Value = serde_json::from_str(data.split_once(";\n").unwrap().0).unwrap();
    let [sphere, orbital] = surfaces.as_array().unwrap().as_slice() else { panic!("not two") };
    assert_eq!(sphere["equations"][0], "x^2 + y^2 + z^2 = 1");
    let mesh = &sphere["numbers"]["meshes"][0];
    assert_eq!(mesh["euler"], 2);
    let volume = mesh["volume"].as_f64().unwrap();
    assert!((volume - 4.188_790).abs() < 0.02, "{volume}");
    assert_eq!(orbital["numbers"]["meshes"].as_array().unwrap().len(), 2);
    for name in ["sphere", "orbital"] {
        let script = fs::read_to_string(page.join("models").join(name).with_extension("js"));
        let script = script.unwrap();
        let text = script.strip_prefix(&format!("handOver(\"{name}\", \"")).unwrap();
        // "glTF" in base 64.
        assert!(text.starts_with("Z2xURg"), "{}", &text[..20]);
        assert!(script.len() < 400_000, "{} bytes", script.len());
    }
}
