//! PDB files: atoms of proteins and of what is bound to them, in columns. Of several models the first is
//! taken, and of a residue in several conformations the one that is there most often.
//!
//! *Based on:* Protein Data Bank, "Atomic Coordinate Entry Format Description", version 3.3.

use std::ops::Range;

use glam::DVec3;
use rustc_hash::FxHashMap;

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
    let Model { title, records, n_models } = read(source.text)?;
    let most_often = conformations(&records);
    let is_kept = |record: &&Record<'_>| {
        record.conformation == ' ' || most_often.get(record.residue) == Some(&record.conformation)
    };
    let kept: Vec<&Record<'_>> = records.iter().filter(is_kept).collect();
    // Where all is water, it is what is meant.
    let has_other = kept.iter().any(|record| !record.is_water);
    let atoms = kept.iter().map(|record| Atom {
        element: record.element,
        place: record.place,
        is_water: record.is_water && has_other,
    });
    let atoms = checked(atoms.collect())
        .map_err(|mistake| vec![mistake.help("the lines of atoms begin with ATOM or HETATM")])?;
    let mut notes = Vec::new();
    if n_models > 1 {
        notes.push(format!("the file has {n_models} models, of which the first is drawn"));
    }
    let n_left_out = records.len() - kept.len();
    if n_left_out > 0 {
        notes.push(format!("{n_left_out} atoms of rarer conformations are left out"));
    }
    let n_guessed = kept.iter().filter(|record| record.is_guessed).count();
    if n_guessed > 0 {
        notes.push(format!("the elements of {n_guessed} atoms were guessed from their names"));
    }
    Ok(converted((source, "a PDB file"), Some(&title), &atoms, notes))
}

/// What a file says of the first of its models.
struct Model<'a> {
    title: String,
    records: Vec<Record<'a>>,
    n_models: usize,
}

/// A line of an atom.
struct Record<'a> {
    element: &'static Element,
    /// Whether the file does not say the element.
    is_guessed: bool,
    place: DVec3,
    is_water: bool,
    /// Chain and number.
    residue: &'a str,
    /// A letter for one of several conformations, or a space.
    conformation: char,
    /// The part of all molecules in which the atom is there.
    occupancy: f64,
}

fn read(text: &str) -> Result<Model<'_>, Vec<Diagnostic>> {
    let mut model = Model { title: String::new(), records: Vec::new(), n_models: 0 };
    let mut mistakes = Vec::new();
    for (line, at) in lines(text) {
        match columns(line, 1..=6).trim() {
            "TITLE" => {
                model.title.push(' ');
                model.title.push_str(columns(line, 11..=80).trim());
            }
            "MODEL" => model.n_models += 1,
            "ATOM" | "HETATM" if model.n_models <= 1 => match record(line, &at) {
                Ok(record) => model.records.push(record),
                Err(mistake) => mistakes.push(mistake),
            },
            _ => {}
        }
        if mistakes.len() == MAX_MISTAKES {
            break;
        }
    }
    if mistakes.is_empty() { Ok(model) } else { Err(mistakes) }
}

/// Columns of a line, counted from 1, as far as the line has them. Columns are bytes; text beyond ASCII
/// stands in comments and titles only.
fn columns(line: &str, range: std::ops::RangeInclusive<usize>) -> &str {
    let end = line.len().min(*range.end());
    line.get(range.start() - 1..end).unwrap_or_default()
}

/// Where the `text` from a column on stands, or the line if there is none.
fn place_of(first: usize, text: &str, at: &Range<usize>) -> Range<usize> {
    let start = at.start + first - 1;
    if text.is_empty() { at.clone() } else { start..start + text.len() }
}

