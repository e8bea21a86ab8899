//! Famous surfaces, each a scene inside the program: `render gallery`.
//!
//! A scene says in `[about]` what it shows. In the gallery all of them stand in the same light.

mod page;
mod sheet;

use std::path::Path;

use glam::DVec3;

pub use page::{Page, write_page};
pub use sheet::write_sheet;

use crate::{
    Error, Result,
    diagnostic::did_you_mean,
    raster::{Axes, Light},
    scene::{self, Scene},
};

/// A scene of the gallery.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Its file without the ending, from the repository's root.
    path: &'static str,
    /// The scene file.
    pub text: &'static str,
}

macro_rules! entries {
    ($($path:literal),* $(,)?) => {
        &[$(Entry {
            path: $path,
            text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/", $path, ".toml")),
        }),*]
    };
}

/// All of them, in the order in which they are shown.
pub const ENTRIES: &[Entry] = entries![
    "gallery/sphere",
    "gallery/ellipsoid_321",
    "gallery/torus_1_04",
    "gallery/superellipsoid_4",
    "gallery/octahedron",
    "gallery/astroidal_ellipsoid",
    "gallery/steinmetz_2",
    "gallery/steinmetz_3",
    "gallery/napkin_ring",
    "gallery/menger_3",
    "gallery/csg_fogleman",
    "configs/heart",
    "gallery/distel",
    "configs/tanglecube",
    "gallery/banchoff_chmutov_4",
    "gallery/chmutov_sextic",
    "gallery/chmutov_octic",
    "gallery/trefoil_knot",
    "gallery/hunt",
    "gallery/double_cone",
    "configs/cayley",
    "configs/clebsch",
    "gallery/chmutov_quartic_12",
    "configs/kummer",
    "configs/togliatti",
    "configs/barth_sextic",
    "gallery/barth_sextic_30_cusps",
    "gallery/labs_septic",
    "gallery/endrass_octic",
    "configs/barth_decic",
    "configs/moebius",
    "configs/klein",
    "gallery/whitney_umbrella",
    "gallery/steiner_roman",
    "gallery/cross_cap",
    "gallery/boy_surface",
    "configs/catenoid",
    "configs/helicoid",
    "gallery/enneper",
    "gallery/scherk_first",
    "gallery/scherk_tower",
    "gallery/schwarz_P",
    "gallery/schwarz_D",
    "gallery/gyroid",
    "gallery/neovius",
    "gallery/schoen_iwp",
    "gallery/fischer_koch_s",
    "gallery/gyroid_ball",
    "configs/pseudosphere",
    "gallery/hyperboloid",
    "gallery/hyperbolic_paraboloid",
    "gallery/monkey_saddle",
    "gallery/plucker_conoid",
    "gallery/gabriels_horn",
    "gallery/dupin_cyclide",
    "gallery/ding_dong",
    "gallery/piriform",
    "gallery/zitrus",
    "gallery/daisy",
    "gallery/calypso",
    "gallery/helix",
    "gallery/kolibri",
    "gallery/kreisel",
    "gallery/eistuete",
    "gallery/octdong",
    "gallery/vis_a_vis",
    "gallery/twilight",
    "gallery/crixxi",
    "gallery/spitz",
    "gallery/seepferdchen",
    "gallery/tanz",
    "gallery/windkanal",
    "gallery/nepali",
    "gallery/dullo",
    "gallery/himmel_hoelle",
    "gallery/taube",
    "gallery/seed_pod",
    "gallery/orthocircles",
    "gallery/decocube",
    "gallery/pretzel",
    "gallery/genus_three",
    "gallery/weird",
    "gallery/chair",
    "gallery/blob",
    "gallery/tooth",
    "gallery/kiss",
    "gallery/miter",
    "gallery/bifolia",
    "configs/scene1",
    "configs/scene2",
    "configs/scene3",
    "gallery/flower",
    "configs/column",
    "configs/gear",
    "gallery/ripples",
    "configs/droplets",
    "configs/orbital",
    "gallery/water",
];

/// Two lamps beside the camera: right, up, towards the viewer; intensity.
const LAMPS: [(DVec3, f64); 2] =
    [(DVec3::new(-0.5, 0.8, 1.0), 0.8), (DVec3::new(1.0, -0.1, 0.6), 0.35)];

/// How much darker hollows are, where a scene does not say.
const OCCLUSION: f64 = 0.5;

impl Entry {
    /// What it is called on the command line.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.path.rsplit('/').next().unwrap_or(self.path)
    }

    /// The scene in the gallery's light, with parameters set as in [`scene::load_with`].
    ///
    /// # Errors
    /// [`Error::Scene`] if a setting is wrong.
    pub fn scene(&self, settings: &[String]) -> Result<Scene> {
        let path = format!("{}.toml", self.path);
        let scene = scene::parse_with(Path::new(&path), self.text, settings, None);
        scene.map(studio).map_err(|rejection| Error::Scene(Box::new(rejection)))
    }
}

/// The scene called `name`.
///
/// # Errors
/// [`Error::Unknown`] with the name that was probably meant.
pub fn find(name: &str) -> Result<&'static Entry> {
    ENTRIES.iter().find(|entry| entry.name() == name).ok_or_else(|| {
        let names = || ENTRIES.iter().map(Entry::name);
        let part_of = || names().find(|other| name.len() > 2 && other.contains(name));
        Error::Unknown(match did_you_mean(name, names()).or_else(part_of) {
            Some(other) => format!("`{name}` is not in the gallery: did you mean `{other}`?"),
            None => format!("`{name}` is not in the gallery: `render gallery` lists what is"),
        })
    })
}

/// The scene called `name`, for callers that read files in the same way.
///
/// # Errors
/// As [`find`] and [`Entry::scene`].
pub fn load(name: &Path, settings: &[String]) -> Result<Scene> {
    find(&name.to_string_lossy())?.scene(settings)
}

/// Lamps and darker hollows for a scene that says nothing about light.
fn studio(mut scene: Scene) -> Scene {
    let image = &mut scene.image;
    if image.lights.is_empty() && image.matcap.is_none() {
        let lamp = |(direction, intensity)| Light {
            direction,
            axes: Axes::Camera,
            color: [1.0; 3],
            intensity,
        };
        image.lights = LAMPS.map(lamp).to_vec();
    }
    if image.occlusion == 0.0 {
        image.occlusion = OCCLUSION;
    }
    scene
}
