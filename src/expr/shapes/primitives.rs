//! Solids with exact signed distances. All stand in the middle of the origin; lengths are whole: of a
//! box its edges, of a cylinder its radius and its height.
//!
//! *Based on:* I. Quilez, "Distance functions" (box, capsule, torus, capped cone).

use super::{Build, Complaint, Number, Solid, abs, complaint, exact, folded, max, min};
use crate::{
    expr::{
        graph::{Graph, Id},
        names::length,
    },
    math::Binary,
};

/// A length must leave a direction.
const NO_DIRECTION: &str = "give the direction away from the solid, such as 0, 0, 1";

pub(super) fn sphere(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let radius = b.positive(0)?;
    let coordinates = b.coordinates();
    let r = length(&coordinates, b.g);
    Ok(Solid::exact(b.g.sub(r, radius.id)))
}

pub(super) fn cuboid(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let x = b.positive(0)?;
    let sizes = match (b.given(1), b.given(2)) {
        (None, None) => [x; 3],
        (Some(_), Some(_)) => [x, b.positive(1)?, b.positive(2)?],
        _ => return Err(complaint(1, "stands without `z`", "a box has one size, or all three")),
    };
    let least = sizes.iter().map(|size| size.value).fold(f64::INFINITY, f64::min);
    let round = b.rounding(3, Some(least / 2.0))?;
    let coordinates = b.coordinates();
    let mut sides = Vec::new();
    for (coordinate, size) in coordinates.into_iter().zip(sizes) {
        let half = b.half(size.id);
        let side = abs(b.g, coordinate);
        sides.push(b.g.sub(side, half));
    }
    Ok(corner(b.g, &sides, round))
}

/// A cylinder along an axis, endless without a height.
pub(super) fn cylinder(b: &mut Build<'_>, axis: usize) -> Result<Solid, Complaint> {
    let radius = b.positive(0)?;
    let mut across = b.coordinates().to_vec();
    let along = across.remove(axis);
    let rho = length(&across, b.g);
    let side = b.g.sub(rho, radius.id);
    if b.given(1).is_none() {
        if b.number(2).value != 0.0 {
            return Err(complaint(2, "has nothing to round", "give the cylinder a height"));
        }
        return Ok(Solid::exact(side));
    }
    let height = b.positive(1)?;
    let round = b.rounding(2, Some(radius.value.min(height.value / 2.0)))?;
    let half = b.half(height.id);
    let end = abs(b.g, along);
    let end = b.g.sub(end, half);
    Ok(corner(b.g, &[side, end], round))
}

/// Where several sides at right angles meet: each is the distance to one of them, negative inside.
pub(super) fn corner(g: &mut Graph, sides: &[Id], round: Number) -> Solid {
    let sides: Vec<Id> = sides.iter().map(|&side| g.add(side, round.id)).collect();
    let zero = exact(g, 0.0);
    let deepest = folded(g, Binary::Max, &sides);
    let beyond: Vec<Id> = sides.iter().map(|&side| max(g, side, zero)).collect();
    let (outside, inside) = (length(&beyond, g), min(g, deepest, zero));
    let distance = g.add(outside, inside);
    let distance = g.sub(distance, round.id);
    let surface = if round.value == 0.0 { deepest } else { distance };
    Solid { surface, distance, is_metric: true }
}

pub(super) fn capsule(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let (radius, height) = (b.positive(0)?, b.positive(1)?);
    let [x, y, z] = b.coordinates();
    let half = b.half(height.id);
    let zero = exact(b.g, 0.0);
    let above = abs(b.g, z);
    let above = b.g.sub(above, half);
    let above = max(b.g, above, zero);
    let from_axis = length(&[x, y, above], b.g);
    Ok(Solid::exact(b.g.sub(from_axis, radius.id)))
}

pub(super) fn torus(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let (radius, tube) = (b.positive(0)?, b.positive(1)?);
    let [x, y, z] = b.coordinates();
    let rho = length(&[x, y], b.g);
    let across = b.g.sub(rho, radius.id);
    let from_circle = length(&[across, z], b.g);
    Ok(Solid::exact(b.g.sub(from_circle, tube.id)))
}

