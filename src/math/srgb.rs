//! The transfer curve of sRGB.
//!
//! *Based on:* IEC 61966-2-1:1999.

/// The linear intensity of an sRGB component, both in [0, 1].
#[must_use]
pub fn linear_from_srgb(component: f64) -> f64 {
    match component <= 0.04045 {
        true => component / 12.92,
        false => libm::pow((component + 0.055) / 1.055, 2.4),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_exact_and_the_middle_is_dark() {
        assert_eq!([0.0, 1.0].map(linear_from_srgb), [0.0, 1.0]);
        assert!((linear_from_srgb(0.5) - 0.214_041_14).abs() < 1e-8);
    }
}
