//! Blocks: voxels that are drawn together, stored or found when the first tile asks for them.

use std::sync::{Arc, OnceLock};

use glam::DVec3;
use rayon::prelude::*;

use super::{
    Layer, Source,
    screen::Screen,
    tile::{Tile, TileLists},
    trace::{Trace, Traced},
    walk::Cells,
};
use crate::{
    expr::Tape,
    math::{Aabb, Lattice, SimdLevel},
    octree::{Part, Storage},
    voxelize::{BLOCK_LEVELS, BlockVoxels, Effort, FindVoxels, Octant, Wish, find_blocks},
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
    /// In the layer's storage.
    Part(Part),
    /// To be found.
    Octant(Box<(Octant, OnceLock<Found>)>),
}

/// The voxels of a block that was asked for.
struct Found {
    voxels: BlockVoxels,
    cells: Cells,
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
}

impl BlockView<'_> {
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
}

impl BlockMaker<'_> {
    /// Calls `look` with the voxels of a block and their cells, found by `finder` if need be.
    pub(super) fn with<T>(
        &self,
        block: &Block,
        finder: &mut dyn FindVoxels,
        look: impl FnOnce(BlockView<'_>, &Cells) -> T,
    ) -> T {
        let layer = &self.layers[block.layer];
        match (&block.place, layer.source) {
            (Place::Part(part), Source::Stored(storage)) => {
                let view = BlockView { storage, lattice: layer.lattice, part: *part };
                look(view, &self.cells(view, layer.lattice))
            }
            (Place::Octant(octant), _) => {
                let (octant, found) = &**octant;
                let Found { voxels, cells } = found.get_or_init(|| {
                    let voxels = finder.find(octant, layer.lattice);
                    let cells = self.cells(view_of(&voxels), layer.lattice);
                    Found { voxels, cells }
                });
                look(view_of(voxels), cells)
            }
            (Place::Part(_), Source::OnDemand { .. }) => {
                unreachable!("parts are those of a storage")
            }
        }
    }

    /// The voxels of a block for which [`BlockMaker::with`] was called before.
    pub(super) fn view<'b>(&'b self, block: &'b Block) -> Option<BlockView<'b>> {
        let layer = &self.layers[block.layer];
        match (&block.place, layer.source) {
            (Place::Part(part), Source::Stored(storage)) => {
                Some(BlockView { storage, lattice: layer.lattice, part: *part })
            }
            (Place::Octant(octant), _) => octant.1.get().map(|found| view_of(&found.voxels)),
            _ => None,
        }
    }

    /// The cells of a block's voxels, cut to the domain.
    fn cells(&self, view: BlockView<'_>, domain: &Lattice) -> Cells {
        let eye = self.screen.eye;
        let first = view.first();
        let corner = [0, 1, 2].map(|axis| view.lattice.corner(axis, first[axis]));
        let origin = DVec3::from_array(corner) - eye;
        let mut cells = Cells::new(origin, view.lattice.voxel_size(), domain.bounds().max - eye);
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

fn view_of(voxels: &BlockVoxels) -> BlockView<'_> {
    let part = Part { level: 0, index: 0, ijk: [0; 3] };
    BlockView { storage: &voxels.octree, lattice: &voxels.lattice, part }
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
                Source::Stored(storage) => {
                    let block = |part| stored(layer, storage, number, part, screen);
                    all.par_extend(storage.parts().into_par_iter().filter_map(block));
                }
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
            let Place::Octant(octant) = &block.place else { continue };
            let (Octant { level, .. }, Some(Found { voxels, .. })) = (&octant.0, octant.1.get())
            else {
                continue;
            };
            count.voxels += u64::from(voxels.octree.voxel_count());
            count.certified += u64::from(voxels.octree.certified_count());
            count.effort.add_below(*level, &voxels.effort);
        }
        count
    }
}

/// A part of a storage, unless it is out of the picture.
fn stored(
    layer: &Layer<'_>,
    storage: &dyn Storage,
    number: usize,
    part: Part,
    screen: &Screen,
) -> Option<Block> {
    let levels_up = storage.depth() - part.level;
    let corner = |end: u32| {
        let plane = |axis: usize| layer.lattice.corner(axis, (part.ijk[axis] + end) << levels_up);
        DVec3::from_array([0, 1, 2].map(plane))
    };
    let bounds = Aabb { min: corner(0), max: corner(1) };
    block(layer, number, &bounds, screen, Place::Part(part))
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
        let place = Place::Octant(Box::new((octant, OnceLock::new())));
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
    if let Place::Octant(octant) = &place {
        let _ = tape.set(octant.0.tape.clone());
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
