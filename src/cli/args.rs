//! What was typed, and what it asks for. Nothing else sees clap.

use std::{
    num::NonZeroUsize,
    ops::RangeInclusive,
    path::{Path, PathBuf},
    thread,
};

use clap::{Args, CommandFactory, Parser, Subcommand, value_parser};
use clap_complete::Shell;

use super::{convert::Conversion, evaluate::Evaluation, yields::Measurement};
use crate::{
    evaluate, gallery,
    hrb::Criterion,
    import,
    math::SimdLevel,
    pipeline::Options,
    scene::{self, Loading, MAX_RESOLUTION, Scene},
};

const EXAMPLES: &str = "\
Examples:
  render heart.toml                          write out/heart.png and out/heart.exr
  render heart.toml --resolution 64          a quick look
  render knot.toml --set a=0.4 --set n=3     with other values of its parameters
  render *.toml --out pictures --quiet       many scenes, and nothing said unless something fails
  render turn.toml --frames 10-19            ten frames of a film
  render heart.toml --stats - | jq .         what was done, as JSON
  render gallery kummer                      a surface that comes with the program
  render convert a.jsurf -o a.toml           a scene of another program's file

Exit codes:
  0 all went well · 1 something failed · 2 a scene or an argument is wrong · 130 interrupted

With several scenes, one that fails does not keep the others from being rendered; the exit code is
then the highest of all. A scene file called `check` is rendered as `./check`.";

/// Renders implicit surfaces F(x, y, z) = 0 from scene files to PNG and EXR pictures.
#[derive(Debug, Parser)]
#[command(name = "render", version, after_help = EXAMPLES, max_term_width = 100)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
#[command(disable_help_subcommand = true)]
struct CommandLine {
    #[command(flatten)]
    render: RenderArgs,

    #[command(subcommand)]
    command: Option<Subcommands>,
}

#[derive(Debug, Args)]
struct RenderArgs {
    #[command(flatten)]
    input: Input,

    #[command(flatten)]
    rendering: Rendering,

    /// Frames of a film or a sweep to draw, such as 10-19 or 7 [default: all]
    #[arg(long, value_name = "A-B", value_parser = frames)]
    frames: Option<RangeInclusive<u32>>,

    /// Memory that may be taken, such as 800M or 12G [default: three quarters of the machine's]
    #[arg(long, value_name = "BYTES", value_parser = bytes)]
    max_memory: Option<u64>,

    /// SIMD level [default: the best of this machine]; the result does not depend on it
    #[arg(long, value_name = "LEVEL", value_parser = simd_level)]
    simd: Option<SimdLevel>,

    /// Write statistics to FILE (- for standard output): one JSON object a line for each scene or
    /// frame
    #[arg(long, value_name = "FILE|-")]
    stats: Option<PathBuf>,
}

/// What rendering scenes and surfaces of the gallery has in common.
#[derive(Debug, Args)]
struct Rendering {
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
}

impl Rendering {
    fn options(self) -> Options {
        Options {
            out_dir: self.out,
            threads: self.threads.and_then(|n| NonZeroUsize::new(usize::from(n))),
            resolution: self.resolution,
            ..Options::default()
        }
    }
}

/// What rendering and checking have in common.
#[derive(Debug, Args)]
struct Input {
    /// Scene files (TOML)
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,

    /// Give a parameter of the scenes another value, a number or a formula; may be repeated
    #[arg(long, value_name = "NAME=VALUE", allow_hyphen_values = true)]
    set: Vec<String>,

    /// Let scenes include files from outside their folders
    #[arg(long)]
    allow_outside: bool,

    /// Show no progress, warnings and summary; only mistakes and failures
    #[arg(long, short, display_order = 100)]
    quiet: bool,
}

#[derive(Debug, Args)]
struct YieldArgs {
    #[command(flatten)]
    input: Input,

    /// Numbers of threads to compare [default: 1, 2, 4 and so on up to one for each core]
    #[arg(long, value_name = "N,N,…", value_delimiter = ',')]
    #[arg(value_parser = value_parser!(u16).range(1..=1024))]
    threads: Vec<u16>,

    /// How often each is timed; medians are shown
    #[arg(long, value_name = "N", default_value_t = 5)]
    #[arg(value_parser = value_parser!(u32).range(1..=1000))]
    runs: u32,

    /// Voxels along the longest axis, instead of what the scenes say
    #[arg(long, value_name = "N")]
    #[arg(value_parser = value_parser!(u32).range(1..=i64::from(MAX_RESOLUTION)))]
    resolution: Option<u32>,

