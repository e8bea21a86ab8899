//! From a [`SceneSpec`] to a [`Scene`]: defaults, ranges, relations between keys.
//!
//! Every mistake is noted and a harmless value put in its place, so that one run finds them all;
//! the scene is only handed out if there were none.

use std::{
    collections::HashSet,
    ops::{Range, RangeInclusive},
    path::Path,
};

use glam::DVec3;

use super::{
    About, Scene, Surface,
    color::linear,
    formula::Formula,
    leaf::{Background, Color, Detail, Number, Numbers, Target, Whole},
    spanned::Spanned,
    spec::{
        AboutSpec, DomainSpec, ImageSpec, SceneSpec, ScheduleSpec, Section, ShadeSpec, StorageSpec,
        VoxelsSpec,
    },
    track::Track,
};
use crate::{
    diagnostic::{Diagnostic, Model, Sources},
    expr::{Definition, Expr},
    math::Aabb,
    octree::StorageKind,
    raster::{ImageSettings, Shade},
    voxelize::Schedule,
};

/// The largest `resolution`, in voxels along the longest axis.
pub const MAX_RESOLUTION: u32 = 16_384;

/// The largest width and height of a picture, in pixels.
const MAX_IMAGE_SIZE: i64 = 16_384;

/// Coordinates beyond this leave no room for powers of them in the range of `f32`.
const MAX_COORDINATE: f64 = 1e12;

const DEFAULT_RESOLUTION: u32 = 512;
/// Samples along an edge of a pixel.
const DEFAULT_SAMPLES: u32 = 2;

const DEFAULT_IMAGE_SIZE: i64 = 1024;
const DEFAULT_BACKGROUND: Background = Background::Color(Color([1.0; 3]));

/// Notes mistakes while the parts of a scene are made.
pub(super) struct Lower<'a> {
    /// The text of the file.
    pub(super) source: &'a str,
    /// What was set for this run, as `name=value`.
    pub(super) settings: &'a [String],
    /// Where the files are that surfaces name.
    pub(super) folder: Option<&'a Path>,
    /// Bytes of memory that a volume may take; what is usual where `None`.
    pub(super) max_memory: Option<u64>,
    pub(super) errors: Vec<Diagnostic>,
    /// What is perhaps not meant.
    pub(super) warnings: Vec<Diagnostic>,
    /// The names that all formulas share, in the order of the file.
    pub(super) definitions: Vec<Definition>,
    /// The formulas of the definitions.
    pub(super) formulas: Vec<Formula>,
    /// Mistakes of definitions that were noted: index, place, message.
    pub(super) noted: HashSet<(usize, usize, String)>,
    /// How many files were included; their texts come before those of `graphs`.
    pub(super) n_included: usize,
    /// The files that were read, with what they mean, unless something is wrong with them.
    pub(super) graphs: Vec<(Model, Option<Expr>)>,
    /// Whether a picture stands for all light.
    pub(super) has_matcap: bool,
    /// The parameters that change from frame to frame.
    pub(super) tracks: Vec<Track>,
}

fn about(spec: &AboutSpec) -> About {
    let AboutSpec { title, source, note } = spec.clone();
    About { title, source, note }
}

impl<'a> Lower<'a> {
    /// Goes on after the mistakes that were found while the file was read.
    pub(super) fn new(
        source: &'a str,
        settings: &'a [String],
        folder: Option<&'a Path>,
        errors: Vec<Diagnostic>,
    ) -> Self {
        Self {
            source,
            settings,
            folder,
            max_memory: None,
            errors,
            warnings: Vec::new(),
            definitions: Vec::new(),
            formulas: Vec::new(),
            noted: HashSet::new(),
            n_included: 0,
            graphs: Vec::new(),
            has_matcap: false,
            tracks: Vec::new(),
        }
    }

    /// The scene called `name`; worth something only if no errors were noted.
    pub(super) fn scene(&mut self, name: &str, spec: &SceneSpec) -> Scene {
        let sweep = self.sweep(spec);
        self.tracks = match &sweep {
            Some(sweep) => sweep.tracks(),
            None => self.tracks_of_film(spec),
        };
        let surfaces = self.surfaces_of_frame(spec, 0);
        let (view, animation) = self.animation(spec);
        let models = self.models(&spec.models, spec.surfaces.len());
        let n_before = spec.surfaces.len() + spec.models.len();
        let volumes = self.volumes(&spec.volumes, n_before);
        let sculptures = self.sculptures(&spec.sculptures, n_before + spec.volumes.len());
        let (image, outputs) = (self.image(spec), self.outputs(name, spec));
        if let Some(sweep) = sweep.as_ref().filter(|_| outputs.sheet.is_some()) {
            self.check_sheet(sweep, &image, spec);
        }
        Scene {
            name: name.to_owned(),
            about: about(&spec.about.spec),
            surfaces,
            models: models.into(),
            solids: volumes.into_iter().chain(sculptures).collect(),
            time: 1.0,
            domain: self.domain(&spec.domain),
            resolution: self.resolution(&spec.voxels.spec),
            is_auto: is_auto(&spec.voxels.spec),
            visible_only: self.visible_only(&spec.voxels.spec),
            certify: spec.voxels.spec.certify.unwrap_or(true),
            storage: storage(&spec.voxels.spec),
            schedule: schedule(&spec.voxels.spec),
            view,
            image,
            outputs,
            mesh: self.mesh(spec),
            animation,
            sweep,
            script: None,
            sources: Sources::default(),
            warnings: Vec::new(),
        }
    }

