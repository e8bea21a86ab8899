//! Tools: what they are like, and what they make of the values that they touch.
//!
//! *Based on:* A. León Salas, 2008, section 4.1 (a tool is an implicit volume with a field that is
//! largest in its middle and falls to nothing at its border); W. von Funck, H. Theisel, H.-P. Seidel,
//! "Vector Field Based Shape Deformations", SIGGRAPH 2006 (flows without sources keep the volume).

use glam::{DQuat, DVec3};
use rayon::prelude::*;

use super::{Piece, Sculpture};
use crate::{
    eval::sampler,
    expr::Tape,
    hrb::{Samples, Value},
    math::SimdLevel,
};

/// The solid that a tool is.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A ball.
    Ball,
    /// A cube along the axes, with the radius for half its edge.
    Cube,
    /// What is inside F < 0, with F of places in radii from the tool's middle; its field is −F, at
    /// most 1.
    Formula(Box<Tape>),
}

/// How the field of a tool grows from its border, where it is 0, to its middle, where it is 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Falloff {
    /// Evenly, as in the thesis.
    #[default]
    Linear,
    /// With a gradient that is 0 at both ends: (1 − d²)², with d from 0 in the middle to 1.
    Smooth,
    /// 1 everywhere inside.
    Hard,
}

/// What a tool does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Deed {
    /// Adds its field to the values.
    Add,
    /// Takes its field from the values.
    Remove,
    /// Makes solid what is in the tool.
    Fill,
    /// Empties what is in the tool.
    Cut,
    /// Draws values towards the mean of the 27 around.
    Smooth,
    /// Turns what is in a ball about an axis through its middle, by this many radians in the middle.
    /// Every shell of the ball turns as a whole: no volume is lost.
    Twist {
        /// Of length 1.
        axis: DVec3,
        /// In radians.
        angle: f64,
    },
    /// Drags what is in a ball along its way, by a flow without sources: no volume is lost.
    Drag,
}

/// A tool, with lengths in samples.
#[derive(Clone, Debug)]
pub struct Tool {
    /// What it is.
    pub shape: Shape,
    /// What it does.
    pub deed: Deed,
    /// From its middle to its border.
    pub radius: f64,
    /// The most that it adds or takes, in parts of the range of values; how far it smooths.
    pub strength: f64,
    /// How its field falls off.
    pub falloff: Falloff,
    /// The least and the largest value.
    pub range: [f64; 2],
}

/// Samples over which the values fall from the largest to the least at the border of what was filled
/// or cut, so that the mesh is smooth there.
const RAMP: f64 = 8.0;

/// Steps in which a drag follows its flow, for each radius.
const FLOW_STEPS: f64 = 32.0;

impl Falloff {
    fn of(self, depth: f64) -> f64 {
        let depth = depth.clamp(0.0, 1.0);
        let d = 1.0 - depth;
        match self {
            Self::Linear => depth,
            Self::Smooth => (1.0 - d * d) * (1.0 - d * d),
            Self::Hard => f64::from(u8::from(depth > 0.0)),
        }
    }
}

