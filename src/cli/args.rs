//! What was typed, and what it asks for. Nothing else sees clap.

use std::{num::NonZeroUsize, path::PathBuf};

use clap::{Parser, value_parser};

use crate::{math::SimdLevel, pipeline::Options, scene::MAX_RESOLUTION};

const EXAMPLES: &str = "\
Examples:
  render heart.toml                          write out/heart.png and out/heart.exr
  render heart.toml --resolution 64          a quick look
  render *.toml --out pictures --quiet       many scenes, and nothing said unless something fails
  render heart.toml --stats - | jq .         what was done, as JSON

Exit codes:
  0 all went well · 1 something failed · 2 a scene or an argument is wrong · 130 interrupted

With several scenes, one that fails does not keep the others from being rendered; the exit code is
then the highest of all.";

/// Renders implicit surfaces F(x, y, z) = 0 from scene files to PNG and EXR pictures.
#[derive(Debug, Parser)]
#[command(name = "render", version, after_help = EXAMPLES, max_term_width = 100)]
struct Args {
    /// Scene files (TOML)
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,

    /// Directory for the pictures; created if it does not exist
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,

    /// Number of threads [default: one for each core]; the result does not depend on it
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    /// Voxels along the longest axis, instead of what the scenes say
    #[arg(long, value_name = "N")]
    #[arg(value_parser = value_parser!(u32).range(1..=i64::from(MAX_RESOLUTION)))]
    resolution: Option<u32>,

    /// SIMD level [default: the best of this machine]; the result does not depend on it
    #[arg(long, value_name = "LEVEL", value_parser = simd_level)]
    simd: Option<SimdLevel>,

    /// Write statistics to FILE (- for standard output): one JSON object a line for each scene
    #[arg(long, value_name = "FILE|-")]
    stats: Option<PathBuf>,

    /// Show no progress and no summary; only mistakes and failures
    #[arg(long, short)]
    quiet: bool,
}

fn simd_level(name: &str) -> Result<SimdLevel, String> {
    SimdLevel::from_name(name).ok_or_else(|| {
        let available: Vec<_> = SimdLevel::available().into_iter().map(SimdLevel::name).collect();
        format!("this machine has {}", available.join(", "))
    })
}

/// Where statistics go.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum StatsTarget {
    Nowhere,
    Stdout,
    File(PathBuf),
}

/// What to do.
#[derive(Debug)]
pub(super) struct Plan {
    pub(super) scenes: Vec<PathBuf>,
    pub(super) options: Options,
    pub(super) stats: StatsTarget,
    pub(super) quiet: bool,
}

/// Reads the command line. The error may be a request for help; it knows its own exit code.
pub(super) fn parse() -> Result<Plan, clap::Error> {
    Args::try_parse().map(Plan::from)
}

impl From<Args> for Plan {
    fn from(args: Args) -> Self {
        Self {
            scenes: args.scenes,
            options: Options {
                out_dir: args.out,
                threads: args.threads.and_then(|n| NonZeroUsize::new(usize::from(n))),
                resolution: args.resolution,
                simd: args.simd,
            },
            stats: match args.stats {
                None => StatsTarget::Nowhere,
                Some(file) if file.as_os_str() == "-" => StatsTarget::Stdout,
                Some(file) => StatsTarget::File(file),
            },
            quiet: args.quiet,
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn arguments_are_consistent() {
        Args::command().debug_assert();
    }

    #[test]
    fn dash_means_standard_output() {
        let plan = |stats| Plan::from(Args::parse_from(["render", "a.toml", "--stats", stats]));
        assert_eq!(plan("-").stats, StatsTarget::Stdout);
        assert_eq!(plan("./-").stats, StatsTarget::File("./-".into()));
    }
}
