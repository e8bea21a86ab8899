//! Normals of voxels: the analytic gradient at the centre, or what the neighbours say.

use std::sync::Arc;

use fearless_simd::{Simd, f64x8};
use glam::DVec3;

use crate::{
    eval::{GradientEvaluator, POINT_BATCH, Points},
    expr::Tape,
    math::{Lanes, Lattice, Mask},
    octree::{MortonOctree, OctNormal, Storage},
};

/// Finds the normals of one thread's voxels and collects them in order.
pub(super) struct NormalFinder<S: Simd> {
    simd: S,
    lattice: Arc<Lattice>,
    evaluator: GradientEvaluator<S>,
    normals: Vec<OctNormal>,
    missing: Vec<u32>,
}

impl<S: Simd> NormalFinder<S> {
    pub(super) fn new(simd: S, lattice: Arc<Lattice>) -> Self {
        let evaluator = GradientEvaluator::new(simd);
        Self { simd, lattice, evaluator, normals: Vec::new(), missing: Vec::new() }
    }

    /// Goes on to another lattice.
    pub(super) fn enter(&mut self, lattice: Arc<Lattice>) {
        self.lattice = lattice;
    }

    /// Adds the normals of `voxels`.
    pub(super) fn find(&mut self, tape: &Tape, voxels: impl IntoIterator<Item = [u32; 3]>) {
        let mut centers: Points = [[0.0; POINT_BATCH]; 3];
        let mut n = 0;
        for ijk in voxels {
            let center = self.lattice.voxel_center(ijk);
            (centers[0][n], centers[1][n], centers[2][n]) = (center.x, center.y, center.z);
            n += 1;
            if n == POINT_BATCH {
                self.add(tape, &centers, n);
                n = 0;
            }
        }
        if n > 0 {
            self.add(tape, &centers, n);
        }
    }

    /// Adds the normals at the first `n` of `centers`.
    fn add(&mut self, tape: &Tape, centers: &Points, n: usize) {
        let gradients = self.evaluator.eval(tape, centers);
        let (normals, usable) = normals(self.simd, &gradients);
        let missing = (0..n).filter(|lane| usable >> lane & 1 == 0);
        self.missing.extend(missing.map(|lane| (self.normals.len() + lane) as u32));
        self.normals.extend_from_slice(&normals[..n]);
    }

    /// The number of normals found since they were taken.
    pub(super) fn len(&self) -> usize {
        self.normals.len()
    }

    /// The normals found since the last call, and the places of those without a usable gradient.
    pub(super) fn take(&mut self) -> (Vec<OctNormal>, Vec<u32>) {
        let normals = self.normals.clone();
        self.normals.clear();
        (normals, std::mem::take(&mut self.missing))
    }
}

/// The directions of a batch of vectors, and the lanes that have one, as bits; the others are +z.
fn normals<S: Simd>(simd: S, vectors: &Points) -> ([OctNormal; POINT_BATCH], u64) {
    simd.vectorize(
        #[inline(always)]
        || {
            let mut steps = [[0.0; POINT_BATCH]; 2];
            let mut usable = 0;
            for first in (0..POINT_BATCH).step_by(f64x8::<S>::LEN) {
                let x = f64x8::load(simd, &vectors[0][first..]);
                let y = f64x8::load(simd, &vectors[1][first..]);
                let z = f64x8::load(simd, &vectors[2][first..]);
                let (direction, is_usable) = direction([x, y, z]);
                let [a, b] = OctNormal::steps(direction);
                a.store(&mut steps[0][first..]);
                b.store(&mut steps[1][first..]);
                usable |= is_usable.bits() << first;
            }
            let mut normals = [OctNormal::from_bits(0); POINT_BATCH];
            for lane in 0..POINT_BATCH {
                normals[lane] = OctNormal::from_steps([steps[0][lane], steps[1][lane]]);
            }
            (normals, usable)
        },
    )
}

/// Vectors scaled so that no sum of their components overflows, and the lanes where they have a
/// direction; the others are +z.
#[inline(always)]
fn direction<L: Lanes<Scalar = f64>>([x, y, z]: [L; 3]) -> ([L; 3], L::Mask) {
    let (zero, one) = (x.same(0.0), x.same(1.0));
    let largest = x.same(f64::MAX);
    let is_finite = x.abs().le(largest) & y.abs().le(largest) & z.abs().le(largest);
    let size = x.abs().max(y.abs()).max(z.abs());
    let usable = is_finite & size.gt(x.same(f64::MIN_POSITIVE / f64::EPSILON));
    let quarter = x.same(0.25);
    let scaled = [
        L::pick(usable, x * quarter, zero),
        L::pick(usable, y * quarter, zero),
        L::pick(usable, z * quarter, one),
    ];
    (scaled, usable)
}

/// The direction of a vector, or +z where it has none.
fn encode(v: DVec3) -> OctNormal {
    OctNormal::from_steps(OctNormal::steps(direction(v.to_array()).0))
}

/// Gives every voxel in `missing` the mean normal of those of its 26 neighbours that have one.
/// A cone's tip or a crossing of sheets has no gradient; its neighbours do.
pub(super) fn fill_missing(octree: &mut MortonOctree, missing: &[u32], lattice: &Lattice) {
    if missing.is_empty() {
        return;
    }
    let mut places = vec![[0; 3]; missing.len()];
    for part in octree.parts() {
        octree.visit(part, &mut |voxel| {
            if let Ok(i) = missing.binary_search(&voxel.rank) {
                places[i] = voxel.ijk;
            }
        });
    }
    let filled: Vec<OctNormal> = places
        .iter()
        .map(|&ijk| {
            let neighbours = neighbours_of(ijk, lattice.n_voxels());
            let ranks = neighbours.filter_map(|place| octree.find(place));
            let known = ranks.filter(|rank| missing.binary_search(rank).is_err());
            encode(known.map(|rank| octree.normal(rank).decode()).sum())
        })
        .collect();
    for (&rank, &normal) in missing.iter().zip(&filled) {
        octree.set_normal(rank, normal);
    }
}

/// The neighbours of a voxel inside the lattice, in a fixed order.
fn neighbours_of(ijk: [u32; 3], n_voxels: [u32; 3]) -> impl Iterator<Item = [u32; 3]> {
    (0..27_u32).filter(|&i| i != 13).filter_map(move |i| {
        let step = [i % 3, i / 3 % 3, i / 9];
        let place = [0, 1, 2].map(|axis| (ijk[axis] + step[axis]).checked_sub(1));
        let [Some(x), Some(y), Some(z)] = place else { return None };
        (x < n_voxels[0] && y < n_voxels[1] && z < n_voxels[2]).then_some([x, y, z])
    })
}
