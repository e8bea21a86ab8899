//! What a mesh is like: whether it is clean, and what shape it has. Nothing is believed of how it was
//! made.

use std::collections::BTreeMap;

use glam::DVec3;

use super::{
    Mesh,
    repair::{join, root},
};

/// What may be wrong with a mesh; all zero if it is clean, but for edges at an open border.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Health {
    /// Edges that only one triangle has.
    pub open_edges: u64,
    /// Edges that more than two triangles have.
    pub crowded_edges: u64,
    /// Edges that two triangles have in the same direction.
    pub turned_edges: u64,
    /// Vertices whose triangles are no single fan.
    pub pinched_vertices: u64,
    /// Triangles with two corners at one place, or without area.
    pub flat_triangles: u64,
    /// Coordinates that are no finite numbers.
    pub not_finite: u64,
    /// Vertices at the place of another one.
    pub double_vertices: u64,
}

impl Health {
    /// Whether the mesh is manifold, oriented and without triangles that have no area; it may have a
    /// border.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        Self { open_edges: 0, ..*self } == Self::default()
    }
}

/// Counts and measures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shape {
    /// Vertices.
    pub vertices: u64,
    /// Edges.
    pub edges: u64,
    /// Triangles.
    pub triangles: u64,
    /// V − E + F.
    pub euler: i64,
    /// Pieces that are not connected by edges.
    pub components: u64,
    /// In squares of scene units.
    pub area: f64,
    /// In cubes of scene units: what is enclosed, if the mesh is closed.
    pub volume: f64,
}

impl Mesh {
    /// Looks for everything that can be wrong.
    #[must_use]
    pub fn health(&self) -> Health {
        let mut health = Health {
            not_finite: self.positions.as_flattened().iter().filter(|c| !c.is_finite()).count()
                as u64,
            ..Health::default()
        };
        for uses in self.edges() {
            match uses {
                [1, 1] => {}
                [1, 0] | [0, 1] => health.open_edges += 1,
                [2, 0] | [0, 2] => health.turned_edges += 1,
                _ => health.crowded_edges += 1,
            }
        }
        health.flat_triangles = self.triangles.iter().filter(|t| self.is_flat(t)).count() as u64;
        health.pinched_vertices = self.pinched_vertices();
        let mut places: Vec<[u32; 3]> =
            self.positions.iter().map(|p| p.map(|c| (c + 0.0).to_bits())).collect();
        places.sort_unstable();
        health.double_vertices = places.windows(2).filter(|pair| pair[0] == pair[1]).count() as u64;
        health
    }

    /// Whether it has a border: an edge that only one triangle has.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.edges().iter().any(|uses| matches!(uses, [0, 1] | [1, 0]))
    }

    /// Counts and measures.
    #[must_use]
    pub fn shape(&self) -> Shape {
        let edges = self.edges().len() as u64;
        let (vertices, triangles) = (self.positions.len() as u64, self.triangles.len() as u64);
        let (mut area, mut volume) = (0.0, 0.0);
        // From a corner of the mesh, so that volumes far from the origin are not lost in rounding.
        let origin = self.positions.first().map_or(DVec3::ZERO, |&p| wide(p));
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|v| wide(self.positions[v as usize]) - origin);
            area += 0.5 * (b - a).cross(c - a).length();
            volume += a.dot(b.cross(c)) / 6.0;
        }
        Shape {
            vertices,
            edges,
            triangles,
            euler: vertices as i64 - edges as i64 + triangles as i64,
            components: self.components(),
            area,
            volume,
        }
    }

    /// How often each edge is used from its smaller to its larger vertex, and the other way.
    fn edges(&self) -> Vec<[u32; 2]> {
        let sides = || {
            let of_triangle = |&[a, b, c]: &[u32; 3]| [(a, b), (b, c), (c, a)];
            self.triangles.iter().flat_map(of_triangle)
        };
        // All sides that have the same smaller vertex stand together, from one of `ends` to the next.
        let mut ends = vec![0_usize; self.positions.len() + 1];
        sides().for_each(|(from, to)| ends[from.min(to) as usize + 1] += 1);
        for vertex in 1..ends.len() {
            ends[vertex] += ends[vertex - 1];
        }
        let mut others = vec![(0_u32, false); 3 * self.triangles.len()];
        for (from, to) in sides() {
            let end = &mut ends[from.min(to) as usize];
            others[*end] = (from.max(to), from > to);
            *end += 1;
        }
        let mut edges = Vec::with_capacity(others.len() / 2);
        let mut start = 0;
        for &end in &ends[..self.positions.len()] {
            let of_vertex = &mut others[start..end];
            of_vertex.sort_unstable();
            for uses in of_vertex.chunk_by(|a, b| a.0 == b.0) {
                let n_down = uses.iter().filter(|(_, is_down)| *is_down).count();
                edges.push([uses.len() - n_down, n_down].map(|n| n as u32));
            }
            start = end;
        }
        edges
    }

    fn is_flat(&self, triangle: &[u32; 3]) -> bool {
        let [a, b, c] = triangle.map(|v| wide(self.positions[v as usize]));
        (b - a).cross(c - a) == DVec3::ZERO
    }

    /// Vertices around which the triangles are several fans, or none.
    fn pinched_vertices(&self) -> u64 {
        // Around a vertex every triangle leads from its next corner to the one after it.
        let mut around: Vec<(u32, u32, u32)> = Vec::with_capacity(3 * self.triangles.len());
        for &[a, b, c] in &self.triangles {
            around.extend([(a, b, c), (b, c, a), (c, a, b)]);
        }
        around.sort_unstable();
        let mut n_used = 0;
        let mut n_pinched = 0;
        for fan in around.chunk_by(|a, b| a.0 == b.0) {
            n_used += 1;
            n_pinched += u64::from(!is_one_fan(fan));
        }
        n_pinched + (self.positions.len() as u64 - n_used)
    }

    /// Pieces that are connected by edges.
    fn components(&self) -> u64 {
        let mut parents: Vec<u32> = (0..self.positions.len() as u32).collect();
        for &[a, b, c] in &self.triangles {
            join(&mut parents, a, b);
            join(&mut parents, b, c);
        }
        (0..parents.len() as u32).filter(|&v| root(&mut parents, v) == v).count() as u64
    }
}

