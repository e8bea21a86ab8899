//! The camera: where each point of the picture looks.
//!
//! View axes are right, up and forward; a point's third view coordinate is its depth. A ray is
//! `origin + t * direction` with a direction whose component along the viewing axis is 1, so its
//! parameter t is the depth in perspective and in parallel projection alike.

use glam::{DVec2, DVec3};

use super::{
    Placement, Projection, View,
    fit::{Content, Extents, depth_in_front, fit_perspective},
};

/// Three unit vectors at right angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Basis {
    pub(super) right: DVec3,
    pub(super) up: DVec3,
    pub(super) forward: DVec3,
}

impl Basis {
    /// The axes of a view.
    ///
    /// # Panics
    /// If the view has no direction.
    pub(super) fn of(view: &View) -> Self {
        let forward = match view.placement {
            Placement::Fit { direction, .. } => -direction,
            Placement::LookAt { eye, target } => target - eye,
        };
        Self::looking(forward, view.up)
    }

    /// Looks along `forward`, with `up` as far up in the picture as it goes. Where `up` is
    /// parallel to `forward`, z or else y points up.
    ///
    /// # Panics
    /// If `forward` is zero or not finite.
    fn looking(forward: DVec3, up: DVec3) -> Self {
        let forward = unit(forward);
        assert!(forward.is_finite(), "the camera must look somewhere");
        // Below a millionth of a radian the cross product is mostly rounding. An `up` of zero
        // gives NaN, which is not above it either.
        let right = [up, DVec3::Z, DVec3::Y]
            .map(|up| forward.cross(unit(up)))
            .into_iter()
            .find(|right| right.length() > 1e-6)
            .map_or(DVec3::X, unit);
        Self { right, up: right.cross(forward), forward }
    }

    fn world_from_view(&self, p: DVec3) -> DVec3 {
        p.x * self.right + p.y * self.up + p.z * self.forward
    }

    fn view_from_world(&self, p: DVec3) -> DVec3 {
        DVec3::new(self.right.dot(p), self.up.dot(p), self.forward.dot(p))
    }
}

/// The part of the half width and half height that the margin leaves to the content.
pub(super) fn filled_part(margin: f64, aspect: f64) -> DVec2 {
    1.0 - 2.0 * margin * aspect.min(1.0) / DVec2::new(aspect, 1.0)
}

/// Half width and half height, at depth 1, of what a picture in perspective shows.
pub(super) fn half_size(fov_degrees: f64, aspect: f64) -> DVec2 {
    let slope = libm::tan(0.5 * fov_degrees.to_radians());
    DVec2::new(aspect * slope, slope)
}

/// Normalizes a vector of any length, without overflow on the way.
pub(super) fn unit(v: DVec3) -> DVec3 {
    (v / v.abs().max_element()).normalize()
}

/// A camera at its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    pub(super) basis: Basis,
    pub(super) eye: DVec3,
    /// Half width and half height of what the picture shows: at depth 1 in perspective, at every
    /// depth in parallel projection.
    pub(super) half_size: DVec2,
    pub(super) is_parallel: bool,
}

