//! The voxels near a surface: those that it may meet and the 26 around each, as bits by brick.

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::SIDE;
use crate::octree::Storage;

/// Bit x + 8y of slice z of a brick.
pub(super) type Bits = [u64; SIDE as usize];

/// All voxels of a brick.
pub(super) const ALL: Bits = [u64::MAX; SIDE as usize];

/// Voxels by their bricks' places, which count from a brick before the first one.
pub(super) type Voxels = FxHashMap<[u32; 3], Bits>;

/// The stored voxels and those around each.
pub(super) fn near(storage: &dyn Storage) -> Voxels {
    let parts: Vec<Voxels> = storage
        .parts()
        .into_par_iter()
        .map(|part| {
            let mut near = Voxels::default();
            let (mut place, mut stored) = ([0; 3], Bits::default());
            storage.visit(part, &mut |voxel| {
                let own = voxel.ijk.map(|i| i / SIDE + 1);
                if own != place {
                    add_around(&mut near, place, &stored);
                    (place, stored) = (own, Bits::default());
                }
                let [x, y, z] = voxel.ijk.map(|i| i % SIDE);
                stored[z as usize] |= 1 << (x + SIDE * y);
            });
            add_around(&mut near, place, &stored);
            near
        })
        .collect();
    let mut all = Voxels::default();
    for (place, bits) in parts.into_iter().flatten() {
        add(&mut all, place, &bits);
    }
    all
}

/// Adds the voxels of a brick and those around them, wherever they are.
fn add_around(all: &mut Voxels, place: [u32; 3], bits: &Bits) {
    for (dx, in_x) in along_x(bits).iter().zip(-1..).map(|(bits, d)| (d, bits)) {
        for (dy, in_y) in along_y(in_x).iter().zip(-1..).map(|(bits, d)| (d, bits)) {
            for (dz, in_z) in along_z(in_y).iter().zip(-1..).map(|(bits, d)| (d, bits)) {
                if *in_z != Bits::default() {
                    let [x, y, z] = place;
                    let steps = [(x, dx), (y, dy), (z, dz)];
                    add(all, steps.map(|(i, d): (u32, i32)| i.wrapping_add_signed(d)), in_z);
                }
            }
        }
    }
}

fn add(all: &mut Voxels, place: [u32; 3], bits: &Bits) {
    let of_brick = all.entry(place).or_default();
    (0..SIDE as usize).for_each(|z| of_brick[z] |= bits[z]);
}

/// Columns x = 0 and x = 7.
const FIRST: u64 = 0x0101_0101_0101_0101;
const LAST: u64 = FIRST << 7;

/// The voxels and those beside them along x: in the brick before, in their own, and in the next one.
fn along_x(bits: &Bits) -> [Bits; 3] {
    [
        bits.map(|b| (b & FIRST) << 7),
        bits.map(|b| b | (b & !LAST) << 1 | (b & !FIRST) >> 1),
        bits.map(|b| (b & LAST) >> 7),
    ]
}

/// The same along y.
fn along_y(bits: &Bits) -> [Bits; 3] {
    [bits.map(|b| b << 56), bits.map(|b| b | b << 8 | b >> 8), bits.map(|b| b >> 56)]
}

/// The same along z.
fn along_z(bits: &Bits) -> [Bits; 3] {
    let [mut before, mut own, mut next] = [Bits::default(), *bits, Bits::default()];
    before[7] = bits[0];
    next[0] = bits[7];
    for z in 0..7 {
        own[z] |= bits[z + 1];
        own[z + 1] |= bits[z];
    }
    [before, own, next]
}

/// On which side each voxel of a brick is, if that is `inside` where it is `known`, and no two
/// neighbours of which one is not known are on different sides.
pub(super) fn sides(mut known: Bits, mut inside: Bits) -> Bits {
    while known != ALL && known != Bits::default() {
        let [more, of_more] = [known, inside].map(around);
        for z in 0..SIDE as usize {
            inside[z] |= of_more[z] & !known[z];
            known[z] |= more[z];
        }
    }
    inside
}

/// The voxels and those beside their faces, of the same brick.
fn around(bits: Bits) -> Bits {
    let [x, y, z] = [along_x, along_y, along_z].map(|along| along(&bits)[1]);
    std::array::from_fn(|i| x[i] | y[i] | z[i])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::octree::{OctNormal, PointerOctreeBuilder, StoreVoxels as _};

    const DEPTH: u32 = 5;

    fn holds(voxels: &Voxels, p: [u32; 3]) -> bool {
        let [x, y, z] = p.map(|i| i % SIDE);
        let bits = voxels.get(&p.map(|i| i / SIDE)).copied().unwrap_or_default();
        bits[z as usize] >> (x + SIDE * y) & 1 == 1
    }

    proptest! {
        /// One by one.
        #[test]
        fn all_voxels_around_are_near(
            ijk in prop::collection::btree_set(prop::array::uniform3(0_u32..1 << DEPTH), 1..20)
        ) {
            let mut voxels = Box::new(PointerOctreeBuilder::new(DEPTH));
            ijk.iter().for_each(|&ijk| voxels.store(ijk, OctNormal::from_bits(0), false));
            let near = near(&*voxels.finish());
            let n = (1 << DEPTH) + 2 * SIDE;
            for i in 0..n * n * n {
                let p = [i % n, i / n % n, i / n / n];
                let is_near = ijk.iter().any(|ijk| {
                    (0..3).all(|axis| p[axis].abs_diff(ijk[axis] + SIDE) <= 1)
                });
                prop_assert_eq!(holds(&near, p), is_near, "{:?}", p);
            }
        }

        /// A half space; of its voxels only those by its border are known.
        #[test]
        fn sides_spread_from_what_is_known(
            normal in prop::array::uniform3(-1_f64..1.0), height in -3_f64..3.0
        ) {
            let value = |i: usize| {
                let p = [i % 8, i / 8 % 8, i / 64].map(|i| i as f64 - 3.5);
                (0..3).map(|axis| normal[axis] * p[axis]).sum::<f64>() - height
            };
            let bits = |is: &dyn Fn(f64) -> bool| -> Bits {
                std::array::from_fn(|z| {
                    (0..64).fold(0, |bits, i| bits | u64::from(is(value(i + 64 * z))) << i)
                })
            };
            // Neighbours differ by less than 1.
            let known = bits(&|value| value.abs() <= 1.0);
            let inside = bits(&|value| value >= 0.0);
            prop_assume!(known != Bits::default());
            let of_known = std::array::from_fn(|z| known[z] & inside[z]);
            prop_assert_eq!(sides(known, of_known), inside);
        }
    }
}
