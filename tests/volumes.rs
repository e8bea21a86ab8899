//! Volumes of the thesis, and those that others scanned: shared data, in the folder that `ZEROSET_DATA`
//! names.

#![expect(clippy::unwrap_used, reason = "a failure is a failure")]

use std::{env, fs, io::Read as _, path::Path};

use glam::{DAffine3, DVec3};
use lzma_rust2::XzReader;
use proptest::prelude::*;
use zeroset::{
    expr::{self, Expr},
    hrb::{Criterion, HrbOctree, Tolerance},
    isosurface::isosurface,
    math::Aabb,
    mesh::{Border, Health},
    progress::Unwatched,
    volume::{
        Keep, Kept, Quantize, RawFormat, SampleType, Samples, Volume,
        thesis::{Alpha, MODELS, Model},
    },
};

/// One of the volumes, unpacked; none, and said so, where there are none.
#[expect(clippy::print_stdout, reason = "the test harness keeps what is said")]
fn volume(test: &str, name: &str) -> Option<Volume> {
    let Some(data) = env::var_os("ZEROSET_DATA") else {
        println!("SKIPPED {test}: ZEROSET_DATA is not set");
        return None;
    };
    let packed = Path::new(&data).join("volumes").join(format!("{name}.raw.xz"));
    let mut bytes = Vec::new();
    let mut unpacked = XzReader::new(fs::File::open(packed).unwrap(), false);
    unpacked.read_to_end(&mut bytes).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("volume.raw");
    fs::write(&path, bytes).unwrap();
    Some(Volume::read(&path, Some(&RawFormat::from_name(name).unwrap())).unwrap())
}

/// The range of each volume, and the sample in the middle of y and z at a third of x.
#[test]
fn scans_are_read() {
    for (name, sample_type, range, sample) in [
        ("aneurism_256x256x256_uint8", SampleType::U8, [0.0, 255.0], 0.0),
        ("bonsai_256x256x256_uint8", SampleType::U8, [0.0, 255.0], 0.0),
        ("fuel_64x64x64_uint8", SampleType::U8, [0.0, 255.0], 192.0),
        ("headsq_64x64x93_int16", SampleType::I16, [0.0, 3926.0], 1116.0),
        ("lobster_301x324x56_uint8", SampleType::U8, [0.0, 255.0], 131.0),
        ("seg3d_tooth_103x94x161_uint16", SampleType::U16, [0.0, 1300.0], 765.0),
        ("stent_128x128x256_int16", SampleType::I16, [0.0, 2000.0], 0.0),
    ] {
        let Some(volume) = volume("scans_are_read", name) else { return };
        let [x, y, z] = volume.size;
        assert_eq!(volume.samples.sample_type(), sample_type, "{name}");
        assert_eq!(volume.range(), range, "{name}");
        assert_eq!(volume.value([x / 3, y / 2, z / 2]), sample, "{name}");
    }
}

/// The components of an artery and of specks of noise around it, as counted by another program.
#[test]
fn specks_of_scans_go() {
    let name = "aneurism_256x256x256_uint8";
    let Some(volume) = volume("specks_of_scans_go", name) else { return };
    let kept = |keep| volume.clone().keep(60.0, keep).unwrap();
    let Kept { n_components, n_kept, largest, n_dropped } = kept(Keep::Largest);
    assert_eq!([n_components, n_kept, largest, n_dropped], [738, 1, 80_580, 5634]);
    let Kept { n_components, n_kept, largest, n_dropped } = kept(Keep::AtLeast(20));
    assert_eq!([n_components, n_kept, largest, n_dropped], [738, 39, 80_580, 1592]);
}

/// A model of the thesis with `n` samples along each axis, as bytes.
fn model(model: Model, alpha: Alpha, n: u32) -> Volume {
    let text = model.text(alpha);
    let formula = Expr::resolve(&expr::parse(&text).unwrap(), &[]).unwrap().expr;
    let cube = Aabb { min: DVec3::NEG_ONE, max: DVec3::ONE };
    Volume::sampled(&formula, cube, [n; 3], Quantize::Floor, &Unwatched).unwrap()
}

