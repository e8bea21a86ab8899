//! glTF 2.0, binary or as text: what Blender, browsers and engines read best.
//!
//! Each mesh is a node with positions, normals and 32-bit indices, one after the other in one buffer,
//! and a material that is no metal: the default is, and black without surroundings to mirror. Lengths
//! are metres. Placing is in the positions; a rotation of the node would be left on the object.
//!
//! *Based on:* Khronos Group, "glTF 2.0 Specification", 2021.

use std::io::{self, Write};

use base64::{Engine as _, engine::general_purpose::STANDARD};
use gltf::json::{
    self, Index, Root, Value,
    accessor::{ComponentType, GenericComponentType, Type},
    buffer::Target,
    extras::RawValue,
    material::{PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor},
    mesh::{Mode, Semantic},
    validation::Checked::Valid,
};

use super::{
    MeshFormat, MeshOptions,
    check::{Placing, bytes, corner_bytes, limit, placing, refusal},
};
use crate::{
    mesh::Mesh,
    output::{SOFTWARE, WriteError},
};

/// Between a mirror and chalk: a soft highlight, as the scene's pictures have.
const ROUGHNESS: f32 = 0.5;

/// Bytes of a vector, and of a triangle's indices.
const BYTES: u64 = 12;

/// Bytes of a GLB file besides its document and its buffer.
const GLB_HEADERS: u64 = 12 + 8 + 8;

/// Writes a GLB file.
///
/// # Errors
/// If `out` fails, or a mesh is empty or broken, or the file would be 4 GiB or more.
pub fn write_glb(
    meshes: &[Mesh],
    options: &MeshOptions,
    mut out: impl Write,
) -> Result<(), WriteError> {
    let placing = placing(meshes, options, MeshFormat::Glb)?;
    let mut text = text(&document(meshes, options, placing, None)?)?;
    // Chunks begin at multiples of four; the buffer is one already.
    while text.len() % 4 != 0 {
        text.push(b' ');
    }
    let n_buffer = n_bytes(meshes);
    let n_file = GLB_HEADERS + text.len() as u64 + n_buffer;
    limit("bytes", n_file, u64::from(u32::MAX))?;
    out.write_all(b"glTF")?;
    out.write_all(&2_u32.to_le_bytes())?;
    out.write_all(&(n_file as u32).to_le_bytes())?;
    chunk_head(b"JSON", text.len() as u64, &mut out)?;
    out.write_all(&text)?;
    chunk_head(b"BIN\0", n_buffer, &mut out)?;
    write_buffer(meshes, placing, &mut out)?;
    Ok(())
}

fn chunk_head(name: &[u8; 4], n: u64, out: &mut impl Write) -> io::Result<()> {
    out.write_all(&(n as u32).to_le_bytes())?;
    out.write_all(name)
}

/// Writes a glTF file that holds its buffer as text, so that it is complete by itself.
///
/// # Errors
/// If `out` fails, or a mesh is empty or broken, or the buffer would be 4 GiB or more.
pub fn write_gltf(
    meshes: &[Mesh],
    options: &MeshOptions,
    mut out: impl Write,
) -> Result<(), WriteError> {
    let placing = placing(meshes, options, MeshFormat::Gltf)?;
    limit("bytes", n_bytes(meshes), u64::from(u32::MAX))?;
    let mut buffer = Vec::with_capacity(n_bytes(meshes) as usize);
    write_buffer(meshes, placing, &mut buffer)?;
    let mut uri = String::from("data:application/octet-stream;base64,");
    STANDARD.encode_string(&buffer, &mut uri);
    drop(buffer);
    out.write_all(&text(&document(meshes, options, placing, Some(uri))?)?)?;
    Ok(())
}

/// Bytes of the buffer.
fn n_bytes(meshes: &[Mesh]) -> u64 {
    let n = |mesh: &Mesh| 2 * mesh.positions.len() as u64 + mesh.triangles.len() as u64;
    BYTES * meshes.iter().map(n).sum::<u64>()
}

/// For each mesh its positions, normals and indices.
fn write_buffer(meshes: &[Mesh], placing: Placing, out: &mut impl Write) -> io::Result<()> {
    for mesh in meshes {
        mesh.positions.iter().try_for_each(|&p| out.write_all(&bytes(placing.position(p))))?;
        mesh.normals.iter().try_for_each(|&n| out.write_all(&bytes(placing.direction(n))))?;
        mesh.triangles.iter().try_for_each(|&t| out.write_all(&corner_bytes(t, 0)))?;
    }
    Ok(())
}

fn text(document: &Root) -> Result<Vec<u8>, WriteError> {
    document.to_vec().map_err(|error| refusal(error.to_string()))
}

