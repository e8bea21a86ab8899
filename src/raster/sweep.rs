//! Cells to rays: each cell of a block is held against all rays that may pass through it, from front
//! to back.
//!
//! With bounds of F in a cell (`voxelize/cells.rs`) most is decided without evaluating F: along a
//! ray the lower bound is concave and the upper one convex, so that F has one sign where the bounds
//! at both ends of the ray's part in the cell say so; if they say that the signs differ, and F is
//! monotone along the ray, there is one root, and nothing behind it shows. What is left is looked at
//! by values at the ends of the part, and then as any part of a ray is; see `trace`.

use fearless_simd::{Simd, f64x8};
use glam::DVec3;

use super::{
    roots::Bracket,
    screen::{Footprint, Ray, Screen},
    sight::{RAYS, Rays, Sight},
    tile::Tile,
    trace::{Lane, Outcome, Quest, Tracer, outcome},
    walk::Span,
};
use crate::{
    eval::{POINT_BATCH, Points},
    expr::Tape,
    math::{Lanes, Mask},
    voxelize::CellBounds,
};

/// A cell, from the eye.
#[derive(Clone, Copy, Debug)]
pub(super) struct SweptCell {
    /// Its first corner, and its last, a little beyond it.
    pub(super) lo: DVec3,
    pub(super) hi: DVec3,
    /// Bounds of F in it, with the middle from the eye, and roundings accounted for.
    pub(super) bounds: Option<CellBounds>,
    /// Whether the tape's region holds it.
    pub(super) in_region: bool,
}

/// What is held against the rays of a tile.
#[derive(Clone, Copy)]
pub(super) struct Swept<'a> {
    pub(super) tape: &'a Tape,
    pub(super) cells: &'a [SweptCell],
    pub(super) screen: &'a Screen,
    /// Rays begin here.
    pub(super) near: f64,
}

/// Where a ray meets the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sighting {
    /// The ray's place.
    pub(super) place: usize,
    pub(super) depth: f64,
}

/// A part of a ray that may meet the surface, as far as its cell tells.
#[derive(Clone, Copy)]
struct Doubt {
    place: usize,
    span: Span,
    /// Bounds of the slope along the ray, if there are any.
    slope: Option<[f64; 2]>,
    in_region: bool,
}

/// What bounds leave of the rays through some cells.
#[derive(Default)]
struct Left {
    brackets: Vec<Bracket>,
    doubts: Vec<Doubt>,
}

/// So many doubts are looked at together.
const DOUBTS: usize = 256;

impl<S: Simd> Tracer<S> {
    /// Finds the nearest meeting of each ray with the surface in the cells.
    pub(super) fn sweep_cells(
        &mut self,
        swept: &Swept<'_>,
        sight: &mut Sight,
        sightings: &mut Vec<Sighting>,
    ) {
        let mut left = Left::default();
        let mut rest = swept.cells;
        while !rest.is_empty() {
            let n = bound_rays(self.simd, swept, rest, sight, &mut left);
            rest = &rest[n..];
            self.look_at_ends(swept, sight, &mut left, sightings);
        }
        self.find_brackets(swept, sight, &left.brackets, sightings);
    }

    /// Tells what values at both ends of parts tell, and looks closer at those which that leaves.
    fn look_at_ends(
        &mut self,
        swept: &Swept<'_>,
        sight: &mut Sight,
        left: &mut Left,
        sightings: &mut Vec<Sighting>,
    ) {
        let eye = swept.screen.eye;
        let Left { brackets, doubts } = left;
        doubts.retain(|doubt| doubt.span.from < sight.far(doubt.place));
        let mut quests: Vec<(Quest, Span)> = Vec::new();
        let mut quest = |ray: Ray, doubt: &Doubt| {
            let Doubt { place, span, .. } = *doubt;
            let farthest = f64::INFINITY;
            quests.push((Quest { sample: place as u32, ray, from: span.from, farthest }, span));
        };
        for some in doubts.chunks(POINT_BATCH / 2) {
            let mut ends: Points = [[0.0; POINT_BATCH]; 3];
            for (k, doubt) in some.iter().enumerate() {
                let ray = sight.ray(doubt.place);
                for (end, depth) in [doubt.span.from, doubt.span.to].into_iter().enumerate() {
                    let p = eye + ray.at(depth);
                    (0..3).for_each(|axis| ends[axis][2 * k + end] = p[axis]);
                }
            }
            let values = self.points.eval(swept.tape, &ends);
            for (k, doubt) in some.iter().enumerate() {
                let Doubt { place, span, slope, in_region } = *doubt;
                let values = [values[2 * k], values[2 * k + 1]];
                let ray = sight.ray(place);
                let found = slope.map_or(Outcome::Open, |slope| {
                    outcome(values, slope, span.to - span.from, true)
                });
                match found {
                    Outcome::Miss => {}
                    Outcome::Root => {
                        if in_region {
                            sight.block(place, span.to);
                        }
                        brackets.push(Bracket { id: place, ray, span, values, in_region });
                    }
                    Outcome::Open => quest(ray, doubt),
                }
            }
        }
        doubts.clear();
        let mut rest = quests.iter().map(|&(quest, span)| Lane::of_part(quest, span));
        let mut meetings = Vec::new();
        self.follow(swept.tape, eye, &mut || rest.next(), &mut meetings);
        for meeting in meetings {
            let place = meeting.sample as usize;
            if sight.meet(place, meeting.depth) {
                sightings.push(Sighting { place, depth: meeting.depth });
            }
        }
    }

