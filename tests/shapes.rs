//! Shapes: as large as they should be, distances where they are promised, operations that compose.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]

use std::{f64::consts::PI, path::Path};

use glam::DVec3;
use proptest::prelude::*;
use zeroset::{
    eval::sampler,
    expr::{Expr, parse_shape},
    math::{Lattice, SimdLevel},
    mesh::{Border, FormulaSettings, Health, Shape, VertexPlace, of_formula},
    pipeline,
    progress::Unwatched,
    scene::{self, Scene},
    voxelize::{Settings, voxelize},
};

fn expr(shape: &str) -> Expr {
    let ast = parse_shape(shape).unwrap_or_else(|mistakes| panic!("{shape}: {mistakes:?}"));
    let resolved = Expr::resolve_shape(&ast, &[]);
    resolved.unwrap_or_else(|mistakes| panic!("{shape}: {mistakes:?}")).expr
}

fn values(shape: &str, points: &[DVec3]) -> Vec<f64> {
    sampler(SimdLevel::detect()).values(&expr(shape).tape(), points)
}

/// What is known of a shape's mesh, which must be clean.
fn measured(shape: &str, resolution: u32) -> Shape {
    let text = format!("version = 1\n[[surface]]\nshape = '{shape}'\n");
    let scene = scene::parse(Path::new("shape.toml"), &text).unwrap();
    measured_on(&scene, &pipeline::lattice(&scene, Some(resolution)))
}

fn measured_on(scene: &Scene, lattice: &Lattice) -> Shape {
    let expr = &scene.surfaces[0].expr;
    let found = voxelize(expr, lattice, &Settings::default(), &Unwatched).unwrap();
    let (border, vertex) = (Border::Open, VertexPlace::Polished);
    let settings = FormulaSettings { border, vertex, simd: SimdLevel::detect() };
    let mesh = of_formula(&expr.tape(), &found.octree, lattice, &settings);
    assert_eq!(mesh.health(), Health::default(), "{}", scene.sources.text);
    mesh.shape()
}

const BALL: f64 = 4.0 / 3.0 * PI;

/// Volume and area of all that is nearer to a convex solid than r: J. Steiner's polynomial of its
/// volume, area and integral of mean curvature.
fn grown(volume: f64, area: f64, curvature: f64, r: f64) -> (f64, f64) {
    let all = volume + area * r + curvature * r * r + BALL * r * r * r;
    (all, area + 2.0 * curvature * r + 4.0 * PI * r * r)
}

