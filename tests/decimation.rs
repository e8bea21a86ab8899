//! Meshes with fewer triangles stay what they were: closed or open as before, with their holes and
//! pieces, near the surface and the right way round.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]

use std::{
    collections::{BTreeMap, BTreeSet},
    env,
    fmt::Write as _,
    fs,
    path::Path,
};

use glam::DVec3;
use proptest::prelude::*;
use zeroset::{
    math::SimdLevel,
    mesh::{Border, FormulaSettings, Health, Mesh, Shape, VertexPlace, of_formula},
    pipeline::{self, Options},
    progress::Unwatched,
    scene::{self, Scene},
    voxelize::{Settings, voxelize},
};

/// The meshes of the surfaces of a scene, in one piece where sheets do not touch.
fn meshes(scene: &Scene, resolution: u32, border: Border) -> Vec<Mesh> {
    let lattice = pipeline::lattice(scene, Some(resolution));
    let settings =
        FormulaSettings { border, vertex: VertexPlace::Polished, simd: SimdLevel::detect() };
    let of_surface = |surface: &scene::Surface| {
        let found = voxelize(&surface.expr, &lattice, &Settings::default(), &Unwatched).unwrap();
        let mut mesh = of_formula(&surface.expr.tape(), &found.octree, &lattice, &settings);
        mesh.split_touching();
        mesh
    };
    scene.surfaces.iter().map(of_surface).collect()
}

fn mesh(f: &str, half: f64, resolution: u32, border: Border) -> Mesh {
    let text = format!(
        "version = 1\n[[surface]]\nf = '{f}'\n[domain]\nmin = [-{half}, -{half}, -{half}]\n\
         max = [{half}, {half}, {half}]\n"
    );
    meshes(&scene::parse(Path::new("mesh.toml"), &text).unwrap(), resolution, border).remove(0)
}

/// The vertices after each vertex of the border.
fn border(mesh: &Mesh) -> BTreeMap<u32, u32> {
    let sides = mesh.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let all: BTreeSet<(u32, u32)> = sides.collect();
    all.iter().copied().filter(|&(a, b)| !all.contains(&(b, a))).collect()
}

/// How many closed lines the border is.
fn n_loops(mesh: &Mesh) -> usize {
    let next = border(mesh);
    let mut left: BTreeSet<u32> = next.keys().copied().collect();
    let mut n = 0;
    while let Some(mut at) = left.pop_first() {
        n += 1;
        while left.remove(&next[&at]) {
            at = next[&at];
        }
    }
    n
}

/// The least cosine of the angle between the normals of two neighbours.
fn sharpest(mesh: &Mesh) -> f64 {
    let at = |v: u32| DVec3::from_array(mesh.positions[v as usize].map(f64::from));
    let mut of_side = BTreeMap::new();
    for &[a, b, c] in &mesh.triangles {
        let normal = (at(b) - at(a)).cross(at(c) - at(a)).normalize();
        of_side.extend([(a, b), (b, c), (c, a)].map(|side| (side, normal)));
    }
    let cosines =
        of_side.iter().filter_map(|(&(a, b), n)| of_side.get(&(b, a)).map(|other| n.dot(*other)));
    cosines.fold(1.0, f64::min)
}

/// What must hold of every mesh that was decimated.
fn check(full: &Mesh, less: &Mesh) -> Result<(), TestCaseError> {
    prop_assert!(less.health().is_clean(), "{:?}", less.health());
    let (before, after) = (full.shape(), less.shape());
    prop_assert_eq!((after.euler, after.components), (before.euler, before.components));
    prop_assert_eq!(n_loops(less), n_loops(full));
    // The volume between two surfaces is not larger than their areas times their distance.
    let distance = full.deviation_from(less).max(less.deviation_from(full));
    if full.health().open_edges == 0 {
        let bound = distance * before.area.max(after.area);
        prop_assert!((after.volume - before.volume).abs() <= bound, "{before:?} {after:?}");
    }
    Ok(())
}

const GYROID: &str = "sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x) = 0";
const TANGLE: &str = "x^4 - 5x^2 + y^4 - 5y^2 + z^4 - 5z^2 + 11.8 = 0";