/// A cone, or a frustum, with its base below and its top above.
///
/// In a plane through the axis it is convex: inside, the distance is the largest of those to its
/// three lines, and outside, it is that to the nearest of its three edges.
pub(super) fn cone(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let (radius, height) = (b.positive(0)?, b.positive(1)?);
    let top = b.rounding(2, None)?;
    let [x, y, z] = b.coordinates();
    let half = b.half(height.id);
    let g = &mut *b.g;
    let zero = exact(g, 0.0);
    let rho = length(&[x, y], g);
    // The slanted edge, from the rim of the base; `along` is its vector (−narrowing, height).
    let narrowing = g.sub(radius.id, top.id);
    let slant = length(&[narrowing, height.id], g);
    let (from_rim, from_base) = (g.sub(rho, radius.id), g.add(z, half));
    let (a, c) = (g.mul(from_rim, height.id), g.mul(from_base, narrowing));
    let sum = g.add(a, c);
    let side = g.div(sum, slant);
    let end = abs(g, z);
    let end = g.sub(end, half);
    let surface = max(g, side, end);
    // The distances to the edges.
    let disc = |g: &mut Graph, radius: Id, height: Id| {
        let beyond = g.sub(rho, radius);
        let beyond = max(g, beyond, zero);
        square_sum(g, beyond, height)
    };
    let base = disc(g, radius.id, from_base);
    let from_top = g.sub(z, half);
    let lid = disc(g, top.id, from_top);
    let (a, c) = (g.mul(from_base, height.id), g.mul(from_rim, narrowing));
    let along = g.sub(a, c);
    let squared = g.powi(slant, 2);
    let along = g.div(along, squared);
    let one = exact(g, 1.0);
    let along = max(g, along, zero);
    let along = min(g, along, one);
    let (a, c) = (g.mul(along, narrowing), g.mul(along, height.id));
    let (across, up) = (g.add(from_rim, a), g.sub(from_base, c));
    let slanted = square_sum(g, across, up);
    let nearest = folded(g, Binary::Min, &[base, lid, slanted]);
    let nearest = g.unary(crate::math::Unary::Sqrt, nearest);
    // Inside, `nearest` is −surface.
    let inside = min(g, surface, zero);
    let two = exact(g, 2.0);
    let twice = g.mul(inside, two);
    let distance = g.add(nearest, twice);
    Ok(Solid { surface, distance, is_metric: true })
}

fn square_sum(g: &mut Graph, a: Id, b: Id) -> Id {
    let (a, b) = (g.powi(a, 2), g.powi(b, 2));
    g.add(a, b)
}

/// What lies behind the plane at `offset` along a direction.
pub(super) fn half_space(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let height = above_plane(b, 3)?;
    Ok(Solid::exact(height))
}

/// A plate along a plane.
pub(super) fn plane(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let height = above_plane(b, 4)?;
    let thickness = b.positive(3)?;
    let half = b.half(thickness.id);
    let height = abs(b.g, height);
    Ok(Solid::exact(b.g.sub(height, half)))
}

/// The height above the plane whose normal the first three arguments are.
fn above_plane(b: &mut Build<'_>, offset: usize) -> Result<Id, Complaint> {
    let direction = direction(b, 0)?;
    let offset = b.number(offset);
    let coordinates = b.coordinates();
    let height = dot(b.g, coordinates, direction);
    Ok(b.g.sub(height, offset.id))
}

/// The unit vector along the arguments from `first` on.
pub(super) fn direction(b: &mut Build<'_>, first: usize) -> Result<[Id; 3], Complaint> {
    let vector = [0, 1, 2].map(|axis| b.number(first + axis));
    if vector.iter().all(|part| part.value == 0.0) {
        return Err(complaint(first, "begins a vector without direction", NO_DIRECTION));
    }
    let vector = vector.map(|part| part.id);
    let length = length(&vector, b.g);
    Ok(vector.map(|part| b.g.div(part, length)))
}

pub(super) fn dot(g: &mut Graph, a: [Id; 3], b: [Id; 3]) -> Id {
    let parts = [0, 1, 2].map(|axis| g.mul(a[axis], b[axis]));
    let sum = g.add(parts[0], parts[1]);
    g.add(sum, parts[2])
}
