//! README tells the truth: its commands, its scene, its message and its tables.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]

use std::{
    collections::BTreeSet,
    fs,
    path::Path,
    process::{Command, Output},
};

use serde_json::Value;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn readme() -> String {
    fs::read_to_string(root().join("README.md")).unwrap()
}

/// The first block of code in `language` that holds `marker`.
fn block(language: &str, marker: &str) -> String {
    let readme = readme();
    let blocks = readme.split("```").skip(1).step_by(2);
    let mut of_language = blocks.filter_map(|block| block.strip_prefix(&format!("{language}\n")));
    of_language.find(|block| block.contains(marker)).unwrap().to_owned()
}

/// Renders the scene `text` as `pebble.toml`, small.
fn render(text: &str) -> Output {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("pebble.toml"), text).unwrap();
    Command::new(env!("CARGO_BIN_EXE_render"))
        .current_dir(directory.path())
        .args(["pebble.toml", "--resolution", "32", "--stats", "-"])
        .output()
        .unwrap()
}

#[test]
fn the_two_commands_are_what_ci_runs() {
    let ci = fs::read_to_string(root().join(".ci/run")).unwrap().replace(" --locked", "");
    for command in block("sh", "cargo run").lines() {
        assert!(ci.contains(command), "{command} is not run");
    }
}

#[test]
fn the_first_scene_renders() {
    let output = render(&block("toml", "[[surface]]"));
    assert_eq!(output.status.code(), Some(0), "{output:?}");
}

#[test]
fn the_scene_with_names_renders_and_can_be_set() {
    let scene = block("toml", "[params]");
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("ring.toml"), scene).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_render"))
        .current_dir(directory.path())
        .args(["ring.toml", "--resolution", "32", "--set", "R=0.5", "--set", "r2=R/4"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
}

#[test]
fn the_scene_with_shapes_renders() {
    let scene = block("toml", "[shapes]");
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("link.toml"), scene).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_render"))
        .current_dir(directory.path())
        .args(["link.toml", "--resolution", "32"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
}

/// The message for an unknown shape lists all of them.
#[test]
fn every_shape_is_in_the_table() {
    let scene = "version = 1\n[[surface]]\nshape = \"qqqqqqqq(1)\"\n";
    let said = String::from_utf8(render(scene).stderr).unwrap();
    let (_, names) = said.split_once("shapes are made by ").unwrap();
    let readme = readme();
    let names: Vec<&str> = names.trim().split(", ").collect();
    assert!(names.len() > 30, "{names:?}");
    for name in names {
        let is_named = [format!("{name}("), format!("`{name}`"), format!(" {name}")];
        assert!(is_named.iter().any(|text| readme.contains(text)), "`{name}` is not in README");
    }
}

#[test]
fn the_film_renders() {
    let scene = block("toml", "[animation]");
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("film.toml"), scene).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_render"))
        .current_dir(directory.path())
        .args(["film.toml", "--resolution", "32", "--frames", "24"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(directory.path().join("out/film_0024.png").exists());
}

#[test]
fn the_sweep_renders() {
    let scene = block("toml", "[sweep]");
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("sweep.toml"), scene).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_render"))
        .current_dir(directory.path())
        .args(["sweep.toml", "--resolution", "32", "--frames", "10-15"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(directory.path().join("out/sweep.sheet.png").exists());
}

#[test]
fn the_function_graph_is_a_surface() {
    let graph = zeroset::expr::Expr::from_vm(&block("text", "var-x")).unwrap();
    assert_eq!(graph.constant(), None);
}

#[test]
fn every_key_is_in_the_table() {
    let schema = fs::read_to_string(root().join("configs/schema.json")).unwrap();
    let schema: Value = serde_json::from_str(&schema).unwrap();
    let readme = readme();
    for (section, schema) in schema["properties"].as_object().unwrap() {
        let is_named = [format!("{section}]"), format!("`{section}`")];
        assert!(is_named.iter().any(|text| readme.contains(text)), "{section}");
        let keys = schema["properties"].as_object().or(schema["items"]["properties"].as_object());
        for key in keys.into_iter().flatten().map(|(key, _)| key) {
            assert!(readme.contains(&format!("`{key}`")), "`{key}` of {section} is not in README");
        }
    }
}

#[test]
fn the_message_is_what_is_said() {
    let scene = "version = 1\n[[surface]]\nf = \"sqr(x) + y^2 + z^2 = 1\"\n";
    let said = String::from_utf8(render(scene).stderr).unwrap();
    assert_eq!(said, block("text", "error:"));
}

#[test]
fn every_statistic_is_explained() {
    let output = render(&format!("{}[output]\nobj = true\n", block("toml", "[[surface]]")));
    let statistics: Value = serde_json::from_slice(&output.stdout).unwrap();
    let mut keys = BTreeSet::new();
    collect_keys("", &statistics, &mut keys);
    let readme = readme();
    for key in keys {
        let (section, name) = key.rsplit_once('.').unwrap_or(("", &key));
        let explained = [&key, section, &format!(".{name}")];
        assert!(
            explained.iter().any(|text| !text.is_empty() && readme.contains(&format!("`{text}`"))),
            "`{key}` is not in README"
        );
    }
}

fn collect_keys(prefix: &str, value: &Value, keys: &mut BTreeSet<String>) {
    match value {
        Value::Object(members) => {
            for (name, member) in members {
                let key = if prefix.is_empty() { name.clone() } else { format!("{prefix}.{name}") };
                collect_keys(&key, member, keys);
            }
        }
        Value::Array(items) if items.iter().any(Value::is_object) => {
            items.iter().for_each(|item| collect_keys(&format!("{prefix}[]"), item, keys));
        }
        _ => {
            keys.insert(prefix.to_owned());
        }
    }
}

#[test]
fn files_that_are_named_exist() {
    let readme = readme();
    let links = readme.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    for link in links.filter(|link| !link.starts_with("http") && !link.starts_with('#')) {
        assert!(root().join(link).exists(), "{link} does not exist");
    }
}
