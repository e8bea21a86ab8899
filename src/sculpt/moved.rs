//! What tools have moved, sampled anew.
//!
//! Where a flow presses, values change from sample to sample by more than the grid can tell, and rims
//! would be jagged. So a sample becomes the mean of values around it, the wider the more is pressed
//! there, and they are made as steep again as they were: depths stay distances. What that takes from
//! edges the surface gets back.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::{Piece, Sculpture, Tool, work::RAMP};
use crate::hrb::{Samples, Value, copy};

/// Parts of a tool's radius that are the edge of a block, of which only the corners are followed if all
/// that comes to it is alike.
const BLOCKS: f64 = 8.0;
/// Samples along the edge of a block, at most.
const BLOCK: f64 = 8.0;
/// Samples around the places that come to corners in which what comes from between them lies.
const MARGIN: f64 = 2.0;
/// The widest edge, in samples, of the cube of which a sample is the mean.
const WINDOW: f64 = 2.5;
/// The farthest, in samples, that the surface is moved to keep the volume.
const CORRECTION: f64 = 0.5;
/// How far it is moved to see what that does.
const PROBE: f64 = 1.0 / 32.0;
/// How often a better distance is looked for.
const SECANTS: usize = 2;

/// What comes to a sample.
#[derive(Clone, Copy, Debug, Default)]
struct Moved {
    value: f64,
    /// How far it has come, in samples, up to 1.
    way: f64,
}

/// Where what comes to the corners of a voxel comes from, at x + 2y + 4z.
type Corners = [DVec3; 8];

impl<V: Value> Sculpture<V> {
    /// Moves what is there, with the surface so much farther out or in that the volume stays what it
    /// was.
    pub(super) fn carry(&mut self, tool: &Tool, piece: &Piece, samples: &Samples) {
        let moved = self.moved(tool, piece, samples);
        let before = self.volume_near(samples);
        let mut gained = |by: f64| {
            let values: Vec<V> =
                moved.iter().map(|moved| V::from_f64(moved.raised(by, tool))).collect();
            self.set(samples, &values);
            self.volume_near(samples) - before
        };
        let sample = (tool.range[1] - tool.range[0]) / RAMP;
        let (mut last, mut by) = ((0.0, gained(0.0)), -PROBE * sample);
        if last.1 == 0.0 {
            return;
        }
        // Secants; what is gained is nearly linear.
        for _ in 0..SECANTS {
            let now = (by, gained(by));
            if now.1 == last.1 {
                return;
            }
            let next = now.0 - now.1 * (now.0 - last.0) / (now.1 - last.1);
            (last, by) = (now, next.clamp(-CORRECTION * sample, CORRECTION * sample));
        }
        gained(by);
    }

    /// What comes to samples.
    fn moved(&self, tool: &Tool, piece: &Piece, samples: &Samples) -> Vec<Moved> {
        let blocks = samples.blocks((tool.radius / BLOCKS).clamp(1.0, BLOCK) as u32);
        let of_block = |block: &Samples| self.moved_to(block, tool, piece);
        let parts: Vec<Vec<Moved>> = blocks.par_iter().map(of_block).collect();
        let mut all = vec![Moved::default(); samples.n()];
        for (block, part) in blocks.iter().zip(&parts) {
            copy(part, block, &mut all, samples);
        }
        all
    }

    /// What comes to the samples of a block.
    fn moved_to(&self, block: &Samples, tool: &Tool, piece: &Piece) -> Vec<Moved> {
        let source = |p: [u32; 3]| tool.source(piece, DVec3::from_array(p.map(f64::from)));
        let ends = [block.first, block.end];
        let end = |c: usize| source([0, 1, 2].map(|axis| ends[c >> axis & 1][axis]));
        if let Some(value) = self.alike_near(&std::array::from_fn(end)) {
            return vec![Moved { value, way: 0.0 }; block.n()];
        }
        let corners = Samples { first: block.first, end: block.end.map(|i| i + 1) };
        let sources: Vec<DVec3> = corners.iter().map(source).collect();
        let of_sample = |p: [u32; 3]| {
            let corner = |c: usize| [0, 1, 2].map(|axis| p[axis] + (c >> axis & 1) as u32);
            self.moved_sample(p, &std::array::from_fn(|c| sources[corners.index(corner(c))]), tool)
        };
        block.iter().map(of_sample).collect()
    }

