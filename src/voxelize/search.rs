//! One thread's search through an octant, level by level, 64 boxes at a time.
//!
//! The nodes of a level that survived are kept in Morton order; eight of them give the 64 boxes of
//! the next pass. Where the tape holds choices, the nodes of a level are split into runs that
//! decided them alike, and every run goes on with its own shortened tape. Runs are searched one
//! after the other, so that every level is still written in Morton order.

use std::sync::Arc;

use fearless_simd::Simd;

use super::{corners::Corners, normals::NormalFinder};
use crate::{
    eval::{BATCH, BoxEvaluator, Boxes},
    expr::{Choice, Tape},
    math::{Lanes, Lattice, child_of},
    octree::{LevelMasks, NodeState, OctNormal, bits},
};

/// Nodes of one level, in Morton order, that share a tape.
pub(super) struct Run {
    nodes: Vec<[u32; 3]>,
    tape: Arc<Tape>,
}

impl Run {
    /// The whole domain.
    pub(super) fn root(tape: Arc<Tape>) -> Self {
        Self { nodes: vec![[0; 3]], tape }
    }

    /// One run for each node.
    pub(super) fn into_single_nodes(self) -> impl Iterator<Item = Self> {
        let Self { nodes, tape } = self;
        nodes.into_iter().map(move |node| Self { nodes: vec![node], tape: tape.clone() })
    }
}

/// What was found in one octant.
pub(super) struct Subtree {
    /// What became of the octant itself.
    pub(super) root: NodeState,
    /// Its nodes, from its own level to the one above the voxels.
    pub(super) levels: Vec<LevelMasks>,
    /// The voxels' normals in Morton order.
    pub(super) normals: Vec<OctNormal>,
    /// Voxels without a usable gradient, by their place in `normals`.
    pub(super) missing_normals: Vec<u32>,
    /// Boxes evaluated on each level of the whole octree.
    pub(super) boxes_tested: Vec<u64>,
}

/// The state of one thread's search.
pub(super) struct Search<'a, S: Simd, L: Lanes<Token = S>, const G: usize> {
    corners: &'a Corners<L::Scalar>,
    depth: u32,
    evaluator: BoxEvaluator<L, G>,
    boxes: Boxes<L::Scalar>,
    normal_finder: NormalFinder<'a, S>,
    masks: Vec<LevelMasks>,
    boxes_tested: Vec<u64>,
}

/// Nodes this close to the voxels keep the tape they have: their runs would be too short to fill
/// batches.
const LEVELS_WITHOUT_SPLIT: u32 = 2;

/// Parents in one batch.
const PARENTS: usize = BATCH / 8;

impl<'a, S: Simd, L: Lanes<Token = S>, const G: usize> Search<'a, S, L, G> {
    pub(super) fn new(simd: S, lattice: &'a Lattice, corners: &'a Corners<L::Scalar>) -> Self {
        let depth = lattice.depth();
        Self {
            corners,
            depth,
            evaluator: BoxEvaluator::new(simd),
            boxes: Boxes::default(),
            normal_finder: NormalFinder::new(simd, lattice),
            masks: vec![LevelMasks::default(); depth as usize],
            boxes_tested: vec![0; depth as usize],
        }
    }

    /// The masks of all levels searched since the last call.
    pub(super) fn take_masks(&mut self) -> Vec<LevelMasks> {
        self.masks.iter_mut().map(std::mem::take).collect()
    }

    /// The boxes evaluated on each level since the last call.
    pub(super) fn take_boxes_tested(&mut self) -> Vec<u64> {
        self.boxes_tested.iter_mut().map(std::mem::take).collect()
    }

    /// Searches from the root down to the nodes of level `stop`, and returns those, in order.
    pub(super) fn descend(&mut self, root: Run, stop: u32) -> Vec<Run> {
        let mut runs = vec![root];
        for level in 0..stop {
            runs = runs.into_iter().flat_map(|run| self.split_children(run, level)).collect();
        }
        runs
    }

