//! The angle of a box in the plane, and waves of that angle, as tight as they can be.
//!
//! Seen from the origin, a box that does not hold it fills a sector between two of its corners.
//! [`Sector`] finds those corners with comparisons alone, so the range of the angle over the box is
//! exact: azimuths come from the box (x, y), colatitudes from the box (ρ, z), on which ρ and z are
//! independent. The natural extension of acos(z/r) keeps 1.6 times as many voxels.
//!
//! [`harmonic`] goes from the sector to sin nθ and cos nθ without any angle: a corner's direction
//! is a unit complex number, its n-th power has the sine and cosine as its parts, and a count of
//! full turns kept along with the powers tells whether a crest or a trough lies between the two
//! corners. Only +, −, ×, ÷ and square root are used.
//!
//! Error of a harmonic: normalising gives a direction within 3.4 u, or 5.2 u where squares lose
//! bits to underflow just within what is let pass, and a complex product adds √5 u (Brent,
//! Percival, Zimmermann, "Error bounds on complex floating-point multiplication", 2007), so the
//! n-th power is within 5.2 n u + 2.3 n u < 8 n u; the bound used is (8 n + 16) u.

use super::{
    elementary::{self, ATAN2_ERROR},
    interval::Interval,
    lanes::{Lanes, Scalar},
    number::{NotesOf, Wave},
};

/// The sector that a box fills as seen from the origin, counter-clockwise from `from` to `to`.
struct Sector<L: Lanes> {
    /// The corner (x, y) at the clockwise end.
    from: (L, L),
    /// The corner (x, y) at the counter-clockwise end.
    to: (L, L),
    /// The origin lies inside the box: every angle occurs.
    full: L::Mask,
}

impl<L: Lanes> Sector<L> {
    #[inline(always)]
    fn of(y: Interval<L>, x: Interval<L>) -> Self {
        let zero = x.lo.same(0.0);
        let (above, below) = (zero.lt(y.hi), y.lo.lt(zero));
        let full = x.lo.lt(zero) & zero.lt(x.hi) & below & above;
        let right = zero.le(x.lo);
        let left = x.hi.le(zero);
        let top = zero.le(y.lo);
        // Each case in turn; the last one is the box below the origin.
        let from_x = L::pick(top, x.hi, x.lo);
        let from_x = L::pick(left, L::pick(above, x.hi, x.lo), from_x);
        let from_x = L::pick(right, L::pick(below, x.lo, x.hi), from_x);
        let from_y = L::pick(right | (top & !left), y.lo, y.hi);
        let to_x = L::pick(top, x.lo, x.hi);
        let to_x = L::pick(left, L::pick(below, x.hi, x.lo), to_x);
        let to_x = L::pick(right, L::pick(above, x.lo, x.hi), to_x);
        let to_y = L::pick(right | !(left | top), y.hi, y.lo);
        Self { from: (from_x, from_y), to: (to_x, to_y), full }
    }

    /// The lanes in which the sector crosses the cut along the negative x axis, so that `to` lies
    /// one turn further than its own angle says.
    #[inline(always)]
    fn crosses_cut(&self) -> L::Mask {
        let zero = self.from.0.same(0.0);
        let from_upper = zero.le(self.from.1);
        let half_turn =
            self.from.1.eq(zero) & self.from.0.lt(zero) & self.to.1.eq(zero) & zero.lt(self.to.0);
        (from_upper & self.to.1.lt(zero)) | half_turn
    }
}

/// The lanes whose box holds the origin, where an angle is not defined, and those that meet the
/// origin's axis of discontinuity are noted; see [`super::Number::atan2`].
#[inline(always)]
pub(super) fn atan2<L: Lanes>(
    y: Interval<L>,
    x: Interval<L>,
    lifted: bool,
    notes: &mut NotesOf<Interval<L>>,
) -> Interval<L> {
    let sector = Sector::of(y, x);
    let zero = x.lo.same(0.0);
    let origin = y.contains_zero() & x.contains_zero();
    let only_origin = x.lo.eq(zero) & x.hi.eq(zero) & y.lo.eq(zero) & y.hi.eq(zero);
    notes.undefined = notes.undefined | only_origin;
    let pi = x.lo.same(std::f64::consts::PI);
    let slack = x.lo.same((ATAN2_ERROR + 4.0) * L::Scalar::UNIT);
    let from = elementary::atan2(sector.from.1, sector.from.0);
    let to = elementary::atan2(sector.to.1, sector.to.0);
    let cut = sector.crosses_cut();
    let bound = pi + pi * slack;
    let (whole, to) = if lifted {
        notes.discontinuous = notes.discontinuous | origin;
        (sector.full, L::pick(cut, to + (pi + pi), to))
    } else {
        let discontinuous = cut | origin;
        notes.discontinuous = notes.discontinuous | discontinuous;
        (sector.full | cut, to)
    };
    // The slack is relative to π, or to 2π past the cut: more than the error of smaller angles.
    let reach = bound * slack + zero.same(L::Scalar::TINY);
    let reach = reach + reach;
    let lo = L::pick(whole, -bound, from - reach);
    let hi = L::pick(whole, bound, to + reach);
    // NaN comes from corners at infinity or at the origin.
    let known = lo.eq(lo) & hi.eq(hi);
    let most = if lifted { bound + bound + bound } else { bound };
    Interval { lo: L::pick(known, lo, -bound), hi: L::pick(known, hi, most) }
}

