//! Roots of F along rays, each between two depths at which F has different signs.
//!
//! Secants, as long as they lead into the bracket; now and then its middle, which always helps.
//!
//! *Based on:* J. Traub, "Iterative Methods for the Solution of Equations", 1964, section 3 (the
//! secant's error is about the product of the last two).

use fearless_simd::{Simd, f64x8};
use glam::DVec3;

use super::{screen::Ray, trace::Tracer, walk::Span};
use crate::{
    eval::{POINT_BATCH, Points},
    expr::Tape,
    math::{Lanes, Mask},
};

/// A root between two depths.
#[derive(Clone, Copy)]
pub(super) struct Bracket {
    /// Whose it is.
    pub(super) id: usize,
    pub(super) ray: Ray,
    pub(super) span: Span,
    /// F at both ends: only the signs must be right, what they are worth is where to look first.
    pub(super) values: [f64; 2],
    /// Whether the tape's region is known to hold it.
    pub(super) in_region: bool,
}

/// A secant whose step is shorter than this part of the bracket leads to the root: the next step
/// would be shorter by as much again.
const PRECISION: f64 = 1e-6;

/// Steps that are enough for any bracket, by middles alone.
const MAX_STEPS: usize = 200;

/// Every so many steps the middle is taken.
const MIDDLE: usize = 4;

/// Brackets in one vector.
const LANES: usize = 8;

/// One number for each bracket.
type Row = [f64; POINT_BATCH];

/// Brackets that are narrowed together.
struct Chase {
    origin: [Row; 3],
    direction: [Row; 3],
    from: Row,
    to: Row,
    /// F < 0 at `from`, if this is.
    first: Row,
    precision: Row,
    /// Where the root is looked for, and where it was before, with F there.
    at: Row,
    before: Row,
    value_before: Row,
    /// The brackets that are done, as bits.
    done: u64,
}

impl Chase {
    fn new(brackets: &[Bracket], eye: DVec3) -> Self {
        let none = [0.0; POINT_BATCH];
        let mut chase = Self {
            origin: [none; 3],
            direction: [none; 3],
            from: none,
            to: none,
            first: none,
            precision: none,
            at: none,
            before: none,
            value_before: none,
            done: u64::MAX << brackets.len(),
        };
        for (k, bracket) in brackets.iter().enumerate() {
            let Bracket { ray, span: Span { from, to }, values: [f, g], .. } = *bracket;
            let origin = eye + ray.origin;
            for axis in 0..3 {
                chase.origin[axis][k] = origin[axis];
                chase.direction[axis][k] = ray.direction[axis];
            }
            (chase.from[k], chase.to[k], chase.first[k]) = (from, to, f);
            chase.precision[k] = PRECISION * (to - from);
            let at = from + (to - from) * (f / (f - g));
            let at = if at >= from && at <= to { at } else { 0.5 * (from + to) };
            chase.at[k] = at;
            // The first secant goes through the end that is farther away.
            let is_late = at - from > to - at;
            (chase.before[k], chase.value_before[k]) = if is_late { (from, f) } else { (to, g) };
        }
        chase
    }

    /// Where roots are looked for.
    #[inline(always)]
    fn points<S: Simd>(&self, simd: S, points: &mut Points) {
        for first in (0..POINT_BATCH).step_by(LANES) {
            let at = f64x8::load(simd, &self.at[first..]);
            for axis in 0..3 {
                let origin = f64x8::load(simd, &self.origin[axis][first..]);
                let direction = f64x8::load(simd, &self.direction[axis][first..]);
                (origin + at * direction).store(&mut points[axis][first..]);
            }
        }
    }

    /// Goes on from `values` of F where roots were looked for.
    #[inline(always)]
    fn narrow<S: Simd>(&mut self, simd: S, values: &Row, step: usize) {
        for first in (0..POINT_BATCH).step_by(LANES) {
            let load = |row: &Row| f64x8::load(simd, &row[first..]);
            let (value, at) = (load(values), load(&self.at));
            let (mut from, mut to) = (load(&self.from), load(&self.to));
            let (before, value_before) = (load(&self.before), load(&self.value_before));
            let (sign, precision) = (load(&self.first), load(&self.precision));
            let zero = value.same(0.0);
            let (negative, first_negative) = (value.lt(zero), sign.lt(zero));
            let is_first = (negative & first_negative) | !(negative | first_negative);
            from = f64x8::pick(is_first, at, from);
            to = f64x8::pick(is_first, to, at);
            let slope = (value - value_before) / (at - before);
            let secant = at - value / slope;
            let is_near = (secant - at).abs().le(precision);
            // Not finite, or all that there is to find.
            let is_end = !value.abs().le(zero.same(f64::MAX))
                | value.eq(zero)
                | (to - from).le(precision * zero.same(PRECISION));
            let is_in = from.lt(secant) & secant.lt(to);
            let middle = (from + to) * zero.same(0.5);
            let next = if step % MIDDLE == MIDDLE - 1 {
                middle
            } else {
                f64x8::pick(is_in, secant, middle)
            };
            let root = f64x8::pick(is_near, secant.max(from).min(to), at);
            let next = f64x8::pick(is_near | is_end, root, next);
            let mut places = [0.0; LANES];
            next.store(&mut places);
            let done = (is_near | is_end).bits();
            for lane in 0..LANES {
                if self.done >> (first + lane) & 1 == 0 {
                    self.at[first + lane] = places[lane];
                }
            }
            self.done |= done << first;
            from.store(&mut self.from[first..]);
            to.store(&mut self.to[first..]);
            at.store(&mut self.before[first..]);
            value.store(&mut self.value_before[first..]);
        }
    }
}

impl<S: Simd> Tracer<S> {
    /// Finds the roots of brackets, and tells of each that lies in the tape's region whose it is and
    /// where.
    pub(super) fn find_roots(
        &mut self,
        tape: &Tape,
        eye: DVec3,
        brackets: &[Bracket],
        tell: &mut dyn FnMut(usize, f64),
    ) {
        let simd = self.simd;
        let mut points: Points = [[0.0; POINT_BATCH]; 3];
        for some in brackets.chunks(POINT_BATCH) {
            let mut chase = Chase::new(some, eye);
            for step in 0..MAX_STEPS {
                simd.vectorize(
                    #[inline(always)]
                    || chase.points(simd, &mut points),
                );
                let values = self.points.eval(tape, &points);
                simd.vectorize(
                    #[inline(always)]
                    || chase.narrow(simd, &values, step),
                );
                if chase.done == u64::MAX {
                    break;
                }
            }
            let mut in_region = u64::MAX;
            if some.iter().any(|bracket| !bracket.in_region) {
                simd.vectorize(
                    #[inline(always)]
                    || chase.points(simd, &mut points),
                );
                self.points.eval(tape, &points);
                in_region = self.points.in_region();
            }
            for (k, bracket) in some.iter().enumerate() {
                if bracket.in_region || in_region >> k & 1 == 1 {
                    tell(bracket.id, chase.at[k]);
                }
            }
        }
    }
}
