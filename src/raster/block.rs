//! Blocks: voxels that are drawn together, stored or found when the first tile asks for them.

use std::{
    borrow::Cow,
    collections::HashMap,
    sync::{Arc, OnceLock},
};

use glam::DVec3;
use rayon::prelude::*;

use super::{
    ImageSettings, Layer, Shade, Source,
    screen::Screen,
    sweep::SweptCell,
    tile::{Tile, TileLists},
    trace::{Trace, Traced},
    walk::Cells,
};
use crate::{
    expr::Tape,
    math::{Aabb, Lattice, SimdLevel},
    octree::{Detail, DetailLevel, Part, Storage},
    voxelize::{
        BLOCK_LEVELS, BRICK_LEVELS, BlockVoxels, Cell, CellBounds, CellGroup, Effort, FindVoxels,
        Octant, Wish, find_blocks,
    },
};

/// Cells may be this large, in pixels, where voxels are smaller or as small as is wanted.
const CELL_PX: f64 = 1.0;

/// Cells are not made smaller than this many steps of f64 at their coordinates.
const MIN_CELL_STEPS: f64 = 1024.0;

/// Voxels of a block are counted in so many bits.
pub(super) const RANK_BITS: u32 = 3 * BLOCK_LEVELS;

/// So many blocks of a tile can be told apart by what is left of 32 bits.
pub(super) const MAX_BLOCKS: usize = 1 << (32 - RANK_BITS);

/// Where the voxels of a block are.
enum Place {
    /// In the layer's storage: at so many levels above the finest.
    Part(u32, Part),
    /// To be found.
    Octant(Box<OnDemand>),
}

/// A block whose voxels and cells are found when the first asks for them.
struct OnDemand {
    octant: Octant,
    voxels: OnceLock<FoundVoxels>,
    cells: OnceLock<FoundCells>,
}

/// The voxels of a block that was asked for.
struct FoundVoxels {
    voxels: BlockVoxels,
    cells: Cells,
}

/// The cells of a block that was asked for, which are larger than voxels.
pub(super) struct FoundCells {
    cells: Cells,
    /// By tapes that they share, each from front to back.
    pub(super) groups: Vec<(Arc<Tape>, Vec<SweptCell>)>,
    /// Edge of a voxel.
    pub(super) voxel_size: f64,
    effort: Effort,
}

/// Voxels that are drawn together: those of an octant.
pub(super) struct Block {
    /// The number of their layer.
    pub(super) layer: usize,
    place: Place,
    /// The formula in it, once it was asked for.
    tape: OnceLock<Arc<Tape>>,
    /// The samples that they may touch.
    pub(super) extent: Tile,
    /// No voxel of it is nearer.
    pub(super) nearest: f64,
}

impl Block {
    /// The layer's formula, which is that of `whole`, shortened to the block, if that can be. It is
    /// the same whoever asks first.
    pub(super) fn tape(&self, whole: &Traced<'_>, tracer: &mut dyn Trace) -> Option<Arc<Tape>> {
        let shorten = || Arc::new(tracer.shortened(whole));
        (whole.tape.n_choices() > 0).then(|| self.tape.get_or_init(shorten).clone())
    }
}

/// The voxels of a block.
#[derive(Clone, Copy)]
pub(super) struct BlockView<'b> {
    pub(super) storage: &'b dyn Storage,
    pub(super) lattice: &'b Lattice,
    pub(super) part: Part,
    /// The level of a storage that they are from.
    level: Option<DetailLevel<'b>>,
}

impl<'b> BlockView<'b> {
    fn of_part(detail: &'b Detail<'_>, up: u32, part: Part) -> Self {
        let level = detail.level(up);
        let DetailLevel { storage, lattice, .. } = level;
        Self { storage, lattice, part, level: Some(level) }
    }

    fn of_voxels(BlockVoxels { octree, lattice, .. }: &'b BlockVoxels) -> Self {
        let part = Part { level: 0, index: 0, ijk: [0; 3] };
        Self { storage: octree, lattice, part, level: None }
    }

    /// How much the normals in the voxel at `rank` agree, in [0, 1].
    pub(super) fn coherence(&self, rank: u32) -> f64 {
        self.level.map_or(1.0, |level| level.coherence(rank))
    }

    /// Lattice coordinates of the block's first voxel.
    pub(super) fn first(&self) -> [u32; 3] {
        self.part.ijk.map(|i| i << (self.storage.depth() - self.part.level))
    }
}

/// What blocks are made from and drawn with.
#[derive(Clone, Copy)]
pub(super) struct BlockMaker<'a> {
    pub(super) layers: &'a [Layer<'a>],
    pub(super) screen: &'a Screen,
    /// Whether voxels are drawn that are not certified.
    pub(super) candidates: bool,
    /// Whether rays are followed through cells that are larger than voxels.
    pub(super) by_cells: bool,
}

