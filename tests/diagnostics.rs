//! Hostile and awkward scene files with the exact words that the command finds for them.
//!
//! Each `diagnostics/NAME.toml` is rendered, and what is said on standard error must equal
//! `diagnostics/NAME.stderr`. A first line such as `# arguments: check --set a=1` says how else to
//! call the command. After a change of words, `ZEROSET_BLESS=NAME` (or `all`) rewrites the
//! files; the test fails nonetheless, so that a blessing never looks like a pass.

#![expect(clippy::expect_used, reason = "a test that cannot find its cases has failed")]

use std::{
    collections::BTreeSet,
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

use libtest_mimic::{Arguments, Failed, Trial};

fn main() {
    let arguments = Arguments::from_args();
    let trials = names().into_iter().map(|name| Trial::test(name.clone(), move || check(&name)));
    libtest_mimic::run(&arguments, trials.collect()).exit();
}

fn directory() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/diagnostics")
}

/// Every case has a scene, a text or both: a missing scene is a case as well.
fn names() -> BTreeSet<String> {
    let entries = fs::read_dir(directory()).expect("the directory of the cases");
    let stem = |path: PathBuf| path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    entries.filter_map(|entry| stem(entry.expect("a case").path())).collect()
}

fn check(name: &str) -> Result<(), Failed> {
    let actual = complaint(name)?;
    let path = directory().join(format!("{name}.stderr"));
    let expected = fs::read_to_string(&path).unwrap_or_default();
    if env::var("ZEROSET_BLESS").is_ok_and(|wanted| wanted == name || wanted == "all") {
        fs::write(&path, &actual)?;
        return Err(format!("blessed: read the changes of {name}.stderr, then run again").into());
    }
    if actual == expected {
        return Ok(());
    }
    Err(format!(
        "--- expected\n{expected}\n--- actual\n{actual}\n--- to accept: ZEROSET_BLESS={name}"
    )
    .into())
}

/// What the command says about a scene that it must refuse, or warn of.
fn complaint(name: &str) -> Result<String, Failed> {
    let arguments = arguments(name);
    let is_check = arguments.first().is_some_and(|first| first == "check");
    let (subcommand, options) = arguments.split_at(usize::from(is_check));
    let mut command = Command::new(env!("CARGO_BIN_EXE_render"));
    command.current_dir(directory()).args(subcommand).arg(format!("{name}.toml")).args(options);
    if !is_check {
        command.args(["--out", env!("CARGO_TARGET_TMPDIR")]);
    }
    let output = command.output()?;
    match output.status.code() {
        Some(1 | 2) if output.stdout.is_empty() => Ok(String::from_utf8(output.stderr)?),
        Some(0) if is_check => Ok(String::from_utf8(output.stderr)?),
        _ => Err(format!("not refused: {output:?}").into()),
    }
}

/// The arguments in the first line of a case.
fn arguments(name: &str) -> Vec<String> {
    let bytes = fs::read(directory().join(name).with_extension("toml")).unwrap_or_default();
    let text = String::from_utf8_lossy(&bytes);
    let line = text.lines().next().and_then(|line| line.strip_prefix("# arguments: "));
    line.into_iter().flat_map(str::split_whitespace).map(str::to_owned).collect()
}
