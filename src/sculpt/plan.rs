//! What becomes of a formula under strokes: the start, the strokes, and any state between.

use std::sync::OnceLock;

use glam::{DAffine3, DVec3};
use rayon::prelude::*;

use super::{Contact, Deed, Moment, Piece, Sculpture, Tool};
use crate::{
    eval::sampler,
    expr::Tape,
    hrb::{HrbOctree, Samples, Tolerance},
    math::{Aabb, SimdLevel},
    mesh::{Border, Crossing, Mesh},
    progress::Progress,
};

/// Values of a sculpture are depths below its surface, in samples, up to this.
pub const DEPTH: f64 = 4.0;

/// A tool and its way.
#[derive(Clone, Debug)]
pub struct Stroke {
    /// With lengths in samples.
    pub tool: Tool,
    /// In samples from the first corner.
    pub pieces: Vec<Piece>,
    /// How it is pushed along all of them, if it is not simply led.
    pub contact: Option<Contact>,
    /// Which stroke of the script it is part of.
    pub number: usize,
}

/// What a hand has felt.
#[derive(Clone, Debug, PartialEq)]
pub struct Felt {
    /// Which stroke of the script it is.
    pub stroke: usize,
    /// From moment to moment; lengths in the scene's.
    pub moments: Vec<Moment>,
}

impl Stroke {
    /// In how many parts it can be shown.
    fn n(&self) -> usize {
        self.contact.map_or(self.pieces.len(), |contact| contact.n(&self.pieces))
    }
}

/// See the file's text.
#[derive(Clone, Debug)]
pub struct Plan {
    formula: Option<Tape>,
    /// The formula in samples, once it is needed.
    start: OnceLock<HrbOctree<f32>>,
    bounds: Aabb,
    /// Edge of a sample.
    step: f64,
    /// Samples along each axis.
    size: [u32; 3],
    strokes: Vec<Stroke>,
}

impl Plan {
    /// Begins with the solid F < 0 in a box, sampled at `n_longest` places along its longest edge; the box
    /// grows to whole samples. What is undefined is no solid; without a formula there is none.
    #[must_use]
    pub fn new(formula: Option<Tape>, bounds: Aabb, n_longest: u32, strokes: Vec<Stroke>) -> Self {
        let step = bounds.size().max_element() / f64::from(n_longest);
        let size = (bounds.size() / step).to_array().map(|n| ((n - 1e-9).ceil() as u32).max(1));
        let bounds = Aabb {
            min: bounds.min,
            max: bounds.min + step * DVec3::from_array(size.map(f64::from)),
        };
        Self { formula, start: OnceLock::new(), bounds, step, size, strokes }
    }

    /// Samples along each axis.
    #[must_use]
    pub fn size(&self) -> [u32; 3] {
        self.size
    }

    /// The box of all samples.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// From samples to the scene.
    #[must_use]
    pub fn placing(&self) -> DAffine3 {
        let scale = DAffine3::from_scale(DVec3::splat(self.step));
        DAffine3::from_translation(self.bounds.min) * scale
    }

    /// Whether there is nothing to begin with, and no stroke brings anything.
    #[must_use]
    pub fn is_of_nothing(&self) -> bool {
        let brings = |stroke: &Stroke| matches!(stroke.tool.deed, Deed::Add | Deed::Fill);
        self.formula.is_none() && !self.strokes.iter().any(brings)
    }

    /// The formula in samples.
    fn start(&self) -> &HrbOctree<f32> {
        self.start.get_or_init(|| {
            let Self { bounds, step, size, .. } = self;
            let slice = |z: u32| match &self.formula {
                Some(tape) => depths(tape, bounds, *step, *size, z),
                None => vec![-DEPTH as f32; (size[0] * size[1]) as usize],
            };
            let slices: Vec<Vec<f32>> = (0..size[2]).into_par_iter().map(slice).collect();
            HrbOctree::build(&slices.concat(), *size, Tolerance::default())
        })
    }

