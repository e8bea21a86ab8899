//! What is evaluated: the thesis's models, formulas of densities, scans.

use std::{borrow::Cow, fmt, path::Path};

use glam::{DAffine3, DVec3};

use crate::{
    Error, Result,
    expr::{self, Expr},
    math::Aabb,
    progress::Unwatched,
    scene,
    volume::{
        Quantize, RawFormat, Samples, Volume,
        thesis::{Alpha, MODELS, Model},
    },
};

/// Where densities are sampled.
const CUBE: Aabb = Aabb { min: DVec3::NEG_ONE, max: DVec3::ONE };

/// The isovalue of the thesis.
const ISOVALUE: f64 = 60.0;

/// Halves of scans are not divided below this size.
const LEAST_SIZE: u32 = 32;

/// Something to evaluate.
#[derive(Clone, Debug)]
pub struct Subject {
    /// For titles.
    pub name: String,
    /// For names of files.
    pub slug: String,
    /// Whether its samples are all or nothing; then there is no gradient to measure errors by.
    pub is_binary: bool,
    /// Where its surface is.
    pub isovalue: f64,
    pub(super) source: Source,
}

/// Where samples come from.
#[derive(Clone, Debug)]
pub(super) enum Source {
    /// Densities from 0 to 255, floored.
    Formula(Expr),
    /// As they are.
    Scan(Volume),
}

/// A grid of samples of a subject.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    step: Step,
    /// Along each axis.
    pub size: [u32; 3],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    /// A formula.
    Sampled,
    /// A scan of which every second sample is left out so many times.
    Halved(u32),
}

/// What is evaluated if nothing is named.
pub const MODEL_NAMES: [&str; 4] = ["esfera", "tronco", "silla", "jarron"];

impl fmt::Display for Grid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.size {
            [x, y, z] if x == y && y == z => write!(f, "{x}³"),
            [x, y, z] => write!(f, "{x} × {y} × {z}"),
        }
    }
}

impl Subject {
    /// What an argument names: a model of the thesis, a scene with volumes, a file of samples, or a
    /// formula of a density.
    ///
    /// # Errors
    /// What is wrong with it, and what would be right.
    pub fn named(argument: &str, isovalue: Option<f64>) -> Result<Vec<Self>> {
        let mut subjects = Self::read(argument)?;
        for subject in &mut subjects {
            subject.isovalue = isovalue.unwrap_or(subject.isovalue);
            if let Source::Scan(volume) = &subject.source {
                volume.check_isovalue(subject.isovalue).map_err(Error::Limit)?;
            }
        }
        Ok(subjects)
    }

    fn read(argument: &str) -> Result<Vec<Self>> {
        let (name, alpha) = argument.split_once(':').unwrap_or((argument, ""));
        if let Some(model) =
            MODELS.iter().find(|model| name == model.name || name == plain(model.name))
        {
            let alphas = match alpha {
                "" => &[Alpha::Solid, Alpha::Linear][..],
                "alpha1" => &[Alpha::Solid],
                "alpha2" => &[Alpha::Linear],
                other => {
                    let text =
                        format!("a model has alpha1 or alpha2 after the colon, not `{other}`");
                    return Err(Error::Limit(text));
                }
            };
            return alphas.iter().map(|&alpha| Self::of_model(*model, alpha)).collect();
        }
        let path = Path::new(argument);
        if path.extension().is_some_and(|ending| ending == "toml") {
            return Self::of_scene(path);
        }
        if path.is_file() {
            return Ok(vec![Self::of_file(path)?]);
        }
        let formula = Self::of_formula(argument, argument.to_owned(), false);
        formula.map(|subject| vec![subject]).map_err(|why| {
            Error::Limit(format!(
                "it is no file, no model (esfera, tronco, silla, jarron) and no formula: {why}"
            ))
        })
    }

    fn of_model(model: Model, alpha: Alpha) -> Result<Self> {
        let (symbol, letter) = match alpha {
            Alpha::Solid => ("α1", "alpha1"),
            Alpha::Linear => ("α2", "alpha2"),
        };
        let name = format!("{} {symbol}", model.name);
        let subject = Self::of_formula(&model.text(alpha), name, alpha == Alpha::Solid)?;
        Ok(Self { slug: format!("{}-{letter}", plain(model.name)), ..subject })
    }

