//! Sheets that touch: where more than two triangles meet at an edge, or several fans at a vertex, the
//! vertices are doubled, so that every sheet is a manifold by itself. Where the ends of an edge cannot be
//! doubled, because each has a single fan that comes by twice, one of the sheets gets a vertex in the middle
//! of its edge. Triangles that lie back to back are dropped. Nothing moves.
//!
//! *Based on:* A. Guéziec, G. Taubin, F. Lazarus, B. Horn, "Cutting and Stitching: Converting Sets of
//! Polygons to Manifold Surfaces", IEEE TVCG 2001.

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::Mesh;

/// A side of a triangle: 3 triangle + corner, from that corner to the next.
pub(super) type Side = u32;

impl Mesh {
    /// Adds vertices where sheets touch. Returns how many.
    pub fn split_touching(&mut self) -> u64 {
        let (mut partners, mut crowded) = self.partners_and_crowded();
        if self.drop_folded(&partners, &crowded) {
            (partners, crowded) = self.partners_and_crowded();
        }
        // The corners of triangles, joined where triangles stay together.
        let n = self.triangles.len() * 3;
        let mut fans: Vec<u32> = (0..n as u32).collect();
        for (side, &partner) in (0..).zip(&partners) {
            if partner != NONE {
                // The first end of a side is the second one of its partner.
                join(&mut fans, side, next(partner));
            }
        }
        let mut first_of: Vec<u32> = vec![NONE; self.positions.len()];
        let mut doubles: FxHashMap<u32, u32> = FxHashMap::default();
        let n_before = self.positions.len();
        for corner in 0..n as u32 {
            let fan = root(&mut fans, corner);
            let vertex = self.triangles[corner as usize / 3][corner as usize % 3] as usize;
            let own = match first_of.get(vertex) {
                Some(&NONE) => {
                    first_of[vertex] = fan;
                    continue;
                }
                Some(&first) if first == fan => continue,
                _ => *doubles.entry(fan).or_insert_with(|| {
                    self.positions.push(self.positions[vertex]);
                    self.normals.push(self.normals[vertex]);
                    (self.positions.len() - 1) as u32
                }),
            };
            self.triangles[corner as usize / 3][corner as usize % 3] = own;
        }
        self.part_edges(&partners, &crowded);
        (self.positions.len() - n_before) as u64
    }

    /// The side across every side, [`NONE`] at borders.
    pub(super) fn partners(&self) -> Vec<Side> {
        self.partners_and_crowded().0
    }

    /// Drops triangles that are each other's back, and those that have a vertex twice: they enclose nothing,
    /// and what is beside them fits together without them. Whether there were any.
    fn drop_folded(&mut self, partners: &[Side], crowded: &[Side]) -> bool {
        let is_alone = |&triangle: &u32| {
            let beside = |i: u32| partners[(3 * triangle + i) as usize] / 3;
            beside(0) == beside(1) && beside(1) == beside(2)
        };
        let mut suspects: Vec<u32> = crowded.iter().map(|side| side / 3).collect();
        suspects.extend((0..self.triangles.len() as u32).filter(is_alone));
        suspects.sort_unstable();
        suspects.dedup();
        // By corners, those that no other one was the back of yet, and which way they go.
        let mut single: FxHashMap<[u32; 3], Vec<(u32, bool)>> = FxHashMap::default();
        let is_line = |[a, b, c]: &[u32; 3]| a == b || b == c || c == a;
        let numbered = (0..).zip(&self.triangles);
        let mut folded: FxHashSet<u32> = numbered
            .filter(|(_, corners)| is_line(corners))
            .map(|(triangle, _)| triangle)
            .collect();
        suspects.retain(|triangle| !folded.contains(triangle));
        for triangle in suspects {
            let corners = self.triangles[triangle as usize];
            let mut sorted = corners;
            sorted.sort_unstable();
            let first = corners.iter().position(|&v| v == sorted[0]).unwrap_or(0);
            let is_even = corners[(first + 1) % 3] == sorted[1];
            let of_corners = single.entry(sorted).or_default();
            match of_corners.iter().position(|&(_, other)| other != is_even) {
                Some(i) => folded.extend([triangle, of_corners.swap_remove(i).0]),
                None => of_corners.push((triangle, is_even)),
            }
        }
        let mut number = 0;
        self.triangles.retain(|_| {
            number += 1;
            !folded.contains(&(number - 1))
        });
        if !folded.is_empty() {
            self.drop_unused();
        }
        !folded.is_empty()
    }

