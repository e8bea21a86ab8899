//! Areas, volumes and Euler numbers that are known in closed form or by quadrature: of solids with edges
//! and nodes, clipped sheets, lobes, and cells of periodic surfaces. Those of smooth closed surfaces are
//! in `meshed`.

use std::{f64::consts::PI, path::Path};

use zeroset::{
    gallery,
    math::{Aabb, Lattice, SimdLevel},
    mesh::{Border, FormulaSettings, Mesh, VertexPlace, of_formula},
    pipeline,
    scene::{self, Scene},
};

use crate::{meshed::published, octree};

/// Most of an area or a volume by which a mesh may be wrong.
const ERROR: f64 = 3e-3;

/// A surface and what is known of it.
struct Known {
    name: &'static str,
    f: &'static str,
    clip: &'static str,
    min: [f64; 3],
    max: [f64; 3],
    resolution: u32,
    area: Option<f64>,
    /// Of what is inside, if the mesh is closed where the domain ends.
    volume: Option<f64>,
    /// Euler number and pieces.
    shape: Option<[i64; 2]>,
    /// By which the area may be wrong.
    area_error: f64,
}

const fn known(name: &'static str, f: &'static str, reach: f64) -> Known {
    Known {
        name,
        f,
        clip: "",
        min: [-reach; 3],
        max: [reach; 3],
        resolution: 128,
        area: None,
        volume: None,
        shape: None,
        area_error: ERROR,
    }
}

impl Known {
    const fn area(self, area: f64) -> Self {
        Self { area: Some(area), ..self }
    }

    const fn volume(self, volume: f64) -> Self {
        Self { volume: Some(volume), ..self }
    }

    const fn shape(self, euler: i64, components: i64) -> Self {
        Self { shape: Some([euler, components]), ..self }
    }

    const fn clip(self, clip: &'static str) -> Self {
        Self { clip, ..self }
    }

    const fn domain(self, min: [f64; 3], max: [f64; 3]) -> Self {
        Self { min, max, ..self }
    }

    /// Where smaller voxels are needed.
    const fn fine(self) -> Self {
        Self { resolution: 256, ..self }
    }

    const fn area_error(self, area_error: f64) -> Self {
        Self { area_error, ..self }
    }

    fn scene(&self) -> Scene {
        let clip = match self.clip {
            "" => String::new(),
            clip => format!("clip = \"{clip}\"\n"),
        };
        let text = format!("version = 1\n[[surface]]\nf = \"\"\"{}\"\"\"\n{clip}", self.f);
        scene::parse(Path::new("surface.toml"), &text).unwrap()
    }
}

/// The mesh of a surface in a box.
fn mesh(scene: &Scene, domain: Aabb, resolution: u32, border: Border) -> Mesh {
    let expr = &scene.surfaces[0].expr;
    let lattice = Lattice::new(domain, resolution);
    let settings =
        FormulaSettings { border, vertex: VertexPlace::Polished, simd: SimdLevel::detect() };
    let mut mesh = of_formula(&expr.tape(), &octree(expr, &lattice), &lattice, &settings);
    mesh.split_touching();
    mesh
}

fn check(known: &Known, scene: &Scene) {
    let Known { name, min, max, resolution, area_error, .. } = *known;
    let domain = Aabb { min: min.into(), max: max.into() };
    let open = mesh(scene, domain, resolution, Border::Open).shape();
    if let Some(area) = known.area {
        let error = open.area / area - 1.0;
        assert!(error.abs() < area_error, "{name}: area {}, wrong by {error}", open.area);
    }
    if let Some(volume) = known.volume {
        let solid = mesh(scene, domain, resolution, Border::Capped).shape().volume;
        let error = solid / volume - 1.0;
        assert!(error.abs() < ERROR, "{name}: volume {solid}, wrong by {error}");
    }
    if let Some(expected) = known.shape {
        assert_eq!([open.euler, open.components as i64], expected, "{name}");
    }
}

#[test]
fn solids_with_edges_are_measured() {
    let root = libm::sqrt(2.0);
    let of = |name, reach| known(name, published(name).f, reach);
    for known in [
        // Edges are cut at voxels, where they are sharper than a right angle visibly.
        of("octahedron", 1.1)
            .area(4.0 * libm::sqrt(3.0))
            .area_error(0.01)
            .volume(4.0 / 3.0)
            .shape(2, 1),
        of("steinmetz_2", 1.1).area(16.0).volume(16.0 / 3.0).shape(2, 1),
        of("steinmetz_3", 1.1).area(24.0 * (2.0 - root)).volume(8.0 * (2.0 - root)).shape(2, 1),
        known("napkin_ring", "max(x^2+y^2+z^2-1, 0.36-x^2-y^2) <= 0", 1.1)
            .fine()
            .area(16.084_954)
            .volume(2.144_661)
            .shape(0, 1),
        known(
            "csg_fogleman",
            "max(x^2+y^2+z^2-1, |x|-0.75, |y|-0.75, |z|-0.75, \
             0.25-x^2-y^2, 0.25-y^2-z^2, 0.25-z^2-x^2) <= 0",
            1.05,
        )
        .area(12.28)
        .volume(0.988_79)
        .shape(-8, 1),
        // Its fins are thinner than voxels over a good part of its area.
        of("astroidal_ellipsoid", 1.05).fine().volume(4.0 * PI / 35.0).shape(2, 1),
        known("water", WATER, 2.2).area(36.44).volume(19.40).shape(2, 1),
    ] {
        check(&known, &known.scene());
    }
}

