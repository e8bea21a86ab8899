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
//! *A matcap* is a picture of a ball that stands for all light (`matcap`).
//!
//! For the light a normal that points away from the viewer is turned around; the normal layer keeps
//! the outward one.
//!
//! *Based on:* J. Blinn, "Models of Light Reflection for Computer Synthesized Pictures", SIGGRAPH
//! 1977 (the highlight).

use std::sync::Arc;

use glam::DVec3;

use super::{
    Axes, ImageSettings, Light, Material,
    matcap::Matcap,
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
    /// A picture, with the picture's right and up.
    Matcap {
        /// A picture of a ball.
        matcap: Arc<Matcap>,
        /// The way to the right in the picture, of length 1.
        right: DVec3,
    },
}

/// The light that gets to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reach {
    /// Bit i: whether the light number i does.
    pub(super) lights: u64,
    /// The part of the surroundings that is open, in [0, 1].
    pub(super) open: f32,
}

impl Reach {
    /// Nothing is in the way.
    pub(super) const ALL: Self = Self { lights: u64::MAX, open: 1.0 };
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

/// From the picture's right, up and towards the viewer to scene coordinates.
fn world(v: DVec3, screen: &Screen) -> DVec3 {
    v.x * screen.right + v.y * screen.up - v.z * screen.forward
}

/// The unit vector towards a light, in scene coordinates.
pub(super) fn towards(light: &Light, screen: &Screen) -> DVec3 {
    match light.axes {
        Axes::Scene => light.direction.normalize(),
        Axes::Camera => world(light.direction, screen).normalize(),
    }
}

impl Lights {
    /// The picture's matcap, or the scene's lights, or else the camera's own.
    pub(super) fn new(image: &ImageSettings, screen: &Screen) -> Self {
        if let Some(matcap) = &image.matcap {
            return Self::Matcap { matcap: matcap.clone(), right: screen.right };
        }
        if image.lights.is_empty() {
            let (tilt, lamp) = (world(TILT, screen), world(LAMP, screen).normalize());
            return Self::Headlight { tilt, lamp };
        }
        let lamp = |light: &Light| Lamp {
            direction: towards(light, screen),
            color: light.intensity * DVec3::from_array(light.color.map(f64::from)),
        };
        Self::Placed(image.lights.iter().map(lamp).collect())
    }