/// Smooth surfaces, and how far they reach.
fn smooth() -> impl Strategy<Value = (String, f64)> {
    prop_oneof![
        (0.3..1.0).prop_map(|r| (format!("x^2 + 2*y^2 + z^2/2 = {r}^2"), 1.6)),
        (0.2..0.45).prop_map(|r| (format!("(hypot(x, y) - 1)^2 + z^2 = {r}^2"), 1.5)),
        (2.0..5.0).prop_map(|half| (GYROID.to_owned(), half)),
        Just((TANGLE.to_owned(), 3.0)),
        // A shell, two sheets of which are a few voxels apart.
        (0.08..0.15).prop_map(|t| (format!("abs(r - 1) = {t}"), 1.3)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::with_cases(24)
    })]

    #[test]
    fn smooth_surfaces_stay_what_they_are(
        (f, half) in smooth(),
        resolution in 24_u32..48,
        share in 0.01..0.9,
        is_capped: bool,
    ) {
        let border = if is_capped { Border::Capped } else { Border::Open };
        let full = mesh(&f, half, resolution, border);
        let n_wanted = (share * full.triangles.len() as f64) as usize;
        let mut less = full.clone();
        less.decimate(n_wanted);
        check(&full, &less)?;
        prop_assert!(less.triangles.len() <= n_wanted.max(200), "{} of {n_wanted}", less.triangles.len());
        // Nothing is folded, unless there are too few triangles to be smooth or caps are sharp.
        if less.triangles.len() > 1000 && sharpest(&full) > 0.4 {
            prop_assert!(sharpest(&less) > 0.0, "{}", sharpest(&less));
        }
    }

    /// Noise: pieces, tunnels and thin parts of the size of a voxel.
    #[test]
    fn rough_surfaces_stay_what_they_are(
        phase in prop::array::uniform3(0.0..6.0),
        n in 3.0..9.0,
        resolution in 16_u32..32,
        share in 0.02..0.9,
    ) {
        let [a, b, c] = phase;
        let f = format!("sin({n}*x + {a} + sin(3*y))*sin({n}*y + {b} + x)*sin({n}*z + {c} - 2*x) = 0.1");
        let full = mesh(&f, 1.5, resolution, Border::Capped);
        let mut less = full.clone();
        less.decimate((share * full.triangles.len() as f64) as usize);
        check(&full, &less)?;
    }
}

/// A vertex of the border goes along it: in a plane that cuts the surface it stays in the plane.
#[test]
fn borders_keep_their_place() {
    let full = mesh("x^2 + y^2 + (z - 0.6)^2 = 1", 1.0, 40, Border::Open);
    let mut less = full.clone();
    less.decimate(300);
    assert!(less.triangles.len() <= 300);
    let (before, after) = (border(&full), border(&less));
    assert!(!after.is_empty() && after.len() < before.len() / 2);
    for &v in after.keys() {
        let p = less.positions[v as usize];
        assert!(p.iter().any(|c| c.abs() == 1.0), "{p:?}");
    }
}

/// Pieces that cannot be smaller, and a mesh that is none.
#[test]
fn what_cannot_collapse_stays() {
    let mut sphere = mesh("r = 1", 1.2, 20, Border::Open);
    sphere.decimate(0);
    assert_eq!(sphere.triangles.len(), 4);
    assert_eq!(sphere.health(), Health::default());
    let mut empty = Mesh::default();
    empty.decimate(4);
    assert_eq!(empty, Mesh::default());
    // An edge with three triangles.
    let crowded = Mesh {
        positions: vec![
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, 1.0],
        ],
        normals: vec![[0.0, 0.0, 1.0]; 5],
        triangles: vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]],
        ..Mesh::default()
    };
    let mut same = crowded.clone();
    same.decimate(1);
    assert_eq!(same, crowded);
}

/// Planes and their edges are where they were: the corners of a cube come back.
#[test]
fn flat_sides_need_few_triangles() {
    let full = mesh("max(abs(x), abs(y), abs(z)) = 1", 1.3, 50, Border::Open);
    let mut less = full.clone();
    less.decimate(200);
    assert!(less.triangles.len() <= 200);
    assert!((less.shape().volume - 8.0).abs() < 0.02, "{:?}", less.shape());
    assert!(full.deviation_from(&less) < 0.03, "{}", full.deviation_from(&less));
}

