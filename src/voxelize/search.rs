//! One thread's search through an octant, level by level, 64 boxes at a time.
//!
//! The nodes of a level that survived are kept in Morton order; eight of them give the 64 boxes of
//! the next pass. Where the tape holds choices, the nodes of a level are split into runs that
//! decided them alike, and every run goes on with its own shortened tape. Runs are searched one
//! after the other, so that every level is still written in Morton order.
//!
//! Blocks of 32³ voxels are searched with their gradients too: the slopes of F over a node may show
//! that F is not 0 there though its value does not. The last two levels are searched together; see
//! `bricks`.

use std::sync::Arc;

use fearless_simd::Simd;

use super::{
    affine::{AffineBounds, Record},
    brick::BRICK_LEVELS,
    closer::{CloserLook, ExactLook},
    corners::Corners,
    node::Family,
    normals::NormalFinder,
    open::OpenVoxels,
    shortened::ShortenedTapes,
    signs::{BLOCK_LEVELS, CornerSigns},
};
use crate::{
    eval::{BATCH, BoxEvaluator, Boxes, SlopeEvaluator},
    expr::{Choice, Tape},
    math::{Lanes, Lattice, child_of},
    octree::{LevelMasks, NodeState, OctNormal, bits},
};

/// Nodes of one level, in Morton order, that share a tape.
pub(super) struct Run {
    nodes: Vec<[u32; 3]>,
    pub(super) tape: Arc<Tape>,
}

impl Run {
    /// The whole domain.
    pub(super) fn root(tape: Arc<Tape>) -> Self {
        Self { nodes: vec![[0; 3]], tape }
    }

    /// The places of the nodes.
    pub(super) fn places(&self) -> impl Iterator<Item = [u32; 3]> {
        self.nodes.iter().copied()
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
    /// Voxels of which it is not proven that the surface passes through, by their place in
    /// `normals`.
    pub(super) candidates: Vec<u32>,
    /// Voxels without a usable gradient, by their place in `normals`.
    pub(super) missing_normals: Vec<u32>,
    /// What it took.
    pub(super) effort: Effort,
}

/// What a search evaluated.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Boxes decided on each level of the whole octree; entry 0 is the root's children.
    pub boxes: Vec<u64>,
    /// Boxes over which the gradient was evaluated.
    pub gradients: u64,
    /// Lattice corners at which the value was.
    pub corners: u64,
    /// Voxels that needed a closer look.
    pub closer_looks: u64,
}

impl Effort {
    fn new(depth: u32) -> Self {
        Self { boxes: vec![0; depth as usize], ..Self::default() }
    }

    /// Adds the counts of a search whose root is on `level`.
    pub fn add_below(&mut self, level: u32, other: &Self) {
        let first = level as usize;
        if self.boxes.len() < first + other.boxes.len() {
            self.boxes.resize(first + other.boxes.len(), 0);
        }
        self.boxes[first..].iter_mut().zip(&other.boxes).for_each(|(sum, n)| *sum += n);
        self.gradients += other.gradients;
        self.corners += other.corners;
        self.closer_looks += other.closer_looks;
    }

    /// Adds another one's counts.
    pub(super) fn add(&mut self, other: &Self) {
        self.add_below(0, other);
    }
}

/// Nodes this close to the voxels keep the tape they have: their runs would be too short to fill
/// batches.
const LEVELS_WITHOUT_SPLIT: u32 = 2;
/// The same where bricks are looked at only once, which does not pay for tapes of their own.
const LEVELS_WITHOUT_SPLIT_TO_OPEN: u32 = 3;

/// Fewer nodes than this of one level are cheaper to divide than to look at the gradients of.
const WORTH_SLOPES: usize = 16;

/// Parents in one batch.
const PARENTS: usize = BATCH / 8;

/// Neighbouring children that decided the choices of their tape alike: the first one, counted in
/// children of the whole run, and the choices.
struct Group {
    first: usize,
    choices: Vec<Choice>,
}

