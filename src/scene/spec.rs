//! The scene file mirrored as data: its sections and keys, nothing checked beyond types.
//!
//! Every key is optional here; what is missing gets its default, or is missed, in
//! `lower`. The docs of the fields are the reference of the file format.

use std::{collections::BTreeMap, ops::Range};

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Deserializer};

use super::{
    definitions::Named,
    leaf::{Background, Color, Detail, Number, Numbers, Table, Target, Whole},
    spanned::Spanned,
};

/// The only version of the format so far.
pub(super) const VERSION: &str = "1";

/// A scene of zeroset: surfaces given by formulas, and how to draw them.
// `version` is missing here: it is looked at before anything else.
#[derive(Debug, Default, JsonSchema)]
#[schemars(deny_unknown_fields)]
#[schemars(extend("anyOf" = [
    { "required": ["surface"] }, { "required": ["volume"] }, { "required": ["sculpture"] },
]))]
pub(super) struct SceneSpec {
    #[schemars(default)]
    pub(super) about: Section<AboutSpec>,
    /// Numbers with names that all formulas may use, each a number or a formula without
    /// coordinates; `--set name=value` overrides them.
    #[schemars(default)]
    pub(super) params: Named,
    /// Expressions with names that all formulas may use.
    #[schemars(rename = "let", default)]
    pub(super) lets: Named,
    /// Shapes with names that other shapes and all formulas may use.
    #[schemars(default)]
    pub(super) shapes: Named,
    /// Files NAME.toml with `[params]`, `[let]` and `[shapes]` that count as if they stood here, relative
    /// to the folder of this one and not outside of it.
    #[schemars(default)]
    pub(super) include: Vec<Spanned<String>>,
    /// What is drawn.
    #[schemars(rename = "surface", default)]
    pub(super) surfaces: Vec<Section<SurfaceSpec>>,
    /// Polygon models that are drawn beside the surfaces.
    #[schemars(rename = "model", default)]
    pub(super) models: Vec<Section<ModelSpec>>,
    /// Sampled volumes, of each of which an isosurface is drawn.
    #[schemars(rename = "volume", default)]
    pub(super) volumes: Vec<Section<VolumeSpec>>,
    /// Solids that tools carve, stroke by stroke.
    #[schemars(rename = "sculpture", default)]
    pub(super) sculptures: Vec<Section<SculptureSpec>>,
    #[schemars(default)]
    pub(super) domain: Section<DomainSpec>,
    #[schemars(default)]
    pub(super) voxels: Section<VoxelsSpec>,
    #[schemars(default)]
    pub(super) camera: Section<CameraSpec>,
    /// The lights; by default one that the camera carries.
    #[schemars(rename = "light", default)]
    pub(super) lights: Vec<Section<LightSpec>>,
    #[schemars(default)]
    pub(super) image: Section<ImageSpec>,
    #[schemars(default)]
    pub(super) output: Section<OutputSpec>,
    /// How surfaces become meshes, for the files of `[output]` that hold them.
    #[schemars(default)]
    pub(super) mesh: Section<MeshSpec>,
    pub(super) animation: Option<Section<AnimationSpec>>,
}

/// A section of the file, or what stands for one that is left out.
#[derive(Clone, Debug, Default)]
pub(super) struct Section<T> {
    pub(super) spec: T,
    /// Its header, or the inline table.
    pub(super) span: Range<usize>,
    /// Whether entries were refused and left out of `spec`: then it is no use to complain that
    /// something is missing.
    pub(super) is_damaged: bool,
}

/// A section within another, without a mistake.
impl<'de, T: Deserialize<'de>> Deserialize<'de> for Section<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let table = toml::Spanned::<Table<T>>::deserialize(deserializer)?;
        let span = table.span();
        Ok(Self { spec: table.into_inner().0, span, is_damaged: false })
    }
}

impl<T: JsonSchema> JsonSchema for Section<T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        T::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        T::json_schema(generator)
    }
}

/// What the scene shows, for people; nothing depends on it.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct AboutSpec {
    /// What it is called; the name of the file by default.
    pub(super) title: Option<String>,
    /// Who found or published it, and when.
    pub(super) source: Option<String>,
    /// What is special about it.
    pub(super) note: Option<String>,
}