/// Shapes with their volumes and areas.
fn known() -> Vec<(&'static str, f64, f64)> {
    let rounded_box = grown(1.4 * 1.4 * 1.4, 6.0 * 1.4 * 1.4, 3.0 * PI * 1.4, 0.3);
    let grown_box = grown(1.0, 6.0, 3.0 * PI, 0.25);
    let (r, h) = (0.4, 1.8);
    let inner = (PI * r * r * h, 2.0 * PI * r * (h + r), PI * (h + PI * r));
    let rounded_cylinder = grown(inner.0, inner.1, inner.2, 0.1);
    vec![
        ("sphere(1)", BALL, 4.0 * PI),
        ("box(1, 2, 3)", 6.0, 22.0),
        ("box(1.5)", 3.375, 13.5),
        ("box(2, round = 0.3)", rounded_box.0, rounded_box.1),
        ("cylinder(0.5, 2)", 0.5 * PI, 2.5 * PI),
        ("cylinder(0.5, 2, 0.1)", rounded_cylinder.0, rounded_cylinder.1),
        ("cyl_x(0.5) & box(2)", 0.5 * PI, 2.5 * PI),
        ("cyl_y(0.5, 2)", 0.5 * PI, 2.5 * PI),
        ("cone(1, 2)", 2.0 / 3.0 * PI, PI * (1.0 + 5_f64.sqrt())),
        ("cone(1, 1, 0.5)", 7.0 / 12.0 * PI, PI * (1.25 + 1.5 * 1.25_f64.sqrt())),
        ("cone(0.5, 1, 1)", 7.0 / 12.0 * PI, PI * (1.25 + 1.5 * 1.25_f64.sqrt())),
        ("capsule(0.5, 1)", 0.25 * PI + BALL / 8.0, 2.0 * PI),
        ("torus(1, 0.3)", 2.0 * PI * PI * 0.09, 4.0 * PI * PI * 0.3),
        ("half_space(0, 0, 1) & sphere(1)", BALL / 2.0, 3.0 * PI),
        ("half_space(3, 4, 0, 0.5) & sphere(1)", BALL * 27.0 / 32.0, PI * 3.75),
        ("plane(0, 0, 1, 0.2, 0.1) & box(1)", 0.2, 2.8),
        ("extrude(x^2 + 4*y^2 - 1, 1)", PI / 2.0, PI + 4.844_224_110_273_838),
        ("revolve((x - 1)^2 + y^2 - 0.09)", 2.0 * PI * PI * 0.09, 4.0 * PI * PI * 0.3),
        ("revolve(sphere(0.3), 1)", 2.0 * PI * PI * 0.09, 4.0 * PI * PI * 0.3),
        ("shell(sphere(1), 0.2)", BALL * (1.331 - 0.729), 4.0 * PI * (1.21 + 0.81)),
        ("box(1).offset(0.25)", grown_box.0, grown_box.1),
        ("box(2).offset(-0.5)", 1.0, 6.0),
        ("box(2) - sphere(0.9)", 8.0 - BALL * 0.729, 24.0 + 4.0 * PI * 0.81),
        ("sphere(1).scale(1, 2, 0.5)", BALL, 15.871_1),
        ("box(1).affine(1, 0.5, 0, 0, 0, 1, 0, 0, 0, 0, 1, 3)", 1.0, 4.0 + 2.0 * 1.25_f64.sqrt()),
        ("box(1, 2, 3).rotate(20, 30, 40).translate(1, 2, 3)", 6.0, 22.0),
        ("sphere(0.2).repeat_x(0.5, 4)", 4.0 * BALL * 0.008, 16.0 * PI * 0.04),
        ("sphere(0.2).translate(0.1, 0, 0).repeat_x(0.5, 3)", 3.0 * BALL * 0.008, 12.0 * PI * 0.04),
        ("box(0.6).repeat_x(0.4, 2).repeat_y(1, 2)", 2.0 * 0.36, 2.0 * 3.12),
        (
            "union(half_space(0, 0, 1), half_space(1, 0, 0), r = 0.3) & box(1)",
            0.75 + (1.0 - PI / 4.0) * 0.09,
            0.75 * 2.0 + (1.0 - PI / 4.0) * 0.18 + 3.0 + 0.4 + PI * 0.15,
        ),
        (
            "intersection(half_space(0, 0, 1, 0.5), half_space(1, 0, 0, 0.5), r = 0.3) & box(1)",
            1.0 - (1.0 - PI / 4.0) * 0.09,
            6.0 - 0.6 + 0.15 * PI - (1.0 - PI / 4.0) * 0.18,
        ),
    ]
}

#[test]
fn shapes_have_their_volume_and_area() {
    for (shape, volume, area) in known() {
        let found = measured(shape, 96);
        let is_near = |found: f64, want: f64| (found / want - 1.0).abs() < 0.015;
        assert!(is_near(found.volume, volume), "{shape}: {} for {volume}", found.volume);
        assert!(is_near(found.area, area), "{shape}: area {} for {area}", found.area);
    }
}

/// Twisting and mirroring keep volumes.
#[test]
fn volumes_survive_what_keeps_them() {
    for shape in ["box(0.6, 0.4, 1).twist(120)", "box(0.6, 0.4, 1).mirror(1, 2, 3)"] {
        let volume = measured(shape, 96).volume;
        assert!((volume / 0.24 - 1.0).abs() < 0.01, "{shape}: {volume}");
    }
}

/// A fifth, and three tenths, of one cell; the least wall is seven voxels thick.
#[test]
fn lattices_fill_their_part_of_space() {
    for (lattice, part) in [
        ("gyroid(1, fraction = 0.2)", 0.2),
        ("schwarz_p(1, fraction = 0.2)", 0.2),
        ("schwarz_d(1, fraction = 0.2)", 0.2),
        ("neovius(1, fraction = 0.3)", 0.3),
        ("iwp(1, fraction = 0.3)", 0.3),
        ("fischer_koch_s(1, fraction = 0.3)", 0.3),
        ("lidinoid(1, fraction = 0.3)", 0.3),
        ("gyroid(1, skeletal = 0.3)", 0.3),
        ("gyroid(1)", 0.5),
    ] {
        let volume = measured(&format!("{lattice} & box(1)"), 96).volume;
        assert!((volume / part - 1.0).abs() < 6e-3, "{lattice}: {volume}");
    }
}

/// A wall of thickness t along a minimal surface of area A fills A t + 2πχ t³/12 (J. Steiner); of a
/// cell of the gyroid A is 3.0915 and χ is −8, and of that of P they are 2.3451 and −4.
#[test]
fn walls_are_as_thick_as_they_should_be() {
    for (name, area, euler) in [("gyroid", 3.0915, -8.0), ("schwarz_p", 2.3451, -4.0)] {
        for t in [0.06, 0.1] {
            let volume = measured(&format!("{name}(1, thickness = {t}) & box(1)"), 96).volume;
            let want = area * t + 2.0 * PI * euler * t * t * t / 12.0;
            assert!((volume / want - 1.0).abs() < 0.015, "{name} {t}: {volume} for {want}");
        }
    }
}

