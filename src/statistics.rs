//! The numbers of a run, as `--stats` writes them: one JSON object for each scene.
//!
//! Everything but `threads`, `simd`, `time_s` and `peak_memory_bytes` is the same on every machine.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::{
    math::Aabb,
    mesh, octree,
    raster::{FrameDigest, PlaneDigest},
    voxelize::Effort,
};

/// The numbers of one scene.
#[derive(Clone, Debug, Serialize)]
pub struct Statistics {
    /// The scene's name.
    pub scene: String,
    /// Voxels along x, y and z.
    pub resolution: [u32; 3],
    /// Whether only voxels were found that the picture shows.
    pub visible_only: bool,
    /// The box that was searched: the scene's domain, widened to whole voxels.
    pub domain: DomainBox,
    /// Boxes evaluated with interval arithmetic.
    pub boxes: Boxes,
    /// Voxels of all surfaces.
    pub voxels: Voxels,
    /// The octrees of all surfaces.
    pub octree: Octree,
    /// The octrees of volumes and sculptures.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub solids: Vec<Solid>,
    /// Where each surface may be singular, if all voxels were found.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub singular: Vec<Singular>,
    /// The meshes, if files of them are written.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub meshes: Vec<Mesh>,
    /// The picture; its digests take a while, and are made only if the options ask to find all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<Frame>,
    /// Float type of the intervals: `f32` or `f64`.
    pub precision: &'static str,
    /// Instruction set, such as `avx2`.
    pub simd: &'static str,
    /// Number of threads.
    pub threads: usize,
    /// Wall-clock seconds.
    pub time_s: Times,
    /// The most memory the process has held so far; `null` where the system does not tell.
    pub peak_memory_bytes: Option<u64>,
}

/// The octree of a volume or a sculpture.
#[derive(Clone, Debug, Serialize)]
pub struct Solid {
    /// The solid's name.
    pub name: String,
    /// Samples along x, y and z.
    pub samples: [u32; 3],
    /// Divided nodes.
    pub nodes: u64,
    /// Regions.
    pub regions: u64,
    /// Bytes that it holds.
    pub bytes: u64,
}

/// A box in scene units.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct DomainBox {
    /// Smallest x, y and z.
    pub min: [f64; 3],
    /// Largest x, y and z.
    pub max: [f64; 3],
}

impl From<Aabb> for DomainBox {
    fn from(bounds: Aabb) -> Self {
        Self { min: bounds.min.to_array(), max: bounds.max.to_array() }
    }
}

/// What was evaluated with interval arithmetic.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Boxes {
    /// Boxes decided, on all levels.
    pub tested: u64,
    /// On each level of the octree; the first entry is the root's children.
    pub tested_per_level: Vec<u64>,
    /// Boxes over which the gradient was evaluated.
    pub gradients: u64,
    /// Corners of voxels and nodes at which the value was evaluated.
    pub corners: u64,
    /// Voxels that were looked at more closely, in f64 and in parts.
    pub closer_looks: u64,
}

impl Boxes {
    /// Adds up the counts of several surfaces, level by level.
    #[must_use]
    pub fn sum<'a>(efforts: impl Iterator<Item = &'a Effort>) -> Self {
        let mut sum = Self::default();
        for Effort { boxes, gradients, corners, closer_looks } in efforts {
            let n_levels = sum.tested_per_level.len().max(boxes.len());
            sum.tested_per_level.resize(n_levels, 0);
            sum.tested_per_level.iter_mut().zip(boxes).for_each(|(sum, n)| *sum += n);
            sum.gradients += gradients;
            sum.corners += corners;
            sum.closer_looks += closer_looks;
        }
        sum.tested = sum.tested_per_level.iter().sum();
        sum
    }
}

/// Voxels of all surfaces.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Voxels {
    /// Voxels that a surface may meet.
    pub stored: u64,
    /// Those that a surface provably passes through.
    pub certified: u64,
    /// The others: that a surface meets them was not disproved.
    pub candidate: u64,
}

/// The octrees of all surfaces.
#[derive(Clone, Debug, Serialize)]
pub struct Octree {
    /// Bytes on the heap.
    pub bytes: Bytes,
    /// One digest for each surface, over shape, normals and certificates.
    pub digests: Vec<String>,
}

/// Bytes on the heap, by what they are for.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Bytes {
    /// All of them.
    pub total: u64,
    /// Where voxels are, and what lies inside.
    pub shape: u64,
    /// Normals.
    pub normals: u64,
    /// Certificates.
    pub certificates: u64,
}

impl Bytes {
    /// Adds up those of several surfaces.
    #[must_use]
    pub fn sum(of_surfaces: impl Iterator<Item = octree::Bytes>) -> Self {
        let mut sum = Self::default();
        for octree::Bytes { shape, normals, certificates } in of_surfaces {
            sum.shape += shape;
            sum.normals += normals;
            sum.certificates += certificates;
        }
        sum.total = sum.shape + sum.normals + sum.certificates;
        sum
    }
}

