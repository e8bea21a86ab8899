//! From the text of a formula to tokens.
//!
//! The lexer goes on after a character that it does not know, so that a formula pasted from
//! elsewhere shows all its foreign characters at once. It knows the usual ones by sight and says
//! what to write instead.

use std::ops::Range;

use super::BinaryOp;
use crate::diagnostic::Diagnostic;

/// The longest formula, in tokens: no hand writes more, and it bounds everything that follows.
pub(super) const MAX_TOKENS: usize = 100_000;

/// After so many foreign characters the text is not a formula.
const MAX_ERRORS: usize = 8;

/// What a token is; its text is the formula's at its span.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Number,
    Name,
    Op(BinaryOp),
    Equals,
    Open,
    Close,
    Comma,
    Bar,
    /// After the last token; its span is empty.
    End,
}

/// A token and the bytes that it covers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Token {
    pub(super) kind: Kind,
    pub(super) span: Range<usize>,
}

/// Splits `text` into tokens; the last one is [`Kind::End`].
pub(super) fn lex(text: &str) -> Result<Vec<Token>, Vec<Diagnostic>> {
    let mut tokens = Vec::new();
    let mut errors = Vec::new();
    let mut at = 0;
    while let Some(start) = text[at..].find(|c: char| !c.is_whitespace()).map(|n| at + n) {
        if tokens.len() == MAX_TOKENS {
            errors.push(too_long(start..text.len()));
        }
        if tokens.len() == MAX_TOKENS || errors.len() >= MAX_ERRORS {
            break;
        }
        let len = match token(&text[start..]) {
            Ok((kind, len)) => {
                tokens.push(Token { kind, span: start..start + len });
                len
            }
            Err(error) => {
                let len = error.span.len();
                errors.push(error.shifted(start));
                len
            }
        };
        at = start + len;
    }
    tokens.push(Token { kind: Kind::End, span: text.len()..text.len() });
    if errors.is_empty() { Ok(tokens) } else { Err(errors) }
}

fn too_long(span: Range<usize>) -> Diagnostic {
    Diagnostic::new(span, format!("the formula is longer than {MAX_TOKENS} symbols"))
        .label("everything from here on is too much")
}

/// The token at the start of `rest`, which is not empty, and its length in bytes.
fn token(rest: &str) -> Result<(Kind, usize), Diagnostic> {
    if let Some((written, help)) = FOREIGN.iter().find(|(written, _)| rest.starts_with(written)) {
        return Err(unexpected(written).help(*help));
    }
    let first = rest.chars().next().unwrap_or_default();
    let kind = match first {
        '0'..='9' | '.' => return number(rest),
        'a'..='z' | 'A'..='Z' | '_' => {
            return Ok((Kind::Name, run(rest, |c| c == '_' || c.is_ascii_alphanumeric())));
        }
        '+' => Kind::Op(BinaryOp::Add),
        '-' => Kind::Op(BinaryOp::Sub),
        '*' => Kind::Op(BinaryOp::Mul),
        '/' => Kind::Op(BinaryOp::Div),
        '^' => Kind::Op(BinaryOp::Pow),
        '=' => Kind::Equals,
        '(' => Kind::Open,
        ')' => Kind::Close,
        ',' => Kind::Comma,
        '|' => Kind::Bar,
        _ => {
            let len = run(rest, char::is_alphabetic).max(first.len_utf8());
            return Err(unexpected(&rest[..len]));
        }
    };
    Ok((kind, 1))
}

/// What people write elsewhere, longest first, and what to write here.
const FOREIGN: [(&str, &str); 33] = [
    ("**", "write `^` for a power"),
    ("<=", NO_COMPARISON),
    (">=", NO_COMPARISON),
    ("==", "write `=` once; it makes an equation"),
    ("!=", NO_COMPARISON),
    ("<", NO_COMPARISON),
    (">", NO_COMPARISON),
    ("≤", NO_COMPARISON),
    ("≥", NO_COMPARISON),
    ("[", "write `(` and `)`"),
    ("]", "write `(` and `)`"),
    ("{", "write `(` and `)`"),
    ("}", "write `(` and `)`"),
    ("·", "write `*` for a product"),
    ("×", "write `*` for a product"),
    ("⋅", "write `*` for a product"),
    ("÷", "write `/` for a quotient"),
    ("−", "write the plain minus of the keyboard, `-`"),
    ("–", "write the plain minus of the keyboard, `-`"),
    ("²", "write `^2`"),
    ("³", "write `^3`"),
    ("⁴", "write `^4`"),
    ("√", "write `sqrt(...)`"),
    ("π", "write `pi`"),
    ("θ", "write `theta`"),
    ("φ", "write `phi`"),
    ("ϕ", "write `phi`"),
    ("ρ", "write `rho`"),
    (";", "separate arguments with `,`"),
    ("\\", "write plain functions, such as `sqrt(x)`, not LaTeX"),
    ("#", "a formula has no comments; write them after the string"),
    ("%", "there is no remainder or percent sign; write `/100` for a percentage"),
    ("!", "there is no factorial; write the product out"),
];

