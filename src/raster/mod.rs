//! Voxels to pictures.

mod frame;

pub use frame::Frame;
