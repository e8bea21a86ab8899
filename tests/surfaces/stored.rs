//! The voxels that hold singular points, cusps, tips and edges are stored: there formulas vanish to a higher
//! order, or have kinks, and a search that relies on signs or gradients would lose them.

use std::f64::consts::{FRAC_1_SQRT_2, PI, SQRT_2};

use glam::DVec3;
use zeroset::{
    eval::sampler,
    math::{Lattice, SimdLevel},
    octree::{Occupancy, Storage},
};

use crate::{lattice, meshed::published, octree, scene};

/// All points that flips of signs make of one.
fn signs(point: [f64; 3]) -> impl Iterator<Item = [f64; 3]> {
    (0..8).map(move |k| {
        [0, 1, 2].map(|axis| if k >> axis & 1 == 0 { point[axis] } else { -point[axis] })
    })
}

/// All points that flips of signs and cyclic permutations make of some, each once.
fn pyrite(points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let cycled = |&[x, y, z]: &[f64; 3]| [[x, y, z], [y, z, x], [z, x, y]];
    unique(points.iter().flat_map(cycled).flat_map(signs).collect())
}

/// All points that fifths of a turn about z make of points with these x and z.
fn fivefold(points: &[[f64; 2]]) -> Vec<[f64; 3]> {
    let turned = |&[x, z]: &[f64; 2]| {
        (0..5).map(move |k| {
            let angle = 0.4 * PI * f64::from(k);
            [x * libm::cos(angle), x * libm::sin(angle), z]
        })
    };
    unique(points.iter().flat_map(turned).collect())
}

fn unique(points: Vec<[f64; 3]>) -> Vec<[f64; 3]> {
    let mut unique: Vec<[f64; 3]> = Vec::new();
    for p in points {
        let is_known = |q: &&[f64; 3]| (0..3).all(|axis| (p[axis] - q[axis]).abs() < 1e-9);
        if !unique.iter().any(|q| is_known(&q)) {
            unique.push(p);
        }
    }
    unique
}

/// Points along a curve, of which the parameter is an angle.
fn around(n: u32, point: impl Fn(f64) -> [f64; 3]) -> Vec<[f64; 3]> {
    // Not at angles at which a point would lie in a plane of symmetry.
    (0..n).map(|k| point(2.0 * PI * (f64::from(k) + 0.3) / f64::from(n))).collect()
}

/// Points on the axes, on either side of the origin.
fn on_axes(distances: &[f64]) -> Vec<[f64; 3]> {
    pyrite(&distances.iter().map(|&t| [t, 0.0, 0.0]).collect::<Vec<_>>())
}

/// What is special about points of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// The gradient vanishes.
    Singular,
    /// The surface has a kink there, or goes as far as that.
    Kink,
    /// The formula has no value there, but the surface comes as near as one likes.
    Limit,
}
use Kind::{Kink, Limit, Singular};

