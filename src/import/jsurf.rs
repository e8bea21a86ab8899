//! Surfer's `.jsurf` files: an algebraic surface in a ball, as IMAGINARY's Surfer and jsurf show it.

use std::fmt::Write as _;

use super::{Converted, Source, header, properties, quoted};
use crate::diagnostic::Diagnostic;

/// The scene of such a file.
pub(super) fn import(source: &Source<'_>) -> Result<Converted, Vec<Diagnostic>> {
    let properties = properties::read(source.text).map_err(|mistake| vec![mistake])?;
    let Some(equation) = properties.iter().find(|p| p.key == "surface_equation") else {
        return Err(vec![
            Diagnostic::new(0..0, "the file has no `surface_equation`")
                .help("a Surfer file has lines such as surface_equation=x^2+y^2+z^2-1"),
        ]);
    };
    let mut scene = header(source);
    // Text that is in memory can always grow.
    let _ = writeln!(scene, "\n[[surface]]\nf = {}", quoted(&equation.value));
    Ok(Converted { scene, notes: Vec::new() })
}
