//! Voxels into the z-buffer of a tile, without holes.
//!
//! *Invariant:* a voxel is offered to every sample whose ray meets its closed cube in front
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

use super::{
    block::BlockView,
    screen::{Ray, Screen},
    tile::Tile,
    walk::BLOCK_SIDE,
    zbuffer::{Key, ZBuffer},
};
use crate::octree::Voxel;

/// Bounds the rounding errors of a coordinate relative to the eye and of the products made with
/// it, relative to the largest coordinate: some 45 units in the last place.
const ROUNDING: f64 = 1e-14;

/// Draws the voxels of a block into the z-buffer of a tile.
pub(super) struct Splatter<'a> {
    view: BlockView<'a>,
    first_id: u32,
    screen: &'a Screen,
    /// Whether voxels are drawn that are not certified.
    candidates: bool,
    /// The block's first voxel.
    first: [u32; 3],
    /// Centres of the block's voxels along each axis, from the eye.
    centers: [[f64; BLOCK_SIDE]; 3],
    /// A voxel's half extents in picture axes.
    extent: DVec3,
    /// A voxel's half width, with the slack for rounding.
    half: f64,
    near: f64,
}

impl<'a> Splatter<'a> {
    /// A voxel's identity is `first_id` plus its place among those of the block.
    pub(super) fn new(
        view: BlockView<'a>,
        first_id: u32,
        screen: &'a Screen,
        near: f64,
        candidates: bool,
    ) -> Self {
        let lattice = view.lattice;
        let size = lattice.voxel_size();
        let bounds = lattice.bounds();
        let reach = bounds.min.abs().max(bounds.max.abs()) + screen.eye.abs();
        let half = 0.5 * size + ROUNDING * (reach.max_element() + screen.radius);
        let first = view.first();
        let centers = [0, 1, 2].map(|axis| {
            std::array::from_fn(|i| {
                let at = |end: u32| lattice.corner(axis, first[axis] + i as u32 + end);
                0.5 * (at(0) + at(1)) - screen.eye[axis]
            })
        });
        let extent = screen.extent(DVec3::splat(half));
        Self { view, first_id, screen, candidates, first, centers, extent, half, near }
    }

    /// Writes the voxels of the block that touch `tile`. Returns the rank of the block's first voxel.
    pub(super) fn cubes(&self, tile: &Tile, zbuffer: &mut ZBuffer) -> u32 {
        self.visit(&mut |voxel, id| self.cube(voxel, id, tile, zbuffer))
    }

    /// Writes the voxels of the block as points: each into the one sample that its centre is in.
    /// Returns the rank of the block's first voxel.
    pub(super) fn points(&self, tile: &Tile, zbuffer: &mut ZBuffer) -> u32 {
        self.visit(&mut |voxel, id| {
            let Some((column, row, depth)) = self.screen.sample_of(self.center(voxel)) else {
                return;
            };
            if depth >= self.near && tile.columns.contains(&column) && tile.rows.contains(&row) {
                zbuffer.met.offer(tile.sample(column, row), Key::new(depth, id));
            }
        })
    }

    /// Calls `draw` for every voxel that is to be drawn, with its identity.
    fn visit(&self, draw: &mut dyn FnMut(Voxel, u32)) -> u32 {
        let BlockView { storage, part, .. } = self.view;
        let mut first_rank = None;
        if storage.voxel_count() > 0 {
            storage.visit(part, &mut |voxel| {
                let first_rank = *first_rank.get_or_insert(voxel.rank);
                if self.candidates || voxel.certified {
                    draw(voxel, self.first_id + (voxel.rank - first_rank));
                }
            });
        }
        first_rank.unwrap_or(0)
    }

    #[inline]
    fn center(&self, voxel: Voxel) -> DVec3 {
        let [x, y, z] = [0, 1, 2].map(|axis| (voxel.ijk[axis] - self.first[axis]) as usize);
        DVec3::new(self.centers[0][x], self.centers[1][y], self.centers[2][z])
    }

    #[inline]
    fn cube(&self, voxel: Voxel, id: u32, tile: &Tile, zbuffer: &mut ZBuffer) {
        let center = self.center(voxel);
        let Some(footprint) = self.screen.footprint(center, self.extent, self.near) else {
            return;
        };
        // No hit of this voxel is nearer than this. What a nearer met voxel hides could not win
        // as a covering one either, so it need not be written there.
        let nearest = Key::new(footprint.nearest, 0);
        let mut normal = None;
        let columns = footprint.columns.start.max(tile.columns.start)
            ..footprint.columns.end.min(tile.columns.end);
        for row in footprint.rows.start.max(tile.rows.start)..footprint.rows.end.min(tile.rows.end)
        {
            for column in columns.clone() {
                let sample = tile.sample(column, row);
                if zbuffer.met.beats(sample, nearest) {
                    continue;
                }
                let ray = self.screen.ray(column, row);
                let to_center = center - ray.origin;
                if !line_meets_cube(to_center, ray.direction, self.half) {
                    continue;
                }
                let normal = *normal.get_or_insert_with(|| voxel.normal.decode());
                self.write(sample, id, &ray, to_center, normal, zbuffer);
            }
        }
    }

    /// Offers a voxel that the pixel's ray meets, met or covered.
    #[inline]
    fn write(
        &self,
        sample: usize,
        id: u32,
        ray: &Ray,
        to_center: DVec3,
        normal: DVec3,
        zbuffer: &mut ZBuffer,
    ) {
        let t = normal.dot(to_center) / normal.dot(ray.direction);
        let from_center = (t * ray.direction - to_center).abs();
        if from_center.cmple(DVec3::splat(self.half)).all() && t >= self.near {
            zbuffer.met.offer(sample, Key::new(t, id));
        } else if let Some((enter, leave)) = self.segment(to_center, ray.direction) {
            // A ray in the plane or parallel to it has t infinite or not a number; the latter
            // counts as met.
            if t > leave {
                zbuffer.covered.offer(sample, Key::new(leave, id));
            } else {
                zbuffer.met.offer(sample, Key::new(enter, id));
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

/// Whether a line meets the cube of half width `half` around `to_center`, both relative to a point
/// of the line.
#[inline]
fn line_meets_cube(to_center: DVec3, direction: DVec3, half: f64) -> bool {
    let off = to_center.cross(direction).abs();
    let d = direction.abs();
    (off.x <= half * (d.y + d.z)) & (off.y <= half * (d.z + d.x)) & (off.z <= half * (d.x + d.y))
}
