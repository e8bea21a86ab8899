//! The values of the parts of a graph that need no coordinates.

use super::graph::{Graph, Id, Node};
use crate::math::{Constant, Notes, Number, Point};

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
