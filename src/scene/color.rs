//! Colours: from what people write to what light does.

use super::leaf::Color;
use crate::math::linear_from_srgb;

/// Linear-light red, green, blue of an sRGB colour.
pub(super) fn linear(Color(rgb): Color) -> [f32; 3] {
    rgb.map(|component| linear_from_srgb(component) as f32)
}

/// What changes no light.
pub(super) const WHITE: Color = Color([1.0; 3]);

/// Colours for surfaces that name none: distinct, and light enough to show their shading.
const PALETTE: [u32; 6] = [0xe8b04b, 0x5b9bd5, 0x6dbb7f, 0xdb6b6b, 0xa184d6, 0x4fbdbd];

/// The colour of the surface number `index`, unless it has its own.
pub(super) fn default_color(index: usize) -> Color {
    Color::from_hex(PALETTE[index % PALETTE.len()])
}
