//! The operations of function graphs, in terms of those of formulas.
//!
//! *Based on:* the reader of fidget-core 0.5, whose operations mean the same here. Its `and`, `or`,
//! `mix` and `rand` are refused, because no formula is exactly what they are.

use super::super::{
    explain::meant,
    functions::{self, Function, Lower, new, one},
    graph::{Graph, Id},
    lex::quoted,
};
use crate::{
    diagnostic::Diagnostic,
    math::{Constant, Step, Unary},
};

/// The operations without operands that are names.
const LEAVES: [&str; 4] = ["const", "var-x", "var-y", "var-z"];

/// The operations that formulas do not have by this name.
static OWN: [Function; 10] = [
    one("neg", |g, a| g.unary(Unary::Neg, a)),
    one("recip", |g, a| g.unary(Unary::Recip, a)),
    one("square", |g, a| g.powi(a, 2)),
    one("not", not),
    new("add", &["a", "b"], Lower::Two(Graph::add)),
    new("sub", &["a", "b"], Lower::Two(Graph::sub)),
    new("mul", &["a", "b"], Lower::Two(Graph::mul)),
    new("div", &["a", "b"], Lower::Two(Graph::div)),
    new("mod", &["a", "b"], Lower::Two(euclidean_remainder)),
    new("compare", &["a", "b"], Lower::Two(compare)),
];

/// The operations that are functions of formulas, with as many operands as those need.
const SHARED: [&str; 16] = [
    "abs", "sqrt", "exp", "ln", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "min", "max",
    "floor", "ceil", "round",
];

/// Operations of the format that no formula is equal to.
const REFUSED: [&str; 4] = ["and", "or", "mix", "rand"];

/// What the second word of a line asks for.
pub(super) enum Operation {
    /// A decimal number.
    Constant,
    /// x, y or z (0, 1 or 2).
    Coordinate(u8),
    /// A function of earlier results.
    Call(&'static Function),
}

impl Operation {
    /// The operation of this name.
    pub(super) fn find(word: &str) -> Option<Self> {
        match word {
            "const" => Some(Self::Constant),
            "var-x" => Some(Self::Coordinate(0)),
            "var-y" => Some(Self::Coordinate(1)),
            "var-z" => Some(Self::Coordinate(2)),
            _ => {
                let own = OWN.iter().find(|function| function.name == word);
                let shared = || functions::find(word).filter(|_| SHARED.contains(&word));
                own.or_else(shared).map(Self::Call)
            }
        }
    }

    /// What stands behind it in a well-formed line.
    pub(super) fn operands(&self) -> &'static [&'static str] {
        const NAMES: &[&str] = &["_a", "_b"];
        match self {
            Self::Constant => &["0.5"],
            Self::Coordinate(_) => &[],
            Self::Call(function) => &NAMES[..function.least()],
        }
    }

    /// A well-formed line; `word` is the operation's own.
    pub(super) fn usage(&self, name: &str, word: &str) -> String {
        let operands: String =
            self.operands().iter().map(|operand| format!(" {operand}")).collect();
        format!("{} {word}{operands}", quoted(name))
    }
}

/// 1 where a is 0, else 0.
fn not(g: &mut Graph, a: Id) -> Id {
    let sign = g.unary(Unary::Step(Step::Sign), a);
    let is_not = g.unary(Unary::Abs, sign);
    let one = g.constant(Constant::exact(1.0));
    g.sub(one, is_not)
}

/// a − |b|⌊a/|b|⌋, which is never negative.
fn euclidean_remainder(g: &mut Graph, a: Id, b: Id) -> Id {
    let b = g.unary(Unary::Abs, b);
    functions::remainder(g, a, b)
}

/// −1 where a lies below b, 1 where above, 0 where they are equal.
fn compare(g: &mut Graph, a: Id, b: Id) -> Id {
    let difference = g.sub(a, b);
    g.unary(Unary::Step(Step::Sign), difference)
}

/// What to say about a word that is no operation.
pub(super) fn unknown(word: &str) -> Diagnostic {
    let names = OWN.iter().map(|function| function.name);
    let known: Vec<&str> = LEAVES.into_iter().chain(names).chain(SHARED).collect();
    let list = format!("operations are {}", known.join(", "));
    let mistake = |message| Diagnostic::new(0..word.len(), message);
    if REFUSED.contains(&word) {
        let message = format!("no formula can express the operation `{word}`");
        return mistake(message).label("not supported").help(list);
    }
    let message = format!("unknown operation `{}`", quoted(word));
    mistake(message).label("not known here").help(match meant(word, &known) {
        _ if word == "log" => "the natural logarithm is `ln`".to_owned(),
        Some(candidate) => format!("did you mean `{candidate}`?"),
        None => list,
    })
}
