//! Vectors of floats that give the same bits on every machine.
//!
//! The only file that touches the SIMD crate. [`Lanes`] exposes just the operations whose result
//! IEEE 754 fixes completely: +, −, ×, ÷, square root, comparison, selection, rounding to integers
//! and moves of bits. There is no fused multiply-add, no approximate reciprocal, and `min` and
//! `max` are defined by a comparison, because the hardware's own disagree on NaN and signed zero.
//! The widths are fixed (16 × f32, 8 × f64), never the machine's. A plain `f32` or `f64` is a
//! vector of one lane, so that scalar code and batches share every formula.
//!
//! Code over lanes is compiled once for every instruction set, and that only works if it is inlined
//! whole into the function that has the instructions enabled: every such function is
//! `#[inline(always)]`, closures too, and calls through pointers and the closures' way through the
//! standard library's combinators (`map`, `fold`) are kept out of it.

use std::{
    fmt::Debug,
    ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub},
};

#[cfg(not(target_arch = "x86_64"))]
use fearless_simd::dispatch;
use fearless_simd::{Level, Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, f64x8};

/// The float type of one lane, with its constants.
pub trait Scalar: Copy + PartialOrd + Debug + Default + Send + Sync + 'static {
    /// Unit roundoff u: half the distance from 1 to the next larger number.
    const UNIT: f64;
    /// The smallest positive number, η.
    const TINY: f64;
    /// The smallest positive normal number.
    const MIN_NORMAL: f64;
    /// The largest finite number.
    const MAX: f64;
    /// Bits of the fraction field.
    const FRACTION_BITS: u32;
    /// Whether this is the narrow type (f32).
    const NARROW: bool;

    /// Rounds to nearest.
    fn nearest(v: f64) -> Self;
    /// Widens; exact.
    fn to_f64(self) -> f64;

    /// The largest value not above `v`.
    #[must_use]
    fn below(v: f64) -> Self;
    /// The smallest value not below `v`.
    #[must_use]
    fn above(v: f64) -> Self;
}

impl Scalar for f32 {
    const UNIT: f64 = 1.0 / (1_u64 << 24) as f64;
    const TINY: f64 = 1.401_298_464_324_817e-45;
    const MIN_NORMAL: f64 = Self::MIN_POSITIVE as f64;
    const MAX: f64 = Self::MAX as f64;
    const FRACTION_BITS: u32 = 23;
    const NARROW: bool = true;

    #[inline(always)]
    fn nearest(v: f64) -> Self {
        v as Self
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    fn below(v: f64) -> Self {
        let near = v as Self;
        if f64::from(near) > v { near.next_down() } else { near }
    }
    fn above(v: f64) -> Self {
        let near = v as Self;
        if f64::from(near) < v { near.next_up() } else { near }
    }
}

impl Scalar for f64 {
    const UNIT: f64 = 1.0 / (1_u64 << 53) as f64;
    const TINY: f64 = 5e-324;
    const MIN_NORMAL: f64 = Self::MIN_POSITIVE;
    const MAX: f64 = Self::MAX;
    const FRACTION_BITS: u32 = 52;
    const NARROW: bool = false;

    #[inline(always)]
    fn nearest(v: f64) -> Self {
        v
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
    fn below(v: f64) -> Self {
        v
    }
    fn above(v: f64) -> Self {
        v
    }
}

/// One truth value a lane.
pub trait Mask:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> + 'static
{
    /// Bit i is lane i.
    fn bits(self) -> u64;
}

impl Mask for bool {
    #[inline(always)]
    fn bits(self) -> u64 {
        u64::from(self)
    }
}

/// A vector of floats; see the file's text for what every implementation promises.
pub trait Lanes:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// The type of one lane.
    type Scalar: Scalar;
    /// The result of a comparison.
    type Mask: Mask;
    /// Proof that the machine has the instructions; copied from any other vector.
    type Token: Copy;
    /// Number of lanes.
    const LEN: usize;

