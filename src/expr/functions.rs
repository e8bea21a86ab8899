//! The functions of the language: their names, their parameters, and what they are in a graph.
//!
//! A function that is no operation of [`crate::math`] is composed of such operations, in a form in
//! which as few operands as possible occur twice: there interval arithmetic stays sharp.

use std::borrow::Cow;

use super::{
    graph::{Graph, Id},
    names::length,
    povray::{self, Formulas},
};
use crate::math::{Binary, Constant, Hyperbolic, Step, Unary, Wave};

/// A function of the language.
pub(super) struct Function {
    pub(super) name: &'static str,
    /// Names of the parameters; `…` as the last one stands for any number more.
    pub(super) parameters: Cow<'static, [&'static str]>,
    pub(super) lower: Lower,
}

/// How a call becomes part of a graph.
pub(super) enum Lower {
    One(fn(&mut Graph, Id) -> Id),
    Two(fn(&mut Graph, Id, Id) -> Id),
    Three(fn(&mut Graph, Id, Id, Id) -> Id),
    /// Any number, the least being the number of named parameters.
    Many(fn(&mut Graph, &[Id]) -> Id),
    /// As other formulas say.
    Formulas(Formulas),
}

/// Arguments that are numbers, which choose among formulas, are not larger than this.
pub(super) const MAX_NUMBER: f64 = 1000.0;

impl Function {
    /// The least number of arguments.
    pub(super) fn least(&self) -> usize {
        self.parameters.len() - usize::from(self.takes_more())
    }

    /// Whether it takes any number of arguments from [`Self::least`] on.
    pub(super) fn takes_more(&self) -> bool {
        self.parameters.last() == Some(&"…")
    }

    /// The first parameter that wants a number, the same everywhere, and gets something else.
    pub(super) fn no_number(&self, graph: &Graph, arguments: &[Id]) -> Option<&'static str> {
        let Lower::Formulas(formulas) = &self.lower else { return None };
        let is_number = |id: Id| {
            let constant = graph.nodes()[id as usize].constant();
            constant.is_some_and(|constant| constant.value.abs() <= MAX_NUMBER)
        };
        let mut given = self.parameters.iter().zip(arguments).enumerate();
        let refused = given.find(|&(index, (_, &id))| formulas.is_number(index) && !is_number(id));
        refused.map(|(_, (&parameter, _))| parameter)
    }

    /// How a call is written.
    pub(super) fn usage(&self) -> String {
        format!("{}({})", self.name, self.parameters.join(", "))
    }

    /// The call's result; nothing if the number of arguments is wrong.
    pub(super) fn lower(&self, graph: &mut Graph, arguments: &[Id]) -> Option<Id> {
        match (&self.lower, arguments) {
            (Lower::One(f), &[a]) => Some(f(graph, a)),
            (Lower::Two(f), &[a, b]) => Some(f(graph, a, b)),
            (Lower::Three(f), &[a, b, c]) => Some(f(graph, a, b, c)),
            (Lower::Many(f), arguments) if arguments.len() >= self.least() => {
                Some(f(graph, arguments))
            }
            (Lower::Formulas(formulas), arguments) if arguments.len() == self.parameters.len() => {
                formulas.lower(graph, &self.parameters, arguments)
            }
            _ => None,
        }
    }
}

/// The function of this name.
pub(super) fn find(name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().find(|function| function.name == name).or_else(|| povray::find(name))
}

/// Whether there is a function of this name.
pub(super) fn exists(name: &str) -> bool {
    find(name).is_some()
}

/// A function of one parameter.
pub(super) const fn one(name: &'static str, f: fn(&mut Graph, Id) -> Id) -> Function {
    Function { name, parameters: Cow::Borrowed(&["a"]), lower: Lower::One(f) }
}

/// A function.
pub(super) const fn new(
    name: &'static str,
    parameters: &'static [&'static str],
    lower: Lower,
) -> Function {
    Function { name, parameters: Cow::Borrowed(parameters), lower }
}

