//! The frames of films and sweeps, each a scene of its own.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{Origin, Outputs, Scene, Solid, Surface, lower::Lower, spec::SceneSpec, track::Track};
use crate::{
    Error, Result,
    diagnostic::{Diagnostic, Model, Rejection, Sources},
    expr::Expr,
    math::Aabb,
    raster::time,
};

/// The most frames that a scene may have.
pub(super) const MAX_FRAMES: u32 = 10_000;

/// What the surfaces of each frame are made of. Files that the scene names are not read again.
#[derive(Debug)]
pub(super) struct Script {
    pub(super) spec: SceneSpec,
    pub(super) folder: Option<PathBuf>,
    pub(super) tracks: Vec<Track>,
    pub(super) n_included: usize,
    pub(super) graphs: Vec<(Model, Option<Expr>)>,
}

impl Script {
    /// The surfaces in a frame, which counts from 0.
    fn surfaces(
        &self,
        source: &str,
        settings: &[String],
        frame: u32,
    ) -> std::result::Result<Vec<Surface>, Vec<Diagnostic>> {
        let mut lower = Lower::new(source, settings, self.folder.as_deref(), Vec::new());
        lower.tracks.clone_from(&self.tracks);
        lower.n_included = self.n_included;
        lower.graphs.clone_from(&self.graphs);
        let surfaces = lower.surfaces_of_frame(&self.spec, frame);
        if lower.errors.is_empty() { Ok(surfaces) } else { Err(lower.errors) }
    }

    /// What is wrong with the first frame that has mistakes.
    fn mistakes(&self, source: &str, settings: &[String], n_frames: u32) -> Vec<Diagnostic> {
        for frame in 1..n_frames {
            let Err(mistakes) = self.surfaces(source, settings, frame) else { continue };
            let values = self.values(frame);
            let values: Vec<String> =
                values.iter().map(|(name, value)| format!("{name} = {value}")).collect();
            let place = format!("in frame {}, where {}", frame + 1, values.join(", "));
            let placed = |mistake: Diagnostic| Diagnostic {
                message: format!("{place}: {}", mistake.message),
                ..mistake
            };
            return mistakes.into_iter().map(placed).collect();
        }
        Vec::new()
    }

    /// What parameters that change are in a frame, which counts from 0.
    fn values(&self, frame: u32) -> BTreeMap<String, f64> {
        let value = |track: &Track| (track.name.clone(), track.values[frame as usize]);
        self.tracks.iter().map(value).collect()
    }
}

impl Lower<'_> {
    /// Keeps what frames are made of, if parameters change, and notes what is wrong in any frame.
    pub(super) fn script(&mut self, n_frames: u32, spec: SceneSpec) -> Option<Arc<Script>> {
        if self.tracks.is_empty() || !self.errors.is_empty() {
            return None;
        }
        let script = Script {
            spec,
            folder: self.folder.map(Path::to_owned),
            tracks: self.tracks.clone(),
            n_included: self.n_included,
            graphs: self.graphs.clone(),
        };
        self.errors = script.mistakes(self.source, self.settings, n_frames);
        Some(Arc::new(script))
    }
}

impl Scene {
    /// How many frames it has; none if it is a still picture.
    #[must_use]
    pub fn n_frames(&self) -> u32 {
        match (&self.animation, &self.sweep) {
            (Some(animation), _) => animation.n_frames,
            (_, Some(sweep)) => sweep.n_frames() as u32,
            _ => 0,
        }
    }

    /// Whether its surfaces differ from frame to frame.
    #[must_use]
    pub fn changes(&self) -> bool {
        let is_filmed =
            |solid: &Solid| matches!(&solid.origin, Origin::Sculpture(it) if it.is_filmed);
        let is_filmed = self.solids.iter().any(is_filmed);
        self.script.is_some() || (self.animation.is_some() && is_filmed)
    }

