//! Names that a scene gives to formulas, and what resolving a formula with them yields.

use super::{Ast, Expr};
use crate::diagnostic::Diagnostic;

/// A name with the formula that it stands for.
#[derive(Clone, Debug)]
pub struct Definition {
    /// As it is written in formulas.
    pub name: String,
    /// What it may stand for.
    pub kind: DefinitionKind,
    /// The formula.
    pub ast: Ast,
}

/// What a name may stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DefinitionKind {
    /// A number, the same everywhere in space.
    Parameter,
    /// Any expression.
    Let,
}

/// A formula whose names are known.
#[derive(Clone, Debug)]
pub struct Resolved {
    /// F, negative where a comparison holds.
    pub expr: Expr,
    /// How the formula was written.
    pub relation: Relation,
    /// What is allowed but perhaps not meant.
    pub warnings: Vec<Mistake>,
}

/// How the two sides of a formula are related.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// There is one side.
    Value,
    /// `a = b`
    Equation,
    /// `a <= b` or another comparison.
    Solid,
}

/// A mistake in a formula or in one of the definitions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistake {
    /// Index of the definition that the span belongs to; the formula itself where `None`.
    pub definition: Option<usize>,
    /// What is wrong.
    pub diagnostic: Diagnostic,
}
