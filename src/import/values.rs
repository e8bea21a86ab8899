//! Values of properties: numbers, words, colours, matrices; what is none is noted as a mistake.

use std::ops::RangeInclusive;

use glam::DMat4;

use super::{line, properties::Property};
use crate::diagnostic::Diagnostic;

/// The properties of a file, and what is wrong with those that were asked for.
pub(super) struct Values<'a> {
    pub(super) properties: &'a [Property],
    pub(super) mistakes: Vec<Diagnostic>,
}

impl<'a> Values<'a> {
    pub(super) fn new(properties: &'a [Property]) -> Self {
        Self { properties, mistakes: Vec::new() }
    }

    pub(super) fn find(&self, key: &str) -> Option<&'a Property> {
        self.properties.iter().find(|property| property.key == key)
    }

    /// Notes what is wrong with the value of a key.
    fn complain(&mut self, key: &str, message: String, help: impl Into<String>) {
        let span = self.find(key).map_or(0..0, |property| property.span.clone());
        self.mistakes.push(Diagnostic::new(span, message).help(help));
    }

    /// The N numbers of a key, if it is there and they are.
    pub(super) fn numbers<const N: usize>(&mut self, key: &str) -> Option<[f64; N]> {
        let property = self.find(key)?;
        let words = property.value.split_whitespace().map(|word| {
            let number = word.trim_end_matches(['f', 'F']).parse().ok();
            number.filter(|number: &f64| number.is_finite())
        });
        let numbers: Option<Vec<f64>> = words.collect();
        let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
        if numbers.is_none() {
            let wanted =
                if N == 1 { "a number" } else { &format!("{N} numbers with blanks between them") };
            let found = match property.value.as_str() {
                "" => "nothing".to_owned(),
                value => format!("`{}`", line(value)),
            };
            let message = format!("`{key}` is {found}, not {wanted}");
            let help = format!("write {key}={}", vec!["1.0"; N].join(" "));
            self.complain(key, message, help);
        }
        numbers
    }

    pub(super) fn number(&mut self, key: &str) -> Option<f64> {
        self.numbers::<1>(key).map(|[number]| number)
    }

    /// The number of a key within a range; `usual` where there is none.
    pub(super) fn number_in(&mut self, key: &str, range: RangeInclusive<f64>, usual: f64) -> f64 {
        let Some(number) = self.number(key) else { return usual };
        if !range.contains(&number) {
            let message = format!("`{key}` is {number}");
            let help = format!("it may be from {} to {}", range.start(), range.end());
            self.complain(key, message, help);
            return usual;
        }
        number
    }

    /// One of two words: whether it is the first one.
    pub(super) fn word(&mut self, key: &str, words: [&str; 2]) -> Option<bool> {
        let property = self.find(key)?;
        let place = words.iter().position(|&word| word == property.value.trim());
        if place.is_none() {
            let message = format!("`{key}` is `{}`", line(&property.value));
            self.complain(key, message, format!("it may be {} or {}", words[0], words[1]));
        }
        place.map(|place| place == 0)
    }

    /// A colour as `"#rrggbb"`.
    pub(super) fn color(&mut self, key: &str) -> Option<String> {
        let color = self.numbers::<3>(key)?;
        if !color.iter().all(|part| (0.0..=1.0).contains(part)) {
            let message = format!("`{key}` is no colour");
            self.complain(key, message, "red, green and blue are numbers from 0 to 1");
        }
        let [r, g, b] = color.map(|part| (part.clamp(0.0, 1.0) * 255.0).round());
        // Clamped above.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
        let [r, g, b] = [r as u8, g as u8, b as u8];
        Some(format!("\"#{r:02x}{g:02x}{b:02x}\""))
    }

    pub(super) fn matrix(&mut self, key: &str) -> Option<DMat4> {
        self.numbers::<16>(key).map(|rows| DMat4::from_cols_array(&rows).transpose())
    }
}
