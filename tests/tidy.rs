//! The house's own rules: which module may use which.

#![expect(clippy::unwrap_used, reason = "a source file that cannot be read is a failure")]

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

/// Every top-level module with the modules that it may use; data flows from left to right through
/// the pipeline, so nobody uses what comes after.
const MAY_USE: &[(&str, &[&str])] = &[
    ("math", &[]),
    ("diagnostic", &[]),
    ("progress", &[]),
    ("files", &["diagnostic"]),
    ("memory", &[]),
    ("error", &["diagnostic"]),
    ("octree", &["math"]),
    ("expr", &["diagnostic", "math"]),
    ("eval", &["expr", "math"]),
    ("voxelize", &["eval", "expr", "math", "octree", "progress"]),
    ("volume", &["eval", "expr", "files", "math", "memory", "progress"]),
    ("mesh", &["eval", "expr", "math", "octree", "voxelize"]),
    ("hrb", &["mesh"]),
    ("sculpt", &["eval", "expr", "hrb", "math", "mesh", "progress"]),
    ("polygons", &["files", "math"]),
    ("raster", &["eval", "expr", "math", "octree", "polygons", "progress", "voxelize"]),
    ("isosurface", &["hrb", "mesh", "raster", "volume"]),
    ("output", &["math", "mesh", "octree", "raster", "sculpt"]),
    (
        "scene",
        &[
            "diagnostic",
            "expr",
            "files",
            "hrb",
            "isosurface",
            "math",
            "mesh",
            "octree",
            "output",
            "polygons",
            "progress",
            "raster",
            "sculpt",
            "volume",
            "voxelize",
        ],
    ),
    ("import", &["diagnostic", "expr", "files", "volume"]),
    ("statistics", &["math", "mesh", "octree", "raster", "voxelize"]),
    ("limits", &["math", "memory", "octree", "raster"]),
    ("advice", &["expr", "math", "octree", "voxelize"]),
    ("solids", &["limits", "progress", "raster", "scene", "statistics"]),
    ("meshing", &["expr", "math", "mesh", "octree", "scene", "statistics"]),
    (
        "pipeline",
        &[
            "advice",
            "expr",
            "limits",
            "math",
            "mesh",
            "meshing",
            "octree",
            "output",
            "progress",
            "raster",
            "scene",
            "sculpt",
            "solids",
            "statistics",
            "voxelize",
        ],
    ),
    (
        "film",
        &[
            "advice",
            "limits",
            "math",
            "octree",
            "output",
            "pipeline",
            "progress",
            "raster",
            "scene",
            "solids",
            "statistics",
        ],
    ),
    (
        "gallery",
        &[
            "diagnostic",
            "expr",
            "math",
            "mesh",
            "meshing",
            "output",
            "pipeline",
            "progress",
            "raster",
            "scene",
            "statistics",
        ],
    ),
    ("yields", &["math", "progress", "scene", "voxelize"]),
    (
        "evaluate",
        &[
            "eval",
            "expr",
            "hrb",
            "isosurface",
            "math",
            "mesh",
            "output",
            "polygons",
            "progress",
            "raster",
            "scene",
            "volume",
        ],
    ),
    (
        "cli",
        &[
            "diagnostic",
            "evaluate",
            "film",
            "gallery",
            "hrb",
            "import",
            "math",
            "output",
            "pipeline",
            "progress",
            "scene",
            "statistics",
            "yields",
        ],
    ),
];

/// What the crate's root offers to all.
const ROOT: [&str; 2] = ["Error", "Result"];

#[test]
fn modules_use_only_what_comes_before_them() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for path in files_below(&src) {
        let inside = path.strip_prefix(&src).unwrap().with_extension("");
        let module = inside.iter().next().unwrap().to_str().unwrap();
        if ["lib", "main"].contains(&module) {
            continue;
        }
        let (_, allowed) = MAY_USE.iter().find(|(name, _)| *name == module).unwrap_or_else(|| {
            panic!("module `{module}` is new: say in {} what it may use", file!())
        });
        for used in modules_used(&fs::read_to_string(&path).unwrap()) {
            let used = used.as_str();
            assert!(
                used == module || ROOT.contains(&used) || allowed.contains(&used),
                "{} uses crate::{used}, which is not among {allowed:?}",
                path.display()
            );
        }
    }
}

fn files_below(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries
        .flat_map(|path| if path.is_dir() { files_below(&path) } else { vec![path] })
        .filter(|path| path.extension().is_some_and(|ending| ending == "rs"))
        .collect()
}

/// The names that follow `crate::`, those of groups included. Comments and unit tests, which stand
/// last in a file, do not count.
fn modules_used(source: &str) -> BTreeSet<String> {
    let code: String = source
        .split("#[cfg(test)]\nmod tests {")
        .next()
        .unwrap_or_default()
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default())
        .collect::<Vec<_>>()
        .join(" ");
    let mut used = BTreeSet::new();
    for rest in code.split("crate::").skip(1) {
        match rest.strip_prefix('{') {
            None => used.extend(first_word(rest)),
            Some(group) => {
                let mut depth = 0;
                let is_item_border = |c: char| {
                    depth += i32::from(c == '{') - i32::from(c == '}');
                    depth < 0 || (depth == 0 && c == ',')
                };
                let group = &group[..closing_brace(group)];
                used.extend(group.split(is_item_border).filter_map(first_word));
            }
        }
    }
    used
}

/// Where the group that starts at the beginning of `text` ends.
fn closing_brace(text: &str) -> usize {
    let mut depth = 0;
    text.find(|c| {
        depth += i32::from(c == '{') - i32::from(c == '}');
        depth < 0
    })
    .unwrap_or(text.len())
}

fn first_word(text: &str) -> Option<String> {
    let word: String =
        text.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    (!word.is_empty()).then_some(word)
}

#[test]
fn groups_are_read_whole() {
    let source = "use crate::{\n  Error,\n  math::{Lattice, x}, octree::Storage,\n};\n\
                  let a = crate::eval::f(); // crate::cli";
    let used: Vec<String> = modules_used(source).into_iter().collect();
    assert_eq!(used, ["Error", "eval", "math", "octree"]);
}
