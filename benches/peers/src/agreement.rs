//! Whether both programs have got the same function and found the same voxels.

use fearless_simd::Simd;
use fidget::{
    eval::{BulkEvaluator, Function, MathFunction},
    vm::VmFunction,
};
use zeroset::{
    eval::{POINT_BATCH, PointEvaluator, Points},
    expr::Tape,
    math::{SimdLevel, SimdTask},
    octree::{MortonOctree, Storage},
};

use crate::{
    enumeration::{Found, places},
    workloads::Workload,
};

const N_POINTS: usize = 4096;

/// Compares the values of F on points spread over the domain.
///
/// # Panics
/// If they differ by more than single floats explain: 1e-4 of the value, or of the mean value.
pub fn check(workload: &Workload) {
    let points = spread(workload);
    let ours = SimdLevel::detect().run(Values { tape: workload.expr.tape(), points: &points });
    let theirs = fidget_values(workload, &points);
    let finite = ours.iter().filter(|v| v.is_finite());
    let mean = finite.clone().map(|v| v.abs()).sum::<f64>() / finite.count() as f64;
    for ((point, a), b) in points.iter().zip(ours).zip(theirs) {
        let b = f64::from(b);
        let agree = (a - b).abs() <= 1e-4 * (a.abs() + mean);
        assert!(
            agree || !a.is_finite() && !b.is_finite(),
            "{}: F is {a} for Zeroset and {b} for Fidget at {point:?}",
            workload.name
        );
    }
}

/// A sequence that fills the domain evenly: multiples of powers of the root of x⁴ = x + 1.
fn spread(workload: &Workload) -> Vec<[f64; 3]> {
    const ROOT: f64 = 1.220_744_084_605_759_5;
    let (min, size) = (workload.domain.min, workload.domain.size());
    let steps = [1.0 / ROOT, 1.0 / (ROOT * ROOT), 1.0 / (ROOT * ROOT * ROOT)];
    let coordinate = |i: usize, axis: usize| {
        let v = min[axis] + size[axis] * (0.5 + i as f64 * steps[axis]).fract();
        f64::from(v as f32)
    };
    (1..=N_POINTS).map(|i| [0, 1, 2].map(|axis| coordinate(i, axis))).collect()
}

struct Values<'a> {
    tape: Tape,
    points: &'a [[f64; 3]],
}

impl SimdTask for Values<'_> {
    type Output = Vec<f64>;

    fn run<S: Simd>(self, simd: S) -> Vec<f64> {
        let mut evaluator = PointEvaluator::new(simd);
        let batches = self.points.chunks_exact(POINT_BATCH);
        batches
            .flat_map(|batch| {
                let points: Points = [0, 1, 2].map(|axis| std::array::from_fn(|i| batch[i][axis]));
                evaluator.eval(&self.tape, &points)
            })
            .collect()
    }
}

fn fidget_values(workload: &Workload, points: &[[f64; 3]]) -> Vec<f32> {
    let function = VmFunction::new(&workload.context, &[workload.root]).unwrap();
    let places = places(function.vars());
    let mut arguments = [const { Vec::new() }; 3];
    for axis in 0..3 {
        arguments[places[axis]] = points.iter().map(|point| point[axis] as f32).collect();
    }
    let tape = function.float_slice_tape(Default::default());
    let mut evaluator = VmFunction::new_float_slice_eval();
    let values = evaluator.eval(&tape, &arguments).unwrap();
    values[0].to_vec()
}

/// How many voxels were kept.
#[derive(Clone, Copy, Debug)]
pub struct Kept {
    /// By both programs.
    pub by_both: u64,
    /// By Zeroset only.
    pub by_zeroset: u64,
    /// By Fidget only.
    pub by_fidget: u64,
}

/// Compares the voxels found.
pub fn compare(ours: &MortonOctree, theirs: &Found) -> Kept {
    let voxels = || theirs.subtrees.iter().flatten();
    let by_both = voxels().filter(|v| ours.find(v.ijk.map(u32::from)).is_some()).count() as u64;
    let by_zeroset = u64::from(ours.voxel_count()) - by_both;
    Kept { by_both, by_zeroset, by_fidget: voxels().count() as u64 - by_both }
}