/// The state of one thread's search.
pub(super) struct Search<S: Simd, L: Lanes<Token = S>, const G: usize> {
    simd: S,
    pub(super) lattice: Arc<Lattice>,
    pub(super) corners: Arc<Corners<L::Scalar>>,
    certify: bool,
    pub(super) depth: u32,
    pub(super) values: BoxEvaluator<L, G>,
    pub(super) slopes: SlopeEvaluator<L, G>,
    pub(super) affine: AffineBounds<L>,
    /// How bounds of bricks and of octants have paid in this block.
    pub(super) records: [Record; 2],
    pub(super) boxes: Boxes<L::Scalar>,
    pub(super) inner_boxes: Boxes<L::Scalar>,
    pub(super) signs: CornerSigns<L::Scalar>,
    pub(super) closer: CloserLook<L, G>,
    pub(super) exact: ExactLook<S>,
    pub(super) normal_finder: NormalFinder<S>,
    tapes: ShortenedTapes,
    /// Where no more than open voxels is asked for, those found so far.
    pub(super) open: Option<OpenVoxels>,
    pub(super) masks: Vec<LevelMasks>,
    pub(super) candidates: Vec<u32>,
    pub(super) effort: Effort,
}

impl<S: Simd, L: Lanes<Token = S>, const G: usize> Search<S, L, G> {
    /// Where `certify` is false, only values are looked at.
    pub(super) fn new(
        simd: S,
        lattice: Arc<Lattice>,
        corners: Arc<Corners<L::Scalar>>,
        certify: bool,
    ) -> Self {
        let depth = lattice.depth();
        Self {
            simd,
            corners,
            certify,
            depth,
            values: BoxEvaluator::new(simd),
            slopes: SlopeEvaluator::new(simd),
            affine: AffineBounds::new(simd, &lattice),
            records: [Record::default(); 2],
            boxes: Boxes::default(),
            inner_boxes: Boxes::default(),
            signs: CornerSigns::new(),
            closer: CloserLook::new(simd, lattice.clone()),
            exact: CloserLook::new(simd, lattice.clone()),
            normal_finder: NormalFinder::new(simd, lattice.clone()),
            lattice,
            tapes: ShortenedTapes::default(),
            open: None,
            masks: vec![LevelMasks::default(); depth as usize],
            candidates: Vec::new(),
            effort: Effort::new(depth),
        }
    }

    /// Goes on to another lattice of as many levels.
    pub(super) fn enter(&mut self, lattice: Arc<Lattice>, corners: Arc<Corners<L::Scalar>>) {
        self.affine = AffineBounds::new(self.simd, &lattice);
        self.closer.enter(lattice.clone());
        self.exact.enter(lattice.clone());
        self.normal_finder.enter(lattice.clone());
        (self.lattice, self.corners) = (lattice, corners);
    }

    /// The masks of all levels searched since the last call.
    pub(super) fn take_masks(&mut self) -> Vec<LevelMasks> {
        self.masks.iter_mut().map(LevelMasks::take).collect()
    }

    /// Drops masks and tapes of what was searched.
    pub(super) fn forget(&mut self) {
        self.masks.iter_mut().for_each(|masks| drop(masks.take()));
        self.tapes.forget();
    }

    /// What was evaluated since the last call.
    pub(super) fn take_effort(&mut self) -> Effort {
        std::mem::replace(&mut self.effort, Effort::new(self.depth))
    }

    /// Searches from the root down to the nodes of level `stop` by values alone, and returns
    /// those, in order.
    pub(super) fn descend(&mut self, root: Run, stop: u32) -> Vec<Run> {
        let mut runs = vec![root];
        for level in 0..stop {
            runs = runs.into_iter().flat_map(|run| self.divide(run, level)).collect();
        }
        runs
    }

    /// The voxels below a root by values alone, and what that took.
    pub(super) fn places(&mut self, root: Run) -> (Vec<[u32; 3]>, Effort) {
        let runs = self.descend(root, self.depth);
        self.forget();
        (runs.iter().flat_map(Run::places).collect(), self.take_effort())
    }

