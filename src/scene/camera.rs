//! The camera: which keys belong together, and views that cannot be.

use glam::DVec3;

use super::{
    leaf::Numbers,
    lower::Lower,
    spanned::Spanned,
    spec::{CameraSpec, ProjectionSpec, Section},
};
use crate::{
    diagnostic::Diagnostic,
    raster::{Placement, Projection, View},
};

const DEFAULT_FOV_DEGREES: f64 = 35.0;
const DEFAULT_MARGIN: f64 = 0.05;

/// A three-quarter view, somewhat from above.
const DEFAULT_DIRECTION: DVec3 = DVec3::new(1.0, -1.7, 0.9);

/// Sine of the smallest angle between `up` and the line of sight.
const MIN_UP_SINE: f64 = 1e-6;

impl Lower<'_> {
    pub(super) fn view(&mut self, section: &Section<CameraSpec>) -> View {
        let spec = &section.spec;
        let projection = self.projection(spec);
        let placement = self.placement(spec, section.is_damaged);
        let sight = match placement {
            Placement::Fit { direction, .. } => direction,
            Placement::LookAt { eye, target } => eye - target,
        };
        let up = match &spec.up {
            Some(up) => self.up(up, sight),
            None if parallel(DVec3::Z, sight) => DVec3::Y,
            None => DVec3::Z,
        };
        View { projection, placement, up }
    }

    fn projection(&mut self, spec: &CameraSpec) -> Projection {
        match spec.projection.unwrap_or_default() {
            ProjectionSpec::Perspective => {
                if let Some(height) = &spec.height {
                    self.conflict(
                        height,
                        "`height` is for orthographic cameras",
                        "write `fov` for \
                        a perspective camera, or add projection = \"orthographic\"",
                    );
                }
                let fov = self.number("fov", spec.fov.as_ref(), 0.1..=179.0, DEFAULT_FOV_DEGREES);
                Projection::Perspective { fov_degrees: fov }
            }
            ProjectionSpec::Orthographic => {
                if let Some(fov) = &spec.fov {
                    self.conflict(
                        fov,
                        "`fov` is for perspective cameras",
                        "write `height` for an \
                        orthographic camera, in scene units",
                    );
                }
                let height = spec.height.as_ref().map(|height| self.positive("height", height));
                Projection::Orthographic { height }
            }
        }
    }

    fn placement(&mut self, spec: &CameraSpec, is_damaged: bool) -> Placement {
        match (&spec.eye, &spec.target) {
            (Some(eye), Some(target)) => self.look_at(spec, eye, target),
            (None, None) => self.fit(spec),
            _ if is_damaged => self.fit(spec),
            (Some(alone), None) => {
                self.conflict(
                    alone,
                    "`eye` stands without `target`",
                    "add `target`, the point \
                    to look at, or write `direction` for a camera that fits what it sees",
                );
                self.fit(spec)
            }
            (None, Some(alone)) => {
                self.conflict(
                    alone,
                    "`target` stands without `eye`",
                    "add `eye`, the place of \
                    the camera",
                );
                self.fit(spec)
            }
        }
    }

    fn fit(&mut self, spec: &CameraSpec) -> Placement {
        let direction = spec.direction.as_ref();
        let direction = direction.map_or(DEFAULT_DIRECTION, |d| self.direction("direction", d));
        let margin = self.number("margin", spec.margin.as_ref(), 0.0..=0.49, DEFAULT_MARGIN);
        Placement::Fit { direction, margin }
    }

    fn look_at(
        &mut self,
        spec: &CameraSpec,
        eye: &Spanned<Numbers<3>>,
        target: &Spanned<Numbers<3>>,
    ) -> Placement {
        const FIXED: &str = "remove it, or remove `eye` and `target`";
        if let Some(direction) = &spec.direction {
            self.conflict(direction, "`direction` is for cameras without `eye`", FIXED);
        }
        if let Some(margin) = &spec.margin {
            self.conflict(margin, "`margin` is for cameras without `eye`", FIXED);
        }
        if eye.get_ref() == target.get_ref() {
            self.conflict(
                target,
                "the camera looks at its own place",
                "`eye` and `target` must \
                differ",
            );
        }
        Placement::LookAt { eye: eye.get_ref().0.into(), target: target.get_ref().0.into() }
    }

    fn up(&mut self, up: &Spanned<Numbers<3>>, sight: DVec3) -> DVec3 {
        let vector = self.direction("up", up);
        if vector != DVec3::ZERO && parallel(vector, sight) {
            self.conflict(
                up,
                "`up` is parallel to the line of sight",
                "choose another direction \
                for the upper edge of the picture",
            );
        }
        vector
    }

    fn conflict<T>(&mut self, at: &Spanned<T>, message: &str, help: &str) {
        self.errors.push(Diagnostic::new(at.span(), message).help(help));
    }
}

/// Whether two vectors point the same or the opposite way; a zero vector has no direction.
pub(super) fn parallel(a: DVec3, b: DVec3) -> bool {
    let sine = a.normalize_or_zero().cross(b.normalize_or_zero()).length();
    a != DVec3::ZERO && b != DVec3::ZERO && sine < MIN_UP_SINE
}
