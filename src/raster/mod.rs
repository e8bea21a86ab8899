//! Voxels to pictures, tile by tile.
//!
//! The picture is cut into tiles, and each is drawn by one thread, from the blocks of voxels that it
//! may show, the nearest first (`tile`). What a sample shows is found by `paint`: its ray goes
//! through the voxels to the surface itself (`walk`, `trace`), or the voxels are drawn into a
//! z-buffer, each a small cube that is projected by itself, like a point (`splat`, `zbuffer`,
//! `resolve`). Polygon models come after them (`triangles`), and solids that are given by samples
//! (`solids`): rays through the cells between these. Then samples get their colours (`color`) and
//! their light (`shadow`, `occlusion`, `light`, `matcap`), and become pixels (`shade`).
//!
//! The picture is the same bits for any number of threads.
//!
//! *Based on:* N. Stolte, A. Kaufman, "Parallel Spatial Enumeration of Implicit Surfaces Using
//! Interval Arithmetic for Octree Generation and Its Direct Visualization", 1998, section 5
//! (voxels drawn as points, beside polygons in one z-buffer); M. Schütz, B. Kerbl, M. Wimmer,
//! "Rendering Point Clouds with Compute Shaders and Vertex Order Optimization", Computer Graphics
//! Forum 2021 (a z-buffer of 64-bit integers, depth above identity).

mod block;
mod camera;
mod color;
mod cubic;
mod digest;
mod field;
mod film;
mod fit;
mod frame;
mod layer;
mod light;
mod matcap;
#[cfg(test)]
mod mock;
mod motion;
mod occlusion;
mod paint;
mod path;
mod pierce;
mod resolve;
mod roots;
mod screen;
mod settings;
mod shade;
mod shadow;
mod sight;
mod solids;
#[cfg(test)]
mod solids_tests;
mod splat;
mod sweep;
#[cfg(test)]
mod tests;
mod tile;
mod trace;
mod triangles;
mod walk;
mod zbuffer;

pub use block::OnDemandCount;
pub use camera::Camera;
pub use digest::{FrameDigest, PlaneDigest};
pub use field::{Field, Solid};
pub use fit::Content;
pub use frame::Frame;
pub use layer::{Drawn, Layer, Source};
pub use matcap::Matcap;
pub use motion::{Motion, time};
pub use path::Path;
pub use settings::{
    Axes, ColorMap, Coloring, ImageSettings, Light, Material, Palette, Placement, Projection,
    Quantity, Shade, View,
};

pub use triangles::Model;

use crate::{Result, math::SimdLevel, progress::Progress};

/// All that a picture shows.
#[derive(Clone, Copy, Debug, Default)]
pub struct Contents<'a> {
    /// Surfaces.
    pub layers: &'a [Layer<'a>],
    /// Polygon models.
    pub models: &'a [Model],
    /// Solids that are given by samples.
    pub solids: &'a [Solid<'a>],
}

/// Draws `contents` as `camera` sees them.
///
/// The camera must have been made for the picture's aspect, or the picture is stretched.
///
/// Also tells what was found of layers whose voxels are found on demand.
///
/// # Errors
/// [`crate::Error::Interrupted`] if `progress` asks to stop; [`crate::Error::Limit`] if a tile shows
/// more than 131072 blocks of voxels, unless rays are followed.
pub fn render(
    contents: &Contents<'_>,
    camera: &Camera,
    image: &ImageSettings,
    simd: SimdLevel,
    progress: &dyn Progress,
) -> Result<(Frame, OnDemandCount)> {
    shade::shade(contents, camera, image, simd, progress)
}
