//! How a camera moves during a film.

use glam::DVec3;

use super::{Path, Placement, View, camera::unit};

/// How the camera moves.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// It does not.
    Still,
    /// It turns about the direction `up` of its view, as far as stated over all frames; seen from
    /// above, counterclockwise.
    Turn {
        /// A frame after the last would have turned by all of them.
        degrees: f64,
    },
    /// It goes along a way, from its time 0 in the first frame to 1 in the last.
    Along(Path),
}

impl Motion {
    /// The views of all of `n_frames` frames, if it begins as `view`.
    #[must_use]
    pub fn views(&self, view: &View, n_frames: u32) -> Vec<View> {
        let of_frame = |frame: u32| match self {
            Self::Still => view.clone(),
            Self::Turn { degrees } => {
                let angle = degrees * f64::from(frame) / f64::from(n_frames) % 360.0;
                turned(view, angle.to_radians())
            }
            Self::Along(path) => path.view(time(frame, n_frames)),
        };
        (0..n_frames).map(of_frame).collect()
    }
}

/// The time of a frame, counted from 0: 0 in the first frame and 1 in the last.
#[must_use]
pub fn time(frame: u32, n_frames: u32) -> f64 {
    if n_frames < 2 { 0.0 } else { f64::from(frame) / f64::from(n_frames - 1) }
}

fn turned(view: &View, angle: f64) -> View {
    let axis = unit(view.up);
    let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
    // Rodrigues' formula; without an angle it changes nothing.
    let turn = |v: DVec3| cosine * v + sine * axis.cross(v) + (1.0 - cosine) * axis.dot(v) * axis;
    let placement = match view.placement {
        Placement::Fit { direction, margin } => {
            Placement::Fit { direction: turn(direction), margin }
        }
        Placement::LookAt { eye, target } => {
            Placement::LookAt { eye: target + turn(eye - target), target }
        }
    };
    View { placement, ..view.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::Projection;

    #[test]
    fn a_turn_has_no_double_frame() {
        let view = View {
            projection: Projection::Perspective { fov_degrees: 35.0 },
            placement: Placement::LookAt { eye: DVec3::new(2.0, 0.0, 1.0), target: DVec3::X },
            up: 3.0 * DVec3::Z,
        };
        let views = Motion::Turn { degrees: 360.0 }.views(&view, 4);
        assert_eq!(views[0], view);
        let eyes = [(2.0, 0.0), (1.0, 1.0), (0.0, 0.0), (1.0, -1.0)];
        for (view, (x, y)) in views.iter().zip(eyes) {
            let Placement::LookAt { eye, target } = view.placement else { panic!("{view:?}") };
            assert!((eye - DVec3::new(x, y, 1.0)).length() < 1e-12, "{eye}");
            assert_eq!(target, DVec3::X);
        }
    }

    #[test]
    fn time_ends_with_the_last_frame() {
        assert_eq!([time(0, 3), time(1, 3), time(2, 3), time(0, 1)], [0.0, 0.5, 1.0, 0.0]);
    }
}
