//! Intervals with outward rounding: the result of every operation contains every real result.
//!
//! Invariants of an interval: `lo <= hi`, `lo` is finite or −∞, `hi` is finite or +∞, no bound is
//! NaN. Operations keep them without a test for special cases where they can.
//!
//! Rounding is always to nearest; a bound c that went through one rounding is moved outwards by
//! φ|c| + η with φ a little above the unit roundoff and η the smallest positive number, which is
//! at least the rounding error, underflow included. Sums, which do not underflow, are moved by 2u|c|,
//! so that 0 stays 0. Negation, absolute value, minimum and maximum are exact and move nothing.
//!
//! *Based on:* S. Rump, P. Zimmermann, S. Boldo, G. Melquiond, "Computing predecessor and
//! successor in rounding to nearest", BIT 2009, section 3; IEEE 1788-2015 for what an operation
//! means at poles and outside its domain.

use super::{
    angle,
    elementary::{
        self, ACOS_ERROR, ATAN2_ERROR, CBRT_ERROR, EXP_ERROR, HYPERBOLIC_ERROR, LN_ERROR,
        TRIG_ERROR,
    },
    lanes::{Lanes, Scalar},
    number::{Constant, Hyperbolic, MaskOf, Notes, NotesOf, Number, Step, Token, Wave},
    point::{smooth_step, step_function, triangle_wave},
};

/// All reals between two bounds, in every lane.
#[derive(Clone, Copy, Debug)]
pub struct Interval<L> {
    /// The lower bound.
    pub lo: L,
    /// The upper bound.
    pub hi: L,
}

/// How far a bound moves: `units` unit roundoffs of its size, and as many smallest numbers.
#[inline(always)]
fn margin<L: Lanes>(c: L, units: f64) -> L {
    // (1 + 4u) covers the second-order terms and the rounding of this expression.
    let phi = units * L::Scalar::UNIT * (1.0 + 4.0 * L::Scalar::UNIT);
    c.abs() * c.same(phi) + c.same(units * L::Scalar::TINY)
}

/// A lower bound of a value whose computed form is c. One correctly rounded operation needs one
/// unit; a computed value with a larger error needs that error in units of u and one unit more,
/// because this difference is rounded itself.
#[inline(always)]
fn lower_by<L: Lanes>(c: L, units: f64) -> L {
    // A computed +∞ is an overflow: the value is above the largest number.
    let c = c.min(c.same(L::Scalar::MAX));
    c - margin(c, units)
}

/// An upper bound of a value whose computed form is c; see [`lower_by`].
#[inline(always)]
fn upper_by<L: Lanes>(c: L, units: f64) -> L {
    let c = c.max(c.same(-L::Scalar::MAX));
    c + margin(c, units)
}

#[inline(always)]
fn lower<L: Lanes>(c: L) -> L {
    lower_by(c, 1.0)
}

#[inline(always)]
fn upper<L: Lanes>(c: L) -> L {
    upper_by(c, 1.0)
}

/// How far the bound of a sum moves. Sums do not underflow: one below 2/u smallest numbers is exact,
/// so 0 stays 0, and a sum of squares does not fall below it. Above, twice the unit roundoff is more
/// than half the distance to the next number, even where this product is itself rounded to a
/// whole number of smallest numbers.
#[inline(always)]
fn sum_margin<L: Lanes>(c: L) -> L {
    c.abs() * c.same(2.0 * L::Scalar::UNIT)
}

/// A lower bound of a sum whose computed form is c.
#[inline(always)]
fn lower_sum<L: Lanes>(c: L) -> L {
    let c = c.min(c.same(L::Scalar::MAX));
    c - sum_margin(c)
}

/// An upper bound of a sum whose computed form is c.
#[inline(always)]
fn upper_sum<L: Lanes>(c: L) -> L {
    let c = c.max(c.same(-L::Scalar::MAX));
    c + sum_margin(c)
}

/// A bound not below what c is the rounded form of.
#[inline(always)]
pub(super) fn round_up<L: Lanes>(c: L) -> L {
    upper(c)
}

impl<L: Lanes> Interval<L> {
    /// The interval of one number.
    #[inline(always)]
    pub fn point(v: L) -> Self {
        Self { lo: v, hi: v }
    }

    /// All real numbers.
    #[inline(always)]
    pub fn entire(like: L) -> Self {
        Self { lo: like.same(f64::NEG_INFINITY), hi: like.same(f64::INFINITY) }
    }

