//! The numbers of a volume, of any type.

use std::fmt;

/// How a number is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleType {
    /// Unsigned, 8 bits.
    U8,
    /// Signed, 8 bits.
    I8,
    /// Unsigned, 16 bits.
    U16,
    /// Signed, 16 bits.
    I16,
    /// Unsigned, 32 bits.
    U32,
    /// Signed, 32 bits.
    I32,
    /// Floating point, 32 bits.
    F32,
    /// Floating point, 64 bits. In files only: it becomes the nearest [`SampleType::F32`], since
    /// no scanner measures as finely as even that rounds. Numbers beyond its range become infinite.
    F64,
}

impl SampleType {
    /// All of them.
    pub const ALL: [Self; 8] =
        [Self::U8, Self::I8, Self::U16, Self::I16, Self::U32, Self::I32, Self::F32, Self::F64];

    /// Bytes a sample takes.
    #[must_use]
    pub fn n_bytes(self) -> u64 {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Such as `u8`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::U8 => "u8",
            Self::I8 => "i8",
            Self::U16 => "u16",
            Self::I16 => "i16",
            Self::U32 => "u32",
            Self::I32 => "i32",
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }

    /// Finds a type by any of the names that it has in scenes, C programs and names of files.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "u8" | "uint8" | "uint8_t" | "uchar" | "unsigned char" => Self::U8,
            "i8" | "int8" | "int8_t" | "signed char" => Self::I8,
            "u16" | "uint16" | "uint16_t" | "ushort" | "unsigned short" | "unsigned short int" => {
                Self::U16
            }
            "i16" | "int16" | "int16_t" | "short" | "short int" | "signed short"
            | "signed short int" => Self::I16,
            "u32" | "uint32" | "uint32_t" | "uint" | "unsigned int" => Self::U32,
            "i32" | "int32" | "int32_t" | "int" | "signed int" => Self::I32,
            "f32" | "float32" | "float" => Self::F32,
            "f64" | "float64" | "double" => Self::F64,
            _ => return None,
        })
    }
}

impl fmt::Display for SampleType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// One of the types that a volume's samples may have.
pub trait Sample: Copy + Default + PartialOrd + Send + Sync + fmt::Debug + 'static {
    /// The value, exactly.
    fn to_f64(self) -> f64;

    /// The largest sample below `value`, which is finite; the smallest of all if there is none.
    fn just_below(value: f64) -> Self;
}

macro_rules! integer_sample {
    ($($type:ty),*) => {$(
        impl Sample for $type {
            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            fn just_below(value: f64) -> Self {
                // The conversion is cut to the type's range.
                (value.ceil() - 1.0) as Self
            }
        }
    )*};
}

integer_sample!(u8, i8, u16, i16, u32, i32);

impl Sample for f32 {
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    fn just_below(value: f64) -> Self {
        let nearest = value as Self;
        if f64::from(nearest) < value { nearest } else { nearest.next_down() }
    }
}

/// The samples of a volume, x fastest, then y, then z.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// Unsigned, 8 bits.
    U8(Vec<u8>),
    /// Signed, 8 bits.
    I8(Vec<i8>),
    /// Unsigned, 16 bits.
    U16(Vec<u16>),
    /// Signed, 16 bits.
    I16(Vec<i16>),
    /// Unsigned, 32 bits.
    U32(Vec<u32>),
    /// Signed, 32 bits.
    I32(Vec<i32>),
    /// Floating point; NaN where there is no value, which counts as outside. May be infinite.
    F32(Vec<f32>),
}

/// The same code for samples of any type: `with_samples!(&samples, |values| values.len())`.
macro_rules! with_samples {
    ($samples:expr, |$values:ident| $code:expr) => {
        match $samples {
            $crate::volume::Samples::U8($values) => $code,
            $crate::volume::Samples::I8($values) => $code,
            $crate::volume::Samples::U16($values) => $code,
            $crate::volume::Samples::I16($values) => $code,
            $crate::volume::Samples::U32($values) => $code,
            $crate::volume::Samples::I32($values) => $code,
            $crate::volume::Samples::F32($values) => $code,
        }
    };
}
pub(crate) use with_samples;

impl Samples {
    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        with_samples!(self, |values| values.len())
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The type; never [`SampleType::F64`].
    #[must_use]
    pub fn sample_type(&self) -> SampleType {
        match self {
            Self::U8(_) => SampleType::U8,
            Self::I8(_) => SampleType::I8,
            Self::U16(_) => SampleType::U16,
            Self::I16(_) => SampleType::I16,
            Self::U32(_) => SampleType::U32,
            Self::I32(_) => SampleType::I32,
            Self::F32(_) => SampleType::F32,
        }
    }

    /// The smallest and the largest; NaN is left out, and stands for both where there is no number.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        with_samples!(self, |values| range(values))
    }
}

fn range<T: Sample>(values: &[T]) -> [f64; 2] {
    // Only NaN differs from itself.
    #[expect(clippy::eq_op, reason = "for floats it is not the same")]
    let mut numbers = values.iter().copied().filter(|v| v == v);
    let Some(first) = numbers.next() else { return [f64::NAN; 2] };
    let (low, high) = numbers.fold((first, first), |(low, high), v| {
        (if v < low { v } else { low }, if v > high { v } else { high })
    });
    // Without the sign of zero, so that the order of samples does not show.
    [low.to_f64() + 0.0, high.to_f64() + 0.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_leave_out_what_is_no_number() {
        assert_eq!(Samples::I16(vec![3, -7, 5]).range(), [-7.0, 5.0]);
        assert_eq!(Samples::F32(vec![f32::NAN, 2.5, -1.0]).range(), [-1.0, 2.5]);
        assert!(Samples::F32(vec![f32::NAN]).range().iter().all(|v| v.is_nan()));
        assert_eq!(Samples::F32(vec![0.0, -0.0]).range()[0].to_bits(), 0);
    }

    #[test]
    fn just_below_is_below() {
        assert_eq!([u8::just_below(60.0), u8::just_below(60.5)], [59, 60]);
        assert_eq!([i16::just_below(-2.5), i16::just_below(-3.0)], [-3, -4]);
        assert_eq!([u8::just_below(0.0), u8::just_below(1e9)], [0, 255]);
        assert_eq!(f32::just_below(1.0), 1.0_f32.next_down());
        assert_eq!(f32::just_below(1.0 + 1e-12), 1.0);
        assert_eq!(f32::just_below(1.0 - 1e-12), 1.0_f32.next_down());
    }

    #[test]
    fn types_are_found_by_their_own_names() {
        for kind in SampleType::ALL {
            assert_eq!(SampleType::from_name(kind.name()), Some(kind));
        }
    }
}
