//! Rays through the cells of a block, from one to the next.
//!
//! *Based on:* J. Amanatides, A. Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing",
//! Eurographics 1987.

use glam::DVec3;

use super::screen::Ray;

/// Cells along an edge of a block, at most.
pub(super) const BLOCK_SIDE: usize = 32;

/// How far the part of a ray in a cell is continued beyond it, in cells, so that no rounding opens
/// a gap between cells.
const OVERLAP: f64 = 1e-9;

/// Which cells of a block may hold the surface.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    /// The first corner, from the eye.
    pub(super) origin: DVec3,
    /// Edge of a cell.
    pub(super) size: f64,
    /// Cells along an edge of the block.
    side: usize,
    /// The last corner, from the eye; cells beyond do not count.
    end: DVec3,
    /// Bit x of row y + 32 z.
    rows: Vec<u32>,
    /// Cubes of 2³ cells that hold any: bit x of row y + 16 z.
    octants: [u16; OCTANTS * OCTANTS],
}

/// Cells along an edge of an octant.
const OCTANT: usize = 2;
/// Octants along an edge of a block.
const OCTANTS: usize = BLOCK_SIDE / OCTANT;

impl Cells {
    /// No cells yet, of a block with `side` cells along an edge, at most 32, that ends at `end` at the
    /// latest.
    pub(super) fn new(origin: DVec3, size: f64, side: usize, end: DVec3) -> Self {
        assert!(side <= BLOCK_SIDE, "a row of cells is a number of 32 bits");
        let rows = vec![0; BLOCK_SIDE * BLOCK_SIDE];
        // By rounding, the planes of a lattice may lie a little beyond its last one.
        let end = end + DVec3::splat(OVERLAP * size);
        let end = end.min(origin + DVec3::splat(side as f64 * size));
        Self { origin, size, side, end, rows, octants: [0; OCTANTS * OCTANTS] }
    }

    /// A box that holds all of them and the ends of rays in them, from the eye.
    pub(super) fn bounds(&self) -> (DVec3, DVec3) {
        let margin = DVec3::splat(0.01 * self.size);
        let side = DVec3::splat(self.side as f64 * self.size);
        (self.origin - margin, self.origin + side + margin)
    }

    /// Adds the cell at `ijk`, each below the block's side.
    #[inline]
    pub(super) fn insert(&mut self, [x, y, z]: [u32; 3]) {
        self.rows[y as usize + BLOCK_SIDE * z as usize] |= 1 << x;
        let [bx, by, bz] = [x, y, z].map(|i| i as usize / OCTANT);
        self.octants[by + OCTANTS * bz] |= 1 << bx;
    }

    /// Boxes that together hold all cells: centres, from the eye, and half an edge.
    pub(super) fn boxes(&self) -> (impl Iterator<Item = DVec3>, f64) {
        let half = 0.5 * OCTANT as f64 * self.size;
        let center = move |i: usize| 2.0 * half * (i as f64 + 0.5);
        let rows = self.octants.iter().enumerate();
        let centers = rows.flat_map(move |(row, &bits)| {
            let of_row = (0..OCTANTS).filter(move |x| bits >> x & 1 == 1);
            of_row.map(move |x| {
                self.origin + DVec3::new(center(x), center(row % OCTANTS), center(row / OCTANTS))
            })
        });
        (centers, half)
    }

    /// The last corner, from the eye, or that of the domain.
    pub(super) fn end(&self) -> DVec3 {
        self.end
    }

    #[inline]
    fn holds(&self, [x, y, z]: [i32; 3]) -> bool {
        self.rows[y as usize + BLOCK_SIDE * z as usize] >> x & 1 == 1
    }
}

/// The part of a ray between two depths.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Span {
    pub(super) from: f64,
    pub(super) to: f64,
}

/// A ray on its way through the cells of a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Walk {
    /// Where the ray is.
    cell: [i32; 3],
    depth: f64,
    step: [i32; 3],
    /// The depth at which it leaves the cell, by axis.
    next: [f64; 3],
    /// The depth that a cell takes, by axis.
    per_cell: [f64; 3],
    /// The depth at which it leaves the block.
    leave: f64,
    overlap: f64,
}