    fn find_brackets(
        &mut self,
        swept: &Swept<'_>,
        sight: &mut Sight,
        brackets: &[Bracket],
        sightings: &mut Vec<Sighting>,
    ) {
        let eye = swept.screen.eye;
        self.find_roots(swept.tape, eye, brackets, &mut |place, depth| {
            if sight.meet(place, depth) {
                sightings.push(Sighting { place, depth });
            }
        });
    }
}

/// Holds cells against rays until all are done or there are enough doubts; how many cells were.
#[inline(never)]
fn bound_rays<S: Simd>(
    simd: S,
    swept: &Swept<'_>,
    cells: &[SweptCell],
    sight: &mut Sight,
    left: &mut Left,
) -> usize {
    simd.vectorize(
        #[inline(always)]
        || {
            for (number, cell) in cells.iter().enumerate() {
                if left.doubts.len() >= DOUBTS {
                    return number;
                }
                let (center, half) = (0.5 * (cell.lo + cell.hi), 0.5 * (cell.hi - cell.lo));
                let extent = swept.screen.extent(half);
                let footprint = swept.screen.footprint(center, extent, swept.near);
                let Some(Footprint { columns, rows, nearest, .. }) = footprint else { continue };
                let touched = Tile { columns, rows };
                let Some(Tile { columns, rows }) = touched.intersection(&sight.tile) else {
                    continue;
                };
                for row in rows {
                    let mut column = columns.start;
                    while column < columns.end {
                        let place = sight.place(column, row);
                        bound_some(simd, cell, swept.near, nearest, place, sight, left);
                        column += RAYS;
                    }
                }
            }
            cells.len()
        },
    )
}

/// Holds a cell against the rays from `place` on.
#[inline(always)]
fn bound_some<S: Simd>(
    simd: S,
    cell: &SweptCell,
    near: f64,
    nearest: f64,
    place: usize,
    sight: &mut Sight,
    left: &mut Left,
) {
    let rays = sight.rays(simd, place);
    let Rays { origin, direction, inverse, far } = rays;
    let zero = f64x8::splat(simd, 0.0);
    if zero.same(nearest).lt(far).bits() == 0 {
        return;
    }
    let (mut from, mut to) = (zero.same(near), far.same(f64::INFINITY));
    for axis in 0..3 {
        let first = (zero.same(cell.lo[axis]) - origin[axis]) * inverse[axis];
        let last = (zero.same(cell.hi[axis]) - origin[axis]) * inverse[axis];
        from = from.max(first.min(last));
        to = to.min(first.max(last));
    }
    let inside = from.le(to) & from.lt(far);
    let mut bits = inside.bits();
    if bits == 0 {
        return;
    }
    let mut ends = [[0.0; RAYS]; 2];
    from.store(&mut ends[0]);
    to.store(&mut ends[1]);
    let span = |lane: usize| Span { from: ends[0][lane], to: ends[1][lane] };
    let Some(bounds) = &cell.bounds else {
        while bits != 0 {
            let lane = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let (place, span) = (place + lane, span(lane));
            left.doubts.push(Doubt { place, span, slope: None, in_region: cell.in_region });
        }
        return;
    };
    let [value_lo, value_hi] = bounds.value.map(|v| zero.same(v));
    let (mut f_lo, mut f_hi, mut g_lo, mut g_hi) = (value_lo, value_hi, value_lo, value_hi);
    let (mut falls, mut rises) = (zero, zero);
    for axis in 0..3 {
        let [lo, hi] = bounds.slopes[axis].map(|v| zero.same(v));
        let first = origin[axis] - zero.same(bounds.middle[axis]);
        let x = first + from * direction[axis];
        let (a, b) = (x * lo, x * hi);
        f_lo += a.min(b);
        f_hi += a.max(b);
        let x = first + to * direction[axis];
        let (a, b) = (x * lo, x * hi);
        g_lo += a.min(b);
        g_hi += a.max(b);
        let (a, b) = (direction[axis] * lo, direction[axis] * hi);
        falls += a.min(b);
        rises += a.max(b);
    }
    let positive = zero.lt(f_lo) & zero.lt(g_lo);
    let negative = f_hi.lt(zero) & g_hi.lt(zero);
    let is_left = inside & !(positive | negative);
    bits = is_left.bits();
    if bits == 0 {
        return;
    }
    let is_monotone = zero.le(falls) | rises.le(zero);
    let crosses = (zero.lt(f_lo) & g_hi.lt(zero)) | (f_hi.lt(zero) & zero.lt(g_lo));
    let certain = (is_left & is_monotone & crosses).bits();
    let mut values = [[0.0; RAYS]; 4];
    let half = zero.same(0.5);
    ((f_lo + f_hi) * half).store(&mut values[0]);
    ((g_lo + g_hi) * half).store(&mut values[1]);
    falls.store(&mut values[2]);
    rises.store(&mut values[3]);
    while bits != 0 {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits - 1;
        let (place, span, in_region) = (place + lane, span(lane), cell.in_region);
        if certain >> lane & 1 == 1 {
            if in_region {
                sight.block(place, span.to);
            }
            let (ray, values) = (sight.ray(place), [values[0][lane], values[1][lane]]);
            left.brackets.push(Bracket { id: place, ray, span, values, in_region });
        } else {
            let slope = Some([values[2][lane], values[3][lane]]);
            left.doubts.push(Doubt { place, span, slope, in_region });
        }
    }
}
