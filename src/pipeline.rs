//! From a scene to files: the only place where one stage hands its result to the next.

use std::{num::NonZeroUsize, ops::RangeInclusive, path::PathBuf, thread, time::Instant};

use crate::{
    Error, Result,
    advice::{self, Occupied},
    expr::Tape,
    limits::{self, Memory},
    math::{Aabb, Lattice, SimdLevel},
    mesh::Mesh,
    meshing,
    octree::{Detail, Storage, StorageKind},
    output::{
        self, exr, forces,
        meshes::{MeshOptions, write_meshes},
        ply, png,
    },
    progress::{Progress, Unwatched},
    raster::{self, Camera, Contents, Drawn, Frame, Layer, OnDemandCount, Shade, Source},
    scene::{MeshSettings, Scene, Surface},
    sculpt::Felt,
    solids,
    statistics::{self, Boxes, DomainBox, Statistics, Times, Voxels, hex},
    voxelize::{self, BLOCK_LEVELS, Effort, Outline, Precision, Schedule, Settings, Voxelization},
};

/// What the user may change for one run without touching the scene.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Where files are written.
    pub out_dir: PathBuf,
    /// Number of threads; one for each core where `None`. Results do not depend on it.
    pub threads: Option<NonZeroUsize>,
    /// Voxels along the longest axis, instead of the scene's own.
    pub resolution: Option<u32>,
    /// Instruction set; the machine's best where `None`. Results do not depend on it.
    pub simd: Option<SimdLevel>,
    /// Bytes of memory that may be taken; three quarters of the machine's where `None`.
    pub max_memory: Option<u64>,
    /// Whether all voxels are found, and not only those that the picture shows, unless the scene
    /// says.
    pub find_all: bool,
    /// The frames of a film or a sweep that are drawn, by their numbers, which begin with 1; all where `None`.
    pub frames: Option<RangeInclusive<u32>>,
}

/// What a run did.
#[derive(Clone, Debug)]
pub struct Report {
    /// Numbers.
    pub statistics: Statistics,
    /// The files written, in order.
    pub written: Vec<PathBuf>,
    /// What the user should know about how the scene was understood.
    pub notes: Vec<String>,
}

/// What a scene looks like, before it goes to files.
#[derive(Debug)]
pub struct Picture {
    /// The picture with its layers.
    pub frame: Frame,
    /// Where it was taken from.
    pub camera: Camera,
    /// Where voxels lie.
    pub lattice: Lattice,
    /// The voxels of each surface of the scene, if all were found.
    pub storages: Vec<Box<dyn Storage>>,
    /// The meshes of surfaces, if files of them are written.
    pub meshes: Vec<Mesh>,
    /// What hands have felt that pushed tools, for each solid of the scene.
    pub felt: Vec<Vec<Felt>>,
    /// Numbers.
    pub statistics: Statistics,
    /// What the user should know about how the scene was understood.
    pub notes: Vec<String>,
}

/// Renders `scene` and writes its files; of a film or a sweep, the first frame as a picture, see
/// [`crate::film`].
///
/// # Errors
/// [`Error::Empty`] if no surface meets the domain, [`Error::Limit`] if the scene is too large,
/// [`Error::Interrupted`] if `progress` asks to stop, [`Error::Io`] and [`Error::Encode`] if a file
/// cannot be written. No file is left half written.
pub fn run(scene: &Scene, options: &Options, progress: &dyn Progress) -> Result<Report> {
    let picture = render(scene, options, progress)?;
    let start = Instant::now();
    let written = write(scene, options, &picture, progress)?;
    let Picture { mut statistics, notes, .. } = picture;
    statistics.time_s.write = start.elapsed().as_secs_f64();
    statistics.peak_memory_bytes = limits::peak_memory_bytes();
    Ok(Report { statistics, written, notes })
}

/// Whether `scene` can be begun: whatever can be said of it without working on it.
///
/// # Errors
/// [`Error::Limit`] if the picture is too large for the machine.
pub fn check(scene: &Scene) -> Result<()> {
    Memory::new(None).check_image(&scene.image)
}

