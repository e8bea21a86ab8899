//! Scene 1 and Barth's decic by Zeroset and by POV-Ray, side by side: `just beside-povray`, with POV-Ray
//! 3.7 installed.
//!
//! POV-Ray's `isosurface` walks along a ray with steps that a bound of the gradient allows, and the
//! user has to know that bound. The third picture of Scene 1 shows what a bound that is too small does;
//! of the decic both show what comes of the equation alone. All are made with one thread. Of Scene 1
//! coverage and normals are compared with one ray through the middle of every pixel. Writes
//! docs/povray.png and docs/decic.png, and figures to the standard output.

#![expect(clippy::unwrap_used, reason = "an example that cannot run has failed")]
#![expect(clippy::print_stdout, reason = "the figures are for the README")]

use std::{
    fs,
    num::NonZeroUsize,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    time::{Duration, Instant},
};

use glam::{DVec2, DVec3};
use image::{Rgb, RgbImage, imageops};
use tempfile::TempDir;
use zeroset::{
    output::png,
    pipeline::{self, Options, Picture},
    progress::Unwatched,
    raster::{Camera, Frame},
    scene::{self, Scene},
};

const EDGE: u32 = 512;

/// Rays through a pixel of the pictures, along an edge.
const SAMPLES: u32 = 2;

/// Promised bounds of |grad F|: enough, for a search finds 5.84 at most, and too small.
const BOUND: f64 = 5.9;
const TOO_SMALL: f64 = 1.0;

/// Times are medians of so many.
const RUNS: usize = 3;

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut scene = scene::load(&root.join("configs/scene1.toml")).unwrap();
    scene.image.width = EDGE;
    scene.image.height = EDGE;
    scene.image.samples = 1;
    scene.image.curvature = false;
    scene.outputs.exr = None;
    let Picture { frame, camera, .. } = pipeline::render(&scene, &options(), &Unwatched).unwrap();
    let povray = PovRay::new(root.join("examples/povray/scene1.pov"), &camera);
    compare(&frame, &povray.normals(&camera));

    scene.image.samples = SAMPLES;
    let ours = png::to_srgb8(&pipeline::render(&scene, &options(), &Unwatched).unwrap().frame);
    let ours = image::DynamicImage::from(ours).into_rgb8();
    let pictures = [ours, povray.picture(Some(BOUND)), povray.picture(Some(TOO_SMALL))];
    side_by_side(&pictures).save(root.join("docs/povray.png")).unwrap();

    let folder = tempfile::tempdir().unwrap();
    let ours = median(|| zeroset(&scene, folder.path()));
    let [enough, too_small] = [BOUND, TOO_SMALL].map(|bound| median(|| povray.time(bound)));
    println!("Zeroset, 512³ voxels: {ours:.2?}");
    println!("POV-Ray, max_gradient {BOUND}: {enough:.2?}; {TOO_SMALL}: {too_small:.2?}");
    decic(root);
}

/// What both make of an equation if nothing else is said.
fn decic(root: &Path) {
    let mut scene = scene::load(&root.join("configs/barth_decic.toml")).unwrap();
    scene.image.width = EDGE;
    scene.image.height = EDGE;
    scene.image.samples = SAMPLES;
    let Picture { frame, camera, .. } = pipeline::render(&scene, &options(), &Unwatched).unwrap();
    let povray = PovRay::new(root.join("examples/povray/decic.pov"), &camera);
    let ours = image::DynamicImage::from(png::to_srgb8(&frame)).into_rgb8();
    side_by_side(&[ours, povray.picture(None)]).save(root.join("docs/decic.png")).unwrap();
}

fn side_by_side(pictures: &[RgbImage]) -> RgbImage {
    let mut all = RgbImage::from_pixel(pictures.len() as u32 * EDGE, EDGE, Rgb([255; 3]));
    for (x, picture) in (0..).step_by(EDGE as usize).zip(pictures) {
        imageops::replace(&mut all, picture, x, 0);
    }
    all
}

fn options() -> Options {
    Options { threads: NonZeroUsize::new(1), ..Options::default() }
}

/// From the scene to the PNG file.
fn zeroset(scene: &Scene, folder: &Path) -> Duration {
    let start = Instant::now();
    let options = Options { out_dir: folder.to_owned(), ..options() };
    pipeline::run(scene, &options, &Unwatched).unwrap();
    start.elapsed()
}

fn median(work: impl Fn() -> Duration) -> Duration {
    let mut times: Vec<Duration> = (0..RUNS).map(|_| work()).collect();
    times.sort();
    times[RUNS / 2]
}

