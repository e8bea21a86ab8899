//! Function graphs in the text format of libfive and Fidget (`.vm`): from the text to the graph of
//! a formula.
//!
//! A line is one operation, `name operation operands`. Its name is new, its operands are names of
//! lines above it, and the last line is the result; `#` begins a comment. Constants are what they
//! say in decimal, as in formulas: a program that computes in `f32` means its nearest number.

mod operation;

use std::ops::Range;

use rustc_hash::FxHashMap;

use self::operation::Operation;
use super::{
    Expr,
    graph::{Graph, Id},
    lex::{self, quoted},
    literal::decimal,
};
use crate::{diagnostic::Diagnostic, math::Unary};

/// After so many mistakes the rest is not worth reading.
const MAX_MISTAKES: usize = 32;

/// Reads a function graph. See [`Expr::from_vm`].
pub(super) fn read(text: &str) -> Result<Expr, Vec<Diagnostic>> {
    let mut reader =
        Reader { text, graph: Graph::default(), known: FxHashMap::default(), mistakes: Vec::new() };
    let mut result = None;
    for line in lines(text) {
        let mut words = words(line);
        let Some(name) = words.next() else { continue };
        result = Some(reader.line(name, &words.collect::<Vec<_>>()));
        if reader.mistakes.len() >= MAX_MISTAKES {
            break;
        }
    }
    let Reader { graph, mut mistakes, .. } = reader;
    let Some(root) = result else {
        return Err(vec![
            Diagnostic::new(0..0, "the file has no operation")
                .help("write one a line, such as `_x var-x`; the last line is the result"),
        ]);
    };
    mistakes.truncate(MAX_MISTAKES);
    if mistakes.is_empty() { Ok(Expr::new(graph, root)) } else { Err(mistakes) }
}

/// The lines of a file, without the mark that some editors write at its beginning.
fn lines(text: &str) -> impl Iterator<Item = &str> {
    text.strip_prefix('\u{feff}').unwrap_or(text).lines()
}

/// The words of a line up to the comment.
fn words(line: &str) -> impl Iterator<Item = &str> {
    line.split('#').next().unwrap_or_default().split_whitespace()
}

struct Reader<'a> {
    text: &'a str,
    graph: Graph,
    /// What the names so far mean.
    known: FxHashMap<&'a str, Id>,
    mistakes: Vec<Diagnostic>,
}

impl<'a> Reader<'a> {
    /// Reads a line. Where it has no meaning, x stands in for its result, so that those who use it
    /// are no mistakes.
    fn line(&mut self, name: &'a str, words: &[&'a str]) -> Id {
        let Some((word, operands)) = words.split_first() else {
            let help = format!("write an operation behind it, as in `{} var-x`", quoted(name));
            self.complain(name, format!("`{}` has no operation", quoted(name)), "", help);
            return self.define(name, None);
        };
        match (Operation::find(word), Operation::find(name)) {
            (Some(operation), _) => {
                let id = self.operation(&operation, name, word, operands);
                self.define(name, id)
            }
            (None, Some(operation)) => {
                let help = format!("write `{}`", operation.usage("_name", name));
                let label = "this is an operation";
                self.complain(name, "the line does not name its result", label, help);
                self.graph.variable(0)
            }
            (None, None) => {
                self.mistakes.push(operation::unknown(word).shifted(self.span(word).start));
                self.define(name, None)
            }
        }
    }

    fn define(&mut self, name: &'a str, id: Option<Id>) -> Id {
        let id = id.unwrap_or_else(|| self.graph.variable(0));
        if self.known.insert(name, id).is_some() {
            let message = format!("`{}` is defined twice", quoted(name));
            let first = self.line_of(name).map_or(String::new(), |n| format!("line {n} has it; "));
            let help = format!("{first}every line needs a name of its own");
            self.complain(name, message, "the second one", help);
        }
        id
    }

    /// What an operation gives, unless something is wrong with its operands.
    fn operation(
        &mut self,
        operation: &Operation,
        name: &str,
        word: &str,
        operands: &[&'a str],
    ) -> Option<Id> {
        let wanted = operation.operands().len();
        if operands.len() != wanted {
            let n = match wanted {
                0 => "no operand".to_owned(),
                1 => "1 operand".to_owned(),
                n => format!("{n} operands"),
            };
            let message = format!("`{word}` takes {n}, not {}", operands.len());
            let help = format!("write `{}`", operation.usage(name, word));
            self.complain(word, message, "", help);
            return None;
        }
        match operation {
            Operation::Constant => self.constant(operands[0]),
            Operation::Coordinate(axis) => Some(self.graph.variable(*axis)),
            Operation::Call(function) => {
                // All of them first, so that every one without a meaning is noted.
                let ids: Vec<Option<Id>> = operands.iter().map(|a| self.operand(a)).collect();
                let ids: Vec<Id> = ids.into_iter().collect::<Option<_>>()?;
                function.lower(&mut self.graph, &ids)
            }
        }
    }

    fn constant(&mut self, written: &'a str) -> Option<Id> {
        let digits = written.strip_prefix(['+', '-']).unwrap_or(written);
        // Neither a second sign nor `inf` or `nan`.
        let is_plain = digits.starts_with(|c: char| c.is_ascii_digit() || c == '.');
        let value = digits.parse::<f64>().ok().filter(|_| is_plain);
        let mistake = match value {
            None => lex::not_a_number(written),
            Some(value) if !value.is_finite() => lex::too_large(written),
            Some(_) => {
                let magnitude = self.graph.constant(decimal(digits));
                let is_negative = written.starts_with('-');
                return Some(match is_negative {
                    true => self.graph.unary(Unary::Neg, magnitude),
                    false => magnitude,
                });
            }
        };
        self.mistakes.push(mistake.shifted(self.span(written).start));
        None
    }

    /// What an earlier line gave.
    fn operand(&mut self, name: &'a str) -> Option<Id> {
        let known = self.known.get(name).copied();
        if known.is_none() {
            // Near names are no help: most files number them.
            let help = match self.line_of(name) {
                Some(n) => format!("line {n} defines it; an operand is a name of a line above"),
                None => "an operand is the name at the beginning of a line above".to_owned(),
            };
            self.complain(name, format!("`{}` is not defined", quoted(name)), "not above", help);
        }
        known
    }

    fn complain(
        &mut self,
        at: &str,
        message: impl Into<String>,
        label: &str,
        help: impl Into<String>,
    ) {
        let mistake = Diagnostic::new(self.span(at), message);
        self.mistakes.push(mistake.label(label).help(help));
    }

    /// Where `part`, a part of the text, is in it.
    fn span(&self, part: &str) -> Range<usize> {
        let start = part.as_ptr().addr() - self.text.as_ptr().addr();
        start..start + part.len()
    }

    /// The number of the first line that defines `name`.
    fn line_of(&self, name: &str) -> Option<usize> {
        lines(self.text).position(|line| words(line).next() == Some(name)).map(|index| index + 1)
    }
}

#[cfg(test)]
#[path = "vm_tests.rs"]
mod tests;
