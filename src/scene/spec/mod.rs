//! The scene file mirrored as data: its sections and keys, nothing checked beyond types.
//!
//! Every key is optional here; what is missing gets its default, or is missed, in
//! `lower`. The docs of the fields are the reference of the file format.

mod data;
mod output;
mod picture;
mod sculpture;
mod space;
mod surface;
mod sweep;

use std::ops::Range;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Deserializer};

use super::{definitions::Named, leaf::Table, spanned::Spanned};

pub(super) use data::{ByteOrderSpec, CriterionSpec, ModelSpec, SampleTypeSpec, VolumeSpec};
pub(super) use output::{MeshSpec, OutputSpec, UnitSpec, VertexSpec};
pub(super) use picture::{
    AnimationSpec, AxesSpec, CameraSpec, ImageSpec, KeySpec, LightSpec, ProjectionSpec, ShadeSpec,
};
pub(super) use sculpture::{
    AdvanceSpec, DeedSpec, FalloffSpec, MirrorSpec, PathSpec, SculptureSpec, StrokeSpec,
};
pub(super) use space::{DomainSpec, ScheduleSpec, StorageSpec, VoxelsSpec};
pub(super) use surface::{BlendSpec, Inside, PaletteSpec, SurfaceSpec};
pub(super) use sweep::{SweepSpec, ValuesSpec};

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
    /// Variants of the scene, a frame for each combination of the values of parameters: the first value,
    /// the last one and how many, or `{ values = [...] }`. The last parameter changes first.
    pub(super) sweep: Option<Section<SweepSpec>>,
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

/// The axis that points up.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum UpSpec {
    #[default]
    Y,
    Z,
}
