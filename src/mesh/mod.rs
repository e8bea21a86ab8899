//! Triangle meshes of surfaces, from voxels by way of a dual grid that is never stored.
//!
//! `grid` holds values in bricks of voxels near the surface, `extract` finds the cells between them
//! and cuts them into triangles (`cases`). `repair` parts sheets that touch, `decimate` takes triangles
//! away, and `check` and `crossings` tell what a mesh is like.
//!
//! *Based on:* A. León Salas, 2008 (IDDG-Octree), chapters 2 and 3.

mod boxes;
mod cases;
mod cells;
mod check;
mod crossings;
mod cut;
mod cuts;
mod decimate;
#[cfg(test)]
mod degenerate;
mod deviation;
mod extract;
mod fans;
mod formula;
mod grid;
mod halo;
mod live;
mod middles;
mod near;
mod normals;
mod numbers;
mod quadric;
mod repair;
mod runs;
mod tapes;
#[cfg(test)]
mod tests;
mod uniform;
mod values;

pub use check::{Health, Shape};
use std::hash::Hasher;

use siphasher::sip128::{Hasher128, SipHasher13};

pub use extract::{Crossing, Extraction, LEAST_PART, extract};
pub use formula::{FormulaSettings, VertexPlace, of_formula, of_open_voxels};
pub use grid::{Border, Brick, Grid, Leaf, SIDE, Stored, VOXELS, Voxels, offset};
pub(crate) use grid::{Slices, byte_bits, index_of, slices};
pub use live::LiveMesh;
pub use uniform::{Threshold, Triangles, uniform};

/// Triangles of one surface, as files hold them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The surface's name.
    pub name: String,
    /// In scene coordinates; of the precision that files have, so that what is checked is what is
    /// written.
    pub positions: Vec<[f32; 3]>,
    /// Of length 1, outwards; one for each position.
    pub normals: Vec<[f32; 3]>,
    /// Counter-clockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Linear-light red, green, blue, in [0, 1].
    pub color: [f32; 3],
}

impl Mesh {
    /// A digest of vertices, normals and triangles; equal meshes have equal digests on every machine.
    #[must_use]
    pub fn digest(&self) -> u128 {
        let mut hasher = SipHasher13::new();
        for coordinates in self.positions.iter().chain(&self.normals) {
            coordinates.iter().for_each(|c| hasher.write_u32(c.to_bits().to_le()));
        }
        self.triangles.as_flattened().iter().for_each(|v| hasher.write_u32(v.to_le()));
        hasher.finish128().as_u128()
    }

    /// Drops vertices that no triangle has; the others keep their order.
    pub(crate) fn drop_unused(&mut self) {
        let mut numbers = vec![u32::MAX; self.positions.len()];
        self.triangles.as_flattened().iter().for_each(|&v| numbers[v as usize] = 0);
        let used = numbers.iter_mut().filter(|number| **number == 0);
        (0..).zip(used).for_each(|(next, number)| *number = next);
        let is_used = |i: &mut usize| {
            *i += 1;
            numbers[*i - 1] != u32::MAX
        };
        let (mut i, mut j) = (0, 0);
        self.positions.retain(|_| is_used(&mut i));
        self.normals.retain(|_| is_used(&mut j));
        for vertex in self.triangles.as_flattened_mut() {
            *vertex = numbers[*vertex as usize];
        }
    }
}
