//! First pass: voxels into the z-buffer, without holes.
//!
//! *Invariant:* a voxel is offered to every pixel whose centre ray meets its closed cube in front
//! of the near plane, unless something nearer is already known to win there. The pixels are found
//! in two steps: the bounding rectangle of the cube's projection, rounded outward, then an exact
//! test of each ray in it. The test is that of separating axes, which needs no division: the line
//! o + t d misses the cube of half width h around c exactly if on one axis of d × (x, y, z) the
//! distance is too large, |c' × d|_k > h (|d_i| + |d_j|) with c' = c - o. The cube is widened by a
//! bound of the rounding errors, so two neighbours leave no crack at their common face.
//!
//! A voxel knows its surface's normal, not where in the cube the surface is; the best guess is the
//! plane through the centre. The voxel is *met* where the ray gets to that plane or beyond it
//! inside the cube: at the crossing, or where it enters the cube if it is beyond the plane by then.
//! The planes of neighbours do not join; by the second case the steps between them are closed.
//! Otherwise the ray leaves the cube before it gets to the plane, and the voxel only *covers* the
//! pixel, at the depth where the ray leaves. `resolve` weighs the two.

use glam::DVec3;
use rayon::prelude::*;

use super::{
    Layer,
    screen::{Ray, Screen},
    zbuffer::{Key, ZBuffer},
};
use crate::{
    Error, Result,
    math::Lattice,
    octree::{Part, Voxel},
    progress::Progress,
};

/// The near plane's depth in voxel sizes: the rays start here.
const NEAR_VOXELS: f64 = 1e-3;

/// Bounds the rounding errors of a coordinate relative to the eye and of the products made with
/// it, relative to the largest coordinate: some 45 units in the last place.
const ROUNDING: f64 = 1e-14;

