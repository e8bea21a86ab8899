//! Contact sheets: small pictures in rows on a white page, each with words below.

use std::io::Write;

use image::RgbaImage;
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use super::{Written, png};
use crate::raster::Frame;

const FONT: RasterHeight = RasterHeight::Size16;

/// Height of a line of words, in pixels.
pub const LINE_PX: usize = FONT.val();

const INK: [u8; 3] = [0x33; 3];

/// How a sheet is divided into cells; sizes are width and height in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Cells in a row.
    pub n_columns: usize,
    /// Rows.
    pub n_rows: usize,
    /// Size of a cell, its words included.
    pub cell_px: [usize; 2],
    /// Size of the pictures, which are in the middle of their cells, at the top.
    pub picture_px: [usize; 2],
}

impl Grid {
    /// The size of the sheet.
    #[must_use]
    pub fn size_px(&self) -> [usize; 2] {
        [self.n_columns * self.cell_px[0], self.n_rows * self.cell_px[1]]
    }
}

/// A white page that is filled picture by picture.
#[derive(Clone, Debug)]
pub struct Sheet {
    grid: Grid,
    /// Red, green and blue of each pixel in sRGB, rows from the top.
    pixels: Vec<u8>,
}

impl Sheet {
    /// An empty sheet.
    #[must_use]
    pub fn new(grid: Grid) -> Self {
        let [width, height] = grid.size_px();
        Self { grid, pixels: vec![u8::MAX; 3 * width * height] }
    }

    /// Fills the cell `[column, row]` with an opaque picture and the lines below it. What is too large for
    /// the cell is cut off.
    ///
    /// # Panics
    /// If there is no such cell.
    pub fn put(&mut self, [column, row]: [usize; 2], picture: &RgbaImage, lines: &[String]) {
        let Grid { n_columns, n_rows, cell_px, picture_px } = self.grid;
        assert!(column < n_columns && row < n_rows, "there is no cell {column}, {row}");
        let corner = [column * cell_px[0], row * cell_px[1]];
        let left = (cell_px[0] - picture_px[0]) / 2;
        for (x, y, pixel) in picture.enumerate_pixels() {
            let [x, y] = [x as usize, y as usize];
            if x < picture_px[0] && y < picture_px[1] {
                let [r, g, b, _] = pixel.0;
                self.pixel([corner[0] + left + x, corner[1] + y]).copy_from_slice(&[r, g, b]);
            }
        }
        for (i, text) in lines.iter().enumerate() {
            self.write_line(text, corner, picture_px[1] + i * LINE_PX);
        }
    }

    /// Writes it as PNG, as small as it gets.
    ///
    /// # Errors
    /// If `out` fails, or there is no cell.
    pub fn write(&self, options: &png::PngOptions, out: impl Write) -> Written {
        let size = self.grid.size_px().map(|n| n as u32);
        png::write_rgb8(size, &self.pixels, options, out)
    }

    fn pixel(&mut self, [x, y]: [usize; 2]) -> &mut [u8] {
        let width = self.grid.n_columns * self.grid.cell_px[0];
        &mut self.pixels[3 * (y * width + x)..][..3]
    }

    /// A line in the middle of the cell at `corner`, `top` pixels below that.
    fn write_line(&mut self, text: &str, corner: [usize; 2], top: usize) {
        let [cell_width, cell_height] = self.grid.cell_px;
        let glyphs: Vec<_> =
            text.chars().filter_map(|c| get_raster(c, FontWeight::Regular, FONT)).collect();
        let width: usize = glyphs.iter().map(|glyph| glyph.width()).sum();
        let mut left = cell_width.saturating_sub(width) / 2;
        for glyph in glyphs {
            for (y, row) in (top..cell_height).zip(glyph.rows()) {
                for (x, &cover) in (left..cell_width).zip(row.iter()) {
                    self.ink([corner[0] + x, corner[1] + y], cover);
                }
            }
            left += glyph.width();
        }
    }

    fn ink(&mut self, place: [usize; 2], cover: u8) {
        let cover = u32::from(cover);
        for (channel, ink) in self.pixel(place).iter_mut().zip(INK) {
            let mixed = u32::from(*channel) * (255 - cover) + u32::from(ink) * cover;
            *channel = (mixed / 255) as u8;
        }
    }
}

/// How many characters fit into a width in pixels.
#[must_use]
pub fn characters(width_px: usize) -> usize {
    width_px / get_raster_width(FontWeight::Regular, FONT)
}

/// The width of so many characters, in pixels.
#[must_use]
pub fn width_px(n_characters: usize) -> usize {
    n_characters * get_raster_width(FontWeight::Regular, FONT)
}

/// Whether all characters can be written; others are left out.
#[must_use]
pub fn can_write(text: &str) -> bool {
    text.chars().all(|c| get_raster(c, FontWeight::Regular, FONT).is_some())
}

