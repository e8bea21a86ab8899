//! STL, binary: bare triangles for printers and old programs. No names, colours, units or shared
//! vertices: all meshes together are one.
//!
//! *Based on:* 3D Systems, "StereoLithography Interface Specification", 1989.

use std::io::Write;

use glam::DVec3;

use super::{
    MeshFormat, MeshOptions,
    check::{bytes, limit, placing},
};
use crate::{
    mesh::Mesh,
    output::{SOFTWARE, WriteError},
};

/// Bytes before the count of triangles.
const HEADER: usize = 80;

/// Writes the triangles of all meshes.
///
/// # Errors
/// If `out` fails, or a mesh is empty or broken, or there are more than 2³² − 1 triangles.
pub fn write(
    meshes: &[Mesh],
    options: &MeshOptions,
    mut out: impl Write,
) -> Result<(), WriteError> {
    let placing = placing(meshes, options, MeshFormat::Stl)?;
    let n = meshes.iter().map(|mesh| mesh.triangles.len() as u64).sum();
    limit("triangles", n, u64::from(u32::MAX))?;
    // It must not begin with "solid", which is how files of text begin.
    let mut header = [b' '; HEADER];
    header[..SOFTWARE.len()].copy_from_slice(SOFTWARE.as_bytes());
    out.write_all(&header)?;
    out.write_all(&(n as u32).to_le_bytes())?;
    for mesh in meshes {
        for triangle in &mesh.triangles {
            let corners = triangle.map(|v| placing.position(mesh.positions[v as usize]));
            out.write_all(&bytes(facet_normal(corners)))?;
            for corner in corners {
                out.write_all(&bytes(corner))?;
            }
            // Some programs keep a colour here, each in its own way.
            out.write_all(&[0, 0])?;
        }
    }
    Ok(())
}

/// Of the corners as they are written; zero if they span no area, as readers expect.
fn facet_normal(corners: [[f32; 3]; 3]) -> [f32; 3] {
    let [a, b, c] = corners.map(|p| DVec3::from_array(p.map(f64::from)));
    let normal = (b - a).cross(c - a).normalize_or_zero();
    normal.to_array().map(|c| c as f32 + 0.0)
}

#[cfg(test)]
mod tests {
    use super::{
        super::{Up, sample::*},
        *,
    };

    #[test]
    fn triangles_are_where_they_were() {
        for (up, place) in [(None, (|p| p) as fn([f32; 3]) -> [f32; 3]), (Some(Up::Y), y_up)] {
            let mut file = Vec::new();
            write(&meshes(), &MeshOptions { up, ..MeshOptions::default() }, &mut file).unwrap();
            assert!(file.starts_with(b"zeroset "));
            assert_eq!(u32::from_le_bytes(file[80..84].try_into().unwrap()), 6);
            let (facets, rest) = file[84..].as_chunks::<50>();
            assert_eq!((facets.len(), rest.len()), (6, 0));
            let meshes = meshes();
            let triangles = meshes.iter().flat_map(|m| m.triangles.iter().map(move |t| (m, t)));
            for (facet, (mesh, triangle)) in facets.iter().zip(triangles) {
                let [n, a, b, c] = [0, 12, 24, 36].map(|at: usize| {
                    [0, 4, 8]
                        .map(|i| f32::from_le_bytes(facet[at + i..at + i + 4].try_into().unwrap()))
                });
                assert_eq!([a, b, c], triangle.map(|v| place(mesh.positions[v as usize])));
                let [a, b, c, n] = [a, b, c, n].map(glam::Vec3::from_array);
                assert!((b - a).cross(c - a).normalize().dot(n) > 0.9999);
                assert_eq!(facet[48..], [0, 0]);
            }
        }
    }

    #[test]
    fn flat_triangles_have_no_normal() {
        assert_eq!(facet_normal([[1.0; 3], [2.0; 3], [3.0; 3]]), [0.0; 3]);
    }
}
