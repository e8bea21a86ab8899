//! Normals at the corners of triangles: the file's, or the mean of what meets there smoothly.

use glam::DVec3;
use rustc_hash::FxHashMap;

/// Cosine of the angle above which two faces meet in an edge.
const CREASE: f64 = 0.766;

/// The unit normals at the corners of every triangle. Where `given` has none (zero or not finite)
/// it is the mean of the normals of the faces around the same point, by their angles there, as far
/// as they differ from the face's own by less than 40 degrees.
pub(super) fn at_corners(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    given: &[DVec3],
) -> Vec<[DVec3; 3]> {
    let is_given = |n: DVec3| n.is_finite() && n.length_squared() > 0.0;
    let faces: Vec<DVec3> = triangles.iter().map(|corners| face(positions, corners)).collect();
    // Vertices are the same point if they lie at the same place: seams of textures do not show.
    let mut around: FxHashMap<[u64; 3], Vec<(usize, f64)>> = FxHashMap::default();
    let key = |i: u32| positions[i as usize].to_array().map(|v| (v + 0.0).to_bits());
    if !given.iter().all(|&n| is_given(n)) {
        for (t, corners) in triangles.iter().enumerate() {
            for c in 0..3 {
                let angle = angle(positions, corners, c);
                around.entry(key(corners[c])).or_default().push((t, angle));
            }
        }
    }
    let at_corner = |t: usize, corner: u32| {
        let given = given[corner as usize];
        if is_given(given) {
            return (given / given.abs().max_element()).normalize();
        }
        let own = faces[t];
        let smooth = around[&key(corner)].iter().filter(|(t, _)| faces[*t].dot(own) >= CREASE);
        let sum: DVec3 = smooth.map(|&(t, angle)| angle * faces[t]).sum();
        sum.normalize_or(own)
    };
    let of_triangle = |(t, corners): (usize, &[u32; 3])| corners.map(|i| at_corner(t, i));
    triangles.iter().enumerate().map(of_triangle).collect()
}

/// The unit normal of a triangle; +z if it has no area.
fn face(positions: &[DVec3], corners: &[u32; 3]) -> DVec3 {
    let [a, b, c] = corners.map(|i| positions[i as usize]);
    (b - a).cross(c - a).normalize_or(DVec3::Z)
}

/// The angle of a triangle at corner `c`.
fn angle(positions: &[DVec3], corners: &[u32; 3], c: usize) -> f64 {
    let at = |k: usize| positions[corners[(c + k) % 3] as usize];
    let (u, v) = ((at(1) - at(0)).normalize_or_zero(), (at(2) - at(0)).normalize_or_zero());
    libm::acos(u.dot(v).clamp(-1.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles with an edge in common, the second turned by `degrees` around it.
    fn hinge(degrees: f64) -> Vec<[DVec3; 3]> {
        let angle = degrees.to_radians();
        let far = DVec3::new(-libm::cos(angle), 0.0, libm::sin(angle));
        let positions = [DVec3::ZERO, DVec3::Y, DVec3::X, far];
        at_corners(&positions, &[[0, 2, 1], [0, 1, 3]], &[DVec3::ZERO; 4])
    }

    #[test]
    fn smooth_edges_are_smoothed_and_sharp_ones_are_not() {
        let [smooth, sharp] = [hinge(30.0), hinge(60.0)];
        assert_eq!(smooth[0][0], smooth[1][0]);
        assert_eq!(sharp[0], [DVec3::Z; 3]);
        assert!(sharp[1].iter().all(|n| n.dot(DVec3::Z) < 0.6));
    }
}