    fn of_formula(text: &str, name: String, is_binary: bool) -> Result<Self> {
        let ast = expr::parse(text)
            .map_err(|mistakes| mistakes.into_iter().next().map(|mistake| mistake.message));
        let resolved = ast.and_then(|ast| {
            Expr::resolve(&ast, &[])
                .map_err(|all| all.into_iter().next().map(|mistake| mistake.diagnostic.message))
        });
        let formula = resolved.map_err(|why| Error::Limit(why.unwrap_or_default()))?.expr;
        let slug = plain(&name);
        Ok(Self { name, slug, is_binary, isovalue: ISOVALUE, source: Source::Formula(formula) })
    }

    fn of_scene(path: &Path) -> Result<Vec<Self>> {
        let scans = scene::load_volumes(path)?;
        if scans.is_empty() {
            return Err(Error::Limit("the scene has no [[volume]] section".to_owned()));
        }
        let subject = |scan: scene::Scan| {
            let name = without_ending(&scan.name);
            Self::of_scan(name, scan.volume, scan.isovalue)
        };
        Ok(scans.into_iter().map(subject).collect())
    }

    fn of_file(path: &Path) -> Result<Self> {
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        let raw = match path.extension() {
            Some(ending) if ending == "raw" => RawFormat::from_name(&file),
            _ => None,
        };
        let volume = Volume::read(path, raw.as_ref()).map_err(Error::Limit)?;
        let name = without_ending(&file);
        // What the name tells of size and type is told beside it anyway.
        let name = if raw.is_some() { name.split('_').next().unwrap_or_default() } else { name };
        Ok(Self::of_scan(name, volume, ISOVALUE))
    }

    fn of_scan(name: &str, volume: Volume, isovalue: f64) -> Self {
        let (name, slug) = (name.to_owned(), plain(name));
        Self { name, slug, is_binary: false, isovalue, source: Source::Scan(volume) }
    }

    /// Whether it was measured, not computed.
    #[must_use]
    pub fn is_scan(&self) -> bool {
        matches!(self.source, Source::Scan(_))
    }

    /// The grids on which it is evaluated, small ones first: `sizes` of formulas, halves of scans.
    #[must_use]
    pub fn grids(&self, sizes: &[u32]) -> Vec<Grid> {
        match &self.source {
            Source::Formula(_) => {
                sizes.iter().map(|&n| Grid { step: Step::Sampled, size: [n; 3] }).collect()
            }
            Source::Scan(volume) => {
                let mut grids = vec![Grid { step: Step::Halved(0), size: volume.size }];
                for times in 1..3 {
                    let size = volume.size.map(|n| n.div_ceil(1 << times));
                    if size.into_iter().max() >= Some(LEAST_SIZE) {
                        grids.insert(0, Grid { step: Step::Halved(times), size });
                    }
                }
                grids
            }
        }
    }

    /// The grid on which errors are measured: 128³, or what comes nearest, and half of a scan.
    #[must_use]
    pub fn test_grid(&self, sizes: &[u32]) -> Grid {
        match &self.source {
            Source::Formula(_) => {
                let n = sizes.iter().copied().min_by_key(|n| n.abs_diff(128)).unwrap_or(128);
                Grid { step: Step::Sampled, size: [n; 3] }
            }
            Source::Scan(volume) => {
                Grid { step: Step::Halved(1), size: volume.size.map(|n| n.div_ceil(2)) }
            }
        }
    }

    /// A grid that is small enough to see its regions.
    pub(super) fn coarse_grid(&self) -> Grid {
        match &self.source {
            Source::Formula(_) => Grid { step: Step::Sampled, size: [32; 3] },
            Source::Scan(volume) => {
                let longest = volume.size.into_iter().max().unwrap_or(1);
                let times = longest.div_ceil(64).next_power_of_two().ilog2();
                let size = volume.size.map(|n| n.div_ceil(1 << times));
                Grid { step: Step::Halved(times), size }
            }
        }
    }

