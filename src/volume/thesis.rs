//! The test functions of A. León Salas, thesis, 2008: four radii over the cube from −1 to 1, and two
//! ways to make densities of them.

/// A radius; what lies at radii up to 1 is solid.
#[derive(Clone, Copy, Debug)]
pub struct Model {
    /// What the thesis calls it.
    pub name: &'static str,
    radius: &'static str,
}

/// How a density follows from a radius r. Where r is above 1 or undefined it is 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alpha {
    /// α1: 255.
    Solid,
    /// α2: 255 (1 − r), cut to 255 where r is negative.
    Linear,
}

/// The sphere, the trunk, the saddle and the vase.
pub const MODELS: [Model; 4] = [
    Model { name: "esfera", radius: "sqrt(x^2 + y^2 + z^2)" },
    Model { name: "tronco", radius: "sqrt(x^2 + 2*y*z)" },
    Model { name: "silla", radius: "sin(x*z) + y + cos(x*z)" },
    Model { name: "jarrón", radius: "x*sin(x) + y*cos(y) + z*sin(z)" },
];

impl Model {
    /// The density, as a formula; it is not cut yet.
    #[must_use]
    pub fn text(self, alpha: Alpha) -> String {
        let r = self.radius;
        match alpha {
            // The sign is −1 outside, 0 on the surface and 1 inside.
            Alpha::Solid => format!("255*min(sign(1 - ({r})) + 1, 1)"),
            Alpha::Linear => format!("255*(1 - ({r}))"),
        }
    }
}
