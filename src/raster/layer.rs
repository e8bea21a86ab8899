//! One surface as rasterization sees it.

use glam::DVec3;
use rayon::prelude::*;

use super::{Content, Material, Model, fit::fold_reach};
use crate::{expr::Tape, math::Lattice, octree::Storage};

/// The voxels of one surface and how they look.
#[derive(Clone, Copy)]
pub struct Layer<'a> {
    /// The voxels.
    pub storage: &'a dyn Storage,
    /// Where they lie.
    pub lattice: &'a Lattice,
    /// How they look.
    pub material: Material,
    /// The formula that they come from, if there is one.
    pub tape: Option<&'a Tape>,
}

/// The near plane's depth in voxel sizes: the rays start here.
const NEAR_VOXELS: f64 = 1e-3;

impl Layer<'_> {
    /// Depth of the near plane.
    pub(super) fn near(&self) -> f64 {
        NEAR_VOXELS * self.lattice.voxel_size()
    }
}

/// All that a picture shows.
#[derive(Clone, Copy)]
pub struct Drawn<'a> {
    /// The surfaces.
    pub layers: &'a [Layer<'a>],
    /// The polygon models.
    pub models: &'a [Model],
}

impl Content for Drawn<'_> {
    fn reach<const N: usize>(&self, directions: [DVec3; N]) -> [f64; N] {
        let of_models = self.models.iter().map(|model| model.reach(directions));
        fold_reach(of_models.chain([self.layers.reach(directions)]))
    }
}

/// All voxels' cubes: what a fitted camera shows.
impl Content for [Layer<'_>] {
    fn reach<const N: usize>(&self, directions: [DVec3; N]) -> [f64; N] {
        fold_reach(self.iter().map(|layer| layer.reach(directions)))
    }
}

impl Content for Layer<'_> {
    fn reach<const N: usize>(&self, directions: [DVec3; N]) -> [f64; N] {
        let parts = self.storage.parts();
        let of_centers: Vec<[f64; N]> = parts
            .par_iter()
            .map(|&part| {
                let mut reach = [f64::NEG_INFINITY; N];
                self.storage.visit(part, &mut |voxel| {
                    let center = self.lattice.voxel_center(voxel.ijk);
                    reach = fold_reach([reach, directions.map(|d| d.dot(center))]);
                });
                reach
            })
            .collect();
        let half = 0.5 * self.lattice.voxel_size();
        let of_centers = fold_reach(of_centers);
        std::array::from_fn(|k| of_centers[k] + half * directions[k].abs().element_sum())
    }
}
