//! Programs to numbers: one [`Machine`] for every kind of [`Number`](crate::math::Number), and the
//! three evaluators built on it: intervals over boxes, values at points, gradients at points.

mod boxes;
mod machine;
mod points;

pub use boxes::{BATCH, BoxEvaluator, Boxes, Verdict};
pub use machine::Machine;
pub use points::{GradientEvaluator, POINT_BATCH, PointEvaluator, Points};
