//! The shape of an octree, level by level: which children are mixed and which lie inside.
//!
//! A node is *mixed* if the surface may pass through it. Only mixed nodes are stored; of the others
//! a bit in the parent tells whether they lie inside. The nodes of a level stand in Morton order,
//! so the children of a node are a run of the next level, and its start follows from the number of
//! child bits before the node.

/// The nodes of one level.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LevelMasks {
    /// Bit c: child c = x + 2y + 4z is mixed.
    pub mixed: Vec<u8>,
    /// Bit c: child c lies inside.
    pub inside: Vec<u8>,
}

/// What became of a node once its descendants are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeState {
    /// No surface and nothing inside.
    Empty,
    /// All inside.
    Inside,
    /// Stored.
    Mixed,
}

impl LevelMasks {
    /// Number of nodes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.mixed.len()
    }

    /// Whether there is no node.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.mixed.is_empty()
    }

    /// Adds a node behind the others.
    pub fn push(&mut self, mixed: u8, inside: u8) {
        self.mixed.push(mixed);
        self.inside.push(inside);
    }

    /// All nodes, in memory of just their size; none is left.
    #[must_use]
    pub fn take(&mut self) -> Self {
        let taken = self.clone();
        self.mixed.clear();
        self.inside.clear();
        taken
    }

    /// Adds the nodes of another part of the same level, which follow in Morton order.
    pub fn append(&mut self, mut next: Self) {
        self.mixed.append(&mut next.mixed);
        self.inside.append(&mut next.inside);
    }

    /// Takes account of what became of the children, given in order, and removes the nodes that
    /// turn out not to be mixed themselves. Returns what became of each node.
    #[must_use]
    pub fn settle(&mut self, children: &[NodeState]) -> Vec<NodeState> {
        let mut children = children.iter();
        for (mixed, inside) in self.mixed.iter_mut().zip(&mut self.inside) {
            for bit in bits(*mixed) {
                match children.next() {
                    Some(NodeState::Mixed) | None => {}
                    Some(NodeState::Empty) => *mixed &= !(1 << bit),
                    Some(NodeState::Inside) => {
                        *mixed &= !(1 << bit);
                        *inside |= 1 << bit;
                    }
                }
            }
        }
        self.settle_above_voxels()
    }

    /// The same for nodes whose children are voxels, which are what their masks say.
    #[must_use]
    pub fn settle_above_voxels(&mut self) -> Vec<NodeState> {
        let mut kept = 0;
        let states = (0..self.len())
            .map(|i| {
                let masks = (self.mixed[i], self.inside[i]);
                // Written without a branch, and kept only if the next one goes elsewhere.
                (self.mixed[kept], self.inside[kept]) = masks;
                match masks {
                    (0, 0) => NodeState::Empty,
                    (0, 0xff) => NodeState::Inside,
                    _ => {
                        kept += 1;
                        NodeState::Mixed
                    }
                }
            })
            .collect();
        self.mixed.truncate(kept);
        self.inside.truncate(kept);
        states
    }
}

/// The nodes above voxels with these Morton codes, ascending: `depth` levels, the root's first. Nothing
/// lies inside.
pub(super) fn masks_above(mut codes: Vec<u64>, depth: u32) -> Vec<LevelMasks> {
    let mut levels = Vec::new();
    for _ in 0..depth {
        let mut level = LevelMasks::default();
        let mut parents: Vec<u64> = Vec::new();
        for children in codes.chunk_by(|a, b| a >> 3 == b >> 3) {
            parents.push(children[0] >> 3);
            level.push(children.iter().fold(0, |mask, code| mask | 1 << (code & 7)), 0);
        }
        levels.push(level);
        codes = parents;
    }
    levels.reverse();
    levels
}

/// The positions of the set bits, ascending.
pub fn bits(mask: u8) -> impl Iterator<Item = u32> {
    let mut rest = mask;
    std::iter::from_fn(move || {
        let bit = rest.trailing_zeros();
        rest &= rest.wrapping_sub(1);
        (bit < 8).then_some(bit)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settling_drops_nodes_and_keeps_order() {
        let mut level = LevelMasks { mixed: vec![0b11, 0b1, 0xff], inside: vec![0, 0b10, 0] };
        let mut children = vec![NodeState::Mixed, NodeState::Inside, NodeState::Empty];
        children.extend([NodeState::Inside; 8]);
        let states = level.settle(&children);
        assert_eq!(states, [NodeState::Mixed, NodeState::Mixed, NodeState::Inside]);
        assert_eq!(level, LevelMasks { mixed: vec![0b1, 0], inside: vec![0b10, 0b10] });
    }

    #[test]
    fn bits_are_listed_in_order() {
        assert_eq!(bits(0b1010_0001).collect::<Vec<_>>(), [0, 5, 7]);
        assert_eq!(bits(0).count(), 0);
    }
}
