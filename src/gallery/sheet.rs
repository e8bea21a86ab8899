//! The gallery's contact sheet: a small picture of each surface in one PNG file, with its title below.
//!
//! Colours are rounded to steps that hardly anybody sees: that halves the file.

use std::path::Path;

use super::Entry;
use crate::{
    Result,
    output::{
        self, png,
        sheet::{Grid, LINE_PX, Sheet, characters, lines},
    },
    pipeline::{self, Options},
    progress::Progress,
};

/// Width and height of a picture.
const CELL: usize = 120;

/// Titles may need so many lines.
const N_LINES: usize = 2;

/// Columns for each row.
const ASPECT: f64 = 1.2;

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
    let mut sheet = Sheet::new(Grid {
        n_columns,
        n_rows: entries.len().div_ceil(n_columns),
        cell_px: [CELL, CELL + N_LINES * LINE_PX],
        picture_px: [CELL; 2],
    });
    for (i, entry) in entries.iter().enumerate() {
        let mut scene = entry.scene(&[])?;
        scene.image.width = CELL as u32;
        scene.image.height = CELL as u32;
        scene.image.background = Some([1.0; 3]);
        scene.image.samples = SAMPLES;
        let frame = pipeline::render(&scene, options, progress)?.frame;
        let mut picture = png::to_srgb8(&frame);
        picture.iter_mut().for_each(|channel| *channel = *channel / STEP * STEP);
        let title = scene.about.title.unwrap_or(scene.name);
        sheet.put([i % n_columns, i / n_columns], &picture, &lines_of(&title));
    }
    let about = png::PngOptions { description: "zeroset's gallery".to_owned() };
    output::write_file(path, |out| sheet.write(&about, out))
}

/// A title in lines that fit, at most [`N_LINES`].
fn lines_of(title: &str) -> Vec<String> {
    let mut lines = lines(title.split(' '), " ", characters(CELL));
    lines.truncate(N_LINES);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{gallery::ENTRIES, output::sheet::can_write};

    #[test]
    fn every_title_can_be_written() {
        for entry in ENTRIES {
            let title = entry.scene(&[]).unwrap().about.title.unwrap();
            assert_eq!(lines_of(&title).join(" "), title);
            assert!(can_write(&title), "{title}");
        }
    }
}
