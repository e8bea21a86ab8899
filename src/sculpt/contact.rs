//! Carving by contact: a tool is pushed along its way, and moves on only when nothing solid is left in
//! it. How far it lags behind the hand that pushes it is felt as a force.
//!
//! *Based on:* A. León Salas, 2008, section 4.2.1 (no active cell may remain in the voxels inside the
//! tool; the force by Hooke's law).

use glam::DVec3;

use super::{Piece, Sculpture, Tool};
use crate::hrb::{Samples, Value};

/// How a tool is pushed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// How far the hand goes in a moment, in samples.
    pub step: f64,
    /// Force for each sample that the tool lags behind.
    pub stiffness: f64,
    /// Moments at most; the hand waits at the end of its way.
    pub moments: usize,
}

/// What happened in a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// How far the hand is on its way, in samples.
    pub hand: f64,
    /// How far the tool is.
    pub tool: f64,
    /// The force that the hand feels.
    pub force: f64,
}

impl Contact {
    /// Moments in which the hand gets to the end of its way.
    #[must_use]
    pub fn n(&self, way: &[Piece]) -> usize {
        (length(way) / self.step).ceil() as usize
    }
}

impl<V: Value> Sculpture<V> {
    /// Pushes a tool along its way until it is at the end and nothing solid is in it, or moments run
    /// out.
    pub fn push(&mut self, tool: &Tool, way: &[Piece], contact: &Contact) -> Vec<Moment> {
        let Contact { step, stiffness, moments } = *contact;
        let length = length(way);
        let (mut hand, mut at) = (0.0_f64, 0.0_f64);
        let mut told = Vec::new();
        for _ in 0..moments {
            hand = (hand + step).min(length);
            let place = place(way, at);
            self.apply(tool, &Piece { from: place, to: place });
            let is_free = !self.is_solid_in(tool, place);
            let is_done = is_free && at >= length;
            if is_free {
                at = (at + step).min(hand);
            }
            told.push(Moment { hand, tool: at, force: stiffness * (hand - at) });
            if is_done {
                break;
            }
        }
        told
    }

    /// Whether a sample in the tool is solid.
    fn is_solid_in(&self, tool: &Tool, place: DVec3) -> bool {
        let whole = self.octree().samples();
        let corner = |p: DVec3| p.max(DVec3::ZERO).to_array().map(|c| c as u32);
        let samples = Samples {
            first: corner((place - tool.radius).floor()),
            end: corner((place + tool.radius).ceil() + 1.0),
        }
        .and(&whole);
        if samples.is_empty() {
            return false;
        }
        let depths = tool.depths(&Piece { from: place, to: place }, &samples);
        let values = self.octree().values(&samples);
        values
            .iter()
            .zip(depths)
            .any(|(value, depth)| depth > 0.0 && value.to_f64() >= self.isovalue())
    }
}

fn length(way: &[Piece]) -> f64 {
    way.iter().map(|piece| piece.from.distance(piece.to)).sum()
}

/// The place so far from the beginning of a way, or its end.
fn place(way: &[Piece], mut far: f64) -> DVec3 {
    for piece in way {
        let length = piece.from.distance(piece.to);
        if far < length {
            return piece.from + far / length * (piece.to - piece.from);
        }
        far -= length;
    }
    way.last().map_or(DVec3::ZERO, |piece| piece.to)
}
