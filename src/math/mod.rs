//! Numbers: everything here is independent of the rest of the crate.

mod angle;
mod dual;
pub mod elementary;
mod interval;
mod lanes;
mod lattice;
mod mean_value;
mod morton;
mod number;
mod operation;
mod point;
mod srgb;

pub use dual::Dual;
pub use interval::Interval;
pub use lanes::{Lanes, Mask, Scalar, SimdLevel, SimdTask};
pub use lattice::{Aabb, Lattice};
pub use mean_value::MeanValue;
pub use morton::{child_of, morton_decode, morton_encode};
pub use number::{
    Constant, Hyperbolic, MaskOf, Notes, NotesOf, Number, ScalarOf, Step, Token, Wave,
};
pub use operation::{Binary, Slot, Unary};
pub use point::Point;
pub use srgb::linear_from_srgb;
