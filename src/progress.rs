//! How long work tells where it is and learns that it should stop.

/// Watches a run. Stages call it from many threads; nothing they compute depends on it, except
/// that a cancelled run ends early with [`crate::Error::Interrupted`].
pub trait Progress: Sync {
    /// A stage of `total` units of work begins; `unit` names them ("subtrees", "voxels").
    fn begin(&self, stage: &str, total: u64, unit: &str);

    /// `units` more of the current stage are done.
    fn advance(&self, units: u64);

    /// The current stage is done.
    fn end(&self);

    /// Whether the user asked to stop. Polled often; must be cheap.
    fn is_cancelled(&self) -> bool;
}

/// Watches nothing and never cancels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unwatched;

impl Progress for Unwatched {
    fn begin(&self, _stage: &str, _total: u64, _unit: &str) {}
    fn advance(&self, _units: u64) {}
    fn end(&self) {}
    fn is_cancelled(&self) -> bool {
        false
    }
}