    /// The samples of a grid.
    ///
    /// # Errors
    /// [`Error::Limit`] if there are too many.
    pub fn volume(&self, grid: Grid) -> Result<Cow<'_, Volume>> {
        Ok(match (&self.source, grid.step) {
            (Source::Formula(formula), _) => {
                let size = grid.size;
                Cow::Owned(Volume::sampled(formula, CUBE, size, Quantize::Floor, &Unwatched)?)
            }
            (Source::Scan(volume), Step::Halved(times)) if times > 0 => {
                Cow::Owned(halved(volume, times))
            }
            (Source::Scan(volume), _) => Cow::Borrowed(volume),
        })
    }
}

/// Every second sample along each axis, from the first on, so many times.
fn halved(volume: &Volume, times: u32) -> Volume {
    let step = 1_usize << times;
    let size = volume.size.map(|n| n.div_ceil(1 << times));
    let [nx, ny, _] = volume.size.map(|n| n as usize);
    let rows = (0..size[2] as usize).flat_map(|z| (0..size[1] as usize).map(move |y| (y, z)));
    let firsts = rows.map(|(y, z)| step * nx * (y + ny * z));
    macro_rules! of_type {
        ($($kind:ident),*) => {
            match &volume.samples {
                $(Samples::$kind(all) => Samples::$kind(
                    firsts.flat_map(|i| all[i..i + nx].iter().step_by(step).copied()).collect(),
                ),)*
            }
        };
    }
    let samples = of_type!(U8, I8, U16, I16, U32, I32, F32);
    // Sample i is where sample i · step was; both stand in the middles of their voxels.
    let scale = step as f64;
    let within = DAffine3::from_translation(DVec3::splat(0.5 * (1.0 - scale)))
        * DAffine3::from_scale(DVec3::splat(scale));
    Volume { size, samples, placing: volume.placing * within }
}

fn without_ending(file: &str) -> &str {
    let file = file.rsplit('/').next().unwrap_or(file);
    file.split('.').next().unwrap_or(file)
}

/// Without what names of files should not have.
fn plain(name: &str) -> String {
    let mut slug = String::new();
    for c in name.chars() {
        match c {
            'ó' => slug.push('o'),
            c if c.is_ascii_alphanumeric() => slug.push(c.to_ascii_lowercase()),
            _ if slug.ends_with('-') || slug.is_empty() => {}
            _ => slug.push('-'),
        }
    }
    slug.truncate(40);
    slug.trim_end_matches('-').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_keep_samples_where_they_are() {
        let samples = Samples::U8((0..5 * 4 * 3).collect());
        let placing = DAffine3::from_scale_rotation_translation(
            DVec3::new(1.0, 2.0, 1.5),
            glam::DQuat::IDENTITY,
            DVec3::new(7.0, 0.0, 1.0),
        );
        let volume = Volume { size: [5, 4, 3], samples, placing };
        let half = halved(&volume, 1);
        assert_eq!(half.size, [3, 2, 2]);
        for z in 0..2 {
            for y in 0..2 {
                for x in 0..3 {
                    let (i, j) = ([x, y, z], [2 * x, 2 * y, 2 * z]);
                    assert_eq!(half.value(i), volume.value(j));
                    let middle = |p: [u32; 3]| DVec3::from_array(p.map(|i| f64::from(i) + 0.5));
                    let [a, b] = [(&half, i), (&volume, j)]
                        .map(|(volume, p)| volume.placing.transform_point3(middle(p)));
                    assert!(a.distance(b) < 1e-12);
                }
            }
        }
    }

    #[test]
    fn names_are_understood() {
        let slugs = |argument: &str| -> Vec<String> {
            Subject::named(argument, None).unwrap().into_iter().map(|s| s.slug).collect()
        };
        assert_eq!(slugs("jarrón"), ["jarron-alpha1", "jarron-alpha2"]);
        assert_eq!(slugs("silla:alpha2"), ["silla-alpha2"]);
        assert_eq!(slugs("255*(1 - r)"), ["255-1-r"]);
        for (argument, words) in [
            ("esfera:alpha3", "alpha1 or alpha2"),
            ("sfera", "no model (esfera, tronco, silla, jarron) and no formula: unknown"),
        ] {
            let error = Subject::named(argument, None).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}
