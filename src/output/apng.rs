//! Animated PNG: a film in one file, as [`super::png`] writes each picture.
//!
//! Frames are written one by one, so that no film is ever in memory. It is repeated for ever.
//!
//! *Based on:* Portable Network Graphics Specification, third edition, section 11.3.5.

use std::io::Write;

use png::Writer;

use super::{
    WriteError, Written,
    png::{PngOptions, bytes, encoder, srgb8},
};
use crate::raster::Frame;

/// What the file says before its first frame.
#[derive(Clone, Debug, PartialEq)]
pub struct ApngOptions {
    /// As for a picture.
    pub png: PngOptions,
    /// Width and height of all frames, in pixels.
    pub size_px: [u32; 2],
    /// Whether no frame has a pixel that is not opaque.
    pub is_opaque: bool,
    /// Number of frames.
    pub n_frames: u32,
    /// Frames a second, from 0.1 to 1000.
    pub fps: f64,
}

/// A film that is being written.
pub struct Apng<W: Write> {
    writer: Writer<W>,
    is_opaque: bool,
}

impl<W: Write> Apng<W> {
    /// Begins a film.
    ///
    /// # Errors
    /// If `out` fails, or the film has no frame or no size.
    pub fn new(options: &ApngOptions, out: W) -> Result<Self, WriteError> {
        let ApngOptions { png, size_px: [width, height], is_opaque, n_frames, fps } = options;
        let mut encoder = encoder(*width, *height, *is_opaque, png, out)?;
        let for_ever = 0;
        encoder.set_animated(*n_frames, for_ever)?;
        let [numerator, denominator] = delay(*fps);
        encoder.set_frame_delay(numerator, denominator)?;
        encoder.validate_sequence(true);
        Ok(Self { writer: encoder.write_header()?, is_opaque: *is_opaque })
    }

    /// Adds the next frame.
    ///
    /// # Errors
    /// If the destination fails, the frame has another size, or the film is full.
    pub fn push(&mut self, frame: &Frame) -> Written {
        Ok(self.writer.write_image_data(&bytes(srgb8(frame), self.is_opaque))?)
    }

    /// Ends the film.
    ///
    /// # Errors
    /// If the destination fails, or frames are missing.
    pub fn finish(self) -> Written {
        Ok(self.writer.finish()?)
    }
}

/// Numerator and denominator of the seconds of a frame, as exact as 16 bits let them be.
fn delay(fps: f64) -> [u16; 2] {
    let fits = |numerator: &u16| fps * f64::from(*numerator) <= f64::from(u16::MAX);
    let numerators = [1, 10, 100, 1000, 10_000];
    let is_whole = |numerator: &u16| (fps * f64::from(*numerator)).fract() == 0.0;
    let exact = numerators.into_iter().filter(fits).find(is_whole);
    let numerator = exact.or(numerators.into_iter().rfind(fits)).unwrap_or(1);
    [numerator, (fps * f64::from(numerator)).round_ties_even() as u16]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::png::to_srgb8;
    use image::{AnimationDecoder as _, codecs::png::PngDecoder};

    #[test]
    fn delays_are_as_exact_as_can_be() {
        assert_eq!(delay(24.0), [1, 24]);
        assert_eq!(delay(29.97), [100, 2997]);
        assert_eq!(delay(0.1), [10, 1]);
        assert_eq!(delay(1000.0), [1, 1000]);
        assert_eq!(delay(1.0 / 3.0), [10_000, 3333]);
    }

    #[test]
    fn frames_are_read_as_they_were_written() {
        for (background, is_opaque) in [([0.0; 4], false), ([0.5, 0.5, 0.5, 1.0], true)] {
            let mut frames = vec![Frame::filled(3, 2, background); 3];
            for (i, frame) in frames.iter_mut().enumerate() {
                frame.rgba[i] = [0.2, 0.1, 0.7, 1.0];
            }
            let png = PngOptions { description: "Würfel".into() };
            let options = ApngOptions { png, size_px: [3, 2], is_opaque, n_frames: 3, fps: 12.5 };
            let mut file = Vec::new();
            let mut film = Apng::new(&options, &mut file).unwrap();
            frames.iter().for_each(|frame| film.push(frame).unwrap());
            film.finish().unwrap();
            let decoder = PngDecoder::new(std::io::Cursor::new(&file)).unwrap();
            let read = decoder.apng().unwrap().into_frames().collect_frames().unwrap();
            assert_eq!(read.len(), 3);
            for (read, written) in read.iter().zip(&frames) {
                assert_eq!(read.delay().numer_denom_ms(), (80, 1));
                assert_eq!(*read.buffer(), to_srgb8(written));
            }
        }
    }

    #[test]
    fn frames_are_counted() {
        let options = ApngOptions {
            png: PngOptions::default(),
            size_px: [1, 1],
            is_opaque: true,
            n_frames: 2,
            fps: 1.0,
        };
        let frame = Frame::filled(1, 1, [1.0; 4]);
        let mut film = Apng::new(&options, Vec::new()).unwrap();
        film.push(&frame).unwrap();
        assert!(film.finish().is_err());
        assert!(Apng::new(&ApngOptions { n_frames: 0, ..options }, Vec::new()).is_err());
    }
}
