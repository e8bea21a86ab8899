//! zeroset: certified pictures and meshes of implicit surfaces.

pub mod cli;
pub mod diagnostic;
mod error;
pub mod eval;
pub mod expr;
pub mod limits;
pub mod math;
pub mod octree;
pub mod output;
pub mod pipeline;
pub mod progress;
pub mod raster;
pub mod scene;
pub mod statistics;
pub mod voxelize;

pub use error::{Error, Result};
