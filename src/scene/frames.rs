//! The frames of films and sweeps, each a scene of its own.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{Outputs, Scene, Surface, lower::Lower, spec::SceneSpec, track::Track};
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
        let is_filmed = self.carvings.iter().any(|carving| carving.is_filmed);
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
            Some(animation) => frame.with_carvings(time(number - 1, animation.n_frames)),
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
    /// The scene with sculptures that are filmed as they are at a time from 0 to 1.
    fn with_carvings(mut self, time: f64) -> Self {
        if !self.carvings.iter().any(|carving| carving.is_filmed) {
            return self;
        }
        let (mut models, mut meshes) = (self.models.to_vec(), self.isosurfaces.to_vec());
        let mut felt = self.felt.to_vec();
        let n = self.carvings.len();
        let (n_models, n_meshes) = (models.len(), meshes.len());
        for (i, carving) in self.carvings.iter().enumerate().filter(|(_, it)| it.is_filmed) {
            let carved = carving.at(time);
            models[n_models - n + i] = carved.model;
            meshes[n_meshes - n + i] = carved.mesh;
            felt[i] = carved.felt;
        }
        (self.models, self.isosurfaces) = (models.into(), meshes.into());
        self.felt = felt.into();
        self
    }

    /// Whether nothing else is shown than surfaces of formulas.
    #[must_use]
    pub fn needs_surfaces(&self) -> bool {
        self.isosurfaces.is_empty()
    }

    /// The box around all models, of scenes that have nothing else.
    #[must_use]
    pub fn bounds_of_models(&self) -> Option<Aabb> {
        let all = self.models.iter().flat_map(|model| &model.polygons.positions);
        let bounds = all.fold(None, |bounds: Option<Aabb>, &p| {
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
