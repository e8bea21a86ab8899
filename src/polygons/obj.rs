//! Wavefront OBJ.

use std::{io::Cursor, path::Path};

use glam::DVec3;

use super::{Raw, Refusal, read_bytes};
use crate::{files, math::linear_from_srgb};

/// All groups of a file together, polygons cut into triangles, with the colours of vertices or
/// else of materials.
pub(super) fn read(path: &Path) -> Result<Raw, Refusal> {
    let bytes = read_bytes(path)?;
    let options =
        tobj::LoadOptions { triangulate: true, single_index: true, ..tobj::LoadOptions::default() };
    // A material library that is missing costs its colours, not the model; one that lies
    // elsewhere is not looked for.
    let material = |name: &Path| {
        let beside = name.to_str().and_then(|name| files::beside(path, name));
        let bytes = beside.and_then(|beside| read_bytes(&beside).ok());
        bytes.map_or(Err(tobj::LoadError::OpenFileFailed), |bytes| {
            tobj::load_mtl_buf(&mut Cursor::new(bytes))
        })
    };
    let (models, materials) = tobj::load_obj_buf(&mut Cursor::new(bytes), &options, material)
        .map_err(|error| format!("it is not a valid OBJ file: {error}"))?;
    let materials = materials.unwrap_or_default();
    let mut raw = Raw::default();
    for tobj::Model { mesh, .. } in &models {
        let first = raw.positions.len() as u32;
        let n = mesh.positions.len() / 3;
        let vector = |of: &[f32], i: usize| of.get(3 * i..3 * i + 3).map(|v| [v[0], v[1], v[2]]);
        let wide = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
        let base = mesh.material_id.and_then(|id| materials.get(id)?.diffuse);
        raw.has_colors |= base.is_some() || !mesh.vertex_color.is_empty();
        for i in 0..n {
            raw.positions.extend(vector(&mesh.positions, i).map(wide));
            raw.normals.push(vector(&mesh.normals, i).map_or(DVec3::ZERO, wide));
            // Colours in OBJ files are as on the screen.
            let color = vector(&mesh.vertex_color, i).or(base);
            raw.colors.push(color.map_or([1.0; 3], |color| {
                color.map(|c| linear_from_srgb(f64::from(c.clamp(0.0, 1.0))) as f32)
            }));
        }
        let beyond = mesh.indices.iter().find(|&&i| i as usize >= n);
        if let Some(i) = beyond {
            return Err(format!("a face has vertex {}, and there are {n}", u64::from(*i) + 1));
        }
        let (triangles, _) = mesh.indices.as_chunks::<3>();
        raw.triangles.extend(triangles.iter().map(|corners| corners.map(|i| first + i)));
    }
    Ok(raw)
}
