//! The box that holds a surface, where the user gives none.
//!
//! The search starts with a cube of 2^21 units and coarse voxels. What survives lies in a smaller
//! box, which is searched with coarse voxels of its own, until boxes shrink no more. Nothing that
//! meets the surface is ever dropped, so the last box holds all of it that lies in the cube.

use std::sync::Arc;

use fearless_simd::{Simd, f64x8};
use glam::DVec3;

use super::{
    corners::Corners,
    search::{Run, Search},
};
use crate::{
    eval::BATCH,
    expr::{Expr, Tape},
    math::{Aabb, Lattice, SimdLevel, SimdTask},
};

/// Where a surface lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// Nowhere within [`Extent::REACH`] of the origin.
    Nothing,
    /// All of it that is within [`Extent::REACH`] lies in this box.
    Within(Aabb),
    /// No bound was found: it may reach [`Extent::REACH`].
    Unbounded,
}

impl Extent {
    /// Half the edge of the cube in which a surface is looked for: 2^20 units.
    pub const REACH: f64 = 1_048_576.0;

    /// What holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        match (self, other) {
            (Self::Unbounded, _) | (_, Self::Unbounded) => Self::Unbounded,
            (Self::Nothing, extent) | (extent, Self::Nothing) => extent,
            (Self::Within(a), Self::Within(b)) => {
                Self::Within(Aabb { min: a.min.min(b.min), max: a.max.max(b.max) })
            }
        }
    }
}

/// Voxels along the longest axis of a box in which it is searched.
const COARSE: u32 = 32;
/// The same for the last box.
const FINE: u32 = 64;
/// Boxes that are tried at most; each but the last ones shrinks to half or less.
const MAX_BOXES: u32 = 100;

/// Finds the box that holds the surface of `expr`. Its corners are rounded outwards to few decimal
/// digits.
#[must_use]
pub fn find_extent(expr: &Expr, simd: SimdLevel) -> Extent {
    simd.run(Task { tape: expr.tape() })
}

struct Task {
    tape: Tape,
}

impl SimdTask for Task {
    type Output = Extent;

    fn run<S: Simd>(self, simd: S) -> Extent {
        let tape = Arc::new(self.tape);
        let reach = DVec3::splat(Extent::REACH);
        let cube = Aabb { min: -reach, max: reach };
        let mut bounds = cube;
        for _ in 0..MAX_BOXES {
            let Some(smaller) = survivors(simd, &tape, bounds, COARSE) else {
                return Extent::Nothing;
            };
            let is_settled = smaller.size().max_element() > 0.5 * bounds.size().max_element();
            bounds = smaller;
            if is_settled {
                break;
            }
        }
        if (bounds.min.cmple(cube.min) | bounds.max.cmpge(cube.max)).any() {
            return Extent::Unbounded;
        }
        survivors(simd, &tape, bounds, FINE).map_or(Extent::Nothing, |b| Extent::Within(rounded(b)))
    }
}

/// The box of the voxels in `bounds` that the surface may meet.
fn survivors<S: Simd>(simd: S, tape: &Arc<Tape>, bounds: Aabb, resolution: u32) -> Option<Aabb> {
    let lattice = Arc::new(Lattice::new(bounds, resolution));
    let corners = Arc::new(Corners::new(&lattice));
    let search = Search::<S, f64x8<S>, { BATCH / 8 }>::new;
    let mut search = search(simd, lattice.clone(), corners, false);
    let voxels = search.descend(Run::root(tape.clone()), lattice.depth());
    let mut found: Option<([u32; 3], [u32; 3])> = None;
    for ijk in voxels.iter().flat_map(Run::places) {
        let (least, most) = found.get_or_insert((ijk, ijk));
        for axis in 0..3 {
            least[axis] = least[axis].min(ijk[axis]);
            most[axis] = most[axis].max(ijk[axis]);
        }
    }
    let (least, most) = found?;
    let corner = |ijk: [u32; 3]| DVec3::from_array([0, 1, 2].map(|a| lattice.corner(a, ijk[a])));
    Some(Aabb { min: corner(least), max: corner(most.map(|i| i + 1)) })
}

/// Rounds outwards to a step between a hundredth and a fortieth of the longest edge, so that the
/// numbers are short enough to be written into a scene.
fn rounded(bounds: Aabb) -> Aabb {
    let longest = bounds.size().max_element();
    let mut power = 1e-9;
    while power * 40.0 < longest {
        power *= 10.0;
    }
    let steps = [0.1, 0.2, 0.5, 1.0].map(|part| part * power);
    let step = steps.into_iter().find(|step| step * 100.0 >= longest).unwrap_or(power);
    // Dividing by a whole number gives the nearest number to the decimal one.
    let per_unit = (1.0 / step).round();
    let decimal = |v: DVec3| if step < 1.0 { v.round() / per_unit } else { v.round() * step };
    Aabb {
        min: decimal((bounds.min / step - 1e-6).floor()),
        max: decimal((bounds.max / step + 1e-6).ceil()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr;

    fn extent(formula: &str) -> Extent {
        let expr = Expr::resolve(&expr::parse(formula).unwrap(), &[]).unwrap().expr;
        find_extent(&expr, SimdLevel::detect())
    }

    fn bounds(formula: &str) -> [[f64; 3]; 2] {
        let Extent::Within(b) = extent(formula) else { panic!("{formula} is bounded") };
        [b.min.to_array(), b.max.to_array()]
    }

    #[test]
    fn boxes_hold_the_surface_and_little_more() {
        let [min, max] = bounds("x^2 + y^2/4 + (z-10)^2 = 1");
        for (found, exact) in min.into_iter().zip([-1.0, -2.0, 9.0]) {
            assert!(found <= exact && exact < found + 0.25, "{found} for {exact}");
        }
        for (found, exact) in max.into_iter().zip([1.0, 2.0, 11.0]) {
            assert!(exact <= found && found < exact + 0.25, "{found} for {exact}");
        }
    }

    #[test]
    fn small_and_large_surfaces_are_found() {
        let [min, max] = bounds("x^2 + y^2 + z^2 = 1e-6");
        assert!(min[0] <= -0.001 && max[0] >= 0.001 && max[0] < 0.0012, "{max:?}");
        let [_, max] = bounds("x^2 + y^2 + z^2 = 1e10");
        assert!(max[1] >= 1e5 && max[1] < 1.1e5, "{max:?}");
    }

    #[test]
    fn what_has_no_bound_is_told_so() {
        assert_eq!(extent("x + y + z"), Extent::Unbounded);
        assert_eq!(extent("sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)"), Extent::Unbounded);
        assert_eq!(extent("x^2 + 1"), Extent::Nothing);
    }
}
