//! Programs ready to run: a list of instructions over few slots, and how to shorten it.
//!
//! A [`Tape`] is a pruned program whose results were given slots, reused once a result is no
//! longer needed, so that a batch stays in the nearest cache. Slots 0, 1 and 2 hold the
//! coordinates and are never overwritten.
//!
//! Where a box decides a minimum, a maximum or an absolute value, everything below it needs only
//! the operand that won. [`Tape::shortened`] removes the other one, and what then became constant.
//! The support of a blended sphere ends so as well: max(1 − u, 0) is decided for 0, and the term
//! vanishes from the sum.
//!
//! *Based on:* M. Keeter, "Massively Parallel Rendering of Complex Closed-Form Implicit Surfaces",
//! SIGGRAPH 2020, section 3 (shortened tapes).

use super::graph::{Id, Node, Simplified, prune, simplify};
use crate::math::{Binary, Constant, Unary};

/// One step: an operation, the slots it reads and the slot it writes.
#[derive(Clone, Copy, Debug)]
pub enum Instruction {
    /// `slots[out] = c`
    Constant(Constant, u32),
    /// `slots[out] = op slots[a]`
    Unary(Unary, u32, u32),
    /// `slots[out] = slots[a] op slots[b]`
    Binary(Binary, u32, u32, u32),
    /// `slots[out] = slots[a] op c`
    BinaryConstant(Binary, u32, Constant, u32),
}

/// A program ready to run; see the file's text.
#[derive(Clone, Debug)]
pub struct Tape {
    nodes: Vec<Node>,
    instructions: Vec<Instruction>,
    n_slots: u32,
    result: u32,
    n_choices: u32,
}

/// The outcome of every choice of a tape on one box, in the order of its instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// Not decided.
    Both,
    /// The first operand, or |a| = a.
    First,
    /// The second operand, or |a| = −a.
    Second,
}

/// Slots that hold the coordinates.
const N_VARIABLES: u32 = 3;

impl Tape {
    /// Schedules what `root` needs.
    #[must_use]
    pub fn new(nodes: &[Node], root: Id) -> Self {
        Self::allocate(prune(nodes, root))
    }

    /// The steps in order.
    #[must_use]
    pub fn instructions(&self) -> &[Instruction] {
        &self.instructions
    }

    /// Number of slots to provide, at least 3.
    #[must_use]
    pub fn n_slots(&self) -> usize {
        self.n_slots as usize
    }

    /// The slot with the result.
    #[must_use]
    pub fn result(&self) -> usize {
        self.result as usize
    }

    /// Number of minima, maxima and absolute values.
    #[must_use]
    pub fn n_choices(&self) -> usize {
        self.n_choices as usize
    }

    /// The tape for a box on which the choices went as given, one for each in order.
    ///
    /// # Panics
    /// If `choices` ends before the tape's choices do.
    #[must_use]
    pub fn shortened(&self, choices: impl IntoIterator<Item = Choice>) -> Self {
        let mut choices = choices.into_iter();
        let mut nodes: Vec<Node> = Vec::with_capacity(self.nodes.len());
        let mut moved: Vec<Id> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            let choice = if is_choice(node) { choices.next() } else { Some(Choice::Both) };
            assert!(choice.is_some(), "one outcome for every choice of the tape");
            let node = node.map_operands(|operand| moved[operand as usize]);
            let simplified = match (node, choice.unwrap_or(Choice::Both)) {
                (Node::Unary(_, a) | Node::Binary(_, a, _), Choice::First) => Simplified::Alias(a),
                (Node::Binary(_, _, b), Choice::Second) => Simplified::Alias(b),
                (Node::Unary(_, a), Choice::Second) => {
                    simplify(Node::Unary(Unary::Neg, a), |id| nodes[id as usize])
                }
                _ => simplify(node, |id| nodes[id as usize]),
            };
            moved.push(match simplified {
                Simplified::Alias(id) => id,
                Simplified::Node(node) => {
                    nodes.push(node);
                    (nodes.len() - 1) as Id
                }
            });
        }
        let root = moved.last().copied().unwrap_or(0);
        Self::allocate(prune(&nodes, root))
    }

    /// Gives every result a slot that is free from then until its last use.
    fn allocate(nodes: Vec<Node>) -> Self {
        let last_use = last_uses(&nodes);
        let mut slot_of: Vec<u32> = vec![0; nodes.len()];
        let mut free: Vec<u32> = Vec::new();
        let mut n_slots = N_VARIABLES;
        let mut instructions = Vec::with_capacity(nodes.len());
        for (id, &node) in nodes.iter().enumerate() {
            if let Node::Variable(axis) = node {
                slot_of[id] = u32::from(axis);
                continue;
            }
            if last_use[id].is_none() {
                continue; // a constant that is only read as part of instructions
            }
            // An operation may write where it read, so its operands are released first.
            for operand in reads(&nodes, node) {
                let slot = slot_of[operand as usize];
                let released = last_use[operand as usize] == Some(id) && slot >= N_VARIABLES;
                if released && !free.contains(&slot) {
                    free.push(slot);
                }
            }
            let out = free.pop().unwrap_or_else(|| {
                n_slots += 1;
                n_slots - 1
            });
            slot_of[id] = out;
            instructions.push(instruction(&nodes, node, &slot_of, out));
        }
        let n_choices = nodes.iter().filter(|node| is_choice(node)).count() as u32;
        let result = slot_of.last().copied().unwrap_or(0);
        Self { nodes, instructions, n_slots, result, n_choices }
    }
}