/// Writes all voxels of `layers`. A voxel's identity is its rank plus the number of voxels in the
/// layers before its own. Where `candidates` is false only certified voxels are written.
pub(super) fn splat(
    layers: &[Layer<'_>],
    screen: &Screen,
    zbuffer: &ZBuffer,
    candidates: bool,
    progress: &dyn Progress,
) -> Result<()> {
    let splatters: Vec<Splatter<'_>> = first_ids(layers)
        .zip(layers)
        .map(|(first_id, layer)| Splatter::new(layer, first_id, screen, zbuffer, candidates))
        .collect();
    let mut work: Vec<(f64, &Splatter<'_>, Part)> = splatters
        .iter()
        .flat_map(|s| s.layer.storage.parts().into_iter().map(move |part| (s.depth(part), s, part)))
        .collect();
    // From front to back, so that most of what is hidden finds out early.
    work.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total = layers.iter().map(|layer| u64::from(layer.storage.voxel_count())).sum();
    progress.begin("rasterize", total, "voxels");
    work.iter().par_bridge().try_for_each(|(_, splatter, part)| {
        if progress.is_cancelled() {
            return Err(Error::Interrupted);
        }
        progress.advance(splatter.part(*part));
        Ok(())
    })?;
    progress.end();
    Ok(())
}

/// The identity of each layer's voxel of rank 0.
///
/// # Panics
/// If there are 2^32 voxels or more.
pub(super) fn first_ids(layers: &[Layer<'_>]) -> impl Iterator<Item = u32> {
    layers.iter().scan(0_u32, |next, layer| {
        let first = *next;
        *next = next
            .checked_add(layer.storage.voxel_count())
            .unwrap_or_else(|| panic!("a picture holds at most {} voxels", u32::MAX));
        Some(first)
    })
}

/// Everything about a layer that its voxels share.
struct Splatter<'a> {
    layer: &'a Layer<'a>,
    first_id: u32,
    screen: &'a Screen,
    zbuffer: &'a ZBuffer,
    candidates: bool,
    /// Centres of the voxels along each axis, from the eye.
    centers: [Vec<f64>; 3],
    /// A voxel's half extents in picture axes.
    extent: DVec3,
    /// A voxel's half width, with the slack for rounding.
    half: f64,
    near: f64,
}

impl<'a> Splatter<'a> {
    fn new(
        layer: &'a Layer<'a>,
        first_id: u32,
        screen: &'a Screen,
        zbuffer: &'a ZBuffer,
        candidates: bool,
    ) -> Self {
        let lattice = layer.lattice;
        let size = lattice.voxel_size();
        let bounds = lattice.bounds();
        let reach = bounds.min.abs().max(bounds.max.abs()) + screen.eye.abs();
        let half = 0.5 * size + ROUNDING * (reach.max_element() + screen.radius);
        Self {
            layer,
            first_id,
            screen,
            zbuffer,
            candidates,
            centers: [0, 1, 2].map(|axis| centers(lattice, axis, screen.eye[axis])),
            extent: screen.extent(DVec3::splat(half)),
            half,
            near: NEAR_VOXELS * size,
        }
    }

    /// Depth of the middle of `part`.
    fn depth(&self, part: Part) -> f64 {
        let Layer { storage, lattice, .. } = self.layer;
        let levels_up = storage.depth() - part.level;
        let corner =
            |axis: usize, end: u32| lattice.corner(axis, (part.ijk[axis] + end) << levels_up);
        let middle = [0, 1, 2].map(|axis| 0.5 * (corner(axis, 0) + corner(axis, 1)));
        self.screen.forward.dot(DVec3::from_array(middle) - self.screen.eye)
    }

    /// Writes the voxels of `part` and returns their number.
    fn part(&self, part: Part) -> u64 {
        let mut n_voxels = 0;
        self.layer.storage.visit(part, &mut |voxel| {
            n_voxels += 1;
            if self.candidates || voxel.certified {
                self.voxel(voxel);
            }
        });
        n_voxels
    }

    #[inline]
    fn voxel(&self, voxel: Voxel) {
        let [x, y, z] = voxel.ijk.map(|i| i as usize);
        let center = DVec3::new(self.centers[0][x], self.centers[1][y], self.centers[2][z]);
        let Some(footprint) = self.screen.footprint(center, self.extent, self.near) else {
            return;
        };
        let id = self.first_id + voxel.rank;
        // No hit of this voxel is nearer than this. What a nearer met voxel hides could not win
        // as a covering one either, so it need not be written there.
        let nearest = Key::new(footprint.nearest, 0);
        let mut normal = None;
        for row in footprint.rows {
            for column in footprint.columns.clone() {
                let pixel = row * self.screen.width + column;
                if self.zbuffer.met.beats(pixel, nearest) {
                    continue;
                }
                let ray = self.screen.ray(column, row);
                let to_center = center - ray.origin;
                if !line_meets_cube(to_center, ray.direction, self.half) {
                    continue;
                }
                let normal = *normal.get_or_insert_with(|| voxel.normal.decode());
                self.write(pixel, id, &ray, to_center, normal);
            }
        }
    }

    /// Offers a voxel that the pixel's ray meets, met or covered.
    #[inline]
    fn write(&self, pixel: usize, id: u32, ray: &Ray, to_center: DVec3, normal: DVec3) {
        let t = normal.dot(to_center) / normal.dot(ray.direction);
        let from_center = (t * ray.direction - to_center).abs();
        if from_center.cmple(DVec3::splat(self.half)).all() && t >= self.near {
            self.zbuffer.met.offer(pixel, Key::new(t, id));
        } else if let Some((enter, leave)) = self.segment(to_center, ray.direction) {
            // A ray in the plane or parallel to it has t infinite or not a number; the latter
            // counts as met.
            if t > leave {
                self.zbuffer.covered.offer(pixel, Key::new(leave, id));
            } else {
                self.zbuffer.met.offer(pixel, Key::new(enter, id));
            }
        }
    }

    /// The depths between which the ray is in the cube, in front of the near plane.
    fn segment(&self, to_center: DVec3, direction: DVec3) -> Option<(f64, f64)> {
        let (mut enter, mut leave) = (self.near, f64::INFINITY);
        for axis in 0..3 {
            let (c, d) = (to_center[axis], direction[axis]);
            // The line meets the cube: along an axis on which it does not move it is inside.
            if d != 0.0 {
                let per_d = 1.0 / d;
                let (middle, half) = (c * per_d, self.half * per_d.abs());
                enter = enter.max(middle - half);
                leave = leave.min(middle + half);
            }
        }
        // A line that only touches an edge may leave before it enters, by rounding.
        (leave >= self.near).then_some((enter.min(leave), leave))
    }
}

fn centers(lattice: &Lattice, axis: usize, eye: f64) -> Vec<f64> {
    let center = |i| 0.5 * (lattice.corner(axis, i) + lattice.corner(axis, i + 1)) - eye;
    (0..lattice.n_voxels()[axis]).map(center).collect()
}

/// Whether a line meets the cube of half width `half` around `to_center`, both relative to a point
/// of the line.
#[inline]
fn line_meets_cube(to_center: DVec3, direction: DVec3, half: f64) -> bool {
    let off = to_center.cross(direction).abs();
    let d = direction.abs();
    (off.x <= half * (d.y + d.z)) & (off.y <= half * (d.z + d.x)) & (off.z <= half * (d.x + d.y))
}
