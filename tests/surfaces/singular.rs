//! Singular surfaces are said to be so, and regular ones are proven to be single sheets.

use std::path::Path;

use glam::DVec3;
use proptest::prelude::*;
use zeroset::{
    expr::{Expr, parse},
    math::{Aabb, Lattice, SimdLevel},
    output::meshes::MeshFormat,
    pipeline,
    progress::Unwatched,
    scene,
    voxelize::{SingularPlace, singular_places},
};

use crate::{lattice, meshed::published, octree, scene as scene_of};

fn found(expr: &Expr, lattice: &Lattice) -> Vec<SingularPlace> {
    singular_places(&expr.tape(), &octree(expr, lattice), lattice, SimdLevel::detect())
}

/// Surfaces with the numbers of their singular points, and resolutions at which these are apart; curves
/// count as one.
const PLACES: &[(&str, u32, usize)] = &[
    ("sphere", 64, 0),
    ("ellipsoid_321", 64, 0),
    ("torus_1_04", 64, 0),
    ("superellipsoid_4", 64, 0),
    ("octahedron", 64, 0),
    ("steinmetz_2", 64, 0),
    ("steinmetz_3", 64, 0),
    ("helicoid", 64, 0),
    ("distel", 64, 0),
    ("tanglecube", 64, 0),
    ("banchoff_chmutov_4", 64, 0),
    ("clebsch_cubic", 64, 0),
    ("seed_pod", 64, 0),
    ("gyroid", 64, 0),
    ("schwarz_P", 64, 0),
    ("schwarz_D", 64, 0),
    ("ding_dong", 64, 1),
    ("piriform", 64, 1),
    ("double_cone", 64, 1),
    ("cayley_cubic", 64, 4),
    ("cayley_cubic, other form", 64, 4),
    ("kummer_quartic", 64, 16),
    ("chmutov_quartic_12", 64, 12),
    ("togliatti_quintic", 64, 31),
    ("barth_sextic", 64, 50),
    ("barth_sextic_30_cusps", 64, 30),
    ("barth_decic", 128, 300),
    ("whitney_umbrella", 64, 1),
    ("steiner_roman", 64, 1),
    ("klein_bottle", 64, 1),
    // All lobes meet in the origin.
    ("stolte_kaufman_scene_2", 64, 1),
    ("stolte_kaufman_scene_3", 64, 1),
];

#[test]
fn singular_points_are_counted() {
    for &(name, resolution, expected) in PLACES {
        let surface = published(name);
        let expr = &scene_of(surface).surfaces[0].expr;
        let places = found(expr, &lattice(surface, resolution));
        assert_eq!(places.len(), expected, "{name}: {places:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Wherever the tip of a cone is, and whichever way it is turned.
    #[test]
    fn tips_are_found(
        x in -0.8..0.8_f64, y in -0.8..0.8_f64, z in -0.8..0.8_f64, a in -1.0..1.0_f64,
        b in -1.0..1.0_f64, slope in 0.3..3.0_f64,
    ) {
        let text = format!(
            "(x - ({x}) + ({a})*(z - ({z})))^2 + (y - ({y}) + ({b})*(z - ({z})))^2 = {slope}*(z - ({z}))^2"
        );
        let expr = Expr::resolve(&parse(&text).unwrap(), &[]).unwrap().expr;
        let domain = Aabb { min: DVec3::NEG_ONE, max: DVec3::ONE };
        let lattice = Lattice::new(domain, 40);
        let places = found(&expr, &lattice);
        prop_assert_eq!(places.len(), 1);
        let away = lattice.voxel_center(places[0].first) - DVec3::new(x, y, z);
        prop_assert!(away.abs().max_element() < 2.5 * lattice.voxel_size(), "{:?} {away}", places);
    }
}

/// Edges of solids are parts of single sheets; where two solids touch there are two.
#[test]
fn edges_are_not_singular() {
    for (f, expected) in [
        ("max(|x|, |y|, |z|) = 0.7", 0),
        ("max(x^2 + y^2 + z^2 - 1, 0.36 - x^2 - y^2) <= 0", 0),
        ("|x| + |y| + |z| = 0.8", 0),
        ("min((x - 0.5)^2 + y^2, (x + 0.5)^2 + y^2) + z^2 = 0.25", 1),
        ("(x^2 + y^2 + z^2 - 0.5)^2 = 0", 1),
    ] {
        let expr = Expr::resolve(&parse(f).unwrap(), &[]).unwrap().expr;
        let domain = Aabb { min: DVec3::splat(-1.1), max: DVec3::splat(1.1) };
        assert_eq!(found(&expr, &Lattice::new(domain, 50)).len(), expected, "{f}");
    }
}

/// With a mesh the user is told, and the statistics count.
#[test]
fn meshes_of_singular_surfaces_come_with_a_note() {
    for (f, n, note) in [
        ("x^2 + y^2 = (z - 0.5)^2", 1, Some("in one place, near (-0.0")),
        ("4*(x^2 + y^2 + z^2) + 16*x*y*z = 1", 4, Some("in 4 places, the first near (")),
        ("x^2 + y^2 + z^2 = 0.5", 0, None),
    ] {
        let text = format!(
            "version = 1\n[[surface]]\nname = 'it'\nf = '{f}'\n[domain]\nmin = [-1, -1, -1]\n\
             max = [1, 1, 1]\n[voxels]\nresolution = 40\n[output]\npng = false\nexr = false\n\
             obj = true\n"
        );
        let scene = scene::parse(Path::new("singular.toml"), &text).unwrap();
        assert_eq!(scene.outputs.meshes[0].0, MeshFormat::Obj);
        let options = pipeline::Options::default();
        let picture = pipeline::render(&scene, &options, &Unwatched).unwrap();
        let singular = &picture.statistics.singular[0];
        assert_eq!((singular.name.as_str(), singular.places), ("it", n), "{f}");
        assert_eq!(singular.places == 0, singular.first.is_none());
        let said = picture.notes.iter().find(|said| said.starts_with("`it` may touch or cross"));
        assert_eq!(said.is_some(), note.is_some(), "{f}: {:?}", picture.notes);
        assert!(note.is_none_or(|note| said.unwrap().contains(note)), "{said:?}");
    }
}
