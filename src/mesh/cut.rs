//! Meshes of surfaces that are cut open: triangles are cut along the border of the region that is
//! kept.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::{LEAST_PART, Mesh};
use crate::{eval::Sample, expr::Tape};

/// Halvings that find a border to the precision of files.
const HALVINGS: usize = 30;

/// Keeps what lies in the region of `tape`, if it has one: triangles that its border crosses lose the
/// part beyond it.
pub(super) fn cut_to_region(mesh: &mut Mesh, tape: &Tape, sampler: &mut dyn Sample) {
    if tape.region().is_none() {
        return;
    }
    let place = |v: u32| DVec3::from_array(mesh.positions[v as usize].map(f64::from));
    let all: Vec<DVec3> = (0..mesh.positions.len() as u32).map(place).collect();
    let is_kept = sampler.are_in_region(tape, &all);

    // The edges that the border crosses, each from its kept end, in the order of triangles.
    let mut numbers: FxHashMap<[u32; 2], u32> = FxHashMap::default();
    let mut edges: Vec<[u32; 2]> = Vec::new();
    for &[a, b, c] in &mesh.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let edge = match [from, to].map(|v| is_kept[v as usize]) {
                [true, false] => [from, to],
                [false, true] => [to, from],
                _ => continue,
            };
            numbers.entry(edge).or_insert_with(|| {
                edges.push(edge);
                (mesh.positions.len() + edges.len() - 1) as u32
            });
        }
    }
    let mut spans = vec![[0.0, 1.0]; edges.len()];
    for _ in 0..HALVINGS {
        let middle = |(&[from, to], &[low, high]): (&[u32; 2], &[f64; 2])| {
            let (from, to) = (place(from), place(to));
            from + 0.5 * (low + high) * (to - from)
        };
        let middles: Vec<DVec3> = edges.iter().zip(&spans).map(middle).collect();
        for (span, is_in) in spans.iter_mut().zip(sampler.are_in_region(tape, &middles)) {
            span[usize::from(!is_in)] = 0.5 * (span[0] + span[1]);
        }
    }
    for (&[from, to], [part, _]) in edges.iter().zip(spans) {
        let part = part.clamp(LEAST_PART, 1.0 - LEAST_PART);
        let blend = |of: &[[f32; 3]]| {
            let [a, b] = [from, to].map(|v| DVec3::from_array(of[v as usize].map(f64::from)));
            a + part * (b - a)
        };
        let (position, normal) = (blend(&mesh.positions), blend(&mesh.normals));
        let normal = normal.normalize_or(DVec3::Z);
        mesh.positions.push(position.as_vec3().to_array());
        mesh.normals.push(normal.as_vec3().to_array());
    }

    let mut triangles = Vec::with_capacity(mesh.triangles.len());
    for &triangle in &mesh.triangles {
        // The corners of what is left, in their order.
        let mut left: Vec<u32> = Vec::with_capacity(4);
        for i in 0..3 {
            let (from, to) = (triangle[i], triangle[(i + 1) % 3]);
            if is_kept[from as usize] {
                left.push(from);
            }
            match [from, to].map(|v| is_kept[v as usize]) {
                [true, false] => left.push(numbers[&[from, to]]),
                [false, true] => left.push(numbers[&[to, from]]),
                _ => {}
            }
        }
        match *left.as_slice() {
            [a, b, c] => triangles.push([a, b, c]),
            [a, b, c, d] => triangles.extend([[a, b, c], [a, c, d]]),
            _ => {}
        }
    }
    mesh.triangles = triangles;
}
