//! Gaussian cube files: the samples stay in their file, which the scene names, and are drawn with the
//! atoms.

use std::fmt::Write as _;

use super::{
    Converted, Source, comments,
    elements::Element,
    header,
    molecule::{Atom, Style, about, camera, formula, surfaces},
    quoted,
};
use crate::volume::{CubeHeader, Refusal, Samples, Volume};

/// The part of its square that the surface of an orbital holds: that of the electron.
const OF_ORBITAL: f64 = 0.9;

/// The part of a density that its surface holds.
const OF_DENSITY: f64 = 0.98;

/// Values below 0 are noise if they are less than this part of the largest.
const NOISE: f64 = 0.01;

/// The scene of a cube file, which calls the file `name`.
pub(super) fn import(source: &Source<'_>, name: &str) -> Result<Converted, Refusal> {
    let cube = CubeHeader::read(source.path)?;
    let (first, n) = (cube.orbitals[0], cube.orbitals.len());
    let volume = Volume::read_orbital(source.path, first)?;
    let surface = Isosurface::of(&volume).ok_or("none of its values differs from 0")?;
    let mut notes = Vec::new();
    if n > 1 {
        notes.push(format!("the file has {n} orbitals, of which number {first} is drawn"));
    }
    let atoms: Vec<Atom> = cube
        .atoms
        .iter()
        .filter_map(|&(number, place)| {
            let element = Element::of_number(number)?;
            Some(Atom { element, place, is_water: false })
        })
        .collect();
    let n_ghosts = cube.atoms.len() - atoms.len();
    if n_ghosts > 0 {
        notes.push(format!("{n_ghosts} points that are no atoms are left out"));
    }
    let mut scene = header(source, "a Gaussian cube file");
    comments(&mut scene, &notes);
    scene.push_str("version = 1\n");
    let note = if atoms.is_empty() { cube.titles[1].clone() } else { formula(&atoms) };
    about(&mut scene, Some(&cube.titles[0]), &note);
    for (sign, range, color) in surface.ranges() {
        let _ = writeln!(scene, "\n[[volume]]\nname = \"{sign}\"\nfile = {}", quoted(name));
        if n > 1 {
            let _ = writeln!(scene, "orbital = {first}");
        }
        let _ = writeln!(scene, "{range}\ncolor = \"{color}\"");
    }
    surfaces(&mut scene, &atoms, Style::BallsAndSticks);
    camera(&mut scene, &atoms, 0.8);
    Ok(Converted { scene, notes })
}

/// What is drawn of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Isosurface {
    isovalue: f64,
    /// Whether there is another surface at the negative isovalue.
    has_signs: bool,
}

impl Isosurface {
    /// The one that holds most of an orbital or a density; nothing if there is none.
    fn of(volume: &Volume) -> Option<Self> {
        let Samples::F32(samples) = &volume.samples else { return None };
        let [low, high] = volume.range();
        let has_signs = low < -NOISE * high;
        let power = if has_signs { 2 } else { 1 };
        let part = if has_signs { OF_ORBITAL } else { OF_DENSITY };
        let mut values: Vec<f32> = samples.iter().map(|v| v.abs()).collect();
        values.retain(|v| v.is_finite());
        values.sort_unstable_by(|a, b| b.total_cmp(a));
        let share = |v: &f32| f64::from(*v).powi(power);
        let wanted = part * values.iter().map(share).sum::<f64>();
        let mut held = 0.0;
        let isovalue = values.iter().find(|v| {
            held += share(v);
            held >= wanted
        })?;
        // Two digits are as many as one would choose.
        let isovalue: f64 = format!("{isovalue:.1e}").parse().ok()?;
        (0.0 < isovalue && isovalue <= high.max(-low)).then_some(Self { isovalue, has_signs })
    }

    /// For each surface its name, what says in a scene what it holds, and its colour.
    fn ranges(self) -> Vec<(&'static str, String, &'static str)> {
        let Self { isovalue, has_signs } = self;
        let above = format!("isovalue = {isovalue}");
        match has_signs {
            false => vec![("density", above, "#3f72af")],
            true => vec![
                ("positive", above, "#3f72af"),
                ("negative", format!("range = [-inf, -{isovalue}]"), "#e84545"),
            ],
        }
    }
}
