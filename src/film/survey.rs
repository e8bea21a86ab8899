//! What is found out before the first frame: one domain for all frames, and their cameras.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::{
    Error, Result, advice,
    limits::Memory,
    math::{Aabb, Lattice, SimdLevel},
    octree::Storage as _,
    pipeline::{self, Coarse, Options},
    progress::Progress,
    raster::{Camera, Drawn, Motion, Placement, Projection},
    scene::Scene,
    solids,
};

/// The scene with a domain that holds all frames, and the cameras of all frames.
pub(super) fn survey(
    scene: &Scene,
    options: &Options,
    progress: &dyn Progress,
    notes: &mut Vec<String>,
) -> Result<(Scene, Vec<Camera>)> {
    let simd = options.simd.unwrap_or_else(SimdLevel::detect);
    // Frames that differ by the camera alone need one look.
    let n_different = if scene.changes() { scene.n_frames() } else { 1 };
    let mut scene = scene.clone();
    scene.domain = scene.domain.or_else(|| scene.bounds_without_surfaces());
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
    let cameras = cameras(&scene, n_different, options, progress, notes)?;
    Ok((scene, cameras))
}

/// The cameras of all frames, of which the first `n_different` show different things.
fn cameras(
    scene: &Scene,
    n_different: u32,
    options: &Options,
    progress: &dyn Progress,
    notes: &mut Vec<String>,
) -> Result<Vec<Camera>> {
    let simd = options.simd.unwrap_or_else(SimdLevel::detect);
    let motion = scene.animation.as_ref().map_or(&Motion::Still, |animation| &animation.motion);
    let views = motion.views(&scene.view, scene.n_frames());
    let is_fixed = matches!(scene.view.placement, Placement::LookAt { .. })
        && matches!(scene.view.projection, Projection::Perspective { .. });
    let mut seen = Seen::default();
    if !is_fixed {
        let lattice = pipeline::choose_lattice(scene, options.resolution, simd, notes);
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
            return Err(pipeline::nothing_found(scene, &lattice, simd));
        }
    }
    let shapes = solids::shapes(scene, &Memory::new(options.max_memory), progress)?;
    let drawn = solids::drawn(scene, &shapes, progress)?;
    if let Some(error) = solids::nothing_of(scene, &drawn) {
        return Err(error);
    }
    let content = Drawn { models: &scene.models, solids: &drawn, ..Drawn::default() };
    let boxes = seen.boxes();
    Ok(Camera::of_film(&views, scene.image.aspect(), &(content, boxes.as_slice())))
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
