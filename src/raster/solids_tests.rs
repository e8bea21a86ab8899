//! Solids of samples against slow and obvious pictures: small steps along every ray.

use glam::{DAffine3, DMat3, DVec3};
use proptest::prelude::*;

use super::{
    Camera, Contents, Drawn, Field, Frame, ImageSettings, Light, Material, Placement, Projection,
    Shade, Solid, View, render, screen::Screen,
};
use crate::{math::SimdLevel, progress::Unwatched};

/// Values at points, x fastest.
#[derive(Clone, Debug)]
struct Values {
    size: [u32; 3],
    values: Vec<f32>,
    placing: DAffine3,
    is_capped: bool,
}

impl Values {
    fn of(size: [u32; 3], value: impl Fn(DVec3) -> f64) -> Self {
        let n = size.iter().product::<u32>();
        let at = |i: u32| {
            let p = [i % size[0], i / size[0] % size[1], i / size[0] / size[1]];
            value(DVec3::from_array(p.map(f64::from)) + 0.5) as f32
        };
        let values = (0..n).map(at).collect();
        Self { size, values, placing: DAffine3::IDENTITY, is_capped: false }
    }

    fn point(&self, p: [i64; 3]) -> f64 {
        let [x, y, z] =
            [0, 1, 2].map(|axis| p[axis].clamp(0, i64::from(self.size[axis]) - 1) as u32);
        f64::from(self.values[(x + self.size[0] * (y + self.size[1] * z)) as usize])
    }

    /// Between points, in the grid's own coordinates.
    fn at(&self, p: DVec3) -> f64 {
        let from_first = p - 0.5;
        let (first, part) = (from_first.floor(), from_first - from_first.floor());
        (0..8)
            .map(|c| {
                let step = [c & 1, c >> 1 & 1, c >> 2];
                let weight = |axis: usize| {
                    if step[axis] == 1 { part[axis] } else { 1.0 - part[axis] }
                };
                let corner = [0, 1, 2].map(|axis| first[axis] as i64 + step[axis]);
                weight(0) * weight(1) * weight(2) * self.point(corner)
            })
            .sum()
    }

    fn is_in_box(&self, p: DVec3) -> bool {
        (0..3).all(|axis| p[axis] >= 0.0 && p[axis] <= f64::from(self.size[axis]))
    }
}

impl Field for Values {
    fn size(&self) -> [u32; 3] {
        self.size
    }

    fn placing(&self) -> DAffine3 {
        self.placing
    }

    fn is_capped(&self) -> bool {
        self.is_capped
    }

    fn bricks(&self) -> Vec<[u32; 3]> {
        let [nx, ny, nz] = self.size.map(|n| n.div_ceil(8));
        (0..nx * ny * nz).map(|i| [i % nx, i / nx % ny, i / nx / ny]).collect()
    }

    fn values(&self, first: [u32; 3], end: [u32; 3]) -> Vec<f32> {
        let mut values = Vec::new();
        for z in first[2]..end[2] {
            for y in first[1]..end[1] {
                values.extend(
                    (first[0]..end[0]).map(|x| self.point([x, y, z].map(i64::from)) as f32),
                );
            }
        }
        values
    }
}

const MATERIAL: Material =
    Material { color: [0.8; 3], back_color: None, specular: 0.0, shininess: 30 };

fn image(side: u32) -> ImageSettings {
    ImageSettings { shade: Shade::Refine, ..super::tests::image(side, side) }
}

fn camera(solid: &Solid<'_>, direction: DVec3) -> Camera {
    let projection = Projection::Perspective { fov_degrees: 30.0 };
    let placement = Placement::Fit { direction, margin: 0.05 };
    let view = View { projection, placement, up: DVec3::new(0.1, 0.2, 1.0) };
    let solids = std::slice::from_ref(solid);
    Camera::new(&view, 1.0, &Drawn { solids, ..Drawn::default() })
}

