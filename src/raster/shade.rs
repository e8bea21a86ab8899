//! Samples to pixels: every sample is lit by itself, and a pixel is the mean of its samples.
//!
//! The mean is that of linear light, premultiplied by alpha, so that edges fit any background. The
//! layers that cannot be averaged show the pixel's nearest sample.

use glam::DVec3;
use rayon::prelude::*;

use super::{
    Camera, Contents, Frame, ImageSettings, Layer, Material, Shade, Solid,
    block::{BlockMaker, Blocks, MAX_BLOCKS, OnDemandCount},
    color::Colorer,
    light::Lights,
    occlusion::Occlusion,
    paint::{Painter, Seen, Tools},
    screen::Screen,
    shadow::Shadows,
    solids::Solids,
    tile::Tile,
    triangles::Triangles,
};
use crate::{Error, Result, math::SimdLevel, progress::Progress};

/// A tile's part of the planes of a [`Frame`], row by row.
struct Planes<'a> {
    rgba: Vec<&'a mut [[f32; 4]]>,
    depth: Vec<&'a mut [f32]>,
    normal: Vec<&'a mut [[f32; 3]]>,
    position: Vec<&'a mut [[f32; 3]]>,
    surface: Vec<&'a mut [f32]>,
    curvature: Vec<&'a mut [f32]>,
    certificate: Vec<&'a mut [f32]>,
}

impl<'a> Planes<'a> {
    /// Cuts a frame into tiles with `edge` pixels along an edge, row by row.
    fn cut(frame: &'a mut Frame, edge: usize) -> Vec<Self> {
        let width = frame.width as usize;
        let mut rgba = cut(&mut frame.rgba, width, edge);
        let mut depth = cut(&mut frame.depth, width, edge);
        let mut normal = cut(&mut frame.normal, width, edge);
        let mut position = cut(&mut frame.position, width, edge);
        let mut surface = cut(&mut frame.surface, width, edge);
        let mut curvature = cut(&mut frame.curvature, width, edge);
        let mut certificate = cut(&mut frame.certificate, width, edge);
        let n_tiles = rgba.len();
        let take = |number: usize| Self {
            rgba: std::mem::take(&mut rgba[number]),
            depth: std::mem::take(&mut depth[number]),
            normal: std::mem::take(&mut normal[number]),
            position: std::mem::take(&mut position[number]),
            surface: std::mem::take(&mut surface[number]),
            curvature: std::mem::take(&mut curvature[number]),
            certificate: std::mem::take(&mut certificate[number]),
        };
        (0..n_tiles).map(take).collect()
    }
}

/// The rows of each tile of a plane.
fn cut<T>(plane: &mut [T], width: usize, edge: usize) -> Vec<Vec<&mut [T]>> {
    let mut tiles = Vec::new();
    for rows in plane.chunks_mut(width * edge) {
        let first = tiles.len();
        tiles.resize_with(first + width.div_ceil(edge), Vec::new);
        for row in rows.chunks_mut(width) {
            for (tile, part) in tiles[first..].iter_mut().zip(row.chunks_mut(edge)) {
                tile.push(part);
            }
        }
    }
    tiles
}

/// The nearest point that a pixel shows.
#[derive(Clone, Copy)]
struct Shown {
    /// Row and column of the pixel in its tile.
    pixel: [usize; 2],
    /// The number of its block in the tile; `None` on models.
    block: Option<u32>,
    /// In scene coordinates.
    point: DVec3,
    voxel_size: f64,
    /// Whether it is not known whether its voxel is certified.
    is_open: bool,
}

