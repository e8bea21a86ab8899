//! Meshes of formulas: clean, of the right shape, as large as the surface.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]

use std::{env, f64::consts::PI, fmt::Write as _, fs, path::Path};

use zeroset::{
    expr::Expr,
    hrb::Tolerance,
    isosurface::isosurface,
    math::{Lattice, SimdLevel},
    mesh::{Border, FormulaSettings, Health, Mesh, Shape, VertexPlace, of_formula, of_open_voxels},
    output::meshes::{MeshFormat, MeshOptions, write_meshes},
    pipeline,
    progress::Unwatched,
    scene::{self, Scene},
    volume::{Samples, Volume},
    voxelize::{Settings, open_voxels, voxelize},
};

/// The mesh of the first surface of a scene.
fn mesh(text: &str, resolution: u32, border: Border, vertex: VertexPlace) -> Mesh {
    let scene = scene::parse(Path::new("mesh.toml"), &format!("version = 1\n{text}")).unwrap();
    let lattice: Lattice = pipeline::lattice(&scene, Some(resolution));
    let expr = &scene.surfaces[0].expr;
    let found = voxelize(expr, &lattice, &Settings::default(), &Unwatched).unwrap();
    let settings = FormulaSettings { border, vertex, simd: SimdLevel::detect() };
    of_formula(&expr.tape(), &found.octree, &lattice, &settings)
}

fn surface(f: &str, half: f64) -> String {
    format!(
        "[[surface]]\nf = '{f}'\n[domain]\nmin = [-{half}, -{half}, -{half}]\n\
         max = [{half}, {half}, {half}]\n"
    )
}

/// Vertices lie on the surface, normals at right angles to it.
#[test]
fn vertices_are_on_the_surface() {
    let mesh = mesh(&surface("x^2 + y^2 + z^2 = 1", 1.3), 50, Border::Open, VertexPlace::Polished);
    for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
        let length = p.iter().map(|c| c * c).sum::<f32>().sqrt();
        assert!((length - 1.0).abs() < 3e-7, "{p:?}");
        assert!((0..3).all(|axis| (p[axis] - n[axis]).abs() < 1e-6), "{p:?} {n:?}");
    }
}

/// A ball that is cut by the domain.
#[test]
fn borders_are_open_or_capped() {
    let text = "[[surface]]\nf = 'x^2 + y^2 + z^2 = 1'\n\
        [domain]\nmin = [-1.2, -1.2, -1.2]\nmax = [1.2, 1.2, 0.48]\n";
    let open = mesh(text, 60, Border::Open, VertexPlace::Polished);
    let Health { open_edges, .. } = open.health();
    assert!(open_edges > 50 && open.health().is_clean(), "{:?}", open.health());
    assert_eq!(open.shape().euler, 1);
    let capped = mesh(text, 60, Border::Capped, VertexPlace::Polished);
    assert_eq!(capped.health(), Health::default());
    assert_eq!(capped.shape().euler, 2);
    let volume = PI * (0.48 - 0.48 * 0.48 * 0.48 / 3.0 + 2.0 / 3.0);
    assert!((capped.shape().volume / volume - 1.0).abs() < 2e-3, "{:?}", capped.shape());
}

/// Solids with edges and corners, thin walls, several pieces: clean whatever the formula.
#[test]
fn all_kinds_of_surfaces_are_clean() {
    for (f, half) in [
        ("max(max(abs(x), abs(y)), abs(z)) = 1", 1.5),
        ("max(x^2 + y^2 + z^2 - 1, 0.3 - x^2 - y^2)", 1.5),
        ("x^4 - 5x^2 + y^4 - 5y^2 + z^4 - 5z^2 + 11.8 = 0", 3.0),
        ("min(x^2 + y^2 + z^2 - 0.3, abs(x - 0.9) + abs(y) + abs(z) - 0.3)", 1.5),
        ("(x^2 + 9/4*y^2 + z^2 - 1)^3 = x^2*z^3 + 9/80*y^2*z^3", 1.5),
    ] {
        for resolution in [17, 40] {
            let mesh = mesh(&surface(f, half), resolution, Border::Capped, VertexPlace::Polished);
            assert_eq!(mesh.health(), Health::default(), "{f} at {resolution}");
            assert!(mesh.shape().volume > 0.0);
        }
    }
}

