//! How open the surroundings of a point are: corners and hollows get less of the light that comes
//! from everywhere.
//!
//! Around each pixel the picture's own depths are looked at along some lines: the highest that
//! rises on either side is the horizon there, and what is open is the light of an even sky between
//! both horizons. What the picture does not show hides nothing. The 16 pixels of every square of 4 by 4
//! look along lines of their own, and their mean over a surface is free of patterns; no chance is
//! involved.
//!
//! *Based on:* J. Jimenez, X. Wu, A. Pesce, A. Jarabo, "Practical Real-Time Strategies for Accurate
//! Indirect Occlusion", SIGGRAPH 2016 course (horizons, and the closed form of the light between
//! them).

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::{
    paint::{Painter, Seen, Tools},
    screen::Screen,
};
use crate::{Error, Result, progress::Progress};

/// Lines through each pixel.
const LINES: usize = 4;
/// Pixels that are looked at on either side, ever farther apart.
const STEPS: usize = 16;
/// How far is looked, as a part of the picture's smaller side, and of the distance there in depth.
const RADIUS: f64 = 0.2;

/// Pixels along an edge of the squares in which every pixel looks along other lines.
const PATTERN: usize = 4;
/// The order of the lines: near ones are far apart.
const ORDER: [[usize; PATTERN]; PATTERN] =
    [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];
/// The order of the distances that they look at.
const PHASES: [usize; PATTERN * PATTERN] = [0, 9, 4, 13, 2, 11, 6, 15, 1, 8, 5, 12, 3, 10, 7, 14];
/// Pixels are of the same surface if neither leaves the other's tangent plane by more than this part
/// of their distance.
const SAME: f64 = 0.35;

/// What a pixel's middle shows.
#[derive(Clone, Copy)]
struct Spot {
    /// From the eye, in scene axes.
    point: DVec3,
    normal: DVec3,
    depth: f64,
}

/// How open it is at what each pixel shows.
pub(super) struct Occlusion {
    width: usize,
    height: usize,
    /// Depth, and the open part in [0, 1]; `None` where there is no surface.
    pixels: Vec<Option<(f64, f32)>>,
}

impl Occlusion {
    /// From what `painter` shows in the middles of pixels: its screen has one sample for each.
    pub(super) fn new(
        painter: &Painter<'_>,
        screen: &Screen,
        tools: impl Fn() -> Tools + Sync,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let spots = spots(painter, screen, tools, progress)?;
        let (width, height) = (screen.width, screen.height);
        let radius = RADIUS * width.min(height) as f64;
        let of_pixel = |i: usize| {
            let spot = spots[i]?;
            let at = [i % width, i / width];
            Some((spot.depth, open(&spots, screen, at, &spot, radius) as f32))
        };
        let pixels: Vec<_> = (0..width * height).into_par_iter().map(of_pixel).collect();
        let mean = |i: usize| {
            let spot = spots[i]?;
            Some((spot.depth, mean(&spots, &pixels, width, [i % width, i / width], &spot)))
        };
        let pixels = (0..width * height).into_par_iter().map(mean).collect();
        Ok(Self { width, height, pixels })
    }

    /// The open part at what a sample of a pixel shows at some depth.
    pub(super) fn at(&self, [column, row]: [usize; 2], depth: f64) -> f32 {
        let columns = column.saturating_sub(1)..(column + 2).min(self.width);
        let rows = row.saturating_sub(1)..(row + 2).min(self.height);
        // The sample may show what only a neighbour's middle shows.
        let mut nearest = (f64::INFINITY, 1.0);
        let own = self.pixels[row * self.width + column];
        let around = rows.flat_map(|row| columns.clone().map(move |column| (row, column)));
        let around = around.map(|(row, column)| self.pixels[row * self.width + column]);
        for (other, open) in [own].into_iter().chain(around).flatten() {
            let distance = (other - depth).abs();
            if distance < nearest.0 {
                nearest = (distance, open);
            }
        }
        nearest.1
    }
}

