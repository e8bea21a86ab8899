//! Small meshes in every format, for other programs to open: `cargo run --release --example meshes --
//! FOLDER`. `expected.json` beside them says what is to be found in them; `tests/consumers.sh` looks.

#![expect(clippy::unwrap_used, reason = "an example that cannot run has failed")]

use std::{env, path::Path};

use serde_json::{Value, json};
use zeroset::{
    math::{Aabb, Lattice, SimdLevel},
    mesh::{Border, FormulaSettings, Mesh, VertexPlace, of_open_voxels},
    output::{
        meshes::{MeshFormat, MeshOptions, write_meshes},
        write_file,
    },
    progress::Unwatched,
    scene,
    voxelize::{self, open_voxels},
};

/// Half the edge of the domain, and voxels along it.
const REACH: f64 = 1.5;
const RESOLUTION: u32 = 64;

/// Scenes by name. The first has a middle and a size of its own along each axis, so that no turn of it
/// looks like another.
const SCENES: [(&str, &str); 3] = [
    (
        "egg",
        "version = 1\n[[surface]]\nname = \"egg\"\ncolor = \"#ff8000\"\n\
         f = \"((x - 0.1)/0.3)^2 + ((y - 0.2)/0.5)^2 + ((z - 0.3)/0.9)^2 = 1\"\n",
    ),
    (
        "pair",
        "version = 1\n[[surface]]\nname = \"a ring\"\ncolor = \"#3060c0\"\n\
         f = \"(sqrt(x^2 + y^2) - 1)^2 + z^2 = 0.3^2\"\n\
         [[surface]]\nname = \"<Kugel> & süß\"\ncolor = \"#c0c000\"\n\
         f = \"x^2 + y^2 + (z - 0.2)^2 = 0.4^2\"\n",
    ),
    (
        "saddle",
        "version = 1\n[[surface]]\nname = \"saddle\"\ncolor = \"#20a060\"\nf = \"z = x*y/2 + x/5\"\n",
    ),
];

fn main() {
    let folder = env::args().nth(1).unwrap_or_else(|| "out/meshes".into());
    let folder = Path::new(&folder);
    let expected: Vec<Value> =
        SCENES.iter().map(|(name, text)| write_scene(folder, name, text)).collect();
    let text = serde_json::to_string_pretty(&expected).unwrap();
    let path = folder.join("expected.json");
    write_file(&path, |out| Ok(std::io::Write::write_all(out, text.as_bytes())?)).unwrap();
}

/// Writes a scene in every format, and gives what is in it.
fn write_scene(folder: &Path, name: &str, text: &str) -> Value {
    let scene = scene::parse(Path::new(name), text).unwrap();
    let domain = Aabb { min: [-REACH; 3].into(), max: [REACH; 3].into() };
    let lattice = Lattice::new(domain, RESOLUTION);
    let settings = FormulaSettings {
        border: Border::Open,
        vertex: VertexPlace::Polished,
        simd: SimdLevel::detect(),
    };
    let mesh = |surface: &scene::Surface| {
        let find = voxelize::Settings::default();
        let open = open_voxels(&surface.expr, &lattice, &find, &Unwatched).unwrap();
        let mesh = of_open_voxels(&surface.expr.tape(), &open, &lattice, &settings);
        Mesh { name: surface.name.clone(), color: surface.material.color, ..mesh }
    };
    let meshes: Vec<Mesh> = scene.surfaces.iter().map(mesh).collect();
    assert!(meshes.iter().all(|mesh| mesh.health().is_clean()));
    let options = MeshOptions { scene: name.into(), ..MeshOptions::default() };
    for format in MeshFormat::ALL {
        let path = folder.join(name).with_extension(format.ending());
        write_meshes(&path, format, &meshes, &options).unwrap();
    }
    let surfaces: Vec<Value> = meshes.iter().map(facts).collect();
    json!({ "scene": name, "surfaces": surfaces })
}

/// What others should find in a mesh, z-up.
fn facts(mesh: &Mesh) -> Value {
    let shape = mesh.shape();
    let bound = |f: fn(f32, f32) -> f32| {
        [0, 1, 2].map(|axis: usize| mesh.positions.iter().map(|p| p[axis]).reduce(f).unwrap())
    };
    json!({
        "name": mesh.name,
        "color": mesh.color,
        "closed": !mesh.is_open(),
        "vertices": shape.vertices,
        "triangles": shape.triangles,
        "euler": shape.euler,
        "volume": shape.volume,
        "min": bound(f32::min),
        "max": bound(f32::max),
    })
}
