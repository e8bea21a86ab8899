//! The scene file mirrored as data: its sections and keys, nothing checked beyond types.
//!
//! Every key is optional here; what is missing gets its default, or is missed, in
//! `lower`. The docs of the fields are the reference of the file format.

use std::ops::Range;

use serde::Deserialize;
use toml::Spanned;

use super::leaf::{Background, Color, Number, Numbers, Table, Target, Whole};

/// The only version of the format so far.
pub(super) const VERSION: &str = "1";

/// A scene file without `version`.
#[derive(Debug, Default)]
pub(super) struct SceneSpec {
    /// `[[surface]]`, in the order of the file.
    pub(super) surfaces: Vec<Section<SurfaceSpec>>,
    pub(super) domain: Section<DomainSpec>,
    pub(super) voxels: Section<VoxelsSpec>,
    pub(super) camera: Section<CameraSpec>,
    pub(super) image: Section<ImageSpec>,
    pub(super) output: Section<OutputSpec>,
}

/// A section of the file, or what stands for one that is left out.
#[derive(Debug, Default)]
pub(super) struct Section<T> {
    pub(super) spec: T,
    /// Its header, or the inline table.
    pub(super) span: Range<usize>,
    /// Whether entries were refused and left out of `spec`: then it is no use to complain that
    /// something is missing.
    pub(super) is_damaged: bool,
}

/// `[[surface]]`: what is drawn, either `f` or `blend`.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SurfaceSpec {
    /// For messages and statistics; "surface 1" and so on by default.
    pub(super) name: Option<String>,
    /// The formula; `a = b` is `a - b`.
    pub(super) f: Option<Spanned<String>>,
    /// A blend of spheres.
    pub(super) blend: Option<Spanned<Table<BlendSpec>>>,
    /// The sign of F inside: negative by default for `f`, positive for `blend`.
    pub(super) inside: Option<Inside>,
    /// By default the next of a small palette.
    pub(super) color: Option<Color>,
    /// Strength of the highlight in [0, 1]; 0.3 by default.
    pub(super) specular: Option<Spanned<Number>>,
    /// Exponent of the highlight from 1 to 1000; 32 by default.
    pub(super) shininess: Option<Spanned<Whole>>,
}

/// `blend = { threshold, radius, spheres }`: see [`crate::expr::Expr::blend`].
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BlendSpec {
    /// The value of the sum on the surface, above 0.
    pub(super) threshold: Spanned<Number>,
    /// Where a sphere with `a = 1` ends, above 0.
    pub(super) radius: Spanned<Number>,
    /// Each `[x, y, z, a]`: the centre, and a > 0 that scales the distance to it.
    pub(super) spheres: Spanned<Vec<Spanned<Numbers<4>>>>,
}

/// Which sign of F means inside.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum Inside {
    Negative,
    Positive,
}

/// `[domain]`: the box that is searched.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DomainSpec {
    /// `[-1, -1, -1]` by default.
    pub(super) min: Option<Spanned<Numbers<3>>>,
    /// `[1, 1, 1]` by default.
    pub(super) max: Option<Spanned<Numbers<3>>>,
}

/// `[voxels]`.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct VoxelsSpec {
    /// Voxels along the longest axis of the domain; 512 by default.
    pub(super) resolution: Option<Spanned<Whole>>,
}

/// `[camera]`: a lens, and a place that is fixed (`eye`, `target`) or fitted (`direction`,
/// `margin`).
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraSpec {
    /// Perspective by default.
    pub(super) projection: Option<ProjectionSpec>,
    /// Perspective: the vertical angle of view in degrees; 35 by default.
    pub(super) fov: Option<Spanned<Number>>,
    /// Orthographic: the picture's height in scene units; by default what fits.
    pub(super) height: Option<Spanned<Number>>,
    /// Where the camera is.
    pub(super) eye: Option<Spanned<Numbers<3>>>,
    /// What is in the picture's middle.
    pub(super) target: Option<Spanned<Numbers<3>>>,
    /// From the object to the camera; `[1.0, -1.7, 0.9]` by default.
    pub(super) direction: Option<Spanned<Numbers<3>>>,
    /// The empty border as a fraction of the picture's smaller side, in [0, 0.5); 0.05 by default.
    pub(super) margin: Option<Spanned<Number>>,
    /// What is up in the picture; z by default, or y when looking along z.
    pub(super) up: Option<Spanned<Numbers<3>>>,
}

/// The lens.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum ProjectionSpec {
    #[default]
    Perspective,
    Orthographic,
}

/// `[image]`.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ImageSpec {
    /// In pixels; 1024 by default.
    pub(super) width: Option<Spanned<Whole>>,
    /// In pixels; 1024 by default.
    pub(super) height: Option<Spanned<Whole>>,
    /// A colour or "transparent"; white by default.
    pub(super) background: Option<Background>,
}

/// `[output]`: true, false or the name of a file below the output directory.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OutputSpec {
    /// True by default: NAME.png after the scene file NAME.toml.
    pub(super) png: Option<Spanned<Target>>,
    /// True by default: NAME.exr.
    pub(super) exr: Option<Spanned<Target>>,
}
