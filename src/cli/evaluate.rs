//! `render evaluate`: reads what is to be evaluated, and says where the report is.

use std::{collections::HashMap, path::Path, time::Instant};

use super::{progress::Watch, report};
use crate::{
    evaluate::{self, Settings, Subject},
    pipeline::{self, Options},
};

/// What to evaluate, and how.
#[derive(Debug)]
pub(super) struct Evaluation {
    /// Names, files and formulas; the thesis's models if there are none.
    pub(super) subjects: Vec<String>,
    pub(super) isovalue: Option<f64>,
    pub(super) settings: Settings,
    pub(super) quiet: bool,
}

/// Writes a report; gives the exit code.
pub(super) fn evaluate(evaluation: &Evaluation) -> u8 {
    let watch = Watch::new(!evaluation.quiet && report::is_terminal());
    let start = Instant::now();
    let mut subjects = Vec::new();
    let mut worst = 0;
    let given = evaluation.subjects.iter().map(String::as_str);
    let models = evaluate::MODEL_NAMES.into_iter().filter(|_| evaluation.subjects.is_empty());
    for argument in given.chain(models) {
        match Subject::named(argument, evaluation.isovalue) {
            Ok(found) => subjects.extend(found),
            Err(error) => {
                report::failure(Path::new(argument), &error);
                worst = worst.max(error.exit_code());
            }
        }
    }
    if worst > 0 {
        return worst;
    }
    let written = pipeline::with_threads(&Options::default(), || {
        evaluate::run(&distinct(subjects), &evaluation.settings, &watch)
    });
    watch.clear();
    let out_dir = &evaluation.settings.out_dir;
    match written.and_then(|written| written) {
        Ok(written) => {
            if !evaluation.quiet {
                report::evaluated(&written, start.elapsed());
            }
            0
        }
        Err(error) => {
            report::failure(out_dir, &error);
            error.exit_code()
        }
    }
}

/// With names of files that differ.
fn distinct(mut subjects: Vec<Subject>) -> Vec<Subject> {
    let mut uses: HashMap<String, usize> = HashMap::new();
    for subject in &mut subjects {
        let n = uses.entry(subject.slug.clone()).or_insert(0);
        *n += 1;
        if *n > 1 {
            subject.slug = format!("{}-{n}", subject.slug);
        }
    }
    subjects
}
