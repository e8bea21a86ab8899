//! How often errors are how large: 3000 bins of 0.001 on [0, 3].
//!
//! *Based on:* A. León Salas, 2008, section 3.9.

/// Bins of one unit.
const BINS_PER_UNIT: usize = 1000;
/// All bins.
pub const N_BINS: usize = 3 * BINS_PER_UNIT;

/// Counts of errors by size.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Histogram {
    /// Bin i: above i/1000, up to (i + 1)/1000; the first one has 0 too.
    pub counts: Vec<u64>,
    /// Larger than all bins.
    pub n_beyond: u64,
}

impl Histogram {
    /// Of errors, whatever their signs; what is no number is left out.
    #[must_use]
    pub fn new(errors: impl IntoIterator<Item = f64>) -> Self {
        let mut histogram = Self { counts: vec![0; N_BINS], n_beyond: 0 };
        for error in errors.into_iter().map(f64::abs).filter(|error| !error.is_nan()) {
            let bin = ((error * BINS_PER_UNIT as f64).ceil() as usize).saturating_sub(1);
            match histogram.counts.get_mut(bin) {
                Some(count) => *count += 1,
                None => histogram.n_beyond += 1,
            }
        }
        histogram
    }

    /// All that were counted.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.counts.iter().sum::<u64>() + self.n_beyond
    }

    /// The upper end of the bin up to which there is this part of all errors; infinite where that is
    /// beyond all bins.
    #[must_use]
    pub fn quantile(&self, part: f64) -> f64 {
        let wanted = part * self.total() as f64;
        let mut n = 0;
        let bin = self.counts.iter().position(|count| {
            n += count;
            n as f64 >= wanted
        });
        bin.map_or(f64::INFINITY, upper_end)
    }

    /// Counts of `width` bins each, from the first up to bin `end`.
    #[must_use]
    pub fn joined(&self, width: usize, end: usize) -> Vec<u64> {
        self.counts[..end.min(N_BINS)].chunks(width).map(|some| some.iter().sum()).collect()
    }
}

/// The upper end of a bin.
#[must_use]
pub(super) fn upper_end(bin: usize) -> f64 {
    (bin + 1) as f64 / BINS_PER_UNIT as f64
}

/// A width in bins, 1, 2 or 5 times a power of ten, of which about `n` reach as far as `most`.
#[must_use]
pub(super) fn even_width(most: f64, n: usize) -> usize {
    let bins = (most.min(3.0) * BINS_PER_UNIT as f64).max(1.0);
    let widths = [1, 2, 5, 10, 20, 50, 100, 200];
    widths.into_iter().find(|&width| bins <= (n * width) as f64).unwrap_or(200)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_are_closed_above() {
        let histogram = Histogram::new([0.0, 0.0005, -0.001, 0.0011, 3.0, -3.0001, f64::NAN]);
        assert_eq!(histogram.counts[..2], [3, 1]);
        assert_eq!((histogram.counts[N_BINS - 1], histogram.n_beyond), (1, 1));
        assert_eq!(histogram.total(), 6);
        assert_eq!(histogram.quantile(0.5), 0.001);
        assert_eq!(histogram.quantile(1.0), f64::INFINITY);
        assert_eq!(histogram.joined(2, 4), [4, 0]);
    }

    #[test]
    fn widths_fit() {
        assert_eq!(even_width(0.02, 20), 1);
        assert_eq!(even_width(0.5, 20), 50);
        assert_eq!(even_width(f64::INFINITY, 20), 200);
    }
}
