//! The ways of tools: single places, lines from place to place, and curves through them.

use glam::DVec3;

/// How a tool gets from place to place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Path {
    /// It is set down at each.
    #[default]
    Points,
    /// Along straight lines.
    Line,
    /// Along a smooth curve through all.
    Curve,
}

/// A straight piece of a way; a place, if both ends are the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Its first end.
    pub from: DVec3,
    /// Its last end.
    pub to: DVec3,
}

/// Pieces of a curve between two places.
const PIECES: u32 = 8;

impl Path {
    /// The pieces of the way through `places`, in order.
    #[must_use]
    pub fn pieces(self, places: &[DVec3]) -> Vec<Piece> {
        let single = |&place: &DVec3| Piece { from: place, to: place };
        if self == Self::Points || places.len() < 2 {
            return places.iter().map(single).collect();
        }
        let places = match self {
            Self::Curve => curve(places),
            _ => places.to_vec(),
        };
        places.windows(2).map(|ends| Piece { from: ends[0], to: ends[1] }).collect()
    }
}

impl Piece {
    /// The point of the piece next to `p`.
    #[must_use]
    pub fn nearest(&self, p: DVec3) -> DVec3 {
        let way = self.to - self.from;
        let length = way.length_squared();
        if length == 0.0 {
            return self.from;
        }
        self.from + ((p - self.from).dot(way) / length).clamp(0.0, 1.0) * way
    }
}

/// Points of a Catmull–Rom spline through `places`.
fn curve(places: &[DVec3]) -> Vec<DVec3> {
    let n = places.len();
    let at = |i: usize| places[i.clamp(1, n) - 1];
    let mut points = vec![places[0]];
    for i in 1..n {
        let [a, b, c, d] = [at(i - 1), at(i), at(i + 1), at(i + 2)];
        for step in 1..=PIECES {
            let t = f64::from(step) / f64::from(PIECES);
            points.push(
                0.5 * (2.0 * b
                    + t * (c - a)
                    + t * t * (2.0 * a - 5.0 * b + 4.0 * c - d)
                    + t * t * t * (3.0 * (b - c) + d - a)),
            );
        }
    }
    points
}
