//! What would fit a raw file of the wrong length: other sizes, another type, a header.

use super::{SampleType, bytes::Stored, times};

/// How many sizes are named.
const N_SIZES: usize = 4;

/// What to say of a file with `found` bytes of samples after `stored.skip` others.
pub(super) fn wrong_length(stored: &Stored, found: u64) -> String {
    let size = stored.size.map(u64::from);
    let (kind, n, wanted) = (stored.sample_type, stored.n_samples(), stored.n_bytes());
    let after = match stored.skip {
        0 => String::new(),
        skip => format!(" after the first {skip}"),
    };
    let said = format!(
        "it holds {found} bytes{after}, and {} samples of {kind} are {wanted}",
        times(size)
    );
    let mut fitting = Vec::new();
    let types: Vec<&str> = SampleType::ALL
        .into_iter()
        .filter(|other| n * other.n_bytes() == found)
        .map(SampleType::name)
        .collect();
    if !types.is_empty() {
        fitting.push(format!("that size of {}", types.join(", ")));
    }
    if stored.skip > 0 && found + stored.skip == wanted {
        fitting.push("no bytes before the samples".to_owned());
    } else if found > wanted {
        let header = stored.skip + (found - wanted);
        fitting.push(format!("{header} bytes before the samples, if they are a header"));
    }
    if found.is_multiple_of(kind.n_bytes()) {
        let sizes = sizes(found / kind.n_bytes(), size);
        if !sizes.is_empty() {
            let sizes: Vec<String> = sizes.into_iter().map(times).collect();
            fitting.push(format!("{} samples of {kind}", sizes.join(", ")));
        }
    }
    match fitting.is_empty() {
        true => said,
        false => format!("{said}; what would fit: {}", fitting.join("; or ")),
    }
}

/// Some sizes with `n` samples: first those that keep two of the `given` sides, then the nearest.
///
/// How far a size is from another is the sum of the ratios of their sides. Sizes with the same sides
/// in another order are told once, unless they keep two.
fn sizes(n: u64, given: [u64; 3]) -> Vec<[u64; 3]> {
    /// Sides that are wrong by more are no slip: of sizes that keep two sides, and of others.
    const MOST: [f64; 2] = [16.0, 8.0];
    let divisors = divisors(n);
    let mut found = Vec::new();
    for &x in &divisors {
        for &y in divisors.iter().take_while(|&&y| y <= n / x) {
            if (n / x).is_multiple_of(y) {
                let size = [x, y, n / x / y];
                let pairs = size.into_iter().zip(given);
                let is_other = pairs.clone().filter(|(a, b)| a == b).count() != 2;
                let ratios = pairs.map(|(a, b)| a.max(b) as f64 / a.min(b) as f64);
                let (sum, worst) = ratios.fold((0.0, 0.0_f64), |(s, w), r| (s + r, w.max(r)));
                if worst <= MOST[usize::from(is_other)] {
                    found.push((is_other, sum, size));
                }
            }
        }
    }
    found.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
    let mut told: Vec<[u64; 3]> = Vec::new();
    for (is_other, _, size) in found {
        let in_order = |mut size: [u64; 3]| {
            size.sort_unstable();
            size
        };
        let is_known = told.iter().any(|&other| in_order(other) == in_order(size));
        if told.len() < N_SIZES && !(is_other && is_known) {
            told.push(size);
        }
    }
    told
}

/// All divisors that fit a side, in order; none where `n` is larger than any volume.
fn divisors(n: u64) -> Vec<u64> {
    /// Trying divisors up to the root of this takes a millisecond.
    const MOST: u64 = 1 << 40;
    if n == 0 || n > MOST {
        return Vec::new();
    }
    let small: Vec<u64> = (1..=n.isqrt()).filter(|&d| n.is_multiple_of(d)).collect();
    let large = small.iter().rev().map(|d| n / d).filter(|&d| d > n.isqrt());
    small.iter().copied().chain(large).filter(|&d| u32::try_from(d).is_ok()).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::volume::bytes::{ByteOrder, Packing};

    fn said(size: [u32; 3], sample_type: SampleType, skip: u64, found: u64) -> String {
        let stored = Stored {
            size,
            sample_type,
            byte_order: ByteOrder::Little,
            packing: Packing::Plain,
            start: 0,
            skip,
        };
        wrong_length(&stored, found)
    }

    #[test]
    fn sides_that_were_mistyped_are_found() {
        assert_eq!(
            said([301, 324, 65], SampleType::U8, 0, 301 * 324 * 56),
            "it holds 5461344 bytes, and 301 x 324 x 65 samples of u8 are 6339060; what would fit: \
             301 x 324 x 56, 288 x 301 x 63, 258 x 336 x 63, 301 x 336 x 54 samples of u8"
        );
    }

    #[test]
    fn cubes_types_and_headers_are_found() {
        assert_eq!(
            said([64; 3], SampleType::U8, 0, 1 << 24),
            "it holds 16777216 bytes, and 64 x 64 x 64 samples of u8 are 262144; what would fit: \
             16515072 bytes before the samples, if they are a header; or 256 x 256 x 256, \
             128 x 256 x 512, 64 x 512 x 512 samples of u8"
        );
        assert_eq!(
            said([10, 20, 30], SampleType::U8, 0, 12000),
            "it holds 12000 bytes, and 10 x 20 x 30 samples of u8 are 6000; what would fit: that \
             size of u16, i16; or 6000 bytes before the samples, if they are a header; or \
             10 x 20 x 60, 10 x 40 x 30, 20 x 20 x 30, 12 x 25 x 40 samples of u8"
        );
        assert_eq!(
            said([10, 20, 30], SampleType::U8, 512, 6000 - 512),
            "it holds 5488 bytes after the first 512, and 10 x 20 x 30 samples of u8 are 6000; what \
             would fit: no bytes before the samples; or 7 x 28 x 28, 14 x 14 x 28, 7 x 16 x 49, \
             8 x 14 x 49 samples of u8"
        );
        assert_eq!(
            said([10, 20, 30], SampleType::U16, 0, 4001),
            "it holds 4001 bytes, and 10 x 20 x 30 samples of u16 are 12000"
        );
        assert_eq!(
            said([10, 20, 30], SampleType::U8, 0, 0),
            "it holds 0 bytes, and 10 x 20 x 30 samples of u8 are 6000"
        );
    }

    proptest! {
        #[test]
        fn sizes_have_as_many_samples(
            n in 1_u64..1 << 33,
            given in prop::array::uniform3(1_u64..3000),
        ) {
            for size in sizes(n, given) {
                prop_assert_eq!(size.iter().product::<u64>(), n);
            }
        }
    }
}
