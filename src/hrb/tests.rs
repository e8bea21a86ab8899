//! Octrees of regions against the samples they were made of.

use proptest::prelude::*;

use super::*;
use crate::mesh::{Border, Extraction, extract};

/// Samples of a few values in blocks, so that there are regions of all sizes.
fn blocky(size: [u32; 3], seed: u64, n_values: u64) -> Vec<u8> {
    let hash = |a: u64| {
        (a ^ seed)
            .wrapping_mul(0x9e37_79b9_7f4a_7c15)
            .rotate_left(29)
            .wrapping_mul(0xbf58_476d_1ce4_e5b9)
    };
    let [nx, ny, nz] = size;
    let mut samples = Vec::new();
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let coarse =
                    hash(u64::from(x / 8) | u64::from(y / 8) << 20 | u64::from(z / 8) << 40);
                let level = coarse >> 20 & 3;
                let fine = hash(
                    u64::from(x >> level)
                        | u64::from(y >> level) << 20
                        | u64::from(z >> level) << 40,
                );
                samples.push((fine >> 17 & 0xff) as u8 % n_values as u8);
            }
        }
    }
    samples
}

fn build(samples: &[u8], size: [u32; 3], epsilon: f64) -> HrbOctree<Fixed8> {
    HrbOctree::build(samples, size, Tolerance { epsilon, criterion: Criterion::Range })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Nothing is lost without a tolerance, and not more than it with one; counts fit together.
    #[test]
    fn regions_hold_their_samples(
        size in [1..40_u32, 1..40_u32, 1..40_u32], seed: u64, epsilon in 0..4_u32,
    ) {
        let samples = blocky(size, seed, 9);
        let octree = build(&samples, size, f64::from(epsilon));
        for (i, &sample) in (0..).zip(&samples) {
            let p = [i % size[0], i / size[0] % size[1], i / size[0] / size[1]];
            let region = octree.region_at(p);
            let error = (region.value.to_f64() - f64::from(sample)).abs();
            prop_assert!(error <= f64::from(epsilon) + 1.0 / 512.0 && (epsilon > 0 || error == 0.0));
            prop_assert!((0..3).all(|axis| p[axis] >> region.level << region.level == region.base[axis]));
        }
        let storage = octree.storage();
        prop_assert_eq!(storage.regions, 7 * storage.nodes + 1);
        prop_assert_eq!(storage.thesis_bytes, 4 * storage.nodes + 3 * storage.regions);
    }

    /// The value is continuous, what samples say in their places, and near what they say elsewhere.
    #[test]
    fn values_are_continuous(
        seed: u64, p in [0.0..20.0_f64, 0.0..20.0, 0.0..20.0], step in [-1e-9..1e-9_f64, -1e-9..1e-9, -1e-9..1e-9],
        epsilon in 0..4_u32,
    ) {
        let size = [20; 3];
        let samples = blocky(size, seed, 9);
        let octree = build(&samples, size, f64::from(epsilon));
        let exact = build(&samples, size, 0.0);
        let value = octree.value_at(p);
        let beside = [0, 1, 2].map(|axis| p[axis] + step[axis]);
        prop_assert!((octree.value_at(beside) - value).abs() < 1e-6);
        prop_assert!((exact.value_at(p) - value).abs() <= f64::from(epsilon) * (1.0 - 1e-9) + 1.0 / 512.0);
        let sample = p.map(|c| c as u32);
        let middle = sample.map(|i| f64::from(i) + 0.5);
        prop_assert_eq!(octree.value_at(middle), octree.region_at(sample).value.to_f64());
    }

    /// The mesh is what plain Marching Cubes would make of the samples, if regions are cut up.
    #[test]
    fn meshes_have_no_cracks(
        size in [1..30_u32, 1..30_u32, 1..30_u32], seed: u64, epsilon in 0..4_u32, isovalue in 1..8_u32,
    ) {
        let samples = blocky(size, seed, 9);
        let octree = build(&samples, size, f64::from(epsilon));
        let grid = octree.grid(f64::from(isovalue), Border::Capped);
        let Extraction { vertices, triangles } = extract(&grid, |crossing| *crossing);
        let mut uses = std::collections::HashMap::new();
        for &[a, b, c] in &triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *uses.entry((from.min(to), from.max(to))).or_insert(0_i32) += if from < to { 1 } else { -1 };
            }
        }
        prop_assert!(uses.values().all(|&n| n == 0));
        prop_assert!(triangles.as_flattened().iter().all(|&v| (v as usize) < vertices.len()));
        // A region that is inside is enclosed: there are triangles if there is anything inside.
        let is_inside = |sample: &u8| u32::from(*sample) >= isovalue;
        if epsilon == 0 {
            prop_assert_eq!(samples.iter().any(is_inside), !triangles.is_empty());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20))]

    /// Every corner of a region is the corner of one region that answers for it.
    #[test]
    fn every_corner_has_one_region_that_answers(
        size in [1..24_u32, 1..24_u32, 1..24_u32], seed: u64, epsilon in 0..4_u32,
    ) {
        let samples = blocky(size, seed, 3);
        let mut octree = build(&samples, size, f64::from(epsilon));
        octree.assign_corners();
        let mut answers = std::collections::HashMap::new();
        for (i, _) in (0..).zip(&samples) {
            let p = [i % size[0], i / size[0] % size[1], i / size[0] / size[1]];
            let region = octree.region_at(p);
            if region.base != p {
                continue;
            }
            for c in 0..8 {
                let corner = [0, 1, 2].map(|axis| p[axis] + ((c >> axis & 1) << region.level));
                *answers.entry(corner).or_insert(0) += u32::from(region.corners >> c & 1);
            }
        }
        prop_assert!(answers.values().all(|&n| n == 1));
        prop_assert_eq!(octree.storage().cells, answers.len() as u64);
    }
}

