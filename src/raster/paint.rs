//! What every sample of a tile shows.
//!
//! *Refine* follows each ray through the voxels to the surface itself. *Voxel* and *slab* draw
//! voxels into a z-buffer; only at rims rays are followed too: a voxel covers what the surface in it
//! covers, and no more.

use glam::DVec3;

use super::{
    Layer, Shade, Source,
    block::{Block, BlockMaker, BlockView, Blocks, MAX_BLOCKS, RANK_BITS},
    light::Reach,
    resolve::{Shown, shown},
    screen::{Ray, Screen},
    sight::Sight,
    solids::Solids,
    splat::Splatter,
    sweep::{Sighting, Swept},
    tile::Tile,
    trace::{Meeting, Quest, Trace, Traced, tracer},
    triangles::Triangles,
    walk::{Cells, Span},
    zbuffer::{Hit, ZBuffer},
};
use crate::{
    math::SimdLevel,
    voxelize::{FindVoxels, finder},
};

/// What a sample shows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// The number of its layer.
    pub(super) layer: usize,
    pub(super) depth: f64,
    /// Outward, of length 1.
    pub(super) normal: DVec3,
    /// Whether the surface provably passes through the voxel, if that was asked.
    pub(super) certified: Option<bool>,
    /// Edge of the voxel.
    pub(super) voxel_size: f64,
    /// How much the normals in it agree, in [0, 1].
    pub(super) coherence: f64,
    /// The number of its block among those of the tile; `None` on models.
    pub(super) block: Option<u32>,
    /// What the material's colour is multiplied by.
    pub(super) tint: [f32; 3],
    /// The light that gets there.
    pub(super) reach: Reach,
}

impl Seen {
    /// Of a model or a solid, which have no voxels.
    pub(super) fn without_voxels(layer: usize, depth: f64, normal: DVec3, tint: [f32; 3]) -> Self {
        Self {
            layer,
            depth,
            normal,
            certified: Some(true),
            voxel_size: 0.0,
            coherence: 1.0,
            block: None,
            tint,
            reach: Reach::ALL,
        }
    }
}

/// The material's colour as it is.
pub(super) const UNTINTED: [f32; 3] = [1.0; 3];

/// What one thread paints with.
pub(super) struct Tools {
    pub(super) tracer: Box<dyn Trace>,
    pub(super) finder: Box<dyn FindVoxels>,
    /// What the last tile showed: memory for the next one.
    pub(super) seen: Vec<Option<Seen>>,
    sight: Sight,
}

impl Tools {
    pub(super) fn new(simd: SimdLevel) -> Self {
        let (tracer, finder) = (tracer(simd), finder(simd));
        Self { tracer, finder, seen: Vec::new(), sight: Sight::default() }
    }
}

/// Everything that painting a tile needs to know.
pub(super) struct Painter<'a> {
    pub(super) maker: BlockMaker<'a>,
    pub(super) blocks: &'a Blocks,
    pub(super) triangles: &'a Triangles<'a>,
    pub(super) solids: &'a Solids<'a>,
    pub(super) shade: Shade,
}

