//! Sculptures against volumes that are built anew.

use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::{
    hrb::{Fixed8, HrbOctree, Sample, Samples, Tolerance, Value},
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
    let deed = match kind % 9 {
        0 => Deed::Add,
        1 => Deed::Remove,
        2 => Deed::Fill,
        3 => Deed::Cut,
        4 => Deed::Smooth,
        5 => Deed::Twist { axis: DVec3::Z, angle: 1.0 },
        6 => Deed::Bend { axis: DVec3::Z, angle: 0.7 },
        7 => Deed::Inflate,
        _ => Deed::Drag,
    };
    let shape = if (kind / 9).is_multiple_of(2) { Shape::Ball } else { Shape::Cube };
    let falloff = [Falloff::Linear, Falloff::Smooth, Falloff::Hard][(kind / 18 % 3) as usize];
    Tool { shape, deed, radius, strength, falloff, range: [0.0, 255.0] }
}

/// A tool's kind, where it begins and which way it goes, in parts of the edge, its radius and strength.
type Made = (u64, [f64; 3], [f64; 3], f64, f64);

fn random_strokes(n: u32, strokes: &[Made], border: Border) -> Result<(), TestCaseError> {
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

/// What was joined within a tolerance before the first stroke stays within it of what was not, however
/// many strokes of tools that work on values in their places follow.
#[test]
fn errors_do_not_add_up() {
    let (n, epsilon) = (64, 1.5);
    let mut exact = round(n);
    let all = exact.octree().samples();
    let tolerance = Tolerance { epsilon, ..Tolerance::default() };
    let octree = HrbOctree::build(&exact.octree().values(&all), [n; 3], tolerance);
    let mut joined = Sculpture::new(octree, 0.0, Border::Capped);
    let deeds = [Deed::Add, Deed::Smooth, Deed::Remove, Deed::Smooth, Deed::Fill, Deed::Cut];
    for (i, deed) in (0..120_u32).zip(deeds.into_iter().cycle()) {
        // Again and again over the same places.
        let at = DVec3::from_array([7, 11, 5].map(|step| f64::from(step * i % n)));
        let tool = ball_tool(deed, 9.0, 0.4);
        let piece = Piece { from: at, to: at };
        for sculpture in [&mut exact, &mut joined] {
            sculpture.apply(&tool, &piece);
        }
    }
    let pairs = exact.octree().values(&all).into_iter().zip(joined.octree().values(&all));
    let farthest = pairs.map(|(a, b)| f64::from(a - b).abs()).fold(0.0, f64::max);
    // What is left of the tolerance, and what rounding adds.
    assert!(farthest > 0.3 && farthest < epsilon + 1e-4, "{farthest}");
}

/// A thousand strokes, each compared: minutes.
#[test]
#[ignore = "takes minutes: cargo test --release --lib -- --ignored a_thousand_strokes"]
fn a_thousand_strokes_are_local_and_exact() {
    let mut state = 1_u64;
    let mut random = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let strokes: Vec<_> = (0..1000)
        .map(|_| {
            let kind = (random() * 1e9) as u64;
            let from = [random(), random(), random()];
            let way = [random(), random(), random()].map(|c| 2.0 * c - 1.0);
            (kind, from, way, 1.0 + 11.0 * random(), 0.1 + random())
        })
        .collect();
    random_strokes(128, &strokes, Border::Capped).unwrap();
}

/// Depths of a solid, of places from the middle.
fn solid(n: u32, depth: impl Fn(DVec3) -> f64) -> Sculpture<f32> {
    let middle = f64::from(n) / 2.0;
    let all = Samples { first: [0; 3], end: [n; 3] };
    let value = |p: [u32; 3]| {
        depth(DVec3::from_array(p.map(f64::from)) + 0.5 - middle).clamp(-DEPTH, DEPTH) as f32
    };
    let samples: Vec<f32> = all.iter().map(value).collect();
    Sculpture::new(HrbOctree::build(&samples, [n; 3], Tolerance::default()), 0.0, Border::Capped)
}

/// A ball of 30 samples' radius, longer along x, so that a twist shows.
fn round(n: u32) -> Sculpture<f32> {
    solid(n, |q| 30.0 - (q * DVec3::new(0.7, 1.2, 1.0)).length())
}

/// A bar along x.
fn bar(n: u32, half_length: f64, half_width: f64) -> Sculpture<f32> {
    solid(n, |q| (half_width - q.y.abs().max(q.z.abs())).min(half_length - q.x.abs()))
}

/// A tool for depths.
fn ball_tool(deed: Deed, radius: f64, strength: f64) -> Tool {
    let range = [-DEPTH, DEPTH];
    Tool { shape: Shape::Ball, deed, radius, strength, falloff: Falloff::Smooth, range }
}

fn volume(sculpture: &Sculpture<f32>) -> f64 {
    let extraction = sculpture.extraction();
    let corner = |v: u32| DVec3::from_array(extraction.vertices[v as usize].point());
    let of = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(corner);
        a.dot(b.cross(c)) / 6.0
    };
    extraction.triangles.iter().map(of).sum()
}