const NO_COMPARISON: &str =
    "comparisons are not supported yet; write an equation with `=`, or one side that is 0";

fn unexpected(written: &str) -> Diagnostic {
    Diagnostic::new(0..written.len(), format!("`{written}` cannot stand in a formula"))
        .label("unexpected here")
}

/// A decimal number: digits with at most one point, then an exponent if `e` is followed by one
/// (otherwise `e` is the next token, a name).
fn number(rest: &str) -> Result<(Kind, usize), Diagnostic> {
    let digit = |c: char| c.is_ascii_digit();
    let mut len = run(rest, digit);
    if rest[len..].starts_with('.') {
        let fraction = run(&rest[len + 1..], digit);
        if len + fraction == 0 {
            return Err(unexpected("."));
        }
        len += 1 + fraction;
    }
    if let Some(exponent) = rest[len..].strip_prefix(['e', 'E']) {
        let sign = usize::from(exponent.starts_with(['+', '-']));
        let digits = run(&exponent[sign..], digit);
        len += if digits > 0 { 1 + sign + digits } else { 0 };
    }
    if rest[len..].starts_with(['.', '_']) {
        let len = len + run(&rest[len..], |c| c.is_ascii_digit() || c == '.' || c == '_');
        return Err(not_a_number(&rest[..len]));
    }
    match rest[..len].parse::<f64>() {
        Ok(value) if value.is_finite() => Ok((Kind::Number, len)),
        Ok(_) => {
            Err(Diagnostic::new(0..len, format!("the number `{}` is too large", &rest[..len]))
                .label("above 1.7e308"))
        }
        Err(_) => Err(not_a_number(&rest[..len])),
    }
}

fn not_a_number(written: &str) -> Diagnostic {
    Diagnostic::new(0..written.len(), format!("`{written}` is not a number"))
        .label("not a decimal number")
        .help("a number has digits, at most one point and perhaps an exponent: 12, 0.5, 1e-3")
}

/// Length in bytes of the longest start of `text` whose characters all satisfy `accept`.
fn run(text: &str, accept: impl Fn(char) -> bool) -> usize {
    text.find(|c| !accept(c)).unwrap_or(text.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(text: &str) -> Vec<&str> {
        let tokens = lex(text).unwrap();
        tokens.iter().map(|t| &text[t.span.clone()]).collect()
    }

    #[test]
    fn numbers_take_an_exponent_only_with_digits() {
        assert_eq!(texts("1 1. .5 1e-3 2E4"), ["1", "1.", ".5", "1e-3", "2E4", ""]);
        assert_eq!(texts("2e-x"), ["2", "e", "-", "x", ""]);
        assert_eq!(texts("3exp"), ["3", "exp", ""]);
    }

    #[test]
    fn malformed_numbers_are_marked_whole() {
        for text in ["1.2.3", "1..2", "1_000", "1e5.5", "1e999"] {
            assert_eq!(lex(text).unwrap_err()[0].span, 0..text.len(), "{text}");
        }
        assert_eq!(lex("x + .").unwrap_err()[0].span, 4..5);
    }

    #[test]
    fn all_foreign_characters_are_found_with_advice() {
        let errors = lex("x² + y² ≤ π ∂ привет").unwrap_err();
        let spans: Vec<_> = errors.iter().map(|e| e.span.clone()).collect();
        assert_eq!(spans, [1..3, 7..9, 10..13, 14..16, 17..20, 21..33]);
        assert_eq!(errors[0].help.as_deref(), Some("write `^2`"));
        assert_eq!(errors[5].help, None);
    }

    #[test]
    fn length_is_limited() {
        let fits = "x+".repeat(MAX_TOKENS / 2);
        assert_eq!(lex(&fits).unwrap().len(), MAX_TOKENS + 1);
        assert_eq!(lex(&(fits + " x")).unwrap_err()[0].span, MAX_TOKENS + 1..MAX_TOKENS + 2);
        assert_eq!(lex(&"?".repeat(1000)).unwrap_err().len(), MAX_ERRORS);
    }
}
