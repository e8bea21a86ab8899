//! Mistakes in the user's text, as data. Only the command line prints them.

use std::{borrow::Cow, ops::Range, path::PathBuf};

/// One mistake: where it is, what it is, what would be right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// What is wrong, in one sentence without a full stop.
    pub message: String,
    /// The offending bytes of the text that `origin` names.
    pub span: Range<usize>,
    /// Which text that is.
    pub origin: Origin,
    /// A few words beside the marked text; may be empty.
    pub label: String,
    /// What to do about it.
    pub help: Option<String>,
}

impl Diagnostic {
    /// A mistake at `span` with nothing beside the marked text and no help.
    pub fn new(span: Range<usize>, message: impl Into<String>) -> Self {
        let (label, origin) = (String::new(), Origin::default());
        Self { message: message.into(), span, origin, label, help: None }
    }

    /// Adds words beside the marked text.
    #[must_use]
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    /// Adds what to do about it.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Moves the span by `offset` bytes: from a formula to the file that holds it.
    #[must_use]
    pub fn shifted(mut self, offset: usize) -> Self {
        self.span = self.span.start + offset..self.span.end + offset;
        self
    }
}

/// Which of the [`Sources`] a span belongs to. The order is that of the texts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Origin {
    /// The file.
    #[default]
    File,
    /// The model of this index.
    Model(usize),
    /// The setting of this index.
    Setting(usize),
}

/// The texts that a scene is made of.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    /// The file as the user named it.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// The files that it names.
    pub models: Vec<Model>,
    /// What was set for this run, as `name=value`.
    pub settings: Vec<String>,
}

/// A file that a scene names.
#[derive(Clone, Debug)]
pub struct Model {
    /// Where it is: the scene's folder and what the scene calls it.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
}

impl Sources {
    /// The text that spans of `origin` belong to, and what to call it.
    #[must_use]
    pub fn get(&self, origin: Origin) -> (Cow<'_, str>, &str) {
        match origin {
            Origin::File => (self.path.to_string_lossy(), &self.text),
            Origin::Model(index) => match self.models.get(index) {
                Some(model) => (model.path.to_string_lossy(), &model.text),
                None => Default::default(),
            },
            Origin::Setting(index) => {
                (Cow::Borrowed("--set"), self.settings.get(index).map_or("", String::as_str))
            }
        }
    }
}

/// A scene that was refused, with every mistake found in it.
#[derive(Clone, Debug)]
pub struct Rejection {
    /// The texts, for the excerpts.
    pub sources: Sources,
    /// At least one mistake, in the order of their places.
    pub diagnostics: Vec<Diagnostic>,
}

/// The candidate that `word` most likely meant, if one is close enough.
#[must_use]
pub fn did_you_mean<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    let limit = 1 + word.chars().count() / 4;
    candidates
        .into_iter()
        .map(|candidate| (edit_distance(word, candidate), candidate))
        // A word of which nothing is left was not misspelt.
        .filter(|&(distance, candidate)| {
            distance <= limit && distance < word.chars().count().max(candidate.chars().count())
        })
        .min()
        .map(|(_, candidate)| candidate)
}

/// Levenshtein distance over characters; a swap of neighbours counts as one (optimal string
/// alignment).
fn edit_distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut before = vec![0; b.len() + 1];
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let substituted = last[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            row[j] = substituted.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn close_words_are_suggested_and_far_ones_are_not() {
        let words = ["resolution", "domain", "sin", "sqrt"];
        assert_eq!(did_you_mean("resolutoin", words), Some("resolution"));
        assert_eq!(did_you_mean("sqr", words), Some("sqrt"));
        assert_eq!(did_you_mean("banana", words), None);
        assert_eq!(did_you_mean("q", ["e", "x"]), None);
    }
}
