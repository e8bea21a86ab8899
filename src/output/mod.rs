//! Results to files: one module per format, and the one way in which files come to be.
//!
//! A format writes to any `Write`; [`write_file`] gives it a file that appears under its name only
//! when it is complete. The same result gives the same bytes: no file holds a date.

pub mod apng;
mod atomic;
pub mod exr;
pub mod forces;
pub mod meshes;
pub mod plot;
pub mod ply;
pub mod png;
pub mod sheet;

pub(crate) use atomic::failed_to_write;
pub use atomic::{FileWriter, NewFile, write_file};

/// What files say about the program that made them.
const SOFTWARE: &str = concat!("zeroset ", env!("CARGO_PKG_VERSION"));

/// How writing a format ended.
pub type Written = Result<(), WriteError>;

/// Why a format could not be written; [`write_file`] adds the file's name.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The bytes did not reach their destination.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// The data cannot be expressed in the format; the encoder's own words.
    #[error("{0}")]
    Encode(String),
}
