//! No voxel is lost: every sign change that a dense sample shows lies in a stored voxel, and what
//! is said to be inside or outside is.

use std::collections::BTreeSet;

use fearless_simd::Simd;
use proptest::prelude::*;
use rayon::{
    ThreadPoolBuilder,
    iter::{IntoParallelIterator, ParallelIterator},
};
use zeroset::{
    eval::{Machine, POINT_BATCH, PointEvaluator, Points},
    expr::{Expr, Tape},
    math::{Aabb, Interval, Lattice, SimdLevel, SimdTask},
    octree::{Occupancy, Storage},
    progress::Unwatched,
    voxelize::{Precision, Schedule, Settings, Voxelization, voxelize},
};

use crate::{
    formulas::{expr, formula},
    numbers::cases,
};

/// A domain and a resolution.
fn lattice(min: [f64; 3], max: [f64; 3], resolution: u32) -> Lattice {
    Lattice::new(Aabb { min: min.into(), max: max.into() }, resolution)
}

fn cube(half: f64, resolution: u32) -> Lattice {
    lattice([-half; 3], [half; 3], resolution)
}

fn run(expr: &Expr, lattice: &Lattice) -> Voxelization {
    voxelize(expr, lattice, &Settings::default(), &Unwatched).unwrap()
}

/// The blend of spheres of scene 1: ten balls, positive inside.
fn blend() -> Expr {
    let spheres = [
        [0.00, 0.00, 0.00, 1.60],
        [0.42, 0.05, 0.12, 2.20],
        [-0.40, 0.10, -0.10, 2.10],
        [0.06, 0.44, -0.08, 2.30],
        [-0.05, -0.43, 0.10, 2.20],
        [0.08, -0.06, 0.46, 2.40],
        [-0.10, 0.04, -0.45, 2.30],
        [0.66, 0.26, 0.24, 2.90],
        [-0.58, -0.22, -0.34, 2.70],
        [0.20, 0.62, 0.28, 2.80],
    ];
    Expr::blend(0.25, 1.0, &spheres)
}

const SCENE_2: &str = "r = sin(4*theta)*sin(8*phi)";
const SCENE_3: &str = "r = sin(3*theta)*sin(4*phi)";

/// Samples along an edge of a voxel, both ends included.
const SAMPLES: u32 = 5;

/// The same for a closer look: certificates come from the ends and middles of eighths of voxels.
const FINE_SAMPLES: u32 = 17;

/// What the samples of one voxel show.
#[derive(Clone, Copy, Debug, Default)]
struct Signs {
    negative: bool,
    zero: bool,
    positive: bool,
    undefined: bool,
}

/// All voxels' signs, x fastest.
struct Sampling<'a> {
    tape: &'a Tape,
    lattice: &'a Lattice,
    /// Values this small have no certain sign.
    rounding: f64,
}

impl SimdTask for Sampling<'_> {
    type Output = Vec<Signs>;

    fn run<S: Simd>(self, simd: S) -> Vec<Signs> {
        let [nx, ny, nz] = self.lattice.n_voxels();
        let rows: Vec<(u32, u32)> = (0..nz).flat_map(|k| (0..ny).map(move |j| (j, k))).collect();
        rows.into_par_iter()
            .map_init(
                || PointEvaluator::new(simd),
                |evaluator, (j, k)| {
                    (0..nx).map(|i| self.signs(evaluator, [i, j, k], SAMPLES)).collect::<Vec<_>>()
                },
            )
            .flatten()
            .collect()
    }
}

impl Sampling<'_> {
    fn signs<S: Simd>(
        &self,
        evaluator: &mut PointEvaluator<S>,
        ijk: [u32; 3],
        samples: u32,
    ) -> Signs {
        let mut signs = Signs::default();
        let n = samples.pow(3);
        for first in (0..n).step_by(POINT_BATCH) {
            let mut points: Points = [[0.0; POINT_BATCH]; 3];
            for (lane, nth) in (first..).take(POINT_BATCH).enumerate() {
                let nth = nth.min(n - 1);
                let step = [nth % samples, nth / samples % samples, nth / (samples * samples)];
                for axis in 0..3 {
                    let [a, b] = [0, 1].map(|end| self.lattice.corner(axis, ijk[axis] + end));
                    let t = f64::from(step[axis]) / f64::from(samples - 1);
                    points[axis][lane] = if t == 1.0 { b } else { a + t * (b - a) };
                }
            }
            for value in evaluator.eval(self.tape, &points) {
                if !value.is_finite() {
                    signs.undefined = true; // or a pole, whose sign depends on the side
                } else if value.abs() <= self.rounding {
                    signs.zero |= value == 0.0;
                } else if value < 0.0 {
                    signs.negative = true;
                } else {
                    signs.positive = true;
                }
            }
        }
        signs
    }
}

