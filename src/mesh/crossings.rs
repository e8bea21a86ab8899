//! Where a mesh passes through itself.
//!
//! *Based on:* P. Guigue, O. Devillers, "Fast and Robust Triangle-Triangle Overlap Test Using
//! Orientation Predicates", Journal of Graphics Tools 2003; J. Shewchuk, "Adaptive Precision
//! Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997 (signs that are exact).

use rayon::prelude::*;
use robust::{Coord, Coord3D, orient2d, orient3d};

use super::{Mesh, boxes::Boxes};

type Point = [f32; 3];

impl Mesh {
    /// How many pairs of triangles have inner points in common, decided without rounding. Pairs that
    /// only touch, at corners, along edges or with a corner on the other one, do not count; those
    /// that lie in one plane and overlap there do. Triangles without area have no inner points.
    #[must_use]
    pub fn self_intersections(&self) -> u64 {
        let boxes = Boxes::new(self);
        let corners = |place: usize| {
            self.triangles[boxes.order[place] as usize].map(|v| self.positions[v as usize])
        };
        let top = boxes.levels.len() - 1;
        let of_leaf = |stack: &mut Vec<(usize, usize)>, leaf: usize| {
            let own = &boxes.levels[0][leaf];
            let mut n = 0;
            stack.push((top, 0));
            while let Some((level, number)) = stack.pop() {
                // Every pair is met once, from its lower place.
                let is_before = ((number + 1) << level) <= leaf;
                let around = &boxes.levels[level][number];
                if is_before || !around.meets(own) {
                    continue;
                }
                if level > 0 {
                    stack.extend(boxes.inside(level, number).map(|below| (level - 1, below)));
                    continue;
                }
                for i in boxes.of_leaf(leaf).filter(|&i| boxes.triangles[i].meets(around)) {
                    for j in boxes.of_leaf(number) {
                        let is_near = j > i && boxes.triangles[i].meets(&boxes.triangles[j]);
                        n += u64::from(is_near && overlap(&corners(i), &corners(j)));
                    }
                }
            }
            n
        };
        (0..boxes.levels[0].len()).into_par_iter().map_init(Vec::new, of_leaf).sum()
    }
}

/// Whether two triangles have inner points in common.
fn overlap(a: &[Point; 3], b: &[Point; 3]) -> bool {
    let of_a = a.map(|p| side(b, p));
    let [any_above, any_below] = [1.0, -1.0].map(|sign| of_a.iter().any(|s| s * sign > 0.0));
    if !any_above && !any_below {
        return overlap_in_plane(a, b);
    }
    if !(any_above && any_below) {
        return false;
    }
    let of_b = b.map(|p| side(a, p));
    if !of_b.iter().any(|&s| s > 0.0) || !of_b.iter().any(|&s| s < 0.0) {
        return false;
    }
    // Each reaches through the plane of the other one with its corner p, seen from which that plane
    // turns the way that makes p above it. They meet if the parts of the line in which the planes
    // meet overlap.
    let (p, mut a, is_a_above) = first_alone(a, of_a);
    let (q, mut b, is_b_above) = first_alone(b, of_b);
    if !is_a_above {
        b.reverse();
    }
    if !is_b_above {
        a.reverse();
    }
    side(&[a[0], q, p], b[0]) < 0.0 && side(&[p, q, a[1]], b[1]) < 0.0
}

/// Above 0 if `p` is on the side of the plane of a triangle from which that is counter-clockwise, 0 if
/// it lies in the plane.
fn side(triangle: &[Point; 3], p: Point) -> f64 {
    let [a, b, c] = *triangle;
    // Common corners, and what lies across an axis, as caps do, need no long arithmetic.
    if triangle.contains(&p)
        || (0..3).any(|axis| [a, b, c].iter().all(|corner| corner[axis] == p[axis]))
    {
        return 0.0;
    }
    let [a, b, c, p] = [a, b, c, p].map(|[x, y, z]| Coord3D { x, y, z });
    -orient3d(a, b, c, p)
}

/// The corner that is alone on its side of a plane, the other two in their order, and whether it is
/// above.
fn first_alone(corners: &[Point; 3], sides: [f64; 3]) -> (Point, [Point; 2], bool) {
    let is_above = sides.iter().filter(|&&s| s > 0.0).count() == 1;
    let is_alone = |&i: &usize| if is_above { sides[i] > 0.0 } else { sides[i] < 0.0 };
    let i = (0..3).find(is_alone).unwrap_or(0);
    (corners[i], [corners[(i + 1) % 3], corners[(i + 2) % 3]], is_above)
}

