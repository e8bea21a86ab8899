//! What the user asks for: the scene file mirrored as data (`spec`) and lowered to a [`Scene`].

mod animation;
mod camera;
mod caption;
mod clip;
mod color;
mod coloring;
mod definitions;
mod explain;
mod files;
mod formula;
mod frames;
mod graph;
mod include;
mod leaf;
mod leaf_schema;
mod light;
mod load;
mod lower;
mod matcap;
mod model;
mod output;
mod read;
mod schema;
mod sculpture;
mod solid;
mod spanned;
mod spec;
mod surface;
mod sweep;
mod track;
mod volume;

#[cfg(test)]
mod tests;

use std::{path::PathBuf, sync::Arc};

pub use animation::Animation;
pub use load::{Loading, load, load_volumes, load_with, parse, parse_with};
pub use lower::MAX_RESOLUTION;
pub use schema::schema;
pub use sculpture::{Carved, Carving};
pub use solid::{Origin, Shape, Solid};
pub use sweep::{Sweep, Swept};
pub use volume::Scan;

use frames::Script;
use serde::Serialize;

use crate::{
    diagnostic::{Diagnostic, Sources},
    expr::Expr,
    math::Aabb,
    mesh::{Border, VertexPlace},
    octree::StorageKind,
    output::meshes::{MeshFormat, Unit, Up},
    raster::{Coloring, ImageSettings, Material, Model, View},
    voxelize::Schedule,
};

/// Everything a run needs to know, checked and with all defaults filled in.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The file's stem; outputs are named after it.
    pub name: String,
    /// What it shows, for people.
    pub about: About,
    /// At least one, unless there are solids.
    pub surfaces: Vec<Surface>,
    /// Polygon models, drawn beside them.
    pub models: Arc<[Model]>,
    /// What samples give: volumes, then sculptures.
    pub solids: Arc<[Solid]>,
    /// How much of the work on sculptures is done that are filmed, from 0 to 1.
    pub time: f64,
    /// The box that is searched, finite and not empty; one is found where there is none.
    pub domain: Option<Aabb>,
    /// Voxels along the domain's longest axis.
    pub resolution: u32,
    /// Whether voxels are made as small as pixels instead, where the picture shows them.
    pub is_auto: bool,
    /// Whether only voxels are found that the picture shows; the run decides where it is `None`.
    pub visible_only: Option<bool>,
    /// Whether voxels are certified, by gradients and values at corners.
    pub certify: bool,
    /// What holds the voxels.
    pub storage: StorageKind,
    /// How work is shared out among threads.
    pub schedule: Schedule,
    /// Where the picture is taken from.
    pub view: View,
    /// Size and background of the picture.
    pub image: ImageSettings,
    /// Which files to write.
    pub outputs: Outputs,
    /// How surfaces become meshes, if files of them are written.
    pub mesh: MeshSettings,
    /// How it moves from frame to frame, if it is a film; all else is then as in the first frame.
    pub animation: Option<Animation>,
    /// Its variants, if it is a sweep; all else is then as in the first of them.
    pub sweep: Option<Sweep>,
    /// What surfaces are made of in each frame, if parameters change.
    script: Option<Arc<Script>>,
    /// What is allowed but perhaps not meant, in the order of the places.
    pub warnings: Vec<Diagnostic>,
    /// The texts that it was made of.
    pub sources: Sources,
}

/// What a scene shows, in words; nothing depends on it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct About {
    /// What it is called.
    pub title: Option<String>,
    /// Who found or published it, and when.
    pub source: Option<String>,
    /// What is special about it.
    pub note: Option<String>,
}

/// One surface F = 0.
#[derive(Clone, Debug)]
pub struct Surface {
    /// For messages and statistics.
    pub name: String,
    /// F with F < 0 inside, whatever the file's convention was.
    pub expr: Expr,
    /// How it looks.
    pub material: Material,
    /// What gives it its colour, if not the material.
    pub coloring: Coloring,
}

/// The files to write; relative names are relative to the output directory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outputs {
    /// An sRGB picture.
    pub png: Option<PathBuf>,
    /// Linear light and layers.
    pub exr: Option<PathBuf>,
    /// Whether it holds layers beside colour and alpha.
    pub layers: bool,
    /// Voxels as points.
    pub ply: Option<PathBuf>,
    /// All frames of a film; the other files are then numbered.
    pub apng: Option<PathBuf>,
    /// All frames of a sweep, side by side; the other files are then numbered.
    pub sheet: Option<PathBuf>,
    /// What hands have felt that pushed tools.
    pub forces: Option<PathBuf>,
    /// Meshes of all surfaces.
    pub meshes: Vec<(MeshFormat, PathBuf)>,
}

/// How surfaces become meshes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshSettings {
    /// What surfaces do where the domain ends.
    pub border: Border,
    /// Where vertices are put.
    pub vertex: VertexPlace,
    /// The axis of files that points up; what is usual for each format where `None`.
    pub up: Option<Up>,
    /// Lengths in files for each in the scene, above 0.
    pub scale: f64,
    /// What a length in files is; what is usual for each format where `None`.
    pub unit: Option<Unit>,
    /// The most triangles of each mesh; as many as there are where `None`.
    pub most_triangles: Option<u32>,
}