    /// The light that an opaque surface sends back along a ray; `reach` tells what gets to it.
    pub(super) fn reflected(
        &self,
        material: &Material,
        outward: DVec3,
        ray: &Ray,
        reach: Reach,
    ) -> [f32; 4] {
        let to_viewer = -ray.direction.normalize();
        let facing = outward.dot(to_viewer);
        let back = backness(-facing);
        let Reflected { matte, glossy } = match self {
            Self::Headlight { tilt, lamp } => {
                let n = if facing < 0.0 { -outward } else { outward };
                headlight(*tilt, *lamp, n, to_viewer, material)
            }
            Self::Placed(lamps) => {
                let lit = |n: DVec3| lit(lamps, reach.lights, n, to_viewer, material);
                if facing >= 0.0 {
                    lit(outward)
                } else {
                    let mirrored = outward - 2.0 * facing * to_viewer;
                    lit(mirrored).mixed(lit(-outward), back)
                }
            }
            Self::Matcap { matcap, right } => {
                let n = if facing < 0.0 { -outward } else { outward };
                // Right and up at right angles to the ray, so that every rim is the ball's.
                let up = to_viewer.cross(*right).normalize();
                let seen = DVec3::new(n.dot(up.cross(to_viewer)), n.dot(up), n.dot(to_viewer));
                Reflected { matte: matcap.light(seen), glossy: DVec3::ZERO }
            }
        };
        let open = f64::from(reach.open);
        let back_color = material.back_color.unwrap_or(material.color);
        let channel = |c: usize| {
            let (front, behind) = (f64::from(material.color[c]), f64::from(back_color[c]));
            let color = front + back * (behind - front);
            (open * (color * matte[c] + glossy[c])) as f32
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

/// By the lamps whose bits in `reach` are set, and by what comes from everywhere.
fn lit(lamps: &[Lamp], reach: u64, n: DVec3, to_viewer: DVec3, material: &Material) -> Reflected {
    let mut sum = Reflected { matte: DVec3::splat(AMBIENT), glossy: DVec3::ZERO };
    let lamps = lamps.iter().enumerate().filter(|&(i, _)| reach >> i & 1 == 1);
    for (_, lamp) in lamps {
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

impl Material {
    /// The material where normals agree by `coherence`, in [0, 1]: highlights are wider and weaker.
    ///
    /// *Based on:* M. Toksvig, "Mipmapping Normal Maps", Journal of Graphics Tools 2005.
    pub(super) fn widened(self, coherence: f64) -> Self {
        if coherence >= 1.0 {
            return self;
        }
        let shininess = f64::from(self.shininess);
        let part = coherence / (coherence + shininess * (1.0 - coherence));
        let wider = (part * shininess).round_ties_even().max(1.0);
        let weaker = self.specular * ((1.0 + wider) / (1.0 + shininess)) as f32;
        Self { shininess: wider as u32, specular: weaker, ..self }
    }
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
        back_color: Some([0.1, 0.3, 0.9]),
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
        let material = Material { back_color: None, ..MATERIAL };
        let n = DVec3::new(0.3, 0.1, 0.9).normalize();
        let seen = |n: DVec3| lights.reflected(&material, n, &RAY, Reach::ALL);
        assert_eq!(seen(n), seen(-n));
    }

    #[test]
    fn front_and_back_have_their_colours() {
        let lights = placed(DVec3::Z);
        let matte = Material { specular: 0.0, ..MATERIAL };
        let [r, g, b, _] = lights.reflected(&matte, DVec3::Z, &RAY, Reach::ALL);
        assert_eq!([r, g, b], matte.color.map(|c| (f64::from(c) * (AMBIENT + DIFFUSE)) as f32));
        let [r, g, b, _] = lights.reflected(&matte, DVec3::NEG_Z, &RAY, Reach::ALL);
        assert_eq!(
            [r, g, b],
            [0.1, 0.3, 0.9].map(|c: f32| (f64::from(c) * (AMBIENT + DIFFUSE)) as f32)
        );
    }

    #[test]
    fn a_lamp_behind_the_surface_gives_no_light() {
        let lights = placed(DVec3::NEG_Z);
        let [r, ..] = lights.reflected(&MATERIAL, DVec3::Z, &RAY, Reach::ALL);
        assert_eq!(r, (f64::from(MATERIAL.color[0]) * AMBIENT) as f32);
    }

    #[test]
    fn a_light_that_does_not_get_there_gives_none() {
        let lights = placed(DVec3::Z);
        let shadow = Reach { lights: 0, open: 0.5 };
        let [r, ..] = lights.reflected(&MATERIAL, DVec3::Z, &RAY, shadow);
        assert_eq!(r, (0.5 * f64::from(MATERIAL.color[0]) * AMBIENT) as f32);
    }

    #[test]
    fn a_matcap_shows_its_middle_to_the_viewer_and_its_rim_at_rims() {
        let pixels = (0..25).map(|i| [(i % 5) as f32 / 4.0, (i / 5) as f32 / 4.0, 0.0]).collect();
        let matcap = Arc::new(Matcap::new(5, pixels).unwrap());
        let lights = Lights::Matcap { matcap, right: DVec3::X };
        let white = Material { color: [1.0; 3], back_color: None, ..MATERIAL };
        let seen = |n: DVec3| lights.reflected(&white, n, &RAY, Reach::ALL);
        assert_eq!(seen(DVec3::Z), [0.5, 0.5, 0.0, 1.0]);
        assert_eq!(seen(DVec3::X), [0.75, 0.5, 0.0, 1.0]);
        assert_eq!(seen(DVec3::Y), [0.5, 0.25, 0.0, 1.0]);
        assert_eq!(seen(DVec3::NEG_Z), seen(DVec3::Z));
    }

    /// No outline may speckle: nearly equal normals look nearly the same, whichever way they face.
    #[test]
    fn light_is_continuous_across_the_rim() {
        let lights = placed(DVec3::new(1.0, 0.4, -0.2));
        let at = |angle: f64| {
            let n = DVec3::new(libm::cos(angle), 0.0, libm::sin(angle));
            lights.reflected(&MATERIAL, n, &RAY, Reach::ALL)
        };
        for step in -1500..1500 {
            let (a, b) = (at(f64::from(step) * 1e-3), at(f64::from(step + 1) * 1e-3));
            for (a, b) in a.into_iter().zip(b) {
                assert!((a - b).abs() < 0.02, "{a} {b} at {step}");
            }
        }
    }
}
