//! PLY, binary, little-endian: small, indexed, read by every mesh library. All meshes are one, told
//! apart by the colours of their vertices.
//!
//! A vertex is `x y z nx ny nz` (float) and `red green blue` (sRGB bytes); a face is a list of three
//! `int`, which more readers know than `uint`.
//!
//! *Based on:* G. Turk, "The PLY Polygon File Format", 1994.

use std::io::Write;

use super::{
    MeshFormat, MeshOptions,
    check::{bytes, corner_bytes, limit, placing},
};
use crate::{
    mesh::Mesh,
    output::{WriteError, ply, png::srgb_code},
};

/// Writes the vertices and triangles of all meshes.
///
/// # Errors
/// If `out` fails, or a mesh is empty or broken, or there are more than 2³¹ − 1 vertices.
pub fn write(
    meshes: &[Mesh],
    options: &MeshOptions,
    mut out: impl Write,
) -> Result<(), WriteError> {
    let placing = placing(meshes, options, MeshFormat::Ply)?;
    let n_vertices = meshes.iter().map(|mesh| mesh.positions.len() as u64).sum();
    let n_triangles: u64 = meshes.iter().map(|mesh| mesh.triangles.len() as u64).sum();
    limit("vertices", n_vertices, i32::MAX as u64)?;
    ply::begin(&mut out)?;
    ply::element(&mut out, "vertex", n_vertices)?;
    ply::properties(&mut out, "float", &["x", "y", "z", "nx", "ny", "nz"])?;
    ply::properties(&mut out, "uchar", &["red", "green", "blue"])?;
    ply::element(&mut out, "face", n_triangles)?;
    ply::properties(&mut out, "list uchar int", &["vertex_indices"])?;
    ply::end(&mut out)?;
    for mesh in meshes {
        let color = mesh.color.map(srgb_code);
        for (&p, &n) in mesh.positions.iter().zip(&mesh.normals) {
            out.write_all(&bytes(placing.position(p)))?;
            out.write_all(&bytes(placing.direction(n)))?;
            out.write_all(&color)?;
        }
    }
    let mut first = 0;
    for mesh in meshes {
        for &triangle in &mesh.triangles {
            out.write_all(&[3])?;
            out.write_all(&corner_bytes(triangle, first))?;
        }
        first += mesh.positions.len() as u32;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{
        super::{Up, sample::*},
        *,
    };

    #[test]
    fn vertices_and_faces_are_what_they_were() {
        for (up, place) in [(None, (|p| p) as fn([f32; 3]) -> [f32; 3]), (Some(Up::Y), y_up)] {
            let mut file = Vec::new();
            write(&meshes(), &MeshOptions { up, ..MeshOptions::default() }, &mut file).unwrap();
            let header = "element vertex 8\n\
                property float x\nproperty float y\nproperty float z\n\
                property float nx\nproperty float ny\nproperty float nz\n\
                property uchar red\nproperty uchar green\nproperty uchar blue\n\
                element face 6\nproperty list uchar int vertex_indices\nend_header\n";
            let start = "ply\nformat binary_little_endian 1.0\ncomment zeroset ";
            assert!(file.starts_with(start.as_bytes()));
            let at = file.windows(header.len()).position(|w| w == header.as_bytes()).unwrap();
            let (vertices, faces) = file[at + header.len()..].split_at(8 * 27);
            let meshes = meshes();
            let all = meshes.iter().flat_map(|mesh| {
                mesh.positions.iter().zip(&mesh.normals).map(|(&p, &n)| (p, n, mesh.color))
            });
            for (vertex, (p, n, color)) in vertices.as_chunks::<27>().0.iter().zip(all) {
                let number = |at: usize| f32::from_le_bytes(vertex[at..at + 4].try_into().unwrap());
                assert_eq!([0, 4, 8].map(number), place(p));
                assert_eq!([12, 16, 20].map(number), place(n));
                assert_eq!(vertex[24..], color.map(srgb_code));
            }
            let (faces, rest) = faces.as_chunks::<13>();
            assert_eq!((faces.len(), rest.len()), (6, 0));
            let expected = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3], [4, 5, 6], [6, 5, 7_i32]];
            for (face, corners) in faces.iter().zip(expected) {
                assert_eq!(face[0], 3);
                assert_eq!(face[1..].as_chunks().0.to_vec(), corners.map(i32::to_le_bytes));
            }
        }
    }
}
