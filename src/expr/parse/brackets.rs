//! Brackets, bars and calls: what opens, what closes, and what is said if one of them does not.

use std::ops::Range;

use super::{
    super::{
        Node, NodeId,
        lex::{self, Kind, Token},
        shapes, syntax,
    },
    Call, Frame, Operand, Parser,
};
use crate::diagnostic::Diagnostic;

/// The deepest nesting of brackets, calls and absolute values.
pub(super) const MAX_DEPTH: usize = 1000;

impl Parser<'_> {
    /// Opens a bracket at `at`.
    pub(super) fn open(&mut self, frame: Frame, at: Range<usize>) -> Result<(), Diagnostic> {
        if self.depth == MAX_DEPTH {
            return Err(syntax::too_deep(at, MAX_DEPTH));
        }
        self.depth += 1;
        self.stack.push(frame);
        Ok(())
    }

    /// Closes a group or a call at `)`; `last` is what stands before it, if anything does.
    pub(super) fn close_bracket(
        &mut self,
        last: Option<Operand>,
        close: &Token,
    ) -> Result<Operand, Diagnostic> {
        self.depth = self.depth.saturating_sub(1);
        match (self.stack.pop(), last) {
            (Some(Frame::Group(open)), Some(Operand { node, .. })) => {
                Ok(Operand { node, span: open.start..close.span.end })
            }
            (Some(Frame::Call(Call { name, power, mut args, start, label, .. })), last) => {
                args.extend(last.map(|argument| self.labelled(label, argument.node)));
                let function = lex::name(&self.text[name.clone()]).to_owned();
                let span = start..close.span.end;
                let call = Operand { span, ..self.push(Node::Call(function, args), name) };
                Ok(match power {
                    Some(power) => self.raised(call, power),
                    None => call,
                })
            }
            (Some(Frame::Bars(open, _)), _) => Err(syntax::never_closed(&open, true)),
            _ => Err(syntax::stray_close(close.span.clone())),
        }
    }

    /// Whether a bar after a value closes one: none of another kind may be open inside.
    pub(super) fn closes_bars(&self) -> bool {
        let mut open = self.stack.iter().rev().filter(|frame| frame.right_power() == 0);
        matches!(open.next(), Some(Frame::Bars(..)))
    }

    /// Closes an absolute value at the second `|`.
    pub(super) fn close_bars(&mut self, inner: &Operand, close: &Token) -> Operand {
        let start = match self.stack.pop() {
            Some(Frame::Bars(open, _)) => open.start,
            _ => unreachable!("a bar was found open"),
        };
        self.depth -= 1;
        self.push(Node::Abs(inner.node), start..close.span.end)
    }

    /// Takes an argument at the comma after it.
    pub(super) fn argument(
        &mut self,
        argument: &Operand,
        comma: Range<usize>,
    ) -> Result<(), Diagnostic> {
        let label = match self.stack.last_mut() {
            Some(Frame::Call(call)) => call.label.take(),
            _ => return Err(syntax::stray_comma(comma)),
        };
        let node = self.labelled(label, argument.node);
        if let Some(Frame::Call(call)) = self.stack.last_mut() {
            call.args.push(node);
        }
        Ok(())
    }

    /// An argument with the name before its `=`, if it has one.
    fn labelled(&mut self, label: Option<Range<usize>>, argument: NodeId) -> NodeId {
        match label {
            Some(name) => {
                let text = lex::name(&self.text[name.clone()]).to_owned();
                self.push(Node::Named(text, argument), name).node
            }
            None => argument,
        }
    }

    /// Whether the name that was read may name an argument: it stands at the start of one, and the
    /// call is of a function whose arguments have names.
    pub(super) fn takes_label(&self) -> bool {
        let before = self.at.checked_sub(2).map(|at| self.tokens[at].kind);
        let begins = matches!(before, Some(Kind::Open | Kind::Comma));
        matches!(self.stack.last(), Some(Frame::Call(call))
            if begins && call.label.is_none() && shapes::exists(&self.text[call.name.clone()]))
    }

    /// The complaint about the innermost open bracket. A bar after a value was perhaps meant to
    /// close one further out.
    pub(super) fn never_closed(&self) -> Diagnostic {
        let mut open = self.stack.iter().filter_map(|frame| match frame {
            Frame::Bars(open, after_value) => Some((open, true, *after_value)),
            Frame::Group(open) | Frame::Call(Call { open, .. }) => Some((open, false, false)),
            _ => None,
        });
        let innermost = open.clone().rev().find(|&(.., after_value)| !after_value);
        match innermost.or_else(|| open.next()) {
            Some((open, is_bar, _)) => syntax::never_closed(open, is_bar),
            None => Diagnostic::new(0..self.text.len(), "a bracket is never closed"),
        }
    }

    /// Whether the token before the current one opened the innermost bracket.
    pub(super) fn last_opened_just_now(&self) -> bool {
        match self.stack.last() {
            Some(Frame::Group(_) | Frame::Bars(..)) => true,
            Some(Frame::Call(Call { args, .. })) => args.is_empty(),
            _ => false,
        }
    }
}
