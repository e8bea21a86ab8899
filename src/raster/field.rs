//! Solids that are given by values on a grid, and the cells between its points that their surface
//! passes through.
//!
//! Point i stands at i + ½ along each axis, so that N points fill the box from 0 to N. Cell i lies
//! between the points i − 1 and i; what would be before the first point or behind the last is like that,
//! so that the first and the last cell are half as wide. In a cell values are interpolated along all three
//! axes at once.

use std::{array, fmt};

use glam::{DAffine3, DVec3};
use rayon::prelude::*;

use super::{Content, Material, fit::fold_reach};
use crate::math::Aabb;

/// Cells along an edge of a chunk.
pub(super) const CHUNK: usize = 8;
/// Points along an edge of a chunk.
pub(super) const POINTS: usize = CHUNK + 1;

/// Values on a grid; 0 and above is inside.
pub trait Field: fmt::Debug + Send + Sync {
    /// Points along each axis.
    fn size(&self) -> [u32; 3];

    /// From the box of the grid to the scene; it is invertible.
    fn placing(&self) -> DAffine3;

    /// Whether what lies beyond the box is outside, so that faces of the box close a solid.
    fn is_capped(&self) -> bool;

    /// The bricks of 8³ points, counted from 0, in which a point is not on the side of another that it
    /// shares a cell with, or is inside at a border that is capped. There may be more of them, but not
    /// twice the same.
    fn bricks(&self) -> Vec<[u32; 3]>;

    /// The values at the points from `first` to before `end`, x fastest; [`f32::MIN`] stands for none,
    /// which is outside.
    fn values(&self, first: [u32; 3], end: [u32; 3]) -> Vec<f32>;

    /// Values of which normals are made: those before anything was joined.
    fn original_values(&self, first: [u32; 3], end: [u32; 3]) -> Vec<f32> {
        self.values(first, end)
    }
}

/// A solid and how it looks.
#[derive(Debug)]
pub struct Solid<'a> {
    pub(super) field: &'a dyn Field,
    pub(super) material: Material,
    pub(super) chunks: Vec<Chunk>,
}

/// 8³ cells, of which some show a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chunk {
    /// In chunks from the first one.
    pub(super) place: [u32; 3],
    /// Bit x + 8y of slice z: the cell may show a surface.
    pub(super) shown: [u64; CHUNK],
    /// The first of these cells along each axis, and behind the last one.
    pub(super) first: [u8; 3],
    pub(super) end: [u8; 3],
}

impl<'a> Solid<'a> {
    /// Finds where the surface of `field` is.
    #[must_use]
    pub fn new(field: &'a dyn Field, material: Material) -> Self {
        let mut places: Vec<[u32; 3]> = field.bricks();
        places.extend(behind_the_last(&places, field.size()));
        places.par_sort_unstable_by_key(|&[x, y, z]| [z, y, x]);
        places.dedup();
        let chunk = |place| {
            let shown = shown(field, place, &Block::read(field, place));
            (shown != [0; CHUNK]).then(|| Chunk::new(place, shown))
        };
        let chunks = places.into_par_iter().filter_map(chunk).collect();
        Self { field, material, chunks }
    }

    /// The corners of the grid's box, in the scene.
    pub(super) fn corners(&self) -> impl Iterator<Item = DVec3> {
        let size = DVec3::from_array(self.field.size().map(f64::from));
        let placing = self.field.placing();
        (0..8).map(move |c| {
            let sides = [c & 1, c >> 1 & 1, c >> 2].map(f64::from);
            placing.transform_point3(size * DVec3::from_array(sides))
        })
    }

    /// The box around the surface, if there is one.
    pub fn bounds(&self) -> Option<Aabb> {
        let [x1, y1, z1, x0, y0, z0] =
            self.reach([DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z]);
        let (min, max) = (DVec3::new(-x0, -y0, -z0), DVec3::new(x1, y1, z1));
        (!self.is_empty()).then_some(Aabb { min, max })
    }

    /// Whether there is no surface.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.chunks.is_empty()
    }
}

/// Half cells behind the last points are in chunks of their own, if bricks of points are full.
fn behind_the_last(bricks: &[[u32; 3]], size: [u32; 3]) -> Vec<[u32; 3]> {
    let is_last = |brick: &[u32; 3], axis: usize| (brick[axis] + 1) * CHUNK as u32 == size[axis];
    let behind = |brick: &[u32; 3], steps: u32| {
        let takes = |axis: usize| steps >> axis & 1 == 1;
        (0..3)
            .all(|axis| !takes(axis) || is_last(brick, axis))
            .then(|| array::from_fn(|axis| brick[axis] + u32::from(takes(axis))))
    };
    bricks.iter().flat_map(|brick| (1..8).filter_map(move |steps| behind(brick, steps))).collect()
}

