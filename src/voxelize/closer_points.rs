//! Values at points of voxels whose slopes are known: what the mean value form over the whole voxel
//! leaves open, it may decide over parts of it.
//!
//! The slopes of a voxel bound those of its parts. So a part needs no gradient of its own, only the
//! value in its middle: F departs from it by at most the slopes times the part's half width. Along
//! axes on which F is monotone nothing is cut: F is least on the *low* face of the voxel, or edge,
//! and largest on the *high* one, and only these are cut into parts.
//!
//! A voxel is empty if F > 0 on all parts of the low face, and inside if F < 0 on all parts of the
//! high one. If both signs were seen the surface passes through.
//!
//! *Based on:* R. Moore, "Interval Analysis", 1966, section 6.3 (mean value form over subdivisions).

use fearless_simd::Simd;

use super::{node::Finding, signs::Signs};
use crate::{
    eval::{BATCH, BoxEvaluator, Boxes},
    expr::Tape,
    math::{Lanes, Lattice, Scalar},
};

/// What is known of the gradient over a voxel in which F is continuous.
#[derive(Clone, Copy, Debug)]
pub(super) struct KnownSlopes {
    /// The axes along which F does not fall.
    pub(super) rising: [bool; 3],
    /// The axes along which F does not rise.
    pub(super) falling: [bool; 3],
    /// Bounds of the absolute slopes.
    pub(super) steepest: [f64; 3],
}

impl KnownSlopes {
    fn is_monotone(&self, axis: usize) -> bool {
        self.rising[axis] || self.falling[axis]
    }
}

/// How often a face is halved.
const MAX_HALVINGS: u32 = 3;

/// More parts than this of one face are not halved any more.
const MAX_PARTS: usize = 12;

/// The face of a voxel that a part belongs to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    /// Where F is least.
    Low,
    /// Where F is largest.
    High,
}

/// A part of a face of the voxel number `voxel`, counted along each axis in parts of its size; 0
/// along monotone axes.
#[derive(Clone, Copy)]
struct Part {
    voxel: usize,
    side: Side,
    at: [u32; 3],
}

/// What was seen of a voxel.
#[derive(Clone, Copy, Default)]
struct Seen {
    negative: bool,
    positive: bool,
}

/// What values at points tell of voxels, given their slopes and the signs at their corners.
pub(super) fn look_at_points<S: Simd, L: Lanes<Token = S>, const G: usize>(
    values: &mut BoxEvaluator<L, G>,
    lattice: &Lattice,
    tape: &Tape,
    voxels: &[([u32; 3], KnownSlopes, Signs)],
) -> Vec<Finding> {
    let mut findings = vec![Finding::Candidate; voxels.len()];
    let mut seen: Vec<Seen> = voxels
        .iter()
        .map(|(_, _, signs)| Seen {
            negative: signs.have(Signs::NEGATIVE),
            positive: signs.have(Signs::POSITIVE),
        })
        .collect();
    let whole = |voxel| [Side::Low, Side::High].map(|side| Part { voxel, side, at: [0; 3] });
    let mut parts: Vec<Part> = (0..voxels.len()).flat_map(whole).collect();
    let mut left: Vec<Part> = Vec::new();
    let mut boxes = Boxes::default();
    for halvings in 1..=MAX_HALVINGS {
        parts = halves(&parts, voxels, &seen);
        left.clear();
        for batch in parts.chunks(BATCH) {
            let mut spreads = [0.0; BATCH];
            for (lane, part) in batch.iter().enumerate() {
                let (ijk, slopes, _) = &voxels[part.voxel];
                spreads[lane] = write(&mut boxes, lane, part, halvings, lattice, *ijk, slopes);
            }
            let ranges = values.ranges(tape, &boxes, batch.len());
            for (lane, part) in batch.iter().enumerate() {
                let (lo, hi) = (ranges.lo[lane].to_f64(), ranges.hi[lane].to_f64());
                let seen = &mut seen[part.voxel];
                seen.negative |= hi < 0.0;
                seen.positive |= lo > 0.0;
                let is_decided = match part.side {
                    Side::Low => lo > spreads[lane],
                    Side::High => hi < -spreads[lane],
                };
                if !is_decided {
                    left.push(*part);
                }
            }
        }
        conclude(&mut findings, &seen, &parts, &left);
        left.retain(|part| findings[part.voxel] == Finding::Candidate);
        std::mem::swap(&mut parts, &mut left);
    }
    findings
}

