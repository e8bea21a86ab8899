//! Where F is 0 on segments, 16 segments side by side: one that is done makes room for the next.
//!
//! *Based on:* T. Chandrupatla, "A new hybrid quadratic/bisection algorithm for finding the zero of a
//! nonlinear function without using derivatives", Advances in Engineering Software 1997.

use fearless_simd::{Simd, f64x8};
use glam::DVec3;

use super::{POINT_BATCH, PointEvaluator, Points};
use crate::{
    expr::Tape,
    math::{Lanes, Mask as _},
};

/// Steps that are enough for any bracket, by bisection alone.
const MAX_STEPS: u32 = 50;

/// A line between two points at which F has different signs.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// The points.
    pub ends: [DVec3; 2],
    /// F there; 0 counts as negative.
    pub values: [f64; 2],
    /// Where to look first, as a part of the segment.
    pub part: f64,
}

/// One number for each lane.
type Row = [f64; POINT_BATCH];

/// The segments that are searched, a lane each.
#[derive(Default)]
pub(super) struct RootFinder {
    /// The number of the segment.
    numbers: [usize; POINT_BATCH],
    steps: [u32; POINT_BATCH],
    from: Points,
    along: Points,
    /// Parts of the segment between which F changes sign, the newer one first, and F there.
    parts: [Row; 2],
    values: [Row; 2],
    /// Where to look next.
    part: Row,
}

impl RootFinder {
    /// Parts of segments at which F is 0, each found to `precision`; where F has no value, the part that
    /// was looked at last.
    pub(super) fn find<S: Simd>(
        &mut self,
        simd: S,
        evaluator: &mut PointEvaluator<S>,
        tape: &Tape,
        segments: &[Segment],
        precision: f64,
    ) -> Vec<f64> {
        let mut found = vec![0.0; segments.len()];
        let mut rest = segments.iter().enumerate();
        let mut idle = (1_u64 << POINT_BATCH) - 1;
        let mut open = 0;
        loop {
            while idle != 0
                && let Some((number, segment)) = rest.next()
            {
                let lane = idle.trailing_zeros() as usize;
                self.enter(lane, number, segment);
                idle &= idle - 1;
                open |= 1 << lane;
            }
            if open == 0 {
                return found;
            }
            let values = evaluator.eval(tape, &self.points(simd));
            let mut done = self.step(simd, &values, precision) & open;
            (idle, open) = (idle | done, open & !done);
            while done != 0 {
                let lane = done.trailing_zeros() as usize;
                found[self.numbers[lane]] = self.part[lane];
                done &= done - 1;
            }
        }
    }

    fn enter(&mut self, lane: usize, number: usize, segment: &Segment) {
        let Segment { ends: [a, b], values: [f, g], part } = *segment;
        let along = b - a;
        self.numbers[lane] = number;
        self.steps[lane] = 0;
        for axis in 0..3 {
            self.from[axis][lane] = a[axis];
            self.along[axis][lane] = along[axis];
        }
        for (i, (end, value)) in [(0.0, f), (1.0, g)].into_iter().enumerate() {
            self.parts[i][lane] = end;
            self.values[i][lane] = value;
        }
        self.part[lane] = part;
    }

    /// Where to look next.
    fn points<S: Simd>(&self, simd: S) -> Points {
        let mut points = [[0.0; POINT_BATCH]; 3];
        simd.vectorize(
            #[inline(always)]
            || {
                for k in (0..POINT_BATCH).step_by(8) {
                    let part = f64x8::load(simd, &self.part[k..]);
                    for axis in 0..3 {
                        let from = f64x8::load(simd, &self.from[axis][k..]);
                        let along = f64x8::load(simd, &self.along[axis][k..]);
                        (from + part * along).store(&mut points[axis][k..]);
                    }
                }
            },
        );
        points
    }

    /// Takes note of F at the points, and tells which lanes are done, as bits; the others know where
    /// to look next.
    fn step<S: Simd>(&mut self, simd: S, values: &Row, precision: f64) -> u64 {
        let mut done = 0;
        for (lane, steps) in self.steps.iter_mut().enumerate() {
            *steps += 1;
            done |= u64::from(*steps >= MAX_STEPS) << lane;
        }
        simd.vectorize(
            #[inline(always)]
            || {
                for k in (0..POINT_BATCH).step_by(8) {
                    done |= self.step_vector(simd, values, precision, k) << k;
                }
            },
        );
        done
    }

    /// The same for the lanes from `k` on.
    #[inline(always)]
    fn step_vector<S: Simd>(&mut self, simd: S, values: &Row, precision: f64, k: usize) -> u64 {
        let value = f64x8::load(simd, &values[k..]);
        let (a, f) =
            (f64x8::load(simd, &self.parts[0][k..]), f64x8::load(simd, &self.values[0][k..]));
        let (b, g) =
            (f64x8::load(simd, &self.parts[1][k..]), f64x8::load(simd, &self.values[1][k..]));
        let part = f64x8::load(simd, &self.part[k..]);
        let zero = value.same(0.0);
        let is_last = value.eq(zero) | !value.abs().le(value.same(f64::MAX));

        let (is_inside, was_inside) = (value.le(zero), f.le(zero));
        let is_like_first = (is_inside & was_inside) | (!is_inside & !was_inside);
        let (c, h) = (f64x8::pick(is_like_first, a, b), f64x8::pick(is_like_first, f, g));
        let (b, g) = (f64x8::pick(is_like_first, b, a), f64x8::pick(is_like_first, g, f));
        let (a, f) = (part, value);

        // The parabola through these and the one that is given up, c: part as a function of F, where it has no turn between them.
        let (x, y, z) = (b - a, c - a, c - b);
        let (p, q, r) = (g - f, h - f, h - g);
        let (xi, phi) = (-x / z, -p / r);
        let one = value.same(1.0);
        let is_smooth = (phi * phi).lt(xi) & ((one - phi) * (one - phi)).lt(one - xi);
        let step = f64x8::pick(is_smooth, f / r * (y * g / (x * q) - h / p), value.same(0.5));
        let next = a + step * x;
        let is_near = (next - a).abs().le(value.same(precision));

        a.store(&mut self.parts[0][k..]);
        b.store(&mut self.parts[1][k..]);
        f.store(&mut self.values[0][k..]);
        g.store(&mut self.values[1][k..]);
        f64x8::pick(is_last, part, next).store(&mut self.part[k..]);
        (is_last | is_near).bits()
    }
}
