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
//! *Silhouettes.* Where the surface has a formula, `paint` follows the rays at rims. Elsewhere a covered
//! pixel with nothing behind, or with another sheet behind, shows the
//! covering voxel: the outline is that of the union of cubes, the smallest one that is certain to
//! contain the surface. Just inside it, a ray that passes over the rim meets the first voxels that
//! face away; their normals are all but at right angles to the ray, as the surface's there is.

use glam::DVec3;

use super::{paint::Seen, screen::Ray, zbuffer::Hit};

/// Largest distance along the normal between two hits of one sheet, in projected voxel sizes.
const SHEET_VOXELS: f64 = 2.5;

/// A voxel that a sample may show.
#[derive(Clone, Copy)]
pub(super) struct Shown {
    pub(super) seen: Seen,
    /// Whether the ray gets to the tangent plane in the voxel.
    pub(super) is_met: bool,
}

/// The hit that a sample shows, of the nearest of each kind; `seen` knows their voxels.
pub(super) fn shown(
    ray: &Ray,
    met: Option<Hit>,
    covered: Option<Hit>,
    seen: impl Fn(Hit) -> Seen,
) -> Option<Shown> {
    match (met, covered) {
        (Some(met), Some(covered)) if covered.depth < met.depth => {
            let (met, covered) = (seen(met), seen(covered));
            let is_met = is_one_sheet(ray, &met, &covered);
            Some(Shown { seen: if is_met { met } else { covered }, is_met })
        }
        (Some(met), _) => Some(Shown { seen: seen(met), is_met: true }),
        (None, Some(covered)) => Some(Shown { seen: seen(covered), is_met: false }),
        (None, None) => None,
    }
}

fn is_one_sheet(ray: &Ray, met: &Seen, covered: &Seen) -> bool {
    let between = (met.depth - covered.depth) * ray.direction;
    let size = met.voxel_size.max(covered.voxel_size);
    let is_near = |n: DVec3| n.dot(between).abs() <= SHEET_VOXELS * size * n.abs().element_sum();
    is_near(met.normal) && is_near(covered.normal)
}
