//! Spatial enumeration with Fidget's evaluators: every voxel in which the interval of F holds 0,
//! and the gradient at its centre.
//!
//! What makes Fidget fast here:
//!
//! - The evaluators of a `Function` are called directly, without the `Shape` around them, which
//!   looks up the names of the variables for every box.
//! - Evaluators, tapes, functions and workspaces are reused by each thread, so that nothing is
//!   allocated for a box. The tapes of the whole function are there before the clock starts.
//! - Functions are shortened where that pays: see `program`.
//! - The eight children of an octant are evaluated before one is looked into, and gradients for many
//!   voxels in one call.
//! - Nothing is made of what was found: no octree, no unit normals.
//!
//! The subtrees of the same frontier as Zeroset's are searched by all threads and collected in order.

use std::sync::Arc;

use fidget::{
    context::{Context, Node},
    eval::{BulkEvaluator, Function, MathFunction, Trace, TracingEvaluator},
    types::{Grad, Interval},
    var::{Var, VarMap},
};
use rayon::prelude::*;
use zeroset::{
    math::{Lattice, child_of},
    octree::bits,
};

use crate::program::{Last, Program, Shortening, Spare};

/// A voxel that the surface may meet.
#[derive(Clone, Copy, Debug)]
pub struct Voxel {
    /// Its place in the lattice.
    pub ijk: [u16; 3],
    /// The gradient at its centre.
    pub gradient: [f32; 3],
}

/// What was found, and what it cost.
pub struct Found {
    /// The voxels of every subtree of the frontier, in Morton order.
    pub subtrees: Vec<Vec<Voxel>>,
    /// Intervals evaluated.
    pub n_boxes: u64,
}

/// Levels of a subtree that one thread searches.
const SUBTREE_LEVELS: u32 = 5;
/// Voxels whose gradients are evaluated in one call.
pub const GRADIENTS: usize = 512;

/// A surface and the lattice in which it is looked for.
pub struct Enumeration<F: Function> {
    root: Arc<Program<F>>,
    /// Where each coordinate stands among the arguments.
    places: [usize; 3],
    corners: [Vec<f32>; 3],
    centers: [Vec<f32>; 3],
    depth: u32,
}

impl<F: MathFunction> Enumeration<F> {
    /// # Panics
    /// If the lattice is not a cube of a power of two.
    pub fn new(context: &Context, root: Node, lattice: &Lattice) -> Self {
        let (depth, n) = (lattice.depth(), 1 << lattice.depth());
        assert_eq!(lattice.n_voxels(), [n; 3], "no voxel overhangs the domain");
        let corner = |axis: usize, i: u32| lattice.corner(axis, i);
        let axes = [0, 1, 2];
        let function = F::new(context, &[root]).unwrap();
        Self {
            places: places(function.vars()),
            root: Arc::new(Program::new(function)),
            corners: axes.map(|a| (0..=n).map(|i| corner(a, i) as f32).collect()),
            centers: axes.map(|a| {
                (0..n).map(|i| (0.5 * (corner(a, i) + corner(a, i + 1))) as f32).collect()
            }),
            depth,
        }
    }

    /// Finds the voxels with the threads of the current pool.
    pub fn run(&self, shortening: Shortening) -> Found {
        let frontier = self.depth.saturating_sub(SUBTREE_LEVELS);
        let mut trunk = Search::new(self, shortening, frontier);
        trunk.descend(&self.root, &mut None, [0; 3], 0);
        let tasks = std::mem::take(&mut trunk.tasks);
        let subtrees: Vec<(Vec<Voxel>, u64)> = tasks
            .into_par_iter()
            .map_init(
                || Search::new(self, shortening, self.depth),
                |search, (program, node)| {
                    let mut last = None;
                    search.descend(&program, &mut last, node, frontier);
                    search.find_gradients(&program);
                    search.spare.take_back(last);
                    search.spare.take_program(program);
                    search.take_found()
                },
            )
            .collect();
        let n_boxes = trunk.n_boxes + subtrees.iter().map(|(_, n_boxes)| n_boxes).sum::<u64>();
        Found { subtrees: subtrees.into_iter().map(|(voxels, _)| voxels).collect(), n_boxes }
    }
}

impl<F: Function> Enumeration<F> {
    /// F.
    pub fn function(&self) -> &F {
        &self.root.function
    }

    /// The boxes of the eight children of `node`, which are of `2^height` voxels an axis, as
    /// arguments of F.
    pub fn children(&self, node: [u32; 3], height: u32) -> [[Interval; 3]; 8] {
        let mut arguments = [[Interval::from(0.0); 3]; 8];
        for axis in 0..3 {
            let plane = |i: u32| self.corners[axis][((2 * node[axis] + i) << height) as usize];
            let planes = [plane(0), plane(1), plane(2)];
            let halves = [[planes[0], planes[1]], [planes[1], planes[2]]];
            let halves = halves.map(|[lower, upper]| Interval::new(lower, upper));
            for c in 0..8 {
                arguments[c][self.places[axis]] = halves[c >> axis & 1];
            }
        }
        arguments
    }

    /// The box of a voxel, as arguments of F.
    pub fn voxel(&self, ijk: [u32; 3]) -> [Interval; 3] {
        let [x, y, z] = ijk.map(|i| (i & 1) as usize);
        self.children(ijk.map(|i| i >> 1), 0)[x | y << 1 | z << 2]
    }

    /// Adds the centre of a voxel to arguments of the gradient of F.
    pub fn push_center(&self, ijk: [u32; 3], arguments: &mut [Vec<Grad>; 3]) {
        for axis in 0..3 {
            let center = self.centers[axis][ijk[axis] as usize];
            let [dx, dy, dz] = [0, 1, 2].map(|a| if a == axis { 1.0 } else { 0.0 });
            arguments[self.places[axis]].push(Grad::new(center, dx, dy, dz));
        }
    }
}

