//! Gaussian cube files: orbitals, densities and potentials of molecules as decimal numbers.
//!
//! Two lines of text; the number of atoms and the place of the first sample; for each axis how many
//! samples it has and the step between them; a line for each atom; then the samples, z fastest. With a
//! negative number of atoms, a list of orbitals follows the atoms, and each sample is as many numbers as
//! the list is long. Lengths are in Bohr, or in Ångström where the numbers of samples are negative; here
//! they are in Ångström always, so that a volume fits the atoms of other files. Steps may be oblique.
//!
//! *Based on:* Gaussian, Inc., documentation of `cubegen`; B. Skinn, "Gaussian CUBE File Format",
//! h5cube-spec.readthedocs.io. Negative numbers of samples are as in VMD.

use std::{
    io::{BufRead, BufReader, Read as _},
    path::Path,
    str::FromStr,
};

use flate2::bufread::MultiGzDecoder;
use glam::{DMat3, DVec3};

use super::{
    Refusal, SampleType, Samples, Volume,
    bytes::{Packing, head, ratio},
    checked_size,
    placing::placing,
    room::check_room,
    times, with_room,
};
use crate::files;

/// Ångström in a Bohr radius (CODATA 2022).
pub const BOHR: f64 = 0.529_177_210_544;

/// The most atoms, and the most orbitals, of a file.
const MAX_LISTED: usize = 1_000_000;

/// The longest line in bytes; some programs write a whole row of samples into one.
const MAX_LINE: u64 = 1 << 20;

/// What stands before the samples of a cube file.
#[derive(Clone, Debug, PartialEq)]
pub struct CubeHeader {
    /// The two lines of text.
    pub titles: [String; 2],
    /// The atoms: their numbers in the periodic table, 0 for what is none, and places in Ångström.
    pub atoms: Vec<(u32, DVec3)>,
    /// The numbers of its orbitals, as the file lists them; of values without a list, from 1.
    pub orbitals: Vec<i64>,
    /// The number of samples along the file's axes.
    size: [u32; 3],
    /// A step along each axis as a column, and where the first sample is, in Ångström.
    steps: DMat3,
    first: DVec3,
}

impl CubeHeader {
    /// Reads the header of a cube file, which may be packed with gzip.
    ///
    /// # Errors
    /// What is wrong in it and what would be right.
    pub fn read(path: &Path) -> Result<Self, Refusal> {
        Self::from_lines(&mut Lines::open(path)?)
    }

    fn from_lines(lines: &mut Lines) -> Result<Self, Refusal> {
        let titles = [lines.title()?, lines.title()?];
        let wanted = "the number of atoms and the place of the first sample";
        let (count, first, rest) = lines.row::<i64, 3>(wanted)?;
        let per_sample = match rest.as_slice() {
            [] => 1,
            [n] => {
                let number = n.parse::<i64>().ok().filter(|n| (1..=MAX_LISTED as i64).contains(n));
                let wanted = "how many values each sample has";
                number.ok_or_else(|| lines.wrong(&format!("`{}`", excerpt(n)), wanted))?
            }
            _ => return Err(lines.wrong("more numbers", wanted)),
        };
        let mut axes = [(0, DVec3::ZERO); 3];
        for axis in &mut axes {
            let wanted = "how many samples an axis has, and the step between them";
            let (n, step, _) = lines.row::<i64, 3>(wanted)?;
            *axis = (n, DVec3::from_array(step));
        }
        let unit = match axes.map(|(n, _)| n.signum()) {
            [-1, -1, -1] => 1.0,
            signs if signs.contains(&-1) => {
                return Err("some of its numbers of samples are negative and some are not: \
                            all mean Bohr if positive, Ångström if negative"
                    .to_owned());
            }
            _ => BOHR,
        };
        let size = checked_size(axes.map(|(n, _)| n.unsigned_abs()))?;
        let n_atoms = count.unsigned_abs();
        if n_atoms > MAX_LISTED as u64 {
            return Err(format!("it has {n_atoms} atoms, and at most {MAX_LISTED} can be read"));
        }
        let mut atoms = Vec::new();
        for _ in 0..n_atoms {
            let wanted = "an atom: its number, its charge and its place";
            let (number, [_, x, y, z], _) = lines.row::<i64, 4>(wanted)?;
            atoms.push((u32::try_from(number).unwrap_or(0), unit * DVec3::new(x, y, z)));
        }
        let orbitals = match count < 0 {
            true if per_sample != 1 => {
                return Err("it has a list of orbitals, and says how many values each sample has \
                            as well"
                    .to_owned());
            }
            true => lines.list()?,
            false => (1..=per_sample).collect(),
        };
        let [x, y, z] = axes.map(|(_, step)| unit * step);
        let steps = DMat3::from_cols(x, y, z);
        Ok(Self { titles, atoms, orbitals, size, steps, first: unit * DVec3::from_array(first) })
    }