/// An open clip cuts triangles where it says.
#[test]
fn clips_are_sharp() {
    let text = "[[surface]]\nf = 'x^2 + y^2 + z^2 = 1'\nclip = 'x + 2 y + 0.3 z <= 0.4'\n\
        [domain]\nmin = [-1.2, -1.2, -1.2]\nmax = [1.2, 1.2, 1.2]\n";
    let mesh = mesh(text, 60, Border::Open, VertexPlace::Polished);
    let health = mesh.health();
    assert!(health.is_clean() && health.open_edges > 50, "{health:?}");
    assert_eq!((mesh.shape().euler, mesh.shape().components), (1, 1));
    let side = |p: &[f32; 3]| p[0] + 2.0 * p[1] + 0.3 * p[2] - 0.4;
    let farthest = mesh.positions.iter().map(side).fold(f32::NEG_INFINITY, f32::max);
    assert!(farthest.abs() < 1e-3, "{farthest}");
    // A cap of height h has the area 2 pi h.
    let height = 1.0 + 0.4 / 5.09_f64.sqrt();
    assert!((mesh.shape().area / (2.0 * PI * height) - 1.0).abs() < 2e-3, "{:?}", mesh.shape());
}

/// Certified voxels tell more than a mesh needs: those that bounds leave open give the same one, where F
/// is smooth, has kinks, jumps, or ends, and where a clip or the domain cuts it.
#[test]
fn open_voxels_give_the_same_meshes() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let load =
        |name: &str| scene::load(&root.join("configs").join(name).with_extension("toml")).unwrap();
    let parse = |f: &str, more: &str| {
        let text = format!("version = 1\n[[surface]]\nf = '{f}'\n{more}");
        scene::parse(Path::new("open.toml"), &text).unwrap()
    };
    let names = "scene1 scene2 scene3 tanglecube drilled_cube solids gyroid helicoid catenoid pseudosphere \
        klein caffeine heart";
    let mut scenes: Vec<(&str, Scene)> =
        names.split_whitespace().map(|name| (name, load(name))).collect();
    let domain = "[domain]\nmin = [-1.5, -1.4, -1.3]\nmax = [1.2, 0.7, 1.1]\n";
    for f in ["1/x = y + z/3", "sqrt(x) = y^2 + z^2", "ln(x + y) = z", "floor(3*x) = z", "x = 0"] {
        scenes.push((f, parse(f, domain)));
    }
    scenes.push((
        "clip",
        parse("x^2 + y^2 + z^2 = 1", &format!("clip = 'z - x/2 <= 0.1'\n{domain}")),
    ));
    for (name, scene) in &scenes {
        for resolution in [3, 20, 70] {
            let lattice = pipeline::lattice(scene, Some(resolution));
            for border in [Border::Open, Border::Capped] {
                for surface in &scene.surfaces {
                    compare(name, &surface.expr, &lattice, border);
                }
            }
        }
    }
}

/// Compares the mesh of certified voxels with those of open ones, found by every instruction set.
fn compare(name: &str, expr: &Expr, lattice: &Lattice, border: Border) {
    let (tape, vertex) = (expr.tape(), VertexPlace::Polished);
    let like = |mesh: &Mesh| (mesh.triangles.len(), mesh.shape().area, mesh.digest());
    let found = voxelize(expr, lattice, &Settings::default(), &Unwatched).unwrap();
    let settings = FormulaSettings { border, vertex, simd: SimdLevel::detect() };
    let certified = like(&of_formula(&tape, &found.octree, lattice, &settings));
    for simd in SimdLevel::available() {
        let find = Settings { simd, ..Settings::default() };
        let found = open_voxels(expr, lattice, &find, &Unwatched).unwrap();
        let settings = FormulaSettings { simd, ..settings };
        let open = like(&of_open_voxels(&tape, &found, lattice, &settings));
        let size = lattice.n_voxels();
        assert_eq!(certified, open, "{name} at {size:?}, {border:?}, {}", simd.name());
    }
}