/// The scene of README: a fifth of a cube of 20 mm.
#[test]
fn the_printed_lattice_is_closed_and_weighs_what_it_should() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/lattice.toml");
    let scene = scene::load(&path).unwrap();
    let lattice = pipeline::lattice(&scene, None);
    let found = measured_on(&scene, &lattice);
    assert!((found.volume / 1600.0 - 1.0).abs() < 3e-3, "{found:?}");
    assert_eq!(found.components, 1);
}

/// Shapes whose `distance` is promised to be the signed distance.
const EXACT: [&str; 15] = [
    "sphere(1)",
    "box(1, 2, 0.7)",
    "box(1.6, round = 0.3)",
    "cylinder(0.7)",
    "cylinder(0.7, 1.1)",
    "cyl_x(0.7, 1.1, 0.2)",
    "cone(0.9, 1.4)",
    "cone(0.3, 1, 0.8)",
    "capsule(0.4, 1)",
    "torus(1, 0.3)",
    "half_space(1, -2, 0.5, 0.3)",
    "plane(1, 1, 1, 0.4)",
    "extrude(box(1, 0.5, 3), 0.8)",
    "revolve(box(0.4, 0.8, 1), 0.7)",
    "box(1, 2, 0.7).rotate(10, 20, 30).mirror(1, 1, 0).scale(0.8).translate(0.1, 0.2, 0.3)",
];

/// Points on the unit sphere, all over it.
fn directions() -> impl Iterator<Item = DVec3> {
    (0..200).map(|i| {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 200.0;
        let angle = 2.399_963_229_728_653 * f64::from(i);
        let rho = (1.0 - z * z).sqrt();
        DVec3::new(rho * libm::cos(angle), rho * libm::sin(angle), z)
    })
}

fn point(range: f64) -> impl Strategy<Value = DVec3> {
    (-range..range, -range..range, -range..range).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// No point nearer than the distance is on the other side, and one at the distance is on the
    /// surface: downhill, where there is one way down.
    #[test]
    fn distances_are_exact(index in 0..EXACT.len(), p in point(2.0)) {
        let shape = format!("offset({}, 0)", EXACT[index]);
        let tape = expr(&shape).tape();
        let mut sampler = sampler(SimdLevel::detect());
        let d = sampler.values(&tape, &[p])[0];
        let around: Vec<DVec3> = directions().map(|u| p + 0.9999 * d.abs() * u).collect();
        for (v, q) in sampler.values(&tape, &around).into_iter().zip(around) {
            prop_assert!(v == 0.0 || v.is_sign_negative() == d.is_sign_negative(), "{shape} at {p}: {d}, but {v} at {q}");
        }
        let gradient = sampler.gradients(&tape, &[p])[0];
        if (gradient.length() - 1.0).abs() < 1e-9 {
            let foot = sampler.values(&tape, &[p - d * gradient])[0];
            prop_assert!(foot.abs() < 1e-9, "{shape} at {p}: {d}, but {foot} at its foot");
        }
    }

    /// The field that is drawn has the sign of the distance, and is not above it in size.
    #[test]
    fn both_fields_agree(index in 0..EXACT.len(), p in point(2.0)) {
        let (surface, distance) =
            (values(EXACT[index], &[p])[0], values(&format!("offset({}, 0)", EXACT[index]), &[p])[0]);
        prop_assert!(surface.abs() <= distance.abs() + 1e-12 && surface * distance >= -1e-24);
    }

    /// Where all but one of the shapes are as far away as the radius, nothing is rounded.
    #[test]
    fn roundings_end_at_their_radius(p in point(2.0), r in 0.01..0.8_f64) {
        const A: &str = "sphere(0.8)";
        const B: &str = "box(1, 0.7, 0.5).translate(0.6, 0.1, 0)";
        let [a, b] = [A, B].map(|shape| values(shape, &[p])[0]);
        let [or, and, less] = ["union", "intersection", "difference"]
            .map(|name| values(&format!("{name}({A}, {B}, r = {r})"), &[p])[0]);
        let is = |found: f64, sharp: f64| (found - sharp).abs() < 4e-16 * (1.0 + r + sharp.abs());
        if a.max(b) >= r { prop_assert!(is(or, a.min(b)), "{or}"); }
        if a.min(b) <= -r { prop_assert!(is(and, a.max(b)), "{and}"); }
        if a.min(-b) <= -r { prop_assert!(is(less, a.max(-b)), "{less}"); }
        // A fillet adds, a rounded edge takes away, and neither more than (√2 − 1) r.
        let most = 0.4143 * r + 1e-15;
        if a.min(b) > 0.0 { prop_assert!(or <= a.min(b) + 1e-15 && or >= a.min(b) - most); }
        if a.max(b) < 0.0 { prop_assert!(and >= a.max(b) - 1e-15 && and <= a.max(b) + most); }
    }

    #[test]
    fn transforms_compose(p in point(2.0), [a, b, c] in prop::array::uniform3(-180.0..180.0_f64)) {
        const S: &str = "box(1, 0.7, 0.5).translate(0.3, 0.2, 0.1)";
        let (sin, cos) = libm::sincos(a.to_radians());
        for (one, other) in [
            (format!("{S}.rotate({a}, {b}, {c})"), format!("{S}.rotate_x({a}).rotate_y({b}).rotate_z({c})")),
            (format!("{S}.rotate_z({a}).rotate_z({b})"), format!("{S}.rotate_z({a} + {b})")),
            (format!("{S}.translate({a}, 0, 1).translate(-{b}, 1, 1)"), format!("{S}.translate({a} - {b}, 1, 2)")),
            (format!("{S}.mirror(1, {b}, {c}).mirror(1, {b}, {c})"), S.to_owned()),
            (format!("{S}.rotate_z({a})"), format!("{S}.affine({cos}, -{sin}, 0, 0, {sin}, {cos}, 0, 0, 0, 0, 1, 0)")),
            (format!("{S}.scale(2).scale(0.5)"), S.to_owned()),
            (format!("{S}.twist({a}).twist(-({a}))"), S.to_owned()),
            (format!("complement({S} | sphere(1))"), format!("complement({S}) & complement(sphere(1))")),
            (format!("{S} - sphere(0.5)"), format!("{S} & complement(sphere(0.5))")),
        ] {
            let (one, other) = (one.replace("--", ""), other.replace("--", ""));
            let (u, v) = (values(&one, &[p])[0], values(&other, &[p])[0]);
            prop_assert!((u - v).abs() < 1e-9 * (1.0 + u.abs()), "{one}: {u}, {other}: {v}");
        }
    }

    /// Folded space is the union of the copies.
    #[test]
    fn folded_copies_are_copies(p in point(3.0), n in 1..7_u32, spacing in 0.85..1.5_f64) {
        let folded = values(&format!("box(0.8, 0.5, 0.6).repeat_x({spacing}, {n})"), &[p])[0];
        let copy = |i: u32| {
            let x = (f64::from(i) - f64::from(n - 1) / 2.0) * spacing;
            values("box(0.8, 0.5, 0.6)", &[p - DVec3::new(x, 0.0, 0.0)])[0]
        };
        let least = (0..n).map(copy).fold(f64::INFINITY, f64::min);
        prop_assert!((folded - least).abs() < 1e-12, "{folded} {least}");
    }
}

