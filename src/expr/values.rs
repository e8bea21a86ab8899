//! Values of a graph at hand: of its parts that need no coordinates, and bounds over a box.

use super::graph::{Graph, Id, Node, prune};
use crate::math::{Constant, Interval, Notes, Number, Point};

/// Point values of the nodes of a growing graph, each computed once. Coordinates are NaN.
#[derive(Default)]
pub(super) struct PointValues {
    values: Vec<f64>,
}

impl PointValues {
    /// The value of the node `id`; NaN where it is undefined or needs coordinates.
    pub(super) fn at(&mut self, graph: &Graph, id: Id) -> f64 {
        if let Some(c) = graph.nodes()[id as usize].constant() {
            return c.value;
        }
        let new = graph.nodes().iter().skip(self.values.len());
        for node in new.take((id as usize + 1).saturating_sub(self.values.len())) {
            let value = self.evaluate(node);
            self.values.push(value);
        }
        self.values[id as usize]
    }

    fn evaluate(&self, node: &Node) -> f64 {
        let mut slots = [[Point::constant((), &Constant::exact(0.0))]; 2];
        for (slot, operand) in slots.iter_mut().zip(node.operands()) {
            *slot = [Point(self.values[operand as usize])];
        }
        let mut notes = [Notes::clear::<f64>(())];
        match *node {
            Node::Variable(_) => return f64::NAN,
            Node::Constant(c) => return c.value,
            Node::Unary(op, _) => op.apply(&mut slots, &mut notes, (0, 0)),
            Node::Binary(op, ..) => op.apply(&mut slots, &mut notes, (0, 1, 0)),
        }
        slots[0][0].0
    }
}

/// A lower bound of the node `root` in the box of these bounds of x, y and z; −∞ where it may be
/// undefined.
pub(super) fn over_box(graph: &Graph, root: Id, place: [(f64, f64); 3]) -> f64 {
    let mut values: Vec<Interval<f64>> = Vec::new();
    let mut notes = [Notes::clear::<f64>(())];
    // Other parts of the graph may be undefined there.
    let (nodes, roots) = prune(graph.nodes(), &[root]);
    for node in &nodes {
        let zero = Interval { lo: 0.0, hi: 0.0 };
        let mut slots = [[zero]; 2];
        for (slot, operand) in slots.iter_mut().zip(node.operands()) {
            *slot = [values[operand as usize]];
        }
        match *node {
            Node::Variable(axis) => {
                let (lo, hi) = place[usize::from(axis)];
                slots[0] = [Interval { lo, hi }];
            }
            Node::Constant(c) => slots[0] = [Interval::constant((), &c)],
            Node::Unary(op, _) => op.apply(&mut slots, &mut notes, (0, 0)),
            Node::Binary(op, ..) => op.apply(&mut slots, &mut notes, (0, 1, 0)),
        }
        values.push(slots[0][0]);
    }
    if notes[0].partial { f64::NEG_INFINITY } else { values[roots[0] as usize].lo }
}
