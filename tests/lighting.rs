//! Colours, shadows, occlusion and matcaps, against what geometry says.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]

use std::fs;

use glam::DVec3;
use zeroset::{
    pipeline::{self, Options, Picture},
    polygons::Polygons,
    progress::Unwatched,
    raster::Shade,
    scene,
};

const SIDE: usize = 160;

/// A picture of the scene `text` with one sample a pixel, beside a white matcap `white.png` and a
/// tetrahedron `tetrahedron.obj`.
fn picture(text: &str, shade: Shade) -> Picture {
    let folder = tempfile::tempdir().unwrap();
    image::RgbImage::from_pixel(4, 4, image::Rgb([255; 3]))
        .save(folder.path().join("white.png"))
        .unwrap();
    fs::write(folder.path().join("tetrahedron.obj"), TETRAHEDRON).unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(&path, text).unwrap();
    let mut scene = scene::load(&path).unwrap();
    (scene.image.width, scene.image.height) = (SIDE as u32, SIDE as u32);
    (scene.image.samples, scene.image.shade) = (1, shade);
    let options = Options { resolution: Some(128), ..Options::default() };
    pipeline::render(&scene, &options, &Unwatched).unwrap()
}

const TETRAHEDRON: &str = "v 0.2 0 0.5\nv -0.7 0.3 0.4\nv -0.1 -0.8 0.6\nv 0 0 1.1\n\
    f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

/// A table, and above it a ball or a tetrahedron.
fn table(thing: &str) -> String {
    format!(
        "version = 1\n[[surface]]\nname = 'table'\nf = 'z = 0'\nspecular = 0\ncolor = '#ffffff'\n\
         {thing}\n[domain]\nmin = [-2, -2, -0.2]\nmax = [2, 2, 1.4]\n\
         [[light]]\ndirection = [1, -0.5, 2]\n\
         [camera]\neye = [1, -9, 7]\ntarget = [0, 0, 0.2]\nfov = 26\n\
         [image]\nshadows = true\n"
    )
}

const BALL: &str = "[[surface]]\nf = 'x^2 + y^2 + (z - 0.8)^2 = 0.25'";
const MODEL: &str = "[[model]]\nfile = 'tetrahedron.obj'\nup = 'z'";

/// The points of the table in a picture, each with whether it is in the shade.
fn table_points(picture: &Picture) -> Vec<(DVec3, bool)> {
    let frame = &picture.frame;
    let is_table = |&i: &usize| frame.surface[i] == 1.0;
    let lit = (0..frame.rgba.len()).filter(is_table).map(|i| frame.rgba[i][0]);
    let most = lit.fold(0.0, f32::max);
    (0..frame.rgba.len())
        .filter(is_table)
        .map(|i| {
            let at = DVec3::from_array(frame.position[i].map(f64::from));
            (at, frame.rgba[i][0] < 0.5 * most)
        })
        .collect()
}

/// How far beyond the rim of the ball the ray from `p` to the light passes, squared.
fn beyond_ball(p: DVec3) -> f64 {
    let d = DVec3::new(1.0, -0.5, 2.0).normalize();
    let to_center = DVec3::new(0.0, 0.0, 0.8) - p;
    (to_center - to_center.dot(d) * d).length_squared() - 0.25
}

#[test]
fn a_ball_throws_the_shadow_that_geometry_says() {
    for (shade, width) in [(Shade::Refine, 1e-3), (Shade::Voxel, 0.1)] {
        let points = table_points(&picture(&table(BALL), shade));
        let (mut n_dark, mut n_lit) = (0, 0);
        for (p, is_dark) in points {
            let beyond = beyond_ball(p);
            if beyond.abs() > width {
                assert_eq!(is_dark, beyond < 0.0, "{p} {shade:?}");
                *(if is_dark { &mut n_dark } else { &mut n_lit }) += 1;
            }
        }
        assert!(n_dark > 200 && n_lit > 3000, "{n_dark} {n_lit}");
    }
}

