//! Every input that fuzzing has kept does no harm: see `fuzz/`.

#![expect(clippy::unwrap_used, reason = "a corpus that cannot be read is a failure")]

use std::{fs, path::Path};

#[path = "../fuzz/checks.rs"]
mod checks;

fn for_each_file_of(target: &str, check: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target);
    let mut n_files = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let data = fs::read(&path).unwrap();
        if std::panic::catch_unwind(|| check(&data)).is_err() {
            panic!("{} does harm", path.display());
        }
        n_files += 1;
    }
    assert!(n_files > 0, "{target} has no corpus");
}

#[test]
fn formulas() {
    for_each_file_of("formula", checks::formula);
}

#[test]
fn scenes() {
    for_each_file_of("scene", checks::scene);
}

#[test]
fn graphs() {
    for_each_file_of("graph", checks::graph);
}

#[test]
fn imports() {
    for_each_file_of("import", checks::import);
}