fn is_choice(node: &Node) -> bool {
    matches!(node, Node::Unary(Unary::Abs, _) | Node::Binary(Binary::Min | Binary::Max, ..))
}

/// The constant that a node carries in its instruction instead of reading it from a slot.
fn inlined(nodes: &[Node], node: Node) -> Option<Constant> {
    match node {
        Node::Binary(op, _, b) if op.commutes() => nodes[b as usize].constant().copied(),
        _ => None,
    }
}

/// The operands that a node reads from slots.
fn reads(nodes: &[Node], node: Node) -> impl Iterator<Item = Id> {
    let from_slots = if inlined(nodes, node).is_some() { 1 } else { 2 };
    node.operands().take(from_slots)
}

/// The last reader of every node; the root is read after the end.
fn last_uses(nodes: &[Node]) -> Vec<Option<usize>> {
    let mut last = vec![None; nodes.len()];
    for (id, &node) in nodes.iter().enumerate() {
        reads(nodes, node).for_each(|operand| last[operand as usize] = Some(id));
    }
    if let Some(root) = last.last_mut() {
        *root = Some(usize::MAX);
    }
    last
}

fn instruction(nodes: &[Node], node: Node, slot_of: &[u32], out: u32) -> Instruction {
    let slot = |operand: Id| slot_of[operand as usize];
    match (node, inlined(nodes, node)) {
        (Node::Binary(op, a, _), Some(c)) => Instruction::BinaryConstant(op, slot(a), c, out),
        (Node::Binary(op, a, b), None) => Instruction::Binary(op, slot(a), slot(b), out),
        (Node::Unary(op, a), _) => Instruction::Unary(op, slot(a), out),
        (Node::Constant(c), _) => Instruction::Constant(c, out),
        (Node::Variable(_), _) => unreachable!("coordinates have their own slots"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Graph;

    /// max(x, y) + |z| with x above y and z negative.
    #[test]
    fn shortening_keeps_the_winners() {
        let mut g = Graph::default();
        let [x, y, z] = [0, 1, 2].map(|axis| g.variable(axis));
        let max = g.binary(Binary::Max, x, y);
        let abs = g.unary(Unary::Abs, z);
        let sum = g.add(max, abs);
        let tape = Tape::new(g.nodes(), sum);
        assert_eq!(tape.n_choices(), 2);
        let short = tape.shortened([Choice::First, Choice::Second]);
        assert_eq!(short.n_choices(), 0);
        assert!(matches!(
            short.instructions(),
            [Instruction::Unary(Unary::Neg, 2, 3), Instruction::Binary(Binary::Add, 0, 3, 3)]
        ));
    }

    #[test]
    fn a_decided_support_removes_its_term() {
        let mut g = Graph::default();
        let (x, y) = (g.variable(0), g.variable(1));
        let zero = g.constant(Constant::exact(0.0));
        let support = g.binary(Binary::Max, x, zero);
        let term = g.powi(support, 4);
        let sum = g.add(y, term);
        let short = Tape::new(g.nodes(), sum).shortened([Choice::Second]);
        assert!(short.instructions().is_empty());
        assert_eq!(short.result(), 1);
    }

    #[test]
    fn slots_are_reused() {
        let mut g = Graph::default();
        let x = g.variable(0);
        let mut sum = x;
        for _ in 0..100 {
            let square = g.powi(sum, 2);
            sum = g.add(square, x);
        }
        assert_eq!(Tape::new(g.nodes(), sum).n_slots(), 4);
    }

    #[test]
    fn a_constant_formula_has_a_tape() {
        let mut g = Graph::default();
        let c = g.constant(Constant::exact(2.5));
        let tape = Tape::new(g.nodes(), c);
        assert!(matches!(tape.instructions(), [Instruction::Constant(_, 3)]));
        assert_eq!(tape.result(), 3);
    }
}
