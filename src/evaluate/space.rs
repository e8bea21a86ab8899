//! What octrees take, beside the grid.
//!
//! *Based on:* A. León Salas, 2008, section 3.6.

use super::surface::octree;
use crate::{
    hrb::{Criterion, Storage, Tolerance},
    volume::{Volume, with_samples},
};

/// The octree of a grid.
#[derive(Clone, Copy, Debug)]
pub struct Space {
    /// When samples were joined.
    pub tolerance: Tolerance,
    /// Counts and bytes.
    pub storage: Storage,
    /// Bytes of the samples as they are held.
    pub samples_bytes: u64,
}

impl Space {
    /// The thesis's bytes in percent of its grid.
    #[must_use]
    pub fn percent(&self) -> f64 {
        100.0 * self.storage.thesis_bytes as f64 / self.storage.grid_bytes as f64
    }

    /// Bytes that are held in percent of the samples.
    #[must_use]
    pub fn resident_percent(&self) -> f64 {
        100.0 * self.storage.resident_bytes as f64 / self.samples_bytes as f64
    }
}

/// What is measured: without a tolerance, and both criteria with two.
pub(super) const TOLERANCES: [Tolerance; 5] = [
    Tolerance { epsilon: 0.0, criterion: Criterion::Range },
    Tolerance { epsilon: 1.0, criterion: Criterion::Range },
    Tolerance { epsilon: 2.0, criterion: Criterion::Range },
    Tolerance { epsilon: 1.0, criterion: Criterion::Deviation },
    Tolerance { epsilon: 2.0, criterion: Criterion::Deviation },
];

/// The octrees of a volume, one for each of [`TOLERANCES`].
#[must_use]
pub(super) fn measure(volume: &Volume) -> Vec<Space> {
    let space = |tolerance| Space {
        tolerance,
        storage: with_samples!(&volume.samples, |samples| {
            octree(samples, volume.size, tolerance).storage()
        }),
        samples_bytes: volume.samples.sample_type().n_bytes() * volume.samples.len() as u64,
    };
    TOLERANCES.into_iter().map(space).collect()
}

/// How a tolerance is called.
#[must_use]
pub(super) fn name(tolerance: Tolerance) -> String {
    let Tolerance { epsilon, criterion } = tolerance;
    match criterion {
        _ if epsilon < 0.0 => "grid".to_owned(),
        _ if epsilon == 0.0 => "ε = 0".to_owned(),
        Criterion::Range => format!("ε = {epsilon}, range"),
        Criterion::Deviation => format!("ε = {epsilon}, deviation"),
    }
}
