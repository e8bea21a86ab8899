//! Volumes that others scanned: shared data, in the folder that `ZEROSET_DATA` names.

#![expect(clippy::unwrap_used, reason = "a failure is a failure")]

use std::{env, fs, io::Read as _, path::Path};

use lzma_rust2::XzReader;
use zeroset::volume::{Keep, Kept, RawFormat, SampleType, Volume};

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