#[test]
fn what_is_no_number_is_kept() {
    let mut samples = vec![1.0_f32; 512];
    samples[300] = f32::NAN;
    let octree = HrbOctree::build(&samples, [8; 3], Tolerance::default());
    assert!(octree.region_at([4, 5, 4]).value.is_nan());
    assert_eq!(octree.region_at([0, 0, 0]).value, 1.0);
}

/// Samples of the thesis's models, floored: counts of nodes and regions.
#[test]
fn the_models_have_the_counts_that_another_program_found() {
    let sampled = |n: u32, radius: &dyn Fn(f64, f64, f64) -> f64, is_binary: bool| {
        let at = |i: u32| -1.0 + (f64::from(i) + 0.5) * 2.0 / f64::from(n);
        let mut samples = Vec::new();
        for z in 0..n {
            for y in 0..n {
                for x in 0..n {
                    let r = radius(at(x), at(y), at(z));
                    let value = if is_binary { 255.0 } else { 255.0 * (1.0 - r) };
                    samples.push(if r <= 1.0 { value.clamp(0.0, 255.0) as u8 } else { 0 });
                }
            }
        }
        samples
    };
    let count = |samples: &[u8], n: u32, epsilon: f64, criterion: Criterion| {
        let octree = HrbOctree::build(samples, [n; 3], Tolerance { epsilon, criterion });
        let storage = octree.storage();
        (storage.nodes, storage.regions)
    };
    let ball = |x: f64, y: f64, z: f64| (x * x + y * y + z * z).sqrt();
    let binary = sampled(32, &ball, true);
    assert_eq!(count(&binary, 32, 0.0, Criterion::Range), (873, 6112));
    let ramp = sampled(32, &ball, false);
    let expected = [(0.0, (2921, 20448)), (1.0, (2873, 20112)), (2.0, (2849, 19944))];
    for (epsilon, counts) in expected {
        assert_eq!(count(&ramp, 32, epsilon, Criterion::Range), counts);
    }
    assert_eq!(count(&ramp, 32, 1.0, Criterion::Deviation), (2873, 20112));
    assert_eq!(count(&ramp, 32, 2.0, Criterion::Deviation), (2849, 19944));
    let ramp = sampled(64, &ball, false);
    assert_eq!(count(&ramp, 64, 0.0, Criterion::Range), (21137, 147_960));
    let saddle = |x: f64, y: f64, z: f64| libm::sin(x * z) + y + libm::cos(x * z);
    let ramp = sampled(128, &saddle, false);
    assert_eq!(count(&ramp, 128, 0.0, Criterion::Range), (139_757, 978_300));
    assert_eq!(count(&ramp, 128, 2.0, Criterion::Deviation), (135_799, 950_594));
}

/// Regions larger than bricks that share a face across the surface.
#[test]
fn large_regions_meet_in_a_closed_mesh() {
    for n in [16_u32, 32, 64, 128] {
        let samples: Vec<u8> =
            (0..n.pow(3)).map(|i| if i / n / n < n / 2 { 200 } else { 0 }).collect();
        let octree = build(&samples, [n; 3], 0.0);
        let open = extract(&octree.grid(100.0, Border::Open), |crossing| crossing.point());
        assert!(open.vertices.iter().all(|p| p[2] == f64::from(n / 2)), "{n}");
        assert!(!open.triangles.is_empty());
        let grid = octree.grid(100.0, Border::Capped);
        let Extraction { vertices, triangles } = extract(&grid, |crossing| crossing.point());
        let mut uses = std::collections::HashMap::new();
        for &[a, b, c] in &triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *uses.entry((from.min(to), from.max(to))).or_insert(0_i32) +=
                    if from < to { 1 } else { -1 };
            }
        }
        assert!(!triangles.is_empty() && uses.values().all(|&n| n == 0), "{n}");
        assert!(vertices.iter().any(|p| p[2] == f64::from(n / 2)), "{n}");
    }
}