/// Renders `scene` and writes nothing.
///
/// # Errors
/// As [`run`], without those of files.
pub fn render(scene: &Scene, options: &Options, progress: &dyn Progress) -> Result<Picture> {
    with_threads(options, || render_with_all_threads(scene, None, options, progress))?
}

/// Renders a frame of a film, which may show nothing, as `camera` sees it.
///
/// # Errors
/// As [`render`].
pub(crate) fn render_frame(
    frame: &Scene,
    camera: &Camera,
    options: &Options,
    progress: &dyn Progress,
) -> Result<Picture> {
    with_threads(options, || render_with_all_threads(frame, Some(camera), options, progress))?
}

/// Runs `work` in a pool with as many threads as the options say.
pub(crate) fn with_threads<T: Send>(
    options: &Options,
    work: impl FnOnce() -> T + Send,
) -> Result<T> {
    let n_threads = options
        .threads
        .or_else(|| thread::available_parallelism().ok())
        .map_or(1, NonZeroUsize::get);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build();
    let pool =
        pool.map_err(|error| Error::Limit(format!("cannot start {n_threads} threads: {error}")))?;
    Ok(pool.install(work))
}

/// A scene without a camera of its own must show something.
fn render_with_all_threads(
    scene: &Scene,
    camera: Option<&Camera>,
    options: &Options,
    progress: &dyn Progress,
) -> Result<Picture> {
    let simd = options.simd.unwrap_or_else(SimdLevel::detect);
    let memory = Memory::new(options.max_memory);
    memory.check_image(&scene.image)?;
    let mut notes = Vec::new();
    let lattice = choose_lattice(scene, options.resolution, simd, &mut notes);
    let is_frame = camera.is_some();

    let start = Instant::now();
    let shapes = solids::shapes(scene, &memory, progress)?;
    let drawn = solids::drawn(scene, &shapes, progress)?;
    if let Some(error) = solids::nothing_of(scene, &drawn).filter(|_| !is_frame) {
        return Err(error);
    }
    let sample = start.elapsed().as_secs_f64();

    let start = Instant::now();
    let outlines = outlines(scene, &lattice, simd)?;
    if !is_frame && scene.needs_surfaces() && outlines.iter().all(Outline::is_empty) {
        return Err(nothing_found(scene, &lattice, simd));
    }
    let content =
        Drawn { outlines: &outlines, models: &scene.models, solids: &drawn, ..Drawn::default() };
    let camera =
        camera.cloned().unwrap_or_else(|| Camera::new(&scene.view, scene.image.aspect(), &content));

    let is_visible_only = is_visible_only(scene, options, &lattice);
    let whole = if is_visible_only {
        notes.extend(notes_on(
            scene,
            lattice.bounds(),
            outlines.iter().map(Occupied::of_outline),
            simd,
        ));
        Whole::default()
    } else {
        let (voxelizations, n_voxels) = find_voxels(scene, &lattice, simd, &memory, progress)?;
        if n_voxels == 0 && !is_frame && scene.needs_surfaces() {
            return Err(nothing_found(scene, &lattice, simd));
        }
        let occupied = voxelizations.iter().map(|v| Occupied::of_octree(&v.octree, &lattice));
        notes.extend(notes_on(scene, lattice.bounds(), occupied, simd));
        Whole::new(scene, voxelizations)
    };
    let voxelize = start.elapsed().as_secs_f64();

    let start = Instant::now();
    let (meshes, of_meshes) = match scene.outputs.meshes.is_empty() {
        true => (Vec::new(), Vec::new()),
        false => meshing::meshes(scene, &whole.storages, &shapes, &lattice, simd),
    };
    notes.extend(of_meshes.iter().flat_map(|numbers| meshing::notes(numbers, &scene.mesh)));
    let mesh = start.elapsed().as_secs_f64();

    let has_meshes = !scene.outputs.meshes.is_empty();
    let singular = match options.find_all || has_meshes {
        true => singular(scene, &whole.storages, &lattice, simd),
        false => Vec::new(),
    };
    let note =
        |found: &statistics::Singular| advice::of_singular(&found.name, found.places, found.first);
    notes.extend(singular.iter().filter(|_| has_meshes).filter_map(note));

    let start = Instant::now();
    let tapes: Vec<Tape> = scene.surfaces.iter().map(|surface| surface.expr.tape()).collect();
    let details: Vec<Detail<'_>> =
        whole.storages.iter().map(|storage| Detail::new(&**storage, &lattice)).collect();
    let layer = |i: usize| Layer {
        source: match details.get(i) {
            Some(detail) if !follows_rays(scene, &lattice) => Source::Stored(detail),
            _ => Source::OnDemand { is_auto: scene.is_auto },
        },
        lattice: &lattice,
        material: scene.surfaces[i].material,
        coloring: &scene.surfaces[i].coloring,
        tape: Some(&tapes[i]),
    };
    let layers: Vec<Layer<'_>> = (0..scene.surfaces.len()).map(layer).collect();
    let contents = Contents { layers: &layers, models: &scene.models, solids: &drawn };
    let is_wanted = is_frame || options.find_all || scene.outputs.has_picture();
    let (frame, seen) = match is_wanted {
        true => raster::render(&contents, &camera, &scene.image, simd, progress)?,
        false => (Frame::filled(0, 0, [0.0; 4]), OnDemandCount::default()),
    };
    let rasterize = start.elapsed().as_secs_f64();
    drop(details);

    let (stored, certified) = if is_visible_only {
        (seen.voxels, seen.certified)
    } else {
        (whole.n_voxels, whole.n_certified)
    };
    let of_outlines: Vec<Effort> = outlines.iter().map(Outline::effort).collect();
    // Where all voxels were found, what the picture took is no part of that.
    let efforts =
        of_outlines.iter().chain(&whole.efforts).chain(is_visible_only.then_some(&seen.effort));
    let statistics = Statistics {
        scene: scene.name.clone(),
        resolution: lattice.n_voxels(),
        visible_only: is_visible_only,
        domain: DomainBox::from(lattice.bounds()),
        boxes: Boxes::sum(efforts),
        voxels: Voxels { stored, certified, candidate: stored - certified },
        octree: statistics::Octree {
            bytes: statistics::Bytes::sum(whole.storages.iter().map(|storage| storage.bytes())),
            digests: whole.digests,
        },
        solids: solids::statistics(scene, &shapes),
        singular,
        meshes: of_meshes,
        frame: options.find_all.then(|| statistics::Frame::from(&frame.digest())),
        precision: Precision::for_lattice(&lattice).name(),
        simd: simd.name(),
        threads: rayon::current_num_threads(),
        time_s: Times { sample, voxelize, rasterize, mesh, write: 0.0 },
        peak_memory_bytes: limits::peak_memory_bytes(),
    };
    let storages = whole.storages;
    let felt = shapes.iter().map(|shape| shape.felt().to_vec()).collect();
    Ok(Picture { frame, camera, lattice, storages, meshes, felt, statistics, notes })
}

