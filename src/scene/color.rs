//! Colours: from what people write to what light does.

use super::leaf::Color;

/// Linear-light red, green, blue of an sRGB colour.
///
/// *Based on:* IEC 61966-2-1:1999, the transfer function of sRGB.
pub(super) fn linear_from_srgb(Color(rgb): Color) -> [f32; 3] {
    rgb.map(|c| match c <= 0.04045 {
        true => c / 12.92,
        false => libm::pow((c + 0.055) / 1.055, 2.4),
    } as f32)
}

/// Colours for surfaces that name none: distinct, and light enough to show their shading.
const PALETTE: [u32; 6] = [0xe8b04b, 0x5b9bd5, 0x6dbb7f, 0xdb6b6b, 0xa184d6, 0x4fbdbd];

/// The colour of the surface number `index`, unless it has its own.
pub(super) fn default_color(index: usize) -> Color {
    Color::from_hex(PALETTE[index % PALETTE.len()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_exact_and_the_middle_is_dark() {
        assert_eq!(linear_from_srgb(Color([0.0, 1.0, 0.5])), [0.0, 1.0, 0.214_041_14]);
    }
}
