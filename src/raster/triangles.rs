//! Polygon models in the picture: triangles into the samples of a tile.
//!
//! A sample shows a triangle if its ray passes on the same side of all three edges, which the signs
//! of d · (a × b) tell for the edge from a to b, both from the ray's origin. For the two triangles
//! at an edge they are the same number with opposite signs, in floats as well, so that no ray slips
//! through between them.
//!
//! *Based on:* R. Segura, F. Feito, "Algorithms to Test Ray-Triangle Intersection", WSCG 2001 (signed
//! volumes).

use glam::DVec3;
use rayon::prelude::*;

use super::{
    Content, Material,
    fit::fold_reach,
    paint::Seen,
    screen::{Ray, Screen},
    tile::{Tile, TileLists},
};
use crate::polygons::Polygons;

/// A polygon model and how it looks.
#[derive(Clone, Debug)]
pub struct Model {
    /// For messages and statistics.
    pub name: String,
    /// Its triangles.
    pub polygons: Polygons,
    /// How it looks; the colours of its vertices are multiplied by the material's.
    pub material: Material,
}

impl Content for Model {
    fn reach<const N: usize>(&self, directions: [DVec3; N]) -> [f64; N] {
        let of_point = |&p: &DVec3| directions.map(|d| d.dot(p));
        fold_reach(self.polygons.positions.iter().map(of_point))
    }
}

/// A triangle on the screen.
struct Placed {
    model: usize,
    triangle: usize,
    extent: Tile,
    nearest: f64,
}

/// The triangles of all models, and which of them each tile may show.
pub(super) struct Triangles<'a> {
    models: &'a [Model],
    all: Vec<Placed>,
    of_tiles: TileLists,
    near: f64,
}

impl<'a> Triangles<'a> {
    /// Of `models`, where they are farther away than `near`.
    pub(super) fn new(models: &'a [Model], screen: &Screen, near: f64) -> Self {
        let mut all: Vec<Placed> = Vec::new();
        for (number, model) in models.iter().enumerate() {
            let n = model.polygons.triangles.len();
            let placed = (0..n).into_par_iter().filter_map(|triangle| {
                let corners = corners(model, triangle, screen);
                let (extent, nearest) = screen.extent_of_triangle(&corners, near)?;
                Some(Placed { model: number, triangle, extent, nearest })
            });
            all.par_extend(placed);
        }
        let of_tiles = TileLists::new(screen, all.iter().map(|placed| &placed.extent));
        Self { models, all, of_tiles, near }
    }

    /// How many models there are.
    pub(super) fn n_models(&self) -> usize {
        self.models.len()
    }

    /// Shows what is nearer than `seen`, the samples of a tile of `screen`. Models are numbered from
    /// `first_layer`.
    pub(super) fn draw(
        &self,
        screen: &Screen,
        place: (usize, usize),
        tile: &Tile,
        first_layer: usize,
        seen: &mut [Option<Seen>],
    ) {
        for placed in self.of_tiles.of_tile(place).map(|i| &self.all[i]) {
            let Some(part) = placed.extent.intersection(tile) else { continue };
            let model = &self.models[placed.model];
            let corners = corners(model, placed.triangle, screen);
            for row in part.rows {
                for column in part.columns.clone() {
                    let sample = tile.sample(column, row);
                    let farthest = seen[sample].map_or(f64::INFINITY, |seen| seen.depth);
                    if placed.nearest > farthest {
                        continue;
                    }
                    let ray = screen.ray(column, row);
                    let Some(weights) = weights(&corners, &ray) else { continue };
                    let depth = screen.forward.dot(blend(&corners, weights));
                    if depth < farthest && depth >= self.near {
                        let normal = normal(model, placed.triangle, weights);
                        let tint = tint(model, placed.triangle, weights);
                        let layer = first_layer + placed.model;
                        seen[sample] = Some(Seen::without_voxels(layer, depth, normal, tint));
                    }
                }
            }
        }
    }

    /// Calls `meet` for every triangle that a tile of `screen` may show, with the samples that it
    /// may touch and a function that tells at which depth a ray meets it, if that is before another.
    pub(super) fn visit(
        &self,
        screen: &Screen,
        place: (usize, usize),
        mut meet: impl FnMut(&Tile, &dyn Fn(&Ray, f64) -> Option<f64>),
    ) {
        for placed in self.of_tiles.of_tile(place).map(|i| &self.all[i]) {
            let corners = corners(&self.models[placed.model], placed.triangle, screen);
            let depth_of = |ray: &Ray, farthest: f64| {
                let weights = if placed.nearest < farthest { weights(&corners, ray) } else { None };
                let depth = weights.map(|weights| screen.forward.dot(blend(&corners, weights)));
                depth.filter(|&depth| depth < farthest)
            };
            meet(&placed.extent, &depth_of);
        }
    }
}

/// The corners of a triangle, from the eye.
fn corners(model: &Model, triangle: usize, screen: &Screen) -> [DVec3; 3] {
    let Polygons { positions, triangles, .. } = &model.polygons;
    triangles[triangle].map(|i| positions[i as usize] - screen.eye)
}

/// The weights of the corners where a ray meets their triangle, if it does.
fn weights(corners: &[DVec3; 3], ray: &Ray) -> Option<[f64; 3]> {
    let [a, b, c] = corners.map(|corner| corner - ray.origin);
    let d = ray.direction;
    let [x, y, z] = [d.dot(b.cross(c)), d.dot(c.cross(a)), d.dot(a.cross(b))];
    let is_inside = (x >= 0.0 && y >= 0.0 && z >= 0.0) || (x <= 0.0 && y <= 0.0 && z <= 0.0);
    let sum = x + y + z;
    (is_inside && sum != 0.0).then(|| [x / sum, y / sum, z / sum])
}

fn blend(vectors: &[DVec3; 3], [x, y, z]: [f64; 3]) -> DVec3 {
    x * vectors[0] + y * vectors[1] + z * vectors[2]
}

fn normal(model: &Model, triangle: usize, weights: [f64; 3]) -> DVec3 {
    let normals = &model.polygons.normals[triangle];
    blend(normals, weights).normalize_or(normals[0])
}

/// The colour of the vertices, white if they have none.
fn tint(model: &Model, triangle: usize, weights: [f64; 3]) -> [f32; 3] {
    let Polygons { triangles, colors, .. } = &model.polygons;
    if colors.is_empty() {
        return [1.0; 3];
    }
    let of_corners =
        triangles[triangle].map(|i| DVec3::from_array(colors[i as usize].map(f64::from)));
    blend(&of_corners, weights).as_vec3().to_array()
}
