//! How far away a camera must be to see everything.
//!
//! With a fixed viewing direction each border of the picture is a plane of fixed orientation, so
//! all that matters of the content is how far it reaches along a few directions: its support
//! function. The tightest camera then follows in closed form, without iteration.

use glam::{DVec2, DVec3};

use super::camera::Basis;
use crate::math::Aabb;

/// Something that a camera can be fitted to.
pub trait Content {
    /// For each direction d, the largest d·p over all points p of the content; negative infinity
    /// if there are none.
    fn reach<const N: usize>(&self, directions: [DVec3; N]) -> [f64; N];
}

impl Content for [Aabb] {
    fn reach<const N: usize>(&self, directions: [DVec3; N]) -> [f64; N] {
        let of_box = |b: &Aabb| {
            let (center, half) = (b.center(), 0.5 * b.size());
            directions.map(|d| d.dot(center) + d.abs().dot(half))
        };
        fold_reach(self.iter().map(of_box))
    }
}

impl<A: Content, B: Content + ?Sized> Content for (A, &B) {
    fn reach<const N: usize>(&self, directions: [DVec3; N]) -> [f64; N] {
        fold_reach([self.0.reach(directions), self.1.reach(directions)])
    }
}

/// The reach of a union, from the reach of its pieces in their order.
pub(super) fn fold_reach<const N: usize>(pieces: impl IntoIterator<Item = [f64; N]>) -> [f64; N] {
    pieces.into_iter().fold([f64::NEG_INFINITY; N], |a, b| {
        // A plain comparison: which zero `f64::max` returns for (-0, +0) is not specified.
        std::array::from_fn(|k| if b[k] > a[k] { b[k] } else { a[k] })
    })
}

/// The content's box in view axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extents {
    /// Smallest coordinates: right, up, depth.
    pub(super) min: DVec3,
    /// Largest coordinates: right, up, depth.
    pub(super) max: DVec3,
}

impl Extents {
    /// # Panics
    /// If the content is empty or not finite.
    pub(super) fn of(content: &(impl Content + ?Sized), basis: &Basis) -> Self {
        let Basis { right, up, forward } = *basis;
        let [x1, y1, z1, x0, y0, z0] = content.reach([right, up, forward, -right, -up, -forward]);
        let (min, max) = (DVec3::new(-x0, -y0, -z0), DVec3::new(x1, y1, z1));
        assert!(min.is_finite() && max.is_finite(), "a camera needs content to be fitted to");
        Self { min, max }
    }

    /// Depth of a plane in front of everything.
    pub(super) fn depth_in_front(&self) -> f64 {
        depth_in_front(self.min.z, self.max.z)
    }
}

/// Depth of a plane in front of everything between two depths: an eighth of their distance before
/// the first.
pub(super) fn depth_in_front(nearest: f64, farthest: f64) -> f64 {
    nearest - 0.125 * (farthest - nearest)
}

/// Places a perspective camera as close as it can be, and returns its place in view axes (right,
/// up, depth).
///
/// `slope` holds the tangents of the half angles, across and up, that the content may fill. A
/// point (X, Y, Z) is inside for an eye (x, y, z) when |X - x| <= slope.x (Z - z), which is
///
/// ```text
///    x - slope.x z >= a,  a = max of  X - slope.x Z   (the reach along right - slope.x forward)
///   -x - slope.x z >= b,  b = max of -X - slope.x Z
/// ```
///
/// Their sum bounds z; at any allowed z, x = (a - b)/2 leaves equal room on both sides. The same
/// holds for y, and the eye takes the farther of the two places.
pub(super) fn fit_perspective(
    content: &(impl Content + ?Sized),
    basis: &Basis,
    slope: DVec2,
) -> DVec3 {
    let Basis { right, up, forward } = *basis;
    let across = slope.x * forward;
    let upward = slope.y * forward;
    let [a, b, c, d, near] =
        content.reach([right - across, -right - across, up - upward, -up - upward, -forward]);
    let eye = DVec3::new(
        0.5 * (a - b),
        0.5 * (c - d),
        (-0.5 * (a + b) / slope.x).min(-0.5 * (c + d) / slope.y).min(-near),
    );
    assert!(eye.is_finite(), "a camera needs content to be fitted to");
    eye
}
