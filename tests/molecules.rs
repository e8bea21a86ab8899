//! Molecules and orbitals: as large as they should be, whatever file they come from.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]

use std::{fmt::Write as _, fs, path::Path, process::Command};

use proptest::prelude::*;
use tempfile::TempDir;
use zeroset::{
    Error,
    hrb::Tolerance,
    import,
    isosurface::isosurface,
    math::{Aabb, Lattice, SimdLevel},
    mesh::{Border, FormulaSettings, Health, Mesh, VertexPlace, of_formula},
    progress::Unwatched,
    scene::{self, Scene},
    volume::{BOHR, Volume},
    voxelize::{BLOCK_LEVELS, Settings, Wish, find_blocks, voxelize},
};

/// Relative errors that areas and volumes may have.
const WRONG: f64 = 3e-3;

/// The surface of index `index` as a mesh, in a cube of this half edge.
fn mesh(scene: &Scene, index: usize, reach: f64, resolution: u32) -> Mesh {
    let domain = Aabb { min: [-reach; 3].into(), max: [reach; 3].into() };
    let (expr, lattice) = (&scene.surfaces[index].expr, Lattice::new(domain, resolution));
    let octree = voxelize(expr, &lattice, &Settings::default(), &Unwatched).unwrap().octree;
    let (border, vertex) = (Border::Open, VertexPlace::Polished);
    let settings = FormulaSettings { border, vertex, simd: SimdLevel::detect() };
    let mesh = of_formula(&expr.tape(), &octree, &lattice, &settings);
    assert_eq!(mesh.health(), Health::default());
    mesh
}

fn parsed(surface: &str) -> Scene {
    let text = format!("version = 1\n[[surface]]\n{surface}\n");
    scene::parse(Path::new("a.toml"), &text).unwrap()
}

/// Area, volume and number of components within `wrong`.
fn expect(mesh: &Mesh, area: f64, volume: f64, components: u64, wrong: f64) {
    let shape = mesh.shape();
    assert_eq!(shape.components, components);
    let errors = [shape.area / area - 1.0, shape.volume / volume - 1.0];
    assert!(errors.iter().all(|error| error.abs() < wrong), "{errors:?}: {shape:?}");
}

/// Oxygen, and hydrogen twice.
const WATER: [[f64; 4]; 3] = [
    [0.0, 0.0, 0.119_262, 1.52],
    [0.0, 0.763_239, -0.477_047, 1.2],
    [0.0, -0.763_239, -0.477_047, 1.2],
];

/// Six atoms of carbon and six of hydrogen on circles of the radii 1.397 and 2.481 Å.
fn benzene() -> Vec<[f64; 4]> {
    let ring = |distance: f64, radius: f64| {
        let (half, height) = (0.5 * distance, 0.75_f64.sqrt() * distance);
        [[distance, 0.0], [half, height], [-half, height]]
            .into_iter()
            .flat_map(move |[x, y]| [[x, y, 0.0, radius], [-x, -y, 0.0, radius]])
    };
    ring(1.397, 1.7).chain(ring(2.481, 1.2)).collect()
}

/// By an integral over exact arcs, with 400,000 slices of each sphere: area, volume.
const OF_WATER: [f64; 2] = [36.455_215, 19.402_979];
const OF_BENZENE: [f64; 2] = [109.534_131, 83.503_863];

#[test]
fn unions_of_atoms_measure_what_they_should() {
    for (spheres, [area, volume], reach) in
        [(WATER.to_vec(), OF_WATER, 2.2), (benzene(), OF_BENZENE, 4.0)]
    {
        let union = mesh(&parsed(&format!("spheres = {spheres:?}")), 0, reach, 160);
        expect(&union, area, volume, 1, WRONG);
        // A formula for the same.
        let terms: Vec<String> = spheres
            .iter()
            .map(|[x, y, z, r]| format!("hypot(x - ({x}), y - ({y}), z - ({z})) - {r}"))
            .collect();
        let formula = parsed(&format!("f = \"min({}) <= 0\"", terms.join(", ")));
        expect(&mesh(&formula, 0, reach, 160), area, volume, 1, WRONG);
    }
}

/// An orbital in atomic units with what is known of |ψ| ≥ iso.
struct Orbital {
    psi: &'static str,
    value: fn([f64; 3]) -> f64,
    iso: f64,
    reach: f64,
    area: f64,
    volume: f64,
    /// The parts of both signs.
    parts: [u64; 2],
}