    /// In how many parts all strokes can be shown.
    #[must_use]
    pub fn n(&self) -> usize {
        self.strokes.iter().map(Stroke::n).sum()
    }

    /// The sculpture after the first `n` parts, and what hands have felt; `None` if `progress` asks to
    /// stop.
    #[must_use]
    pub fn carved(
        &self,
        mut n: usize,
        progress: &dyn Progress,
    ) -> Option<(Sculpture<f32>, Vec<Felt>)> {
        progress.begin("sculpt", n as u64, "strokes");
        let mut sculpture = Sculpture::new(self.start().clone(), 0.0, Border::Capped);
        let mut felt = Vec::new();
        for stroke in &self.strokes {
            let Stroke { tool, pieces, contact, number } = stroke;
            let own = stroke.n().min(n);
            n -= own;
            let Some(contact) = contact else {
                for piece in pieces.iter().take(own) {
                    if progress.is_cancelled() {
                        return None;
                    }
                    sculpture.apply(tool, piece);
                    progress.advance(1);
                }
                continue;
            };
            if progress.is_cancelled() {
                return None;
            }
            // The hand waits for the tool once it is at its end.
            let moments = if own == stroke.n() { contact.moments } else { own };
            let moments = contact.moments.min(moments);
            let told = sculpture.push(tool, pieces, &Contact { moments, ..*contact });
            let of_scene = |moment: &Moment| Moment {
                hand: moment.hand * self.step,
                tool: moment.tool * self.step,
                force: moment.force,
            };
            felt.push(Felt { stroke: *number, moments: told.iter().map(of_scene).collect() });
            progress.advance(own as u64);
        }
        progress.end();
        Some((sculpture, felt))
    }

    /// The mesh of a sculpture of this plan, in scene coordinates.
    #[must_use]
    pub fn mesh(&self, sculpture: &Sculpture<f32>) -> Mesh {
        let extraction = sculpture.extraction();
        let vertex = |crossing: &Crossing| {
            let point = DVec3::from_array(crossing.point());
            let outwards = match crossing.is_cap {
                true => crossing.outwards(),
                false => -gradient(sculpture.octree(), point),
            };
            let along = || crossing.outwards().normalize_or(DVec3::Z);
            let normal = outwards.try_normalize().unwrap_or_else(along);
            let place = self.bounds.min + self.step * point;
            (place.as_vec3().to_array(), normal.as_vec3().to_array())
        };
        let (positions, normals) = extraction.vertices.par_iter().map(vertex).unzip();
        let triangles = extraction.triangles;
        let mut mesh = Mesh { positions, normals, triangles, ..Mesh::default() };
        mesh.drop_unused();
        mesh
    }
}

/// Depths of a slice of samples below F = 0, by F and its gradient there.
fn depths(tape: &Tape, bounds: &Aabb, step: f64, size: [u32; 3], z: u32) -> Vec<f32> {
    let slice = Samples { first: [0, 0, z], end: [size[0], size[1], z + 1] };
    let points: Vec<DVec3> = slice
        .iter()
        .map(|p| bounds.min + step * (DVec3::from_array(p.map(f64::from)) + 0.5))
        .collect();
    let mut sampler = sampler(SimdLevel::detect());
    let values = sampler.values(tape, &points);
    let gradients = sampler.gradients(tape, &points);
    let depth = |(f, g): (f64, DVec3)| {
        let slope = g.length() * step;
        let depth = if slope.is_finite() && slope > 0.0 { -f / slope } else { -f * f64::MAX };
        // What is undefined is outside; 0 without a slope is on the surface.
        if f.is_nan() {
            -DEPTH
        } else if f == 0.0 {
            0.0
        } else {
            depth.clamp(-DEPTH, DEPTH)
        }
    };
    values.into_iter().zip(gradients).map(|pair| depth(pair) as f32).collect()
}

/// By differences of values one sample apart.
fn gradient(octree: &HrbOctree<f32>, point: DVec3) -> DVec3 {
    let along = |axis: DVec3| {
        octree.value_at((point + axis).to_array()) - octree.value_at((point - axis).to_array())
    };
    DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
}
