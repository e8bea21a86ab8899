//! Gaussian cube files: the samples stay in their file, which the scene names, and are drawn with the
//! atoms.

use std::fmt::Write as _;

use super::{
    Converted, Source, comments,
    elements::Element,
    header,
    molecule::{Atom, FARTHEST, Style, about, camera, formula, surfaces},
    quoted,
};
use crate::volume::{CubeHeader, Refusal, Samples, Volume};

/// The part of its square that the surface of an orbital holds: that of the electron.
const OF_ORBITAL: f64 = 0.9;

/// Where the density of electrons, for each cubic Bohr, ends a molecule. *Based on:* R. Bader and others,
/// "Properties of atoms in molecules: atomic volumes" (1987). A part of all electrons would be no measure:
/// a sample on a heavy nucleus may count as more than all others.
const OF_DENSITY: f64 = 0.002;

/// Values below 0 are noise if they are less than this part of the largest.
const NOISE: f64 = 0.01;

/// The scene of a cube file, which calls the file `name`.
pub(super) fn import(source: &Source<'_>, name: &str) -> Result<Converted, Refusal> {
    let cube = CubeHeader::read(source.path)?;
    let (first, n) = (cube.orbitals[0], cube.orbitals.len());
    let volume = Volume::read_orbital(source.path, first, None)?;
    let surface = Isosurface::of(&volume).ok_or("none of its values differs from 0")?;
    if let Some((_, place)) = cube.atoms.iter().find(|(_, p)| p.abs().max_element() > FARTHEST) {
        return Err(format!("an atom stands at {place}, which is too far away"));
    }
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
    let style = Style::sticks(&atoms, &mut notes);
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
    surfaces(&mut scene, &atoms, &style);
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
    /// The one that holds most of an orbital, or a molecule by its density; nothing if there is none.
    fn of(volume: &Volume) -> Option<Self> {
        let [low, high] = volume.range();
        let has_signs = low < -NOISE * high;
        let isovalue = match has_signs {
            true => that_holds(OF_ORBITAL, volume)?,
            // What is no density of electrons, or none that matters.
            false if high < 10.0 * OF_DENSITY => two_digits(0.1 * high)?,
            false => OF_DENSITY,
        };
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

/// The value at and above which samples hold this part of the sum of all squares, whatever their signs.
fn that_holds(part: f64, volume: &Volume) -> Option<f64> {
    let Samples::F32(samples) = &volume.samples else { return None };
    let mut values: Vec<f32> = samples.iter().map(|v| v.abs()).collect();
    values.retain(|v| v.is_finite());
    values.sort_unstable_by(|a, b| b.total_cmp(a));
    let square = |v: f32| f64::from(v) * f64::from(v);
    let wanted = part * values.iter().copied().map(square).sum::<f64>();
    let mut held = 0.0;
    let found = values.into_iter().find(|&v| {
        held += square(v);
        held >= wanted
    })?;
    two_digits(found.into())
}

/// As many digits as one would choose.
fn two_digits(value: f64) -> Option<f64> {
    format!("{value:.1e}").parse().ok()
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::*;

    fn surface(samples: &[f32]) -> Option<Isosurface> {
        let size = [samples.len() as u32, 1, 1];
        let samples = Samples::F32(samples.to_vec());
        Isosurface::of(&Volume { size, samples, placing: DAffine3::IDENTITY })
    }

    #[test]
    fn nine_tenths_of_an_orbital_are_held() {
        // Squares 100, 64, 36, 4, 1: the first three are more than nine tenths, two are not.
        let found = surface(&[0.1, -0.2, 0.8, f32::NAN, 0.6, -1.0]);
        assert_eq!(found, Some(Isosurface { isovalue: 0.6, has_signs: true }));
        let ranges: Vec<String> =
            found.unwrap().ranges().into_iter().map(|(_, range, _)| range).collect();
        assert_eq!(ranges, ["isovalue = 0.6", "range = [-inf, -0.6]"]);
    }

    #[test]
    fn densities_end_where_molecules_do() {
        let positive = |isovalue| Some(Isosurface { isovalue, has_signs: false });
        assert_eq!(surface(&[0.0, 195.0, 0.1, -1e-6]), positive(0.002));
        assert_eq!(surface(&[0.0, 0.012_34]), positive(0.0012));
        assert_eq!(surface(&[0.0, 0.0]), None);
        assert_eq!(surface(&[f32::NAN]), None);
    }
}
