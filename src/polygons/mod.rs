//! Polygon models that are drawn beside surfaces: triangles, their normals and colours.
//!
//! *Based on:* N. Stolte, A. Kaufman, "Parallel Spatial Enumeration of Implicit Surfaces Using
//! Interval Arithmetic for Octree Generation and Its Direct Visualization", 1998, section 5
//! (voxels and polygons in one z-buffer).

mod gltf;
mod normals;
mod obj;

use std::{io::Read as _, path::Path};

use glam::{DAffine3, DMat3, DVec3};

use crate::files;

/// Triangles in scene coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polygons {
    /// The vertices.
    pub positions: Vec<DVec3>,
    /// The corners of each triangle, counter-clockwise from outside, as places in `positions`.
    pub triangles: Vec<[u32; 3]>,
    /// The unit normals at the corners of each triangle, outwards.
    pub normals: Vec<[DVec3; 3]>,
    /// Linear-light red, green and blue of each vertex; none if the model has no colours.
    pub colors: Vec<[f32; 3]>,
}

/// Vertices and triangles as they stand in a file; `colors` are as many as `positions` or none.
#[derive(Debug, Default)]
struct Raw {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// At the vertices; zero where the file has none.
    normals: Vec<DVec3>,
    /// With white where the file has none.
    colors: Vec<[f32; 3]>,
    has_colors: bool,
}

/// The largest file.
const MAX_BYTES: u64 = 1 << 30;

/// Why a file holds no polygons, as a sentence without its name.
pub type Refusal = String;

impl Polygons {
    /// Reads an OBJ, glTF or GLB file, by its ending.
    ///
    /// # Errors
    /// Why it cannot be read, or what is wrong in it.
    pub fn read(path: &Path) -> Result<Self, Refusal> {
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        let raw = match ending.as_deref() {
            Some("obj") => obj::read(path)?,
            Some("gltf" | "glb") => gltf::read(path)?,
            _ => return Err("the name must end in .obj, .gltf or .glb".to_owned()),
        };
        raw.checked()
    }

    /// Moves everything; `placing` must not be singular.
    #[must_use]
    pub fn placed(mut self, placing: DAffine3) -> Self {
        let turn = normal_matrix(placing.matrix3);
        let flips = placing.matrix3.determinant() < 0.0;
        for p in &mut self.positions {
            *p = placing.transform_point3(*p);
        }
        for (corners, normals) in self.triangles.iter_mut().zip(&mut self.normals) {
            *normals = normals.map(|n| (turn * n).normalize_or(DVec3::Z));
            // A reflection turns every triangle inside out.
            if flips {
                corners.swap(1, 2);
                normals.swap(1, 2);
            }
        }
        self
    }
}

/// How normals turn where points are moved by `matrix`: the cofactors, outwards even if it reflects.
fn normal_matrix(matrix: DMat3) -> DMat3 {
    let DMat3 { x_axis: x, y_axis: y, z_axis: z } = matrix;
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    if matrix.determinant() < 0.0 { -1.0 * cofactors } else { cofactors }
}

impl Raw {
    /// Whether all of it makes sense.
    fn checked(self) -> Result<Polygons, Refusal> {
        if self.triangles.is_empty() {
            return Err("it has no faces".to_owned());
        }
        if let Some(i) = self.positions.iter().position(|p| !p.is_finite()) {
            let p = self.positions[i];
            return Err(format!("vertex {} is at ({}, {}, {})", i + 1, p.x, p.y, p.z));
        }
        let n = self.positions.len();
        let is_beyond = |corners: &[u32; 3]| corners.iter().any(|&corner| corner as usize >= n);
        if let Some(i) = self.triangles.iter().position(is_beyond) {
            let corner = self.triangles[i].iter().max().copied().unwrap_or_default();
            let (triangle, corner) = (i + 1, u64::from(corner) + 1);
            return Err(format!("triangle {triangle} has vertex {corner}, and there are {n}"));
        }
        let normals = normals::at_corners(&self.positions, &self.triangles, &self.normals);
        Ok(Polygons {
            positions: self.positions,
            triangles: self.triangles,
            normals,
            colors: if self.has_colors { self.colors } else { Vec::new() },
        })
    }
}

/// The bytes of a file that a model consists of.
fn read_bytes(path: &Path) -> Result<Vec<u8>, Refusal> {
    let (mut file, length) = files::open(path)?;
    if length > MAX_BYTES {
        return Err(format!("{} is larger than {} MiB", path.display(), MAX_BYTES >> 20));
    }
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)
        .map_err(|error| format!("cannot read {}: {error}", path.display()))?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reflections_keep_the_outside_outside() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let raw = Raw {
            positions: corners.to_vec(),
            triangles: vec![[0, 1, 2]],
            normals: vec![DVec3::ZERO; 3],
            ..Raw::default()
        };
        let polygons = raw.checked().unwrap();
        assert_eq!(polygons.normals[0], [DVec3::Z; 3]);
        let mirror = DAffine3::from_scale(DVec3::new(-2.0, 1.0, 1.0));
        let mirrored = polygons.placed(mirror);
        let [a, b, c] = mirrored.triangles[0].map(|i| mirrored.positions[i as usize]);
        assert!((b - a).cross(c - a).normalize().dot(mirrored.normals[0][0]) > 0.99);
    }

    #[test]
    fn nonsense_is_refused() {
        let raw = |positions: Vec<DVec3>, triangles| Raw {
            normals: vec![DVec3::ZERO; positions.len()],
            positions,
            triangles,
            ..Raw::default()
        };
        let said = |raw: Raw| raw.checked().unwrap_err();
        assert_eq!(said(raw(vec![DVec3::ZERO], vec![])), "it has no faces");
        let nan = vec![DVec3::X, DVec3::NAN];
        assert_eq!(said(raw(nan, vec![[0, 1, 0]])), "vertex 2 is at (NaN, NaN, NaN)");
        let beyond = raw(vec![DVec3::X; 3], vec![[0, 1, 2], [0, 1, u32::MAX]]);
        assert_eq!(said(beyond), "triangle 2 has vertex 4294967296, and there are 3");
    }
}
