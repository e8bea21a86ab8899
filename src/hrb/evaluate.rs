//! A value at every point: constant in the middle of a region, and between neighbours a blend that is
//! continuous, whatever their sizes.
//!
//! The value is that of a trilinear interpolation between the finest samples, each of which is what
//! its region keeps. Inside a region, from half a sample on, all eight samples around are the region's, and
//! so is the value; elsewhere it blends with neighbours, and as all of it is one interpolation on one grid,
//! there is no jump anywhere.
//!
//! *Error:* every value is a mean of region values with positive weights that add up to 1, so it differs
//! from the interpolation of the samples by no more than a sample from what its region keeps: ε(1 − 1/n)
//! for the mean of n samples that differ by ε at most, and the rounding of what is kept.
//!
//! *Based on:* A. León Salas, 2008, section 2.2 (the two zones of a region).

use glam::DVec3;

use super::{HrbOctree, Value};

/// The first of the eight samples around a point, how far behind it the point is, in [0, 1], and their
/// values.
struct Around {
    part: [f64; 3],
    corners: [f64; 8],
}

impl<V: Value> HrbOctree<V> {
    /// The value at a point, in samples from the volume's first corner; samples are in the middles of
    /// unit cubes. Beyond the outermost samples it stays what it is there.
    #[must_use]
    pub fn value_at(&self, point: [f64; 3]) -> f64 {
        self.around(point).value()
    }

    /// The same, and its gradient.
    pub(crate) fn value_and_slope_at(&self, point: [f64; 3]) -> (f64, DVec3) {
        let around = self.around(point);
        (around.value(), around.slope())
    }

    fn around(&self, point: [f64; 3]) -> Around {
        let mut first = [0; 3];
        let mut part = [0.0; 3];
        for axis in 0..3 {
            let last = self.size()[axis] - 1;
            let at = (point[axis] - 0.5).clamp(0.0, f64::from(last));
            first[axis] = (at as u32).min(last.saturating_sub(1));
            part[axis] = at - f64::from(first[axis]);
        }
        let region = self.region_at(first);
        let own = region.value.to_f64();
        let corner = |c: u32| {
            let p = [0, 1, 2].map(|axis| {
                let last = self.size()[axis] - 1;
                (first[axis] + (c >> axis & 1)).min(last)
            });
            let is_own = (0..3).all(|axis| p[axis] >> region.level == first[axis] >> region.level);
            if is_own { own } else { self.region_at(p).value.to_f64() }
        };
        Around { part, corners: std::array::from_fn(|c| corner(c as u32)) }
    }
}

impl Around {
    #[inline]
    fn value(&self) -> f64 {
        let Self { part, corners } = self;
        if corners.iter().all(|&corner| corner == corners[0]) {
            return corners[0];
        }
        let [a, b, c, d] = [0, 2, 4, 6].map(|c| blend(corners[c], corners[c + 1], part[0]));
        blend(blend(a, b, part[1]), blend(c, d, part[1]), part[2])
    }

    fn slope(&self) -> DVec3 {
        let [x, y, z] = self.part;
        let v = &self.corners;
        // Over the face across an axis, of what lies along the axis.
        let along = |step: usize, [a, b]: [usize; 2], s: f64, t: f64| {
            let rise = |c: usize| v[c + step] - v[c];
            blend(blend(rise(0), rise(a), s), blend(rise(b), rise(a + b), s), t)
        };
        DVec3::new(along(1, [2, 4], y, z), along(2, [1, 4], x, z), along(4, [1, 2], x, y))
    }
}

/// Exact where both are the same, so that the zones join bit by bit.
#[inline]
fn blend(a: f64, b: f64, part: f64) -> f64 {
    a + part * (b - a)
}