    /// Directory for the plots; created if it does not exist
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
}

#[derive(Debug, Args)]
struct GalleryArgs {
    /// Surfaces to render [default: a list is printed]
    #[arg(value_name = "NAME")]
    names: Vec<String>,

    /// Write a page with pictures, equations and models that turn, of the named surfaces or of all, to
    /// DIR/index.html
    #[arg(long, value_name = "DIR")]
    page: Option<PathBuf>,

    /// Write small pictures of the named surfaces or of all to one PNG file
    #[arg(long, value_name = "FILE")]
    sheet: Option<PathBuf>,

    /// Give a parameter of the scenes another value, a number or a formula; may be repeated
    #[arg(long, value_name = "NAME=VALUE", allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["page", "sheet"])]
    set: Vec<String>,

    #[command(flatten)]
    rendering: Rendering,

    /// Show no progress, warnings and summary; only mistakes and failures
    #[arg(long, short, display_order = 100)]
    quiet: bool,
}

#[derive(Debug, Args)]
struct EvaluateArgs {
    /// Models of the thesis (esfera, tronco, silla, jarron, also with :alpha1 or :alpha2), scenes with
    /// volumes, files of samples, or formulas of densities [default: the four models]
    #[arg(value_name = "SUBJECT")]
    subjects: Vec<String>,

    /// Directory for the report, its tables and pictures; created if it does not exist
    #[arg(long, value_name = "DIR", default_value = "out/evaluation")]
    out: PathBuf,

    /// Samples of models and formulas along each axis
    #[arg(long, value_name = "N,N,…", value_delimiter = ',', default_value = "32,64,128")]
    #[arg(value_parser = value_parser!(u32).range(8..=1024))]
    sizes: Vec<u32>,

    /// All sizes of the thesis, up to 512; takes minutes and some gigabytes
    #[arg(long, conflicts_with = "sizes")]
    full: bool,

    /// Where surfaces are [default: 60, or what a scene says]
    #[arg(long, value_name = "VALUE", allow_hyphen_values = true, value_parser = finite)]
    isovalue: Option<f64>,

    /// What tolerances are held against: samples among themselves, or each and their mean
    #[arg(long, value_name = "range|deviation", default_value = "deviation")]
    #[arg(value_parser = criterion)]
    criterion: Criterion,

    /// How often each time is taken; medians are shown
    #[arg(long, value_name = "N", default_value_t = 5)]
    #[arg(value_parser = value_parser!(u32).range(1..=1000))]
    runs: u32,

    /// Show no progress and summary; only mistakes and failures
    #[arg(long, short, display_order = 100)]
    quiet: bool,
}

#[derive(Debug, Args)]
struct ConvertArgs {
    /// The file; the ending of its name tells what it is
    #[arg(value_name = "FILE")]
    file: PathBuf,

    /// The scene file to write [default: standard output]
    #[arg(long, short, value_name = "SCENE.toml", value_parser = scene_file)]
    out: Option<PathBuf>,

    /// Draw the atoms of molecules as small balls with bonds between them
    #[arg(long)]
    sticks: bool,

    /// Show no notes; only mistakes and failures
    #[arg(long, short, display_order = 100)]
    quiet: bool,
}

#[derive(Debug, Subcommand)]
enum Subcommands {
    /// Find every mistake in scene files without rendering them
    Check(Input),
    /// Measure how well threads share the work: a table, and a plot NAME-yield.svg
    Yield(YieldArgs),
    /// List famous surfaces, render some, or make a page or a sheet of them
    Gallery(GalleryArgs),
    /// Remake the evaluation of León Salas (2008): a report on space, time and errors of octrees of
    /// samples
    Evaluate(EvaluateArgs),
    /// Make a scene file of a file of another program
    #[command(after_help = format!("Files that can be converted: {}", import::formats()))]
    Convert(ConvertArgs),
    /// Print the JSON Schema of scene files, with which editors complete them
    Schema,
    /// Print a script that makes a shell complete this command
    Completions {
        /// The shell
        shell: Shell,
    },
    /// Print the manual page
    Man,
}

/// The name of a scene file, so that no other file is replaced by mistake.
fn scene_file(name: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(name);
    match path.extension() {
        Some(ending) if ending == "toml" => Ok(path),
        _ => Err("the name of a scene file ends in .toml".to_owned()),
    }
}

