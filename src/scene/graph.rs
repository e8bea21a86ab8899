//! Surfaces from files: function graphs that lie beside the scene.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use super::{lower::Lower, spanned::Spanned};
use crate::{
    diagnostic::{Diagnostic, Model, Origin},
    expr::Expr,
    files,
};

/// The most that the files of a scene hold, all together.
const MAX_BYTES: u64 = 16 << 20;

impl Lower<'_> {
    /// F as the file says that a surface names.
    pub(super) fn graph(&mut self, file: &Spanned<String>) -> Option<Expr> {
        let path = self.path(file).map_err(|mistake| self.errors.push(mistake)).ok()?;
        // A file that several surfaces name is read once, and its mistakes are noted once.
        if let Some((_, expr)) = self.graphs.iter().find(|(model, _)| model.path == path) {
            return expr.clone();
        }
        let bytes = self.read(file, &path).map_err(|mistake| self.errors.push(mistake)).ok()?;
        let (text, mistake) = files::decode(bytes);
        let expr = mistake.map_or_else(|| Expr::from_vm(&text), |mistake| Err(vec![mistake]));
        let origin = Origin::Model(self.n_included + self.graphs.len());
        let note = |mistakes: Vec<Diagnostic>| {
            let placed = mistakes.into_iter().map(|mistake| Diagnostic { origin, ..mistake });
            self.errors.extend(placed);
        };
        let expr = expr.map_err(note).ok();
        self.graphs.push((Model { path, text }, expr.clone()));
        expr
    }

    /// Where the file is, if it may be one.
    fn path(&self, file: &Spanned<String>) -> Result<PathBuf, Diagnostic> {
        let name = Path::new(file.get_ref());
        // Other formats may come, and a scene from a stranger shall not quote any file.
        if name.extension().is_none_or(|ending| ending != "vm") {
            return Err(Diagnostic::new(file.span(), "the name must end in `.vm`")
                .label("not a function graph")
                .help("what can be read are function graphs in the text format of Fidget"));
        }
        self.beside(file)
    }

    /// The bytes of a file, or why there are none.
    fn read(&self, file: &Spanned<String>, path: &Path) -> Result<Vec<u8>, Diagnostic> {
        let mistake = |why: &str| {
            Diagnostic::new(file.span(), format!("cannot read {}: {why}", path.display()))
        };
        let failed = |error: io::Error| match error.kind() {
            io::ErrorKind::NotFound => mistake("there is no such file")
                .help("the name is relative to the folder of the scene"),
            _ => mistake(&error.to_string()),
        };
        // A pipe would be waited for.
        if !fs::metadata(path).map_err(failed)?.is_file() {
            return Err(mistake("it is not a file"));
        }
        let held: u64 = self.graphs.iter().map(|(model, _)| model.text.len() as u64).sum();
        let bytes = files::read(path, MAX_BYTES.saturating_sub(held)).map_err(failed)?;
        bytes.ok_or_else(|| {
            let limit = MAX_BYTES >> 20;
            mistake("it is too large")
                .help(format!("the files of a scene hold {limit} MiB at most, all together"))
        })
    }
}