/// Whether two triangles of one plane overlap: unless all of one lies beyond an edge of the other.
fn overlap_in_plane(a: &[Point; 3], b: &[Point; 3]) -> bool {
    // Seen along an axis that shows it from a side.
    for axis in 0..3 {
        let flat = |p: Point| Coord { x: p[(axis + 1) % 3], y: p[(axis + 2) % 3] };
        let turned = |corners: &[Point; 3]| {
            let [p, q, r] = corners.map(flat);
            let turn = orient2d(p, q, r);
            (turn != 0.0).then_some(if turn > 0.0 { [p, q, r] } else { [p, r, q] })
        };
        let (Some(a), Some(b)) = (turned(a), turned(b)) else { continue };
        let parts = |a: &[Coord<f32>; 3], b: &[Coord<f32>; 3]| {
            (0..3).any(|i| b.iter().all(|&p| orient2d(a[i], a[(i + 1) % 3], p) <= 0.0))
        };
        return !parts(&a, &b) && !parts(&b, &a);
    }
    false
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn mesh(corners: &[[Point; 3]]) -> Mesh {
        Mesh {
            positions: corners.as_flattened().to_vec(),
            triangles: (0..corners.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
            ..Mesh::default()
        }
    }

    fn count(corners: &[[Point; 3]]) -> u64 {
        mesh(corners).self_intersections()
    }

    const FLAT: [Point; 3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    #[test]
    fn what_crosses_counts() {
        assert_eq!(count(&[]), 0);
        assert_eq!(count(&[FLAT]), 0);
        assert_eq!(count(&[FLAT, [[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [9.0, 9.0, 1.0]]]), 1);
        // From a corner of both, and from an edge through an edge.
        assert_eq!(count(&[FLAT, [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [1.0, 1.0, -1.0]]]), 1);
        assert_eq!(count(&[FLAT, [[2.0, -1.0, 0.0], [2.0, 1.0, 1.0], [2.0, 1.0, -1.0]]]), 1);
    }

    #[test]
    fn what_touches_does_not_count() {
        // A corner on the triangle, an edge along it, a corner on an edge, a common edge.
        assert_eq!(count(&[FLAT, [[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [2.0, 2.0, 1.0]]]), 0);
        assert_eq!(count(&[FLAT, [[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [1.0, 1.0, 1.0]]]), 0);
        assert_eq!(count(&[FLAT, [[2.0, 0.0, 0.0], [2.0, -1.0, 1.0], [2.0, -1.0, -1.0]]]), 0);
        assert_eq!(count(&[FLAT, [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 1.0, 1.0]]]), 0);
        // Beside each other in one plane.
        assert_eq!(count(&[FLAT, [[4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 4.0, 0.0]]]), 0);
    }

    #[test]
    fn what_overlaps_in_a_plane_counts() {
        assert_eq!(count(&[FLAT, FLAT]), 1);
        assert_eq!(count(&[FLAT, [[1.0, 1.0, 0.0], [0.5, 1.0, 0.0], [1.0, 0.5, 0.0]]]), 1);
        // A strip that is folded back upon itself: both have an edge in common.
        assert_eq!(count(&[FLAT, [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 3.0, 0.0]]]), 1);
        let tilted = [[0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
        assert_eq!(count(&[tilted, [[0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.25, 0.5, 0.75]]]), 1);
        let no_area = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [2.0, 2.0, 0.0]];
        assert_eq!(count(&[FLAT, no_area]), 0);
    }

    /// Whether two triangles with small whole coordinates overlap, with fractions: the line through
    /// each edge of one is cut with the other, and the middle of what both have in common is inside
    /// both.
    fn overlap_by_fractions(a: &[[i128; 3]; 3], b: &[[i128; 3]; 3]) -> bool {
        let sub = |p: [i128; 3], q: [i128; 3]| [0, 1, 2].map(|i| p[i] - q[i]);
        let dot = |p: [i128; 3], q: [i128; 3]| (0..3).map(|i| p[i] * q[i]).sum::<i128>();
        let cross = |p: [i128; 3], q: [i128; 3]| {
            [0, 1, 2].map(|i| p[(i + 1) % 3] * q[(i + 2) % 3] - p[(i + 2) % 3] * q[(i + 1) % 3])
        };
        let normal = |t: &[[i128; 3]; 3]| cross(sub(t[1], t[0]), sub(t[2], t[0]));
        let (n, m) = (normal(a), normal(b));
        let line = cross(n, m);
        if n == [0; 3] || m == [0; 3] || line == [0; 3] {
            return false;
        }
        // Where the edges of a triangle pass through the plane of the other one, along the line, as
        // fractions; the parts between are open.
        let part = |t: &[[i128; 3]; 3], other: &[[i128; 3]; 3], across: [i128; 3]| {
            let height = t.map(|p| dot(sub(p, other[0]), across));
            if height.iter().all(|&h| h >= 0) || height.iter().all(|&h| h <= 0) {
                return None;
            }
            let along = t.map(|p| dot(p, line));
            let mut places: Vec<(i128, i128)> = Vec::new();
            for i in 0..3 {
                let j = (i + 1) % 3;
                if height[i] == 0 {
                    places.push((along[i], 1));
                }
                if height[i].signum() * height[j].signum() < 0 {
                    let (p, q) = (height[i].abs(), height[j].abs());
                    places.push((along[i] * q + along[j] * p, p + q));
                }
            }
            let less = |x: &(i128, i128), y: &(i128, i128)| (x.0 * y.1).cmp(&(y.0 * x.1));
            places.sort_by(less);
            Some((places[0], places[places.len() - 1]))
        };
        let (Some((a0, a1)), Some((b0, b1))) = (part(a, b, m), part(b, a, n)) else { return false };
        let is_less = |x: (i128, i128), y: (i128, i128)| x.0 * y.1 < y.0 * x.1;
        is_less(a0, b1) && is_less(b0, a1)
    }

    proptest! {
        /// Small numbers, so that all kinds of touching happen.
        #[test]
        fn fractions_say_the_same(corners in prop::array::uniform2(
            prop::array::uniform3(prop::array::uniform3(-3_i8..=3))
        )) {
            let [a, b] = corners.map(|t| t.map(|p| p.map(i128::from)));
            let [p, q] = corners.map(|t| t.map(|p| p.map(f32::from)));
            let sub = |p: [i128; 3], q: [i128; 3]| [0, 1, 2].map(|i| p[i] - q[i]);
            let cross = |p: [i128; 3], q: [i128; 3]| {
                [0, 1, 2].map(|i| p[(i + 1) % 3] * q[(i + 2) % 3] - p[(i + 2) % 3] * q[(i + 1) % 3])
            };
            let [n, m] = [a, b].map(|t| cross(sub(t[1], t[0]), sub(t[2], t[0])));
            prop_assume!(cross(n, m) != [0; 3]);
            let expected = u64::from(overlap_by_fractions(&a, &b));
            prop_assert_eq!(count(&[p, q]), expected);
            prop_assert_eq!(count(&[q, p]), expected);
        }

        /// In the plane, where a third is shared by its corners: any inner point of both is one of a
        /// fine grid's.
        #[test]
        fn a_grid_of_points_says_the_same(corners in prop::array::uniform2(
            prop::array::uniform3(prop::array::uniform2(0_i8..=4))
        )) {
            let inner = |t: &[[i64; 2]; 3], p: [i64; 2]| {
                let turn = |a: [i64; 2], b: [i64; 2], c: [i64; 2]| {
                    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
                };
                let signs = [0, 1, 2].map(|i| turn(t[i], t[(i + 1) % 3], p).signum());
                signs == [1; 3] || signs == [-1; 3]
            };
            // Corners of the overlap are fractions with denominators up to 32, and it is no thinner
            // than what this grid sees.
            const FINE: i64 = 97;
            let [a, b] = corners.map(|t| t.map(|p| p.map(|c| i64::from(c) * FINE)));
            let expected = (0..=4 * FINE).any(|x| {
                (0..=4 * FINE).any(|y| inner(&a, [x, y]) && inner(&b, [x, y]))
            });
            let [p, q] = corners.map(|t| t.map(|[x, y]| [f32::from(x), f32::from(y), f32::from(x) + 2.0]));
            prop_assert_eq!(count(&[p, q]), u64::from(expected));
        }

        /// All pairs one by one.
        #[test]
        fn boxes_miss_nothing(
            corners in prop::collection::vec(
                (prop::array::uniform3(0_f32..10.0), prop::array::uniform3(prop::array::uniform3(0_f32..1.5))),
                1..120,
            )
        ) {
            let corners: Vec<[Point; 3]> = corners.iter().map(|(base, t)| {
                t.map(|p| [0, 1, 2].map(|axis| base[axis] + p[axis]))
            }).collect();
            let pairs = (0..corners.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
            let n = pairs.filter(|&(i, j)| overlap(&corners[i], &corners[j])).count();
            prop_assert_eq!(count(&corners), n as u64);
        }
    }
}
