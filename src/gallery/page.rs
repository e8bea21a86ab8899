//! A page without a server: a picture of each surface, its equation, numbers, and a model that turns.
//!
//! `index.html` holds everything but pictures and models. A browser that opens a page from disk does
//! not let it read other files, so that models are scripts that hand over a GLB file as text, and
//! the viewer is a plain script as well.

use std::path::Path;

use base64::{Engine as _, engine::general_purpose::STANDARD};
use serde::Serialize;
use toml::{Table, Value};

use super::Entry;
use crate::{
    Error, Result,
    math::SimdLevel,
    mesh::Mesh,
    meshing,
    output::{
        self, WriteError,
        meshes::{MeshFormat, MeshOptions, write_glb},
        png,
    },
    pipeline::{self, Options, Picture},
    progress::Progress,
    raster::Placement,
    scene::{About, Scene},
    statistics::Statistics,
};

const TEMPLATE: &str = include_str!("page.html");

/// Where the template wants the surfaces.
const PLACE: &str = "/* surfaces */";

/// `@google/model-viewer` 4.4.0, as the registry has it, and its licence.
const VIEWER: [(&str, &str); 2] = [
    ("model-viewer.js", include_str!("../../gallery/viewer/model-viewer.js")),
    ("LICENSE", include_str!("../../gallery/viewer/LICENSE")),
];

/// Width and height of a picture.
const PICTURE: u32 = 480;

/// Samples along an edge of a pixel.
const SAMPLES: u32 = 3;

/// Voxels along the longest axis for numbers and models, unless options say otherwise.
const RESOLUTION: u32 = 128;

/// Triangles of a model.
const N_TRIANGLES: usize = 5000;

/// What was written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Page {
    /// Surfaces on it.
    pub n_surfaces: usize,
    /// Those with a model.
    pub n_models: usize,
}

/// A surface, as the page's script reads it.
#[derive(Debug, Serialize)]
struct Exhibit {
    name: String,
    #[serde(flatten)]
    about: About,
    equations: Vec<String>,
    /// Names that they use, and what these stand for.
    names: Vec<(String, String)>,
    /// The scene file.
    scene: &'static str,
    /// From the surface to the camera.
    direction: Option<[f64; 3]>,
    numbers: Numbers,
    has_model: bool,
}

/// What is known of a surface.
#[derive(Debug, Serialize)]
struct Numbers {
    resolution: [u32; 3],
    stored: u64,
    certified: u64,
    /// Groups of voxels in which it may be singular.
    places: u64,
    meshes: Vec<Counted>,
    seconds: f64,
}

/// The mesh of one surface.
#[derive(Debug, Serialize)]
struct Counted {
    name: String,
    vertices: u64,
    edges: u64,
    triangles: u64,
    euler: i64,
    components: u64,
    area: f64,
    /// If it is closed and does not pass through itself.
    volume: Option<f64>,
}

/// Draws all `entries` and writes a page of them to the folder `folder`.
///
/// # Errors
/// As [`pipeline::run`].
pub fn write_page(
    entries: &[&Entry],
    folder: &Path,
    options: &Options,
    progress: &dyn Progress,
) -> Result<Page> {
    let mut exhibits = Vec::new();
    for entry in entries {
        exhibits.push(exhibit(entry, folder, options, progress)?);
    }
    for (name, text) in VIEWER {
        write_text(&folder.join("viewer").join(name), text)?;
    }
    let path = folder.join("index.html");
    let json = serde_json::to_string(&exhibits)
        .map_err(|error| Error::Encode { path: path.clone(), reason: error.to_string() })?;
    // A script ends where its text says so.
    let page = TEMPLATE.replacen(PLACE, &json.replace('<', "\\u003c"), 1);
    write_text(&path, &page)?;
    let n_models = exhibits.iter().filter(|exhibit| exhibit.has_model).count();
    Ok(Page { n_surfaces: exhibits.len(), n_models })
}

fn write_text(path: &Path, text: &str) -> Result<()> {
    output::write_file(path, |out| Ok(std::io::Write::write_all(out, text.as_bytes())?))
}