/// Points of published surfaces, all that are affine where their number is known.
fn special_points() -> Vec<(&'static str, Kind, Vec<[f64; 3]>)> {
    let phi = 0.5 * (1.0 + libm::sqrt(5.0));
    let icosidodecahedron = pyrite(&[[1.0, 0.0, 0.0], [0.5 * phi, 0.5 / phi, 0.5]]);
    let dodecahedron = pyrite(&[[1.0, 1.0, 1.0], [phi, 0.0, 1.0 / phi]]);
    let origin = vec![[0.0; 3]];
    let line = |t: &[f64]| t.iter().map(|&z| [0.0, 0.0, z]).collect::<Vec<_>>();
    vec![
        ("ding_dong", Singular, origin.clone()),
        ("piriform", Singular, origin.clone()),
        ("double_cone", Singular, origin.clone()),
        (
            "cayley_cubic",
            Singular,
            vec![[1.0, 1.0, -1.0], [1.0, -1.0, 1.0], [-1.0, 1.0, 1.0], [-1.0, -1.0, -1.0]],
        ),
        (
            "cayley_cubic, other form",
            Singular,
            vec![[0.5, 0.5, -0.5], [0.5, -0.5, 0.5], [-0.5, 0.5, 0.5], [-0.5, -0.5, -0.5]],
        ),
        ("kummer_quartic", Singular, kummer(1.69)),
        ("chmutov_quartic_12", Singular, pyrite(&[[FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0]])),
        ("togliatti_quintic", Singular, togliatti()),
        ("barth_sextic", Singular, [icosidodecahedron.clone(), dodecahedron].concat()),
        ("barth_sextic_30_cusps", Singular, icosidodecahedron),
        ("barth_decic", Singular, pyrite(BARTH_DECIC)),
        ("hunt", Singular, hunt()),
        ("heart_taubin", Singular, around(40, |t| [libm::cos(t), 2.0 / 3.0 * libm::sin(t), 0.0])),
        // The pinch point, the double line, and the handle that no sheet passes.
        ("whitney_umbrella", Singular, line(&[0.0, 0.31, 1.2, -0.31, -1.2])),
        // The triple point, double lines, the pinch points, and lines that no sheet passes.
        ("steiner_roman", Singular, on_axes(&[0.0, 0.27, 0.5, 0.61])),
        (
            "klein_bottle",
            Singular,
            around(40, |t| [SQRT_2 * libm::cos(t), 1.0 + SQRT_2 * libm::sin(t), 0.0]),
        ),
        ("boy_surface", Singular, line(&[0.0, 2.0 / 3.0])),
        ("stolte_kaufman_scene_2", Limit, origin.clone()),
        ("stolte_kaufman_scene_3", Limit, origin),
        ("octahedron", Kink, on_axes(&[1.0])),
        ("astroidal_ellipsoid", Kink, on_axes(&[1.0])),
        ("distel", Kink, on_axes(&[1.0])),
        ("steinmetz_2", Kink, around(40, |t| [libm::cos(t), libm::sin(t), libm::sin(t)])),
        ("steinmetz_3", Kink, pyrite(&[[FRAC_1_SQRT_2, FRAC_1_SQRT_2, FRAC_1_SQRT_2]])),
        ("pseudosphere", Kink, around(40, |t| [libm::cos(t), libm::sin(t), 0.0])),
    ]
}

/// The nodes of Kummer's quartic with mu² = `mu2`, between 1 and 3: two on each edge of the tetrahedron of
/// planes, where it meets the sphere, and one below each corner.
fn kummer(mu2: f64) -> Vec<[f64; 3]> {
    let corners =
        [[0.0, SQRT_2, 1.0], [0.0, -SQRT_2, 1.0], [SQRT_2, 0.0, -1.0], [-SQRT_2, 0.0, -1.0]];
    let below = |corner: DVec3| 0.5 * (mu2 - 1.0) * corner;
    let mut nodes = Vec::new();
    for (i, a) in corners.into_iter().map(DVec3::from_array).enumerate() {
        nodes.push(below(a).to_array());
        for b in corners.into_iter().skip(i + 1).map(DVec3::from_array) {
            // Edges touch the sphere of radius 1 in the middle.
            let (middle, along) = (0.5 * (a + b), (b - a).normalize());
            let half = libm::sqrt(mu2 - 1.0);
            nodes.extend([-half, half].map(|t| (middle + t * along).to_array()));
        }
    }
    nodes
}

/// The nodes of Barth's form of Togliatti's quintic, found by Newton's method.
fn togliatti() -> Vec<[f64; 3]> {
    fivefold(&[
        [0.0, -2.689_994_047_855_830_4],
        [0.665_003_100_443_925_4, -0.537_998_809_571_165_9],
        [-0.665_003_100_443_925_4, 0.537_998_809_571_165_9],
        [-0.919_011_682_189_444_7, -0.283_990_227_825_646_6],
        [0.919_011_682_189_444_7, 0.283_990_227_825_646_6],
        [1.075_997_619_142_332, 0.792_007_391_316_685_2],
        [2.406_003_820_030_181, -0.283_990_227_825_646_6],
    ])
}

