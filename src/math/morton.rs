//! Morton order: the bits of three coordinates interleaved, x lowest (child x + 2y + 4z).

/// Interleaves the low 21 bits of each coordinate.
#[must_use]
pub fn morton_encode(ijk: [u32; 3]) -> u64 {
    spread(ijk[0]) | (spread(ijk[1]) << 1) | (spread(ijk[2]) << 2)
}

/// The inverse of [`morton_encode`].
#[must_use]
pub fn morton_decode(code: u64) -> [u32; 3] {
    [gather(code), gather(code >> 1), gather(code >> 2)]
}

/// Coordinates of child `c` = x + 2y + 4z of the node at `ijk`, each on its own level's lattice.
#[must_use]
pub fn child_of(ijk: [u32; 3], c: u32) -> [u32; 3] {
    [ijk[0] << 1 | c & 1, ijk[1] << 1 | c >> 1 & 1, ijk[2] << 1 | c >> 2]
}

/// Moves bit i to bit 3i.
fn spread(v: u32) -> u64 {
    let mut v = u64::from(v) & 0x1f_ffff;
    v = (v | v << 32) & 0x001f_0000_0000_ffff;
    v = (v | v << 16) & 0x001f_0000_ff00_00ff;
    v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
    v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
    (v | v << 2) & 0x1249_2492_4924_9249
}

/// Moves bit 3i to bit i.
fn gather(code: u64) -> u32 {
    let mut v = code & 0x1249_2492_4924_9249;
    v = (v | v >> 2) & 0x10c3_0c30_c30c_30c3;
    v = (v | v >> 4) & 0x100f_00f0_0f00_f00f;
    v = (v | v >> 8) & 0x001f_0000_ff00_00ff;
    v = (v | v >> 16) & 0x001f_0000_0000_ffff;
    ((v | v >> 32) & 0x1f_ffff) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn decode_inverts_encode(x in 0..1_u32 << 21, y in 0..1_u32 << 21, z in 0..1_u32 << 21) {
            prop_assert_eq!(morton_decode(morton_encode([x, y, z])), [x, y, z]);
        }
    }

    #[test]
    fn child_order_is_x_plus_2y_plus_4z() {
        for child in 0..8_u32 {
            assert_eq!(morton_encode([child & 1, child >> 1 & 1, child >> 2]), u64::from(child));
        }
    }
}
