//! Runs of bricks, and the places of what they give to a mesh.

use std::ops::Range;

use super::{cuts::Cuts, grid::RUN};

/// The numbers of bricks, and the places of their vertices and triangles.
pub(super) type Part<'a, T> = (Range<usize>, &'a mut [T], &'a mut [[u32; 3]]);

/// Runs of bricks, each with the places of its vertices and of its triangles.
pub(super) fn shared_out<'a, T>(
    cuts: &[Cuts],
    mut vertices: &'a mut [T],
    mut triangles: &'a mut [[u32; 3]],
) -> Vec<Part<'a, T>> {
    let part = |(first, cuts): (usize, &[Cuts])| {
        let n_vertices: u32 = cuts.iter().map(Cuts::count).sum();
        let room = cuts.iter().map(Cuts::room).sum();
        let bricks = RUN * first..RUN * first + cuts.len();
        let own = vertices.split_off_mut(..n_vertices as usize).unwrap_or_default();
        (bricks, own, triangles.split_off_mut(..room).unwrap_or_default())
    };
    cuts.chunks(RUN).enumerate().map(part).collect()
}

/// Moves what parts have together, given how much each has room for and how much it has.
pub(super) fn close_up<T: Copy>(all: &mut Vec<T>, parts: &[[usize; 2]]) {
    let (mut start, mut end) = (0, 0);
    for &[room, n] in parts {
        if start > end {
            all.copy_within(start..start + n, end);
        }
        start += room;
        end += n;
    }
    all.truncate(end);
}
