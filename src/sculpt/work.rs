//! What tools make of the values that they touch.

use glam::DVec3;
use rayon::prelude::*;

use super::{Deed, Piece, Sculpture, Tool};
use crate::hrb::{Samples, Value, join_around};

/// Samples over which the values fall from the largest to the least at the border of what was filled
/// or cut, so that the mesh is smooth there.
const RAMP: f64 = 8.0;

impl<V: Value> Sculpture<V> {
    /// Lets a tool do its deed along a piece of its way.
    pub fn apply(&mut self, tool: &Tool, piece: &Piece) {
        let samples = self.touched(tool, piece);
        if samples.is_empty() {
            return;
        }
        let values = match tool.deed {
            Deed::Twist { .. } | Deed::Drag => self.moved(tool, piece, &samples),
            _ => self.worked(tool, piece, &samples),
        };
        self.set(&samples, &values);
    }

    /// The samples that a tool may change.
    fn touched(&self, tool: &Tool, piece: &Piece) -> Samples {
        let margin = match tool.deed {
            Deed::Fill | Deed::Cut => 0.5 * RAMP,
            _ => 0.0,
        };
        let reach = tool.radius + margin;
        let first = (piece.from.min(piece.to) - reach - 0.5).floor().max(DVec3::ZERO);
        let end = (piece.from.max(piece.to) + reach + 0.5).ceil().max(DVec3::ZERO);
        let box_of = |p: DVec3| p.to_array().map(|c| c.min(f64::from(u32::MAX / 2)) as u32);
        Samples { first: box_of(first), end: box_of(end) }.and(&self.octree().samples())
    }

    /// New values where a tool works on them in their places.
    fn worked(&self, tool: &Tool, piece: &Piece, samples: &Samples) -> Vec<V> {
        let [low, high] = tool.range;
        let (isovalue, slope) = (self.isovalue(), (high - low) / RAMP);
        let ramp = |depth: f64| slope * depth * tool.radius;
        let amount = tool.strength * (high - low);
        let mut values = self.octree().values(samples);
        let means = match tool.deed {
            Deed::Smooth => self.means(samples),
            _ => Vec::new(),
        };
        let [nx, ny, _] = samples.size();
        let work = |(z, values): (usize, &mut [V])| {
            let first = [samples.first[0], samples.first[1], samples.first[2] + z as u32];
            let end = [samples.end[0], samples.end[1], first[2] + 1];
            let depths = tool.depths(piece, &Samples { first, end });
            let values = values.iter_mut().zip(depths).enumerate();
            for (i, (value, depth)) in values {
                let old = value.to_f64();
                let new = match tool.deed {
                    Deed::Fill => old.max((isovalue + ramp(depth)).clamp(low, high)),
                    Deed::Cut => old.min((isovalue - ramp(depth)).clamp(low, high)),
                    _ if depth <= 0.0 => continue,
                    Deed::Smooth => {
                        let part = (tool.strength * tool.falloff.of(depth)).min(1.0);
                        old + part * (means[nx * ny * z + i] - old)
                    }
                    Deed::Remove => old - amount * tool.falloff.of(depth),
                    _ => old + amount * tool.falloff.of(depth),
                };
                *value = V::from_f64(new.clamp(low, high));
            }
        };
        values.par_chunks_mut(nx * ny).enumerate().for_each(work);
        values
    }

    /// Of each sample the mean of the 27 around, as far as they are there.
    fn means(&self, samples: &Samples) -> Vec<f64> {
        let whole = self.octree().samples();
        let around = samples.grown(1).and(&whole);
        let mut sums: Vec<f64> =
            self.octree().values(&around).iter().map(|value| value.to_f64()).collect();
        join_around(&mut sums, around.size(), |sum, beside| *sum += beside);
        let n = |p: [u32; 3]| Samples { first: p, end: p.map(|i| i + 1) }.grown(1).and(&around).n();
        samples.iter().map(|p| sums[around.index(p)] / n(p) as f64).collect()
    }
}
