//! Films: one frame after another, each as a still picture is made.
//!
//! Before the first frame all of them are looked at with large voxels, so that one domain holds the
//! surfaces of all and a fitted camera shows them without trembling. That is done for every film,
//! whichever frames are drawn then: a frame is the same bits in the whole film and alone.

use std::{collections::BTreeMap, ops::RangeInclusive, path::PathBuf, time::Instant};

use glam::DVec3;

use crate::{
    Error, Result, advice,
    limits::{self, Memory},
    math::{Aabb, Lattice, SimdLevel},
    octree::Storage as _,
    output::{
        self, NewFile,
        apng::{Apng, ApngOptions},
        png::PngOptions,
    },
    pipeline::{self, Coarse, Options, Picture},
    progress::Progress,
    raster::{Camera, Drawn, Placement, Projection},
    scene::{Animation, Outputs, Scene},
    statistics::Statistics,
};

/// What making a film did.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Which frames were drawn.
    pub n_frames: u32,
    /// The files written, in order.
    pub written: Vec<PathBuf>,
    /// What the user should know about how the scene was understood.
    pub notes: Vec<String>,
}

/// Renders the frames of `scene` that the options name and writes their files. What was done for
/// each is told to `done`, whose error ends the film.
///
/// # Errors
/// As [`Film::new`], [`Film::picture`] and [`pipeline::run`]; also that of `done`. Frames that are
/// finished stay.
pub fn run(
    scene: &Scene,
    options: &Options,
    progress: &dyn Progress,
    mut done: impl FnMut(Statistics) -> Result<()>,
) -> Result<Report> {
    let film = Film::new(scene, options, progress)?;
    let mut report = Report { notes: film.notes.clone(), ..Report::default() };
    let name = scene.outputs.apng.as_ref().map(|name| options.out_dir.join(name));
    let mut file = name.as_deref().map(NewFile::create).transpose()?;
    let failed = |error| output::failed_to_write(name.as_deref().unwrap_or("".as_ref()), error);
    let begin = |file| Apng::new(&film.apng_options(), file).map_err(failed);
    let mut apng = file.as_mut().map(|file| begin(file.writer())).transpose()?;
    for number in film.numbers.clone() {
        let (frame, mut picture) = film.draw(number, progress)?;
        let start = Instant::now();
        report.written.extend(pipeline::write(&frame, options, &picture, progress)?);
        if let Some(apng) = &mut apng {
            apng.push(&picture.frame).map_err(failed)?;
        }
        picture.statistics.time_s.write = start.elapsed().as_secs_f64();
        picture.statistics.peak_memory_bytes = limits::peak_memory_bytes();
        // Those of one frame: what is true of many would be said of each.
        if report.notes.len() == film.notes.len() {
            let note = |note| format!("frame {number}: {note}");
            report.notes.extend(picture.notes.into_iter().map(note));
        }
        report.n_frames += 1;
        done(picture.statistics)?;
    }
    apng.map(Apng::finish).transpose().map_err(failed)?;
    file.map(NewFile::keep).transpose()?;
    report.written.extend(name);
    Ok(report)
}

/// A film that is ready to be drawn.
#[derive(Debug)]
pub struct Film<'a> {
    /// With a domain for all frames.
    scene: Scene,
    options: &'a Options,
    /// Frames a second.
    fps: f64,
    /// Of all frames.
    cameras: Vec<Camera>,
    /// The frames to draw.
    numbers: RangeInclusive<u32>,
    notes: Vec<String>,
}

impl<'a> Film<'a> {
    /// Finds the domain and the cameras of all frames.
    ///
    /// # Errors
    /// [`Error::Limit`] if the scene is no film, does not have the frames that the options name, or
    /// its pictures are too large; [`Error::Empty`] if no frame shows anything to which a camera
    /// can be fitted; [`Error::Interrupted`] if `progress` asks to stop.
    pub fn new(scene: &Scene, options: &'a Options, progress: &dyn Progress) -> Result<Self> {
        let numbers = numbers(scene, options)?;
        let Some(animation) = &scene.animation else { unreachable!("only films have frames") };
        Memory::new(options.max_memory).check_image(&scene.image)?;
        let mut notes = Vec::new();
        let (scene, cameras) = pipeline::with_threads(options, || {
            survey(scene, animation, options, progress, &mut notes)
        })??;
        Ok(Self { scene, options, fps: animation.fps, cameras, numbers, notes })
    }

    /// The picture of the frame of this number, which counts from 1.
    ///
    /// # Errors
    /// As [`pipeline::render`], but a frame may be empty.
    ///
    /// # Panics
    /// If the film has no such frame.
    pub fn picture(&self, number: u32, progress: &dyn Progress) -> Result<Picture> {
        self.draw(number, progress).map(|(_, picture)| picture)
    }

    /// The scene of a frame and its picture.
    fn draw(&self, number: u32, progress: &dyn Progress) -> Result<(Scene, Picture)> {
        let frame = self.scene.frame(number)?;
        let stage = format!("frame {number} of {}", self.cameras.len());
        let progress = Within { progress, stage };
        let camera = &self.cameras[number as usize - 1];
        let mut picture = pipeline::render_frame(&frame, camera, self.options, &progress)?;
        if let Some(frame) = &mut picture.statistics.frame {
            frame.number = Some(number);
        }
        Ok((frame, picture))
    }

    fn apng_options(&self) -> ApngOptions {
        let image = &self.scene.image;
        ApngOptions {
            png: PngOptions { description: self.scene.name.clone() },
            size_px: [image.width, image.height],
            is_opaque: image.background.is_some(),
            n_frames: self.numbers.end() - self.numbers.start() + 1,
            fps: self.fps,
        }
    }
}