/// Octrees of the thesis's models and meshes of their surfaces at 60, closed at the border.
fn check_models(sizes: &[u32]) {
    for (of, &n) in MODELS.into_iter().flat_map(|of| sizes.iter().map(move |n| (of, n))) {
        // Where its radius is undefined, the trunk has a hole.
        let euler = if of.name == "tronco" { 0 } else { 2 };
        for alpha in [Alpha::Solid, Alpha::Linear] {
            let volume = model(of, alpha, n);
            let Samples::U8(samples) = &volume.samples else { panic!("bytes were asked for") };
            for (epsilon, criterion) in [
                (0.0, Criterion::Range),
                (1.0, Criterion::Range),
                (2.0, Criterion::Range),
                (1.0, Criterion::Deviation),
                (2.0, Criterion::Deviation),
            ] {
                let what = format!("{} {n} {alpha:?} {epsilon} {criterion:?}", of.name);
                let tolerance = Tolerance { epsilon, criterion };
                let storage = HrbOctree::build(samples, volume.size, tolerance).storage();
                assert_eq!(storage.regions, 7 * storage.nodes + 1, "{what}");
                let mut mesh = isosurface(&volume, 60.0, tolerance, Border::Capped);
                let split = mesh.split_touching();
                let health = Health { double_vertices: 0, ..mesh.health() };
                assert_eq!(health, Health::default(), "{what}, {split} split");
                // Samples of the thin border of a finer saddle hang together by edges and corners alone.
                if n <= 64 {
                    assert_eq!(mesh.shape().euler, euler, "{what}, {split} split");
                }
            }
        }
    }
}

#[test]
fn models_of_the_thesis_become_clean_meshes() {
    check_models(&[32, 64, 128]);
}

#[test]
#[ignore = "some minutes, and a gigabyte"]
fn large_models_of_the_thesis_become_clean_meshes() {
    check_models(&[256, 512]);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// Regions of all sizes whose sheets touch each other in any way.
    #[test]
    fn meshes_of_any_samples_are_clean(
        size in [1..20_u32, 1..20_u32, 1..20_u32], seed: u64, epsilon in 0..3_u32, isovalue in 1..8_u32,
    ) {
        let hash = |at: [u32; 3], level: u32| {
            let place = at.iter().fold(0, |key, &i| key << 21 | u64::from(i >> level));
            (place ^ seed).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29).wrapping_mul(0xbf58_476d_1ce4_e5b9)
        };
        let [nx, ny, nz] = size;
        let sample = |i: u32| {
            let at = [i % nx, i / nx % ny, i / (nx * ny)];
            let level = hash(at, 3) >> 20 & 3;
            (hash(at, level as u32) >> 17 & 0xff) as u8 % 9
        };
        let samples = (0..nx * ny * nz).map(sample).collect();
        let volume = Volume { size, samples: Samples::U8(samples), placing: DAffine3::IDENTITY };
        let tolerance = Tolerance { epsilon: epsilon.into(), criterion: Criterion::Range };
        let mut mesh = isosurface(&volume, isovalue.into(), tolerance, Border::Capped);
        let split = mesh.split_touching();
        let health = Health { double_vertices: 0, ..mesh.health() };
        prop_assert_eq!(health, Health::default(), "{} split", split);
    }
}

/// A skull whose samples often equal the isovalue: `matrix.dat` of `Cranium.inv3` in Debian's package
/// `invesalius-examples`, which `ZEROSET_CRANIUM` names.
#[test]
#[expect(clippy::print_stdout, reason = "the test harness keeps what is said")]
fn the_cranium_is_closed() {
    let Some(path) = env::var_os("ZEROSET_CRANIUM") else {
        println!("SKIPPED the_cranium_is_closed: ZEROSET_CRANIUM is not set");
        return;
    };
    let format = RawFormat {
        spacing: [0.957_031, 0.957_031, 1.5],
        ..RawFormat::new([256, 256, 108], SampleType::I16)
    };
    let volume = Volume::read(Path::new(&path), Some(&format)).unwrap();
    let Samples::I16(samples) = &volume.samples else { panic!("16 bits were asked for") };
    assert_eq!(samples.iter().filter(|&&sample| sample == 226).count(), 524);
    assert_eq!(samples.iter().filter(|&&sample| sample >= 226).count(), 475_759);
    let mut mesh = isosurface(&volume, 226.0, Tolerance::default(), Border::Capped);
    let split = mesh.split_touching();
    let (health, shape) = (mesh.health(), mesh.shape());
    println!("{shape:?} {health:?}, {split} split");
    assert_eq!(Health { double_vertices: 0, ..health }, Health::default());
    assert!((shape.volume / 661_414.0 - 1.0).abs() < 5e-3, "{}", shape.volume);
}