/// What describes the buffer, which is in the file or at `uri`.
fn document(
    meshes: &[Mesh],
    options: &MeshOptions,
    placing: Placing,
    uri: Option<String>,
) -> Result<Root, WriteError> {
    let asset = json::Asset { generator: Some(SOFTWARE.into()), ..json::Asset::default() };
    let mut root = Root { asset, ..Root::default() };
    let buffer = json::Buffer {
        byte_length: n_bytes(meshes).into(),
        name: None,
        uri,
        extensions: None,
        extras: None,
    };
    let mut views = Views { buffer: root.push(buffer), offset: 0 };
    // Blender keeps what nodes say, and drops what the file as a whole says.
    let extras = serde_json::json!({ "scene": options.scene }).to_string();
    let extras = RawValue::from_string(extras).map_err(|error| refusal(error.to_string()))?;
    let mut nodes = Vec::new();
    for mesh in meshes {
        let primitive = primitive(mesh, placing, &mut views, &mut root);
        let mesh_index = root.push(json::Mesh {
            name: Some(mesh.name.clone()),
            primitives: vec![primitive],
            weights: None,
            extensions: None,
            extras: None,
        });
        nodes.push(root.push(json::Node {
            mesh: Some(mesh_index),
            name: Some(mesh.name.clone()),
            extras: Some(extras.clone()),
            ..json::Node::default()
        }));
    }
    let name = (!options.scene.is_empty()).then(|| options.scene.clone());
    root.scene = Some(root.push(json::Scene { nodes, name, extensions: None, extras: None }));
    Ok(root)
}

/// The triangles of a mesh and how they look.
fn primitive(
    mesh: &Mesh,
    placing: Placing,
    views: &mut Views,
    root: &mut Root,
) -> json::mesh::Primitive {
    let [r, g, b] = mesh.color;
    let material = root.push(json::Material {
        name: Some(mesh.name.clone()),
        // The inside of a closed surface is never seen.
        double_sided: mesh.is_open(),
        pbr_metallic_roughness: PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor([r, g, b, 1.0]),
            metallic_factor: StrengthFactor(0.0),
            roughness_factor: StrengthFactor(ROUGHNESS),
            ..PbrMetallicRoughness::default()
        },
        ..json::Material::default()
    });
    let n = mesh.positions.len();
    let (min, max) = bounds(mesh, placing);
    let mut accessor = |target, n_vectors, count: usize, component_type, type_| json::Accessor {
        buffer_view: Some(views.push(target, n_vectors, root)),
        byte_offset: None,
        count: count.into(),
        component_type: Valid(GenericComponentType(component_type)),
        type_: Valid(type_),
        min: None,
        max: None,
        name: None,
        normalized: false,
        sparse: None,
        extensions: None,
        extras: None,
    };
    let mut vectors = || accessor(Target::ArrayBuffer, n, n, ComponentType::F32, Type::Vec3);
    let positions = json::Accessor { min: Some(min), max: Some(max), ..vectors() };
    let normals = vectors();
    let n = mesh.triangles.len();
    let indices = accessor(Target::ElementArrayBuffer, n, 3 * n, ComponentType::U32, Type::Scalar);
    let attributes = [
        (Valid(Semantic::Positions), root.push(positions)),
        (Valid(Semantic::Normals), root.push(normals)),
    ];
    json::mesh::Primitive {
        attributes: attributes.into(),
        indices: Some(root.push(indices)),
        material: Some(material),
        mode: Valid(Mode::Triangles),
        targets: None,
        extensions: None,
        extras: None,
    }
}

/// The parts of the buffer, one after the other.
struct Views {
    buffer: Index<json::Buffer>,
    offset: u64,
}

impl Views {
    fn push(
        &mut self,
        target: Target,
        n_vectors: usize,
        root: &mut Root,
    ) -> Index<json::buffer::View> {
        let length = BYTES * n_vectors as u64;
        let offset = self.offset;
        self.offset += length;
        root.push(json::buffer::View {
            buffer: self.buffer,
            byte_length: length.into(),
            byte_offset: Some(offset.into()),
            byte_stride: None,
            target: Some(Valid(target)),
            name: None,
            extensions: None,
            extras: None,
        })
    }
}

/// The corners of the box around what is written, which must match it to the bit.
fn bounds(mesh: &Mesh, placing: Placing) -> (Value, Value) {
    let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for &p in &mesh.positions {
        for (axis, c) in placing.position(p).into_iter().enumerate() {
            min[axis] = min[axis].min(c);
            max[axis] = max[axis].max(c);
        }
    }
    (Value::from(min.to_vec()), Value::from(max.to_vec()))
}

#[cfg(test)]
mod tests {
    use super::{
        super::{Unit, Up, sample::*, write_meshes},
        *,
    };
    use crate::polygons::Polygons;
    use gltf::{Gltf, buffer::Source};

