//! What a picture shows: view, image, lights, material.

use std::sync::Arc;

use glam::DVec3;

use super::matcap::Matcap;
use crate::expr::Expr;

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
    /// Whether the scene's lights cast shadows.
    pub shadows: bool,
    /// How much darker it is in corners and hollows: from 0, not at all, to 1.
    pub occlusion: f64,
    /// A picture of a ball that stands for all light.
    pub matcap: Option<Arc<Matcap>>,
    /// What stands for the surface in a voxel.
    pub shade: Shade,
    /// Samples along an edge of a pixel, from 1 to 8.
    pub samples: u32,
    /// Whether voxels are drawn that are not certified.
    pub candidates: bool,
    /// Whether it is found of every voxel that shows whether it is certified.
    pub certificate: bool,
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

/// What gives a surface its colour.
#[derive(Clone, Debug, Default)]
pub enum Coloring {
    /// The material.
    #[default]
    Plain,
    /// Red, green and blue are x, y and z in the domain.
    Position,
    /// Red, green and blue are the components of the normal.
    Normal,
    /// Green where the surface provably passes through the voxel, red elsewhere.
    Certificate,
    /// A number, by a palette.
    Mapped(Quantity, ColorMap),
}

/// A number at a point of a surface.
#[derive(Clone, Debug)]
pub enum Quantity {
    /// Mean curvature, positive where the surface bulges outwards.
    Curvature,
    /// F in the middle of the voxel.
    Value,
    /// What a formula says.
    Formula(Expr),
}

/// Which colour a number has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorMap {
    /// The colours.
    pub palette: Palette,
    /// The numbers that have the first colour and the last; from −1 to 1 where `None`, or for
    /// curvature from −10 to 10, divided by the domain's longest edge.
    pub range: Option<[f64; 2]>,
}

/// Colours in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Palette {
    /// Dark blue to yellow; even steps to the eye, as the next three.
    Viridis,
    /// Black to white over red.
    Magma,
    /// Blue to yellow over red.
    Plasma,
    /// As viridis, for all kinds of colour vision.
    Cividis,
    /// Many colours, as a rainbow.
    Turbo,
    /// Blue below the middle, white, red above.
    BlueRed,
    /// Black to white.
    Gray,
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
    /// The same for the side where F is negative; `color` where `None`.
    pub back_color: Option<[f32; 3]>,
    /// Strength of the highlight, in [0, 1].
    pub specular: f32,
    /// Exponent of the highlight, at least 1.
    pub shininess: u32,
}