/// The parts of half the size, of faces that may still tell something.
fn halves(parts: &[Part], voxels: &[([u32; 3], KnownSlopes, Signs)], seen: &[Seen]) -> Vec<Part> {
    let mut halves = Vec::new();
    for face in parts.chunk_by(|a, b| a.voxel == b.voxel && a.side == b.side) {
        let Part { voxel, side, .. } = face[0];
        // A face on which F has the other sign somewhere decides nothing any more.
        let is_hopeless = match side {
            Side::Low => seen[voxel].negative,
            Side::High => seen[voxel].positive,
        };
        if is_hopeless || face.len() > MAX_PARTS {
            continue;
        }
        let slopes = &voxels[voxel].1;
        let is_cut = |axis: usize| !slopes.is_monotone(axis);
        for part in face {
            for c in (0..8_u32).filter(|c| (0..3).all(|axis| c >> axis & 1 == 0 || is_cut(axis))) {
                let at = [0, 1, 2]
                    .map(|axis| if is_cut(axis) { 2 * part.at[axis] + (c >> axis & 1) } else { 0 });
                halves.push(Part { at, ..*part });
            }
        }
    }
    halves
}

/// Writes the middle of a part to one lane, and returns how far F may depart from its value there
/// on the part.
fn write<T: Scalar>(
    boxes: &mut Boxes<T>,
    lane: usize,
    part: &Part,
    halvings: u32,
    lattice: &Lattice,
    ijk: [u32; 3],
    slopes: &KnownSlopes,
) -> f64 {
    let mut spread = 0.0;
    for axis in 0..3 {
        let [lo, hi] = [0, 1].map(|end| lattice.corner(axis, ijk[axis] + end));
        let (below, above) = if slopes.is_monotone(axis) {
            let is_first = slopes.rising[axis] == (part.side == Side::Low);
            let end = if is_first { lo } else { hi };
            (T::below(end), T::above(end))
        } else {
            let n = f64::from(1_u32 << halvings);
            let bound = |i: u32| lo + (hi - lo) * (f64::from(i) / n);
            let (from, to) = (bound(part.at[axis]), bound(part.at[axis] + 1));
            let middle = T::nearest(0.5 * (from + to));
            let half = (to - middle.to_f64()).max(middle.to_f64() - from);
            // The last step covers the rounding of all of this, of the bounds above all.
            let rounding = f64::EPSILON * (lo.abs() + hi.abs());
            spread += slopes.steepest[axis] * (half + 4.0 * rounding);
            (middle, middle)
        };
        (boxes.lo[axis][lane], boxes.hi[axis][lane]) = (below, above);
    }
    spread * (1.0 + 16.0 * f64::EPSILON)
}

/// Decides the voxels of `parts` by what was seen, and by which of their parts are left.
fn conclude(findings: &mut [Finding], seen: &[Seen], parts: &[Part], left: &[Part]) {
    let mut left = left.chunk_by(|a, b| a.voxel == b.voxel && a.side == b.side).peekable();
    for face in parts.chunk_by(|a, b| a.voxel == b.voxel && a.side == b.side) {
        let Part { voxel, side, .. } = face[0];
        let is_left = left.next_if(|part| part[0].voxel == voxel && part[0].side == side).is_some();
        if seen[voxel].negative && seen[voxel].positive {
            findings[voxel] = Finding::Certified;
        } else if !is_left {
            findings[voxel] = if side == Side::Low { Finding::Empty } else { Finding::Inside };
        }
    }
}