    fn glb(options: &MeshOptions) -> Vec<u8> {
        let mut file = Vec::new();
        write_glb(&meshes(), options, &mut file).unwrap();
        file
    }

    #[test]
    fn others_read_the_same_numbers() {
        for (up, place) in [(None, y_up as fn([f32; 3]) -> [f32; 3]), (Some(Up::Z), |p| p)] {
            let options = MeshOptions { up, scene: "Würfel".into(), ..MeshOptions::default() };
            let file = glb(&options);
            assert_eq!(u32::from_le_bytes(file[8..12].try_into().unwrap()) as usize, file.len());
            let Gltf { document, blob } = Gltf::from_slice(&file).unwrap();
            let blob = blob.unwrap();
            let scene = document.default_scene().unwrap();
            assert_eq!(scene.name(), Some("Würfel"));
            assert_eq!(scene.nodes().len(), 2);
            for (node, mesh) in scene.nodes().zip(meshes()) {
                assert_eq!(node.name(), Some(mesh.name.as_str()));
                let untouched = ([0.0; 3], [0.0, 0.0, 0.0, 1.0], [1.0; 3]);
                assert_eq!(node.transform().decomposed(), untouched);
                assert_eq!(node.extras().as_ref().unwrap().get(), r#"{"scene":"Würfel"}"#);
                let primitive = node.mesh().unwrap().primitives().next().unwrap();
                let material = primitive.material();
                assert_eq!(material.double_sided(), mesh.name == "two words");
                let pbr = material.pbr_metallic_roughness();
                let [r, g, b] = mesh.color;
                assert_eq!(pbr.base_color_factor(), [r, g, b, 1.0]);
                assert_eq!(pbr.metallic_factor(), 0.0);
                let reader = primitive.reader(|_| Some(&blob));
                let positions: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
                let expected: Vec<_> = mesh.positions.iter().map(|&p| place(p)).collect();
                assert_eq!(positions, expected);
                let normals: Vec<[f32; 3]> = reader.read_normals().unwrap().collect();
                assert_eq!(normals, mesh.normals.iter().map(|&n| place(n)).collect::<Vec<_>>());
                let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
                assert_eq!(indices, mesh.triangles.as_flattened());
                let extreme = |f: fn(f32, f32) -> f32, axis: usize| {
                    positions.iter().map(|p| p[axis]).reduce(f).unwrap()
                };
                let bounds = primitive.bounding_box();
                assert_eq!(bounds.min, [0, 1, 2].map(|axis| extreme(f32::min, axis)));
                assert_eq!(bounds.max, [0, 1, 2].map(|axis| extreme(f32::max, axis)));
                let volume = |positions| Mesh { positions, ..mesh.clone() }.shape().volume;
                assert!((volume(positions) - volume(mesh.positions.clone())).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn text_and_binary_are_the_same() {
        let mut text = Vec::new();
        write_gltf(&meshes(), &MeshOptions::default(), &mut text).unwrap();
        let text = Gltf::from_slice(&text).unwrap();
        let binary = Gltf::from_slice(&glb(&MeshOptions::default())).unwrap();
        let buffer = text.buffers().next().unwrap();
        let Source::Uri(uri) = buffer.source() else { panic!("a buffer as text") };
        let (_, data) = uri.split_once(";base64,").unwrap();
        assert_eq!(STANDARD.decode(data).ok(), binary.blob);
        assert_eq!(buffer.length(), binary.buffers().next().unwrap().length());
    }

    #[test]
    fn both_can_be_drawn_again() {
        let folder = tempfile::tempdir().unwrap();
        for format in [MeshFormat::Glb, MeshFormat::Gltf] {
            let path = folder.path().join("a").with_extension(format.ending());
            write_meshes(&path, format, &meshes(), &MeshOptions::default()).unwrap();
            let read = Polygons::read(&path).unwrap();
            let expected: Vec<[f32; 3]> =
                meshes().iter().flat_map(|mesh| mesh.positions.clone()).map(y_up).collect();
            let read_positions: Vec<_> =
                read.positions.iter().map(|p| p.as_vec3().to_array()).collect();
            assert_eq!(read_positions, expected);
            assert_eq!(read.triangles[5], [6, 5, 7]);
            assert_eq!(read.colors[7], meshes()[1].color);
        }
    }

    #[test]
    fn lengths_are_metres() {
        let options = MeshOptions { unit: Some(Unit::Foot), scale: 100.0, ..<_>::default() };
        let file = glb(&options);
        let binary = Gltf::from_slice(&file).unwrap();
        let primitive = binary.meshes().nth(1).unwrap().primitives().next().unwrap();
        assert_eq!(primitive.bounding_box().max[0], (f64::from(123.456_f32) * 30.48) as f32);
    }
}