fn wide(p: [f32; 3]) -> DVec3 {
    DVec3::from_array(p.map(f64::from))
}

/// Whether triangles around a vertex, each (vertex, from, to), are a closed ring or one open fan.
fn is_one_fan(fan: &[(u32, u32, u32)]) -> bool {
    let next: BTreeMap<u32, u32> = fan.iter().map(|&(_, from, to)| (from, to)).collect();
    if next.len() != fan.len() {
        return false;
    }
    // An open fan begins where no triangle leads.
    let targets: std::collections::BTreeSet<u32> = next.values().copied().collect();
    let start = next.keys().find(|from| !targets.contains(from)).or(next.keys().next());
    let Some(&start) = start else { return false };
    let (mut at, mut n) = (start, 0);
    while let Some(&to) = next.get(&at) {
        n += 1;
        at = to;
        if at == start || n > fan.len() {
            break;
        }
    }
    n == fan.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> Mesh {
        Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            ..Mesh::default()
        }
    }

    #[test]
    fn a_tetrahedron_is_clean() {
        let mesh = tetrahedron();
        assert_eq!(mesh.health(), Health::default());
        assert!(!mesh.is_open());
        let shape = mesh.shape();
        assert_eq!((shape.vertices, shape.edges, shape.triangles, shape.euler), (4, 6, 4, 2));
        assert_eq!(shape.components, 1);
        assert!((shape.volume - 1.0 / 6.0).abs() < 1e-15);
        assert!((shape.area - (1.5 + 0.75_f64.sqrt())).abs() < 1e-15);
    }

    #[test]
    fn everything_wrong_is_found() {
        let health = |change: &dyn Fn(&mut Mesh)| {
            let mut mesh = tetrahedron();
            change(&mut mesh);
            mesh.health()
        };
        assert_eq!(health(&|mesh| mesh.triangles.truncate(3)).open_edges, 3);
        assert_eq!(health(&|mesh| mesh.triangles[3] = [1, 3, 2]).turned_edges, 3);
        assert_eq!(health(&|mesh| mesh.triangles.push([1, 2, 3])).crowded_edges, 3);
        assert_eq!(health(&|mesh| mesh.positions[3] = [f32::NAN; 3]).not_finite, 3);
        assert_eq!(health(&|mesh| mesh.positions[3] = [1.0, 0.0, 0.0]).double_vertices, 1);
        assert_eq!(health(&|mesh| mesh.positions[3] = [0.5, 0.5, 0.0]).flat_triangles, 1);
        assert!(Mesh { triangles: vec![[0, 2, 1]], ..tetrahedron() }.is_open());
        // A vertex of no triangle, and one that two tetrahedra share.
        assert_eq!(health(&|mesh| mesh.positions.push([9.0; 3])).pinched_vertices, 1);
        let pinched = health(&|mesh| {
            mesh.positions.extend([[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]);
            mesh.triangles.extend([[0, 5, 4], [0, 4, 6], [0, 6, 5], [4, 5, 6]]);
        });
        assert_eq!(Health { pinched_vertices: 1, ..Health::default() }, pinched);
    }
}