    /// Which value of each sample is meant.
    fn index_of(&self, orbital: Option<i64>) -> Result<usize, Refusal> {
        let list = || {
            let shown: Vec<String> = self.orbitals.iter().take(12).map(i64::to_string).collect();
            shown.join(", ") + if self.orbitals.len() > shown.len() { ", …" } else { "" }
        };
        match orbital {
            None if self.orbitals.len() == 1 => Ok(0),
            None => {
                let example = self.orbitals[0];
                Err(format!(
                    "it holds the orbitals {}: say which, as in orbital = {example}",
                    list()
                ))
            }
            Some(wanted) => self
                .orbitals
                .iter()
                .position(|&number| number == wanted)
                .ok_or_else(|| format!("it has no orbital {wanted}, but {}", list())),
        }
    }
}

/// Reads the samples of one orbital, which must be named if there are several.
pub(super) fn read(
    path: &Path,
    orbital: Option<i64>,
    max_memory: Option<u64>,
) -> Result<Volume, Refusal> {
    let mut lines = Lines::open(path)?;
    let header = CubeHeader::from_lines(&mut lines)?;
    let index = header.index_of(orbital)?;
    let placing = placing(header.steps, header.first)?;
    check_room(header.size, SampleType::F32, max_memory)?;
    let samples = Samples::F32(samples(lines, &header, index)?);
    Ok(Volume { size: header.size, samples, placing })
}

/// One value of each sample, x fastest.
fn samples(mut lines: Lines, header: &CubeHeader, index: usize) -> Result<Vec<f32>, Refusal> {
    let [nx, ny, nz] = header.size.map(|n| n as usize);
    let n_each = header.orbitals.len();
    let n = nx * ny * nz;
    let wanted = n.saturating_mul(n_each);
    let what = times(header.size.map(u64::from));
    let what = if n_each == 1 { what } else { format!("{what} times {n_each}") };
    // A number is a digit at least, and a space between it and the next.
    if wanted as u64 > lines.at_most / 2 + 1 {
        return Err(format!("it is too short for {what} numbers"));
    }
    let mut samples = with_room(n, "samples")?;
    samples.resize(n, f32::NAN);
    let mut found = 0;
    while lines.next()? {
        for word in lines.words()? {
            if found == wanted {
                return Err(format!("it holds more numbers than the {wanted} that {what} are"));
            }
            let value = number(word).ok_or_else(|| {
                let word = excerpt(word);
                format!("line {}: `{word}` instead of a number", lines.number)
            })?;
            if found % n_each == index {
                let at = found / n_each;
                let (i, j, k) = (at / (ny * nz), at / nz % ny, at % nz);
                samples[(k * ny + j) * nx + i] = value;
            }
            found += 1;
        }
    }
    if found < wanted {
        return Err(format!("it ends after {found} numbers, and {what} are {wanted}"));
    }
    Ok(samples)
}

/// A number as Fortran writes it too: `1.5D-3`, and `1.5-103` where the exponent has three digits.
fn number(word: &str) -> Option<f32> {
    let written = |text: &str| text.parse::<f32>().ok();
    written(word).or_else(|| {
        let sign = word.rfind(['+', '-']).filter(|&at| at > 0);
        let end = word.find(['d', 'D']).or(sign)?;
        let exponent = word[end..].trim_start_matches(['d', 'D']);
        written(&format!("{}e{exponent}", &word[..end]))
    })
}

fn excerpt(word: &str) -> String {
    word.chars().take(40).collect()
}

/// The lines of a file, one at a time.
struct Lines {
    bytes: Box<dyn BufRead>,
    /// The bytes that the file has at most, unpacked.
    at_most: u64,
    line: Vec<u8>,
    /// From 1.
    number: u64,
}