/// Twists, drags, bends, and what is inflated at the cost of what is around.
#[test]
fn tools_that_move_keep_the_volume() {
    let n = 112;
    let before = round(n);
    let (whole, middle) = (volume(&before), DVec3::splat(f64::from(n) / 2.0));
    let at = |far: f64| middle + far * DVec3::Z;
    let twist = Deed::Twist { axis: DVec3::Z, angle: 1.2 };
    let bend = Deed::Bend { axis: DVec3::Z, angle: 0.8 };
    let ways = [
        (ball_tool(twist, 50.0, 1.0), Piece { from: middle, to: middle }),
        (ball_tool(Deed::Drag, 24.0, 1.0), Piece { from: at(25.0), to: at(33.0) }),
        (ball_tool(bend, 52.0, 1.0), Piece { from: middle, to: middle + DVec3::X }),
        (ball_tool(Deed::Inflate, 26.0, 0.5), Piece { from: at(30.0), to: at(30.0) }),
    ];
    for (tool, piece) in ways {
        let mut sculpture = before.clone();
        sculpture.apply(&tool, &piece);
        assert!(sculpture.extraction() != before.extraction(), "{:?}", tool.deed);
        let part = volume(&sculpture) / whole;
        assert!((part - 1.0).abs() < 1e-3, "{:?}: {part}", tool.deed);
    }
}

/// The arm of a bar turns about its hinge; the other half stays.
#[test]
fn a_bend_turns_the_arm() {
    let middle = DVec3::splat(40.0);
    let mut sculpture = bar(80, 32.0, 6.0);
    let tool = ball_tool(Deed::Bend { axis: DVec3::Z, angle: 0.5 }, 38.0, 1.0);
    sculpture.apply(&tool, &Piece { from: middle, to: middle + DVec3::X });
    let is_solid = |p: DVec3| sculpture.octree().value_at(p.to_array()) > 0.0;
    let turned = 18.0 * DVec3::new(libm::cos(0.5), libm::sin(0.5), 0.0);
    let beside = 9.0 * DVec3::new(-libm::sin(0.5), libm::cos(0.5), 0.0);
    assert!(is_solid(middle + turned), "the arm turns");
    assert!(!is_solid(middle + turned + beside) && !is_solid(middle + turned - beside));
    assert!(is_solid(middle - 18.0 * DVec3::X), "the other half stays");
    assert!(!is_solid(middle - 18.0 * DVec3::X + 9.0 * DVec3::Y));
}