    /// Searches the single node of `run`, on `level`, down to the voxels.
    pub(super) fn subtree(&mut self, run: Run, level: u32) -> Subtree {
        self.search(run, level);
        self.tapes.forget();
        let (normals, missing_normals) = self.normal_finder.take();
        let candidates = std::mem::take(&mut self.candidates);
        let mut levels = self.take_masks().split_off(level as usize);
        let mut levels_up = levels.iter_mut().rev();
        let mut states = levels_up.next().map_or_else(Vec::new, LevelMasks::settle_above_voxels);
        for masks in levels_up {
            states = masks.settle(&states);
        }
        let root = states.first().copied().unwrap_or(NodeState::Empty);
        let effort = self.take_effort();
        Subtree { root, levels, normals, candidates, missing_normals, effort }
    }

    /// Searches nodes above the blocks.
    pub(super) fn search(&mut self, run: Run, level: u32) {
        if level + BLOCK_LEVELS < self.depth {
            for run in self.divide(run, level) {
                self.search(run, level + 1);
            }
            return;
        }
        for run in run.into_single_nodes() {
            // What is done in a block depends on nothing else.
            self.records = [Record::default(); 2];
            for ijk in run.places() {
                self.signs.enter(ijk.map(|i| i << (self.depth - level)), &self.corners);
            }
            self.search_block(run, level);
        }
    }

    /// Searches nodes of one block.
    fn search_block(&mut self, run: Run, level: u32) {
        if self.certify && level + BRICK_LEVELS == self.depth {
            match self.open {
                Some(_) => self.open_bricks(&run),
                None => self.search_bricks(&run),
            }
            return;
        }
        if level + 1 == self.depth {
            self.divide_into_voxels(&run, level);
            return;
        }
        let runs = if self.certify {
            self.divide_with_slopes(run, level)
        } else {
            self.divide(run, level)
        };
        for run in runs {
            self.search_block(run, level + 1);
        }
    }

    /// Divides the nodes of a run on `level` by the values of F: the surviving children, in runs
    /// that decided their choices alike.
    pub(super) fn divide(&mut self, run: Run, level: u32) -> Vec<Run> {
        let (families, groups) = self.test_values(&run, level);
        self.children(run, level, &families, groups)
    }

    /// The same, by values and slopes.
    fn divide_with_slopes(&mut self, run: Run, level: u32) -> Vec<Run> {
        let (mut families, groups) = self.test_values(&run, level);
        // Bricks are bounded by their slopes anyway.
        if level + 1 + BRICK_LEVELS < self.depth {
            self.test_slopes(&run, level, &mut families);
        }
        self.children(run, level, &families, groups)
    }

    /// Divides the nodes above the voxels by the values of F, and keeps the voxels.
    fn divide_into_voxels(&mut self, run: &Run, level: u32) {
        let (families, _) = self.test_values(run, level);
        let mut voxels = Vec::with_capacity(4 * families.len());
        for (&node, family) in run.nodes.iter().zip(&families) {
            self.masks[level as usize].push(family.mixed, family.inside);
            voxels.extend(bits(family.mixed).map(|c| child_of(node, c)));
        }
        let first = self.normal_finder.len() as u32;
        self.candidates.extend(first..first + voxels.len() as u32);
        self.normal_finder.find(&run.tape, voxels);
    }

