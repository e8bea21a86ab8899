//! A mesh that changes in parts: what bricks give to it is replaced brick by brick, and the places of
//! vertices and triangles that are gone are used again.
//!
//! *Based on:* A. León Salas, 2008, section 4.2 (holes in the vertex buffer, figure 4.3).

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::{
    Crossing, Extraction, Grid, Voxels,
    cuts::Cuts,
    extract::{Parts, Run, extract_parts},
};
use crate::math::morton_encode;

/// See the file's text.
#[derive(Clone, Debug, Default)]
pub struct LiveMesh {
    /// With holes, where nothing is that means anything.
    vertices: Vec<Crossing>,
    triangles: Vec<[u32; 3]>,
    /// The holes.
    free_vertices: Vec<u32>,
    free_triangles: Vec<u32>,
    /// By the Morton codes of bricks; boxed, as they are taken out and put back.
    bricks: FxHashMap<u64, Box<Part>>,
    /// How many bricks have regions around them that are as large as bricks, or larger.
    n_beside_large: usize,
}

/// What a brick has given.
#[derive(Clone, Debug, Default)]
struct Part {
    /// Which of its edges are cut.
    cuts: Cuts,
    /// The places of their vertices, in order.
    vertices: Vec<u32>,
    /// The places of its triangles, in the order of cells.
    triangles: Vec<u32>,
    /// Whether regions around it are as large as bricks, or larger.
    is_beside_large: bool,
}

impl LiveMesh {
    /// Finds the surface again in the `wanted` bricks; `grid` has those of them that are near the
    /// surface, and all around these. Vertices on edges that stay keep their places.
    pub fn renew<B: Voxels>(&mut self, grid: &Grid<B>, wanted: impl Iterator<Item = [u32; 3]>) {
        let mut numbers = Vec::new();
        let mut old = Vec::new();
        for place in wanted {
            let before = self.bricks.remove(&morton_encode(place));
            match grid.number_at(place) {
                Some(number) => numbers.push((number as usize, before.unwrap_or_default())),
                None => old.extend(before),
            }
        }
        // In the grid's order.
        numbers.sort_unstable_by_key(|&(number, _)| number);
        let (numbers, before): (Vec<usize>, Vec<Box<Part>>) = numbers.into_iter().unzip();
        let code = |number: usize| morton_encode(grid.bricks[number].place);
        let known = |number| Some(self.bricks.get(&code(number))?.cuts.clone());
        let Parts { mut cuts, firsts, runs } = extract_parts(grid, &numbers, known);
        for part in before.iter().chain(&old) {
            self.free_triangles.extend(&part.triangles);
            self.n_beside_large -= usize::from(part.is_beside_large);
        }
        for part in old {
            self.free_vertices.extend(part.vertices);
        }

        // The places of all vertices, by their numbers.
        let n: u32 = cuts.iter().map(Cuts::count).sum();
        let mut places = vec![0; n as usize];
        for (number, &first) in firsts.iter().enumerate() {
            if let Some(part) = self.bricks.get(&code(number)) {
                let first = first as usize;
                places[first..first + part.vertices.len()].copy_from_slice(&part.vertices);
            }
        }
        let mut vertices = runs.iter().flat_map(|run| &run.vertices);
        for (&number, before) in numbers.iter().zip(&before) {
            let mut place = places[firsts[number] as usize..].iter_mut();
            let mut kept = before.vertices.iter();
            cuts[number].merge(&before.cuts, |is_cut, was_cut| {
                let old = if was_cut { kept.next() } else { None };
                if !is_cut {
                    self.free_vertices.extend(old);
                    return;
                }
                let (Some(place), Some(&vertex)) = (place.next(), vertices.next()) else { return };
                *place = match old {
                    Some(&old) => {
                        self.vertices[old as usize] = vertex;
                        old
                    }
                    None => put(&mut self.vertices, &mut self.free_vertices, vertex),
                };
            });
        }
        let mut before = before.into_iter();
        for Run { bricks, triangles, .. } in runs {
            let mut triangles = triangles.into_iter();
            for ((number, n), mut part) in bricks.into_iter().zip(before.by_ref()) {
                let own = &places[firsts[number] as usize..][..cuts[number].count() as usize];
                if own.is_empty() && n == 0 {
                    continue;
                }
                part.cuts = std::mem::take(&mut cuts[number]);
                part.vertices.clear();
                part.vertices.extend(own);
                part.triangles.clear();
                part.triangles.extend(triangles.by_ref().take(n).map(|corners| {
                    let corners = corners.map(|v| places[v as usize]);
                    put(&mut self.triangles, &mut self.free_triangles, corners)
                }));
                part.is_beside_large = grid.is_beside_large(number);
                self.n_beside_large += usize::from(part.is_beside_large);
                self.bricks.insert(code(number), part);
            }
        }
    }

    /// Whether a brick has vertices on edges of one of its voxels.
    #[must_use]
    pub fn has_vertices_at(&self, brick: [u32; 3], voxel: usize) -> bool {
        let part = self.bricks.get(&morton_encode(brick));
        part.is_some_and(|part| part.cuts.has_vertices_at(voxel))
    }

    /// Whether nowhere at the surface a region is as large as a brick.
    #[must_use]
    pub fn is_of_small_regions(&self) -> bool {
        self.n_beside_large == 0
    }

    /// The volume, in samples, between the triangles of some bricks and the origin; that of what they
    /// enclose, if they are all.
    #[must_use]
    pub fn volume_of(&self, bricks: impl Iterator<Item = [u32; 3]>) -> f64 {
        let corner = |v: u32| DVec3::from_array(self.vertices[v as usize].point());
        let of_triangle = |&t: &u32| {
            let [a, b, c] = self.triangles[t as usize].map(corner);
            a.dot(b.cross(c)) / 6.0
        };
        let parts = bricks.filter_map(|place| self.bricks.get(&morton_encode(place)));
        parts.flat_map(|part| &part.triangles).map(of_triangle).sum()
    }

    /// Vertices and triangles without holes, in the order of a mesh that is made in one piece.
    #[must_use]
    pub fn compact(&self) -> Extraction {
        let mut bricks: Vec<(u64, &Part)> =
            self.bricks.iter().map(|(&code, part)| (code, &**part)).collect();
        bricks.sort_unstable_by_key(|&(code, _)| code);
        let mut numbers = vec![0; self.vertices.len()];
        let mut vertices = Vec::with_capacity(self.vertices.len() - self.free_vertices.len());
        for &place in bricks.iter().flat_map(|(_, part)| &part.vertices) {
            numbers[place as usize] = vertices.len() as u32;
            vertices.push(self.vertices[place as usize]);
        }
        let places = bricks.iter().flat_map(|(_, part)| &part.triangles);
        let triangles =
            places.map(|&t| self.triangles[t as usize].map(|v| numbers[v as usize])).collect();
        Extraction { vertices, triangles }
    }
}

/// Puts something where a hole is, or at the end.
fn put<T>(all: &mut Vec<T>, free: &mut Vec<u32>, one: T) -> u32 {
    match free.pop() {
        Some(place) => {
            all[place as usize] = one;
            place
        }
        None => {
            all.push(one);
            (all.len() - 1) as u32
        }
    }
}