    /// Puts a vertex into the middle of an edge that another pair of triangles has as well.
    fn part_edges(&mut self, partners: &[Side], crowded: &[Side]) {
        let mut taken: FxHashSet<[u32; 2]> = FxHashSet::default();
        // Sides that went to a new triangle when theirs was cut in two.
        let mut moved: FxHashMap<Side, Side> = FxHashMap::default();
        for &side in crowded {
            // Each pair once.
            let partner = partners[side as usize];
            if partner == NONE || partner < side {
                continue;
            }
            let pair = [side, partner].map(|mut side| {
                while let Some(&now) = moved.get(&side) {
                    side = now;
                }
                side
            });
            let corner = |side: Side| self.triangles[side as usize / 3][side as usize % 3];
            let [a, b] = [corner(pair[0]), corner(next(pair[0]))];
            if taken.insert([a.min(b), a.max(b)]) {
                continue;
            }
            let middle = self.positions.len() as u32;
            let mean = |of: &[[f32; 3]]| {
                let [a, b] = [a, b].map(|v| DVec3::from_array(of[v as usize].map(f64::from)));
                0.5 * (a + b)
            };
            let (position, normal) = (mean(&self.positions), mean(&self.normals));
            self.positions.push(position.as_vec3().to_array());
            self.normals.push(normal.normalize_or(DVec3::Z).as_vec3().to_array());
            for side in pair {
                let (triangle, i) = (side as usize / 3, side as usize % 3);
                let corners = self.triangles[triangle];
                let [end, opposite] = [1, 2].map(|step| corners[(i + step) % 3]);
                self.triangles[triangle][(i + 1) % 3] = middle;
                moved.insert(next(side), 3 * self.triangles.len() as u32 + 1);
                self.triangles.push([middle, end, opposite]);
            }
        }
    }

    /// The side across every side, [`NONE`] at borders; and the sides at edges that more than two triangles
    /// have.
    fn partners_and_crowded(&self) -> (Vec<Side>, Vec<Side>) {
        let mut sides: Vec<([u32; 2], Side)> = Vec::with_capacity(3 * self.triangles.len());
        for (triangle, corners) in (0..).zip(&self.triangles) {
            for i in 0..3 {
                let (a, b) = (corners[i], corners[(i + 1) % 3]);
                sides.push(([a.min(b), a.max(b)], 3 * triangle + i as u32));
            }
        }
        sides.sort_unstable();
        let (mut partners, mut crowded) = (vec![NONE; sides.len()], Vec::new());
        let mut pair = |a: Side, b: Side| {
            partners[a as usize] = b;
            partners[b as usize] = a;
        };
        for at_edge in sides.chunk_by(|a, b| a.0 == b.0) {
            match *at_edge {
                [_] => {}
                [(_, a), (_, b)] => pair(a, b),
                _ => {
                    crowded.extend(at_edge.iter().map(|&(_, side)| side));
                    self.pair_around(at_edge, &mut pair);
                }
            }
        }
        (partners, crowded)
    }

