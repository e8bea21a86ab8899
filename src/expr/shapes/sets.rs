//! Union, intersection and difference, sharp or rounded, and what grows from one shape.
//!
//! A rounded union of a, b, … is max(r, m) − √(Σ max(r − aᵢ, 0)²), m the least of them: where two
//! faces meet at a right angle it is a fillet of radius r. It has a gradient everywhere near the
//! surface, and is the sharp union wherever all but one of the shapes are r away. An intersection is
//! the complement of the union of complements.
//!
//! *Based on:* Mercury, "hg_sdf" (fOpUnionRound), here for any number of shapes.

use super::{Build, Complaint, Solid, abs, exact, folded, max};
use crate::{
    expr::{
        graph::{Graph, Id},
        names::length,
    },
    math::{Binary, Unary},
};

/// A length is measured in something that is none.
const NO_LENGTH: &str = "the values of this shape are no lengths";

pub(super) fn union(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let solids = b.solids(0).to_vec();
    joined(b, &solids)
}

pub(super) fn intersection(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let solids = b.solids(0).to_vec();
    let outsides = solids.into_iter().map(|solid| turned(b.g, solid)).collect::<Vec<_>>();
    let outside = joined(b, &outsides)?;
    Ok(turned(b.g, outside))
}

/// The first shape without the others.
pub(super) fn difference(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let mut solids = b.solids(0).to_vec();
    solids[0] = turned(b.g, solids[0]);
    let outside = joined(b, &solids)?;
    Ok(turned(b.g, outside))
}

pub(super) fn complement(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let solid = b.solid(0);
    Ok(turned(b.g, solid))
}

/// `a | b`
pub(in crate::expr) fn either(g: &mut Graph, a: Solid, b: Solid) -> Solid {
    combined(g, &[a, b], |g, parts| folded(g, Binary::Min, parts))
}

/// `a & b`
pub(in crate::expr) fn both(g: &mut Graph, a: Solid, b: Solid) -> Solid {
    combined(g, &[a, b], |g, parts| folded(g, Binary::Max, parts))
}

/// `a - b`
pub(in crate::expr) fn without(g: &mut Graph, a: Solid, b: Solid) -> Solid {
    let outside = turned(g, b);
    both(g, a, outside)
}

/// Inside and outside change places.
fn turned(g: &mut Graph, solid: Solid) -> Solid {
    solid.map(|field| g.unary(Unary::Neg, field))
}

/// The same done to the surfaces of several solids and to their distances.
pub(super) fn combined(
    g: &mut Graph,
    solids: &[Solid],
    f: impl Fn(&mut Graph, &[Id]) -> Id,
) -> Solid {
    let surfaces: Vec<Id> = solids.iter().map(|solid| solid.surface).collect();
    let distances: Vec<Id> = solids.iter().map(|solid| solid.distance).collect();
    let is_metric = solids.iter().all(|solid| solid.is_metric);
    Solid { surface: f(g, &surfaces), distance: f(g, &distances), is_metric }
}

fn joined(b: &mut Build<'_>, solids: &[Solid]) -> Result<Solid, Complaint> {
    let r = b.rounding(1, None)?;
    if r.value == 0.0 {
        return Ok(combined(b.g, solids, |g, parts| folded(g, Binary::Min, parts)));
    }
    if solids.iter().any(|solid| !solid.is_metric) {
        b.warning = Some(NO_LENGTH);
    }
    Ok(combined(b.g, solids, |g, parts| rounded(g, parts, r.id)))
}

fn rounded(g: &mut Graph, parts: &[Id], r: Id) -> Id {
    let zero = exact(g, 0.0);
    let reach = |g: &mut Graph, part: Id| {
        let reach = g.sub(r, part);
        max(g, reach, zero)
    };
    let reaches: Vec<Id> = parts.iter().map(|&part| reach(g, part)).collect();
    let least = folded(g, Binary::Min, parts);
    let (outside, inside) = (max(g, least, r), length(&reaches, g));
    g.sub(outside, inside)
}

/// What is nearer to the shape than `distance`, or deeper inside if that is negative.
pub(super) fn offset(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let (solid, distance) = (measured(b), b.number(1));
    let field = b.g.sub(solid.distance, distance.id);
    Ok(Solid { surface: field, distance: field, ..solid })
}

/// A wall along the surface, half of it on either side.
pub(super) fn shell(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let (solid, thickness) = (measured(b), b.positive(1)?);
    let half = b.half(thickness.id);
    let distance = abs(b.g, solid.distance);
    let field = b.g.sub(distance, half);
    Ok(Solid { surface: field, distance: field, ..solid })
}

/// The first argument, whose distance is used.
fn measured(b: &mut Build<'_>) -> Solid {
    let solid = b.solid(0);
    if !solid.is_metric {
        b.warning = Some(NO_LENGTH);
    }
    solid
}