/// What is drawn: one of `f`, `shape`, `blend` and `file`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SurfaceSpec {
    /// For messages and statistics; "surface 1" and so on by default.
    pub(super) name: Option<String>,
    /// The formula; `a = b` means a − b = 0, and `a <= b` is a solid.
    pub(super) f: Option<Spanned<String>>,
    /// A shape: solids joined by `|` (union), `&` (intersection) and `-` (difference).
    pub(super) shape: Option<Spanned<String>>,
    /// A blend of spheres.
    pub(super) blend: Option<Spanned<Table<BlendSpec>>>,
    /// A function graph in the text format of libfive and Fidget: the file `NAME.vm`, relative to
    /// the folder of the scene.
    pub(super) file: Option<Spanned<String>>,
    /// The sign of F inside: negative by default for `f` and `file`, positive for `blend`; a
    /// comparison says itself what is inside.
    pub(super) inside: Option<Spanned<Inside>>,
    /// What is kept, as an inequality; the cuts are open. `clip` of `[domain]` applies as well.
    pub(super) clip: Option<Spanned<String>>,
    /// Whether the cuts of clips are closed; by default as `[domain]` says.
    pub(super) cap: Option<Spanned<bool>>,
    /// By default the next of a small palette.
    pub(super) color: Option<Spanned<Color>>,
    /// What the colour tells instead: "position", "normal", "certificate", "curvature", "value" (F in
    /// the middle of the voxel) or a formula. `palette` and `color_range` are for the last three.
    pub(super) color_by: Option<Spanned<String>>,
    /// The colours for numbers; "viridis" by default, "blue-red" for curvature.
    pub(super) palette: Option<Spanned<PaletteSpec>>,
    /// The numbers with the first and the last of these colours; by default [-1, 1], and for
    /// curvature [-10, 10] divided by the longest edge of the domain.
    pub(super) color_range: Option<Spanned<Numbers<2>>>,
    /// The colour seen from inside; by default the same.
    pub(super) back_color: Option<Color>,
    /// Strength of the highlight in [0, 1]; 0.3 by default.
    #[schemars(range(min = 0, max = 1))]
    pub(super) specular: Option<Spanned<Number>>,
    /// Exponent of the highlight from 1 to 1000; 32 by default.
    #[schemars(range(min = 1, max = 1000))]
    pub(super) shininess: Option<Spanned<Whole>>,
}

/// Colours in a row.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum PaletteSpec {
    /// Dark blue to yellow.
    Viridis,
    /// Black to white over red.
    Magma,
    /// Blue to yellow over red.
    Plasma,
    /// As viridis, for all kinds of colour vision.
    Cividis,
    /// Many colours.
    Turbo,
    /// Blue to white to red.
    BlueRed,
    /// Black to white.
    Gray,
}

/// A polygon model. It is scaled, turned and moved, in this order.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ModelSpec {
    /// The file `NAME.obj`, `NAME.gltf` or `NAME.glb`, relative to the folder of the scene.
    #[schemars(required)]
    pub(super) file: Option<Spanned<String>>,
    /// For messages; the file's name by default.
    pub(super) name: Option<String>,
    /// What the colours in the file are multiplied by, white by default; without such colours by
    /// default the next of a small palette.
    pub(super) color: Option<Color>,
    /// The colour seen from inside; by default the same.
    pub(super) back_color: Option<Color>,
    /// Strength of the highlight in [0, 1]; 0.3 by default.
    #[schemars(range(min = 0, max = 1))]
    pub(super) specular: Option<Spanned<Number>>,
    /// Exponent of the highlight from 1 to 1000; 32 by default.
    #[schemars(range(min = 1, max = 1000))]
    pub(super) shininess: Option<Spanned<Whole>>,
    /// The axis that points up in the file, which becomes the scene's z; "y" by default.
    pub(super) up: Option<UpSpec>,
    /// How much larger the model becomes; 1 by default.
    pub(super) scale: Option<Spanned<Number>>,
    /// Degrees by which it is turned about the scene's x, then y, then z.
    pub(super) rotate: Option<Spanned<Numbers<3>>>,
    /// By how much it is moved.
    pub(super) translate: Option<Spanned<Numbers<3>>>,
}