/// A unit complex number with the number of whole turns of its angle: the angle is
/// 2π·turns + arg(c + i s), with arg in (−π, π].
#[derive(Clone, Copy)]
struct Rotation<L> {
    c: L,
    s: L,
    turns: L,
}

impl<L: Lanes> Rotation<L> {
    #[inline(always)]
    fn upper(self) -> L::Mask {
        self.s.same(0.0).le(self.s)
    }

    /// The sum of the angles. A turn is completed when both angles lie in the upper half plane and
    /// the product does not, or both point left; and mirrored.
    #[inline(always)]
    fn then(self, b: Self) -> Self {
        let (zero, one) = (self.c.same(0.0), self.c.same(1.0));
        let c = self.c * b.c - self.s * b.s;
        let s = self.c * b.s + self.s * b.c;
        let (up, down) = (self.upper() & b.upper(), !self.upper() & !b.upper());
        let both_left = self.c.lt(zero) & b.c.lt(zero);
        let past_top = up & (s.lt(zero) | both_left);
        let past_bottom = down & (zero.lt(s) | (s.eq(zero) & c.lt(zero)) | both_left);
        let carry = L::pick(past_top, one, L::pick(past_bottom, -one, zero));
        Self { c, s, turns: self.turns + b.turns + carry }
    }

    #[inline(always)]
    fn powi(self, n: u32) -> Self {
        let mut result = self;
        for bit in (0..n.ilog2()).rev() {
            result = result.then(result);
            if n >> bit & 1 == 1 {
                result = result.then(self);
            }
        }
        result
    }

    /// A quarter turn further: cos a = sin(a + π/2).
    #[inline(always)]
    fn quarter_on(self) -> Self {
        let (zero, one) = (self.c.same(0.0), self.c.same(1.0));
        let past_top = self.upper() & self.c.lt(zero);
        Self { c: -self.s, s: self.c, turns: self.turns + L::pick(past_top, one, zero) }
    }

    /// How many crests and troughs of the sine lie at or before this angle, up to a constant.
    /// `slack` moves the angle: positive forwards, negative backwards.
    #[inline(always)]
    fn extrema_before(self, slack: L) -> (L, L) {
        let (zero, one) = (self.c.same(0.0), self.c.same(1.0));
        let after_crest = self.upper() & self.c.le(slack);
        let after_trough = self.upper() | (-slack).le(self.c);
        (
            self.turns + L::pick(after_crest, one, zero),
            self.turns + L::pick(after_trough, one, zero),
        )
    }
}

/// The direction of a corner, and the lanes where its length is 1 as it should be: not at the
/// origin, not where the squares over- or underflow. Nor may a corner below the x axis end up on
/// it because its sine underflows: on the negative side it would be a turn away.
#[inline(always)]
fn direction<L: Lanes>((x, y): (L, L), turns: L) -> (Rotation<L>, L::Mask) {
    let length = (x * x + y * y).sqrt();
    let (c, s) = (x / length, y / length);
    let excess = (c * c + s * s - x.same(1.0)).abs();
    let zero = x.same(0.0);
    let raised = y.lt(zero) & zero.le(s);
    (Rotation { c, s, turns }, excess.le(x.same(8.0 * L::Scalar::UNIT)) & !raised)
}

/// sin nθ or cos nθ over the box; see [`super::Number::harmonic`].
#[inline(always)]
pub(super) fn harmonic<L: Lanes>(
    y: Interval<L>,
    x: Interval<L>,
    wave: Wave,
    n: u32,
    notes: &mut NotesOf<Interval<L>>,
) -> Interval<L> {
    let (zero, one) = (x.lo.same(0.0), x.lo.same(1.0));
    let sector = Sector::of(y, x);
    notes.discontinuous = notes.discontinuous | (y.contains_zero() & x.contains_zero());
    let turns = L::pick(sector.crosses_cut(), one, zero);
    let (from, from_is_unit) = direction(sector.from, zero);
    let (to, to_is_unit) = direction(sector.to, turns);
    let known = from_is_unit & to_is_unit & !sector.full;
    let (from, to) = (from.powi(n), to.powi(n));
    let (from, to) = match wave {
        Wave::Sin => (from, to),
        Wave::Cos => (from.quarter_on(), to.quarter_on()),
    };
    let error = one.same((8.0 * f64::from(n) + 16.0) * L::Scalar::UNIT);
    let (crests_before, troughs_before) = from.extrema_before(-error);
    let (crests, troughs) = to.extrema_before(error);
    let (crest, trough) = (crests_before.lt(crests), troughs_before.lt(troughs));
    let least = (from.s.min(to.s) - error).max(-one);
    let most = (from.s.max(to.s) + error).min(one);
    Interval { lo: L::pick(known & !trough, least, -one), hi: L::pick(known & !crest, most, one) }
}
