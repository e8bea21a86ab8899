//! The pictures against slow and obvious ones.

use glam::DVec3;
use proptest::prelude::*;
use rayon::ThreadPoolBuilder;

use super::{mock::Mock, screen::Screen, *};
use crate::{
    Error,
    math::{Aabb, Lattice, SimdLevel},
    progress::Unwatched,
};

const WHITE: [f32; 3] = [0.8; 3];

pub(super) fn image(width: u32, height: u32) -> ImageSettings {
    ImageSettings {
        width,
        height,
        background: None,
        lights: Vec::new(),
        shadows: false,
        occlusion: 0.0,
        matcap: None,
        shade: Shade::Voxel,
        samples: 1,
        candidates: true,
        certificate: true,
        curvature: false,
    }
}

fn view(projection: Projection, placement: Placement) -> View {
    View { projection, placement, up: DVec3::Z }
}

fn draw(layers: &[Layer<'_>], camera: &Camera, width: u32, height: u32) -> Frame {
    render(
        &Contents { layers, ..Contents::default() },
        camera,
        &image(width, height),
        SimdLevel::detect(),
        &Unwatched,
    )
    .unwrap()
    .0
}

/// Whether the ray from depth `near` on meets a cube: slabs, straight from the book.
fn meets(origin: DVec3, direction: DVec3, center: DVec3, half: f64, near: f64) -> bool {
    let (mut enter, mut leave) = (near, f64::INFINITY);
    for axis in 0..3 {
        let (o, d) = (origin[axis] - center[axis], direction[axis]);
        if d == 0.0 {
            if o.abs() > half {
                return false;
            }
        } else {
            let (a, b) = ((-half - o) / d, (half - o) / d);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
    }
    enter <= leave
}

/// Every pixel whose ray meets a cube is covered, and no other: up to cubes a billionth larger or
/// smaller, between which the answer is a matter of rounding.
fn check_coverage(mock: &Mock, camera: &Camera, width: u32, height: u32) {
    let frame = draw(&[mock.layer(WHITE)], camera, width, height);
    let screen = Screen::new(camera, width, height, 1);
    let size = mock.lattice.voxel_size();
    for row in 0..height as usize {
        for column in 0..width as usize {
            let ray = screen.ray(column, row);
            let any = |half: f64, near: f64| {
                mock.voxels.iter().any(|voxel| {
                    let center = mock.lattice.voxel_center(voxel.ijk);
                    meets(camera.eye() + ray.origin, ray.direction, center, half, near)
                })
            };
            let depth = frame.depth[row * width as usize + column];
            let (near, slack) = (1e-3 * size, 1e-9 * size);
            if depth == Frame::FAR {
                assert!(!any(0.5 * size - slack, near + slack), "hole at {column}, {row}");
            } else {
                assert!(any(0.5 * size + slack, near - slack), "stray at {column}, {row}");
                assert!(f64::from(depth) > 0.999 * near);
            }
        }
    }
}

fn directions() -> impl Strategy<Value = DVec3> {
    [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0]
        .prop_map(DVec3::from_array)
        .prop_filter("a direction", |d| d.length() > 0.1)
}

/// A few voxels anywhere in a lattice of 16 by 10 by 16, with any normals.
fn clouds() -> impl Strategy<Value = Mock> {
    let place = ([0..16_u32, 0..10, 0..16], directions());
    prop::collection::vec(place, 1..40).prop_map(|places| {
        let domain = Aabb { min: DVec3::new(-1.3, -0.8, -1.3), max: DVec3::new(1.3, 0.825, 1.3) };
        Mock::new(Lattice::new(domain, 16), places)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn perspective_coverage_is_exact(
        mock in clouds(), direction in directions(), fov_degrees in 5.0..150.0_f64,
    ) {
        let placement = Placement::Fit { direction, margin: 0.05 };
        let view = view(Projection::Perspective { fov_degrees }, placement);
        check_coverage(&mock, &Camera::new(&view, 1.5, &mock), 48, 32);
    }

    #[test]
    fn coverage_is_exact_from_within(
        mock in clouds(), eye in directions(), look in directions(), fov_degrees in 5.0..150.0_f64,
    ) {
        let placement = Placement::LookAt { eye, target: eye + look };
        let view = view(Projection::Perspective { fov_degrees }, placement);
        check_coverage(&mock, &Camera::new(&view, 1.0, &mock), 33, 33);
    }

    #[test]
    fn parallel_coverage_is_exact(mock in clouds(), direction in directions(), margin in 0.0..0.3) {
        let placement = Placement::Fit { direction, margin };
        let view = view(Projection::Orthographic { height: None }, placement);
        check_coverage(&mock, &Camera::new(&view, 0.8, &mock), 32, 40);
    }

    /// The layers agree with each other: the position is on the pixel's ray, at its depth.
    #[test]
    fn layers_agree(mock in clouds(), direction in directions()) {
        let placement = Placement::Fit { direction, margin: 0.0 };
        let view = view(Projection::Perspective { fov_degrees: 40.0 }, placement);
        let camera = Camera::new(&view, 1.0, &mock);
        let frame = draw(&[mock.layer(WHITE)], &camera, 40, 40);
        for (i, &depth) in frame.depth.iter().enumerate() {
            let (n, p) = (frame.normal[i].map(f64::from), frame.position[i].map(f64::from));
            if depth == Frame::FAR {
                prop_assert_eq!((frame.rgba[i], n, p), ([0.0; 4], [0.0; 3], [0.0; 3]));
                continue;
            }
            let (n, p) = (DVec3::from_array(n), DVec3::from_array(p));
            prop_assert!((n.length() - 1.0).abs() < 1e-6);
            prop_assert!((camera.view_from_world(p).z - f64::from(depth)).abs() < 1e-5);
            let at = 0.5 * (camera.picture_from_world(p) + 1.0) * 40.0;
            let expected = glam::DVec2::new((i % 40) as f64 + 0.5, 39.5 - (i / 40) as f64);
            prop_assert!((at - expected).abs().max_element() < 1e-3);
        }
    }
}

/// Axis-parallel rays along shared faces and edges: the worst case for cracks.
#[test]
fn rays_along_faces_find_no_crack() {
    let lattice = Lattice::new(Aabb { min: DVec3::NEG_ONE, max: DVec3::ONE }, 8);
    let slab = (0..8).flat_map(|x| (0..8).map(move |y| ([x, y, 4], DVec3::Z)));
    let mock = Mock::new(lattice, slab);
    let placement = Placement::Fit { direction: DVec3::Z, margin: 0.0 };
    for n in [7, 8, 9, 16, 17] {
        let view = view(Projection::Orthographic { height: None }, placement);
        let frame = draw(&[mock.layer(WHITE)], &Camera::new(&view, 1.0, &mock), n, n);
        assert!(frame.depth.iter().all(|&d| d != Frame::FAR), "{n}");
    }
}

#[test]
fn a_camera_inside_a_voxel_sees_it_everywhere() {
    let lattice = Lattice::new(Aabb { min: DVec3::NEG_ONE, max: DVec3::ONE }, 5);
    let mock = Mock::new(lattice, [([2; 3], DVec3::X)]);
    let placement = Placement::LookAt { eye: DVec3::splat(0.01), target: DVec3::ONE };
    let view = view(Projection::Perspective { fov_degrees: 170.0 }, placement);
    let frame = draw(&[mock.layer(WHITE)], &Camera::new(&view, 1.0, &mock), 30, 30);
    assert!(frame.depth.iter().all(|&d| d != Frame::FAR));
}

#[test]
fn threads_and_order_do_not_matter() {
    let (mut a, b) = (Mock::sphere(48, 0.9), Mock::sphere(40, 0.88));
    let placement = Placement::Fit { direction: DVec3::new(1.0, -2.0, 0.7), margin: 0.02 };
    let view = view(Projection::Perspective { fov_degrees: 30.0 }, placement);
    let camera = Camera::new(&view, 1.25, &a);
    let mut digests = Vec::new();
    for n_threads in [1, 2, 7] {
        for _ in 0..2 {
            let pool = ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
            let layers = [a.layer(WHITE), b.layer([0.9, 0.2, 0.1])];
            digests.push(pool.install(|| draw(&layers, &camera, 200, 160)).digest());
            // Another order: the odd places, then the even ones.
            let (odd, even) = (a.parts.iter().skip(1).step_by(2), a.parts.iter().step_by(2));
            a.parts = odd.chain(even).copied().collect();
        }
    }
    assert!(digests.iter().all(|digest| *digest == digests[0]));
    assert!(digests[0].n_covered > 10_000);
}

/// Flat sheets, at grazing incidence too, never show a point farther away than cubes reach.
#[test]
fn flat_sheets_are_smooth() {
    for n in [DVec3::new(0.2, 0.1, 1.0), DVec3::new(1.0, 1.0, 1.0), DVec3::new(0.0, 0.3, 1.0)] {
        let n = n.normalize();
        let mock = Mock::surface(40, |p| (n.dot(p), n));
        for slant in [0.05, 0.2, 1.0] {
            let direction = slant * n + n.any_orthonormal_vector();
            let view = view(
                Projection::Perspective { fov_degrees: 20.0 },
                Placement::Fit { direction, margin: 0.0 },
            );
            let camera = Camera::new(&view, 1.0, &mock);
            let frame = draw(&[mock.layer(WHITE)], &camera, 150, 150);
            let limit = (1.0 + 1e-6) * mock.lattice.voxel_size() * n.abs().element_sum();
            for p in frame.position.iter().filter(|p| **p != [0.0; 3]) {
                let off = n.dot(DVec3::from_array(p.map(f64::from))).abs();
                assert!(off < limit, "{off}");
            }
        }
    }
}

/// Where a ray of a pixel meets a sphere around the origin, if it does.
fn sphere_hit(camera: &Camera, screen: &Screen, pixel: usize, radius: f64) -> Option<DVec3> {
    let ray = screen.ray(pixel % screen.width, pixel / screen.width);
    let (o, d) = (camera.eye() + ray.origin, ray.direction);
    let (a, b, c) = (d.dot(d), d.dot(o), o.dot(o) - radius * radius);
    let discriminant = b * b - a * c;
    (discriminant >= 0.0).then(|| o - (b + discriminant.sqrt()) / a * d)
}

/// No speckles: every pixel of a sphere has nearly the normal that it should have, and the point
/// is no farther from the sphere than a voxel's cube reaches.
#[test]
fn a_sphere_is_clean() {
    let radius = 0.9;
    let mock = Mock::sphere(64, radius);
    let diagonal = 3.0_f64.sqrt() * mock.lattice.voxel_size();
    for direction in [DVec3::new(1.0, -2.0, 1.2), DVec3::X, DVec3::new(1.0, 1.0, 0.0)] {
        let placement = Placement::Fit { direction, margin: 0.03 };
        let view = view(Projection::Perspective { fov_degrees: 30.0 }, placement);
        let camera = Camera::new(&view, 1.0, &mock);
        let screen = Screen::new(&camera, 300, 300, 1);
        let frame = draw(&[mock.layer(WHITE)], &camera, 300, 300);
        for pixel in 0..frame.depth.len() {
            let Some(hit) = sphere_hit(&camera, &screen, pixel, radius) else { continue };
            let [n, p] = [&frame.normal, &frame.position]
                .map(|plane| DVec3::from_array(plane[pixel].map(f64::from)));
            let to_eye = (camera.eye() - hit).normalize();
            let (expected, found) = (hit.dot(to_eye) / radius, n.dot(to_eye).abs());
            assert!((p.length() - radius).abs() < 1.1 * diagonal);
            // At the rim a voxel's height is a sixth of all that the cosine runs through.
            let tolerance = if expected > 0.4 { 0.08 } else { 0.25 };
            assert!((expected - found).abs() < tolerance, "{expected} {found} at {pixel}");
        }
    }
}

/// The rim of a nearer surface has no holes through which a farther one shows.
#[test]
fn a_rim_before_another_surface_has_no_holes() {
    let (ball, wall) = (Mock::sphere(48, 0.5), Mock::surface(48, |p| (p.x + 0.8, DVec3::X)));
    let placement = Placement::LookAt { eye: DVec3::new(3.0, 0.3, 0.2), target: DVec3::ZERO };
    let view = view(Projection::Perspective { fov_degrees: 25.0 }, placement);
    let layers = [wall.layer([0.0, 0.0, 1.0]), ball.layer([1.0, 0.0, 0.0])];
    let camera = Camera::new(&view, 1.0, &wall);
    let screen = Screen::new(&camera, 250, 250, 1);
    let frame = draw(&layers, &camera, 250, 250);
    for pixel in 0..frame.depth.len() {
        let is_ball = sphere_hit(&camera, &screen, pixel, 0.5).is_some();
        assert!(!is_ball || frame.depth[pixel] < 3.2, "hole at {pixel}");
        // Out of reach of the cubes of the ball the wall is seen.
        let is_far = sphere_hit(&camera, &screen, pixel, 0.5 + 3.0 / 24.0).is_none();
        assert!(!is_far || frame.depth[pixel] > 3.5, "stray at {pixel}");
    }
}

#[test]
fn a_nearer_surface_hides_a_farther_one() {
    let (near, far) = (Mock::sphere(32, 0.4), Mock::sphere(32, 0.9));
    let placement = Placement::Fit { direction: DVec3::Y, margin: 0.0 };
    let view = view(Projection::Orthographic { height: None }, placement);
    for swap in [false, true] {
        let mut layers = [near.layer([1.0, 0.0, 0.0]), far.layer([0.0, 0.0, 1.0])];
        if swap {
            layers.swap(0, 1);
        }
        let camera = Camera::new(&view, 1.0, &far);
        let frame = draw(&layers, &camera, 64, 64);
        let middle = frame.rgba[32 * 64 + 32];
        assert!(middle[2] > middle[0], "the larger sphere is around the smaller one");
    }
}

#[test]
fn background_and_emptiness() {
    let empty = Mock::new(Lattice::new(Aabb { min: DVec3::ZERO, max: DVec3::ONE }, 4), []);
    let placement = Placement::LookAt { eye: DVec3::X, target: DVec3::ZERO };
    let view = view(Projection::Perspective { fov_degrees: 40.0 }, placement);
    let camera = Camera::new(&view, 1.0, &empty);
    let settings = ImageSettings { background: Some([0.1, 0.2, 0.3]), ..image(4, 4) };
    let layers = [empty.layer(WHITE)];
    let contents = Contents { layers: &layers, ..Contents::default() };
    let drawn = render(&contents, &camera, &settings, SimdLevel::detect(), &Unwatched);
    let (frame, _) = drawn.unwrap();
    assert_eq!(frame, Frame::filled(4, 4, [0.1, 0.2, 0.3, 1.0]));
}

#[test]
fn cancelling_ends_the_run() {
    struct Cancelled;
    impl Progress for Cancelled {
        fn begin(&self, _stage: &str, _total: u64, _unit: &str) {}
        fn advance(&self, _units: u64) {}
        fn end(&self) {}
        fn is_cancelled(&self) -> bool {
            true
        }
    }
    let mock = Mock::sphere(16, 0.5);
    let placement = Placement::Fit { direction: DVec3::X, margin: 0.0 };
    let view = view(Projection::Perspective { fov_degrees: 40.0 }, placement);
    let camera = Camera::new(&view, 1.0, &mock);
    let outcome = render(
        &Contents { layers: &[mock.layer(WHITE)], ..Contents::default() },
        &camera,
        &image(8, 8),
        SimdLevel::detect(),
        &Cancelled,
    );
    assert!(matches!(outcome, Err(Error::Interrupted)));
}
