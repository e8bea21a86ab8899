//! Voxels to pictures.

mod frame;
mod settings;

pub use frame::Frame;
pub use settings::{ImageSettings, Material, Placement, Projection, View};
