//! Virtual sculpture: strokes of tools change a sampled volume, its octree and its mesh where they
//! touch it, and nowhere else.
//!
//! *Based on:* A. León Salas, 2008, chapter 4.

mod contact;
mod flow;
mod live;
mod moved;
mod path;
mod plan;
#[cfg(test)]
mod tests;
mod tool;
mod work;

pub use contact::{Contact, Moment};
pub use live::Sculpture;
pub use path::{Path, Piece};
pub use plan::{DEPTH, Felt, Plan, Stroke};
pub use tool::{Deed, Falloff, Shape, Tool};
