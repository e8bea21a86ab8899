//! The one file that holds all frames: a film as an animated PNG, a sweep as a contact sheet.

use std::path::{Path, PathBuf};

use super::Film;
use crate::{
    Result,
    limits::Memory,
    output::{
        self, FileWriter, NewFile,
        apng::{Apng, ApngOptions},
        png::PngOptions,
        sheet::{self, Grid, Sheet},
    },
    raster::Frame,
    scene::Sweep,
};

/// A film that is written frame by frame, and its file, which has no name yet.
pub(super) struct Animated<'a> {
    path: &'a Path,
    apng: Apng<&'a mut FileWriter>,
}

impl<'a> Animated<'a> {
    /// Begins the film.
    pub(super) fn new(film: &Film<'_>, path: &'a Path, file: &'a mut NewFile) -> Result<Self> {
        let image = &film.scene.image;
        let options = ApngOptions {
            png: PngOptions { description: film.scene.name.clone() },
            size_px: [image.width, image.height],
            is_opaque: image.background.is_some(),
            n_frames: film.numbers.end() - film.numbers.start() + 1,
            fps: film.scene.animation.as_ref().map_or(1.0, |animation| animation.fps),
        };
        let apng = Apng::new(&options, file.writer());
        let apng = apng.map_err(|error| output::failed_to_write(path, error))?;
        Ok(Self { path, apng })
    }

    pub(super) fn push(&mut self, frame: &Frame) -> Result<()> {
        self.apng.push(frame).map_err(|error| output::failed_to_write(self.path, error))
    }

    pub(super) fn finish(self) -> Result<()> {
        self.apng.finish().map_err(|error| output::failed_to_write(self.path, error))
    }
}

/// The contact sheet of a sweep, without the rows of which no frame is drawn.
pub(super) struct ContactSheet<'a> {
    path: PathBuf,
    scene: &'a str,
    sweep: &'a Sweep,
    sheet: Sheet,
    grid: Grid,
    /// By which pictures are smaller than frames.
    factor: usize,
    first_row: usize,
}

impl<'a> ContactSheet<'a> {
    /// The empty sheet of a sweep, if there is memory for it.
    pub(super) fn new(film: &'a Film<'_>, sweep: &'a Sweep, path: PathBuf) -> Result<Self> {
        let (mut grid, factor) = sweep.sheet(&film.scene.image);
        let row = |number: u32| (number as usize - 1) / grid.n_columns;
        let (first_row, last_row) = (row(*film.numbers.start()), row(*film.numbers.end()));
        grid.n_rows = last_row - first_row + 1;
        Memory::new(film.options.max_memory).check_sheet(grid.size_px(), &film.scene.image)?;
        let (scene, sheet) = (film.scene.name.as_str(), Sheet::new(grid));
        Ok(Self { path, scene, sweep, sheet, grid, factor, first_row })
    }

    pub(super) fn push(&mut self, number: u32, frame: &Frame) {
        let i = number as usize - 1;
        let n_columns = self.grid.n_columns;
        let place = [i % n_columns, i / n_columns - self.first_row];
        let lines = self.sweep.lines(number, &self.grid);
        self.sheet.put(place, &sheet::reduced(frame, self.factor), &lines);
    }

    /// Writes the file, and tells where.
    pub(super) fn finish(self) -> Result<PathBuf> {
        let options = PngOptions { description: self.scene.to_owned() };
        output::write_file(&self.path, |out| self.sheet.write(&options, out))?;
        Ok(self.path)
    }
}
