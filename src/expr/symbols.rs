//! The signs of printed mathematics: what they mean here, and what to write for those that mean
//! nothing. Formulas pasted from a paper are full of them.

use super::{
    ast::{BinaryOp, Comparison},
    lex::Kind,
};

/// What one sign beyond ASCII stands for.
pub(super) fn sign(c: char) -> Option<Kind> {
    Some(match c {
        '·' | '×' | '⋅' | '∙' | '∗' => Kind::Op(BinaryOp::Mul),
        '÷' | '∕' => Kind::Op(BinaryOp::Div),
        '−' | '–' => Kind::Op(BinaryOp::Sub),
        '≤' | '⩽' => Kind::Comparison(Comparison::AtMost),
        '≥' | '⩾' => Kind::Comparison(Comparison::AtLeast),
        '√' | '∛' => Kind::Root,
        '∣' => Kind::Bar,
        '∩' => Kind::Op(BinaryOp::Intersection),
        '∪' => Kind::Op(BinaryOp::Union),
        _ => return None,
    })
}

/// The function that a sign of [`Kind::Root`] stands for.
pub(super) fn root(sign: &str) -> &'static str {
    if sign == "∛" { "cbrt" } else { "sqrt" }
}

/// The name of a Greek letter, which is the same as writing the name out.
pub(super) fn greek(c: char) -> Option<&'static str> {
    Some(match c {
        'α' => "alpha",
        'β' => "beta",
        'γ' => "gamma",
        'δ' => "delta",
        'ε' | 'ϵ' => "epsilon",
        'ζ' => "zeta",
        'η' => "eta",
        'θ' | 'ϑ' => "theta",
        'ι' => "iota",
        'κ' => "kappa",
        'λ' => "lambda",
        'μ' | 'µ' => "mu",
        'ν' => "nu",
        'ξ' => "xi",
        'π' => "pi",
        'ρ' | 'ϱ' => "rho",
        'σ' => "sigma",
        'τ' => "tau",
        'υ' => "upsilon",
        'φ' | 'ϕ' => "phi",
        'χ' => "chi",
        'ψ' => "psi",
        'ω' => "omega",
        _ => return None,
    })
}

/// The digit or sign that is raised.
pub(super) fn superscript(c: char) -> Option<char> {
    let raised = "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻".chars().zip("0123456789+-".chars());
    raised.into_iter().find(|&(sign, _)| sign == c).map(|(_, plain)| plain)
}

/// What people write elsewhere, longest first, and what to write here.
pub(super) const FOREIGN: [(&str, &str); 24] = [
    ("==", "write `=` once; it makes an equation"),
    ("!=", NO_INEQUALITY),
    ("≠", NO_INEQUALITY),
    ("[", "write `(` and `)`"),
    ("]", "write `(` and `)`"),
    ("{", "write `(` and `)`"),
    ("}", "write `(` and `)`"),
    ("‖", "write `hypot(a, b, c)` for the length of a vector"),
    ("½", "write `(1/2)`"),
    ("⅓", "write `(1/3)`"),
    ("¼", "write `(1/4)`"),
    ("¾", "write `(3/4)`"),
    ("⁄", "write `/` for a quotient"),
    ("±", "write one formula with `+` and one with `-`, as two surfaces"),
    ("∓", "write one formula with `+` and one with `-`, as two surfaces"),
    ("∞", "write a large number"),
    ("ⁿ", "write `^n`"),
    (";", "separate arguments with `,`"),
    ("\\", "write plain functions, such as `sqrt(x)`, not LaTeX"),
    ("#", "a formula has no comments; write them after the string"),
    ("%", "write `mod(a, b)` for a remainder, `/100` for a percentage"),
    ("!", "there is no factorial; write the product out"),
    (":", "a formula has no `:`; write a quotient with `/`"),
    ("\u{200b}", "an invisible character stands here: delete it"),
];

const NO_INEQUALITY: &str =
    "write `=` for a surface, or `<=` or `>=` for a solid, which is everything on one side";