impl Painter<'_> {
    /// What each sample of the tile in the given column and row of tiles shows.
    pub(super) fn paint(
        &self,
        place: (usize, usize),
        tile: &Tile,
        tools: &mut Tools,
    ) -> Vec<Option<Seen>> {
        let blocks: Vec<&Block> = self.blocks.of_tile(place).collect();
        let mut seen = self.surfaces(&blocks, tile, tools);
        let (n_layers, n_models) = (self.layers().len(), self.triangles.n_models());
        self.triangles.draw(self.screen(), place, tile, n_layers, &mut seen);
        self.solids.draw(self.screen(), place, tile, n_layers + n_models, &mut seen);
        seen
    }

    /// The ray of a sample of the tile.
    pub(super) fn ray(&self, tile: &Tile, sample: usize) -> Ray {
        let (column, row) = tile.place(sample);
        self.screen().ray(column, row)
    }

    /// The point that a sample of the tile shows, in scene coordinates.
    pub(super) fn point(&self, tile: &Tile, sample: usize, seen: &Seen) -> DVec3 {
        self.screen().eye + self.ray(tile, sample).at(seen.depth)
    }

    fn layers(&self) -> &[Layer<'_>] {
        self.maker.layers
    }

    fn screen(&self) -> &Screen {
        self.maker.screen
    }

    /// What each sample shows of the surfaces.
    fn surfaces(&self, blocks: &[&Block], tile: &Tile, tools: &mut Tools) -> Vec<Option<Seen>> {
        // Only surfaces that have a formula can be traced.
        let has_formulas = self.layers().iter().all(|layer| layer.tape.is_some());
        match self.shade {
            Shade::GlPoint => {
                let mut zbuffer = ZBuffer::new(tile);
                let first_ranks = self.draw(blocks, tile, tools, &mut zbuffer, |splatter, z| {
                    splatter.points(tile, z)
                });
                let hits = (0..tile.n_samples()).map(|sample| zbuffer.met.get(sample));
                hits.map(|hit| hit.map(|hit| self.seen(blocks, &first_ranks, hit))).collect()
            }
            Shade::Refine if self.maker.by_cells => self.sweep(blocks, tile, tools),
            Shade::Refine if has_formulas => {
                let mut seen = vec![None; tile.n_samples()];
                let wanted = vec![f64::INFINITY; tile.n_samples()];
                self.trace(blocks, tile, wanted, tools, &mut seen, false);
                seen
            }
            Shade::Refine | Shade::Voxel | Shade::Slab | Shade::Status => {
                let mut seen = self.splat(blocks, tile, tools, has_formulas);
                if self.shade == Shade::Slab {
                    for (sample, seen) in seen.iter_mut().enumerate() {
                        if let Some(seen) = seen {
                            seen.normal = self.blended(blocks, tile, sample, seen);
                        }
                    }
                }
                seen
            }
        }
    }

    /// Draws blocks into the z-buffer, each with `draw`, unless they are hidden. Returns the rank of
    /// the first voxel of each.
    fn draw(
        &self,
        blocks: &[&Block],
        tile: &Tile,
        tools: &mut Tools,
        zbuffer: &mut ZBuffer,
        draw: impl Fn(&Splatter<'_>, &mut ZBuffer) -> u32,
    ) -> Vec<u32> {
        let mut first_ranks = vec![0; blocks.len()];
        for (number, block) in blocks.iter().enumerate() {
            let Some(part) = block.extent.intersection(tile) else { continue };
            if zbuffer.hides(tile, &part, block.nearest) {
                continue;
            }
            let near = self.layers()[block.layer].near();
            let first_id = first_id(number);
            let view = self.maker.open(block, &mut *tools.finder);
            let candidates = self.maker.candidates;
            let splatter = Splatter::new(view, first_id, self.screen(), near, candidates);
            first_ranks[number] = draw(&splatter, zbuffer);
        }
        first_ranks
    }

    /// What is known of the voxel of a hit.
    fn seen(&self, blocks: &[&Block], first_ranks: &[u32], Hit { depth, id }: Hit) -> Seen {
        let number = (id >> RANK_BITS) as usize;
        let block = blocks[number];
        let view = self.maker.view(block);
        let rank = first_ranks[number] + (id & ((1 << RANK_BITS) - 1));
        Seen {
            layer: block.layer,
            depth: f64::from(depth),
            normal: view.storage.normal(rank).decode(),
            certified: Some(view.storage.is_certified(rank)),
            voxel_size: view.lattice.voxel_size(),
            coherence: view.coherence(rank),
            block: Some(number as u32),
            tint: UNTINTED,
            reach: Reach::ALL,
        }
    }

    /// By voxels in a z-buffer.
    fn splat(
        &self,
        blocks: &[&Block],
        tile: &Tile,
        tools: &mut Tools,
        has_formulas: bool,
    ) -> Vec<Option<Seen>> {
        let mut zbuffer = ZBuffer::new(tile);
        let first_ranks = self.draw(blocks, tile, tools, &mut zbuffer, |splatter, zbuffer| {
            splatter.cubes(tile, zbuffer)
        });
        let of_sample = |sample| {
            let (column, row) = tile.place(sample);
            let (met, covered) = (zbuffer.met.get(sample), zbuffer.covered.get(sample));
            let seen = |hit| self.seen(blocks, &first_ranks, hit);
            shown(&self.screen().ray(column, row), met, covered, seen)
        };
        let shown: Vec<Option<Shown>> = (0..tile.n_samples()).map(of_sample).collect();
        let mut seen: Vec<_> = shown.iter().map(|shown| shown.map(|shown| shown.seen)).collect();
        if has_formulas {
            let is_met = |sample: usize| shown[sample].is_some_and(|shown| shown.is_met);
            let mut is_traced = vec![false; tile.n_samples()];
            // What a ray at a rim shows makes rims of its neighbours.
            loop {
                let is_new =
                    |&i: &usize| !is_traced[i] && self.is_at_rim(tile, &seen, i, is_met(i));
                let rims: Vec<usize> = (0..tile.n_samples()).filter(is_new).collect();
                if rims.is_empty() {
                    break;
                }
                let mut wanted = vec![f64::NEG_INFINITY; tile.n_samples()];
                for &sample in &rims {
                    wanted[sample] = f64::INFINITY;
                    is_traced[sample] = true;
                    seen[sample] = None;
                }
                self.trace(blocks, tile, wanted, tools, &mut seen, true);
            }
        }
        seen
    }

    /// What the samples show, by the cells of all blocks from front to back.
    fn sweep(&self, blocks: &[&Block], tile: &Tile, tools: &mut Tools) -> Vec<Option<Seen>> {
        let Tools { tracer, finder, seen, sight } = tools;
        let screen = self.screen();
        let mut seen = std::mem::take(seen);
        seen.clear();
        seen.resize(tile.n_samples(), None);
        sight.enter(screen, tile);
        let mut sightings: Vec<Sighting> = Vec::new();
        for (number, block) in (0..).zip(blocks) {
            let Some(part) = block.extent.intersection(tile) else { continue };
            if !sight.sees(&part, block.nearest) {
                continue;
            }
            let layer = &self.layers()[block.layer];
            let Some(found) = self.maker.swept(block, &mut **finder) else { continue };
            for (tape, cells) in &found.groups {
                sightings.clear();
                let swept = Swept { tape, cells, screen, near: layer.near() };
                tracer.sweep(&swept, sight, &mut sightings);
                sightings.retain(|sighting| sighting.depth == sight.met(sighting.place));
                let point = |s: &Sighting| screen.eye + sight.ray(s.place).at(s.depth);
                let points: Vec<DVec3> = sightings.iter().map(point).collect();
                let gradients = tracer.gradients(tape, &points);
                for ((sighting, gradient), &point) in sightings.iter().zip(gradients).zip(&points) {
                    let normal = unit(gradient).or_else(|| {
                        // Where F has no gradient the voxel's normal stands in.
                        let view = self.maker.open(block, &mut **finder);
                        let rank = view.storage.find(view.lattice.voxel_at(point))?;
                        Some(view.storage.normal(rank).decode())
                    });
                    seen[sight.sample(sighting.place)] = Some(Seen {
                        layer: block.layer,
                        depth: sighting.depth,
                        normal: normal.unwrap_or(DVec3::Z),
                        certified: None,
                        voxel_size: found.voxel_size,
                        coherence: 1.0,
                        block: Some(number),
                        tint: UNTINTED,
                        reach: Reach::ALL,
                    });
                }
            }
        }
        seen
    }

    /// Whether the surface provably passes through the voxels of points that a tile shows, each with
    /// the number of its block.
    pub(super) fn certificates(
        &self,
        place: (usize, usize),
        points: &[(u32, DVec3)],
        tools: &mut Tools,
    ) -> Vec<bool> {
        let blocks: Vec<&Block> = self.blocks.of_tile(place).collect();
        let of_point = |&(block, point): &(u32, DVec3)| {
            let view = self.maker.open(blocks[block as usize], &mut *tools.finder);
            let rank = view.storage.find(view.lattice.voxel_at(point));
            rank.is_some_and(|rank| view.storage.is_certified(rank))
        };
        points.iter().map(of_point).collect()
    }

    /// The mean curvature at points that a tile shows, each with the number of its block and the
    /// edge of its voxel; 0 where there is none.
    pub(super) fn curvatures(
        &self,
        place: (usize, usize),
        points: &[(u32, DVec3, f64)],
        tools: &mut Tools,
    ) -> Vec<f64> {
        let Tools { tracer, finder, .. } = tools;
        let blocks: Vec<&Block> = self.blocks.of_tile(place).collect();
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by_key(|&i| points[i].0);
        let mut curvatures = vec![0.0; points.len()];
        for of_block in order.chunk_by(|&a, &b| points[a].0 == points[b].0) {
            let block = blocks[points[of_block[0]].0 as usize];
            let Some(tape) = self.layers()[block.layer].tape else { continue };
            let of_points: Vec<(DVec3, f64)> =
                of_block.iter().map(|&i| (points[i].1, points[i].2)).collect();
            let cells = &*self.maker.cells(block, &mut **finder);
            let own = block.tape(&Traced { tape, cells, eye: self.screen().eye }, &mut **tracer);
            let found = tracer.curvatures(own.as_deref().unwrap_or(tape), &of_points);
            for (&i, curvature) in of_block.iter().zip(found) {
                curvatures[i] = curvature;
            }
        }
        curvatures
    }

    /// Whether the surface in a voxel may have ended before the ray of the sample that shows it.
    fn is_at_rim(&self, tile: &Tile, all: &[Option<Seen>], sample: usize, is_met: bool) -> bool {
        let Some(seen) = all[sample] else { return false };
        let (column, row) = tile.place(sample);
        let direction = self.screen().ray(column, row).direction;
        let is_grazed = seen.normal.dot(direction).abs() < GRAZING * direction.length();
        let is_border = column == tile.columns.start
            || column + 1 == tile.columns.end
            || row == tile.rows.start
            || row + 1 == tile.rows.end;
        if !is_met || is_grazed || is_border {
            return true;
        }
        let step = STEP_VOXELS * seen.voxel_size;
        let width = tile.columns.len();
        [sample - 1, sample + 1, sample - width, sample + width].into_iter().any(|neighbour| {
            all[neighbour].is_none_or(|other| (other.depth - seen.depth).abs() > step)
        })
    }

    /// Follows the rays of all samples to the surface, as far as `farthest` says, and notes what
    /// they meet in `seen`; with the normals of voxels, or those of the surface.
    fn trace(
        &self,
        blocks: &[&Block],
        tile: &Tile,
        mut farthest: Vec<f64>,
        tools: &mut Tools,
        seen: &mut [Option<Seen>],
        of_voxels: bool,
    ) {
        let Tools { tracer, finder, .. } = tools;
        let (mut quests, mut meetings): (Vec<Quest>, Vec<Meeting>) = (Vec::new(), Vec::new());
        for (number, block) in (0..).zip(blocks) {
            let Some(part) = block.extent.intersection(tile) else { continue };
            let layer = &self.layers()[block.layer];
            let Some(tape) = layer.tape else { continue };
            let is_open = |row: usize| {
                let first = tile.sample(part.columns.start, row);
                farthest[first..first + part.columns.len()].iter().any(|&d| d > block.nearest)
            };
            if !part.rows.clone().any(is_open) {
                continue;
            }
            let view = self.maker.open(block, &mut **finder);
            let cells = &*self.maker.cells(block, &mut **finder);
            let depths = self.depths(cells, layer.near(), &part);
            quests.clear();
            for row in part.rows.clone() {
                for column in part.columns.clone() {
                    let sample = tile.sample(column, row);
                    let Span { from, to } = depths[part.sample(column, row)];
                    let farthest = farthest[sample].min(to);
                    if from < farthest {
                        let ray = self.screen().ray(column, row);
                        quests.push(Quest { sample: sample as u32, ray, from, farthest });
                    }
                }
            }
            meetings.clear();
            let eye = self.screen().eye;
            let whole = Traced { tape, cells, eye };
            let own = block.tape(&whole, &mut **tracer);
            let traced = Traced { tape: own.as_deref().unwrap_or(tape), ..whole };
            tracer.trace(&traced, &quests, &mut meetings);
            let point = |meeting: &Meeting| {
                let (column, row) = tile.place(meeting.sample as usize);
                eye + self.screen().ray(column, row).at(meeting.depth)
            };
            let points: Vec<DVec3> = meetings.iter().map(point).collect();
            let gradients = tracer.gradients(traced.tape, &points);
            for (meeting, gradient) in meetings.iter().zip(gradients) {
                let sample = meeting.sample as usize;
                if meeting.depth < farthest[sample] {
                    farthest[sample] = meeting.depth;
                    let normal = (gradient, of_voxels);
                    seen[sample] = Some(self.met((number, block), view, tile, meeting, normal));
                }
            }
        }
    }

    /// Between which depths the ray of each sample of `part` can meet `cells`.
    fn depths(&self, cells: &Cells, near: f64, part: &Tile) -> Vec<Span> {
        let never = Span { from: f64::INFINITY, to: f64::NEG_INFINITY };
        let mut depths = vec![never; part.n_samples()];
        let (centers, half) = cells.boxes();
        let extent = self.screen().extent(DVec3::splat(half * (1.0 + 1e-6)));
        for center in centers {
            let Some(footprint) = self.screen().footprint(center, extent, near) else { continue };
            let touched = Tile { columns: footprint.columns, rows: footprint.rows };
            let Some(touched) = touched.intersection(part) else { continue };
            let (from, to) = (footprint.nearest, footprint.farthest);
            for row in touched.rows {
                let first = part.sample(touched.columns.start, row);
                for span in &mut depths[first..first + touched.columns.len()] {
                    span.from = if from < span.from { from } else { span.from };
                    span.to = if to > span.to { to } else { span.to };
                }
            }
        }
        depths
    }

    /// What a sample shows whose ray meets the surface, with the gradient there, or the voxel's
    /// normal if that is wanted.
    fn met(
        &self,
        (number, block): (u32, &Block),
        view: BlockView<'_>,
        tile: &Tile,
        meeting: &Meeting,
        (gradient, of_voxels): (DVec3, bool),
    ) -> Seen {
        let BlockView { storage, lattice, .. } = view;
        let (column, row) = tile.place(meeting.sample as usize);
        let point = self.screen().eye + self.screen().ray(column, row).at(meeting.depth);
        let depth = meeting.depth;
        let own = unit(gradient).filter(|_| !of_voxels);
        let rank = storage.find(lattice.voxel_at(point));
        let normal = own.or_else(|| rank.map(|rank| storage.normal(rank).decode()));
        Seen {
            layer: block.layer,
            depth,
            normal: normal.or_else(|| unit(gradient)).unwrap_or(DVec3::Z),
            certified: Some(rank.is_some_and(|rank| storage.is_certified(rank))),
            voxel_size: lattice.voxel_size(),
            coherence: 1.0,
            block: Some(number),
            tint: UNTINTED,
            reach: Reach::ALL,
        }
    }

    /// The normal between those of the voxels around, as far as they belong to the same sheet.
    fn blended(&self, blocks: &[&Block], tile: &Tile, sample: usize, seen: &Seen) -> DVec3 {
        let of_layer =
            seen.block.filter(|_| matches!(self.layers()[seen.layer].source, Source::Stored(_)));
        let view = of_layer.map(|number| self.maker.view(blocks[number as usize]));
        let Some(BlockView { storage, lattice, .. }) = view else { return seen.normal };
        let at =
            (self.point(tile, sample, seen) - lattice.bounds().min) / lattice.voxel_size() - 0.5;
        let (first, part) = (at.floor(), at - at.floor());
        let mut sum = DVec3::ZERO;
        for c in 0..8_u32 {
            let mut weight = 1.0;
            let mut ijk = [0; 3];
            for axis in 0..3 {
                let step = c >> axis & 1;
                weight *= if step == 1 { part[axis] } else { 1.0 - part[axis] };
                // Below the lattice this saturates at its first voxel.
                ijk[axis] = (first[axis] + f64::from(step)) as u32;
            }
            if let Some(rank) = storage.find(ijk) {
                let normal = storage.normal(rank).decode();
                if normal.dot(seen.normal) > 0.0 {
                    sum += weight * normal;
                }
            }
        }
        unit(sum).unwrap_or(seen.normal)
    }
}

/// Sine of the angle between ray and plane below which the ray may pass over the surface where it
/// meets the plane.
const GRAZING: f64 = 0.3;

/// Between neighbours whose depths differ by more voxels than this there may be a rim.
const STEP_VOXELS: f64 = 4.0;

/// A vector made of length 1; `None` if it has no direction.
fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    (v.is_finite() && largest > f64::MIN_POSITIVE).then(|| (v / largest).normalize())
}

/// The identity of the first voxel of a tile's block.
fn first_id(number: usize) -> u32 {
    assert!(number < MAX_BLOCKS, "checked before the first tile");
    (number as u32) << RANK_BITS
}