/// Whether samples of the voxel's neighbours are negative: the voxel itself may be defined in a
/// corner between the samples.
fn is_beside_negative(all: &[Signs], lattice: &Lattice, ijk: [u32; 3]) -> bool {
    let n = lattice.n_voxels();
    (0..27_u32).any(|i| {
        let place = [i % 3, i / 3 % 3, i / 9].into_iter().zip(ijk);
        let place: Vec<u32> = place.filter_map(|(d, v)| (v + d).checked_sub(1)).collect();
        let [i, j, k] = place[..] else { return false };
        let inside = i < n[0] && j < n[1] && k < n[2];
        inside && all[(i + n[0] * (j + n[1] * k)) as usize].negative
    })
}

/// The signs of one voxel's fine samples.
struct CloserSampling<'a>(Sampling<'a>, [u32; 3]);

impl SimdTask for CloserSampling<'_> {
    type Output = Signs;

    fn run<S: Simd>(self, simd: S) -> Signs {
        self.0.signs(&mut PointEvaluator::new(simd), self.1, FINE_SAMPLES)
    }
}

/// Voxelizes and holds every voxel against its samples.
fn check(name: &str, expr: &Expr, lattice: &Lattice, rounding: f64) -> Voxelization {
    let found = run(expr, lattice);
    let tape = expr.tape();
    let all = SimdLevel::detect().run(Sampling { tape: &tape, lattice, rounding });
    let [nx, ny, _] = lattice.n_voxels();
    let mut n_crossed = 0;
    for (i, &signs) in all.iter().enumerate() {
        let i = i as u32;
        let ijk = [i % nx, i / nx % ny, i / (nx * ny)];
        let occupancy = found.octree.occupancy(ijk);
        let crossed = (signs.negative && signs.positive) || signs.zero;
        n_crossed += u32::from(crossed);
        match occupancy {
            Occupancy::Surface => {
                let rank = found.octree.find(ijk).unwrap();
                if found.octree.is_certified(rank) && !(signs.negative && signs.positive) {
                    // Here the smallest values have a sign too: a certificate is exact.
                    let sampling = Sampling { tape: &tape, lattice, rounding: 0.0 };
                    let signs = SimdLevel::detect().run(CloserSampling(sampling, ijk));
                    assert!(signs.negative && signs.positive, "{name}: {ijk:?} shows {signs:?}");
                }
            }
            Occupancy::Inside => {
                assert!(
                    !signs.positive && !signs.zero,
                    "{name}: voxel {ijk:?} is inside but {signs:?}"
                );
                assert!(
                    signs.negative || !signs.undefined || is_beside_negative(&all, lattice, ijk),
                    "{name}: voxel {ijk:?} is inside but not defined"
                );
            }
            Occupancy::Empty => assert!(
                !signs.negative && !signs.zero,
                "{name}: voxel {ijk:?} is empty but {signs:?}"
            ),
        }
        assert!(!crossed || occupancy == Occupancy::Surface, "{name}: {ijk:?} is lost: {signs:?}");
    }
    assert!(n_crossed > 0, "{name} has no surface");
    found
}

fn check_all(formulas: &[(&str, Lattice)]) {
    for (text, lattice) in formulas {
        check(text, &expr(text), lattice, 1e-13);
    }
}

#[test]
fn no_voxel_of_a_smooth_surface_is_lost() {
    check_all(&[
        ("x^2 + y^2 + z^2 = 1", cube(1.25, 64)),
        ("r = 1", cube(1.25, 51)),
        ("(sqrt(x^2 + y^2) - 0.7)^2 + z^2 = 0.09", cube(1.1, 64)),
        ("sin(5*x)*cos(5*y) + sin(5*y)*cos(5*z) + sin(5*z)*cos(5*x)", cube(1.3, 64)),
        (
            "(x^2 + 9/4*y^2 + z^2 - 1)^3 - x^2*z^3 - 9/80*y^2*z^3",
            lattice([-1.3, -0.9, -1.1], [1.3, 0.9, 1.4], 64),
        ),
        ("exp(200*(r - 0.5)) = 1", cube(1.0, 64)),
        ("1e30*(x^2 + y^2 + z^2)^60 = 1", cube(1.0, 64)),
        ("1e30*(x^2 + y^2 + z^2 - 1)*(x^2 + y^2 + z^2 - 0.5)", cube(1.1, 64)),
        ("x^4 + y^4 + z^4 - x^2 - y^2 - z^2 + 0.3", lattice([-1.2; 3], [1.5; 3], 60)),
    ]);
    check("blend", &blend().negated(), &cube(1.0, 64), 1e-13);
    check("blend, positive inside", &blend(), &lattice([-0.9; 3], [1.0, 1.1, 0.9], 47), 1e-13);
}