/// What files of `configs/` become as meshes, as far as a few lines tell: `golden/mesh/NAME.txt`, which
/// `ZEROSET_BLESS=meshes` rewrites.
#[test]
fn meshes_of_scenes_are_the_golden_ones() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut differ = Vec::new();
    for name in ["scene1", "scene3", "tanglecube", "drilled_cube", "solids", "gyroid", "helicoid"] {
        let scene = scene::load(&root.join("configs").join(name).with_extension("toml")).unwrap();
        let lattice = pipeline::lattice(&scene, Some(48));
        let mut text = String::new();
        for border in [Border::Open, Border::Capped] {
            for surface in &scene.surfaces {
                let found =
                    voxelize(&surface.expr, &lattice, &Settings::default(), &Unwatched).unwrap();
                let settings = FormulaSettings {
                    border,
                    vertex: VertexPlace::Polished,
                    simd: SimdLevel::detect(),
                };
                let mut mesh = of_formula(&surface.expr.tape(), &found.octree, &lattice, &settings);
                let split = mesh.split_touching();
                let health = mesh.health();
                assert!(
                    Health { open_edges: 0, double_vertices: 0, ..health } == Health::default(),
                    "{name}: {health:?}"
                );
                let Shape { vertices, triangles, euler, components, area, volume, .. } =
                    mesh.shape();
                writeln!(
                    text,
                    "{} {border:?}: {vertices} vertices, {triangles} triangles, Euler {euler}, \
                     {components} components, {} open edges, {split} split, area {area:.6}, \
                     volume {volume:.6}, {:032x}",
                    surface.name,
                    health.open_edges,
                    mesh.digest()
                )
                .unwrap();
            }
        }
        let golden = root.join("golden/mesh").join(name).with_extension("txt");
        differ.extend(difference(name, &text, &golden));
    }
    assert!(differ.is_empty(), "{}", differ.join("\n"));
}

/// Small meshes to the last digit, `golden/mesh/NAME.obj`, for those who want to see what changed;
/// `ZEROSET_BLESS=meshes` rewrites them.
#[test]
fn small_meshes_are_the_golden_ones() {
    let ball = "[[surface]]\nname = 'ball'\nf = 'x^2 + y^2 + z^2 = 1'\n[domain]\n\
        min = [-1.4, -1.4, -1.4]\nmax = [1.4, 1.4, ";
    let of_ball =
        |top: &str, border| mesh(&format!("{ball}{top}]\n"), 8, border, VertexPlace::Polished);
    // A region of 2³ samples beside single ones, so that cells of all kinds are there.
    let samples = [
        [[9, 9, 4, 1], [9, 9, 5, 0], [3, 2, 7, 0], [0, 0, 0, 6]],
        [[9, 9, 2, 0], [9, 9, 4, 0], [8, 1, 0, 0], [0, 0, 5, 5]],
        [[1, 0, 0, 0], [0, 6, 0, 0], [0, 0, 0, 0], [0, 0, 5, 5]],
    ];
    let volume = Volume {
        size: [4, 4, 3],
        samples: Samples::U8(samples.as_flattened().as_flattened().to_vec()),
        placing: glam::DAffine3::from_scale(glam::DVec3::new(1.0, 1.0, 1.5)),
    };
    let blocks = isosurface(&volume, 4.5, Tolerance::default(), Border::Capped);
    let (mut differ, folder) = (Vec::new(), tempfile::tempdir().unwrap());
    for (name, mut mesh) in [
        ("ball", of_ball("1.4", Border::Open)),
        ("cut_ball", of_ball("0.3", Border::Capped)),
        ("blocks", blocks),
    ] {
        mesh.split_touching();
        mesh.name = name.into();
        let found = folder.path().join(name).with_extension("obj");
        write_meshes(&found, MeshFormat::Obj, &[mesh], &MeshOptions::default()).unwrap();
        let found = fs::read_to_string(found).unwrap();
        assert!(found.len() < 20_000, "{name}: {} bytes", found.len());
        let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/mesh").join(name);
        differ.extend(difference(name, &found, &golden.with_extension("obj")));
    }
    assert!(differ.is_empty(), "{}", differ.join("\n"));
}