/// Areas and volumes are integrals along the radius, of which the boundary's angle is a function.
const ORBITALS: [Orbital; 2] = [
    Orbital {
        psi: "z*exp(-r/2) / (4*sqrt(2*pi))",
        value: |[x, y, z]| {
            z * libm::exp(-libm::sqrt(x * x + y * y + z * z) / 2.0)
                / (4.0 * libm::sqrt(std::f64::consts::TAU))
        },
        iso: 0.03,
        reach: 7.0,
        area: 264.932_889,
        volume: 282.400_917,
        parts: [1, 1],
    },
    Orbital {
        psi: "(3*z^2 - r^2)*exp(-r/3) / (81*sqrt(6*pi))",
        value: |[x, y, z]| {
            let r = libm::sqrt(x * x + y * y + z * z);
            (3.0 * z * z - r * r) * libm::exp(-r / 3.0)
                / (81.0 * libm::sqrt(6.0 * std::f64::consts::PI))
        },
        iso: 0.01,
        reach: 15.0,
        area: 1_615.976_655,
        volume: 2_624.285_209,
        parts: [2, 1],
    },
];

#[test]
fn orbitals_measure_what_they_should() {
    for Orbital { psi, iso, reach, area, volume, parts, .. } in ORBITALS {
        let scene = parsed(&format!("f = \"|{psi}| >= {iso}\""));
        expect(&mesh(&scene, 0, reach, 160), area, volume, parts[0] + parts[1], WRONG);
    }
}

/// The text of a cube file with an orbital, `n` samples along each axis, in Bohr.
fn cube(orbital: &Orbital, n: u32) -> String {
    let step = 2.0 * orbital.reach / f64::from(n - 1);
    let first = -orbital.reach;
    let mut text = format!("hydrogen\nan orbital\n 1 {first} {first} {first}\n");
    for axis in 0..3 {
        let along = [0, 1, 2].map(|i| if i == axis { step } else { 0.0 });
        let _ = writeln!(text, "{n} {:.9} {:.9} {:.9}", along[0], along[1], along[2]);
    }
    text.push_str("1 1.0 0.0 0.0 0.0\n");
    let at = |i: u32| first + step * f64::from(i);
    for i in 0..n * n * n {
        let place = [at(i / (n * n)), at(i / n % n), at(i % n)];
        let end = if i % 6 == 5 { "\n" } else { " " };
        let _ = write!(text, "{:.5E}{end}", (orbital.value)(place));
    }
    text
}

/// A file in a folder that goes with it.
fn file(name: &str, text: &str) -> (TempDir, std::path::PathBuf) {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, text).unwrap();
    (folder, path)
}

/// With 100 samples an axis the surface lies between samples as straight lines do, inside of where it
/// bulges: the error is in proportion to the square of the step.
#[test]
fn orbitals_in_cube_files_measure_the_same() {
    for orbital in ORBITALS {
        let errors = [50, 100].map(|n| {
            let (_folder, path) = file("a.cube", &cube(&orbital, n));
            let volume = Volume::read(&path, None).unwrap();
            let negative = volume.band([f64::NEG_INFINITY, -orbital.iso]).unwrap();
            let of = |volume, level| {
                isosurface(volume, level, Tolerance::default(), Border::Open).shape()
            };
            let signs = [of(&volume, orbital.iso), of(&negative, 0.0)];
            assert_eq!(signs.map(|shape| shape.components), orbital.parts);
            let area: f64 = signs.iter().map(|shape| shape.area).sum();
            let whole: f64 = signs.iter().map(|shape| shape.volume).sum();
            let unit = BOHR * BOHR;
            [area / (unit * orbital.area) - 1.0, whole / (unit * BOHR * orbital.volume) - 1.0]
        });
        let [coarse, fine] = errors;
        for (coarse, fine) in coarse.into_iter().zip(fine) {
            assert!(fine.abs() < WRONG, "{errors:?}");
            assert!(coarse / fine > 3.0, "{errors:?}");
        }
    }
}

