//! From the text of a formula to a program: [`parse`] gives an [`Ast`], names are resolved while
//! it is lowered to a hash-consed graph, and the graph is scheduled as a tape.

mod ast;

pub use ast::{Ast, BinaryOp, Node, NodeId};