fn drawn(solids: &[Solid<'_>], camera: &Camera, image: &ImageSettings) -> Frame {
    let contents = Contents { solids, ..Contents::default() };
    render(&contents, camera, image, SimdLevel::detect(), &Unwatched).unwrap().0
}

/// The depth at which a ray changes sides for the first time, by steps of a hundredth of a point's
/// distance, if the sides are clear.
fn stepped(values: &Values, screen: &Screen, pixel: (usize, usize)) -> Option<Option<f64>> {
    let inverse = values.placing.inverse();
    let ray = screen.ray(pixel.0, pixel.1);
    let (o, d) = (
        inverse.transform_point3(screen.eye + ray.origin),
        inverse.transform_vector3(ray.direction),
    );
    let step = 0.01 / d.length();
    let reach = (o.length() + DVec3::from_array(values.size.map(f64::from)).length()) / d.length();
    let mut before: Option<f64> = None;
    let mut is_unclear = false;
    for i in 0..(reach / step) as usize {
        let p = o + (i as f64 * step) * d;
        if !values.is_in_box(p) {
            let is_closed = values.is_capped && before.is_some_and(|value| value >= 0.0);
            if is_closed {
                return Some(Some(i as f64 * step));
            }
            before = None;
            continue;
        }
        let value = values.at(p);
        let starts_inside = before.is_none() && values.is_capped && value >= 0.0;
        if starts_inside || before.is_some_and(|before| (before >= 0.0) != (value >= 0.0)) {
            return if is_unclear { None } else { Some(Some(i as f64 * step)) };
        }
        is_unclear |= value.abs() < 0.02;
        before = Some(value);
    }
    if is_unclear { None } else { Some(None) }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Noise, which has surfaces of every kind in nearly all cells.
    #[test]
    fn every_ray_shows_the_first_crossing(
        size in prop::array::uniform3(1_u32..12),
        noise in prop::collection::vec(-1_f32..1.0, 1728),
        direction in prop::array::uniform3(-1_f64..1.0),
        columns in prop::array::uniform9(-0.3_f64..0.3),
        is_capped: bool,
    ) {
        let direction = DVec3::from_array(direction);
        prop_assume!(direction.length() > 0.1 && direction.cross(DVec3::new(0.1, 0.2, 1.0)).length() > 0.1);
        let n = size.iter().product::<u32>() as usize;
        let matrix = DMat3::IDENTITY + DMat3::from_cols_array(&columns);
        prop_assume!(matrix.determinant().abs() > 0.2);
        let placing = DAffine3::from_mat3_translation(matrix, DVec3::new(3.0, -2.0, 1.0));
        let values = Values { size, values: noise[..n].to_vec(), placing, is_capped };
        let solid = Solid::new(&values, MATERIAL);
        prop_assume!(!solid.is_empty());
        let camera = camera(&solid, direction);
        let frame = drawn(std::slice::from_ref(&solid), &camera, &image(12));
        let screen = Screen::new(&camera, 12, 12, 1);
        for i in 0..144 {
            let Some(expected) = stepped(&values, &screen, (i % 12, i / 12)) else { continue };
            let found = f64::from(frame.depth[i]);
            match expected {
                // Rays that graze a corner of the box may pass between two steps.
                None => prop_assert!(frame.rgba[i][3] == 0.0 || !found.is_finite(), "{i}: {found}"),
                Some(depth) => prop_assert!((found - depth).abs() < 0.03, "{i}: {found} {depth}"),
            }
        }
    }
}

/// A ball in an oblique grid, with the exact ball's normals.
#[test]
fn normals_point_outwards() {
    let matrix = DMat3::from_cols(
        DVec3::new(0.11, 0.02, 0.0),
        DVec3::new(0.0, -0.09, 0.01),
        DVec3::new(0.0, 0.0, 0.1),
    );
    let placing = DAffine3::from_mat3_translation(matrix, DVec3::new(-2.2, 1.2, -2.0));
    let ball = |p: DVec3| 1.0 - placing.transform_point3(p).length_squared();
    let values = Values { placing, ..Values::of([40; 3], ball) };
    let solid = Solid::new(&values, MATERIAL);
    let camera = camera(&solid, DVec3::new(1.0, -1.7, 0.8));
    let frame = drawn(std::slice::from_ref(&solid), &camera, &image(64));
    let shown: Vec<usize> = (0..64 * 64).filter(|&i| frame.rgba[i][3] > 0.0).collect();
    assert!(shown.len() > 1500, "{}", shown.len());
    for i in shown {
        let [point, normal] =
            [frame.position[i], frame.normal[i]].map(|v| DVec3::from_array(v.map(f64::from)));
        // What is cut off where the cube of a cell is 0.1 across.
        assert!((point.length() - 1.0).abs() < 5e-3, "{}", point.length());
        assert!(normal.dot(point.normalize()) > 0.999, "{normal} at {point}");
    }
}

/// Half of the box is filled: it has the normals of its faces, and one that was cut.
#[test]
fn caps_are_flat() {
    let values = Values { is_capped: true, ..Values::of([20; 3], |p| 10.3 - p.z) };
    let solid = Solid::new(&values, MATERIAL);
    let bounds = solid.bounds().unwrap();
    assert_eq!([bounds.min.x, bounds.max.y, bounds.min.z], [0.0, 20.0, 0.0]);
    let camera = camera(&solid, DVec3::new(1.0, -1.7, 0.8));
    let frame = drawn(std::slice::from_ref(&solid), &camera, &image(64));
    let mut seen = [0; 3];
    for i in (0..64 * 64).filter(|&i| frame.rgba[i][3] > 0.0) {
        let (point, normal) = (frame.position[i], frame.normal[i]);
        let faces = [point[0] - 20.0, point[1], point[2] - 10.3];
        let axis = (0..3).find(|&axis| faces[axis].abs() < 1e-4).unwrap();
        let outwards = [1.0, -1.0, 1.0][axis];
        assert!((normal[axis] - outwards).abs() < 1e-5, "{normal:?} at {point:?}");
        seen[axis] += 1;
    }
    assert!(seen.iter().all(|&n| n > 50), "{seen:?}");
}

/// A small ball above a large one, under a lamp.
#[test]
fn solids_cast_shadows_on_solids() {
    let two = |p: DVec3| {
        let ball =
            |middle: [f64; 3], radius: f64| radius - (p - DVec3::from_array(middle)).length();
        ball([16.0, 16.0, 8.0], 7.0).max(ball([16.0, 16.0, 24.0], 4.0))
    };
    let values = Values::of([32; 3], two);
    let solid = Solid::new(&values, MATERIAL);
    let camera = camera(&solid, DVec3::new(1.0, -1.7, 0.8));
    let lamp =
        Light { direction: DVec3::Z, intensity: 1.0, color: [1.0; 3], axes: super::Axes::Scene };
    let lit = |shadows| {
        let image = ImageSettings { shadows, lights: vec![lamp], ..image(64) };
        drawn(std::slice::from_ref(&solid), &camera, &image)
    };
    let (with, without) = (lit(true), lit(false));
    let mut n_dark = 0;
    for i in (0..64 * 64).filter(|&i| with.rgba[i][3] > 0.0) {
        let [x, y, z] = with.position[i].map(f64::from);
        let from_axis = DVec3::new(x - 16.0, y - 16.0, 0.0).length();
        let is_dark = with.rgba[i][0] < without.rgba[i][0];
        let is_lit = without.normal[i][2] > 0.1;
        if z < 16.0 && is_lit && from_axis < 3.7 {
            assert!(is_dark, "{x} {y} {z}");
            n_dark += 1;
        }
        if (z > 20.0 && is_lit) || from_axis > 4.3 {
            assert!(!is_dark, "{x} {y} {z}");
        }
    }
    assert!(n_dark > 50, "{n_dark}");
}
