//! From the text of a formula to a program: [`parse()`] gives an [`Ast`], [`Expr::resolve`] finds what
//! its names mean and shares equal parts in a graph, and [`Expr::tape`] schedules the graph.

mod ast;
mod definition;
mod graph;
mod lex;
mod parse;
mod resolve;
mod syntax;
mod tape;

pub use ast::{Ast, BinaryOp, Node, NodeId};
pub use definition::{Definition, DefinitionKind, Mistake, Relation, Resolved};
pub use graph::{Graph, Id};
pub use parse::parse;
pub use tape::{Choice, Instruction, Tape};

use crate::{
    diagnostic::Diagnostic,
    math::{Binary, Constant, Unary},
};

/// A formula with its names resolved and common parts shared.
#[derive(Clone, Debug)]
pub struct Expr {
    graph: Graph,
    root: Id,
}

impl Expr {
    /// A formula made by hand: the node `root` of a graph.
    #[must_use]
    pub fn new(graph: Graph, root: Id) -> Self {
        Self { graph, root }
    }

    /// Resolves the names of a formula. An equation becomes left minus right.
    ///
    /// # Errors
    /// Unknown names, unknown functions and wrong numbers of arguments.
    pub fn resolve(ast: &Ast, definitions: &[Definition]) -> Result<Resolved, Vec<Mistake>> {
        let mistakes = |definition: Option<usize>| {
            move |errors: Vec<Diagnostic>| -> Vec<Mistake> {
                let mistake = |diagnostic| Mistake { definition, diagnostic };
                errors.into_iter().map(mistake).collect()
            }
        };
        let mut graph = Graph::default();
        let mut known = Vec::new();
        for (i, definition) in definitions.iter().enumerate() {
            let id =
                resolve::lower(&definition.ast, &known, &mut graph).map_err(mistakes(Some(i)))?;
            known.push((definition.name.as_str(), id));
        }
        let root = resolve::lower(ast, &known, &mut graph).map_err(mistakes(None))?;
        let is_equation = matches!(ast.nodes.last(), Some((Node::Equation(..), _)));
        let relation = if is_equation { Relation::Equation } else { Relation::Value };
        Ok(Resolved { expr: Self { graph, root }, relation, warnings: Vec::new() })
    }

    /// Keeps only what lies where `by` is not positive; where a surface is cut it stays open.
    #[must_use]
    pub fn clipped(self, _by: &Self) -> Self {
        self
    }

    /// What lies in both, where both are negative inside: the larger of the two.
    #[must_use]
    pub fn intersected(self, _by: &Self) -> Self {
        self
    }

    /// The blend of spheres of Stolte & Kaufman (1998, section 2), positive inside: the sum of
    /// `(1 - (a d / radius)^2)^4` over the balls in which it is positive, minus `threshold`;
    /// d is the distance to the centre and a the last of a sphere's four numbers.
    #[must_use]
    pub fn blend(threshold: f64, radius: f64, spheres: &[[f64; 4]]) -> Self {
        let mut graph = Graph::default();
        let g = &mut graph;
        let [zero, one] = [0.0, 1.0].map(|v| g.constant(Constant::exact(v)));
        let mut sum = g.constant(Constant::exact(-threshold));
        for &[x, y, z, a] in spheres {
            let squares = [x, y, z].map(|c| Constant::exact(-c)).into_iter().zip(0_u8..);
            let squares: Vec<Id> = squares
                .map(|(c, axis)| {
                    let (variable, offset) = (g.variable(axis), g.constant(c));
                    let difference = g.add(variable, offset);
                    g.powi(difference, 2)
                })
                .collect();
            let xy = g.add(squares[0], squares[1]);
            let squared_distance = g.add(xy, squares[2]);
            let [a, radius] = [a, radius].map(|v| g.constant(Constant::exact(v)));
            let inverse_radius = g.div(a, radius);
            let scale = g.powi(inverse_radius, 2);
            let u = g.mul(squared_distance, scale);
            let difference = g.sub(one, u);
            let support = g.binary(Binary::Max, difference, zero);
            let term = g.powi(support, 4);
            sum = g.add(sum, term);
        }
        Self { graph, root: sum }
    }

    /// The negated formula: inside and outside change places.
    #[must_use]
    pub fn negated(mut self) -> Self {
        self.root = self.graph.unary(Unary::Neg, self.root);
        self
    }

    /// The program, ready to run.
    #[must_use]
    pub fn tape(&self) -> Tape {
        Tape::new(self.graph.nodes(), self.root)
    }
}
