//! Reference pictures: every scene in `configs/` at a small size, and the paper's at full resolution.
//! Of a film one frame is compared, of a sweep also the contact sheet, as it is in the file.
//!
//! The pixels of `golden/image/NAME.png` and the lines of `golden/image/NAME.digest` (octrees,
//! and size, range and hash of every layer) must be met exactly. A failure leaves one picture with
//! expected, difference and actual side by side. `ZEROSET_BLESS=NAME` (or `all`) rewrites the
//! references; the test fails nonetheless, so that a blessing never looks like a pass.

#![expect(clippy::expect_used, reason = "a test that cannot find its cases has failed")]

use std::{
    env,
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
};

use image::{Rgba, RgbaImage};
use libtest_mimic::{Arguments, Failed, Trial};
use zeroset::{
    film::{self, Film},
    output::png,
    pipeline::{self, Options, Picture},
    progress::Unwatched,
    scene::{self, Scene},
};

/// Voxels along the longest axis and pixels along the longer side.
#[derive(Clone, Copy)]
struct Size {
    resolution: u32,
    pixels: u32,
}

const SMALL: Size = Size { resolution: 96, pixels: 240 };

/// The paper's scenes are also compared at the paper's resolution; README shows these pictures.
const LARGE: Size = Size { resolution: 512, pixels: 512 };
const LARGE_SCENES: [&str; 3] = ["scene1", "scene2", "scene3"];

fn main() {
    let arguments = Arguments::from_args();
    let mut trials: Vec<Trial> = scenes()
        .into_iter()
        .map(|name| Trial::test(name.clone(), move || check(&name, &name, SMALL)))
        .collect();
    let sweeps = scenes().into_iter().filter(|scene| {
        fs::read_to_string(path(scene)).is_ok_and(|text| text.contains("\n[sweep]"))
    });
    trials.extend(sweeps.map(|scene| {
        let name = format!("{scene}.sheet");
        Trial::test(name.clone(), move || check_sheet(&name, &scene))
    }));
    trials.extend(LARGE_SCENES.map(|scene| {
        let name = format!("{scene}_{}", LARGE.resolution);
        Trial::test(name.clone(), move || check(&name, scene, LARGE))
    }));
    libtest_mimic::run(&arguments, trials).exit();
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn scenes() -> Vec<String> {
    let entries = fs::read_dir(root().join("configs")).expect("the folder of the scenes");
    let paths = entries.map(|entry| entry.expect("a scene").path());
    let is_scene = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "toml");
    let stem = |path: PathBuf| path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let mut names: Vec<String> = paths.filter(is_scene).filter_map(stem).collect();
    names.sort();
    names
}

fn path(scene: &str) -> PathBuf {
    root().join("configs").join(scene).with_extension("toml")
}

fn load(scene: &str) -> Result<Scene, Failed> {
    scene::load(&path(scene)).map_err(|error| format!("{error:?}").into())
}

fn check(name: &str, scene: &str, size: Size) -> Result<(), Failed> {
    let picture = render(scene, size)?;
    compare(name, &png::to_srgb8(&picture.frame), Some(&digest(&picture)))
}

fn check_sheet(name: &str, scene: &str) -> Result<(), Failed> {
    let scene = load(scene)?;
    let folder = tempfile::tempdir()?;
    let options = Options {
        out_dir: folder.path().to_owned(),
        resolution: Some(SMALL.resolution),
        ..Options::default()
    };
    let made = film::run(&scene, &options, &Unwatched, |_| Ok(()));
    let sheet = made.map_err(|error| error.to_string())?.together.ok_or("there is no sheet")?;
    compare(name, &image::open(sheet)?.to_rgba8(), None)
}

/// Holds a picture, and the digest of its layers, against the reference.
fn compare(name: &str, image: &RgbaImage, digest: Option<&str>) -> Result<(), Failed> {
    let folder = root().join("golden/image");
    let png = folder.join(format!("{name}.png"));
    let text = folder.join(format!("{name}.digest"));
    if env::var("ZEROSET_BLESS").is_ok_and(|wanted| wanted == name || wanted == "all") {
        image.save(&png)?;
        digest.map_or(Ok(()), |digest| fs::write(&text, digest))?;
        return Err(format!("blessed: look at {}, then run again", png.display()).into());
    }
    let expected = image::open(&png).map_err(|error| format!("{}: {error}", png.display()))?;
    let expected = expected.to_rgba8();
    if expected != *image {
        let panes = root().join("target/golden").join(format!("{name}.png"));
        fs::create_dir_all(panes.parent().unwrap_or(root()))?;
        side_by_side(&expected, image).save(&panes)?;
        return Err(format!("pixels differ: look at {}", panes.display()).into());
    }
    let Some(digest) = digest else { return Ok(()) };
    let expected = fs::read_to_string(&text)?;
    if expected != digest {
        return Err(format!("layers differ\n--- expected\n{expected}--- actual\n{digest}").into());
    }
    Ok(())
}

fn render(scene: &str, size: Size) -> Result<Picture, Failed> {
    let mut scene = load(scene)?;
    let longer = scene.image.width.max(scene.image.height);
    scene.image.width = scene.image.width * size.pixels / longer;
    scene.image.height = scene.image.height * size.pixels / longer;
    let options = Options {
        out_dir: PathBuf::new(),
        threads: None,
        resolution: Some(size.resolution),
        simd: None,
        max_memory: None,
        find_all: true,
        frames: None,
    };
    let picture = match scene.n_frames() {
        0 => pipeline::render(&scene, &options, &Unwatched),
        // Neither the first nor the last, nor one between that is like them.
        n => Film::new(&scene, &options, &Unwatched)
            .and_then(|film| film.picture(n / 3 + 1, &Unwatched)),
    };
    picture.map_err(|error| error.to_string().into())
}

fn digest(picture: &Picture) -> String {
    let statistics = &picture.statistics;
    let mut text = format!("voxels {}\n", statistics.voxels.stored);
    let _ = writeln!(text, "boxes {:?}", statistics.boxes.tested_per_level);
    for octree in &statistics.octree.digests {
        let _ = writeln!(text, "octree {octree}");
    }
    text + &picture.frame.digest().to_string()
}

/// Expected, difference and actual. The difference is white where the two agree, red where only
/// colour differs, blue where only one of them shows a surface.
fn side_by_side(expected: &RgbaImage, actual: &RgbaImage) -> RgbaImage {
    let (width, height) =
        (expected.width().max(actual.width()), expected.height().max(actual.height()));
    RgbaImage::from_fn(3 * width, height, |x, y| {
        let at = |image: &RgbaImage| image.get_pixel_checked(x % width, y).copied();
        let (was, is) = (at(expected), at(actual));
        let pixel = match x / width {
            0 => was,
            2 => is,
            _ if was == is => Some(Rgba([255; 4])),
            _ => match (was, is) {
                (Some(was), Some(is)) if was[3] == is[3] => {
                    let change = was.0.iter().zip(is.0).map(|(a, b)| a.abs_diff(b)).max();
                    let rest = 200_u8.saturating_sub(change.unwrap_or(0).saturating_mul(4));
                    Some(Rgba([255, rest, rest, 255]))
                }
                _ => Some(Rgba([0, 0, 255, 255])),
            },
        };
        pixel.unwrap_or(Rgba([128, 128, 128, 255]))
    })
}