#[test]
fn no_voxel_of_a_spherical_scene_is_lost() {
    check_all(&[
        (SCENE_2, cube(1.0, 64)),
        (SCENE_2, lattice([-1.03, -0.9, -1.0], [0.97, 1.1, 0.8], 61)),
        (SCENE_3, cube(1.0, 64)),
        (SCENE_3, lattice([-0.3, -1.0, -1.0], [1.0, 0.21, 0.77], 64)),
        ("rho = 0.7 + 0.1*sin(9*theta)", cube(1.0, 64)),
        ("r = 0.6 + 0.3*sin(2*theta + 6*z)", cube(1.0, 64)),
        ("r = 0.6 + 0.1*cos(5*phi - theta)", cube(1.0, 50)),
    ]);
}

#[test]
fn no_voxel_of_a_surface_with_edges_is_lost() {
    check_all(&[
        ("|x| + |y| + |z| = 1", cube(1.1, 64)),
        ("max(x^2 + y^2, max(y^2 + z^2, z^2 + x^2)) = 1", cube(1.25, 64)),
        ("min(max(x, y), max(z - 0.3, |x + y| - 0.7)) = 0.1", cube(1.0, 64)),
        ("|x|^(2/3) + |y|^(2/3) + |z|^(2/3) = 1", cube(1.1, 64)),
        ("x^2 + y^2 + z^2 + 1e30*max(0, z - 0.5) = 1", cube(1.1, 64)),
        ("max(x, 0)^1.5 + y^2 + z^2 = 0.6", cube(1.0, 64)),
        ("min(max(x, 0), max(y, 0))^0.5 + z^2 = 0.6", cube(1.0, 41)),
    ]);
}

#[test]
fn no_voxel_of_a_partly_defined_formula_is_lost() {
    check_all(&[
        ("ln(x) + y^2 = z", cube(1.3, 64)),
        ("ln(x) + 5*y^2 = 1", lattice([-1.0; 3], [1.0; 3], 64)),
        ("sqrt(x) - 0.7 + y^2", cube(1.0, 64)),
        ("sqrt(x*y) - z - 3*sqrt(z)", cube(1.0, 50)),
        ("sqrt(x) + y - 1.5", lattice([-1.1; 3], [1.3; 3], 64)),
        ("sqrt(1 - x^2 - y^2 - z^2) = 0.5 + z", cube(1.2, 64)),
        ("acos(x + y) = 1 + z", cube(1.0, 64)),
        ("1/x = 2*y + z", cube(1.0, 64)),
        ("y + 1/(x*z) = 3", cube(2.0, 63)),
        ("x^y = z", cube(2.0, 64)),
        ("theta", cube(1.0, 64)),
        ("theta = 3.1", lattice([-1.0; 3], [0.7; 3], 64)),
        ("theta + z", cube(4.0, 64)),
        ("exp(1/x) = 2 + y*z", cube(2.0, 64)),
    ]);
}

/// Certification drops voxels and adds none.
#[test]
fn certified_voxels_are_a_part_of_all() {
    for text in [SCENE_2, "|x| + |y| + |z| = 1", "ln(x) + y^2 = z", "floor(3*x) + y = 0.5"] {
        let (expr, lattice) = (expr(text), cube(1.1, 64));
        let by_values = Settings { certify: false, ..Settings::default() };
        let all = voxelize(&expr, &lattice, &by_values, &Unwatched).unwrap().octree;
        assert_eq!(all.certified_count(), 0);
        let certified = run(&expr, &lattice).octree;
        assert!(certified.certified_count() > 0 && certified.voxel_count() <= all.voxel_count());
        for part in certified.parts() {
            certified.visit(part, &mut |voxel| assert!(all.find(voxel.ijk).is_some(), "{text}"));
        }
    }
}

