//! Sampled volumes: files that lie beside the scene, and the isosurfaces in them.

use std::path::Path;

use super::{
    color::{WHITE, default_color},
    leaf::Whole,
    lower::Lower,
    solid::{Origin, Solid},
    spanned::Spanned,
    spec::{ByteOrderSpec, CriterionSpec, SampleTypeSpec, Section, VolumeSpec},
};
use crate::{
    diagnostic::Diagnostic,
    hrb::{Criterion, Tolerance},
    isosurface::Isosurface,
    mesh::Border,
    volume::{ByteOrder, Keep, RawFormat, SampleType, Volume, is_cube},
};

/// More voxels along an axis are no file that memory holds.
const MAX_SIZE: i64 = 1 << 20;

/// What a `[[volume]]` section says.
#[derive(Clone, Debug)]
pub struct Scan {
    /// For messages.
    pub name: String,
    /// Its samples, without the components that are dropped.
    pub volume: Volume,
    /// What is this large or larger is inside.
    pub isovalue: f64,
    /// When samples are alike.
    pub tolerance: Tolerance,
    /// What its isosurface does where the volume ends.
    pub border: Border,
}

impl Lower<'_> {
    /// The isosurfaces of all volumes that could be read, after `n_before` other things with colours.
    pub(super) fn volumes(&mut self, specs: &[Section<VolumeSpec>], n_before: usize) -> Vec<Solid> {
        let volume = |(i, section)| self.volume(n_before + i, section);
        specs.iter().enumerate().filter_map(volume).collect()
    }

    fn volume(&mut self, index: usize, section: &Section<VolumeSpec>) -> Option<Solid> {
        let spec = &section.spec;
        let usual = if self.has_matcap { WHITE } else { default_color(index) };
        let colors = (spec.color.unwrap_or(usual), spec.back_color);
        let material = self.material_of(colors, spec.specular.as_ref(), spec.shininess.as_ref());
        let Scan { name, volume, isovalue, tolerance, border } = self.scan(section)?;
        if border == Border::Open && !volume.has_outside(isovalue) {
            let span = spec.file.as_ref().map_or(section.span.clone(), |file| file.span());
            self.errors.push(
                Diagnostic::new(span, "the isosurface is empty")
                    .help("no two neighbours lie on different sides of it"),
            );
            return None;
        }
        let isosurface = Isosurface::new(volume, isovalue, tolerance, border);
        Some(Solid { name, material, origin: Origin::Volume(isosurface.into()) })
    }

    /// The samples of a section and what is looked for in them.
    pub(super) fn scan(&mut self, section: &Section<VolumeSpec>) -> Option<Scan> {
        let spec = &section.spec;
        let raw = self.raw_format(spec);
        let Some(file) = &spec.file else {
            self.missing(section, "file", "file = \"scan.nrrd\"");
            return None;
        };
        let path = self.beside(file).map_err(|mistake| self.errors.push(mistake)).ok()?;
        let (volume, span) = match &spec.orbital {
            Some(orbital) => (self.orbital(&path, raw.as_ref(), orbital)?, orbital.span()),
            None => (Volume::read_within(&path, raw.as_ref(), self.max_memory), file.span()),
        };
        let volume = volume.map_err(|why| {
            let message = format!("cannot use {}: {why}", file.get_ref());
            self.errors.push(Diagnostic::new(span, message));
        });
        let (volume, isovalue) = self.inside(section, volume.ok()?)?;
        let volume = self.kept(spec, volume, isovalue)?;
        let epsilon = self.number("tolerance", spec.tolerance.as_ref(), 0.0..=f64::MAX, 0.0);
        let criterion = match spec.criterion.unwrap_or_default() {
            CriterionSpec::Range => Criterion::Range,
            CriterionSpec::Deviation => Criterion::Deviation,
        };
        let border = if spec.cap.unwrap_or(false) { Border::Capped } else { Border::Open };
        let name = spec.name.clone().unwrap_or_else(|| file.get_ref().clone());
        Some(Scan { name, volume, isovalue, tolerance: Tolerance { epsilon, criterion }, border })
    }

    /// One orbital of a cube file, unless the file is of another kind.
    fn orbital(
        &mut self,
        path: &Path,
        raw: Option<&RawFormat>,
        orbital: &Spanned<Whole>,
    ) -> Option<Result<Volume, String>> {
        if raw.is_some() || !is_cube(path) {
            self.errors.push(
                Diagnostic::new(orbital.span(), "`orbital` is for cube files")
                    .label("this file has another ending than .cube and .cub")
                    .help("remove it"),
            );
            return None;
        }
        Some(Volume::read_orbital(path, orbital.get_ref().0, self.max_memory))
    }

    /// The volume in which what is inside is at or above the isovalue.
    fn inside(&mut self, section: &Section<VolumeSpec>, volume: Volume) -> Option<(Volume, f64)> {
        let spec = &section.spec;
        match (&spec.isovalue, &spec.range) {
            (Some(isovalue), None) => {
                let value = isovalue.get_ref().0;
                match volume.check_isovalue(value) {
                    Ok(()) => Some((volume, value)),
                    Err(why) => {
                        self.errors.push(Diagnostic::new(isovalue.span(), why));
                        None
                    }
                }
            }
            (None, Some(range)) => match volume.band(range.get_ref().0) {
                Ok(band) => Some((band, 0.0)),
                Err(why) => {
                    self.errors.push(Diagnostic::new(range.span(), why));
                    None
                }
            },
            (Some(_), Some(range)) => {
                self.errors.push(
                    Diagnostic::new(range.span(), "`range` stands beside `isovalue`")
                        .help("remove one of them"),
                );
                None
            }
            (None, None) => {
                self.missing(section, "isovalue", "isovalue = 100");
                None
            }
        }
    }

    /// The volume without the components that are too small.
    fn kept(&mut self, spec: &VolumeSpec, mut volume: Volume, isovalue: f64) -> Option<Volume> {
        let least = spec.min_samples.as_ref();
        let min_samples = self.whole("min_samples", least, 1..=i64::from(u32::MAX), 1);
        let keep = match spec.keep_largest.unwrap_or(false) {
            true => Keep::Largest,
            false if min_samples > 1 => Keep::AtLeast(u64::from(min_samples)),
            false => return Some(volume),
        };
        match volume.keep(isovalue, keep) {
            Ok(_) => Some(volume),
            Err(why) => {
                let span = spec.file.as_ref().map_or(0..0, |file| file.span());
                self.errors.push(Diagnostic::new(span, why));
                None
            }
        }
    }

    /// What the scene says of a file that does not say it itself.
    fn raw_format(&mut self, spec: &VolumeSpec) -> Option<RawFormat> {
        let (Some(size), Some(sample_type)) = (&spec.size, &spec.sample_type) else {
            let size = spec.size.as_ref().map(|size| ("size", "type", size.span()));
            let alone = spec.sample_type.as_ref().map(|kind| ("type", "size", kind.span()));
            if let Some((key, other, span)) = size.or(alone) {
                self.errors.push(
                    Diagnostic::new(span, format!("`{key}` stands without `{other}`"))
                        .help("files of raw samples need both, other files none of them"),
                );
            }
            return None;
        };
        let mut sides = [1; 3];
        for (side, n) in sides.iter_mut().zip(size.get_ref().0) {
            if !(1.0..=MAX_SIZE as f64).contains(&n) || n.fract() != 0.0 {
                self.errors.push(
                    Diagnostic::new(size.span(), "`size` is three whole numbers above 0")
                        .label(format!("{n} is none")),
                );
                return None;
            }
            *side = n as u32;
        }
        let mut format = RawFormat::new(
            sides,
            match sample_type.get_ref() {
                SampleTypeSpec::Uint8 => SampleType::U8,
                SampleTypeSpec::Int8 => SampleType::I8,
                SampleTypeSpec::Uint16 => SampleType::U16,
                SampleTypeSpec::Int16 => SampleType::I16,
                SampleTypeSpec::Uint32 => SampleType::U32,
                SampleTypeSpec::Int32 => SampleType::I32,
                SampleTypeSpec::Float32 => SampleType::F32,
                SampleTypeSpec::Float64 => SampleType::F64,
            },
        );
        if spec.byte_order == Some(ByteOrderSpec::Big) {
            format.byte_order = ByteOrder::Big;
        }
        if let Some(spacing) = &spec.spacing {
            format.spacing = spacing.get_ref().0;
        }
        if let Some(origin) = &spec.origin {
            format.origin = self.coordinates("origin", origin);
        }
        let skip = spec.skip.as_ref();
        format.skip = u64::from(self.whole("skip", skip, 0..=i64::from(u32::MAX), 0));
        Some(format)
    }

    fn missing(&mut self, section: &Section<VolumeSpec>, key: &str, example: &str) {
        if !section.is_damaged {
            self.errors.push(
                Diagnostic::new(section.span.clone(), format!("the volume has no `{key}`"))
                    .help(format!("add it, as in {example}")),
            );
        }
    }
}