/// Where one surface is not proven to be a single sheet.
#[derive(Clone, Debug, Serialize)]
pub struct Singular {
    /// The surface's name.
    pub name: String,
    /// Groups of voxels that share corners: as many as there are singular points and curves, where those
    /// are some voxels apart.
    pub places: u64,
    /// Voxels in them.
    pub voxels: u64,
    /// The middle of the first of them.
    pub first: Option<[f64; 3]>,
}

/// The mesh of one surface.
#[derive(Clone, Debug, Serialize)]
pub struct Mesh {
    /// The surface's name.
    pub name: String,
    /// Vertices.
    pub vertices: u64,
    /// Edges.
    pub edges: u64,
    /// Triangles.
    pub triangles: u64,
    /// Vertices less edges plus triangles.
    pub euler: i64,
    /// Pieces.
    pub components: u64,
    /// In squares of scene units.
    pub area: f64,
    /// In cubes of scene units, if the mesh is closed.
    pub volume: f64,
    /// Edges that only one triangle has.
    pub open_edges: u64,
    /// Vertices that were doubled where sheets touch.
    pub split_vertices: u64,
    /// Pairs of triangles with inner points in common.
    pub self_intersections: u64,
    /// Triangles before some were taken away, if that was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub full_triangles: Option<u64>,
    /// The farthest that a vertex which there was before is from the mesh that is left, in scene units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deviation: Option<f64>,
    /// Whatever else is wrong: crowded or turned edges, pinched or double vertices, flat triangles,
    /// coordinates that are no numbers.
    pub faults: u64,
    /// Of vertices, normals and triangles.
    pub digest: String,
}

impl Mesh {
    /// Counts and measures of a mesh, of which `full` is what it was before triangles were taken away.
    #[must_use]
    pub fn of(mesh: &mesh::Mesh, full: Option<&mesh::Mesh>, split_vertices: u64) -> Self {
        let mesh::Health {
            open_edges,
            crowded_edges,
            turned_edges,
            pinched_vertices,
            flat_triangles,
            not_finite,
            double_vertices,
        } = mesh.health();
        let mesh::Shape { vertices, edges, triangles, euler, components, area, volume } =
            mesh.shape();
        Self {
            name: mesh.name.clone(),
            vertices,
            edges,
            triangles,
            euler,
            components,
            area,
            volume,
            open_edges,
            split_vertices,
            self_intersections: mesh.self_intersections(),
            full_triangles: full.map(|full| full.triangles.len() as u64),
            deviation: full.map(|full| full.deviation_from(mesh)),
            // What was parted lies twice at one place.
            faults: crowded_edges
                + turned_edges
                + pinched_vertices
                + flat_triangles
                + not_finite
                + double_vertices.saturating_sub(split_vertices),
            digest: hex(mesh.digest()),
        }
    }
}

/// The picture.
#[derive(Clone, Debug, Serialize)]
pub struct Frame {
    /// Its number in a film or a sweep, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub number: Option<u32>,
    /// What parameters that change from frame to frame are in this one.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub params: BTreeMap<String, f64>,
    /// Width and height in pixels.
    pub size_px: [u32; 2],
    /// Pixels that show a surface.
    pub covered: usize,
    /// Digests of the colours and of the layers.
    pub digests: FrameDigests,
}

/// Digests of the planes of a picture.
#[derive(Clone, Debug, Serialize)]
pub struct FrameDigests {
    /// Of the colours.
    pub rgba: String,
    /// Of the depths.
    pub depth: String,
    /// Of the normals.
    pub normal: String,
    /// Of the positions.
    pub position: String,
    /// Of the numbers of surfaces.
    pub surface: String,
    /// Of the curvatures.
    pub curvature: String,
    /// Of the certificates.
    pub certificate: String,
}

impl From<&FrameDigest> for Frame {
    fn from(digest: &FrameDigest) -> Self {
        let of = |plane: &PlaneDigest| hex(plane.hash);
        Self {
            number: None,
            params: BTreeMap::new(),
            size_px: digest.size_px,
            covered: digest.n_covered,
            digests: FrameDigests {
                rgba: of(&digest.rgba),
                depth: of(&digest.depth),
                normal: of(&digest.normal),
                position: of(&digest.position),
                surface: of(&digest.surface),
                curvature: of(&digest.curvature),
                certificate: of(&digest.certificate),
            },
        }
    }
}

/// Wall-clock seconds of the stages.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Times {
    /// Octrees of volumes and sculptures.
    pub sample: f64,
    /// Subdivision, normals and octree.
    pub voxelize: f64,
    /// Camera, z-buffer and shading.
    pub rasterize: f64,
    /// Meshes.
    pub mesh: f64,
    /// Encoding and writing files.
    pub write: f64,
}

/// A digest as text: 32 hexadecimal digits.
#[must_use]
pub fn hex(digest: u128) -> String {
    format!("{digest:032x}")
}
