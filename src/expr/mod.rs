//! From the text of a formula to a program: [`parse()`] gives an [`Ast`], [`Expr::resolve`] finds what
//! its names mean, those that the scene defines included, and shares equal parts in a graph, and
//! [`Expr::tape`] schedules the graph. [`Expr::from_vm`] reads a graph that another program wrote.

mod ast;
mod definition;
mod explain;
mod explain_shapes;
mod functions;
mod graph;
mod lex;
mod literal;
mod names;
mod parse;
mod povray;
mod resolve;
mod shapes;
mod substitute;
mod symbols;
mod syntax;
mod tape;
mod values;
mod vm;

pub use ast::{Ast, BinaryOp, Comparison, Node, NodeId};
pub use definition::{Definition, DefinitionKind, Mistake};
pub use graph::{Graph, Id};
pub use parse::{parse, parse_shape};
pub use resolve::{Relation, Resolved};
pub use tape::{Choice, Instruction, Tape};

use crate::{
    diagnostic::Diagnostic,
    math::{Binary, Constant, Unary},
};

/// Whether a name has a meaning of its own in formulas: a coordinate, a constant or a function.
#[must_use]
pub fn has_meaning(name: &str) -> bool {
    names::exists(name) || functions::exists(name)
}

/// Whether formulas can say `name`: letters, digits and `_`, or one Greek letter.
#[must_use]
pub fn is_name(name: &str) -> bool {
    lex::is_name(name)
}

/// A formula with its names resolved and common parts shared.
#[derive(Clone, Debug)]
pub struct Expr {
    graph: Graph,
    root: Id,
    /// What is at most 0 where the formula counts, if it does not count everywhere.
    region: Option<Id>,
}

impl Expr {
    /// A formula made by hand: the node `root` of a graph.
    #[must_use]
    pub fn new(graph: Graph, root: Id) -> Self {
        Self { graph, root, region: None }
    }

    /// Finds what the names of a formula mean. A definition hides what its name means otherwise.
    ///
    /// # Errors
    /// Names that mean nothing, calls that do not fit, circular definitions, parameters that are
    /// not constant. All definitions are checked, used or not, so that a mistake in one is found
    /// with every formula. The list is empty only if the formula needs a definition whose tree is.
    pub fn resolve(ast: &Ast, definitions: &[Definition]) -> Result<Resolved, Vec<Mistake>> {
        resolve::resolve(ast, definitions)
    }

    /// As [`Self::resolve`], for a shape that [`parse_shape`] read: negative inside.
    ///
    /// # Errors
    /// As [`Self::resolve`]; also if it is a number or an equation.
    pub fn resolve_shape(ast: &Ast, definitions: &[Definition]) -> Result<Resolved, Vec<Mistake>> {
        resolve::resolve_shape(ast, definitions)
    }

    /// Reads a function graph in the text format of libfive and Fidget (`.vm`): one operation a line,
    /// `name operation operands`, of which the last one is the result. Constants are decimal numbers,
    /// enclosed like those of a formula.
    ///
    /// # Errors
    /// The first mistakes of the text, in the order of their places.
    pub fn from_vm(text: &str) -> Result<Self, Vec<Diagnostic>> {
        vm::read(text)
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
            let squared_distance = squared_distance(g, [x, y, z]);
            let [a, radius] = [a, radius].map(|v| g.constant(Constant::exact(v)));
            let inverse_radius = g.div(a, radius);
            let scale = g.powi(inverse_radius, 2);
            let u = g.mul(squared_distance, scale);
            let difference = g.sub(one, u);
            let support = g.binary(Binary::Max, difference, zero);
            let term = g.powi(support, 4);
            sum = g.add(sum, term);
        }
        Self::new(graph, sum)
    }

    /// The union of spheres, negative inside: each is its centre and its radius r. It is the least of all
    /// d² − r², where d is the distance to a centre, and of the least r², which no zero depends on: what
    /// is farther away than that from a box drops out of its tape, whatever else is near.
    #[must_use]
    pub fn spheres(spheres: &[[f64; 4]]) -> Self {
        let mut graph = Graph::default();
        let g = &mut graph;
        let far = spheres.iter().map(|&[.., r]| r * r).fold(f64::INFINITY, f64::min);
        let mut least = g.constant(Constant::exact(far.min(f64::MAX)));
        for &[x, y, z, r] in spheres {
            let squared_distance = squared_distance(g, [x, y, z]);
            let radius = g.constant(Constant::exact(r));
            let squared_radius = g.powi(radius, 2);
            let depth = g.sub(squared_distance, squared_radius);
            least = g.binary(Binary::Min, depth, least);
        }
        Self::new(graph, least)
    }

    /// The negated formula: inside and outside change places.
    #[must_use]
    pub fn negated(mut self) -> Self {
        self.root = self.graph.unary(Unary::Neg, self.root);
        self
    }

    /// The part of the surface where `by` is at most 0; where that cuts it, it stays open.
    #[must_use]
    pub fn clipped(mut self, by: &Self) -> Self {
        let by = self.graph.import(&by.graph, by.root);
        let region = self.region.map_or(by, |region| self.graph.binary(Binary::Max, region, by));
        self.region = Some(region);
        self
    }

    /// The solid inside both this formula and `by`: where that cuts the surface, it is capped.
    #[must_use]
    pub fn intersected(mut self, by: &Self) -> Self {
        let by = self.graph.import(&by.graph, by.root);
        self.root = self.graph.binary(Binary::Max, self.root, by);
        self
    }

    /// The value, if the formula does not depend on the coordinates.
    #[must_use]
    pub fn constant(&self) -> Option<f64> {
        self.graph.nodes()[self.root as usize].constant().map(|c| c.value)
    }

    /// The program, ready to run.
    #[must_use]
    pub fn tape(&self) -> Tape {
        Tape::new(self.graph.nodes(), self.root, self.region)
    }
}

/// The square of the distance to a point.
fn squared_distance(g: &mut Graph, point: [f64; 3]) -> Id {
    let [x, y, z] = [0, 1, 2].map(|axis: u8| {
        let offset = g.constant(Constant::exact(-point[usize::from(axis)]));
        let variable = g.variable(axis);
        let difference = g.add(variable, offset);
        g.powi(difference, 2)
    });
    let xy = g.add(x, y);
    g.add(xy, z)
}
