//! Polygon models and sampled volumes in the scene file.

use schemars::JsonSchema;
use serde::Deserialize;

use super::UpSpec;
use crate::scene::{
    leaf::{Color, Ends, Number, Numbers, Whole},
    spanned::Spanned,
};

/// A polygon model. It is scaled, turned and moved, in this order.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct ModelSpec {
    /// The file `NAME.obj`, `NAME.gltf` or `NAME.glb`, relative to the folder of the scene.
    #[schemars(required)]
    pub(in crate::scene) file: Option<Spanned<String>>,
    /// For messages; the file's name by default.
    pub(in crate::scene) name: Option<String>,
    /// What the colours in the file are multiplied by, white by default; without such colours by
    /// default the next of a small palette.
    pub(in crate::scene) color: Option<Color>,
    /// The colour seen from inside; by default the same.
    pub(in crate::scene) back_color: Option<Color>,
    /// Strength of the highlight in [0, 1]; 0.3 by default.
    #[schemars(range(min = 0, max = 1))]
    pub(in crate::scene) specular: Option<Spanned<Number>>,
    /// Exponent of the highlight from 1 to 1000; 32 by default.
    #[schemars(range(min = 1, max = 1000))]
    pub(in crate::scene) shininess: Option<Spanned<Whole>>,
    /// The axis that points up in the file, which becomes the scene's z; "y" by default.
    pub(in crate::scene) up: Option<UpSpec>,
    /// How much larger the model becomes; 1 by default.
    pub(in crate::scene) scale: Option<Spanned<Number>>,
    /// Degrees by which it is turned about the scene's x, then y, then z.
    pub(in crate::scene) rotate: Option<Spanned<Numbers<3>>>,
    /// By how much it is moved.
    pub(in crate::scene) translate: Option<Spanned<Numbers<3>>>,
}

/// A sampled volume, and the isosurface in it. Samples are in the middles of voxels.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct VolumeSpec {
    /// The file, relative to the folder of the scene: NRRD (`.nrrd`, `.nhdr`), MetaImage (`.mha`,
    /// `.mhd`), NIfTI-1 (`.nii`, `.nii.gz`, `.hdr`), a Gaussian cube file (`.cube`, `.cub`), or raw
    /// samples with `size` and `type`.
    #[schemars(required)]
    pub(in crate::scene) file: Option<Spanned<String>>,
    /// For messages and meshes; the file's name by default.
    pub(in crate::scene) name: Option<String>,
    /// A cube file with several orbitals: the number of the one that is meant, as the file lists it.
    pub(in crate::scene) orbital: Option<Spanned<Whole>>,
    /// What is this large or larger is inside.
    pub(in crate::scene) isovalue: Option<Spanned<Number>>,
    /// What lies between these two is inside, instead of `isovalue`; with -inf as the first, what is
    /// the second or smaller.
    pub(in crate::scene) range: Option<Spanned<Ends>>,
    /// Whether only the largest component of what is inside is kept; false by default.
    pub(in crate::scene) keep_largest: Option<bool>,
    /// Components with fewer samples are dropped; 1 by default.
    pub(in crate::scene) min_samples: Option<Spanned<Whole>>,
    /// By how much samples may differ that become one region; 0 by default.
    pub(in crate::scene) tolerance: Option<Spanned<Number>>,
    /// What is compared with `tolerance`; "range" by default.
    pub(in crate::scene) criterion: Option<CriterionSpec>,
    /// Whether the isosurface is closed where the volume ends; false by default.
    pub(in crate::scene) cap: Option<bool>,
    /// Raw samples: how many there are along x, y and z.
    pub(in crate::scene) size: Option<Spanned<Numbers<3>>>,
    /// Raw samples: their type.
    #[serde(rename = "type")]
    pub(in crate::scene) sample_type: Option<Spanned<SampleTypeSpec>>,
    /// Raw samples: the order of their bytes; "little" by default.
    pub(in crate::scene) byte_order: Option<ByteOrderSpec>,
    /// Raw samples: the distances between them along x, y and z; 1 by default.
    pub(in crate::scene) spacing: Option<Spanned<Numbers<3>>>,
    /// Raw samples: where the first one is in the scene; `[0, 0, 0]` by default.
    pub(in crate::scene) origin: Option<Spanned<Numbers<3>>>,
    /// Raw samples: how many bytes stand before them; 0 by default.
    pub(in crate::scene) skip: Option<Spanned<Whole>>,
    /// By default the next of a small palette.
    pub(in crate::scene) color: Option<Color>,
    /// The colour seen from inside; by default the same.
    pub(in crate::scene) back_color: Option<Color>,
    /// Strength of the highlight in [0, 1]; 0.3 by default.
    #[schemars(range(min = 0, max = 1))]
    pub(in crate::scene) specular: Option<Spanned<Number>>,
    /// Exponent of the highlight from 1 to 1000; 32 by default.
    #[schemars(range(min = 1, max = 1000))]
    pub(in crate::scene) shininess: Option<Spanned<Whole>>,
}

/// How a sample is stored.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(in crate::scene) enum SampleTypeSpec {
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
pub(in crate::scene) enum ByteOrderSpec {
    #[default]
    Little,
    Big,
}

/// What is compared with the tolerance.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(in crate::scene) enum CriterionSpec {
    /// The largest sample and the least.
    #[default]
    Range,
    /// Each sample and the mean.
    Deviation,
}
