//! What is said about names that mean nothing, or something else than their place wants.

use std::ops::Range;

use super::{
    explain_shapes,
    functions::{self, FUNCTIONS, Function, MAX_NUMBER},
    names::{self, NAMES},
    povray, shapes,
};
use crate::diagnostic::{Diagnostic, did_you_mean};

/// Longer words are not compared with others.
const MAX_WORD: usize = 32;

/// More definitions than this are not listed.
const MAX_LISTED: usize = 12;

/// `name` stands for no value; `defined` are the names that the scene defines; `is_shape` where shapes
/// are made.
pub(super) fn unknown_name(
    name: &str,
    span: Range<usize>,
    defined: &[&str],
    is_shape: bool,
) -> Diagnostic {
    let diagnostic = Diagnostic::new(span, format!("unknown name `{name}`"));
    if functions::exists(name) {
        return diagnostic
            .label("this is a function")
            .help(format!("write its argument in parentheses: `{name}(…)`"));
    }
    if let Some(function) = shapes::find(name) {
        return explain_shapes::bare_shape(function, diagnostic.span);
    }
    let known: Vec<&str> = defined.iter().copied().chain(NAMES).collect();
    let listed = &known[defined.len().saturating_sub(MAX_LISTED)..];
    let list = format!("known names are {}", listed.join(", "));
    diagnostic.label("not known here").help(match (product(name, &known), meant(name, &known)) {
        (Some(product), _) => format!("write `{product}` for a product"),
        (None, Some(candidate)) => format!("did you mean `{candidate}`? {list}"),
        (None, None) if is_shape => {
            format!("{list}; others are defined in [params], [let] or [shapes]")
        }
        (None, None) => format!("{list}; others are defined in [params] or [let]"),
    })
}

/// `name` is called, and is no function; `is_shape` where shapes are made.
pub(super) fn unknown_function(
    name: &str,
    span: Range<usize>,
    defined: &[&str],
    is_shape: bool,
) -> Diagnostic {
    if names::exists(name) || defined.contains(&name) {
        return Diagnostic::new(span, format!("unknown function `{name}`"))
            .label("this is a value, not a function")
            .help(format!("to multiply, write `{name}*(…)`"));
    }
    if name == "log" {
        return Diagnostic::new(span, "`log` means different logarithms in different texts")
            .label("to which base?")
            .help("write `ln` for the natural one, `log10` or `log2`");
    }
    let diagnostic =
        Diagnostic::new(span, format!("unknown function `{name}`")).label("not known here");
    if let Some(why) = povray::refused(name) {
        let diagnostic = diagnostic.label(format!("in POV-Ray it is {why}"));
        return diagnostic.help(match ELSEWHERE.iter().find(|(elsewhere, _)| *elsewhere == name) {
            Some((_, here)) => format!("write `{here}`"),
            None => "only functions that are given by formulas are known here".to_owned(),
        });
    }
    let shape = explain_shapes::elsewhere(name);
    if let Some(here) = shape.as_ref().filter(|_| is_shape) {
        return diagnostic.help(format!("write `{here}`"));
    }
    if let Some((_, here)) = ELSEWHERE.iter().find(|(elsewhere, _)| *elsewhere == name) {
        return diagnostic.help(format!("write `{here}`"));
    }
    if let Some(here) = shape {
        return diagnostic.help(format!("write `{here}`"));
    }
    let known: Vec<&str> = FUNCTIONS.iter().map(|function| function.name).collect();
    let shapes = shapes::FUNCTIONS.iter().map(|function| function.name);
    let all: Vec<&str> = known.iter().copied().chain(shapes).chain(povray::names()).collect();
    diagnostic.help(match meant(name, &all) {
        Some(candidate) => format!("did you mean `{candidate}`?"),
        None if is_shape => explain_shapes::known_shapes(),
        None => format!(
            "known functions are {}, and those of POV-Ray such as `f_torus`",
            known.join(", ")
        ),
    })
}

