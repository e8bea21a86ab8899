//! The voxels near a surface: those that it may meet and the 26 around each, as bits by brick.

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::SIDE;
use crate::{math::morton_encode, octree::Storage, voxelize::OpenBrick};

/// Bit x + 8y of slice z of a brick.
pub(super) type Bits = [u64; SIDE as usize];

/// All voxels of a brick.
pub(super) const ALL: Bits = [u64::MAX; SIDE as usize];

/// Voxels by the Morton codes of their bricks' places, which count from a brick before the first one.
pub(super) type Voxels = FxHashMap<u64, Bits>;

/// The stored voxels and those around each.
pub(super) fn near_stored(storage: &dyn Storage) -> Voxels {
    let of_part = |part| {
        let mut around = Around::default();
        storage.visit(part, &mut |voxel| {
            let [x, y, z] = voxel.ijk.map(|i| i % SIDE);
            around.brick(voxel.ijk)[z as usize] |= 1 << (x + SIDE * y);
        });
        around.finish()
    };
    joined(storage.parts().into_par_iter().map(of_part).collect())
}

/// The open voxels and those around each.
pub(super) fn near_open(bricks: &[OpenBrick]) -> Voxels {
    let of_some = |some: &[OpenBrick]| {
        let mut around = Around::default();
        for brick in some {
            let [x, y, first] = brick.first.map(|i| i % SIDE);
            let slices = &mut around.brick(brick.first)[first as usize..];
            for (z, slice) in (0..OpenBrick::EDGE).zip(slices) {
                *slice |= brick.slice(z) << (x + SIDE * y);
            }
        }
        around.finish()
    };
    joined(bricks.par_chunks(SOME).map(of_some).collect())
}

/// Bricks of 4³ voxels that a thread takes at a time.
const SOME: usize = 1 << 12;

fn joined(parts: Vec<Voxels>) -> Voxels {
    let mut parts = parts.into_iter();
    let mut all = parts.next().unwrap_or_default();
    for (code, bits) in parts.flatten() {
        add(&mut all, code, &bits);
    }
    all
}

/// Takes voxels, and adds those around them brick by brick.
#[derive(Default)]
struct Around {
    all: Voxels,
    /// A brick that is not added yet.
    place: [u32; 3],
    bits: Bits,
}

impl Around {
    /// The bits of the brick that holds a voxel.
    fn brick(&mut self, voxel: [u32; 3]) -> &mut Bits {
        let place = voxel.map(|i| i / SIDE + 1);
        if place != self.place {
            self.add_brick();
            (self.place, self.bits) = (place, Bits::default());
        }
        &mut self.bits
    }

    fn add_brick(&mut self) {
        for (dx, in_x) in along_x(&self.bits).iter().zip(-1..).map(|(bits, d)| (d, bits)) {
            for (dy, in_y) in along_y(in_x).iter().zip(-1..).map(|(bits, d)| (d, bits)) {
                for (dz, in_z) in along_z(in_y).iter().zip(-1..).map(|(bits, d)| (d, bits)) {
                    if *in_z != Bits::default() {
                        let [x, y, z] = self.place;
                        let steps = [(x, dx), (y, dy), (z, dz)];
                        let place = steps.map(|(i, d): (u32, i32)| i.wrapping_add_signed(d));
                        add(&mut self.all, morton_encode(place), in_z);
                    }
                }
            }
        }
    }

    fn finish(mut self) -> Voxels {
        self.add_brick();
        self.all
    }
}

fn add(all: &mut Voxels, code: u64, bits: &Bits) {
    let of_brick = all.entry(code).or_default();
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
        let code = morton_encode(p.map(|i| i / SIDE));
        let bits = voxels.get(&code).copied().unwrap_or_default();
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
            let near = near_stored(&*voxels.finish());
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
