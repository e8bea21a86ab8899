//! The values that stand in a scene file: numbers, vectors, colours, names of files.
//!
//! TOML allows more than a scene can use (`nan`, arrays of any length, tables written as arrays),
//! and serde takes it silently; these types do not. An error message may have a second line, which
//! is shown as help.

use std::{fmt, marker::PhantomData};

use serde::{
    Deserialize, Deserializer,
    de::{Error, MapAccess, SeqAccess, Visitor, value::MapAccessDeserializer},
};

/// A finite number, written as a float or an integer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Number(pub(super) f64);

/// An integer; what is too large for `i64` becomes its end, which every range check refuses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Whole(pub(super) i64);

/// Exactly `N` finite numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Numbers<const N: usize>(pub(super) [f64; N]);

/// Two numbers, of which each may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ends(pub(super) [f64; 2]);

/// An sRGB colour, components in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Color(pub(super) [f64; 3]);

impl Color {
    /// The colour "#rrggbb".
    fn from_text(text: &str) -> Option<Self> {
        let digits = text.strip_prefix('#')?;
        let is_rgb = digits.len() == 6 && digits.bytes().all(|byte| byte.is_ascii_hexdigit());
        u32::from_str_radix(digits, 16).ok().filter(|_| is_rgb).map(Self::from_hex)
    }

    /// The colour `0xrrggbb`.
    pub(super) fn from_hex(rgb: u32) -> Self {
        Self([rgb >> 16, rgb >> 8, rgb].map(|byte| f64::from(byte & 0xff) / 255.0))
    }
}

/// How many voxels there are along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Detail {
    /// As many as the picture needs.
    Auto,
    Voxels(i64),
}

/// What is behind the surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Background {
    Transparent,
    Color(Color),
}

/// Whether to write a file, and under which name.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Target {
    Switch(bool),
    File(String),
}

/// A table; serde's own structs would take an array as well.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Table<T>(pub(super) T);

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NumberVisitor)
    }
}

struct NumberVisitor;

impl Visitor<'_> for NumberVisitor {
    type Value = Number;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Number, E> {
        if value.is_finite() {
            return Ok(Number(value));
        }
        Err(E::custom("expected a finite number"))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Number, E> {
        Ok(Number(value as f64))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Number, E> {
        Ok(Number(value as f64))
    }

    fn visit_i128<E: Error>(self, value: i128) -> Result<Number, E> {
        Ok(Number(value as f64))
    }
}

impl<'de> Deserialize<'de> for Whole {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(WholeVisitor)
    }
}

struct WholeVisitor;

impl Visitor<'_> for WholeVisitor {
    type Value = Whole;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a whole number")
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Whole, E> {
        Ok(Whole(value))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Whole, E> {
        Ok(Whole(i64::try_from(value).unwrap_or(i64::MAX)))
    }

    fn visit_i128<E: Error>(self, value: i128) -> Result<Whole, E> {
        let end = if value < 0 { i64::MIN } else { i64::MAX };
        Ok(Whole(i64::try_from(value).unwrap_or(end)))
    }
}

impl<'de, const N: usize> Deserialize<'de> for Numbers<N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NumbersVisitor::<N>)
    }
}

struct NumbersVisitor<const N: usize>;

impl<'de, const N: usize> Visitor<'de> for NumbersVisitor<N> {
    type Value = Numbers<N>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "an array of {N} numbers")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Numbers<N>, A::Error> {
        let mut numbers = [0.0; N];
        let mut n = 0;
        while let Some(Number(value)) = seq.next_element()? {
            if let Some(slot) = numbers.get_mut(n) {
                *slot = value;
            }
            n += 1;
        }
        if n == N {
            return Ok(Numbers(numbers));
        }
        Err(A::Error::custom(format!("expected {N} numbers, found {n}")))
    }
}

impl<'de> Deserialize<'de> for Ends {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(EndsVisitor)
    }
}

struct EndsVisitor;

impl<'de> Visitor<'de> for EndsVisitor {
    type Value = Ends;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an array of 2 numbers")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Ends, A::Error> {
        let mut ends = [f64::NAN; 2];
        let mut n = 0;
        while let Some(value) = seq.next_element::<f64>()? {
            if value.is_nan() {
                return Err(A::Error::custom("expected numbers, or inf or -inf"));
            }
            if let Some(slot) = ends.get_mut(n) {
                *slot = value;
            }
            n += 1;
        }
        if n == 2 {
            return Ok(Ends(ends));
        }
        Err(A::Error::custom(format!("expected 2 numbers, found {n}")))
    }
}

impl<'de> Deserialize<'de> for Color {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ColorVisitor)
    }
}

struct ColorVisitor;

const COLOR_HELP: &str = "write \"#rrggbb\", or [red, green, blue] with numbers from 0 to 1";

impl<'de> Visitor<'de> for ColorVisitor {
    type Value = Color;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "a colour\n{COLOR_HELP}")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Color, E> {
        let color = Color::from_text(text);
        color.ok_or_else(|| E::custom(format!("`{text}` is not a colour\n{COLOR_HELP}")))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Color, A::Error> {
        let Numbers(rgb) = NumbersVisitor::<3>.visit_seq(seq)?;
        if rgb.iter().all(|c| (0.0..=1.0).contains(c)) {
            return Ok(Color(rgb));
        }
        Err(A::Error::custom(format!("the numbers of a colour lie from 0 to 1\n{COLOR_HELP}")))
    }
}

impl<'de> Deserialize<'de> for Background {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(BackgroundVisitor)
    }
}

struct BackgroundVisitor;

impl<'de> Visitor<'de> for BackgroundVisitor {
    type Value = Background;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "\"transparent\" or a colour\n{COLOR_HELP}")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Background, E> {
        if text == "transparent" {
            return Ok(Background::Transparent);
        }
        let color = Color::from_text(text).map(Background::Color);
        color.ok_or_else(|| {
            E::custom(format!("`{text}` is not a background\nwrite \"transparent\" or \"#rrggbb\""))
        })
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Background, A::Error> {
        ColorVisitor.visit_seq(seq).map(Background::Color)
    }
}

impl<'de> Deserialize<'de> for Target {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(TargetVisitor)
    }
}

struct TargetVisitor;

impl Visitor<'_> for TargetVisitor {
    type Value = Target;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("true, false or the name of a file")
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<Target, E> {
        Ok(Target::Switch(value))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Target, E> {
        Ok(Target::File(text.to_owned()))
    }
}

impl<'de> Deserialize<'de> for Detail {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(DetailVisitor)
    }
}

struct DetailVisitor;

impl Visitor<'_> for DetailVisitor {
    type Value = Detail;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a whole number or \"auto\"")
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Detail, E> {
        WholeVisitor.visit_i64(value).map(|Whole(n)| Detail::Voxels(n))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Detail, E> {
        WholeVisitor.visit_u64(value).map(|Whole(n)| Detail::Voxels(n))
    }

    fn visit_i128<E: Error>(self, value: i128) -> Result<Detail, E> {
        WholeVisitor.visit_i128(value).map(|Whole(n)| Detail::Voxels(n))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Detail, E> {
        if text == "auto" {
            return Ok(Detail::Auto);
        }
        Err(E::invalid_value(serde::de::Unexpected::Str(text), &self))
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Table<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(TableVisitor(PhantomData))
    }
}

struct TableVisitor<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for TableVisitor<T> {
    type Value = Table<T>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a table")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Table<T>, A::Error> {
        T::deserialize(MapAccessDeserializer::new(map)).map(Table)
    }
}
