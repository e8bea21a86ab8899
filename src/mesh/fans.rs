//! Which triangles meet where, while edges collapse: partners of sides, and fans around vertices.

use super::{
    Mesh,
    repair::{NONE, Side, next},
};

/// The triangles of an oriented manifold, which may have a border.
#[derive(Debug)]
pub(super) struct Fans {
    /// The corners of each triangle; of those that are gone, [`NONE`].
    pub(super) triangles: Vec<[u32; 3]>,
    /// The side across every side, [`NONE`] at borders.
    partners: Vec<Side>,
    /// A side that leaves each vertex: at the border the one without a partner. [`NONE`] if the
    /// vertex is gone.
    first: Vec<Side>,
    n_triangles: usize,
}

/// The previous side of the same triangle.
fn previous(side: Side) -> Side {
    next(next(side))
}

impl Fans {
    /// Of a mesh; nothing if an edge has more than two triangles or is turned, or if a vertex has
    /// several fans or a triangle twice.
    pub(super) fn new(mesh: &Mesh) -> Option<Self> {
        let (triangles, partners) = (mesh.triangles.clone(), mesh.partners());
        let n_triangles = triangles.len();
        let mut fans =
            Self { triangles, partners, first: vec![NONE; mesh.positions.len()], n_triangles };
        let mut n_sides = vec![0_u32; mesh.positions.len()];
        for side in 0..fans.partners.len() as Side {
            let (from, to) = (fans.from(side), fans.to(side));
            let partner = fans.partners[side as usize];
            let fits = partner == NONE || (fans.from(partner), fans.to(partner)) == (to, from);
            if !fits || from == to {
                return None;
            }
            n_sides[from as usize] += 1;
            let first = &mut fans.first[from as usize];
            if partner == NONE || *first == NONE {
                *first = side;
            }
        }
        let is_one_fan = |v: u32| fans.sides(v).count() == n_sides[v as usize] as usize;
        (0..n_sides.len() as u32).all(is_one_fan).then_some(fans)
    }

    /// How many triangles there are.
    pub(super) fn n_triangles(&self) -> usize {
        self.n_triangles
    }

    /// The vertex at the beginning of a side.
    pub(super) fn from(&self, side: Side) -> u32 {
        self.triangles[side as usize / 3][side as usize % 3]
    }

    /// The vertex at the end of a side.
    pub(super) fn to(&self, side: Side) -> u32 {
        self.from(next(side))
    }

    /// One side of every edge.
    pub(super) fn edges(&self) -> impl Iterator<Item = Side> {
        (0..self.partners.len() as Side).filter(|&side| {
            let partner = self.partners[side as usize];
            self.from(side) != NONE && (partner == NONE || side < partner)
        })
    }

    /// Whether only one triangle has a side.
    pub(super) fn is_open(&self, side: Side) -> bool {
        self.partners[side as usize] == NONE
    }

    /// Whether a vertex is at the border.
    pub(super) fn is_border(&self, v: u32) -> bool {
        self.is_open(self.first[v as usize])
    }

    /// Whether a vertex has no triangles any more.
    pub(super) fn is_gone(&self, v: u32) -> bool {
        self.first[v as usize] == NONE
    }

    /// The sides that leave a vertex, counter-clockwise: one in each of its triangles.
    pub(super) fn sides(&self, v: u32) -> impl Iterator<Item = Side> {
        let first = self.first[v as usize];
        let after = move |side: &Side| {
            let across = self.partners[previous(*side) as usize];
            (across != NONE && across != first).then_some(across)
        };
        std::iter::successors((first != NONE).then_some(first), after)
    }

    /// The vertices that share an edge with a vertex.
    pub(super) fn neighbors(&self, v: u32) -> impl Iterator<Item = u32> {
        self.sides(v).flat_map(|side| {
            let last = previous(side);
            let end = self.is_open(last).then(|| self.from(last));
            std::iter::once(self.to(side)).chain(end)
        })
    }

    /// The side between two vertices that leaves one or the other.
    pub(super) fn side_between(&self, u: u32, v: u32) -> Option<Side> {
        let leads = |from: u32, to: u32| self.sides(from).find(|&side| self.to(side) == to);
        leads(u, v).or_else(|| leads(v, u))
    }

    /// Whether the surface stays what it is, a manifold of the same genus with the same borders, if
    /// the ends of a side become one vertex: the *link condition* of T. Dey, H. Edelsbrunner,
    /// S. Guha, D. Nekhayev, "Topology Preserving Edge Contraction", 1999.
    pub(super) fn may_collapse(&self, side: Side) -> bool {
        let (u, v) = (self.from(side), self.to(side));
        let partner = self.partners[side as usize];
        let mut apexes = vec![self.to(next(side))];
        if partner == NONE {
            // A triangle that is alone would be gone.
            if [next(side), previous(side)].iter().all(|&side| self.is_open(side)) {
                return false;
            }
        } else {
            apexes.push(self.to(next(partner)));
            let is_tetrahedron = apexes[0] == apexes[1]
                || [u, v].iter().all(|&v| !self.is_border(v) && self.sides(v).count() == 3);
            if is_tetrahedron || (self.is_border(u) && self.is_border(v)) {
                return false;
            }
        }
        let of_u: Vec<u32> = self.neighbors(u).collect();
        self.neighbors(v).filter(|w| of_u.contains(w)).count() == apexes.len()
    }