/// Where x, y and z stand among the arguments; those that F does not use stand behind the others.
pub fn places(vars: &VarMap) -> [usize; 3] {
    let mut unused = vars.len()..;
    [Var::X, Var::Y, Var::Z].map(|var| vars.get(&var).or_else(|| unused.next()).unwrap())
}

/// One thread's search.
struct Search<'a, F: Function> {
    surface: &'a Enumeration<F>,
    shortening: Shortening,
    /// The level on which the search ends: the frontier's, or that of the voxels.
    stop: u32,
    box_evaluator: F::IntervalEval,
    gradient_evaluator: F::GradSliceEval,
    spare: Spare<F>,
    voxels: Vec<Voxel>,
    /// The centres of the last voxels found, whose gradients are not yet known.
    waiting: [Vec<Grad>; 3],
    /// The nodes of the frontier.
    tasks: Vec<(Arc<Program<F>>, [u32; 3])>,
    /// How the choices went in the children last tested, for every height above the voxels.
    traces: Vec<[Option<F::Trace>; 8]>,
    n_boxes: u64,
}

impl<'a, F: Function> Search<'a, F> {
    fn new(surface: &'a Enumeration<F>, shortening: Shortening, stop: u32) -> Self {
        Self {
            surface,
            shortening,
            stop,
            box_evaluator: F::new_interval_eval(),
            gradient_evaluator: F::new_grad_slice_eval(),
            spare: Spare::default(),
            voxels: Vec::new(),
            waiting: Default::default(),
            tasks: Vec::new(),
            traces: vec![[const { None }; 8]; surface.depth as usize],
            n_boxes: 0,
        }
    }

    /// Searches the children of `node`, on `level`, down to where the search ends.
    fn descend(
        &mut self,
        program: &Arc<Program<F>>,
        last: &mut Last<F>,
        node: [u32; 3],
        level: u32,
    ) {
        let height = self.surface.depth - level - 1;
        let (kept, decided) = self.test_children(program, node, height);
        if height == 0 {
            bits(kept).for_each(|c| self.add_voxel(child_of(node, c)));
            if self.waiting[0].len() >= GRADIENTS {
                self.find_gradients(program);
            }
            return;
        }
        for c in bits(kept) {
            let child = child_of(node, c);
            let trace = self.traces[height as usize][c as usize].as_ref();
            match trace.filter(|_| decided >> c & 1 == 1) {
                Some(trace) => {
                    let inner = self.spare.shorten(program, last, trace);
                    self.find_gradients(program);
                    self.enter(&inner.program, &mut inner.last, child, level + 1);
                    self.find_gradients(&inner.program);
                }
                None => self.enter(program, last, child, level + 1),
            }
        }
    }

    /// Evaluates the children of `node`, which are of `2^height` voxels an axis. Returns those that
    /// the surface may meet and, where functions are to be shortened, those that can be, as bits;
    /// their traces are kept for that height. All eight are evaluated before one is looked into:
    /// what becomes of each is hard to predict, and this saves a quarter of the time.
    fn test_children(&mut self, program: &Program<F>, node: [u32; 3], height: u32) -> (u8, u8) {
        let tape = self.spare.box_tape(program);
        let shortens = self.shortening.is_on(height);
        let children = self.surface.children(node, height);
        let (mut kept, mut decided) = (0, 0);
        for (c, arguments) in children.iter().enumerate() {
            let (range, trace) = self.box_evaluator.eval(tape, arguments).unwrap();
            // Not `contains`, which NaN would fail: it proves nothing.
            let is_empty = (range[0].lower() > 0.0) | (range[0].upper() < 0.0);
            kept |= u8::from(!is_empty) << c;
            if let Some(trace) = trace.filter(|_| shortens && !is_empty) {
                decided |= 1 << c;
                match &mut self.traces[height as usize][c] {
                    Some(kept_trace) => kept_trace.copy_from(trace),
                    none => *none = Some(trace.clone()),
                }
            }
        }
        self.n_boxes += 8;
        (kept, decided)
    }

    fn enter(&mut self, program: &Arc<Program<F>>, last: &mut Last<F>, node: [u32; 3], level: u32) {
        if level == self.stop {
            self.tasks.push((program.clone(), node));
        } else {
            self.descend(program, last, node, level);
        }
    }

    fn add_voxel(&mut self, ijk: [u32; 3]) {
        self.surface.push_center(ijk, &mut self.waiting);
        self.voxels.push(Voxel { ijk: ijk.map(|i| i as u16), gradient: [f32::NAN; 3] });
    }

    /// Evaluates the gradients that are waited for.
    fn find_gradients(&mut self, program: &Program<F>) {
        let n_waiting = self.waiting[0].len();
        if n_waiting == 0 {
            return;
        }
        let tape = self.spare.gradient_tape(program);
        let gradients = self.gradient_evaluator.eval(tape, &self.waiting).unwrap();
        let first = self.voxels.len() - n_waiting;
        for (voxel, gradient) in self.voxels[first..].iter_mut().zip(&gradients[0]) {
            voxel.gradient = [gradient.dx, gradient.dy, gradient.dz];
        }
        self.waiting.iter_mut().for_each(Vec::clear);
    }

    /// The voxels, and the intervals evaluated, since the last call.
    fn take_found(&mut self) -> (Vec<Voxel>, u64) {
        (std::mem::take(&mut self.voxels), std::mem::take(&mut self.n_boxes))
    }
}