/// All voxels of all surfaces.
#[derive(Default)]
struct Whole {
    storages: Vec<Box<dyn Storage>>,
    digests: Vec<String>,
    efforts: Vec<Effort>,
    n_voxels: u64,
    n_certified: u64,
}

impl Whole {
    fn new(scene: &Scene, voxelizations: Vec<Voxelization>) -> Self {
        let mut whole = Self::default();
        for Voxelization { octree, effort, .. } in voxelizations {
            whole.digests.push(hex(octree.digest()));
            whole.n_voxels += u64::from(octree.voxel_count());
            whole.n_certified += u64::from(octree.certified_count());
            whole.efforts.push(effort);
            whole.storages.push(scene.storage.keep(octree));
        }
        whole
    }
}

/// Where each surface whose voxels were found is not proven to be a single sheet.
fn singular(
    scene: &Scene,
    storages: &[Box<dyn Storage>],
    lattice: &Lattice,
    simd: SimdLevel,
) -> Vec<statistics::Singular> {
    let of_surface = |(surface, storage): (&Surface, &dyn Storage)| {
        let places = voxelize::singular_places(&surface.expr.tape(), storage, lattice, simd);
        statistics::Singular {
            name: surface.name.clone(),
            places: places.len() as u64,
            voxels: places.iter().map(|place| place.n_voxels).sum(),
            first: places.first().map(|place| lattice.voxel_center(place.first).to_array()),
        }
    };
    let storages = storages.iter().map(|storage| &**storage);
    scene.surfaces.iter().zip(storages).map(of_surface).collect()
}

