//! Awkward numbers and intervals, and real results to hold enclosures against.

use proptest::prelude::*;
use zeroset::math::{Interval, Lanes, Scalar};

/// A scalar that is a vector of one lane.
pub(crate) trait Float: Scalar + Lanes<Scalar = Self, Token = (), Mask = bool> {
    /// The number with the bits given; all of them for f64, the upper half for f32.
    fn from_pattern(bits: u64) -> Self;
    /// The next larger number.
    fn up(self) -> Self;
}

impl Float for f32 {
    fn from_pattern(bits: u64) -> Self {
        Self::from_bits((bits >> 32) as u32)
    }
    fn up(self) -> Self {
        self.next_up()
    }
}

impl Float for f64 {
    fn from_pattern(bits: u64) -> Self {
        Self::from_bits(bits)
    }
    fn up(self) -> Self {
        self.next_up()
    }
}

/// Runs `n` cases, or as many as the variable `PROPTEST_CASES` says, and writes no files.
pub(crate) fn cases(n: u32) -> ProptestConfig {
    let default = ProptestConfig::default();
    let from_environment = std::env::var_os("PROPTEST_CASES").map(|_| default.cases);
    ProptestConfig { cases: from_environment.unwrap_or(n), failure_persistence: None, ..default }
}

/// Finite numbers, the awkward ones often.
pub(crate) fn number<T: Float>() -> impl Strategy<Value = T> {
    let (max, least, normal) = (T::MAX, T::TINY, T::MIN_NORMAL);
    let special = prop::sample::select(vec![
        0.0,
        -0.0,
        1.0,
        -1.0,
        2.0,
        -3.0,
        0.5,
        0.75,
        max,
        -max,
        max / 2.0,
        least,
        -least,
        normal,
        -normal,
        1.0 + 2.0 * T::UNIT,
        1.0 - T::UNIT,
        88.0,
        -87.0,
        709.0,
        -708.0,
        6400.0,
    ]);
    prop_oneof![
        3 => special.prop_map(T::nearest),
        3 => (-10.0..10.0).prop_map(T::nearest),
        1 => (-3_i32..=3).prop_map(|i| T::nearest(f64::from(i))),
        1 => (-400.0..400.0).prop_map(|a: f64| T::nearest(a * std::f64::consts::FRAC_PI_4)),
        2 => any::<u64>().prop_map(T::from_pattern),
        1 => (1.0..2.0, -150_i32..130).prop_map(|(m, e)| T::nearest(libm::ldexp(m, e))),
    ]
    .prop_filter("finite", |v: &T| v.to_f64().is_finite())
}

/// Bounds of intervals: wide, one number, neighbours, touching zero, unbounded.
pub(crate) fn interval<T: Float>() -> impl Strategy<Value = Interval<T>> {
    let pair = (number::<T>(), number::<T>());
    let zero = || T::nearest(0.0);
    prop_oneof![
        4 => pair.prop_map(|(a, b)| if b < a { (b, a) } else { (a, b) }),
        2 => number::<T>().prop_map(|a| (a, a)),
        2 => number::<T>().prop_filter("has a finite neighbour", |a| a.up().to_f64().is_finite())
            .prop_map(|a| (a, a.up())),
        1 => number::<T>().prop_map(move |a| if a < zero() { (a, zero()) } else { (zero(), a) }),
        1 => number::<T>().prop_map(|a| (a, T::nearest(f64::INFINITY))),
        1 => number::<T>().prop_map(|a| (T::nearest(f64::NEG_INFINITY), a)),
        1 => Just((T::nearest(f64::NEG_INFINITY), T::nearest(f64::INFINITY))),
    ]
    .prop_map(|(lo, hi)| Interval { lo, hi })
}

/// Reals of an interval: its bounds, what lies between them, and zero.
pub(crate) fn reals<T: Float>(a: Interval<T>, at: &[f64]) -> Vec<f64> {
    let far = if T::NARROW { 1e300 } else { f64::MAX };
    let (lo, hi) = (a.lo.to_f64().max(-far), a.hi.to_f64().min(far));
    let between = at.iter().map(|t| (lo * (1.0 - t) + hi * t).clamp(lo, hi));
    let mut points: Vec<f64> = [lo, hi].into_iter().chain(between).collect();
    if lo <= 0.0 && 0.0 <= hi {
        points.push(0.0);
    }
    points
}

/// The true result of an operation at a point, as far as it is known.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Truth {
    /// Nearest f64, or within `ulps` of it.
    pub(crate) value: f64,
    /// Has the sign of the true result minus `value`; 0 where that is not known.
    pub(crate) rest: f64,
    /// Numbers by which `value` may be wrong.
    pub(crate) ulps: u32,
}

impl Truth {
    pub(crate) fn exact(value: f64) -> Self {
        Self { value, rest: 0.0, ulps: 0 }
    }

    /// A correctly rounded result and the sign of what rounding took away.
    pub(crate) fn rounded(value: f64, rest: f64) -> Self {
        let rest = if value.is_finite() && rest.is_finite() { rest } else { 0.0 };
        Self { value, rest, ulps: 0 }
    }

    /// A result of a library that is within `ulps`.
    pub(crate) fn within(value: f64, ulps: u32) -> Self {
        Self { value, rest: 0.0, ulps }
    }

    pub(crate) fn sum(a: f64, b: f64) -> Self {
        let s = a + b;
        let t = s - a;
        Self::rounded(s, (a - (s - t)) + (b - t))
    }

    pub(crate) fn product(a: f64, b: f64) -> Self {
        let p = a * b;
        let rest = libm::fma(a, b, -p);
        // Where the product vanishes, so does its remainder; the sign is still known.
        let lost = p == 0.0 && a != 0.0 && b != 0.0;
        Self::rounded(p, if lost { a.signum() * b.signum() } else { rest })
    }

    /// Whether the bounds enclose it.
    pub(crate) fn is_in(self, lo: f64, hi: f64) -> bool {
        let (mut least, mut most) = (self.value, self.value);
        for _ in 0..self.ulps {
            (least, most) = (least.next_down(), most.next_up());
        }
        if self.ulps > 0 {
            return lo <= most && least <= hi;
        }
        let above = lo < least || (lo == least && self.rest >= 0.0);
        let below = most < hi || (most == hi && self.rest <= 0.0);
        above && below
    }
}

/// `lo <= hi`, no NaN, no infinity on the wrong side.
pub(crate) fn is_sane<T: Float>(a: Interval<T>) -> bool {
    let (lo, hi) = (a.lo.to_f64(), a.hi.to_f64());
    lo <= hi && lo < f64::INFINITY && f64::NEG_INFINITY < hi
}