/// What to say of a text that is not that of the file; the file is rewritten if that is wanted.
fn difference(name: &str, found: &str, golden: &Path) -> Option<String> {
    if env::var("ZEROSET_BLESS").is_ok_and(|wanted| wanted == "meshes" || wanted == "all") {
        fs::create_dir_all(golden.parent().unwrap()).unwrap();
        fs::write(golden, found).unwrap();
        return Some(format!("{name}: blessed"));
    }
    let expected = fs::read_to_string(golden).unwrap_or_default();
    if found == expected {
        return None;
    }
    let (found, expected): (Vec<&str>, Vec<&str>) =
        (found.lines().collect(), expected.lines().collect());
    let line = |lines: &[&str], i: usize| lines.get(i).map_or("nothing", |line| line).to_owned();
    let n = found.len().max(expected.len());
    let first = (0..n).find(|&i| found.get(i) != expected.get(i)).unwrap_or(n);
    let n_differ = (0..n).filter(|&i| found.get(i) != expected.get(i)).count();
    Some(format!(
        "{}: {n_differ} of {n} lines differ, the first is {}\n  expected: {}\n  found:    {}",
        golden.display(),
        first + 1,
        line(&expected, first),
        line(&found, first)
    ))
}

/// A scan as it comes: raw samples beside a scene of nothing else.
fn scan(file: &str, keys: &str) -> Scene {
    let data = env::var_os("ZEROSET_DATA").unwrap();
    let packed = Path::new(&data).join("volumes").join(file).with_extension("raw.xz");
    let folder = tempfile::tempdir().unwrap();
    let mut raw = fs::File::create(folder.path().join("scan.raw")).unwrap();
    let packed = fs::File::open(packed).unwrap();
    std::io::copy(&mut lzma_rust2::XzReader::new(packed, false), &mut raw).unwrap();
    let path = folder.path().join("scan.toml");
    fs::write(&path, format!("version = 1\n[[volume]]\nfile = 'scan.raw'\n{keys}\n")).unwrap();
    scene::load(&path).unwrap()
}

#[test]
#[expect(clippy::print_stdout, reason = "the test harness keeps what is said")]
fn isosurfaces_of_scans_are_clean() {
    if env::var_os("ZEROSET_DATA").is_none() {
        println!("SKIPPED: ZEROSET_DATA is not set");
        return;
    }
    for (file, keys) in [
        ("aneurism_256x256x256_uint8", "size = [256, 256, 256]\ntype = 'uint8'\nisovalue = 60"),
        ("fuel_64x64x64_uint8", "size = [64, 64, 64]\ntype = 'uint8'\nisovalue = 10"),
        ("lobster_301x324x56_uint8", "size = [301, 324, 56]\ntype = 'uint8'\nisovalue = 40"),
        ("headsq_64x64x93_int16", "size = [64, 64, 93]\ntype = 'int16'\nisovalue = 1150"),
        ("seg3d_tooth_103x94x161_uint16", "size = [103, 94, 161]\ntype = 'uint16'\nisovalue = 600"),
    ] {
        for tolerance in [0, 8] {
            let keys = format!("{keys}\ncap = true\ntolerance = {tolerance}");
            let mut mesh = scan(file, &keys).solids[0].at(1.0, &Unwatched).unwrap().mesh();
            let split = mesh.split_touching();
            let health = mesh.health();
            assert_eq!(
                Health { double_vertices: 0, ..health },
                Health::default(),
                "{file}, tolerance {tolerance}, {split} split"
            );
            let Shape { euler, components, triangles, volume, .. } = mesh.shape();
            assert!(volume > 0.0, "{file}");
            assert_eq!(mesh.self_intersections(), 0, "{file}, tolerance {tolerance}");
            mesh.decimate(triangles as usize / 10);
            let (health, less) = (mesh.health(), mesh.shape());
            assert_eq!(Health { double_vertices: 0, ..health }, Health::default(), "{file}");
            assert_eq!((less.euler, less.components), (euler, components), "{file}");
            assert!(less.triangles <= triangles / 9, "{file}: {} of {triangles}", less.triangles);
        }
    }
}
