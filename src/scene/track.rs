//! Parameters that differ from frame to frame.

use std::ops::Range;

use super::formula::Formula;

/// A parameter with its value in each frame.
#[derive(Clone, Debug)]
pub(super) struct Track {
    pub(super) name: String,
    /// The section that says so.
    pub(super) section: &'static str,
    /// One for each frame, at least one.
    pub(super) values: Vec<f64>,
    /// Where they are written.
    pub(super) span: Range<usize>,
}

impl Track {
    /// The same as it would stand in `[params]`, in a frame that counts from 0.
    pub(super) fn formula(&self, frame: u32, source: &str) -> Formula {
        Formula::of_number(&self.values[frame as usize].to_string(), self.span.clone(), source)
    }
}
