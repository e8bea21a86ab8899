//! Solids from plane figures: what a shape or a formula is where z = 0.

use super::{Build, Complaint, Number, Solid, abs, exact, max, primitives::corner};
use crate::expr::names::length;

/// The figure, `height` high, half of it above and half of it below.
pub(super) fn extrude(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let height = b.positive(1)?;
    let [x, y, z] = b.coordinates();
    let zero = exact(b.g, 0.0);
    let figure = b.solid(0).at(b.g, [x, y, zero]);
    let half = b.half(height.id);
    let end = abs(b.g, z);
    let end = b.g.sub(end, half);
    let sharp = Number { id: zero, value: 0.0 };
    let solid = corner(b.g, &[figure.distance, end], sharp);
    Ok(Solid { surface: max(b.g, figure.surface, end), ..solid }.measured_as(figure))
}

/// The figure turned about the z axis: its x is the distance from the axis less `offset`, its y is z.
pub(super) fn revolve(b: &mut Build<'_>) -> Result<Solid, Complaint> {
    let offset = b.number(1);
    let [x, y, z] = b.coordinates();
    let zero = exact(b.g, 0.0);
    let rho = length(&[x, y], b.g);
    let from_axis = b.g.sub(rho, offset.id);
    Ok(b.solid(0).at(b.g, [from_axis, z, zero]))
}

impl Solid {
    /// The same fields, which are lengths only if those of `part` are.
    pub(super) fn measured_as(self, part: Self) -> Self {
        Self { is_metric: self.is_metric && part.is_metric, ..self }
    }
}