/// One shape for all copies: the formula does not grow with their number.
#[test]
fn copies_that_are_alike_cost_nothing() {
    let length = |shape: &str| expr(shape).tape().instructions().len();
    let few = length("sphere(0.2).repeat_x(0.5, 3).repeat_y(0.5, 3)");
    assert_eq!(length("sphere(0.2).repeat_x(0.5, 3001).repeat_y(0.5, 30001)"), few);
    assert!(length("sphere(0.2).repeat_x(0.5).repeat_y(0.5)") < few);
    // What else is in the formula does not matter.
    assert!(expr("sphere(0.2).repeat_x(0.5) | (sqrt(x - 3) + y)").constant().is_none());
    // A ball that leaves its cell is as many balls as there are.
    assert!(length("sphere(0.3).repeat_x(0.5, 30)") > 100);
}

/// Equal shapes are one part, wherever they come from.
#[test]
fn equal_parts_are_shared() {
    let length = |shape: &str| expr(shape).tape().instructions().len();
    let ball = length("sphere(1)");
    assert_eq!(length("sphere(1) | sphere(2 - 1).rotate_z(360).scale(1)"), ball);
    assert_eq!(length("sphere(1).mirror(0, 0, 1) | sphere(1)"), ball);
}

#[test]
fn what_has_no_distance_warns_of_lengths() {
    let warnings = |shape: &str| {
        let resolved = Expr::resolve_shape(&parse_shape(shape).unwrap(), &[]).unwrap();
        resolved.warnings.len()
    };
    assert_eq!(warnings("shell(box(1) | sphere(1).translate(1, 0, 0), 0.1)"), 0);
    assert_eq!(warnings("shell(x^2 + y^2 + z^2 - 1, 0.1)"), 1);
    assert_eq!(warnings("offset(box(1).twist(30), 0.1)"), 1);
    assert_eq!(warnings("union(sphere(1).scale(1, 2, 3), box(1), r = 0.1)"), 1);
    assert_eq!(warnings("union(sphere(1).scale(1, 2, 3), box(1))"), 0);
}
