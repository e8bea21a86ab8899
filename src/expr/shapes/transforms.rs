//! Shapes at other places. A shape that is moved is, at a point, what it was where the point came
//! from: coordinates are replaced by what the inverse makes of them.

use super::{
    Build, Complaint, Number, Solid, complaint, exact, max, min,
    primitives::{direction, dot},
};
use crate::{
    expr::{
        graph::{Graph, Id},
        names::length,
        values::over_box,
    },
    math::{Constant, Wave},
};

/// Where a column of a matrix is as long as another, or at right angles to it.
const SAME: f64 = 1e-12;

pub(super) fn translate(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let by = [1, 2, 3].map(|index| b.number(index).id);
    let place = b.coordinates();
    let before = [0, 1, 2].map(|axis| b.g.sub(place[axis], by[axis]));
    Ok(b.solid(0).at(b.g, before))
}

/// Turned about x, then y, then z.
pub(super) fn rotate(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let mut solid = b.solid(0);
    for axis in 0..3 {
        let degrees = b.number(axis + 1);
        solid = rotated(b, solid, axis, degrees);
    }
    Ok(solid)
}

pub(super) fn rotate_about(b: &mut Build<'_>, axis: usize) -> Result<Solid, Complaint> {
    let (solid, degrees) = (b.solid(0), b.number(1));
    Ok(rotated(b, solid, axis, degrees))
}

fn rotated(b: &mut Build<'_>, solid: Solid, axis: usize, degrees: Number) -> Solid {
    let (sin, cos) = waves_of_degrees(b.g, degrees);
    let before = turned_back(b, axis, sin, cos);
    solid.at(b.g, before)
}

/// The coordinates before a turn about `axis`, counterclockwise seen from its end.
fn turned_back(b: &mut Build<'_>, axis: usize, sin: Id, cos: Id) -> [Id; 3] {
    let mut before = b.coordinates();
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let products = [(u, cos), (v, sin), (v, cos), (u, sin)].map(|(i, f)| b.g.mul(before[i], f));
    before[u] = b.g.add(products[0], products[1]);
    before[v] = b.g.sub(products[2], products[3]);
    before
}

/// Sine and cosine of an angle in degrees, exact where it is a multiple of 90.
fn waves_of_degrees(g: &mut Graph, degrees: Number) -> (Id, Id) {
    let quarters = degrees.value / 90.0;
    if quarters.fract() == 0.0 {
        let (sin, cos) = match quarters.rem_euclid(4.0) {
            1.0 => (1.0, 0.0),
            2.0 => (0.0, -1.0),
            3.0 => (-1.0, 0.0),
            _ => (0.0, 1.0),
        };
        return (exact(g, sin), exact(g, cos));
    }
    let angle = in_radians(g, degrees.id);
    (g.wave(Wave::Sin, angle), g.wave(Wave::Cos, angle))
}

fn in_radians(g: &mut Graph, degrees: Id) -> Id {
    let degree = g.constant(Constant::rounded(std::f64::consts::PI / 180.0));
    g.mul(degrees, degree)
}

/// Turned the further the higher up, by an angle for each unit of length.
pub(super) fn twist(b: &mut Build<'_>, axis: usize) -> Result<Solid, Complaint> {
    let degrees = b.number(1);
    let height = b.coordinates()[axis];
    let rate = in_radians(b.g, degrees.id);
    let angle = b.g.mul(height, rate);
    let (sin, cos) = (b.g.wave(Wave::Sin, angle), b.g.wave(Wave::Cos, angle));
    let before = turned_back(b, axis, sin, cos);
    let reach = reach(b.g, b.solid(0), axis);
    let mut solid = b.solid(0).at(b.g, before);
    if let Some(reach) = reach {
        // Far out, boxes hold all angles: that the shape does not get there must be said.
        let mut across = b.coordinates().to_vec();
        across.remove(axis);
        let rho = length(&across, b.g);
        let reach = exact(b.g, reach);
        let beyond = b.g.sub(rho, reach);
        solid = solid.map(|field| max(b.g, field, beyond));
    }
    Ok(Solid { is_metric: solid.is_metric && degrees.value == 0.0, ..solid })
}

