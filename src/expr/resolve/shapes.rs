//! Shapes in formulas: calls that make them, and the signs that join them.

use std::ops::Range;

use super::{Lowered, Resolver};
use crate::{
    diagnostic::Diagnostic,
    expr::{
        Ast, BinaryOp, DefinitionKind, Node as AstNode, NodeId, explain, explain_shapes, lex,
        shapes::{self, Argument, Build, Function, Kind, Number, Solid, sets},
    },
};

/// A call's parameter gets these arguments, each a node of the tree.
type Given = Vec<Vec<NodeId>>;

impl Lowered {
    /// The part as a shape: what depends on the coordinates is one, negative inside.
    pub(super) fn as_solid(&self) -> Option<Solid> {
        self.solid.or_else(|| self.varies.then(|| Solid::of_formula(self.id)))
    }

    fn of_solid(solid: Solid, is_damaged: bool) -> Self {
        Self { id: solid.surface, solid: Some(solid), varies: true, is_damaged }
    }
}

impl Resolver<'_> {
    /// `a | b`, `a & b`, or `a - b` of shapes; nothing if it is another operation.
    pub(super) fn joined(
        &mut self,
        text: Option<usize>,
        ast: &Ast,
        node: usize,
        parts: &[Lowered],
    ) -> Option<Lowered> {
        let (AstNode::Binary(op, a, b), ref span) = ast.nodes[node] else { return None };
        let (first, second) = (parts[a as usize], parts[b as usize]);
        let is_damaged = first.is_damaged || second.is_damaged;
        let join = match (op, first.solid.is_some(), second.solid.is_some()) {
            (BinaryOp::Union, ..) => sets::either,
            (BinaryOp::Intersection, ..) => sets::both,
            (BinaryOp::Sub, true, true) => sets::without,
            (BinaryOp::Sub, true, false) | (BinaryOp::Sub, false, true) if !is_damaged => {
                self.complain(text, explain_shapes::shape_and_value(span.clone()));
                return Some(self.stand_in());
            }
            (_, true, true) if !is_damaged => {
                self.complain(text, explain_shapes::arithmetic(span.clone()));
                return Some(self.stand_in());
            }
            _ => return None,
        };
        if op == BinaryOp::Union
            && let Some(inner) = self.unbracketed(ast, span, b, parts)
        {
            self.complain(text, explain_shapes::order_of_sets(span.clone(), inner));
            return Some(self.stand_in());
        }
        let mut solids = [first, second].into_iter().zip([a, b]).map(|(part, node)| {
            let solid = part.as_solid();
            if solid.is_none() && !part.is_damaged {
                self.complain(text, explain_shapes::no_shape(ast.extent(node)));
            }
            solid
        });
        let (Some(first), Some(second)) = (solids.next()?, solids.next()?) else {
            return Some(self.stand_in());
        };
        Some(Lowered::of_solid(join(&mut self.graph, first, second), is_damaged))
    }

    /// The sign of `b`, the right side of a union, if it is `&` or `-` without brackets around it: then
    /// the union would come last, and many read it first.
    fn unbracketed(
        &self,
        ast: &Ast,
        union: &Range<usize>,
        b: NodeId,
        parts: &[Lowered],
    ) -> Option<&'static str> {
        let (AstNode::Binary(op, ..), ref span) = ast.nodes[b as usize] else { return None };
        let is_bracketed = span.end != union.end;
        match op {
            BinaryOp::Intersection if !is_bracketed => Some("&"),
            BinaryOp::Sub if !is_bracketed && parts[b as usize].solid.is_some() => Some("-"),
            _ => None,
        }
    }

    /// A call of a function that makes a shape.
    pub(super) fn shape(
        &mut self,
        text: Option<usize>,
        ast: &Ast,
        node: usize,
        function: &'static Function,
        parts: &[Lowered],
    ) -> Lowered {
        let (AstNode::Call(_, ref arguments), ref span) = ast.nodes[node] else {
            return self.stand_in();
        };
        if let Some(user) = text.map(|index| &self.definitions.list[index])
            && user.kind == DefinitionKind::Parameter
        {
            let user = lex::name(&user.name);
            self.complain(text, explain::not_constant(user, function.name, span.clone()));
            return self.stand_in();
        }
        if arguments.iter().any(|&argument| parts[argument as usize].is_damaged) {
            return self.stand_in();
        }
        let built = assigned(ast, function, span, arguments, parts)
            .and_then(|given| self.solid(ast, function, span, &given, parts));
        match built {
            Ok((solid, warning)) => {
                if let Some(warning) = warning {
                    let warning = explain_shapes::no_length(function.name, span.clone(), warning);
                    self.warn(text, warning);
                }
                Lowered::of_solid(solid, false)
            }
            Err(mistake) => {
                self.complain(text, mistake);
                self.stand_in()
            }
        }
    }

    /// The solid, and what is to be said about it.
    fn solid(
        &mut self,
        ast: &Ast,
        function: &'static Function,
        span: &Range<usize>,
        given: &Given,
        parts: &[Lowered],
    ) -> Result<(Solid, Option<&'static str>), Diagnostic> {
        let mut arguments = Vec::new();
        for (nodes, &(name, kind)) in given.iter().zip(function.parameters) {
            let place = |node: NodeId| ast.extent(node);
            arguments.push(match kind {
                Kind::Solid | Kind::Solids => {
                    let solid = |&node: &NodeId| {
                        let solid = parts[node as usize].as_solid();
                        solid.ok_or_else(|| {
                            explain_shapes::number_for_shape(function, name, place(node))
                        })
                    };
                    Argument::Solids(nodes.iter().map(solid).collect::<Result<_, _>>()?)
                }
                _ => match nodes.first() {
                    Some(&node) => {
                        let part = &parts[node as usize];
                        if part.varies {
                            return Err(explain_shapes::no_number(
                                function,
                                name,
                                place(node),
                                part.solid.is_some(),
                            ));
                        }
                        let value = self.values.at(&self.graph, part.id);
                        if !value.is_finite() {
                            return Err(explain_shapes::no_value(function.name, name, place(node)));
                        }
                        Argument::Number(Some(Number { id: part.id, value }))
                    }
                    None => Argument::Number(match kind {
                        Kind::Or(value) => {
                            let id = self.graph.constant(crate::math::Constant::exact(value));
                            Some(Number { id, value })
                        }
                        _ => None,
                    }),
                },
            });
        }
        let mut call = Build { g: &mut self.graph, arguments, warning: None };
        let built = function.build(&mut call);
        let warning = call.warning;
        let solid = built.map_err(|complaint| {
            let nodes = complaint.parameter.map(|index| given[index].as_slice());
            let at = nodes.and_then(<[NodeId]>::first).map(|&node| ast.extent(node));
            explain_shapes::wrong_argument(function, at.unwrap_or_else(|| span.clone()), &complaint)
        })?;
        if self.graph.nodes().len() > shapes::MAX_NODES {
            return Err(explain_shapes::too_large(span.clone()));
        }
        Ok((solid, warning))
    }
}