/// What the middles of all pixels show.
fn spots(
    painter: &Painter<'_>,
    screen: &Screen,
    tools: impl Fn() -> Tools + Sync,
    progress: &dyn Progress,
) -> Result<Vec<Option<Spot>>> {
    let (n_columns, n_rows) = screen.n_tiles();
    let mut spots = vec![None; screen.width * screen.height];
    progress.begin("look around", (n_columns * n_rows) as u64, "tiles");
    spots.par_chunks_mut(screen.width * screen.tile_edge).enumerate().try_for_each(
        |(row, spots)| {
            let mut tools = tools();
            for column in 0..n_columns {
                if progress.is_cancelled() {
                    return Err(Error::Interrupted);
                }
                let tile = screen.tile(column, row);
                let seen = painter.paint((column, row), &tile, &mut tools);
                for (sample, seen) in seen.iter().enumerate() {
                    let Some(Seen { depth, normal, .. }) = *seen else { continue };
                    let ray = painter.ray(&tile, sample);
                    let (x, y) = tile.place(sample);
                    let normal = if normal.dot(ray.direction) > 0.0 { -normal } else { normal };
                    spots[(y - tile.rows.start) * screen.width + x] =
                        Some(Spot { point: ray.at(depth), normal, depth });
                }
                progress.advance(1);
            }
            Ok(())
        },
    )?;
    progress.end();
    Ok(spots)
}

/// The mean of a pixel and those of its neighbours that show the same surface.
fn mean(
    spots: &[Option<Spot>],
    pixels: &[Option<(f64, f32)>],
    width: usize,
    [column, row]: [usize; 2],
    spot: &Spot,
) -> f32 {
    let height = spots.len() / width;
    let range =
        |i: usize, n: usize| i.saturating_sub(PATTERN / 2 - 1)..(i + PATTERN / 2 + 1).min(n);
    let (mut sum, mut n) = (0.0, 0.0);
    for y in range(row, height) {
        for x in range(column, width) {
            let i = y * width + x;
            let (Some(other), Some((_, open))) = (spots[i], pixels[i]) else { continue };
            let away = other.point - spot.point;
            let leaves = |normal: DVec3| away.dot(normal).abs() > SAME * away.length();
            if !leaves(spot.normal) && !leaves(other.normal) {
                sum += open;
                n += 1.0;
            }
        }
    }
    (sum / n).clamp(0.0, 1.0)
}

/// The open part of the surroundings of a spot, by a few lines: their mean lies in [0, 1].
fn open(
    spots: &[Option<Spot>],
    screen: &Screen,
    [column, row]: [usize; 2],
    spot: &Spot,
    radius: f64,
) -> f64 {
    let to_viewer = if screen.is_parallel { -screen.forward } else { -spot.point.normalize() };
    let reach = radius * screen.pixel_size(spot.depth);
    let order = ORDER[row % PATTERN][column % PATTERN];
    let [turn, phase] =
        [order, PHASES[order]].map(|i| i as f64 / ORDER.as_flattened().len() as f64);
    let mut sum = 0.0;
    for line in 0..LINES {
        let angle = (line as f64 + turn) * (PI / LINES as f64);
        let along = DVec2::new(libm::cos(angle), libm::sin(angle));
        let across = along.x * screen.right + along.y * screen.up;
        // The plane of the line and the viewer, and what of the normal lies in it.
        let axis = across.cross(to_viewer).normalize();
        let tangent = to_viewer.cross(axis);
        let projected = spot.normal - spot.normal.dot(axis) * axis;
        let length = projected.length();
        if length < 1e-6 {
            continue;
        }
        let tilt = {
            let cosine = (projected.dot(to_viewer) / length).clamp(-1.0, 1.0);
            let angle = libm::acos(cosine);
            if projected.dot(tangent) < 0.0 { -angle } else { angle }
        };
        for side in [-1.0, 1.0] {
            // Light comes from the half space that the normal points to.
            let flat = tilt + side * FRAC_PI_2;
            let lowest = libm::cos(flat.clamp(-PI, PI));
            let mut highest = lowest;
            for step in 1..=STEPS {
                let part = (step as f64 - phase) / STEPS as f64;
                let distance = side * (radius * part * part.sqrt()).max(step as f64);
                let x = column as f64 + distance * along.x;
                let y = row as f64 - distance * along.y;
                let (x, y) = ((x + 0.5).floor(), (y + 0.5).floor());
                let is_in =
                    x >= 0.0 && y >= 0.0 && x < screen.width as f64 && y < screen.height as f64;
                if !is_in {
                    break;
                }
                let Some(other) = spots[y as usize * screen.width + x as usize] else { continue };
                let away = other.point - spot.point;
                let square = away.length_squared();
                // What is far away counts ever less.
                let weight = 1.0 - square / (reach * reach);
                if square > 0.0 && weight > 0.0 {
                    let cosine = away.dot(to_viewer) / square.sqrt();
                    let rise = lowest + weight * (cosine - lowest);
                    highest = if rise > highest { rise } else { highest };
                }
            }
            let horizon = side * libm::acos(highest.clamp(-1.0, 1.0));
            sum += 0.25
                * length
                * (libm::cos(tilt) + 2.0 * horizon * libm::sin(tilt)
                    - libm::cos(2.0 * horizon - tilt));
        }
    }
    sum / LINES as f64
}