/// A sampled volume, and the isosurface in it. Samples are in the middles of voxels.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct VolumeSpec {
    /// The file, relative to the folder of the scene: NRRD (`.nrrd`, `.nhdr`), MetaImage (`.mha`,
    /// `.mhd`), NIfTI-1 (`.nii`, `.nii.gz`, `.hdr`), or raw samples with `size` and `type`.
    #[schemars(required)]
    pub(super) file: Option<Spanned<String>>,
    /// For messages and meshes; the file's name by default.
    pub(super) name: Option<String>,
    /// What is this large or larger is inside.
    pub(super) isovalue: Option<Spanned<Number>>,
    /// What lies between these two is inside, instead of `isovalue`.
    pub(super) range: Option<Spanned<Numbers<2>>>,
    /// Whether only the largest component of what is inside is kept; false by default.
    pub(super) keep_largest: Option<bool>,
    /// Components with fewer samples are dropped; 1 by default.
    pub(super) min_samples: Option<Spanned<Whole>>,
    /// By how much samples may differ that become one region; 0 by default.
    pub(super) tolerance: Option<Spanned<Number>>,
    /// What is compared with `tolerance`; "range" by default.
    pub(super) criterion: Option<CriterionSpec>,
    /// Whether the isosurface is closed where the volume ends; false by default.
    pub(super) cap: Option<bool>,
    /// Raw samples: how many there are along x, y and z.
    pub(super) size: Option<Spanned<Numbers<3>>>,
    /// Raw samples: their type.
    #[serde(rename = "type")]
    pub(super) sample_type: Option<Spanned<SampleTypeSpec>>,
    /// Raw samples: the order of their bytes; "little" by default.
    pub(super) byte_order: Option<ByteOrderSpec>,
    /// Raw samples: the distances between them along x, y and z; 1 by default.
    pub(super) spacing: Option<Spanned<Numbers<3>>>,
    /// Raw samples: where the first one is in the scene; `[0, 0, 0]` by default.
    pub(super) origin: Option<Spanned<Numbers<3>>>,
    /// Raw samples: how many bytes stand before them; 0 by default.
    pub(super) skip: Option<Spanned<Whole>>,
    /// By default the next of a small palette.
    pub(super) color: Option<Color>,
    /// The colour seen from inside; by default the same.
    pub(super) back_color: Option<Color>,
    /// Strength of the highlight in [0, 1]; 0.3 by default.
    #[schemars(range(min = 0, max = 1))]
    pub(super) specular: Option<Spanned<Number>>,
    /// Exponent of the highlight from 1 to 1000; 32 by default.
    #[schemars(range(min = 1, max = 1000))]
    pub(super) shininess: Option<Spanned<Whole>>,
}

/// A solid on a grid of samples, and the strokes that change it.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SculptureSpec {
    /// For messages and meshes; "sculpture 1" and so on by default.
    pub(super) name: Option<String>,
    /// What it is before the first stroke: F < 0 is solid. By default there is nothing.
    pub(super) f: Option<Spanned<String>>,
    /// Samples along the longest edge of its box, from 8 to 512; 128 by default.
    #[schemars(range(min = 8, max = 512))]
    pub(super) size: Option<Spanned<Whole>>,
    /// The first corner of its box; `[-1, -1, -1]` by default.
    pub(super) min: Option<Spanned<Numbers<3>>>,
    /// The last corner of its box; `[1, 1, 1]` by default.
    pub(super) max: Option<Spanned<Numbers<3>>>,
    /// Whether a film shows one stroke after the other; false by default.
    pub(super) film: Option<bool>,
    /// The strokes, in order.
    #[serde(rename = "stroke", default)]
    pub(super) strokes: Vec<Section<StrokeSpec>>,
    /// By default the next of a small palette.
    pub(super) color: Option<Color>,
    /// The colour seen from inside; by default the same.
    pub(super) back_color: Option<Color>,
    /// Strength of the highlight in [0, 1]; 0.3 by default.
    #[schemars(range(min = 0, max = 1))]
    pub(super) specular: Option<Spanned<Number>>,
    /// Exponent of the highlight from 1 to 1000; 32 by default.
    #[schemars(range(min = 1, max = 1000))]
    pub(super) shininess: Option<Spanned<Whole>>,
}

