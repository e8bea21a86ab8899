//! `render yield`: how well threads share the work, as a table and a plot.

use std::{fmt::Write as _, path::PathBuf};

use super::{args::Scenes, progress::Watch, report};
use crate::{
    Result,
    output::{self, plot},
    pipeline,
    progress::Progress as _,
    scene::Scene,
    yields::{self, Yield},
};

/// What to measure.
#[derive(Debug)]
pub(super) struct Measurement {
    pub(super) threads: Vec<usize>,
    pub(super) runs: u32,
    pub(super) resolution: Option<u32>,
    /// Where plots go.
    pub(super) out_dir: PathBuf,
}

/// What the paper's Table 1 says: scene, seconds with one processor. For two to seven processors it
/// prints yields, of all three scenes between these.
const PAPER_SECONDS: [(&str, f64); 3] = [("scene1", 88.0), ("scene2", 111.0), ("scene3", 71.0)];
const PAPER_YIELDS: [(usize, &str); 3] = [(1, "100 %"), (2, "95-100 %"), (7, "75-92 %")];

/// Measures every scene; gives the worst exit code.
pub(super) fn measure(scenes: &Scenes, measurement: &Measurement) -> u8 {
    let watch = Watch::new(!scenes.quiet && report::is_terminal());
    let mut worst = 0;
    for path in &scenes.paths {
        let measured = scenes.load(path).and_then(|scene| measure_one(&scene, measurement, &watch));
        watch.clear();
        if let Err(error) = measured {
            report::failure(path, &error);
            worst = worst.max(error.exit_code());
        }
        if watch.is_cancelled() {
            break;
        }
    }
    worst
}

fn measure_one(scene: &Scene, measurement: &Measurement, watch: &Watch) -> Result<()> {
    let Measurement { threads, runs, resolution, out_dir } = measurement;
    let lattice = pipeline::lattice(scene, *resolution);
    let yields = yields::measure(scene, &lattice, threads, *runs, watch)?;
    watch.clear();
    let resolution = lattice.n_voxels().into_iter().max().unwrap_or(1);
    report::to_stdout(table(scene, resolution, &yields).as_bytes())?;
    let line = |name: &str, of: fn(&Yield) -> f64| {
        let points = yields.iter().map(|row| (row.threads as f64, 100.0 * of(row))).collect();
        (name.to_owned(), points)
    };
    let plot = plot::Plot {
        title: format!("{} at {resolution}: yield of threads", scene.name),
        x_label: "threads".to_owned(),
        y_label: "percent".to_owned(),
        y_max: 110.0,
        lines: vec![
            line("t1 / (n tn)", |row| row.plain),
            line("of n runs side by side", |row| row.share),
        ],
        ..plot::Plot::default()
    };
    let file = out_dir.join(format!("{}-yield.svg", scene.name));
    output::write_file(&file, |out| plot::write(&plot, out))
}

fn table(scene: &Scene, resolution: u32, yields: &[Yield]) -> String {
    let mut text = format!(
        "{} at resolution {resolution}\n\n\
         | threads | seconds | yield t1/(n tn) | of n runs side by side | paper |\n\
         |---|---|---|---|---|\n",
        scene.name
    );
    let in_paper = PAPER_SECONDS.iter().find(|(name, _)| *name == scene.name);
    for Yield { threads, seconds, plain, share } in yields {
        let printed = PAPER_YIELDS.iter().find(|(n, _)| n == threads).map(|(_, range)| *range);
        let paper = match (in_paper, printed) {
            (Some((_, seconds)), Some(range)) if *threads == 1 => format!("{seconds} s, {range}"),
            (Some(_), Some(range)) => range.to_owned(),
            _ => String::new(),
        };
        let _ = writeln!(
            text,
            "| {threads} | {seconds:.4} | {:.1} % | {:.1} % | {paper} |",
            100.0 * plain,
            100.0 * share
        );
    }
    text + "\n"
}