/// Draws a surface and writes its picture and its model.
fn exhibit(
    entry: &Entry,
    folder: &Path,
    options: &Options,
    progress: &dyn Progress,
) -> Result<Exhibit> {
    let mut scene = entry.scene(&[])?;
    scene.image.width = PICTURE;
    scene.image.height = PICTURE;
    scene.image.background = None;
    scene.image.samples = SAMPLES;
    let name = entry.name();
    let model = Path::new("models").join(name).with_extension("js");
    // Meshes are made where files of them are wanted.
    scene.outputs.meshes = vec![(MeshFormat::Glb, model.clone())];
    let options = Options {
        find_all: true,
        resolution: options.resolution.or(Some(RESOLUTION)),
        ..options.clone()
    };
    let picture = pipeline::render(&scene, &options, progress)?;
    let description = png::PngOptions { description: name.to_owned() };
    let path = folder.join("pictures").join(name).with_extension("png");
    output::write_file(&path, |out| png::write(&picture.frame, &description, out))?;
    let numbers = Numbers::of(&picture.statistics);
    let has_model = !picture.meshes.is_empty();
    if has_model {
        let simd = options.simd.unwrap_or_else(SimdLevel::detect);
        write_model(&folder.join(model), &scene, picture, simd)?;
    }
    let (equations, names) = formulas(entry.text);
    Ok(Exhibit {
        name: name.to_owned(),
        about: scene.about,
        equations,
        names,
        scene: entry.text,
        direction: match scene.view.placement {
            Placement::Fit { direction, .. } => Some(direction.to_array()),
            Placement::LookAt { eye, target } => Some((eye - target).to_array()),
        },
        numbers,
        has_model,
    })
}

impl Numbers {
    fn of(statistics: &Statistics) -> Self {
        let times = &statistics.time_s;
        let counted = |mesh: &crate::statistics::Mesh| {
            let is_closed = mesh.open_edges + mesh.faults + mesh.self_intersections == 0;
            Counted {
                name: mesh.name.clone(),
                vertices: mesh.vertices,
                edges: mesh.edges,
                triangles: mesh.triangles,
                euler: mesh.euler,
                components: mesh.components,
                area: mesh.area,
                volume: is_closed.then_some(mesh.volume),
            }
        };
        Self {
            resolution: statistics.resolution,
            stored: statistics.voxels.stored,
            certified: statistics.voxels.certified,
            places: statistics.singular.iter().map(|found| found.places).sum(),
            meshes: statistics.meshes.iter().map(counted).collect(),
            seconds: times.voxelize + times.rasterize + times.mesh,
        }
    }
}

/// Writes a script that hands over the meshes with few triangles.
fn write_model(path: &Path, scene: &Scene, picture: Picture, simd: SimdLevel) -> Result<()> {
    let n_all: usize = picture.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
    let thin = |mut mesh: Mesh| {
        let n_wanted = (N_TRIANGLES * mesh.triangles.len()).div_ceil(n_all);
        let surface = scene.surfaces.iter().find(|surface| surface.name == mesh.name);
        let tape = surface.map(|surface| surface.expr.tape());
        meshing::thin_out(&mut mesh, n_wanted, tape.as_ref(), simd);
        mesh
    };
    let meshes: Vec<Mesh> = picture.meshes.into_iter().map(thin).collect();
    let options = MeshOptions { scene: scene.name.clone(), ..MeshOptions::default() };
    output::write_file(path, |out| {
        let mut glb = Vec::new();
        write_glb(&meshes, &options, &mut glb)?;
        write_script(&scene.name, &glb, out)
    })
}

fn write_script(
    name: &str,
    glb: &[u8],
    mut out: impl std::io::Write,
) -> std::result::Result<(), WriteError> {
    Ok(writeln!(out, "handOver(\"{name}\", \"{}\");", STANDARD.encode(glb))?)
}

/// The formulas of a scene's surfaces, and the names that they may use.
fn formulas(text: &str) -> (Vec<String>, Vec<(String, String)>) {
    let table: Table = text.parse().unwrap_or_default();
    let tidy = |value: &Value| match value {
        Value::String(text) => text.split_whitespace().collect::<Vec<_>>().join(" "),
        other => other.to_string(),
    };
    let surfaces = table.get("surface").and_then(Value::as_array).into_iter().flatten();
    let equations = surfaces.map(|surface| match surface.get("f") {
        Some(f) => tidy(f),
        None => "sum of (1 - (a*d/radius)^2)^4 = threshold".to_owned(),
    });
    let names = ["params", "let"].into_iter().filter_map(|section| table.get(section)?.as_table());
    let names = names.flatten().map(|(name, value)| (name.clone(), tidy(value)));
    (equations.collect(), names.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_those_of_the_scene() {
        let text = "version = 1\n[params]\na = 2\n[let]\ns = \"x^2 +\\n  y^2\"\n\
            [[surface]]\nf = \"\"\"\ns =\n a\"\"\"\n";
        let (equations, names) = formulas(text);
        assert_eq!(equations, ["s = a"]);
        assert_eq!(names, [("a".into(), "2".into()), ("s".into(), "x^2 + y^2".into())]);
    }

    #[test]
    fn the_template_has_one_place() {
        assert_eq!(TEMPLATE.matches(PLACE).count(), 1);
    }
}
