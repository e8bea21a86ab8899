//! The samples of one picture: their rays, and which of them a box may touch.
//!
//! All positions here are relative to the eye, where precision is needed most.

use std::ops::Range;

use glam::DVec3;

use super::{Camera, tile::Tile};

/// Samples along an edge of a tile, at most.
const TILE: usize = 64;

/// Pixels that a box may touch lie within this many pixels of its projection. Generous: it covers
/// rounding, and the pixels that it adds fail the exact test.
const SLACK_PX: f64 = 1e-6;

/// The same where rays may pass between pixel centres.
const BETWEEN_PX: f64 = 1.0;

/// A camera with a grid of pixels before it.
pub(super) struct Screen {
    /// Samples along an edge of a pixel.
    pub(super) samples: usize,
    /// In samples.
    pub(super) width: usize,
    /// In samples.
    pub(super) height: usize,
    /// Samples along an edge of a tile: of whole pixels.
    pub(super) tile_edge: usize,
    pub(super) eye: DVec3,
    pub(super) right: DVec3,
    pub(super) up: DVec3,
    pub(super) forward: DVec3,
    pub(super) is_parallel: bool,
    /// No ray starts farther from the eye than this on any axis.
    pub(super) radius: f64,
    /// A ray's varying vector is `columns[i] + rows[j]`: its direction in perspective, its origin
    /// in parallel projection.
    columns: Vec<DVec3>,
    rows: Vec<DVec3>,
    /// Dotted with a point: pixels to the right of the middle (times depth, in perspective).
    across: DVec3,
    /// Dotted with a point: pixels below the middle (times depth, in perspective).
    down: DVec3,
    /// The middle of the picture, counted in pixel centres.
    middle: [f64; 2],
    /// What a box may touch lies within this many pixels of its projection.
    slack: f64,
}

/// The centre ray of a pixel: `origin + t * direction`, relative to the eye.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    pub(super) origin: DVec3,
    pub(super) direction: DVec3,
}

impl Ray {
    pub(super) fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }
}

/// Pixels that a box may touch, and the depths between which it does.
#[derive(Clone, Debug)]
pub(super) struct Footprint {
    pub(super) columns: Range<usize>,
    pub(super) rows: Range<usize>,
    pub(super) nearest: f64,
    pub(super) farthest: f64,
}

impl Screen {
    /// With `width` by `height` pixels of `samples` by `samples` samples.
    pub(super) fn new(camera: &Camera, width: u32, height: u32, samples: u32) -> Self {
        let (width, height) = (width * samples, height * samples);
        let super::camera::Basis { right, up, forward } = camera.basis;
        let (w, h) = (f64::from(width), f64::from(height));
        let half = camera.half_size;
        let common = if camera.is_parallel { DVec3::ZERO } else { forward };
        let column = |i: u32| right * ((f64::from(2 * i + 1) - w) / w * half.x);
        let row = |j: u32| common + up * ((h - f64::from(2 * j + 1)) / h * half.y);
        let samples = samples as usize;
        Self {
            samples,
            tile_edge: TILE / samples * samples,
            width: width as usize,
            height: height as usize,
            eye: camera.eye,
            right,
            up,
            forward,
            is_parallel: camera.is_parallel,
            radius: if camera.is_parallel { half.x + half.y } else { 0.0 },
            columns: (0..width).map(column).collect(),
            rows: (0..height).map(row).collect(),
            across: right * (0.5 * w / half.x),
            down: up * (-0.5 * h / half.y),
            middle: [0.5 * w - 0.5, 0.5 * h - 0.5],
            slack: SLACK_PX,
        }
    }

    /// The same screen for rays that pass anywhere between its pixels.
    pub(super) fn for_rays_between(self) -> Self {
        Self { slack: BETWEEN_PX, ..self }
    }

    /// Edge of a pixel at a depth, in scene units.
    pub(super) fn pixel_size(&self, depth: f64) -> f64 {
        let of_sample = self.down.length().recip();
        self.samples as f64 * of_sample * if self.is_parallel { 1.0 } else { depth }
    }

    /// How many tiles stand in a row, and how many rows there are.
    pub(super) fn n_tiles(&self) -> (usize, usize) {
        (self.width.div_ceil(self.tile_edge), self.height.div_ceil(self.tile_edge))
    }

