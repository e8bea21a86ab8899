//! PLY: voxels as points with normals and colours, for viewers of point clouds.
//!
//! Binary, little-endian; a point is `x y z nx ny nz` (float), `red green blue` (sRGB) and
//! `certified` (bytes), in the order of surfaces and of voxels.
//!
//! *Based on:* G. Turk, "The PLY Polygon File Format", 1994.

use std::io::{self, Write};

use super::{SOFTWARE, WriteError, png::srgb_code};
use crate::{
    math::Lattice,
    octree::{OctNormal, Storage},
};

/// The voxels of one surface.
#[derive(Clone, Copy)]
pub struct Points<'a> {
    /// The voxels.
    pub storage: &'a dyn Storage,
    /// Linear-light red, green and blue.
    pub color: [f32; 3],
}

/// Writes the centres of all voxels.
///
/// # Errors
/// If `out` fails.
pub fn write(
    surfaces: &[Points<'_>],
    lattice: &Lattice,
    mut out: impl Write,
) -> Result<(), WriteError> {
    let n: u64 = surfaces.iter().map(|points| u64::from(points.storage.voxel_count())).sum();
    begin(&mut out)?;
    element(&mut out, "vertex", n)?;
    properties(&mut out, "float", &["x", "y", "z", "nx", "ny", "nz"])?;
    properties(&mut out, "uchar", &["red", "green", "blue", "certified"])?;
    end(&mut out)?;
    for Points { storage, color } in surfaces {
        let [r, g, b] = color.map(srgb_code);
        for part in storage.parts() {
            let mut bytes = Vec::new();
            storage.visit(part, &mut |voxel| {
                let center = lattice.voxel_center(voxel.ijk).as_vec3();
                let normal = OctNormal::decode(voxel.normal).as_vec3();
                for number in center.to_array().into_iter().chain(normal.to_array()) {
                    bytes.extend(number.to_le_bytes());
                }
                bytes.extend([r, g, b, u8::from(voxel.certified)]);
            });
            out.write_all(&bytes)?;
        }
    }
    Ok(())
}

/// The first lines of a file.
pub(super) fn begin(out: &mut impl Write) -> io::Result<()> {
    write!(out, "ply\nformat binary_little_endian 1.0\ncomment {SOFTWARE}\n")
}

/// That `n` things of a kind follow; their properties are named next.
pub(super) fn element(out: &mut impl Write, name: &str, n: u64) -> io::Result<()> {
    writeln!(out, "element {name} {n}")
}

/// Properties of one type.
pub(super) fn properties(out: &mut impl Write, kind: &str, names: &[&str]) -> io::Result<()> {
    names.iter().try_for_each(|name| writeln!(out, "property {kind} {name}"))
}

/// The last line before the numbers.
pub(super) fn end(out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "end_header")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        math::Aabb,
        octree::{DenseGridBuilder, StoreVoxels as _},
    };
    use glam::DVec3;

    #[test]
    fn every_voxel_is_a_point() {
        let lattice = Lattice::new(Aabb { min: DVec3::ZERO, max: DVec3::ONE }, 4);
        let mut builder = Box::new(DenseGridBuilder::new(2));
        builder.store([1, 0, 3], OctNormal::encode(DVec3::X), true);
        builder.store([2, 0, 0], OctNormal::encode(-DVec3::Z), false);
        let storage = builder.finish();
        let mut bytes = Vec::new();
        let surface = Points { storage: &*storage, color: [1.0, 0.0, 0.0] };
        write(&[surface, surface], &lattice, &mut bytes).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.starts_with("ply\nformat binary_little_endian 1.0\n"));
        assert!(text.contains("element vertex 4\n"));
        let end = b"end_header\n";
        let header = bytes.windows(end.len()).position(|w| w == end).unwrap() + end.len();
        let (points, rest) = bytes[header..].as_chunks::<28>();
        assert_eq!((points.len(), rest.len()), (4, 0));
        let number = |at: usize| f32::from_le_bytes(points[0][at..at + 4].try_into().unwrap());
        assert_eq!([number(0), number(4), number(8)], [0.625, 0.125, 0.125]);
        assert_eq!([number(12), number(16), number(20)], [0.0, 0.0, -1.0]);
        assert_eq!(points[0][24..], [255, 0, 0, 0]);
    }
}