/// What other languages call things, and how it is written here.
const ELSEWHERE: [(&str, &str); 31] = [
    ("arcsin", "asin(a)"),
    ("arccos", "acos(a)"),
    ("arctan", "atan(a)"),
    ("arctan2", "atan2(y, x)"),
    ("arg", "atan2(y, x)"),
    ("cot", "1/tan(a)"),
    ("sec", "1/cos(a)"),
    ("csc", "1/sin(a)"),
    ("tg", "tan(a)"),
    ("sgn", "sign(a)"),
    ("signum", "sign(a)"),
    ("fabs", "abs(a)"),
    ("ceiling", "ceil(a)"),
    ("int", "floor(a)"),
    ("fmod", "mod(a, b)"),
    ("lerp", "mix(a, b, t)"),
    ("length", "hypot(a, b, c)"),
    ("norm", "hypot(a, b, c)"),
    ("power", "pow(base, exponent)"),
    ("square", "a^2"),
    ("cube", "a^3"),
    ("lg", "log10(a)"),
    ("lb", "log2(a)"),
    ("log1p", "ln(1 + a)"),
    ("f_boxed", "max(0, 1 - max(|x|, |y|, |z|))"),
    ("f_cylindrical", "max(0, 1 - hypot(x, z))"),
    ("f_onion", "mod(r, 1)"),
    ("f_planar", "max(0, 1 - |y|)"),
    ("f_spherical", "max(0, 1 - r)"),
    ("minimum", "min(a, b)"),
    ("maximum", "max(a, b)"),
];

/// A call with too few or too many arguments.
pub(super) fn wrong_count(function: &Function, span: Range<usize>, found: usize) -> Diagnostic {
    let wanted = match (function.takes_more(), function.least()) {
        (true, n) => format!("at least {n} arguments"),
        (false, 1) => "1 argument".to_owned(),
        (false, n) => format!("{n} arguments"),
    };
    Diagnostic::new(span, format!("`{}` takes {wanted}, not {found}", function.name))
        .help(format!("write `{}`", function.usage()))
}

/// A call whose `parameter` must be a number, and is none or too large.
pub(super) fn no_number(function: &Function, parameter: &str, span: Range<usize>) -> Diagnostic {
    let message = format!("`{parameter}` of `{}` must be a number", function.name);
    Diagnostic::new(span, message)
        .label(format!("from -{MAX_NUMBER} to {MAX_NUMBER}, the same everywhere"))
        .help(format!("write `{}`", function.usage()))
}

/// The known word that was meant, if one is near: the same but for capitals, or a slip away.
pub(super) fn meant<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    if word.len() > MAX_WORD {
        return None;
    }
    let same = known.iter().copied().find(|candidate| candidate.eq_ignore_ascii_case(word));
    let is_near = |candidate: &&str| candidate.len().abs_diff(word.len()) <= word.len() / 4 + 1;
    same.or_else(|| did_you_mean(word, known.iter().copied().filter(is_near)))
}

/// The word as a product of known names of one letter, as in `xyz` or `ax`.
fn product(word: &str, known: &[&str]) -> Option<String> {
    let letters: Vec<String> = word.chars().map(String::from).collect();
    let is_product = (2..=4).contains(&letters.len())
        && letters.iter().all(|letter| known.contains(&letter.as_str()));
    is_product.then(|| letters.join("*"))
}

/// The parameter `user` uses `name`, which differs from place to place.
pub(super) fn not_constant(user: &str, name: &str, span: Range<usize>) -> Diagnostic {
    Diagnostic::new(span, format!("the parameter `{user}` depends on `{name}`"))
        .label("differs from place to place")
        .help(format!("parameters are constants; move `{user}` to [let]"))
}

/// A definition hides what `name` means otherwise.
pub(super) fn hidden(name: &str, span: Range<usize>) -> Diagnostic {
    let meaning = match name {
        "x" | "y" | "z" => "the coordinate",
        "r" => "the distance from the origin",
        "rho" => "the distance from the z axis",
        "theta" => "the azimuth",
        "phi" => "the angle from the z axis",
        _ => "the constant",
    };
    Diagnostic::new(span, format!("`{name}` is defined here and hides {meaning} `{name}`"))
        .label(format!("every `{name}` means this now"))
        .help("if both are needed, give the definition another name")
}
