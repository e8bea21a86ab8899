//! Carving by contact: a tool is pushed along a line, and moves on only when nothing solid is left in
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
    /// The way of the hand; lengths in samples.
    pub way: Piece,
    /// How far the hand goes in a moment.
    pub step: f64,
    /// Force for each sample that the tool lags behind.
    pub stiffness: f64,
    /// Moments at most; the hand waits at the end of its way.
    pub moments: u32,
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

impl<V: Value> Sculpture<V> {
    /// Pushes a tool along its way until it is at the end and nothing solid is in it, or moments run
    /// out.
    pub fn push(&mut self, tool: &Tool, contact: &Contact) -> Vec<Moment> {
        let Contact { way, step, stiffness, moments } = *contact;
        let length = way.from.distance(way.to);
        let along = (way.to - way.from).normalize_or_zero();
        let (mut hand, mut at) = (0.0_f64, 0.0_f64);
        let mut told = Vec::new();
        for _ in 0..moments {
            hand = (hand + step).min(length);
            let place = way.from + at * along;
            self.apply(tool, &Piece { from: place, to: place });
            if !self.is_solid_in(tool, place) {
                if at >= length {
                    told.push(Moment { hand, tool: at, force: stiffness * (hand - at) });
                    break;
                }
                at = (at + step).min(hand);
            }
            told.push(Moment { hand, tool: at, force: stiffness * (hand - at) });
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
        let depths = tool.depths(&Piece { from: place, to: place }, &samples);
        let values = self.octree().values(&samples);
        values
            .iter()
            .zip(depths)
            .any(|(value, depth)| depth > 0.0 && value.to_f64() >= self.isovalue())
    }
}
