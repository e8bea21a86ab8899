//! Degenerate cells: which there are, and that the ordinary table serves them.
//!
//! Around a corner of a voxel a large one may take two octants, or four. The table of such cells that
//! the thesis leaves to later work is derived here: of every way to share out the octants, and of every
//! case of what lies inside, the triangles that are left.
//!
//! *Based on:* A. León Salas, 2008, section 2.3, and what it leaves to later work.

use std::collections::{BTreeMap, BTreeSet};

use super::cases::{CASES, Loop, axis_of, lower_octant};

/// The voxel in each octant, by its lowest octant.
type Cell = [usize; 8];

/// All cells that octrees have: along one axis octants may be one in pairs, and in a plane with that
/// axis, as the larger voxels are the fewer planes they end at, four may be one. One voxel at least has
/// the corner.
fn cells() -> BTreeSet<Cell> {
    let mut cells = BTreeSet::new();
    for (first, second) in (0..9).map(|k| (k / 3, k % 3)).filter(|(a, b)| a != b) {
        let (pair, third) = (1 << first, 3 - first - second);
        // In each of two slabs: two pairs, each one voxel or two, or all four one voxel.
        for choice in 0..25 {
            let mut cell: Cell = std::array::from_fn(|octant| octant);
            for octant in 0..8 {
                let slab = [choice % 5, choice / 5][octant >> third & 1];
                let which = octant >> second & 1;
                if slab == 4 {
                    cell[octant] &= 1 << third;
                } else if slab >> which & 1 == 1 {
                    cell[octant] &= !pair;
                }
            }
            if (0..8).any(|octant| cell.iter().filter(|&&voxel| voxel == octant).count() == 1) {
                cells.insert(cell);
            }
        }
    }
    cells
}

fn n_voxels(cell: &Cell) -> usize {
    cell.iter().collect::<BTreeSet<_>>().len()
}

/// The ways to turn and to mirror a cell, as where octants go.
fn symmetries() -> Vec<[usize; 8]> {
    let axes = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let of = |axes: [usize; 3], flip: usize| {
        let goes = |octant: usize| {
            (0..3).fold(0, |to, axis| to | (octant >> axis & 1) << axes[axis]) ^ flip
        };
        std::array::from_fn(goes)
    };
    axes.into_iter().flat_map(|axes| (0..8).map(move |flip| of(axes, flip))).collect()
}

/// The same cell after a symmetry.
fn turned(cell: &Cell, goes: &[usize; 8]) -> Cell {
    let mut voxels = [0; 8];
    (0..8).for_each(|octant| voxels[goes[octant]] = goes[cell[octant]]);
    std::array::from_fn(|octant| {
        let same = (0..8).filter(|&other| voxels[other] == voxels[octant]);
        same.min().unwrap_or(octant)
    })
}

/// The cases of a cell in which each voxel is inside or not as a whole.
fn cases(cell: &Cell) -> impl Iterator<Item = u8> {
    (0..=u8::MAX)
        .filter(|inside| (0..8).all(|octant| inside >> octant & 1 == inside >> cell[octant] & 1))
}

/// The vertex on an edge: what joins the same two voxels is one.
fn vertex(cell: &Cell, edge: u8) -> u32 {
    let low = lower_octant(edge.into());
    let ends = [cell[low], cell[low | 1 << axis_of(edge.into())]];
    (8 * ends[0].min(ends[1]) + ends[0].max(ends[1])) as u32
}

/// The triangles of the degenerate table.
fn degenerate(cell: &Cell, inside: u8) -> Vec<[u32; 3]> {
    let loops = CASES[usize::from(inside)].loops.iter();
    let left = loops.map(|edges| Loop::collapsed(edges, |edge| vertex(cell, edge)));
    left.flat_map(|left| left.triangles().collect::<Vec<_>>()).collect()
}

/// Those of the ordinary one, without the collapsed.
fn ordinary(cell: &Cell, inside: u8) -> Vec<[u32; 3]> {
    let triangles = CASES[usize::from(inside)].triangles.iter();
    let triangles = triangles.map(|edges| edges.map(|edge| vertex(cell, edge)));
    triangles.filter(|[a, b, c]| a != b && b != c && c != a).collect()
}

/// How often the sides of triangles are gone along, less how often against: what is left is their
/// border.
fn border(triangles: &[[u32; 3]]) -> BTreeMap<(u32, u32), i32> {
    let mut uses = BTreeMap::new();
    for &[a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let (side, way) = if from < to { ((from, to), 1) } else { ((to, from), -1) };
            *uses.entry(side).or_insert(0) += way;
        }
    }
    uses.retain(|_, n| *n != 0);
    uses
}

/// The kinds of cells, up to symmetry, by how many voxels they have.
#[test]
fn there_are_so_many_degenerate_cells() {
    let cells = cells();
    assert_eq!(cells.len(), 73);
    let symmetries = symmetries();
    let kinds: BTreeSet<Cell> = cells
        .iter()
        .filter_map(|cell| symmetries.iter().map(|goes| turned(cell, goes)).min())
        .collect();
    let mut by_voxels = BTreeMap::new();
    kinds.iter().for_each(|kind| *by_voxels.entry(n_voxels(kind)).or_insert(0) += 1);
    // The cube; one pair; two side by side or across (a prism, a wedge); three, or a face (a pyramid);
    // a face and a pair across it or along (a tetrahedron).
    assert_eq!(by_voxels, BTreeMap::from([(4, 1), (5, 2), (6, 2), (7, 1), (8, 1)]));
    assert_eq!(cells.iter().map(|cell| cases(cell).count()).sum::<usize>(), 3904);
}

/// The ordinary table and the removal of collapsed triangles leave the same surface in every cell: as
/// many triangles with the same border, cut along other diagonals at most.
#[test]
fn the_ordinary_table_serves_degenerate_cells() {
    let (mut n, mut n_same) = (0, 0);
    for cell in cells() {
        for inside in cases(&cell) {
            let (table, plain) = (degenerate(&cell, inside), ordinary(&cell, inside));
            assert_eq!(table.len(), plain.len(), "{cell:?} {inside:#b}");
            assert_eq!(border(&table), border(&plain), "{cell:?} {inside:#b}");
            n += 1;
            n_same += usize::from(table == plain);
        }
    }
    assert_eq!((n, n_same), (3904, 3882));
}
