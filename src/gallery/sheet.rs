//! The contact sheet: a small picture of each surface in one PNG file, with its title below.
//!
//! Colours are rounded to steps that hardly anybody sees: that halves the file.

use std::path::Path;

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use super::Entry;
use crate::{
    Result,
    output::{self, png},
    pipeline::{self, Options},
    progress::Progress,
};

/// Width and height of a picture.
const CELL: usize = 120;

const LINE: RasterHeight = RasterHeight::Size16;

/// Titles may need so many lines.
const N_LINES: usize = 2;

const CELL_HEIGHT: usize = CELL + N_LINES * LINE as usize;

/// Columns for each row.
const ASPECT: f64 = 1.2;

const INK: [u8; 3] = [0x33; 3];

/// Steps of a channel; 255 is a multiple.
const STEP: u8 = 5;

/// Samples along an edge of a pixel.
const SAMPLES: u32 = 3;

/// Draws all `entries` and writes them to the PNG file `path`.
///
/// # Errors
/// As [`pipeline::run`].
pub fn write_sheet(
    entries: &[&Entry],
    path: &Path,
    options: &Options,
    progress: &dyn Progress,
) -> Result<()> {
    let n_columns = ((entries.len() as f64 * ASPECT).sqrt().ceil() as usize).max(1);
    let mut sheet = Sheet::new(n_columns, entries.len().div_ceil(n_columns));
    for (i, entry) in entries.iter().enumerate() {
        let mut scene = entry.scene(&[])?;
        scene.image.width = CELL as u32;
        scene.image.height = CELL as u32;
        scene.image.background = Some([1.0; 3]);
        scene.image.samples = SAMPLES;
        let picture = pipeline::render(&scene, options, progress)?;
        let corner = [i % n_columns * CELL, i / n_columns * CELL_HEIGHT];
        sheet.paste(&png::to_srgb8(&picture.frame), corner);
        let title = scene.about.title.unwrap_or(scene.name);
        for (line, text) in lines(&title).enumerate() {
            sheet.write(&text, [corner[0], corner[1] + CELL + line * LINE.val()]);
        }
    }
    let size = [sheet.width, sheet.height].map(|n| n as u32);
    let about = png::PngOptions { description: "zeroset's gallery".to_owned() };
    output::write_file(path, |out| png::write_rgb8(size, &sheet.pixels, &about, out))
}

/// A white page.
struct Sheet {
    width: usize,
    height: usize,
    /// Red, green and blue of each pixel in sRGB.
    pixels: Vec<u8>,
}

impl Sheet {
    fn new(n_columns: usize, n_rows: usize) -> Self {
        let (width, height) = (n_columns * CELL, n_rows * CELL_HEIGHT);
        Self { width, height, pixels: vec![u8::MAX; 3 * width * height] }
    }

    fn pixel(&mut self, x: usize, y: usize) -> &mut [u8] {
        &mut self.pixels[3 * (y * self.width + x)..][..3]
    }

    fn paste(&mut self, picture: &image::RgbaImage, [left, top]: [usize; 2]) {
        for (x, y, pixel) in picture.enumerate_pixels() {
            let rounded = pixel.0.map(|channel| (channel / STEP) * STEP);
            self.pixel(left + x as usize, top + y as usize).copy_from_slice(&rounded[..3]);
        }
    }

    /// A line of text in the middle of a cell.
    fn write(&mut self, text: &str, [left, top]: [usize; 2]) {
        let glyphs: Vec<_> =
            text.chars().filter_map(|c| get_raster(c, FontWeight::Regular, LINE)).collect();
        let width: usize = glyphs.iter().map(|glyph| glyph.width()).sum();
        let mut x = left + CELL.saturating_sub(width) / 2;
        for glyph in glyphs {
            for (y, row) in glyph.rows().enumerate() {
                for (dx, &cover) in row.iter().enumerate() {
                    self.ink([x + dx, top + y], cover);
                }
            }
            x += glyph.width();
        }
    }

    fn ink(&mut self, [x, y]: [usize; 2], cover: u8) {
        let cover = u32::from(cover);
        for (channel, ink) in self.pixel(x, y).iter_mut().zip(INK) {
            let mixed = u32::from(*channel) * (255 - cover) + u32::from(ink) * cover;
            *channel = (mixed / 255) as u8;
        }
    }
}

/// A title in lines that fit, at most [`N_LINES`].
fn lines(title: &str) -> impl Iterator<Item = String> {
    let fits = CELL / get_raster_width(FontWeight::Regular, LINE);
    let mut lines: Vec<String> = Vec::new();
    for word in title.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= fits => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.chars().take(fits).collect()),
        }
    }
    lines.into_iter().take(N_LINES)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gallery::ENTRIES;

    #[test]
    fn every_title_can_be_written() {
        for entry in ENTRIES {
            let title = entry.scene(&[]).unwrap().about.title.unwrap();
            assert_eq!(lines(&title).collect::<Vec<_>>().join(" "), title);
            for c in title.chars() {
                assert!(get_raster(c, FontWeight::Regular, LINE).is_some(), "{c:?} of {title}");
            }
        }
    }
}
