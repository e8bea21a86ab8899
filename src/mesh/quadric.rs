//! Sums of squared distances from planes and points, as quadratic functions of a place.
//!
//! *Based on:* M. Garland, P. Heckbert, "Surface Simplification Using Quadric Error Metrics", SIGGRAPH
//! 1997.

use std::ops::Add;

use glam::DVec3;

/// The function xᵀ A x + 2 bᵀ x + c.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Quadric {
    /// A, which is symmetric: its diagonal, and the elements yz, xz and xy beside it.
    diagonal: DVec3,
    beside: DVec3,
    b: DVec3,
    c: f64,
}

impl Quadric {
    /// `weight` times the squared distance from the plane through `p` across the unit vector `n`.
    pub(super) fn plane(p: DVec3, n: DVec3, weight: f64) -> Self {
        let d = n.dot(p);
        Self {
            diagonal: weight * n * n,
            beside: weight * DVec3::new(n.y * n.z, n.x * n.z, n.x * n.y),
            b: -weight * d * n,
            c: weight * d * d,
        }
    }

    /// `weight` times the squared distance from `p`.
    pub(super) fn point(p: DVec3, weight: f64) -> Self {
        Self {
            diagonal: DVec3::splat(weight),
            beside: DVec3::ZERO,
            b: -weight * p,
            c: weight * p.dot(p),
        }
    }

    /// Its value; what rounding makes negative is 0.
    pub(super) fn at(&self, x: DVec3) -> f64 {
        (x.dot(self.times(x)) + 2.0 * self.b.dot(x) + self.c).max(0.0)
    }

    /// Where it is least, by Cramer's rule; not finite where that is no single place.
    pub(super) fn least(&self) -> DVec3 {
        let (d, s) = (self.diagonal, self.beside);
        let rows =
            [DVec3::new(d.x, s.z, s.y), DVec3::new(s.z, d.y, s.x), DVec3::new(s.y, s.x, d.z)];
        let [x, y, z] = [rows[1].cross(rows[2]), rows[2].cross(rows[0]), rows[0].cross(rows[1])];
        -(self.b.x * x + self.b.y * y + self.b.z * z) / rows[0].dot(x)
    }

    /// The part of the way from `u` to `v` at which it is least; not finite where that is anywhere.
    pub(super) fn least_between(&self, u: DVec3, v: DVec3) -> f64 {
        let along = v - u;
        -(self.times(u) + self.b).dot(along) / along.dot(self.times(along))
    }

    fn times(&self, x: DVec3) -> DVec3 {
        let s = self.beside;
        let mixed = DVec3::new(s.z * x.y + s.y * x.z, s.z * x.x + s.x * x.z, s.y * x.x + s.x * x.y);
        self.diagonal * x + mixed
    }
}

impl Add for Quadric {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            diagonal: self.diagonal + other.diagonal,
            beside: self.beside + other.beside,
            b: self.b + other.b,
            c: self.c + other.c,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_planes_are_least_where_they_meet() {
        let corner = DVec3::new(0.3, -1.2, 2.5);
        let normals = [DVec3::new(0.6, 0.8, 0.0), DVec3::new(0.0, -0.6, 0.8), DVec3::X];
        let sum = normals
            .iter()
            .map(|&n| Quadric::plane(corner, n, 2.0))
            .fold(Quadric::default(), Quadric::add);
        assert!(sum.least().distance(corner) < 1e-12);
        assert!(sum.at(corner) < 1e-12);
        let off = DVec3::new(0.1, 0.2, -0.4);
        let direct: f64 = normals.iter().map(|n| 2.0 * n.dot(off) * n.dot(off)).sum();
        assert!((sum.at(corner + off) - direct).abs() < 1e-12);
        let part = sum.least_between(corner - off, corner + 3.0 * off);
        assert!((part - 0.25).abs() < 1e-12);
    }

    #[test]
    fn a_point_makes_the_least_place_unique() {
        let plane = Quadric::plane(DVec3::Z, DVec3::Z, 1.0);
        assert!(!plane.least().is_finite());
        let p = DVec3::new(4.0, 5.0, 1.0);
        let sum = plane + Quadric::point(p, 1e-4);
        assert!(sum.least().distance(p) < 1e-9);
        assert!((sum.at(p + DVec3::X) - 1e-4).abs() < 1e-12);
    }
}
