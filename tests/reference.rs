//! Pictures against a ray caster that knows nothing of voxels and intervals: small steps along each
//! ray, by formulas written down once more.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]
#![expect(clippy::print_stdout, reason = "the figures are for BENCHMARKS.md")]

use std::path::Path;

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use zeroset::{
    math::Aabb,
    pipeline::{self, Options, Picture},
    progress::Unwatched,
    raster::{Camera, Frame, Shade},
    scene::{self, Scene},
};

const RESOLUTION: u32 = 512;

/// Steps of the ray caster in a voxel.
const STEPS: f64 = 4.0;

/// A surface as the ray caster knows it.
struct Reference {
    name: &'static str,
    f: fn(DVec3) -> f64,
    clip: fn(DVec3) -> bool,
}

fn everything(_: DVec3) -> bool {
    true
}

fn harmonics(p: DVec3, a: f64, b: f64) -> f64 {
    let r = p.length();
    let theta = libm::atan2(p.y, p.x);
    let phi = libm::acos((p.z / r).clamp(-1.0, 1.0));
    r - libm::sin(a * theta) * libm::sin(b * phi)
}

fn ten_spheres(p: DVec3) -> f64 {
    const SPHERES: [[f64; 4]; 10] = [
        [0.00, 0.00, 0.00, 1.60],
        [0.42, 0.05, 0.12, 2.20],
        [-0.40, 0.10, -0.10, 2.10],
        [0.06, 0.44, -0.08, 2.30],
        [-0.05, -0.43, 0.10, 2.20],
        [0.08, -0.06, 0.46, 2.40],
        [-0.10, 0.04, -0.45, 2.30],
        [0.66, 0.26, 0.24, 2.90],
        [-0.58, -0.22, -0.34, 2.70],
        [0.20, 0.62, 0.28, 2.80],
    ];
    let term = |[x, y, z, a]: [f64; 4]| {
        let u = 1.0 - a * a * (p - DVec3::new(x, y, z)).length_squared();
        if u > 0.0 { u * u * u * u } else { 0.0 }
    };
    SPHERES.map(term).iter().sum::<f64>() - 0.25
}

fn cube(x: f64) -> f64 {
    x * x * x
}

const REFERENCES: [Reference; 8] = [
    Reference { name: "scene1", f: ten_spheres, clip: everything },
    Reference { name: "scene2", f: |p| harmonics(p, 4.0, 8.0), clip: everything },
    Reference { name: "scene3", f: |p| harmonics(p, 3.0, 4.0), clip: everything },
    Reference {
        name: "tanglecube",
        f: |p| (p * p * p * p - 5.0 * p * p).element_sum() + 11.8,
        clip: everything,
    },
    Reference {
        name: "barth_sextic",
        f: |p| {
            let q = p * p;
            let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
            let g = golden * golden;
            let factors = (g * q.x - q.y) * (g * q.y - q.z) * (g * q.z - q.x);
            let sphere = q.element_sum() - 1.0;
            4.0 * factors - (1.0 + 2.0 * golden) * sphere * sphere
        },
        clip: |p| p.length_squared() <= 1.8 * 1.8,
    },
    Reference {
        name: "heart",
        f: |p| {
            let q = p * p;
            let z = cube(p.z);
            cube(q.x + 2.25 * q.y + q.z - 1.0) - q.x * z - 9.0 / 80.0 * q.y * z
        },
        clip: everything,
    },
    Reference {
        name: "gyroid",
        f: |p| {
            let (s, c) = (p.map(libm::sin), p.map(libm::cos));
            s.x * c.y + s.y * c.z + s.z * c.x
        },
        clip: everything,
    },
    Reference {
        name: "klein",
        f: |p| {
            let s = p.length_squared();
            let t = s - 2.0 * p.y - 1.0;
            (s + 2.0 * p.y - 1.0) * (t * t - 8.0 * p.z * p.z) + 16.0 * p.x * p.z * t
        },
        clip: |p| p.x <= 0.7,
    },
];