    /// The samples that a triangle may touch at depth `near` or farther, and no less a depth than
    /// it has there; `None` if that is nothing.
    pub(super) fn extent_of_triangle(
        &self,
        corners: &[DVec3; 3],
        near: f64,
    ) -> Option<(Tile, f64)> {
        let depths = corners.map(|corner| self.forward.dot(corner));
        let nearest = depths.into_iter().fold(f64::INFINITY, f64::min);
        let mut bounds = [(f64::INFINITY, f64::NEG_INFINITY); 2];
        let mut add = |p: DVec3, depth: f64| {
            let scale = if self.is_parallel { 1.0 } else { 1.0 / depth };
            for (axis, bounds) in [self.across, self.down].into_iter().zip(&mut bounds) {
                let at = axis.dot(p) * scale;
                *bounds = (bounds.0.min(at), bounds.1.max(at));
            }
        };
        for i in 0..3 {
            let j = (i + 1) % 3;
            if depths[i] >= near {
                add(corners[i], depths[i]);
            }
            // Where an edge goes through the near plane the triangle is cut.
            if (depths[i] < near) != (depths[j] < near) {
                let t = (near - depths[i]) / (depths[j] - depths[i]);
                add(corners[i] + t * (corners[j] - corners[i]), near);
            }
        }
        let samples = |(lo, hi): (f64, f64), middle: f64, n: usize| {
            let slack = self.slack + 1e-12 * (lo.abs() + hi.abs());
            // Ceiling and floor by truncation, which saturates: negative numbers become 0.
            let first = (middle + lo + (1.0 - slack)) as u32 as usize;
            first..((middle + hi + (1.0 + slack)) as u32 as usize).min(n)
        };
        let columns = samples(bounds[0], self.middle[0], self.width);
        let rows = samples(bounds[1], self.middle[1], self.height);
        let is_seen = nearest.is_finite() && !columns.is_empty() && !rows.is_empty();
        is_seen.then(|| (Tile { columns, rows }, nearest.max(near)))
    }

    /// The tile in a column and a row of tiles.
    pub(super) fn tile(&self, column: usize, row: usize) -> Tile {
        let edge = self.tile_edge;
        let part = |i: usize, n: usize| i * edge..((i + 1) * edge).min(n);
        Tile { columns: part(column, self.width), rows: part(row, self.height) }
    }

    #[inline]
    pub(super) fn ray(&self, column: usize, row: usize) -> Ray {
        let varying = self.columns[column] + self.rows[row];
        if self.is_parallel {
            Ray { origin: varying, direction: self.forward }
        } else {
            Ray { origin: DVec3::ZERO, direction: varying }
        }
    }

    /// The parts of varying vectors that the columns and the rows of a tile add; see
    /// [`Screen::ray`].
    pub(super) fn vectors(&self, tile: &Tile) -> (&[DVec3], &[DVec3]) {
        (&self.columns[tile.columns.clone()], &self.rows[tile.rows.clone()])
    }

    /// The column and the row that a point appears in, and its depth; `None` if it is out of the
    /// picture or behind the eye.
    #[inline]
    pub(super) fn sample_of(&self, p: DVec3) -> Option<(usize, usize, f64)> {
        let depth = self.forward.dot(p);
        if depth <= 0.0 {
            return None;
        }
        let scale = if self.is_parallel { 1.0 } else { 1.0 / depth };
        let column = (self.across.dot(p) * scale + self.middle[0] + 0.5).floor();
        let row = (self.down.dot(p) * scale + self.middle[1] + 0.5).floor();
        let is_in = |v: f64, n: usize| v >= 0.0 && v < n as f64;
        (is_in(column, self.width) && is_in(row, self.height)).then_some((
            column as usize,
            row as usize,
            depth,
        ))
    }

    /// Half extents of an axis-aligned box in picture axes: pixels across, pixels down (both times
    /// depth in perspective), depth. `half` are its half extents in scene units.
    pub(super) fn extent(&self, half: DVec3) -> DVec3 {
        let of = |axis: DVec3| axis.abs().dot(half);
        DVec3::new(of(self.across), of(self.down), of(self.forward))
    }

    /// Bounds what the box around `center` with half extents `extent` (from [`Screen::extent`])
    /// touches at depth `near` or farther; `None` if that is nothing.
    ///
    /// In perspective the box projects into [x - ex, x + ex] / [max(z - ez, near), z + ez], an
    /// interval division; z - ez < near needs no special case, as the divisor stays positive.
    #[inline]
    pub(super) fn footprint(&self, center: DVec3, extent: DVec3, near: f64) -> Option<Footprint> {
        let z = self.forward.dot(center);
        let farthest = z + extent.z;
        if farthest < near {
            return None;
        }
        let nearest = (z - extent.z).max(near);
        let (per_near, per_far) =
            if self.is_parallel { (1.0, 1.0) } else { (1.0 / nearest, 1.0 / farthest) };
        let pixels = |at: f64, half: f64, middle: f64, n: usize| {
            let (lo, hi) = (at - half, at + half);
            let lo = middle + lo * if lo < 0.0 { per_near } else { per_far };
            let hi = middle + hi * if hi < 0.0 { per_far } else { per_near };
            // Ceiling and floor by truncation, which saturates: negative numbers become 0.
            let first = (lo + (1.0 - self.slack)) as u32 as usize;
            first..((hi + (1.0 + self.slack)) as u32 as usize).min(n)
        };
        let columns = pixels(self.across.dot(center), extent.x, self.middle[0], self.width);
        let rows = pixels(self.down.dot(center), extent.y, self.middle[1], self.height);
        (!columns.is_empty() && !rows.is_empty()).then_some(Footprint {
            columns,
            rows,
            nearest,
            farthest,
        })
    }
}
