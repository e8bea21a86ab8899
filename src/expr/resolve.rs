//! Names to operations: from the tree of a formula to the graph of a program.

use crate::{
    diagnostic::{Diagnostic, did_you_mean},
    expr::{
        Ast, BinaryOp, Node as AstNode,
        graph::{Graph, Id},
    },
    math::{Binary, Constant, Unary, Wave},
};

/// The names that stand for a value.
const NAMES: [&str; 9] = ["x", "y", "z", "r", "theta", "phi", "rho", "pi", "e"];

/// The functions with their least and largest number of arguments.
const FUNCTIONS: [(&str, usize, usize); 11] = [
    ("sqrt", 1, 1),
    ("abs", 1, 1),
    ("min", 2, usize::MAX),
    ("max", 2, usize::MAX),
    ("sin", 1, 1),
    ("cos", 1, 1),
    ("atan2", 2, 2),
    ("acos", 1, 1),
    ("exp", 1, 1),
    ("ln", 1, 1),
    ("pow", 2, 2),
];

/// Lowers `ast` into `graph`; an equation becomes left minus right.
pub(super) fn lower(
    ast: &Ast,
    known: &[(&str, Id)],
    graph: &mut Graph,
) -> Result<Id, Vec<Diagnostic>> {
    let mut diagnostics = Vec::new();
    let mut ids: Vec<Id> = Vec::with_capacity(ast.nodes.len());
    for (node, span) in &ast.nodes {
        let id = |child: u32| ids[child as usize];
        let lowered = match node {
            AstNode::Number { text } => Ok(graph.constant(decimal(text))),
            AstNode::Name(name) => match known.iter().find(|(known, _)| known == name) {
                Some(&(_, id)) => Ok(id),
                None => lower_name(name, graph),
            },
            AstNode::Neg(a) => Ok(graph.unary(Unary::Neg, id(*a))),
            AstNode::Abs(a) => Ok(graph.unary(Unary::Abs, id(*a))),
            AstNode::Binary(op, a, b) => Ok(lower_binary(*op, id(*a), id(*b), graph)),
            AstNode::Equation(a, b) => Ok(graph.sub(id(*a), id(*b))),
            AstNode::Call(name, arguments) => {
                let arguments: Vec<Id> = arguments.iter().map(|&a| id(a)).collect();
                lower_call(name, &arguments, graph)
            }
        };
        ids.push(lowered.unwrap_or_else(|complain| {
            diagnostics.push(complain(span.clone()));
            graph.variable(0) // stands in, so that further mistakes are found
        }));
    }
    match ids.last() {
        Some(&root) if diagnostics.is_empty() => Ok(root),
        _ => Err(diagnostics),
    }
}

/// A mistake that still lacks its place.
type Complaint = Box<dyn Fn(std::ops::Range<usize>) -> Diagnostic>;

fn lower_name(name: &str, graph: &mut Graph) -> Result<Id, Complaint> {
    let [x, y, z] = [0, 1, 2].map(|axis| graph.variable(axis));
    Ok(match name {
        "x" => x,
        "y" => y,
        "z" => z,
        "pi" => graph.constant(Constant::rounded(std::f64::consts::PI)),
        "e" => graph.constant(Constant::rounded(std::f64::consts::E)),
        "rho" => radius_of(&[x, y], graph),
        "r" => radius_of(&[x, y, z], graph),
        "theta" => graph.binary(Binary::Atan2 { lifted: false }, y, x),
        "phi" => {
            let rho = radius_of(&[x, y], graph);
            graph.binary(Binary::Atan2 { lifted: false }, rho, z)
        }
        _ => {
            let is_function = FUNCTIONS.iter().any(|&(function, ..)| function == name);
            let name = name.to_owned();
            return Err(Box::new(move |span| {
                let diagnostic = Diagnostic::new(span, format!("unknown name `{name}`"));
                if is_function {
                    return diagnostic
                        .label("this is a function")
                        .help(format!("write its argument in parentheses: `{name}(…)`"));
                }
                let known = format!("known names are {}", NAMES.join(", "));
                diagnostic.label("not known here").help(match did_you_mean(&name, NAMES) {
                    Some(candidate) => format!("did you mean `{candidate}`? {known}"),
                    None => known,
                })
            }));
        }
    })
}

/// √(Σ aᵢ²): over a box this is the exact range, because the coordinates are independent.
fn radius_of(coordinates: &[Id], graph: &mut Graph) -> Id {
    let squares: Vec<Id> = coordinates.iter().map(|&a| graph.powi(a, 2)).collect();
    let sum = squares.into_iter().reduce(|a, b| graph.add(a, b));
    let sum = sum.unwrap_or_else(|| graph.constant(Constant::exact(0.0)));
    graph.unary(Unary::Sqrt, sum)
}