fn record<'a>(line: &'a str, at: &Range<usize>) -> Result<Record<'a>, Diagnostic> {
    let mut place = [0.0; 3];
    for (axis, (coordinate, first)) in place.iter_mut().zip([31, 39, 47]).enumerate() {
        let text = columns(line, first..=first + 7);
        let number: Option<f64> = text.trim().parse().ok();
        *coordinate = number.filter(|number| number.abs() <= FARTHEST).ok_or_else(|| {
            let axis = ['x', 'y', 'z'][axis];
            Diagnostic::new(
                place_of(first, text, at),
                format!("an atom has no {axis} in columns {first} to {}", first + 7),
            )
            .help("lines of PDB files are cut into columns, not words: x, y and z stand in columns 31 to 54")
        })?;
    }
    let residue_name = columns(line, 18..=20).trim();
    let said = columns(line, 77..=78).trim();
    let (element, is_guessed) = match Element::of_symbol(said) {
        Some(element) => (element, false),
        None => (guessed(line, residue_name, at)?, true),
    };
    Ok(Record {
        element,
        is_guessed,
        place: place.into(),
        is_water: matches!(residue_name, "HOH" | "WAT" | "DOD" | "H2O" | "TIP" | "SOL"),
        residue: columns(line, 22..=27),
        conformation: columns(line, 17..=17).chars().next().unwrap_or(' '),
        occupancy: columns(line, 55..=60).trim().parse().unwrap_or(1.0),
    })
}

/// The element by the atom's name. Symbols end in column 14, so that carbon's alpha, ` CA `, is not
/// calcium, `CA  `; names of four letters begin a column earlier, but only those of hydrogen are so long.
/// Where columns are not kept, only what is no residue of a protein has elements of two letters.
fn guessed(
    line: &str,
    residue_name: &str,
    at: &Range<usize>,
) -> Result<&'static Element, Diagnostic> {
    let name = columns(line, 13..=16);
    let letters = name.trim().trim_start_matches(|c: char| c.is_ascii_digit());
    let two = columns(line, 13..=14);
    let is_ion = residue_name == name.trim();
    let may_be_two = is_ion || (line.starts_with("HETATM") && !letters.starts_with('H'));
    let of_two = Element::of_symbol(two.trim()).filter(|element| element.symbol.len() == 2);
    let of_one = || letters.get(..1).and_then(Element::of_symbol);
    of_two.filter(|_| may_be_two).or_else(of_one).ok_or_else(|| {
        Diagnostic::new(place_of(13, name, at), "the element of an atom is unknown")
            .label("neither in columns 77 to 78 nor in the name")
            .help("write its symbol into columns 77 to 78")
    })
}

