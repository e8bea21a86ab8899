//! Second pass: every pixel is lit once, from the normal of the voxel that it shows.
//!
//! The light comes from the camera. A lamp beside it would show the form better, but not the rim:
//! there the voxels that a picture shows face the viewer or just not, in no order, and both sides
//! of a surface must look alike, so a light that is not the same for a normal and its opposite
//! speckles every outline. Here the light at the rim is: it goes to zero. Away from the rim it is
//! tilted, so that what faces up and left is brighter. The highlight is Blinn's, for a lamp on that
//! side. For the light a normal that points away from the viewer is turned around; the normal layer
//! keeps the outward one.
//!
//! *Based on:* J. Blinn, "Models of Light Reflection for Computer Synthesized Pictures", SIGGRAPH
//! 1977 (the highlight).

use glam::DVec3;
use rayon::prelude::*;

use super::{
    Frame, Layer, Material,
    resolve::Voxels,
    screen::{Ray, Screen},
    zbuffer::ZBuffer,
};
use crate::{Error, Result, progress::Progress};

/// Light that reaches everything.
const AMBIENT: f64 = 0.08;
/// Light from the camera on what faces it.
const DIFFUSE: f64 = 0.80;
/// How much brighter what faces right, up or towards the viewer is.
const TILT: DVec3 = DVec3::new(-0.25, 0.4, 0.0);
/// Where the lamp of the highlight is, from the surface: right, up, towards the viewer.
const LAMP: DVec3 = DVec3::new(-0.4, 0.6, 1.0);

/// Lights all pixels.
pub(super) fn shade(
    layers: &[Layer<'_>],
    screen: &Screen,
    zbuffer: &ZBuffer,
    background: Option<[f32; 3]>,
    progress: &dyn Progress,
) -> Result<Frame> {
    let voxels = Voxels::new(layers);
    let lights = Lights::new(screen);
    let empty = background.map_or([0.0; 4], |[r, g, b]| [r, g, b, 1.0]);
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
                    rgba[column] = lights.reflected(&hit.layer.material, hit.normal, &ray);
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

/// The lights in scene coordinates.
struct Lights {
    tilt: DVec3,
    lamp: DVec3,
}

impl Lights {
    fn new(screen: &Screen) -> Self {
        let world = |v: DVec3| v.x * screen.right + v.y * screen.up - v.z * screen.forward;
        Self { tilt: world(TILT), lamp: world(LAMP).normalize() }
    }

    /// The light that an opaque surface sends back along a ray.
    fn reflected(&self, material: &Material, outward: DVec3, ray: &Ray) -> [f32; 4] {
        let to_viewer = -ray.direction.normalize();
        let n = if outward.dot(to_viewer) < 0.0 { -outward } else { outward };
        let facing = n.dot(to_viewer);
        let matte = AMBIENT + DIFFUSE * facing * (1.0 + n.dot(self.tilt));
        let halfway = (self.lamp + to_viewer).normalize();
        let highlight = power(n.dot(halfway).max(0.0), material.shininess);
        let glossy = f64::from(material.specular) * facing * highlight;
        let [r, g, b] = material.color.map(|c| (f64::from(c) * matte + glossy) as f32);
        [r, g, b, 1.0]
    }
}

/// x to the n by repeated multiplication, the same on every platform.
fn power(x: f64, n: u32) -> f64 {
    let (mut square, mut rest, mut product) = (x, n, 1.0);
    while rest > 0 {
        if rest & 1 == 1 {
            product *= square;
        }
        square *= square;
        rest >>= 1;
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn power_multiplies() {
        assert_eq!(power(3.0, 0), 1.0);
        assert_eq!(power(3.0, 13), 1_594_323.0);
        assert_eq!(power(0.999, u32::MAX), 0.0);
    }

    #[test]
    fn both_sides_look_the_same() {
        let lights = Lights { tilt: 0.3 * DVec3::Y, lamp: DVec3::Z };
        let material = Material { color: [0.8, 0.5, 0.2], specular: 0.5, shininess: 20 };
        let ray = Ray { origin: DVec3::ZERO, direction: DVec3::NEG_Z };
        let n = DVec3::new(0.3, 0.1, 0.9).normalize();
        assert_eq!(lights.reflected(&material, n, &ray), lights.reflected(&material, -n, &ray));
    }
}