/// Paints and lights all pixels.
pub(super) fn shade(
    contents: &Contents<'_>,
    camera: &Camera,
    image: &ImageSettings,
    simd: SimdLevel,
    progress: &dyn Progress,
) -> Result<(Frame, OnDemandCount)> {
    let Contents { layers, models, solids } = *contents;
    let empty = image.background.map_or([0.0; 4], |[r, g, b]| [r, g, b, 1.0]);
    let mut frame = Frame::blank(image.width, image.height);
    if frame.rgba.is_empty() {
        return Ok((frame, OnDemandCount::default()));
    }
    let tools = || Tools::new(simd);
    let occlusion = if image.occlusion > 0.0 {
        let screen = Screen::new(camera, image.width, image.height, 1);
        let drawn = OnScreen::new(contents, &screen, image, simd)?;
        Some(Occlusion::new(&drawn.painter(), &screen, tools, progress)?)
    } else {
        None
    };
    let screen = &Screen::new(camera, image.width, image.height, image.samples);
    let drawn = OnScreen::new(contents, screen, image, simd)?;
    let painter = drawn.painter();
    let lights = Lights::new(image, screen);
    let of_layers = layers.iter().map(|layer| layer.material);
    let of_models = models.iter().map(|model| model.material);
    let of_solids = solids.iter().map(|solid| solid.material);
    let materials = of_layers.chain(of_models).chain(of_solids).collect();
    let colorer = Colorer::new(layers, image.shade);
    let shadows = Shadows::new(contents, image, screen, simd);
    let shader = Shader { materials, colorer, screen, shadows, occlusion, lights, image, empty };
    let (n_columns, n_rows) = screen.n_tiles();
    progress.begin("rasterize", (n_columns * n_rows) as u64, "tiles");
    let tiles = Planes::cut(&mut frame, screen.tile_edge / screen.samples);
    tiles.into_par_iter().enumerate().try_for_each_init(tools, |tools, (number, mut planes)| {
        if progress.is_cancelled() {
            return Err(Error::Interrupted);
        }
        let place = (number % n_columns, number / n_columns);
        let tile = screen.tile(place.0, place.1);
        let mut seen = painter.paint(place, &tile, tools);
        shader.light(&painter, place, &tile, &mut seen, tools);
        let shown = shader.write(&tile, &seen, &mut planes);
        tools.seen = seen;
        if image.certificate {
            add_certificates(&painter, place, &shown, &mut planes, tools);
        }
        if image.curvature {
            add_curvatures(&painter, place, &shown, &mut planes, tools);
        }
        progress.advance(1);
        Ok(())
    })?;
    progress.end();
    let count = drawn.blocks.count();
    Ok((frame, count))
}

/// All that a screen shows.
struct OnScreen<'a> {
    maker: BlockMaker<'a>,
    blocks: Blocks,
    triangles: Triangles<'a>,
    solids: Solids<'a>,
    shade: Shade,
}

impl<'a> OnScreen<'a> {
    fn new(
        contents: &Contents<'a>,
        screen: &'a Screen,
        image: &ImageSettings,
        simd: SimdLevel,
    ) -> Result<Self> {
        let Contents { layers, models, solids } = *contents;
        let blocks = Blocks::new(layers, screen, simd);
        if image.shade != Shade::Refine && blocks.most_of_a_tile() > MAX_BLOCKS {
            return Err(Error::Limit(
                "a part of the picture shows too many voxels at once; write shade = \"refine\" in \
                 [image], or lower `resolution` in [voxels]"
                    .to_owned(),
            ));
        }
        let near = near(contents, screen);
        let triangles = Triangles::new(models, screen, near);
        let solids = Solids::new(solids, screen, near);
        let maker = BlockMaker::new(layers, screen, image);
        Ok(Self { maker, blocks, triangles, solids, shade: image.shade })
    }

    fn painter(&self) -> Painter<'_> {
        let Self { maker, blocks, triangles, solids, shade } = self;
        Painter { maker: *maker, blocks, triangles, solids, shade: *shade }
    }
}

/// Where rays begin: of layers, or of models and solids by themselves.
fn near(contents: &Contents<'_>, screen: &Screen) -> f64 {
    let Contents { layers, models, solids } = contents;
    let of_layers = layers.iter().map(Layer::near).fold(f64::INFINITY, f64::min);
    if of_layers.is_finite() {
        return of_layers;
    }
    let of_models = models.iter().flat_map(|model| model.polygons.positions.iter().copied());
    let all = of_models.chain(solids.iter().flat_map(Solid::corners));
    NEAR_MODELS * all.map(|p| (p - screen.eye).length_squared()).fold(0.0, f64::max).sqrt()
}

/// The nearest that models are shown, as a part of how far away they reach.
const NEAR_MODELS: f64 = 1e-6;

/// Everything that lighting a sample needs to know.
struct Shader<'a> {
    /// Of the layers, then of the models and of the solids.
    materials: Vec<Material>,
    colorer: Colorer<'a>,
    screen: &'a Screen,
    shadows: Shadows<'a>,
    occlusion: Option<Occlusion>,
    lights: Lights,
    image: &'a ImageSettings,
    /// A pixel without any surface.
    empty: [f32; 4],
}