#[test]
fn a_model_throws_its_shadow_on_a_surface() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tetrahedron.obj");
    fs::write(&path, TETRAHEDRON).unwrap();
    let Polygons { positions, triangles, .. } = Polygons::read(&path).unwrap();
    let d = DVec3::new(1.0, -0.5, 2.0);
    // Positive inside the triangle as the light sees it, by the least of three areas.
    let inside = |p: DVec3, corners: [DVec3; 3]| {
        let [a, b, c] = corners.map(|corner| corner - p);
        let areas = [d.dot(b.cross(c)), d.dot(c.cross(a)), d.dot(a.cross(b))];
        let sign = areas.iter().sum::<f64>().signum();
        areas.map(|area| sign * area).into_iter().fold(f64::INFINITY, f64::min)
    };
    let mut n_dark = 0;
    for (p, is_dark) in table_points(&picture(&table(MODEL), Shade::Refine)) {
        let of_triangle = |t: &[u32; 3]| inside(p, t.map(|i| positions[i as usize]));
        let most = triangles.iter().map(of_triangle).fold(f64::NEG_INFINITY, f64::max);
        if most.abs() > 1e-4 {
            assert_eq!(is_dark, most > 0.0, "{p}");
            n_dark += usize::from(is_dark);
        }
    }
    assert!(n_dark > 100, "{n_dark}");
}

/// Nothing that curves outwards is in its own shade where it faces the light.
#[test]
fn surfaces_do_not_shade_themselves() {
    let text = "version = 1\n[[surface]]\nf = 'x^4 + y^4 + z^4 = 1'\nspecular = 0\n\
        [[light]]\ndirection = [1, -2, 3]\n";
    for shade in [Shade::Refine, Shade::Voxel, Shade::Slab] {
        let plain = picture(text, shade);
        let shaded = picture(&format!("{text}[image]\nshadows = true\n"), shade);
        let differ = plain.frame.rgba.iter().zip(&shaded.frame.rgba).filter(|(a, b)| a != b);
        assert_eq!(differ.count(), 0, "{shade:?}");
    }
}

/// With a white matcap a pixel has the very colour of its surface.
fn colored(keys: &str) -> Picture {
    let text = format!(
        "version = 1\n[[surface]]\nf = 'x^2 + y^2 + z^2 = 1'\n{keys}\n\
         [domain]\nmin = [-1.5, -1.5, -1.5]\nmax = [1.5, 1.5, 1.5]\n[image]\nmatcap = 'white.png'\n"
    );
    picture(&text, Shade::Refine)
}

#[test]
fn formulas_color_by_their_value() {
    let keys = "color_by = 'x + 2 y'\npalette = 'gray'\ncolor_range = [-1, 2]";
    let frame = colored(keys).frame;
    let mut n = 0;
    for (i, rgba) in frame.rgba.iter().enumerate().filter(|&(i, _)| frame.surface[i] == 1.0) {
        let [x, y, _] = frame.position[i].map(f64::from);
        let t = ((x + 2.0 * y + 1.0) / 3.0).clamp(0.0, 1.0);
        let srgb = libm::pow(f64::from(rgba[0]), 1.0 / 2.4) * 1.055 - 0.055;
        if t > 0.05 {
            assert!((srgb - t).abs() < 1e-3, "{srgb} {t}");
        }
        n += 1;
    }
    assert!(n > 3000, "{n}");
}

#[test]
fn a_ball_has_one_curvature_and_so_one_color() {
    let frame = colored("color_by = 'curvature'\ncolor_range = [0, 2]").frame;
    // In the middle of blue to red there is white.
    for (i, rgba) in frame.rgba.iter().enumerate().filter(|&(i, _)| frame.surface[i] == 1.0) {
        assert!(rgba.iter().all(|&c| c > 0.8), "{rgba:?} at {i}");
    }
}

#[test]
fn a_plane_is_open_and_a_corner_is_not() {
    let light = |f: &str, occlusion: f64| {
        let text = format!(
            "version = 1\n[[surface]]\nf = '{f}'\ncolor = '#ffffff'\n\
             [domain]\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\n\
             [camera]\nprojection = 'orthographic'\ndirection = [0, -1, 1]\n\
             [image]\nmatcap = 'white.png'\nocclusion = {occlusion}\n"
        );
        let frame = picture(&text, Shade::Refine).frame;
        frame.rgba[SIDE / 2 * SIDE + SIDE / 2][0]
    };
    let plane = light("z = 0.01 y", 1.0);
    // Pixels beside a line count as if they were on it.
    assert!((0.98..=1.0).contains(&plane), "{plane}");
    // Where two walls meet at a right angle each hides half of the sky from the other.
    let corner = light("max(-z, y) = 0", 1.0);
    assert!((0.4..0.75).contains(&corner), "{corner}");
    assert!((light("max(-z, y) = 0", 0.5) - 0.5 * (1.0 + corner)).abs() < 1e-6);
}