/// For each residue in several conformations, the one that is there most often; the first of equals.
fn conformations<'a>(records: &[Record<'a>]) -> FxHashMap<&'a str, char> {
    let mut shares: FxHashMap<&str, Vec<(char, f64)>> = FxHashMap::default();
    for record in records.iter().filter(|record| record.conformation != ' ') {
        let shares = shares.entry(record.residue).or_default();
        match shares.iter_mut().find(|(letter, _)| *letter == record.conformation) {
            Some((_, share)) => *share += record.occupancy,
            None => shares.push((record.conformation, record.occupancy)),
        }
    }
    let most = |shares: Vec<(char, f64)>| {
        let first = (' ', f64::NEG_INFINITY);
        shares.into_iter().fold(first, |most, other| if other.1 > most.1 { other } else { most }).0
    };
    shares.into_iter().map(|(residue, shares)| (residue, most(shares))).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// A line of an atom: what stands in columns 1 to 27, place, and what follows it.
    fn line(start: &str, x: f64, end: &str) -> String {
        format!("{start:<30}{x:8.3}{:8.3}{:8.3}{end}\n", 2.0, -3.0)
    }

    fn convert(text: &str) -> Result<Converted, Vec<Diagnostic>> {
        import(&Source { path: Path::new("a.pdb"), text, has_sticks: false })
    }

    /// The elements of lines that begin so, without any in their columns.
    fn elements(starts: &[&str]) -> Vec<&'static str> {
        let lines = starts.iter().map(|start| line(start, 0.0, ""));
        let text: String = lines.collect();
        read(&text).unwrap().records.iter().map(|record| record.element.symbol).collect()
    }

    #[test]
    fn elements_stand_in_their_columns() {
        let end = "  1.00 20.00          CL";
        let text = line("HETATM    1 CL1  LIG A   1", 1.0, end);
        let Converted { scene, notes } = convert(&text).unwrap();
        assert!(scene.contains("\"chlorine\"") && scene.contains("[1, 2, -3, 1.75]"), "{scene}");
        assert!(notes.is_empty());
    }

    #[test]
    fn elements_are_guessed() {
        let of = elements(&[
            "ATOM      1  CA  ALA A   1",
            "ATOM      2 1HB  ALA A   1",
            "ATOM      3 HD11 LEU A   2",
            "ATOM      4 HG   SER A   2",
            "ATOM      5 CA   ALA A   3",
            "HETATM    6 CA    CA A   4",
            "HETATM    7 FE   HEM A   5",
            "HETATM    8  NA  HEM A   5",
            "HETATM    9 HO2' LIG A   6",
            "HETATM   10  OD1 LIG A   6",
        ]);
        assert_eq!(of, ["C", "H", "H", "H", "C", "Ca", "Fe", "N", "H", "O"]);
    }

    #[test]
    fn one_model_and_one_conformation() {
        let end = |part: f64| format!("{part:6.2}{:>18}", "C");
        let text = [
            "TITLE     A PROTEIN\nMODEL        1\n".to_owned(),
            line("ATOM      1  CA AALA A   1", 1.0, &end(0.4)),
            line("ATOM      1  CA BALA A   1", 2.0, &end(0.6)),
            line("ATOM      2  CB  ALA A   1", 3.0, &end(1.0)),
            line("ATOM      3  CA AALA A   2", 4.0, &end(0.5)),
            line("ATOM      3  CA BALA A   2", 5.0, &end(0.5)),
            line("HETATM    4  O   HOH A   3", 6.0, ""),
            "ENDMDL\nMODEL        2\n".to_owned(),
            line("ATOM      1  CA  ALA A   1", 7.0, &end(1.0)),
        ];
        let Converted { scene, notes } = convert(&text.concat()).unwrap();
        let xs: Vec<&str> = scene
            .lines()
            .filter_map(|line| line.trim().strip_prefix('[')?.split_once(", 2, -3, 1."))
            .map(|(x, _)| x)
            .collect();
        assert_eq!(xs, ["2", "3", "4", "6"]);
        assert!(scene.contains("title = \"A PROTEIN\"") && scene.contains("\"oxygen of water\""));
        assert_eq!(
            notes,
            [
                "the file has 2 models, of which the first is drawn",
                "2 atoms of rarer conformations are left out",
                "the elements of 1 atoms were guessed from their names"
            ]
        );
    }

    #[test]
    fn water_alone_is_what_is_meant() {
        let scene = convert(&line("HETATM    1  O   HOH A   1", 0.0, "")).unwrap().scene;
        assert!(scene.contains("\"oxygen\"") && !scene.contains("of water"));
    }

    #[test]
    fn what_is_wrong_is_said() {
        let said = |text: &str| {
            let [mistake] = convert(text).unwrap_err().try_into().unwrap();
            (mistake.message, text[mistake.span].to_owned())
        };
        assert_eq!(said("HEADER\n").0, "the file has no atoms");
        assert_eq!(
            said("ATOM      1  CA  ALA A   1       1.000   2.0x0   3.000\n"),
            ("an atom has no y in columns 39 to 46".to_owned(), "   2.0x0".to_owned())
        );
        let no_x = ("an atom has no x in columns 31 to 38".to_owned(), "ATOM".to_owned());
        assert_eq!(said("ATOM\n"), no_x);
        let text = line("ATOM      1  ??  ALA A   1", 0.0, "");
        assert_eq!(
            said(&text),
            ("the element of an atom is unknown".to_owned(), " ?? ".to_owned())
        );
        let many = "ATOM\n".repeat(99);
        assert_eq!(convert(&many).unwrap_err().len(), MAX_MISTAKES);
    }
}
