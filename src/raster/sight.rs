//! The rays of a tile, side by side, and how far each still looks.

use fearless_simd::{Simd, f64x8};
use glam::DVec3;

use super::{
    screen::{Ray, Screen},
    tile::Tile,
};
use crate::math::Lanes;

/// Rays that are looked at together.
pub(super) const RAYS: usize = 8;

/// Stands for the inverse of 0: what lies on either side of such a ray is infinitely far along it.
const FLAT: f64 = 1e300;

/// The rays of a tile. Each has a place: rows are followed by a few rays that look nowhere, so that
/// [`RAYS`] of them can be loaded anywhere.
#[derive(Default)]
pub(super) struct Sight {
    pub(super) tile: Tile,
    stride: usize,
    /// What all rays have in common: their direction, with parallel rays.
    common: Option<DVec3>,
    /// A ray's varying vector is that of its column and that of its row; see [`Screen`].
    columns: [Vec<f64>; 3],
    rows: Vec<DVec3>,
    /// Inverse directions; one row of them where all rows are the same.
    inverse: [Vec<f64>; 3],
    /// No ray looks farther than this.
    far: Vec<f64>,
    /// The depth at which a ray meets what was found so far.
    met: Vec<f64>,
}

/// Some rays, axis by axis.
#[derive(Clone, Copy)]
pub(super) struct Rays<S: Simd> {
    pub(super) origin: [f64x8<S>; 3],
    pub(super) direction: [f64x8<S>; 3],
    pub(super) inverse: [f64x8<S>; 3],
    pub(super) far: f64x8<S>,
}

impl Sight {
    /// Goes on to the rays of another tile, which have met nothing yet.
    pub(super) fn enter(&mut self, screen: &Screen, tile: &Tile) {
        let (width, height) = (tile.columns.len(), tile.rows.len());
        let (columns, rows) = screen.vectors(tile);
        self.tile = tile.clone();
        self.stride = width + RAYS;
        self.common = screen.is_parallel.then_some(screen.forward);
        self.rows.clear();
        self.rows.extend_from_slice(rows);
        let invert = |d: f64| if d.abs() < 1.0 / FLAT { FLAT } else { 1.0 / d };
        for axis in 0..3 {
            let (of_columns, inverse) = (&mut self.columns[axis], &mut self.inverse[axis]);
            of_columns.clear();
            of_columns.extend(columns.iter().map(|column| column[axis]));
            of_columns.resize(self.stride, 0.0);
            inverse.clear();
            match self.common {
                Some(direction) => inverse.resize(self.stride, invert(direction[axis])),
                None => {
                    for row in rows {
                        let row = row[axis];
                        inverse.extend(of_columns.iter().map(|&column| invert(column + row)));
                    }
                }
            }
        }
        self.far.clear();
        self.far.resize(self.stride * height, f64::NEG_INFINITY);
        for row in self.far.chunks_mut(self.stride) {
            row[..width].fill(f64::INFINITY);
        }
        self.met.clear();
        self.met.resize(self.stride * height, f64::INFINITY);
    }

    /// The place of a sample of the screen.
    #[inline(always)]
    pub(super) fn place(&self, column: usize, row: usize) -> usize {
        (row - self.tile.rows.start) * self.stride + (column - self.tile.columns.start)
    }

    /// The ray at a place.
    pub(super) fn ray(&self, place: usize) -> Ray {
        let (column, row) = (place % self.stride, place / self.stride);
        let varying = DVec3::from_array([0, 1, 2].map(|axis| self.columns[axis][column]));
        let varying = varying + self.rows[row];
        match self.common {
            Some(direction) => Ray { origin: varying, direction },
            None => Ray { origin: DVec3::ZERO, direction: varying },
        }
    }

    /// The number in the tile of the sample at a place.
    pub(super) fn sample(&self, place: usize) -> usize {
        place / self.stride * self.tile.columns.len() + place % self.stride
    }

    /// The rays from a place on.
    #[inline(always)]
    pub(super) fn rays<S: Simd>(&self, simd: S, place: usize) -> Rays<S> {
        let (column, row) = (place % self.stride, place / self.stride);
        let zero = f64x8::splat(simd, 0.0);
        let (mut origin, mut direction, mut inverse) = ([zero; 3], [zero; 3], [zero; 3]);
        let of_inverse = if self.common.is_some() { column } else { place };
        for axis in 0..3 {
            let of_column = f64x8::load(simd, &self.columns[axis][column..]);
            let varying = of_column + f64x8::splat(simd, self.rows[row][axis]);
            match self.common {
                Some(common) => {
                    origin[axis] = varying;
                    direction[axis] = f64x8::splat(simd, common[axis]);
                }
                None => direction[axis] = varying,
            }
            inverse[axis] = f64x8::load(simd, &self.inverse[axis][of_inverse..]);
        }
        let far = f64x8::load(simd, &self.far[place..]);
        Rays { origin, direction, inverse, far }
    }

    /// How far the ray at a place looks.
    #[inline(always)]
    pub(super) fn far(&self, place: usize) -> f64 {
        self.far[place]
    }

    /// The ray at a place certainly meets something at this depth or before.
    #[inline(always)]
    pub(super) fn block(&mut self, place: usize, depth: f64) {
        let far = &mut self.far[place];
        *far = if depth < *far { depth } else { *far };
    }

    /// The ray at a place meets the surface at a depth; whether that is the nearest so far.
    pub(super) fn meet(&mut self, place: usize, depth: f64) -> bool {
        self.block(place, depth);
        let is_nearest = depth < self.met[place];
        if is_nearest {
            self.met[place] = depth;
        }
        is_nearest
    }

    /// The depth at which the ray at a place meets what was found so far.
    pub(super) fn met(&self, place: usize) -> f64 {
        self.met[place]
    }

    /// Whether some ray in `part` looks as far as `depth`.
    pub(super) fn sees(&self, part: &Tile, depth: f64) -> bool {
        part.rows.clone().any(|row| {
            let first = self.place(part.columns.start, row);
            self.far[first..first + part.columns.len()].iter().any(|&far| far > depth)
        })
    }
}
