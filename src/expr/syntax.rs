//! What the parser says about mistakes. Every message marks text that is there: where something
//! is missing, its neighbours.

use std::ops::Range;

use super::{
    BinaryOp,
    lex::{Kind, Token},
};
use crate::diagnostic::Diagnostic;

/// A formula and its tokens, to quote from.
pub(super) struct Quote<'a> {
    pub(super) text: &'a str,
    pub(super) tokens: &'a [Token],
}

impl Quote<'_> {
    /// The token before `found`.
    fn before(&self, found: &Token) -> Option<&Token> {
        let n = self.tokens.partition_point(|token| token.span.start < found.span.start);
        self.tokens[..n].last()
    }

    fn of(&self, token: &Token) -> &str {
        &self.text[token.span.clone()]
    }

    /// `found` stands where a number, a name or a bracket was wanted.
    pub(super) fn missing_operand(&self, found: &Token) -> Diagnostic {
        let here = self.of(found);
        let Some(last) = self.before(found) else {
            return match found.kind {
                Kind::End => Diagnostic::new(0..self.text.len(), "the formula is empty")
                    .help("write an equation, such as x^2 + y^2 + z^2 = 1"),
                _ => Diagnostic::new(found.span.clone(), format!("nothing stands before `{here}`"))
                    .label("a value is missing before this"),
            };
        };
        let before = self.of(last);
        if found.kind == Kind::End {
            return Diagnostic::new(last.span.clone(), format!("nothing follows `{before}`"))
                .label("a value is missing after this")
                .help("write a number, a name or a bracket after it");
        }
        Diagnostic::new(
            last.span.start..found.span.end,
            format!("nothing stands between `{before}` and `{here}`"),
        )
        .label("a value is missing in here")
        .help("write a number, a name or a bracket between them")
    }

    /// `found` follows a complete operand.
    pub(super) fn missing_operator(&self, found: &Token) -> Diagnostic {
        let here = self.of(found);
        let Some(last) = self.before(found) else {
            return Diagnostic::new(found.span.clone(), format!("`{here}` cannot stand here"));
        };
        let before = self.of(last);
        let help = match last.kind {
            Kind::Bar => format!("write `|…|*{here}` for a product with an absolute value"),
            _ => format!("write `{before}*{here}` for a product"),
        };
        Diagnostic::new(
            last.span.start..found.span.end,
            format!("an operator is missing between `{before}` and `{here}`"),
        )
        .label("how are these combined?")
        .help(help)
    }

    /// `&` or `∪` in a formula.
    pub(super) fn sign_of_shapes(&self, sign: &Token, op: BinaryOp) -> Diagnostic {
        let help = match op {
            BinaryOp::Intersection => {
                "write `max(a, b)`: an intersection is negative where both are; `shape = \"…\"` takes `&`"
            }
            _ => {
                "write `min(a, b)`: a union is negative where either is; `shape = \"…\"` takes `|`"
            }
        };
        let message = format!("`{}` cannot stand in a formula", self.of(sign));
        Diagnostic::new(sign.span.clone(), message).label("unexpected here").help(help)
    }

    /// An equation or a comparison as a part of something.
    pub(super) fn relation_in_brackets(&self, sign: Range<usize>) -> Diagnostic {
        let text = &self.text[sign.clone()];
        let help = match text {
            "=" => "an equation stands alone: close every bracket before the `=`".to_owned(),
            _ => format!(
                "a comparison stands alone; inside max, min and the like write a difference that is \
                 negative inside: `a - b` for `a {text} b`"
            ),
        };
        Diagnostic::new(sign, format!("`{text}` stands inside brackets"))
            .label("a bracket is still open here")
            .help(if matches!(text, ">" | ">=" | "≥" | "⩾") {
                help.replace("`a - b`", "`b - a`")
            } else {
                help
            })
    }
}

/// A name after a point that is not called.
pub(super) fn no_method(span: Range<usize>, name: &str) -> Diagnostic {
    Diagnostic::new(span, format!("`.{name}` lacks its parentheses"))
        .label("what is done to the shape before it?")
        .help(format!("write `.{name}(…)`, as in sphere(1).translate(0, 0, 2)"))
}

/// `a || b` and `a && b`
pub(super) fn double_sign(span: Range<usize>, sign: &str) -> Diagnostic {
    Diagnostic::new(span, format!("`{sign}{sign}` stands between shapes"))
        .label("one too many")
        .help(format!("write `{sign}` once"))
}

/// A foreign sign in a shape, with what to write for the brackets of a vector.
pub(super) fn without_vectors(mistake: Diagnostic, text: &str) -> Diagnostic {
    match text.get(mistake.span.clone()) {
        Some("[" | "]") => mistake.help("write the numbers alone, as in a.translate(1, 0, 0)"),
        _ => mistake,
    }
}

/// The formula ends, or the bracket around this one closes, before `open` does.
pub(super) fn never_closed(open: &Range<usize>, is_bar: bool) -> Diagnostic {
    let (opening, help) = match is_bar {
        true => ("|", "add the missing `|`; inside bars write products with `*`, as in |2*|x||"),
        false => ("(", "add the missing `)`"),
    };
    Diagnostic::new(open.clone(), format!("`{opening}` is never closed"))
        .label("opened here")
        .help(help)
}

pub(super) fn stray_close(span: Range<usize>) -> Diagnostic {
    Diagnostic::new(span, "`)` closes nothing")
        .label("no `(` is open here")
        .help("remove it, or add the `(` that is missing before it")
}

pub(super) fn stray_comma(span: Range<usize>) -> Diagnostic {
    Diagnostic::new(span, "`,` stands outside a call")
        .label("not between arguments")
        .help("commas separate arguments, as in max(x, y); a decimal number has a point, as in 1.5")
}

pub(super) fn second_equals(span: Range<usize>) -> Diagnostic {
    Diagnostic::new(span, "a formula has one `=` at most")
        .label("the second one")
        .help("write each equation as a surface of its own")
}

pub(super) fn second_relation(span: Range<usize>) -> Diagnostic {
    Diagnostic::new(span, "a formula has one `=`, `<=` or `>=` at most")
        .label("the second one")
        .help("where several hold at once, `a <= b <= c` say, write max(a - b, b - c) <= 0")
}

/// A product without a sign where it has two meanings.
pub(super) fn two_ways(span: Range<usize>, first: &str, second: &str) -> Diagnostic {
    Diagnostic::new(span, "this can be read in two ways")
        .label("what belongs together here?")
        .help(format!("write `{first}` or `{second}`"))
}

/// `sin x`
pub(super) fn bare_function(span: Range<usize>, name: &str) -> Diagnostic {
    Diagnostic::new(span, format!("the argument of `{name}` needs parentheses"))
        .label(format!("`{name}` is a function"))
        .help(format!("write `{name}(…)`"))
}

/// `sin⁻¹(x)`
pub(super) fn inverse_or_reciprocal(span: Range<usize>, name: &str) -> Diagnostic {
    let inverse = match name {
        "sin" | "cos" | "tan" => format!("`a{name}(…)`"),
        _ => "the name of the inverse function".to_owned(),
    };
    Diagnostic::new(span, "this can be the inverse function or the reciprocal")
        .label(format!("what does it do to `{name}`?"))
        .help(format!("write {inverse} or `1/{name}(…)`"))
}

pub(super) fn too_deep(span: Range<usize>, limit: usize) -> Diagnostic {
    Diagnostic::new(span, format!("brackets are nested more than {limit} deep"))
        .label("one too many")
        .help("write the formula with fewer brackets inside one another")
}
