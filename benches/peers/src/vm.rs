//! Function graphs in Fidget's `.vm` text as formulas of Zeroset: one operation a line, the last one
//! is the result. Constants are single floats, as Fidget reads them.

use std::collections::HashMap;

use zeroset::{
    expr::{Expr, Graph},
    math::{Binary, Constant, Unary, Wave},
};

/// # Panics
/// If the text is not well formed, or has an operation that the models do not use.
pub fn read(text: &str) -> Expr {
    let mut graph = Graph::default();
    let mut results = HashMap::new();
    let mut last = None;
    for line in text.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let operand = |i: usize| results[words[i + 2]];
        let id = match words[1] {
            "const" => {
                let value: f32 = words[2].parse().unwrap();
                graph.constant(Constant::exact(value.into()))
            }
            "var-x" => graph.variable(0),
            "var-y" => graph.variable(1),
            "var-z" => graph.variable(2),
            "add" => graph.add(operand(0), operand(1)),
            "sub" => graph.sub(operand(0), operand(1)),
            "mul" => graph.mul(operand(0), operand(1)),
            "div" => graph.div(operand(0), operand(1)),
            "min" => graph.binary(Binary::Min, operand(0), operand(1)),
            "max" => graph.binary(Binary::Max, operand(0), operand(1)),
            "neg" => graph.unary(Unary::Neg, operand(0)),
            "abs" => graph.unary(Unary::Abs, operand(0)),
            "square" => graph.powi(operand(0), 2),
            "sqrt" => graph.unary(Unary::Sqrt, operand(0)),
            "exp" => graph.unary(Unary::Exp, operand(0)),
            "ln" => graph.unary(Unary::Ln, operand(0)),
            "sin" => graph.wave(Wave::Sin, operand(0)),
            "cos" => graph.wave(Wave::Cos, operand(0)),
            other => panic!("no model uses {other}"),
        };
        results.insert(words[0], id);
        last = Some(id);
    }
    Expr::new(graph, last.unwrap())
}