/// The nodes of Barth's decic but for signs and cyclic permutations, found by Newton's method.
const BARTH_DECIC: &[[f64; 3]] = &[
    [0.083_462_633_855_547_3, 0.572_061_402_817_684_4, 0.218_508_012_224_410_55],
    [0.353_553_390_593_273_8, 0.135_045_378_368_863_2, 0.488_598_768_962_136_94],
    [0.437_016_024_448_821_1, 0.0, 0.437_016_024_448_821_1],
    [0.309_016_994_374_947_4, 0.5, 0.190_983_005_625_052_58],
    [0.618_033_988_749_894_8, 0.0, 0.0],
    [0.301_970_646_079_957_8, 0.218_508_012_224_410_55, 0.623_644_147_331_000_3],
    [0.0, FRAC_1_SQRT_2, 0.166_925_267_711_094_6],
    [0.488_598_768_962_137, 0.520_478_658_304_368_5, 0.135_045_378_368_863_2],
    [0.790_569_415_042_094_8, 0.572_061_402_817_684_3, 0.218_508_012_224_410_55],
    [1.0, 0.0, 0.0],
    [0.925_614_793_410_958_1, 0.353_553_390_593_273_8, 0.135_045_378_368_863_2],
    [0.809_016_994_374_947_5, 0.309_016_994_374_947_4, 0.5],
    [0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [0.353_553_390_593_273_8, 1.279_168_184_004_231_3, 1.362_630_817_859_778_6],
    [1.632_721_574_597_504_3, 0.790_569_415_042_094_8, 0.572_061_402_817_684_4],
    [0.0, 1.851_229_586_821_916_4, 0.437_016_024_448_821_1],
];

/// Two nodes, and points of the edges: the curve in which a sphere and a hyperboloid meet.
fn hunt() -> Vec<[f64; 3]> {
    // 3*x² + y² - 4*z² = 12 and x² + y² + z² = 13 give 2*x² - 5*z² = -1.
    let edge = |k: i32| {
        let z = 0.46 + 0.11 * f64::from(k);
        let x2 = 0.5 * (5.0 * z * z - 1.0);
        [libm::sqrt(x2), libm::sqrt(13.0 - x2 - z * z), z]
    };
    let root = libm::sqrt(10.0);
    let nodes = [[0.0, root, 0.0], [0.0, -root, 0.0]];
    nodes.into_iter().chain((0..12).map(edge).flat_map(signs)).collect()
}

/// Whether the voxel that holds a point is stored, or all of them if it lies between several.
fn is_stored(storage: &dyn Storage, lattice: &Lattice, p: [f64; 3]) -> bool {
    let [x, y, z] = [0, 1, 2].map(|axis| {
        let holds = |&i: &u32| {
            let [low, high] = [i, i + 1].map(|i| lattice.corner(axis, i));
            (low - 1e-12..=high + 1e-12).contains(&p[axis])
        };
        (0..lattice.n_voxels()[axis]).filter(holds).collect::<Vec<u32>>()
    });
    assert!(!(x.is_empty() || y.is_empty() || z.is_empty()), "{p:?} is outside");
    let all = z.iter().flat_map(|&k| y.iter().flat_map(move |&j| [(j, k)]));
    let mut all = all.flat_map(|(j, k)| x.iter().map(move |&i| [i, j, k]));
    all.all(|ijk| storage.occupancy(ijk) == Occupancy::Surface)
}

#[test]
fn special_points_lie_in_stored_voxels() {
    for (name, _, points) in special_points() {
        let surface = published(name);
        let expr = &scene(surface).surfaces[0].expr;
        for resolution in [64, 101] {
            let lattice = lattice(surface, resolution);
            let octree = octree(expr, &lattice);
            let is_lost = |p: &[f64; 3]| !is_stored(&octree, &lattice, *p);
            let lost: Vec<_> = points.iter().copied().filter(is_lost).collect();
            assert!(lost.is_empty(), "{name} at {resolution}: {} lost, {lost:?}", lost.len());
        }
    }
}

/// The points are what they are said to be, and as many as are known.
#[test]
fn special_points_are_special() {
    let mut sampler = sampler(SimdLevel::detect());
    let counts = [
        ("kummer_quartic", 16),
        ("chmutov_quartic_12", 12),
        ("togliatti_quintic", 31),
        ("barth_sextic", 50),
        ("barth_sextic_30_cusps", 30),
        ("barth_decic", 300),
    ];
    for (name, kind, points) in special_points() {
        let known = counts.iter().find(|(known, _)| *known == name);
        assert!(known.is_none_or(|(_, n)| points.len() == *n), "{name}: {}", points.len());
        let tape = scene(published(name)).surfaces[0].expr.tape();
        let points: Vec<DVec3> = points.into_iter().map(DVec3::from_array).collect();
        let values = sampler.values(&tape, &points);
        let gradients = sampler.gradients(&tape, &points);
        for ((p, value), gradient) in points.iter().zip(values).zip(gradients) {
            assert!(kind == Limit || value.abs() < 1e-10, "{name} at {p}: {value}");
            assert!(kind != Singular || gradient.length() < 1e-9, "{name} at {p}: {gradient}");
        }
    }
}
