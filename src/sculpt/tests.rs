//! Sculptures against volumes that are built anew.

use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::{
    hrb::{Fixed8, HrbOctree, Samples, Tolerance, Value},
    mesh::{Border, extract},
};

fn ball(n: u32) -> Vec<u8> {
    let middle = f64::from(n) / 2.0;
    let all = Samples { first: [0; 3], end: [n; 3] };
    let value = |p: [u32; 3]| {
        let r = (DVec3::from_array(p.map(f64::from)) + 0.5 - middle).length();
        (128.0 + 32.0 * (0.6 * middle - r)).clamp(0.0, 255.0) as u8
    };
    all.iter().map(value).collect()
}

/// Whether a sculpture is what its samples would make anew: octree, corners and mesh.
fn check(sculpture: &Sculpture<Fixed8>, border: Border) -> Result<(), TestCaseError> {
    let octree = sculpture.octree();
    let all = octree.samples();
    use crate::hrb::Sample;
    let samples: Vec<u8> = octree.values(&all).iter().map(|v| v.to_f64() as u8).collect();
    let mut anew = HrbOctree::build(&samples, octree.size(), Tolerance::default());
    anew.assign_corners();
    prop_assert!(anew == *octree, "the octree is another one");
    let grid = anew.grid(sculpture.isovalue(), border);
    let whole = extract(&grid, |crossing| *crossing);
    let parts = sculpture.extraction();
    prop_assert_eq!(parts.vertices.len(), whole.vertices.len());
    prop_assert!(parts == whole, "the mesh is another one");
    Ok(())
}

fn tool(kind: u64, radius: f64, strength: f64) -> Tool {
    let deed = match kind % 7 {
        0 => Deed::Add,
        1 => Deed::Remove,
        2 => Deed::Fill,
        3 => Deed::Cut,
        4 => Deed::Smooth,
        5 => Deed::Twist { axis: DVec3::Z, angle: 1.0 },
        _ => Deed::Drag,
    };
    let shape = if kind / 7 % 2 == 0 { Shape::Ball } else { Shape::Cube };
    let falloff = [Falloff::Linear, Falloff::Smooth, Falloff::Hard][(kind / 14 % 3) as usize];
    Tool { shape, deed, radius, strength, falloff, range: [0.0, 255.0] }
}

fn random_strokes(
    n: u32,
    strokes: &[(u64, [f64; 3], [f64; 3], f64, f64)],
    border: Border,
) -> Result<(), TestCaseError> {
    let octree = HrbOctree::build(&ball(n), [n; 3], Tolerance::default());
    let mut sculpture = Sculpture::new(octree, 128.0, border);
    check(&sculpture, border)?;
    for &(kind, from, way, radius, strength) in strokes {
        let from = DVec3::from_array(from) * f64::from(n);
        let piece = Piece { from, to: from + DVec3::from_array(way) * 4.0 };
        sculpture.apply(&tool(kind, radius, strength), &piece);
        check(&sculpture, border)?;
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    /// After every stroke the sculpture is what its samples would make anew.
    #[test]
    fn strokes_are_local_and_exact(
        n in 20..44_u32,
        is_capped: bool,
        strokes in prop::collection::vec(
            (any::<u64>(), [0.0..1.0, 0.0..1.0, 0.0..1.0], [-1.0..1.0, -1.0..1.0, -1.0..1.0], 1.0..9.0, 0.1..1.5),
            1..10,
        ),
    ) {
        random_strokes(n, &strokes, if is_capped { Border::Capped } else { Border::Open })?;
    }
}

/// Blocks of one value, with regions that are larger than bricks on both sides of the surface.
#[test]
fn large_regions_are_cut_and_joined() {
    let n = 64;
    let samples: Vec<u8> =
        (0..n * n * n).map(|i| if i / n / n < n / 2 { 200 } else { 0 }).collect();
    let octree = HrbOctree::build(&samples, [n; 3], Tolerance::default());
    for border in [Border::Open, Border::Capped] {
        let mut sculpture = Sculpture::new(octree.clone(), 100.0, border);
        check(&sculpture, border).unwrap();
        let corner = Samples { first: [20, 21, 30], end: [27, 25, 35] };
        let before = sculpture.octree().values(&corner);
        sculpture.set(&corner, &vec![Fixed8::from_f64(150.0); corner.n()]);
        check(&sculpture, border).unwrap();
        let far = Samples { first: [60, 60, 60], end: [64, 64, 64] };
        sculpture.set(&far, &vec![Fixed8::from_f64(255.0); far.n()]);
        check(&sculpture, border).unwrap();
        sculpture.set(&corner, &before);
        check(&sculpture, border).unwrap();
        sculpture.set(&far, &vec![Fixed8::from_f64(0.0); far.n()]);
        check(&sculpture, border).unwrap();
        assert_eq!(*sculpture.octree(), {
            let mut anew = octree.clone();
            anew.assign_corners();
            anew
        });
    }
}