/// The values at the points of a chunk.
pub(super) struct Block {
    values: Vec<f32>,
}

impl Block {
    /// Of the chunk at a place.
    pub(super) fn read(field: &dyn Field, place: [u32; 3]) -> Self {
        let mut values = spread(field, place, 0, |first, end| field.values(first, end));
        // What has no value is as far outside as anything here, so that it leaves its neighbours' digits.
        let largest =
            values.iter().filter(|v| v.abs() < f32::MAX).fold(0.0_f32, |a, v| a.max(v.abs()));
        let usual = if largest > 0.0 { largest } else { 1.0 };
        for value in &mut values {
            *value = value.clamp(-usual, usual);
            if *value == 0.0 && value.is_sign_negative() {
                *value = -f32::MIN_POSITIVE;
            }
        }
        Self { values }
    }

    /// The values at the corners, x + 2y + 4z, of a cell.
    #[inline]
    pub(super) fn corners(&self, [x, y, z]: [usize; 3]) -> [f64; 8] {
        array::from_fn(|c| {
            let at = (x + (c & 1)) + POINTS * ((y + (c >> 1 & 1)) + POINTS * (z + (c >> 2)));
            f64::from(self.values[at])
        })
    }
}

/// The slopes at the points of a chunk, by differences between the points around; one-sided at the
/// border. They point inwards.
pub(super) struct Slopes {
    values: Vec<f32>,
    place: [u32; 3],
    size: [u32; 3],
}

impl Slopes {
    /// Of the chunk at a place.
    pub(super) fn read(field: &dyn Field, place: [u32; 3]) -> Self {
        let values = spread(field, place, 1, |first, end| field.original_values(first, end));
        Self { values, place, size: field.size() }
    }

    /// The slopes at a place in the chunk, between those at the points around.
    pub(super) fn at(&self, p: DVec3) -> DVec3 {
        let cell = p.to_array().map(|i| (i as usize).min(CHUNK - 1));
        let mut sum = DVec3::ZERO;
        for c in 0..8 {
            let step = [c & 1, c >> 1 & 1, c >> 2];
            let weight: f64 = (0..3)
                .map(|axis| {
                    let part = p[axis] - cell[axis] as f64;
                    if step[axis] == 1 { part } else { 1.0 - part }
                })
                .product();
            sum += weight * self.of_point([0, 1, 2].map(|axis| cell[axis] + step[axis]));
        }
        sum
    }

    fn of_point(&self, point: [usize; 3]) -> DVec3 {
        const WIDTH: usize = POINTS + 2;
        const STEPS: [usize; 3] = [1, WIDTH, WIDTH * WIDTH];
        let first = |axis: usize| i64::from(self.place[axis]) * CHUNK as i64 - 1;
        let last = |axis: usize| i64::from(self.size[axis]) - 1;
        // What is like a point has its slopes.
        let i: [i64; 3] =
            array::from_fn(|axis| (first(axis) + point[axis] as i64).clamp(0, last(axis)));
        let here: usize =
            (0..3).map(|axis| (i[axis] - first(axis) + 1) as usize * STEPS[axis]).sum();
        let along = |axis: usize| {
            let n = i64::from(i[axis] > 0) + i64::from(i[axis] < last(axis));
            let [before, behind] = [here - STEPS[axis], here + STEPS[axis]];
            let rise = f64::from(self.values[behind]) - f64::from(self.values[before]);
            if n == 0 { 0.0 } else { rise / n as f64 }
        };
        DVec3::new(along(0), along(1), along(2))
    }
}

/// The values at the points of a chunk and as many more as `margin` says on every side, x fastest.
fn spread(
    field: &dyn Field,
    place: [u32; 3],
    margin: usize,
    values: impl Fn([u32; 3], [u32; 3]) -> Vec<f32>,
) -> Vec<f32> {
    let n = POINTS + 2 * margin;
    let size = field.size();
    let like = |axis: usize, i: usize| {
        let at = i64::from(place[axis]) * CHUNK as i64 + i as i64 - 1 - margin as i64;
        at.clamp(0, i64::from(size[axis]) - 1) as u32
    };
    let (first, last) =
        ([0, 1, 2].map(|axis| like(axis, 0)), [0, 1, 2].map(|axis| like(axis, n - 1)));
    let own = values(first, last.map(|i| i + 1));
    let width = [0, 1].map(|axis| (last[axis] - first[axis] + 1) as usize);
    let from = |axis: usize| -> Vec<usize> {
        (0..n).map(|i| (like(axis, i) - first[axis]) as usize).collect()
    };
    let (xs, ys, zs) = (from(0), from(1), from(2));
    let mut all = Vec::with_capacity(n * n * n);
    for &z in &zs {
        for &y in &ys {
            let row = width[0] * (y + width[1] * z);
            all.extend(xs.iter().map(|&x| own[row + x]));
        }
    }
    all
}

