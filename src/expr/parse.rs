//! From tokens to an [`Ast`]: an operator-precedence parser whose stack is a `Vec`.
//!
//! *Based on:* V. Pratt, "Top Down Operator Precedence", POPL 1973. The recursion is written out
//! as a stack of [`Frame`]s, so that no formula, however nested, can overflow the thread's stack.
//!
//! The parser alternates between two states: it wants an operand, or it has one and looks at what
//! follows. From the loosest to the tightest, the operators are `=`; `+ -`; `* /`; unary minus and
//! plus; `^`, which alone groups from the right. So `-x^2` is `-(x^2)` and `2^-x^2` is
//! `2^(-(x^2))`.

use std::ops::Range;

use super::{
    Ast, BinaryOp, Node, NodeId,
    lex::{Kind, Token, lex},
    syntax::{self, Quote},
};
use crate::diagnostic::Diagnostic;

/// The deepest nesting of brackets, calls and absolute values.
const MAX_DEPTH: usize = 1000;

/// Parses a formula. Names and numbers of arguments are not checked.
///
/// # Errors
/// All characters that cannot stand in a formula, or else the first mistake of syntax.
pub fn parse(text: &str) -> Result<Ast, Vec<Diagnostic>> {
    let tokens = lex(text)?;
    let mut parser = Parser { text, tokens, at: 0, nodes: Vec::new(), stack: Vec::new(), depth: 0 };
    match parser.formula() {
        Ok(()) => Ok(Ast { nodes: parser.nodes }),
        Err(error) => Err(vec![error]),
    }
}

/// A finished part of the formula; the span includes brackets around it.
struct Operand {
    node: NodeId,
    span: Range<usize>,
}

/// Something begun that waits for its last operand.
enum Frame {
    /// Unary minus at this span.
    Minus(Range<usize>),
    /// An infix operator with its left operand.
    Infix(BinaryOp, Operand),
    /// The left side of an equation.
    Equation(Operand),
    /// An opening bracket at this span.
    Group(Range<usize>),
    /// An opening bar at this span.
    Bars(Range<usize>),
    /// A call: its name's span, the opening bracket's, the arguments so far.
    Call { name: Range<usize>, open: Range<usize>, args: Vec<NodeId> },
}

impl Frame {
    /// How tightly a waiting operator holds the operand on its right; brackets do not let go.
    fn right_power(&self) -> u8 {
        match self {
            Self::Minus(_) => 5,
            Self::Infix(op, _) => match op {
                BinaryOp::Add | BinaryOp::Sub => 2,
                BinaryOp::Mul | BinaryOp::Div => 4,
                BinaryOp::Pow => 7,
            },
            _ => 0,
        }
    }
}

/// How tightly an infix operator holds the operand on its left.
fn left_power(op: BinaryOp) -> u8 {
    match op {
        BinaryOp::Add | BinaryOp::Sub => 1,
        BinaryOp::Mul | BinaryOp::Div => 3,
        BinaryOp::Pow => 8,
    }
}

struct Parser<'a> {
    text: &'a str,
    tokens: Vec<Token>,
    at: usize,
    nodes: Vec<(Node, Range<usize>)>,
    stack: Vec<Frame>,
    /// Number of brackets among the frames of the stack.
    depth: usize,
}