/// The frames of `scene` that the options ask for.
///
/// # Errors
/// [`Error::Limit`] if there are no such frames.
pub fn numbers(scene: &Scene, options: &Options) -> Result<RangeInclusive<u32>> {
    let n_frames = scene.n_frames();
    let asked = options.frames.clone().unwrap_or(1..=n_frames);
    if n_frames == 0 {
        let message = "there are no frames to choose from: the scene has no [animation]";
        return Err(Error::Limit(message.to_owned()));
    }
    if *asked.end() > n_frames {
        return Err(Error::Limit(format!(
            "there is no frame {}: the film has {n_frames}; change --frames, or `frames` in \
             [animation]",
            asked.end()
        )));
    }
    Ok(asked)
}

/// The files of the frames of `scene` that the options ask for, then those of all together.
///
/// # Errors
/// As [`numbers`].
pub fn outputs(scene: &Scene, options: &Options) -> Result<Vec<Outputs>> {
    let of_frame = |number| scene.outputs.of_frame(number, scene.n_frames());
    let together = Outputs {
        png: None,
        exr: None,
        ply: None,
        forces: None,
        meshes: Vec::new(),
        ..scene.outputs.clone()
    };
    Ok(numbers(scene, options)?.map(of_frame).chain([together]).collect())
}

/// The scene with a domain that holds all frames, and the cameras of all frames.
fn survey(
    scene: &Scene,
    animation: &Animation,
    options: &Options,
    progress: &dyn Progress,
    notes: &mut Vec<String>,
) -> Result<(Scene, Vec<Camera>)> {
    let simd = options.simd.unwrap_or_else(SimdLevel::detect);
    // Frames that differ by the camera alone need one look.
    let n_different = if scene.changes() { animation.n_frames } else { 1 };
    let mut scene = scene.clone();
    scene.domain = scene.domain.or_else(|| scene.bounds_of_models());
    if scene.domain.is_none() {
        progress.begin("looking for the surfaces", u64::from(n_different), "frames");
        let mut failure = None;
        let of_frame = |number| {
            progress.advance(1);
            let is_cancelled = progress.is_cancelled();
            let frame = if is_cancelled { Err(Error::Interrupted) } else { scene.frame(number) };
            let surfaces = frame.map(|frame| frame.surfaces);
            let surfaces = surfaces.map_err(|error| failure = Some(error)).unwrap_or_default();
            surfaces.into_iter().map(|surface| (surface.name, surface.expr))
        };
        let (domain, note) = advice::choose_domain((1..=n_different).flat_map(of_frame), simd);
        progress.end();
        if let Some(failure) = failure {
            return Err(failure);
        }
        notes.push(note);
        scene.domain = Some(domain);
    }
    let views = animation.motion.views(&scene.view, animation.n_frames);
    let is_fixed = matches!(scene.view.placement, Placement::LookAt { .. })
        && matches!(scene.view.projection, Projection::Perspective { .. });
    let mut seen = Seen::default();
    if !is_fixed {
        let lattice = pipeline::choose_lattice(&scene, options.resolution, simd, notes);
        progress.begin("placing the camera", u64::from(n_different), "frames");
        for number in 1..=n_different {
            if progress.is_cancelled() {
                return Err(Error::Interrupted);
            }
            seen.add(&pipeline::coarse_voxels(&scene.frame(number)?, &lattice, simd)?);
            progress.advance(1);
        }
        progress.end();
        if seen.rows.is_empty() && scene.needs_surfaces() {
            return Err(pipeline::nothing_found(&scene, &lattice, simd));
        }
    }
    let models = Drawn { voxels: Vec::new(), outlines: &[], models: &scene.models };
    let cameras = Camera::of_film(&views, scene.image.aspect(), &(models, seen.boxes().as_slice()));
    Ok((scene, cameras))
}

/// The large voxels of several frames, all on one lattice. Of each row along x only the ends are
/// kept: how far rows reach is how far their voxels do.
#[derive(Default)]
struct Seen {
    /// Least and greatest x, by y and z.
    rows: BTreeMap<[u32; 2], [u32; 2]>,
    lattice: Option<Lattice>,
}

impl Seen {
    fn add(&mut self, coarse: &Coarse) {
        for octree in coarse.voxelizations.iter().map(|found| &found.octree) {
            for part in octree.parts() {
                octree.visit(part, &mut |voxel| {
                    let [x, y, z] = voxel.ijk;
                    let [least, most] = self.rows.entry([y, z]).or_insert([x, x]);
                    (*least, *most) = (x.min(*least), x.max(*most));
                });
            }
        }
        self.lattice.get_or_insert_with(|| coarse.lattice.clone());
    }

    fn boxes(&self) -> Vec<Aabb> {
        let Some(lattice) = &self.lattice else { return Vec::new() };
        let corner = |ijk: [u32; 3]| {
            DVec3::from_array(std::array::from_fn(|axis| lattice.corner(axis, ijk[axis])))
        };
        let row = |(&[y, z], &[least, most]): (&[u32; 2], &[u32; 2])| Aabb {
            min: corner([least, y, z]),
            max: corner([most + 1, y + 1, z + 1]),
        };
        self.rows.iter().map(row).collect()
    }
}

/// Progress of a frame, which says which one it is.
struct Within<'a> {
    progress: &'a dyn Progress,
    stage: String,
}

impl Progress for Within<'_> {
    fn begin(&self, stage: &str, total: u64, unit: &str) {
        self.progress.begin(&format!("{}: {stage}", self.stage), total, unit);
    }

    fn advance(&self, units: u64) {
        self.progress.advance(units);
    }

    fn end(&self) {
        self.progress.end();
    }

    fn is_cancelled(&self) -> bool {
        self.progress.is_cancelled()
    }
}
