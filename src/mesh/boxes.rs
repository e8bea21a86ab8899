//! Boxes around triangles, around pairs of boxes, and so on up to one box around all: what is near a
//! place is found without looking at the rest.

use rayon::prelude::*;

use super::Mesh;
use crate::math::morton_encode;

/// Triangles in a lowest box.
pub(super) const LEAF: usize = 4;

/// Smallest and largest x, y and z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) min: [f32; 3],
    pub(super) max: [f32; 3],
}

impl Bounds {
    const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    fn with(self, other: Self) -> Self {
        Self {
            min: [0, 1, 2].map(|axis| self.min[axis].min(other.min[axis])),
            max: [0, 1, 2].map(|axis| self.max[axis].max(other.max[axis])),
        }
    }

    /// Whether two boxes have a point in common, be it at their borders.
    pub(super) fn meets(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.min[axis] <= other.max[axis] && other.min[axis] <= self.max[axis])
    }
}

/// The boxes of a mesh, in Morton order of the middles of its triangles.
#[derive(Debug)]
pub(super) struct Boxes {
    /// The numbers of the triangles.
    pub(super) order: Vec<u32>,
    /// Around each triangle, in this order.
    pub(super) triangles: Vec<Bounds>,
    /// Around [`LEAF`] triangles each, then around two boxes of the level before each; the last one is
    /// around all.
    pub(super) levels: Vec<Vec<Bounds>>,
}

impl Boxes {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let around = |t: u32| {
            let corners = mesh.triangles[t as usize].map(|v| mesh.positions[v as usize]);
            let points = corners.map(|p| Bounds { min: p, max: p });
            points.into_iter().fold(Bounds::EMPTY, Bounds::with)
        };
        let all: Vec<Bounds> =
            (0..mesh.triangles.len() as u32).into_par_iter().map(around).collect();
        let whole = all.par_iter().copied().reduce(|| Bounds::EMPTY, Bounds::with);
        let size = (0..3).map(|axis| whole.max[axis] - whole.min[axis]).fold(0.0, f32::max);
        // A place along the largest axis has 20 bits.
        let scale = f64::from(1_u32 << 20) / f64::from(size).max(f64::MIN_POSITIVE);
        let code = |bounds: &Bounds| {
            morton_encode([0, 1, 2].map(|axis| {
                let middle = 0.5 * (f64::from(bounds.min[axis]) + f64::from(bounds.max[axis]));
                ((middle - f64::from(whole.min[axis])) * scale) as u32
            }))
        };
        let mut keys: Vec<(u64, u32)> =
            all.par_iter().zip(0..all.len() as u32).map(|(b, t)| (code(b), t)).collect();
        keys.par_sort_unstable();
        let order: Vec<u32> = keys.into_iter().map(|(_, t)| t).collect();
        let triangles: Vec<Bounds> = order.iter().map(|&t| all[t as usize]).collect();
        let union = |some: &[Bounds]| some.iter().copied().fold(Bounds::EMPTY, Bounds::with);
        let mut levels = vec![triangles.par_chunks(LEAF).map(union).collect::<Vec<_>>()];
        while let Some(last) = levels.last()
            && last.len() > 1
        {
            levels.push(last.par_chunks(2).map(union).collect());
        }
        Self { order, triangles, levels }
    }

    /// The two boxes in a box of a level above the lowest: their numbers on the level below.
    pub(super) fn inside(&self, level: usize, number: usize) -> std::ops::Range<usize> {
        2 * number..(2 * number + 2).min(self.levels[level - 1].len())
    }

    /// The places of the triangles in a lowest box.
    pub(super) fn of_leaf(&self, number: usize) -> std::ops::Range<usize> {
        LEAF * number..(LEAF * (number + 1)).min(self.triangles.len())
    }
}