/// Runs POV-Ray in a folder of its own.
struct PovRay {
    scene: PathBuf,
    folder: TempDir,
}

impl PovRay {
    fn new(scene: PathBuf, camera: &Camera) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let ray = |x: f64, y: f64| camera.ray(DVec2::new(x, y)).1;
        let forward = camera.forward();
        let vectors = [
            ("Eye", camera.eye()),
            ("Right", ray(1.0, 0.0) - forward),
            ("Up", ray(0.0, 1.0) - forward),
            ("Forward", forward),
        ];
        let lines = vectors
            .map(|(name, DVec3 { x, y, z })| format!("#declare {name} = <{x:?}, {y:?}, {z:?}>;\n"));
        fs::write(folder.path().join("camera.inc"), lines.concat()).unwrap();
        Self { scene, folder }
    }

    /// Renders the scene with further options, and returns the file.
    fn run(&self, options: &[String]) -> PathBuf {
        let file = self.folder.path().join("picture.png");
        let size = [format!("+W{EDGE}"), format!("+H{EDGE}")];
        let status = Command::new("povray")
            .current_dir(&self.folder)
            .arg(format!("+I{}", self.scene.display()))
            .arg(format!("+O{}", file.display()))
            .args(["+L.", "+WT1", "-D", "-GA"])
            .args(size)
            .args(options)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status()
            .unwrap_or_else(|error| panic!("POV-Ray cannot be run: {error}"));
        assert!(status.success(), "POV-Ray has failed");
        file
    }

    /// With as many rays a pixel as Zeroset's picture has, and a bound of the gradient or the usual one.
    fn lit(&self, bound: Option<f64>) -> PathBuf {
        let samples = format!("+R{SAMPLES}");
        let options = ["+A0.0", "+AM1", "-J", &samples].map(str::to_owned);
        let bound = bound.map(|bound| format!("Declare=Bound={bound}"));
        self.run(&options.into_iter().chain(bound).collect::<Vec<_>>())
    }

    fn picture(&self, bound: Option<f64>) -> RgbImage {
        image::open(self.lit(bound)).unwrap().into_rgb8()
    }

    /// From the scene to the PNG file.
    fn time(&self, bound: f64) -> Duration {
        let start = Instant::now();
        self.lit(Some(bound));
        start.elapsed()
    }

    /// The normal of each pixel in scene coordinates; `None` where there is no surface.
    fn normals(&self, camera: &Camera) -> Vec<Option<DVec3>> {
        let halves = [1, -1].map(|sign| {
            let options = ["-A", "+FN16", "File_Gamma=1"].map(str::to_owned);
            let of = [format!("Declare=Normals={sign}"), format!("Declare=Bound={BOUND}")];
            image::open(self.run(&[&options[..], &of].concat())).unwrap().into_rgb16()
        });
        let ray = |x: f64, y: f64| camera.ray(DVec2::new(x, y)).1;
        let forward = camera.forward();
        let [right, up] = [ray(1.0, 0.0), ray(0.0, 1.0)].map(|v| (v - forward).normalize());
        let [front, back] = &halves;
        let normal = |(a, b): (&Rgb<u16>, &Rgb<u16>)| {
            let component = |c: usize| f64::from(a.0[c]) - f64::from(b.0[c]);
            (a.0[2] > 0).then(|| {
                let toward = f64::from(a.0[2]);
                component(0) * right + component(1) * up - toward * forward
            })
        };
        front.pixels().zip(back.pixels()).map(normal).collect()
    }
}

/// Prints how many pixels only one of both covers, and the mean angle between normals.
fn compare(ours: &Frame, theirs: &[Option<DVec3>]) {
    let (mut n_both, mut n_ours, mut n_theirs, mut degrees) = (0, 0, 0, 0.0);
    for (i, theirs) in theirs.iter().enumerate() {
        match (ours.depth[i] < Frame::FAR, theirs) {
            (true, Some(normal)) => {
                n_both += 1;
                let own = DVec3::from_array(ours.normal[i].map(f64::from));
                degrees += own.angle_between(*normal).to_degrees();
            }
            (true, None) => n_ours += 1,
            (false, Some(_)) => n_theirs += 1,
            (false, None) => {}
        }
    }
    println!(
        "pixels covered by both {n_both}, by Zeroset only {n_ours}, by POV-Ray only {n_theirs}"
    );
    println!("mean angle between normals {:.4}°", degrees / f64::from(n_both));
}
