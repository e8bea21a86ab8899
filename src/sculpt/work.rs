//! What tools make of the values that they touch.

use glam::DVec3;
use rayon::prelude::*;

use super::{Deed, Piece, Sculpture, Tool};
use crate::hrb::{Samples, Value, join_around};

/// Samples over which the values fall from the largest to the least, as depths do, at the border of what
/// was filled or cut, so that the mesh is smooth there.
pub(super) const RAMP: f64 = 8.0;

/// Halvings that find an amount more closely than values are kept.
const HALVINGS: usize = 30;

impl<V: Value> Sculpture<V> {
    /// Lets a tool do its deed along a piece of its way.
    pub fn apply(&mut self, tool: &Tool, piece: &Piece) {
        let samples = self.touched(tool, piece);
        if samples.is_empty() {
            return;
        }
        let values = match tool.deed {
            Deed::Twist { .. } | Deed::Drag | Deed::Bend { .. } => {
                return self.carry(tool, piece, &samples);
            }
            Deed::Inflate => self.inflated(tool, piece, &samples),
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
        // A bend stays where it begins.
        let to = if matches!(tool.deed, Deed::Bend { .. }) { piece.from } else { piece.to };
        let first = (piece.from.min(to) - reach - 0.5).floor().max(DVec3::ZERO);
        let end = (piece.from.max(to) + reach + 0.5).ceil().max(DVec3::ZERO);
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
            let field = |depth: f64| amount * tool.falloff.of(depth);
            match tool.deed {
                Deed::Fill => each(values, &depths, |_, old, depth| {
                    old.max((isovalue + ramp(depth)).clamp(low, high)).clamp(low, high)
                }),
                Deed::Cut => each(values, &depths, |_, old, depth| {
                    old.min((isovalue - ramp(depth)).clamp(low, high)).clamp(low, high)
                }),
                _ => each_inside(values, &depths, |i, old, depth| {
                    let new = match tool.deed {
                        Deed::Smooth => {
                            let part = (tool.strength * tool.falloff.of(depth)).min(1.0);
                            old + part * (means[nx * ny * z + i] - old)
                        }
                        Deed::Remove => old - field(depth),
                        _ => old + field(depth),
                    };
                    new.clamp(low, high)
                }),
            }
        };
        values.par_chunks_mut(nx * ny).enumerate().for_each(work);
        values
    }

    /// New values where a tool inflates: as much is taken around as keeps the volume.
    fn inflated(&self, tool: &Tool, piece: &Piece, samples: &Samples) -> Vec<V> {
        let [low, high] = tool.range;
        let (isovalue, slope) = (self.isovalue(), (high - low) / RAMP);
        let old = self.octree().values(samples);
        // What each sample wins and what it may lose.
        let fields = |depth: f64| {
            let t = 2.0 * depth.clamp(0.0, 0.5);
            let ring = 4.0 * t * (1.0 - t);
            (tool.falloff.of(2.0 * depth - 1.0), ring * ring)
        };
        let touched: Vec<(usize, f64, (f64, f64))> = tool
            .depths(piece, samples)
            .into_iter()
            .enumerate()
            .filter(|&(_, depth)| depth > 0.0)
            .map(|(i, depth)| (i, old[i].to_f64(), fields(depth)))
            .collect();
        let new = |won: f64, lost: f64, (value, (inner, outer)): (f64, (f64, f64))| {
            (value + won * inner - lost * outer).clamp(low, high)
        };
        // In samples, of which those at the surface count in part.
        let volume = |won: f64, lost: f64| -> f64 {
            let part = |value: f64| ((value - isovalue) / slope + 0.5).clamp(0.0, 1.0);
            touched.iter().map(|&(_, value, fields)| part(new(won, lost, (value, fields)))).sum()
        };
        let before = volume(0.0, 0.0);
        let amount = tool.strength * (high - low);
        // If too little can be taken, less is added.
        let is_too_much = |won: f64, lost: f64| volume(won, lost) > before;
        let won = match is_too_much(amount, amount) {
            true => most(amount, |won| !is_too_much(won, amount)),
            false => amount,
        };
        let lost = most(amount, |lost| is_too_much(won, lost));
        let mut values = old;
        for &(i, value, fields) in &touched {
            values[i] = V::from_f64(new(won, lost, (value, fields)));
        }
        values
    }

    /// Of each sample the mean of the 27 around, as far as they are there.
    fn means(&self, samples: &Samples) -> Vec<f64> {
        let whole = self.octree().samples();
        let around = samples.grown(1).and(&whole);
        let mut sums: Vec<f64> =
            self.octree().values(&around).iter().map(|value| value.to_f64()).collect();
        join_around(&mut sums, around.size(), |sum, beside| *sum += beside);
        // How many there are along an axis.
        let n = |axis: usize, i: u32| 1 + i.min(1) + (whole.end[axis] - 1 - i).min(1);
        let mut means = Vec::with_capacity(samples.n());
        for row in samples.rows() {
            let [x, y, z] = row;
            let sums = &sums[around.index(row)..];
            let of_row = n(1, y) * n(2, z);
            let mean = |(x, sum): (u32, &f64)| sum / f64::from(n(0, x) * of_row);
            means.extend((x..samples.end[0]).zip(sums).map(mean));
        }
        means
    }
}

/// Gives every value another, by its number, itself and how deep it is in a tool.
#[inline]
fn each<V: Value>(values: &mut [V], depths: &[f64], new: impl Fn(usize, f64, f64) -> f64) {
    for (i, (value, &depth)) in values.iter_mut().zip(depths).enumerate() {
        *value = V::from_f64(new(i, value.to_f64(), depth));
    }
}

/// The same for those that are in the tool.
#[inline]
fn each_inside<V: Value>(values: &mut [V], depths: &[f64], new: impl Fn(usize, f64, f64) -> f64) {
    for (i, (value, &depth)) in values.iter_mut().zip(depths).enumerate() {
        if depth > 0.0 {
            *value = V::from_f64(new(i, value.to_f64(), depth));
        }
    }
}

/// The most, up to a bound, of which something is true that is true of less.
fn most(bound: f64, is: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, bound);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if is(middle) { low = middle } else { high = middle }
    }
    low
}
