//! What gradients prove of boxes holds at the points of the boxes.

use fearless_simd::{Simd, f32x16, f64x8};
use proptest::prelude::*;
use zeroset::{
    eval::{BATCH, BoxEvaluator, Boxes, SlopeEvaluator, SlopeVerdict},
    expr::Tape,
    math::{Interval, Lanes, Scalar, SimdLevel, SimdTask},
};

use crate::{
    formulas::{boxes, expr, formula, point_in, range_at},
    numbers::cases,
};

struct Slopes<'a> {
    tape: &'a Tape,
    narrow: &'a Boxes<f32>,
    wide: &'a Boxes<f64>,
}

impl SimdTask for Slopes<'_> {
    type Output = [SlopeVerdict; 2];

    fn run<S: Simd>(self, simd: S) -> Self::Output {
        [
            slopes::<S, f32x16<S>, { BATCH / 16 }>(simd, self.tape, self.narrow),
            slopes::<S, f64x8<S>, { BATCH / 8 }>(simd, self.tape, self.wide),
        ]
    }
}

fn slopes<S: Simd, L: Lanes<Token = S>, const G: usize>(
    simd: S,
    tape: &Tape,
    boxes: &Boxes<L::Scalar>,
) -> SlopeVerdict {
    let mut values = BoxEvaluator::<L, G>::new(simd);
    SlopeEvaluator::<L, G>::new(simd).eval(&mut values, tape, boxes, boxes, BATCH)
}

/// Stores the same boxes in both types.
fn store<T: Scalar>(boxes: &mut Boxes<T>, bounds: &[[[f32; 2]; 3]]) {
    for (lane, bounds) in bounds.iter().enumerate() {
        for axis in 0..3 {
            let [lo, hi] = bounds[axis].map(|v| T::nearest(f64::from(v)));
            (boxes.lo[axis][lane], boxes.hi[axis][lane]) = (lo, hi);
        }
    }
}

proptest! {
    #![proptest_config(cases(3_000))]

    #[test]
    fn what_slopes_prove_holds_at_every_point(
        text in formula(),
        bounds in prop::collection::vec(boxes(), BATCH),
        points in prop::collection::vec([0.0..=1.0_f64, 0.0..=1.0_f64, 0.0..=1.0_f64], 6),
    ) {
        let tape = expr(&text).tape();
        let (mut narrow, mut wide) = (Boxes::<f32>::default(), Boxes::<f64>::default());
        store(&mut narrow, &bounds);
        store(&mut wide, &bounds);
        let verdicts = SimdLevel::detect().run(Slopes { tape: &tape, narrow: &narrow, wide: &wide });
        for (lane, bounds) in bounds.iter().enumerate() {
            let ranges: Vec<Option<Interval<f64>>> =
                points.iter().map(|&at| range_at(&tape, point_in(*bounds, at))).collect();
            for verdict in &verdicts {
                let is = |lanes: u64| lanes >> lane & 1 == 1;
                for range in ranges.iter().flatten() {
                    prop_assert!(!is(verdict.verdict.empty) || range.hi >= 0.0, "{bounds:?}");
                    prop_assert!(!is(verdict.verdict.negative) || range.lo <= 0.0, "{bounds:?}");
                }
                let signs = is(verdict.crossed) && is(verdict.verdict.empty | verdict.verdict.negative);
                prop_assert!(!signs, "both signs, and one alone: {bounds:?}");
                for axis in 0..3 {
                    for &at in &points {
                        // From a point to one further along the axis.
                        let mut on = at;
                        on[axis] += 0.5 * (1.0 - at[axis]);
                        let ends = [at, on].map(|at| range_at(&tape, point_in(*bounds, at)));
                        let [Some(from), Some(to)] = ends else { continue };
                        prop_assert!(!is(verdict.rising[axis]) || from.lo <= to.hi, "{bounds:?}");
                        prop_assert!(!is(verdict.falling[axis]) || to.lo <= from.hi, "{bounds:?}");
                    }
                }
            }
        }
    }
}
