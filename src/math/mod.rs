//! Numbers: everything here is independent of the rest of the crate.

mod lattice;
mod morton;

pub use lattice::{Aabb, Lattice};
pub use morton::{morton_decode, morton_encode};