    /// Searches the single node of `run`, on `level`, down to the voxels.
    pub(super) fn subtree(&mut self, run: Run, level: u32) -> Subtree {
        self.refine(run, level);
        let (normals, missing_normals) = self.normal_finder.take();
        let mut levels = self.take_masks().split_off(level as usize);
        let mut states = vec![NodeState::Mixed; normals.len()];
        for masks in levels.iter_mut().rev() {
            states = masks.settle(&states);
        }
        let root = states.first().copied().unwrap_or(NodeState::Empty);
        let boxes_tested = self.take_boxes_tested();
        Subtree { root, levels, normals, missing_normals, boxes_tested }
    }

    fn refine(&mut self, run: Run, level: u32) {
        if level == self.depth {
            self.normal_finder.find(&run.tape, &run.nodes);
        } else if run.tape.n_choices() > 0 && level + LEVELS_WITHOUT_SPLIT < self.depth {
            for run in self.split_children(run, level) {
                self.refine(run, level + 1);
            }
        } else {
            let Run { nodes, tape } = run;
            let mut children = Vec::new();
            self.test_children(&nodes, level, &tape, false, |_, child| children.push(child));
            self.refine(Run { nodes: children, tape }, level + 1);
        }
    }

    /// The surviving children of the nodes on `level`, in runs that decided their choices alike.
    fn split_children(&mut self, run: Run, level: u32) -> Vec<Run> {
        let Run { nodes, tape } = run;
        let mut runs: Vec<Run> = Vec::new();
        let mut last: Vec<Choice> = Vec::new();
        let mut choices = Vec::new();
        self.test_children(&nodes, level, &tape, true, |outcome, child| {
            choices.clear();
            choices.extend(outcome());
            match runs.last_mut() {
                Some(run) if choices == last => run.nodes.push(child),
                _ => {
                    let decided = choices.iter().any(|&choice| choice != Choice::Both);
                    let tape = if decided {
                        Arc::new(tape.shortened(choices.iter().copied()))
                    } else {
                        tape.clone()
                    };
                    runs.push(Run { nodes: vec![child], tape });
                    std::mem::swap(&mut last, &mut choices);
                }
            }
        });
        runs
    }

    /// Tests the children of the nodes on `level`, records the masks of the nodes, and passes on
    /// every child that survives, in order, with a way to ask how its choices went.
    fn test_children(
        &mut self,
        nodes: &[[u32; 3]],
        level: u32,
        tape: &Tape,
        trace: bool,
        mut survivor: impl FnMut(&dyn Fn() -> Vec<Choice>, [u32; 3]),
    ) {
        let edge = 1 << (self.depth - level - 1);
        for parents in nodes.chunks(PARENTS) {
            let mut outside = 0;
            for (p, &ijk) in parents.iter().enumerate() {
                let missing = self.corners.write_children(&mut self.boxes, 8 * p, ijk, edge);
                outside |= u64::from(missing) << (8 * p);
            }
            let present = (u64::MAX >> (BATCH - 8 * parents.len())) & !outside;
            self.boxes_tested[level as usize] += u64::from(present.count_ones());
            let verdict = self.evaluator.eval(tape, &self.boxes, trace);
            // A node that is undefined in part is divided until its undefined parts are empty; a
            // voxel is not divided, and counts as inside for the part that is defined.
            let voxels = level + 1 == self.depth;
            let inside = if voxels { verdict.inside_where_defined } else { verdict.inside };
            let mixed = !verdict.empty & !inside & present;
            let inside = inside & present;
            for (p, &ijk) in parents.iter().enumerate() {
                let of_parent = |mask: u64| (mask >> (8 * p)) as u8;
                self.masks[level as usize].push(of_parent(mixed), of_parent(inside));
                for c in bits(of_parent(mixed)) {
                    let outcome = || self.evaluator.choices(8 * p + c as usize).collect();
                    survivor(&outcome, child_of(ijk, c));
                }
            }
        }
    }
}
