//! Lights: `[[light]]` sections.

use glam::DVec3;

use super::{
    color::linear_from_srgb,
    leaf::Color,
    lower::Lower,
    spec::{AxesSpec, LightSpec, Section},
};
use crate::{
    diagnostic::Diagnostic,
    raster::{Axes, Light},
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
            color: linear_from_srgb(spec.color.unwrap_or(Color([1.0; 3]))),
            intensity,
        }
    }
}
