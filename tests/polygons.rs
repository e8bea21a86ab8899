//! Polygon models: in the picture with surfaces, from real files and from broken ones.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]

use std::{env, fs, path::Path};

use base64::{Engine as _, engine::general_purpose::STANDARD};
use glam::{DVec2, DVec3};
use zeroset::{
    pipeline::{self, Options, Picture},
    polygons::Polygons,
    progress::Unwatched,
    raster::{Frame, Shade},
    scene,
};

/// A picture of the scene `text`, whose folder also holds `files`.
fn picture(text: &str, files: &[(&str, &[u8])], shade: Shade) -> Picture {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    let path = folder.path().join("scene.toml");
    fs::write(&path, text).unwrap();
    let mut scene = scene::load(&path).unwrap();
    (scene.image.width, scene.image.height) = (200, 200);
    (scene.image.samples, scene.image.shade) = (1, shade);
    let options = Options { resolution: Some(128), ..Options::default() };
    pipeline::render(&scene, &options, &Unwatched).unwrap()
}

/// A square in the plane x + 2y + 3z = 0.3, larger than the picture.
const SQUARE: &str = "v 30 -15 0.1\nv 0 3 -1.9\nv -30 15 0.1\nv 0 -3 2.1\nf 1 2 3 4\n";

const CUT_SPHERE: &str = "version = 1\n[[surface]]\nf = 'x^2 + y^2 + z^2 = 1'\n\
    [[model]]\nfile = 'square.obj'\nup = 'z'\n\
    [camera]\neye = [3, -4, 2.5]\ntarget = [0, 0, 0]\nfov = 30\n";

/// Everywhere the nearer one of a sphere and a polygon is seen.
fn largest_error(shade: Shade) -> f64 {
    let Picture { frame, camera, .. } =
        picture(CUT_SPHERE, &[("square.obj", SQUARE.as_bytes())], shade);
    let mut largest = 0.0_f64;
    for (pixel, &depth) in frame.depth.iter().enumerate() {
        let at = DVec2::new((pixel % 200) as f64, (pixel / 200) as f64) + 0.5;
        let at = at / 100.0 - 1.0;
        let (o, d) = camera.ray(DVec2::new(at.x, -at.y));
        let n = DVec3::new(1.0, 2.0, 3.0);
        let plane = (0.3 - n.dot(o)) / n.dot(d);
        let square = o + plane * d;
        // Only where the square is known to reach.
        if square.length() > 1.8 {
            continue;
        }
        let (a, b, c) = (d.dot(d), d.dot(o), o.dot(o) - 1.0);
        let under = b * b - a * c;
        // A thousandth of a pixel at the sphere's rim is left out.
        if under.abs() < 1e-3 {
            continue;
        }
        let sphere = if under > 0.0 { (-b - under.sqrt()) / a } else { f64::INFINITY };
        assert!(depth != Frame::FAR, "a hole at {pixel}");
        largest = largest.max((plane.min(sphere) - f64::from(depth)).abs());
    }
    largest
}

#[test]
fn polygons_and_surfaces_hide_each_other() {
    let voxel = 2.0 / 128.0;
    let [refined, voxels] = [Shade::Refine, Shade::Voxel].map(largest_error);
    assert!(refined < 1e-5, "{refined}");
    assert!(voxels < 3.0 * voxel, "{voxels}");
}

