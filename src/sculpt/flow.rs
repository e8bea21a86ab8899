//! Tools that move what is there.
//!
//! *Based on:* W. von Funck, H. Theisel, H.-P. Seidel, "Vector Field Based Shape Deformations",
//! SIGGRAPH 2006 (flows without sources keep the volume).

use glam::{DQuat, DVec3};
use rayon::prelude::*;

use super::{Deed, Piece, Sculpture, Tool, tool::at_middles};
use crate::hrb::{Samples, Value};

/// Steps in which a drag follows its flow, for each radius.
const FLOW_STEPS: f64 = 32.0;

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
