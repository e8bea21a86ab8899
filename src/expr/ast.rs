//! A parsed formula: names are not resolved yet, nothing is simplified.

use std::ops::Range;

/// Index of a node in its [`Ast`].
pub type NodeId = u32;

/// A formula as a flat tree. Children stand before their parents and the last node is the root,
/// so that every walk is a loop and no formula can overflow the stack.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ast {
    /// Nodes with the bytes of the formula that each came from.
    pub nodes: Vec<(Node, Range<usize>)>,
}

impl Ast {
    /// The bytes of the part of the formula that ends with this node; brackets around it may be
    /// missing.
    #[must_use]
    pub fn extent(&self, node: NodeId) -> Range<usize> {
        let (mut from, mut to) = (usize::MAX, 0);
        let mut open = vec![node];
        while let Some(node) = open.pop() {
            let Some((node, span)) = self.nodes.get(node as usize) else { continue };
            (from, to) = (from.min(span.start), to.max(span.end));
            match node {
                Node::Call(_, arguments) => open.extend(arguments),
                Node::Named(_, a) | Node::Neg(a) | Node::Abs(a) => open.push(*a),
                Node::Binary(_, a, b) | Node::Equation(a, b) | Node::Comparison(_, a, b) => {
                    open.extend([a, b]);
                }
                Node::Number { .. } | Node::Name(_) => {}
            }
        }
        from.min(to)..to
    }

    /// The bytes of the whole formula; brackets around it may be missing.
    #[must_use]
    pub fn span(&self) -> Range<usize> {
        self.nodes.last().map_or(0..0, |(_, span)| span.clone())
    }
}

/// One node of an [`Ast`].
#[derive(Clone, Debug, PartialEq)]
pub enum Node {
    /// A literal; `text` is the decimal number.
    Number {
        /// Such as `0.25` or `1e-3`.
        text: String,
    },
    /// A coordinate, a constant or a definition; Greek letters are spelt out.
    Name(String),
    /// `-a`
    Neg(NodeId),
    /// `|a|`
    Abs(NodeId),
    /// `a op b`
    Binary(BinaryOp, NodeId, NodeId),
    /// `name(a, b, …)` or `a.name(b, …)`; the span of the node is the name's.
    Call(String, Vec<NodeId>),
    /// `a = b`; only the root can be one.
    Equation(NodeId, NodeId),
    /// `a <= b` or `a >= b`; only the root can be one.
    Comparison(Comparison, NodeId, NodeId),
    /// `name = a` as an argument of a call; the span of the node is the name's.
    Named(String, NodeId),
}

/// A comparison, which bounds a solid; its border counts as inside whether `=` is written or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Comparison {
    /// `<=`, `<`
    AtMost,
    /// `>=`, `>`
    AtLeast,
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
    /// `&`, of shapes.
    Intersection,
    /// `|` after a value, of shapes.
    Union,
}