/// All functions but POV-Ray's, in the order in which they are listed to the user.
pub(super) static FUNCTIONS: [Function; 32] = [
    one("sqrt", |g, a| g.unary(Unary::Sqrt, a)),
    one("cbrt", |g, a| g.unary(Unary::Cbrt, a)),
    one("abs", |g, a| g.unary(Unary::Abs, a)),
    new("min", &["a", "b", "…"], Lower::Many(|g, a| fold(g, Binary::Min, a))),
    new("max", &["a", "b", "…"], Lower::Many(|g, a| fold(g, Binary::Max, a))),
    new("smin", &["a", "b", "radius"], Lower::Three(smooth_min)),
    new("smax", &["a", "b", "radius"], Lower::Three(smooth_max)),
    new("clamp", &["a", "low", "high"], Lower::Three(clamp)),
    one("sin", |g, a| g.wave(Wave::Sin, a)),
    one("cos", |g, a| g.wave(Wave::Cos, a)),
    one("tan", Graph::tan),
    one("asin", |g, a| g.unary(Unary::Asin, a)),
    one("acos", |g, a| g.unary(Unary::Acos, a)),
    one("atan", |g, a| g.unary(Unary::Atan, a)),
    new("atan2", &["y", "x"], Lower::Two(|g, y, x| g.binary(ATAN2, y, x))),
    one("sinh", |g, a| g.unary(Unary::Hyperbolic(Hyperbolic::Sinh), a)),
    one("cosh", |g, a| g.unary(Unary::Hyperbolic(Hyperbolic::Cosh), a)),
    one("tanh", |g, a| g.unary(Unary::Hyperbolic(Hyperbolic::Tanh), a)),
    one("exp", |g, a| g.unary(Unary::Exp, a)),
    one("ln", |g, a| g.unary(Unary::Ln, a)),
    one("log2", |g, a| logarithm(g, a, std::f64::consts::LOG2_E)),
    one("log10", |g, a| logarithm(g, a, std::f64::consts::LOG10_E)),
    new("pow", &["base", "exponent"], Lower::Two(Graph::pow)),
    new("hypot", &["a", "b", "…"], Lower::Many(|g, parts| length(parts, g))),
    one("sign", |g, a| g.unary(Unary::Step(Step::Sign), a)),
    one("floor", |g, a| g.unary(Unary::Step(Step::Floor), a)),
    one("ceil", |g, a| g.unary(Unary::Step(Step::Ceil), a)),
    one("round", |g, a| g.unary(Unary::Step(Step::Round), a)),
    new("mod", &["a", "b"], Lower::Two(remainder)),
    new("step", &["edge", "a"], Lower::Two(step)),
    new("smoothstep", &["edge0", "edge1", "a"], Lower::Three(smoothstep)),
    new("mix", &["a", "b", "t"], Lower::Three(mix)),
];

const ATAN2: Binary = Binary::Atan2 { lifted: false };

fn exact(g: &mut Graph, value: f64) -> Id {
    g.constant(Constant::exact(value))
}

fn fold(g: &mut Graph, op: Binary, arguments: &[Id]) -> Id {
    let folded = arguments.iter().copied().reduce(|a, b| g.binary(op, a, b));
    folded.unwrap_or_else(|| exact(g, 0.0))
}

/// The logarithm to a base b; `scale` is the f64 nearest to 1 / ln b.
fn logarithm(g: &mut Graph, a: Id, scale: f64) -> Id {
    let (ln, scale) = (g.unary(Unary::Ln, a), g.constant(Constant::rounded(scale)));
    g.mul(ln, scale)
}

/// a − b⌊a/b⌋, which has the sign of b.
pub(super) fn remainder(g: &mut Graph, a: Id, b: Id) -> Id {
    let quotient = g.div(a, b);
    let floor = g.unary(Unary::Step(Step::Floor), quotient);
    let whole = g.mul(b, floor);
    g.sub(a, whole)
}

/// 0 below `edge`, 1 from there on: 1 + min(sign(a − edge), 0).
fn step(g: &mut Graph, edge: Id, a: Id) -> Id {
    let (zero, one) = (exact(g, 0.0), exact(g, 1.0));
    let difference = g.sub(a, edge);
    let sign = g.unary(Unary::Step(Step::Sign), difference);
    let drop = g.binary(Binary::Min, sign, zero);
    g.add(drop, one)
}

/// The nearest number to a between `low` and `high`.
fn clamp(g: &mut Graph, a: Id, low: Id, high: Id) -> Id {
    let a = g.binary(Binary::Max, a, low);
    g.binary(Binary::Min, a, high)
}

/// 0 up to `edge0`, 1 from `edge1` on, smooth between them.
fn smoothstep(g: &mut Graph, edge0: Id, edge1: Id, a: Id) -> Id {
    let (from, width) = (g.sub(a, edge0), g.sub(edge1, edge0));
    let t = g.div(from, width);
    g.unary(Unary::Smoothstep, t)
}

/// a where t = 0, b where t = 1, linear between them.
fn mix(g: &mut Graph, a: Id, b: Id, t: Id) -> Id {
    let difference = g.sub(b, a);
    let part = g.mul(difference, t);
    g.add(a, part)
}

/// min(a, b) − m² / 4k, m = max(k − |a − b|, 0).
///
/// *Based on:* I. Quilez, "smooth minimum", the quadratic polynomial.
fn smooth_min(g: &mut Graph, a: Id, b: Id, k: Id) -> Id {
    let min = g.binary(Binary::Min, a, b);
    match rounding(g, a, b, k) {
        Some(rounding) => g.sub(min, rounding),
        None => min,
    }
}

/// max(a, b) + m² / 4k, m as in [`smooth_min`].
fn smooth_max(g: &mut Graph, a: Id, b: Id, k: Id) -> Id {
    let max = g.binary(Binary::Max, a, b);
    match rounding(g, a, b, k) {
        Some(rounding) => g.add(max, rounding),
        None => max,
    }
}

/// m² / 4k; nothing for a constant radius that is not above 0, which leaves the edge sharp.
fn rounding(g: &mut Graph, a: Id, b: Id, k: Id) -> Option<Id> {
    if g.nodes()[k as usize].constant().is_some_and(|k| k.value <= 0.0) {
        return None;
    }
    let (zero, four) = (exact(g, 0.0), exact(g, 4.0));
    let difference = g.sub(a, b);
    let distance = g.unary(Unary::Abs, difference);
    let depth = g.sub(k, distance);
    let depth = g.binary(Binary::Max, depth, zero);
    let (square, scale) = (g.powi(depth, 2), g.mul(k, four));
    Some(g.div(square, scale))
}
