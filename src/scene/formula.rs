//! The text of a formula with its place, so that its mistakes can be shown where it stands.

use std::ops::Range;

use super::{lower::Lower, spanned::Spanned};
use crate::{
    diagnostic::{Diagnostic, Origin},
    expr::{Ast, Expr, Mistake, Resolved, parse, parse_shape},
};

/// The text of a formula and where it stands.
#[derive(Clone, Debug)]
pub(super) struct Formula {
    text: String,
    origin: Origin,
    /// All of it, with its quotes.
    span: Range<usize>,
    /// Where its first character is, if it stands there literally, without escapes.
    start: Option<usize>,
    /// Whether it is a shape: then `|` and `&` join solids.
    is_shape: bool,
}

impl Formula {
    /// A formula that the file `source` holds as a string at `span`, quotes included.
    pub(super) fn of_string(text: &str, span: Range<usize>, source: &str) -> Self {
        let start = source.get(span.clone()).and_then(|written| start_of_literal(written, text));
        let start = start.map(|offset| span.start + offset);
        Self { text: text.to_owned(), origin: Origin::File, span, start, is_shape: false }
    }

    /// The formula `text` that stands for the number at `span` of the file `source`.
    pub(super) fn of_number(text: &str, span: Range<usize>, source: &str) -> Self {
        let start = (source.get(span.clone()) == Some(text)).then_some(span.start);
        Self { text: text.to_owned(), origin: Origin::File, span, start, is_shape: false }
    }

    /// What stands at `span` of the setting number `index`.
    pub(super) fn in_setting(index: usize, argument: &str, span: Range<usize>) -> Self {
        let (text, start) = (argument[span.clone()].to_owned(), Some(span.start));
        Self { text, origin: Origin::Setting(index), span, start, is_shape: false }
    }

    /// The same text, read as a shape.
    pub(super) fn into_shape(self) -> Self {
        Self { is_shape: true, ..self }
    }

    /// The same in another text.
    pub(super) fn in_text(self, origin: Origin) -> Self {
        Self { origin, ..self }
    }

    /// The text that it stands in.
    pub(super) fn origin(&self) -> Origin {
        self.origin
    }

    /// Moves a mistake in the formula to the text that holds it: exactly if the formula stands
    /// there literally, else to all of it.
    fn place(&self, mistake: Diagnostic) -> Diagnostic {
        let placed = match self.start {
            Some(start) => mistake.shifted(start),
            None => Diagnostic {
                span: self.span.clone(),
                label: "in this formula".to_owned(),
                ..mistake
            },
        };
        Diagnostic { origin: self.origin, ..placed }
    }

    /// A mistake that is all of the formula.
    pub(super) fn mistake(&self, message: impl Into<String>) -> Diagnostic {
        Diagnostic { origin: self.origin, ..Diagnostic::new(self.span.clone(), message) }
    }
}

impl Lower<'_> {
    /// The formula in a string of the file.
    pub(super) fn formula(&self, text: &Spanned<String>) -> Formula {
        Formula::of_string(text.get_ref(), text.span(), self.source)
    }

    /// Parses a formula, or notes what is wrong with it.
    pub(super) fn parse(&mut self, formula: &Formula) -> Option<Ast> {
        let parse = if formula.is_shape { parse_shape } else { parse };
        match parse(&formula.text) {
            Ok(ast) => Some(ast),
            Err(mistakes) => {
                self.errors.extend(mistakes.into_iter().map(|mistake| formula.place(mistake)));
                None
            }
        }
    }

    /// Finds what a formula means with the scene's definitions, or notes what is wrong with it.
    pub(super) fn resolve(&mut self, formula: &Formula) -> Option<Resolved> {
        let ast = self.parse(formula)?;
        let resolve = if formula.is_shape { Expr::resolve_shape } else { Expr::resolve };
        match resolve(&ast, &self.definitions) {
            Ok(resolved) => {
                let warnings = self.placed(formula, resolved.warnings.clone());
                self.warnings.extend(warnings);
                Some(resolved)
            }
            Err(mistakes) => {
                let mistakes = self.placed(formula, mistakes);
                self.errors.extend(mistakes);
                None
            }
        }
    }

    /// Mistakes at their places, without those of definitions that were noted before: every formula
    /// that is resolved finds them again.
    fn placed(&mut self, formula: &Formula, mistakes: Vec<Mistake>) -> Vec<Diagnostic> {
        let mut placed = Vec::new();
        for Mistake { definition, diagnostic } in mistakes {
            let Some(index) = definition else {
                placed.push(formula.place(diagnostic));
                continue;
            };
            let is_new =
                self.noted.insert((index, diagnostic.span.start, diagnostic.message.clone()));
            if let Some(definition) = self.formulas.get(index).filter(|_| is_new) {
                placed.push(definition.place(diagnostic));
            }
        }
        placed
    }
}

/// Where in a TOML string, quotes included, its value begins, if it stands there literally.
fn start_of_literal(written: &str, value: &str) -> Option<usize> {
    let quotes = if written.starts_with("\"\"\"") || written.starts_with("'''") { 3 } else { 1 };
    let after = written.get(quotes..)?;
    let newline = ["\r\n", "\n"].into_iter().find(|end| quotes == 3 && after.starts_with(end));
    let start = quotes + newline.map_or(0, str::len);
    let end = written.len().checked_sub(quotes)?;
    (written.get(start..end)? == value).then_some(start)
}

#[cfg(test)]
mod tests {
    use super::start_of_literal;

    #[test]
    fn literal_strings_are_found() {
        assert_eq!(start_of_literal("\"x+1\"", "x+1"), Some(1));
        assert_eq!(start_of_literal("''", ""), Some(1));
        assert_eq!(start_of_literal("\"\"\"\nx\n+1\"\"\"", "x\n+1"), Some(4));
        assert_eq!(start_of_literal("'''\r\nx'''", "x"), Some(5));
        assert_eq!(start_of_literal("\"\\u0078\"", "x"), None);
    }
}
