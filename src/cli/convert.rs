//! `render convert`: a file of another program as a scene.

use std::{io::Write as _, path::PathBuf};

use super::report;
use crate::{
    Result,
    import::{self, Options},
    output,
};

/// What to convert.
#[derive(Debug)]
pub(super) struct Conversion {
    pub(super) file: PathBuf,
    /// With the scene to write; standard output if there is none.
    pub(super) options: Options,
    pub(super) quiet: bool,
}

/// Writes the scene; gives the exit code.
pub(super) fn convert(conversion: &Conversion) -> u8 {
    write(conversion).map_or_else(
        |error| {
            report::failure(&conversion.file, &error);
            error.exit_code()
        },
        |()| 0,
    )
}

fn write(conversion: &Conversion) -> Result<()> {
    let converted = import::convert_with(&conversion.file, &conversion.options)?;
    let text = converted.scene.as_bytes();
    match &conversion.options.scene {
        Some(path) => output::write_file(path, |out| Ok(out.write_all(text)?))?,
        None => report::to_stdout(text)?,
    }
    if !conversion.quiet {
        report::notes(&conversion.file, &converted.notes);
    }
    Ok(())
}