impl Camera {
    /// Sets up the camera that `view` describes, for pictures `aspect` times as wide as high.
    ///
    /// A fitted camera shows all of `content` as large as the margin lets it. A camera with
    /// parallel rays stands in front of all of `content`, moved back along its axis if need be.
    ///
    /// # Panics
    /// If the camera depends on the content and that is empty, if a direction is zero, or if a
    /// fixed camera looks at its own place. The scene's checks exclude all of them.
    #[must_use]
    pub fn new(view: &View, aspect: f64, content: &(impl Content + ?Sized)) -> Self {
        let basis = Basis::of(view);
        let filled = match view.placement {
            Placement::Fit { margin, .. } => filled_part(margin, aspect),
            Placement::LookAt { .. } => DVec2::ONE,
        };
        match view.projection {
            Projection::Perspective { fov_degrees } => {
                let half_size = half_size(fov_degrees, aspect);
                let eye = match view.placement {
                    Placement::LookAt { eye, .. } => eye,
                    Placement::Fit { .. } => {
                        basis.world_from_view(fit_perspective(content, &basis, half_size * filled))
                    }
                };
                Self { basis, eye, half_size, is_parallel: false }
            }
            Projection::Orthographic { height } => {
                let (eye, half_height) = match (view.placement, height) {
                    // Only how near the content comes matters.
                    (Placement::LookAt { eye, .. }, Some(height)) => {
                        let eye = basis.view_from_world(eye);
                        let [far, near] = content.reach([basis.forward, -basis.forward]);
                        let front = depth_in_front(-near, far);
                        (eye.with_z(eye.z.min(front)), 0.5 * height)
                    }
                    (placement, height) => {
                        let extents = Extents::of(content, &basis);
                        let fitted = 0.5 * (extents.min + extents.max);
                        let eye = match placement {
                            Placement::LookAt { eye, .. } => basis.view_from_world(eye),
                            Placement::Fit { .. } => fitted.with_z(f64::INFINITY),
                        };
                        let eye = eye.with_z(eye.z.min(extents.depth_in_front()));
                        let fitting = || {
                            let room = (extents.max - eye).max(eye - extents.min);
                            let room = room.truncate() / filled;
                            room.y.max(room.x / aspect)
                        };
                        (eye, height.map_or_else(fitting, |height| 0.5 * height))
                    }
                };
                let half_size = DVec2::new(aspect * half_height, half_height);
                Self { basis, eye: basis.world_from_view(eye), half_size, is_parallel: true }
            }
        }
    }

    /// The eye; with parallel rays, the point of the eye plane behind the picture's middle.
    #[must_use]
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// The unit vector from the eye into the picture.
    #[must_use]
    pub fn forward(&self) -> DVec3 {
        self.basis.forward
    }

    /// The ray through a point of the picture, (-1, -1) to (1, 1): where it starts, and the way it
    /// goes for each unit of depth.
    #[must_use]
    pub fn ray(&self, picture: DVec2) -> (DVec3, DVec3) {
        let Basis { right, up, forward } = self.basis;
        let at = picture * self.half_size;
        let across = at.x * right + at.y * up;
        if self.is_parallel { (self.eye + across, forward) } else { (self.eye, forward + across) }
    }

    /// A point in view axes: right, up, depth, from the eye.
    #[must_use]
    pub fn view_from_world(&self, p: DVec3) -> DVec3 {
        self.basis.view_from_world(p - self.eye)
    }

