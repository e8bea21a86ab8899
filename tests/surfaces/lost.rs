//! No voxel is lost: voxels that are not stored show one sign on a fine lattice of points.

use fearless_simd::Simd;
use rayon::prelude::*;
use zeroset::{
    eval::{POINT_BATCH, PointEvaluator, Points},
    expr::Tape,
    math::{Lattice, SimdLevel, SimdTask},
    octree::{MortonOctree, Occupancy, Storage},
};

use crate::{SURFACES, lattice, octree, scene};

/// Values this small may have either sign by the rounding of their evaluation.
const ROUNDING: f64 = 1e-10;

/// Counts the voxels without surface in which a point shows that there is one.
struct Count<'a> {
    tape: &'a Tape,
    lattice: &'a Lattice,
    octree: &'a MortonOctree,
    /// Parts of a voxel's edge.
    finer: u32,
}

impl SimdTask for Count<'_> {
    type Output = usize;

    fn run<S: Simd>(self, simd: S) -> usize {
        let [nx, ny, nz] = self.lattice.n_voxels();
        let rows: Vec<(u32, u32)> = (0..nz).flat_map(|k| (0..ny).map(move |j| (j, k))).collect();
        let lost_in_row = |evaluator: &mut PointEvaluator<S>, (j, k)| {
            (0..nx).filter(|&i| self.is_lost(evaluator, [i, j, k])).count()
        };
        rows.into_par_iter().map_init(|| PointEvaluator::new(simd), lost_in_row).sum()
    }
}

impl Count<'_> {
    fn is_lost<S: Simd>(&self, evaluator: &mut PointEvaluator<S>, ijk: [u32; 3]) -> bool {
        let wrong = match self.octree.occupancy(ijk) {
            Occupancy::Surface => return false,
            Occupancy::Inside => 1.0,
            Occupancy::Empty => -1.0,
        };
        let side = self.finer + 1;
        let n = side.pow(3);
        (0..n).step_by(POINT_BATCH).any(|first| {
            let mut points: Points = [[0.0; POINT_BATCH]; 3];
            for lane in 0..POINT_BATCH {
                let nth = (first + lane as u32).min(n - 1);
                let step = [nth % side, nth / side % side, nth / (side * side)];
                for axis in 0..3 {
                    let [a, b] = [0, 1].map(|end| self.lattice.corner(axis, ijk[axis] + end));
                    let t = f64::from(step[axis]) / f64::from(self.finer);
                    points[axis][lane] = if t == 1.0 { b } else { a + t * (b - a) };
                }
            }
            evaluator.eval(self.tape, &points).iter().any(|value| wrong * value > ROUNDING)
        })
    }
}

fn check(finer: u32) {
    for surface in SURFACES {
        let (expr, lattice) = (&scene(surface).surfaces[0].expr, lattice(surface, 64));
        let octree = octree(expr, &lattice);
        let count = Count { tape: &expr.tape(), lattice: &lattice, octree: &octree, finer };
        let n_lost = SimdLevel::detect().run(count);
        assert_eq!(n_lost, 0, "{}: voxels are lost", surface.name);
    }
}

#[test]
fn no_voxel_is_lost() {
    check(4);
}

#[test]
#[ignore = "some minutes: 1024³ points for each surface"]
fn no_voxel_is_lost_sixteen_times_finer() {
    check(16);
}
