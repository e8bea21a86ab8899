//! The same formula at other places: coordinates of a graph replaced by what depends on them.

use super::graph::{Graph, Id, Node};

impl Graph {
    /// What `roots` are where x, y and z are `coordinates`. Parts that do not depend on a coordinate
    /// stay the nodes that they are.
    pub(super) fn substitute<const N: usize>(
        &mut self,
        roots: [Id; N],
        coordinates: [Id; 3],
    ) -> [Id; N] {
        let last = roots.iter().copied().max().unwrap_or(0) as usize;
        let mut needed = vec![false; last + 1];
        roots.iter().for_each(|&root| needed[root as usize] = true);
        for id in (0..=last).rev() {
            if needed[id] {
                self.nodes()[id].operands().for_each(|operand| needed[operand as usize] = true);
            }
        }
        let mut moved: Vec<Id> = (0..=last as Id).collect();
        for id in (0..=last).filter(|&id| needed[id]) {
            moved[id] = match self.nodes()[id] {
                Node::Variable(axis) => coordinates[usize::from(axis)],
                node if node.operands().all(|a| moved[a as usize] == a) => id as Id,
                node => self.add_node(node.map_operands(|operand| moved[operand as usize])),
            };
        }
        roots.map(|root| moved[root as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Binary, Constant};

    #[test]
    fn coordinates_are_replaced_at_once() {
        let mut g = Graph::default();
        let [x, y, z] = [0, 1, 2].map(|axis| g.variable(axis));
        let sum = g.binary(Binary::Sub, x, y);
        // x and y change places: neither is replaced twice.
        let [swapped] = g.substitute([sum], [y, x, z]);
        assert!(
            matches!(g.nodes()[swapped as usize], Node::Binary(Binary::Sub, a, b) if (a, b) == (y, x))
        );
        let three = g.constant(Constant::exact(3.0));
        let [constant] = g.substitute([sum], [three, three, z]);
        assert_eq!(g.nodes()[constant as usize].constant(), Some(&Constant::exact(0.0)));
        assert_eq!(g.substitute([z], [y, x, z]), [z]);
    }
}
