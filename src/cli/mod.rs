//! The command line: the only place that knows arguments, the terminal and exit codes.

mod args;
mod convert;
mod evaluate;
mod exhibit;
mod progress;
mod render;
mod report;
mod yields;

use std::{path::Path, process::ExitCode};

use self::args::{Plan, Scenes};
use crate::{Error, Result, pipeline, scene};

/// Runs the command with the arguments of the process.
#[must_use]
pub fn run() -> ExitCode {
    let plan = match args::parse() {
        Ok(plan) => plan,
        Err(error) => {
            // Help that nobody reads is no failure.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    ExitCode::from(match plan {
        Plan::Render { scenes, options, stats } => render::render(scenes, options, stats),
        Plan::Check(scenes) => check(&scenes),
        Plan::Yield(scenes, measurement) => yields::measure(&scenes, &measurement),
        Plan::Evaluate(evaluation) => evaluate::evaluate(&evaluation),
        Plan::List => print(exhibit::list().as_bytes()),
        Plan::Exhibit(exhibition) => exhibit::exhibit(&exhibition),
        Plan::Convert(conversion) => convert::convert(&conversion),
        Plan::Schema => print(scene::schema().as_bytes()),
        Plan::Print(text) => print(&text),
    })
}

/// Looks for mistakes in every scene; the worst exit code counts.
fn check(scenes: &Scenes) -> u8 {
    let check = |path: &Path| -> Result<()> {
        let scene = scenes.load(path)?;
        pipeline::check(&scene)?;
        if !scenes.quiet {
            report::warnings(&scene);
            report::fine(path, &scene);
        }
        Ok(())
    };
    let failed = |path: &Path, error: &Error| {
        report::failure(path, error);
        error.exit_code()
    };
    let code = |path: &Path| check(path).map_or_else(|error| failed(path, &error), |()| 0);
    scenes.paths.iter().map(|path| code(path)).max().unwrap_or(0)
}

fn print(text: &[u8]) -> u8 {
    let Err(error) = report::to_stdout(text) else { return 0 };
    report::failure(Path::new("standard output"), &error);
    error.exit_code()
}