fn lower_binary(op: BinaryOp, a: Id, b: Id, graph: &mut Graph) -> Id {
    match op {
        BinaryOp::Add => graph.add(a, b),
        BinaryOp::Sub => graph.sub(a, b),
        BinaryOp::Mul => graph.mul(a, b),
        BinaryOp::Div => graph.div(a, b),
        BinaryOp::Pow => graph.pow(a, b),
    }
}

fn lower_call(name: &str, arguments: &[Id], graph: &mut Graph) -> Result<Id, Complaint> {
    let Some(&(_, least, most)) = FUNCTIONS.iter().find(|&&(function, ..)| function == name) else {
        return Err(unknown_function(name));
    };
    if !(least..=most).contains(&arguments.len()) {
        return Err(wrong_count(name, least, most, arguments.len()));
    }
    let a = arguments[0];
    let fold = |op, graph: &mut Graph| {
        arguments[1..].iter().fold(a, |folded, &b| graph.binary(op, folded, b))
    };
    Ok(match name {
        "sqrt" => graph.unary(Unary::Sqrt, a),
        "abs" => graph.unary(Unary::Abs, a),
        "sin" => graph.wave(Wave::Sin, a),
        "cos" => graph.wave(Wave::Cos, a),
        "acos" => graph.unary(Unary::Acos, a),
        "exp" => graph.unary(Unary::Exp, a),
        "ln" => graph.unary(Unary::Ln, a),
        "min" => fold(Binary::Min, graph),
        "max" => fold(Binary::Max, graph),
        "atan2" => graph.binary(Binary::Atan2 { lifted: false }, a, arguments[1]),
        "pow" => graph.pow(a, arguments[1]),
        _ => unreachable!("every entry of FUNCTIONS is lowered"),
    })
}

fn unknown_function(name: &str) -> Complaint {
    let name = name.to_owned();
    Box::new(move |span| {
        let diagnostic = Diagnostic::new(span, format!("unknown function `{name}`"));
        if NAMES.contains(&name.as_str()) {
            return diagnostic
                .label("this is a value, not a function")
                .help(format!("to multiply, write `{name}*(…)`"));
        }
        let known: Vec<&str> = FUNCTIONS.iter().map(|&(function, ..)| function).collect();
        let list = format!("known functions are {}", known.join(", "));
        diagnostic.label("not known here").help(match did_you_mean(&name, known) {
            Some(candidate) => format!("did you mean `{candidate}`? {list}"),
            None => list,
        })
    })
}

fn wrong_count(name: &str, least: usize, most: usize, found: usize) -> Complaint {
    let wanted = match (least, most) {
        (1, 1) => "1 argument".to_owned(),
        (n, m) if n == m => format!("{n} arguments"),
        (n, _) => format!("at least {n} arguments"),
    };
    let message = format!("`{name}` takes {wanted}, not {found}");
    let help = match name {
        "atan2" => Some("write `atan2(y, x)`".to_owned()),
        "pow" => Some("write `pow(base, exponent)` or `base^exponent`".to_owned()),
        _ => None,
    };
    Box::new(move |span| Diagnostic {
        help: help.clone(),
        ..Diagnostic::new(span, message.clone())
    })
}

/// The constant that a decimal literal means: exact where an f64 holds it.
fn decimal(text: &str) -> Constant {
    let value: f64 = text.parse().unwrap_or(f64::NAN);
    if is_dyadic(text) { Constant::exact(value) } else { Constant::rounded(value) }
}

/// Whether an f64 holds a literal m·10ᵉ: no 5 may be left in the denominator, and the odd part of
/// the numerator must fit the fraction.
fn is_dyadic(text: &str) -> bool {
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = format!("{whole}{fraction}");
    let (Ok(mut m), Ok(exponent)) = (digits.parse::<u128>(), exponent.parse::<i32>()) else {
        return false;
    };
    if m == 0 {
        return true;
    }
    let mut fives = i64::from(exponent) - fraction.len() as i64;
    while fives < 0 && m.is_multiple_of(5) {
        m /= 5;
        fives += 1;
    }
    let odd = m >> m.trailing_zeros();
    (0..=22).contains(&fives)
        && exponent.abs() < 250
        && odd.checked_mul(5_u128.pow(fives as u32)).is_some_and(|v| v < 1 << 53)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_are_exact_where_they_can_be() {
        for text in ["0", "1", "0.5", ".25", "3.", "1e3", "12.125", "5e-1", "1e22", "0.0"] {
            assert!(decimal(text).as_exact().is_some(), "{text}");
        }
        for text in ["0.1", "2.3", "1e-1", "1e23", "9007199254740993", "0.42"] {
            let c = decimal(text);
            assert!(c.lo < c.value && c.value < c.hi, "{text}");
        }
    }
}