fn finite(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| "write a number such as 60 or 0.5".to_owned())
}

fn criterion(name: &str) -> Result<Criterion, String> {
    match name {
        "range" => Ok(Criterion::Range),
        "deviation" => Ok(Criterion::Deviation),
        _ => Err("it is range or deviation".to_owned()),
    }
}

fn simd_level(name: &str) -> Result<SimdLevel, String> {
    SimdLevel::from_name(name).ok_or_else(|| {
        let available: Vec<_> = SimdLevel::available().into_iter().map(SimdLevel::name).collect();
        format!("this machine has {}", available.join(", "))
    })
}

/// A number of bytes with one of the endings K, M, G and T, for powers of 1024, or none.
fn bytes(text: &str) -> Result<u64, String> {
    let (number, exponent) = match text.find(|c: char| !c.is_ascii_digit()) {
        None => (text, 0),
        Some(end) => match &text[end..] {
            "K" | "k" => (&text[..end], 1),
            "M" => (&text[..end], 2),
            "G" => (&text[..end], 3),
            "T" => (&text[..end], 4),
            _ => return Err("write a number such as 800M or 12G".to_owned()),
        },
    };
    let number: Option<u64> = number.parse().ok();
    number
        .and_then(|n| n.checked_mul(1 << (10 * exponent)))
        .ok_or_else(|| "write a number such as 800M or 12G".to_owned())
}

/// `A-B` or a single number, from 1.
fn frames(text: &str) -> Result<RangeInclusive<u32>, String> {
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    match (first.parse(), last.parse()) {
        (Ok(first), Ok(last)) if 1 <= first && first <= last => Ok(first..=last),
        _ => Err("write a number from 1, or a range such as 10-19".to_owned()),
    }
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
pub(super) enum Plan {
    /// Render scenes.
    Render { scenes: Scenes, options: Options, stats: StatsTarget },
    /// Look for mistakes.
    Check(Scenes),
    /// Measure how well threads share the work.
    Yield(Scenes, Measurement),
    /// List the gallery.
    List,
    /// Show the gallery, or some of it.
    Exhibit(Exhibition),
    /// Evaluate octrees of samples.
    Evaluate(Evaluation),
    /// Make a scene of another program's file.
    Convert(Conversion),
    /// Print the schema of scene files.
    Schema,
    /// Print what was made of the definition of the arguments.
    Print(Vec<u8>),
}

/// Where a page and a sheet of the gallery go.
#[derive(Debug)]
pub(super) struct Exhibition {
    /// All where there are none.
    pub(super) names: Vec<String>,
    pub(super) page: Option<PathBuf>,
    pub(super) sheet: Option<PathBuf>,
    pub(super) options: Options,
    pub(super) quiet: bool,
}

/// Scene files and how to read them.
#[derive(Debug)]
pub(super) struct Scenes {
    /// Files, or names of the gallery.
    pub(super) paths: Vec<PathBuf>,
    /// What reads one of them.
    pub(super) read: fn(&Path, &Loading<'_>) -> crate::Result<Scene>,
    /// Each `name=value`.
    pub(super) settings: Vec<String>,
    /// Whether files outside a scene's folder may be included.
    pub(super) allow_outside: bool,
    /// Bytes of memory that a run may take, if the user says.
    pub(super) max_memory: Option<u64>,
    pub(super) quiet: bool,
}

impl Scenes {
    /// Reads one of them.
    pub(super) fn load(&self, path: &Path) -> crate::Result<Scene> {
        let Self { settings, allow_outside, max_memory, .. } = self;
        let (allow_outside, max_memory) = (*allow_outside, *max_memory);
        (self.read)(path, &Loading { settings, allow_outside, max_memory })
    }
}

/// Reads the command line. The error may be a request for help; it knows its own exit code.
pub(super) fn parse() -> Result<Plan, clap::Error> {
    CommandLine::try_parse().and_then(plan)
}

fn plan(line: CommandLine) -> Result<Plan, clap::Error> {
    Ok(match line.command {
        None => render(line.render),
        Some(Subcommands::Check(input)) => Plan::Check(scenes(input)),
        Some(Subcommands::Yield(args)) => measure(args),
        Some(Subcommands::Gallery(args)) => exhibit(args),
        Some(Subcommands::Evaluate(args)) => Plan::Evaluate(evaluation(args)),
        Some(Subcommands::Convert(ConvertArgs { file, out, sticks, quiet })) => {
            let options = import::Options { scene: out, has_sticks: sticks };
            Plan::Convert(Conversion { file, options, quiet })
        }
        Some(Subcommands::Schema) => Plan::Schema,
        Some(Subcommands::Completions { shell }) => Plan::Print(completions(shell)),
        Some(Subcommands::Man) => Plan::Print(manual()?),
    })
}

fn render(args: RenderArgs) -> Plan {
    Plan::Render {
        scenes: Scenes { max_memory: args.max_memory, ..scenes(args.input) },
        options: Options {
            simd: args.simd,
            max_memory: args.max_memory,
            find_all: args.stats.is_some(),
            frames: args.frames,
            ..args.rendering.options()
        },
        stats: match args.stats {
            None => StatsTarget::Nowhere,
            Some(file) if file.as_os_str() == "-" => StatsTarget::Stdout,
            Some(file) => StatsTarget::File(file),
        },
    }
}

fn exhibit(args: GalleryArgs) -> Plan {
    let GalleryArgs { names, page, sheet, set, rendering, quiet } = args;
    let options = rendering.options();
    if page.is_some() || sheet.is_some() {
        return Plan::Exhibit(Exhibition { names, page, sheet, options, quiet });
    }
    if names.is_empty() {
        return Plan::List;
    }
    let paths = names.into_iter().map(PathBuf::from).collect();
    let scenes = Scenes {
        paths,
        read: |name, loading| gallery::load(name, loading.settings),
        settings: set,
        allow_outside: false,
        max_memory: options.max_memory,
        quiet,
    };
    Plan::Render { scenes, options, stats: StatsTarget::Nowhere }
}

fn measure(args: YieldArgs) -> Plan {
    let n_cores = thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let powers = std::iter::successors(Some(1), |n| Some(2 * n)).take_while(|&n| n < n_cores);
    let threads = match args.threads.as_slice() {
        [] => powers.chain([n_cores]).collect(),
        some => some.iter().copied().map(usize::from).collect(),
    };
    let YieldArgs { input, runs, resolution, out, .. } = args;
    Plan::Yield(scenes(input), Measurement { threads, runs, resolution, out_dir: out })
}

fn evaluation(args: EvaluateArgs) -> Evaluation {
    let EvaluateArgs { subjects, out, mut sizes, full, isovalue, criterion, runs, quiet } = args;
    if full {
        sizes = vec![32, 64, 128, 256, 512];
    }
    sizes.sort_unstable();
    sizes.dedup();
    let settings = evaluate::Settings { sizes, criterion, runs, out_dir: out };
    Evaluation { subjects, isovalue, settings, quiet }
}

fn scenes(input: Input) -> Scenes {
    Scenes {
        paths: input.scenes,
        read: scene::load_with,
        settings: input.set,
        allow_outside: input.allow_outside,
        max_memory: None,
        quiet: input.quiet,
    }
}

fn completions(shell: Shell) -> Vec<u8> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut CommandLine::command(), "render", &mut script);
    script
}

