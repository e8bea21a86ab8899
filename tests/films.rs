//! Films: frames alone and together, files, cameras that do not tremble, keys.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]

use std::{
    collections::BTreeSet,
    fs,
    path::Path,
    process::{Command, Output},
};

use glam::DVec3;
use image::{AnimationDecoder as _, codecs::png::PngDecoder};
use zeroset::{
    film::Film,
    pipeline::Options,
    progress::Unwatched,
    raster::{Camera, Frame},
    scene,
};

/// An egg that grows away from the origin while the camera goes around it.
const EGG: &str = "version = 1\n[params]\na = 0.5\n[let]\nq = \"2*a\"\n[[surface]]\n\
    f = \"x^2 + 2*y^2 + (z - q)^2 = a^2\"\n[voxels]\nresolution = 48\n\
    [image]\nwidth = 40\nheight = 30\n[animation]\nframes = 5\nturntable = 360\n\
    [animation.params]\na = [0.5, 2, 1]\n";

fn render(scene: &str, arguments: &[&str]) -> (Output, tempfile::TempDir) {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("egg.toml"), scene).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_render"));
    command.current_dir(directory.path()).arg("egg.toml").args(arguments);
    (command.output().unwrap(), directory)
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn names(directory: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(directory.join("out")).unwrap();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

#[test]
fn frames_alone_are_those_of_the_whole() {
    let (output, whole) = render(EGG, &[]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let (output, part) = render(EGG, &["--frames", "2-3", "--threads", "1"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let numbered = |number| ["png", "exr"].map(|ending| format!("egg_000{number}.{ending}"));
    assert_eq!(names(whole.path()), (1..=5).flat_map(numbered).collect());
    assert_eq!(names(part.path()), (2..=3).flat_map(numbered).collect());
    for name in names(part.path()) {
        let read = |folder: &Path| fs::read(folder.join("out").join(&name)).unwrap();
        assert_eq!(read(whole.path()), read(part.path()), "{name}");
    }
}

#[test]
fn the_animated_file_holds_the_numbered_ones() {
    for background in ["", "background = \"transparent\"\n"] {
        let scene = EGG.replace("[animation]\n", &format!("{background}[animation]\n"))
            + "[output]\napng = \"film/egg.apng\"\nexr = false\n";
        let (output, directory) = render(&scene, &[]);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let out = directory.path().join("out");
        let film = fs::File::open(out.join("film/egg.apng")).unwrap();
        let film = PngDecoder::new(std::io::BufReader::new(film)).unwrap().apng().unwrap();
        let film = film.into_frames().collect_frames().unwrap();
        assert_eq!(film.len(), 5);
        for (i, frame) in film.iter().enumerate() {
            let alone = image::open(out.join(format!("egg_000{}.png", i + 1))).unwrap();
            assert_eq!(*frame.buffer(), alone.to_rgba8(), "frame {}", i + 1);
        }
        assert!((1..5).any(|i| film[i].buffer() != film[0].buffer()));
    }
}

#[test]
fn a_film_is_summed_up_in_a_line_and_counted_in_statistics() {
    let scene = format!("{EGG}[output]\nexr = false\napng = true\n");
    let (output, _) = render(&scene, &["--stats", "-", "--frames", "2-4"]);
    let said = stderr(&output);
    let expected =
        "egg.toml: wrote 3 frames: out/egg_0002.png to out/egg_0004.png, out/egg.apng in ";
    assert!(said.lines().last().unwrap().starts_with(expected), "{said}");
    assert_eq!(said.lines().count(), 2, "a note on the domain, and the sum: {said}");
    let lines = String::from_utf8(output.stdout).unwrap();
    let number =
        |line| serde_json::from_str::<serde_json::Value>(line).unwrap()["frame"]["number"].clone();
    assert_eq!(lines.lines().map(number).collect::<Vec<_>>(), [2, 3, 4]);
}

#[test]
fn frames_that_do_not_exist_are_refused() {
    let still = EGG.split("[animation]").next().unwrap();
    for (scene, frames, complaint) in [
        (EGG, "5-6", "there is no frame 6: the film has 5"),
        (EGG, "0", "a range such as 10-19"),
        (EGG, "3-2", "a range such as 10-19"),
        (EGG, "x", "a range such as 10-19"),
        (still, "1", "the scene has neither [animation] nor [sweep]"),
    ] {
        let (output, directory) = render(scene, &["--frames", frames]);
        assert_eq!(output.status.code(), Some(2), "{frames}");
        assert!(stderr(&output).contains(complaint), "{frames}: {output:?}");
        assert!(!directory.path().join("out").exists());
    }
}

#[test]
fn films_do_not_overwrite_each_other() {
    let (output, _) = render(EGG, &["egg.toml", "--frames", "4"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("would overwrite out/egg_0004.png of egg.toml"), "{output:?}");
}

/// All frames of the film `text`, with their cameras.
fn frames(text: &str) -> Vec<(Frame, Camera)> {
    let scene = scene::parse(Path::new("film.toml"), text).unwrap();
    let options = Options::default();
    let film = Film::new(&scene, &options, &Unwatched).unwrap();
    let picture = |number| film.picture(number, &Unwatched).unwrap();
    (1..=scene.n_frames()).map(picture).map(|picture| (picture.frame, picture.camera)).collect()
}

#[test]
fn a_fitted_film_cuts_nothing_off_and_does_not_tremble() {
    for projection in ["perspective", "orthographic"] {
        let text = format!("{EGG}[camera]\nprojection = \"{projection}\"\nmargin = 0.02\n");
        for (text, is_turned) in
            [(text.clone(), true), (text.replace("turntable = 360\n", ""), false)]
        {
            let frames = frames(&text);
            // The directions of all views meet in one point, as far from each.
            let eyes: Vec<DVec3> = frames.iter().map(|(_, camera)| camera.eye()).collect();
            let (mean, height) = (eyes.iter().sum::<DVec3>() / 5.0, eyes[0].z);
            let away = |eye: &DVec3| (*eye - mean).length();
            assert!(eyes.iter().all(|eye| (eye.z - height).abs() < 1e-9));
            assert!(eyes.iter().all(|eye| (away(eye) - away(&eyes[0])).abs() < 1e-9));
            assert_eq!(away(&eyes[0]) > 0.1, is_turned);
            for (frame, _) in &frames {
                let covers = |pixel: usize| frame.depth[pixel] != Frame::FAR;
                let is_border = |pixel: &usize| {
                    let (x, y) = (pixel % 40, pixel / 40);
                    x == 0 || x == 39 || y == 0 || y == 29
                };
                assert!((0..40 * 30).any(covers) && !(0..40 * 30).filter(is_border).any(covers));
            }
        }
    }
}

/// A zoom by 10^5 onto the pole of a sphere: every frame shows the sphere, and the last one a flat
/// piece of it.
#[test]
fn keys_zoom_evenly() {
    let frames = frames(
        "version = 1\n[[surface]]\nf = \"x^2 + y^2 + z^2 = 1\"\n[domain]\nmin = [-2, -2, -2]\n\
         max = [2, 2, 2]\n[voxels]\nresolution = \"auto\"\n[image]\nwidth = 24\nheight = 24\n\
         [camera]\nup = [0, 1, 0]\n[animation]\nframes = 11\n\
         [[animation.key]]\nat = 0\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n\
         [[animation.key]]\nat = 1\neye = [0.6, 0, 0.80005]\ntarget = [0.6, 0, 0.8]\nfov = 20\n",
    );
    let distance = |camera: &Camera| (camera.eye() - DVec3::new(0.6, 0.0, 0.8)).length();
    let mut before = f64::INFINITY;
    for (frame, camera) in &frames {
        assert!(distance(camera) < before, "the camera comes nearer");
        before = distance(camera);
        assert!(frame.depth[12 * 24 + 12] != Frame::FAR);
    }
    let normals = &frames[10].0.normal;
    assert!(normals.iter().all(|normal| (normal[0] - 0.6).abs() < 1e-3));
}

#[test]
fn a_frame_may_be_empty_and_a_film_may_not() {
    let vanishing =
        EGG.replace("a = [0.5, 2, 1]", "a = [1, 0.5, 0.25]").replace("= a^2", "= a - 0.6");
    let covered: Vec<bool> = frames(&vanishing)
        .iter()
        .map(|(frame, _)| frame.depth.iter().any(|&depth| depth != Frame::FAR))
        .collect();
    assert_eq!(covered, [true, true, false, false, false]);
    let (output, directory) = render(&EGG.replace("= a^2", "= -a"), &[]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(stderr(&output).contains("it has no points"), "{output:?}");
    assert!(!directory.path().join("out").exists());
}

/// Interrupted in one of 9999 frames.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_whole_frames() {
    let scene = EGG
        .replace("frames = 5", "frames = 9999")
        .replace("\n[animation.params]\na = [0.5, 2, 1]", "")
        + "[output]\napng = true\nexr = false\n";
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("egg.toml"), scene).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_render"))
        .current_dir(directory.path())
        .args(["egg.toml", "--quiet"])
        .spawn()
        .unwrap();
    let first = directory.path().join("out/egg_0001.png");
    while !first.exists() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{output:?}");
    for name in names(directory.path()) {
        image::open(directory.path().join("out").join(&name)).unwrap();
        assert!(name.starts_with("egg_"), "{name}");
    }
}