    /// All lanes `v`.
    fn splat(token: Self::Token, v: Self::Scalar) -> Self;
    /// The first [`Lanes::LEN`] values of a slice.
    fn load(token: Self::Token, values: &[Self::Scalar]) -> Self;
    /// Writes the lanes to the start of a slice.
    fn store(self, values: &mut [Self::Scalar]);
    /// The token that this vector was made with.
    fn token(self) -> Self::Token;
    /// A mask with all lanes `v`.
    fn splat_mask(token: Self::Token, v: bool) -> Self::Mask;

    /// Square root; NaN below zero.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Clears the sign.
    #[must_use]
    fn abs(self) -> Self;
    /// Largest integer not above.
    #[must_use]
    fn floor(self) -> Self;
    /// Nearest integer, ties to even.
    #[must_use]
    fn round(self) -> Self;
    /// `self < other`; false on NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`; false on NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// `self == other`; false on NaN.
    fn eq(self, other: Self) -> Self::Mask;
    /// `yes` where the mask is set, else `no`.
    fn pick(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// 2 to the power `self`, an integer for which the result is a normal number.
    #[must_use]
    fn exp2_integer(self) -> Self;
    /// Splits a positive normal number as m·2^e with m in [1, 2): (m, e).
    fn split_exponent(self) -> (Self, Self);

    /// All lanes `v`, rounded to nearest.
    #[inline(always)]
    #[must_use]
    fn same(self, v: f64) -> Self {
        Self::splat(self.token(), Self::Scalar::nearest(v))
    }
    /// `self` where it is smaller, else `other`; in particular `other` where `self` is NaN.
    #[inline(always)]
    #[must_use]
    fn min(self, other: Self) -> Self {
        Self::pick(self.lt(other), self, other)
    }
    /// `self` where it is larger, else `other`; in particular `other` where `self` is NaN.
    #[inline(always)]
    #[must_use]
    fn max(self, other: Self) -> Self {
        Self::pick(other.lt(self), self, other)
    }
    /// `self > other`; false on NaN.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }
    /// `self >= other`; false on NaN.
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        other.le(self)
    }
    /// Applies a scalar function to every lane where `mask` is set: the slow way out for rare
    /// arguments.
    #[inline(always)]
    #[must_use]
    fn patch(self, mask: Self::Mask, argument: Self, f: fn(f64) -> f64) -> Self {
        let bits = mask.bits();
        if bits == 0 {
            return self;
        }
        let mut values = [Self::Scalar::default(); MAX_LEN];
        let mut arguments = values;
        self.store(&mut values[..Self::LEN]);
        argument.store(&mut arguments[..Self::LEN]);
        patch_scalars(&mut values, &arguments, bits, f);
        Self::load(self.token(), &values[..Self::LEN])
    }
}

/// The longest vector.
const MAX_LEN: usize = 16;

#[cold]
fn patch_scalars<T: Scalar>(
    values: &mut [T; MAX_LEN],
    arguments: &[T; MAX_LEN],
    bits: u64,
    f: fn(f64) -> f64,
) {
    for lane in (0..MAX_LEN).filter(|lane| bits >> lane & 1 == 1) {
        values[lane] = T::nearest(f(arguments[lane].to_f64()));
    }
}

macro_rules! scalar_lanes {
    ($float:ident) => {
        impl Lanes for $float {
            type Scalar = $float;
            type Mask = bool;
            type Token = ();
            const LEN: usize = 1;

            #[inline(always)]
            fn splat((): (), v: $float) -> Self {
                v
            }
            #[inline(always)]
            fn load((): (), values: &[$float]) -> Self {
                values[0]
            }
            #[inline(always)]
            fn store(self, values: &mut [$float]) {
                values[0] = self;
            }
            #[inline(always)]
            fn token(self) {}
            #[inline(always)]
            fn splat_mask((): (), v: bool) -> bool {
                v
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $float::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $float::abs(self)
            }
            #[inline(always)]
            fn floor(self) -> Self {
                $float::floor(self)
            }
            #[inline(always)]
            fn round(self) -> Self {
                $float::round_ties_even(self)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn le(self, other: Self) -> bool {
                self <= other
            }
            #[inline(always)]
            fn eq(self, other: Self) -> bool {
                self == other
            }
            #[inline(always)]
            fn pick(mask: bool, yes: Self, no: Self) -> Self {
                if mask { yes } else { no }
            }
            #[inline(always)]
            fn exp2_integer(self) -> Self {
                $float::from_bits(
                    (self + exponent_magic::<$float>() as $float).to_bits()
                        << $float::FRACTION_BITS,
                )
            }
            #[inline(always)]
            fn split_exponent(self) -> (Self, Self) {
                let bits = self.to_bits();
                let fraction = (1 << $float::FRACTION_BITS) - 1;
                let one = (1.0 as $float).to_bits();
                let magic = integer_magic::<$float>() as $float;
                let exponent = $float::from_bits((bits >> $float::FRACTION_BITS) | magic.to_bits());
                (
                    $float::from_bits((bits & fraction) | one),
                    exponent - exponent_magic::<$float>() as $float,
                )
            }
        }
    };
}

/// A number whose last fraction bit is worth 1: adding a small integer puts it into those bits.
const fn integer_magic<T: Scalar>() -> f64 {
    (1_u64 << T::FRACTION_BITS) as f64
}

/// [`integer_magic`] plus the exponent's bias: the low bits hold a biased exponent.
const fn exponent_magic<T: Scalar>() -> f64 {
    integer_magic::<T>() + if T::NARROW { 127.0 } else { 1023.0 }
}

scalar_lanes!(f32);
scalar_lanes!(f64);

macro_rules! vector_lanes {
    ($vector:ident, $float:ident, $mask:ident) => {
        impl<S: Simd> Mask for fearless_simd::$mask<S> {
            #[inline(always)]
            fn bits(self) -> u64 {
                self.to_bitmask()
            }
        }

        impl<S: Simd> Lanes for $vector<S> {
            type Scalar = $float;
            type Mask = fearless_simd::$mask<S>;
            type Token = S;
            const LEN: usize = <Self as SimdBase<S>>::LEN;

            #[inline(always)]
            fn splat(token: S, v: $float) -> Self {
                SimdBase::splat(token, v)
            }
            #[inline(always)]
            fn load(token: S, values: &[$float]) -> Self {
                SimdBase::from_slice(token, &values[..<Self as SimdBase<S>>::LEN])
            }
            #[inline(always)]
            fn store(self, values: &mut [$float]) {
                self.store_slice(&mut values[..<Self as SimdBase<S>>::LEN]);
            }
            #[inline(always)]
            fn token(self) -> S {
                fearless_simd::ExtractToken::token(&self)
            }
            #[inline(always)]
            fn splat_mask(token: S, v: bool) -> Self::Mask {
                SimdMask::splat(token, v)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                SimdFloat::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                SimdBase::abs(self)
            }
            #[inline(always)]
            fn floor(self) -> Self {
                SimdFloat::floor(self)
            }
            #[inline(always)]
            fn round(self) -> Self {
                SimdFloat::round_ties_even(self)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> Self::Mask {
                self.simd_lt(other)
            }
            #[inline(always)]
            fn le(self, other: Self) -> Self::Mask {
                self.simd_le(other)
            }
            #[inline(always)]
            fn eq(self, other: Self) -> Self::Mask {
                self.simd_eq(other)
            }
            #[inline(always)]
            fn pick(mask: Self::Mask, yes: Self, no: Self) -> Self {
                mask.select(yes, no)
            }
            #[inline(always)]
            fn exp2_integer(self) -> Self {
                let biased = self.same(exponent_magic::<$float>()) + self;
                Self::from_bits(biased.to_bits() << $float::FRACTION_BITS)
            }
            #[inline(always)]
            fn split_exponent(self) -> (Self, Self) {
                let bits = self.to_bits();
                let magic = self.same(integer_magic::<$float>());
                let fraction = (1 << $float::FRACTION_BITS) - 1;
                let exponent = Self::from_bits((bits >> $float::FRACTION_BITS) | magic.to_bits());
                let mantissa = Self::from_bits((bits & fraction) | self.same(1.0).to_bits());
                (mantissa, exponent - self.same(exponent_magic::<$float>()))
            }
        }
    };
}

vector_lanes!(f32x16, f32, mask32x16);
vector_lanes!(f64x8, f64, mask64x8);

/// Work that is compiled once for every instruction set; see [`SimdLevel::run`].
pub trait SimdTask {
    /// What it gives.
    type Output;
    /// The work; `f32x16<S>` and `f64x8<S>` are its vectors.
    fn run<S: Simd>(self, simd: S) -> Self::Output;
}

/// An instruction set. Results never depend on it, only speed does.
#[derive(Clone, Copy, Debug)]
pub struct SimdLevel(Level);

impl SimdLevel {
    /// The best that this machine has.
    #[must_use]
    pub fn detect() -> Self {
        Self(Level::new())
    }

    /// Every level that this machine has, best first.
    #[must_use]
    pub fn available() -> Vec<Self> {
        let best = Level::new();
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        let levels = [
            best.as_avx512().map(Level::Avx512),
            best.as_avx2().map(Level::Avx2),
            best.as_sse2().map(Level::Sse2),
        ];
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        let levels = [Some(best)];
        levels.into_iter().flatten().map(Self).collect()
    }

    /// Finds an available level by its name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::available().into_iter().find(|level| level.name() == name)
    }

    /// Such as `avx2`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self.0 {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Avx512(_) => "avx512",
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Avx2(_) => "avx2",
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Sse2(_) | Level::Sse4_2(_) => "sse2",
            #[cfg(target_arch = "aarch64")]
            Level::Neon(_) => "neon",
            _ => "scalar",
        }
    }

