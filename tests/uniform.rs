//! Plain Marching Cubes against the dual grid of an octree of single samples: the same triangles.

use proptest::prelude::*;

use zeroset::{
    hrb::{Criterion, HrbOctree, Tolerance},
    mesh::{Border, Crossing, Extraction, Threshold, Triangles, extract, uniform},
};

/// Corners of triangles as bits of coordinates, each triangle from its least corner on, in order.
fn canonical(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<[[u32; 3]; 3]> {
    let place = |v: u32| positions[v as usize].map(f32::to_bits);
    let from_least = |&[a, b, c]: &[u32; 3]| {
        let [a, b, c] = [a, b, c].map(place);
        [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap_or_default()
    };
    let mut all: Vec<_> = triangles.iter().map(from_least).collect();
    all.sort_unstable();
    all
}

/// Both ways; a tolerance below 0 joins no samples, 0 those that are equal.
fn both<T>(
    samples: &[T],
    size: [u32; 3],
    isovalue: f64,
    border: Border,
    epsilon: f64,
) -> [Vec<[[u32; 3]; 3]>; 2]
where
    T: Threshold + zeroset::hrb::Sample,
{
    let Triangles { positions, triangles } = uniform(samples, size, isovalue, border);
    let tolerance = Tolerance { epsilon, criterion: Criterion::Range };
    let octree = HrbOctree::build(samples, size, tolerance);
    let point = |crossing: &Crossing| crossing.point().map(|x| x as f32);
    let Extraction { vertices, triangles: of_octree } =
        extract(&octree.grid(isovalue, border), point);
    let all = extract(&octree.whole_grid(isovalue, border), point);
    assert_eq!(all.triangles.len(), of_octree.len(), "an index loses nothing");
    [canonical(&positions, &triangles), canonical(&vertices, &of_octree)]
}

fn borders() -> impl Strategy<Value = Border> {
    prop_oneof![Just(Border::Open), Just(Border::Capped)]
}

/// Numbers that repeat from run to run.
fn random(seed: u64) -> impl FnMut() -> u64 {
    let mut state = seed | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state >> 11
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Any samples, if none are joined; few values, so that many are the isovalue itself.
    #[test]
    fn bytes(
        size in [1..140_u32, 1..12_u32, 1..12_u32], seed: u64, isovalue in 0..7_u32, border in borders(),
    ) {
        let mut next = random(seed);
        let n = size.iter().product::<u32>();
        let samples: Vec<u8> = (0..n).map(|_| (next() % 6) as u8).collect();
        let [plain, dual] = both(&samples, size, f64::from(isovalue) * 0.9, border, -1.0);
        prop_assert_eq!(plain, dual);
    }

    /// Floats, no two of which are likely to be the same.
    #[test]
    fn floats(size in [1..20_u32, 1..20_u32, 1..20_u32], seed: u64, border in borders()) {
        let mut next = random(seed);
        let n = size.iter().product::<u32>();
        let samples: Vec<f32> = (0..n).map(|_| (next() >> 24) as f32 / 536_870_912.0).collect();
        let [plain, dual] = both(&samples, size, 0.4, border, 0.0);
        prop_assert_eq!(plain, dual);
    }
}

/// What is no number is outside, and hides nothing.
#[test]
fn what_is_no_number_is_outside() {
    let mut next = random(5);
    for border in [Border::Open, Border::Capped] {
        let sample = |k: u64| if k.is_multiple_of(17) { f32::NAN } else { (k % 1000) as f32 };
        let samples: Vec<f32> = (0..11 * 9 * 13).map(|_| sample(next())).collect();
        let [plain, dual] = both(&samples, [11, 9, 13], 400.0, border, -1.0);
        assert!(!plain.is_empty());
        assert_eq!(plain, dual);
    }
}

/// With a tolerance of 0 samples are joined where they are equal, away from a smooth surface, which
/// stays the same bit by bit.
#[test]
fn without_a_tolerance_a_smooth_surface_is_the_same() {
    let n = 64_u32;
    let at = |i: u32| f64::from(2 * i + 1) / f64::from(n) - 1.0;
    let value = |i: u32| {
        let [x, y, z] = [i % n, i / n % n, i / n / n].map(at);
        (255.0 * (1.0 - (x * x + y * y + z * z).sqrt())).clamp(0.0, 255.0) as u8
    };
    let samples: Vec<u8> = (0..n * n * n).map(value).collect();
    let [plain, dual] = both(&samples, [n; 3], 60.0, Border::Open, 0.0);
    assert!(plain.len() > 10_000);
    assert_eq!(plain, dual);
}

#[test]
fn whatever_is_inside_ends_at_a_cap() {
    let samples = vec![9_u8; 24];
    let [plain, dual] = both(&samples, [2, 3, 4], 9.0, Border::Capped, -1.0);
    assert_eq!(plain, dual);
    // Every outer face of every cell between samples and phantoms.
    assert!(!plain.is_empty());
    let [plain, dual] = both(&samples, [2, 3, 4], 10.0, Border::Capped, -1.0);
    assert!(plain.is_empty() && dual.is_empty());
    let [plain, _] = both(&samples, [2, 3, 4], 300.0, Border::Open, -1.0);
    assert!(plain.is_empty());
}
