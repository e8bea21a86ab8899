//! XYZ files: how many atoms there are, a line of text, and for each atom its element and place in
//! Ångström. Several such frames may follow each other; the first is taken.

use std::ops::Range;

use glam::DVec3;

use super::{
    Converted, Source,
    elements::Element,
    lines,
    molecule::{Atom, FARTHEST, checked, converted},
};
use crate::diagnostic::Diagnostic;

/// Mistakes after this many are not told.
const MAX_MISTAKES: usize = 8;

/// The scene of such a file.
pub(super) fn import(source: &Source<'_>) -> Result<Converted, Vec<Diagnostic>> {
    let Frame { title, atoms, n_ghosts, has_more } = read(source.text)?;
    let atoms = checked(atoms).map_err(|mistake| vec![mistake])?;
    let mut notes = Vec::new();
    if has_more {
        notes.push("the file has several frames, of which the first is drawn".to_owned());
    }
    if n_ghosts > 0 {
        notes.push(format!("{n_ghosts} points that are no atoms are left out"));
    }
    // What programs write for each other is no title.
    let title = Some(title).filter(|title| !title.contains('='));
    Ok(converted((source, "an XYZ file"), title, &atoms, notes))
}

/// The first frame of a file.
struct Frame<'a> {
    title: &'a str,
    atoms: Vec<Atom>,
    /// Points without an element, such as centres of rings.
    n_ghosts: usize,
    /// Whether other frames follow.
    has_more: bool,
}

fn read(text: &str) -> Result<Frame<'_>, Vec<Diagnostic>> {
    let mut lines = lines(text);
    let (first, at) = lines.next().unwrap_or(("", 0..0));
    let n: usize = first.trim().parse().map_err(|_| {
        vec![Diagnostic::new(at, "the first line is not the number of atoms").help(
            "an XYZ file is the number of atoms, a line of text, and lines such as C 0 1.4 0",
        )]
    })?;
    let (title, _) = lines.next().unwrap_or_default();
    let mut frame = Frame { title, atoms: Vec::new(), n_ghosts: 0, has_more: false };
    let mut mistakes = Vec::new();
    for i in 0..n {
        let Some((line, at)) = lines.next().filter(|(line, _)| !line.trim().is_empty()) else {
            let end = text.trim_end().len();
            mistakes.push(
                Diagnostic::new(end..end, format!("the file ends after {i} atoms"))
                    .help(format!("its first line says that there are {n}")),
            );
            break;
        };
        match atom(line, &at) {
            Ok(Some(atom)) => frame.atoms.push(atom),
            Ok(None) => frame.n_ghosts += 1,
            Err(mistake) => mistakes.push(mistake),
        }
        if mistakes.len() == MAX_MISTAKES {
            break;
        }
    }
    frame.has_more = lines.any(|(line, _)| !line.trim().is_empty());
    if mistakes.is_empty() { Ok(frame) } else { Err(mistakes) }
}

/// The atom of a line; nothing if it is a point without an element.
fn atom(line: &str, at: &Range<usize>) -> Result<Option<Atom>, Diagnostic> {
    let mut words = line.split_ascii_whitespace();
    let name = words.next().unwrap_or_default();
    let place = [(); 3].map(|()| words.next().and_then(number));
    let [Some(x), Some(y), Some(z)] = place else {
        return Err(Diagnostic::new(at.clone(), "an atom has no place")
            .label("not an element and three numbers")
            .help("write it as in C 0.0 1.4 0.0"));
    };
    // Some programs number the atoms of an element: C1, C2.
    let symbol = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let element = match name.parse() {
        Ok(0) => return Ok(None),
        Ok(number) => Element::of_number(number),
        Err(_) => Element::of_symbol(symbol),
    };
    match element {
        Some(element) => Ok(Some(Atom { element, place: DVec3::new(x, y, z), is_water: false })),
        None if GHOSTS.contains(&symbol.to_ascii_lowercase().as_str()) => Ok(None),
        None => {
            let start = at.start + line.len() - line.trim_start().len();
            Err(Diagnostic::new(start..start + name.len(), format!("`{name}` is no element"))
                .help("an atom begins with the symbol of its element, such as C or Cl"))
        }
    }
}

/// What stands for points that are no atoms.
const GHOSTS: [&str; 5] = ["x", "xx", "du", "bq", "q"];

/// A coordinate, also as Fortran writes it.
fn number(word: &str) -> Option<f64> {
    let number: Option<f64> = word.replace(['d', 'D'], "e").parse().ok();
    number.filter(|number| number.abs() <= FARTHEST)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    const WATER: &str =
        "3\nwater\nO 0 0 0.119262\nH 0 0.763239 -0.477047 0.4\r\n1 0 -0.763239 -4.77047D-1\n";

    fn convert(text: &str) -> Result<Converted, Vec<Diagnostic>> {
        import(&Source { path: Path::new("water.xyz"), text, has_sticks: false })
    }

    fn mistake(text: &str) -> (String, String) {
        let [mistake] = convert(text).unwrap_err().try_into().unwrap();
        (mistake.message, text[mistake.span].to_owned())
    }

    #[test]
    fn elements_become_surfaces() {
        let Converted { scene, notes } = convert(WATER).unwrap();
        assert!(notes.is_empty());
        for part in [
            "title = \"water\"",
            "note = \"H2 O: 3 atoms\"",
            "name = \"oxygen\"\ncolor = \"#ff0d0d\"\nspheres = [\n  [0, 0, 0.11926, 1.52],\n]\n",
            "  [0, 0.76324, -0.47705, 1.2],\n  [0, -0.76324, -0.47705, 1.2],\n]\n",
        ] {
            assert!(scene.contains(part), "{scene}");
        }
    }

    #[test]
    fn further_frames_and_ghosts_are_told() {
        let text = format!("4\nenergy=1\nBq 1 2 3\n{}\n{WATER}", &WATER[8..]);
        let Converted { scene, notes } = convert(&text).unwrap();
        assert!(!scene.contains("title"));
        assert_eq!(notes.len(), 2, "{notes:?}");
        assert!(notes[0].contains("several frames") && notes[1].starts_with("1 points"));
    }

    #[test]
    fn what_is_wrong_is_said() {
        let said = |text: &str| mistake(text).0;
        assert_eq!(said("C 0 0 0\n"), "the first line is not the number of atoms");
        assert_eq!(said(""), "the first line is not the number of atoms");
        assert_eq!(said("0\n\n"), "the file has no atoms");
        assert_eq!(said("2\n\nC 0 0 0\n"), "the file ends after 1 atoms");
        assert_eq!(said("1000000000000\n\n"), "the file ends after 0 atoms");
        let no_element = ("`Qq1` is no element".to_owned(), "Qq1".to_owned());
        assert_eq!(mistake("1\n\n  Qq1 0 0 0\n"), no_element);
        let no_place = ("an atom has no place".to_owned(), "C 0 0 inf".to_owned());
        assert_eq!(mistake("1\n\nC 0 0 inf\n"), no_place);
        let many = format!("99\n\n{}", "C\n".repeat(99));
        assert_eq!(convert(&many).unwrap_err().len(), MAX_MISTAKES);
    }
}
