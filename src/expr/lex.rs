//! From the text of a formula to tokens.
//!
//! The lexer goes on after a character that it does not know, so that a formula pasted from
//! elsewhere shows all its foreign characters at once. It knows the usual ones by sight and says
//! what to write instead.

use std::{borrow::Cow, ops::Range};

use super::{
    ast::{BinaryOp, Comparison},
    symbols,
};
use crate::diagnostic::Diagnostic;

/// The longest formula, in tokens: no hand writes more, and it bounds everything that follows.
pub(super) const MAX_TOKENS: usize = 100_000;

/// The longest name, in bytes.
pub(super) const MAX_NAME: usize = 64;

/// After so many foreign characters the text is not a formula.
const MAX_ERRORS: usize = 8;

/// What a token is; its text is the formula's at its span.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Number,
    /// A word, or one Greek letter: [`name`] tells which name it is.
    Name,
    Op(BinaryOp),
    /// A raised integer: [`power`] tells which.
    Power,
    /// A prefix root sign.
    Root,
    Equals,
    Comparison(Comparison),
    Open,
    Close,
    Comma,
    Bar,
    /// A point before a name: what follows is done to what stands before it.
    Dot,
    /// After the last token; its span is empty.
    End,
}

/// A token and the bytes that it covers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Token {
    pub(super) kind: Kind,
    pub(super) span: Range<usize>,
}

/// The name that a token of [`Kind::Name`] means.
pub(super) fn name(written: &str) -> &str {
    written.chars().next().and_then(symbols::greek).unwrap_or(written)
}

/// Whether `written` is one name and nothing else.
pub(super) fn is_name(written: &str) -> bool {
    matches!(token(written), Ok((Kind::Name, len)) if len == written.len())
}

/// The integer that a token of [`Kind::Power`] means, in plain digits with at most a minus.
pub(super) fn power(written: &str) -> String {
    written.chars().filter_map(symbols::superscript).filter(|&c| c != '+').collect()
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

/// The token at the start of `rest` and its length in bytes.
fn token(rest: &str) -> Result<(Kind, usize), Diagnostic> {
    let first = rest.chars().next().unwrap_or_default();
    match first {
        '.' if is_dot(rest) => return Ok((Kind::Dot, 1)),
        '0'..='9' | '.' => return number(rest),
        'a'..='z' | 'A'..='Z' | '_' => return word(rest),
        _ if symbols::greek(first).is_some() => return Ok((Kind::Name, first.len_utf8())),
        _ if symbols::superscript(first).is_some() => return raised(rest),
        _ => {}
    }
    if let Some((kind, sign)) = SIGNS.iter().find(|(_, sign)| rest.starts_with(sign)) {
        // `==` is a sign of its own, and a foreign one.
        if !rest.starts_with("==") {
            return Ok((*kind, sign.len()));
        }
    }
    if let Some(kind) = symbols::sign(first) {
        return Ok((kind, first.len_utf8()));
    }
    if let Some((sign, help)) = symbols::FOREIGN.iter().find(|(sign, _)| rest.starts_with(sign)) {
        return Err(unexpected(sign).help(*help));
    }
    let len = run(rest, char::is_alphabetic).max(first.len_utf8()).min(rest.len());
    Err(unexpected(&rest[..len]))
}

/// Whether a point at the start of `rest` stands before a name.
fn is_dot(rest: &str) -> bool {
    rest[1..].trim_start().starts_with(|c: char| c == '_' || c.is_ascii_alphabetic())
}

/// The signs of ASCII, longest first.
const SIGNS: [(Kind, &str); 16] = [
    (Kind::Op(BinaryOp::Pow), "**"),
    (Kind::Comparison(Comparison::AtMost), "<="),
    (Kind::Comparison(Comparison::AtLeast), ">="),
    (Kind::Comparison(Comparison::AtMost), "<"),
    (Kind::Comparison(Comparison::AtLeast), ">"),
    (Kind::Op(BinaryOp::Add), "+"),
    (Kind::Op(BinaryOp::Sub), "-"),
    (Kind::Op(BinaryOp::Mul), "*"),
    (Kind::Op(BinaryOp::Div), "/"),
    (Kind::Op(BinaryOp::Pow), "^"),
    (Kind::Op(BinaryOp::Intersection), "&"),
    (Kind::Equals, "="),
    (Kind::Open, "("),
    (Kind::Close, ")"),
    (Kind::Comma, ","),
    (Kind::Bar, "|"),
];

/// At most so many characters of something strange are quoted.
const MAX_QUOTE: usize = 40;

/// `written` for a message, not too long.
pub(super) fn quoted(written: &str) -> Cow<'_, str> {
    match written.char_indices().nth(MAX_QUOTE) {
        None => written.into(),
        Some((end, _)) => format!("{}…", &written[..end]).into(),
    }
}

