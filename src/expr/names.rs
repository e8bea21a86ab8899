//! The names that stand for a value without being defined: coordinates and constants.

use super::graph::{Graph, Id};
use crate::math::{Binary, Constant, Unary};

/// All of them. The coordinates come first.
pub(super) const NAMES: [&str; 10] = ["x", "y", "z", "r", "theta", "phi", "rho", "pi", "tau", "e"];

const N_COORDINATES: usize = 7;

/// Whether the name has a value of its own.
pub(super) fn exists(name: &str) -> bool {
    NAMES.contains(&name)
}

/// Whether the name's value differs from place to place.
pub(super) fn is_coordinate(name: &str) -> bool {
    NAMES[..N_COORDINATES].contains(&name)
}

/// What the name stands for, if anything.
pub(super) fn lower(name: &str, graph: &mut Graph) -> Option<Id> {
    use std::f64::consts::{E, PI, TAU};
    let constant = |value, graph: &mut Graph| Some(graph.constant(Constant::rounded(value)));
    match name {
        "pi" => return constant(PI, graph),
        "tau" => return constant(TAU, graph),
        "e" => return constant(E, graph),
        _ => {}
    }
    let [x, y, z] = [0, 1, 2].map(|axis| graph.variable(axis));
    Some(match name {
        "x" => x,
        "y" => y,
        "z" => z,
        "rho" => length(&[x, y], graph),
        "r" => length(&[x, y, z], graph),
        "theta" => graph.binary(Binary::Atan2 { lifted: false }, y, x),
        "phi" => {
            let rho = length(&[x, y], graph);
            graph.binary(Binary::Atan2 { lifted: false }, rho, z)
        }
        _ => return None,
    })
}

/// √(Σ aᵢ²): over a box this is the exact range where the parts are independent.
pub(super) fn length(parts: &[Id], graph: &mut Graph) -> Id {
    let squares: Vec<Id> = parts.iter().map(|&a| graph.powi(a, 2)).collect();
    let sum = squares.into_iter().reduce(|a, b| graph.add(a, b));
    let sum = sum.unwrap_or_else(|| graph.constant(Constant::exact(0.0)));
    graph.unary(Unary::Sqrt, sum)
}
