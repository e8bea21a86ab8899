//! Solids of samples in the picture: chunks of cells into the samples of a tile.

use std::cell::OnceCell;

use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;

use super::{
    field::{CHUNK, Chunk, Slopes, Solid},
    paint::{Seen, UNTINTED},
    pierce::{Pierce, Pierced},
    screen::{Ray, Screen},
    tile::{Tile, TileLists},
};

/// A chunk on the screen.
struct Placed {
    solid: usize,
    chunk: usize,
    extent: Tile,
    nearest: f64,
}

/// The chunks of all solids, and which of them each tile may show, the nearest first.
pub(super) struct Solids<'a> {
    all: &'a [Solid<'a>],
    frames: Vec<Axes>,
    placed: Vec<Placed>,
    of_tiles: TileLists,
    near: f64,
}

/// Between what a screen sees, from its eye, and a grid of points.
struct Axes {
    grid_from_view: DAffine3,
    /// Of normals, from the grid to the scene.
    normals: DMat3,
}

impl<'a> Solids<'a> {
    /// Of `all`, where they are farther away than `near`.
    pub(super) fn new(all: &'a [Solid<'a>], screen: &Screen, near: f64) -> Self {
        let mut placed: Vec<Placed> = Vec::new();
        for (number, solid) in all.iter().enumerate() {
            let of_chunk = |(i, chunk): (usize, &Chunk)| {
                let (extent, nearest) = extent(solid, chunk, screen, near)?;
                Some(Placed { solid: number, chunk: i, extent, nearest })
            };
            placed.par_extend(solid.chunks.par_iter().enumerate().filter_map(of_chunk));
        }
        // A stable sort: what is equally far away stays in order.
        placed.par_sort_by(|a, b| a.nearest.total_cmp(&b.nearest));
        let of_tiles = TileLists::new(screen, placed.iter().map(|placed| &placed.extent));
        let frames = all.iter().map(|solid| Axes::new(solid, screen)).collect();
        Self { all, frames, placed, of_tiles, near }
    }

    /// Shows what is nearer than `seen`, the samples of a tile of `screen`. Solids are numbered from
    /// `first_layer`.
    pub(super) fn draw(
        &self,
        screen: &Screen,
        place: (usize, usize),
        tile: &Tile,
        first_layer: usize,
        seen: &mut [Option<Seen>],
    ) {
        for placed in self.of_tiles.of_tile(place).map(|i| &self.placed[i]) {
            let Some(part) = placed.extent.intersection(tile) else { continue };
            let piercer = Piercer::new(self, placed);
            for row in part.rows {
                for column in part.columns.clone() {
                    let sample = tile.sample(column, row);
                    let farthest = seen[sample].map_or(f64::INFINITY, |seen| seen.depth);
                    if placed.nearest > farthest {
                        continue;
                    }
                    let ray = screen.ray(column, row);
                    let Some(pierce) = piercer.first(&ray, farthest) else { continue };
                    let (layer, depth) = (first_layer + placed.solid, pierce.depth);
                    let normal = piercer.normal(&ray, &pierce);
                    seen[sample] = Some(Seen::without_voxels(layer, depth, normal, UNTINTED));
                }
            }
        }
    }

    /// Calls `meet` for every chunk that a tile of the screen may show, with the samples that it may
    /// touch and a function that tells at which depth a ray meets it, if that is before another.
    pub(super) fn visit(
        &self,
        place: (usize, usize),
        mut meet: impl FnMut(&Tile, &dyn Fn(&Ray, f64) -> Option<f64>),
    ) {
        for placed in self.of_tiles.of_tile(place).map(|i| &self.placed[i]) {
            let piercer = Piercer::new(self, placed);
            let depth_of = |ray: &Ray, farthest: f64| {
                let pierce = (placed.nearest < farthest).then(|| piercer.first(ray, farthest));
                pierce.flatten().map(|pierce| pierce.depth)
            };
            meet(&placed.extent, &depth_of);
        }
    }
}

/// The samples that a chunk may touch, and no less a depth than it has there; `None` if that is nothing.
fn extent(solid: &Solid<'_>, chunk: &Chunk, screen: &Screen, near: f64) -> Option<(Tile, f64)> {
    let placing = solid.field.placing();
    let [first, last] = chunk.bounds(solid.field.size());
    let (middle, half) = (0.5 * (first + last), 0.5 * (last - first));
    let of_axis = |axis: DVec3, half: f64| axis.abs() * half;
    let DMat3 { x_axis, y_axis, z_axis } = placing.matrix3;
    let half = of_axis(x_axis, half.x) + of_axis(y_axis, half.y) + of_axis(z_axis, half.z);
    let center = placing.transform_point3(middle) - screen.eye;
    let footprint = screen.footprint(center, screen.extent(half * (1.0 + 1e-6)), near)?;
    let extent = Tile { columns: footprint.columns, rows: footprint.rows };
    Some((extent, footprint.nearest))
}

impl Axes {
    fn new(solid: &Solid<'_>, screen: &Screen) -> Self {
        let inverse = solid.field.placing().inverse();
        let grid_from_view = inverse * DAffine3::from_translation(screen.eye);
        Self { grid_from_view, normals: inverse.matrix3.transpose() }
    }
}

/// A chunk and rays through it; its values are read when the first one comes.
struct Piercer<'a> {
    solid: &'a Solid<'a>,
    chunk: &'a Chunk,
    axes: &'a Axes,
    near: f64,
    pierced: OnceCell<Pierced<'a>>,
    slopes: OnceCell<Slopes>,
}

impl<'a> Piercer<'a> {
    fn new(solids: &'a Solids<'a>, placed: &Placed) -> Self {
        let solid = &solids.all[placed.solid];
        let (chunk, axes) = (&solid.chunks[placed.chunk], &solids.frames[placed.solid]);
        let (pierced, slopes) = (OnceCell::new(), OnceCell::new());
        Self { solid, chunk, axes, near: solids.near, pierced, slopes }
    }

    /// A ray as the chunk has it.
    fn turned(&self, ray: &Ray) -> Ray {
        let first = DVec3::from_array(self.chunk.place.map(|i| f64::from(i * CHUNK as u32)));
        Ray {
            origin: self.axes.grid_from_view.transform_point3(ray.origin) + 0.5 - first,
            direction: self.axes.grid_from_view.transform_vector3(ray.direction),
        }
    }

    /// Where a ray first meets the surface before `farthest`.
    fn first(&self, ray: &Ray, farthest: f64) -> Option<Pierce> {
        let pierced = self.pierced.get_or_init(|| Pierced::new(self.solid.field, self.chunk));
        let pierce = pierced.first(&self.turned(ray), [self.near, farthest]);
        pierce.filter(|pierce| pierce.depth >= self.near && pierce.depth < farthest)
    }

    /// The outward normal where a ray meets the surface.
    fn normal(&self, ray: &Ray, pierce: &Pierce) -> DVec3 {
        let outwards = match pierce.face {
            Some((axis, is_upper)) => DVec3::AXES[axis] * if is_upper { 1.0 } else { -1.0 },
            None => {
                let read = || Slopes::read(self.solid.field, self.chunk.place);
                -self.slopes.get_or_init(read).at(self.turned(ray).at(pierce.depth))
            }
        };
        let normal = (self.axes.normals * outwards).try_normalize();
        // Where nothing rises it faces the viewer.
        normal.unwrap_or_else(|| -ray.direction.normalize_or(DVec3::Z))
    }
}
