//! How far a mesh is from another one.

use glam::DVec3;
use rayon::prelude::*;

use super::{
    Mesh,
    boxes::{Bounds, Boxes},
};

/// Vertices that a thread looks at one after the other: they are near each other.
const CHUNK: usize = 1 << 10;

impl Mesh {
    /// The farthest that a vertex of this mesh is from the surface of another one; infinite if that
    /// has no triangles.
    #[must_use]
    pub fn deviation_from(&self, other: &Self) -> f64 {
        let boxes = Boxes::new(other);
        let farthest = |points: &[[f32; 3]]| {
            let mut farthest = 0.0_f64;
            // The nearest triangle of the last vertex is a good first guess for the next one.
            let mut guess = None;
            let mut stack = Vec::new();
            for point in points {
                let (distance, nearest) = nearest(other, &boxes, wide(*point), guess, &mut stack);
                farthest = farthest.max(distance);
                guess = nearest;
            }
            farthest
        };
        let all = self.positions.par_chunks(CHUNK).map(farthest);
        all.reduce(|| 0.0, f64::max).sqrt()
    }
}

/// The squared distance of a point from a mesh, and the nearest of its triangles. `stack` is empty
/// before and after.
fn nearest(
    mesh: &Mesh,
    boxes: &Boxes,
    point: DVec3,
    guess: Option<u32>,
    stack: &mut Vec<(usize, usize, f64)>,
) -> (f64, Option<u32>) {
    let to_triangle = |t: u32| {
        let corners = mesh.triangles[t as usize].map(|v| wide(mesh.positions[v as usize]));
        point.distance_squared(nearest_point(corners, point))
    };
    let mut best = (guess.map_or(f64::INFINITY, to_triangle), guess);
    let top = boxes.levels.len() - 1;
    if let Some(whole) = boxes.levels[top].first() {
        stack.push((top, 0, to_bounds(whole, point)));
    }
    while let Some((level, number, distance)) = stack.pop() {
        if distance >= best.0 {
            continue;
        }
        if level == 0 {
            for &t in &boxes.order[boxes.of_leaf(number)] {
                let distance = to_triangle(t);
                if distance < best.0 {
                    best = (distance, Some(t));
                }
            }
            continue;
        }
        let n_before = stack.len();
        stack.extend(
            boxes
                .inside(level, number)
                .map(|below| (level - 1, below, to_bounds(&boxes.levels[level - 1][below], point))),
        );
        // The nearer one is looked at first.
        if stack[n_before].2 < stack[stack.len() - 1].2 {
            stack[n_before..].reverse();
        }
    }
    best
}

fn wide(p: [f32; 3]) -> DVec3 {
    DVec3::from_array(p.map(f64::from))
}

/// The squared distance of a point from a box.
fn to_bounds(bounds: &Bounds, point: DVec3) -> f64 {
    let (min, max) = (wide(bounds.min), wide(bounds.max));
    (min - point).max(point - max).max(DVec3::ZERO).length_squared()
}

/// The point of a triangle that is nearest to `p`.
///
/// *Based on:* C. Ericson, *Real-Time Collision Detection*, 2005, section 5.1.5.
fn nearest_point([a, b, c]: [DVec3; 3], p: DVec3) -> DVec3 {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (ab.dot(p - a), ac.dot(p - a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let (d3, d4) = (ab.dot(p - b), ac.dot(p - b));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let (d5, d6) = (ab.dot(p - c), ac.dot(p - c));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    // Areas of the parts across from each corner, by their signs.
    let (of_a, of_b, of_c) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    if of_c <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + d1 / (d1 - d3) * ab;
    }
    if of_b <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + d2 / (d2 - d6) * ac;
    }
    if of_a <= 0.0 && d4 >= d3 && d5 >= d6 {
        let part = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return b + part * (c - b);
    }
    let whole = of_a + of_b + of_c;
    a + of_b / whole * ab + of_c / whole * ac
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_is_nearer_than_others() {
        let corners = [DVec3::ZERO, DVec3::new(2.0, 0.3, 0.1), DVec3::new(0.4, 1.5, -0.2)];
        let [a, b, c] = corners;
        let n = 60;
        for i in 0..1000_u32 {
            let part = |k: u32| f64::from(i * k % 997) / 997.0 * 6.0 - 3.0;
            let p = DVec3::new(part(331), part(577), part(769));
            let nearest = nearest_point(corners, p).distance(p);
            let of_grid = (0..=n).flat_map(|i| (0..=n - i).map(move |j| (i, j))).map(|(i, j)| {
                let [u, v] = [i, j].map(|k| f64::from(k) / f64::from(n));
                (a + u * (b - a) + v * (c - a)).distance(p)
            });
            let of_grid = of_grid.fold(f64::INFINITY, f64::min);
            assert!(nearest <= of_grid + 1e-12 && of_grid < nearest + 0.05, "{p}");
        }
    }

    #[test]
    fn a_square_above_a_square_is_as_far_as_it_is_high() {
        let square = |z: f32, n: u32| {
            let at = |i: u32| [(i % (n + 1)) as f32 / n as f32, (i / (n + 1)) as f32 / n as f32, z];
            let of_cell = |i: u32| {
                let v = i % n + (n + 1) * (i / n);
                [[v, v + 1, v + n + 2], [v, v + n + 2, v + n + 1]]
            };
            Mesh {
                positions: (0..(n + 1) * (n + 1)).map(at).collect(),
                triangles: (0..n * n).flat_map(of_cell).collect(),
                ..Mesh::default()
            }
        };
        assert_eq!(square(0.25, 20).deviation_from(&square(0.0, 13)), 0.25);
        assert_eq!(square(0.0, 7).deviation_from(&square(0.0, 16)), 0.0);
        assert_eq!(square(0.0, 1).deviation_from(&Mesh::default()), f64::INFINITY);
    }
}
