//! What one evaluation costs, with nothing around it: F over the boxes of voxels on the surface, and
//! its gradient at their centres. Zeroset evaluates intervals in f32 and gradients in f64, Fidget
//! both in f32.

use std::{hint::black_box, time::Duration};

use fearless_simd::{Simd, f32x16};
use fidget::{
    eval::{BulkEvaluator, Function, TracingEvaluator},
    types::{Grad, Interval},
};
use zeroset::{
    eval::{BATCH, BoxEvaluator, Boxes, GradientEvaluator, POINT_BATCH, Points},
    expr::Tape,
    math::{Lattice, SimdLevel, SimdTask},
};

use crate::{
    enumeration::{Enumeration, Found},
    timing::{median, take_turns, time},
    tuning::Fidget,
    workloads::Workload,
};

/// Boxes, and points, in one measurement.
const N_SAMPLES: usize = 4096;

/// Nanoseconds for one box, and for one gradient.
#[derive(Clone, Copy, Debug)]
pub struct Cost {
    pub box_ns: f64,
    pub gradient_ns: f64,
}

/// What an evaluation of F costs.
#[derive(Clone, Copy, Debug)]
pub struct Throughput {
    /// Operations of F, as Zeroset counts them.
    pub n_operations: usize,
    pub zeroset: Cost,
    pub jit: Cost,
    pub vm: Cost,
}

/// Measures all evaluators in turn. `found` are the voxels to take samples from.
pub fn measure(
    workload: &Workload,
    lattice: &Lattice,
    fidget: &Fidget,
    found: &Found,
) -> Throughput {
    let voxels = samples(found);
    let tape = workload.expr.tape();
    let n_operations = tape.instructions().len();
    let times = SimdLevel::detect().run(Turns { tape, lattice, fidget, voxels: &voxels });
    let ns = |i: usize| median(&times[i]) / N_SAMPLES as f64 * 1e9;
    let cost = |first| Cost { box_ns: ns(first), gradient_ns: ns(first + 1) };
    Throughput { n_operations, zeroset: cost(0), jit: cost(2), vm: cost(4) }
}

/// Runs of neighbours, spread evenly over the surface.
fn samples(found: &Found) -> Vec<[u32; 3]> {
    let all: Vec<[u32; 3]> =
        found.subtrees.iter().flatten().map(|voxel| voxel.ijk.map(u32::from)).collect();
    let n_runs = N_SAMPLES / BATCH;
    let first = |run: usize| run * (all.len() - BATCH) / (n_runs - 1);
    (0..n_runs).flat_map(|run| all[first(run)..][..BATCH].to_vec()).collect()
}

struct Turns<'a> {
    tape: Tape,
    lattice: &'a Lattice,
    fidget: &'a Fidget,
    voxels: &'a [[u32; 3]],
}

impl SimdTask for Turns<'_> {
    type Output = [Vec<f64>; 6];

    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let Self { tape, lattice, fidget, voxels } = self;
        let mut box_evaluator = BoxEvaluator::<f32x16<S>, { BATCH / 16 }>::new(simd);
        let boxes: Vec<Boxes<f32>> = voxels.chunks(BATCH).map(|v| boxes(lattice, v)).collect();
        let mut gradient_evaluator = GradientEvaluator::new(simd);
        let points: Vec<Points> = voxels.chunks(POINT_BATCH).map(|v| points(lattice, v)).collect();
        let zeroset_boxes = || {
            for batch in &boxes {
                black_box(box_evaluator.eval(&tape, batch, BATCH, false));
            }
        };
        let zeroset_gradients = || {
            for batch in &points {
                black_box(gradient_evaluator.eval(&tape, batch));
            }
        };
        let (jit_boxes, jit_gradients) = fidget_turns(&fidget.jit, voxels);
        let (vm_boxes, vm_gradients) = fidget_turns(&fidget.vm, voxels);
        take_turns([
            &mut repeated(zeroset_boxes),
            &mut repeated(zeroset_gradients),
            &mut repeated(jit_boxes),
            &mut repeated(jit_gradients),
            &mut repeated(vm_boxes),
            &mut repeated(vm_gradients),
        ])
    }
}

/// The mean time of several runs: one is too short for the clock and for the caches to be warm.
fn repeated(mut work: impl FnMut()) -> impl FnMut() -> Duration {
    const RUNS: u32 = 8;
    move || time(|| (0..RUNS).for_each(|_| work())) / RUNS
}

fn boxes(lattice: &Lattice, voxels: &[[u32; 3]]) -> Boxes<f32> {
    let mut boxes = Boxes::default();
    for (lane, ijk) in voxels.iter().enumerate() {
        for axis in 0..3 {
            boxes.lo[axis][lane] = lattice.corner(axis, ijk[axis]) as f32;
            boxes.hi[axis][lane] = lattice.corner(axis, ijk[axis] + 1) as f32;
        }
    }
    boxes
}

fn points(lattice: &Lattice, voxels: &[[u32; 3]]) -> Points {
    let center = |lane: usize| lattice.voxel_center(voxels[lane]);
    [0, 1, 2].map(|axis| std::array::from_fn(|lane| center(lane)[axis]))
}

/// Fidget's work: intervals one by one, gradients as many in one call as the enumeration passes.
fn fidget_turns<'a, F: Function>(
    surface: &'a Enumeration<F>,
    voxels: &'a [[u32; 3]],
) -> (impl FnMut() + 'a, impl FnMut() + 'a) {
    let function = surface.function();
    let box_tape = function.interval_tape(Default::default());
    let gradient_tape = function.grad_slice_tape(Default::default());
    let mut box_evaluator = F::new_interval_eval();
    let mut gradient_evaluator = F::new_grad_slice_eval();
    let boxes: Vec<[Interval; 3]> = voxels.iter().map(|&ijk| surface.voxel(ijk)).collect();
    let mut centers: Vec<[Vec<Grad>; 3]> = Vec::new();
    for batch in voxels.chunks(crate::enumeration::GRADIENTS) {
        let mut arguments = [const { Vec::new() }; 3];
        batch.iter().for_each(|&ijk| surface.push_center(ijk, &mut arguments));
        centers.push(arguments);
    }
    let box_work = move || {
        for arguments in &boxes {
            black_box(box_evaluator.eval(&box_tape, arguments).unwrap().0[0]);
        }
    };
    let gradient_work = move || {
        for arguments in &centers {
            black_box(gradient_evaluator.eval(&gradient_tape, arguments).unwrap()[0][0]);
        }
    };
    (box_work, gradient_work)
}