/// A stroke of a tool.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct StrokeSpec {
    /// What the tool does: "add", "remove", "fill", "cut", "smooth", "twist" or "drag".
    #[serde(rename = "do")]
    #[schemars(required)]
    pub(super) deed: Option<Spanned<DeedSpec>>,
    /// Where it goes: one place or more.
    #[schemars(required)]
    pub(super) at: Option<Spanned<Vec<Numbers<3>>>>,
    /// How it gets from place to place; "points" by default, "line" for drags.
    pub(super) path: Option<PathSpec>,
    /// "ball", "cube", or a formula in radii from the tool's middle with F < 0 inside; "ball" by
    /// default.
    pub(super) tool: Option<Spanned<String>>,
    /// From the tool's middle to its border.
    #[schemars(required)]
    pub(super) radius: Option<Spanned<Number>>,
    /// By how much an addition or removal moves the surface in the tool's middle, in parts of its radius;
    /// more than 4 samples set down a ball or dig a hole of their own. How much is smoothed, in
    /// [0, 1]. 0.5 by default.
    pub(super) strength: Option<Spanned<Number>>,
    /// How the effect falls off from the tool's middle; "smooth" by default.
    pub(super) falloff: Option<FalloffSpec>,
    /// The axis of a twist; `[0, 0, 1]` by default.
    pub(super) axis: Option<Spanned<Numbers<3>>>,
    /// Degrees of a twist in the tool's middle; 90 by default.
    pub(super) angle: Option<Spanned<Number>>,
    /// How often it is done; 1 by default.
    #[schemars(range(min = 1, max = 1000))]
    pub(super) times: Option<Spanned<Whole>>,
    /// Whether the same happens on the other side of a plane through the middle of the box.
    pub(super) mirror: Option<MirrorSpec>,
}

/// What a tool does.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum DeedSpec {
    /// Raises the surface.
    Add,
    /// Lowers the surface.
    Remove,
    /// Makes solid what is in the tool.
    Fill,
    /// Empties what is in the tool.
    Cut,
    /// Smooths the surface.
    Smooth,
    /// Turns what is in the tool; the volume stays what it is.
    Twist,
    /// Drags what is in the tool along its way; the volume stays what it is.
    Drag,
}

/// How a tool gets from place to place.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum PathSpec {
    /// It is set down at each.
    Points,
    /// Along straight lines.
    Line,
    /// Along a smooth curve.
    Curve,
}

/// How the effect of a tool falls off.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum FalloffSpec {
    /// Evenly.
    Linear,
    /// Smoothly.
    Smooth,
    /// Not at all.
    Hard,
}

/// A plane across an axis.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum MirrorSpec {
    X,
    Y,
    Z,
}

/// How a sample is stored.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum SampleTypeSpec {
    Uint8,
    Int8,
    Uint16,
    Int16,
    Uint32,
    Int32,
    Float32,
    Float64,
}

/// The order of bytes.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum ByteOrderSpec {
    #[default]
    Little,
    Big,
}

/// What is compared with the tolerance.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum CriterionSpec {
    /// The largest sample and the least.
    #[default]
    Range,
    /// Each sample and the mean.
    Deviation,
}

/// The axis that points up.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum UpSpec {
    #[default]
    Y,
    Z,
}

/// A blend of spheres: the sum of (1 − (a d / radius)²)⁴ over the balls in which it is positive,
/// minus the threshold; d is the distance to a centre.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
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
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum Inside {
    Negative,
    Positive,
}

/// Where surfaces are: the box that is searched, and what is kept of it.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct DomainSpec {
    /// The corner with the smallest coordinates; without `min` and `max` a box is found that
    /// holds the surfaces.
    pub(super) min: Option<Spanned<Numbers<3>>>,
    /// The corner with the largest coordinates.
    pub(super) max: Option<Spanned<Numbers<3>>>,
    /// What is kept of all surfaces, as an inequality such as `x^2 + y^2 + z^2 <= 4`.
    pub(super) clip: Option<Spanned<String>>,
    /// Whether the cuts of clips are closed, so that solids stay solid; false by default.
    pub(super) cap: Option<Spanned<bool>>,
}

