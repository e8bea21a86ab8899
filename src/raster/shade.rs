//! Samples to pixels: every sample is lit by itself, and a pixel is the mean of its samples.
//!
//! The mean is that of linear light, premultiplied by alpha, so that edges fit any background. The
//! layers that cannot be averaged show the pixel's nearest sample.

use glam::DVec3;
use rayon::prelude::*;

use super::{
    Camera, Frame, ImageSettings, Layer, Material, Model, Shade,
    block::{BlockMaker, Blocks, MAX_BLOCKS, OnDemandCount},
    color::Colorer,
    light::Lights,
    occlusion::Occlusion,
    paint::{Painter, Seen, Tools},
    screen::Screen,
    shadow::Shadows,
    tile::Tile,
    trace::tracer,
    triangles::Triangles,
};
use crate::{Error, Result, math::SimdLevel, progress::Progress, voxelize::finder};

/// One pixel of a [`Frame`].
#[derive(Clone, Copy)]
struct Pixel {
    rgba: [f32; 4],
    depth: f32,
    normal: [f32; 3],
    position: [f32; 3],
    surface: f32,
    curvature: f32,
    certificate: f32,
}

impl Pixel {
    /// No surface and no light.
    const EMPTY: Self = Self {
        rgba: [0.0; 4],
        depth: Frame::FAR,
        normal: [0.0; 3],
        position: [0.0; 3],
        surface: 0.0,
        curvature: 0.0,
        certificate: 0.0,
    };
}

/// The nearest point that a pixel shows.
#[derive(Clone, Copy)]
struct Shown {
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
    layers: &[Layer<'_>],
    models: &[Model],
    camera: &Camera,
    image: &ImageSettings,
    simd: SimdLevel,
    progress: &dyn Progress,
) -> Result<(Frame, OnDemandCount)> {
    let empty = image.background.map_or([0.0; 4], |[r, g, b]| [r, g, b, 1.0]);
    let mut frame = Frame::filled(image.width, image.height, empty);
    if frame.rgba.is_empty() {
        return Ok((frame, OnDemandCount::default()));
    }
    let tools = || Tools { tracer: tracer(simd), finder: finder(simd) };
    let occlusion = if image.occlusion > 0.0 {
        let screen = Screen::new(camera, image.width, image.height, 1);
        let drawn = OnScreen::new(layers, models, &screen, image, simd)?;
        Some(Occlusion::new(&drawn.painter(), &screen, tools, progress)?)
    } else {
        None
    };
    let screen = &Screen::new(camera, image.width, image.height, image.samples);
    let drawn = OnScreen::new(layers, models, screen, image, simd)?;
    let painter = drawn.painter();
    let lights = Lights::new(image, screen);
    let of_layers = layers.iter().map(|layer| layer.material);
    let materials = of_layers.chain(models.iter().map(|model| model.material)).collect();
    let colorer = Colorer::new(layers, image.shade);
    let shadows = Shadows::new(layers, models, image, screen, simd);
    let shader = Shader { materials, colorer, screen, shadows, occlusion, lights, image, empty };
    let (n_columns, n_rows) = screen.n_tiles();
    progress.begin("rasterize", (n_columns * n_rows) as u64, "tiles");
    let width = image.width as usize;
    let rows = screen.tile_edge / screen.samples;
    let n = width * rows;
    let Frame { rgba, depth, normal, position, surface, curvature, certificate, .. } = &mut frame;
    rgba.par_chunks_mut(n)
        .zip(depth.par_chunks_mut(n))
        .zip(normal.par_chunks_mut(n))
        .zip(position.par_chunks_mut(n))
        .zip(surface.par_chunks_mut(n))
        .zip(curvature.par_chunks_mut(n))
        .zip(certificate.par_chunks_mut(n))
        .enumerate()
        .try_for_each(|(row, planes)| {
            let ((((((rgba, depth), normal), position), surface), curvature), certificate) = planes;
            let tiles: Result<Vec<Vec<Pixel>>> = (0..n_columns)
                .into_par_iter()
                .map_init(tools, |tools, column| {
                    if progress.is_cancelled() {
                        return Err(Error::Interrupted);
                    }
                    let tile = screen.tile(column, row);
                    let mut seen = painter.paint((column, row), &tile, tools);
                    shader.light(&painter, (column, row), &tile, &mut seen, tools);
                    progress.advance(1);
                    let mut pixels = shader.pixels(&tile, &seen);
                    if image.certificate {
                        add_certificates(&painter, (column, row), &mut pixels, tools);
                    }
                    if image.curvature {
                        add_curvatures(&painter, (column, row), &mut pixels, tools);
                    }
                    Ok(pixels.into_iter().map(|(pixel, _)| pixel).collect())
                })
                .collect();
            for (column, pixels) in tiles?.into_iter().enumerate() {
                let first = column * rows;
                let columns = rows.min(width - first);
                for (i, pixel) in pixels.into_iter().enumerate() {
                    let at = i / columns * width + first + i % columns;
                    rgba[at] = pixel.rgba;
                    depth[at] = pixel.depth;
                    normal[at] = pixel.normal;
                    position[at] = pixel.position;
                    surface[at] = pixel.surface;
                    curvature[at] = pixel.curvature;
                    certificate[at] = pixel.certificate;
                }
            }
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
    shade: Shade,
}

impl<'a> OnScreen<'a> {
    fn new(
        layers: &'a [Layer<'a>],
        models: &'a [Model],
        screen: &'a Screen,
        image: &ImageSettings,
        simd: SimdLevel,
    ) -> Result<Self> {
        let blocks = Blocks::new(layers, screen, simd);
        if image.shade != Shade::Refine && blocks.most_of_a_tile() > MAX_BLOCKS {
            return Err(Error::Limit(
                "a part of the picture shows too many voxels at once; write shade = \"refine\" in \
                 [image], or lower `resolution` in [voxels]"
                    .to_owned(),
            ));
        }
        let near = layers.iter().map(Layer::near).fold(f64::INFINITY, f64::min);
        let triangles = Triangles::new(models, screen, near);
        let maker = BlockMaker::new(layers, screen, image);
        Ok(Self { maker, blocks, triangles, shade: image.shade })
    }

    fn painter(&self) -> Painter<'_> {
        let Self { maker, blocks, triangles, shade } = self;
        Painter { maker: *maker, blocks, triangles, shade: *shade }
    }
}

/// Everything that lighting a sample needs to know.
struct Shader<'a> {
    /// Of the layers, then of the models.
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