impl<V: Value> Sculpture<V> {
    /// Lets a tool do its deed along a piece of its way.
    pub fn apply(&mut self, tool: &Tool, piece: &Piece) {
        let samples = self.touched(tool, piece);
        if samples.is_empty() {
            return;
        }
        let points: Vec<DVec3> =
            samples.iter().map(|p| DVec3::from_array(p.map(f64::from)) + 0.5).collect();
        let values = match tool.deed {
            Deed::Twist { .. } | Deed::Drag => self.moved(tool, piece, &points),
            _ => self.worked(tool, piece, &samples, &points),
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
    fn worked(&self, tool: &Tool, piece: &Piece, samples: &Samples, points: &[DVec3]) -> Vec<V> {
        let [low, high] = tool.range;
        let slope = (high - low) / RAMP;
        let depths = tool.depths(piece, points);
        let old = self.octree().values(samples);
        let around = samples.grown(1).and(&self.octree().samples());
        let beside = match tool.deed {
            Deed::Smooth => self.octree().values(&around),
            _ => Vec::new(),
        };
        let amount = tool.strength * (high - low);
        let value = |(i, p): (usize, [u32; 3])| {
            let (value, depth) = (old[i].to_f64(), depths[i]);
            let ramp = slope * depth * tool.radius;
            let new = match tool.deed {
                Deed::Fill => value.max((self.isovalue() + ramp).clamp(low, high)),
                Deed::Cut => value.min((self.isovalue() - ramp).clamp(low, high)),
                _ if depth <= 0.0 => return old[i],
                Deed::Add => value + amount * tool.falloff.of(depth),
                Deed::Remove => value - amount * tool.falloff.of(depth),
                _ => {
                    let near = Samples { first: p, end: p.map(|i| i + 1) }.grown(1).and(&around);
                    let sum: f64 = near.iter().map(|p| beside[around.index(p)].to_f64()).sum();
                    let part = (tool.strength * tool.falloff.of(depth)).min(1.0);
                    value + part * (sum / near.n() as f64 - value)
                }
            };
            V::from_f64(new.clamp(low, high))
        };
        samples.iter().enumerate().map(value).collect()
    }

    /// New values where a tool moves what is there.
    fn moved(&self, tool: &Tool, piece: &Piece, points: &[DVec3]) -> Vec<V> {
        let source = |&p: &DVec3| match tool.deed {
            Deed::Twist { axis, angle } => {
                let from_middle = p - piece.to;
                let depth = 1.0 - from_middle.length() / tool.radius;
                let turn = -angle * tool.falloff.of(depth);
                let (sin, cos) = (libm::sin(0.5 * turn), libm::cos(0.5 * turn));
                let turn = DQuat::from_vec4((axis * sin).extend(cos));
                if depth > 0.0 { piece.to + turn * from_middle } else { p }
            }
            _ => piece.upstream(p, tool.radius),
        };
        let value = |p: &DVec3| {
            let from = source(p);
            // What does not move keeps its value exactly.
            match from == *p {
                true => self.octree().region_at(p.to_array().map(|c| c as u32)).value,
                false => V::from_f64(self.octree().value_at(from.to_array())),
            }
        };
        points.par_iter().map(value).collect()
    }
}

impl Tool {
    /// How deep points are in the tool: 0 at its border, 1 in its middle.
    pub(super) fn depths(&self, piece: &Piece, points: &[DVec3]) -> Vec<f64> {
        let places = points.iter().map(|&p| (p - piece.nearest(p)) / self.radius);
        match &self.shape {
            Shape::Ball => places.map(|q| 1.0 - q.length()).collect(),
            Shape::Cube => places.map(|q| 1.0 - q.abs().max_element()).collect(),
            Shape::Formula(tape) => {
                let values = sampler(SimdLevel::detect()).values(tape, &places.collect::<Vec<_>>());
                // What is undefined is outside.
                values.into_iter().map(|f| if f.is_nan() { f64::MIN } else { -f }).collect()
            }
        }
    }
}

impl Piece {
    /// Where what flows to a point comes from, as a ball is dragged along the piece.
    fn upstream(&self, point: DVec3, radius: f64) -> DVec3 {
        let way = self.to - self.from;
        let length = way.length();
        if length == 0.0 {
            return point;
        }
        let n = (FLOW_STEPS * length / radius).ceil().max(1.0);
        let along = way / length;
        let (u, w) = along.any_orthonormal_pair();
        // Seen from the ball's middle, F = f² along + f f' (p r × w + q u × r), the product of the
        // gradients of f p and f q: without sources, 1 in the middle and 0 outside.
        let flow = |at: DVec3, middle: DVec3| {
            let from_middle = at - middle;
            let d = from_middle.length() / radius;
            if d >= 1.0 {
                return DVec3::ZERO;
            }
            let f = (1.0 - d * d) * (1.0 - d * d);
            // f' r / |r|, by the chain rule.
            let slope = -4.0 * (1.0 - d * d) / (radius * radius) * from_middle;
            (f * u + from_middle.dot(u) * slope).cross(f * w + from_middle.dot(w) * slope)
        };
        let step = length / n;
        let mut at = point;
        for i in 0..n as u32 {
            let done = f64::from(i) * step;
            let middle = |back: f64| self.to - along * (done + back * step);
            let a = flow(at, middle(0.0));
            let b = flow(at - 0.5 * step * a, middle(0.5));
            let c = flow(at - 0.5 * step * b, middle(0.5));
            let d = flow(at - step * c, middle(1.0));
            at -= step / 6.0 * (a + 2.0 * (b + c) + d);
        }
        at
    }
}