impl Parser<'_> {
    fn formula(&mut self) -> Result<(), Diagnostic> {
        loop {
            let Some(mut operand) = self.operand()? else { continue };
            loop {
                match self.after(operand)? {
                    After::Operand(closed) => operand = closed,
                    After::Operator => break,
                    After::End => return Ok(()),
                }
            }
        }
    }

    /// Reads what stands where an operand is wanted; `None` if one still is afterwards.
    fn operand(&mut self) -> Result<Option<Operand>, Diagnostic> {
        let token = self.next();
        let span = token.span.clone();
        match token.kind {
            Kind::Number => {
                let text = self.text[span.clone()].to_owned();
                return Ok(Some(self.push(Node::Number { text }, span)));
            }
            Kind::Name if self.peek() == Kind::Open => {
                let open = self.next().span;
                self.open(Frame::Call { name: span, open: open.clone(), args: Vec::new() }, open)?;
                if self.peek() == Kind::Close {
                    let close = self.next();
                    return self.close_bracket(None, &close).map(Some);
                }
            }
            Kind::Name => {
                let name = self.text[span.clone()].to_owned();
                return Ok(Some(self.push(Node::Name(name), span)));
            }
            Kind::Op(BinaryOp::Sub) => self.stack.push(Frame::Minus(span)),
            Kind::Op(BinaryOp::Add) => {}
            Kind::Open => self.open(Frame::Group(span.clone()), span)?,
            Kind::Bar => self.open(Frame::Bars(span.clone()), span)?,
            Kind::End if self.last_opened_just_now() => return Err(self.never_closed()),
            Kind::Op(_) | Kind::Equals | Kind::Comma | Kind::Close | Kind::End => {
                return Err(self.quote().missing_operand(&token));
            }
        }
        Ok(None)
    }

    /// Reads what stands after an operand.
    fn after(&mut self, operand: Operand) -> Result<After, Diagnostic> {
        let token = self.next();
        match token.kind {
            Kind::Op(op) => {
                let left = self.complete(operand, left_power(op));
                self.stack.push(Frame::Infix(op, left));
                return Ok(After::Operator);
            }
            Kind::Number | Kind::Name | Kind::Open => {
                return Err(self.quote().missing_operator(&token));
            }
            Kind::Equals | Kind::Comma | Kind::Close | Kind::Bar | Kind::End => {}
        }
        let operand = self.complete(operand, 0);
        match token.kind {
            Kind::Close => self.close_bracket(Some(operand), &token).map(After::Operand),
            Kind::Bar => self.close_bars(operand, &token).map(After::Operand),
            Kind::Comma => self.argument(&operand, token.span).map(|()| After::Operator),
            Kind::Equals => self.equals(operand, token.span).map(|()| After::Operator),
            _ => self.finish(operand).map(|()| After::End),
        }
    }

    /// Gives `operand` to the operators that hold it tighter than `left_power`: with 0, to all of
    /// them up to the last open bracket.
    fn complete(&mut self, operand: Operand, left_power: u8) -> Operand {
        let mut right = operand;
        while self.stack.last().is_some_and(|frame| frame.right_power() > left_power) {
            right = match self.stack.pop() {
                Some(Frame::Minus(minus)) => {
                    let span = minus.start..right.span.end;
                    self.push(Node::Neg(right.node), span)
                }
                Some(Frame::Infix(op, left)) => {
                    let span = left.span.start..right.span.end;
                    self.push(Node::Binary(op, left.node, right.node), span)
                }
                _ => unreachable!("only operators have a power"),
            };
        }
        right
    }

    /// Closes a group or a call at `)`; `last` is what stands before it, if anything does.
    fn close_bracket(
        &mut self,
        last: Option<Operand>,
        close: &Token,
    ) -> Result<Operand, Diagnostic> {
        self.depth = self.depth.saturating_sub(1);
        match (self.stack.pop(), last) {
            (Some(Frame::Group(open)), Some(Operand { node, .. })) => {
                Ok(Operand { node, span: open.start..close.span.end })
            }
            (Some(Frame::Call { name, mut args, .. }), last) => {
                args.extend(last.map(|argument| argument.node));
                let call = Node::Call(self.text[name.clone()].to_owned(), args);
                let span = name.start..close.span.end;
                Ok(Operand { span, ..self.push(call, name) })
            }
            (Some(Frame::Bars(open)), _) => Err(syntax::never_closed(&open, true)),
            _ => Err(syntax::stray_close(close.span.clone())),
        }
    }

    /// Closes an absolute value at the second `|`.
    fn close_bars(&mut self, inner: Operand, close: &Token) -> Result<Operand, Diagnostic> {
        if let Some(Frame::Bars(open)) = self.stack.last() {
            let span = open.start..close.span.end;
            self.stack.pop();
            self.depth -= 1;
            return Ok(self.push(Node::Abs(inner.node), span));
        }
        Err(match self.stack.iter().any(|frame| matches!(frame, Frame::Bars(_))) {
            true => self.never_closed(),
            false => self.quote().missing_operator(close),
        })
    }

    /// Takes an argument at the comma after it.
    fn argument(&mut self, argument: &Operand, comma: Range<usize>) -> Result<(), Diagnostic> {
        match self.stack.last_mut() {
            Some(Frame::Call { args, .. }) => {
                args.push(argument.node);
                Ok(())
            }
            _ => Err(syntax::stray_comma(comma)),
        }
    }

    /// Takes the left side of an equation.
    fn equals(&mut self, left: Operand, equals: Range<usize>) -> Result<(), Diagnostic> {
        match self.stack.last() {
            None => {
                self.stack.push(Frame::Equation(left));
                Ok(())
            }
            Some(Frame::Equation(_)) => Err(syntax::second_equals(equals)),
            Some(_) => Err(syntax::equals_in_brackets(equals)),
        }
    }

    /// Completes the formula at its end.
    fn finish(&mut self, right: Operand) -> Result<(), Diagnostic> {
        match self.stack.last() {
            None => Ok(()),
            Some(Frame::Equation(left)) => {
                let (node, span) = (left.node, left.span.start..right.span.end);
                self.push(Node::Equation(node, right.node), span);
                Ok(())
            }
            Some(_) => Err(self.never_closed()),
        }
    }

    /// The complaint about the innermost open bracket.
    fn never_closed(&self) -> Diagnostic {
        let open = self.stack.iter().rev().find_map(|frame| match frame {
            Frame::Bars(open) => Some(syntax::never_closed(open, true)),
            Frame::Group(open) | Frame::Call { open, .. } => {
                Some(syntax::never_closed(open, false))
            }
            Frame::Minus(_) | Frame::Infix(..) | Frame::Equation(_) => None,
        });
        open.unwrap_or_else(|| Diagnostic::new(0..self.text.len(), "a bracket is never closed"))
    }

    /// Whether the token before the current one opened the innermost bracket.
    fn last_opened_just_now(&self) -> bool {
        match self.stack.last() {
            Some(Frame::Group(_) | Frame::Bars(_)) => true,
            Some(Frame::Call { args, .. }) => args.is_empty(),
            _ => false,
        }
    }

    fn push(&mut self, node: Node, span: Range<usize>) -> Operand {
        self.nodes.push((node, span.clone()));
        Operand { node: (self.nodes.len() - 1) as NodeId, span }
    }

    fn open(&mut self, frame: Frame, at: Range<usize>) -> Result<(), Diagnostic> {
        if self.depth == MAX_DEPTH {
            return Err(syntax::too_deep(at, MAX_DEPTH));
        }
        self.depth += 1;
        self.stack.push(frame);
        Ok(())
    }

    fn quote(&self) -> Quote<'_> {
        Quote { text: self.text, tokens: &self.tokens }
    }

    fn peek(&self) -> Kind {
        self.tokens[self.at].kind
    }

    /// The current token, which is read with this. The end is never passed.
    fn next(&mut self) -> Token {
        let token = self.tokens[self.at].clone();
        self.at = (self.at + 1).min(self.tokens.len() - 1);
        token
    }
}

/// What stood after an operand.
enum After {
    /// A closing bracket: what it closed is an operand again.
    Operand(Operand),
    /// An operator or a comma: another operand is wanted.
    Operator,
    /// The end of the formula, which is complete.
    End,
}

#[cfg(test)]
#[path = "parse_tests.rs"]
mod tests;