    /// The surfaces in a frame, which counts from 0.
    pub(super) fn surfaces_of_frame(&mut self, spec: &SceneSpec, frame: u32) -> Vec<Surface> {
        self.has_matcap = spec.image.spec.matcap.is_some();
        self.define(&spec.params, &spec.lets, &spec.shapes, frame);
        let clip = self.clip(&spec.domain);
        self.surfaces(&spec.surfaces, &clip)
    }

    /// The box to search, if the file has one.
    fn domain(&mut self, section: &Section<DomainSpec>) -> Option<Aabb> {
        let min = section.spec.min.as_ref().map(|min| self.coordinates("min", min));
        let max = section.spec.max.as_ref().map(|max| self.coordinates("max", max));
        let (min, max, at) = match (min, max, &section.spec.max) {
            (Some(min), Some(max), Some(at)) => (min, max, at),
            (None, None, _) => return None,
            _ if section.is_damaged => return None,
            (min, ..) => {
                self.one_corner(
                    section,
                    if min.is_some() { ["min", "max"] } else { ["max", "min"] },
                );
                return None;
            }
        };
        for (axis, (min, max)) in ['x', 'y', 'z'].into_iter().zip(min.into_iter().zip(max)) {
            if min >= max {
                let message =
                    format!("the domain is empty along {axis}: min is {min}, max is {max}");
                self.errors.push(
                    Diagnostic::new(at.span(), message)
                        .help("every number of `min` must be below its partner in `max`"),
                );
            }
        }
        Some(Aabb { min: min.into(), max: max.into() })
    }

    fn one_corner(&mut self, section: &Section<DomainSpec>, [given, missing]: [&str; 2]) {
        let corners = section.spec.min.as_ref().or(section.spec.max.as_ref());
        self.errors.push(
            Diagnostic::new(
                corners.map_or(section.span.clone(), Spanned::span),
                format!("`{given}` stands without `{missing}`"),
            )
            .help(format!("add `{missing}`, or remove `{given}`: then a box is found")),
        );
    }

    pub(super) fn coordinates(&mut self, key: &str, value: &Spanned<Numbers<3>>) -> [f64; 3] {
        if value.get_ref().0.iter().any(|c| c.abs() > MAX_COORDINATE) {
            self.errors.push(
                Diagnostic::new(value.span(), format!("`{key}` is too far out"))
                    .label(format!("beyond {MAX_COORDINATE:e}"))
                    .help("choose a larger unit of length"),
            );
        }
        value.get_ref().0
    }

    fn resolution(&mut self, spec: &VoxelsSpec) -> u32 {
        let Some(resolution) = &spec.resolution else { return DEFAULT_RESOLUTION };
        let Detail::Voxels(n) = *resolution.get_ref() else { return DEFAULT_RESOLUTION };
        if !(1..=i64::from(MAX_RESOLUTION)).contains(&n) {
            let allowed = format!("from 1 to {MAX_RESOLUTION}, or \"auto\"");
            self.out_of_range(resolution.span(), "resolution", allowed);
        }
        n.clamp(1, i64::from(MAX_RESOLUTION)) as u32
    }

    /// Whether only visible voxels are found, if the file says so, or must be.
    fn visible_only(&mut self, spec: &VoxelsSpec) -> Option<bool> {
        let visible_only = spec.visible_only.as_ref().map(|is| *is.get_ref());
        let is_auto = is_auto(spec);
        if let Some(key) = &spec.visible_only
            && is_auto
            && visible_only == Some(false)
        {
            self.errors.push(
                Diagnostic::new(key.span(), "`visible_only` contradicts resolution = \"auto\"")
                    .label("only what is visible can be made as fine as pixels")
                    .help("remove it, or write a number for `resolution`"),
            );
        }
        visible_only.or(is_auto.then_some(true))
    }

