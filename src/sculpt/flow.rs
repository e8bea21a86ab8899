//! Flows of tools that move what is there: where what comes to a place comes from.
//!
//! *Based on:* W. von Funck, H. Theisel, H.-P. Seidel, "Vector Field Based Shape Deformations",
//! SIGGRAPH 2006 (flows without sources keep the volume).

use glam::{DQuat, DVec3};

use super::{Deed, Piece, Tool};

/// Steps in which a drag follows its flow, for each radius of its way.
const DRAG_STEPS: f64 = 16.0;
/// Steps in which a bend does, for each radian.
const BEND_STEPS: f64 = 12.0;

impl Tool {
    /// Where what the tool moves to a place comes from; what does not move comes from there exactly.
    pub(super) fn source(&self, piece: &Piece, place: DVec3) -> DVec3 {
        match self.deed {
            Deed::Twist { axis, angle } => self.untwisted(piece.to, place, axis, angle),
            Deed::Bend { axis, angle } => piece.unbent(place, self.radius, axis, angle),
            Deed::Drag => piece.undragged(place, self.radius),
            _ => place,
        }
    }

    /// Back about an axis through the middle, by the angle of the shell that the place is in.
    fn untwisted(&self, middle: DVec3, place: DVec3, axis: DVec3, angle: f64) -> DVec3 {
        let from_middle = place - middle;
        let depth = 1.0 - from_middle.length() / self.radius;
        if depth <= 0.0 {
            return place;
        }
        let half = -0.5 * angle * self.falloff.of(depth);
        let turn = DQuat::from_vec4((axis * libm::sin(half)).extend(libm::cos(half)));
        middle + turn * from_middle
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
    /// Against the flow of a ball that is dragged along the piece.
    fn undragged(&self, point: DVec3, radius: f64) -> DVec3 {
        let way = self.to - self.from;
        let length = way.length();
        if length == 0.0 || self.nearest(point).distance(point) >= radius {
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

    /// Against the flow of a bend about the piece's beginning, with the arm towards its end.
    fn unbent(&self, point: DVec3, radius: f64, axis: DVec3, angle: f64) -> DVec3 {
        let arm = (self.to - self.from).normalize_or_zero();
        let axis = (axis - axis.dot(arm) * arm).normalize_or_zero();
        let n = (BEND_STEPS * angle.abs()).ceil().max(1.0);
        let from_hinge = point - self.from;
        if from_hinge.length() >= radius {
            return point;
        }
        let step = angle / n;
        let from = upstream(from_hinge, n as u32, step, |at, time| {
            // Half way between what stays and the arm, wherever it is by then.
            let half = 0.5 * (angle - time * step);
            let ahead = libm::cos(half) * arm + libm::sin(half) * axis.cross(arm);
            bend(at, ahead, axis, radius)
        });
        // What does not move is where it was exactly.
        if from == from_hinge { point } else { self.from + from }
    }
}

/// The flow, for each radian, that turns what lies ahead of a hinge about its axis, up to half the radius
/// wholly. Between what stays and what turns it is that of a beam: each section across turns as a whole,
/// and its middle follows those before it.
fn bend(at: DVec3, ahead: DVec3, axis: DVec3, radius: f64) -> DVec3 {
    let side = axis.cross(ahead);
    let (x, y, width) = (at.dot(ahead), at.dot(side), 0.5 * radius);
    let turn = Rise::at(0.5 + x / width);
    let stream = 0.5 * y * y * turn.value + width * width * turn.second_sum;
    let slope =
        (0.5 * y * y * turn.slope / width + width * turn.sum) * ahead + y * turn.value * side;
    // What flows along the levels of a function across an axis has no source.
    let far = at.length();
    let inside = Rise::at(2.0 - 2.0 * far / radius);
    let outwards = if far > 0.0 { -2.0 * inside.slope / (radius * far) * at } else { DVec3::ZERO };
    axis.cross(inside.value * slope + stream * outwards)
}

/// A function from 0 at 0 to 1 at 1 and level beyond, with two derivatives everywhere.
struct Rise {
    value: f64,
    slope: f64,
    /// Its integral from 0.
    sum: f64,
    /// The integral of that.
    second_sum: f64,
}

impl Rise {
    fn at(t: f64) -> Self {
        let beyond = (t - 1.0).max(0.0);
        let t = t.clamp(0.0, 1.0);
        let (left, cube) = (t * (1.0 - t), t * t * t);
        Self {
            value: cube * (10.0 - 15.0 * t + 6.0 * t * t),
            slope: 30.0 * left * left,
            sum: cube * t * (2.5 - 3.0 * t + t * t) + beyond,
            second_sum: cube * t * t * (0.5 - 0.5 * t + t * t / 7.0)
                + 0.5 * beyond * (1.0 + beyond),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DMat3;

    use super::*;
    use crate::sculpt::{Falloff, Shape};

    /// By how much a place grows on its way, from differences of where things come from.
    fn growth(tool: &Tool, piece: &Piece, place: DVec3) -> f64 {
        const STEP: f64 = 1e-4;
        let along = |axis: DVec3| {
            let ends = [place + STEP * axis, place - STEP * axis];
            let [a, b] = ends.map(|p| tool.source(piece, p));
            (a - b) / (2.0 * STEP)
        };
        1.0 / DMat3::from_cols(along(DVec3::X), along(DVec3::Y), along(DVec3::Z)).determinant()
    }

    /// Nothing grows or shrinks, and what lies beyond the tool stays exactly.
    #[test]
    fn flows_have_no_sources() {
        let axis = DVec3::new(0.36, 0.48, 0.8);
        let piece = Piece { from: DVec3::new(1.0, 2.0, 3.0), to: DVec3::new(6.0, 1.0, 2.0) };
        let deeds = [Deed::Twist { axis, angle: 2.0 }, Deed::Bend { axis, angle: 1.5 }, Deed::Drag];
        for deed in deeds {
            let tool = Tool {
                shape: Shape::Ball,
                deed,
                radius: 10.0,
                strength: 1.0,
                falloff: Falloff::Smooth,
                range: [-4.0, 4.0],
            };
            let mut moved = 0;
            for i in 0..1000 {
                let at = |k: i32| f64::from(i / k % 10) * 2.7 - 10.0;
                let place = DVec3::new(at(1), at(10), at(100));
                let growth = growth(&tool, &piece, place);
                assert!((growth - 1.0).abs() < 1e-3, "{deed:?} at {place}: {growth}");
                let is_beyond = piece.nearest(place).distance(place) >= tool.radius;
                let is_moved = tool.source(&piece, place) != place;
                assert!(!(is_beyond && is_moved), "{deed:?} at {place}");
                moved += usize::from(is_moved);
            }
            assert!(moved > 50, "{deed:?} moves {moved}");
        }
    }
}