/// A ball whose samples stand along oblique axes, as those of crystals do.
#[test]
fn oblique_axes_are_followed() {
    let steps = [[0.1, 0.0, 0.0], [0.04, 0.09, 0.0], [-0.02, 0.03, 0.08]];
    let n = 60_u32;
    let middle = [0, 1, 2].map(|axis| {
        0.5 * f64::from(n - 1) * steps.iter().map(|step: &[f64; 3]| step[axis]).sum::<f64>()
    });
    let mut text = String::from("a ball\n\n 0 0 0 0\n");
    for [x, y, z] in steps {
        let _ = writeln!(text, "-{n} {x} {y} {z}");
    }
    for i in 0..n * n * n {
        let index = [i / (n * n), i / n % n, i % n].map(f64::from);
        let from_middle = [0, 1, 2].map(|axis| {
            steps.iter().zip(index).map(|(step, i)| i * step[axis]).sum::<f64>() - middle[axis]
        });
        let squared: f64 = from_middle.iter().map(|d| d * d).sum();
        let _ = writeln!(text, "{:.5}", 4.0 - squared);
    }
    let (_folder, path) = file("a.cube", &text);
    let volume = Volume::read(&path, None).unwrap();
    let ball = isosurface(&volume, 0.0, Tolerance::default(), Border::Open);
    assert_eq!(ball.health(), Health::default());
    let pi = std::f64::consts::PI;
    expect(&ball, 16.0 * pi, 32.0 / 3.0 * pi, 1, WRONG);
}

/// What a scene says of colours and meshes: what is converted can be loaded.
fn converted(name: &str, text: &str) -> (Scene, Vec<String>) {
    let (folder, path) = file(name, text);
    let out = folder.path().join("scenes/a.toml");
    fs::create_dir(folder.path().join("scenes")).unwrap();
    let options = import::Options { scene: Some(out.clone()), has_sticks: false };
    let converted = import::convert_with(&path, &options).unwrap();
    fs::write(&out, &converted.scene).unwrap();
    (scene::load(&out).unwrap(), converted.notes)
}

#[test]
fn xyz_files_become_scenes() {
    let lines: String = WATER
        .iter()
        .zip(["O", "H", "H"])
        .map(|([x, y, z, _], symbol)| format!("{symbol} {x} {y} {z}\n"))
        .collect();
    let (scene, notes) = converted("water.xyz", &format!("3\nWater\n{lines}"));
    assert!(notes.is_empty());
    assert_eq!(scene.about.title.as_deref(), Some("Water"));
    let names: Vec<&str> = scene.surfaces.iter().map(|surface| surface.name.as_str()).collect();
    assert_eq!(names, ["oxygen", "hydrogen"]);
    let white = scene.surfaces[1].material.color;
    assert_eq!(white, [1.0; 3]);
    let ball = |r: f64| [4.0 * r * r, 4.0 / 3.0 * r * r * r].map(|v| std::f64::consts::PI * v);
    let [area, volume] = ball(1.52);
    expect(&mesh(&scene, 0, 2.2, 96), area, volume, 1, WRONG);
    // Both atoms of hydrogen, which overlap by caps of 1.2 Å less half their distance.
    let [area, volume] = ball(1.2).map(|v| 2.0 * v);
    let cap = 1.2 - 0.763_239;
    let [lost, overlap] = [2.0 * 1.2 * cap, cap * cap * (3.0 * 1.2 - cap) / 3.0]
        .map(|v| 2.0 * std::f64::consts::PI * v);
    expect(&mesh(&scene, 1, 2.2, 96), area - lost, volume - overlap, 1, WRONG);
}

#[test]
fn cube_files_become_scenes() {
    // Nine tenths of the electron need more room.
    let [orbital, _] = ORBITALS;
    let (scene, notes) = converted("orbital.cube", &cube(&Orbital { reach: 16.0, ..orbital }, 60));
    assert!(notes.is_empty());
    let names: Vec<&str> = scene.solids.iter().map(|solid| solid.name.as_str()).collect();
    assert_eq!(names, ["positive", "negative"]);
    assert_eq!(scene.surfaces.len(), 1, "the proton");
    // The lobes lie on either side of the proton, as large as each other.
    let meshes = [0, 1].map(|i| scene.solids[i].at(1.0, &Unwatched).unwrap().mesh());
    let [up, down] = [0, 1].map(|i| meshes[i].shape());
    assert!((up.volume / down.volume - 1.0).abs() < 1e-3 && up.volume > 0.0);
    let heights = |i: usize| meshes[i].positions.iter().map(|p| p[2]);
    assert!(heights(0).all(|z| z > 0.0) && heights(1).all(|z| z < 0.0));
}

