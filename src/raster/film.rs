//! Cameras that show the same content in all frames of a film, fitted to it once.
//!
//! A camera that fitted each frame by itself would tremble. Here all frames look at one point from
//! one distance, so that only the direction changes. The point is in the middle of the content; up
//! and down it lies where the content leaves equal room above and below, over all frames.

use glam::{DVec2, DVec3};

use super::{
    Camera, Content, Placement, Projection, View,
    camera::{Basis, filled_part, half_size, unit},
    fit::Extents,
};

impl Camera {
    /// The cameras of a film, as [`Camera::new`] sets up each; but those that are fitted look at
    /// one point from one distance.
    ///
    /// `views` must be of one kind, projection and `up`, as [`super::Motion::views`] gives them.
    ///
    /// # Panics
    /// As [`Camera::new`].
    #[must_use]
    pub fn of_film(views: &[View], aspect: f64, content: &(impl Content + ?Sized)) -> Vec<Self> {
        let Some(first) = views.first() else { return Vec::new() };
        let margin = match first.placement {
            Placement::Fit { margin, .. } if views.iter().any(|view| view != first) => margin,
            Placement::Fit { .. } => {
                return vec![Self::new(first, aspect, content); views.len()];
            }
            Placement::LookAt { .. } => {
                return views.iter().map(|view| Self::new(view, aspect, content)).collect();
            }
        };
        let bases: Vec<Basis> = views.iter().map(Basis::of).collect();
        let filled = filled_part(margin, aspect);
        match first.projection {
            Projection::Perspective { fov_degrees } => {
                let half_size = half_size(fov_degrees, aspect);
                let seen = Seen::new(&bases, first.up, half_size * filled, content);
                let distance = seen.distance(half_size * filled);
                let camera = |basis: &Basis| {
                    let eye = seen.middle - distance * basis.forward;
                    Self { basis: *basis, eye, half_size, is_parallel: false }
                };
                bases.iter().map(camera).collect()
            }
            Projection::Orthographic { height } => {
                let seen = Seen::new(&bases, first.up, DVec2::ZERO, content);
                let room = seen.across() / filled;
                let half_height = height.map_or(room.y.max(room.x / aspect), |height| 0.5 * height);
                let half_size = DVec2::new(aspect * half_height, half_height);
                let in_front = |basis: &Basis| {
                    let middle = basis.forward.dot(seen.middle);
                    middle - Extents::of(content, basis).depth_in_front()
                };
                let distance = bases.iter().map(in_front).fold(f64::NEG_INFINITY, f64::max);
                let camera = |basis: &Basis| {
                    let eye = seen.middle - distance * basis.forward;
                    Self { basis: *basis, eye, half_size, is_parallel: true }
                };
                bases.iter().map(camera).collect()
            }
        }
    }
}

/// How far the content reaches in all frames, from the point that all look at.
struct Seen {
    middle: DVec3,
    /// To the borders of the picture as far as they may be filled: along `right`, `-right`, `up`
    /// and `-up`, each less the slope of the border times `forward`, and along `-forward`.
    reach: [f64; 5],
}

impl Seen {
    /// `slope` holds the tangents of the half angles, across and up, that the content may fill.
    fn new(bases: &[Basis], up: DVec3, slope: DVec2, content: &(impl Content + ?Sized)) -> Self {
        let axis = unit(up);
        let across = bases[0].right;
        let along = axis.cross(across);
        let [x1, x0, y1, y0] = content.reach([across, -across, along, -along]);
        let beside = 0.5 * ((x1 - x0) * across + (y1 - y0) * along);
        let mut reach = [f64::NEG_INFINITY; 5];
        for Basis { right, up, forward } in bases.iter().copied() {
            let (x, y) = (slope.x * forward, slope.y * forward);
            let directions = [right - x, -right - x, up - y, -up - y, -forward];
            let of_frame = content.reach(directions);
            for (reach, (of_frame, direction)) in
                reach.iter_mut().zip(of_frame.into_iter().zip(directions))
            {
                *reach = reach.max(of_frame - direction.dot(beside));
            }
        }
        // Moving the point up by h takes h times this from the reach above and adds it below; the
        // slopes' parts are the same on both sides.
        let rise = bases[0].up.dot(axis);
        let height = 0.5 * (reach[2] - reach[3]) / rise;
        let sink = bases[0].forward.dot(axis) * height;
        reach[0] += slope.x * sink;
        reach[1] += slope.x * sink;
        reach[2] += slope.y * sink - height * rise;
        reach[3] += slope.y * sink + height * rise;
        reach[4] += sink;
        assert!(reach.iter().all(|r| r.is_finite()), "a camera needs content to be fitted to");
        Self { middle: beside + height * axis, reach }
    }

