//! From tokens to an [`Ast`]: an operator-precedence parser whose stack is a `Vec`.
//!
//! *Based on:* V. Pratt, "Top Down Operator Precedence", POPL 1973. The recursion is written out
//! as a stack of [`Frame`]s, so that no formula, however nested, can overflow the thread's stack.
//!
//! The parser alternates between two states: it wants an operand, or it has one and looks at what
//! follows. From the loosest to the tightest, the operators are `=` and comparisons; `|`; `&`; `+ -`;
//! `* /`; unary minus and plus; `^`, which alone groups from the right; raised powers; root signs; the
//! point before a call. So `-x^2` is `-(x^2)` and `2^-x^2` is `2^(-(x^2))`. A product may be written
//! without `*`: see [`juxtapose`].
//!
//! A bar closes the innermost open bracket if that is a bar and a value stands before it, else it
//! opens: `|x||y|` is a product, and `|2*|x||` needs its `*`. In the text of a shape a bar that could
//! open after a value is the union instead.

use std::ops::Range;

use super::{
    Ast, BinaryOp, Comparison, Node, NodeId, functions,
    lex::{self, Kind, Token, lex},
    symbols,
    syntax::{self, Quote},
};
use crate::diagnostic::Diagnostic;

mod brackets;
mod juxtapose;

/// Parses a formula. Names and numbers of arguments are not checked.
///
/// # Errors
/// All characters that cannot stand in a formula, or else the first mistake of syntax.
pub fn parse(text: &str) -> Result<Ast, Vec<Diagnostic>> {
    parse_as(text, false)
}

/// Parses a shape: a formula in which `a | b` and `a & b` are union and intersection.
///
/// # Errors
/// As [`parse`].
pub fn parse_shape(text: &str) -> Result<Ast, Vec<Diagnostic>> {
    parse_as(text, true)
}

fn parse_as(text: &str, is_shape: bool) -> Result<Ast, Vec<Diagnostic>> {
    let tokens = lex(text).map_err(|mistakes| match is_shape {
        true => {
            mistakes.into_iter().map(|mistake| syntax::without_vectors(mistake, text)).collect()
        }
        false => mistakes,
    })?;
    let (nodes, stack) = (Vec::new(), Vec::new());
    let mut parser = Parser { text, is_shape, tokens, at: 0, nodes, stack, depth: 0 };
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
    /// A root sign at this span.
    Root(Range<usize>),
    /// The left side of an equation, or of a comparison.
    Relation(Option<Comparison>, Operand),
    /// An opening bracket at this span.
    Group(Range<usize>),
    /// An opening bar at this span, and whether it stands directly after a value.
    Bars(Range<usize>, bool),
    /// A call.
    Call(Call),
}

/// A call that is not closed yet.
struct Call {
    name: Range<usize>,
    /// Between the name and the bracket, as in sin²(x).
    power: Option<Range<usize>>,
    open: Range<usize>,
    args: Vec<NodeId>,
    /// Where the call begins: at its name, or at what stands before the point.
    start: usize,
    /// The name before the `=` of the argument that is being read.
    label: Option<Range<usize>>,
}

impl Frame {
    /// How tightly a waiting operator holds the operand on its right; brackets do not let go.
    fn right_power(&self) -> u8 {
        match self {
            Self::Root(_) => 13,
            Self::Minus(_) => 9,
            Self::Infix(op, _) => match op {
                BinaryOp::Union => 2,
                BinaryOp::Intersection => 4,
                BinaryOp::Add | BinaryOp::Sub => 6,
                BinaryOp::Mul | BinaryOp::Div => 8,
                BinaryOp::Pow => 11,
            },
            _ => 0,
        }
    }
}

/// How tightly an infix operator holds the operand on its left.
fn left_power(op: BinaryOp) -> u8 {
    match op {
        BinaryOp::Union => 1,
        BinaryOp::Intersection => 3,
        BinaryOp::Add | BinaryOp::Sub => 5,
        BinaryOp::Mul | BinaryOp::Div => 7,
        BinaryOp::Pow => 12,
    }
}

