//! Famous surfaces as they are published, and what is known of them.

#![expect(clippy::unwrap_used, reason = "a surface that cannot be parsed is a failure")]

mod lost;
mod measured;
mod meshed;
mod singular;
mod stored;
mod symmetric;
mod thin;

use std::path::Path;

use zeroset::{
    expr::Expr,
    math::{Aabb, Lattice},
    octree::{MortonOctree, Storage},
    progress::Unwatched,
    scene::{self, Scene},
    voxelize::{Settings, voxelize},
};

use symmetric::Symmetry;

/// A surface, its named parts, half the edge of its domain, and the symmetries that it must have.
#[derive(Clone, Copy)]
struct Surface {
    name: &'static str,
    definitions: &'static [(&'static str, &'static str)],
    f: &'static str,
    reach: f64,
    symmetries: &'static [Symmetry],
}

const FLIPS: &[Symmetry] = &[[-1, 2, 3], [1, -2, 3], [1, 2, -3]];
/// All permutations are made of these.
const SWAPS: &[Symmetry] = &[[2, 1, 3], [1, 3, 2]];
/// The whole group of a cube.
const CUBE: &[Symmetry] = &[[-1, 2, 3], [1, -2, 3], [1, 2, -3], [2, 1, 3], [1, 3, 2]];
/// The group of a tetrahedron with its mirrors.
const TETRAHEDRON: &[Symmetry] = &[[-1, -2, 3], [1, -2, -3], [2, 1, 3], [1, 3, 2]];
/// Turns and mirrors about z.
const ROUND: &[Symmetry] = &[[-1, 2, 3], [-2, 1, 3]];
/// The same, and the mirror along z.
const LENS: &[Symmetry] = &[[-1, 2, 3], [-2, 1, 3], [1, 2, -3]];
const NONE: &[Symmetry] = &[];

const fn plain(
    name: &'static str,
    f: &'static str,
    reach: f64,
    symmetries: &'static [Symmetry],
) -> Surface {
    Surface { name, definitions: &[], f, reach, symmetries }
}

const PHI: (&str, &str) = ("phi", "(1+sqrt(5))/2");

