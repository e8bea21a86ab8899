//! A mesh that changes in parts: what bricks give to it is replaced brick by brick, and the places of
//! vertices and triangles that are gone are used again.
//!
//! *Based on:* A. León Salas, 2008, section 4.2 (holes in the vertex buffer, figure 4.3).

use rustc_hash::FxHashMap;

use super::{BrickMesh, Crossing, EdgeKey, Extraction, VOXELS, extract::brick_of};

/// See the file's text.
#[derive(Clone, Debug, Default)]
pub struct LiveMesh {
    /// With holes, where nothing is that means anything.
    vertices: Vec<Crossing>,
    triangles: Vec<[u32; 3]>,
    /// The holes.
    free_vertices: Vec<u32>,
    free_triangles: Vec<u32>,
    /// By the Morton codes of bricks.
    bricks: FxHashMap<u64, Part>,
}

/// What a brick has given.
#[derive(Clone, Debug, Default)]
struct Part {
    /// In order of their edges.
    vertices: Vec<(EdgeKey, u32)>,
    /// In order of their cells.
    triangles: Vec<u32>,
}

impl LiveMesh {
    /// Replaces what the bricks of these Morton codes have given by `meshes`, which are in Morton order
    /// and of no other bricks. Vertices on edges that stay keep their places.
    pub fn replace(&mut self, bricks: &[u64], meshes: &[BrickMesh]) {
        let mut old: FxHashMap<u64, Part> = FxHashMap::default();
        for brick in bricks {
            if let Some(part) = self.bricks.remove(brick) {
                self.free_triangles.extend(&part.triangles);
                old.insert(*brick, part);
            }
        }
        for mesh in meshes {
            let before = old.remove(&mesh.brick).unwrap_or_default();
            let vertices = self.vertices(&before, mesh);
            self.bricks.insert(mesh.brick, Part { vertices, triangles: Vec::new() });
        }
        for brick in bricks {
            for (_, gone) in old.remove(brick).unwrap_or_default().vertices {
                self.free_vertices.push(gone);
            }
        }
        for mesh in meshes {
            let of_mesh = mesh.triangles.iter().map(|corners| {
                let corners = corners.map(|key| self.number(key));
                put(&mut self.triangles, &mut self.free_triangles, corners)
            });
            let triangles = of_mesh.collect();
            if let Some(part) = self.bricks.get_mut(&mesh.brick) {
                part.triangles = triangles;
            }
        }
    }

    /// Places for the vertices of a brick, and of those that are gone.
    fn vertices(&mut self, before: &Part, mesh: &BrickMesh) -> Vec<(EdgeKey, u32)> {
        let mut kept = before.vertices.iter().copied().peekable();
        let mut vertices = Vec::with_capacity(mesh.vertices.len());
        for &(key, crossing) in &mesh.vertices {
            while let Some((_, gone)) = kept.next_if(|&(other, _)| other < key) {
                self.free_vertices.push(gone);
            }
            let number = match kept.next_if(|&(other, _)| other == key) {
                Some((_, number)) => {
                    self.vertices[number as usize] = crossing;
                    number
                }
                None => put(&mut self.vertices, &mut self.free_vertices, crossing),
            };
            vertices.push((key, number));
        }
        self.free_vertices.extend(kept.map(|(_, gone)| gone));
        vertices
    }

    /// Whether a brick has vertices on edges of one of its voxels.
    #[must_use]
    pub fn has_vertices_at(&self, brick: u64, voxel: usize) -> bool {
        let is_of = |&(key, _): &(EdgeKey, u32)| key as usize % VOXELS == voxel;
        self.bricks.get(&brick).is_some_and(|part| part.vertices.iter().any(is_of))
    }

    /// The place of the vertex on an edge.
    fn number(&self, key: EdgeKey) -> u32 {
        let part = &self.bricks[&brick_of(key)];
        let at = part.vertices.partition_point(|&(other, _)| other < key);
        part.vertices[at].1
    }

    /// Vertices and triangles without holes, in the order of a mesh that is made in one piece.
    #[must_use]
    pub fn compact(&self) -> Extraction {
        let mut bricks: Vec<u64> = self.bricks.keys().copied().collect();
        bricks.sort_unstable();
        let mut numbers = vec![0; self.vertices.len()];
        let mut vertices = Vec::with_capacity(self.vertices.len() - self.free_vertices.len());
        for brick in &bricks {
            for &(_, number) in &self.bricks[brick].vertices {
                numbers[number as usize] = vertices.len() as u32;
                vertices.push(self.vertices[number as usize]);
            }
        }
        let of_brick = |brick: &u64| self.bricks[brick].triangles.iter();
        let triangles = bricks.iter().flat_map(of_brick);
        let triangles =
            triangles.map(|&t| self.triangles[t as usize].map(|v| numbers[v as usize])).collect();
        Extraction { vertices, triangles }
    }

    /// Places of vertices and triangles, with those that are free.
    #[must_use]
    pub fn places(&self) -> [[usize; 2]; 2] {
        [
            [self.vertices.len(), self.free_vertices.len()],
            [self.triangles.len(), self.free_triangles.len()],
        ]
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