    #[inline(always)]
    fn zero(self) -> L {
        self.lo.same(0.0)
    }

    /// The lanes whose interval holds zero.
    #[inline(always)]
    pub fn contains_zero(self) -> L::Mask {
        self.lo.le(self.zero()) & self.zero().le(self.hi)
    }

    /// The smallest and the largest absolute value.
    #[inline(always)]
    pub fn magnitudes(self) -> (L, L) {
        let (a, b) = (self.lo.abs(), self.hi.abs());
        (L::pick(self.contains_zero(), self.zero(), a.min(b)), a.max(b))
    }

    #[inline(always)]
    fn clamped(self, lo: f64, hi: f64) -> Self {
        let (least, most) = (self.lo.same(lo), self.lo.same(hi));
        Self { lo: self.lo.max(least).min(most), hi: self.hi.min(most).max(least) }
    }

    /// Notes what is outside the domain of arcsin and arccos.
    #[inline(always)]
    fn note_beyond_one(self, notes: &mut NotesOf<Self>) {
        let one = self.lo.same(1.0);
        let partial = self.lo.lt(-one) | one.lt(self.hi);
        notes.discontinuous = notes.discontinuous | partial;
        notes.partial = notes.partial | partial;
        notes.undefined = notes.undefined | self.hi.lt(-one) | one.lt(self.lo);
    }

    #[inline(always)]
    fn hull(self, b: Self) -> Self {
        Self { lo: self.lo.min(b.lo), hi: self.hi.max(b.hi) }
    }
}

/// The tangent of the numbers in `x`, which are within the limit.
#[inline(always)]
fn tan_at<L: Lanes>(x: L) -> Interval<L> {
    let error = x.same((TRIG_ERROR + 1.0) * L::Scalar::UNIT);
    let (s, c) = (elementary::sin(x), elementary::cos(x));
    let (s, c) =
        (Interval { lo: s - error, hi: s + error }, Interval { lo: c - error, hi: c + error });
    s.mul(c.recip(&mut Notes::clear::<L>(x.token())))
}

/// Whether a whole number plus `phase` lies between two numbers.
#[inline(always)]
fn holds_phase<L: Lanes>(from: L, to: L, phase: f64) -> L::Mask {
    let phase = from.same(phase);
    (from - phase).le((to - phase).floor())
}

impl<L: Lanes> Number for Interval<L> {
    type Lanes = L;

    #[inline(always)]
    fn constant(token: Token<Self>, c: &Constant) -> Self {
        Self {
            lo: L::splat(token, L::Scalar::below(c.lo)),
            hi: L::splat(token, L::Scalar::above(c.hi)),
        }
    }

