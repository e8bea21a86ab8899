//! Tools that move what is there.
//!
//! *Based on:* W. von Funck, H. Theisel, H.-P. Seidel, "Vector Field Based Shape Deformations",
//! SIGGRAPH 2006 (flows without sources keep the volume).

use glam::{DQuat, DVec3};
use rayon::prelude::*;

use super::{Deed, Piece, Sculpture, Tool, tool::at_middles};
use crate::hrb::{Samples, Value};

/// Steps in which a drag follows its flow, for each radius of its way.
const DRAG_STEPS: f64 = 32.0;
/// Steps in which a bend does, for each radian.
const BEND_STEPS: f64 = 32.0;

impl<V: Value> Sculpture<V> {
    /// New values where a tool moves what is there.
    pub(super) fn moved(&self, tool: &Tool, piece: &Piece, samples: &Samples) -> Vec<V> {
        let source = |p: DVec3| match tool.deed {
            Deed::Twist { axis, angle } => {
                let from_middle = p - piece.to;
                let depth = 1.0 - from_middle.length() / tool.radius;
                let turn = -angle * tool.falloff.of(depth);
                let (sin, cos) = (libm::sin(0.5 * turn), libm::cos(0.5 * turn));
                let turn = DQuat::from_vec4((axis * sin).extend(cos));
                if depth > 0.0 { piece.to + turn * from_middle } else { p }
            }
            Deed::Bend { axis, angle } => piece.unbent(p, tool.radius, axis, angle),
            _ => piece.upstream(p, tool.radius),
        };
        let value = |p: DVec3| {
            let from = source(p);
            // What does not move keeps its value exactly.
            match from == p {
                true => self.octree().region_at(p.to_array().map(|c| c as u32)).value,
                false => V::from_f64(self.octree().value_at(from.to_array())),
            }
        };
        at_middles(samples, |p| p).into_par_iter().map(value).collect()
    }
}

/// A function of places, and its gradient.
type Field = (f64, DVec3);

/// The product of the gradients of f p and f q: a flow without sources that is that of p and q where f
/// is 1, and nothing where it is 0.
fn flow((f, slope): Field, (p, p_slope): Field, (q, q_slope): Field) -> DVec3 {
    (f * p_slope + p * slope).cross(f * q_slope + q * slope)
}

/// Where what a flow brings to a place in so many steps comes from; the flow is asked for places and
/// times back from the end, in steps.
fn upstream(place: DVec3, n: u32, step: f64, flow: impl Fn(DVec3, f64) -> DVec3) -> DVec3 {
    let mut at = place;
    for i in 0..n {
        let time = f64::from(i);
        let a = flow(at, time);
        let b = flow(at - 0.5 * step * a, time + 0.5);
        let c = flow(at - 0.5 * step * b, time + 0.5);
        let d = flow(at - step * c, time + 1.0);
        at -= step / 6.0 * (a + 2.0 * (b + c) + d);
    }
    at
}

impl Piece {
    /// Where what flows to a point comes from, as a ball is dragged along the piece.
    fn upstream(&self, point: DVec3, radius: f64) -> DVec3 {
        let way = self.to - self.from;
        let length = way.length();
        if length == 0.0 {
            return point;
        }
        let n = (DRAG_STEPS * length / radius).ceil().max(1.0);
        let along = way / length;
        let (u, w) = along.any_orthonormal_pair();
        let step = length / n;
        upstream(point, n as u32, step, |at, time| {
            // Seen from the ball's middle.
            let from_middle = at - (self.to - along * (time * step));
            let d = from_middle.length() / radius;
            if d >= 1.0 {
                return DVec3::ZERO;
            }
            let f = (1.0 - d * d) * (1.0 - d * d);
            let slope = -4.0 * (1.0 - d * d) / (radius * radius) * from_middle;
            flow((f, slope), (from_middle.dot(u), u), (from_middle.dot(w), w))
        })
    }

    /// Where what is bent to a point comes from: about the piece's beginning, with the arm towards its
    /// end.
    fn unbent(&self, point: DVec3, radius: f64, axis: DVec3, angle: f64) -> DVec3 {
        let arm = (self.to - self.from).normalize_or_zero();
        let axis = (axis - axis.dot(arm) * arm).normalize_or_zero();
        let n = (BEND_STEPS * angle.abs()).ceil().max(1.0);
        let from_hinge = point - self.from;
        if from_hinge.length() >= radius {
            return point;
        }
        let from = upstream(from_hinge, n as u32, angle / n, |at, _| {
            let d = at.length() / radius;
            // All of the arm up to half the radius turns.
            let (inside, inside_slope) = rise(2.0 - 2.0 * d);
            let (turned, turned_slope) = rise(0.5 + 2.0 * at.dot(arm) / radius);
            let of_ball = if d > 0.0 {
                -2.0 * inside_slope / (radius * radius * d) * at
            } else {
                DVec3::ZERO
            };
            let of_arm = 2.0 * turned_slope / radius * arm;
            let f = (inside * turned, turned * of_ball + inside * of_arm);
            // A turn is the product of the gradients of these two.
            let across = at - at.dot(axis) * axis;
            flow(f, (at.dot(axis), axis), (0.5 * across.length_squared(), across))
        });
        // What does not move is where it was exactly.
        if from == from_hinge { point } else { self.from + from }
    }
}

/// From 0 at 0 to 1 at 1 and level beyond, with two derivatives everywhere; and the first.
fn rise(t: f64) -> (f64, f64) {
    let t = t.clamp(0.0, 1.0);
    let left = t * (1.0 - t);
    (t * t * t * (10.0 - 15.0 * t + 6.0 * t * t), 30.0 * left * left)
}
