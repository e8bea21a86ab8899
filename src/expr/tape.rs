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
    roots: Vec<Id>,
    instructions: Vec<Instruction>,
    n_slots: u32,
    n_choices: u32,
    result: u32,
    region: Option<u32>,
    axes: [bool; 3],
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
    /// Schedules what `root` needs, and what `region` does if there is one: a second result that
    /// is at most 0 where the first one counts.
    #[must_use]
    pub fn new(nodes: &[Node], root: Id, region: Option<Id>) -> Self {
        let roots: Vec<Id> = [root].into_iter().chain(region).collect();
        Self::allocate(prune(nodes, &roots))
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

    /// The slot with the region's value, if there is a region.
    #[must_use]
    pub fn region(&self) -> Option<usize> {
        self.region.map(|slot| slot as usize)
    }

    /// Whether the result depends on the coordinate `axis` (0, 1 or 2) at all.
    #[must_use]
    pub fn depends_on(&self, axis: usize) -> bool {
        self.axes[axis]
    }

    /// Number of minima, maxima and absolute values, and one if there is a region.
    #[must_use]
    pub fn n_choices(&self) -> usize {
        self.n_choices as usize + usize::from(self.region.is_some())
    }

    /// The tape for a box on which the choices went as given, one for each in order. If there is a
    /// region it is the last choice, and `First` where it holds the whole box.
    ///
    /// # Panics
    /// If `choices` ends before the tape's choices do.
    #[must_use]
    pub fn shortened(&self, choices: impl IntoIterator<Item = Choice>) -> Self {
        let mut choices = choices.into_iter();
        let outcomes: Vec<Choice> = self
            .nodes
            .iter()
            .map(|node| {
                let outcome = if is_choice(node) { choices.next() } else { Some(Choice::Both) };
                outcome.unwrap_or_else(|| panic!("one outcome for every choice of the tape"))
            })
            .collect();
        let in_region = choices.next() == Some(Choice::First);
        let roots = &self.roots[..if in_region { 1 } else { self.roots.len() }];
        // What lost is not looked at: of a large tape, little is left in a small box.
        let needed = self.needed(roots, &outcomes);
        let mut nodes: Vec<Node> = Vec::new();
        let mut moved: Vec<Id> = vec![0; self.nodes.len()];
        for (id, node) in self.nodes.iter().enumerate().filter(|&(id, _)| needed[id]) {
            let node = node.map_operands(|operand| moved[operand as usize]);
            let simplified = match (node, outcomes[id]) {
                (Node::Unary(_, a) | Node::Binary(_, a, _), Choice::First) => Simplified::Alias(a),
                (Node::Binary(_, _, b), Choice::Second) => Simplified::Alias(b),
                (Node::Unary(_, a), Choice::Second) => {
                    simplify(Node::Unary(Unary::Neg, a), |id| nodes[id as usize])
                }
                _ => simplify(node, |id| nodes[id as usize]),
            };
            moved[id] = match simplified {
                Simplified::Alias(id) => id,
                Simplified::Node(node) => {
                    nodes.push(node);
                    (nodes.len() - 1) as Id
                }
            };
        }
        let roots: Vec<Id> = roots.iter().map(|&root| moved[root as usize]).collect();
        Self::allocate(prune(&nodes, &roots))
    }

    /// The nodes that `roots` need where choices went as given.
    fn needed(&self, roots: &[Id], outcomes: &[Choice]) -> Vec<bool> {
        let mut needed = vec![false; self.nodes.len()];
        roots.iter().for_each(|&root| needed[root as usize] = true);
        for (id, node) in self.nodes.iter().enumerate().rev() {
            if !needed[id] {
                continue;
            }
            match (*node, outcomes[id]) {
                (Node::Binary(_, a, _), Choice::First) => needed[a as usize] = true,
                (Node::Binary(_, _, b), Choice::Second) => needed[b as usize] = true,
                _ => node.operands().for_each(|operand| needed[operand as usize] = true),
            }
        }
        needed
    }

    /// Gives every result a slot that is free from then until its last use.
    fn allocate((nodes, roots): (Vec<Node>, Vec<Id>)) -> Self {
        let last_use = last_uses(&nodes, &roots);
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
        let result = slot_of[roots[0] as usize];
        let region = roots.get(1).map(|&root| slot_of[root as usize]);
        let is_read =
            |axis| nodes.iter().any(|node| matches!(node, Node::Variable(a) if *a == axis));
        let axes = [0, 1, 2].map(is_read);
        Self { nodes, roots, instructions, n_slots, n_choices, result, region, axes }
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

/// The last reader of every node; the roots are read after the end.
fn last_uses(nodes: &[Node], roots: &[Id]) -> Vec<Option<usize>> {
    let mut last = vec![None; nodes.len()];
    for (id, &node) in nodes.iter().enumerate() {
        reads(nodes, node).for_each(|operand| last[operand as usize] = Some(id));
    }
    roots.iter().for_each(|&root| last[root as usize] = Some(usize::MAX));
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
    use crate::{
        eval::Machine,
        expr::Graph,
        math::{Interval, Notes, Point, Wave},
    };
    use proptest::prelude::*;

    /// max(x, y) + |z| with x above y and z negative.
    #[test]
    fn shortening_keeps_the_winners() {
        let mut g = Graph::default();
        let [x, y, z] = [0, 1, 2].map(|axis| g.variable(axis));
        let max = g.binary(Binary::Max, x, y);
        let abs = g.unary(Unary::Abs, z);
        let sum = g.add(max, abs);
        let tape = Tape::new(g.nodes(), sum, None);
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
        let short = Tape::new(g.nodes(), sum, None).shortened([Choice::Second]);
        assert!(short.instructions().is_empty());
        assert_eq!(short.result(), 1);
    }

    /// In a row of spheres, a box around one of them, and one far from all.
    #[test]
    fn far_spheres_drop_out_of_a_union() {
        let spheres: Vec<[f64; 4]> =
            (0..100).map(|i| [3.0 * f64::from(i), 0.0, 0.0, 1.0]).collect();
        let tape = crate::expr::Expr::spheres(&spheres).tape();
        let shortened = |x: f64, y: f64| {
            let at = |v: f64| [Interval { lo: v - 0.5, hi: v + 0.5 }];
            let mut machine = Machine::<Interval<f64>, 1>::default();
            machine.run((), &tape, &[at(x), at(y), at(0.0)], true);
            let choice = |&[first, second]: &[u64; 2]| match (first & 1, second & 1) {
                (1, _) => Choice::First,
                (_, 1) => Choice::Second,
                _ => Choice::Both,
            };
            tape.shortened(machine.choices().iter().map(choice))
        };
        assert_eq!(tape.n_choices(), 100);
        assert_eq!(shortened(150.0, 1.0).n_choices(), 1);
        assert_eq!(shortened(150.0, 9.0).instructions().len(), 1);
    }

    #[test]
    fn a_region_that_holds_the_box_is_dropped() {
        let mut g = Graph::default();
        let (x, y) = (g.variable(0), g.variable(1));
        let (f, region) = (g.powi(x, 2), g.powi(y, 2));
        let tape = Tape::new(g.nodes(), f, Some(region));
        assert_eq!((tape.n_choices(), tape.result(), tape.region()), (1, 3, Some(4)));
        let short = tape.shortened([Choice::First]);
        assert_eq!((short.n_choices(), short.region(), short.instructions().len()), (0, None, 1));
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
        assert_eq!(Tape::new(g.nodes(), sum, None).n_slots(), 4);
    }

    /// A graph of random operations on the coordinates, constants and earlier results.
    fn random_graph(seeds: &[(u8, u8, u8)]) -> (Graph, Id) {
        let mut g = Graph::default();
        let mut ids: Vec<Id> = (0..3).map(|axis| g.variable(axis)).collect();
        ids.extend([-1.5, 0.0, 3.0].map(|v| g.constant(Constant::exact(v))));
        for &(op, a, b) in seeds {
            // Recent results are taken often, so that programs grow deep.
            let pick = |i: u8| ids[ids.len() - 1 - usize::from(i) % ids.len().min(9)];
            let (a, b) = (pick(a), pick(b));
            ids.push(match op % 14 {
                0 => g.add(a, b),
                1 => g.sub(a, b),
                2 => g.mul(a, b),
                3 => g.div(a, b),
                4 => g.binary(Binary::Min, a, b),
                5 => g.binary(Binary::Max, a, b),
                6 => g.binary(Binary::Atan2 { lifted: false }, a, b),
                7 => g.binary(Binary::Harmonic { wave: Wave::Cos, n: 5 }, a, b),
                8 => g.unary(Unary::Sqrt, a),
                9 => g.unary(Unary::Abs, a),
                10 => g.wave(Wave::Sin, a),
                11 => g.powi(a, i32::from(b as u8 % 5)),
                12 => g.unary(Unary::Exp, a),
                _ => g.unary(Unary::Neg, a),
            });
        }
        (g, ids[ids.len() - 1])
    }

    /// Every node's value, one after the other.
    fn naive_value(nodes: &[Node], root: Id, p: [f64; 3]) -> f64 {
        let mut values: Vec<f64> = Vec::new();
        for node in nodes {
            let mut slots = [[Point(0.0)]; 2];
            for (slot, operand) in slots.iter_mut().zip(node.operands()) {
                *slot = [Point(values[operand as usize])];
            }
            let mut notes = [Notes::clear::<f64>(())];
            match *node {
                Node::Variable(axis) => slots[0] = [Point(p[usize::from(axis)])],
                Node::Constant(c) => slots[0] = [Point(c.value)],
                Node::Unary(op, _) => op.apply(&mut slots, &mut notes, (0, 0)),
                Node::Binary(op, ..) => op.apply(&mut slots, &mut notes, (0, 1, 0)),
            }
            values.push(slots[0][0].0);
        }
        values[root as usize]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2_000))]

        #[test]
        fn slots_hold_what_the_nodes_mean(
            seeds in prop::collection::vec(any::<(u8, u8, u8)>(), 1..60),
            p in [-2.0..2.0_f64, -2.0..2.0_f64, -2.0..2.0_f64],
        ) {
            let (graph, root) = random_graph(&seeds);
            let tape = Tape::new(graph.nodes(), root, None);
            let mut machine = Machine::<Point<f64>, 1>::default();
            machine.run((), &tape, &p.map(|v| [Point(v)]), false);
            let (got, want) = (machine.slot(tape.result())[0].0, naive_value(graph.nodes(), root, p));
            prop_assert!(got.to_bits() == want.to_bits() || (got.is_nan() && want.is_nan()));
        }
    }

    #[test]
    fn a_constant_formula_has_a_tape() {
        let mut g = Graph::default();
        let c = g.constant(Constant::exact(2.5));
        let tape = Tape::new(g.nodes(), c, None);
        assert!(matches!(tape.instructions(), [Instruction::Constant(_, 3)]));
        assert_eq!(tape.result(), 3);
    }
}
