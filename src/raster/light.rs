//! How much light a surface sends to the viewer: from the camera's own lamp, or from the scene's.
//!
//! *The default light* comes from the camera. A lamp beside it would show the form better, but not
//! the rim: there the voxels that a picture shows face the viewer or just not, in no order, so a
//! light that differs between a normal and its opposite speckles every outline. Here the light at
//! the rim goes to zero. Away from the rim it is tilted, so that what faces up and left is
//! brighter. The highlight is Blinn's, for a lamp on that side.
//!
//! *A scene's own lights* are Lambert's and Blinn's. They cannot vanish at the rim. Instead, what
//! reaches the viewer is a continuous function of the normal: just beyond the rim a normal counts
//! as its mirror image before it, and only well beyond does the back have its own light. The colour
//! of the back fades in the same way.
//!
//! For the light a normal that points away from the viewer is turned around; the normal layer keeps
//! the outward one.
//!
//! *Based on:* J. Blinn, "Models of Light Reflection for Computer Synthesized Pictures", SIGGRAPH
//! 1977 (the highlight).

use glam::DVec3;

use super::{
    Axes, Light, Material,
    screen::{Ray, Screen},
};

/// Light that reaches everything.
const AMBIENT: f64 = 0.08;
/// Light of a lamp of intensity 1 on what faces it.
const DIFFUSE: f64 = 0.80;
/// How much brighter what faces right, up or towards the viewer is.
const TILT: DVec3 = DVec3::new(-0.25, 0.4, 0.0);
/// Where the lamp of the highlight is, from the surface: right, up, towards the viewer.
const LAMP: DVec3 = DVec3::new(-0.4, 0.6, 1.0);

/// Sines of the angles behind the rim at which the back begins to show, and shows alone. Voxels at
/// the rim of a form that is 100 voxels across face away by a sine of up to 0.14.
const BACK_FADES_IN: [f64; 2] = [0.12, 0.35];

/// The lights in scene coordinates.
pub(super) enum Lights {
    /// The camera's own lamp.
    Headlight {
        /// Which way what is brighter faces.
        tilt: DVec3,
        /// Towards the lamp of the highlight, of length 1.
        lamp: DVec3,
    },
    /// The scene's.
    Placed(Vec<Lamp>),
}

/// A light from far away.
pub(super) struct Lamp {
    /// Towards the light, of length 1.
    direction: DVec3,
    /// Linear-light red, green, blue, times the intensity.
    color: DVec3,
}

/// Light that a surface sends to the viewer: what its colour takes part in, and the highlight.
#[derive(Clone, Copy)]
struct Reflected {
    matte: DVec3,
    glossy: DVec3,
}

impl Lights {
    /// The scene's `lights`, or the camera's own if there are none.
    pub(super) fn new(lights: &[Light], screen: &Screen) -> Self {
        let world = |v: DVec3| v.x * screen.right + v.y * screen.up - v.z * screen.forward;
        if lights.is_empty() {
            return Self::Headlight { tilt: world(TILT), lamp: world(LAMP).normalize() };
        }
        let lamp = |light: &Light| Lamp {
            direction: match light.axes {
                Axes::Scene => light.direction.normalize(),
                Axes::Camera => world(light.direction).normalize(),
            },
            color: light.intensity * DVec3::from_array(light.color.map(f64::from)),
        };
        Self::Placed(lights.iter().map(lamp).collect())
    }

    /// The light that an opaque surface sends back along a ray.
    pub(super) fn reflected(&self, material: &Material, outward: DVec3, ray: &Ray) -> [f32; 4] {
        let to_viewer = -ray.direction.normalize();
        let facing = outward.dot(to_viewer);
        let back = backness(-facing);
        let Reflected { matte, glossy } = match self {
            Self::Headlight { tilt, lamp } => {
                let n = if facing < 0.0 { -outward } else { outward };
                headlight(*tilt, *lamp, n, to_viewer, material)
            }
            Self::Placed(lamps) if facing >= 0.0 => lit(lamps, outward, to_viewer, material),
            Self::Placed(lamps) => {
                let mirrored = outward - 2.0 * facing * to_viewer;
                let rim = lit(lamps, mirrored, to_viewer, material);
                rim.mixed(lit(lamps, -outward, to_viewer, material), back)
            }
        };
        let channel = |c: usize| {
            let (front, behind) = (f64::from(material.color[c]), f64::from(material.back_color[c]));
            let color = front + back * (behind - front);
            (color * matte[c] + glossy[c]) as f32
        };
        [channel(0), channel(1), channel(2), 1.0]
    }
}

impl Reflected {
    fn mixed(self, other: Self, part: f64) -> Self {
        Self {
            matte: self.matte + part * (other.matte - self.matte),
            glossy: self.glossy + part * (other.glossy - self.glossy),
        }
    }
}

