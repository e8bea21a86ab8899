//! The evaluation of the HRB-Octree and the IDDG-Octree, remade: space, time, errors of isosurfaces,
//! and ways to interpolate, of models, formulas and scans.
//!
//! [`run`] writes a report in Markdown with tables in CSV, plots and pictures beside it. All but the
//! times is the same from run to run.
//!
//! *Based on:* A. León Salas, 2008, chapters 2 and 3.

mod cells;
mod error;
mod gradient;
mod histogram;
mod pictures;
mod report;
mod sections;
mod slices;
mod space;
mod subject;
mod surface;
mod table;
mod time;

use std::path::PathBuf;

pub use cells::{CellOctree, Counts};
pub use error::{Errors, Summary, Truth};
pub use histogram::{Histogram, N_BINS};
pub use slices::{Difference, Properties};
pub use space::Space;
pub use subject::{Grid, MODEL_NAMES, Subject};
pub use surface::{GRID, Surface};
pub use time::{OfGrid, Times};

use crate::{
    Result,
    hrb::{Criterion, Tolerance},
    progress::Progress,
};
use report::Report;

/// What to measure.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Samples along each axis of formulas, in rising order.
    pub sizes: Vec<u32>,
    /// What tolerances are held against where times and errors are measured; space is measured with
    /// both.
    pub criterion: Criterion,
    /// How often each time is taken.
    pub runs: u32,
    /// Where files are written.
    pub out_dir: PathBuf,
}

impl Settings {
    /// The tolerances of the thesis.
    fn tolerances(&self) -> [Tolerance; 3] {
        let criterion = self.criterion;
        [0.0, 1.0, 2.0].map(|epsilon| Tolerance { epsilon, criterion })
    }
}

/// Evaluates `subjects` and writes what was found; tells the files.
///
/// # Errors
/// [`crate::Error::Limit`] if a grid is too large, [`crate::Error::Interrupted`] if `progress` asks
/// to stop, [`crate::Error::Io`] and [`crate::Error::Encode`] if a file cannot be written.
pub fn run(
    subjects: &[Subject],
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Vec<PathBuf>> {
    let mut report = Report::new(&settings.out_dir);
    let n_grids: usize = subjects.iter().map(|subject| subject.grids(&settings.sizes).len()).sum();
    progress.begin("evaluate", 2 * n_grids as u64 + 2 * subjects.len() as u64, "steps");
    let space = sections::space::write(&mut report, subjects, settings, progress)?;
    let time = sections::time::write(&mut report, subjects, settings, progress)?;
    let error = sections::error::write(&mut report, subjects, settings, progress)?;
    let property = sections::property::write(&mut report, subjects, settings, progress)?;
    let gradient = sections::gradient::write(&mut report, subjects, settings)?;
    progress.end();
    let claims = sections::claims::text(subjects, &space, &error);
    let open = sections::claims::OPEN;
    let parts = [
        &sections::claims::intro(settings),
        &claims,
        &space.text,
        &time,
        &error.text,
        &property,
        &gradient,
        open,
    ];
    report.finish(&parts.map(str::trim_end).join("\n\n"))
}