fn manual() -> Result<Vec<u8>, clap::Error> {
    let mut page = Vec::new();
    clap_mangen::Man::new(CommandLine::command()).render(&mut page)?;
    Ok(page)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn planned(arguments: &[&str]) -> Plan {
        plan(CommandLine::parse_from(["render"].iter().chain(arguments))).unwrap()
    }

    #[test]
    fn arguments_are_consistent() {
        CommandLine::command().debug_assert();
    }

    #[test]
    fn dash_means_standard_output() {
        let target = |file| match planned(&["a.toml", "--stats", file]) {
            Plan::Render { stats, .. } => stats,
            other => panic!("{other:?}"),
        };
        assert_eq!(target("-"), StatsTarget::Stdout);
        assert_eq!(target("./-"), StatsTarget::File("./-".into()));
    }

    #[test]
    fn scenes_may_be_called_like_subcommands() {
        assert!(matches!(planned(&["check", "a.toml"]), Plan::Check(_)));
        for scenes in [&["./check"][..], &["a.toml", "check"], &["--", "check"]] {
            assert!(matches!(planned(scenes), Plan::Render { .. }), "{scenes:?}");
        }
    }

    #[test]
    fn values_may_be_negative() {
        let Plan::Check(scenes) = planned(&["check", "a.toml", "--set", "a=-1", "--set=b=-x"])
        else {
            panic!("not a check");
        };
        assert_eq!(scenes.settings, ["a=-1", "b=-x"]);
    }
}
