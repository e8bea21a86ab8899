//! Meshes to files that other programs open: one module per format, and what all of them share.
//!
//! Scenes are z-up. A file has the axis up that its readers take for granted: formats that are read as
//! y-up get (x, z, −y), a rotation, so that what was outside stays outside. Positions are scaled in
//! f64 and rounded once.

mod check;
mod gltf;
mod obj;
mod ply;
#[cfg(test)]
mod sample;
mod stl;
mod threemf;

use std::path::{Path, PathBuf};

pub use gltf::{write_glb, write_gltf};
pub use obj::{write as write_obj, write_materials as write_mtl};
pub use ply::write as write_ply;
pub use stl::write as write_stl;
pub use threemf::write as write_3mf;

use super::write_file;
use crate::{Result, mesh::Mesh};

/// The axis of a file that points where z does in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Up {
    /// The second coordinate.
    Y,
    /// The third coordinate.
    Z,
}

/// What one length in a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A millionth of a metre.
    Micron,
    /// A thousandth of a metre.
    Millimeter,
    /// A hundredth of a metre.
    Centimeter,
    /// 25.4 millimetres.
    Inch,
    /// 12 inches.
    Foot,
    /// The metre.
    Meter,
}

impl Unit {
    /// How many metres it has.
    #[must_use]
    pub fn meters(self) -> f64 {
        match self {
            Self::Micron => 1e-6,
            Self::Millimeter => 1e-3,
            Self::Centimeter => 1e-2,
            Self::Inch => 0.0254,
            Self::Foot => 0.3048,
            Self::Meter => 1.0,
        }
    }
}

/// How meshes stand in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshOptions {
    /// Which axis points up; `None` is [what readers of the format expect](MeshFormat::usual_up).
    pub up: Option<Up>,
    /// Lengths in the file for each in the scene; positive. Vertices that are neighbours in f32 may
    /// come to lie at one place unless it is a power of two.
    pub scale: f64,
    /// What a length in the file is. 3MF says so, and for glTF, whose lengths are metres, lengths are
    /// converted. With `None`, a scaled length is a metre in glTF and a millimetre in 3MF, which is
    /// what their readers show at a handy size.
    pub unit: Option<Unit>,
    /// The scene's name.
    pub scene: String,
}

impl Default for MeshOptions {
    fn default() -> Self {
        Self { up: None, scale: 1.0, unit: None, scene: String::new() }
    }
}

/// The formats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// glTF 2.0, binary.
    Glb,
    /// glTF 2.0 as text, its buffer included.
    Gltf,
    /// Wavefront OBJ, with its materials in a file beside it.
    Obj,
    /// PLY, binary.
    Ply,
    /// STL, binary.
    Stl,
    /// 3D Manufacturing Format.
    ThreeMf,
}

impl MeshFormat {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Glb, Self::Gltf, Self::Obj, Self::Ply, Self::Stl, Self::ThreeMf];

    /// The ending of its files, without a dot.
    #[must_use]
    pub fn ending(self) -> &'static str {
        match self {
            Self::Glb => "glb",
            Self::Gltf => "gltf",
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Stl => "stl",
            Self::ThreeMf => "3mf",
        }
    }

    /// The axis that points up for those who read it: glTF says y, OBJ is taken for y-up, and the
    /// others are shown and printed as they are, on tables where z is up.
    #[must_use]
    pub fn usual_up(self) -> Up {
        match self {
            Self::Glb | Self::Gltf | Self::Obj => Up::Y,
            Self::Ply | Self::Stl | Self::ThreeMf => Up::Z,
        }
    }
}

/// Writes `meshes` into the file at `path`; with OBJ, materials go into a `.mtl` file beside it. Gives
/// the files that were written.
///
/// # Errors
/// [`Error::Encode`](crate::Error::Encode) if a mesh is empty or broken or does not fit the format, and
/// then nothing is written; [`Error::Io`](crate::Error::Io) as [`write_file`].
pub fn write_meshes(
    path: &Path,
    format: MeshFormat,
    meshes: &[Mesh],
    options: &MeshOptions,
) -> Result<Vec<PathBuf>> {
    let mut written = Vec::new();
    match format {
        MeshFormat::Glb => write_file(path, |out| write_glb(meshes, options, out))?,
        MeshFormat::Gltf => write_file(path, |out| write_gltf(meshes, options, out))?,
        MeshFormat::Obj => {
            // The materials first: no OBJ file is ever without them.
            let library = path.with_extension("mtl");
            check::placing(meshes, options, format)
                .map_err(|error| super::failed_to_write(path, error))?;
            write_file(&library, |out| write_mtl(meshes, out))?;
            let name = library.file_name().unwrap_or_default().to_string_lossy().into_owned();
            written.push(library);
            write_file(path, |out| write_obj(meshes, options, &name, out))?;
        }
        MeshFormat::Ply => write_file(path, |out| write_ply(meshes, options, out))?,
        MeshFormat::Stl => write_file(path, |out| write_stl(meshes, options, out))?,
        MeshFormat::ThreeMf => write_file(path, |out| write_3mf(meshes, options, out))?,
    }
    written.insert(0, path.to_owned());
    Ok(written)
}

#[cfg(test)]
mod tests {
    use super::{sample::meshes, *};
    use crate::Error;
    use std::fs;

    fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
        let mut files: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap())
            .map(|entry| {
                (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap())
            })
            .collect();
        files.sort();
        files
    }

    #[test]
    fn every_format_has_its_files_and_bytes_repeat() {
        let write = || {
            let folder = tempfile::tempdir().unwrap();
            let mut written = Vec::new();
            for format in MeshFormat::ALL {
                let path = folder.path().join("a").with_extension(format.ending());
                let options = MeshOptions { scene: "a".into(), ..MeshOptions::default() };
                let all = write_meshes(&path, format, &meshes(), &options).unwrap();
                written.extend(all.into_iter().map(|path| path.file_name().unwrap().to_owned()));
            }
            (written, files(folder.path()))
        };
        let (written, first) = write();
        assert_eq!(written, ["a.glb", "a.gltf", "a.obj", "a.mtl", "a.ply", "a.stl", "a.3mf"]);
        assert_eq!(first.len(), 7);
        assert_eq!(first, write().1);
    }

    #[test]
    fn what_is_refused_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        for format in MeshFormat::ALL {
            let path = folder.path().join("a").with_extension(format.ending());
            let outcome = write_meshes(&path, format, &[], &MeshOptions::default());
            assert!(matches!(outcome, Err(Error::Encode { .. })));
        }
        assert_eq!(files(folder.path()), []);
    }
}