#[test]
fn no_voxel_is_lost_in_awkward_domains() {
    check_all(&[
        ("x^2 + 4*y^2 + 9*z^2 = 1", lattice([-1.1, -0.6, -0.4], [1.1, 0.6, 0.4], 100)),
        ("x^2 + y^2 + z^2 = 1", lattice([-1.0; 3], [1.0; 3], 1)),
        ("x^2 + y^2 + z^2 = 1", lattice([-1.0; 3], [1.0; 3], 3)),
        ("x^2 + y^2 + z^2 = 1", lattice([-0.1, 0.2, -3.0], [1.1, 0.3, 3.0], 129)),
        ("x + y + z = 0", lattice([-0.3; 3], [0.3, 0.2, 0.1], 17)),
        ("x^2 + y^2 + z^2 = 1e8", lattice([9990.0, -10.0, -10.0], [10010.0, 10.0, 10.0], 64)),
        ("(x/1e6)^2 + (y/1e6)^2 + (z/1e6)^2 = 1", cube(1.2e6, 33)),
        ("(1e6*x)^2 + (1e6*y)^2 + (1e6*z)^2 = 1", cube(1.2e-6, 33)),
    ]);
}

/// What is certain of F at a point: that it is negative, that it is positive.
fn certain_signs(tape: &Tape, p: [f64; 3]) -> [bool; 2] {
    let inputs = p.map(|v| [Interval::point(v)]);
    let mut machine = Machine::<Interval<f64>, 1>::default();
    let notes = machine.run((), tape, &inputs, false);
    let range = machine.slot(tape.result());
    let is_defined = !notes[0].undefined && !notes[0].partial;
    [range[0].hi < 0.0, 0.0 < range[0].lo].map(|sign| sign && is_defined)
}

/// What is certain of F at some of a lattice of points in a voxel.
fn certain_signs_in(tape: &Tape, lattice: &Lattice, ijk: [u32; 3], samples: u32) -> [bool; 2] {
    let mut signs = [false; 2];
    for nth in 0..samples.pow(3) {
        let step = [nth % samples, nth / samples % samples, nth / (samples * samples)];
        let p = [0, 1, 2].map(|axis| {
            let [a, b] = [0, 1].map(|end| lattice.corner(axis, ijk[axis] + end));
            let t = f64::from(step[axis]) / f64::from(samples - 1);
            if t == 1.0 { b } else { a + t * (b - a) }
        });
        let here = certain_signs(tape, p);
        signs = [signs[0] | here[0], signs[1] | here[1]];
    }
    signs
}

proptest! {
    #![proptest_config(cases(1_500))]

    #[test]
    fn no_voxel_of_a_random_formula_is_lost(
        text in formula(),
        min in [-2.0..2.0_f64, -2.0..2.0_f64, -2.0..0.5_f64],
        size in [0.1..4.0_f64, 0.1..4.0_f64, 0.1..4.0_f64],
        is_round in any::<bool>(),
        resolution in 5_u32..14,
    ) {
        let round = |v: f64| if is_round { (4.0 * v).round() / 4.0 } else { v };
        let min = min.map(round);
        let max = [0, 1, 2].map(|axis| min[axis] + round(size[axis]).max(0.125));
        let (expr, lattice) = (expr(&text), lattice(min, max, resolution));
        let octree = run(&expr, &lattice).octree;
        let tape = expr.tape();
        let [nx, ny, nz] = lattice.n_voxels();
        for i in 0..nx * ny * nz {
            let ijk = [i % nx, i / nx % ny, i / (nx * ny)];
            let signs = certain_signs_in(&tape, &lattice, ijk, 3);
            let wrong = match octree.occupancy(ijk) {
                Occupancy::Surface => {
                    octree.is_certified(octree.find(ijk).unwrap())
                        && signs != [true; 2]
                        && certain_signs_in(&tape, &lattice, ijk, FINE_SAMPLES) != [true; 2]
                }
                Occupancy::Inside => signs[1],
                Occupancy::Empty => signs[0],
            };
            prop_assert!(!wrong, "{ijk:?} is {:?}: {signs:?}", octree.occupancy(ijk));
        }
    }
}

