//! What can go wrong, sorted by whose fault it is: the input's (exit code 2), the machine's
//! (exit code 1) or nobody's (an interrupt, exit code 130).

use std::path::PathBuf;

use crate::diagnostic::Rejection;

/// A failed run.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The scene file says something that cannot be done; every mistake found is listed.
    #[error("{} is not a valid scene", .0.sources.path.display())]
    Scene(Box<Rejection>),

    /// The scene is well formed, but no voxel of it can meet any of its surfaces.
    #[error("{0}")]
    Empty(String),

    /// The work would exceed a limit; the text names the limit and the key to change.
    #[error("{0}")]
    Limit(String),

    /// An argument names what does not exist.
    #[error("{0}")]
    Unknown(String),

    /// A file could not be read or written.
    #[error("cannot {action} {}", .path.display())]
    Io {
        /// What was tried, as a verb: "read", "write", "create".
        action: &'static str,
        /// The file or directory.
        path: PathBuf,
        /// Why it failed.
        source: std::io::Error,
    },

    /// An encoder refused the data.
    #[error("cannot encode {}: {reason}", .path.display())]
    Encode {
        /// The file that was to be written.
        path: PathBuf,
        /// The encoder's own words.
        reason: String,
    },

    /// The user asked to stop.
    #[error("interrupted")]
    Interrupted,
}

impl Error {
    /// The process exit code: 1 failure, 2 bad input, 130 interrupted.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Scene(_) | Self::Empty(_) | Self::Limit(_) | Self::Unknown(_) => 2,
            Self::Io { .. } | Self::Encode { .. } => 1,
            Self::Interrupted => 130,
        }
    }
}

/// A result whose error is [`Error`].
pub type Result<T> = std::result::Result<T, Error>;