struct Parser<'a> {
    text: &'a str,
    /// Whether bars after values are unions.
    is_shape: bool,
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
            Kind::Name => return self.name(span),
            Kind::Op(BinaryOp::Sub) => self.stack.push(Frame::Minus(span)),
            Kind::Op(BinaryOp::Add) => {}
            Kind::Open => self.open(Frame::Group(span.clone()), span)?,
            Kind::Bar => self.open(Frame::Bars(span.clone(), self.is_juxtaposed()), span)?,
            Kind::Root => self.stack.push(Frame::Root(span)),
            Kind::End if self.last_opened_just_now() => return Err(self.never_closed()),
            _ => return Err(self.quote().missing_operand(&token)),
        }
        Ok(None)
    }

    /// Reads a name, or a call up to its first argument.
    fn name(&mut self, name: Range<usize>) -> Result<Option<Operand>, Diagnostic> {
        let power = self.power_of_function(&name)?;
        if self.peek() == Kind::Equals && self.takes_label() {
            if let Some(Frame::Call(call)) = self.stack.last_mut() {
                call.label = Some(name);
            }
            self.next();
            return Ok(None);
        }
        if self.peek() != Kind::Open {
            let text = lex::name(&self.text[name.clone()]).to_owned();
            return Ok(Some(self.push(Node::Name(text), name)));
        }
        let start = name.start;
        self.call(name, start, power, Vec::new())
    }

    /// Reads what stands after the point that follows `receiver`: a call of which it is the first
    /// argument.
    fn method(&mut self, receiver: &Operand, dot: &Range<usize>) -> Result<After, Diagnostic> {
        let name = self.next().span; // the lexer has seen it
        if self.peek() != Kind::Open {
            return Err(syntax::no_method(dot.start..name.end, &self.text[name]));
        }
        let closed = self.call(name, receiver.span.start, None, vec![receiver.node])?;
        Ok(closed.map_or(After::Operator, After::Operand))
    }

    /// Reads a call up to the next argument, or all of it if nothing stands in its brackets.
    fn call(
        &mut self,
        name: Range<usize>,
        start: usize,
        power: Option<Range<usize>>,
        args: Vec<NodeId>,
    ) -> Result<Option<Operand>, Diagnostic> {
        let open = self.next().span;
        let call = Call { name, power, open: open.clone(), args, start, label: None };
        self.open(Frame::Call(call), open)?;
        if self.peek() == Kind::Close {
            let close = self.next();
            return self.close_bracket(None, &close).map(Some);
        }
        Ok(None)
    }

    /// Reads the power between the name of a function and its bracket: sin²(x) and sin^2(x) are
    /// (sin(x))².
    fn power_of_function(
        &mut self,
        name: &Range<usize>,
    ) -> Result<Option<Range<usize>>, Diagnostic> {
        let name = &self.text[name.clone()];
        let kind = |n: usize| self.tokens.get(self.at + n).map(|token| token.kind);
        let n_tokens = match (kind(0), kind(1), kind(2)) {
            (Some(Kind::Power), Some(Kind::Open), _) => 1,
            (Some(Kind::Op(BinaryOp::Pow)), Some(Kind::Number), Some(Kind::Open)) => 2,
            _ => return Ok(None),
        };
        if !functions::exists(name) {
            return Ok(None);
        }
        self.at += n_tokens;
        let power = self.tokens[self.at - 1].span.clone();
        if self.text[power.clone()].starts_with('⁻') {
            return Err(syntax::inverse_or_reciprocal(power, name));
        }
        Ok(Some(power))
    }

    /// Reads what stands after an operand.
    fn after(&mut self, operand: Operand) -> Result<After, Diagnostic> {
        let token = self.next();
        match token.kind {
            Kind::Op(op @ (BinaryOp::Intersection | BinaryOp::Union)) if !self.is_shape => {
                return Err(self.quote().sign_of_shapes(&token, op));
            }
            Kind::Op(op) => {
                match op {
                    BinaryOp::Pow => self.check_power(&operand, &token)?,
                    BinaryOp::Intersection => self.check_single(&token)?,
                    _ => {}
                }
                self.infix(op, operand);
                return Ok(After::Operator);
            }
            Kind::Power => {
                self.check_power(&operand, &token)?;
                return Ok(After::Operand(self.raised(operand, token.span)));
            }
            Kind::Bar if self.closes_bars() => {}
            Kind::Bar if self.is_shape => {
                self.check_single(&token)?;
                self.infix(BinaryOp::Union, operand);
                return Ok(After::Operator);
            }
            Kind::Dot => return self.method(&operand, &token.span),
            Kind::Number | Kind::Name | Kind::Root | Kind::Open | Kind::Bar => {
                self.check_product(&operand, &token)?;
                self.infix(BinaryOp::Mul, operand);
                self.at -= 1; // the token is read again, as the start of the second factor
                return Ok(After::Operator);
            }
            Kind::Equals | Kind::Comparison(_) | Kind::Comma | Kind::Close | Kind::End => {}
        }
        let operand = self.complete(operand, 0);
        match token.kind {
            Kind::Close => self.close_bracket(Some(operand), &token).map(After::Operand),
            Kind::Bar => Ok(After::Operand(self.close_bars(&operand, &token))),
            Kind::Comma => self.argument(&operand, token.span).map(|()| After::Operator),
            Kind::Equals => self.relation(None, operand, token.span).map(|()| After::Operator),
            Kind::Comparison(comparison) => {
                self.relation(Some(comparison), operand, token.span).map(|()| After::Operator)
            }
            _ => self.finish(&operand).map(|()| After::End),
        }
    }

    /// Refuses a sign between shapes that is written twice.
    fn check_single(&self, sign: &Token) -> Result<(), Diagnostic> {
        let next = &self.tokens[self.at];
        if next.kind == sign.kind && next.span.start == sign.span.end {
            let span = sign.span.start..next.span.end;
            return Err(syntax::double_sign(span, &self.text[sign.span.clone()]));
        }
        Ok(())
    }

    /// Begins an operation with its left operand.
    fn infix(&mut self, op: BinaryOp, operand: Operand) {
        let left = self.complete(operand, left_power(op));
        self.stack.push(Frame::Infix(op, left));
    }

    /// Raises `base` to the integer that is written at `power`.
    fn raised(&mut self, base: Operand, power: Range<usize>) -> Operand {
        let written = &self.text[power.clone()];
        let plain = if written.is_ascii() { written.to_owned() } else { lex::power(written) };
        let digits = plain.trim_start_matches('-').to_owned();
        let mut exponent = self.push(Node::Number { text: digits }, power.clone());
        if plain.starts_with('-') {
            exponent = self.push(Node::Neg(exponent.node), power.clone());
        }
        let span = base.span.start..base.span.end.max(power.end);
        self.push(Node::Binary(BinaryOp::Pow, base.node, exponent.node), span)
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
                Some(Frame::Root(sign)) => {
                    let span = sign.start..right.span.end;
                    let function = symbols::root(&self.text[sign.clone()]).to_owned();
                    Operand { span, ..self.push(Node::Call(function, vec![right.node]), sign) }
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

    /// Takes the left side of an equation or a comparison at the sign after it.
    fn relation(
        &mut self,
        comparison: Option<Comparison>,
        left: Operand,
        sign: Range<usize>,
    ) -> Result<(), Diagnostic> {
        match self.stack.last() {
            None => {
                self.stack.push(Frame::Relation(comparison, left));
                Ok(())
            }
            Some(Frame::Relation(None, _)) if comparison.is_none() => {
                Err(syntax::second_equals(sign))
            }
            Some(Frame::Relation(..)) => Err(syntax::second_relation(sign)),
            Some(_) => Err(self.quote().relation_in_brackets(sign)),
        }
    }

    /// Completes the formula at its end.
    fn finish(&mut self, right: &Operand) -> Result<(), Diagnostic> {
        match self.stack.last() {
            None => Ok(()),
            Some(Frame::Relation(comparison, left)) => {
                let (a, b, span) = (left.node, right.node, left.span.start..right.span.end);
                let node = match *comparison {
                    None => Node::Equation(a, b),
                    Some(comparison) => Node::Comparison(comparison, a, b),
                };
                self.push(node, span);
                Ok(())
            }
            Some(_) => Err(self.never_closed()),
        }
    }

    fn push(&mut self, node: Node, span: Range<usize>) -> Operand {
        self.nodes.push((node, span.clone()));
        Operand { node: (self.nodes.len() - 1) as NodeId, span }
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