/// Words in lines of at most so many characters, with `between` between two words of a line. A word that
/// is longer is cut off.
pub fn lines<'a>(
    words: impl IntoIterator<Item = &'a str>,
    between: &str,
    n_characters: usize,
) -> Vec<String> {
    let length = |text: &str| text.chars().count();
    let mut lines: Vec<String> = Vec::new();
    for word in words {
        match lines.last_mut() {
            Some(line) if length(line) + length(between) + length(word) <= n_characters => {
                *line += between;
                *line += word;
            }
            _ => lines.push(word.chars().take(n_characters).collect()),
        }
    }
    lines
}

/// The picture on white, smaller by a whole factor: each pixel is the mean of `factor` × `factor`, of fewer
/// at the right and lower borders.
///
/// # Panics
/// If `factor` is 0.
#[must_use]
pub fn reduced(frame: &Frame, factor: usize) -> RgbaImage {
    let [width, height] = [frame.width, frame.height].map(|n| n as usize);
    let mut small = Frame::filled(
        width.div_ceil(factor) as u32,
        height.div_ceil(factor) as u32,
        [0.0, 0.0, 0.0, 1.0],
    );
    let small_width = width.div_ceil(factor);
    for (i, pixel) in small.rgba.iter_mut().enumerate() {
        let [left, top] = [i % small_width * factor, i / small_width * factor];
        let [right, bottom] = [(left + factor).min(width), (top + factor).min(height)];
        let rows = (top..bottom).map(|y| &frame.rgba[y * width + left..y * width + right]);
        let mut sum = [0.0; 3];
        for [r, g, b, alpha] in rows.flatten() {
            let on_white = |channel: f32| channel + (1.0 - alpha);
            [r, g, b].into_iter().zip(&mut sum).for_each(|(&c, sum)| *sum += on_white(c));
        }
        let n = ((right - left) * (bottom - top)) as f32;
        *pixel = [sum[0] / n, sum[1] / n, sum[2] / n, 1.0];
    }
    png::to_srgb8(&small)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: [u8; 3] = [255; 3];

    fn at(sheet: &Sheet, x: usize, y: usize) -> [u8; 3] {
        let place = 3 * (y * sheet.grid.size_px()[0] + x);
        sheet.pixels[place..place + 3].try_into().unwrap()
    }

    #[test]
    fn pictures_and_words_stay_in_their_cells() {
        let grid = Grid { n_columns: 3, n_rows: 2, cell_px: [40, 48], picture_px: [30, 20] };
        let mut sheet = Sheet::new(grid);
        // Larger than the cell, and words as well.
        let picture = RgbaImage::from_pixel(90, 90, image::Rgba([1, 2, 3, 255]));
        let long = ["quite a long line".to_owned(), "b".to_owned(), "c".to_owned()];
        sheet.put([1, 0], &picture, &long);
        let [width, height] = grid.size_px();
        assert_eq!([width, height], [120, 96]);
        let mut n_picture = 0;
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let is_inside = (40..80).contains(&x) && y < 48;
            let is_picture = at(&sheet, x, y) == [1, 2, 3];
            assert_eq!(is_picture, (45..75).contains(&x) && y < 20, "{x}, {y}");
            assert!(is_inside || at(&sheet, x, y) == WHITE, "{x}, {y}");
            n_picture += usize::from(is_picture);
        }
        assert_eq!(n_picture, 30 * 20);
        let has_ink = |rows: std::ops::Range<usize>| {
            rows.into_iter().any(|y| (40..80).any(|x| at(&sheet, x, y)[0] < 128))
        };
        assert!(has_ink(20..36) && has_ink(36..48), "a line, and what fits of the second");
    }

    #[test]
    fn words_are_joined_while_they_fit() {
        let words = ["a = 1", "b = 22", "c = 3", "much too long"];
        assert_eq!(lines(words, ", ", 13), ["a = 1, b = 22", "c = 3", "much too long"]);
        assert_eq!(lines(words, ", ", 12), ["a = 1", "b = 22", "c = 3", "much too lon"]);
        assert_eq!(lines([], ", ", 12), [""; 0]);
    }

    /// As mean light, and what is transparent is white.
    #[test]
    fn pictures_are_reduced_by_means() {
        let mut frame = Frame::filled(3, 2, [0.0; 4]);
        for (i, value) in [0.0, 0.25, 1.0, 0.5, 0.25, 0.5].into_iter().enumerate() {
            frame.rgba[i] = [value, 0.0, 0.0, 1.0];
        }
        frame.rgba[2] = [0.0; 4];
        let code = |linear: f32| png::srgb_code(linear);
        let small = reduced(&frame, 2);
        assert_eq!(small.dimensions(), (2, 1));
        assert_eq!(small.get_pixel(0, 0).0, [code(0.25), 0, 0, 255]);
        assert_eq!(small.get_pixel(1, 0).0, [code(0.75), code(0.5), code(0.5), 255]);
        assert_eq!(reduced(&frame, 1).get_pixel(2, 0).0, [255; 4]);
    }
}
