//! What one value and one gradient tell of all voxels of a cube.
//!
//! With the slopes of F over a cube, S, and its value in the middle, F(m), every point x of the cube
//! has
//!
//! F(m) + Σ min(S·(x − m)) <= F(x) <= F(m) + Σ max(S·(x − m)),
//!
//! a sum over the axes, so that bounds over the cube's voxels and at their corners need no
//! evaluation: only three additions each. The less F bends in the cube, the fewer voxels they
//! leave open.
//!
//! *Based on:* R. Moore, "Interval Analysis", 1966, section 6.3 (mean value form). That its terms
//! can be shared among the parts of a box was not found in print.

use fearless_simd::Simd;

use super::brick::{of_octant, offset};
use crate::{
    eval::{BATCH, Boxes, Ranges},
    math::{Lanes, Lattice, Scalar},
};

/// What is proven of the voxels of a cube, a bit each in Morton order.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct VoxelVerdict {
    /// F > 0.
    pub(super) empty: u64,
    /// F < 0.
    pub(super) inside: u64,
    /// F < 0 at a corner.
    pub(super) negative: u64,
    /// F > 0 at a corner.
    pub(super) positive: u64,
}

impl VoxelVerdict {
    /// The same for a brick of which the cube is octant `c`.
    pub(super) fn of_octant(self, c: u32) -> Self {
        Self {
            empty: of_octant(self.empty, c),
            inside: of_octant(self.inside, c),
            negative: of_octant(self.negative, c),
            positive: of_octant(self.positive, c),
        }
    }
}

/// Whether bounds have paid so far: where F has kinks everywhere they tell nothing, and there is
/// no use in asking on.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Record {
    n_asked: u32,
    n_told: u32,
}

impl Record {
    /// As many as this must be asked before anything is said.
    const ENOUGH: u32 = 64;

    /// Notes whether a cube's bounds told anything.
    pub(super) fn note(&mut self, told: bool) {
        self.n_asked += 1;
        self.n_told += u32::from(told);
    }

    /// Whether one in eight has told something.
    pub(super) fn pays(&self) -> bool {
        self.n_asked < Self::ENOUGH || self.n_told >= self.n_asked / 8
    }
}

/// Finds what affine bounds tell, with vectors of type L.
pub(super) struct AffineBounds<L: Lanes> {
    token: L::Token,
    voxel_size: L::Scalar,
    /// What all roundings together take at most, relative to the sum of all terms.
    rounding: L::Scalar,
    /// And where numbers are so small that they lose digits.
    underflow: L::Scalar,
}

/// Bounds over the slabs of an axis, each a voxel thick.
#[derive(Clone, Copy)]
struct Slabs<L, const EDGE: usize> {
    /// The least and the largest of the lower bounds on both planes of each slab.
    least_lower: [L; EDGE],
    most_lower: [L; EDGE],
    /// The same of the upper bounds.
    least_upper: [L; EDGE],
    most_upper: [L; EDGE],
}

impl<L: Lanes, const EDGE: usize> Slabs<L, EDGE> {
    /// For a slope between `lo` and `hi` a voxel.
    #[inline(always)]
    fn new(lo: L, hi: L) -> Self {
        let none = [lo; EDGE];
        let mut slabs =
            Self { least_lower: none, most_lower: none, least_upper: none, most_upper: none };
        for i in 0..EDGE {
            let first = lo.same(i as f64 - (EDGE / 2) as f64);
            let last = first + lo.same(1.0);
            let (a, b) = (lo * first, hi * first);
            let (c, d) = (lo * last, hi * last);
            let [lower_first, lower_last] = [a.min(b), c.min(d)];
            let [upper_first, upper_last] = [a.max(b), c.max(d)];
            slabs.least_lower[i] = lower_first.min(lower_last);
            slabs.most_lower[i] = lower_first.max(lower_last);
            slabs.least_upper[i] = upper_first.min(upper_last);
            slabs.most_upper[i] = upper_first.max(upper_last);
        }
        slabs
    }
}

/// Voxels whose bits fit into the fraction of an f32.
const GROUP: usize = 16;

