//! Wavefront OBJ: text that everything reads, and its materials.
//!
//! Each mesh is an object with a material of its name. Vertices carry colours as well, which MeshLab
//! shows. Colours are sRGB, as nearly all readers take them; Blender takes those of vertices so, and
//! those of materials for linear ones, which makes them paler. Numbers are the shortest that are read
//! back as the same f32, without exponents, which some readers do not know.
//!
//! *Based on:* Wavefront Technologies, "Object Files (.obj)" and "MTL material format", 1995.

use std::io::Write;

use super::{MeshFormat, MeshOptions, check::placing};
use crate::{
    mesh::Mesh,
    output::{SOFTWARE, WriteError, png::srgb_code},
};

/// Writes all meshes. `library` is the name of the file beside it with [`write_materials`].
///
/// # Errors
/// If `out` fails, or a mesh is empty or broken.
pub fn write(
    meshes: &[Mesh],
    options: &MeshOptions,
    library: &str,
    mut out: impl Write,
) -> Result<(), WriteError> {
    let placing = placing(meshes, options, MeshFormat::Obj)?;
    writeln!(out, "# {SOFTWARE}\nmtllib {library}")?;
    let mut first = 1_u64;
    for (mesh, label) in meshes.iter().zip(labels(meshes)) {
        writeln!(out, "o {label}")?;
        let [r, g, b] = srgb(mesh.color);
        for &p in &mesh.positions {
            let [x, y, z] = placing.position(p);
            writeln!(out, "v {x} {y} {z} {r} {g} {b}")?;
        }
        for &n in &mesh.normals {
            let [x, y, z] = placing.direction(n);
            writeln!(out, "vn {x} {y} {z}")?;
        }
        writeln!(out, "usemtl {label}")?;
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|v| first + u64::from(v));
            writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}")?;
        }
        first += mesh.positions.len() as u64;
    }
    Ok(())
}

/// Writes the materials of all meshes.
///
/// # Errors
/// If `out` fails.
pub fn write_materials(meshes: &[Mesh], mut out: impl Write) -> Result<(), WriteError> {
    writeln!(out, "# {SOFTWARE}")?;
    for (mesh, label) in meshes.iter().zip(labels(meshes)) {
        let [r, g, b] = srgb(mesh.color);
        // Illumination model 1: with light and without highlights.
        writeln!(out, "newmtl {label}\nKd {r} {g} {b}\nillum 1")?;
    }
    Ok(())
}

fn srgb(color: [f32; 3]) -> [f32; 3] {
    color.map(|c| f32::from(srgb_code(c)) / 255.0)
}

/// Names that are one word to every reader, each only once.
fn labels(meshes: &[Mesh]) -> Vec<String> {
    let mut labels: Vec<String> = Vec::new();
    for mesh in meshes {
        // `#` begins a comment, and a backslash may join lines.
        let is_bad = |c: char| c.is_whitespace() || c.is_control() || c == '#' || c == '\\';
        let mut label = mesh.name.replace(is_bad, "_");
        if label.is_empty() {
            label.push_str("surface");
        }
        let plain = label.clone();
        let mut n = 1;
        while labels.contains(&label) {
            n += 1;
            label = format!("{plain}_{n}");
        }
        labels.push(label);
    }
    labels
}

#[cfg(test)]
mod tests {
    use super::{
        super::{Up, sample::*, write_meshes},
        *,
    };
    use crate::polygons::Polygons;
    use std::io::Cursor;

    fn text(options: &MeshOptions) -> String {
        let mut file = Vec::new();
        write(&meshes(), options, "a b.mtl", &mut file).unwrap();
        String::from_utf8(file).unwrap()
    }

    #[test]
    fn others_read_the_same_numbers() {
        for (up, place) in [(None, y_up as fn([f32; 3]) -> [f32; 3]), (Some(Up::Z), |p| p)] {
            let options = MeshOptions { up, ..MeshOptions::default() };
            let mut materials = Vec::new();
            write_materials(&meshes(), &mut materials).unwrap();
            let (models, materials) = tobj::load_obj_buf(
                &mut Cursor::new(text(&options)),
                &tobj::LoadOptions { single_index: true, ..tobj::LoadOptions::default() },
                |name| {
                    assert_eq!(name.to_str(), Some("a b.mtl"));
                    tobj::load_mtl_buf(&mut Cursor::new(&materials))
                },
            )
            .unwrap();
            let materials = materials.unwrap();
            assert_eq!((models.len(), materials.len()), (2, 2));
            for (model, mesh) in models.iter().zip(meshes()) {
                assert_eq!(model.name, mesh.name.replace(' ', "_"));
                let read = &model.mesh;
                let material = &materials[read.material_id.unwrap()];
                assert_eq!(material.name, model.name);
                assert_eq!(material.diffuse, Some(srgb(mesh.color)));
                assert_eq!(read.vertex_color.as_chunks::<3>().0[0], srgb(mesh.color));
                // The reader numbers vertices as faces name them.
                let vector = |of: &[f32], i: u32| of.as_chunks::<3>().0[i as usize];
                let (triangles, _) = read.indices.as_chunks::<3>();
                assert_eq!(triangles.len(), mesh.triangles.len());
                for (triangle, ours) in triangles.iter().zip(&mesh.triangles) {
                    for (&i, &v) in triangle.iter().zip(ours) {
                        let v = v as usize;
                        assert_eq!(vector(&read.positions, i), place(mesh.positions[v]));
                        assert_eq!(vector(&read.normals, i), place(mesh.normals[v]));
                    }
                }
            }
        }
    }

    #[test]
    fn it_can_be_drawn_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        write_meshes(&path, MeshFormat::Obj, &meshes(), &MeshOptions::default()).unwrap();
        let read = Polygons::read(&path).unwrap();
        assert_eq!((read.positions.len(), read.triangles.len()), (8, 6));
        assert!((read.colors[0][1] - meshes()[0].color[1]).abs() < 0.003);
    }

    #[test]
    fn numbers_have_neither_exponents_nor_negative_zeros() {
        let text = text(&MeshOptions::default());
        let numbers = text.lines().filter(|line| line.starts_with('v'));
        assert!(numbers.clone().all(|line| !line[2..].contains(['e', 'E'])));
        assert!(text.contains("\nv 0.1 0.0000001 0 "));
        assert!(text.contains("\nv 0.33333334 -0.000000000001 -0.25 "));
    }

    #[test]
    fn labels_are_words_and_differ() {
        let named = |name: &str| Mesh { name: name.into(), ..Mesh::default() };
        let meshes = ["a b", "a\tb", "a_b_2", "", "#\\", "é"].map(named);
        assert_eq!(labels(&meshes), ["a_b", "a_b_2", "a_b_2_2", "surface", "__", "é"]);
    }
}
