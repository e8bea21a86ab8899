//! glTF 2.0, as text or binary.

use std::path::Path;

use base64::{Engine as _, engine::general_purpose::STANDARD};
use glam::{DAffine3, DMat4, DVec3};
use gltf::{Document, Gltf, Node, buffer, mesh::Mode};

use super::{Raw, Refusal, normal_matrix, read_bytes};
use crate::files;

/// How deep nodes may be nested.
const MAX_DEPTH: u32 = 64;

/// All triangles of the file's scene, where its nodes place them, with the colours of vertices
/// times those of materials. Textures are not looked at.
pub(super) fn read(path: &Path) -> Result<Raw, Refusal> {
    let bytes = read_bytes(path)?;
    let Gltf { document, mut blob } = Gltf::from_slice(&bytes)
        .map_err(|error| format!("it is not a valid glTF file: {error}"))?;
    let buffers: Result<Vec<Vec<u8>>, Refusal> =
        document.buffers().map(|buffer| bytes_of(&buffer, &mut blob, path)).collect();
    let buffers = buffers?;
    check_views(&document, &buffers)?;
    let mut raw = Raw::default();
    let scene = document.default_scene().or_else(|| document.scenes().next());
    let scene = scene.ok_or("it has no scene")?;
    for node in scene.nodes() {
        add(&node, DAffine3::IDENTITY, &buffers, &mut raw, 0)?;
    }
    Ok(raw)
}

/// The bytes of a buffer: in the file, or beside it.
fn bytes_of(
    buffer: &gltf::Buffer<'_>,
    blob: &mut Option<Vec<u8>>,
    path: &Path,
) -> Result<Vec<u8>, Refusal> {
    let index = buffer.index();
    let bytes = match buffer.source() {
        buffer::Source::Bin => blob.take().ok_or("its binary part is missing")?,
        buffer::Source::Uri(uri) => match uri.strip_prefix("data:") {
            Some(data) => {
                let (_, text) = data.split_once(";base64,").ok_or("a data URI is not base64")?;
                STANDARD.decode(text).map_err(|error| format!("buffer {index}: {error}"))?
            }
            None => {
                let beside = files::beside(path, uri)
                    .ok_or_else(|| format!("buffer {index} does not lie beside it: {uri}"))?;
                read_bytes(&beside)?
            }
        },
    };
    if bytes.len() < buffer.length() {
        let (found, length) = (bytes.len(), buffer.length());
        return Err(format!("buffer {index} holds {found} bytes instead of {length}"));
    }
    Ok(bytes)
}

/// Whether what accessors read lies in their buffers.
fn check_views(document: &Document, buffers: &[Vec<u8>]) -> Result<(), Refusal> {
    for view in document.views() {
        let held = buffers.get(view.buffer().index()).map_or(0, Vec::len);
        if view.offset().checked_add(view.length()).is_none_or(|end| end > held) {
            return Err(format!("buffer view {} is longer than its buffer", view.index()));
        }
    }
    for accessor in document.accessors() {
        let Some(view) = accessor.view() else { continue };
        let stride = view.stride().unwrap_or(accessor.size());
        let before_last = accessor.count().saturating_sub(1).checked_mul(stride);
        let end = before_last
            .and_then(|n| n.checked_add(accessor.offset())?.checked_add(accessor.size()));
        if accessor.count() > 0 && end.is_none_or(|end| end > view.length()) {
            return Err(format!("accessor {} is longer than its buffer view", accessor.index()));
        }
    }
    Ok(())
}

/// Adds the triangles of a node and of those below.
fn add(
    node: &Node<'_>,
    above: DAffine3,
    buffers: &[Vec<u8>],
    raw: &mut Raw,
    depth: u32,
) -> Result<(), Refusal> {
    if depth > MAX_DEPTH {
        return Err(format!("its nodes are nested more than {MAX_DEPTH} deep"));
    }
    let matrix = node.transform().matrix().map(|column| column.map(f64::from));
    let placing = above * DAffine3::from_mat4(DMat4::from_cols_array_2d(&matrix));
    for primitive in node.mesh().iter().flat_map(gltf::Mesh::primitives) {
        let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
        let Some(positions) = reader.read_positions() else { continue };
        let first = raw.positions.len() as u32;
        let wide = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
        raw.positions.extend(positions.map(|p| placing.transform_point3(wide(p))));
        let n = raw.positions.len() as u32 - first;
        let turn = normal_matrix(placing.matrix3);
        raw.normals.extend(reader.read_normals().into_iter().flatten().map(|v| turn * wide(v)));
        raw.normals.resize(raw.positions.len(), DVec3::ZERO);
        let [r, g, b, _] = primitive.material().pbr_metallic_roughness().base_color_factor();
        let colors = reader.read_colors(0).map(|colors| colors.into_rgb_f32());
        raw.has_colors |= colors.is_some() || primitive.material().index().is_some();
        let tinted = colors.into_iter().flatten().map(|c| [r * c[0], g * c[1], b * c[2]]);
        raw.colors.extend(tinted);
        raw.colors.resize(raw.positions.len(), [r, g, b]);
        let indices: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..n).collect(),
        };
        if let Some(i) = indices.iter().find(|&&i| i >= n) {
            return Err(format!("a face has vertex {i}, and vertices end at {}", i64::from(n) - 1));
        }
        let flips = placing.matrix3.determinant() < 0.0;
        let mut push = |[a, b, c]: [u32; 3]| {
            let corners = if flips { [a, c, b] } else { [a, b, c] };
            raw.triangles.push(corners.map(|i| first + i));
        };
        match primitive.mode() {
            Mode::Triangles => indices.as_chunks().0.iter().for_each(|&corners| push(corners)),
            Mode::TriangleStrip => indices.windows(3).enumerate().for_each(|(i, w)| {
                push(if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] });
            }),
            Mode::TriangleFan => {
                indices.windows(2).skip(1).for_each(|w| push([indices[0], w[0], w[1]]));
            }
            Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => {}
        }
    }
    for child in node.children() {
        add(&child, placing, buffers, raw, depth + 1)?;
    }
    Ok(())
}
