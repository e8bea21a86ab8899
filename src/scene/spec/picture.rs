//! Cameras, lights, pictures and films in the scene file.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use super::Section;
use crate::scene::{
    leaf::{Background, Color, Number, Numbers, Whole},
    spanned::Spanned,
};

/// A lens, and a place that is fixed (`eye`, `target`) or fitted (`direction`,
/// `margin`).
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct CameraSpec {
    /// Perspective by default.
    pub(in crate::scene) projection: Option<ProjectionSpec>,
    /// Perspective: the vertical angle of view in degrees; 35 by default.
    #[schemars(range(min = 0.1, max = 179))]
    pub(in crate::scene) fov: Option<Spanned<Number>>,
    /// Orthographic: the picture's height in scene units; by default what fits.
    pub(in crate::scene) height: Option<Spanned<Number>>,
    /// Where the camera is.
    pub(in crate::scene) eye: Option<Spanned<Numbers<3>>>,
    /// What is in the picture's middle.
    pub(in crate::scene) target: Option<Spanned<Numbers<3>>>,
    /// From the object to the camera; `[1.0, -1.7, 0.9]` by default.
    pub(in crate::scene) direction: Option<Spanned<Numbers<3>>>,
    /// The empty border as a fraction of the picture's smaller side, in [0, 0.5); 0.05 by default.
    #[schemars(range(min = 0, max = 0.49))]
    pub(in crate::scene) margin: Option<Spanned<Number>>,
    /// What is up in the picture; z by default, or y when looking along z.
    pub(in crate::scene) up: Option<Spanned<Numbers<3>>>,
}

/// The lens.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(in crate::scene) enum ProjectionSpec {
    #[default]
    Perspective,
    Orthographic,
}

/// A light from far away.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct LightSpec {
    /// Towards the light.
    #[schemars(required)]
    pub(in crate::scene) direction: Option<Spanned<Numbers<3>>>,
    /// What `direction` is relative to; the scene by default.
    pub(in crate::scene) relative_to: Option<AxesSpec>,
    /// White by default.
    pub(in crate::scene) color: Option<Color>,
    /// Brightness from 0 to 1000; 1 by default, as bright as the camera's own light.
    #[schemars(range(min = 0, max = 1000))]
    pub(in crate::scene) intensity: Option<Spanned<Number>>,
}

/// What a direction is relative to.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(in crate::scene) enum AxesSpec {
    /// x, y and z.
    #[default]
    Scene,
    /// Right and up in the picture, and towards the viewer.
    Camera,
}

/// The picture.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct ImageSpec {
    /// In pixels; 1024 by default.
    #[schemars(range(min = 1, max = 16384))]
    pub(in crate::scene) width: Option<Spanned<Whole>>,
    /// In pixels; 1024 by default.
    #[schemars(range(min = 1, max = 16384))]
    pub(in crate::scene) height: Option<Spanned<Whole>>,
    /// A colour or "transparent"; white by default.
    pub(in crate::scene) background: Option<Background>,
    /// What stands for the surface in a voxel; "refine" by default.
    pub(in crate::scene) shade: Option<ShadeSpec>,
    /// Whether the scene's lights cast shadows; false by default.
    pub(in crate::scene) shadows: Option<Spanned<bool>>,
    /// How much darker corners and hollows are, from 0, the default, to 1.
    #[schemars(range(min = 0, max = 1))]
    pub(in crate::scene) occlusion: Option<Spanned<Number>>,
    /// A square PNG picture of a lit ball that stands for all light, relative to the folder of the
    /// scene; surfaces are white by default then.
    pub(in crate::scene) matcap: Option<Spanned<String>>,
    /// Rays through a pixel: 1, 4, 9, 16, 25, 36, 49 or 64; 4 by default.
    #[schemars(range(min = 1, max = 64))]
    pub(in crate::scene) samples: Option<Spanned<Whole>>,
    /// Whether voxels are drawn of which it is not proven that the surface passes through; true by
    /// default.
    pub(in crate::scene) candidates: Option<bool>,
}

/// What stands for the surface in a voxel.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub(in crate::scene) enum ShadeSpec {
    /// The surface itself: exact outlines, exact normals.
    #[default]
    Refine,
    /// A plane in each voxel, with a normal between those of the voxels around.
    Slab,
    /// A plane in each voxel, with the voxel's normal.
    Voxel,
    /// A point in each voxel, one pixel large, with holes in close-ups.
    GlPoint,
    /// As "voxel"; green where the surface provably passes through a voxel, red where that is not proven.
    Status,
}

/// A film: the scene and the camera change from frame to frame.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct AnimationSpec {
    /// How many frames, from 1 to 10000.
    #[schemars(required, range(min = 1, max = 10000))]
    pub(in crate::scene) frames: Option<Spanned<Whole>>,
    /// Degrees by which the camera turns about `up` from the first frame to one after the last;
    /// 360 make a film that can be repeated.
    pub(in crate::scene) turntable: Option<Spanned<Number>>,
    /// Frames a second in the animated PNG file, from 0.1 to 1000; 24 by default.
    #[schemars(range(min = 0.1, max = 1000))]
    pub(in crate::scene) fps: Option<Spanned<Number>>,
    /// Parameters that change: each with its values at even intervals from the first frame to the
    /// last, at least two; between them it changes evenly.
    #[serde(default)]
    pub(in crate::scene) params: Section<BTreeMap<Spanned<String>, Spanned<Vec<Number>>>>,
    /// Places of the camera, at least two, between which it goes smoothly.
    #[serde(default)]
    pub(in crate::scene) key: Vec<Section<KeySpec>>,
}

/// A place of the camera. What is missing is as in `[camera]`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct KeySpec {
    /// When: 0 is the first frame and 1 the last.
    #[schemars(required, range(min = 0, max = 1))]
    pub(in crate::scene) at: Option<Spanned<Number>>,
    /// Where the camera is.
    #[schemars(required)]
    pub(in crate::scene) eye: Option<Spanned<Numbers<3>>>,
    /// What is in the picture's middle.
    #[schemars(required)]
    pub(in crate::scene) target: Option<Spanned<Numbers<3>>>,
    /// Perspective: the vertical angle of view in degrees.
    #[schemars(range(min = 0.1, max = 179))]
    pub(in crate::scene) fov: Option<Spanned<Number>>,
    /// Orthographic: the picture's height in scene units.
    pub(in crate::scene) height: Option<Spanned<Number>>,
}
