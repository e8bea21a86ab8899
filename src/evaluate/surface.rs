//! Isosurfaces whose vertices are known well enough to be measured.

use glam::{DMat3, DVec3};

use crate::{
    hrb::{self, HrbOctree, Tolerance},
    isosurface,
    mesh::{Border, Crossing, Extraction, Threshold, extract},
    volume::{Volume, with_samples},
};

/// A tolerance with which nothing is joined: the octree is the grid, and its mesh that of
/// [`crate::mesh::uniform`].
pub const GRID: f64 = -1.0;

/// Triangles with what is known of their vertices.
#[derive(Clone, Debug, Default)]
pub struct Surface {
    /// In scene coordinates.
    pub positions: Vec<DVec3>,
    /// Of length 1, outwards.
    pub normals: Vec<DVec3>,
    /// By how much samples differ between the ends of the edges that vertices lie on, for each scene
    /// unit.
    pub slopes: Vec<f64>,
    /// Counter-clockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

#[derive(Clone, Copy, Default)]
struct Vertex {
    position: DVec3,
    normal: [f32; 3],
    slope: f64,
}

impl Surface {
    /// The surface in a volume; a tolerance of [`GRID`] takes all samples.
    #[must_use]
    pub fn new(volume: &Volume, isovalue: f64, tolerance: Tolerance) -> Self {
        let normals_by: DMat3 = volume.placing.matrix3.inverse().transpose();
        let place = |p: [f64; 3]| volume.placing.transform_point3(DVec3::from_array(p));
        let vertex = |crossing: &Crossing| {
            let [a, b] = crossing.ends.map(|end| place(end.map(f64::from)));
            let [f, g] = crossing.offsets.map(f64::from);
            Vertex {
                position: place(crossing.point()),
                normal: isosurface::normal(volume, crossing, normals_by),
                slope: (g - f).abs() / a.distance(b),
            }
        };
        let Extraction { vertices, mut triangles } = with_samples!(&volume.samples, |samples| {
            let octree = octree(samples, volume.size, tolerance);
            extract(&octree.grid(isovalue, Border::Open), vertex)
        });
        let mut numbers = vec![u32::MAX; vertices.len()];
        triangles.as_flattened().iter().for_each(|&v| numbers[v as usize] = 0);
        let is_used: Vec<bool> = numbers.iter().map(|&number| number == 0).collect();
        (0..).zip(numbers.iter_mut().filter(|n| **n == 0)).for_each(|(next, n)| *n = next);
        triangles.as_flattened_mut().iter_mut().for_each(|v| *v = numbers[*v as usize]);
        if volume.placing.matrix3.determinant() < 0.0 {
            triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        let mut surface = Self { triangles, ..Self::default() };
        for (vertex, _) in vertices.iter().zip(is_used).filter(|(_, is_used)| *is_used) {
            surface.positions.push(vertex.position);
            surface.normals.push(DVec3::from_array(vertex.normal.map(f64::from)));
            surface.slopes.push(vertex.slope);
        }
        surface
    }
}

/// The octree of samples.
pub(super) fn octree<T>(samples: &[T], size: [u32; 3], tolerance: Tolerance) -> HrbOctree<T::Value>
where
    T: hrb::Sample + Threshold,
{
    HrbOctree::build(samples, size, tolerance)
}
