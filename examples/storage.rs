//! What octrees of homogeneous regions take beside the samples they are made of, as tables for
//! BENCHMARKS.md: `cargo run --release --example storage`. The models of A. León Salas (thesis, 2008), and,
//! where `ZEROSET_DATA` names their folder, scans.

#![expect(clippy::unwrap_used, reason = "an example that cannot run has failed")]
#![expect(clippy::print_stdout, reason = "its tables are what it is for")]

use std::{env, fs, io::Read as _, path::Path};

use glam::DVec3;
use lzma_rust2::XzReader;
use zeroset::{
    expr::{Expr, parse},
    hrb::{HrbOctree, Storage, Tolerance},
    math::Aabb,
    progress::Unwatched,
    volume::{
        Quantize, RawFormat, Samples, Volume,
        thesis::{Alpha, MODELS, Model},
    },
};

/// Samples along each axis of the models.
const SIZES: [u32; 5] = [32, 64, 128, 256, 512];
/// Tolerances, in steps: a grey value of the models, a 255th of the range of a scan.
const STEPS: [f64; 3] = [0.0, 1.0, 2.0];

const SCANS: [&str; 7] = [
    "aneurism_256x256x256_uint8",
    "bonsai_256x256x256_uint8",
    "fuel_64x64x64_uint8",
    "headsq_64x64x93_int16",
    "lobster_301x324x56_uint8",
    "seg3d_tooth_103x94x161_uint16",
    "stent_128x128x256_int16",
];

fn main() {
    header("model");
    for (model, alpha) in MODELS.iter().flat_map(|m| [(m, Alpha::Solid), (m, Alpha::Linear)]) {
        for n in SIZES {
            let name = if alpha == Alpha::Solid { "α1" } else { "α2" };
            row(&format!("{} {name}, {n}³", model.name), &sampled(*model, alpha, n), 1.0);
        }
    }
    let Some(data) = env::var_os("ZEROSET_DATA") else {
        return println!("\nSKIPPED scans: ZEROSET_DATA is not set");
    };
    println!();
    header("scan");
    for name in SCANS {
        let volume = scan(&Path::new(&data).join("volumes"), name);
        let [least, most] = volume.range();
        let step = (most - least) / 255.0;
        let [x, y, z] = volume.size;
        let short = name.split('_').take_while(|part| !part.contains('x')).collect::<Vec<&str>>();
        let label = format!("{}, {x} x {y} x {z}, step {step:.3}", short.join(" "));
        row(&label, &volume, step);
    }
}

fn header(what: &str) {
    print!("| {what} |");
    STEPS.iter().for_each(|step| print!(" ε = {step}: nodes | thesis | memory |"));
    println!("\n|---|{}", "---|---|---|".repeat(STEPS.len()));
}

/// A row of the table: for each tolerance nodes, and bytes as a part of those of the grid.
fn row(name: &str, volume: &Volume, step: f64) {
    print!("| {name} |");
    for steps in STEPS {
        let (storage, bytes) = storage(volume, steps * step);
        let Storage { nodes, thesis_bytes, grid_bytes, resident_bytes, .. } = storage;
        let part = |bytes: u64, of: u64| 100.0 * bytes as f64 / of as f64;
        let (thesis, resident) = (part(thesis_bytes, grid_bytes), part(resident_bytes, bytes));
        print!(" {nodes} | {thesis:.1} % | {resident:.1} % |");
    }
    println!();
}

/// What the octree takes, and the bytes of the samples.
fn storage(volume: &Volume, epsilon: f64) -> (Storage, u64) {
    let tolerance = Tolerance { epsilon, ..Tolerance::default() };
    let size = volume.size;
    match &volume.samples {
        Samples::U8(samples) => {
            (HrbOctree::build(samples, size, tolerance).storage(), samples.len() as u64)
        }
        Samples::U16(samples) => {
            (HrbOctree::build(samples, size, tolerance).storage(), 2 * samples.len() as u64)
        }
        Samples::I16(samples) => {
            (HrbOctree::build(samples, size, tolerance).storage(), 2 * samples.len() as u64)
        }
        other => panic!("no scan here has samples of {}", other.sample_type()),
    }
}

fn sampled(model: Model, alpha: Alpha, n: u32) -> Volume {
    let ast = parse(&model.text(alpha)).unwrap();
    let formula = Expr::resolve(&ast, &[]).unwrap().expr;
    let cube = Aabb { min: DVec3::NEG_ONE, max: DVec3::ONE };
    Volume::sampled(&formula, cube, [n; 3], Quantize::Floor, &Unwatched).unwrap()
}

fn scan(folder: &Path, name: &str) -> Volume {
    let packed = fs::File::open(folder.join(format!("{name}.raw.xz"))).unwrap();
    let mut bytes = Vec::new();
    XzReader::new(packed, false).read_to_end(&mut bytes).unwrap();
    let unpacked = tempfile::NamedTempFile::new().unwrap();
    fs::write(unpacked.path(), bytes).unwrap();
    Volume::read(unpacked.path(), Some(&RawFormat::from_name(name).unwrap())).unwrap()
}
