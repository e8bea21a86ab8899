//! The command line: the only place that knows arguments, the terminal and exit codes.

mod args;
mod progress;
mod report;

use std::{
    collections::HashMap,
    io::Write as _,
    path::{Path, PathBuf},
    process::ExitCode,
    time::Instant,
};

use self::{
    args::{Plan, StatsTarget},
    progress::Watch,
};
use crate::{
    Error, Result, output, pipeline,
    progress::Progress as _,
    scene::{self, Scene},
    statistics::Statistics,
};

/// Runs the command with the arguments of the process.
#[must_use]
pub fn run() -> ExitCode {
    match args::parse() {
        Ok(plan) => Session::new(plan).run(),
        Err(error) => {
            // Help that nobody reads is no failure.
            let _ = error.print();
            ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2))
        }
    }
}

/// All scenes of one call.
struct Session {
    plan: Plan,
    watch: Watch,
    /// The statistics so far, one line a scene.
    stats: String,
    /// Which scene each file comes from.
    claimed: HashMap<PathBuf, PathBuf>,
}

impl Session {
    fn new(plan: Plan) -> Self {
        let watch = Watch::new(!plan.quiet && report::is_terminal());
        Self { plan, watch, stats: String::new(), claimed: HashMap::new() }
    }

    /// Renders every scene, whatever happens to the others; the worst exit code counts.
    fn run(mut self) -> ExitCode {
        let mut worst = 0;
        for path in std::mem::take(&mut self.plan.scenes) {
            if self.watch.is_cancelled() {
                worst = Error::Interrupted.exit_code();
                break;
            }
            if let Err(error) = self.render(&path) {
                self.watch.clear();
                report::failure(&path, &error);
                worst = worst.max(error.exit_code());
            }
        }
        ExitCode::from(worst)
    }

    fn render(&mut self, path: &Path) -> Result<()> {
        let start = Instant::now();
        let scene = scene::load(path)?;
        self.claim(path, &scene)?;
        let report = pipeline::run(&scene, &self.plan.options, &self.watch)?;
        self.watch.clear();
        if !self.plan.quiet {
            report::summary(path, &report, start.elapsed());
        }
        self.record(&report.statistics)
    }

    /// Refuses a scene that would overwrite the files of one before it.
    fn claim(&mut self, path: &Path, scene: &Scene) -> Result<()> {
        for file in [&scene.outputs.png, &scene.outputs.exr].into_iter().flatten() {
            if let Some(other) = self.claimed.insert(file.clone(), path.to_owned()) {
                return Err(Error::Limit(format!(
                    "would overwrite {} of {}: give them different names or calls of their own",
                    self.plan.options.out_dir.join(file).display(),
                    other.display(),
                )));
            }
        }
        Ok(())
    }

    /// Adds the statistics of a scene. The file is whole after every scene.
    fn record(&mut self, statistics: &Statistics) -> Result<()> {
        let to_json = |path: &Path| {
            serde_json::to_string(statistics)
                .map_err(|error| Error::Encode { path: path.to_owned(), reason: error.to_string() })
        };
        match &self.plan.stats {
            StatsTarget::Nowhere => Ok(()),
            StatsTarget::Stdout => report::to_stdout(&to_json(Path::new("standard output"))?),
            StatsTarget::File(file) => {
                self.stats += &to_json(file)?;
                self.stats.push('\n');
                output::write_file(file, |out| Ok(out.write_all(self.stats.as_bytes())?))
            }
        }
    }
}