    /// Runs `task` with this level's instructions. SSE4.2 goes with SSE2: the machines that have it
    /// and not AVX2 are few, and every level costs a quarter of the time to build this crate.
    pub fn run<T: SimdTask>(self, task: T) -> T::Output {
        match self.0 {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Avx512(simd) => task.run(simd),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Avx2(simd) => task.run(simd),
            #[cfg(target_arch = "x86_64")]
            level => match level.as_sse2() {
                Some(simd) => task.run(simd),
                None => unreachable!("every x86-64 machine has SSE2"),
            },
            #[cfg(not(target_arch = "x86_64"))]
            level => dispatch!(level, simd => task.run(simd)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_split_and_join() {
        for (v, m, e) in [(1.0, 1.0, 0.0), (12.0, 1.5, 3.0), (0.3125, 1.25, -2.0)] {
            assert_eq!(Lanes::split_exponent(v), (m, e));
            assert_eq!(Lanes::split_exponent(v as f32), (m as f32, e as f32));
        }
        assert_eq!(Lanes::exp2_integer(-1022.0_f64), f64::MIN_POSITIVE);
        assert_eq!(Lanes::exp2_integer(127.0_f32), 1.701_411_8e38);
    }

    /// One operation after another on awkward numbers, as bits.
    struct Everything;

    fn operations<L: Lanes>(a: L, b: L) -> [L; 11] {
        let rounded = [b.sqrt(), b.floor(), b.round(), b.abs(), -b];
        let [sqrt, floor, round, abs, neg] = rounded;
        [a + b, a - b, a * b, a / b, a.min(b), a.max(b), sqrt, floor, round, abs, neg]
    }

    impl SimdTask for Everything {
        type Output = Vec<u32>;
        fn run<S: Simd>(self, simd: S) -> Vec<u32> {
            let awkward: [f32; 16] = [
                0.0,
                -0.0,
                1.5,
                -2.5,
                f32::NAN,
                f32::INFINITY,
                f32::NEG_INFINITY,
                1e-45,
                -1e-40,
                3e38,
                0.5,
                8_388_609.0,
                -7.1,
                16_777_216.0,
                1.0,
                1e-3,
            ];
            let mut out = Vec::new();
            for shift in 0..16 {
                let mut turned = awkward;
                turned.rotate_left(shift);
                let operands = (f32x16::load(simd, &awkward), f32x16::load(simd, &turned));
                for v in operations(operands.0, operands.1) {
                    let mut lanes = [0.0; 16];
                    v.store(&mut lanes);
                    out.extend(lanes.map(|x| if x.is_nan() { u32::MAX } else { x.to_bits() }));
                }
            }
            out
        }
    }

    #[test]
    fn every_level_gives_the_same_bits() {
        let levels = SimdLevel::available();
        let reference = levels[0].run(Everything);
        for level in levels {
            assert_eq!(level.run(Everything), reference, "{}", level.name());
        }
    }
}
