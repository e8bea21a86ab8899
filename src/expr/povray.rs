//! The functions of POV-Ray's `functions.inc`, as formulas: `povray.txt` holds them.

use std::{
    borrow::Cow,
    sync::{LazyLock, OnceLock},
};

use super::{
    Ast, Node as AstNode,
    functions::{self, Function, Lower},
    graph::{Graph, Id},
    literal::decimal,
    names::{self, length},
    parse::parse,
    resolve::binary,
};
use crate::math::{Binary, Constant, Unary, Wave};

/// The formulas; its first lines say how they are written.
const TEXT: &str = include_str!("povray.txt");

/// What the names of functions for users begin with; the others are parts of these.
const PREFIX: &str = "f_";

/// Functions of POV-Ray that are no formulas, and why.
const REFUSED: [(&str, &str); 2] = [
    (
        "noise, which is made of tables of random numbers",
        "f_noise3d f_snoise3d f_noise_generator f_hetero_mf f_ridge f_ridged_mf f_agate f_bozo f_bumps \
         f_crackle f_dents f_granite f_ripples f_spotted f_waves f_wood f_wrinkles",
    ),
    (
        "a pattern for colours",
        "f_boxed f_brick f_checker f_cylindrical f_gradientX f_gradientY f_gradientZ f_hexagon \
         f_leopard f_mandel f_marble f_onion f_planar f_radial f_spherical f_spiral1 f_spiral2",
    ),
];

/// The formulas of a function, in terms of its parameters.
pub(super) struct Formulas {
    /// Parts of the last one that have names, and the last one, whose value is the function's.
    lines: Vec<&'static str>,
    /// For each parameter whether it is a number, the same everywhere.
    is_number: Vec<bool>,
    /// The lines' trees, from when they are needed first.
    trees: OnceLock<Vec<Ast>>,
}

/// All functions, in the order of the text, with those that are only parts of others.
static FUNCTIONS: LazyLock<Vec<Function>> = LazyLock::new(|| {
    let lines = TEXT.lines().filter(|line| !line.is_empty() && !line.starts_with('#'));
    let lines: Vec<&'static str> = lines.collect();
    let blocks = lines.chunk_by(|_, next| next.starts_with(' '));
    blocks
        .filter_map(|block| block.split_first().and_then(|(head, body)| read(head, body)))
        .collect()
});

/// A function from its first line, `name(parameters)`, and those below it.
fn read(head: &'static str, body: &[&'static str]) -> Option<Function> {
    let (name, parameters) = head.strip_suffix(')')?.split_once('(')?;
    let (names, is_number) = parameters
        .split(", ")
        .map(|parameter| match parameter.strip_prefix("number ") {
            Some(number) => (number, true),
            None => (parameter, false),
        })
        .unzip();
    let lines = body.iter().map(|line| line.trim()).collect();
    let formulas = Formulas { lines, is_number, trees: OnceLock::new() };
    Some(Function { name, parameters: Cow::Owned(names), lower: Lower::Formulas(formulas) })
}

/// The function of this name, if it is one of POV-Ray's.
pub(super) fn find(name: &str) -> Option<&'static Function> {
    name.starts_with(PREFIX).then(|| known(name)).flatten()
}

/// Names of all of them.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    FUNCTIONS.iter().map(|function| function.name).filter(|name| name.starts_with(PREFIX))
}

/// Why POV-Ray's function of this name cannot be one here.
pub(super) fn refused(name: &str) -> Option<&'static str> {
    let is_among = |refused: &str| refused.split_whitespace().any(|refused| refused == name);
    REFUSED.iter().find(|(_, refused)| is_among(refused)).map(|(why, _)| *why)
}

fn known(name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().find(|function| function.name == name)
}

impl Formulas {
    /// Whether the parameter of this index is a number.
    pub(super) fn is_number(&self, index: usize) -> bool {
        self.is_number.get(index).copied().unwrap_or(false)
    }

