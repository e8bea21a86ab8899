//! The mean value form: what a gradient tells of the values on a box.
//!
//! Along an axis on which F rises everywhere in the box, F is least at the lower end and largest at
//! the upper one, so the axis can be left out: only its ends matter. Along the other axes F departs
//! from its value in the middle by at most the slope times half the width. Hence
//!
//! F(low) − spread <= F <= F(high) + spread
//!
//! with `low` and `high` in the middle of the axes that are left, and at the proper ends of the
//! others. If F is monotone along all three axes its range is exactly from F(low) to F(high).
//!
//! The proof needs no derivative: interval arithmetic on [`super::Dual`]s encloses the quotients of
//! differences, (F(p) − F(q)) / (p − q) along each axis, of every operation, because each is
//! continuous wherever nothing discontinuous was noted of its *value*.
//!
//! *Based on:* R. Moore, "Interval Analysis", 1966, sections 6.3 and 6.5 (mean value form,
//! monotonicity); E. Hansen, G. Walster, "Global Optimization Using Interval Analysis", 2004,
//! section 7 (reduction by monotonicity).

use super::{
    interval::{Interval, round_up},
    lanes::Lanes,
};

/// Bounds of F on a box in terms of its values at two points; see the file's text.
pub struct MeanValue<L: Lanes> {
    /// Around where F is least, but for the spread.
    pub low: [Interval<L>; 3],
    /// Around where F is largest, but for the spread.
    pub high: [Interval<L>; 3],
    /// How far F may leave the values at those points; +∞ if nothing is known.
    pub spread: L,
}

impl<L: Lanes> MeanValue<L> {
    /// The form over a box on which the gradient lies in `gradient`. The bounds of the box lie
    /// between those of `outer` and of `inner`; `low` and `high` are intervals that hold points
    /// of the box.
    #[inline(always)]
    pub fn new(
        outer: &[Interval<L>; 3],
        inner: &[Interval<L>; 3],
        gradient: &[Interval<L>; 3],
    ) -> Self {
        let zero = outer[0].lo.same(0.0);
        let mut form = Self { low: *outer, high: *outer, spread: zero };
        for axis in 0..3 {
            let (x, slope) = (outer[axis], gradient[axis]);
            let (rising, falling) = (zero.le(slope.lo), slope.hi.le(zero));
            let middle = (x.lo + (x.hi - x.lo) * x.lo.same(0.5)).max(x.lo).min(x.hi);
            let half = round_up((x.hi - middle).max(middle - x.lo));
            let departure = round_up(slope.magnitudes().1 * half);
            let departure = L::pick(rising | falling, zero, departure);
            form.spread = round_up(form.spread + departure);
            let first = Interval { lo: x.lo, hi: inner[axis].lo };
            let last = Interval { lo: inner[axis].hi, hi: x.hi };
            let middle = Interval::point(middle);
            form.low[axis] = pick(rising, first, pick(falling, last, middle));
            form.high[axis] = pick(rising, last, pick(falling, first, middle));
        }
        form
    }
}

#[inline(always)]
fn pick<L: Lanes>(mask: L::Mask, yes: Interval<L>, no: Interval<L>) -> Interval<L> {
    Interval { lo: L::pick(mask, yes.lo, no.lo), hi: L::pick(mask, yes.hi, no.hi) }
}
