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

/// The blocks of all layers, and which of them each tile of the screen may show.
pub(super) struct Blocks {
    pub(super) all: Vec<Block>,
    /// Tiles in a row.
    pub(super) n_columns: usize,
    /// Rows of tiles.
    pub(super) n_rows: usize,
    /// By tile, row by row: its blocks from front to back.
    of_tiles: Vec<Vec<u32>>,
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
        let edge = screen.tile_edge;
        let (n_columns, n_rows) = (screen.width.div_ceil(edge), screen.height.div_ceil(edge));
        let mut of_tiles = vec![Vec::new(); n_columns * n_rows];
        let mut order: Vec<u32> = (0..all.len() as u32).collect();
        // From front to back, so that most of what is hidden finds out early.
        order.sort_by(|&a, &b| all[a as usize].nearest.total_cmp(&all[b as usize].nearest));
        for number in order {
            let Tile { columns, rows } = &all[number as usize].extent;
            for row in rows.start / edge..rows.end.div_ceil(edge) {
                for column in columns.start / edge..columns.end.div_ceil(edge) {
                    of_tiles[row * n_columns + column].push(number);
                }
            }
        }
        Self { all, n_columns, n_rows, of_tiles }
    }

    /// The blocks that a tile may show, from front to back.
    pub(super) fn of_tile(&self, column: usize, row: usize) -> impl Iterator<Item = &Block> {
        self.of_tiles[row * self.n_columns + column].iter().map(|&i| &self.all[i as usize])
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
