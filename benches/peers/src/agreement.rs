//! Whether both programs have got the same function, found the same voxels and seen the same.

use fearless_simd::Simd;
use fidget::{
    eval::{BulkEvaluator, Function, MathFunction},
    raster::voxel::Image,
    vm::VmFunction,
};
use zeroset::{
    eval::{POINT_BATCH, PointEvaluator, Points},
    expr::Tape,
    math::{SimdLevel, SimdTask},
    octree::{MortonOctree, Storage},
    raster::Frame,
};

use crate::{
    enumeration::{Found, places},
    workloads::{RESOLUTION, Workload},
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

/// How many voxels were kept, or pixels covered.
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

/// How much alike two pictures are.
#[derive(Clone, Copy, Debug)]
pub struct Likeness {
    /// Pixels that show the surface.
    pub covered: Kept,
    /// Of pixels covered by both, the mean difference of depths in voxels.
    pub depth: f64,
    /// The share whose depths differ by less than a voxel.
    pub within_voxel: f64,
    /// The mean angle between normals in degrees.
    pub degrees: f64,
}

/// Compares pictures that look along z at a cube about the origin. Fidget's depth counts voxels from
/// the back: the surface lies somewhere in the last one.
pub fn compare_pictures(ours: &Frame, theirs: &Image, half_edge: f64) -> Likeness {
    let mut covered = Kept { by_both: 0, by_zeroset: 0, by_fidget: 0 };
    let (mut depth, mut n_within, mut degrees, mut n_normals) = (0.0, 0_u64, 0.0, 0_u64);
    for (i, pixel) in theirs.iter().enumerate() {
        match (ours.depth[i] < Frame::FAR, pixel.depth > 0) {
            (false, false) => continue,
            (true, false) => covered.by_zeroset += 1,
            (false, true) => covered.by_fidget += 1,
            (true, true) => {
                covered.by_both += 1;
                let z = f64::from(ours.position[i][2]) / half_edge;
                let voxels = 0.5 * f64::from(RESOLUTION) * (z + 1.0);
                let difference = (voxels - (f64::from(pixel.depth) - 0.5)).abs();
                depth += difference;
                n_within += u64::from(difference < 1.0);
                // Fidget's gradient is in axes of the picture, with y down.
                let [x, y, z] = pixel.normal;
                if let Some(angle) = angle(ours.normal[i], [x, -y, z]) {
                    degrees += angle;
                    n_normals += 1;
                }
            }
        }
    }
    let n = covered.by_both as f64;
    Likeness {
        covered,
        depth: depth / n,
        within_voxel: n_within as f64 / n,
        degrees: degrees / n_normals as f64,
    }
}

/// In degrees; `None` where a vector has no direction.
#[expect(clippy::disallowed_methods, reason = "a figure for a table, not for a picture")]
fn angle(a: [f32; 3], b: [f32; 3]) -> Option<f64> {
    let [a, b] = [a, b].map(|v| v.map(f64::from));
    let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let cosine = dot(a, b) / (dot(a, a) * dot(b, b)).sqrt();
    cosine.is_finite().then(|| cosine.clamp(-1.0, 1.0).acos().to_degrees())
}