impl<'a> BlockMaker<'a> {
    pub(super) fn new(layers: &'a [Layer<'a>], screen: &'a Screen, image: &ImageSettings) -> Self {
        let is_found = |layer: &Layer<'_>| {
            layer.tape.is_some() && matches!(layer.source, Source::OnDemand { .. })
        };
        let candidates = image.candidates;
        let by_cells = candidates && image.shade == Shade::Refine && layers.iter().all(is_found);
        Self { layers, screen, candidates, by_cells }
    }

    /// The voxels of a block, found by `finder` if need be.
    pub(super) fn open<'b>(
        &'b self,
        block: &'b Block,
        finder: &mut dyn FindVoxels,
    ) -> BlockView<'b> {
        if let Place::Octant(place) = &block.place {
            let lattice = self.layers[block.layer].lattice;
            place.voxels.get_or_init(|| {
                let voxels = finder.find(&place.octant, lattice);
                let cells = self.cells_in(BlockView::of_voxels(&voxels), lattice);
                FoundVoxels { voxels, cells }
            });
        }
        self.view(block)
    }

    /// The voxels of a block that was opened before.
    pub(super) fn view<'b>(&'b self, block: &'b Block) -> BlockView<'b> {
        match (&block.place, self.layers[block.layer].source) {
            (Place::Part(up, part), Source::Stored(detail)) => {
                BlockView::of_part(detail, *up, *part)
            }
            (Place::Octant(place), _) => match place.voxels.get() {
                Some(found) => BlockView::of_voxels(&found.voxels),
                None => unreachable!("it was opened"),
            },
            (Place::Part(..), Source::OnDemand { .. }) => {
                unreachable!("parts are those of a storage")
            }
        }
    }

    /// The cells of a block that rays are followed through, found by `finder` if need be.
    pub(super) fn cells<'b>(
        &'b self,
        block: &'b Block,
        finder: &mut dyn FindVoxels,
    ) -> Cow<'b, Cells> {
        let Place::Octant(place) = &block.place else {
            let cells = self.cells_in(self.view(block), self.layers[block.layer].lattice);
            return Cow::Owned(cells);
        };
        if self.by_cells {
            return Cow::Borrowed(&self.bounded(block, place, finder).cells);
        }
        self.open(block, finder);
        match place.voxels.get() {
            Some(found) => Cow::Borrowed(&found.cells),
            None => unreachable!("it was opened"),
        }
    }

    /// The cells of a block on demand, with bounds.
    pub(super) fn swept<'b>(
        &self,
        block: &'b Block,
        finder: &mut dyn FindVoxels,
    ) -> Option<&'b FoundCells> {
        match &block.place {
            Place::Octant(place) => Some(self.bounded(block, place, finder)),
            Place::Part(..) => None,
        }
    }

    fn bounded<'b>(
        &self,
        block: &Block,
        place: &'b OnDemand,
        finder: &mut dyn FindVoxels,
    ) -> &'b FoundCells {
        place.cells.get_or_init(|| {
            let domain = self.layers[block.layer].lattice;
            let size = domain.octant_edge(place.octant.level + BLOCK_LEVELS - BRICK_LEVELS);
            let bounds = domain.bounds();
            let eye = self.screen.eye;
            let farthest = bounds.min.abs().max(bounds.max.abs()) + eye.abs();
            // What any coordinate may be off by where a ray is followed.
            let rounding = 8.0 * f64::EPSILON * (farthest.max_element() + self.screen.radius);
            let margin = 1e-6 * size + 4.0 * rounding;
            let found = finder.find_cells(&place.octant, domain, margin);
            let lattice = &found.lattice;
            let origin = DVec3::from_array([0, 1, 2].map(|axis| lattice.corner(axis, 0))) - eye;
            let side = 1 << (BLOCK_LEVELS - BRICK_LEVELS);
            let mut cells = Cells::new(origin, size, side, bounds.max - eye);
            let slack = 1e-9 * size + rounding;
            let forward = self.screen.forward;
            let end = cells.end();
            let mut swept = |cell: &Cell| {
                cells.insert(cell.ijk);
                let corner = |end: u32| {
                    let plane = |axis: usize| lattice.corner(axis, cell.ijk[axis] + end);
                    DVec3::from_array([0, 1, 2].map(plane)) - eye
                };
                let bounds = cell.bounds.map(|bounds| from_eye(bounds, eye, size, rounding));
                let in_region = cell.in_region;
                let (lo, hi) = (corner(0) - slack, corner(1).min(end) + slack);
                SweptCell { lo, hi, bounds, in_region }
            };
            let depth = |cell: &SweptCell| forward.dot(cell.lo + cell.hi);
            let group = |CellGroup { tape, cells }: CellGroup| {
                let mut group: Vec<SweptCell> = cells.iter().map(&mut swept).collect();
                group.sort_unstable_by(|a, b| depth(a).total_cmp(&depth(b)));
                (tape, group)
            };
            let mut groups: Vec<_> = found.groups.into_iter().map(group).collect();
            groups.sort_by(|(_, a), (_, b)| depth(&a[0]).total_cmp(&depth(&b[0])));
            let voxel_size = size / f64::from(1_u32 << BRICK_LEVELS);
            FoundCells { cells, groups, voxel_size, effort: found.effort }
        })
    }

    /// The cells of a block's voxels, cut to the domain.
    fn cells_in(&self, view: BlockView<'_>, domain: &Lattice) -> Cells {
        let eye = self.screen.eye;
        let first = view.first();
        let corner = [0, 1, 2].map(|axis| view.lattice.corner(axis, first[axis]));
        let origin = DVec3::from_array(corner) - eye;
        let (size, side) = (view.lattice.voxel_size(), 1 << BLOCK_LEVELS);
        let mut cells = Cells::new(origin, size, side, domain.bounds().max - eye);
        if view.storage.voxel_count() > 0 {
            view.storage.visit(view.part, &mut |voxel| {
                if self.candidates || voxel.certified {
                    cells.insert([0, 1, 2].map(|axis| voxel.ijk[axis] - first[axis]));
                }
            });
        }
        cells
    }
}

