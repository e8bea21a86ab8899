//! The command as its users meet it: exit codes, output streams, several scenes in one call.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]

use std::{
    fs,
    path::Path,
    process::{Command, Output, Stdio},
};

const SPHERE: &str = "version = 1\n[params]\na = 0.5\n[[surface]]\nf = \"x^2 + y^2 + z^2 = a\"\n\
    [domain]\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\n[image]\nwidth = 32\nheight = 32\n";

/// Renders in an empty directory that holds `a.toml`, `b.toml` (good) and `bad.toml`.
fn render(arguments: &[&str]) -> (Output, tempfile::TempDir) {
    let directory = tempfile::tempdir().unwrap();
    for (name, text) in [("a", SPHERE), ("b", SPHERE), ("bad", "version = 3")] {
        fs::write(directory.path().join(name).with_extension("toml"), text).unwrap();
    }
    let output = command(directory.path()).args(arguments).output().unwrap();
    (output, directory)
}

fn command(directory: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_render"));
    command.current_dir(directory);
    command
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn a_scene_is_rendered_and_summed_up() {
    let (output, _) = render(&["a.toml", "--resolution", "8"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(output.stdout.is_empty());
    assert!(stderr(&output).starts_with("a.toml: wrote out/a.png, out/a.exr in "), "{output:?}");
    assert_eq!(stderr(&output).lines().count(), 1);
}

#[test]
fn quiet_says_nothing() {
    let (output, _) = render(&["a.toml", "--resolution", "8", "--quiet"]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!((output.stdout, output.stderr), (vec![], vec![]));
}

#[test]
fn help_and_version_go_to_stdout() {
    let (output, _) = render(&["--help"]);
    let help = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0));
    for part in ["--resolution", "--set", "check ", "schema ", "Examples:", "Exit codes:"] {
        assert!(help.contains(part), "{part} is not in\n{help}");
    }
    let (output, _) = render(&["--version"]);
    let version = format!("render {}\n", env!("CARGO_PKG_VERSION"));
    assert_eq!(String::from_utf8(output.stdout).unwrap(), version);
}

#[test]
fn wrong_arguments_exit_with_2() {
    for arguments in [
        &[][..],
        &["a.toml", "--threads", "0"],
        &["a.toml", "--resolution", "99999999"],
        &["a.toml", "--nonsense"],
        &["check"],
        &["check", "a.toml", "--threads", "2"],
        &["completions", "tcsh"],
    ] {
        let (output, _) = render(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn a_missing_scene_exits_with_1_and_is_named() {
    let (output, _) = render(&["nowhere.toml"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).starts_with("error: cannot read nowhere.toml: "), "{output:?}");
}

#[test]
fn a_failed_scene_does_not_stop_the_others() {
    let (output, _) = render(&["bad.toml", "nowhere.toml", "a.toml", "--resolution", "8"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("unknown version 3"));
    assert!(stderr(&output).contains("a.toml: wrote"));
    let last = stderr(&output).lines().last().unwrap().to_owned();
    assert!(last.starts_with("1 rendered, 2 failed, "), "{last}");
}

#[test]
fn several_scenes_are_summed_up() {
    let (output, _) = render(&["a.toml", "b.toml", "--resolution", "8"]);
    assert_eq!(stderr(&output).lines().count(), 3, "{output:?}");
    assert!(stderr(&output).contains("2 rendered, 0 failed, "));
    let (output, _) = render(&["a.toml", "b.toml", "--resolution", "8", "--quiet"]);
    assert_eq!(output.stderr, b"");
}

#[test]
fn parameters_are_set() {
    let voxels = |arguments: &[&str]| {
        let (output, _) =
            render(&[&["a.toml", "--resolution", "16", "--stats", "-"], arguments].concat());
        let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        value["voxels"]["stored"].as_u64().unwrap()
    };
    assert_eq!(voxels(&["--set", "a=1/2"]), voxels(&[]));
    assert!(voxels(&["--set", "a=0.1"]) < voxels(&[]));
    let (output, _) = render(&["a.toml", "--set", "b=1"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("the scene has no parameter `b`"), "{output:?}");
}

#[test]
fn checking_writes_one_line_for_each_scene_and_no_file() {
    let (output, directory) = render(&["check", "a.toml", "b.toml"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(output.stdout.is_empty());
    assert_eq!(stderr(&output).lines().count(), 2, "{output:?}");
    assert!(stderr(&output).starts_with("a.toml: fine: 1 surface in the box from "), "{output:?}");
    assert!(!directory.path().join("out").exists());
    let (output, _) = render(&["check", "bad.toml", "a.toml", "nowhere.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("unknown version 3"));
    assert!(stderr(&output).contains("cannot read nowhere.toml"));
    let (output, _) = render(&["check", "a.toml", "--quiet"]);
    assert_eq!(output.stderr, b"");
}

#[test]
fn a_scene_may_be_called_like_a_subcommand() {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("check"), SPHERE).unwrap();
    let output = command(directory.path()).args(["./check", "--resolution", "8"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(directory.path().join("out/check.png").exists());
}

#[test]
fn warnings_do_not_fail_and_quiet_hides_them() {
    let directory = tempfile::tempdir().unwrap();
    let scene = "version = 1\n[params]\nphi = 2\n[[surface]]\nf = \"x = phi\"\n";
    fs::write(directory.path().join("a.toml"), scene).unwrap();
    let output = command(directory.path()).args(["check", "a.toml"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(stderr(&output).starts_with("warning: `phi` "), "{output:?}");
    let output = command(directory.path()).args(["check", "a.toml", "-q"]).output().unwrap();
    assert_eq!(output.stderr, b"");
}

#[test]
fn shells_and_manuals_are_served() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let (output, _) = render(&["completions", shell]);
        assert_eq!(output.status.code(), Some(0));
        assert!(String::from_utf8(output.stdout).unwrap().contains("resolution"), "{shell}");
    }
    let (output, _) = render(&["man"]);
    assert!(String::from_utf8(output.stdout).unwrap().contains(".TH render 1"));
}

#[test]
fn scenes_do_not_overwrite_each_other() {
    let (output, _) = render(&["a.toml", "a.toml", "--resolution", "8"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("would overwrite out/a.png"), "{output:?}");
}

#[test]
fn statistics_are_json_lines() {
    let (output, directory) =
        render(&["a.toml", "b.toml", "--resolution", "8", "--stats", "stats.json"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let text = fs::read_to_string(directory.path().join("stats.json")).unwrap();
    let objects: Vec<serde_json::Value> =
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(objects.len(), 2);
    assert!(objects.iter().all(serde_json::Value::is_object));
}

#[test]
fn statistics_alone_are_on_stdout() {
    let (output, _) = render(&["a.toml", "--resolution", "8", "--stats", "-"]);
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(value.is_object());
}

#[test]
fn a_closed_pipe_is_no_failure() {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("a.toml"), SPHERE).unwrap();
    let mut child = command(directory.path())
        .args(["a.toml", "--resolution", "8", "--stats", "-"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(!stderr(&output).contains("panicked"));
}

#[test]
fn an_empty_result_tells_the_range_of_f() {
    let directory = tempfile::tempdir().unwrap();
    let scene = "version = 1\n[[surface]]\nname = \"far\"\nf = \"x^2 + y^2 + z^2 + 1\"\n\
        [domain]\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\n";
    fs::write(directory.path().join("a.toml"), scene).unwrap();
    let output = command(directory.path()).args(["a.toml"]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let complaint = stderr(&output);
    assert!(complaint.contains("`far` does not meet the domain"), "{complaint}");
    assert!(complaint.contains("between 1.000000 at (0.0000, 0.0000, 0.0000)"), "{complaint}");
    assert!(complaint.contains("and 4.000000 at (-1.0000, -1.0000, -1.0000)"), "{complaint}");
    assert!(!directory.path().join("out").exists());
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("a.toml"), SPHERE).unwrap();
    fs::write(directory.path().join("file"), "in the way").unwrap();
    let arguments = ["a.toml", "--resolution", "8", "--out", "file/pictures"];
    let output = command(directory.path()).args(arguments).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).starts_with("error: cannot create file/pictures"), "{output:?}");
    assert_eq!(fs::read_to_string(directory.path().join("file")).unwrap(), "in the way");
}

/// Interrupted while it searches 8192³ voxels, which takes many seconds.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_no_file() {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("a.toml"), SPHERE).unwrap();
    let child = command(directory.path())
        .args(["a.toml", "--resolution", "8192", "--stats", "stats.json"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_millis(500));
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{output:?}");
    assert!(!directory.path().join("out").exists());
}

/// What is said about a scene with the sphere x² + y² + z² = 4 in the box given.
fn said_about_sphere(formula: &str, domain: &str) -> String {
    let directory = tempfile::tempdir().unwrap();
    let scene = format!(
        "version = 1\n[[surface]]\nname = \"it\"\nf = \"{formula}\"\n{domain}\n\
         [voxels]\nresolution = 64\n[image]\nwidth = 16\nheight = 16\n"
    );
    fs::write(directory.path().join("a.toml"), scene).unwrap();
    stderr(&command(directory.path()).args(["a.toml"]).output().unwrap())
}

#[test]
fn a_domain_that_does_not_fit_is_told() {
    let sphere = "x^2 + y^2 + z^2 = 4";
    let lies_in = "all of it lies in min = [-2.1, -2.1, -2.1], max = [2.1, 2.1, 2.1]";
    let found = said_about_sphere(sphere, "");
    assert!(found.contains(&format!("note: a.toml: {lies_in}, which is searched")), "{found}");
    let cut = said_about_sphere(sphere, "[domain]\nmin = [-1, -1, -1]\nmax = [3, 3, 3]");
    assert!(cut.contains(&format!("the domain cuts `it`: {lies_in}")), "{cut}");
    let small = said_about_sphere(sphere, "[domain]\nmin = [-90, -90, -90]\nmax = [90, 90, 90]");
    assert!(small.contains(&format!("of 64 voxels: {lies_in}")), "{small}");
    let away = said_about_sphere(sphere, "[domain]\nmin = [7, 7, 7]\nmax = [9, 9, 9]");
    assert!(away.contains("if it has points, they lie in min = [-2.1, -2.1, -2.1]"), "{away}");
    let fitting = said_about_sphere(sphere, "[domain]\nmin = [-3, -3, -3]\nmax = [3, 3, 3]");
    assert!(fitting.starts_with("a.toml: wrote"), "{fitting}");
}

#[test]
fn a_formula_without_a_surface_is_told() {
    let constant = said_about_sphere("3 - 2", "");
    assert!(constant.contains("F is 1 everywhere, whatever x, y and z are"), "{constant}");
    let zero = said_about_sphere("0.1*x - x/10", "");
    assert!(zero.contains("`it` was excluded from only 0 % of the voxels"), "{zero}");
    let endless = said_about_sphere("x + y + z", "");
    assert!(endless.contains("no bound was found for `it` within 2^20 of the origin"), "{endless}");
}

/// The digest of the picture of a sphere with more keys in the section `[voxels]`.
fn picture_with(keys: &str) -> (Output, String) {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("a.toml"), format!("{SPHERE}[voxels]\n{keys}\n")).unwrap();
    let arguments = ["a.toml", "--resolution", "64", "--stats", "-"];
    let output = command(directory.path()).args(arguments).output().unwrap();
    let stdout = String::from_utf8(output.stdout.clone()).unwrap();
    let digests = stdout.split("\"frame\"").nth(1).unwrap_or_default();
    (output, digests.split("\"precision\"").next().unwrap_or_default().to_owned())
}

#[test]
fn storage_and_schedule_do_not_show() {
    let (_, reference) = picture_with("");
    assert!(reference.contains("rgba"));
    for keys in [
        "storage = \"octree\"",
        "storage = \"pointer\"",
        "storage = \"dense\"",
        "schedule = \"master-slave\"",
        "storage = \"pointer\"\nschedule = \"master-slave\"",
    ] {
        let (output, picture) = picture_with(keys);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        assert_eq!(picture, reference, "{keys}");
    }
}

#[test]
fn what_does_not_fit_says_what_would() {
    let (output, directory) =
        render(&["a.toml", "--resolution", "2048", "--max-memory", "40M", "--stats", "-"]);
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    assert!(said.contains("million voxels are to be expected at resolution 2048"), "{said}");
    assert!(said.contains(" would fit, or give more with --max-memory"), "{said}");
    assert!(!directory.path().join("out").exists());
    let (output, _) = render(&["a.toml", "--max-memory", "1X"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("such as 800M or 12G"), "{output:?}");
}

#[test]
fn solids_that_do_not_fit_are_not_begun() {
    let jar = concat!(env!("CARGO_MANIFEST_DIR"), "/configs/jar.toml");
    let (output, directory) = render(&[jar, "--max-memory", "100K"]);
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    assert!(
        said.contains("file = \"volumes/jar.nrrd\"") && said.contains("--max-memory"),
        "{said}"
    );
    assert!(!directory.path().join("out").exists());
    let bumps = concat!(env!("CARGO_MANIFEST_DIR"), "/configs/bumps.toml");
    let (output, directory) = render(&[bumps, "--max-memory", "150M"]);
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    assert!(said.contains("the volumes and sculptures need") && said.contains("`size`"), "{said}");
    assert!(!directory.path().join("out").exists());
}

#[test]
fn a_yield_is_a_table_and_a_plot() {
    let arguments = ["yield", "a.toml", "--threads", "1,3", "--runs", "1", "--resolution", "16"];
    let (output, directory) = render(&arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let table = String::from_utf8(output.stdout).unwrap();
    let rows: Vec<&str> = table.lines().filter(|line| line.starts_with("| ")).collect();
    assert_eq!(rows.len(), 3, "{table}");
    assert!(rows[1].starts_with("| 1 |") && rows[2].starts_with("| 3 |"), "{table}");
    let plot = fs::read_to_string(directory.path().join("out/a-yield.svg")).unwrap();
    assert!(plot.starts_with("<svg") && plot.contains("threads"), "{plot}");
}

#[test]
fn candidates_can_be_hidden() {
    // A wall that the surface touches from one side: nothing of it can be certified.
    let scene = "version = 1\n[[surface]]\nf = \"x^2 = 0\"\n[domain]\nmin = [-1, -1, -1]\n\
        max = [1, 1, 1]\n[image]\nwidth = 32\nheight = 32\n";
    let covered = |more: &str| {
        let directory = tempfile::tempdir().unwrap();
        fs::write(directory.path().join("a.toml"), format!("{scene}{more}")).unwrap();
        let arguments = ["a.toml", "--resolution", "16", "--stats", "-"];
        let output = command(directory.path()).args(arguments).output().unwrap();
        let stdout = String::from_utf8(output.stdout).unwrap();
        assert!(stdout.contains("\"certified\":0"), "{stdout}");
        !stdout.contains("\"covered\":0,")
    };
    assert!(covered(""));
    assert!(covered("shade = \"status\"\n"));
    assert!(!covered("candidates = false\n"));
}