    /// Pairs the sides at an edge that many triangles have, by going around it: what is inside lies
    /// between the two of a pair.
    fn pair_around(&self, sides: &[([u32; 2], Side)], pair: &mut impl FnMut(Side, Side)) {
        let at = |v: u32| DVec3::from_array(self.positions[v as usize].map(f64::from));
        let [from, to] = sides[0].0.map(at);
        let along = (to - from).normalize_or(DVec3::Z);
        let (right, up) = along.any_orthonormal_pair();
        let mut around: Vec<(f64, bool, Side)> = sides
            .iter()
            .map(|&(edge, side)| {
                let corners = self.triangles[side as usize / 3];
                let i = side as usize % 3;
                let away = at(corners[(i + 2) % 3]) - from;
                let angle = libm::atan2(away.dot(up), away.dot(right));
                (angle, corners[i] == edge[0], side)
            })
            .collect();
        around.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
        // Seen along the edge, a triangle that goes the same way has what is inside on its left, and so
        // before it: it is paired with the one before that goes the other way.
        let mut open: Vec<Side> = Vec::new();
        for &(_, is_along, side) in around.iter().chain(&around) {
            if !is_along {
                open.push(side);
            } else if let Some(other) = open.pop() {
                pair(side, other);
            }
        }
    }
}

/// No side.
pub(super) const NONE: u32 = u32::MAX;

/// The next side of the same triangle.
pub(super) fn next(side: Side) -> Side {
    side / 3 * 3 + (side + 1) % 3
}

/// The root of an entry in a forest whose paths are halved on the way.
pub(super) fn root(parents: &mut [u32], mut v: u32) -> u32 {
    while parents[v as usize] != v {
        let above = parents[parents[v as usize] as usize];
        parents[v as usize] = above;
        v = above;
    }
    v
}

/// Joins the trees of two entries; the smaller root stays.
pub(super) fn join(parents: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(parents, a), root(parents, b));
    parents[a.max(b) as usize] = a.min(b);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Health;

    /// Two tetrahedra that share an edge, or a vertex; each closed and outwards.
    fn touching(second: [[f32; 3]; 4], shared: &[(u32, u32)]) -> Mesh {
        let first = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let name =
            |v: u32| shared.iter().find(|&&(own, _)| own == v).map_or(v + 4, |&(_, other)| other);
        let other = faces.map(|face: [u32; 3]| face.map(name));
        let mut mesh = Mesh {
            positions: first.into_iter().chain(second).collect(),
            normals: vec![[0.0, 0.0, 1.0]; 8],
            triangles: faces.into_iter().chain(other).collect(),
            ..Mesh::default()
        };
        mesh.drop_unused();
        mesh
    }

    #[test]
    fn sheets_that_share_an_edge_are_parted() {
        // The second has the edge from (0, 0, 0) to (1, 0, 0), and lies on its other side.
        let second = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];
        let mut mesh = touching(second, &[(0, 0), (1, 1)]);
        assert_eq!(mesh.health().crowded_edges, 1);
        assert_eq!(mesh.split_touching(), 2);
        let Health { crowded_edges, open_edges, pinched_vertices, turned_edges, .. } =
            mesh.health();
        assert_eq!([crowded_edges, open_edges, pinched_vertices, turned_edges], [0; 4]);
        let shape = mesh.shape();
        assert_eq!((shape.components, shape.euler), (2, 4));
    }

    #[test]
    fn what_encloses_nothing_is_dropped() {
        let second = [[2.0, 2.0, 2.0], [3.0, 2.0, 2.0], [2.0, 3.0, 2.0], [2.0, 2.0, 3.0]];
        let clean = touching(second, &[]);
        let mut mesh = clean.clone();
        // Back to back at an edge of other triangles, alone, and with a vertex twice.
        mesh.positions.extend([[5.0, 0.0, 0.0], [5.0, 1.0, 0.0], [5.0, 0.0, 1.0]]);
        mesh.normals.extend([[1.0, 0.0, 0.0]; 3]);
        mesh.triangles.extend([[0, 1, 8], [1, 0, 8], [8, 9, 10], [10, 9, 8], [4, 5, 4]]);
        assert_eq!(mesh.split_touching(), 0);
        assert_eq!(mesh, clean);
    }

    #[test]
    fn sheets_that_share_a_vertex_are_parted() {
        let second = [[0.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, -1.0, 0.0]];
        let mut mesh = touching(second, &[(0, 0)]);
        assert_eq!(mesh.health().pinched_vertices, 1);
        assert_eq!(mesh.split_touching(), 1);
        assert_eq!(mesh.health().pinched_vertices, 0);
        assert_eq!(mesh.split_touching(), 0);
    }
}