    /// The pixels of a tile, row by row, each with the nearest point that it shows.
    fn pixels(&self, tile: &Tile, seen: &[Option<Seen>]) -> Vec<(Pixel, Option<Shown>)> {
        let samples = self.screen.samples;
        let n_rows = tile.rows.len() / samples;
        let n_columns = tile.columns.len() / samples;
        let mut pixels = Vec::with_capacity(n_rows * n_columns);
        for row in 0..n_rows {
            for column in 0..n_columns {
                let rows = (row * samples..(row + 1) * samples).map(|row| row * tile.columns.len());
                let of_row = |row: usize| (0..samples).map(move |i| row + column * samples + i);
                pixels.push(self.pixel(tile, seen, rows.flat_map(of_row)));
            }
        }
        pixels
    }

    /// The mean of some samples, and the nearest of them.
    fn pixel(
        &self,
        tile: &Tile,
        seen: &[Option<Seen>],
        samples: impl Iterator<Item = usize>,
    ) -> (Pixel, Option<Shown>) {
        let mut sum = [0.0_f64; 4];
        let mut nearest: Option<(usize, Seen)> = None;
        for sample in samples {
            let rgba = seen[sample].map_or(self.empty, |seen| self.lit(tile, sample, &seen));
            (0..4).for_each(|c| sum[c] += f64::from(rgba[c]));
            if let Some(seen) = seen[sample]
                && nearest.is_none_or(|(_, other)| seen.depth < other.depth)
            {
                nearest = Some((sample, seen));
            }
        }
        let n = (self.screen.samples * self.screen.samples) as f64;
        let rgba = sum.map(|channel| (channel / n) as f32);
        let Some((sample, seen)) = nearest else {
            return (Pixel { rgba, ..Pixel::EMPTY }, None);
        };
        let (column, row) = tile.place(sample);
        let point = self.screen.eye + self.screen.ray(column, row).at(seen.depth);
        let pixel = Pixel {
            rgba,
            depth: seen.depth as f32,
            normal: seen.normal.as_vec3().to_array(),
            position: point.as_vec3().to_array(),
            surface: (seen.layer + 1) as f32,
            curvature: 0.0,
            certificate: f32::from(u8::from(seen.certified == Some(true))),
        };
        let is_open = seen.certified.is_none();
        (pixel, Some(Shown { block: seen.block, point, voxel_size: seen.voxel_size, is_open }))
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
    pixels: &mut [(Pixel, Option<Shown>)],
    tools: &mut Tools,
) {
    let points = pixels.iter().enumerate().filter_map(|(i, (_, shown))| {
        let Shown { block, point, .. } = shown.filter(|shown| shown.is_open)?;
        Some((i, (block?, point)))
    });
    let (places, points): (Vec<usize>, Vec<(u32, DVec3)>) = points.unzip();
    for (i, is_certified) in places.into_iter().zip(painter.certificates(place, &points, tools)) {
        pixels[i].0.certificate = f32::from(u8::from(is_certified));
    }
}

/// Adds the curvatures at the points that pixels show.
fn add_curvatures(
    painter: &Painter<'_>,
    place: (usize, usize),
    pixels: &mut [(Pixel, Option<Shown>)],
    tools: &mut Tools,
) {
    let points = pixels.iter().enumerate().filter_map(|(i, (_, shown))| {
        let Shown { block, point, voxel_size, .. } = (*shown)?;
        Some((i, (block?, point, voxel_size)))
    });
    let (places, points): (Vec<usize>, Vec<(u32, DVec3, f64)>) = points.unzip();
    for (i, curvature) in places.into_iter().zip(painter.curvatures(place, &points, tools)) {
        pixels[i].0.curvature = curvature as f32;
    }
}
