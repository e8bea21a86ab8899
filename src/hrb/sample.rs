//! The types of samples, and what octrees keep of them.

use crate::mesh::Threshold;

/// A sample of a volume.
pub trait Sample: Copy + PartialOrd + Send + Sync {
    /// What a region keeps: the sample itself, or a mean.
    type Value: Value;
    /// A sum of any number of samples: exact for integers.
    type Sum: Copy + Send;

    /// As a number.
    fn to_f64(self) -> f64;

    /// As a region keeps it, exactly.
    fn value(self) -> Self::Value;

    /// A sum of one.
    fn sum(self) -> Self::Sum;

    /// A sum of `n` samples like this one.
    fn times(self, n: u64) -> Self::Sum;

    /// Two sums together.
    fn add(a: Self::Sum, b: Self::Sum) -> Self::Sum;

    /// The mean of `n` samples.
    fn mean(sum: Self::Sum, n: u64) -> Self::Value;

    /// Whether this is no number.
    #[inline]
    fn is_undefined(self) -> bool {
        false
    }

    /// The smaller one; no number if one of them is none.
    #[inline]
    fn least(self, other: Self) -> Self {
        if other < self || other.is_undefined() { other } else { self }
    }

    /// The larger one; no number if one of them is none.
    #[inline]
    fn most(self, other: Self) -> Self {
        if other > self || other.is_undefined() { other } else { self }
    }
}

/// What a region keeps: a sample by itself, too, so that what is kept can be changed.
pub trait Value: Sample<Value = Self> + Threshold + std::fmt::Debug {
    /// The nearest; halves up.
    fn from_f64(value: f64) -> Self;
}

/// Eight bits before the point and eight behind: the two bytes of the thesis.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Eq)]
pub struct Fixed8(u16);

impl Value for Fixed8 {
    /// To whole numbers from 0 to 255, as samples are.
    #[inline]
    fn from_f64(value: f64) -> Self {
        Self((value + 0.5).floor().clamp(0.0, 255.0) as u16 * 256)
    }
}

impl From<Fixed8> for f64 {
    #[inline]
    fn from(value: Fixed8) -> Self {
        value.to_f64()
    }
}

impl Threshold for Fixed8 {
    fn at_least(isovalue: f64) -> Option<Self> {
        let least = (256.0 * isovalue).ceil();
        // The conversion is cut to the type's range.
        (least <= u16::MAX.into()).then_some(Self(least as u16))
    }
}

impl Value for f32 {
    #[inline]
    fn from_f64(value: f64) -> Self {
        value as Self
    }
}

impl Value for f64 {
    #[inline]
    fn from_f64(value: f64) -> Self {
        value
    }
}

impl Sample for Fixed8 {
    type Value = Self;
    type Sum = i64;

    #[inline]
    fn to_f64(self) -> f64 {
        f64::from(self.0) / 256.0
    }

    #[inline]
    fn value(self) -> Self {
        self
    }

    #[inline]
    fn sum(self) -> i64 {
        self.0.into()
    }

    #[inline]
    fn times(self, n: u64) -> i64 {
        i64::from(self.0) * n as i64
    }

    #[inline]
    fn add(a: i64, b: i64) -> i64 {
        a + b
    }

    fn mean(sum: i64, n: u64) -> Self {
        let n = n as i64;
        Self(((2 * sum + n) / (2 * n)) as u16)
    }
}

impl Sample for u8 {
    type Value = Fixed8;
    type Sum = i64;

    #[inline]
    fn to_f64(self) -> f64 {
        self.into()
    }

    #[inline]
    fn value(self) -> Fixed8 {
        Fixed8(u16::from(self) << 8)
    }

    #[inline]
    fn sum(self) -> i64 {
        self.into()
    }

    #[inline]
    fn times(self, n: u64) -> i64 {
        i64::from(self) * n as i64
    }

    #[inline]
    fn add(a: i64, b: i64) -> i64 {
        a + b
    }

    /// To the nearest 256th, halves up.
    fn mean(sum: i64, n: u64) -> Fixed8 {
        let n = n as i64;
        Fixed8(((512 * sum + n) / (2 * n)) as u16)
    }
}

/// Integers whose means are kept as floats.
macro_rules! integer {
    ($type:ty, $value:ty) => {
        impl Sample for $type {
            type Value = $value;
            type Sum = i64;

            #[inline]
            fn to_f64(self) -> f64 {
                self.into()
            }

            #[inline]
            fn value(self) -> $value {
                self as $value
            }

            #[inline]
            fn sum(self) -> i64 {
                self.into()
            }

            #[inline]
            fn times(self, n: u64) -> i64 {
                i64::from(self) * n as i64
            }

            #[inline]
            fn add(a: i64, b: i64) -> i64 {
                a + b
            }

            fn mean(sum: i64, n: u64) -> $value {
                (sum as f64 / n as f64) as $value
            }
        }
    };
}

integer!(i8, f32);
integer!(u16, f32);
integer!(i16, f32);
integer!(u32, f64);
integer!(i32, f64);

/// Floats, with sums in a fixed order.
macro_rules! float {
    ($type:ty) => {
        impl Sample for $type {
            type Value = $type;
            type Sum = f64;

            #[inline]
            fn is_undefined(self) -> bool {
                self.is_nan()
            }

            #[inline]
            fn to_f64(self) -> f64 {
                self.into()
            }

            #[inline]
            fn value(self) -> $type {
                self
            }

            #[inline]
            fn sum(self) -> f64 {
                self.into()
            }

            #[inline]
            fn times(self, n: u64) -> f64 {
                f64::from(self) * n as f64
            }

            #[inline]
            fn add(a: f64, b: f64) -> f64 {
                a + b
            }

            fn mean(sum: f64, n: u64) -> $type {
                (sum / n as f64) as $type
            }
        }
    };
}

float!(f32);
float!(f64);
