//! Voxels to pictures: every voxel is a small cube that is projected by itself, like a point.
//!
//! A picture is made in two passes. The first writes voxels into a z-buffer (`splat`, `zbuffer`):
//! a voxel reaches every pixel whose centre ray meets its cube, so a surface that lies in the
//! union of its voxels has no holes. The second looks at every pixel once, chooses the voxel that
//! it shows (`resolve`) and lights it (`shade`, `light`).
//!
//! Both passes run on all threads, and the picture is the same bits for any number of them.
//!
//! *Based on:* N. Stolte, A. Kaufman, "Parallel Spatial Enumeration of Implicit Surfaces Using
//! Interval Arithmetic for Octree Generation and Its Direct Visualization", 1998, section 5
//! (voxels drawn as points); M. Schütz, B. Kerbl, M. Wimmer, "Rendering Point Clouds with Compute
//! Shaders and Vertex Order Optimization", Computer Graphics Forum 2021 (a z-buffer of 64-bit
//! integers, depth above identity, filled by atomic minima).

mod camera;
mod digest;
mod fit;
mod frame;
mod layer;
mod light;
#[cfg(test)]
mod mock;
mod paint;
mod resolve;
mod screen;
mod settings;
mod shade;
mod splat;
#[cfg(test)]
mod tests;
mod tile;
mod trace;
mod walk;
mod zbuffer;

pub use camera::Camera;
pub use digest::{FrameDigest, PlaneDigest};
pub use fit::Content;
pub use frame::Frame;
pub use layer::Layer;
pub use settings::{Axes, ImageSettings, Light, Material, Placement, Projection, Shade, View};

use crate::{Result, math::SimdLevel, progress::Progress};
use screen::Screen;

/// Draws `layers` as `camera` sees them.
///
/// The camera must have been made for the picture's aspect, or the picture is stretched.
///
/// # Errors
/// [`crate::Error::Interrupted`] if `progress` asks to stop.
///
/// # Panics
/// If the layers hold 2^32 voxels or more together.
pub fn render(
    layers: &[Layer<'_>],
    camera: &Camera,
    image: &ImageSettings,
    simd: SimdLevel,
    progress: &dyn Progress,
) -> Result<Frame> {
    let screen = Screen::new(camera, image.width, image.height, image.samples);
    shade::shade(layers, &screen, image, simd, progress)
}
