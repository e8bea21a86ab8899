//! Names to operations: from the trees of a formula and of the definitions that it may use to the
//! graph of a program.
//!
//! Every definition is lowered once, before those that use it, and its name then means that node:
//! a part that is used many times, directly or through others, is computed once.

use std::ops::Range;

use super::{
    Ast, BinaryOp, Comparison, Definition, DefinitionKind, Expr, Mistake, Node as AstNode,
    definition::Definitions,
    explain, explain_shapes, functions,
    graph::{Graph, Id},
    lex,
    literal::decimal,
    names,
    shapes::{self as making, Solid},
    values::PointValues,
};
use crate::{
    diagnostic::Diagnostic,
    math::{Binary, Unary},
};

mod shapes;

/// After so many mistakes the rest is not worth reading.
const MAX_MISTAKES: usize = 32;

/// A formula whose names are resolved.
#[derive(Clone, Debug)]
pub struct Resolved {
    /// The formula; a relation became a difference: left minus right, and right minus left for
    /// `>=`, so that a solid is where it is negative.
    pub expr: Expr,
    /// What the formula is.
    pub relation: Relation,
    /// What is probably not meant, though it has a meaning.
    pub warnings: Vec<Mistake>,
}

/// What a formula is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// Neither an equation nor a comparison.
    Value,
    /// `a = b`
    Equation,
    /// `a <= b` or `a >= b`: all places where it holds.
    Solid,
}

/// Resolves `ast` with `definitions`. See [`Expr::resolve`].
pub(super) fn resolve(ast: &Ast, definitions: &[Definition]) -> Result<Resolved, Vec<Mistake>> {
    resolve_as(ast, definitions, false)
}

/// Resolves a shape. See [`Expr::resolve_shape`].
pub(super) fn resolve_shape(
    ast: &Ast,
    definitions: &[Definition],
) -> Result<Resolved, Vec<Mistake>> {
    resolve_as(ast, definitions, true)
}

fn resolve_as(
    ast: &Ast,
    definitions: &[Definition],
    is_shape: bool,
) -> Result<Resolved, Vec<Mistake>> {
    let mut mistakes = Vec::new();
    let by_name = Definitions::new(definitions, &mut mistakes);
    let order = by_name.ordered(&mut mistakes);
    let mut resolver = Resolver {
        graph: Graph::default(),
        lowered: vec![None; definitions.len()],
        is_used: vec![false; definitions.len()],
        definitions: by_name,
        values: PointValues::default(),
        mistakes,
        warnings: Vec::new(),
        is_shape,
    };
    for index in order {
        resolver.define(index);
    }
    let mut root = resolver.lower(None, ast);
    if is_shape {
        root = resolver.as_shape(None, ast, root);
    }
    if root.is_damaged || !resolver.mistakes.is_empty() {
        let mut mistakes = resolver.mistakes;
        mistakes.truncate(MAX_MISTAKES);
        return Err(mistakes);
    }
    let mut warnings = resolver.hidden_names();
    warnings.append(&mut resolver.warnings);
    let expr = Expr::new(resolver.graph, root.id);
    Ok(Resolved { expr, relation: relation(ast), warnings })
}

fn relation(ast: &Ast) -> Relation {
    match ast.nodes.last() {
        Some((AstNode::Equation(..), _)) => Relation::Equation,
        Some((AstNode::Comparison(..), _)) => Relation::Solid,
        _ => Relation::Value,
    }
}

/// A part of a formula in the graph.
#[derive(Clone, Copy)]
struct Lowered {
    id: Id,
    /// The shape that it is, if it is one.
    solid: Option<Solid>,
    /// Whether it was written with coordinates.
    varies: bool,
    /// Whether it stands in for something that could not be made sense of.
    is_damaged: bool,
}

struct Resolver<'a> {
    definitions: Definitions<'a>,
    graph: Graph,
    /// The definitions done so far.
    lowered: Vec<Option<Lowered>>,
    is_used: Vec<bool>,
    values: PointValues,
    mistakes: Vec<Mistake>,
    warnings: Vec<Mistake>,
    /// Whether the formula makes a shape.
    is_shape: bool,
}