/// How far a shape is proven to reach from an axis at most, if it is.
fn reach(g: &Graph, solid: Solid, axis: usize) -> Option<f64> {
    const ALL: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
    let ends_before = |reach: f64| {
        let sides = [(reach, f64::INFINITY), (f64::NEG_INFINITY, -reach)];
        [(axis + 1) % 3, (axis + 2) % 3].into_iter().all(|across| {
            sides.into_iter().all(|side| {
                let mut place = [ALL; 3];
                place[across] = side;
                over_box(g, solid.surface, place) > 0.0
            })
        })
    };
    // Steps of √2, up to what a scene is searched for.
    let steps: Vec<f64> = (-40..=40).map(|n| libm::exp2(f64::from(n) / 2.0)).collect();
    let square = steps.get(steps.partition_point(|&reach| !ends_before(reach)))?;
    Some(square * 1.5)
}

/// By one factor, or by one along each axis.
pub(super) fn scale(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let x = b.positive(1)?;
    let factors = match (b.given(2), b.given(3)) {
        (None, None) => [x; 3],
        (Some(_), Some(_)) => [x, b.positive(2)?, b.positive(3)?],
        _ => return Err(complaint(2, "stands without `z`", "give one factor, or all three")),
    };
    let place = b.coordinates();
    let before = [0, 1, 2].map(|axis| b.g.div(place[axis], factors[axis].id));
    let solid = b.solid(0).at(b.g, before);
    // The least factor keeps the field a lower bound of the distance.
    let least = min(b.g, factors[0].id, factors[1].id);
    let least = min(b.g, least, factors[2].id);
    let is_even = factors.iter().all(|factor| factor.value == x.value);
    let solid = solid.map(|field| b.g.mul(field, least));
    Ok(Solid { is_metric: solid.is_metric && is_even, ..solid })
}

/// What a mirror through the origin shows, at right angles to a direction.
pub(super) fn mirror(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let normal = direction(b, 1)?;
    let place = b.coordinates();
    let height = dot(b.g, place, normal);
    let two = exact(b.g, 2.0);
    let twice = b.g.mul(height, two);
    let before = [0, 1, 2].map(|axis| {
        let back = b.g.mul(twice, normal[axis]);
        // Along an axis the coordinate itself, negated, and not x − 2x.
        match b.g.nodes()[normal[axis] as usize].constant().and_then(Constant::as_exact) {
            Some(n) if n.abs() == 1.0 => b.g.unary(crate::math::Unary::Neg, place[axis]),
            _ => b.g.sub(place[axis], back),
        }
    });
    Ok(b.solid(0).at(b.g, before))
}

/// Any affine map: three rows of a matrix, each with what is added.
pub(super) fn affine(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let rows = [0, 1, 2].map(|row| [0, 1, 2, 3].map(|column| b.number(1 + 4 * row + column)));
    let m = rows.map(|row| [row[0].id, row[1].id, row[2].id]);
    let values = rows.map(|row| [row[0].value, row[1].value, row[2].value]);
    let g = &mut *b.g;
    // Cofactors: the inverse is their transpose over the determinant.
    let cofactors = [0, 1, 2].map(|i: usize| {
        [0, 1, 2].map(|j: usize| {
            let (r, s, u, v) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
            let (p, q) = (g.mul(m[r][u], m[s][v]), g.mul(m[r][v], m[s][u]));
            g.sub(p, q)
        })
    });
    let determinant = dot(g, m[0], cofactors[0]);
    let size = g.nodes()[determinant as usize].constant().map_or(0.0, |c| c.value.abs());
    let largest = values.iter().flatten().fold(0.0, |a: f64, v| a.max(v.abs()));
    if size.is_nan() || size <= 1e-9 * largest * largest * largest {
        let help = "a map that flattens space leaves no solid";
        return Err(complaint(1, "begins a matrix without an inverse", help));
    }
    let place = [0, 1, 2].map(|axis| g.variable(axis));
    let moved = [0, 1, 2].map(|axis| g.sub(place[axis], rows[axis][3].id));
    let before = [0, 1, 2].map(|j| {
        let column = [0, 1, 2].map(|i| cofactors[i][j]);
        let sum = dot(g, moved, column);
        g.div(sum, determinant)
    });
    let solid = b.solid(0).at(b.g, before);
    Ok(Solid { is_metric: solid.is_metric && keeps_lengths(&values), ..solid })
}

/// Whether the columns of a matrix are of length 1 and at right angles.
fn keeps_lengths(m: &[[f64; 3]; 3]) -> bool {
    let product = |a: usize, b: usize| (0..3).map(|row| m[row][a] * m[row][b]).sum::<f64>();
    let is = |a, b, want: f64| (product(a, b) - want).abs() < SAME;
    (0..3).all(|a| is(a, a, 1.0) && is(a, (a + 1) % 3, 0.0))
}