impl Walk {
    /// A ray that enters the block, at depth `near` at least; `None` if it passes by.
    pub(super) fn new(cells: &Cells, ray: &Ray, near: f64) -> Option<Self> {
        let (mut enter, mut leave) = (near, f64::INFINITY);
        for axis in 0..3 {
            let to_first = cells.origin[axis] - ray.origin[axis];
            let to_last = cells.end[axis] - ray.origin[axis];
            let d = ray.direction[axis];
            if d == 0.0 {
                if to_first > 0.0 || to_last < 0.0 {
                    return None;
                }
            } else {
                let (a, b) = (to_first / d, to_last / d);
                let (first, last) = if a < b { (a, b) } else { (b, a) };
                enter = if first > enter { first } else { enter };
                leave = if last < leave { last } else { leave };
            }
        }
        if enter > leave {
            return None;
        }
        let mut walk = Self {
            cell: [0; 3],
            depth: enter,
            step: [0; 3],
            next: [f64::INFINITY; 3],
            per_cell: [f64::INFINITY; 3],
            leave,
            overlap: 0.0,
        };
        let entry = ray.at(enter) - cells.origin;
        for axis in 0..3 {
            let d = ray.direction[axis];
            let at = (entry[axis] / cells.size).floor() as i32;
            let at = at.clamp(0, cells.side as i32 - 1);
            walk.cell[axis] = at;
            if d != 0.0 {
                walk.step[axis] = if d > 0.0 { 1 } else { -1 };
                let plane = f64::from(at + i32::from(d > 0.0)) * cells.size;
                let to_plane = cells.origin[axis] - ray.origin[axis] + plane;
                walk.next[axis] = to_plane / d;
                walk.per_cell[axis] = cells.size / d.abs();
            }
        }
        let fastest = ray.direction.abs().max_element();
        walk.overlap = OVERLAP * cells.size / fastest;
        Some(walk)
    }

    /// Goes on to the next cell that may hold the surface, and returns where the ray is in it.
    pub(super) fn next_cell(&mut self, cells: &Cells) -> Option<Span> {
        loop {
            let is_beyond = self.cell.iter().any(|&i| i < 0 || i >= cells.side as i32);
            if is_beyond || self.depth > self.leave {
                return None;
            }
            let holds = cells.holds(self.cell);
            let [x, y, z] = self.next;
            let axis = if x <= y && x <= z {
                0
            } else if y <= z {
                1
            } else {
                2
            };
            let from = self.depth;
            let to = if self.next[axis] < self.leave { self.next[axis] } else { self.leave };
            self.cell[axis] += self.step[axis];
            self.next[axis] += self.per_cell[axis];
            self.depth = if to > from { to } else { from };
            if holds {
                return Some(Span { from: from - self.overlap, to: self.depth + self.overlap });
            }
        }
    }

    /// No cell that is still to come begins before this depth.
    pub(super) fn depth(&self) -> f64 {
        self.depth
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The spans of all cells together are the ray's way through the block, and each lies in
        /// its cell.
        #[test]
        fn spans_are_the_way_through_the_block(
            origin in [-2.0..2.0_f64, -2.0..2.0, -2.0..2.0],
            target in [0.0..1.0_f64, 0.0..1.0, 0.0..1.0],
            flat in 0..4_usize,
        ) {
            let mut direction = DVec3::from_array(target) - DVec3::from_array(origin);
            if flat < 3 {
                direction[flat] = 0.0;
            }
            prop_assume!(direction.length() > 0.1);
            let ray = Ray { origin: DVec3::from_array(origin), direction };
            let mut cells = Cells::new(DVec3::ZERO, 1.0 / 32.0, 32, DVec3::ONE);
            for i in 0..32_u32.pow(3) {
                cells.insert([i % 32, i / 32 % 32, i / 1024]);
            }
            let near = 1e-6;
            let outside = |t: f64| {
                let p = ray.at(t);
                (0..3).any(|axis| p[axis] < -1e-6 || p[axis] > 1.0 + 1e-6)
            };
            let mut last = None;
            let mut walk = Walk::new(&cells, &ray, near);
            while let Some(span) = walk.as_mut().and_then(|walk| walk.next_cell(&cells)) {
                prop_assert!(span.from <= span.to);
                if let Some(last) = last {
                    let gap: f64 = span.from - last;
                    prop_assert!((-1e-6..=0.0).contains(&gap), "{gap}");
                }
                prop_assert!(!outside(0.5 * (span.from + span.to)));
                let (from, to) = (ray.at(span.from), ray.at(span.to));
                prop_assert!((from - to).abs().max_element() <= 1.0 / 32.0 + 1e-6);
                last = Some(span.to);
            }
            if let Some(last) = last {
                prop_assert!(outside(last + 1e-3));
            }
        }
    }
}
