//! Second pass: every pixel is lit once, from the normal of the voxel that it shows.

use rayon::prelude::*;

use super::{
    Frame, ImageSettings, Layer, Material, Shade,
    light::Lights,
    resolve::{Candidate, Voxels},
    screen::Screen,
    zbuffer::ZBuffer,
};
use crate::{Error, Result, progress::Progress};

/// Lights all pixels.
pub(super) fn shade(
    layers: &[Layer<'_>],
    screen: &Screen,
    zbuffer: &ZBuffer,
    image: &ImageSettings,
    progress: &dyn Progress,
) -> Result<Frame> {
    let voxels = Voxels::new(layers);
    let lights = Lights::new(&image.lights, screen);
    let empty = image.background.map_or([0.0; 4], |[r, g, b]| [r, g, b, 1.0]);
    let mut frame = Frame::filled(screen.width as u32, screen.height as u32, empty);
    let width = screen.width.max(1);
    progress.begin("shade", screen.height as u64, "rows");
    frame
        .rgba
        .par_chunks_mut(width)
        .zip(frame.depth.par_chunks_mut(width))
        .zip(frame.normal.par_chunks_mut(width))
        .zip(frame.position.par_chunks_mut(width))
        .enumerate()
        .try_for_each(|(row, (((rgba, depth), normal), position))| {
            if progress.is_cancelled() {
                return Err(Error::Interrupted);
            }
            for column in 0..rgba.len() {
                let pixel = row * width + column;
                let ray = screen.ray(column, row);
                let (met, covered) = (zbuffer.met.get(pixel), zbuffer.covered.get(pixel));
                if let Some(hit) = voxels.shown(&ray, met, covered) {
                    let point = screen.eye + ray.at(hit.depth);
                    let material = material(&hit, image.shade);
                    rgba[column] = lights.reflected(&material, hit.normal, &ray);
                    depth[column] = hit.depth as f32;
                    normal[column] = hit.normal.as_vec3().to_array();
                    position[column] = point.as_vec3().to_array();
                }
            }
            progress.advance(1);
            Ok(())
        })?;
    progress.end();
    Ok(frame)
}

/// Green and red that differ in brightness too.
const CERTIFIED: [f32; 3] = [0.15, 0.55, 0.2];
const CANDIDATE: [f32; 3] = [0.75, 0.08, 0.04];

/// What a hit looks like.
fn material(hit: &Candidate<'_>, shade: Shade) -> Material {
    match shade {
        Shade::Material => hit.layer.material,
        Shade::Status => {
            let color = if hit.certified { CERTIFIED } else { CANDIDATE };
            Material { color, back_color: color, ..hit.layer.material }
        }
    }
}
