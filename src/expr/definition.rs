//! What a scene defines for its formulas: parameters and named parts; and the order in which they
//! can be computed.
//!
//! Definitions may use each other whatever their order. The search for that order is a depth-first
//! walk whose stack is a `Vec`, so that no chain of definitions overflows the thread's stack.

use std::borrow::Cow;

use rustc_hash::FxHashMap;

use super::{Ast, Node, functions, lex};
use crate::diagnostic::Diagnostic;

/// A name with a formula behind it, which the formulas of a scene may use.
#[derive(Clone, Debug)]
pub struct Definition {
    /// How formulas refer to it: letters, digits and `_`, or one Greek letter.
    pub name: String,
    /// What its formula may use.
    pub kind: DefinitionKind,
    /// Its formula. A tree without nodes stands for one that was refused: what uses it is not
    /// resolved, and is not a mistake of its own.
    pub ast: Ast,
}

/// What the formula of a [`Definition`] may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DefinitionKind {
    /// Other definitions that are the same everywhere; no coordinates.
    Parameter,
    /// All other definitions and the coordinates.
    Let,
    /// The same; it stands for a shape.
    Shape,
}

/// A mistake, or a warning, about a formula that was resolved with definitions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistake {
    /// The definition whose formula the span belongs to; `None` for the formula itself.
    pub definition: Option<usize>,
    /// What is wrong. Where it is about a definition's name, the span is the whole of its formula.
    pub diagnostic: Diagnostic,
}

/// Definitions by name, with what is wrong about their names.
pub(super) struct Definitions<'a> {
    pub(super) list: &'a [Definition],
    by_name: FxHashMap<&'a str, usize>,
}

impl<'a> Definitions<'a> {
    pub(super) fn new(list: &'a [Definition], mistakes: &mut Vec<Mistake>) -> Self {
        let mut by_name = FxHashMap::default();
        for (index, definition) in list.iter().enumerate() {
            let name = lex::name(&definition.name);
            let complaint = if !lex::is_name(&definition.name) {
                Some(not_a_name(&definition.name))
            } else if functions::exists(name) {
                Some((
                    format!("`{name}` is a function and cannot be defined anew"),
                    "choose another name, such as `a` or `my_name`",
                ))
            } else if by_name.contains_key(name) {
                let help = "give one of the two another name";
                Some((format!("`{name}` is defined twice"), help))
            } else {
                by_name.insert(name, index);
                None
            };
            mistakes.extend(complaint.map(|(message, help)| Mistake {
                definition: Some(index),
                diagnostic: Diagnostic::new(definition.ast.span(), message).help(help),
            }));
        }
        Self { list, by_name }
    }

    /// The definition of this name.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    /// All usable names.
    pub(super) fn names(&self) -> Vec<&'a str> {
        let named = self.list.iter().map(|definition| lex::name(&definition.name));
        named.filter(|name| self.by_name.contains_key(name)).collect()
    }

    /// What a definition uses: the nodes that name definitions, and which ones.
    fn uses(&self, index: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let nodes = self.list[index].ast.nodes.iter().enumerate();
        nodes.filter_map(|(node, (kind, _))| match kind {
            Node::Name(name) => self.find(name).map(|used| (node, used)),
            _ => None,
        })
    }

    /// All definitions, those that are used before those that use them; cycles are mistakes.
    pub(super) fn ordered(&self, mistakes: &mut Vec<Mistake>) -> Vec<usize> {
        let mut order = Vec::with_capacity(self.list.len());
        let mut state = vec![State::New; self.list.len()];
        for start in 0..self.list.len() {
            if state[start] != State::New {
                continue;
            }
            state[start] = State::Open;
            let mut path = vec![(start, self.uses(start))];
            while let Some((index, uses)) = path.last_mut() {
                let index = *index;
                match uses.next() {
                    None => {
                        state[index] = State::Done;
                        order.push(index);
                        path.pop();
                    }
                    Some((_, used)) if state[used] == State::New => {
                        state[used] = State::Open;
                        path.push((used, self.uses(used)));
                    }
                    Some((node, used)) if state[used] == State::Open => {
                        let first = path.iter().rposition(|&(open, _)| open == used);
                        let cycle: Vec<usize> =
                            path[first.unwrap_or(0)..].iter().map(|&(open, _)| open).collect();
                        cycle.iter().for_each(|&member| state[member] = State::InCycle);
                        mistakes.push(self.cycle(&cycle, node));
                    }
                    Some(_) => {}
                }
            }
        }
        order
    }

    /// The complaint about a cycle, which the last member closes at its node `node`.
    fn cycle(&self, cycle: &[usize], node: usize) -> Mistake {
        let name = |index: usize| lex::name(&self.list[index].name);
        let (first, last) = (cycle[0], cycle[cycle.len() - 1]);
        let mut names: Vec<Cow<'_, str>> = cycle.iter().map(|&index| name(index).into()).collect();
        if names.len() > MAX_SHOWN {
            let hidden = names.len() - MAX_SHOWN + 1;
            names
                .splice(MAX_SHOWN / 2..MAX_SHOWN / 2 + hidden, [format!("({hidden} more)").into()]);
        }
        names.push(name(first).into());
        let message = format!("`{}` is defined by itself: {}", name(first), names.join(" -> "));
        Mistake {
            definition: Some(last),
            diagnostic: Diagnostic::new(self.list[last].ast.nodes[node].1.clone(), message)
                .label("this closes the circle")
                .help("one of them must be given without the others"),
        }
    }
}

/// Longer cycles are shown with their beginning and their end.
const MAX_SHOWN: usize = 8;

/// How far the walk over the definitions is with one of them.
#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    New,
    /// On the path from where the walk began.
    Open,
    /// On that path, and in a cycle that was reported.
    InCycle,
    Done,
}

fn not_a_name(written: &str) -> (String, &'static str) {
    let help = "a name has letters a to z, digits and `_`, and begins with a letter";
    (format!("`{written}` cannot be a name in a formula"), help)
}
