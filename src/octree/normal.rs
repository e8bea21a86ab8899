//! Unit vectors in 32 bits: the octahedral map, 16 bits a component.
//!
//! *Based on:* Z. Cigolle, S. Donow, D. Evangelakos, M. Mara, M. McGuire, Q. Meyer, "A Survey of
//! Efficient Representations for Independent Unit Vectors", JCGT 2014, section 3 (oct32). The
//! largest error is 0.004 degrees.

use glam::DVec3;

use crate::math::Lanes;

/// A unit vector, folded onto the octahedron |x|+|y|+|z| = 1 and flattened to a square.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct OctNormal(u32);

/// The square's half width in steps; odd, so that 0 and the axes are exact.
const STEPS: f64 = 32767.0;

impl OctNormal {
    /// Encodes a vector of any positive finite length.
    #[must_use]
    pub fn encode(v: DVec3) -> Self {
        Self::from_steps(Self::steps(v.to_array()))
    }

    /// The two coordinates of vectors on the square, in steps: whole numbers.
    #[inline(always)]
    #[must_use]
    pub fn steps<L: Lanes<Scalar = f64>>([x, y, z]: [L; 3]) -> [L; 2] {
        let (zero, one) = (x.same(0.0), x.same(1.0));
        let scale = one / (x.abs() + y.abs() + z.abs());
        let (x, y, z) = (x * scale, y * scale, z * scale);
        let folded = [one - y.abs(), one - x.abs()];
        let folded = [
            L::pick(zero.le(x), folded[0], -folded[0]),
            L::pick(zero.le(y), folded[1], -folded[1]),
        ];
        let is_upper = zero.le(z);
        let steps = x.same(STEPS);
        [
            (L::pick(is_upper, x, folded[0]) * steps).round(),
            (L::pick(is_upper, y, folded[1]) * steps).round(),
        ]
    }

    /// The normal of what [`OctNormal::steps`] gives.
    #[inline(always)]
    #[must_use]
    pub fn from_steps(steps: [f64; 2]) -> Self {
        let [a, b] = steps;
        Self(u32::from(a as i16 as u16) | u32::from(b as i16 as u16) << 16)
    }

    /// Decodes to a unit vector.
    #[must_use]
    pub fn decode(self) -> DVec3 {
        self.direction().normalize()
    }

    /// The vector on the octahedron, which is shorter than 1.
    pub(super) fn direction(self) -> DVec3 {
        let component = |bits: u32| f64::from(bits as u16 as i16) / STEPS;
        let (a, b) = (component(self.0), component(self.0 >> 16));
        let z = 1.0 - a.abs() - b.abs();
        let fold = (-z).max(0.0);
        DVec3::new(a - sign(a) * fold, b - sign(b) * fold, z)
    }

    /// The 32 bits as stored.
    #[must_use]
    pub const fn to_bits(self) -> u32 {
        self.0
    }

    /// The inverse of [`OctNormal::to_bits`].
    #[must_use]
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits)
    }
}

fn sign(x: f64) -> f64 {
    if x >= 0.0 { 1.0 } else { -1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn error_is_below_four_thousandths_of_a_degree(
            x in -1.0..1.0_f64, y in -1.0..1.0_f64, z in -1.0..1.0_f64,
        ) {
            let v = DVec3::new(x, y, z);
            prop_assume!(v.length() > 1e-3);
            let error = OctNormal::encode(v).decode().cross(v.normalize()).length();
            prop_assert!(error < 0.004_f64.to_radians(), "{error}");
            prop_assert!(OctNormal::encode(v).decode().dot(v) > 0.0);
        }
    }

    #[test]
    fn axes_are_exact() {
        for axis in [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z] {
            assert_eq!(OctNormal::encode(axis * 3.0).decode(), axis);
        }
    }
}