/// How finely space is divided.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct VoxelsSpec {
    /// Voxels along the longest axis of the domain, up to 16384; 512 by default. "auto": as small
    /// as pixels, wherever the camera is.
    pub(super) resolution: Option<Spanned<Detail>>,
    /// Whether only voxels are found that the picture shows; true by default, unless statistics of
    /// all are asked for. The picture does not depend on it.
    pub(super) visible_only: Option<Spanned<bool>>,
    /// Whether gradients are used to drop voxels that the surface does not meet, and to certify
    /// the others; true by default. Without, only values are looked at, as in the paper.
    pub(super) certify: Option<bool>,
    /// What holds the voxels; the picture does not depend on it. "octree" by default.
    pub(super) storage: Option<StorageSpec>,
    /// How work is shared out among threads; the picture does not depend on it. "stealing" by
    /// default.
    pub(super) schedule: Option<ScheduleSpec>,
}

/// What holds the voxels.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum StorageSpec {
    /// An octree without pointers, in Morton order.
    #[default]
    Octree,
    /// The paper's octree of cells with pointers.
    Pointer,
    /// A grid of bits.
    Dense,
}

/// How work is shared out among threads.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum ScheduleSpec {
    /// Idle threads steal subtrees.
    #[default]
    Stealing,
    /// A master hands out octants, as in the paper.
    MasterSlave,
}

/// A lens, and a place that is fixed (`eye`, `target`) or fitted (`direction`,
/// `margin`).
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraSpec {
    /// Perspective by default.
    pub(super) projection: Option<ProjectionSpec>,
    /// Perspective: the vertical angle of view in degrees; 35 by default.
    #[schemars(range(min = 0.1, max = 179))]
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
    #[schemars(range(min = 0, max = 0.49))]
    pub(super) margin: Option<Spanned<Number>>,
    /// What is up in the picture; z by default, or y when looking along z.
    pub(super) up: Option<Spanned<Numbers<3>>>,
}

/// The lens.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum ProjectionSpec {
    #[default]
    Perspective,
    Orthographic,
}

/// A light from far away.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct LightSpec {
    /// Towards the light.
    #[schemars(required)]
    pub(super) direction: Option<Spanned<Numbers<3>>>,
    /// What `direction` is relative to; the scene by default.
    pub(super) relative_to: Option<AxesSpec>,
    /// White by default.
    pub(super) color: Option<Color>,
    /// Brightness from 0 to 1000; 1 by default, as bright as the camera's own light.
    #[schemars(range(min = 0, max = 1000))]
    pub(super) intensity: Option<Spanned<Number>>,
}

/// What a direction is relative to.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum AxesSpec {
    /// x, y and z.
    #[default]
    Scene,
    /// Right and up in the picture, and towards the viewer.
    Camera,
}

/// The picture.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ImageSpec {
    /// In pixels; 1024 by default.
    #[schemars(range(min = 1, max = 16384))]
    pub(super) width: Option<Spanned<Whole>>,
    /// In pixels; 1024 by default.
    #[schemars(range(min = 1, max = 16384))]
    pub(super) height: Option<Spanned<Whole>>,
    /// A colour or "transparent"; white by default.
    pub(super) background: Option<Background>,
    /// What stands for the surface in a voxel; "refine" by default.
    pub(super) shade: Option<ShadeSpec>,
    /// Whether the scene's lights cast shadows; false by default.
    pub(super) shadows: Option<Spanned<bool>>,
    /// How much darker corners and hollows are, from 0, the default, to 1.
    #[schemars(range(min = 0, max = 1))]
    pub(super) occlusion: Option<Spanned<Number>>,
    /// A square PNG picture of a lit ball that stands for all light, relative to the folder of the
    /// scene; surfaces are white by default then.
    pub(super) matcap: Option<Spanned<String>>,
    /// Rays through a pixel: 1, 4, 9, 16, 25, 36, 49 or 64; 4 by default.
    #[schemars(range(min = 1, max = 64))]
    pub(super) samples: Option<Spanned<Whole>>,
    /// Whether voxels are drawn of which it is not proven that the surface passes through; true by
    /// default.
    pub(super) candidates: Option<bool>,
}