/// Voxels along the longest axis for placing the camera, at most.
const COARSE: u32 = 128;

/// A lattice of large voxels, by which cameras are placed.
fn coarse_lattice(lattice: &Lattice) -> Lattice {
    let resolution = lattice.n_voxels().into_iter().max().unwrap_or(1);
    let levels = resolution.div_ceil(COARSE).next_power_of_two().ilog2();
    Lattice::new(lattice.bounds(), (resolution >> levels).max(1))
}

/// Large voxels of all surfaces.
pub(crate) struct Coarse {
    pub(crate) lattice: Lattice,
    pub(crate) voxelizations: Vec<Voxelization>,
}

/// Finds large voxels of all surfaces.
pub(crate) fn coarse_voxels(scene: &Scene, lattice: &Lattice, simd: SimdLevel) -> Result<Coarse> {
    let coarse = coarse_lattice(lattice);
    let settings = Settings { simd, certify: scene.certify, ..Settings::default() };
    let find =
        |surface: &Surface| voxelize::voxelize(&surface.expr, &coarse, &settings, &Unwatched);
    let voxelizations: Result<Vec<Voxelization>> = scene.surfaces.iter().map(find).collect();
    Ok(Coarse { voxelizations: voxelizations?, lattice: coarse })
}

/// The outlines of all surfaces, by which the camera is placed: the same whichever voxels are found
/// after them.
fn outlines(scene: &Scene, lattice: &Lattice, simd: SimdLevel) -> Result<Vec<Outline>> {
    let coarse = coarse_lattice(lattice);
    let outline = |surface: &Surface| Outline::new(&surface.expr, &coarse, simd, scene.certify);
    scene.surfaces.iter().map(outline).collect()
}

/// Whether the picture needs no voxels: it follows rays through cells that are found on demand, so that
/// it is the same whether all voxels are found or not.
fn follows_rays(scene: &Scene, lattice: &Lattice) -> bool {
    scene.certify
        && scene.image.shade == Shade::Refine
        && scene.image.candidates
        && lattice.depth() > BLOCK_LEVELS
}

/// Whether only those voxels are found that the picture shows.
fn is_visible_only(scene: &Scene, options: &Options, lattice: &Lattice) -> bool {
    // The paper's storages and schedule hold and find all, and so do values alone. The normals of
    // voxels without a gradient, and of slabs, are those of their neighbours, which may be anywhere.
    let needs_all = scene.outputs.ply.is_some()
        || !scene.outputs.meshes.is_empty()
        || scene.storage != StorageKind::Morton
        || scene.schedule != Schedule::Stealing
        || !scene.certify
        || scene.image.shade != Shade::Refine
        || lattice.depth() <= BLOCK_LEVELS;
    scene.is_auto || (scene.visible_only.unwrap_or(!options.find_all) && !needs_all)
}

/// The voxel lattice of `scene`, with another resolution if one is given.
#[must_use]
pub fn lattice(scene: &Scene, resolution: Option<u32>) -> Lattice {
    choose_lattice(scene, resolution, SimdLevel::detect(), &mut Vec::new())
}

/// Adds a note if the domain had to be found.
pub(crate) fn choose_lattice(
    scene: &Scene,
    resolution: Option<u32>,
    simd: SimdLevel,
    notes: &mut Vec<String>,
) -> Lattice {
    let domain = scene.domain.or_else(|| scene.bounds_without_surfaces()).unwrap_or_else(|| {
        let surfaces = scene.surfaces.iter().map(|s| (&s.name, &s.expr));
        let (domain, note) = advice::choose_domain(surfaces, simd);
        notes.push(note);
        domain
    });
    Lattice::new(domain, resolution.unwrap_or(scene.resolution))
}