/// Which parameter gets which arguments.
fn assigned(
    ast: &Ast,
    function: &'static Function,
    span: &Range<usize>,
    arguments: &[NodeId],
    parts: &[Lowered],
) -> Result<Given, Diagnostic> {
    let parameters = function.parameters;
    let mut given: Given = vec![Vec::new(); parameters.len()];
    let mut next = 0;
    let mut has_names = false;
    for &argument in arguments {
        let (node, at) = &ast.nodes[argument as usize];
        if let AstNode::Named(name, value) = node {
            has_names = true;
            let index = parameters.iter().position(|(parameter, _)| parameter == name);
            let Some(index) = index else {
                return Err(explain_shapes::unknown_argument(function, name, at.clone()));
            };
            if !given[index].is_empty() {
                return Err(explain_shapes::given_before(function, name, at.clone()));
            }
            given[index].push(*value);
            continue;
        }
        if has_names {
            return Err(explain_shapes::after_names(function, ast.extent(argument)));
        }
        // The next parameter that takes it: one of many shapes takes all shapes that follow.
        let is_solid = parts[argument as usize].as_solid().is_some();
        while let Some((_, kind)) = parameters.get(next) {
            let is_full = !given[next].is_empty();
            match kind {
                Kind::Solids if is_solid || !is_full => break,
                Kind::Named | Kind::Solids => next += 1,
                _ if is_full => next += 1,
                _ => break,
            }
        }
        match given.get_mut(next) {
            Some(nodes) => nodes.push(argument),
            None => return Err(explain_shapes::too_many(function, span.clone(), arguments.len())),
        }
    }
    for (nodes, &(name, kind)) in given.iter().zip(parameters) {
        let is_needed = matches!(kind, Kind::Solid | Kind::Solids | Kind::Number);
        if nodes.is_empty() && is_needed {
            return Err(explain_shapes::missing_argument(function, name, span.clone()));
        }
    }
    Ok(given)
}
