//! What no file may hold, and where things are put: all is checked before the first byte is written.

use super::{MeshFormat, MeshOptions, Unit, Up};
use crate::{mesh::Mesh, output::WriteError};

/// How far from 1 the length of a normal may be; validators of glTF allow more.
const NORMAL_SLACK: f32 = 1e-3;

/// Vertices of a file: the largest number of 32 bits marks the end of a strip to some readers.
const MAX_VERTICES: u64 = u32::MAX as u64;

/// From the scene's axes and lengths to those of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placing {
    up: Up,
    scale: f64,
}

impl Placing {
    /// Where a point of the scene is in the file.
    pub(super) fn position(self, p: [f32; 3]) -> [f32; 3] {
        self.direction(p.map(|c| (f64::from(c) * self.scale) as f32))
    }

    /// Where a direction of the scene points in the file. Zero has no sign, so that files do not
    /// differ by it.
    pub(super) fn direction(self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        match self.up {
            Up::Y => [x, z, -y],
            Up::Z => [x, y, z],
        }
        .map(|c| c + 0.0)
    }
}

/// A vector as binary formats store it.
pub(super) fn bytes(v: [f32; 3]) -> [u8; 12] {
    let mut bytes = [0; 12];
    for (to, c) in bytes.as_chunks_mut().0.iter_mut().zip(v) {
        *to = c.to_le_bytes();
    }
    bytes
}

/// The corners of a triangle as binary formats store them, when its mesh's vertices begin at `first`.
pub(super) fn corner_bytes(triangle: [u32; 3], first: u32) -> [u8; 12] {
    let mut bytes = [0; 12];
    for (to, v) in bytes.as_chunks_mut().0.iter_mut().zip(triangle) {
        *to = (first + v).to_le_bytes();
    }
    bytes
}

/// How to write `meshes` in a format.
///
/// # Errors
/// If there is nothing to write, if a mesh is broken, or if there is more than any format can count.
pub(super) fn placing(
    meshes: &[Mesh],
    options: &MeshOptions,
    format: MeshFormat,
) -> Result<Placing, WriteError> {
    let to_meters = match format {
        MeshFormat::Glb | MeshFormat::Gltf => options.unit.map_or(1.0, Unit::meters),
        _ => 1.0,
    };
    let placing =
        Placing { up: options.up.unwrap_or(format.usual_up()), scale: options.scale * to_meters };
    if !(options.scale > 0.0 && placing.scale.is_normal()) {
        return Err(refusal(format!("a scale of {} leaves nothing", options.scale)));
    }
    if meshes.is_empty() {
        return Err(refusal("there is no mesh".into()));
    }
    for mesh in meshes {
        let said = |what: String| refusal(format!("the mesh of `{}` {what}", mesh.name));
        check(mesh, placing).map_err(said)?;
    }
    limit("vertices", meshes.iter().map(|mesh| mesh.positions.len() as u64).sum(), MAX_VERTICES)?;
    Ok(placing)
}

/// That a count is not above what a format can hold.
///
/// # Errors
/// If it is.
pub(super) fn limit(what: &str, n: u64, max: u64) -> Result<(), WriteError> {
    match n <= max {
        true => Ok(()),
        false => Err(refusal(format!("{n} {what} are more than the format can hold, {max}"))),
    }
}

pub(super) fn refusal(reason: String) -> WriteError {
    WriteError::Encode(reason)
}

/// What is wrong with a mesh, as the end of a sentence.
fn check(mesh: &Mesh, placing: Placing) -> Result<(), String> {
    let n = mesh.positions.len();
    if n == 0 || mesh.triangles.is_empty() {
        return Err("is empty".into());
    }
    if mesh.normals.len() != n {
        return Err(format!("has {n} vertices and {} normals", mesh.normals.len()));
    }
    let is_nowhere = |&p: &[f32; 3]| !placing.position(p).iter().all(|c| c.is_finite());
    if let Some(i) = mesh.positions.iter().position(is_nowhere) {
        return Err(format!("has a vertex at {:?}, which no file can hold", mesh.positions[i]));
    }
    let is_no_unit = |n: &[f32; 3]| {
        let length = n.iter().map(|c| c * c).sum::<f32>().sqrt();
        // Not a number is no unit either.
        !(1.0 - NORMAL_SLACK..=1.0 + NORMAL_SLACK).contains(&length)
    };
    if let Some(i) = mesh.normals.iter().position(is_no_unit) {
        return Err(format!("has a normal {:?}, which is not of length 1", mesh.normals[i]));
    }
    if let Some(v) = mesh.triangles.as_flattened().iter().find(|&&v| v as usize >= n) {
        return Err(format!("has a triangle with vertex {v}, and {n} vertices"));
    }
    if !mesh.color.iter().all(|c| (0.0..=1.0).contains(c)) {
        return Err(format!("has the colour {:?}", mesh.color));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{super::sample, *};

    fn said(change: impl Fn(&mut Mesh)) -> String {
        let mut meshes = sample::meshes();
        change(&mut meshes[1]);
        let options = MeshOptions { scale: 2.0, ..MeshOptions::default() };
        placing(&meshes, &options, MeshFormat::Glb).unwrap_err().to_string()
    }

    #[test]
    fn broken_meshes_are_refused_by_name() {
        let name = &sample::meshes()[1].name;
        for (outcome, what) in [
            (said(|mesh| mesh.triangles.clear()), "is empty"),
            (said(|mesh| *mesh = Mesh { name: mesh.name.clone(), ..Mesh::default() }), "is empty"),
            (said(|mesh| mesh.normals.truncate(2)), "has 4 vertices and 2 normals"),
            (said(|mesh| mesh.positions[2][1] = f32::NAN), "has a vertex at [0.0, NaN"),
            (said(|mesh| mesh.positions[2][1] = f32::MAX), "has a vertex at [0.0, 3.4"),
            (said(|mesh| mesh.normals[2] = [0.0; 3]), "has a normal [0.0, 0.0, 0.0]"),
            (said(|mesh| mesh.normals[2][0] = f32::NAN), "has a normal [NaN"),
            (said(|mesh| mesh.triangles[0][1] = 4), "has a triangle with vertex 4, and 4"),
            (said(|mesh| mesh.color[0] = f32::NAN), "has the colour [NaN"),
        ] {
            assert!(outcome.starts_with(&format!("the mesh of `{name}` {what}")), "{outcome}");
        }
    }

    #[test]
    fn scales_must_leave_something() {
        for scale in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-320] {
            let options = MeshOptions { scale, ..MeshOptions::default() };
            assert!(placing(&sample::meshes(), &options, MeshFormat::Stl).is_err());
        }
    }

    #[test]
    fn only_gltf_lengths_are_metres() {
        let options =
            MeshOptions { scale: 10.0, unit: Some(Unit::Millimeter), ..MeshOptions::default() };
        let place = |format| {
            let placing = placing(&sample::meshes(), &options, format).unwrap();
            placing.position([1.0, 2.0, -0.0])
        };
        assert_eq!(place(MeshFormat::Glb), [0.01, 0.0, -0.02]);
        assert_eq!(place(MeshFormat::Stl), [10.0, 20.0, 0.0]);
        assert!(place(MeshFormat::Stl)[2].is_sign_positive());
    }

    #[test]
    fn limits_are_inclusive() {
        assert!(limit("vertices", MAX_VERTICES, MAX_VERTICES).is_ok());
        let said = limit("vertices", MAX_VERTICES + 1, MAX_VERTICES).unwrap_err().to_string();
        assert_eq!(said, "4294967296 vertices are more than the format can hold, 4294967295");
    }
}
