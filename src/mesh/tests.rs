//! Meshes of grids with voxels of any size: closed, oriented, in the right place.

use std::collections::HashMap;

use proptest::prelude::*;

use super::*;

/// How often each edge is used in its direction.
fn edge_uses(triangles: &[[u32; 3]]) -> HashMap<(u32, u32), i32> {
    let mut uses = HashMap::new();
    for &[a, b, c] in triangles {
        for edge in [(a, b), (b, c), (c, a)] {
            *uses.entry(edge).or_insert(0) += 1;
        }
    }
    uses
}

/// Whether every edge is used as often in one direction as in the other.
fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let uses = edge_uses(triangles);
    uses.iter().all(|(&(a, b), n)| uses.get(&(b, a)) == Some(n))
}

/// A grid of all voxels of a random octree: `split` tells whether a node is divided, `value` what a
/// leaf holds.
pub(super) fn tree_grid(
    depth: u32,
    border: Border,
    isovalue: f64,
    split: &mut dyn FnMut(u32) -> bool,
    value: &mut dyn FnMut([u32; 3], u32) -> f64,
) -> Grid {
    let n = 1_u32 << depth;
    let mut leaves = vec![(0.0, 0_u8); (n as usize).pow(3)];
    let mut stack = vec![([0_u32; 3], depth)];
    while let Some((base, level)) = stack.pop() {
        if level > 0 && split(level) {
            for c in 0..8 {
                let half = 1 << (level - 1);
                stack.push(([0, 1, 2].map(|axis| base[axis] + half * (c >> axis & 1)), level - 1));
            }
            continue;
        }
        let v = value(base, level);
        let side = 1_u32 << level;
        for z in 0..side {
            for y in 0..side {
                for x in 0..side {
                    let p = [base[0] + x, base[1] + y, base[2] + z];
                    leaves[(p[0] + n * (p[1] + n * p[2])) as usize] = (v, level as u8);
                }
            }
        }
    }
    let outside = isovalue - 1.0;
    let at = |p: [u32; 3]| {
        let is_phantom = p.iter().any(|&i| i < SIDE || i >= SIDE + n);
        let q = p.map(|i| i.clamp(SIDE, SIDE + n - 1) - SIDE);
        let (v, level) = leaves[(q[0] + n * (q[1] + n * q[2])) as usize];
        (if is_phantom && border == Border::Capped { outside } else { v }, level)
    };
    let side = n / SIDE + 2;
    let mut bricks = Vec::new();
    for place in 0..side.pow(3) {
        let place = [place % side, place / side % side, place / side / side];
        let mut offsets = Vec::with_capacity(VOXELS);
        let mut levels = Vec::with_capacity(VOXELS);
        for i in 0..VOXELS as u32 {
            let within = [i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE];
            let (v, level) = at([0, 1, 2].map(|axis| place[axis] * SIDE + within[axis]));
            offsets.push(offset(v, isovalue));
            levels.push(level);
        }
        bricks.push(Brick::new(place, &offsets, &levels));
    }
    Grid::new(bricks, [n; 3], border)
}

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
    /// Whatever the octree and its values are, there is no crack.
    #[test]
    fn capped_meshes_are_closed(seed: u64, divided in 1..5_u64) {
        let (mut splits, mut values) = (random(seed), random(seed ^ 0xabcdef));
        let grid = tree_grid(
            4, Border::Capped, 0.5,
            &mut |level| level == 4 || splits() % 5 < divided,
            &mut |_, _| (values() % 5) as f64 / 4.0,
        );
        let Extraction { vertices: crossings, triangles } = extract(&grid, |crossing| *crossing);
        prop_assert!(is_closed(&triangles));
        prop_assert!(triangles.iter().all(|[a, b, c]| a != b && b != c && c != a));
        prop_assert!(triangles.as_flattened().iter().all(|&v| (v as usize) < crossings.len()));
        for crossing in &crossings {
            prop_assert!(crossing.point().iter().all(|&x| (0.0..=16.0).contains(&x)));
        }
    }

    /// An open mesh ends on the border and nowhere else.
    #[test]
    fn open_meshes_end_on_the_border(seed: u64, divided in 1..5_u64) {
        let (mut splits, mut values) = (random(seed), random(seed ^ 0xabcdef));
        let grid = tree_grid(
            4, Border::Open, 0.5,
            &mut |level| level == 4 || splits() % 5 < divided,
            &mut |_, _| (values() % 5) as f64 / 4.0,
        );
        let Extraction { vertices: crossings, triangles } = extract(&grid, |crossing| *crossing);
        let uses = edge_uses(&triangles);
        for (&(a, b), n) in &uses {
            if uses.get(&(b, a)) != Some(n) {
                let [p, q] = [a, b].map(|v| crossings[v as usize].point());
                let is_on_border = (0..3).any(|axis| {
                    [0.0, 16.0].iter().any(|&border| p[axis] == border && q[axis] == border)
                });
                prop_assert!(is_on_border, "{p:?} {q:?}");
            }
        }
    }
}

/// A field that is linear along an axis is met exactly, whatever the sizes of its voxels.
#[test]
fn uniform_grids_give_the_plane_of_a_linear_field() {
    let grid =
        tree_grid(4, Border::Open, 7.3, &mut |_| true, &mut |base, _| f64::from(base[2]) + 0.5);
    let Extraction { vertices: crossings, triangles } = extract(&grid, |crossing| *crossing);
    assert!(crossings.iter().all(|crossing| (crossing.point()[2] - 7.3).abs() < 1e-7));
    // Cells reach from border to border.
    assert_eq!(triangles.len(), 2 * 17 * 17);
    assert_eq!(crossings.len(), 18 * 18);
}

/// Crossings lie within half a voxel of the face that two voxels share.
#[test]
fn crossings_stay_near_faces() {
    let mut levels = random(7);
    let grid = tree_grid(
        5,
        Border::Capped,
        0.5,
        &mut |level| level > 3 || levels().is_multiple_of(3),
        &mut |base, _| f64::from(u8::from(base[0] < 16)),
    );
    let Extraction { vertices: crossings, triangles } = extract(&grid, |crossing| *crossing);
    assert!(is_closed(&triangles));
    let inner = crossings.iter().filter(|crossing| !crossing.is_cap);
    assert!(inner.clone().count() > 50);
    assert!(inner.into_iter().all(|crossing| (crossing.point()[0] - 16.0).abs() <= 0.5));
}
