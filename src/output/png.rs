//! PNG: 8-bit sRGB with straight alpha, for looking at.
//!
//! The picture is marked as sRGB for old readers and new ones (`sRGB` and `gAMA` chunks).
//! Where every pixel is opaque there is no alpha channel.
//!
//! *Based on:* Portable Network Graphics Specification, third edition, section 11.3.

use std::{io::Write, sync::LazyLock};

use image::{Rgba, RgbaImage};
use png::{
    BitDepth, ColorType, Compression, Encoder, EncodingError, ScaledFloat, SrgbRenderingIntent,
};
use rayon::prelude::*;

use super::{SOFTWARE, WriteError};
use crate::{math::linear_from_srgb, raster::Frame};

/// The gamma that comes nearest to sRGB, times 100,000, for readers that do not know sRGB.
const SRGB_GAMMA: u32 = 45455;

/// What the file says besides the picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PngOptions {
    /// What the picture shows: the scene's name.
    pub description: String,
}

/// Writes the colours of `frame`.
///
/// # Errors
/// If `out` fails, or the picture is empty.
pub fn write(frame: &Frame, options: &PngOptions, out: impl Write) -> Result<(), WriteError> {
    let pixels = srgb8(frame);
    let is_opaque = pixels.iter().all(|pixel| pixel[3] == u8::MAX);
    let mut writer = encoder(frame.width, frame.height, is_opaque, options, out)?.write_header()?;
    writer.write_image_data(&bytes(pixels, is_opaque))?;
    Ok(writer.finish()?)
}

/// Writes an opaque picture, as small as it gets: red, green and blue of each pixel in sRGB, rows from the
/// top.
///
/// # Errors
/// If `out` fails, or the picture is empty or has not so many bytes.
pub fn write_rgb8(
    [width, height]: [u32; 2],
    pixels: &[u8],
    options: &PngOptions,
    out: impl Write,
) -> Result<(), WriteError> {
    let mut encoder = encoder(width, height, true, options, out)?;
    encoder.set_compression(Compression::High);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    Ok(writer.finish()?)
}

/// An encoder that says what is the same for all pictures; without alpha if they are opaque.
pub(super) fn encoder<W: Write>(
    width: u32,
    height: u32,
    is_opaque: bool,
    options: &PngOptions,
    out: W,
) -> Result<Encoder<'static, W>, WriteError> {
    let mut encoder = Encoder::new(out, width, height);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_color(if is_opaque { ColorType::Rgb } else { ColorType::Rgba });
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    encoder.set_source_gamma(ScaledFloat::from_scaled(SRGB_GAMMA));
    encoder.add_itxt_chunk("Software".into(), SOFTWARE.into())?;
    encoder.add_itxt_chunk("Description".into(), options.description.clone())?;
    Ok(encoder)
}

/// The pixels as they are stored.
pub(super) fn bytes(pixels: Vec<[u8; 4]>, is_opaque: bool) -> Vec<u8> {
    if is_opaque {
        return pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
    }
    pixels.into_flattened()
}

/// The picture that [`write()`] stores, for comparison in memory.
#[must_use]
pub fn to_srgb8(frame: &Frame) -> RgbaImage {
    let pixels = srgb8(frame);
    RgbaImage::from_fn(frame.width, frame.height, |x, y| {
        Rgba(pixels[y as usize * frame.width as usize + x as usize])
    })
}

pub(super) fn srgb8(frame: &Frame) -> Vec<[u8; 4]> {
    frame.rgba.par_iter().map(|&rgba| srgb8_of(rgba)).collect()
}

fn srgb8_of([r, g, b, alpha]: [f32; 4]) -> [u8; 4] {
    let coverage = (alpha * 255.0).round_ties_even() as u8;
    if coverage == 0 {
        return [0; 4];
    }
    let code = |premultiplied: f32| srgb_code(premultiplied / alpha);
    [code(r), code(g), code(b), coverage]
}

/// The sRGB code nearest to a linear intensity; 0 below the range (or not a number), 255 above.
pub(super) fn srgb_code(linear: f32) -> u8 {
    BORDERS.partition_point(|&border| border <= linear) as u8
}

/// The linear intensities between neighbouring codes, halfway in sRGB. A search among them is
/// exact and monotone, which rounding a power function is not, and faster.
static BORDERS: LazyLock<[f32; 255]> = LazyLock::new(|| {
    std::array::from_fn(|code| linear_from_srgb((code as f64 + 0.5) / 255.0) as f32)
});

impl From<EncodingError> for WriteError {
    fn from(error: EncodingError) -> Self {
        match error {
            EncodingError::IoError(error) => Self::Io(error),
            other => Self::Encode(other.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(background: [f32; 4]) -> Frame {
        let mut frame = Frame::filled(3, 2, background);
        frame.rgba[1] = [1.0, 0.212_230_76, 0.0, 1.0];
        frame.rgba[2] = [0.106_115_38, 2.0, -1.0, 0.5];
        frame
    }

    fn bytes(frame: &Frame) -> Vec<u8> {
        let mut bytes = Vec::new();
        write(frame, &PngOptions { description: "Würfel".into() }, &mut bytes).unwrap();
        bytes
    }

    #[test]
    fn every_code_survives() {
        for code in 0..=u8::MAX {
            assert_eq!(srgb_code(linear_from_srgb(f64::from(code) / 255.0) as f32), code);
        }
        assert_eq!([-1.0, f32::NAN, 2.0, f32::INFINITY].map(srgb_code), [0, 0, 255, 255]);
    }

    #[test]
    fn alpha_is_straight_and_colours_are_srgb() {
        let image = to_srgb8(&picture([0.0; 4]));
        assert_eq!(image.get_pixel(0, 1).0, [0; 4]);
        assert_eq!(image.get_pixel(1, 0).0, [255, 127, 0, 255]);
        assert_eq!(image.get_pixel(2, 0).0, [127, 255, 0, 128]);
    }

    #[test]
    fn what_is_read_is_what_was_written() {
        for (background, color) in [([0.0; 4], ColorType::Rgba), ([1.0; 4], ColorType::Rgb)] {
            let mut frame = picture(background);
            if color == ColorType::Rgb {
                frame.rgba[2][3] = 1.0;
            }
            let bytes = bytes(&frame);
            let decoded = image::load_from_memory(&bytes).unwrap();
            assert_eq!(decoded.to_rgba8(), to_srgb8(&frame));
            let reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
            let info = reader.info();
            assert_eq!(info.color_type, color);
            assert_eq!(info.srgb, Some(SrgbRenderingIntent::Perceptual));
            assert_eq!(info.gama_chunk.map(|gamma| gamma.into_scaled()), Some(SRGB_GAMMA));
            let texts: Vec<_> = info
                .utf8_text
                .iter()
                .map(|chunk| (chunk.keyword.as_str(), chunk.get_text().unwrap()))
                .collect();
            assert_eq!(texts[0], ("Software", SOFTWARE.into()));
            assert_eq!(texts[1], ("Description", "Würfel".into()));
        }
    }

    #[test]
    fn bytes_repeat() {
        let frame = picture([0.0; 4]);
        assert_eq!(bytes(&frame), bytes(&frame));
    }

    #[test]
    fn an_empty_picture_is_refused() {
        let none = Frame::filled(0, 5, [0.0; 4]);
        let outcome = write(&none, &PngOptions::default(), Vec::new());
        assert!(matches!(outcome, Err(WriteError::Encode(_))));
    }
}
