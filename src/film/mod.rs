//! Films and sweeps: one frame after another, each as a still picture is made.
//!
//! Before the first frame all of them are looked at with large voxels, so that one domain holds the
//! surfaces of all and a fitted camera shows them without trembling. That is done every time,
//! whichever frames are drawn then: a frame is the same bits among all others and alone.

mod survey;
mod together;
mod watched;

use std::{ops::RangeInclusive, path::PathBuf, time::Instant};

use self::{
    together::{Animated, ContactSheet},
    watched::{Pace, Watched},
};
use crate::{
    Error, Result,
    limits::{self, Memory},
    output::NewFile,
    pipeline::{self, Options, Picture},
    progress::Progress,
    raster::Camera,
    scene::{Outputs, Scene},
    statistics::Statistics,
};

/// What making a film or a sweep did.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// How many frames were drawn.
    pub n_frames: u32,
    /// The files of frames, in order.
    pub written: Vec<PathBuf>,
    /// The file that holds all frames that were drawn, if there is one.
    pub together: Option<PathBuf>,
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
    let in_folder = |name: &PathBuf| options.out_dir.join(name);
    let animated = scene.outputs.apng.as_ref().map(in_folder);
    let mut file = animated.as_deref().map(NewFile::create).transpose()?;
    let begin = |(path, file)| Animated::new(&film, path, file);
    let mut apng = animated.as_deref().zip(file.as_mut()).map(begin).transpose()?;
    let of_sweep = scene.sweep.as_ref().zip(scene.outputs.sheet.as_ref().map(in_folder));
    let begin = |(sweep, path)| ContactSheet::new(&film, sweep, path);
    let mut sheet = of_sweep.map(begin).transpose()?;
    let start = Instant::now();
    for number in film.numbers.clone() {
        let n_left = film.numbers.end() - number + 1;
        let pace = Pace { start, n_done: report.n_frames, n_left };
        let (frame, mut picture) = film.draw(number, Some(pace), progress)?;
        let start = Instant::now();
        report.written.extend(pipeline::write(&frame, options, &picture, progress)?);
        if let Some(apng) = &mut apng {
            apng.push(&picture.frame)?;
        }
        if let Some(sheet) = &mut sheet {
            sheet.push(number, &picture.frame);
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
    apng.map(Animated::finish).transpose()?;
    file.map(NewFile::keep).transpose()?;
    report.together = animated;
    if let Some(sheet) = sheet {
        report.together = Some(sheet.finish()?);
    }
    Ok(report)
}

/// A film or a sweep that is ready to be drawn.
#[derive(Debug)]
pub struct Film<'a> {
    /// With a domain for all frames.
    scene: Scene,
    options: &'a Options,
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
    /// [`Error::Limit`] if the scene has no frames, or not those that the options name, or its pictures
    /// are too large; [`Error::Empty`] if no frame shows anything to which a camera can be fitted;
    /// [`Error::Interrupted`] if `progress` asks to stop.
    pub fn new(scene: &Scene, options: &'a Options, progress: &dyn Progress) -> Result<Self> {
        let numbers = numbers(scene, options)?;
        Memory::new(options.max_memory).check_image(&scene.image)?;
        let mut notes = Vec::new();
        let (scene, cameras) = pipeline::with_threads(options, || {
            survey::survey(scene, options, progress, &mut notes)
        })??;
        Ok(Self { scene, options, cameras, numbers, notes })
    }

    /// The picture of the frame of this number, which counts from 1.
    ///
    /// # Errors
    /// As [`pipeline::render`], but a frame may be empty.
    ///
    /// # Panics
    /// If the film has no such frame.
    pub fn picture(&self, number: u32, progress: &dyn Progress) -> Result<Picture> {
        self.draw(number, None, progress).map(|(_, picture)| picture)
    }

    /// The scene of a frame and its picture.
    fn draw(
        &self,
        number: u32,
        pace: Option<Pace>,
        progress: &dyn Progress,
    ) -> Result<(Scene, Picture)> {
        let frame = self.scene.frame(number)?;
        let pace = pace.map(|pace| pace.to_string()).unwrap_or_default();
        let stage = format!("frame {number} of {}{pace}", self.cameras.len());
        let progress = Watched { progress, frame: stage };
        let camera = &self.cameras[number as usize - 1];
        let mut picture = pipeline::render_frame(&frame, camera, self.options, &progress)?;
        if let Some(frame) = &mut picture.statistics.frame {
            frame.number = Some(number);
            frame.params = self.scene.params_of_frame(number);
        }
        Ok((frame, picture))
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
        let message =
            "there are no frames to choose from: the scene has neither [animation] nor [sweep]";
        return Err(Error::Limit(message.to_owned()));
    }
    if *asked.end() > n_frames {
        let (what, remedy) = match scene.sweep {
            Some(_) => ("sweep", "the values in [sweep]"),
            None => ("film", "`frames` in [animation]"),
        };
        return Err(Error::Limit(format!(
            "there is no frame {}: the {what} has {n_frames}; change --frames, or {remedy}",
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