    /// What all samples near some places are, if they are known to be alike.
    fn alike_near(&self, places: &Corners) -> Option<f64> {
        let least = places.iter().fold(DVec3::MAX, |least, &p| least.min(p)) - MARGIN;
        let most = places.iter().fold(DVec3::MIN, |most, &p| most.max(p)) + MARGIN;
        let size = self.octree().size();
        let sample =
            |p: DVec3| [0, 1, 2].map(|axis| p[axis].clamp(0.0, f64::from(size[axis] - 1)) as u32);
        let near = Samples { first: sample(least), end: sample(most).map(|i| i + 1) };
        self.octree().alike(&near).map(V::to_f64)
    }

    /// What comes to a sample.
    fn moved_sample(&self, p: [u32; 3], corners: &Corners, tool: &Tool) -> Moved {
        let middle = DVec3::from_array(p.map(f64::from)) + 0.5;
        let way = (corners.iter().sum::<DVec3>() / 8.0).distance(middle).min(1.0);
        let is_still = (0..8).all(|c| corners[c] == middle + offset(c));
        if is_still {
            // Exactly what it was.
            return Moved { value: self.octree().region_at(p).value.to_f64(), way: 0.0 };
        }
        if let Some(value) = self.alike_near(corners) {
            return Moved { value, way };
        }
        let [low, high] = tool.range;
        let (depth, slope, matrix) = self.mean(corners);
        // The slope among the new samples.
        let pressed = (matrix.transpose() * slope).length();
        let scale = if pressed > 0.0 { slope.length() / pressed } else { 1.0 };
        Moved { value: (self.isovalue() + scale * depth).clamp(low, high), way }
    }

    /// The mean of what comes to a voxel and around it: how far it is above the isovalue, its slope where
    /// it comes from, and how places there change with those in the voxel.
    fn mean(&self, corners: &Corners) -> (f64, DVec3, DMat3) {
        let along = |axis: usize| (0..8).map(|c| 0.5 * offset(c)[axis] * corners[c]).sum::<DVec3>();
        let matrix = DMat3::from_cols(along(0), along(1), along(2));
        // 3 of a turn; more, the more is pressed.
        let squares: f64 = matrix.to_cols_array().iter().map(|m| m * m).sum();
        let window = (squares - 2.0).clamp(1.0, WINDOW);
        let n = (2.0 * window).ceil() as u32 - 1;
        let place = |i: u32| 0.5 + window * ((f64::from(i) + 0.5) / f64::from(n) - 0.5);
        let (mut depth, mut slope) = (0.0, DVec3::ZERO);
        for [x, y, z] in (Samples { first: [0; 3], end: [n; 3] }).iter() {
            let from = between(corners, [x, y, z].map(place));
            let (own, own_slope) = self.octree().value_and_slope_at(from.to_array());
            depth += own - self.isovalue();
            slope += own_slope;
        }
        (depth / f64::from(n.pow(3)), slope, matrix)
    }
}

impl Moved {
    /// With the surface farther out; what is deep inside or far outside stays, and what has not moved.
    fn raised(&self, by: f64, tool: &Tool) -> f64 {
        let [low, high] = tool.range;
        let part = (self.value - low) / (high - low);
        (self.value + by * self.way * 4.0 * part * (1.0 - part)).clamp(low, high)
    }
}

/// From the middle of a voxel to a corner.
fn offset(c: usize) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|axis| (c >> axis & 1) as f64 - 0.5))
}

/// What is linear along each axis between the corners of a voxel, and beyond.
fn between(corners: &Corners, [x, y, z]: [f64; 3]) -> DVec3 {
    let blend = |a: DVec3, b: DVec3, part: f64| a + part * (b - a);
    let [a, b, c, d] = [0, 2, 4, 6].map(|c| blend(corners[c], corners[c + 1], x));
    blend(blend(a, b, y), blend(c, d, y), z)
}
