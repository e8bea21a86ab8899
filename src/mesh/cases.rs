//! Marching Cubes: which edges of a cell the surface cuts, and how its pieces join them.
//!
//! The table is derived, not typed: on every face of the cell, walking around it, the edge where the
//! walk comes in is joined to the edge where that inside run ends, so that inside corners at a
//! diagonal are kept apart. The rule looks at the four signs of the face alone; two cells that share
//! a face therefore join the same edges, and no crack can open between them.
//!
//! *Based on:* W. Lorensen, H. Cline, "Marching Cubes", SIGGRAPH 1987; A. León Salas, 2008, section
//! 2.4 (the same cells, stretched or collapsed, in a dual grid).

use std::{array, sync::LazyLock};

/// Edges of a cell: edge `4 axis + j` goes along `axis`; bit 0 and 1 of j are its place on the next
/// two axes. Its ends are octants x + 2y + 4z.
pub(super) const N_EDGES: usize = 12;

/// The octant at the lower end of an edge.
pub(super) const fn lower_octant(edge: usize) -> usize {
    let (axis, j) = (edge / 4, edge % 4);
    (j & 1) << ((axis + 1) % 3) | (j >> 1) << ((axis + 2) % 3)
}

/// The axis of an edge.
pub(super) const fn axis_of(edge: usize) -> usize {
    edge / 4
}

/// The edge between two octants that differ in one bit.
fn edge_between(a: usize, b: usize) -> usize {
    let axis = (a ^ b).trailing_zeros() as usize;
    let low = a & b;
    let bit = |step: usize| low >> ((axis + step) % 3) & 1;
    4 * axis + bit(1) + 2 * bit(2)
}

/// The two faces that an edge lies on, as bits: face `2 axis + side`.
pub(super) fn faces_of(edge: usize) -> u8 {
    let (axis, low) = (axis_of(edge), lower_octant(edge));
    let face = |axis: usize| 1_u8 << (2 * axis + (low >> axis & 1));
    face((axis + 1) % 3) | face((axis + 2) % 3)
}

/// What the surface is like in a cell.
#[derive(Clone, Debug, Default)]
pub(super) struct Case {
    /// Closed loops of cut edges, inside on the left as seen from outside.
    pub(super) loops: Vec<Vec<u8>>,
    /// Triangles of cut edges, if no two of them meet at one place.
    pub(super) triangles: Vec<[u8; 3]>,
}

/// By the octants that lie inside, as bits.
pub(super) static CASES: LazyLock<Vec<Case>> = LazyLock::new(|| (0..=u8::MAX).map(case).collect());

/// How many triangles each has.
pub(super) static N_TRIANGLES: LazyLock<[u8; 256]> =
    LazyLock::new(|| array::from_fn(|inside| CASES[inside].triangles.len() as u8));

fn case(inside: u8) -> Case {
    let loops = loops(inside);
    let triangles = loops.iter().flat_map(|edges| {
        let faces: Vec<u8> = edges.iter().map(|&edge| faces_of(edge as usize)).collect();
        fan(&faces).map(|corners| corners.map(|i| edges[i]))
    });
    Case { triangles: triangles.collect(), loops }
}

fn loops(inside: u8) -> Vec<Vec<u8>> {
    let is_inside = |octant: usize| inside >> octant & 1 == 1;
    let mut next = [None; N_EDGES];
    for axis in 0..3 {
        for side in 0..2 {
            let around = around(axis, side);
            for i in 0..4 {
                let (a, b) = (around[i], around[(i + 1) % 4]);
                if is_inside(a) || !is_inside(b) {
                    continue;
                }
                // The run of inside corners begins at b; it ends before the first outside one.
                let step = (2..5).find(|&step| !is_inside(around[(i + step) % 4]));
                let Some(step) = step else { continue };
                let (c, d) = (around[(i + step - 1) % 4], around[(i + step) % 4]);
                next[edge_between(a, b)] = Some(edge_between(c, d));
            }
        }
    }
    let mut loops = Vec::new();
    for start in 0..N_EDGES {
        let mut edges = Vec::new();
        let mut at = start;
        while let Some(edge) = next[at].take() {
            edges.push(at as u8);
            at = edge;
        }
        if !edges.is_empty() {
            loops.push(edges);
        }
    }
    loops
}

/// The octants around a face, counter-clockwise as seen from outside the cell.
fn around(axis: usize, side: usize) -> [usize; 4] {
    let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
    let first = side << axis;
    match side {
        0 => [first, first | v, first | u | v, first | u],
        _ => [first, first | u, first | u | v, first | v],
    }
}