    /// Where a point appears: (-1, -1) is the picture's lower left corner, (1, 1) its upper right
    /// one. Meaningless for points behind the eye.
    #[must_use]
    pub fn picture_from_world(&self, p: DVec3) -> DVec2 {
        let p = self.view_from_world(p);
        let scale = if self.is_parallel { 1.0 } else { p.z };
        p.truncate() / scale / self.half_size
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Aabb;
    use proptest::prelude::*;

    fn fit(projection: Projection, direction: DVec3, up: DVec3, margin: f64) -> View {
        View { projection, placement: Placement::Fit { direction, margin }, up }
    }

    const PERSPECTIVE: Projection = Projection::Perspective { fov_degrees: 30.0 };
    const PARALLEL: Projection = Projection::Orthographic { height: None };

    fn corners(b: &Aabb) -> impl Iterator<Item = DVec3> {
        let (min, max) = (b.min, b.max);
        (0..8).map(move |k| {
            DVec3::new(
                if k & 1 == 0 { min.x } else { max.x },
                if k & 2 == 0 { min.y } else { max.y },
                if k & 4 == 0 { min.z } else { max.z },
            )
        })
    }

    fn boxes() -> impl Strategy<Value = Vec<Aabb>> {
        let one = ([-3.0..3.0_f64, -3.0..3.0, -3.0..3.0], [0.01..2.0_f64, 0.01..2.0, 0.01..2.0])
            .prop_map(|(min, size)| {
                let min = DVec3::from_array(min);
                Aabb { min, max: min + DVec3::from_array(size) }
            });
        prop::collection::vec(one, 1..6)
    }

    proptest! {
        /// Nothing is cut off, and moving closer would cut something off.
        #[test]
        fn fit_is_tight(
            boxes in boxes(), d in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0],
            aspect in 0.3..3.0_f64, margin in 0.0..0.4_f64, is_parallel: bool,
        ) {
            let direction = DVec3::from_array(d);
            prop_assume!(direction.length() > 0.1);
            let projection = if is_parallel { PARALLEL } else { PERSPECTIVE };
            let view = fit(projection, direction, DVec3::Z, margin);
            let camera = Camera::new(&view, aspect, boxes.as_slice());
            let points: Vec<DVec3> = boxes.iter().flat_map(corners).collect();
            let seen = points.iter().map(|&p| camera.picture_from_world(p));
            let (lo, hi) = seen.fold((DVec2::MAX, DVec2::MIN), |(lo, hi), p| (lo.min(p), hi.max(p)));
            // In units of half the picture's smaller side, as the margin is given.
            let side = DVec2::new(aspect, 1.0) / aspect.min(1.0);
            let room = (DVec2::ONE - hi).min(lo + DVec2::ONE) * side - 2.0 * margin;
            prop_assert!(room.min_element().abs() < 1e-9, "{room}");
            prop_assert!(points.iter().all(|&p| camera.view_from_world(p).z > 0.0));
            if is_parallel {
                prop_assert!((lo + hi).abs().max_element() < 1e-9, "centred");
            }
        }
    }

    #[test]
    fn up_may_be_parallel_to_the_view() {
        let unit_box = [Aabb { min: DVec3::ZERO, max: DVec3::ONE }];
        for direction in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE] {
            for up in [direction, -3.0 * direction, DVec3::ZERO, 1e-300 * direction] {
                let camera =
                    Camera::new(&fit(PERSPECTIVE, direction, up, 0.0), 1.0, unit_box.as_slice());
                let Basis { right, up, forward } = camera.basis;
                assert!((right.cross(forward) - up).length() < 1e-12, "{direction} {up}");
                assert!((right.length() - 1.0).abs() < 1e-12);
                assert!((forward + direction.normalize()).length() < 1e-12);
            }
        }
        let from_above = fit(PERSPECTIVE, DVec3::Z, DVec3::Z, 0.0);
        assert_eq!(Camera::new(&from_above, 1.0, unit_box.as_slice()).basis.up, DVec3::Y);
    }

    #[test]
    fn look_at_keeps_the_place_and_needs_no_content() {
        let view = View {
            projection: PERSPECTIVE,
            placement: Placement::LookAt { eye: DVec3::X, target: 3.0 * DVec3::X },
            up: DVec3::Z,
        };
        let nothing: [Aabb; 0] = [];
        let camera = Camera::new(&view, 2.0, nothing.as_slice());
        assert_eq!((camera.eye(), camera.forward()), (DVec3::X, DVec3::X));
        assert_eq!(camera.basis.right, -DVec3::Y);
        let edge = DVec3::new(2.0, 0.0, libm::tan(15.0_f64.to_radians()));
        assert!((camera.picture_from_world(edge).y - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_parallel_camera_stands_in_front_of_everything() {
        let view = View {
            projection: Projection::Orthographic { height: Some(4.0) },
            placement: Placement::LookAt {
                eye: DVec3::splat(0.5),
                target: DVec3::new(0.5, 9.0, 0.5),
            },
            up: DVec3::Z,
        };
        let content = [Aabb { min: DVec3::ZERO, max: DVec3::ONE }];
        let camera = Camera::new(&view, 1.0, content.as_slice());
        assert_eq!(camera.eye(), DVec3::new(0.5, -0.125, 0.5));
        assert_eq!(camera.picture_from_world(DVec3::new(0.5, 7.0, 2.5)), DVec2::Y);
    }
}