    /// Tests the children of nodes by the values of F over them. Where runs are
    /// still split, also tells how the choices went.
    fn test_values(&mut self, run: &Run, level: u32) -> (Vec<Family>, Vec<Group>) {
        let Run { nodes, tape } = run;
        let edge = 1 << (self.depth - level - 1);
        let is_voxel = level + 1 == self.depth;
        let without = match self.open {
            Some(_) => LEVELS_WITHOUT_SPLIT_TO_OPEN,
            None => LEVELS_WITHOUT_SPLIT,
        };
        let split = tape.n_choices() > 0 && level + without < self.depth;
        let mut families = vec![Family::EMPTY; nodes.len()];
        let mut groups: Vec<Group> = Vec::new();
        let mut rest = 0..nodes.len();
        let mut n_tested = 0;
        loop {
            let mut parents = [0; PARENTS];
            let mut n = 0;
            for i in rest.by_ref().take(PARENTS) {
                self.corners.write_children(&mut self.boxes, 8 * n, nodes[i], edge);
                parents[n] = i;
                n += 1;
            }
            if n == 0 {
                break;
            }
            let verdict = self.values.eval(tape, &self.boxes, 8 * n, split);
            // A node that is undefined in part is divided until its undefined parts are empty; a
            // voxel is not divided, and counts as inside for the part that is defined.
            let inside = if is_voxel { verdict.inside_where_defined() } else { verdict.inside() };
            let mixed = !verdict.empty & !inside;
            let regular = verdict.continuous & verdict.in_region;
            for (p, &i) in parents[..n].iter().enumerate() {
                let present = self.corners.present_children(nodes[i], edge);
                let of_parent = |lanes: u64| (lanes >> (8 * p)) as u8 & present;
                n_tested += u64::from(present.count_ones());
                let family = &mut families[i];
                family.mixed = of_parent(mixed);
                family.inside = of_parent(inside);
                family.regular = of_parent(regular);
                if split {
                    for c in bits(family.mixed) {
                        let first = 8 * i + c as usize;
                        let choices = self.values.choices(8 * p + c as usize);
                        match groups.last() {
                            Some(group) if group.choices.iter().copied().eq(choices) => {}
                            _ => {
                                let choices = self.values.choices(8 * p + c as usize).collect();
                                groups.push(Group { first, choices });
                            }
                        }
                    }
                }
            }
        }
        self.effort.boxes[level as usize] += n_tested;
        (families, groups)
    }

    /// Tests the surviving children by the gradient over them.
    fn test_slopes(&mut self, run: &Run, level: u32, families: &mut [Family]) {
        let Run { nodes, tape } = run;
        let edge = 1 << (self.depth - level - 1);
        let mut open: Vec<(usize, u32)> = Vec::new();
        for (i, family) in families.iter().enumerate() {
            open.extend(bits(family.mixed & family.regular).map(|c| (i, c)));
        }
        if open.len() < WORTH_SLOPES {
            return;
        }
        self.effort.gradients += open.len() as u64;
        for batch in open.chunks(BATCH) {
            for (lane, &(i, c)) in batch.iter().enumerate() {
                let child = child_of(nodes[i], c);
                let boxes = [&mut self.boxes, &mut self.inner_boxes];
                self.corners.write_node(boxes, lane, child, edge);
            }
            let (outer, inner) = (&self.boxes, &self.inner_boxes);
            let found = self.slopes.eval(&mut self.values, tape, outer, inner, batch.len());
            for (lane, &(i, c)) in batch.iter().enumerate() {
                let is = |lanes: u64| lanes >> lane & 1 == 1;
                if is(found.verdict.empty) {
                    families[i].drop(c, false);
                } else if is(found.verdict.negative) {
                    families[i].drop(c, true);
                }
            }
        }
    }

    /// Records the masks of the nodes on `level` and collects the children that are left, in runs
    /// that share a tape.
    fn children(
        &mut self,
        run: Run,
        level: u32,
        families: &[Family],
        groups: Vec<Group>,
    ) -> Vec<Run> {
        let Run { nodes, tape } = run;
        let mut runs: Vec<Run> = Vec::new();
        let mut groups = groups.into_iter().peekable();
        let mut group = None;
        let mut is_new = true;
        for (i, (node, family)) in nodes.iter().zip(families).enumerate() {
            self.masks[level as usize].push(family.mixed, family.inside);
            for c in bits(family.mixed) {
                while let Some(next) = groups.next_if(|g| g.first <= 8 * i + c as usize) {
                    group = Some(next);
                    is_new = true;
                }
                if is_new {
                    let tape = match group.take() {
                        Some(Group { choices, .. }) => self.tapes.shortened(&tape, &choices),
                        None => tape.clone(),
                    };
                    runs.push(Run { nodes: Vec::new(), tape });
                    is_new = false;
                }
                if let Some(run) = runs.last_mut() {
                    run.nodes.push(child_of(*node, c));
                }
            }
        }
        runs
    }
}