const SURFACES: &[Surface] = &[
    plain("sphere", "x^2+y^2+z^2 = 1", 1.2, CUBE),
    plain("ellipsoid_321", "(x/3)^2+(y/2)^2+z^2 = 1", 3.2, FLIPS),
    plain("torus_1_04", "(x^2+y^2+z^2+1-0.16)^2 = 4*(x^2+y^2)", 1.5, LENS),
    plain("superellipsoid_4", "x^4+y^4+z^4 = 1", 1.1, CUBE),
    plain("octahedron", "|x|+|y|+|z| = 1", 1.1, CUBE),
    plain("astroidal_ellipsoid", "|x|^(2/3)+|y|^(2/3)+|z|^(2/3) = 1", 1.05, CUBE),
    plain("steinmetz_2", "max(x^2+y^2, x^2+z^2) = 1", 1.1, &[[-1, 2, 3], [1, -2, 3], [1, 3, 2]]),
    plain("steinmetz_3", "max(x^2+y^2, x^2+z^2, y^2+z^2) = 1", 1.1, CUBE),
    plain("ding_dong", "x^2+y^2 = (1-z)*z^2", 1.6, ROUND),
    plain("piriform", "x^4-x^3+y^2+z^2 = 0", 1.1, &[[1, -2, 3], [1, 2, -3], [1, 3, 2]]),
    plain("pseudosphere", "|z| = ln((1+sqrt(1-rho^2))/rho)-sqrt(1-rho^2)", 2.0, LENS),
    plain("helicoid", "x*sin(z) = y*cos(z)", 3.15, &[[-1, -2, 3], [1, -2, -3]]),
    plain("moebius_strip", "-y+x^2*y+y^3-2*x*z-2*x^2*z-2*y^2*z+y*z^2 = 0", 1.5, &[[1, -2, -3]]),
    plain(
        "heart_taubin",
        "(x^2+9/4*y^2+z^2-1)^3 = x^2*z^3+9/80*y^2*z^3",
        1.4,
        &[[-1, 2, 3], [1, -2, 3]],
    ),
    plain("distel", "x^2+y^2+z^2+2000*(x^2+y^2)*(x^2+z^2)*(y^2+z^2) = 1", 1.05, CUBE),
    plain("tanglecube", "x^4-5*x^2+y^4-5*y^2+z^4-5*z^2+11.8 = 0", 3.0, CUBE),
    plain("banchoff_chmutov_4", "8*(x^4+y^4+z^4)-8*(x^2+y^2+z^2)+3 = 0", 1.3, CUBE),
    Surface {
        name: "trefoil_knot",
        definitions: &[
            ("a", "0.58"),
            ("b", "0.41"),
            ("A", "x^2+y^2"),
            ("B", "A+1+z^2+a^2-b^2"),
            ("C", "x^3-3*x*y^2"),
            ("D", "A+1"),
            ("E", "3*x^2*y-y^3"),
        ],
        f: "(-8*A^2*B+4*a^2*(2*A^2-C*D)+8*a^2*E*z+4*a^2*C*z^2)^2 \
            = A*(2*A*B^2+8*A^2+4*a^2*(2*C-A*D)-8*a^2*E*z-4*A*a^2*z^2)^2",
        reach: 2.8,
        symmetries: &[[1, -2, -3]],
    },
    plain("hunt", "4*(x^2+y^2+z^2-13)^3+27*(3*x^2+y^2-4*z^2-12)^2 = 0", 4.5, FLIPS),
    plain("double_cone", "x^2+y^2 = z^2", 1.0, LENS),
    plain("cayley_cubic", "x^3+y^3+z^3+1 = (x+y+z+1)^3/4", 4.0, SWAPS),
    plain("cayley_cubic, other form", "4*(x^2+y^2+z^2)+16*x*y*z = 1", 1.5, TETRAHEDRON),
    plain(
        "clebsch_cubic",
        "81*(x^3+y^3+z^3)-189*(x^2*y+x^2*z+y^2*x+y^2*z+z^2*x+z^2*y)+54*x*y*z\
         +126*(x*y+x*z+y*z)-9*(x^2+y^2+z^2)-9*(x+y+z)+1 = 0",
        2.0,
        SWAPS,
    ),
    plain(
        "kummer_quartic",
        "(x^2+y^2+z^2-1.69)^2 = (3*1.69-1)/(3-1.69)*(1-z-sqrt(2)*x)*(1-z+sqrt(2)*x)\
         *(1+z+sqrt(2)*y)*(1+z-sqrt(2)*y)",
        3.0,
        &[[-1, 2, 3], [1, -2, 3]],
    ),
    Surface {
        name: "chmutov_quartic_12",
        definitions: &[("X", "8*x^4-8*x^2+1"), ("Y", "8*y^4-8*y^2+1"), ("Z", "8*z^4-8*z^2+1")],
        f: "X+Y+Z+1 = 0",
        reach: 1.3,
        symmetries: CUBE,
    },
    Surface {
        name: "togliatti_quintic",
        definitions: &[
            ("P2", "cos(2*pi/5)*x-sin(2*pi/5)*y-z"),
            ("P4", "cos(4*pi/5)*x-sin(4*pi/5)*y-z"),
            ("P6", "cos(6*pi/5)*x-sin(6*pi/5)*y-z"),
            ("P8", "cos(8*pi/5)*x-sin(8*pi/5)*y-z"),
        ],
        f: "(1-sqrt(5-sqrt(5))/2*z)*(x^2+y^2-1+(1+3*sqrt(5))/4*z^2)^2 \
            = 3.8496061120482923*(x-z)*P2*P4*P6*P8",
        reach: 3.0,
        symmetries: NONE,
    },
    Surface {
        name: "barth_sextic",
        definitions: &[PHI],
        f: "4*(phi^2*x^2-y^2)*(phi^2*y^2-z^2)*(phi^2*z^2-x^2) = (1+2*phi)*(x^2+y^2+z^2-1)^2",
        reach: 1.8,
        symmetries: FLIPS,
    },
    Surface {
        name: "barth_sextic_30_cusps",
        definitions: &[PHI],
        f: "4*(phi^2*x^2-y^2)*(phi^2*y^2-z^2)*(phi^2*z^2-x^2) = (1+2*phi)*(x^2+y^2+z^2-1)^3",
        reach: 1.8,
        symmetries: FLIPS,
    },
    Surface {
        name: "barth_decic",
        definitions: &[PHI],
        f: "8*(x^2-phi^4*y^2)*(y^2-phi^4*z^2)*(z^2-phi^4*x^2)\
            *(x^4+y^4+z^4-2*x^2*y^2-2*x^2*z^2-2*y^2*z^2)\
            +(3+5*phi)*(x^2+y^2+z^2-1)^2*(x^2+y^2+z^2-(2-phi))^2 = 0",
        reach: 2.0,
        symmetries: FLIPS,
    },
    plain("whitney_umbrella", "x^2 = y^2*z", 1.5, &[[-1, 2, 3], [1, -2, 3]]),
    plain("steiner_roman", "x^2*y^2+y^2*z^2+z^2*x^2 = x*y*z", 0.7, TETRAHEDRON),
    plain(
        "klein_bottle",
        "(x^2+y^2+z^2+2*y-1)*((x^2+y^2+z^2-2*y-1)^2-8*z^2)+16*x*z*(x^2+y^2+z^2-2*y-1) = 0",
        4.0,
        &[[-1, 2, -3]],
    ),
    plain(
        "boy_surface",
        "64*(1-z)^3*z^3-48*(1-z)^2*z^2*(3*x^2+3*y^2+2*z^2)\
         +12*(1-z)*z*(27*(x^2+y^2)^2-24*z^2*(x^2+y^2)+36*sqrt(2)*y*z*(y^2-3*x^2)+4*z^4)\
         +(9*x^2+9*y^2-2*z^2)*(-81*(x^2+y^2)^2-72*z^2*(x^2+y^2)\
         +108*sqrt(2)*x*z*(x^2-3*y^2)+4*z^4) = 0",
        2.0,
        NONE,
    ),
    plain("seed_pod", "(x^2+y^2+z^2-1.43^2)*x*y*z = 0.07", 1.7, TETRAHEDRON),
    plain(
        "gyroid",
        "sin(x)*cos(y)+sin(y)*cos(z)+sin(z)*cos(x) = 0",
        3.2,
        &[[2, 3, 1], [-1, -2, -3]],
    ),
    plain("schwarz_P", "cos(x)+cos(y)+cos(z) = 0", 3.2, CUBE),
    plain("schwarz_D", "cos(x)*cos(y)*cos(z) = sin(x)*sin(y)*sin(z)", 3.2, TETRAHEDRON),
    plain("stolte_kaufman_scene_2", "r = sin(4*theta)*sin(8*phi)", 1.0, &[[-2, 1, 3], [1, -2, -3]]),
    plain("stolte_kaufman_scene_3", "r = sin(3*theta)*sin(4*phi)", 1.0, &[[-1, 2, 3], [1, -2, -3]]),
];

