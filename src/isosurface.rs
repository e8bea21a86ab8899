//! Isosurfaces of volumes as meshes: regions, their dual grid, and normals from the samples.

use glam::{DMat3, DVec3, Vec3};

use crate::{
    hrb::{HrbOctree, Tolerance},
    mesh::{Border, Crossing, Extraction, Mesh, extract},
    volume::{Volume, with_samples},
};

/// The surface in a volume where samples are `isovalue`; what is more is inside. In scene coordinates.
#[must_use]
pub fn isosurface(volume: &Volume, isovalue: f64, tolerance: Tolerance, border: Border) -> Mesh {
    let matrix = volume.placing.matrix3;
    let is_mirrored = matrix.determinant() < 0.0;
    let normals_by = matrix.inverse().transpose();
    let vertex = |crossing: &Crossing| {
        let point = volume.placing.transform_point3(DVec3::from_array(crossing.point()));
        (point.as_vec3().to_array(), normal(volume, crossing, normals_by))
    };
    let Extraction { vertices, triangles } = with_samples!(&volume.samples, |samples| {
        let octree = HrbOctree::build(samples, volume.size, tolerance);
        extract(&octree.grid(isovalue, border), vertex)
    });
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
