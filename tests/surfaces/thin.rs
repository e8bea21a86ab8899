//! Hardly more voxels are kept than the surface meets: stored voxels are held against those that
//! show both signs on a lattice of 5³ points, corners included.

use fearless_simd::Simd;
use zeroset::{
    eval::{POINT_BATCH, PointEvaluator, Points},
    expr::Tape,
    math::{Lattice, SimdLevel, SimdTask},
    octree::{MortonOctree, Storage},
};

use crate::{SURFACES, lattice, octree, scene};

/// Samples along an edge of a voxel, both ends included.
const SAMPLES: u32 = 5;

/// Surfaces with the number of voxels that may be stored for each that shows both signs, at a
/// resolution of 128.
const MOST: &[(&str, f64)] = &[
    ("sphere", 1.0),
    ("steinmetz_2", 1.0),
    ("steinmetz_3", 1.0),
    ("distel", 1.0),
    ("heart_taubin", 1.3),
    ("hunt", 1.3),
    ("torus_1_04", 1.2),
    ("tanglecube", 1.2),
    ("clebsch_cubic", 1.2),
    ("cayley_cubic", 1.3),
    ("kummer_quartic", 1.3),
    ("barth_sextic", 1.5),
    ("togliatti_quintic", 2.0),
    ("barth_decic", 3.0),
    ("boy_surface", 2.0),
    ("klein_bottle", 2.0),
    ("trefoil_knot", 13.0),
];

/// Counts the stored voxels that show both signs.
struct Count<'a> {
    tape: &'a Tape,
    lattice: &'a Lattice,
    octree: &'a MortonOctree,
}

impl SimdTask for Count<'_> {
    type Output = u32;

    fn run<S: Simd>(self, simd: S) -> u32 {
        let mut evaluator = PointEvaluator::new(simd);
        let mut n_crossed = 0;
        for part in self.octree.parts() {
            self.octree.visit(part, &mut |voxel| {
                n_crossed += u32::from(self.is_crossed(&mut evaluator, voxel.ijk));
            });
        }
        n_crossed
    }
}

impl Count<'_> {
    fn is_crossed<S: Simd>(&self, evaluator: &mut PointEvaluator<S>, ijk: [u32; 3]) -> bool {
        let [mut negative, mut positive] = [false; 2];
        let n = SAMPLES.pow(3);
        for first in (0..n).step_by(POINT_BATCH) {
            let mut points: Points = [[0.0; POINT_BATCH]; 3];
            for lane in 0..POINT_BATCH {
                let nth = (first + lane as u32).min(n - 1);
                let step = [nth % SAMPLES, nth / SAMPLES % SAMPLES, nth / (SAMPLES * SAMPLES)];
                for axis in 0..3 {
                    let [a, b] = [0, 1].map(|end| self.lattice.corner(axis, ijk[axis] + end));
                    let t = f64::from(step[axis]) / f64::from(SAMPLES - 1);
                    points[axis][lane] = if t == 1.0 { b } else { a + t * (b - a) };
                }
            }
            let values = evaluator.eval(self.tape, &points);
            negative |= values.iter().any(|&value| value < 0.0);
            positive |= values.iter().any(|&value| value > 0.0);
            if negative && positive {
                return true;
            }
        }
        false
    }
}

#[test]
#[expect(clippy::print_stdout, reason = "the table of README is made from this")]
fn stored_voxels_are_few() {
    let mut failures = Vec::new();
    for surface in SURFACES {
        let (expr, lattice) = (&scene(surface).surfaces[0].expr, lattice(surface, 128));
        let octree = octree(expr, &lattice);
        let count = Count { tape: &expr.tape(), lattice: &lattice, octree: &octree };
        let n_crossed = SimdLevel::detect().run(count);
        let stored = octree.voxel_count();
        let ratio = f64::from(stored) / f64::from(n_crossed);
        let open = stored - octree.certified_count();
        println!("{:24} {stored:8} stored {open:7} open {ratio:8.3}", surface.name);
        let most = MOST.iter().find(|(name, _)| *name == surface.name);
        if let Some(&(name, most)) = most.filter(|(_, most)| ratio > *most) {
            failures.push(format!("{name}: {ratio} voxels instead of {most}"));
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}
