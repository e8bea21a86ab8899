//! Files that lie beside the scene.

use std::path::PathBuf;

use super::{lower::Lower, spanned::Spanned};
use crate::diagnostic::Diagnostic;

impl Lower<'_> {
    /// Where the file is that a scene names, if the scene has a folder.
    pub(super) fn beside(&self, file: &Spanned<String>) -> Result<PathBuf, Diagnostic> {
        let folder = self.folder.ok_or_else(|| {
            Diagnostic::new(file.span(), "a scene without a folder names a file")
                .label("relative to which folder?")
                .help("read the scene from a file, or say in which folder its files are")
        })?;
        Ok(folder.join(file.get_ref()))
    }
}
