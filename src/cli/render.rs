//! Rendering all scenes of one call.

use std::{
    collections::HashMap,
    io::Write as _,
    path::{Path, PathBuf},
    time::Instant,
};

use super::{
    args::{Scenes, StatsTarget},
    progress::Watch,
    report,
};
use crate::{
    Error, Result, output,
    pipeline::{self, Options},
    progress::Progress as _,
    scene::{self, Scene},
    statistics::Statistics,
};

/// Renders every scene, whatever happens to the others; gives the worst exit code.
pub(super) fn render(scenes: Scenes, options: Options, target: StatsTarget) -> u8 {
    let watch = Watch::new(!scenes.quiet && report::is_terminal());
    let claimed = HashMap::new();
    Session { scenes, options, target, watch, stats: String::new(), claimed }.run()
}

/// All scenes of one call.
struct Session {
    scenes: Scenes,
    options: Options,
    target: StatsTarget,
    watch: Watch,
    /// The statistics so far, one line a scene.
    stats: String,
    /// Which scene each file comes from.
    claimed: HashMap<PathBuf, PathBuf>,
}

impl Session {
    fn run(mut self) -> u8 {
        let start = Instant::now();
        let (mut worst, mut n_rendered, mut n_failed) = (0, 0, 0);
        for path in std::mem::take(&mut self.scenes.paths) {
            if self.watch.is_cancelled() {
                worst = Error::Interrupted.exit_code();
                break;
            }
            match self.render(&path) {
                Ok(()) => n_rendered += 1,
                Err(error) => {
                    n_failed += 1;
                    self.watch.clear();
                    report::failure(&path, &error);
                    worst = worst.max(error.exit_code());
                }
            }
        }
        if n_rendered + n_failed > 1 && !self.scenes.quiet {
            report::total(n_rendered, n_failed, start.elapsed());
        }
        worst
    }

    fn render(&mut self, path: &Path) -> Result<()> {
        let start = Instant::now();
        let scene = scene::load_with(path, &self.scenes.settings)?;
        if !self.scenes.quiet {
            report::warnings(&scene);
        }
        self.claim(path, &scene)?;
        let report = pipeline::run(&scene, &self.options, &self.watch)?;
        self.watch.clear();
        if !self.scenes.quiet {
            report::notes(path, &report);
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
                    self.options.out_dir.join(file).display(),
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
                .map(|line| line + "\n")
                .map_err(|error| Error::Encode { path: path.to_owned(), reason: error.to_string() })
        };
        match &self.target {
            StatsTarget::Nowhere => Ok(()),
            StatsTarget::Stdout => {
                report::to_stdout(to_json(Path::new("standard output"))?.as_bytes())
            }
            StatsTarget::File(file) => {
                self.stats += &to_json(file)?;
                output::write_file(file, |out| Ok(out.write_all(self.stats.as_bytes())?))
            }
        }
    }
}