impl<S: Simd, L: Lanes<Token = S>> AffineBounds<L> {
    pub(super) fn new(token: S, lattice: &Lattice) -> Self {
        let bounds = lattice.bounds();
        let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
        let voxel_size = lattice.voxel_size();
        // Slopes are multiplied by a rounded edge, and that is rounded: 2 u. Sums have four terms,
        // and this bound is one more: 4 u. A corner of the lattice is off by no more than two
        // roundings, of a number not above twice `farthest`, and so is the middle.
        let of_corners = 16.0 * f64::EPSILON * (farthest / voxel_size).max(1.0);
        let rounding = 16.0 * L::Scalar::UNIT + of_corners;
        Self {
            token,
            voxel_size: L::Scalar::nearest(voxel_size),
            rounding: L::Scalar::above(rounding),
            underflow: L::Scalar::above(16.0 * L::Scalar::MIN_NORMAL),
        }
    }

    /// What the values `middles` in the middle of `n` cubes of EDGE³ voxels, at corners of the
    /// lattice, and the slopes over them tell. The cubes lie in the lattice, and F is continuous in
    /// them.
    #[inline(never)]
    pub(super) fn tell<const EDGE: usize>(
        &self,
        middles: &Ranges<L::Scalar>,
        slopes: &Boxes<L::Scalar>,
        n: usize,
    ) -> [VoxelVerdict; BATCH] {
        let Self { token, .. } = *self;
        let mut verdicts = [VoxelVerdict::default(); BATCH];
        token.vectorize(
            #[inline(always)]
            || {
                let voxel_size = L::splat(token, self.voxel_size);
                let rounding = L::splat(token, self.rounding);
                for from in (0..n).step_by(L::LEN) {
                    let mut least = L::load(token, &middles.lo[from..]);
                    let mut most = L::load(token, &middles.hi[from..]);
                    let mut all = least.abs() + most.abs();
                    let mut axes = [Slabs::<L, EDGE>::new(least, most); 3];
                    for axis in 0..3 {
                        let lo = L::load(token, &slopes.lo[axis][from..]) * voxel_size;
                        let hi = L::load(token, &slopes.hi[axis][from..]) * voxel_size;
                        all = all + (lo.abs() + hi.abs()) * lo.same(EDGE as f64);
                        axes[axis] = Slabs::new(lo, hi);
                    }
                    // If anything is infinite this is, and no comparison below holds.
                    let margin = all * rounding + L::splat(token, self.underflow);
                    (least, most) = (least - margin, most + margin);
                    tell_groups(least, most, &axes, &mut verdicts[from..]);
                }
            },
        );
        verdicts
    }
}

/// Adds up the bounds for every voxel, and writes what they tell to the first `L::LEN` verdicts.
#[inline(always)]
fn tell_groups<L: Lanes, const EDGE: usize>(
    least: L,
    most: L,
    [x, y, z]: &[Slabs<L, EDGE>; 3],
    verdicts: &mut [VoxelVerdict],
) {
    let zero = least.same(0.0);
    let n_voxels = EDGE * EDGE * EDGE;
    for first in (0..n_voxels).step_by(GROUP) {
        // Sums of powers of two, one for each voxel that is meant.
        let [mut empty, mut inside, mut negative, mut positive] = [zero; 4];
        for i in 0..GROUP.min(n_voxels) {
            let [a, b, c] = offset((first + i) as u32).map(|step| step as usize);
            let least_lower = least + x.least_lower[a] + y.least_lower[b] + z.least_lower[c];
            let most_lower = least + x.most_lower[a] + y.most_lower[b] + z.most_lower[c];
            let least_upper = most + x.least_upper[a] + y.least_upper[b] + z.least_upper[c];
            let most_upper = most + x.most_upper[a] + y.most_upper[b] + z.most_upper[c];
            let bit = zero.same((1_u32 << i).into());
            empty = empty + L::pick(zero.lt(least_lower), bit, zero);
            inside = inside + L::pick(most_upper.lt(zero), bit, zero);
            negative = negative + L::pick(least_upper.lt(zero), bit, zero);
            positive = positive + L::pick(zero.lt(most_lower), bit, zero);
        }
        let mut bits = [[L::Scalar::default(); BATCH]; 4];
        empty.store(&mut bits[0]);
        inside.store(&mut bits[1]);
        negative.store(&mut bits[2]);
        positive.store(&mut bits[3]);
        for lane in 0..L::LEN {
            let of = |kind: usize| u64::from(bits[kind][lane].to_f64() as u32) << first;
            let verdict = &mut verdicts[lane];
            verdict.empty |= of(0);
            verdict.inside |= of(1);
            verdict.negative |= of(2);
            verdict.positive |= of(3);
        }
    }
}
