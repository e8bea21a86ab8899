//! Molecules as scenes: atoms as spheres in the colours of their elements, and the bonds between them.

use std::fmt::Write as _;

use glam::{DMat3, DVec3};

use super::{Converted, Source, comments, elements::Element, header, quoted};
use crate::diagnostic::Diagnostic;

/// The most atoms: a scene file with more spheres is too large.
const MAX_ATOMS: usize = 80_000;

/// Places farther out than this, in Ångström, are no atom's.
pub(super) const FARTHEST: f64 = 1e6;

/// The most bonds that are drawn; each is several operations of a formula.
const MAX_BONDS: usize = 2_000;

/// By how much atoms that are bonded may be farther apart than their covalent radii say, in Ångström.
/// *Based on:* N. O'Boyle and others, "Open Babel" (2011).
const SLACK: f64 = 0.45;

/// Nearer than this, in Ångström, atoms are two guesses at the place of one, and not bonded.
const NEAREST: f64 = 0.4;

/// The radius of a bond, and what part of its radius an atom has beside bonds, in Ångström.
const BOND: f64 = 0.12;
const BALL: f64 = 0.25;

/// An atom.
#[derive(Debug)]
pub(super) struct Atom {
    pub(super) element: &'static Element,
    /// In Ångström.
    pub(super) place: DVec3,
    /// Whether it belongs to a water molecule beside the molecule that is meant.
    pub(super) is_water: bool,
}

/// How atoms are drawn.
#[derive(Debug)]
pub(super) enum Style {
    /// As large as they are.
    Spheres,
    /// As small balls with bonds, of which these are the ends.
    Sticks(Vec<[DVec3; 2]>),
}

impl Style {
    /// Balls and sticks; there is a note if there are too many bonds.
    pub(super) fn sticks(atoms: &[Atom], notes: &mut Vec<String>) -> Self {
        let mut bonds = bonds(atoms);
        if bonds.len() > MAX_BONDS {
            notes.push(format!("no more than {MAX_BONDS} bonds are drawn"));
            bonds.truncate(MAX_BONDS);
        }
        Self::Sticks(bonds)
    }
}

/// A number with five digits after the point; files of molecules have fewer.
fn decimal(value: f64) -> f64 {
    // Not -0.
    (value * 1e5).round() / 1e5 + 0.0
}

fn vector(v: DVec3) -> String {
    format!("{}, {}, {}", decimal(v.x), decimal(v.y), decimal(v.z))
}

/// There are atoms, and not too many.
///
/// # Errors
/// There are none, or too many.
pub(super) fn checked(atoms: Vec<Atom>) -> Result<Vec<Atom>, Diagnostic> {
    match atoms.len() {
        0 => Err(Diagnostic::new(0..0, "the file has no atoms")),
        1..=MAX_ATOMS => Ok(atoms),
        n => Err(Diagnostic::new(0..0, format!("the file has {n} atoms"))
            .label(format!("a scene has {MAX_ATOMS} at most"))
            .help("leave out what is not needed, such as water or all chains but one")),
    }
}

/// The molecular formula: carbon, hydrogen, then the other elements by symbol (E. Hill, 1900).
pub(super) fn formula(atoms: &[Atom]) -> String {
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for atom in atoms {
        let symbol = atom.element.symbol;
        match counts.iter_mut().find(|(other, _)| *other == symbol) {
            Some((_, n)) => *n += 1,
            None => counts.push((symbol, 1)),
        }
    }
    let has_carbon = counts.iter().any(|&(symbol, _)| symbol == "C");
    let place = |symbol| match symbol {
        "C" => 0,
        "H" if has_carbon => 1,
        _ => 2,
    };
    counts.sort_by_key(|&(symbol, _)| (place(symbol), symbol));
    let part = |(symbol, n): (&str, usize)| match n {
        1 => symbol.to_owned(),
        _ => format!("{symbol}{n}"),
    };
    counts.into_iter().map(part).collect::<Vec<_>>().join(" ")
}

