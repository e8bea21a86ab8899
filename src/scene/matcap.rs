//! Matcaps: pictures that lie beside the scene.

use std::{path::Path, sync::Arc};

use image::{ImageReader, Limits};

use super::{lower::Lower, spanned::Spanned};
use crate::{diagnostic::Diagnostic, math::linear_from_srgb, raster::Matcap};

/// Pixels along an edge, at most.
const MAX_SIDE: u32 = 4096;

impl Lower<'_> {
    /// The picture of a ball that a file holds.
    pub(super) fn matcap(&mut self, file: &Spanned<String>) -> Option<Arc<Matcap>> {
        let path = self.beside(file).map_err(|mistake| self.errors.push(mistake)).ok()?;
        let refused = |why: String| {
            let message = format!("cannot use {}: {why}", file.get_ref());
            self.errors.push(Diagnostic::new(file.span(), message).help(
                "a matcap is a square PNG picture of a ball, relative to the scene's folder",
            ));
        };
        read(&path).map_err(refused).ok().map(Arc::new)
    }
}

fn read(path: &Path) -> Result<Matcap, String> {
    let words = |error: &dyn std::fmt::Display| error.to_string();
    let mut reader = ImageReader::open(path).map_err(|error| words(&error))?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    reader.limits(limits);
    let picture = reader.with_guessed_format().map_err(|error| words(&error))?;
    let picture = picture.decode().map_err(|error| words(&error))?.into_rgb8();
    let (width, height) = picture.dimensions();
    let light: Vec<f32> =
        (0..=u8::MAX).map(|c| linear_from_srgb(f64::from(c) / 255.0) as f32).collect();
    let pixels = picture.pixels().map(|pixel| pixel.0.map(|c| light[usize::from(c)])).collect();
    (width == height)
        .then(|| Matcap::new(width as usize, pixels))
        .flatten()
        .ok_or_else(|| format!("it is not square: {width} by {height} pixels"))
}