fn unexpected(written: &str) -> Diagnostic {
    let is_invisible = |c: char| c.is_control() || ('\u{200b}'..='\u{200f}').contains(&c);
    let shown = match written.chars().next().filter(|&c| is_invisible(c)) {
        Some(c) => c.escape_unicode().to_string().into(),
        None => quoted(written),
    };
    let message = format!("`{shown}` cannot stand in a formula");
    Diagnostic::new(0..written.len(), message).label("unexpected here")
}

fn word(rest: &str) -> Result<(Kind, usize), Diagnostic> {
    let len = run(rest, |c| c == '_' || c.is_ascii_alphanumeric());
    if len > MAX_NAME {
        let message = format!("the name `{}` is too long", quoted(&rest[..len]));
        return Err(
            Diagnostic::new(0..len, message).label(format!("more than {MAX_NAME} characters"))
        );
    }
    Ok((Kind::Name, len))
}

/// A raised integer, such as ², ¹⁰ or ⁻¹.
fn raised(rest: &str) -> Result<(Kind, usize), Diagnostic> {
    let len = run(rest, |c| symbols::superscript(c).is_some());
    let plain: String = rest[..len].chars().filter_map(symbols::superscript).collect();
    let digits = plain.strip_prefix(['+', '-']).unwrap_or(&plain);
    if digits.is_empty() || !digits.bytes().all(|c| c.is_ascii_digit()) {
        let message = format!("`{}` is not a power", quoted(&rest[..len]));
        return Err(Diagnostic::new(0..len, message)
            .label("not a raised integer")
            .help("write the exponent after `^`, as in x^(a-1)"));
    }
    Ok((Kind::Power, len))
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
        Ok(_) => Err(too_large(&rest[..len])),
        Err(_) => Err(not_a_number(&rest[..len])),
    }
}

/// A number beyond f64.
pub(super) fn too_large(written: &str) -> Diagnostic {
    let message = format!("the number `{}` is too large", quoted(written));
    Diagnostic::new(0..written.len(), message).label("above 1.7e308")
}

/// Something in place of a number.
pub(super) fn not_a_number(written: &str) -> Diagnostic {
    Diagnostic::new(0..written.len(), format!("`{}` is not a number", quoted(written)))
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
    fn printed_signs_are_tokens_with_exact_spans() {
        assert_eq!(
            texts("2πr²−x¹⁰·√y⁻³"),
            ["2", "π", "r", "²", "−", "x", "¹⁰", "·", "√", "y", "⁻³", ""]
        );
        assert_eq!((power("¹⁰"), power("⁻³"), power("⁺²")), ("10".into(), "-3".into(), "2".into()));
        assert_eq!(["θ", "ϕ", "φ", "ρ", "x1"].map(name), ["theta", "phi", "phi", "rho", "x1"]);
        assert_eq!(texts("x**2<=1≥0"), ["x", "**", "2", "<=", "1", "≥", "0", ""]);
    }

    #[test]
    fn names_are_told_from_what_is_none() {
        for text in ["x", "_a1", "λ", "sin"] {
            assert!(is_name(text), "{text}");
        }
        for text in ["", "1x", "a b", "λ1", "a-b", "é", " a"] {
            assert!(!is_name(text), "{text}");
        }
        assert_eq!(lex(&"a".repeat(65)).unwrap_err()[0].span, 0..65);
    }

    #[test]
    fn all_foreign_characters_are_found_with_advice() {
        let errors = lex("x⁻ + y == ∞ ∂ привет %").unwrap_err();
        let spans: Vec<_> = errors.iter().map(|e| e.span.clone()).collect();
        assert_eq!(spans, [1..4, 9..11, 12..15, 16..19, 20..32, 33..34]);
        assert_eq!(errors[1].help.as_deref(), Some("write `=` once; it makes an equation"));
        assert_eq!(errors[4].help, None);
    }

    #[test]
    fn length_is_limited() {
        let fits = "x+".repeat(MAX_TOKENS / 2);
        assert_eq!(lex(&fits).unwrap().len(), MAX_TOKENS + 1);
        assert_eq!(lex(&(fits + " x")).unwrap_err()[0].span, MAX_TOKENS + 1..MAX_TOKENS + 2);
        assert_eq!(lex(&"?".repeat(1000)).unwrap_err().len(), MAX_ERRORS);
    }
}
