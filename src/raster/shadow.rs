//! Which lights get to a point: rays from the lights, followed to the surface as those of the camera.
//!
//! Every light has a view of its own, with parallel rays, which sorts blocks and triangles into
//! tiles. A ray goes from the light to the very point that a sample shows, between the light's own
//! samples: shadows are as sharp as the picture, and nothing depends on how fine the light's view is.
//!
//! *Based on:* T. Aila, S. Laine, "Alias-Free Shadow Maps", Eurographics Symposium on Rendering 2004
//! (points of the picture, sorted by where the light sees them).

use glam::DVec3;

use super::{
    Camera, Contents, ImageSettings, Layer, Model, Placement, Projection, Shade, Solid, View,
    block::{BlockMaker, Blocks},
    light::towards,
    paint::{Painter, Seen, Tools},
    screen::{Ray, Screen},
    solids::Solids,
    tile::Tile,
    trace::{Meeting, Quest, Traced},
    triangles::Triangles,
};
use crate::math::{Aabb, SimdLevel};

/// Pixels along an edge of a light's view; it only sorts.
const VIEW: u32 = 1024;

/// What is nearer to a point than this many voxels does not shade it, as the point itself may be off
/// by so much: on the surface itself, or in the plane of a voxel.
const BIAS_REFINED: f64 = 0.01;
const BIAS_SPLATTED: f64 = 1.0;

/// The same on models and solids, as a part of the scene: their normals are smoother than their shapes.
const BIAS_MODEL: f64 = 1e-3;

/// Where a surface faces away from a light by more than this sine, it gets no light of it.
const FACES_AWAY: f64 = -0.36;

/// What casts shadows, as each light sees it.
pub(super) struct Shadows<'a> {
    layers: &'a [Layer<'a>],
    views: Vec<LightView<'a>>,
    image: &'a ImageSettings,
    bias_model: f64,
}

struct LightView<'a> {
    screen: Screen,
    blocks: Blocks,
    triangles: Triangles<'a>,
    solids: Solids<'a>,
    near: f64,
}

/// A ray from a light to the point of a sample.
struct Shaft {
    sample: u32,
    /// Where the light's view shows the point.
    column: usize,
    row: usize,
    ray: Ray,
    farthest: f64,
    is_dark: bool,
}

impl<'a> Shadows<'a> {
    /// Of `contents`; nothing if the picture asks for no shadows.
    pub(super) fn new(
        contents: &Contents<'a>,
        image: &'a ImageSettings,
        screen: &Screen,
        simd: SimdLevel,
    ) -> Self {
        let Contents { layers, models, solids } = *contents;
        let boxes: Vec<Aabb> = layers
            .iter()
            .map(|layer| layer.lattice.bounds())
            .chain(models.iter().filter_map(bounds_of))
            .chain(solids.iter().filter_map(Solid::bounds))
            .collect();
        let near = layers.iter().map(Layer::near).fold(f64::INFINITY, f64::min);
        // Parallel rays begin before everything.
        let near = if near.is_finite() { near } else { 0.0 };
        let view = |direction: DVec3| {
            let view = View {
                projection: Projection::Orthographic { height: None },
                placement: Placement::Fit { direction, margin: 0.01 },
                up: DVec3::Z,
            };
            let camera = Camera::new(&view, 1.0, boxes.as_slice());
            let screen = Screen::new(&camera, VIEW, VIEW, 1).for_rays_between();
            let blocks = Blocks::new(layers, &screen, simd);
            let triangles = Triangles::new(models, &screen, near);
            let solids = Solids::new(solids, &screen, near);
            LightView { screen, blocks, triangles, solids, near }
        };
        let lights = if image.shadows { image.lights.as_slice() } else { &[] };
        let views = lights.iter().map(|light| view(towards(light, screen))).collect();
        let size = boxes.iter().map(|b| b.size().max_element()).fold(0.0, f64::max);
        Self { layers, views, image, bias_model: BIAS_MODEL * size }
    }

    /// Takes from what the samples of a tile show the lights that do not get there.
    pub(super) fn cast(
        &self,
        painter: &Painter<'_>,
        tile: &Tile,
        seen: &mut [Option<Seen>],
        tools: &mut Tools,
    ) {
        for (number, view) in self.views.iter().enumerate() {
            let mut shafts = self.shafts(view, painter, tile, seen);
            let edge = view.screen.tile_edge;
            let place = |shaft: &Shaft| (shaft.column / edge, shaft.row / edge);
            // Samples stay in their order, as quests must be.
            shafts.sort_by_key(place);
            for of_tile in shafts.chunk_by_mut(|a, b| place(a) == place(b)) {
                let Some(place) = of_tile.first().map(place) else { continue };
                self.by_surfaces(view, place, of_tile, tools);
                by_models_and_solids(view, place, of_tile);
            }
            for shaft in shafts.iter().filter(|shaft| shaft.is_dark) {
                if let Some(seen) = &mut seen[shaft.sample as usize] {
                    seen.reach.lights &= !(1 << number);
                }
            }
        }
    }