    /// Makes the ends of a side one vertex, that at its beginning. The side must be one that
    /// [may collapse](Self::may_collapse).
    pub(super) fn collapse(&mut self, side: Side) {
        let (kept, gone) = (self.from(side), self.to(side));
        let around: Vec<Side> = self.sides(gone).collect();
        for side in around {
            self.triangles[side as usize / 3][side as usize % 3] = kept;
        }
        let partner = self.partners[side as usize];
        let mut start = self.close(side);
        if partner != NONE {
            start = self.close(partner).or(start);
        }
        self.first[gone as usize] = NONE;
        self.first[kept as usize] = start.map_or(NONE, |start| self.clockwise_end(start));
    }

    /// Takes out the triangle of a side whose ends have become one; its two other sides are one then.
    /// A side that leaves that vertex.
    fn close(&mut self, side: Side) -> Option<Side> {
        let apex = self.to(next(side));
        let (towards, away) = (next(side), previous(side));
        // Beyond the triangle, this one leaves the apex, and this one leads to it.
        let leaving = self.partners[towards as usize];
        let leading = self.partners[away as usize];
        for (a, b) in [(leaving, leading), (leading, leaving)] {
            if a != NONE {
                self.partners[a as usize] = b;
            }
        }
        if self.first[apex as usize] == away {
            self.first[apex as usize] = leaving;
        }
        self.triangles[side as usize / 3] = [NONE; 3];
        self.n_triangles -= 1;
        if leading != NONE { Some(leading) } else { (leaving != NONE).then(|| next(leaving)) }
    }

    /// The first side around a vertex, from any that leaves it.
    fn clockwise_end(&self, start: Side) -> Side {
        let mut side = start;
        loop {
            let partner = self.partners[side as usize];
            if partner == NONE {
                return side;
            }
            side = next(partner);
            if side == start {
                return side;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fans(n_vertices: usize, triangles: &[[u32; 3]]) -> Option<Fans> {
        Fans::new(&Mesh {
            positions: vec![[0.0; 3]; n_vertices],
            triangles: triangles.to_vec(),
            ..Mesh::default()
        })
    }

    fn may_collapse(fans: &Fans, u: u32, v: u32) -> bool {
        fans.may_collapse(fans.side_between(u, v).unwrap_or(NONE))
    }

    #[test]
    fn closed_pieces_end_as_tetrahedra() {
        let octahedron = [
            [0, 2, 4],
            [2, 1, 4],
            [1, 3, 4],
            [3, 0, 4],
            [2, 0, 5],
            [1, 2, 5],
            [3, 1, 5],
            [0, 3, 5],
        ];
        let Some(mut fans) = fans(6, &octahedron) else { panic!("it is a manifold") };
        assert_eq!(fans.neighbors(4).collect::<Vec<_>>(), [0, 2, 1, 3]);
        assert!(may_collapse(&fans, 0, 4));
        fans.collapse(fans.side_between(0, 4).unwrap_or(NONE));
        assert_eq!(fans.n_triangles(), 6);
        assert!(fans.is_gone(4) && !fans.is_gone(0));
        // 1 and 0 are opposite, and both have 2, 3 and 5 around them.
        assert!(!may_collapse(&fans, 0, 1));
        assert!(may_collapse(&fans, 0, 2));
        fans.collapse(fans.side_between(0, 2).unwrap_or(NONE));
        assert_eq!(fans.n_triangles(), 4);
        assert!([[0, 1], [0, 3], [1, 3], [1, 5]].iter().all(|&[u, v]| !may_collapse(&fans, u, v)));
    }

    #[test]
    fn borders_stay_apart() {
        // A strip of three triangles: what leads across it must not collapse.
        let Some(mut fans) = fans(5, &[[0, 1, 2], [2, 1, 3], [2, 3, 4]]) else {
            panic!("it is a manifold")
        };
        assert!((0..5).all(|v| fans.is_border(v)));
        assert!(!may_collapse(&fans, 1, 2) && !may_collapse(&fans, 2, 3));
        assert!(may_collapse(&fans, 0, 1) && may_collapse(&fans, 1, 3));
        fans.collapse(fans.side_between(1, 3).unwrap_or(NONE));
        assert_eq!(fans.neighbors(2).count(), 3);
        fans.collapse(fans.side_between(0, 2).unwrap_or(NONE));
        assert_eq!(fans.n_triangles(), 1);
        // The last one stays.
        assert!(fans.edges().all(|side| !fans.may_collapse(side)));
    }

    #[test]
    fn only_oriented_manifolds_have_fans() {
        assert!(fans(3, &[[0, 1, 2]]).is_some());
        assert!(fans(4, &[[0, 1, 2], [0, 1, 3]]).is_none());
        assert!(fans(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]).is_none());
        assert!(fans(5, &[[0, 1, 2], [0, 3, 4]]).is_none());
        assert!(fans(3, &[[0, 1, 1]]).is_none());
    }
}