/// The commands and the two volumes that README shows, with files of these names.
#[test]
fn readme_tells_what_can_be_done() {
    let readme =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md")).unwrap();
    let blocks: Vec<&str> = readme.split("```").skip(1).step_by(2).collect();
    let block = |marker: &str| *blocks.iter().find(|block| block.contains(marker)).unwrap();
    let folder = TempDir::new().unwrap();
    let [orbital, _] = ORBITALS;
    for (name, text) in [
        ("caffeine.xyz", "1\n\nN 0 0 0\n".to_owned()),
        ("1crn.pdb", protein()),
        ("homo.cube", cube(&orbital, 30)),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let commands = block("render convert caffeine.xyz").lines().skip(1);
    for line in commands {
        let words = line.split('#').next().unwrap().split_whitespace().skip(1);
        let mut command = Command::new(env!("CARGO_BIN_EXE_render"));
        let output = command.args(words).current_dir(folder.path()).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{line}: {output:?}");
        let scene = line.split_whitespace().skip_while(|&word| word != "-o").nth(1).unwrap();
        scene::load(&folder.path().join(scene)).unwrap();
    }
    let volumes = block("[-inf, -0.03]").trim_start_matches("toml");
    let path = folder.path().join("volumes.toml");
    fs::write(&path, format!("version = 1\n{volumes}")).unwrap();
    assert_eq!(scene::load(&path).unwrap().solids.len(), 2);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// A damaged file is a scene, or is refused with reasons that mark places of the file.
    #[test]
    fn damaged_files_do_no_harm(
        signs in prop::collection::vec((any::<usize>(), "[0-9eE.+\\-*A-Za-z \n\té°]"), 1..12),
        cuts in prop::collection::vec(any::<usize>(), 0..4),
        is_pdb: bool,
    ) {
        let (name, mut text) = match is_pdb {
            true => ("a.pdb", protein().lines().take(12).collect::<Vec<_>>().join("\n")),
            false => ("a.xyz", "3\nWater\nO 0 0 0.1\nH 0 0.7 -0.4\n1 0 -0.7 -0.4\n".to_owned()),
        };
        for (at, sign) in signs {
            let at = text.floor_char_boundary(at % text.len());
            text.insert_str(at, &sign);
        }
        for at in cuts {
            let at = text.floor_char_boundary(at % text.len());
            text.remove(at);
        }
        match import::convert_text(Path::new(name), text) {
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
            Err(other) => prop_assert!(false, "{other}"),
        }
    }
}

/// A ball of atoms as close to each other as those of a protein: 5,000 of them.
fn protein() -> String {
    let mut text = String::from("TITLE     BALL OF ATOMS\n");
    // A sequence that fills space evenly (M. Roberts, 2018).
    let steps = [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3];
    let place = |i: usize| steps.map(|step| 60.0 * ((0.5 + i as f64 * step).fract() - 0.5));
    let places = (0..).map(place);
    let is_inside = |p: &[f64; 3]| p.iter().map(|c| c * c).sum::<f64>() < 28.8 * 28.8;
    for (i, [x, y, z]) in places.filter(is_inside).take(5_000).enumerate() {
        let element = ["C", "C", "C", "N", "O"][i % 5];
        let _ = writeln!(
            text,
            "ATOM  {:5}  {element:<3} ALA A{:4}    {x:8.3}{y:8.3}{z:8.3}  1.00  0.00          {element:>2}",
            i + 1,
            i / 8 + 1,
        );
    }
    text
}

#[test]
fn a_protein_is_found_with_little_of_its_formula() {
    let (scene, notes) = converted("protein.pdb", &protein());
    assert!(notes.is_empty());
    let names: Vec<&str> = scene.surfaces.iter().map(|surface| surface.name.as_str()).collect();
    assert_eq!(names, ["carbon", "nitrogen", "oxygen"]);
    let carbon = scene.surfaces[0].expr.tape();
    let whole = carbon.instructions().len();
    assert!(whole > 3_000 * 6, "{whole}");
    // Blocks of 32³ voxels hold a hundredth of the ball, and atoms around them reach into them.
    let domain = Aabb { min: [-32.0; 3].into(), max: [32.0; 3].into() };
    let lattice = Lattice::new(domain, 256);
    let wish = |level: u32, _: &Aabb| match level + BLOCK_LEVELS >= lattice.depth() {
        true => Wish::Keep,
        false => Wish::Divide,
    };
    let blocks = find_blocks(carbon, &lattice, SimdLevel::detect(), &wish);
    let longest = blocks.iter().map(|block| block.tape.instructions().len()).max().unwrap();
    assert!(longest < whole / 25, "{longest} of {whole}");
}
