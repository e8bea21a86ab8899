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
    Error, Result, film, output,
    pipeline::{self, Options},
    progress::Progress as _,
    scene::{Outputs, Scene},
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
    /// The statistics so far, one line a scene or frame.
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
        let scene = self.scenes.load(path)?;
        if !self.scenes.quiet {
            report::warnings(&scene);
        }
        self.claim(path, &scene)?;
        let (notes, written) = if scene.n_frames() > 0 {
            let film = self.film(&scene)?;
            let written = report::film(&film);
            (film.notes, written)
        } else {
            let report = pipeline::run(&scene, &self.options, &self.watch)?;
            self.record(&report.statistics)?;
            self.save()?;
            (report.notes, report::files(&report.written))
        };
        self.watch.clear();
        if !self.scenes.quiet {
            report::notes(path, &notes);
            report::summary(path, &written, start.elapsed());
        }
        Ok(())
    }

    /// Makes a film or a sweep. The statistics of what was done are kept if it is cut short.
    fn film(&mut self, scene: &Scene) -> Result<film::Report> {
        let options = self.options.clone();
        let watch = self.watch.clone();
        let made = film::run(scene, &options, &watch, |statistics| self.record(&statistics));
        self.save().and(made)
    }

    /// Refuses a scene that would overwrite the files of one before it, or lacks frames.
    fn claim(&mut self, path: &Path, scene: &Scene) -> Result<()> {
        let is_film = scene.n_frames() > 0 || self.options.frames.is_some();
        let outputs = match is_film {
            true => film::outputs(scene, &self.options)?,
            false => vec![scene.outputs.clone()],
        };
        for file in outputs.iter().flat_map(Outputs::files) {
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

    /// Adds the statistics of a scene or frame.
    fn record(&mut self, statistics: &Statistics) -> Result<()> {
        let (path, is_stdout) = match &self.target {
            StatsTarget::Nowhere => return Ok(()),
            StatsTarget::Stdout => (Path::new("standard output"), true),
            StatsTarget::File(file) => (file.as_path(), false),
        };
        let line = serde_json::to_string(statistics)
            .map_err(|error| Error::Encode { path: path.to_owned(), reason: error.to_string() })?
            + "\n";
        if is_stdout {
            return report::to_stdout(line.as_bytes());
        }
        self.stats += &line;
        Ok(())
    }

    /// Writes the statistics so far, if they go to a file.
    fn save(&self) -> Result<()> {
        match &self.target {
            StatsTarget::File(file) => {
                output::write_file(file, |out| Ok(out.write_all(self.stats.as_bytes())?))
            }
            _ => Ok(()),
        }
    }
}