    /// The value with these arguments for `parameters`.
    pub(super) fn lower(
        &self,
        g: &mut Graph,
        parameters: &[&'static str],
        arguments: &[Id],
    ) -> Option<Id> {
        let mut known: Vec<(&str, Id)> =
            parameters.iter().copied().zip(arguments.iter().copied()).collect();
        let parsed = || self.lines.iter().filter_map(|line| parse(line).ok()).collect();
        let mut value = None;
        for tree in self.trees.get_or_init(parsed) {
            let (name, node) = lower(g, tree, &known)?;
            known.extend(name.map(|name| (name, node)));
            value = Some(node);
        }
        value
    }
}

/// The value of a formula with names for nodes, and the name that it gives to that.
fn lower<'a>(g: &mut Graph, tree: &'a Ast, known: &[(&str, Id)]) -> Option<(Option<&'a str>, Id)> {
    let mut values: Vec<Option<Id>> = Vec::with_capacity(tree.nodes.len());
    for (node, _) in &tree.nodes {
        let at = |id: u32| values.get(id as usize).copied().flatten();
        let value = match node {
            AstNode::Number { text } => Some(g.constant(decimal(text))),
            AstNode::Name(name) => match known.iter().rev().find(|(known, _)| known == name) {
                Some(&(_, value)) => Some(value),
                None => (name == "pi").then(|| names::lower(name, g)).flatten(),
            },
            AstNode::Neg(a) => Some(g.unary(Unary::Neg, at(*a)?)),
            AstNode::Abs(a) => Some(g.unary(Unary::Abs, at(*a)?)),
            AstNode::Binary(op, a, b) => Some(binary(*op, at(*a)?, at(*b)?, g)),
            AstNode::Call(name, arguments) => {
                let arguments: Option<Vec<Id>> = arguments.iter().map(|&a| at(a)).collect();
                Some(call(g, name, &arguments?)?)
            }
            AstNode::Equation(name, value) => {
                let Some((AstNode::Name(name), _)) = tree.nodes.get(*name as usize) else {
                    return None;
                };
                return Some((Some(name), at(*value)?));
            }
            AstNode::Comparison(..) | AstNode::Named(..) => None,
        };
        values.push(value);
    }
    Some((None, values.pop().flatten()?))
}

/// A call in a formula of the text.
fn call(g: &mut Graph, name: &str, arguments: &[Id]) -> Option<Id> {
    let number = |id: Id| g.nodes()[id as usize].constant().map(|constant| constant.value);
    match (name, arguments) {
        ("if_positive", &[c, a, b]) => Some(if number(c)? > 0.0 { a } else { b }),
        ("if_zero", &[c, a, b]) => Some(if number(c)? == 0.0 { a } else { b }),
        ("triangle", &[a]) => Some(g.unary(Unary::Triangle, a)),
        ("points", &[a, b, radius, n]) => {
            let n = number(n)?;
            nearest_point(g, [a, b], radius, n)
        }
        _ => known(name).or_else(|| functions::find(name))?.lower(g, arguments),
    }
}

/// The distance from (a, b) to the nearest point at angles 0, 2π/n, 4π/n and so on of a circle, of which
/// there are as many as n has whole units; far away if there are none.
fn nearest_point(g: &mut Graph, [a, b]: [Id; 2], radius: Id, n: f64) -> Option<Id> {
    let turn = g.constant(Constant::rounded(std::f64::consts::TAU));
    let parts = g.constant(Constant::exact(n));
    let mut nearest = g.constant(Constant::exact(FAR));
    let mut i = 0.0;
    while i + 1.0 <= n {
        let part = g.constant(Constant::exact(i));
        let angle = g.mul(turn, part);
        let angle = g.div(angle, parts);
        let [cos, sin] = [Wave::Cos, Wave::Sin].map(|wave| g.wave(wave, angle));
        let offsets = [(a, cos), (b, sin)].map(|(from, direction)| {
            let to = g.mul(radius, direction);
            g.sub(from, to)
        });
        let distance = length(&offsets, g);
        nearest = g.binary(Binary::Min, nearest, distance);
        i += 1.0;
    }
    Some(nearest)
}

/// What POV-Ray gives for the distance to none.
const FAR: f64 = 10_000.0;