/// The surface as a scene file.
fn scene(surface: &Surface) -> Scene {
    let definitions: String =
        surface.definitions.iter().map(|(name, f)| format!("{name} = \"{f}\"\n")).collect();
    let text =
        format!("version = 1\n[let]\n{definitions}[[surface]]\nf = \"\"\"{}\"\"\"\n", surface.f);
    scene::parse(Path::new("surface.toml"), &text)
        .unwrap_or_else(|rejection| panic!("{}: {:?}", surface.name, rejection.diagnostics))
}

fn lattice(surface: &Surface, resolution: u32) -> Lattice {
    let reach = [surface.reach; 3];
    let domain = Aabb { min: reach.map(|r| -r).into(), max: reach.into() };
    Lattice::new(domain, resolution)
}

fn octree(expr: &Expr, lattice: &Lattice) -> MortonOctree {
    voxelize(expr, lattice, &Settings::default(), &Unwatched).unwrap().octree
}

#[test]
fn every_surface_is_found() {
    for surface in SURFACES {
        let octree = octree(&scene(surface).surfaces[0].expr, &lattice(surface, 48));
        // A surface across the domain meets about as many voxels as a face of the lattice has. Some
        // formulas keep many more than that, but none keeps everything.
        let all = 48 * 48 * 48;
        let n = octree.voxel_count();
        assert!((300..all).contains(&n), "{}: {n}", surface.name);
    }
}