#[test]
fn normals_are_the_formulas() {
    let scene = "version = 1\n[[surface]]\nf = 'x^2 + y^2 + z^2 = 1'\n";
    let scene = scene::parse(Path::new("ball.toml"), scene).unwrap();
    let mut mesh = meshes(&scene, 64, Border::Open).remove(0);
    mesh.decimate(1000);
    mesh.take_normals_of(&scene.surfaces[0].expr.tape(), SimdLevel::detect());
    for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
        let [p, n] = [p, n].map(|v| DVec3::from_array(v.map(f64::from)));
        assert!(p.normalize().distance(n) < 1e-6, "{p} {n}");
    }
}

#[test]
fn threads_change_nothing() {
    let full = mesh(GYROID, 4.0, 64, Border::Capped);
    let with = |n_threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        pool.install(|| {
            let mut mesh = full.clone();
            mesh.decimate(2000);
            (mesh.digest(), full.deviation_from(&mesh).to_bits(), mesh.self_intersections())
        })
    };
    assert_eq!(with(1), with(4));
}

/// The key in a scene: for each mesh, with what is said of it.
#[test]
fn scenes_say_how_many_triangles() {
    let text = "version = 1\n[[surface]]\nname = 'ball'\nf = 'x^2 + y^2 + z^2 = 1'\n\
        [[surface]]\nname = 'crumbs'\nf = 'sin(9x)*sin(9y)*sin(9z) = 0.9'\n\
        [domain]\nmin = [-1.1, -1.1, -1.1]\nmax = [1.1, 1.1, 1.1]\n\
        [output]\nobj = true\n[mesh]\ntriangles = 100\n[image]\nwidth = 8\nheight = 8\n";
    let scene = scene::parse(Path::new("scene.toml"), text).unwrap();
    let options = Options { resolution: Some(64), ..Options::default() };
    let picture = pipeline::render(&scene, &options, &Unwatched).unwrap();
    let [ball, crumbs] = picture.statistics.meshes.as_slice() else { panic!() };
    assert_eq!((ball.triangles, ball.faults, ball.open_edges), (100, 0, 0));
    assert!(ball.full_triangles > Some(10_000));
    assert!(ball.deviation.is_some_and(|distance| distance > 0.01 && distance < 0.1), "{ball:?}");
    // Each of these pieces is a tetrahedron at last.
    assert!(crumbs.components > 25 && crumbs.triangles == 4 * crumbs.components, "{crumbs:?}");
    let said = picture.notes.join("\n");
    assert!(
        said.contains(&format!("the mesh of `crumbs` has {} triangles, not 100", crumbs.triangles))
    );
    assert!(!said.contains("ball"), "{said}");
}

/// What files of `configs/` become with a tenth of their triangles: `golden/mesh/decimated.txt`, which
/// `ZEROSET_BLESS=meshes` rewrites.
#[test]
fn decimated_scenes_are_the_golden_ones() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut text = String::new();
    for name in ["scene1", "scene3", "tanglecube", "drilled_cube", "solids", "gyroid", "helicoid"] {
        let scene = scene::load(&root.join("configs").join(name).with_extension("toml")).unwrap();
        for (surface, full) in scene.surfaces.iter().zip(meshes(&scene, 48, Border::Capped)) {
            let mut less = full.clone();
            less.decimate(full.triangles.len() / 10);
            assert!(less.health().is_clean(), "{name}: {:?}", less.health());
            let Shape { vertices, triangles, euler, area, volume, .. } = less.shape();
            writeln!(
                text,
                "{}: {} crossings; with a tenth: {vertices} vertices, {triangles} triangles, Euler \
                 {euler}, {} open edges, {} crossings, area {area:.6}, volume {volume:.6}, \
                 deviation {:.6}, {:032x}",
                surface.name,
                full.self_intersections(),
                less.health().open_edges,
                less.self_intersections(),
                full.deviation_from(&less),
                less.digest()
            )
            .unwrap();
        }
    }
    let golden = root.join("golden/mesh/decimated.txt");
    if env::var("ZEROSET_BLESS").is_ok_and(|wanted| wanted == "meshes" || wanted == "all") {
        fs::write(&golden, &text).unwrap();
        panic!("blessed");
    }
    assert!(fs::read_to_string(&golden).unwrap_or_default() == text, "is now\n{text}");
}