/// The scene of a molecule alone.
pub(super) fn converted(
    (source, what): (&Source<'_>, &str),
    title: Option<&str>,
    atoms: &[Atom],
    mut notes: Vec<String>,
) -> Converted {
    let style = match source.has_sticks {
        true => Style::sticks(atoms, &mut notes),
        false => Style::Spheres,
    };
    let mut scene = header(source, what);
    comments(&mut scene, &notes);
    scene.push_str("version = 1\n");
    about(&mut scene, title, &format!("{}: {} atoms", formula(atoms), atoms.len()));
    surfaces(&mut scene, atoms, &style);
    camera(&mut scene, atoms, 0.5);
    Converted { scene, notes }
}

/// Adds what the scene is about.
pub(super) fn about(scene: &mut String, title: Option<&str>, note: &str) {
    scene.push_str("\n[about]\n");
    if let Some(title) = title.map(str::trim).filter(|title| !title.is_empty()) {
        let _ = writeln!(scene, "title = {}", quoted(title));
    }
    let _ = writeln!(scene, "note = {}", quoted(note));
}

/// Adds a surface for each element, water by itself, and one for the bonds.
pub(super) fn surfaces(scene: &mut String, atoms: &[Atom], style: &Style) {
    let mut groups: Vec<(bool, &Element, Vec<&Atom>)> = Vec::new();
    for atom in atoms {
        let is_of = |&(is_water, element, _): &(bool, &Element, _)| {
            is_water == atom.is_water && element == atom.element
        };
        match groups.iter().position(is_of) {
            Some(at) => groups[at].2.push(atom),
            None => groups.push((atom.is_water, atom.element, vec![atom])),
        }
    }
    groups.sort_by_key(|&(is_water, ..)| is_water);
    for (is_water, element, atoms) in groups {
        let of_water = if is_water { " of water" } else { "" };
        let part = if let Style::Spheres = style { 1.0 } else { BALL };
        let radius = decimal(part * element.radius);
        let _ = writeln!(scene, "\n[[surface]]\nname = \"{}{of_water}\"", element.name);
        let _ = writeln!(scene, "color = \"#{:06x}\"\nspheres = [", element.color);
        for atom in atoms {
            let _ = writeln!(scene, "  [{}, {radius}],", vector(atom.place));
        }
        scene.push_str("]\n");
    }
    let Style::Sticks(bonds) = style else { return };
    let sticks: Vec<String> = bonds.iter().copied().map(stick).collect();
    if !sticks.is_empty() {
        let sticks = sticks.join(" |\n  ");
        let _ = writeln!(
            scene,
            "\n[[surface]]\nname = \"bonds\"\ncolor = \"#a0a0a0\"\nshape = \"\"\"\n  {sticks}\"\"\""
        );
    }
}

/// The ends of bonds, in the order of the atoms along x: all, or one more than are drawn.
fn bonds(atoms: &[Atom]) -> Vec<[DVec3; 2]> {
    let mut order: Vec<&Atom> = atoms.iter().collect();
    order.sort_by(|a, b| a.place.x.total_cmp(&b.place.x));
    let widest = order.iter().map(|atom| atom.element.bond_radius).fold(0.0, f64::max);
    let mut bonds = Vec::new();
    for (i, a) in order.iter().enumerate() {
        for b in &order[i + 1..] {
            let step = b.place - a.place;
            let reach = a.element.bond_radius + SLACK;
            if step.x > reach + widest {
                break;
            }
            let length = step.length();
            if (NEAREST..=reach + b.element.bond_radius).contains(&length) {
                bonds.push([a.place, b.place]);
                if bonds.len() > MAX_BONDS {
                    return bonds;
                }
            }
        }
    }
    bonds
}

/// A bond as a shape: a cylinder along z that is turned and moved into its place.
fn stick([a, b]: [DVec3; 2]) -> String {
    let step = b - a;
    let tilt = libm::acos((step.z / step.length()).clamp(-1.0, 1.0)).to_degrees();
    let turn = libm::atan2(step.y, step.x).to_degrees();
    let height = decimal(step.length());
    // Thousandths of a degree.
    let [tilt, turn] = [tilt, turn].map(|angle| (angle * 1e3).round() / 1e3 + 0.0);
    let middle = vector(0.5 * (a + b));
    format!("cylinder({BOND}, {height}).rotate(0, {tilt}, {turn}).translate({middle})")
}

/// Adds a camera that sees the molecule's broad side, its longest axis across the picture; `tilt` is how
/// far it looks along that side, 0 for not at all. Nothing if the atoms have no such side.
pub(super) fn camera(scene: &mut String, atoms: &[Atom], tilt: f64) {
    let Some([long, middle, short]) = axes(atoms) else { return };
    // The side from which the axes point where they do in a scene without a camera: z up, y away.
    let up = if middle.dot(DVec3::new(0.0, 0.5, 1.0)) < 0.0 { -middle } else { middle };
    let towards = if short.dot(DVec3::new(0.3, -0.5, 1.0)) < 0.0 { -short } else { short };
    let across = if long.dot(up.cross(towards)) < 0.0 { -long } else { long };
    let direction = towards + tilt * (0.4 * across - up);
    let _ =
        writeln!(scene, "\n[camera]\ndirection = [{}]\nup = [{}]", vector(direction), vector(up));
}

/// The axes along which the atoms lie the farthest apart, next, and least, of length 1; nothing if they
/// lie in a line, to which all directions across are alike.
fn axes(atoms: &[Atom]) -> Option<[DVec3; 3]> {
    let middle = atoms.iter().map(|atom| atom.place).sum::<DVec3>() / atoms.len() as f64;
    let mut m = [[0.0; 3]; 3];
    for atom in atoms {
        let d = (atom.place - middle).to_array();
        for (row, di) in m.iter_mut().zip(d) {
            row.iter_mut().zip(d).for_each(|(sum, dj)| *sum += di * dj);
        }
    }
    let (values, vectors) = eigen(m);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
    let is_line = values[order[1]] <= 1e-6 * values[order[0]];
    (!is_line).then(|| order.map(|i| vectors.col(i)))
}

/// The eigenvalues of a symmetric matrix, and its eigenvectors as columns, by Jacobi's rotations (1846).
fn eigen(mut m: [[f64; 3]; 3]) -> ([f64; 3], DMat3) {
    /// More than enough: the rest falls quadratically.
    const SWEEPS: usize = 16;
    let mut vectors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for (p, q) in [(0, 1), (0, 2), (1, 2)].repeat(SWEEPS) {
        if m[p][q] == 0.0 {
            continue;
        }
        let theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
        let tan = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
        let cos = 1.0 / (tan * tan + 1.0).sqrt();
        let sin = tan * cos;
        for row in m.iter_mut().chain(&mut vectors) {
            (row[p], row[q]) = (cos * row[p] - sin * row[q], sin * row[p] + cos * row[q]);
        }
        for k in 0..3 {
            (m[p][k], m[q][k]) = (cos * m[p][k] - sin * m[q][k], sin * m[p][k] + cos * m[q][k]);
        }
    }
    ([m[0][0], m[1][1], m[2][2]], DMat3::from_cols_array_2d(&vectors).transpose())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn atom(symbol: &str, place: [f64; 3]) -> Atom {
        let element = Element::of_symbol(symbol).unwrap();
        Atom { element, place: place.into(), is_water: false }
    }

    #[test]
    fn formulas_are_in_hills_order() {
        let of = |symbols: &[&str]| {
            formula(&symbols.iter().map(|symbol| atom(symbol, [0.0; 3])).collect::<Vec<_>>())
        };
        assert_eq!(of(&["O", "H", "N", "C", "H", "Br"]), "C H2 Br N O");
        assert_eq!(of(&["O", "H", "H"]), "H2 O");
    }

    #[test]
    fn neighbours_are_bonded() {
        let atoms = [
            atom("H", [0.0, 0.763, -0.477]),
            atom("O", [0.0, 0.0, 0.119]),
            atom("H", [0.0, -0.763, -0.477]),
            // Another guess at the first one's place, and one that is too far away.
            atom("H", [0.1, 0.763, -0.477]),
            atom("O", [4.0, 0.0, 0.0]),
        ];
        let ends = bonds(&atoms);
        assert_eq!(ends.len(), 3, "{ends:?}");
        assert!(ends.iter().all(|ends| ends.contains(&atoms[1].place)));
    }

    #[test]
    fn sticks_lie_between_atoms() {
        let written = stick([DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)]);
        assert_eq!(written, "cylinder(0.12, 1.41421).rotate(0, 90, 45).translate(0.5, 0.5, 0)");
    }

    #[test]
    fn the_broad_side_is_seen() {
        let flat = [
            atom("C", [0.0, 0.0, 1.0]),
            atom("C", [3.0, 0.0, 1.0]),
            atom("C", [-3.0, 0.0, 1.0]),
            atom("C", [0.0, 1.0, 1.0]),
        ];
        let mut scene = String::new();
        camera(&mut scene, &flat, 0.5);
        assert_eq!(scene, "\n[camera]\ndirection = [0.2, -0.5, 1]\nup = [0, 1, 0]\n");
        assert!(axes(&flat[..3]).is_none() && axes(&flat[..1]).is_none());
    }

    proptest! {
        #[test]
        fn eigenvectors_are_turned_into_themselves(
            [a, b, c, d, e, f] in prop::array::uniform6(-10.0..10.0_f64),
        ) {
            let m = [[a, b, c], [b, d, e], [c, e, f]];
            let (values, vectors) = eigen(m);
            let matrix = DMat3::from_cols_array_2d(&m);
            for i in 0..3 {
                let v = vectors.col(i);
                prop_assert!((v.length() - 1.0).abs() < 1e-9);
                prop_assert!((matrix * v - values[i] * v).length() < 1e-9, "{values:?}");
            }
        }
    }
}