/// A scene's picture, and what is needed to cast the same rays.
struct Case<'a> {
    reference: &'a Reference,
    camera: Camera,
    domain: Aabb,
    step: f64,
    frame: Frame,
}

impl<'a> Case<'a> {
    fn new(reference: &'a Reference, shade: Shade, pixels: u32) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs");
        let mut scene: Scene = scene::load(&path.join(format!("{}.toml", reference.name))).unwrap();
        (scene.image.width, scene.image.height) = (pixels, pixels);
        (scene.image.samples, scene.image.shade) = (1, shade);
        let options = Options { resolution: Some(RESOLUTION), ..Options::default() };
        let Picture { frame, camera, .. } = pipeline::render(&scene, &options, &Unwatched).unwrap();
        let lattice = pipeline::lattice(&scene, Some(RESOLUTION));
        let step = lattice.voxel_size() / STEPS;
        Self { reference, camera, domain: lattice.bounds(), step, frame }
    }

    /// The ray through a pixel, `offset` pixels beside its centre.
    fn ray(&self, pixel: usize, offset: DVec2) -> (DVec3, DVec3) {
        let (width, height) = (self.frame.width as usize, f64::from(self.frame.height));
        let at = DVec2::new((pixel % width) as f64, (pixel / width) as f64) + 0.5 + offset;
        let picture = 2.0 * at / DVec2::new(width as f64, height) - 1.0;
        self.camera.ray(DVec2::new(picture.x, -picture.y))
    }

    /// The depth at which a ray meets the surface first.
    fn hit(&self, (origin, direction): (DVec3, DVec3)) -> Option<f64> {
        let Reference { f, clip, .. } = self.reference;
        let (mut enter, mut leave) = (1e-9, f64::INFINITY);
        for axis in 0..3 {
            let to = |plane: DVec3| (plane[axis] - origin[axis]) / direction[axis];
            let (a, b) = (to(self.domain.min), to(self.domain.max));
            enter = a.min(b).max(enter);
            leave = a.max(b).min(leave);
        }
        let at = |t: f64| f(origin + t * direction);
        let is_kept = |t: f64| clip(origin + t * direction);
        let n = ((leave - enter) * direction.length() / self.step).ceil();
        let place = |i: u32| enter + (leave - enter) * (f64::from(i) / n);
        let (mut before, mut last) = (f64::NAN, at(enter));
        for i in 1..=n.max(0.0) as u32 {
            let (t, t_last) = (place(i), place(i - 1));
            let value = at(t);
            let root = if (value < 0.0) != (last < 0.0) {
                Some(bisect(&at, t_last, t))
            } else if (before < 0.0) == (last < 0.0)
                && last.abs() < before.abs()
                && last.abs() <= value.abs()
            {
                // A dip between three steps may go through 0.
                let from = place(i.saturating_sub(2));
                let dip = least(&|t| at(t) * last.signum(), from, t);
                (at(dip) * last.signum() < 0.0).then(|| bisect(&at, from, dip))
            } else {
                None
            };
            if let Some(root) = root.filter(|&root| is_kept(root)) {
                return Some(root);
            }
            (before, last) = (last, value);
        }
        None
    }

    fn normal(&self, p: DVec3) -> DVec3 {
        let h = 1e-6;
        let slope =
            |axis: DVec3| (self.reference.f)(p + h * axis) - (self.reference.f)(p - h * axis);
        DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z)).normalize()
    }

    /// Whether moving a ray by a ten-thousandth of a pixel changes whether it hits.
    fn is_tangent(&self, pixel: usize, is_hit: bool) -> bool {
        let offsets = [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y];
        offsets.iter().any(|&d| self.hit(self.ray(pixel, 1e-4 * d)).is_some() != is_hit)
    }
}

fn bisect(f: &impl Fn(f64) -> f64, mut from: f64, mut to: f64) -> f64 {
    let sign = f(to) < 0.0;
    for _ in 0..60 {
        let middle = 0.5 * (from + to);
        if (f(middle) < 0.0) == sign {
            to = middle;
        } else {
            from = middle;
        }
    }
    to
}

