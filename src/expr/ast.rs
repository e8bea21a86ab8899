//! A parsed formula: names are not resolved yet, nothing is simplified.

use std::ops::Range;

/// Index of a node in its [`Ast`].
pub type NodeId = u32;

/// A formula as a flat tree. Children stand before their parents and the last node is the root,
/// so that every walk is a loop and no formula can overflow the stack.
#[derive(Clone, Debug, PartialEq)]
pub struct Ast {
    /// Nodes with the bytes of the formula that each came from.
    pub nodes: Vec<(Node, Range<usize>)>,
}

/// One node of an [`Ast`].
#[derive(Clone, Debug, PartialEq)]
pub enum Node {
    /// A literal; `text` is the decimal number as it was written.
    Number {
        /// Such as `0.25` or `1e-3`.
        text: String,
    },
    /// A coordinate, constant or parameter.
    Name(String),
    /// `-a`
    Neg(NodeId),
    /// `|a|`
    Abs(NodeId),
    /// `a op b`
    Binary(BinaryOp, NodeId, NodeId),
    /// `name(a, b, …)`; the span of the node is the name's.
    Call(String, Vec<NodeId>),
    /// `a = b`; only the root can be one.
    Equation(NodeId, NodeId),
}

/// An infix operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinaryOp {
    /// `+`
    Add,
    /// `-`
    Sub,
    /// `*`
    Mul,
    /// `/`
    Div,
    /// `^`
    Pow,
}
