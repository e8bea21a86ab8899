//! Where surfaces are looked for in the scene file, and how finely.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::scene::{
    leaf::{Detail, Numbers},
    spanned::Spanned,
};

/// Where surfaces are: the box that is searched, and what is kept of it.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct DomainSpec {
    /// The corner with the smallest coordinates; without `min` and `max` a box is found that
    /// holds the surfaces.
    pub(in crate::scene) min: Option<Spanned<Numbers<3>>>,
    /// The corner with the largest coordinates.
    pub(in crate::scene) max: Option<Spanned<Numbers<3>>>,
    /// What is kept of all surfaces, as an inequality such as `x^2 + y^2 + z^2 <= 4`.
    pub(in crate::scene) clip: Option<Spanned<String>>,
    /// Whether the cuts of clips are closed, so that solids stay solid; false by default.
    pub(in crate::scene) cap: Option<Spanned<bool>>,
}

/// How finely space is divided.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct VoxelsSpec {
    /// Voxels along the longest axis of the domain, up to 16384; 512 by default. "auto": as small
    /// as pixels, wherever the camera is.
    pub(in crate::scene) resolution: Option<Spanned<Detail>>,
    /// Whether only voxels are found that the picture shows; true by default, unless statistics of
    /// all are asked for. The picture does not depend on it.
    pub(in crate::scene) visible_only: Option<Spanned<bool>>,
    /// Whether gradients are used to drop voxels that the surface does not meet, and to certify
    /// the others; true by default. Without, only values are looked at, as in the paper.
    pub(in crate::scene) certify: Option<bool>,
    /// What holds the voxels; the picture does not depend on it. "octree" by default.
    pub(in crate::scene) storage: Option<StorageSpec>,
    /// How work is shared out among threads; the picture does not depend on it. "stealing" by
    /// default.
    pub(in crate::scene) schedule: Option<ScheduleSpec>,
}

/// What holds the voxels.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(in crate::scene) enum StorageSpec {
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
pub(in crate::scene) enum ScheduleSpec {
    /// Idle threads steal subtrees.
    #[default]
    Stealing,
    /// A master hands out octants, as in the paper.
    MasterSlave,
}