/// Cuts a loop into triangles, given the faces that each of its corners lies on: from the first
/// corner whose diagonals join no two corners of one face, or two cells could both have that
/// diagonal.
pub(super) fn fan(faces: &[u8]) -> impl Iterator<Item = [usize; 3]> + use<> {
    let n = faces.len();
    let is_good = |&apex: &usize| {
        (2..n.saturating_sub(1)).all(|step| faces[apex] & faces[(apex + step) % n] == 0)
    };
    let apex = (0..n).find(is_good).unwrap_or(0);
    (1..n.saturating_sub(1)).map(move |i| [apex, (apex + i) % n, (apex + i + 1) % n])
}

/// A loop in a cell between voxels of which large ones count several times: cut edges between the same
/// two voxels are one vertex.
pub(super) struct Loop {
    vertices: [u32; N_EDGES],
    /// The faces that each vertex lies on, as bits.
    faces: [u8; N_EDGES],
    n: usize,
}

impl Loop {
    /// What is left of cut edges one after the other, of which `vertex` tells the vertices.
    #[inline]
    pub(super) fn collapsed(edges: &[u8], vertex: impl Fn(u8) -> u32) -> Self {
        let mut left = Self { vertices: [0; N_EDGES], faces: [0; N_EDGES], n: 0 };
        let Self { vertices, faces, n } = &mut left;
        for &edge in edges {
            let vertex = vertex(edge);
            // Cells that are collapsed have the same edge several times.
            if *n == 0 || vertices[*n - 1] != vertex {
                (vertices[*n], faces[*n]) = (vertex, 0);
                *n += 1;
            }
            faces[*n - 1] |= faces_of(edge.into());
        }
        if *n > 1 && vertices[0] == vertices[*n - 1] {
            *n -= 1;
            faces[0] |= faces[*n];
        }
        left
    }

    /// Its triangles, if any are left.
    #[inline]
    pub(super) fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        fan(&self.faces[..self.n]).map(|corners| corners.map(|i| self.vertices[i]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn middle(edge: usize) -> DVec3 {
        let low = lower_octant(edge);
        let corner = DVec3::from_array([0, 1, 2].map(|axis| (low >> axis & 1) as f64));
        corner + 0.5 * DVec3::AXES[axis_of(edge)]
    }

    #[test]
    fn edges_have_two_ends_and_two_faces() {
        for edge in 0..N_EDGES {
            let low = lower_octant(edge);
            assert_eq!(edge_between(low, low | 1 << axis_of(edge)), edge);
            assert_eq!(faces_of(edge).count_ones(), 2);
        }
    }

    #[test]
    fn every_cut_edge_is_in_one_loop_once() {
        for (inside, case) in CASES.iter().enumerate() {
            let mut seen = [0; N_EDGES];
            case.loops.iter().flatten().for_each(|&edge| seen[edge as usize] += 1);
            for (edge, n) in seen.into_iter().enumerate() {
                let low = lower_octant(edge);
                let is_cut = (inside >> low ^ inside >> (low | 1 << axis_of(edge))) & 1;
                assert_eq!(n, is_cut, "edge {edge} of {inside:#b}");
            }
            assert!(case.loops.iter().all(|edges| edges.len() >= 3), "{inside:#b}");
        }
    }

    #[test]
    fn triangles_face_away_from_what_is_inside() {
        for k in 0..8_usize {
            let [a, b, c] = CASES[1 << k].triangles[0].map(|edge| middle(edge as usize));
            let corner = DVec3::from_array([0, 1, 2].map(|axis| (k >> axis & 1) as f64));
            assert!((b - a).cross(c - a).dot(a - corner) > 0.0, "corner {k}");
        }
    }

    #[test]
    fn no_case_needs_a_diagonal_in_a_face() {
        for (inside, case) in CASES.iter().enumerate() {
            for edges in &case.loops {
                let faces: Vec<u8> = edges.iter().map(|&e| faces_of(e as usize)).collect();
                let n = faces.len();
                for [a, b, c] in fan(&faces) {
                    for (i, j) in [(a, b), (b, c), (c, a)] {
                        let is_side = (i + 1) % n == j || (j + 1) % n == i;
                        assert!(is_side || faces[i] & faces[j] == 0, "{inside:#b}");
                    }
                }
            }
        }
    }
}
