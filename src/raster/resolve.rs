//! Which voxel a pixel shows: the nearest one that its ray *meets*, or one that merely *covers* it.
//!
//! Cubes stick out of the surface, by up to the length of a diagonal. Were the nearest cube shown,
//! every sheet would be hidden behind the corners of its own voxels, and what is seen through the
//! corners would change from pixel to pixel. A met voxel is as deep as the surface is, up to a
//! voxel, and the met parts of neighbours close up. So a met voxel is shown, except where a
//! covering one in front of it belongs to another sheet: the rim of something nearer.
//!
//! *One sheet or two?* Let a flat sheet with unit normal n run through voxels of size h. A voxel's
//! cube reaches h/2 |n|₁ from its centre along n, and every cube meets the sheet, so all points of
//! all cubes are at most h |n|₁ away from it. Hence two hits on one flat sheet differ by at most
//! 2 h |n|₁ along n. This is asked along both hits' normals, with half a voxel more for curvature.
//! A bound on the depths alone would have to be far larger: at grazing incidence a ray runs
//! through the cubes of one sheet for many voxels before it gets to a plane.
//!
//! *Silhouettes.* A covered pixel with nothing behind, or with another sheet behind, shows the
//! covering voxel: the outline is that of the union of cubes, the smallest one that is certain to
//! contain the surface. Just inside it, a ray that passes over the rim meets the first voxels that
//! face away; their normals are all but at right angles to the ray, as the surface's there is.

use super::{
    Layer,
    paint::{Seen, UNTINTED},
    screen::Ray,
    splat::first_ids,
    zbuffer::Hit,
};
use glam::DVec3;

/// Largest distance along the normal between two hits of one sheet, in projected voxel sizes.
const SHEET_VOXELS: f64 = 2.5;

/// Finds voxels by their identity.
pub(super) struct Voxels<'a> {
    layers: &'a [Layer<'a>],
    first_ids: Vec<u32>,
}

/// A voxel that a sample may show.
#[derive(Clone, Copy)]
pub(super) struct Shown {
    pub(super) seen: Seen,
    /// Whether the ray gets to the tangent plane in the voxel.
    pub(super) is_met: bool,
}

impl<'a> Voxels<'a> {
    pub(super) fn new(layers: &'a [Layer<'a>]) -> Self {
        Self { layers, first_ids: first_ids(layers).collect() }
    }

    /// The hit that a pixel shows, of the nearest of each kind.
    pub(super) fn shown(&self, ray: &Ray, met: Option<Hit>, covered: Option<Hit>) -> Option<Shown> {
        match (met, covered) {
            (Some(met), Some(covered)) if covered.depth < met.depth => {
                let (met, covered) = (self.seen(met), self.seen(covered));
                let is_met = self.is_one_sheet(ray, &met, &covered);
                Some(Shown { seen: if is_met { met } else { covered }, is_met })
            }
            (Some(met), _) => Some(Shown { seen: self.seen(met), is_met: true }),
            (None, Some(covered)) => Some(Shown { seen: self.seen(covered), is_met: false }),
            (None, None) => None,
        }
    }

    /// What is known of the voxel of a hit.
    pub(super) fn seen(&self, hit: Hit) -> Seen {
        // An empty layer shares its first identity with the next one, which is the owner.
        let owner = self.first_ids.partition_point(|&first| first <= hit.id) - 1;
        let layer = &self.layers[owner];
        let rank = hit.id - self.first_ids[owner];
        let normal = layer.storage.normal(rank).decode();
        let certified = layer.storage.is_certified(rank);
        Seen { layer: owner, depth: f64::from(hit.depth), normal, certified, tint: UNTINTED }
    }

    fn is_one_sheet(&self, ray: &Ray, met: &Seen, covered: &Seen) -> bool {
        let between = (met.depth - covered.depth) * ray.direction;
        let size_of = |seen: &Seen| self.layers[seen.layer].lattice.voxel_size();
        let size = size_of(met).max(size_of(covered));
        let is_near =
            |n: DVec3| n.dot(between).abs() <= SHEET_VOXELS * size * n.abs().element_sum();
        is_near(met.normal) && is_near(covered.normal)
    }
}
