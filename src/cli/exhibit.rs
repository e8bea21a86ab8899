//! The gallery: its list, its page, its contact sheet.

use std::{fmt::Write as _, path::Path, time::Instant};

use super::{args::Exhibition, progress::Watch, report};
use crate::{
    Result,
    gallery::{self, ENTRIES, Entry},
};

/// A line for each surface: its name, and what it is.
pub(super) fn list() -> String {
    let width = ENTRIES.iter().map(|entry| entry.name().len()).max().unwrap_or(0);
    let mut text = String::new();
    for entry in ENTRIES {
        let about = entry.scene(&[]).map(|scene| scene.about).unwrap_or_default();
        let words = |words: Option<String>| words.unwrap_or_default();
        let (title, note) = (words(about.title), words(about.note));
        // Text that is in memory can always grow.
        let _ = writeln!(text, "{:width$}  {title}. {note}", entry.name());
    }
    text
}

/// Writes what is asked for; gives the exit code.
pub(super) fn exhibit(exhibition: &Exhibition) -> u8 {
    let watch = Watch::new(!exhibition.quiet && report::is_terminal());
    let made = write(exhibition, &watch);
    watch.clear();
    made.map_or_else(
        |error| {
            report::failure(Path::new("gallery"), &error);
            error.exit_code()
        },
        |()| 0,
    )
}

fn write(exhibition: &Exhibition, watch: &Watch) -> Result<()> {
    let Exhibition { names, page, sheet, options, quiet } = exhibition;
    let entries: Vec<&Entry> = match names.as_slice() {
        [] => ENTRIES.iter().collect(),
        names => names.iter().map(|name| gallery::find(name)).collect::<Result<_>>()?,
    };
    let summary = |written: &str, start: Instant| {
        watch.clear();
        if !quiet {
            report::summary(Path::new("gallery"), written, start.elapsed());
        }
    };
    if let Some(path) = sheet {
        let start = Instant::now();
        gallery::write_sheet(&entries, path, options, watch)?;
        summary(&path.display().to_string(), start);
    }
    if let Some(folder) = page {
        let start = Instant::now();
        let written = gallery::write_page(&entries, folder, options, watch)?;
        let index = folder.join("index.html");
        let words = format!(
            "{} with {} surfaces and {} models",
            index.display(),
            written.n_surfaces,
            written.n_models
        );
        summary(&words, start);
    }
    Ok(())
}
