//! Values of a formula in the middles of voxels near its surface.

use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::{
    Border, Brick, FormulaSettings, Grid, SIDE, VOXELS,
    grid::{self, is_inside},
    near::{ALL, Bits, Voxels, sides},
    offset,
    tapes::Tapes,
};
use crate::{
    eval::{Sample, sampler},
    math::{Lattice, morton_decode, morton_encode},
};

/// Values of −F in the voxels of a brick that are near the surface. Others are as far inside or outside
/// as can be: edges between them are cut only where F ends.
pub(super) struct Values {
    near: Bits,
    /// The voxels inside, near or not.
    inside: Bits,
    /// Set bits before each slice.
    before: [u16; SIDE as usize],
    offsets: Box<[f32]>,
}

impl Values {
    fn new(near: Bits, inside: Bits, offsets: Box<[f32]>) -> Self {
        let mut n = 0;
        let before = near.map(|slice| {
            n += slice.count_ones() as u16;
            n - slice.count_ones() as u16
        });
        Self { near, inside, before, offsets }
    }

    /// What a voxel has that is not near.
    #[inline]
    fn far(&self, z: usize, bit: usize) -> f32 {
        if self.inside[z] >> bit & 1 == 1 { f32::MAX } else { f32::MIN }
    }
}

impl grid::Voxels for Values {
    type Value = f32;

    fn values(&self, all: &mut [f32; VOXELS]) {
        if let Some(offsets) = self.offsets.as_array() {
            *all = *offsets;
            return;
        }
        let mut offsets = self.offsets.iter();
        for (i, value) in all.iter_mut().enumerate() {
            let (z, bit) = (i / 64, i % 64);
            let own = if self.near[z] >> bit & 1 == 1 { offsets.next().copied() } else { None };
            *value = own.unwrap_or_else(|| self.far(z, bit));
        }
    }

    #[inline]
    fn offset_of(&self, offset: f32) -> f32 {
        offset
    }

    #[inline]
    fn offset(&self, index: usize) -> f32 {
        let (z, bit) = (index / 64, index % 64);
        if self.near[z] >> bit & 1 == 0 {
            return self.far(z, bit);
        }
        let below = self.near[z] & ((1 << bit) - 1);
        self.offsets[usize::from(self.before[z]) + below.count_ones() as usize]
    }

    #[inline]
    fn level(&self, _: usize) -> u8 {
        0
    }
}

/// The grid of the values of −F: inside is what is not negative. `is_known_inside` tells of voxels in
/// bricks without any that is near.
pub(super) fn grid(
    tapes: &Tapes<'_>,
    mut near: Voxels,
    is_known_inside: &mut dyn FnMut([u32; 3]) -> bool,
    lattice: &Lattice,
    settings: &FormulaSettings,
) -> Grid<Values> {
    let (size, border) = (lattice.n_voxels(), settings.border);
    if tapes.whole.region().is_some() {
        // What lies beyond the region is not stored.
        near.values_mut().for_each(|bits| *bits = ALL);
    }
    if border == Border::Capped {
        let caps = bricks_of_caps(is_known_inside, size, &near);
        near.extend(caps.into_iter().map(|place| (morton_encode(place), ALL)));
    }
    let new_sampling = || Sampling::new(tapes, lattice, settings);
    let brick =
        |sampling: &mut Sampling<'_>, (code, near)| sampling.brick(morton_decode(code), near);
    // The grid sorts them.
    let near: Vec<(u64, Bits)> = near.into_iter().collect();
    let bricks = near.into_par_iter().map_init(new_sampling, brick).collect();
    Grid::new(bricks, size, border)
}

/// One thread's means of finding values.
struct Sampling<'a> {
    tapes: &'a Tapes<'a>,
    lattice: &'a Lattice,
    border: Border,
    sampler: Box<dyn Sample>,
    points: Vec<DVec3>,
}

impl<'a> Sampling<'a> {
    fn new(tapes: &'a Tapes<'a>, lattice: &'a Lattice, settings: &FormulaSettings) -> Self {
        let (sampler, points) = (sampler(settings.simd), Vec::with_capacity(VOXELS));
        Self { tapes, lattice, border: settings.border, sampler, points }
    }