/// The files of real programs, as their authors describe them.
#[test]
#[expect(clippy::print_stdout, reason = "the test harness keeps what is said")]
fn real_models_are_read() {
    let Some(data) = env::var_os("ZEROSET_DATA") else {
        println!("SKIPPED real models: ZEROSET_DATA is not set");
        return;
    };
    let expected = [
        ("spot.obj", 5856, 5856),
        ("teapot.obj", 6320, 6320),
        ("Box.glb", 12, 12),
        ("Duck.glb", 4212, 4212),
    ];
    for (name, least, most) in expected {
        let polygons = Polygons::read(&Path::new(&data).join("meshes").join(name)).unwrap();
        let n = polygons.triangles.len();
        assert!((least..=most).contains(&n), "{name} has {n} triangles");
        let agrees = |(corners, normals): (&[u32; 3], &[DVec3; 3])| {
            let [a, b, c] = corners.map(|i| polygons.positions[i as usize]);
            assert!(normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-9));
            normals.iter().sum::<DVec3>().dot((b - a).cross(c - a)) >= 0.0
        };
        let n_agree =
            polygons.triangles.iter().zip(&polygons.normals).filter(|&pair| agrees(pair)).count();
        // Some slivers of smooth models are turned away from their normals.
        assert!(n_agree >= n * 98 / 100, "{name}: {n_agree} of {n}");
    }
}

/// A glTF file with one triangle, whose accessor of positions counts `count` vertices, in a node
/// that is moved by 5 along x.
fn gltf(count: u32, uri: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
        "nodes": [{{"translation": [5, 0, 0], "mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "material": 0}}]}}],
        "materials": [{{"pbrMetallicRoughness": {{"baseColorFactor": [0.5, 0.25, 1, 1]}}}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": {count},
            "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
        "buffers": [{{"byteLength": 36, "uri": "{uri}"}}]}}"#
    )
}

fn corners() -> Vec<u8> {
    [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn data_uri(bytes: &[u8]) -> String {
    format!("data:application/octet-stream;base64,{}", STANDARD.encode(bytes))
}

#[test]
fn nodes_place_their_meshes_and_materials_colour_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    fs::write(&path, gltf(3, "a.bin")).unwrap();
    fs::write(folder.path().join("a.bin"), corners()).unwrap();
    let beside = Polygons::read(&path).unwrap();
    assert_eq!(beside.positions, [DVec3::X * 5.0, DVec3::X * 6.0, DVec3::new(5.0, 1.0, 0.0)]);
    assert_eq!(beside.colors, [[0.5, 0.25, 1.0]; 3]);
    assert_eq!(beside.normals, [[DVec3::Z; 3]]);
    fs::write(&path, gltf(3, &data_uri(&corners()))).unwrap();
    assert_eq!(Polygons::read(&path).unwrap(), beside);
}

#[test]
fn broken_models_are_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let said = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        Polygons::read(&path).unwrap_err()
    };
    let nan = [f32::NAN.to_le_bytes().to_vec(), corners()[4..].to_vec()].concat();
    let cases: [(&str, Vec<u8>, &str); 12] = [
        ("a.stl", Vec::new(), "the name must end in .obj, .gltf or .glb"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_vec(), "it has no faces"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n".to_vec(), "it is not a valid OBJ file"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n".to_vec(), "vertex 3 is at (NaN, 1, 0)"),
        ("a.obj", b"v 0 zero 0\nf 1 1 1\n".to_vec(), "it is not a valid OBJ file"),
        ("a.obj", vec![0xff; 100], "it "),
        ("a.gltf", b"{\"asset\": ".to_vec(), "it is not a valid glTF file"),
        ("a.glb", b"glTF\x02\0\0\0\x10\0\0\0".to_vec(), "it is not a valid glTF file"),
        ("a.gltf", gltf(3, "../a.bin").into(), "buffer 0 does not lie beside it: ../a.bin"),
        ("a.gltf", gltf(3, &data_uri(&[0; 35])).into(), "buffer 0 holds 35 bytes instead of 36"),
        ("a.gltf", gltf(9, &data_uri(&corners())).into(), "accessor 0 is longer"),
        ("a.gltf", gltf(3, &data_uri(&nan)).into(), "vertex 1 is at (NaN, NaN, NaN)"),
    ];
    for (name, bytes, expected) in cases {
        let refusal = said(name, &bytes);
        assert!(refusal.starts_with(expected), "{refusal}");
    }
    let missing = Polygons::read(&folder.path().join("b.obj")).unwrap_err();
    assert!(missing.starts_with("there is no file"), "{missing}");
}