/// The voxels of all surfaces, and how many they are.
fn find_voxels(
    scene: &Scene,
    lattice: &Lattice,
    simd: SimdLevel,
    memory: &Memory,
    progress: &dyn Progress,
) -> Result<(Vec<Voxelization>, u32)> {
    let Scene { storage, image, schedule, certify, .. } = scene;
    let max_voxels = memory.max_voxels(lattice, *storage, image);
    let settings = Settings { simd, schedule: *schedule, certify: *certify, max_voxels };
    let mut n_expected = 0;
    for surface in &scene.surfaces {
        n_expected += voxelize::expected_voxels(&surface.expr, lattice, &settings)?;
    }
    memory.check_voxels(n_expected, lattice, *storage, image)?;
    let (mut voxelizations, mut n_voxels) = (Vec::new(), 0);
    for surface in &scene.surfaces {
        let settings = Settings { max_voxels: max_voxels - n_voxels, ..settings };
        let found = voxelize::voxelize(&surface.expr, lattice, &settings, progress)?;
        n_voxels += found.octree.voxel_count();
        voxelizations.push(found);
    }
    Ok((voxelizations, n_voxels))
}

/// Says why there is no voxel.
pub(crate) fn nothing_found(scene: &Scene, lattice: &Lattice, simd: SimdLevel) -> Error {
    let why =
        |surface: &Surface| advice::why_empty(&surface.name, &surface.expr, lattice.bounds(), simd);
    Error::Empty(scene.surfaces.iter().map(why).collect::<Vec<_>>().join("\n"))
}

/// What the user should know about the surfaces that were found, and those that were not.
fn notes_on<'a>(
    scene: &Scene,
    domain: Aabb,
    occupied: impl Iterator<Item = Option<Occupied<'a>>>,
    simd: SimdLevel,
) -> Vec<String> {
    let about = |(surface, found): (&Surface, Option<Occupied<'a>>)| {
        let (name, expr) = (surface.name.as_str(), &surface.expr);
        match found {
            None => Some(advice::why_empty(name, expr, domain, simd)),
            Some(found) => advice::about(name, expr, &found, simd),
        }
    };
    scene.surfaces.iter().zip(occupied).filter_map(about).collect()
}

/// Writes the files of a scene, and tells which.
pub(crate) fn write(
    scene: &Scene,
    options: &Options,
    picture: &Picture,
    progress: &dyn Progress,
) -> Result<Vec<PathBuf>> {
    let Picture { frame, lattice, storages, meshes, felt, .. } = picture;
    let mut written = Vec::new();
    let mut write_one =
        |name: &PathBuf, write: &dyn Fn(&mut output::FileWriter) -> output::Written| {
            if progress.is_cancelled() {
                return Err(Error::Interrupted);
            }
            let path = options.out_dir.join(name);
            output::write_file(&path, write)?;
            written.push(path);
            Ok(())
        };
    if let Some(name) = &scene.outputs.png {
        let options = png::PngOptions { description: scene.name.clone() };
        write_one(name, &|out| png::write(frame, &options, out))?;
    }
    if let Some(name) = &scene.outputs.exr {
        let options =
            exr::ExrOptions { scene: scene.name.clone(), is_plain: !scene.outputs.layers };
        write_one(name, &|out| exr::write(frame, &options, out))?;
    }
    if let Some(name) = &scene.outputs.ply {
        let surfaces = scene.surfaces.iter().zip(storages);
        let points: Vec<ply::Points<'_>> = surfaces
            .map(|(surface, storage)| ply::Points {
                storage: &**storage,
                color: surface.material.color,
            })
            .collect();
        write_one(name, &|out| ply::write(&points, lattice, out))?;
    }
    if let Some(name) = &scene.outputs.forces {
        let pushes = scene.solids.iter().zip(felt).flat_map(|(solid, felt)| {
            felt.iter().map(|push| forces::Push {
                sculpture: &solid.name,
                stroke: push.stroke,
                moments: &push.moments,
            })
        });
        let pushes: Vec<forces::Push<'_>> = pushes.collect();
        write_one(name, &|out| forces::write(&pushes, out))?;
    }
    let MeshSettings { up, scale, unit, .. } = scene.mesh;
    let of_meshes = MeshOptions { up, scale, unit, scene: scene.name.clone() };
    for (format, name) in &scene.outputs.meshes {
        if progress.is_cancelled() {
            return Err(Error::Interrupted);
        }
        let path = options.out_dir.join(name);
        written.extend(write_meshes(&path, *format, meshes, &of_meshes)?);
    }
    Ok(written)
}
