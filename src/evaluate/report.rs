//! The files of a report; each is written as soon as it is known.

use std::{
    io::Write as _,
    path::{Path, PathBuf},
};

use super::table::Table;
use crate::{
    Result,
    output::{
        self,
        plot::{self, Plot},
        png::{self, PngOptions},
    },
    raster::Frame,
};

/// The files so far.
#[derive(Debug)]
pub(super) struct Report {
    out_dir: PathBuf,
    written: Vec<PathBuf>,
}

impl Report {
    pub(super) fn new(out_dir: &Path) -> Self {
        Self { out_dir: out_dir.to_owned(), written: Vec::new() }
    }

    /// Writes a table as NAME.csv.
    pub(super) fn csv(&mut self, name: &str, table: &Table) -> Result<()> {
        let text = table.csv();
        self.write(&format!("{name}.csv"), |out| Ok(out.write_all(text.as_bytes())?))
    }

    /// Writes a plot as NAME.svg; gives the words that show it.
    pub(super) fn plot(&mut self, name: &str, plot: &Plot) -> Result<String> {
        let file = format!("{name}.svg");
        self.write(&file, |out| plot::write(plot, out))?;
        Ok(format!("![{}]({file})", plot.title))
    }

    /// Writes a picture as NAME.png; gives the words that show it.
    pub(super) fn picture(&mut self, name: &str, title: &str, frame: &Frame) -> Result<String> {
        let file = format!("{name}.png");
        let options = PngOptions { description: title.to_owned() };
        self.write(&file, |out| png::write(frame, &options, out))?;
        Ok(format!("![{title}]({file})"))
    }

    /// Writes the report itself; tells all files, the report first.
    pub(super) fn finish(mut self, text: &str) -> Result<Vec<PathBuf>> {
        self.write("report.md", |out| Ok(writeln!(out, "{text}")?))?;
        self.written.rotate_right(1);
        Ok(self.written)
    }

    fn write(
        &mut self,
        file: &str,
        write: impl FnOnce(&mut output::FileWriter) -> output::Written,
    ) -> Result<()> {
        let path = self.out_dir.join(file);
        output::write_file(&path, write)?;
        self.written.push(path);
        Ok(())
    }
}

/// Something that is folded away until it is asked for.
pub(super) fn folded(title: &str, content: &str) -> String {
    format!("<details><summary>{title}</summary>\n\n{content}\n</details>\n\n")
}

/// Pictures side by side under their names.
pub(super) fn side_by_side(names: &[String], pictures: &[String]) -> String {
    let line = |fields: &[String]| format!("| {} |\n", fields.join(" | "));
    format!("{}|{}\n{}\n", line(names), "---|".repeat(names.len()), line(pictures))
}
