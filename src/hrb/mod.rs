//! Sampled volumes as octrees of homogeneous regions (HRB-Octree).
//!
//! *Based on:* A. León Salas, 2008, chapters 2 and 3.

mod brick;
mod bricks;
mod build;
mod corners;
mod edit;
mod evaluate;
mod near;
mod octree;
mod parts;
mod rows;
mod sample;
mod samples;
#[cfg(test)]
mod tests;
mod whole;
mod window;

pub use build::{Criterion, Tolerance};
pub use edit::Changes;
pub use near::NearVoxels;
pub use octree::{HrbOctree, Region, Storage};
pub use sample::{Fixed8, Sample, Value};
pub use samples::Samples;
pub(crate) use samples::{copy, join_around};
pub(crate) use window::Window;
