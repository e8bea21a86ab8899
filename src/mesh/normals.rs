//! Normals of vertices that were moved: the formula's again.

use glam::DVec3;
use rayon::prelude::*;

use super::Mesh;
use crate::{eval::sampler, expr::Tape, math::SimdLevel};

/// Vertices that a thread looks at, at a time.
const CHUNK: usize = 1 << 12;

/// The cosine of the angle by which a formula's normal may differ from the one that a vertex has. It
/// is farther off on caps, whose normals are not the formula's, and at sharp edges.
const LEAST_COSINE: f64 = 0.9;

impl Mesh {
    /// Gives vertices the normals of F at their places, outwards where F < 0 is inside, if these are
    /// not far from those that they have.
    pub fn take_normals_of(&mut self, tape: &Tape, simd: SimdLevel) {
        let wide = |p: &[f32; 3]| DVec3::from_array(p.map(f64::from));
        self.normals.par_chunks_mut(CHUNK).zip(self.positions.par_chunks(CHUNK)).for_each_init(
            || sampler(simd),
            |sampler, (normals, positions)| {
                let points: Vec<DVec3> = positions.iter().map(wide).collect();
                for (normal, gradient) in normals.iter_mut().zip(sampler.gradients(tape, &points)) {
                    let largest = gradient.abs().max_element();
                    let exact = (gradient / largest).normalize_or_zero();
                    if exact.dot(wide(normal)) >= LEAST_COSINE {
                        *normal = exact.as_vec3().to_array();
                    }
                }
            },
        );
    }
}
