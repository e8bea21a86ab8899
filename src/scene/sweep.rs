//! Sweeps: variants of a scene in which parameters have other values, all in the same light and from the
//! same place.

use std::ops::Range;

use super::{
    caption::captions,
    definitions::{no_parameter, settable},
    frames::MAX_FRAMES,
    lower::Lower,
    spanned::Spanned,
    spec::{SceneSpec, ValuesSpec},
    track::Track,
};
use crate::{
    diagnostic::Diagnostic,
    output::sheet::{self, Grid, LINE_PX},
    raster::ImageSettings,
};

/// The variants of a scene: all combinations of the values of some parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// At least one, in the order of the file: the last one changes from each frame to the next.
    pub params: Vec<Swept>,
}

/// A parameter of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Swept {
    /// What it is called.
    pub name: String,
    /// At least one.
    pub values: Vec<f64>,
    /// What captions say of each.
    words: Vec<String>,
    /// Where they are written.
    span: Range<usize>,
}

/// A contact sheet is not wider and not higher if smaller pictures help, in pixels.
const SHEET_PX: usize = 4096;
/// It cannot be wider or higher.
const MAX_SHEET_PX: usize = 16_384;
/// Pictures are not made smaller than this.
const LEAST_PX: usize = 64;
/// Between what is said of two parameters.
const BETWEEN: &str = ", ";
/// Between neighbouring pictures, and below captions.
const GAP_PX: usize = 8;

impl Sweep {
    /// How many variants there are.
    #[must_use]
    pub fn n_frames(&self) -> usize {
        self.params.iter().fold(1, |n, swept| n.saturating_mul(swept.values.len()))
    }

    /// The place of each parameter's value in a frame, which counts from 1.
    fn places(&self, number: u32) -> Vec<usize> {
        let mut rest = number.saturating_sub(1) as usize;
        let mut place = |swept: &Swept| {
            let place = rest % swept.values.len();
            rest /= swept.values.len();
            place
        };
        let mut places: Vec<usize> = self.params.iter().rev().map(&mut place).collect();
        places.reverse();
        places
    }

    /// What is said of a frame, which counts from 1: `a = 0.30` for each parameter.
    #[must_use]
    pub fn caption(&self, number: u32) -> Vec<&str> {
        let params = self.params.iter().zip(self.places(number));
        params.map(|(swept, place)| swept.words[place].as_str()).collect()
    }

    /// The contact sheet: a row for each value of the first of two parameters, else about as many rows as
    /// columns. Pictures of `image` are in it as they are, or smaller by a whole factor, which is given
    /// too.
    #[must_use]
    pub fn sheet(&self, image: &ImageSettings) -> (Grid, usize) {
        let n_columns = match self.params.as_slice() {
            [only] => columns(only.values.len()),
            [.., last] => last.values.len(),
            [] => 1,
        };
        let n_rows = self.n_frames().div_ceil(n_columns);
        let size = [image.width, image.height].map(|n| n as usize);
        let longest: Vec<String> =
            self.params.iter().map(|swept| "m".repeat(swept.longest_words())).collect();
        let longest_px = longest.iter().map(|words| sheet::width_px(words.len())).max();
        let grid = |factor: usize| {
            let picture_px = size.map(|n| n.div_ceil(factor));
            let room_px = longest_px.unwrap_or(0).max(picture_px[0]);
            let words = longest.iter().map(String::as_str);
            let n_lines = sheet::lines(words, BETWEEN, sheet::characters(room_px)).len();
            let width = room_px + GAP_PX;
            let height = picture_px[1] + n_lines * LINE_PX + GAP_PX;
            Grid { n_columns, n_rows, cell_px: [width, height], picture_px }
        };
        let is_small = |&factor: &usize| {
            let [width, height] = grid(factor).size_px();
            let is_least = size.iter().all(|n| n.div_ceil(factor) <= LEAST_PX);
            width.max(height) <= SHEET_PX || is_least
        };
        let factor = (1..).find(is_small).unwrap_or(1);
        (grid(factor), factor)
    }

    /// The lines of a caption in a cell of the contact sheet.
    #[must_use]
    pub fn lines(&self, number: u32, grid: &Grid) -> Vec<String> {
        let room = sheet::characters(grid.cell_px[0] - GAP_PX);
        sheet::lines(self.caption(number), BETWEEN, room)
    }

    /// The parameters with their values in each frame.
    pub(super) fn tracks(&self) -> Vec<Track> {
        let n_frames = self.n_frames().min(MAX_FRAMES as usize) as u32;
        let places: Vec<Vec<usize>> = (1..=n_frames).map(|number| self.places(number)).collect();
        let track = |(i, swept): (usize, &Swept)| Track {
            name: swept.name.clone(),
            section: "[sweep]",
            values: places.iter().map(|places| swept.values[places[i]]).collect(),
            span: swept.span.clone(),
        };
        self.params.iter().enumerate().map(track).collect()
    }
}

/// Columns of a sheet of `n` pictures, not fewer than rows, so that the last row is as full as can be.
fn columns(n: usize) -> usize {
    let square = n.isqrt() + usize::from(n.isqrt().pow(2) < n);
    let n_empty = |n_columns: &usize| n.div_ceil(*n_columns) * n_columns - n;
    (square..=(4 * n).isqrt()).min_by_key(n_empty).unwrap_or(1)
}

impl Swept {
    fn new(name: String, values: Vec<f64>, span: Range<usize>) -> Self {
        Self { words: captions(&name, &values), name, values, span }
    }

    /// The most characters that captions say of it.
    fn longest_words(&self) -> usize {
        self.words.iter().map(|words| words.chars().count()).max().unwrap_or(0)
    }
}