/// What was found of layers whose voxels are found on demand.
#[derive(Clone, Debug, Default)]
pub struct OnDemandCount {
    /// Voxels.
    pub voxels: u64,
    /// Those that the surface provably passes through.
    pub certified: u64,
    /// What it took.
    pub effort: Effort,
}

/// The blocks of all layers from front to back, and which of them each tile may show.
pub(super) struct Blocks {
    all: Vec<Block>,
    of_tiles: TileLists,
}

impl Blocks {
    pub(super) fn new(layers: &[Layer<'_>], screen: &Screen, simd: SimdLevel) -> Self {
        let mut all: Vec<Block> = Vec::new();
        for (number, layer) in layers.iter().enumerate() {
            match layer.source {
                Source::Stored(detail) => all.extend(stored(layer, detail, number, screen)),
                Source::OnDemand { is_auto } => {
                    all.extend(on_demand(layer, number, is_auto, screen, simd));
                }
            }
        }
        // So that most of what is hidden finds out early.
        all.sort_by(|a, b| a.nearest.total_cmp(&b.nearest));
        let of_tiles = TileLists::new(screen, all.iter().map(|block| &block.extent));
        Self { all, of_tiles }
    }

    /// The blocks that the tile in a column and a row of tiles may show, from front to back.
    pub(super) fn of_tile(&self, place: (usize, usize)) -> impl Iterator<Item = &Block> {
        self.of_tiles.of_tile(place).map(|i| &self.all[i])
    }

    /// The most blocks that a tile may show.
    pub(super) fn most_of_a_tile(&self) -> usize {
        self.of_tiles.longest()
    }

    /// What was found on demand.
    pub(super) fn count(&self) -> OnDemandCount {
        let mut count = OnDemandCount::default();
        for block in &self.all {
            let Place::Octant(place) = &block.place else { continue };
            let level = place.octant.level;
            if let Some(FoundVoxels { voxels, .. }) = place.voxels.get() {
                count.voxels += u64::from(voxels.octree.voxel_count());
                count.certified += u64::from(voxels.octree.certified_count());
                count.effort.add_below(level, &voxels.effort);
            }
            if let Some(FoundCells { effort, .. }) = place.cells.get() {
                count.effort.add_below(level, effort);
            }
        }
        count
    }
}

/// The parts of a storage that may show, each of the coarsest level whose voxels are no larger than
/// pixels.
fn stored(layer: &Layer<'_>, detail: &Detail<'_>, number: usize, screen: &Screen) -> Vec<Block> {
    let finest = detail.level(0);
    let bounds = |up: u32, part: &Part| {
        let levels = finest.storage.depth() - part.level;
        let corner = |end: u32| {
            let plane = |axis: usize| {
                let node = (part.ijk[axis] >> up) + end;
                layer.lattice.corner(axis, node << (levels + up))
            };
            DVec3::from_array([0, 1, 2].map(plane))
        };
        Aabb { min: corner(0), max: corner(1) }
    };
    // The larger a node, the nearer it comes: what is too large for some level is for all above.
    let is_fine = |up: u32, part: &Part| {
        let voxel = layer.lattice.voxel_size() * f64::from(1_u32 << up);
        extent(&bounds(up, part), screen, layer.near(), 0.0)
            .is_some_and(|(_, nearest)| voxel <= CELL_PX * screen.pixel_size(nearest))
    };
    let level_of = |part: &Part| {
        let coarser = 1..=detail.n_coarser().min(part.level);
        coarser.take_while(|&up| is_fine(up, part)).last().unwrap_or(0)
    };
    let parts = finest.storage.parts();
    let mut chosen: Vec<(u32, Part)> =
        parts.into_par_iter().map(|part| (level_of(&part), part)).collect();
    // Parts below one node are neighbours, and choose alike.
    let node = |&(up, part): &(u32, Part)| (up, part.ijk.map(|i| i >> up));
    chosen.dedup_by_key(|of_part| node(of_part));
    let mut nodes: HashMap<(u32, [u32; 3]), Part> = HashMap::new();
    for of_level in chosen.chunk_by(|a, b| a.0 == b.0) {
        let (up, part) = of_level[0];
        if up > 0 && !nodes.contains_key(&node(&(up, part))) {
            let of_level = detail.nodes(up, part.level - up).into_iter();
            nodes.extend(of_level.map(|node| ((up, node.ijk), node)));
        }
    }
    let make = |of_part: (u32, Part)| {
        let (up, part) = of_part;
        let place = Place::Part(up, nodes.get(&node(&of_part)).copied().unwrap_or(part));
        block(layer, number, &bounds(up, &part), screen, place)
    };
    chosen.into_par_iter().filter_map(make).collect()
}

/// The octants that may show, as blocks of cells of a pixel or a voxel.
fn on_demand(
    layer: &Layer<'_>,
    number: usize,
    is_auto: bool,
    screen: &Screen,
    simd: SimdLevel,
) -> Vec<Block> {
    let Layer { lattice, tape: Some(tape), .. } = *layer else { return Vec::new() };
    let near = layer.near();
    let wish = |level: u32, bounds: &Aabb| {
        let Some((_, nearest)) = extent(bounds, screen, near, 0.0) else { return Wish::Skip };
        let cell = lattice.octant_edge(level + BLOCK_LEVELS);
        let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
        let is_voxel = !is_auto && level + BLOCK_LEVELS >= lattice.depth();
        let is_fine = cell <= CELL_PX * screen.pixel_size(nearest);
        let is_limit = cell <= MIN_CELL_STEPS * f64::EPSILON * largest;
        if is_voxel || is_fine || is_limit { Wish::Keep } else { Wish::Divide }
    };
    let octants = find_blocks(tape.clone(), lattice, simd, &wish);
    let make = |octant: Octant| {
        let bounds = lattice.octant_bounds(octant.level, octant.ijk)?;
        let (voxels, cells) = (OnceLock::new(), OnceLock::new());
        let place = Place::Octant(Box::new(OnDemand { octant, voxels, cells }));
        block(layer, number, &bounds, screen, place)
    };
    octants.into_par_iter().filter_map(make).collect()
}

fn block(
    layer: &Layer<'_>,
    number: usize,
    bounds: &Aabb,
    screen: &Screen,
    place: Place,
) -> Option<Block> {
    let slack = 1e-6 * bounds.size().max_element();
    let (extent, nearest) = extent(bounds, screen, layer.near(), slack)?;
    let tape = OnceLock::new();
    if let Place::Octant(place) = &place {
        let _ = tape.set(place.octant.tape.clone());
    }
    Some(Block { layer: number, place, tape, extent, nearest })
}

/// The samples that a box may touch, and its least depth; `None` if it is out of the picture.
fn extent(bounds: &Aabb, screen: &Screen, near: f64, slack: f64) -> Option<(Tile, f64)> {
    let (min, max) = (bounds.min - screen.eye, bounds.max - screen.eye);
    let half = 0.5 * (max - min) + DVec3::splat(slack);
    let footprint = screen.footprint(0.5 * (min + max), screen.extent(half), near)?;
    Some((Tile { columns: footprint.columns, rows: footprint.rows }, footprint.nearest))
}

/// Bounds with their middle from the eye, where each coordinate may be off by `rounding`.
fn from_eye(bounds: CellBounds, eye: DVec3, size: f64, rounding: f64) -> CellBounds {
    let CellBounds { middle, value: [lo, hi], slopes } = bounds;
    let steepest: f64 = slopes.iter().map(|[lo, hi]| lo.abs().max(hi.abs())).sum();
    // Of the sums of products, each of a few roundings.
    let of_sums = 64.0 * f64::EPSILON * (lo.abs() + hi.abs() + steepest * size);
    let margin = of_sums + 4.0 * steepest * rounding;
    CellBounds { middle: middle - eye, value: [lo - margin, hi + margin], slopes }
}
