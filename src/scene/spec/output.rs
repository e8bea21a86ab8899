//! The files that are written, in the scene file, and how surfaces become meshes.

use schemars::JsonSchema;
use serde::Deserialize;

use super::UpSpec;
use crate::scene::{
    leaf::{Number, Target, Whole},
    spanned::Spanned,
};

/// The files: true, false or the name of a file below the output directory.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct OutputSpec {
    /// True by default: NAME.png after the scene file NAME.toml.
    pub(in crate::scene) png: Option<Spanned<Target>>,
    /// True by default: NAME.exr.
    pub(in crate::scene) exr: Option<Spanned<Target>>,
    /// Whether the EXR file holds layers beside colour and alpha; true by default.
    pub(in crate::scene) layers: Option<bool>,
    /// False by default. True: NAME.ply, all voxels as points with normals and colours.
    pub(in crate::scene) ply: Option<Spanned<Target>>,
    /// False by default. True: NAME.apng, a film in one file.
    pub(in crate::scene) apng: Option<Spanned<Target>>,
    /// True by default for sweeps: NAME.sheet.png, all frames in one picture, with captions.
    pub(in crate::scene) sheet: Option<Spanned<Target>>,
    /// False by default. True: NAME.csv, the forces that hands have felt which pushed tools into sculptures,
    /// moment by moment.
    pub(in crate::scene) forces: Option<Spanned<Target>>,
    /// False by default. True: NAME.glb, meshes of all surfaces as binary glTF.
    pub(in crate::scene) glb: Option<Spanned<Target>>,
    /// False by default. True: NAME.gltf, meshes as glTF in one text file.
    pub(in crate::scene) gltf: Option<Spanned<Target>>,
    /// False by default. True: NAME.obj, meshes as Wavefront OBJ, with NAME.mtl.
    pub(in crate::scene) obj: Option<Spanned<Target>>,
    /// False by default. True: NAME.mesh.ply, meshes as binary PLY.
    pub(in crate::scene) mesh_ply: Option<Spanned<Target>>,
    /// False by default. True: NAME.stl, meshes as binary STL.
    pub(in crate::scene) stl: Option<Spanned<Target>>,
    /// False by default. True: NAME.3mf, meshes with units for printing.
    #[serde(rename = "3mf")]
    pub(in crate::scene) three_mf: Option<Spanned<Target>>,
}

/// How surfaces become meshes.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct MeshSpec {
    /// Whether solids are closed where the domain ends; false by default.
    pub(in crate::scene) cap: Option<bool>,
    /// Where vertices are put; "polished" by default.
    pub(in crate::scene) vertex: Option<VertexSpec>,
    /// The axis of files that points up; by default "y" for GLB, glTF and OBJ, "z" for the others.
    pub(in crate::scene) up: Option<UpSpec>,
    /// Lengths in files for each in the scene; 1 by default.
    pub(in crate::scene) scale: Option<Spanned<Number>>,
    /// What a length in files is; by default a metre in glTF and a millimetre in 3MF.
    pub(in crate::scene) unit: Option<UnitSpec>,
    /// The most triangles of each mesh, at least 4; as many as there are by default.
    #[schemars(range(min = 4))]
    pub(in crate::scene) triangles: Option<Spanned<Whole>>,
}

/// Where vertices are put.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(in crate::scene) enum VertexSpec {
    /// On the surface.
    #[default]
    Polished,
    /// Where a value between those in the middles of voxels would be 0.
    Linear,
}

/// What a length is.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(in crate::scene) enum UnitSpec {
    Micron,
    Millimeter,
    Centimeter,
    Inch,
    Foot,
    Meter,
}
