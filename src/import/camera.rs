//! Cameras of other programs, from whose spaces a similarity leads to the scene.

use super::{number, similarity::Similarity, snapped, vector};

/// What a camera sees.
pub(super) enum Lens {
    /// Parallel rays, so many lengths of the camera's space from the lowest to the highest.
    Flat { height: f64 },
    /// A cone, so many degrees from the lowest to the highest.
    Wide { fov: f64 },
}

impl Lens {
    /// How far from a ball of radius 1 the camera sees all of it, or may just not stand in it.
    pub(super) fn distance(&self) -> f64 {
        match self {
            Self::Flat { .. } => 1.0,
            Self::Wide { fov } => 1.0 / libm::sin((fov / 2.0).to_radians()),
        }
    }

    /// `[camera]` for one whose space (right, up, towards the viewer) becomes the scene's by `view`; what
    /// it looks at is beside `ball`.
    pub(super) fn camera(&self, ball: &Similarity, view: &Similarity) -> String {
        let ahead = view.ahead(ball.shift);
        let target = view.shift - view.axis(2) * if ahead > 0.0 { ahead } else { view.scale };
        let lens = match self {
            Self::Flat { height } => {
                let height = number(height * view.scale);
                format!("projection = \"orthographic\"\nheight = {height}")
            }
            Self::Wide { fov } => format!("fov = {}", number(*fov)),
        };
        let [eye, target] = [view.shift, target].map(|at| vector(snapped(at, ball.scale)));
        let up = vector(snapped(view.axis(1), 1.0));
        format!("\n[camera]\n{lens}\neye = {eye}\ntarget = {target}\nup = {up}\n")
    }
}
