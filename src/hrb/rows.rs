//! Bits of a brick with one layer of its neighbours around it.

use crate::mesh::SIDE;

/// Samples along an edge of a brick, with both layers.
const WIDTH: usize = SIDE as usize + 2;

/// Rows of 10 bits along x, by z and y.
pub(super) type Rows = [[u16; WIDTH]; WIDTH];

/// The bits of 27 bricks, those of slice z as `of` gives them; nothing where there is no brick.
#[inline]
pub(super) fn rows_around<B>(bricks: &[Option<B>; 27], of: impl Fn(&B, usize) -> u64) -> Rows {
    let mut rows = Rows::default();
    for (z, slice) in rows.iter_mut().enumerate() {
        for k in 0..3 {
            let first = 3 * k + 9 * part(z);
            let bits = |x: usize| match &bricks[first + x] {
                Some(brick) => of(brick, within(z)),
                None => 0,
            };
            let (a, b, c) = (bits(0), bits(1), bits(2));
            let row = |y: usize| {
                let [a, b, c] = [a, b, c].map(|bits| (bits >> (8 * y)) as u16 & 0xff);
                a >> 7 | b << 1 | (c & 1) << 9
            };
            match k {
                0 => slice[0] = row(7),
                1 => (0..8).for_each(|y| slice[1 + y] = row(y)),
                _ => slice[9] = row(0),
            }
        }
    }
    rows
}

/// Which of three bricks in a row holds a place.
#[inline]
fn part(i: usize) -> usize {
    i.div_ceil(8)
}

/// Which voxel of it that is.
#[inline]
fn within(i: usize) -> usize {
    (i + 7) % 8
}
