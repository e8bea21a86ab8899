//! Pieces of the picture that are drawn one at a time, each by one thread, and what may show in
//! each.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::{Layer, screen::Screen};
use crate::octree::Part;

/// A rectangle of samples.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Tile {
    pub(super) columns: Range<usize>,
    pub(super) rows: Range<usize>,
}

impl Tile {
    pub(super) fn n_samples(&self) -> usize {
        self.columns.len() * self.rows.len()
    }

    /// The number in the tile of a sample of the screen.
    #[inline]
    pub(super) fn sample(&self, column: usize, row: usize) -> usize {
        (row - self.rows.start) * self.columns.len() + (column - self.columns.start)
    }

    /// Column and row on the screen of a sample of the tile.
    #[inline]
    pub(super) fn place(&self, sample: usize) -> (usize, usize) {
        let width = self.columns.len();
        (self.columns.start + sample % width, self.rows.start + sample / width)
    }

    /// What both share, if anything.
    pub(super) fn intersection(&self, other: &Self) -> Option<Self> {
        let both = |a: &Range<usize>, b: &Range<usize>| a.start.max(b.start)..a.end.min(b.end);
        let (columns, rows) = (both(&self.columns, &other.columns), both(&self.rows, &other.rows));
        (!columns.is_empty() && !rows.is_empty()).then_some(Self { columns, rows })
    }
}

/// Voxels that are drawn together: those of a node of the octree.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// The number of their layer.
    pub(super) layer: usize,
    pub(super) part: Part,
    /// The samples that they may touch.
    pub(super) extent: Tile,
    /// No voxel of it is nearer.
    pub(super) nearest: f64,
}

/// Which of some things each tile of the screen may show, in their order.
pub(super) struct TileLists {
    n_columns: usize,
    /// By tile, row by row.
    lists: Vec<Vec<u32>>,
}

impl TileLists {
    /// From the samples that each thing may touch.
    pub(super) fn new<'a>(screen: &Screen, extents: impl Iterator<Item = &'a Tile>) -> Self {
        let edge = screen.tile_edge;
        let (n_columns, n_rows) = screen.n_tiles();
        let mut lists = vec![Vec::new(); n_columns * n_rows];
        for (number, Tile { columns, rows }) in extents.enumerate() {
            for row in rows.start / edge..rows.end.div_ceil(edge) {
                for column in columns.start / edge..columns.end.div_ceil(edge) {
                    lists[row * n_columns + column].push(number as u32);
                }
            }
        }
        Self { n_columns, lists }
    }

    /// The numbers of what the tile in a column and a row of tiles may show.
    pub(super) fn of_tile(&self, (column, row): (usize, usize)) -> impl Iterator<Item = usize> {
        self.lists[row * self.n_columns + column].iter().map(|&i| i as usize)
    }
}

/// The blocks of all layers from front to back, and which of them each tile may show.
pub(super) struct Blocks {
    all: Vec<Block>,
    of_tiles: TileLists,
}

impl Blocks {
    pub(super) fn new(layers: &[Layer<'_>], screen: &Screen) -> Self {
        let mut all: Vec<Block> = Vec::new();
        for (number, layer) in layers.iter().enumerate() {
            let parts = layer.storage.parts();
            let blocks =
                parts.into_par_iter().filter_map(|part| block(layer, number, part, screen));
            all.par_extend(blocks);
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
}

/// A part of a layer, unless it is out of the picture.
fn block(layer: &Layer<'_>, number: usize, part: Part, screen: &Screen) -> Option<Block> {
    let lattice = layer.lattice;
    let levels_up = layer.storage.depth() - part.level;
    let corner = |end: u32| {
        DVec3::from_array([0, 1, 2].map(|axis| {
            lattice.corner(axis, (part.ijk[axis] + end) << levels_up) - screen.eye[axis]
        }))
    };
    let (min, max) = (corner(0), corner(1));
    let half = 0.5 * (max - min) + DVec3::splat(1e-6 * lattice.voxel_size());
    let near = layer.near();
    let footprint = screen.footprint(0.5 * (min + max), screen.extent(half), near)?;
    let extent = Tile { columns: footprint.columns, rows: footprint.rows };
    Some(Block { layer: number, part, extent, nearest: footprint.nearest })
}
