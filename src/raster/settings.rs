//! What a picture shows: view, image, lights, material.

use glam::DVec3;

/// Where the picture is taken from and through which lens.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The lens.
    pub projection: Projection,
    /// The place.
    pub placement: Placement,
    /// The direction that points up in the picture; not parallel to the viewing direction.
    pub up: DVec3,
}

/// The lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Vertical field of view in degrees, in (0, 180).
    Perspective {
        /// From the lower to the upper edge of the picture.
        fov_degrees: f64,
    },
    /// Parallel rays; height of the picture in scene units, or what fits.
    Orthographic {
        /// From the lower to the upper edge of the picture.
        height: Option<f64>,
    },
}

/// The camera's place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Placement {
    /// As close as shows everything that was found.
    Fit {
        /// From the object to the camera; any length.
        direction: DVec3,
        /// Empty border as a fraction of the picture's smaller side, in [0, 0.5).
        margin: f64,
    },
    /// Fixed by the user.
    LookAt {
        /// The camera.
        eye: DVec3,
        /// The point in the picture's middle.
        target: DVec3,
    },
}

/// Size, background and lights of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageSettings {
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
    /// Linear-light red, green, blue; transparent where `None`.
    pub background: Option<[f32; 3]>,
    /// The scene's lights; the camera's own where there are none.
    pub lights: Vec<Light>,
    /// What stands for the surface in a voxel.
    pub shade: Shade,
    /// Samples along an edge of a pixel, from 1 to 8.
    pub samples: u32,
    /// Whether voxels are drawn that are not certified.
    pub candidates: bool,
    /// Whether curvatures are found.
    pub curvature: bool,
}

impl ImageSettings {
    /// How many times as wide as high the picture is.
    #[must_use]
    pub fn aspect(&self) -> f64 {
        f64::from(self.width) / f64::from(self.height)
    }
}

/// What stands for the surface in a voxel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shade {
    /// The surface itself: where the ray meets it, with its normal there.
    #[default]
    Refine,
    /// The plane through the voxel's centre, with a normal between those of the voxels around.
    Slab,
    /// The same plane, with the voxel's normal: the paper's points, as large as a voxel.
    Voxel,
    /// The voxel's centre, one pixel large: the paper's points.
    GlPoint,
    /// As [`Shade::Voxel`]; green where the surface provably passes through a voxel, red where that is not proven.
    Status,
}

/// A light from far away: the same direction everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Towards the light; any length but zero.
    pub direction: DVec3,
    /// What `direction` is relative to.
    pub axes: Axes,
    /// Linear-light red, green, blue, in [0, 1].
    pub color: [f32; 3],
    /// Brightness; 1 is that of the camera's own light. Not negative.
    pub intensity: f64,
}

/// What a direction is relative to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// The scene's x, y and z.
    Scene,
    /// The picture's right and up, and towards the viewer.
    Camera,
}

/// How a surface looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Linear-light red, green, blue of diffuse reflection, in [0, 1].
    pub color: [f32; 3],
    /// The same for the side where F is negative.
    pub back_color: [f32; 3],
    /// Strength of the highlight, in [0, 1].
    pub specular: f32,
    /// Exponent of the highlight, at least 1.
    pub shininess: u32,
}
