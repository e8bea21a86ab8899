//! Where the samples of a file stand.

use glam::{DAffine3, DMat3, DVec3};

use super::Refusal;

/// The placing in which a step along axis i is column i of `steps`, and the first sample is at
/// `first`.
///
/// # Errors
/// What is wrong, if samples would lie on top of each other or nowhere.
pub(super) fn placing(steps: DMat3, first: DVec3) -> Result<DAffine3, Refusal> {
    let placing = DAffine3::from_mat3_translation(steps, first - steps * DVec3::splat(0.5));
    let volume = steps.determinant();
    if !placing.is_finite() || !volume.is_finite() {
        return Err("its samples have no finite places".to_owned());
    }
    // Cosines of a header are rounded, so that a flat grid need not be flat exactly.
    let sides = steps.x_axis.length() * steps.y_axis.length() * steps.z_axis.length();
    if volume.abs() <= 1e-9 * sides {
        let [x, y, z] = [steps.x_axis, steps.y_axis, steps.z_axis];
        return Err(format!("its samples lie in a plane: their steps are {x}, {y} and {z}"));
    }
    Ok(placing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_sample_is_where_it_should_be() {
        let steps = DMat3::from_diagonal(DVec3::new(-2.0, 3.0, 0.5));
        let placing = placing(steps, DVec3::new(1.0, 2.0, 3.0)).unwrap();
        assert_eq!(placing.transform_point3(DVec3::splat(0.5)), DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(placing.transform_point3(DVec3::new(1.5, 0.5, 0.5)).x, -1.0);
    }

    #[test]
    fn flat_grids_are_refused() {
        let flat = DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0));
        assert_eq!(
            placing(flat, DVec3::ZERO).unwrap_err(),
            "its samples lie in a plane: their steps are [1, 0, 0], [0, 1, 0] and [0, 0, 0]"
        );
        let nan = DMat3::from_diagonal(DVec3::NAN);
        assert_eq!(placing(nan, DVec3::ZERO).unwrap_err(), "its samples have no finite places");
        assert!(placing(DMat3::from_diagonal(DVec3::splat(1e-200)), DVec3::ZERO).is_err());
    }
}
