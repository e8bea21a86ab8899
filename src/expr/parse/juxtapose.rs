//! Products written without a sign, and the places where such a product could be read in two ways.
//!
//! `2x`, `3(x+1)`, `x y`, `(x+1)(y-1)`, `2|x|`, `x²y`, `sin(x)cos(y)` are products that bind as `*`
//! does. A name directly before a bracket is a call. No product is read where people disagree
//! about its meaning:
//!
//! - after a quotient: `1/2x` is (1/2)x for some and 1/(2x) for others;
//! - after an exponent, unless it is bracketed or, above anything but a number, a plain integer:
//!   `x^2y` is x²y, but `e^2x`, `2^x y` and `x^-2y` are refused;
//! - after a root of a name: `√x y` is refused, while `√2x` is (√2)x;
//! - after a bar, before anything but a bar: in `|a|b|c|` bars pair in two ways.
//!
//! *Based on:* the style guides of the American Mathematical Society and the American Physical
//! Society, which contradict each other on 1/2x.

use std::ops::Range;

use super::{
    super::{
        BinaryOp, Node, functions,
        lex::{self, Kind, Token},
        syntax,
    },
    Frame, Operand, Parser, left_power,
};
use crate::diagnostic::Diagnostic;

/// Whether a waiting operator holds its operand tighter than a product does.
fn binds_tighter(frame: &Frame) -> bool {
    frame.right_power() > left_power(BinaryOp::Mul)
}

impl Parser<'_> {
    /// The token before the current one, if there is one.
    fn previous(&self) -> Option<&Token> {
        self.at.checked_sub(2).map(|at| &self.tokens[at])
    }

    /// Whether the current token begins a factor without a sign before it.
    pub(super) fn is_juxtaposed(&self) -> bool {
        let after_sign = self.previous().is_none_or(|token| matches!(token.kind, Kind::Op(_)));
        !after_sign && matches!(self.stack.last(), Some(Frame::Infix(BinaryOp::Mul, _)))
    }

    /// Whether `left` may be multiplied with what starts at `next`, the current token.
    pub(super) fn check_product(&self, left: &Operand, next: &Token) -> Result<(), Diagnostic> {
        let Some(last) = self.previous() else { return Ok(()) };
        let word = &self.text[last.span.clone()];
        if last.kind == Kind::Name && functions::exists(word) {
            return Err(syntax::bare_function(last.span.start..next.span.end, word));
        }
        let is_product = match (last.kind, next.kind) {
            (_, Kind::Number) => false,
            (Kind::Bar, next) => next == Kind::Bar,
            _ => true,
        };
        if !is_product {
            return Err(self.quote().missing_operator(next));
        }
        self.check_unambiguous(left, last, next)
    }

    /// Refuses a product after `left` if an operator that waits for `left` could wait for the
    /// product as well.
    fn check_unambiguous(
        &self,
        left: &Operand,
        last: &Token,
        next: &Token,
    ) -> Result<(), Diagnostic> {
        // The part of the formula that would be the waiting operator's operand.
        let mut right = left.span.clone();
        for frame in self.stack.iter().rev().take_while(|frame| binds_tighter(frame)) {
            let whole = |start: usize| start..next.span.end;
            match frame {
                Frame::Minus(minus) => right.start = minus.start,
                Frame::Root(sign) => {
                    if last.kind == Kind::Name {
                        let (a, b) = (self.clip(&right), self.factor(next));
                        let (first, second) = (format!("sqrt({a})*{b}"), format!("sqrt({a}*{b})"));
                        return Err(syntax::two_ways(whole(sign.start), &first, &second));
                    }
                    right.start = sign.start;
                }
                Frame::Infix(BinaryOp::Div, left) => {
                    let (a, b, c) = (self.clip(&left.span), self.clip(&right), self.factor(next));
                    let (first, second) = (format!("({a}/{b})*{c}"), format!("{a}/({b}*{c})"));
                    return Err(syntax::two_ways(whole(left.span.start), &first, &second));
                }
                Frame::Infix(BinaryOp::Pow, base) => {
                    if !self.is_clear_exponent(base, &right) {
                        let (a, b) = (self.clip(&base.span), self.clip(&right));
                        let c = self.factor(next);
                        let (first, second) = (format!("{a}^({b})*{c}"), format!("{a}^({b}*{c})"));
                        return Err(syntax::two_ways(whole(base.span.start), &first, &second));
                    }
                    right.start = base.span.start;
                }
                Frame::Infix(_, left) => right.start = left.span.start,
                _ => {}
            }
        }
        Ok(())
    }

    /// Whether nobody reads on after the exponent that starts `exponent`.
    fn is_clear_exponent(&self, base: &Operand, exponent: &Range<usize>) -> bool {
        let is_number = match &self.nodes[base.node as usize].0 {
            Node::Number { .. } => true,
            Node::Name(name) => name == "e",
            _ => false,
        };
        match self.text[exponent.clone()].chars().next() {
            Some('0'..='9' | '.') => !is_number,
            Some('(' | '|') => true,
            _ => false,
        }
    }

    /// Refuses a power of a root without brackets: `√x²` is |x| for some and x for others.
    pub(super) fn check_power(&self, base: &Operand, power: &Token) -> Result<(), Diagnostic> {
        if self.previous().is_some_and(|last| last.kind == Kind::Power) {
            let span = base.span.start..power.span.end;
            return Err(syntax::two_ways(span, "(a^b)^c", "a^(b^c)"));
        }
        let mut waiting = self.stack.iter().rev();
        let root = waiting.find(|frame| !matches!(frame, Frame::Minus(_)));
        if let Some(Frame::Root(sign)) = root {
            let base = self.clip(&base.span);
            let n = match power.kind {
                Kind::Power => lex::power(&self.text[power.span.clone()]),
                _ => "…".to_owned(),
            };
            let (first, second) = (format!("sqrt({base})^{n}"), format!("sqrt({base}^{n})"));
            return Err(syntax::two_ways(sign.start..power.span.end, &first, &second));
        }
        Ok(())
    }

    /// A part of the formula for a proposal; only dots if it is long.
    fn clip(&self, span: &Range<usize>) -> &str {
        let text = &self.text[span.clone()];
        if text.len() <= 24 && !text.contains('\n') { text } else { "…" }
    }

    /// How the factor that starts at `next`, the current token, is written in a proposal.
    fn factor(&self, next: &Token) -> String {
        let text = &self.text[next.span.clone()];
        match next.kind {
            Kind::Name if self.peek() == Kind::Open => format!("{text}(…)"),
            Kind::Name => text.to_owned(),
            Kind::Bar => "|…|".to_owned(),
            Kind::Root => "sqrt(…)".to_owned(),
            _ => "(…)".to_owned(),
        }
    }
}