    /// Half the width and height of the content.
    fn across(&self) -> DVec2 {
        let [a, b, c, d, _] = self.reach;
        DVec2::new(a.max(b), c.max(d))
    }

    /// From how far away everything is in the picture.
    fn distance(&self, slope: DVec2) -> f64 {
        let across = self.across() / slope;
        across.x.max(across.y).max(self.reach[4])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{math::Aabb, raster::Motion};
    use proptest::prelude::*;

    fn corners(b: &Aabb) -> [DVec3; 8] {
        std::array::from_fn(|k| {
            let end = |axis: usize| if k >> axis & 1 == 0 { b.min[axis] } else { b.max[axis] };
            DVec3::new(end(0), end(1), end(2))
        })
    }

    proptest! {
        /// In no frame anything is cut off, and nearer it would be in some frame.
        #[test]
        fn a_turntable_shows_all_from_one_distance(
            boxes in prop::collection::vec((
                [-3.0..3.0_f64, -3.0..3.0, -3.0..3.0], [0.01..2.0_f64, 0.01..2.0, 0.01..2.0],
            ), 1..5),
            direction in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0],
            up in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0],
            aspect in 0.3..3.0_f64, margin in 0.0..0.4_f64, is_parallel: bool,
            n_frames in 2_u32..9,
        ) {
            let boxes: Vec<Aabb> = boxes.into_iter().map(|(min, size)| {
                let min = DVec3::from_array(min);
                Aabb { min, max: min + DVec3::from_array(size) }
            }).collect();
            let (direction, up) = (DVec3::from_array(direction), DVec3::from_array(up));
            prop_assume!(direction.cross(up).length() > 0.1);
            let projection = match is_parallel {
                true => Projection::Orthographic { height: None },
                false => Projection::Perspective { fov_degrees: 30.0 },
            };
            let view = View { projection, placement: Placement::Fit { direction, margin }, up };
            let views = Motion::Turn { degrees: 360.0 }.views(&view, n_frames);
            let cameras = Camera::of_film(&views, aspect, boxes.as_slice());
            let mut least = f64::INFINITY;
            let mut above_and_below = DVec2::INFINITY;
            for camera in &cameras {
                for p in boxes.iter().flat_map(corners) {
                    let at = camera.picture_from_world(p);
                    prop_assert!(camera.view_from_world(p).z > 0.0);
                    let side = DVec2::new(aspect, 1.0) / aspect.min(1.0);
                    let room = (DVec2::ONE - at.abs()) * side - 2.0 * margin;
                    least = least.min(room.min_element());
                    above_and_below =
                        above_and_below.min(DVec2::new(1.0 - at.y, 1.0 + at.y));
                }
            }
            prop_assert!(least.abs() < 1e-9, "{least}");
            let DVec2 { x: above, y: below } = above_and_below;
            prop_assert!(!is_parallel || (above - below).abs() < 1e-9, "{above} {below}");
            // All look at one point from one distance.
            let axis = up.normalize();
            let off = |camera: &Camera| {
                let [eye, first] = [camera, &cameras[0]].map(|camera| camera.eye());
                (eye - first).dot(axis).abs()
            };
            prop_assert!(cameras.iter().all(|camera| off(camera) < 1e-9));
        }
    }
}
