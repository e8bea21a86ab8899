//! Repetition along an axis.
//!
//! Copies are as many shapes as they are, and may overlap. Where a shape is the same from both sides
//! of the middle of its cell, and is proven not to leave it, one shape does for all copies, however
//! many: the coordinate is folded to the distance from the middle of its cell, which is continuous, so
//! that no box across the border between two cells sees a jump.

use super::{Build, Complaint, Kind, Solid, abs, complaint, exact, folded, max, sets::combined};
use crate::{
    expr::{graph::Graph, values::over_box},
    math::{Binary, Unary},
};

/// The shape, the distance between copies and how many there are.
pub(super) const ALONG: &[(&str, Kind)] =
    &[("a", Kind::Solid), ("spacing", Kind::Number), ("count", Kind::Optional)];

/// More copies than this are wanted by mistake, unless one shape does for all.
const MAX_COPIES: f64 = 4096.0;

/// So many nodes are left to the copies.
pub(crate) const MAX_NODES: usize = 1 << 20;

pub(super) fn along(b: &mut Build<'_>, axis: usize) -> Result<Solid, Complaint> {
    let spacing = b.positive(1)?;
    let count = b.given(2).map(|count| count.value);
    if let Some(count) = count
        && (count.fract() != 0.0 || !(1.0..=1e6).contains(&count))
    {
        let help = "it must be a whole number from 1 to 1000000";
        return Err(complaint(2, format!("is {count}"), help));
    }
    let solid = b.solid(0);
    let is_even = is_even(b.g, solid, axis);
    let fits = is_even && fits(b.g, solid, axis, spacing.value / 2.0);
    match count {
        _ if fits => {
            // The copies stand at whole or half numbers of spacings.
            let half = if count.is_some_and(|n| n % 2.0 == 0.0) { 0.5 } else { 0.0 };
            let mut place = b.coordinates();
            let g = &mut *b.g;
            let cells = g.div(place[axis], spacing.id);
            let shift = exact(g, half);
            let cells = g.sub(cells, shift);
            let folded = g.unary(Unary::Triangle, cells);
            let mut before = g.mul(folded, spacing.id);
            if let Some(count) = count {
                // Beyond the last copy it is farther and farther away.
                let last = exact(g, (count - 1.0) / 2.0);
                let last = g.mul(last, spacing.id);
                let beyond = abs(g, place[axis]);
                let beyond = g.sub(beyond, last);
                before = max(g, before, beyond);
            }
            place[axis] = before;
            Ok(solid.at(b.g, place))
        }
        None => {
            let (message, help) = match is_even {
                true => (
                    "is not shown to hold the shape",
                    "without a count the shape must lie within its cell; give more spacing, or a count",
                ),
                false => (
                    "is for a shape that differs from side to side",
                    "without a count both sides of the shape must be the same; give a count",
                ),
            };
            Err(complaint(1, message, help))
        }
        Some(count) if count > MAX_COPIES => {
            let help = format!("{MAX_COPIES} copies of such a shape are the most");
            Err(complaint(2, format!("is {count}"), &help))
        }
        Some(count) => {
            let mut copies = Vec::new();
            for i in 0..count as u32 {
                let mut place = b.coordinates();
                let g = &mut *b.g;
                let at = exact(g, f64::from(i) - (count - 1.0) / 2.0);
                let at = g.mul(at, spacing.id);
                place[axis] = g.sub(place[axis], at);
                copies.push(solid.at(g, place));
                if g.nodes().len() > MAX_NODES {
                    let help = "give fewer copies, or a simpler shape";
                    return Err(complaint(2, "makes too large a formula", help));
                }
            }
            Ok(combined(b.g, &copies, |g, parts| folded(g, Binary::Min, parts)))
        }
    }
}

/// Whether the shape does not change where the coordinate `axis` changes its sign.
fn is_even(g: &mut Graph, solid: Solid, axis: usize) -> bool {
    let mut mirrored = [0, 1, 2].map(|axis| g.variable(axis));
    mirrored[axis] = g.unary(Unary::Neg, mirrored[axis]);
    let there = solid.at(g, mirrored);
    (there.surface, there.distance) == (solid.surface, solid.distance)
}

/// Whether a shape that is the same on both sides is proven to end before `border`.
fn fits(g: &Graph, solid: Solid, axis: usize, border: f64) -> bool {
    let mut place = [(f64::NEG_INFINITY, f64::INFINITY); 3];
    place[axis] = (border, f64::INFINITY);
    over_box(g, solid.surface, place) > 0.0
}
