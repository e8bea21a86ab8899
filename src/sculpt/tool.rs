//! Tools: what they are like, and what they make of the values that they touch.
//!
//! *Based on:* A. León Salas, 2008, section 4.1 (a tool is an implicit volume with a field that is
//! largest in its middle and falls to nothing at its border).

use glam::DVec3;

use super::Piece;
use crate::{eval::sampler, expr::Tape, hrb::Samples, math::SimdLevel};

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
    /// Bends what is in a ball about the beginning of its way: what lies towards its end turns about an
    /// axis by this many radians. No volume is lost.
    Bend {
        /// Of length 1; what it has along the way does not count.
        axis: DVec3,
        /// In radians.
        angle: f64,
    },
    /// Adds its field in the inner half of its depth, and takes from the surface in the outer half what
    /// has come in: no volume is won.
    Inflate,
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

impl Falloff {
    pub(super) fn of(self, depth: f64) -> f64 {
        let depth = depth.clamp(0.0, 1.0);
        let d = 1.0 - depth;
        match self {
            Self::Linear => depth,
            Self::Smooth => (1.0 - d * d) * (1.0 - d * d),
            Self::Hard => f64::from(u8::from(depth > 0.0)),
        }
    }
}

impl Tool {
    /// How deep the middles of samples are in the tool: 0 at its border, 1 in its middle.
    pub(super) fn depths(&self, piece: &Piece, samples: &Samples) -> Vec<f64> {
        match &self.shape {
            Shape::Ball => self.at_places(piece, samples, |q| 1.0 - q.length_squared().sqrt()),
            Shape::Cube => self.at_places(piece, samples, |q| 1.0 - q.abs().max_element()),
            Shape::Formula(tape) => {
                let places = self.at_places(piece, samples, |q| q);
                let values = sampler(SimdLevel::detect()).values(tape, &places);
                // What is undefined is outside.
                values.into_iter().map(|f| if f.is_nan() { f64::MIN } else { -f }).collect()
            }
        }
    }

    /// Something of the places of samples, from the tool's middle in its radii, as the tool passes by.
    #[inline]
    fn at_places<T: Copy + Default>(
        &self,
        piece: &Piece,
        samples: &Samples,
        of: impl Fn(DVec3) -> T,
    ) -> Vec<T> {
        match piece.from == piece.to {
            // One place for all is quicker.
            true => at_middles(samples, |p| of((p - piece.from) / self.radius)),
            false => at_middles(samples, |p| of((p - piece.nearest(p)) / self.radius)),
        }
    }
}

/// Something of the middles of samples, x fastest.
#[inline]
pub(super) fn at_middles<T: Copy + Default>(samples: &Samples, of: impl Fn(DVec3) -> T) -> Vec<T> {
    let mut all = vec![T::default(); samples.n()];
    for (first, row) in samples.rows().zip(all.chunks_exact_mut(samples.size()[0])) {
        let first = DVec3::from_array(first.map(f64::from)) + 0.5;
        for (i, one) in (0..).zip(row) {
            *one = of(DVec3::new(first.x + f64::from(i), first.y, first.z));
        }
    }
    all
}