/// Far from the origin f32 no longer tells the corners of a voxel apart.
#[test]
fn no_voxel_is_lost_far_from_the_origin() {
    let (x, h) = (1000.0, 1e-3);
    let far = lattice([x - h, -h, -h], [x + h, h, h], 64);
    assert_eq!(Precision::for_lattice(&far), Precision::Double);
    let text = "(x - 1000)^2 + y^2 + z^2 = 0.0000005";
    let found = check(text, &expr(text), &far, 1e-18);
    assert_eq!(found.precision, Precision::Double);
    let scene = "rho - 1000 + 0.0003*sin(9*phi)*cos(1000*theta)";
    check(scene, &expr(scene), &far, 1e-11);
}

/// The coordinates of the stored voxels.
fn stored(expr: &Expr, lattice: &Lattice) -> BTreeSet<[u32; 3]> {
    let octree = run(expr, lattice).octree;
    let mut voxels = BTreeSet::new();
    for part in octree.parts() {
        octree.visit(part, &mut |voxel| {
            voxels.insert(voxel.ijk);
        });
    }
    voxels
}

fn assert_symmetric(name: &str, lattice: &Lattice, map: impl Fn([u32; 3]) -> [u32; 3]) {
    let voxels = stored(&expr(name), lattice);
    let image: BTreeSet<_> = voxels.iter().map(|&ijk| map(ijk)).collect();
    let lost: Vec<_> = voxels.symmetric_difference(&image).take(4).collect();
    assert!(lost.is_empty(), "{name} at {:?}: {lost:?}", lattice.n_voxels());
}

#[test]
fn symmetric_scenes_have_symmetric_voxels() {
    for lattice in [cube(1.0, 64), cube(1.0625, 64), cube(1.1, 61), cube(0.97, 100)] {
        let last = lattice.n_voxels()[0] - 1;
        assert_symmetric(SCENE_2, &lattice, |[x, y, z]| [last - y, x, z]);
        assert_symmetric(SCENE_2, &lattice, |[x, y, z]| [x, last - y, last - z]);
        assert_symmetric(SCENE_3, &lattice, |[x, y, z]| [last - x, y, z]);
        for sphere in ["x^2 + y^2 + z^2 = 0.7", "r = 0.8"] {
            for flips in 0..8_u32 {
                let flip = |axis: u32, v: u32| if flips >> axis & 1 == 1 { last - v } else { v };
                let turned = |[x, y, z]: [u32; 3]| [flip(0, x), flip(1, y), flip(2, z)];
                assert_symmetric(sphere, &lattice, turned);
                assert_symmetric(sphere, &lattice, |[x, y, z]| turned([y, z, x]));
                assert_symmetric(sphere, &lattice, |[x, y, z]| turned([z, x, y]));
                assert_symmetric(sphere, &lattice, |[x, y, z]| turned([y, x, z]));
                assert_symmetric(sphere, &lattice, |[x, y, z]| turned([x, z, y]));
                assert_symmetric(sphere, &lattice, |[x, y, z]| turned([z, y, x]));
            }
        }
    }
}

#[test]
fn threads_and_levels_change_nothing() {
    let far = lattice([999.0, -1.0, -1.0], [1001.0, 1.0, 1.0], 100);
    let cases = [
        (expr(SCENE_2), cube(1.0, 128)),
        (blend(), cube(1.0, 100)),
        (expr("min(r - 0.5, max(|x| - 0.9, |y + z| - 0.1)) = 0.1"), cube(1.0, 128)),
        (expr("ln(x) + y^2 = z"), cube(1.0, 128)),
        (expr("(x - 1000)^2 + y^2 + z^2 = 0.5"), far),
    ];
    for (expr, lattice) in &cases {
        let reference = run(expr, lattice);
        let same = |other: &Voxelization, what: &str| {
            assert_eq!(other.octree.digest(), reference.octree.digest(), "{what}");
            assert_eq!(other.effort, reference.effort, "{what}");
        };
        for threads in [1, 2, 7] {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            same(&pool.install(|| run(expr, lattice)), &format!("{threads} threads"));
        }
        for threads in [1, 2, 7] {
            let settings = Settings { schedule: Schedule::MasterSlave, ..Settings::default() };
            let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let found = pool.install(|| voxelize(expr, lattice, &settings, &Unwatched)).unwrap();
            same(&found, &format!("a master and {threads} slaves"));
        }
        for level in SimdLevel::available() {
            same(
                &voxelize(
                    expr,
                    lattice,
                    &Settings { simd: level, ..Settings::default() },
                    &Unwatched,
                )
                .unwrap(),
                level.name(),
            );
        }
    }
}