impl Lower<'_> {
    /// The variants, if the scene has a sweep, and notes what is wrong with it.
    pub(super) fn sweep(&mut self, spec: &SceneSpec) -> Option<Sweep> {
        let section = spec.sweep.as_ref()?;
        if spec.animation.is_some() {
            self.errors.push(
                Diagnostic::new(section.span.clone(), "the scene is a film already")
                    .label("[sweep] stands beside [animation]")
                    .help(
                        "remove one of the two; parameters of films change in [animation.params]",
                    ),
            );
        }
        let mut entries: Vec<_> = section.spec.iter().collect();
        entries.sort_by_key(|(name, _)| name.span().start);
        let mut params: Vec<Swept> = Vec::new();
        for (written, spec_of_values) in entries {
            let span = spec_of_values.span();
            match settable(written.get_ref(), &spec.params, &spec.lets) {
                Ok(name) if params.iter().any(|swept| swept.name == name) => self.errors.push(
                    Diagnostic::new(written.span(), format!("`{name}` is given twice"))
                        .label("the second one"),
                ),
                Ok(name) => {
                    let values = self.values_of(&name, spec_of_values);
                    params.extend(values.map(|values| Swept::new(name, values, span)));
                }
                Err(help) => {
                    self.errors.push(no_parameter(written.span(), written.get_ref(), &help));
                }
            }
        }
        if section.spec.is_empty() && !section.is_damaged {
            self.errors.push(
                Diagnostic::new(section.span.clone(), "the sweep has no parameter")
                    .help("add one with its values, as in a = [0, 1, 11]"),
            );
        }
        let (last, sweep) = (params.last()?.span.clone(), Sweep { params });
        let n_frames = sweep.n_frames();
        if n_frames > MAX_FRAMES as usize {
            let factors: Vec<String> =
                sweep.params.iter().map(|swept| swept.values.len().to_string()).collect();
            let message = match factors.as_slice() {
                [_] => format!("the sweep has {n_frames} frames"),
                factors => format!("the sweep has {} = {n_frames} frames", factors.join(" x ")),
            };
            self.errors.push(
                Diagnostic::new(last, message)
                    .label(format!("more than {MAX_FRAMES}"))
                    .help("choose fewer values, or fewer parameters"),
            );
        }
        Some(sweep)
    }

    /// The values of a parameter, if they make sense.
    fn values_of(&mut self, name: &str, written: &Spanned<ValuesSpec>) -> Option<Vec<f64>> {
        let (message, label) = match written.get_ref() {
            ValuesSpec::Listed(values) if !values.is_empty() => return Some(values.clone()),
            ValuesSpec::Listed(_) => (format!("`{name}` has no values"), "expected one or more"),
            ValuesSpec::Even([first, last, _]) if first == last => {
                (format!("`{name}` does not change"), "the first value is the last one")
            }
            &ValuesSpec::Even([first, last, n]) => {
                if n.fract() == 0.0 && (2.0..=f64::from(MAX_FRAMES)).contains(&n) {
                    let parts = n - 1.0;
                    let value = |i: u32| {
                        let (i, rest) = (f64::from(i), parts - f64::from(i));
                        (rest * first + i * last) / parts
                    };
                    return Some((0..n as u32).map(value).collect());
                }
                let message = format!("`{name}` cannot have {n} values");
                (message, "the third number is how many: from 2 to 10000")
            }
        };
        self.errors.push(
            Diagnostic::new(written.span(), message).label(label).help(
                "write [first, last, how many], or all values, as in { values = [0, 0.2, 1] }",
            ),
        );
        None
    }

    /// Complains about a contact sheet that would be too large.
    pub(super) fn check_sheet(&mut self, sweep: &Sweep, image: &ImageSettings, spec: &SceneSpec) {
        let [width, height] = sweep.sheet(image).0.size_px();
        if width.max(height) > MAX_SHEET_PX && self.errors.is_empty() {
            let section = spec.sweep.as_ref().map_or(0..0, |section| section.span.clone());
            let sheet = &spec.output.spec.sheet;
            let span = sheet.as_ref().map_or(section, Spanned::span);
            self.errors.push(
                Diagnostic::new(span, "the contact sheet would be too large")
                    .label(format!("{width} x {height} pixels, more than {MAX_SHEET_PX}"))
                    .help(
                        "choose fewer values, or write sheet = false in [output], so that there are \
                         single pictures alone",
                    ),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn swept(name: &str, values: &[f64]) -> Swept {
        Swept::new(name.to_owned(), values.to_vec(), 0..0)
    }

    #[test]
    fn the_last_parameter_changes_first() {
        let params =
            vec![swept("a", &[1.0, 2.0]), swept("b", &[5.0]), swept("c", &[3.0, 4.0, 6.0])];
        let sweep = Sweep { params };
        assert_eq!(sweep.n_frames(), 6);
        let values = sweep.tracks().into_iter().map(|track| track.values).collect::<Vec<_>>();
        assert_eq!(values[0], [1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
        assert_eq!(values[1], [5.0; 6]);
        assert_eq!(values[2], [3.0, 4.0, 6.0, 3.0, 4.0, 6.0]);
        assert_eq!(sweep.caption(5), ["a = 2", "b = 5", "c = 4"]);
    }

    #[test]
    fn sheets_have_no_long_gaps() {
        for (n, expected) in [(1, 1), (2, 2), (3, 3), (5, 3), (7, 4), (9, 3), (11, 4), (12, 4)] {
            assert_eq!(columns(n), expected, "{n}");
        }
        for n in 1..200 {
            let n_columns = columns(n);
            assert!(n_columns >= n.div_ceil(n_columns), "{n}: not higher than wide");
        }
    }
}
