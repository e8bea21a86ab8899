//! One thread's search through an octant, level by level, 64 boxes at a time.
//!
//! The nodes of a level that survived are kept in Morton order; eight of them give the 64 boxes of
//! the next pass. Where the tape holds choices, the nodes of a level are split into runs that
//! decided them alike, and every run goes on with its own shortened tape. Runs are searched one
//! after the other, so that every level is still written in Morton order.
//!
//! The last levels are searched block by block, 32³ voxels each, with three more tests:
//!
//! - *Slopes.* The gradient over a node may show that F is not 0 there though its value does not,
//!   or that F is monotone along all three axes.
//! - *Trends.* Where F is monotone its range over any part is that between two corners: no more
//!   intervals over boxes are needed below, and what the signs at the corners say is exact.
//! - *Corners.* F is continuous in a voxel and has both signs at its corners: the surface provably
//!   passes through.
//!
//! What is left open is looked at more closely; see `closer`.

use std::sync::Arc;

use fearless_simd::Simd;

use super::{
    closer::{CloserLook, ExactLook},
    closer_points::{KnownSlopes, look_at_points},
    corners::Corners,
    node::{Family, Node, Trend},
    normals::NormalFinder,
    shortened::ShortenedTapes,
    signs::{BLOCK_LEVELS, CornerSigns, Signs, steps_to, steps_to_children},
};
use crate::{
    eval::{BATCH, BoxEvaluator, Boxes, SlopeEvaluator},
    expr::{Choice, Tape},
    math::{Lanes, Lattice, child_of},
    octree::{LevelMasks, NodeState, OctNormal, bits},
};

/// Nodes of one level, in Morton order, that share a tape.
pub(super) struct Run {
    nodes: Vec<Node>,
    tape: Arc<Tape>,
}

impl Run {
    /// The whole domain.
    pub(super) fn root(tape: Arc<Tape>) -> Self {
        Self { nodes: vec![Node { ijk: [0; 3], trend: Trend::UNKNOWN }], tape }
    }

    /// The places of the nodes.
    pub(super) fn places(&self) -> impl Iterator<Item = [u32; 3]> {
        self.nodes.iter().map(|node| node.ijk)
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
    /// Whether the surface provably passes through a voxel, in Morton order.
    pub(super) certified: Vec<bool>,
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

    /// Adds another one's counts.
    pub(super) fn add(&mut self, other: &Self) {
        self.boxes.iter_mut().zip(&other.boxes).for_each(|(sum, n)| *sum += n);
        self.gradients += other.gradients;
        self.corners += other.corners;
        self.closer_looks += other.closer_looks;
    }
}

/// Nodes this close to the voxels keep the tape they have: their runs would be too short to fill
/// batches.
const LEVELS_WITHOUT_SPLIT: u32 = 2;

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

/// A voxel that the gradient left open: child `c` of the node number `parent`.
struct OpenVoxel {
    parent: usize,
    c: u32,
    slopes: KnownSlopes,
}

/// The state of one thread's search.
pub(super) struct Search<'a, S: Simd, L: Lanes<Token = S>, const G: usize> {
    lattice: &'a Lattice,
    corners: &'a Corners<L::Scalar>,
    certify: bool,
    depth: u32,
    values: BoxEvaluator<L, G>,
    slopes: SlopeEvaluator<L, G>,
    boxes: Boxes<L::Scalar>,
    inner_boxes: Boxes<L::Scalar>,
    signs: CornerSigns<L::Scalar>,
    closer: CloserLook<'a, L, G>,
    exact: ExactLook<'a, S>,
    normal_finder: NormalFinder<'a, S>,
    tapes: ShortenedTapes,
    masks: Vec<LevelMasks>,
    certified: Vec<bool>,
    effort: Effort,
}