/// A bar bent by a right angle is as thick beside the hinge as before, and depths there are distances.
#[test]
fn a_strong_bend_leaves_a_bar_whole() {
    let middle = DVec3::splat(48.0);
    let mut sculpture = bar(96, 36.0, 8.0);
    let before = volume(&sculpture);
    let angle = std::f64::consts::FRAC_PI_2;
    let tool = ball_tool(Deed::Bend { axis: DVec3::Z, angle }, 76.0, 1.0);
    sculpture.apply(&tool, &Piece { from: middle, to: middle + DVec3::X });
    assert!((volume(&sculpture) / before - 1.0).abs() < 1e-4);
    let depth = |p: DVec3| sculpture.octree().value_at((middle + p).to_array());
    for want in [-3.0, -1.0, 1.0, 3.0] {
        for side in [DVec3::X, -DVec3::X, DVec3::Z, -DVec3::Z] {
            // The arm lies along y.
            let got = depth(31.0 * DVec3::Y + (8.0 - want) * side);
            assert!((got - want).abs() < 0.2, "{got} at {want} along {side}");
        }
    }
    let still = [0.0, 12.5].map(|y| depth(y * DVec3::Y - 30.0 * DVec3::X));
    assert_eq!(still, [DEPTH, -DEPTH], "the other half stays");
}

/// What is inflated rises in the middle and sinks around.
#[test]
fn what_is_inflated_comes_from_around() {
    let n = 112;
    let middle = DVec3::splat(f64::from(n) / 2.0);
    let mut sculpture = round(n);
    let top = middle + 30.0 * DVec3::Z;
    let depth = |sculpture: &Sculpture<f32>, p: DVec3| sculpture.octree().value_at(p.to_array());
    let ring = middle + 18.0 * DVec3::X + 27.0 * DVec3::Z;
    let before = [depth(&sculpture, top), depth(&sculpture, ring)];
    let tool = ball_tool(Deed::Inflate, 26.0, 0.4);
    sculpture.apply(&tool, &Piece { from: top, to: top });
    assert!(depth(&sculpture, top) > before[0] + 2.0, "it rises in the middle");
    assert!(depth(&sculpture, ring) < before[1], "it sinks around");
}

/// A tool pushed into a block waits until it has eaten what is in it, and lags behind the hand.
#[test]
fn a_pushed_tool_waits_for_the_block() {
    let n = 48;
    let samples: Vec<u8> = (0..n * n * n).map(|i| if i % n < n / 2 { 255 } else { 0 }).collect();
    let octree = HrbOctree::build(&samples, [n; 3], Tolerance::default());
    let mut block = Sculpture::new(octree, 128.0, Border::Capped);
    let before = volume_of(&block);
    let tool = Tool {
        shape: Shape::Ball,
        deed: Deed::Remove,
        radius: 6.0,
        strength: 0.2,
        falloff: Falloff::Hard,
        range: [0.0, 255.0],
    };
    let middle = f64::from(n) / 2.0;
    let place = |x| DVec3::new(x, middle, middle);
    // The way has a joint.
    let way = [
        Piece { from: place(44.0), to: place(30.0) },
        Piece { from: place(30.0), to: place(10.0) },
    ];
    let contact = Contact { step: 1.0, stiffness: 2.0, moments: 400 };
    let moments = block.push(&tool, &way, &contact);
    let last = moments.last().unwrap();
    assert_eq!((last.tool, last.force), (34.0, 0.0), "it gets to the end");
    // In the air there is no force; in the block there is, by Hooke's law.
    assert!(moments[..8].iter().all(|moment| moment.force == 0.0));
    assert!(moments.iter().any(|moment| moment.force > 10.0));
    assert!(moments.iter().all(|moment| moment.force == 2.0 * (moment.hand - moment.tool)));
    assert!(moments.windows(2).all(|pair| pair[1].tool >= pair[0].tool));
    // Nothing solid is left where the tool has been.
    let hole = Samples { first: [11, 24, 24], end: [24, 25, 25] };
    assert!(
        block
            .octree()
            .values(&hole)
            .iter()
            .all(|value| *value == Fixed8::from_f64(0.0) || { value.to_f64() < 128.0 })
    );
    assert!(volume_of(&block) < before);
    check(&block, Border::Capped).unwrap();
}

fn volume_of(sculpture: &Sculpture<Fixed8>) -> usize {
    let octree = sculpture.octree();
    octree.values(&octree.samples()).iter().filter(|value| value.to_f64() >= 128.0).count()
}