    fn image(&mut self, scene: &SceneSpec) -> ImageSettings {
        let spec = &scene.image.spec;
        let output = &scene.output.spec;
        let no_exr = output.exr.as_ref().is_some_and(|exr| *exr.get_ref() == Target::Switch(false));
        let range = 1..=MAX_IMAGE_SIZE;
        ImageSettings {
            width: self.whole("width", spec.width.as_ref(), range.clone(), DEFAULT_IMAGE_SIZE),
            height: self.whole("height", spec.height.as_ref(), range, DEFAULT_IMAGE_SIZE),
            background: match spec.background.unwrap_or(DEFAULT_BACKGROUND) {
                Background::Transparent => None,
                Background::Color(color) => Some(linear(color)),
            },
            lights: self.lights(&scene.lights),
            shadows: self.shadows(spec, &scene.lights),
            occlusion: self.number("occlusion", spec.occlusion.as_ref(), 0.0..=1.0, 0.0),
            matcap: self.light_picture(spec, &scene.lights),
            shade: match spec.shade.unwrap_or_default() {
                ShadeSpec::Refine => Shade::Refine,
                ShadeSpec::Slab => Shade::Slab,
                ShadeSpec::Voxel => Shade::Voxel,
                ShadeSpec::GlPoint => Shade::GlPoint,
                ShadeSpec::Status => Shade::Status,
            },
            samples: self.samples(spec),
            candidates: spec.candidates.unwrap_or(true),
            certificate: !no_exr && output.layers.unwrap_or(true),
            curvature: !no_exr && output.layers.unwrap_or(true),
        }
    }

    /// Samples along an edge of a pixel.
    fn samples(&mut self, spec: &ImageSpec) -> u32 {
        let Some(samples) = &spec.samples else { return DEFAULT_SAMPLES };
        let n = self.whole("samples", spec.samples.as_ref(), 1..=64, 1);
        let edge = n.isqrt();
        if edge * edge != n {
            self.errors.push(
                Diagnostic::new(samples.span(), format!("`samples` is {n}"))
                    .label("not a square number")
                    .help("a pixel is divided evenly: write 1, 4, 9, 16, 25, 36, 49 or 64"),
            );
        }
        edge
    }

    /// An integer in `range`, which lies within `u32`.
    pub(super) fn whole(
        &mut self,
        key: &str,
        value: Option<&Spanned<Whole>>,
        range: RangeInclusive<i64>,
        default: i64,
    ) -> u32 {
        let (low, high) = (*range.start(), *range.end());
        let chosen = value.map_or(default, |value| value.get_ref().0);
        if let Some(value) = value
            && !range.contains(&chosen)
        {
            self.out_of_range(value.span(), key, format!("from {low} to {high}"));
        }
        chosen.clamp(low, high) as u32
    }

    /// A number in `range`.
    pub(super) fn number(
        &mut self,
        key: &str,
        value: Option<&Spanned<Number>>,
        range: RangeInclusive<f64>,
        default: f64,
    ) -> f64 {
        let (low, high) = (*range.start(), *range.end());
        let chosen = value.map_or(default, |value| value.get_ref().0);
        if let Some(value) = value
            && !range.contains(&chosen)
        {
            self.out_of_range(value.span(), key, format!("from {low} to {high}"));
        }
        chosen
    }

    /// A number above 0.
    pub(super) fn positive(&mut self, key: &str, value: &Spanned<Number>) -> f64 {
        let chosen = value.get_ref().0;
        if chosen <= 0.0 {
            self.out_of_range(value.span(), key, "above 0".to_owned());
        }
        chosen
    }

    fn out_of_range(&mut self, span: Range<usize>, key: &str, allowed: String) {
        self.errors.push(
            Diagnostic::new(span, format!("`{key}` is out of range"))
                .label(format!("must be {allowed}")),
        );
    }

    /// A vector that has a direction.
    pub(super) fn direction(&mut self, key: &str, value: &Spanned<Numbers<3>>) -> DVec3 {
        let vector = DVec3::from_array(value.get_ref().0);
        if vector == DVec3::ZERO {
            self.errors.push(
                Diagnostic::new(value.span(), format!("`{key}` has no direction"))
                    .label("must not be zero"),
            );
        }
        vector
    }
}

/// Whether voxels are to be as small as pixels.
pub(super) fn is_auto(spec: &VoxelsSpec) -> bool {
    spec.resolution.as_ref().is_some_and(|resolution| *resolution.get_ref() == Detail::Auto)
}

fn storage(spec: &VoxelsSpec) -> StorageKind {
    match spec.storage.unwrap_or_default() {
        StorageSpec::Octree => StorageKind::Morton,
        StorageSpec::Pointer => StorageKind::Pointer,
        StorageSpec::Dense => StorageKind::Dense,
    }
}

fn schedule(spec: &VoxelsSpec) -> Schedule {
    match spec.schedule.unwrap_or_default() {
        ScheduleSpec::Stealing => Schedule::Stealing,
        ScheduleSpec::MasterSlave => Schedule::MasterSlave,
    }
}