impl Resolver<'_> {
    /// Whether the definition `text`, or the formula, makes a shape.
    fn makes_shape(&self, text: Option<usize>) -> bool {
        text.map_or(self.is_shape, |index| {
            self.definitions.list[index].kind == DefinitionKind::Shape
        })
    }

    /// Lowers a definition.
    fn define(&mut self, index: usize) {
        let Definition { kind, ast, .. } = &self.definitions.list[index];
        let mut lowered = self.lower(Some(index), ast);
        if *kind == DefinitionKind::Shape {
            lowered = self.as_shape(Some(index), ast, lowered);
        } else if relation(ast) != Relation::Value {
            lowered.is_damaged = true;
            let diagnostic = Diagnostic::new(ast.span(), "a definition is a value")
                .label("this is an equation or a comparison")
                .help("write the relation in a formula, or the difference of its sides here");
            self.complain(Some(index), diagnostic);
        }
        if *kind == DefinitionKind::Parameter && !lowered.is_damaged {
            let value = self.values.at(&self.graph, lowered.id);
            if !value.is_finite() {
                lowered.is_damaged = true;
                let name = lex::name(&self.definitions.list[index].name);
                let diagnostic = Diagnostic::new(ast.span(), format!("`{name}` has no value"))
                    .label("undefined, or too large")
                    .help("it divides by 0, perhaps, or takes a root of a negative number");
                self.complain(Some(index), diagnostic);
            }
        }
        self.lowered[index] = Some(lowered);
    }

    /// Lowers the tree of the definition `text`, or of the formula.
    fn lower(&mut self, text: Option<usize>, ast: &Ast) -> Lowered {
        let mut parts: Vec<Lowered> = Vec::with_capacity(ast.nodes.len());
        for node in 0..ast.nodes.len() {
            let part = self.node(text, ast, node, &parts);
            parts.push(part);
        }
        parts.last().copied().unwrap_or_else(|| self.stand_in())
    }

    /// All of a tree as a shape.
    fn as_shape(&mut self, text: Option<usize>, ast: &Ast, root: Lowered) -> Lowered {
        let diagnostic = match (relation(ast), root.as_solid()) {
            _ if root.is_damaged => return root,
            (Relation::Equation, _) => explain_shapes::equation_for_shape(ast.span()),
            (_, None) => explain_shapes::no_shape(ast.span()),
            (_, solid) => return Lowered { solid, ..root },
        };
        self.complain(text, diagnostic);
        self.stand_in()
    }

    /// Something in place of what has no meaning, so that further mistakes are found.
    fn stand_in(&mut self) -> Lowered {
        Lowered { id: self.graph.variable(0), solid: None, varies: false, is_damaged: true }
    }

    fn complain(&mut self, definition: Option<usize>, diagnostic: Diagnostic) {
        if self.mistakes.len() < MAX_MISTAKES {
            self.mistakes.push(Mistake { definition, diagnostic });
        }
    }

    fn warn(&mut self, definition: Option<usize>, diagnostic: Diagnostic) {
        self.warnings.push(Mistake { definition, diagnostic });
    }

    fn node(&mut self, text: Option<usize>, ast: &Ast, node: usize, parts: &[Lowered]) -> Lowered {
        if let Some(joined) = self.joined(text, ast, node, parts) {
            return joined;
        }
        let graph = &mut self.graph;
        let part = |child: u32| parts[child as usize];
        let same = |id, a: Lowered| Lowered { id, solid: None, ..a };
        let both = |id, a: Lowered, b: Lowered| Lowered {
            id,
            solid: None,
            varies: a.varies || b.varies,
            is_damaged: a.is_damaged || b.is_damaged,
        };
        let (ref kind, ref span) = ast.nodes[node];
        match *kind {
            AstNode::Number { ref text } => Lowered {
                id: graph.constant(decimal(text)),
                solid: None,
                varies: false,
                is_damaged: false,
            },
            AstNode::Name(ref name) => self.name(text, name, span),
            AstNode::Named(_, a) => part(a),
            AstNode::Call(ref name, ref arguments) => match making::find(name) {
                Some(function) => self.shape(text, ast, node, function, parts),
                None => {
                    let arguments: Vec<Lowered> = arguments.iter().map(|&a| part(a)).collect();
                    self.call(text, name, span, &arguments)
                }
            },
            AstNode::Neg(a) => same(graph.unary(Unary::Neg, part(a).id), part(a)),
            AstNode::Abs(a) => same(graph.unary(Unary::Abs, part(a).id), part(a)),
            AstNode::Binary(op, a, b) => {
                let (a, b) = (part(a), part(b));
                both(binary(op, a.id, b.id, graph), a, b)
            }
            AstNode::Equation(a, b) | AstNode::Comparison(Comparison::AtMost, a, b) => {
                let (a, b) = (part(a), part(b));
                both(graph.sub(a.id, b.id), a, b)
            }
            AstNode::Comparison(Comparison::AtLeast, a, b) => {
                let (a, b) = (part(a), part(b));
                both(graph.sub(b.id, a.id), a, b)
            }
        }
    }

    fn name(&mut self, text: Option<usize>, name: &str, span: &Range<usize>) -> Lowered {
        let lowered = match self.definitions.find(name) {
            Some(index) => {
                self.is_used[index] = true;
                self.lowered[index]
            }
            None => names::lower(name, &mut self.graph).map(|id| Lowered {
                id,
                solid: None,
                varies: names::is_coordinate(name),
                is_damaged: false,
            }),
        };
        let Some(lowered) = lowered else {
            // A definition that is not lowered yet is in a cycle, which was complained about.
            if self.definitions.find(name).is_none() && self.mistakes.len() < MAX_MISTAKES {
                let defined = self.definitions.names();
                let is_shape = self.makes_shape(text);
                self.complain(text, explain::unknown_name(name, span.clone(), &defined, is_shape));
            }
            return self.stand_in();
        };
        let user = text.map(|index| &self.definitions.list[index]);
        if let Some(user) = user.filter(|user| user.kind == DefinitionKind::Parameter)
            && lowered.varies
        {
            let user = lex::name(&user.name);
            self.complain(text, explain::not_constant(user, name, span.clone()));
            return self.stand_in();
        }
        lowered
    }

    fn call(
        &mut self,
        text: Option<usize>,
        name: &str,
        span: &Range<usize>,
        arguments: &[Lowered],
    ) -> Lowered {
        let ids: Vec<Id> = arguments.iter().map(|argument| argument.id).collect();
        let function = functions::find(name);
        let is_damaged = arguments.iter().any(|argument| argument.is_damaged);
        if let Some(function) = function
            && let Some(parameter) = function.no_number(&self.graph, &ids)
        {
            if !is_damaged {
                self.complain(text, explain::no_number(function, parameter, span.clone()));
            }
            return self.stand_in();
        }
        if let Some(id) = function.and_then(|function| function.lower(&mut self.graph, &ids)) {
            return Lowered {
                id,
                solid: None,
                varies: arguments.iter().any(|argument| argument.varies),
                is_damaged,
            };
        }
        if self.mistakes.len() < MAX_MISTAKES {
            let span = span.clone();
            let diagnostic = match function {
                None => {
                    let defined = self.definitions.names();
                    explain::unknown_function(name, span, &defined, self.makes_shape(text))
                }
                Some(function) => explain::wrong_count(function, span, arguments.len()),
            };
            self.complain(text, diagnostic);
        }
        self.stand_in()
    }

    /// Warnings about the definitions that took a name which has a meaning without them.
    fn hidden_names(&self) -> Vec<Mistake> {
        let definitions = self.definitions.list.iter().zip(&self.is_used).enumerate();
        let hiding = definitions.filter_map(|(index, (definition, &is_used))| {
            let name = lex::name(&definition.name);
            (is_used && names::exists(name)).then(|| Mistake {
                definition: Some(index),
                diagnostic: explain::hidden(name, definition.ast.span()),
            })
        });
        hiding.collect()
    }
}

/// What an operator makes of two values.
pub(super) fn binary(op: BinaryOp, a: Id, b: Id, graph: &mut Graph) -> Id {
    match op {
        BinaryOp::Add => graph.add(a, b),
        BinaryOp::Sub => graph.sub(a, b),
        BinaryOp::Mul => graph.mul(a, b),
        BinaryOp::Div => graph.div(a, b),
        BinaryOp::Pow => graph.pow(a, b),
        BinaryOp::Intersection => graph.binary(Binary::Max, a, b),
        BinaryOp::Union => graph.binary(Binary::Min, a, b),
    }
}

#[cfg(test)]
#[path = "resolve_tests.rs"]
mod tests;