/// Where a function with one dip is least.
fn least(f: &impl Fn(f64) -> f64, mut from: f64, mut to: f64) -> f64 {
    for _ in 0..60 {
        let third = (to - from) / 3.0;
        if f(from + third) < f(to - third) {
            to -= third;
        } else {
            from += third;
        }
    }
    0.5 * (from + to)
}

/// How a picture differs from the reference.
#[derive(Debug, Default)]
struct Difference {
    /// Pixels at the outline.
    n_outline: usize,
    /// Pixels that the surface covers and the picture does not.
    n_holes: usize,
    /// Pixels that the picture covers and the surface does not.
    n_strays: usize,
    /// Mean angle between normals, in degrees, without sign.
    angle: f64,
    /// Largest difference of depths among the 99.9 % best, in voxels.
    depth: f64,
}

fn compare(reference: &Reference, shade: Shade, pixels: u32) -> Difference {
    let case = Case::new(reference, shade, pixels);
    let n = case.frame.depth.len();
    let hits: Vec<Option<f64>> =
        (0..n).into_par_iter().map(|pixel| case.hit(case.ray(pixel, DVec2::ZERO))).collect();
    let mut difference = Difference::default();
    let (mut angles, mut depths) = (Vec::new(), Vec::new());
    let width = pixels as usize;
    for (pixel, hit) in hits.iter().enumerate() {
        let is_shown = case.frame.depth[pixel] != Frame::FAR;
        let neighbours = [pixel.checked_sub(1), pixel.checked_sub(width)];
        let neighbours = neighbours.into_iter().flatten().chain([pixel + 1, pixel + width]);
        let is_outline =
            neighbours.filter_map(|i| hits.get(i)).any(|other| other.is_some() != hit.is_some());
        difference.n_outline += usize::from(is_outline);
        match hit {
            Some(depth) if is_shown => {
                let (origin, direction) = case.ray(pixel, DVec2::ZERO);
                let normal = DVec3::from_array(case.frame.normal[pixel].map(f64::from));
                let expected = case.normal(origin + *depth * direction);
                let off = (depth - f64::from(case.frame.depth[pixel])).abs();
                depths.push(off * direction.length() / (STEPS * case.step));
                let sine = normal.cross(expected).length();
                angles.push(libm::asin(sine.min(1.0)).to_degrees());
            }
            Some(_) if !case.is_tangent(pixel, true) => difference.n_holes += 1,
            None if is_shown && !case.is_tangent(pixel, false) => difference.n_strays += 1,
            _ => {}
        }
    }
    difference.angle = angles.iter().sum::<f64>() / angles.len() as f64;
    depths.sort_by(f64::total_cmp);
    difference.depth = depths[depths.len() * 999 / 1000];
    difference
}

fn check(shade: Shade, pixels: u32, angle: f64) {
    for reference in &REFERENCES {
        let found = compare(reference, shade, pixels);
        println!("{:14} {shade:?} {found:?}", reference.name);
        let name = reference.name;
        assert_eq!(found.n_holes, 0, "{name}");
        assert!(found.n_strays as f64 <= 0.001 * found.n_outline as f64, "{name}: {found:?}");
        assert!(found.angle < angle, "{name}: {found:?}");
    }
}

#[test]
fn refined_pictures_are_those_of_a_ray_caster() {
    check(Shade::Refine, 160, 0.5);
}

#[test]
fn voxels_cover_what_the_surface_covers() {
    check(Shade::Voxel, 160, 3.0);
}

/// Some minutes: `cargo test --release --test reference -- --ignored --nocapture`
#[test]
#[ignore = "takes some minutes"]
fn large_pictures_are_those_of_a_ray_caster() {
    check(Shade::Refine, 1024, 0.5);
    check(Shade::Voxel, 1024, 3.0);
}
