//! Sculptures as scenes: tools that are pushed, and tools that keep the volume.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]

use std::{fs, path::Path, process::Command};

use zeroset::{pipeline, pipeline::Options, progress::Unwatched, scene};

/// A block into which a tool is pushed from above.
const PUSHED: &str = "version = 1\n[[sculpture]]\nname = \"a block, pushed\"\n\
    f = \"max(abs(x), abs(y), abs(z)) - 0.5\"\nsize = 64\n[[sculpture.stroke]]\ndo = \"remove\"\n\
    advance = \"contact\"\nat = [[0, 0, 0.8], [0, 0, 0.2]]\nradius = 0.15\nstrength = 0.1\n\
    stiffness = 40\n[image]\nwidth = 16\nheight = 16\n";

/// Renders a scene as a user does; whether that went well, what was said, and the file of forces.
fn render(scene: &str) -> (bool, String, Option<String>) {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("block.toml"), scene).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_render"));
    let output = command.current_dir(directory.path()).arg("block.toml").output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    (output.status.success(), said, fs::read_to_string(directory.path().join("out/block.csv")).ok())
}

#[test]
fn forces_of_a_pushed_tool_are_written() {
    let (is_well, said, forces) = render(&format!("{PUSHED}[output]\nforces = true\n"));
    assert!(is_well, "{said}");
    let forces = forces.unwrap();
    let mut lines = forces.lines();
    assert_eq!(lines.next(), Some("sculpture,stroke,push,moment,hand,tool,force"));
    let rows: Vec<[f64; 3]> = lines
        .enumerate()
        .map(|(i, line)| {
            let row = line.strip_prefix(&format!("\"a block, pushed\",1,1,{},", i + 1)).unwrap();
            let numbers: Vec<f64> = row.split(',').map(|field| field.parse().unwrap()).collect();
            numbers.try_into().unwrap()
        })
        .collect();
    // In the air nothing is felt; in the block what Hooke's law says, in lengths of the scene.
    assert_eq!(rows[0][2], 0.0);
    assert!(rows.iter().any(|row| row[2] > 1.0));
    for [hand, tool, force] in &rows {
        assert!((force - 40.0 * (hand - tool)).abs() < 1e-9);
        assert!(tool <= hand && *hand <= 0.6 + 1e-9);
    }
    // In the end the tool is there, and the hand feels nothing.
    let [hand, tool, force] = *rows.last().unwrap();
    assert!((hand - 0.6).abs() < 1e-9 && hand == tool && force == 0.0);
}

#[test]
fn a_sculpture_that_is_cut_away_is_no_picture() {
    let scene = "version = 1\n[[sculpture]]\nname = 'pebble'\nf = 'r - 0.5'\nsize = 16\n\
        [[sculpture.stroke]]\ndo = 'cut'\nat = [[0, 0, 0]]\nradius = 1\n";
    let (is_well, said, _) = render(scene);
    assert!(!is_well && said.contains("nothing is left of `pebble`"), "{said}");
}

#[test]
fn a_push_ends_when_its_moments_are_over() {
    let scene = PUSHED.replace("stiffness = 40", "moments = 20");
    let (is_well, said, forces) = render(&format!("{scene}[output]\nforces = true\n"));
    assert!(is_well, "{said}");
    assert_eq!(forces.unwrap().lines().count(), 21);
}

#[test]
fn forces_are_written_only_if_asked_for() {
    let (is_well, said, forces) = render(PUSHED);
    assert!(is_well && forces.is_none(), "{said}");
}

/// A push and its mirror image are two of one stroke.
#[test]
fn a_push_is_mirrored() {
    let at = "at = [[0.8, 0.1, 0], [0.4, 0.1, 0]]\nmirror = \"x\"";
    let scene = PUSHED.replace("at = [[0, 0, 0.8], [0, 0, 0.2]]", at);
    let (is_well, said, forces) = render(&format!("{scene}[output]\nforces = true\n"));
    assert!(is_well, "{said}");
    let forces = forces.unwrap();
    let of_push = |number: u32| -> Vec<&str> {
        let start = format!("\"a block, pushed\",1,{number},");
        forces.lines().filter_map(|line| line.strip_prefix(&start)).collect()
    };
    assert!(!of_push(1).is_empty());
    assert_eq!(of_push(1), of_push(2), "they meet the same");
}

/// The volume of a scene's first mesh.
fn volume(text: &str) -> f64 {
    let text = format!("{text}[output]\npng = false\nexr = false\nglb = true\n");
    let scene = scene::parse(Path::new("volume.toml"), &text).unwrap();
    let picture = pipeline::render(&scene, &Options::default(), &Unwatched).unwrap();
    let mesh = &picture.meshes[0];
    let corner = |v: u32| glam::Vec3::from_array(mesh.positions[v as usize]).as_dvec3();
    let part = |&[a, b, c]: &[u32; 3]| corner(a).dot(corner(b).cross(corner(c))) / 6.0;
    mesh.triangles.iter().map(part).sum()
}

#[test]
fn bends_and_inflations_keep_the_volume() {
    let solid =
        "version = 1\n[[sculpture]]\nf = \"max(hypot(y, z) - 0.3, abs(x) - 0.7)\"\nsize = 128\n";
    let before = volume(solid);
    let strokes = [
        "do = \"bend\"\nat = [[0, 0, 0], [1, 0, 0]]\nradius = 0.95\nangle = 30\n",
        "do = \"inflate\"\nat = [[0, 0, 0.3]]\nradius = 0.4\nstrength = 0.2\n",
    ];
    for stroke in strokes {
        let after = volume(&format!("{solid}[[sculpture.stroke]]\n{stroke}"));
        assert!(
            after != before && (after / before - 1.0).abs() < 1e-3,
            "{stroke}: {}",
            after / before
        );
    }
}