    #[inline(always)]
    fn neg(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo }
    }

    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self { lo: lower_sum(self.lo + b.lo), hi: upper_sum(self.hi + b.hi) }
    }

    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self { lo: lower_sum(self.lo - b.hi), hi: upper_sum(self.hi - b.lo) }
    }

    /// The hull of the four products of bounds. 0·∞ is NaN and means 0; `min` and `max` step over
    /// a NaN on their left: where one product is NaN because a bound is 0, either another product
    /// of that bound is 0 as well, or the other factor is unbounded on both sides.
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        let p = [self.lo * b.lo, self.lo * b.hi, self.hi * b.lo, self.hi * b.hi];
        let last = L::pick(p[3].eq(p[3]), p[3], self.zero());
        Self {
            lo: lower(p[0].min(p[1].min(p[2].min(last)))),
            hi: upper(p[0].max(p[1].max(p[2].max(last)))),
        }
    }

    #[inline(always)]
    fn mul_constant(self, c: &Constant) -> Self {
        let factor = Self::constant(self.token(), c);
        match c.as_exact() {
            // One product a bound suffices where the factor is known to the last bit.
            Some(v) if L::Scalar::nearest(v).to_f64() == v && v != 0.0 => {
                let (a, b) = (self.lo * factor.lo, self.hi * factor.lo);
                let (a, b) = if v > 0.0 { (a, b) } else { (b, a) };
                Self { lo: lower(a), hi: upper(b) }
            }
            _ => self.mul(factor),
        }
    }

    #[inline(always)]
    fn recip(self, notes: &mut NotesOf<Self>) -> Self {
        let (zero, one) = (self.zero(), self.lo.same(1.0));
        let pole = self.contains_zero();
        notes.discontinuous = notes.discontinuous | pole;
        let only_zero = self.lo.eq(zero) & self.hi.eq(zero);
        notes.undefined = notes.undefined | only_zero;
        let unbounded_below = (pole & self.lo.lt(zero)) | only_zero;
        let unbounded_above = (pole & zero.lt(self.hi)) | only_zero;
        let entire = Self::entire(zero);
        Self {
            lo: L::pick(unbounded_below, entire.lo, lower(one / self.hi)),
            hi: L::pick(unbounded_above, entire.hi, upper(one / self.lo)),
        }
    }

    #[inline(always)]
    fn square(self) -> Self {
        let (a, b) = (self.lo * self.lo, self.hi * self.hi);
        let least = L::pick(self.contains_zero(), self.zero(), a.min(b));
        Self { lo: lower(least).max(self.zero()), hi: upper(a.max(b)) }
    }

    #[inline(always)]
    fn powi(self, n: u32) -> Self {
        // (n − 1) u is the error to first order; (n u)² covers the rest.
        let units = f64::from(n) * (1.0 + f64::from(n) * L::Scalar::UNIT);
        if n == 1 {
            self
        } else if n.is_multiple_of(2) {
            let (least, most) = self.magnitudes();
            let lo = lower_by(elementary::powi(least, n), units).max(self.zero());
            Self { lo, hi: upper_by(elementary::powi(most, n), units) }
        } else {
            let lo = lower_by(elementary::powi(self.lo, n), units);
            Self { lo, hi: upper_by(elementary::powi(self.hi, n), units) }
        }
    }

    #[inline(always)]
    fn sqrt(self, notes: &mut NotesOf<Self>) -> Self {
        let zero = self.zero();
        let below = self.lo.lt(zero);
        notes.discontinuous = notes.discontinuous | below;
        notes.partial = notes.partial | below;
        notes.undefined = notes.undefined | self.hi.lt(zero);
        Self { lo: lower(self.lo.max(zero).sqrt()).max(zero), hi: upper(self.hi.max(zero).sqrt()) }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        let (lo, hi) = self.magnitudes();
        Self { lo, hi }
    }

    #[inline(always)]
    fn min(self, b: Self) -> Self {
        Self { lo: self.lo.min(b.lo), hi: self.hi.min(b.hi) }
    }

    #[inline(always)]
    fn max(self, b: Self) -> Self {
        Self { lo: self.lo.max(b.lo), hi: self.hi.max(b.hi) }
    }

    /// The values at the bounds, and ±1 where a crest or a trough may lie between. Crests of sine
    /// lie at whole numbers of turns plus 1/4; the slack `e` covers the rounding of the number of
    /// turns, and a wrong "yes" costs next to nothing because the wave is flat there.
    #[inline(always)]
    fn wave(self, wave: Wave) -> Self {
        let limit = elementary::trig_limit::<L::Scalar>();
        let one = self.lo.same(1.0);
        let inner = self.clamped(-limit, limit);
        let far = self.lo.lt(self.lo.same(-limit)) | self.lo.same(limit).lt(self.hi);
        let (a, b) = match wave {
            Wave::Sin => (elementary::sin(inner.lo), elementary::sin(inner.hi)),
            Wave::Cos => (elementary::cos(inner.lo), elementary::cos(inner.hi)),
        };
        // One unit more for the rounding of the bounds themselves.
        let error = one.same((TRIG_ERROR + 1.0) * L::Scalar::UNIT);
        let (least, most) = (a.min(b) - error, a.max(b) + error);

        let turns = one.same(0.5 * std::f64::consts::FRAC_1_PI);
        let (from, to) = (inner.lo * turns, inner.hi * turns);
        let e = (from.abs().max(to.abs()) + one) * one.same(8.0 * L::Scalar::UNIT);
        let (crest, trough) = match wave {
            Wave::Sin => (0.25, 0.75),
            Wave::Cos => (0.0, 0.5),
        };
        let crest = holds_phase(from - e, to + e, crest);
        let trough = holds_phase(from - e, to + e, trough);
        Self {
            lo: L::pick(trough | far, -one, least.max(-one)),
            hi: L::pick(crest | far, one, most.min(one)),
        }
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let (least, most) = elementary::exp_limits::<L::Scalar>();
        let zero = self.zero();
        // Beyond the limits exp returns 0 and ∞; the safe bound there is its value at the limit.
        let lo = elementary::exp(self.lo.min(zero.same(most)));
        let hi = elementary::exp(self.hi.max(zero.same(least)));
        let units = EXP_ERROR + 2.0;
        Self { lo: lower_by(lo, units).max(zero), hi: upper_by(hi, units) }
    }

    /// At zero the logarithm counts as defined, with the limit −∞ for its value, so that powers,
    /// which are exponentials of logarithms, are 0 at zero.
    #[inline(always)]
    fn ln(self, notes: &mut NotesOf<Self>) -> Self {
        let zero = self.zero();
        notes.discontinuous = notes.discontinuous | self.lo.le(zero);
        notes.partial = notes.partial | self.lo.lt(zero);
        notes.undefined = notes.undefined | self.hi.lt(zero);
        let tiny = zero.same(L::Scalar::TINY);
        let units = LN_ERROR + 2.0;
        let lo = lower_by(elementary::ln(self.lo.max(tiny)), units);
        let hi = upper_by(elementary::ln(self.hi.max(tiny)), units);
        Self { lo: L::pick(self.lo.lt(tiny), zero.same(f64::NEG_INFINITY), lo), hi }
    }

    #[inline(always)]
    fn acos(self, notes: &mut NotesOf<Self>) -> Self {
        self.note_beyond_one(notes);
        let inner = self.clamped(-1.0, 1.0);
        let units = ACOS_ERROR + 2.0;
        Self {
            lo: lower_by(elementary::acos(inner.hi), units).max(self.zero()),
            hi: upper_by(elementary::acos(inner.lo), units),
        }
    }

    #[inline(always)]
    fn asin(self, notes: &mut NotesOf<Self>) -> Self {
        self.note_beyond_one(notes);
        let inner = self.clamped(-1.0, 1.0);
        let units = ACOS_ERROR + 2.0;
        Self {
            lo: lower_by(elementary::asin(inner.lo), units),
            hi: upper_by(elementary::asin(inner.hi), units),
        }
    }

    #[inline(always)]
    fn atan(self) -> Self {
        let units = ATAN2_ERROR + 2.0;
        // The arc tangent of ∞ is the limit, which is reached there to the last place.
        let largest = self.lo.same(L::Scalar::MAX);
        Self {
            lo: lower_by(elementary::atan(self.lo.max(-largest)), units),
            hi: upper_by(elementary::atan(self.hi.min(largest)), units),
        }
    }

    /// Between two poles the tangent rises. Its values at the bounds are quotients of enclosures
    /// of sine and cosine, because near a pole the relative error of the cosine is large.
    #[inline(always)]
    fn tan(self, notes: &mut NotesOf<Self>) -> Self {
        let one = self.lo.same(1.0);
        let half_turns = one.same(std::f64::consts::FRAC_1_PI);
        let (from, to) = (self.lo * half_turns, self.hi * half_turns);
        let e = (from.abs().max(to.abs()) + one) * one.same(8.0 * L::Scalar::UNIT);
        let limit = elementary::trig_limit::<L::Scalar>();
        let inner = self.clamped(-limit, limit);
        let far = self.lo.lt(one.same(-limit)) | one.same(limit).lt(self.hi);
        let pole = far | holds_phase(from - e, to + e, 0.5);
        notes.discontinuous = notes.discontinuous | pole;
        let (lo, hi) = (tan_at(inner.lo), tan_at(inner.hi));
        let entire = Self::entire(one);
        Self { lo: L::pick(pole, entire.lo, lo.lo), hi: L::pick(pole, entire.hi, hi.hi) }
    }

    /// Beyond the limit the functions are unbounded for f32 or f64; the safe bound on the near side
    /// is the value at the limit.
    #[inline(always)]
    fn hyperbolic(self, function: Hyperbolic) -> Self {
        let units = HYPERBOLIC_ERROR + 2.0;
        let (one, entire) = (self.lo.same(1.0), Self::entire(self.lo));
        let limit = elementary::exp_limits::<L::Scalar>().1;
        let inner = self.clamped(-limit, limit);
        let limit = one.same(limit);
        match function {
            Hyperbolic::Sinh => {
                let lo = lower_by(elementary::sinh(inner.lo), units);
                let hi = upper_by(elementary::sinh(inner.hi), units);
                Self {
                    lo: L::pick(self.lo.lt(-limit), entire.lo, lo),
                    hi: L::pick(limit.lt(self.hi), entire.hi, hi),
                }
            }
            Hyperbolic::Cosh => {
                let (least, most) = inner.magnitudes();
                let unbounded = self.lo.lt(-limit) | limit.lt(self.hi);
                let hi = upper_by(elementary::cosh(most), units);
                Self {
                    lo: lower_by(elementary::cosh(least), units).max(one),
                    hi: L::pick(unbounded, entire.hi, hi),
                }
            }
            Hyperbolic::Tanh => Self {
                lo: lower_by(elementary::tanh(self.lo), units).max(-one),
                hi: upper_by(elementary::tanh(self.hi), units).min(one),
            },
        }
    }

    #[inline(always)]
    fn cbrt(self) -> Self {
        let units = CBRT_ERROR + 2.0;
        Self {
            lo: lower_by(elementary::cbrt(self.lo), units),
            hi: upper_by(elementary::cbrt(self.hi), units),
        }
    }

    /// Steps rise and are exact; the function jumps where the two bounds differ.
    #[inline(always)]
    fn step(self, step: Step, notes: &mut NotesOf<Self>) -> Self {
        let (lo, hi) = (step_function(step, self.lo), step_function(step, self.hi));
        notes.discontinuous = notes.discontinuous | lo.lt(hi);
        Self { lo, hi }
    }

    #[inline(always)]
    fn smoothstep(self) -> Self {
        let (zero, one) = (self.zero(), self.lo.same(1.0));
        Self {
            lo: lower_by(smooth_step(self.lo), 4.0).max(zero),
            hi: upper_by(smooth_step(self.hi), 4.0).min(one),
        }
    }

    /// The values at the bounds, and 0 and 1/2 where a whole or a half number lies between. Where a
    /// half is lost from a bound, far out, it is so to the safe side.
    #[inline(always)]
    fn triangle(self) -> Self {
        let (half, limit) = (self.lo.same(0.5), self.lo.same(L::Scalar::MAX));
        let (from, to) = (self.lo.max(-limit), self.hi.min(limit));
        let (a, b) = (triangle_wave(from), triangle_wave(to));
        Self {
            lo: L::pick(holds_phase(from, to, 0.0), self.zero(), a.min(b)),
            hi: L::pick(holds_phase(from, to, 0.5), half, a.max(b)),
        }
    }

    #[inline(always)]
    fn atan2(self, x: Self, lifted: bool, notes: &mut NotesOf<Self>) -> Self {
        angle::atan2(self, x, lifted, notes)
    }

    #[inline(always)]
    fn harmonic(self, x: Self, wave: Wave, n: u32, notes: &mut NotesOf<Self>) -> Self {
        angle::harmonic(self, x, wave, n, notes)
    }

    #[inline(always)]
    fn order(self, b: Self) -> (MaskOf<Self>, MaskOf<Self>) {
        (self.hi.lt(b.lo), b.hi.lt(self.lo))
    }

    #[inline(always)]
    fn token(self) -> Token<Self> {
        self.lo.token()
    }

    #[inline(always)]
    fn abs_slope(self) -> Self {
        let (one, zero) = (self.lo.same(1.0), self.zero());
        let begins_below = self.lo.lt(zero);
        // What ends at 0 falls all the way, as what begins there rises.
        let falls = begins_below & self.hi.le(zero);
        Self { lo: L::pick(begins_below, -one, one), hi: L::pick(falls, -one, one) }
    }

    /// 1 from a whole number to the next half, −1 from there on.
    #[inline(always)]
    fn triangle_slope(self) -> Self {
        let one = self.lo.same(1.0);
        let bends = holds_phase(self.lo, self.hi, 0.0) | holds_phase(self.lo, self.hi, 0.5);
        let rises = (self.lo - self.lo.floor()).lt(self.lo.same(0.5));
        let slope = L::pick(rises, one, -one);
        Self { lo: L::pick(bends, -one, slope), hi: L::pick(bends, one, slope) }
    }

    #[inline(always)]
    fn choose(a: Self, b: Self, p: Self, q: Self) -> Self {
        let (first, second) = a.order(b);
        let both = p.hull(q);
        Self {
            lo: L::pick(first, p.lo, L::pick(second, q.lo, both.lo)),
            hi: L::pick(first, p.hi, L::pick(second, q.hi, both.hi)),
        }
    }
}