/// How much of the back shows where a normal faces away with this cosine.
fn backness(away: f64) -> f64 {
    let [start, end] = BACK_FADES_IN;
    let t = ((away - start) / (end - start)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn headlight(
    tilt: DVec3,
    lamp: DVec3,
    n: DVec3,
    to_viewer: DVec3,
    material: &Material,
) -> Reflected {
    let facing = n.dot(to_viewer);
    let matte = AMBIENT + DIFFUSE * facing * (1.0 + n.dot(tilt));
    let glossy = f64::from(material.specular) * facing * highlight(lamp, n, to_viewer, material);
    Reflected { matte: DVec3::splat(matte), glossy: DVec3::splat(glossy) }
}

fn lit(lamps: &[Lamp], n: DVec3, to_viewer: DVec3, material: &Material) -> Reflected {
    let mut sum = Reflected { matte: DVec3::splat(AMBIENT), glossy: DVec3::ZERO };
    for lamp in lamps {
        let facing = n.dot(lamp.direction).max(0.0);
        let glossy = f64::from(material.specular) * facing;
        sum.matte += DIFFUSE * facing * lamp.color;
        sum.glossy += glossy * highlight(lamp.direction, n, to_viewer, material) * lamp.color;
    }
    sum
}

/// Blinn's highlight: how closely the normal halves the angle between lamp and viewer.
fn highlight(lamp: DVec3, n: DVec3, to_viewer: DVec3, material: &Material) -> f64 {
    let halfway = (lamp + to_viewer).normalize_or_zero();
    power(n.dot(halfway).max(0.0), material.shininess)
}

/// x to the n by repeated multiplication, the same on every platform.
fn power(x: f64, n: u32) -> f64 {
    let (mut square, mut rest, mut product) = (x, n, 1.0);
    while rest > 0 {
        if rest & 1 == 1 {
            product *= square;
        }
        square *= square;
        rest >>= 1;
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;

    const RAY: Ray = Ray { origin: DVec3::ZERO, direction: DVec3::NEG_Z };
    const MATERIAL: Material = Material {
        color: [0.8, 0.5, 0.2],
        back_color: [0.1, 0.3, 0.9],
        specular: 0.5,
        shininess: 20,
    };

    fn placed(direction: DVec3) -> Lights {
        Lights::Placed(vec![Lamp { direction: direction.normalize(), color: DVec3::ONE }])
    }

    #[test]
    fn power_multiplies() {
        assert_eq!(power(3.0, 0), 1.0);
        assert_eq!(power(3.0, 13), 1_594_323.0);
        assert_eq!(power(0.999, u32::MAX), 0.0);
    }

    #[test]
    fn both_sides_look_the_same_in_one_colour() {
        let lights = Lights::Headlight { tilt: 0.3 * DVec3::Y, lamp: DVec3::Z };
        let material = Material { back_color: MATERIAL.color, ..MATERIAL };
        let n = DVec3::new(0.3, 0.1, 0.9).normalize();
        assert_eq!(lights.reflected(&material, n, &RAY), lights.reflected(&material, -n, &RAY));
    }

    #[test]
    fn front_and_back_have_their_colours() {
        let lights = placed(DVec3::Z);
        let matte = Material { specular: 0.0, ..MATERIAL };
        let [r, g, b, _] = lights.reflected(&matte, DVec3::Z, &RAY);
        assert_eq!([r, g, b], matte.color.map(|c| (f64::from(c) * (AMBIENT + DIFFUSE)) as f32));
        let [r, g, b, _] = lights.reflected(&matte, DVec3::NEG_Z, &RAY);
        assert_eq!(
            [r, g, b],
            matte.back_color.map(|c| (f64::from(c) * (AMBIENT + DIFFUSE)) as f32)
        );
    }

    #[test]
    fn a_lamp_behind_the_surface_gives_no_light() {
        let lights = placed(DVec3::NEG_Z);
        let [r, ..] = lights.reflected(&MATERIAL, DVec3::Z, &RAY);
        assert_eq!(r, (f64::from(MATERIAL.color[0]) * AMBIENT) as f32);
    }

    /// No outline may speckle: nearly equal normals look nearly the same, whichever way they face.
    #[test]
    fn light_is_continuous_across_the_rim() {
        let lights = placed(DVec3::new(1.0, 0.4, -0.2));
        let at = |angle: f64| {
            let n = DVec3::new(libm::cos(angle), 0.0, libm::sin(angle));
            lights.reflected(&MATERIAL, n, &RAY)
        };
        for step in -1500..1500 {
            let (a, b) = (at(f64::from(step) * 1e-3), at(f64::from(step + 1) * 1e-3));
            for (a, b) in a.into_iter().zip(b) {
                assert!((a - b).abs() < 0.02, "{a} {b} at {step}");
            }
        }
    }
}
