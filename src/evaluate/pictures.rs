//! Isosurfaces from one point of view, plain or coloured by error.
//!
//! *Based on:* A. León Salas, 2008, section 3.9 (from blue, where there is no error, to red).

use glam::DVec3;

use super::surface::Surface;
use crate::{
    Result,
    math::{SimdLevel, linear_from_srgb},
    polygons::Polygons,
    progress::Progress,
    raster::{
        self, Camera, Contents, Drawn, Frame, ImageSettings, Material, Model, Placement,
        Projection, Shade, View,
    },
};

/// Edge of a picture in pixels.
const SIZE_PX: u32 = 420;

/// The colour of all, if errors are not shown.
const PLAIN: [f32; 3] = [0.55, 0.52, 0.44];
/// Where there is no measure.
const UNKNOWN: [f32; 3] = [0.5, 0.5, 0.5];

/// A surface to draw, with errors that colours tell: those of `most` and above are red.
#[derive(Clone, Copy, Debug)]
pub(super) struct Colors<'a> {
    /// One for each vertex; NaN where there is none.
    pub(super) errors: &'a [f64],
    /// The largest error with a colour of its own.
    pub(super) most: f64,
}

/// Draws surfaces, all as the first one is seen when it fits.
///
/// # Errors
/// [`crate::Error::Interrupted`] if `progress` asks to stop.
pub(super) fn draw(
    surfaces: &[(&Surface, Option<Colors<'_>>)],
    progress: &dyn Progress,
) -> Result<Vec<Frame>> {
    let view = View {
        projection: Projection::Perspective { fov_degrees: 35.0 },
        placement: Placement::Fit { direction: DVec3::new(1.0, -1.7, 0.9), margin: 0.04 },
        up: DVec3::Z,
    };
    let image = ImageSettings {
        width: SIZE_PX,
        height: SIZE_PX,
        background: Some([1.0; 3]),
        lights: Vec::new(),
        shadows: false,
        occlusion: 0.0,
        matcap: None,
        shade: Shade::Refine,
        samples: 2,
        candidates: true,
        certificate: false,
        curvature: false,
    };
    let mut camera = None;
    let mut frames = Vec::new();
    for &(surface, colors) in surfaces {
        if surface.triangles.is_empty() {
            frames.push(Frame::filled(SIZE_PX, SIZE_PX, [1.0; 4]));
            continue;
        }
        let models = [model(surface, colors)];
        let drawn = Drawn { models: &models, ..Drawn::default() };
        let camera = camera.get_or_insert_with(|| Camera::new(&view, image.aspect(), &drawn));
        let simd = SimdLevel::detect();
        let contents = Contents { models: &models, ..Contents::default() };
        frames.push(raster::render(&contents, camera, &image, simd, progress)?.0);
    }
    Ok(frames)
}

fn model(surface: &Surface, colors: Option<Colors<'_>>) -> Model {
    let normals = |&corners: &[u32; 3]| corners.map(|v| surface.normals[v as usize]);
    let of_vertices = |Colors { errors, most }| errors.iter().map(|&e| color(e, most)).collect();
    let polygons = Polygons {
        positions: surface.positions.clone(),
        triangles: surface.triangles.clone(),
        normals: surface.triangles.iter().map(normals).collect(),
        colors: colors.map(of_vertices).unwrap_or_default(),
    };
    let color = if colors.is_some() { [1.0; 3] } else { PLAIN };
    let material = Material { color, back_color: None, specular: 0.15, shininess: 32 };
    Model { name: String::new(), polygons, material }
}

/// From blue to red, as linear light.
fn color(error: f64, most: f64) -> [f32; 3] {
    if error.is_nan() {
        return UNKNOWN;
    }
    let part = (error.abs() / most).min(1.0);
    [0.1 + 0.8 * part, 0.1, 0.9 - 0.8 * part].map(|component| linear_from_srgb(component) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_go_from_blue_to_red() {
        let [none, all, unknown] = [0.0, -2.0, f64::NAN].map(|error| color(error, 1.0));
        assert!(none[2] > none[0] && all[0] > all[2]);
        assert_eq!((none[0], none[2]), (all[2], all[0]));
        assert_eq!(unknown, UNKNOWN);
    }
}