/// What stands for the surface in a voxel.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub(super) enum ShadeSpec {
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
pub(super) struct AnimationSpec {
    /// How many frames, from 1 to 10000.
    #[schemars(required, range(min = 1, max = 10000))]
    pub(super) frames: Option<Spanned<Whole>>,
    /// Degrees by which the camera turns about `up` from the first frame to one after the last;
    /// 360 make a film that can be repeated.
    pub(super) turntable: Option<Spanned<Number>>,
    /// Frames a second in the animated PNG file, from 0.1 to 1000; 24 by default.
    #[schemars(range(min = 0.1, max = 1000))]
    pub(super) fps: Option<Spanned<Number>>,
    /// Parameters that change: each with its values at even intervals from the first frame to the
    /// last, at least two; between them it changes evenly.
    #[serde(default)]
    pub(super) params: Section<BTreeMap<Spanned<String>, Spanned<Vec<Number>>>>,
    /// Places of the camera, at least two, between which it goes smoothly.
    #[serde(default)]
    pub(super) key: Vec<Section<KeySpec>>,
}

/// A place of the camera. What is missing is as in `[camera]`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct KeySpec {
    /// When: 0 is the first frame and 1 the last.
    #[schemars(required, range(min = 0, max = 1))]
    pub(super) at: Option<Spanned<Number>>,
    /// Where the camera is.
    #[schemars(required)]
    pub(super) eye: Option<Spanned<Numbers<3>>>,
    /// What is in the picture's middle.
    #[schemars(required)]
    pub(super) target: Option<Spanned<Numbers<3>>>,
    /// Perspective: the vertical angle of view in degrees.
    #[schemars(range(min = 0.1, max = 179))]
    pub(super) fov: Option<Spanned<Number>>,
    /// Orthographic: the picture's height in scene units.
    pub(super) height: Option<Spanned<Number>>,
}

/// The files: true, false or the name of a file below the output directory.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct OutputSpec {
    /// True by default: NAME.png after the scene file NAME.toml.
    pub(super) png: Option<Spanned<Target>>,
    /// True by default: NAME.exr.
    pub(super) exr: Option<Spanned<Target>>,
    /// Whether the EXR file holds layers beside colour and alpha; true by default.
    pub(super) layers: Option<bool>,
    /// False by default. True: NAME.ply, all voxels as points with normals and colours.
    pub(super) ply: Option<Spanned<Target>>,
    /// False by default. True: NAME.apng, a film in one file.
    pub(super) apng: Option<Spanned<Target>>,
    /// False by default. True: NAME.glb, meshes of all surfaces as binary glTF.
    pub(super) glb: Option<Spanned<Target>>,
    /// False by default. True: NAME.gltf, meshes as glTF in one text file.
    pub(super) gltf: Option<Spanned<Target>>,
    /// False by default. True: NAME.obj, meshes as Wavefront OBJ, with NAME.mtl.
    pub(super) obj: Option<Spanned<Target>>,
    /// False by default. True: NAME.mesh.ply, meshes as binary PLY.
    pub(super) mesh_ply: Option<Spanned<Target>>,
    /// False by default. True: NAME.stl, meshes as binary STL.
    pub(super) stl: Option<Spanned<Target>>,
    /// False by default. True: NAME.3mf, meshes with units for printing.
    #[serde(rename = "3mf")]
    pub(super) three_mf: Option<Spanned<Target>>,
}

/// How surfaces become meshes.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct MeshSpec {
    /// Whether solids are closed where the domain ends; false by default.
    pub(super) cap: Option<bool>,
    /// Where vertices are put; "polished" by default.
    pub(super) vertex: Option<VertexSpec>,
    /// The axis of files that points up; by default "y" for GLB, glTF and OBJ, "z" for the others.
    pub(super) up: Option<UpSpec>,
    /// Lengths in files for each in the scene; 1 by default.
    pub(super) scale: Option<Spanned<Number>>,
    /// What a length in files is; by default a metre in glTF and a millimetre in 3MF.
    pub(super) unit: Option<UnitSpec>,
    /// The most triangles of each mesh, at least 4; as many as there are by default.
    #[schemars(range(min = 4))]
    pub(super) triangles: Option<Spanned<Whole>>,
}

/// Where vertices are put.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum VertexSpec {
    /// On the surface.
    #[default]
    Polished,
    /// Where a value between those in the middles of voxels would be 0.
    Linear,
}

/// What a length is.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum UnitSpec {
    Micron,
    Millimeter,
    Centimeter,
    Inch,
    Foot,
    Meter,
}