impl Shader<'_> {
    /// Finds the colours of what the samples of a tile show, and the light that gets there.
    fn light(
        &self,
        painter: &Painter<'_>,
        place: (usize, usize),
        tile: &Tile,
        seen: &mut [Option<Seen>],
        tools: &mut Tools,
    ) {
        self.colorer.color(painter, place, tile, seen, tools);
        self.shadows.cast(painter, tile, seen, tools);
        let Some(occlusion) = &self.occlusion else { return };
        let strength = self.image.occlusion as f32;
        for (sample, seen) in seen.iter_mut().enumerate() {
            let Some(seen) = seen else { continue };
            let (column, row) = tile.place(sample);
            let pixel = [column, row].map(|i| i / self.screen.samples);
            seen.reach.open = 1.0 - strength * (1.0 - occlusion.at(pixel, seen.depth));
        }
    }

    /// Writes the pixels of a tile, and returns the nearest point that each shows.
    fn write(&self, tile: &Tile, seen: &[Option<Seen>], planes: &mut Planes<'_>) -> Vec<Shown> {
        let mut all = Vec::new();
        let wants_more = self.image.certificate || self.image.curvature;
        for row in 0..planes.rgba.len() {
            for column in 0..planes.rgba[row].len() {
                let (rgba, nearest) = self.mean(tile, seen, [row, column]);
                planes.rgba[row][column] = rgba;
                let Some((sample, seen)) = nearest else {
                    planes.depth[row][column] = Frame::FAR;
                    continue;
                };
                let point = self.point(tile, sample, &seen);
                planes.depth[row][column] = seen.depth as f32;
                planes.normal[row][column] = seen.normal.as_vec3().to_array();
                planes.position[row][column] = point.as_vec3().to_array();
                planes.surface[row][column] = (seen.layer + 1) as f32;
                if seen.certified == Some(true) {
                    planes.certificate[row][column] = 1.0;
                }
                if wants_more {
                    let Seen { block, voxel_size, certified, .. } = seen;
                    let (pixel, is_open) = ([row, column], certified.is_none());
                    all.push(Shown { pixel, block, point, voxel_size, is_open });
                }
            }
        }
        all
    }

    /// The mean of a pixel's samples, and the nearest of them.
    fn mean(
        &self,
        tile: &Tile,
        seen: &[Option<Seen>],
        [row, column]: [usize; 2],
    ) -> ([f32; 4], Option<(usize, Seen)>) {
        let samples = self.screen.samples;
        let mut sum = [0.0_f64; 4];
        let mut nearest: Option<(usize, Seen)> = None;
        for i in 0..samples * samples {
            let row = row * samples + i / samples;
            let sample = row * tile.columns.len() + column * samples + i % samples;
            let seen = seen[sample].as_ref();
            let rgba = seen.map_or(self.empty, |seen| self.lit(tile, sample, seen));
            (0..4).for_each(|c| sum[c] += f64::from(rgba[c]));
            if let Some(seen) = seen
                && nearest.is_none_or(|(_, other)| seen.depth < other.depth)
            {
                nearest = Some((sample, *seen));
            }
        }
        let n = (samples * samples) as f64;
        (sum.map(|channel| (channel / n) as f32), nearest)
    }

    /// The point that a sample shows.
    fn point(&self, tile: &Tile, sample: usize, seen: &Seen) -> DVec3 {
        let (column, row) = tile.place(sample);
        self.screen.eye + self.screen.ray(column, row).at(seen.depth)
    }

    fn lit(&self, tile: &Tile, sample: usize, seen: &Seen) -> [f32; 4] {
        let (column, row) = tile.place(sample);
        let ray = self.screen.ray(column, row);
        let material = self.materials[seen.layer];
        let color = match self.colorer.colors(seen.layer) {
            true => seen.tint,
            false => [0, 1, 2].map(|c| material.color[c] * seen.tint[c]),
        };
        let material = Material { color, ..material }.widened(seen.coherence);
        self.lights.reflected(&material, seen.normal, &ray, seen.reach)
    }
}

/// Adds whether the voxels that pixels show are certified, where that is not known yet.
fn add_certificates(
    painter: &Painter<'_>,
    place: (usize, usize),
    shown: &[Shown],
    planes: &mut Planes<'_>,
    tools: &mut Tools,
) {
    let open = || shown.iter().filter(|shown| shown.is_open && shown.block.is_some());
    let points: Vec<_> = open().filter_map(|shown| Some((shown.block?, shown.point))).collect();
    let certificates = painter.certificates(place, &points, tools);
    for (&Shown { pixel: [row, column], .. }, is_certified) in open().zip(certificates) {
        planes.certificate[row][column] = f32::from(u8::from(is_certified));
    }
}

/// Adds the curvatures at the points that pixels show.
fn add_curvatures(
    painter: &Painter<'_>,
    place: (usize, usize),
    shown: &[Shown],
    planes: &mut Planes<'_>,
    tools: &mut Tools,
) {
    let of_point = |shown: &Shown| Some((shown.block?, shown.point, shown.voxel_size));
    let points: Vec<_> = shown.iter().filter_map(of_point).collect();
    let curvatures = painter.curvatures(place, &points, tools);
    let of_blocks = shown.iter().filter(|shown| shown.block.is_some());
    for (&Shown { pixel: [row, column], .. }, curvature) in of_blocks.zip(curvatures) {
        planes.curvature[row][column] = curvature as f32;
    }
}