    /// What parameters that change are in the frame of this number, from 1.
    #[must_use]
    pub fn params_of_frame(&self, number: u32) -> BTreeMap<String, f64> {
        self.script.as_ref().map(|script| script.values(number - 1)).unwrap_or_default()
    }

    /// The frame of this number, from 1: a still scene, with files of its own. The
    /// camera is left as it is.
    ///
    /// # Errors
    /// [`Error::Scene`] if formulas make no sense with the values that parameters have then, which
    /// loading the scene has found out before.
    pub fn frame(&self, number: u32) -> Result<Self> {
        let frame = Self {
            outputs: self.outputs.of_frame(number, self.n_frames()),
            animation: None,
            sweep: None,
            script: None,
            warnings: Vec::new(),
            ..self.clone()
        };
        let frame = match &self.animation {
            Some(animation) => Self { time: time(number - 1, animation.n_frames), ..frame },
            None => frame,
        };
        let Some(script) = &self.script else { return Ok(frame) };
        let Sources { text, settings, .. } = &self.sources;
        match script.surfaces(text, settings, number - 1) {
            Ok(surfaces) => Ok(Self { surfaces, ..frame }),
            Err(diagnostics) => {
                let sources = self.sources.clone();
                Err(Error::Scene(Box::new(Rejection { sources, diagnostics })))
            }
        }
    }
}

impl Scene {
    /// Whether nothing else is shown than surfaces of formulas.
    #[must_use]
    pub fn needs_surfaces(&self) -> bool {
        self.solids.is_empty()
    }

    /// The box around all models and solids, of scenes that have nothing else.
    #[must_use]
    pub fn bounds_without_surfaces(&self) -> Option<Aabb> {
        let of_models =
            self.models.iter().flat_map(|model| model.polygons.positions.iter().copied());
        let of_solids =
            self.solids.iter().flat_map(|solid| [solid.bounds().min, solid.bounds().max]);
        let bounds = of_models.chain(of_solids).fold(None, |bounds: Option<Aabb>, p| {
            let Aabb { min, max } = bounds.unwrap_or(Aabb { min: p, max: p });
            Some(Aabb { min: min.min(p), max: max.max(p) })
        })?;
        // A flat one still has three sides.
        let margin = 1e-3 * bounds.size().max_element().max(f64::MIN_POSITIVE);
        let margin = glam::DVec3::splat(margin);
        let wide = Aabb { min: bounds.min - margin, max: bounds.max + margin };
        self.surfaces.is_empty().then_some(wide)
    }
}

impl Outputs {
    /// The files of the frame of this number; those of all frames together are none of them.
    #[must_use]
    pub fn of_frame(&self, number: u32, n_frames: u32) -> Self {
        let digits = n_frames.to_string().len().max(4);
        let numbered = |file: &PathBuf| {
            let stem = file.file_stem().unwrap_or_default().to_string_lossy();
            let ending = file.extension().unwrap_or_default().to_string_lossy();
            file.with_file_name(format!("{stem}_{number:0digits$}.{ending}"))
        };
        Self {
            png: self.png.as_ref().map(numbered),
            exr: self.exr.as_ref().map(numbered),
            ply: self.ply.as_ref().map(numbered),
            apng: None,
            sheet: None,
            layers: self.layers,
            forces: self.forces.as_ref().map(numbered),
            meshes: self.meshes.iter().map(|(format, file)| (*format, numbered(file))).collect(),
        }
    }

    /// Whether there is a picture among them.
    #[must_use]
    pub fn has_picture(&self) -> bool {
        [&self.png, &self.exr, &self.apng, &self.sheet].into_iter().any(Option::is_some)
    }

    /// All files.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        let meshes = self.meshes.iter().map(|(_, file)| file);
        let others = [&self.png, &self.exr, &self.ply, &self.apng, &self.sheet, &self.forces];
        others.into_iter().flatten().chain(meshes)
    }
}
