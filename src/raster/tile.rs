//! Pieces of the picture that are drawn one at a time, each by one thread, and what may show in
//! each.

use std::ops::Range;

use super::screen::Screen;

/// A rectangle of samples.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
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

    /// The most things that a tile may show.
    pub(super) fn longest(&self) -> usize {
        self.lists.iter().map(Vec::len).max().unwrap_or(0)
    }

    /// The numbers of what the tile in a column and a row of tiles may show.
    pub(super) fn of_tile(&self, (column, row): (usize, usize)) -> impl Iterator<Item = usize> {
        self.lists[row * self.n_columns + column].iter().map(|&i| i as usize)
    }
}