const WATER: &str =
    "min(hypot(x, y, z - 0.119262) - 1.52, hypot(x, |y| - 0.763239, z + 0.477047) - 1.2) <= 0";

#[test]
fn nodes_tips_and_clouds_are_measured() {
    let of = |name, reach| known(name, published(name).f, reach);
    for known in [
        // The drop alone; its tip is a node.
        known("ding_dong", "max(x^2+y^2-(1-z)*z^2, -z) <= 0", 1.05)
            .domain([-0.55, -0.55, -0.05], [0.55, 0.55, 1.05])
            .area(2.021_744)
            .volume(PI / 12.0)
            .shape(2, 1),
        of("piriform", 0.0)
            .domain([-0.1, -0.6, -0.6], [1.1, 0.6, 0.6])
            .area(1.476_638)
            .volume(PI / 20.0)
            .shape(2, 1),
        // By quadrature over directions from (0, 0, 0.3).
        of("heart_taubin", 1.4).area(11.5187).volume(3.345_102).shape(2, 1),
        of("distel", 1.05).fine().area(2.514).volume(0.238_38).shape(2, 1),
        known("orbital 2p_z", "|z*exp(-r/2)/(4*sqrt(2*pi))| >= 0.03", 8.0)
            .area(264.9)
            .volume(282.4)
            .shape(4, 2),
        known("orbital 3d_z2", "|(3*z^2-r^2)*exp(-r/3)/(81*sqrt(6*pi))| >= 0.01", 20.0)
            .area(1616.0)
            .volume(2624.0)
            .shape(4, 3),
        of("klein_bottle", 4.0).area(133.44),
        of("stolte_kaufman_scene_2", 1.0).fine().volume(0.378_964).shape(64, 32),
        of("stolte_kaufman_scene_3", 1.0).fine().volume(0.384_173),
    ] {
        check(&known, &known.scene());
    }
}

#[test]
fn clipped_sheets_are_measured() {
    let of = |name, reach| known(name, published(name).f, reach);
    // The pseudosphere up to where its tractrix has the parameter 2. Towards its rim it is thinner than any
    // voxel, which takes area and hardly any volume.
    let height = 2.0 - libm::tanh(2.0);
    let horns = 2.0 * PI / 3.0 * libm::pow(libm::tanh(2.0), 3.0);
    for known in [
        of("helicoid", 0.0)
            .domain([-1.1, -1.1, 0.0], [1.1, 1.1, 2.0 * PI])
            .clip("rho <= 1")
            .area(14.423_599)
            .shape(1, 1),
        of("pseudosphere", 0.0).domain([-1.1, -1.1, -height], [1.1, 1.1, height]).volume(horns),
        // Four closed pods, and four open sheets.
        of("seed_pod", 1.8).clip("r <= 1.7").shape(4 * 2 + 4, 8),
    ] {
        check(&known, &known.scene());
    }
}

/// A sponge of which the smallest bars are 9 voxels thick, and its many edges are cut.
#[test]
fn the_sponge_has_all_its_holes() {
    let sponge = gallery::find("menger_3").unwrap().scene(&[]).unwrap();
    let n = 3;
    let volume = (0..n).map(|_| 20.0 / 27.0).product();
    let area = 2.0 * (0..n).map(|_| 20.0 / 9.0).product::<f64>()
        + 4.0 * (0..n).map(|_| 8.0 / 9.0).product::<f64>();
    let genus = 1409;
    let known = known("menger_3", "", 0.55).fine().area(area).area_error(0.04).volume(volume);
    check(&known.shape(2 - 2 * genus, 1), &sponge);
}

/// As the notes of the gallery say.
#[test]
fn genera_are_right() {
    for (name, genus) in [("pretzel", 2), ("genus_three", 3), ("orthocircles", 7), ("decocube", 13)]
    {
        let scene = gallery::find(name).unwrap().scene(&[]).unwrap();
        let domain = pipeline::lattice(&scene, Some(96)).bounds();
        let shape = mesh(&scene, domain, 96, Border::Open).shape();
        assert_eq!((shape.euler, shape.components), (2 - 2 * genus, 1), "{name}");
    }
}

/// In one cell: the area, in squares of its edge, and the part of space on one side. In 1, 2 and 3 cells along
/// each edge: the Euler number of one, because that of a piece is the number of cells times it, and as much
/// again as its border is long.
#[test]
fn cells_of_periodic_surfaces_are_measured() {
    for (name, area, euler) in
        [("gyroid", 3.0917, -8), ("schwarz_P", 2.3526, -4), ("schwarz_D", 3.8380, -16)]
    {
        let edge = 2.0 * PI;
        let cell = known(name, published(name).f, PI)
            .area(area * edge * edge)
            .volume(0.5 * edge * edge * edge);
        let scene = cell.scene();
        check(&cell, &scene);
        let piece = |n: u32| {
            // Not where its border touches a symmetric part of the surface.
            let min = glam::DVec3::new(0.3, 0.5, 0.8);
            let domain = Aabb { min, max: min + f64::from(n) * edge };
            mesh(&scene, domain, 32 * n, Border::Open).shape().euler
        };
        // n³ - 2*(n - 1)³ + (n - 2)³ of n = 3 is 12; what grows with n drops out.
        assert_eq!(piece(3) - 2 * piece(2) + piece(1), 12 * euler, "{name}");
    }
}
