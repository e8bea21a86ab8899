//! What a picture shows: view, image, material.

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

/// Size and background of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageSettings {
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
    /// Linear-light red, green, blue; transparent where `None`.
    pub background: Option<[f32; 3]>,
}

/// How a surface looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Linear-light red, green, blue of diffuse reflection, in [0, 1].
    pub color: [f32; 3],
    /// Strength of the highlight, in [0, 1].
    pub specular: f32,
    /// Exponent of the highlight, at least 1.
    pub shininess: u32,
}
