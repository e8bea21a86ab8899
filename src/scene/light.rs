//! Lights: `[[light]]` sections.

use std::sync::Arc;

use glam::DVec3;

use super::{
    color::{WHITE, linear},
    lower::Lower,
    spec::{AxesSpec, ImageSpec, LightSpec, Section},
};
use crate::{
    diagnostic::Diagnostic,
    raster::{Axes, Light, Matcap},
};

/// Every pixel sums over all lights.
const MAX_LIGHTS: usize = 64;

/// So bright that every colour is white.
const MAX_INTENSITY: f64 = 1000.0;

impl Lower<'_> {
    /// The scene's lights; none for the camera's own.
    pub(super) fn lights(&mut self, sections: &[Section<LightSpec>]) -> Vec<Light> {
        if let Some(section) = sections.get(MAX_LIGHTS) {
            self.errors.push(
                Diagnostic::new(section.span.clone(), "the scene has too many lights")
                    .label(format!("there may be {MAX_LIGHTS}")),
            );
        }
        sections.iter().take(MAX_LIGHTS).map(|section| self.light(section)).collect()
    }

    /// Whether the scene's lights cast shadows.
    pub(super) fn shadows(&mut self, spec: &ImageSpec, lights: &[Section<LightSpec>]) -> bool {
        let Some(shadows) = spec.shadows.as_ref().filter(|shadows| *shadows.get_ref()) else {
            return false;
        };
        if lights.is_empty() {
            self.errors.push(
                Diagnostic::new(shadows.span(), "`shadows` stands without a light")
                    .label("the camera's own light throws no shadow that the camera sees")
                    .help("add a light: [[light]] with direction = [1, -1, 2]"),
            );
        }
        true
    }

    /// The picture that stands for all light, if there is one.
    pub(super) fn light_picture(
        &mut self,
        spec: &ImageSpec,
        lights: &[Section<LightSpec>],
    ) -> Option<Arc<Matcap>> {
        let file = spec.matcap.as_ref()?;
        if let Some(light) = lights.first() {
            self.errors.push(
                Diagnostic::new(light.span.clone(), "a light stands beside `matcap`")
                    .label("the picture stands for all light")
                    .help("remove one of them"),
            );
        }
        self.matcap(file)
    }

    fn light(&mut self, section: &Section<LightSpec>) -> Light {
        let spec = &section.spec;
        let direction = match &spec.direction {
            Some(direction) => self.direction("direction", direction),
            None if section.is_damaged => DVec3::Z,
            None => {
                self.errors.push(
                    Diagnostic::new(section.span.clone(), "the light has no direction")
                        .label("no `direction`")
                        .help("add the direction towards the light, as in direction = [1, -1, 2]"),
                );
                DVec3::Z
            }
        };
        let intensity = self.number("intensity", spec.intensity.as_ref(), 0.0..=MAX_INTENSITY, 1.0);
        Light {
            direction,
            axes: match spec.relative_to.unwrap_or_default() {
                AxesSpec::Scene => Axes::Scene,
                AxesSpec::Camera => Axes::Camera,
            },
            color: linear(spec.color.unwrap_or(WHITE)),
            intensity,
        }
    }
}