impl Lines {
    fn open(path: &Path) -> Result<Self, Refusal> {
        let is_packed = head(files::open(path)?.0, Packing::Plain, 2)? == [0x1f, 0x8b];
        let (file, length) = files::open(path)?;
        let file = BufReader::new(file);
        let (bytes, at_most): (Box<dyn BufRead>, u64) = match is_packed {
            true => (Box::new(BufReader::new(MultiGzDecoder::new(file))), ratio(length)),
            false => (Box::new(file), length),
        };
        Ok(Self { bytes, at_most, line: Vec::new(), number: 0 })
    }

    /// Goes on to the next line, if there is one.
    fn next(&mut self) -> Result<bool, Refusal> {
        self.line.clear();
        self.number += 1;
        let n = self
            .bytes
            .by_ref()
            .take(MAX_LINE)
            .read_until(b'\n', &mut self.line)
            .map_err(|error| format!("it cannot be read: {error}"))?;
        match n as u64 == MAX_LINE {
            true => Err(format!("line {} is longer than {} KiB", self.number, MAX_LINE >> 10)),
            false => Ok(n > 0),
        }
    }

    fn words(&self) -> Result<std::str::SplitAsciiWhitespace<'_>, Refusal> {
        let text = std::str::from_utf8(&self.line);
        text.map(str::split_ascii_whitespace)
            .map_err(|_| format!("line {} is not text", self.number))
    }

    fn wrong(&self, found: &str, wanted: &str) -> Refusal {
        format!("line {}: {found} instead of {wanted}", self.number)
    }

    fn title(&mut self) -> Result<String, Refusal> {
        if !self.next()? {
            return Err(format!("it ends after {} lines", self.number - 1));
        }
        Ok(String::from_utf8_lossy(&self.line).trim().to_owned())
    }

    /// A line with a number, `N` numbers and perhaps more, which are called `wanted`.
    fn row<T: FromStr, const N: usize>(
        &mut self,
        wanted: &str,
    ) -> Result<(T, [f64; N], Vec<String>), Refusal> {
        if !self.next()? {
            return Err(self.wrong("the end of the file", wanted));
        }
        let mut words = self.words()?;
        let first = words.next().and_then(|word| word.parse().ok());
        let mut numbers = [f64::NAN; N];
        for number in &mut numbers {
            *number = words.next().and_then(|word| word.parse().ok()).unwrap_or(f64::NAN);
        }
        let rest = words.map(str::to_owned).collect();
        match first.filter(|_| numbers.iter().all(|number| number.is_finite())) {
            Some(first) => Ok((first, numbers, rest)),
            None => {
                let line = String::from_utf8_lossy(&self.line);
                let line = line.trim();
                let end = if line.chars().count() > 40 { "…" } else { "" };
                Err(self.wrong(&format!("`{}{end}`", excerpt(line)), wanted))
            }
        }
    }

    /// How many numbers there are, and the numbers, on as many lines as they take.
    fn list(&mut self) -> Result<Vec<i64>, Refusal> {
        let wanted = "the list of orbitals: how many there are, and their numbers";
        let mut length = None;
        let mut list = Vec::new();
        while length.is_none_or(|n| list.len() < n) {
            if !self.next()? {
                return Err(self.wrong("the end of the file", wanted));
            }
            for word in self.words()? {
                let number: Option<i64> = word.parse().ok();
                let wrong = || self.wrong(&format!("`{}`", excerpt(word)), wanted);
                let number = number.ok_or_else(wrong)?;
                match length {
                    None if (1..=MAX_LISTED as i64).contains(&number) => {
                        length = Some(number as usize);
                    }
                    Some(n) if list.len() < n => list.push(number),
                    _ => return Err(wrong()),
                }
            }
        }
        Ok(list)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::tests::{Folder, gzip, place, read};

    /// Two atoms and 2 x 1 x 3 samples, of which (i, 0, k) is 10 i + k.
    const PLAIN: &str = "water\nan orbital\n 2 1.0 2.0 3.0\n 2 0.5 0 0\n 1 0 0.5 0\n 3 0 0 0.25\n\
                         8 8.0 0 0 1\n 1 1.0 0 2 0\n 0 1 2\n 1.0E+01 1.1D1 1.2+1\n";

    fn said(text: &str) -> Refusal {
        read("a.cube", text.as_bytes()).unwrap_err()
    }

    #[test]
    fn samples_and_places() {
        let volume = read("a.cube", PLAIN.as_bytes()).unwrap();
        assert_eq!(volume.size, [2, 1, 3]);
        assert_eq!(volume.samples, Samples::F32(vec![0.0, 10.0, 1.0, 11.0, 2.0, 12.0]));
        assert_eq!(place(&volume, [0, 0, 0]), BOHR * DVec3::new(1.0, 2.0, 3.0));
        let last = BOHR * DVec3::new(1.5, 2.0, 3.5);
        assert!((place(&volume, [1, 0, 2]) - last).length() < 1e-15);
        assert_eq!(read("a.cub.gz", &gzip(PLAIN.as_bytes())).unwrap(), volume);
        let header = CubeHeader::read(&Folder::new().with("a.cube", PLAIN.as_bytes())).unwrap();
        assert_eq!(header.titles, ["water", "an orbital"]);
        assert_eq!(header.atoms, [(8, BOHR * DVec3::Z), (1, BOHR * 2.0 * DVec3::Y)]);
    }

    #[test]
    fn negative_numbers_of_samples_mean_angstrom() {
        let text = PLAIN.replace("\n 2 0.5", "\n -2 0.5").replace("\n 1 0 0.5", "\n -1 0 0.5");
        assert!(said(&text).starts_with("some of its numbers of samples are negative"));
        let volume = read("a.cube", text.replace("\n 3 0", "\n -3 0").as_bytes()).unwrap();
        assert_eq!(place(&volume, [1, 0, 2]), DVec3::new(1.5, 2.0, 3.5));
    }

    #[test]
    fn one_of_several_orbitals() {
        let text = "\n\n -1 0 0 0\n 1 1 0 0\n 1 0 1 0\n 2 0 0 1\n 1 1 0 0 0\n 3 20 21\n 22\n\
                    1 2 3 4\n5 6\n";
        let path = Folder::new();
        let path = path.with("a.cub", text.as_bytes());
        let of = |orbital| Volume::read_orbital(&path, orbital, None).map(|volume| volume.samples);
        assert_eq!(of(20).unwrap(), Samples::F32(vec![1.0, 4.0]));
        assert_eq!(of(22).unwrap(), Samples::F32(vec![3.0, 6.0]));
        assert_eq!(of(1).unwrap_err(), "it has no orbital 1, but 20, 21, 22");
        assert_eq!(said(text), "it holds the orbitals 20, 21, 22: say which, as in orbital = 20");
        // Without a list, values are counted.
        let text = "\n\n 0 0 0 0 2\n 1 1 0 0\n 1 0 1 0\n 1 0 0 1\n 7 8\n";
        assert_eq!(said(text), "it holds the orbitals 1, 2: say which, as in orbital = 1");
    }

    #[test]
    fn what_is_wrong_is_said() {
        assert_eq!(said(""), "it ends after 0 lines");
        assert_eq!(
            said("a\nb\n x 1 2 3\n"),
            "line 3: `x 1 2 3` instead of the number of atoms and the place of the first sample"
        );
        assert!(said("a\nb\n").starts_with("line 3: the end of the file instead of the number of"));
        assert_eq!(
            said(&PLAIN.replace(" 3 0 0 0.25", "3 0 0")),
            "line 6: `3 0 0` instead of how many samples an axis has, and the step between them"
        );
        assert_eq!(
            said(&PLAIN.replace(" 0 1 2\n", "")),
            "it ends after 3 numbers, and 2 x 1 x 3 are 6"
        );
        assert_eq!(
            said(&PLAIN.replace("1.2+1", "1.2+1 7")),
            "it holds more numbers than the 6 that 2 x 1 x 3 are"
        );
        assert_eq!(said(&PLAIN.replace("1.2+1", "*****")), "line 10: `*****` instead of a number");
        assert_eq!(
            said(&PLAIN.replace("\n 2 0.5", "\n 2000000 0.5")),
            "it is too short for 2000000 x 1 x 3 numbers"
        );
        assert!(
            said(&PLAIN.replace("0 0.5 0", "0.5 0 0")).starts_with("its samples lie in a plane")
        );
    }

    #[test]
    fn numbers_of_fortran() {
        let all = ["1.5", "-1.5E-3", "1.5D-03", "-1.5-3", "+2", "1.5d+2"].map(number);
        assert_eq!(all, [1.5, -1.5e-3, 1.5e-3, -1.5e-3, 2.0, 150.0].map(Some));
        assert_eq!(number("0.12345-103"), Some(0.0));
        assert_eq!(["-", "e", "1-", "D5", "1.5x", ""].map(number), [None; 6]);
    }
}
