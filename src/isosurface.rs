//! Isosurfaces of volumes: regions, which are drawn as they are, or their dual grid as a mesh; normals
//! come from the samples.

use std::{fmt, sync::OnceLock};

use glam::{DAffine3, DMat3, DVec3, Vec3};

use crate::{
    hrb::{self, HrbOctree, Storage, Tolerance, Value},
    mesh::{Border, Crossing, Extraction, Mesh, extract, offset},
    raster::Field,
    volume::{Volume, with_samples},
};

/// What a volume has at an isovalue and above. Its octree is built when it is first needed.
#[derive(Debug)]
pub struct Isosurface {
    volume: Volume,
    isovalue: f64,
    tolerance: Tolerance,
    border: Border,
    octree: OnceLock<Box<dyn Regions>>,
}

impl Isosurface {
    /// Of a volume in which samples are alike within a tolerance.
    #[must_use]
    pub fn new(volume: Volume, isovalue: f64, tolerance: Tolerance, border: Border) -> Self {
        Self { volume, isovalue, tolerance, border, octree: OnceLock::new() }
    }

    /// The volume.
    #[must_use]
    pub fn volume(&self) -> &Volume {
        &self.volume
    }

    /// The surface in scene coordinates.
    #[must_use]
    pub fn mesh(&self) -> Mesh {
        mesh(&self.volume, self.octree(), self.isovalue, self.border)
    }

    /// What the octree takes.
    #[must_use]
    pub fn storage(&self) -> Storage {
        self.octree().storage()
    }

    fn octree(&self) -> &dyn Regions {
        &**self.octree.get_or_init(|| octree(&self.volume, self.tolerance))
    }
}

impl Field for Isosurface {
    fn size(&self) -> [u32; 3] {
        self.volume.size
    }

    fn placing(&self) -> DAffine3 {
        self.volume.placing
    }

    fn is_capped(&self) -> bool {
        self.border == Border::Capped
    }

    fn bricks(&self) -> Vec<[u32; 3]> {
        self.octree().bricks(self.isovalue, self.border)
    }

    fn values(&self, first: [u32; 3], end: [u32; 3]) -> Vec<f32> {
        self.octree().offsets(&hrb::Samples { first, end }, self.isovalue)
    }

    fn original_values(&self, first: [u32; 3], end: [u32; 3]) -> Vec<f32> {
        let samples = hrb::Samples { first, end };
        samples.iter().map(|p| offset(self.volume.value(p), self.isovalue)).collect()
    }
}

/// The surface in a volume where samples are `isovalue`; what is more is inside. In scene coordinates.
#[must_use]
pub fn isosurface(volume: &Volume, isovalue: f64, tolerance: Tolerance, border: Border) -> Mesh {
    mesh(volume, &*octree(volume, tolerance), isovalue, border)
}

/// An octree of values of any kind.
pub(crate) trait Regions: fmt::Debug + Send + Sync {
    /// What it takes.
    fn storage(&self) -> Storage;

    /// The bricks near an isosurface, counted from 0.
    fn bricks(&self, isovalue: f64, border: Border) -> Vec<[u32; 3]>;

    /// How far samples are above the isovalue, x fastest.
    fn offsets(&self, samples: &hrb::Samples, isovalue: f64) -> Vec<f32>;

    /// The mesh of an isosurface; `vertex` gives places and normals.
    fn extraction(
        &self,
        isovalue: f64,
        border: Border,
        vertex: &(dyn Fn(&Crossing) -> Vertex + Sync),
    ) -> Extraction<Vertex>;
}

/// Its place and its normal.
pub(crate) type Vertex = ([f32; 3], [f32; 3]);

impl<V: Value> Regions for HrbOctree<V> {
    fn storage(&self) -> Storage {
        self.storage()
    }

    fn bricks(&self, isovalue: f64, border: Border) -> Vec<[u32; 3]> {
        self.grid(isovalue, border).bricks_of_voxels()
    }

    fn offsets(&self, samples: &hrb::Samples, isovalue: f64) -> Vec<f32> {
        self.values(samples).into_iter().map(|value| offset(value.to_f64(), isovalue)).collect()
    }

    fn extraction(
        &self,
        isovalue: f64,
        border: Border,
        vertex: &(dyn Fn(&Crossing) -> Vertex + Sync),
    ) -> Extraction<Vertex> {
        extract(&self.grid(isovalue, border), vertex)
    }
}

fn octree(volume: &Volume, tolerance: Tolerance) -> Box<dyn Regions> {
    with_samples!(&volume.samples, |samples| {
        Box::new(HrbOctree::build(samples, volume.size, tolerance))
    })
}

fn mesh(volume: &Volume, octree: &dyn Regions, isovalue: f64, border: Border) -> Mesh {
    let matrix = volume.placing.matrix3;
    let is_mirrored = matrix.determinant() < 0.0;
    let normals_by = matrix.inverse().transpose();
    let vertex = |crossing: &Crossing| {
        let point = volume.placing.transform_point3(DVec3::from_array(crossing.point()));
        (point.as_vec3().to_array(), normal(volume, crossing, normals_by))
    };
    let Extraction { vertices, triangles } = octree.extraction(isovalue, border, &vertex);
    let (positions, normals) = vertices.into_iter().unzip();
    let mut mesh = Mesh { positions, normals, triangles, ..Mesh::default() };
    if is_mirrored {
        mesh.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    }
    mesh.drop_unused();
    mesh
}

/// Outwards, of length 1: against the gradient between the ends of an edge, or along the edge where
/// there is none.
pub(crate) fn normal(volume: &Volume, crossing: &Crossing, normals_by: DMat3) -> [f32; 3] {
    let along = crossing.outwards();
    let [g, h] = crossing.ends.map(|end| gradient(volume, Vec3::from_array(end).as_dvec3()));
    let inwards = g + crossing.part * (h - g);
    let outwards = if crossing.is_cap || !inwards.is_finite() { along } else { -inwards };
    let turned = (normals_by * outwards).try_normalize();
    turned.unwrap_or_else(|| (normals_by * along).normalize_or(DVec3::Z)).as_vec3().to_array()
}

/// By differences between the samples around the one that holds a point; one-sided at the border.
fn gradient(volume: &Volume, p: DVec3) -> DVec3 {
    let at = [0, 1, 2].map(|axis| (p[axis] as u32).min(volume.size[axis] - 1));
    let along = |axis: usize| {
        let (mut lower, mut upper) = (at, at);
        lower[axis] = at[axis].saturating_sub(1);
        upper[axis] = (at[axis] + 1).min(volume.size[axis] - 1);
        let steps = upper[axis] - lower[axis];
        if steps == 0 {
            return 0.0;
        }
        (volume.value(upper) - volume.value(lower)) / f64::from(steps)
    };
    DVec3::new(along(0), along(1), along(2))
}
