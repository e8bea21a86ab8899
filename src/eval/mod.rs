//! Programs to numbers: one [`Machine`] for every kind of [`Number`](crate::math::Number), and the
//! evaluators built on it: intervals over boxes, gradients over boxes, values and gradients at points.

mod boxes;
mod machine;
mod points;
mod roots;
mod sampler;
mod slopes;

pub use boxes::{BATCH, BoxEvaluator, Boxes, Ranges, Verdict};
pub use machine::Machine;
pub use points::{GradientEvaluator, POINT_BATCH, PointEvaluator, Points, batch};
pub use roots::Segment;
pub use sampler::{Sample, sampler};
pub use slopes::{SlopeEvaluator, SlopeVerdict};