    /// The brick at a place, with values in the voxels that are near the surface.
    fn brick(&mut self, place: [u32; 3], near: Bits) -> Brick<Values> {
        let side = SIDE as usize;
        let [x, y, z] = [0, 1, 2].map(|axis| self.coordinates(axis, place[axis]));
        self.points.clear();
        each_voxel(&near, |i| {
            self.points.push(DVec3::new(x[i % side], y[i / side % side], z[i / side / side]));
        });
        let values = self.sampler.values(self.tapes.of_brick(place), &self.points);
        let mut offsets: Box<[f32]> = values.iter().map(|&value| offset(0.0, value)).collect();
        if self.border == Border::Capped {
            self.close(place, &near, &mut offsets);
        }
        let mut inside = Bits::default();
        let mut next = offsets.iter();
        each_voxel(&near, |i| {
            let is_inside = next.next().is_some_and(|&offset| is_inside(offset));
            inside[i / 64] |= u64::from(is_inside) << (i % 64);
        });
        let inside = sides(near, inside);
        Brick::of(place, Values::new(near, inside, offsets), inside, Bits::default())
    }

    /// Those of the middles of a brick's voxels along an axis; phantoms are on the border.
    fn coordinates(&self, axis: usize, place: u32) -> [f64; SIDE as usize] {
        let (n, bounds) = (self.lattice.n_voxels()[axis], self.lattice.bounds());
        std::array::from_fn(|i| match (place * SIDE + i as u32).checked_sub(SIDE) {
            None => bounds.min[axis],
            Some(i) if i >= n => bounds.max[axis],
            Some(i) => 0.5 * (self.lattice.corner(axis, i) + self.lattice.corner(axis, i + 1)),
        })
    }

    /// Makes what is beyond the border outside.
    fn close(&self, place: [u32; 3], near: &Bits, offsets: &mut [f32]) {
        let size = self.lattice.n_voxels();
        let mut next = offsets.iter_mut();
        each_voxel(near, |i| {
            let within = [i, i / 8, i / 64].map(|i| i as u32 % SIDE);
            let is_beyond = (0..3).any(|axis| {
                !(SIDE..SIDE + size[axis]).contains(&(place[axis] * SIDE + within[axis]))
            });
            if let Some(offset) = next.next()
                && is_beyond
            {
                *offset = f32::MIN;
            }
        });
    }
}

/// Calls `tell` with the number of each voxel of a brick that has a bit, in order.
#[inline]
fn each_voxel(bits: &Bits, mut tell: impl FnMut(usize)) {
    for (z, &slice) in bits.iter().enumerate() {
        let mut rest = slice;
        while rest != 0 {
            tell(64 * z + rest.trailing_zeros() as usize);
            rest &= rest - 1;
        }
    }
}

/// The bricks at the border that may hold voxels inside, and their neighbours: caps run through them.
/// Those in `near` may, whatever their first voxel is.
fn bricks_of_caps(
    is_inside: &mut dyn FnMut([u32; 3]) -> bool,
    size: [u32; 3],
    near: &Voxels,
) -> FxHashSet<[u32; 3]> {
    let mut bricks = FxHashSet::default();
    let n = size.map(|n| n.div_ceil(SIDE));
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for side in [0, n[axis] - 1] {
            for i in 0..n[u] {
                for j in 0..n[v] {
                    let mut place = [0; 3];
                    (place[axis], place[u], place[v]) = (side, i, j);
                    // Bricks without stored voxels are all inside or all outside.
                    if near.contains_key(&morton_encode(place.map(|i| i + 1)))
                        || is_inside(place.map(|i| i * SIDE))
                    {
                        let around = |k: u32| [k % 3, k / 3 % 3, k / 9];
                        let places = (0..27).map(around);
                        bricks.extend(places.map(|k| [0, 1, 2].map(|axis| place[axis] + k[axis])));
                    }
                }
            }
        }
    }
    bricks
}