impl<'a, S: Simd, L: Lanes<Token = S>, const G: usize> Search<'a, S, L, G> {
    /// Where `certify` is false, only values are looked at.
    pub(super) fn new(
        simd: S,
        lattice: &'a Lattice,
        corners: &'a Corners<L::Scalar>,
        certify: bool,
    ) -> Self {
        let depth = lattice.depth();
        Self {
            lattice,
            corners,
            certify,
            depth,
            values: BoxEvaluator::new(simd),
            slopes: SlopeEvaluator::new(simd),
            boxes: Boxes::default(),
            inner_boxes: Boxes::default(),
            signs: CornerSigns::new(),
            closer: CloserLook::new(simd, lattice),
            exact: CloserLook::new(simd, lattice),
            normal_finder: NormalFinder::new(simd, lattice),
            tapes: ShortenedTapes::default(),
            masks: vec![LevelMasks::default(); depth as usize],
            certified: Vec::new(),
            effort: Effort::new(depth),
        }
    }

    /// The masks of all levels searched since the last call.
    pub(super) fn take_masks(&mut self) -> Vec<LevelMasks> {
        self.masks.iter_mut().map(std::mem::take).collect()
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

    /// Searches the single node of `run`, on `level`, down to the voxels.
    pub(super) fn subtree(&mut self, run: Run, level: u32) -> Subtree {
        self.search(run, level);
        self.tapes.forget();
        let (normals, missing_normals) = self.normal_finder.take();
        let certified = std::mem::take(&mut self.certified);
        let mut levels = self.take_masks().split_off(level as usize);
        let mut states = vec![NodeState::Mixed; normals.len()];
        for masks in levels.iter_mut().rev() {
            states = masks.settle(&states);
        }
        let root = states.first().copied().unwrap_or(NodeState::Empty);
        let effort = self.take_effort();
        Subtree { root, levels, normals, certified, missing_normals, effort }
    }

    /// Searches nodes above the blocks.
    fn search(&mut self, run: Run, level: u32) {
        if level + BLOCK_LEVELS < self.depth {
            for run in self.divide(run, level) {
                self.search(run, level + 1);
            }
            return;
        }
        for run in run.into_single_nodes() {
            for ijk in run.places() {
                self.signs.enter(ijk.map(|i| i << (self.depth - level)), self.corners);
            }
            self.search_block(run, level);
        }
    }

    /// Searches nodes of one block.
    fn search_block(&mut self, run: Run, level: u32) {
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

    /// The same, with all that a block offers.
    fn divide_with_slopes(&mut self, run: Run, level: u32) -> Vec<Run> {
        let (mut families, groups) = self.test_values(&run, level);
        self.follow_trends(&run, level, &mut families);
        self.test_slopes(&run, level, &mut families, &mut Vec::new());
        self.children(run, level, &families, groups)
    }

    /// Divides the nodes above the voxels, and keeps the voxels.
    fn divide_into_voxels(&mut self, run: &Run, level: u32) {
        let (mut families, _) = self.test_values(run, level);
        if self.certify {
            self.follow_trends(run, level, &mut families);
            self.certify_at_corners(run, &mut families);
            let mut open = Vec::new();
            self.test_slopes(run, level, &mut families, &mut open);
            self.look_at_points(run, &mut families, &open);
            self.look_closer(run, &mut families);
        }
        let mut voxels = Vec::with_capacity(4 * families.len());
        for (node, family) in run.nodes.iter().zip(&families) {
            self.masks[level as usize].push(family.mixed, family.inside);
            for c in bits(family.mixed) {
                voxels.push(child_of(node.ijk, c));
                self.certified.push(family.certified >> c & 1 == 1);
            }
        }
        self.normal_finder.find(&run.tape, &voxels);
    }

    /// Tests the children of nodes without a trend by the values of F over them. Where runs are
    /// still split, also tells how the choices went.
    fn test_values(&mut self, run: &Run, level: u32) -> (Vec<Family>, Vec<Group>) {
        let Run { nodes, tape } = run;
        let edge = 1 << (self.depth - level - 1);
        let is_voxel = level + 1 == self.depth;
        let split = tape.n_choices() > 0 && level + LEVELS_WITHOUT_SPLIT < self.depth;
        let mut families = vec![Family::EMPTY; nodes.len()];
        let mut groups: Vec<Group> = Vec::new();
        let mut rest = (0..nodes.len()).filter(|&i| !nodes[i].trend.is_known());
        let mut n_tested = 0;
        loop {
            let mut parents = [0; PARENTS];
            let mut n = 0;
            for i in rest.by_ref().take(PARENTS) {
                self.corners.write_children(&mut self.boxes, 8 * n, nodes[i].ijk, edge);
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
                let present = self.corners.present_children(nodes[i].ijk, edge);
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

    /// Tests the children of nodes with a trend by the signs at two of their corners, which tell
    /// everything.
    fn follow_trends(&mut self, run: &Run, level: u32, families: &mut [Family]) {
        let edge = 1 << (self.depth - level - 1);
        let children = steps_to_children(edge);
        let ends_of = |trend: Trend| {
            let [least, most] = [trend.to_least(edge), trend.to_most(edge)].map(steps_to);
            [children.map(|child| child + least), children.map(|child| child + most)]
        };
        for Node { ijk, trend } in run.nodes.iter().filter(|node| node.trend.is_known()) {
            let first = self.signs.place(ijk.map(|i| 2 * i * edge));
            ends_of(*trend).iter().for_each(|ends| self.signs.ask(first, ends));
        }
        self.tell_signs(&run.tape);
        let mut n_tested = 0;
        for (Node { ijk, trend }, family) in run.nodes.iter().zip(families) {
            if !trend.is_known() {
                continue;
            }
            let present = self.corners.present_children(*ijk, edge);
            n_tested += u64::from(present.count_ones());
            let first = self.signs.place(ijk.map(|i| 2 * i * edge));
            let [least, most] = ends_of(*trend).map(|ends| self.signs.get(first, &ends));
            *family = Family { regular: present, trends: [*trend; 8], ..Family::EMPTY };
            for c in 0..8 {
                let (least, most) = (least[c], most[c]);
                let is_empty = least.have(Signs::POSITIVE);
                let is_inside = most.have(Signs::NEGATIVE);
                let is_mixed = !is_empty & !is_inside;
                let is_crossed = is_mixed & least.and(most).have(Signs::BOTH);
                family.inside |= u8::from(is_inside) << c;
                family.mixed |= u8::from(is_mixed) << c;
                family.certified |= u8::from(is_crossed) << c;
            }
            family.inside &= present;
            family.mixed &= present;
            family.certified &= present;
        }
        self.effort.boxes[level as usize] += n_tested;
    }

    /// Certifies voxels in which F is continuous and which have corners of both signs.
    fn certify_at_corners(&mut self, run: &Run, families: &mut [Family]) {
        let children = steps_to_children(1);
        for (node, family) in run.nodes.iter().zip(&*families) {
            let first = self.signs.place(node.ijk.map(|i| 2 * i));
            for c in bits(family.open()) {
                self.signs.ask(first + children[c as usize], &children);
            }
        }
        self.tell_signs(&run.tape);
        for (node, family) in run.nodes.iter().zip(families) {
            let first = self.signs.place(node.ijk.map(|i| 2 * i));
            for c in bits(family.open()) {
                let corners = self.signs.get(first + children[c as usize], &children);
                let signs = corners.into_iter().fold(Signs::default(), Signs::and);
                family.certified |= u8::from(signs.have(Signs::BOTH)) << c;
            }
        }
    }

    fn tell_signs(&mut self, tape: &Tape) {
        self.effort.corners += self.signs.tell(&mut self.values, tape, &mut self.boxes);
    }

    /// Tests the surviving children by the gradient over them, and finds the trends of those that
    /// have one. Adds voxels that stay open to `left`.
    fn test_slopes(
        &mut self,
        run: &Run,
        level: u32,
        families: &mut [Family],
        left: &mut Vec<OpenVoxel>,
    ) {
        let Run { nodes, tape } = run;
        let edge = 1 << (self.depth - level - 1);
        let is_voxel = level + 1 == self.depth;
        // Below a trend tapes are not shortened any more.
        let is_last_tape = tape.n_choices() == 0 || level + 1 + LEVELS_WITHOUT_SPLIT >= self.depth;
        let mut open: Vec<(usize, u32)> = Vec::new();
        for (i, family) in families.iter().enumerate() {
            open.extend(bits(family.open()).map(|c| (i, c)));
        }
        if open.len() < WORTH_SLOPES && !is_voxel {
            return;
        }
        self.effort.gradients += open.len() as u64;
        for batch in open.chunks(BATCH) {
            for (lane, &(i, c)) in batch.iter().enumerate() {
                let child = child_of(nodes[i].ijk, c);
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
                } else if is_voxel && is(found.crossed) {
                    families[i].certified |= 1 << c;
                } else {
                    let (rising, falling) = (found.rising.map(is), found.falling.map(is));
                    let trend = Trend::new(rising, falling);
                    if is_last_tape {
                        families[i].trends[c as usize] = trend;
                    }
                    if is_voxel && !trend.is_known() {
                        let steepest = self.slopes.steepest(lane);
                        let slopes = KnownSlopes { rising, falling, steepest };
                        left.push(OpenVoxel { parent: i, c, slopes });
                    }
                }
            }
        }
    }

    /// Looks at F at points of voxels whose slopes are known.
    fn look_at_points(&mut self, run: &Run, families: &mut [Family], open: &[OpenVoxel]) {
        let children = steps_to_children(1);
        let voxels: Vec<_> = open
            .iter()
            .map(|open| {
                let ijk = run.nodes[open.parent].ijk;
                let first = self.signs.place(ijk.map(|i| 2 * i)) + children[open.c as usize];
                let corners = self.signs.get(first, &children);
                let signs = corners.into_iter().fold(Signs::default(), Signs::and);
                (child_of(ijk, open.c), open.slopes, signs)
            })
            .collect();
        let findings = look_at_points(&mut self.values, self.lattice, &run.tape, &voxels);
        for (open, finding) in open.iter().zip(findings) {
            families[open.parent].conclude(open.c, finding);
        }
    }

    /// Looks closer at voxels that are neither certified nor dropped.
    fn look_closer(&mut self, run: &Run, families: &mut [Family]) {
        let (mut with_trend, mut without) = (Vec::new(), Vec::new());
        for (i, family) in families.iter().enumerate() {
            for c in bits(family.mixed & !family.certified) {
                let has_trend = family.trends[c as usize].is_known();
                if has_trend { with_trend.push((i, c)) } else { without.push((i, c)) }
            }
        }
        let Effort { closer_looks, gradients, .. } = &mut self.effort;
        *closer_looks += (with_trend.len() + without.len()) as u64;
        let places = |open: &[(usize, u32)]| -> Vec<[u32; 3]> {
            open.iter().map(|&(i, c)| child_of(run.nodes[i].ijk, c)).collect()
        };
        let found = self.exact.look_at_whole(&run.tape, &places(&with_trend), gradients);
        let found_in_parts = self.closer.look_at_parts(&run.tape, &places(&without), gradients);
        let open = with_trend.into_iter().chain(without);
        for ((i, c), finding) in open.zip(found.into_iter().chain(found_in_parts)) {
            families[i].conclude(c, finding);
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
                    let (ijk, trend) = (child_of(node.ijk, c), family.trends[c as usize]);
                    run.nodes.push(Node { ijk, trend });
                }
            }
        }
        runs
    }
}
