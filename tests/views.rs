//! Voxels where the picture shows them: the same picture, and close-ups that are as crisp as the
//! overview.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]

use std::{fs, path::Path};

use glam::{DVec2, DVec3};
use zeroset::{
    pipeline::{self, Options, Picture},
    progress::Unwatched,
    raster::{Frame, Shade},
    scene::{self, Scene},
};

fn render(scene: &Scene, find_all: bool) -> Picture {
    let options = Options { resolution: Some(100), find_all, ..Options::default() };
    pipeline::render(scene, &options, &Unwatched).unwrap()
}

#[test]
fn only_visible_voxels_give_the_same_picture() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs");
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    for path in paths.filter(|path| path.extension().is_some_and(|ending| ending == "toml")) {
        let mut scene = scene::load(&path).unwrap();
        // A mesh would need all voxels.
        scene.outputs.meshes.clear();
        (scene.image.width, scene.image.height) = (150, 110);
        (scene.image.shade, scene.visible_only) = (Shade::Refine, None);
        let (all, visible) = (render(&scene, true), render(&scene, false));
        assert_eq!(visible.frame.digest(), all.frame.digest(), "{}", path.display());
        let n_voxels = |picture: &Picture| picture.statistics.voxels.stored;
        let is_only = visible.statistics.visible_only && n_voxels(&visible) <= n_voxels(&all);
        assert!(is_only || scene.surfaces.is_empty(), "{}", path.display());
    }
}

/// Where voxels are smaller than pixels, nodes of the octree stand for them, whatever holds it.
#[test]
fn far_away_nodes_stand_for_voxels() {
    let picture = |shade: &str, storage: &str| {
        let text = format!(
            "version = 1\n[[surface]]\nf = 'x^2 + y^2 + z^2 = 1'\n\
             [voxels]\nresolution = 400\nstorage = '{storage}'\n\
             [image]\nwidth = 50\nheight = 50\nshade = '{shade}'\n"
        );
        let scene = scene::parse(Path::new("ball.toml"), &text).unwrap();
        pipeline::render(&scene, &Options::default(), &Unwatched).unwrap()
    };
    let exact = picture("refine", "octree").frame;
    for shade in ["voxel", "slab", "status"] {
        let of_nodes = picture(shade, "octree");
        let frame = &of_nodes.frame;
        assert_eq!(frame.surface, exact.surface, "{shade}");
        let (mut sum, mut n) = (0.0, 0.0);
        for (&normal, &point) in frame.normal.iter().zip(&exact.position) {
            let [normal, point] = [normal, point].map(|v| DVec3::from_array(v.map(f64::from)));
            if point != DVec3::ZERO {
                sum += normal.angle_between(point).to_degrees();
                n += 1.0;
            }
        }
        assert!(n > 1000.0 && sum / n < 3.0, "{shade}: {} degrees over {n} pixels", sum / n);
        for storage in ["pointer", "dense"] {
            assert_eq!(picture(shade, storage).frame.digest(), frame.digest(), "{shade} {storage}");
        }
    }
}

/// The surface of Scene 2.
fn lobes(p: DVec3) -> f64 {
    let r = p.length();
    r - libm::sin(4.0 * libm::atan2(p.y, p.x)) * libm::sin(8.0 * libm::acos(p.z / r))
}

fn gradient(p: DVec3) -> DVec3 {
    let h = 1e-5;
    let along = |axis: DVec3| (lobes(p + h * axis) - lobes(p - h * axis)) / (2.0 * h);
    DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
}

/// The point of a lobe in the direction of azimuth 5.205 and colatitude 0.982.
fn target() -> DVec3 {
    let (theta, phi): (f64, f64) = (5.205, 0.982);
    let r = libm::sin(4.0 * theta) * libm::sin(8.0 * phi);
    let rho = r * libm::sin(phi);
    DVec3::new(rho * libm::cos(theta), rho * libm::sin(theta), r * libm::cos(phi))
}

/// From this distance, slanted, with voxels as large as pixels.
fn close_up(distance: f64) -> Picture {
    let target = target();
    let slanted = gradient(target).normalize() + DVec3::new(0.4, -0.3, 0.25);
    let eye = target + distance * slanted.normalize();
    let text = format!(
        "version = 1\n[[surface]]\nf = 'r = sin(4*theta) * sin(8*phi)'\n\
         [domain]\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\n[voxels]\nresolution = 'auto'\n\
         [camera]\neye = [{}, {}, {}]\ntarget = [{}, {}, {}]\nfov = 20\n\
         [image]\nwidth = 200\nheight = 200\n",
        eye.x, eye.y, eye.z, target.x, target.y, target.z
    );
    let scene = scene::parse(Path::new("close-up.toml"), &text).unwrap();
    pipeline::render(&scene, &Options::default(), &Unwatched).unwrap()
}

#[test]
fn close_ups_are_as_exact_as_the_overview() {
    for distance in [3e-3, 3e-6, 3e-8] {
        let Picture { frame, camera, statistics, .. } = close_up(distance);
        assert!(statistics.visible_only);
        for (pixel, &depth) in frame.depth.iter().enumerate() {
            assert!(depth != Frame::FAR, "a hole at {pixel}, {distance} away");
            let at = DVec2::new((pixel % 200) as f64, (pixel / 200) as f64) / 100.0 - 1.0;
            // The layers show one of the pixel's samples: anywhere in it, so only roughly.
            let (origin, direction) = camera.ray(DVec2::new(at.x + 0.005, -at.y - 0.005));
            let off = lobes(origin + f64::from(depth) * direction) / gradient(target()).length();
            assert!(off.abs() < 0.01 * distance, "{off} at {pixel}, {distance} away");
            let normal = DVec3::from_array(frame.normal[pixel].map(f64::from));
            let expected = gradient(origin + f64::from(depth) * direction).normalize();
            assert!(normal.dot(expected) > 0.9999, "{normal} {expected}");
        }
    }
}

/// Spheres outside and inside, a plane: curvatures that everybody knows.
#[test]
fn curvatures_are_those_of_spheres_and_planes() {
    for (f, expected) in [
        ("x^2 + y^2 + z^2 = 0.25", 2.0),
        ("0.25 = x^2 + y^2 + z^2", -2.0),
        ("x + 2*y - z = 0", 0.0),
        ("x^2 + y^2 = 0.25", 1.0),
    ] {
        let text = format!(
            "version = 1\n[[surface]]\nf = '{f}'\n[domain]\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\n\
             [camera]\nprojection = 'orthographic'\n[image]\nwidth = 60\nheight = 60\n"
        );
        let scene = scene::parse(Path::new("curved.toml"), &text).unwrap();
        let Picture { frame, .. } = render(&scene, false);
        let mut n_seen = 0;
        for (depth, curvature) in frame.depth.iter().zip(&frame.curvature) {
            let expected = if *depth == Frame::FAR { 0.0 } else { expected };
            n_seen += usize::from(*depth != Frame::FAR);
            assert!((curvature - expected).abs() < 1e-4, "{f}: {curvature}");
        }
        assert!(n_seen > 300, "{f}");
    }
}
