//! pipeline

use std::path::PathBuf;

use crate::{Result, progress::Progress, scene::Scene};

/// How to run.
#[derive(Clone, Debug)]
pub struct Options {
    /// Where files are written.
    pub out_dir: PathBuf,
    /// Threads, or all that there are.
    pub threads: Option<usize>,
    /// Instead of the scene's own.
    pub resolution: Option<u32>,
    /// SIMD level, or the best that there is.
    pub simd: Option<String>,
}

/// What a run did.
#[derive(Clone, Debug)]
pub struct Report {
    /// Numbers.
    pub statistics: Statistics,
    /// Files.
    pub written: Vec<PathBuf>,
}

/// Numbers of a run.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Statistics {
    /// The scene's name.
    pub scene: String,
}

/// Runs.
///
/// # Errors
/// None yet.
pub fn run(scene: &Scene, options: &Options, _progress: &dyn Progress) -> Result<Report> {
    let files = [&scene.outputs.png, &scene.outputs.exr];
    Ok(Report {
        statistics: Statistics { scene: scene.name.clone() },
        written: files.into_iter().flatten().map(|file| options.out_dir.join(file)).collect(),
    })
}
