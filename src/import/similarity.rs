//! Maps of space that keep the shape of things.

use glam::{DMat3, DMat4, DVec3, DVec4};

use super::{number, snapped, vector};

/// By how much the columns of a matrix may differ in length, and from a right angle: files hold
/// rotations with seven digits.
const TOLERANCE: f64 = 1e-3;

/// A turn, times a factor, and a shift.
pub(super) struct Similarity {
    /// Columns of the same length, at right angles.
    pub(super) linear: DMat3,
    pub(super) scale: f64,
    pub(super) shift: DVec3,
}

impl Similarity {
    pub(super) fn new(matrix: DMat4) -> Option<Self> {
        let linear = DMat3::from_mat4(matrix);
        let scale = libm::cbrt(linear.determinant());
        let unlike = (linear.transpose() * linear) * (1.0 / (scale * scale)) - DMat3::IDENTITY;
        let is_affine = matrix.row(3).abs_diff_eq(DVec4::W, TOLERANCE);
        let is_similar = scale > 0.0 && unlike.abs_diff_eq(DMat3::ZERO, TOLERANCE);
        (is_affine && is_similar).then_some(Self { linear, scale, shift: matrix.w_axis.truncate() })
    }

    /// Where the axis number i leads, with a length of 1.
    pub(super) fn axis(&self, i: usize) -> DVec3 {
        self.linear.col(i).normalize()
    }

    /// How far `place` is before a camera whose space this one leads out of.
    pub(super) fn ahead(&self, place: DVec3) -> f64 {
        self.axis(2).dot(self.shift - place)
    }

    /// `[domain]` for the ball that the ball of radius 1 becomes.
    pub(super) fn domain(&self) -> String {
        let (middle, radius) = (snapped(self.shift, self.scale), self.scale);
        let square = |axis: &str, middle: f64| match number(middle.abs()) {
            _ if middle == 0.0 => format!("{axis}^2"),
            text if middle < 0.0 => format!("({axis} + {text})^2"),
            text => format!("({axis} - {text})^2"),
        };
        let squares = [("x", middle.x), ("y", middle.y), ("z", middle.z)];
        let squares = squares.map(|(axis, middle)| square(axis, middle)).join(" + ");
        let [min, max] = [-radius, radius].map(|reach| vector(middle + DVec3::splat(reach)));
        let radius = number(radius);
        format!("[domain]\nmin = {min}\nmax = {max}\nclip = \"{squares} <= {radius}^2\"\n")
    }
}
