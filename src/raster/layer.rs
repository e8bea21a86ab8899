//! One surface as rasterization sees it.

use glam::DVec3;
use rayon::prelude::*;

use super::{Coloring, Content, Material, Model, Solid, fit::fold_reach};
use crate::{
    expr::Tape,
    math::Lattice,
    octree::{Detail, Storage},
    voxelize::Outline,
};

/// Where the voxels of a surface come from.
#[derive(Clone, Copy, Debug)]
pub enum Source<'a> {
    /// All of them were found.
    Stored(&'a Detail<'a>),
    /// They are found where the picture shows them.
    OnDemand {
        /// Whether they are made as small as pixels, and not as the lattice says.
        is_auto: bool,
    },
}

/// The voxels of one surface and how they look.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    /// The voxels.
    pub source: Source<'a>,
    /// Where they lie.
    pub lattice: &'a Lattice,
    /// How they look.
    pub material: Material,
    /// What gives them their colour.
    pub coloring: &'a Coloring,
    /// The formula that they come from, if there is one.
    pub tape: Option<&'a Tape>,
}

/// The near plane's depth in voxel sizes: the rays start here.
const NEAR_VOXELS: f64 = 1e-3;

/// The same where voxels become as small as pixels.
const NEAR_VOXELS_AUTO: f64 = 1e-9;

impl Layer<'_> {
    /// Depth of the near plane.
    pub(super) fn near(&self) -> f64 {
        let is_auto = matches!(self.source, Source::OnDemand { is_auto: true });
        let voxels = if is_auto { NEAR_VOXELS_AUTO } else { NEAR_VOXELS };
        voxels * self.lattice.voxel_size()
    }
}

/// All that a picture shows.
#[derive(Clone, Default)]
pub struct Drawn<'a> {
    /// Voxels of surfaces.
    pub voxels: Vec<(&'a dyn Storage, &'a Lattice)>,
    /// Outlines of surfaces.
    pub outlines: &'a [Outline],
    /// The polygon models.
    pub models: &'a [Model],
    /// Solids that are given by samples.
    pub solids: &'a [Solid<'a>],
}

impl Content for Drawn<'_> {
    fn reach<const N: usize>(&self, directions: [DVec3; N]) -> [f64; N] {
        let of_models = self.models.iter().map(|model| model.reach(directions));
        let of_voxels =
            self.voxels.iter().map(|(storage, lattice)| reach(*storage, lattice, directions));
        let of_outlines = self.outlines.iter().map(|outline| {
            beyond_centers(outline.reach(directions), outline.lattice(), directions)
        });
        let of_solids = self.solids.iter().map(|solid| solid.reach(directions));
        fold_reach(of_models.chain(of_solids).chain(of_voxels).chain(of_outlines))
    }
}

/// How far the cubes of all voxels reach.
fn reach<const N: usize>(
    storage: &dyn Storage,
    lattice: &Lattice,
    directions: [DVec3; N],
) -> [f64; N] {
    let parts = storage.parts();
    let of_centers: Vec<[f64; N]> = parts
        .par_iter()
        .map(|&part| {
            let mut reach = [f64::NEG_INFINITY; N];
            storage.visit(part, &mut |voxel| {
                let center = lattice.voxel_center(voxel.ijk);
                reach = fold_reach([reach, directions.map(|d| d.dot(center))]);
            });
            reach
        })
        .collect();
    beyond_centers(fold_reach(of_centers), lattice, directions)
}

/// How far cubes reach, from how far their centres do.
fn beyond_centers<const N: usize>(
    of_centers: [f64; N],
    lattice: &Lattice,
    directions: [DVec3; N],
) -> [f64; N] {
    let half = 0.5 * lattice.voxel_size();
    std::array::from_fn(|k| of_centers[k] + half * directions[k].abs().element_sum())
}
