//! The picture before it becomes a file: planar buffers, one entry a pixel, rows from the top.

/// A rendered picture with its layers.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Linear-light red, green, blue (premultiplied) and alpha.
    pub rgba: Vec<[f32; 4]>,
    /// Distance from the eye along the viewing direction, in scene units; [`Frame::FAR`] where
    /// there is no surface.
    pub depth: Vec<f32>,
    /// Outward unit normal in scene coordinates; zero where there is no surface.
    pub normal: Vec<[f32; 3]>,
    /// Point of the surface in scene coordinates; zero where there is no surface.
    pub position: Vec<[f32; 3]>,
    /// The number of the surface, from 1, in the scene's order; models are numbered after surfaces.
    /// 0 where there is none.
    pub surface: Vec<f32>,
    /// Mean curvature in 1 / scene units, positive where the surface bulges outwards; 0 where there
    /// is no surface, and on models.
    pub curvature: Vec<f32>,
    /// 1 where the surface provably passes through the voxel, and on models; else 0.
    pub certificate: Vec<f32>,
}

impl Frame {
    /// Depth of the background, as compositors write it.
    pub const FAR: f32 = 1e10;

    /// A picture without any surface, all of one colour.
    #[must_use]
    pub fn filled(width: u32, height: u32, rgba: [f32; 4]) -> Self {
        let mut frame = Self::blank(width, height);
        frame.rgba.fill(rgba);
        frame.depth.fill(Self::FAR);
        frame
    }

    /// Nothing but zeros, which is no picture yet: memory that is never written costs nothing.
    pub(super) fn blank(width: u32, height: u32) -> Self {
        let n = width as usize * height as usize;
        Self {
            width,
            height,
            rgba: vec![[0.0; 4]; n],
            depth: vec![0.0; n],
            normal: vec![[0.0; 3]; n],
            position: vec![[0.0; 3]; n],
            surface: vec![0.0; n],
            curvature: vec![0.0; n],
            certificate: vec![0.0; n],
        }
    }
}