/// Which cells of a chunk may show a surface.
fn shown(field: &dyn Field, place: [u32; 3], block: &Block) -> [u64; CHUNK] {
    let size = field.size();
    let mut shown = [0; CHUNK];
    for i in 0..CHUNK * CHUNK * CHUNK {
        let cell = [i % CHUNK, i / CHUNK % CHUNK, i / (CHUNK * CHUNK)];
        let at = |axis: usize| place[axis] * CHUNK as u32 + cell[axis] as u32;
        if (0..3).any(|axis| at(axis) > size[axis]) {
            continue;
        }
        let n_inside = block.corners(cell).iter().filter(|&&value| value >= 0.0).count();
        let is_closed =
            field.is_capped() && (0..3).any(|axis| at(axis) == 0 || at(axis) == size[axis]);
        if n_inside > 0 && (n_inside < 8 || is_closed) {
            shown[cell[2]] |= 1 << (cell[0] + CHUNK * cell[1]);
        }
    }
    shown
}

impl Content for Solid<'_> {
    fn reach<const N: usize>(&self, directions: [DVec3; N]) -> [f64; N] {
        let placing = self.field.placing();
        let size = DVec3::from_array(self.field.size().map(f64::from));
        // The same directions, as the grid has them.
        let turned = directions.map(|d| placing.matrix3.transpose() * d);
        let start = directions.map(|d| d.dot(placing.translation));
        let of_chunk = |chunk: &Chunk| {
            let cells = chunk.cells().map(|cell| {
                let first = (DVec3::from_array(cell.map(f64::from)) - 0.5).max(DVec3::ZERO);
                let last = (DVec3::from_array(cell.map(f64::from)) + 0.5).min(size);
                array::from_fn(|k| {
                    let (d, of_last) = (turned[k], turned[k].cmpgt(DVec3::ZERO));
                    start[k] + d.dot(DVec3::select(of_last, last, first))
                })
            });
            fold_reach(cells)
        };
        let all: Vec<[f64; N]> = self.chunks.par_iter().map(of_chunk).collect();
        fold_reach(all)
    }
}

impl Chunk {
    /// With at least one cell that is shown.
    fn new(place: [u32; 3], shown: [u64; CHUNK]) -> Self {
        // Of all slices together, a bit for each column and each row.
        let slices = shown.iter().fold(0, |all, slice| all | slice);
        let bytes = slices.to_le_bytes();
        let bits = |is: &dyn Fn(usize) -> bool| {
            (0..CHUNK).fold(0_u8, |bits, i| bits | u8::from(is(i)) << i)
        };
        let along = [
            bytes.iter().fold(0, |all, row| all | row),
            bits(&|y| bytes[y] != 0),
            bits(&|z| shown[z] != 0),
        ];
        let first = along.map(|bits| bits.trailing_zeros() as u8);
        let end = along.map(|bits| CHUNK as u8 - bits.leading_zeros() as u8);
        Self { place, shown, first, end }
    }

    /// The box around the cells that may show a surface, in the grid's box of a size.
    pub(super) fn bounds(&self, size: [u32; 3]) -> [DVec3; 2] {
        let corner = |cell: [u8; 3]| {
            let at =
                |axis: usize| f64::from(self.place[axis]) * CHUNK as f64 + f64::from(cell[axis]);
            // Cell i begins at i − ½.
            DVec3::new(at(0), at(1), at(2)) - 0.5
        };
        let size = DVec3::from_array(size.map(f64::from));
        [corner(self.first).max(DVec3::ZERO), corner(self.end).min(size)]
    }

    /// The cells that may show a surface, counted from the first of all.
    fn cells(&self) -> impl Iterator<Item = [u32; 3]> {
        let first = self.place.map(|i| i * CHUNK as u32);
        (0..CHUNK).flat_map(move |z| {
            let slice = self.shown[z];
            (0..64_u32).filter(move |i| slice >> i & 1 == 1).map(move |i| {
                let cell = [i % 8, i / 8, z as u32];
                array::from_fn(|axis| first[axis] + cell[axis])
            })
        })
    }
}