    /// The rays from a light to what the samples of a tile show, if it may get there.
    fn shafts(
        &self,
        view: &LightView<'_>,
        painter: &Painter<'_>,
        tile: &Tile,
        seen: &[Option<Seen>],
    ) -> Vec<Shaft> {
        let to_light = -view.screen.forward;
        let shaft = |(sample, seen): (usize, &Option<Seen>)| {
            let seen = (*seen)?;
            let point = painter.point(tile, sample, &seen);
            let is_front = seen.normal.dot(painter.ray(tile, sample).direction) <= 0.0;
            let normal = if is_front { seen.normal } else { -seen.normal };
            let bias = match (seen.block.is_some(), self.image.shade) {
                (false, _) => self.bias_model,
                (true, Shade::Refine) => BIAS_REFINED * seen.voxel_size,
                (true, _) => BIAS_SPLATTED * seen.voxel_size,
            };
            // A ray that grazes the surface would be in it for long, were its end a little below.
            let p = point + bias * normal - view.screen.eye;
            let (column, row, depth) = view.screen.sample_of(p)?;
            let direction = view.screen.forward;
            (normal.dot(to_light) > FACES_AWAY).then(|| Shaft {
                sample: sample as u32,
                column,
                row,
                ray: Ray { origin: p - depth * direction, direction },
                farthest: depth - bias,
                is_dark: false,
            })
        };
        seen.iter().enumerate().filter_map(shaft).collect()
    }

    /// Finds the rays that surfaces block.
    fn by_surfaces(
        &self,
        view: &LightView<'_>,
        place: (usize, usize),
        shafts: &mut [Shaft],
        tools: &mut Tools,
    ) {
        let Tools { tracer, finder, .. } = tools;
        let screen = &view.screen;
        let maker = BlockMaker::new(self.layers, screen, self.image);
        let (mut quests, mut meetings): (Vec<Quest>, Vec<Meeting>) = (Vec::new(), Vec::new());
        for block in view.blocks.of_tile(place) {
            let Some(tape) = self.layers[block.layer].tape else { continue };
            let Tile { columns, rows } = &block.extent;
            let may_meet = |shaft: &&Shaft| {
                !shaft.is_dark
                    && block.nearest < shaft.farthest
                    && columns.contains(&shaft.column)
                    && rows.contains(&shaft.row)
            };
            quests.clear();
            quests.extend(shafts.iter().filter(may_meet).map(|shaft| Quest {
                sample: shaft.sample,
                ray: shaft.ray,
                from: block.nearest,
                farthest: shaft.farthest,
            }));
            if quests.is_empty() {
                continue;
            }
            meetings.clear();
            let cells = &*maker.cells(block, &mut **finder);
            let whole = Traced { tape, cells, eye: screen.eye };
            let own = block.tape(&whole, &mut **tracer);
            let traced = Traced { tape: own.as_deref().unwrap_or(tape), ..whole };
            tracer.trace(&traced, &quests, &mut meetings);
            for meeting in &meetings {
                let of_sample = shafts.binary_search_by_key(&meeting.sample, |shaft| shaft.sample);
                if let Ok(i) = of_sample {
                    shafts[i].is_dark = true;
                }
            }
        }
    }
}

/// Finds the rays that models and solids block.
fn by_models_and_solids(view: &LightView<'_>, place: (usize, usize), shafts: &mut [Shaft]) {
    // By rows, and in them by columns, so that those that a triangle may touch stand together.
    shafts.sort_by_key(|shaft| (shaft.row, shaft.column));
    let mut darken = |Tile { columns, rows }: &Tile,
                      depth_of: &dyn Fn(&Ray, f64) -> Option<f64>| {
        let first = shafts.partition_point(|shaft| shaft.row < rows.start);
        for row in shafts[first..].chunk_by_mut(|a, b| a.row == b.row) {
            if row[0].row >= rows.end {
                break;
            }
            let start = row.partition_point(|shaft| shaft.column < columns.start);
            let in_columns = row[start..].iter_mut().take_while(|s| s.column < columns.end);
            for shaft in in_columns.filter(|shaft| !shaft.is_dark) {
                let depth = depth_of(&shaft.ray, shaft.farthest);
                shaft.is_dark = depth.is_some_and(|depth| depth >= view.near);
            }
        }
    };
    view.triangles.visit(&view.screen, place, &mut darken);
    view.solids.visit(place, &mut darken);
}

/// The box around a model that has triangles.
fn bounds_of(model: &Model) -> Option<Aabb> {
    let positions = &model.polygons.positions;
    let first = *positions.first()?;
    let (min, max) = positions.iter().fold((first, first), |(a, b), &p| (a.min(p), b.max(p)));
    Some(Aabb { min, max })
}
