//! Pictures of a lit ball that stand for all light: what faces a way looks as the ball does there.
//!
//! *Based on:* P. Sloan, W. Martin, A. Gooch, B. Gooch, "The Lit Sphere: A Model for Capturing NPR
//! Shading from Art", Graphics Interface 2001.

use glam::{DVec2, DVec3};

/// A square picture of a ball that fills it, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Matcap {
    side: usize,
    /// Linear-light red, green, blue.
    pixels: Vec<[f32; 3]>,
}

impl Matcap {
    /// The picture with `side`² pixels of linear-light red, green, blue; `None` if they are not so
    /// many, or none.
    #[must_use]
    pub fn new(side: usize, pixels: Vec<[f32; 3]>) -> Option<Self> {
        (side > 0 && pixels.len() == side * side).then_some(Self { side, pixels })
    }

    /// The light of what faces `n`, given as right, up and towards the viewer, of length 1.
    pub(super) fn light(&self, n: DVec3) -> DVec3 {
        // The outermost pixels of a round picture are mixed with what is around it.
        let radius = 0.5 * self.side as f64 - 1.5;
        let middle = 0.5 * self.side as f64 - 0.5;
        let last = (self.side - 1) as f64;
        let at = DVec2::new(middle + radius * n.x, middle - radius * n.y);
        let at = at.clamp(DVec2::ZERO, DVec2::splat(last));
        let (first, part) = (at.floor(), at - at.floor());
        let mut sum = DVec3::ZERO;
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let x = (first.x as usize + dx).min(self.side - 1);
            let y = (first.y as usize + dy).min(self.side - 1);
            let weight_x = if dx == 1 { part.x } else { 1.0 - part.x };
            let weight_y = if dy == 1 { part.y } else { 1.0 - part.y };
            let pixel = self.pixels[y * self.side + x].map(f64::from);
            sum += weight_x * weight_y * DVec3::from_array(pixel);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_find_their_pixels() {
        let side = 5;
        let pixel = |i: usize| [(i % side) as f32, (i / side) as f32, 0.0];
        let matcap = Matcap::new(side, (0..side * side).map(pixel).collect()).unwrap();
        assert_eq!(matcap.light(DVec3::Z), DVec3::new(2.0, 2.0, 0.0));
        assert_eq!(matcap.light(DVec3::X), DVec3::new(3.0, 2.0, 0.0));
        assert_eq!(matcap.light(0.5 * DVec3::Y), DVec3::new(2.0, 1.5, 0.0));
        assert_eq!(Matcap::new(2, vec![[0.0; 3]; 3]), None);
        let one = Matcap::new(1, vec![[0.25; 3]]).unwrap();
        assert_eq!(one.light(DVec3::NEG_X), DVec3::splat(0.25));
    }
}
