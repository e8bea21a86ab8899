//! How much memory a volume takes.

use super::{Refusal, SampleType, times};
use crate::memory::{self, mebibytes};

/// Bytes that so many samples and their octree take, at most.
pub(super) fn bytes_with_octree(n_samples: u64, sample_type: SampleType) -> u64 {
    // A value in the octree takes twice the bytes of a sample or 8 at most, with a part of the nodes.
    let of_sample = sample_type.n_bytes();
    n_samples.saturating_mul(of_sample + (5 * of_sample / 2).min(10))
}

/// Whether samples and their octree fit into so many bytes, or into what is usual.
///
/// # Errors
/// They do not.
pub(super) fn check_room(
    size: [u32; 3],
    sample_type: SampleType,
    max_memory: Option<u64>,
) -> Result<(), Refusal> {
    let n = size.iter().map(|&n| u64::from(n)).product::<u64>();
    let needed = bytes_with_octree(n, sample_type);
    match max_memory.or_else(memory::usual) {
        Some(bytes) if needed > bytes => Err(format!(
            "its {} samples of {sample_type} need {} with their octree, and {} are what they may \
             take; give more with --max-memory",
            times(size.map(u64::from)),
            mebibytes(needed),
            mebibytes(bytes),
        )),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_volume_larger_than_memory_is_refused() {
        let check = |bytes| check_room([512; 3], SampleType::U8, Some(bytes));
        assert!(check(1 << 30).is_ok());
        let error = check(100 << 20).unwrap_err();
        assert!(error.contains("need 384 MiB with their octree, and 100 MiB"), "{error}");
    }
}
