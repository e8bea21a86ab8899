//! From a [`SceneSpec`] to a [`Scene`]: defaults, ranges, relations between keys.
//!
//! Every mistake is noted and a harmless value put in its place, so that one run finds them all;
//! the scene is only handed out if there were none.

use std::{
    ops::{Range, RangeInclusive},
    path::{Component, Path, PathBuf},
};

use glam::DVec3;
use toml::Spanned;

use super::{
    Outputs, Scene,
    color::linear_from_srgb,
    leaf::{Background, Color, Number, Numbers, Target, Whole},
    spec::{DomainSpec, ImageSpec, OutputSpec, SceneSpec, Section, VoxelsSpec},
};
use crate::{diagnostic::Diagnostic, math::Aabb, raster::ImageSettings};

/// The largest `resolution`, in voxels along the longest axis.
pub const MAX_RESOLUTION: u32 = 16_384;

/// The largest width and height of a picture, in pixels.
const MAX_IMAGE_SIZE: i64 = 16_384;

/// Coordinates beyond this leave no room for powers of them in the range of `f32`.
const MAX_COORDINATE: f64 = 1e12;

const DEFAULT_RESOLUTION: i64 = 512;
const DEFAULT_IMAGE_SIZE: i64 = 1024;
const DEFAULT_BACKGROUND: Background = Background::Color(Color([1.0; 3]));

/// Notes mistakes while the parts of a scene are made.
pub(super) struct Lower<'a> {
    /// The text of the file.
    pub(super) source: &'a str,
    pub(super) errors: &'a mut Vec<Diagnostic>,
}

impl Lower<'_> {
    /// The scene called `name`; worth something only if no errors were noted.
    pub(super) fn scene(&mut self, name: &str, spec: &SceneSpec) -> Scene {
        Scene {
            name: name.to_owned(),
            surfaces: self.surfaces(&spec.surfaces),
            domain: self.domain(&spec.domain),
            resolution: self.resolution(&spec.voxels.spec),
            view: self.view(&spec.camera),
            image: self.image(&spec.image.spec),
            outputs: self.outputs(name, &spec.output.spec),
        }
    }

    fn domain(&mut self, Section { spec, is_damaged, .. }: &Section<DomainSpec>) -> Aabb {
        let min = self.coordinates("min", spec.min.as_ref(), [-1.0; 3]);
        let max = self.coordinates("max", spec.max.as_ref(), [1.0; 3]);
        let axes = ['x', 'y', 'z'].into_iter().zip(min.into_iter().zip(max));
        let is_empty = |(_, (min, max)): &(char, (f64, f64))| min >= max && !is_damaged;
        for (axis, (min, max)) in axes.filter(is_empty) {
            let at = spec.max.as_ref().or(spec.min.as_ref());
            let message = format!("the domain is empty along {axis}: min is {min}, max is {max}");
            self.errors.push(
                Diagnostic::new(at.map_or(0..0, Spanned::span), message)
                    .help("every number of `min` must be below its partner in `max`"),
            );
        }
        Aabb { min: min.into(), max: max.into() }
    }

    fn coordinates(
        &mut self,
        key: &str,
        value: Option<&Spanned<Numbers<3>>>,
        default: [f64; 3],
    ) -> [f64; 3] {
        let Some(value) = value else { return default };
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
        let range = 1..=i64::from(MAX_RESOLUTION);
        self.whole("resolution", spec.resolution.as_ref(), range, DEFAULT_RESOLUTION)
    }

    fn image(&mut self, spec: &ImageSpec) -> ImageSettings {
        let range = 1..=MAX_IMAGE_SIZE;
        ImageSettings {
            width: self.whole("width", spec.width.as_ref(), range.clone(), DEFAULT_IMAGE_SIZE),
            height: self.whole("height", spec.height.as_ref(), range, DEFAULT_IMAGE_SIZE),
            background: match spec.background.unwrap_or(DEFAULT_BACKGROUND) {
                Background::Transparent => None,
                Background::Color(color) => Some(linear_from_srgb(color)),
            },
        }
    }

    fn outputs(&mut self, name: &str, spec: &OutputSpec) -> Outputs {
        Outputs {
            png: self.file(&format!("{name}.png"), spec.png.as_ref()),
            exr: self.file(&format!("{name}.exr"), spec.exr.as_ref()),
        }
    }

    /// The file to write: `default`, none, or the one named, which must end as `default` does.
    fn file(&mut self, default: &str, target: Option<&Spanned<Target>>) -> Option<PathBuf> {
        let Some(target) = target else { return Some(default.into()) };
        let name = match target.get_ref() {
            Target::Switch(write) => return write.then(|| default.into()),
            Target::File(name) => Path::new(name),
        };
        let ending = Path::new(default).extension().unwrap_or_default();
        let below = |part: Component<'_>| matches!(part, Component::Normal(_) | Component::CurDir);
        if !name.components().all(below) {
            self.errors.push(
                Diagnostic::new(target.span(), "the file would lie outside the output directory")
                    .label("not a relative name, or one with `..`")
                    .help("choose the directory on the command line with --out"),
            );
        } else if name.extension() != Some(ending) {
            let ending = ending.display();
            self.errors.push(
                Diagnostic::new(target.span(), format!("the name must end in `.{ending}`"))
                    .help(format!("write a name such as \"picture.{ending}\", true or false")),
            );
        }
        Some(name.to_owned())
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
