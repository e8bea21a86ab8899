//! POV-Ray's functions: the values that POV-Ray gives, those of its definitions, and enclosures of them.
//!
//! The definitions here are written as POV-Ray's program goes about them, with its branches and
//! remainders; the formulas under test know none of these.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]
#![expect(clippy::disallowed_methods, reason = "compared within a tolerance")]
#![expect(clippy::too_many_lines, reason = "a table of all functions")]

use std::{
    collections::BTreeSet,
    f64::consts::{FRAC_PI_3, FRAC_PI_6, PI, TAU},
};

use glam::DVec3;
use zeroset::{
    eval::Machine,
    expr::{Expr, Tape, parse},
    math::{Aabb, Interval, Lattice, Notes, Number, Point},
    octree::Storage as _,
    progress::Unwatched,
    voxelize::{Settings, voxelize},
};

/// A function of x, y, z and further arguments.
type Definition = fn(f64, f64, f64, &[f64]) -> f64;

/// A function with arguments, the level at which it has a surface, and half the edge of a cube around it.
struct Case {
    name: &'static str,
    arguments: &'static [f64],
    level: f64,
    reach: f64,
    definition: Definition,
}

const fn case(
    name: &'static str,
    arguments: &'static [f64],
    (level, reach): (f64, f64),
    definition: Definition,
) -> Case {
    Case { name, arguments, level, reach, definition }
}

/// The values of most functions end at -10 and 10.
fn field(strength: f64, value: f64) -> f64 {
    (strength * value).clamp(-10.0, 10.0)
}

/// A solid of revolution of a curve, or a cylinder along z: the curve's coordinates.
fn turned(x: f64, y: f64, z: f64, [sor, offset, angle]: [f64; 3]) -> (f64, f64) {
    if sor <= 0.0 {
        return (x, y);
    }
    let from = (x * x + z * z).sqrt() - offset;
    let (sin, cos) = angle.to_radians().sin_cos();
    (from * cos - y * sin, from * sin + y * cos)
}

fn last_three(p: &[f64]) -> [f64; 3] {
    p[p.len() - 3..].try_into().unwrap()
}

/// Coordinates of a curve whose switch, offset and angle are the last arguments.
fn curve(x: f64, y: f64, z: f64, p: &[f64]) -> (f64, f64) {
    turned(x, y, z, last_three(p))
}

/// The remainder of C, then from 0 to `whole`, less half of that.
fn wrapped(value: f64, whole: f64) -> f64 {
    let rest = value % whole;
    if rest < 0.0 { rest + whole / 2.0 } else { rest - whole / 2.0 }
}

fn section(a: f64, b: f64, shape: f64) -> f64 {
    if shape == 1.0 {
        (a * a + b * b).sqrt()
    } else if shape == 0.0 {
        a.abs().max(b.abs())
    } else {
        let power = 2.0 / shape;
        (a.abs().powf(power) + b.abs().powf(power)).powf(shape * 0.5)
    }
}

fn three_ellipsoids(x: f64, y: f64, z: f64, e: f64, s: f64) -> [f64; 3] {
    let (x2, y2, z2) = (x * x, y * y, z * z);
    [
        (-(x2 * e + y2 * e + z2) * s).exp(),
        (-(x2 * e + y2 + z2 * e) * s).exp(),
        (-(x2 + y2 * e + z2 * e) * s).exp(),
    ]
}

/// Which hexagon (x, y) is in: coordinates from its middle, folded, and their angle.
fn hexagon(x: f64, y: f64) -> (f64, f64, f64) {
    let half = 3_f64.sqrt() / 2.0;
    let mut a = (x.abs() % 3_f64.sqrt() - half).abs();
    let mut b = (y.abs() % 3.0 - 1.5).abs();
    let (c, d) = (half - a, 1.5 - b);
    if a * a + b * b > c * c + d * d {
        (a, b) = (c, d);
    }
    (a, b, b.atan2(a))
}

fn cushion(x: f64, y: f64, z: f64, p: &[f64]) -> f64 {
    let (x2, y2, z2) = (x * x, y * y, z * z);
    let r = z2 * x2 - z2 * z2 - 2.0 * z * x2 + 2.0 * z2 * z + x2
        - z2
        - (x2 - z) * (x2 - z)
        - y2 * y2
        - 2.0 * x2 * y2
        - y2 * z2
        + 2.0 * y2 * z
        + y2;
    field(p[0], r)
}

fn mesh(x: f64, y: f64, z: f64, p: &[f64]) -> f64 {
    let thread = |along: f64, across: f64, spacing: f64, over: f64, sign: f64| {
        let mut r = along % (spacing * 2.0);
        if r < 0.0 {
            r += spacing * 2.0;
        }
        let r = (r - spacing).abs() * p[2];
        let h = (y + sign * (across * PI / over).cos() * p[3]) * p[4];
        -(h * h + r * r).sqrt()
    };
    let threads = [
        thread(x, z, p[0], p[1], -1.0),
        thread(x - p[0], z, p[0], p[1], 1.0),
        thread(z, x, p[1], p[0], 1.0),
        thread(z - p[1], x, p[1], p[0], -1.0),
    ];
    -threads.into_iter().fold(f64::NEG_INFINITY, f64::max)
}

fn helix1(x: f64, y: f64, z: f64, p: &[f64]) -> f64 {
    let r = (x * x + z * z).sqrt();
    let turn = z.atan2(x);
    let wind = wrapped(turn * p[0] + y * p[1] * p[0], TAU) / p[4] / (p[1] * p[0]);
    let out = r - p[3];
    let (sin, cos) = p[6].to_radians().sin_cos();
    let across = match p[5] {
        1.0 => section(out, wind, 1.0),
        shape => section(out * cos - wind * sin, out * sin + wind * cos, shape),
    };
    -p[2] + (p[3] + r).min(across)
}

fn spiral(x: f64, y: f64, z: f64, p: &[f64]) -> f64 {
    let r = (x * x + z * z).sqrt() + p[0] * z.atan2(x) / TAU;
    let wind = r % p[0] - p[0] * 0.5;
    let ball = (x * x + y * y + z * z).sqrt();
    -(p[2] - ball).min(p[1] - section(wind, y, p[5]).min(ball))
}

fn helical_torus(x: f64, y: f64, z: f64, p: &[f64]) -> f64 {
    let ring = (x * x + z * z).sqrt();
    let turn = x.atan2(z);
    let around = (ring - p[0]).atan2(y);
    let r = ((ring - p[0]).powi(2) + y * y).sqrt();
    let wind = wrapped(turn * p[1] + around * p[2], TAU);
    let groove = (wind * p[8]).atan2(r - p[5]);
    let groove = (groove * p[7] + turn * p[9]).cos() * p[3] + p[4];
    let tube = ((r - p[5]).powi(2) + wind * wind * p[6]).sqrt().min(r + p[5]);
    -(p[4] + p[5] - p[0] - ring).max(groove - tube)
}

fn cases() -> Vec<Case> {
    vec![
        case("f_algbr_cyl1", &[1.0, 5.0, 0.0, 0.0, 0.0], (0.0, 2.0), |x, y, z, p| {
            let (a, b) = curve(x, y, z, p);
            let r = -(a * a * a.abs() - a * a + b * b);
            -p[1].min((p[0] * r).max(-p[1]))
        }),
        case("f_algbr_cyl1", &[1.0, 5.0, 1.0, 0.5, 30.0], (0.0, 2.0), |x, y, z, p| {
            let (a, b) = curve(x, y, z, p);
            let r = -(a * a * a.abs() - a * a + b * b);
            -p[1].min((p[0] * r).max(-p[1]))
        }),
        case("f_algbr_cyl2", &[1.0, 5.0, 1.0, 0.0, 0.0], (0.0, 2.0), |x, y, z, p| {
            let (a, b) = curve(x, y, z, p);
            let (a2, b2) = (a * a, b * b);
            let r = -(2.0 * a2 * a2 - 3.0 * a2 * b + b2 - 2.0 * b2 * b + b2 * b2);
            p[1].min((p[0] * r).max(-p[1]))
        }),
        case("f_algbr_cyl3", &[2.0, 5.0, 1.0, 1.0, 45.0], (0.0, 2.0), |x, y, z, p| {
            let (a, b) = curve(x, y, z, p);
            let (a2, b2) = (a * a, b * b);
            let r = -(a2 * a2 + a2 * b2 - 2.0 * a2 * b - a * b2 + b2);
            p[1].min((p[0] * r).max(-p[1]))
        }),
        case("f_algbr_cyl4", &[-1.0, 5.0, 1.0, 0.0, -20.0], (0.0, 2.0), |x, y, z, p| {
            let (a, b) = curve(x, y, z, p);
            let (a2, b2) = (a * a, b * b);
            let r = -(a2 * a2 + b2 * b2 + 2.0 * a2 * b2 + 3.0 * a2 * b - b2 * b);
            p[1].min((p[0] * r).max(-p[1]))
        }),
        case("f_bicorn", &[-1.0, 1.0], (0.0, 2.0), |x, y, z, p| {
            let (q, s) = (x * x + z * z, p[1] * p[1]);
            let r = q + 2.0 * p[1] * y - s;
            field(p[0], y * y * (s - q) - r * r)
        }),
        case("f_bifolia", &[-1.0, 3.0], (0.0, 2.0), |x, y, z, p| {
            let s = x * x + y * y + z * z;
            field(p[0], -(s * s - p[1] * (x * x + z * z) * y))
        }),
        case("f_blob", &[1.0, 1.0, 1.1, 0.8, 0.9], (-0.4, 2.0), |x, y, z, p| {
            let ball = |from: f64, strength: f64, inverse: f64| {
                let q = ((x + from).powi(2) + y * y + z * z) * inverse * inverse;
                let q = if q > 1.0 { 1.0 } else { q };
                strength * (1.0 - q) * (1.0 - q)
            };
            -(ball(p[0] * 0.5, p[1], p[2]) + ball(-p[0] * 0.5, p[3], p[4]))
        }),
        case("f_blob2", &[1.5, 2.0, 2.0, 1.0], (0.0, 3.0), |x, y, z, p| {
            let first = (-(x * x + y * y + z * z) * p[1]).exp();
            let second = (-((x - p[0]).powi(2) + y * y + z * z) * p[1]).exp();
            p[3] - (first + second) * p[2]
        }),
        case("f_boy_surface", &[-1e-3, 1.0], (0.0, 2.0), |x, y, z, p| {
            let (x2, y2, z2, root) = (x * x, y * y, z * z, 2_f64.sqrt());
            let (h, ph) = (1.0 - z, x2 + y2);
            let r = 64.0 * h * h * h * z2 * z
                - 48.0 * h * h * z2 * (3.0 * x2 + 3.0 * y2 + 2.0 * z2)
                + 12.0
                    * h
                    * z
                    * (27.0 * ph * ph - 24.0 * z2 * ph
                        + 36.0 * root * y * z * (y2 - 3.0 * x2)
                        + 4.0 * z2 * z2)
                + (9.0 * x2 + 9.0 * y2 - 2.0 * z2)
                    * (-81.0 * ph * ph - 72.0 * z2 * ph
                        + 108.0 * root * x * z * (x2 - 3.0 * y2)
                        + 4.0 * z2 * z2);
            field(p[0], p[1] * r)
        }),
        case("f_comma", &[1.2], (0.0, 2.0), |x, y, z, p| {
            let r = ((x + p[0] * 0.25).powi(2) + z * z).sqrt();
            let tail =
                (z.atan2(x) * 0.5).cos() * p[0] * 0.5 - ((r - p[0] * 0.75).powi(2) + y * y).sqrt();
            let head = p[0] * 0.5 - ((x - p[0] * 0.5).powi(2) + z * z + y * y).sqrt();
            -z.min(tail).max(head)
        }),
        case("f_cross_ellipsoids", &[0.1, 1.0, 1.0, 0.5], (0.0, 4.0), |x, y, z, p| {
            let [a, b, c] = three_ellipsoids(x, y, z, p[0], p[1]);
            p[3] - a.max(b).max(c) * p[2]
        }),
        case("f_crossed_trough", &[1.0], (0.0, 2.0), |x, y, z, p| field(p[0], x * x * z * z - y)),
        case("f_cubic_saddle", &[1.0], (0.0, 2.0), |x, y, z, p| {
            field(p[0], -(x * x * x - y * y * y - z))
        }),
        case("f_cushion", &[-1.0], (0.0, 2.0), cushion),
        case("f_devils_curve", &[-1.0], (0.0, 2.0), |x, y, z, p| {
            let (x2, y2, z2) = (x * x, y * y, z * z);
            let r = x2 * x2 + 2.0 * x2 * z2 - 0.36 * x2 - y2 * y2 + 0.25 * y2 + z2 * z2;
            field(p[0], -r)
        }),
        case("f_devils_curve_2d", &[-1.0, 1.0, 0.8, 1.0, 0.3, 15.0], (0.0, 2.0), |x, y, z, p| {
            let (a, b) = curve(x, y, z, p);
            let (a2, b2) = (a * a, b * b);
            field(p[0], -(a2 * (a2 - p[1] * p[1]) - b2 * (b2 - p[2] * p[2])))
        }),
        case("f_dupin_cyclid", &[-1e-4, 6.0, 0.5, 3.0, 0.2, 3.0], (0.0, 4.0), |x, y, z, p| {
            let (x2, y2, z2) = (x * x, y * y, z * z);
            let (i, ph, th) = (p[5] * p[5], p[2] * p[2], p[4] * p[4]);
            let p1 = ph - th - (p[3] + p[1]) * (p[3] + p[1]);
            let p2 = ph - th - (p[3] - p[1]) * (p[3] - p[1]);
            let (p3, p4) = (p[3] * p[3], p[1] * p[1]);
            let r = p1 * p2 * (x2 * x2 + y2 * y2 + z2 * z2)
                + 2.0 * (p1 * p2 * (x2 * y2 + x2 * z2 + y2 * z2))
                + 2.0
                    * i
                    * ((-th - p3 + ph + p4) * (2.0 * x * p[3] + 2.0 * y * p[4] - i)
                        - 4.0 * p[4] * ph * y)
                    * (x2 + y2 + z2)
                + 4.0 * i * i * (p[3] * x + p[4] * y) * (-i + p[4] * y + p[3] * x)
                + 4.0 * i * i * p4 * y2
                + i * i * i * i;
            field(p[0], -r)
        }),
        case("f_ellipsoid", &[1.0, 0.7, 1.5], (1.0, 2.0), |x, y, z, p| {
            (x * x * p[0] * p[0] + y * y * p[1] * p[1] + z * z * p[2] * p[2]).sqrt()
        }),
        case("f_enneper", &[1.0], (0.0, 4.0), |x, y, z, p| {
            let (x2, y2, z2) = (x * x, y * y, z * z);
            let z = if z.abs() < 0.2 { 0.2 } else { z };
            let r = (y2 - x2) / (2.0 * z) + 2.0 * z2 / 9.0 + 2.0 / 3.0;
            let s = (y2 - x2) / (4.0 * z) - 0.25 * (x2 + y2 + 8.0 / 9.0 * z2) + 2.0 / 9.0;
            field(p[0], -(r * r * r - 6.0 * s * s))
        }),
        case("f_flange_cover", &[0.01, 3.0, 0.8, 1.0], (0.0, 4.0), |x, y, z, p| {
            p[3] - three_ellipsoids(x, y, z, p[0], p[1]).iter().sum::<f64>() * p[2]
        }),
        case("f_folium_surface", &[1.0, 1.0, 1.0], (0.0, 2.0), |x, y, z, p| {
            let q = y * y + z * z;
            field(p[0], q * (1.0 + (p[2] - 4.0 * p[1]) * x) + x * x * (1.0 + p[2]))
        }),
        case("f_folium_surface_2d", &[-1.0, 2.0, 1.0, 1.0, 0.5, 60.0], (0.0, 2.0), |x, y, z, p| {
            let (a, b) = curve(x, y, z, p);
            let r = b * b * (1.0 + (p[2] - 4.0 * p[1]) * a) + a * a * (1.0 + p[2]);
            field(p[0], -r)
        }),
        case("f_glob", &[-1.0], (0.0, 2.0), |x, y, z, p| {
            let x2 = x * x;
            field(p[0], 0.5 * x2 * x2 * x + 0.5 * x2 * x2 - (y * y + z * z))
        }),
        case("f_heart", &[-1.0], (0.0, 2.0), |x, y, z, p| {
            let (x2, y2, z2) = (x * x, y * y, z * z);
            let q = 2.0 * x2 + y2 + z2 - 1.0;
            field(p[0], -(q * q * q - 0.1 * x2 * z2 * z - y2 * z2 * z))
        }),
        case(
            "f_helical_torus",
            &[1.3, 8.0, 1.0, 0.1, 0.2, 0.3, 0.2, 3.0, 1.0, 2.0],
            (0.0, 2.5),
            helical_torus,
        ),
        case("f_helix1", &[2.0, 4.0, 0.15, 1.0, 1.0, 1.0, 0.0], (0.0, 2.0), helix1),
        case("f_helix1", &[1.0, 5.0, 0.2, 1.0, 1.5, 0.0, 30.0], (0.0, 2.0), helix1),
        case("f_helix1", &[3.0, 3.0, 0.15, 1.0, 1.0, 0.5, 0.0], (0.0, 2.0), helix1),
        case("f_helix2", &[0.0, 4.0, 0.5, 0.3, 0.0, 0.0, 0.0], (0.0, 2.0), |x, y, z, p| {
            let (sin, cos) = (y * p[1]).sin_cos();
            let (a, b) = (x - p[3] * cos, z - p[3] * sin);
            section(a * cos + b * sin, -a * sin + b * cos, p[5]) - p[2]
        }),
        case("f_hex_x", &[0.0], (0.5, 4.0), |x, y, _, _| {
            let (a, b, angle) = hexagon(x, y);
            if angle < FRAC_PI_6 { a } else { FRAC_PI_3.cos() * a + FRAC_PI_3.sin() * b }
        }),
        case("f_hex_y", &[0.0], (0.3, 4.0), |x, y, _, _| {
            let (a, b, angle) = hexagon(x, y);
            if angle < FRAC_PI_6 { b } else { (-FRAC_PI_3.sin() * a + FRAC_PI_3.cos() * b).abs() }
        }),
        case("f_hunt_surface", &[-1e-3], (0.0, 5.0), |x, y, z, p| {
            let (x2, y2, z2) = (x * x, y * y, z * z);
            let (q, s) = (x2 + y2 + z2 - 13.0, 3.0 * x2 + y2 - 4.0 * z2 - 12.0);
            field(p[0], -(4.0 * q * q * q + 27.0 * s * s))
        }),
        case("f_hyperbolic_torus", &[-1.0, 0.6, 0.4], (0.0, 2.0), |x, y, z, p| {
            let (x2, y2, z2) = (x * x, y * y, z * z);
            let (ph, th) = (p[1] * p[1], p[2] * p[2]);
            let r = x2 * x2 + 2.0 * x2 * y2 - 2.0 * x2 * z2 - 2.0 * (ph + th) * x2 + y2 * y2
                - 2.0 * y2 * z2
                + 2.0 * (ph - th) * y2
                + z2 * z2
                + 2.0 * (ph + th) * z2
                + (ph - th) * (ph - th);
            field(p[0], -r)
        }),
        case("f_isect_ellipsoids", &[0.1, 1.0, 1.0, 0.5], (0.0, 2.0), |x, y, z, p| {
            let [a, b, c] = three_ellipsoids(x, y, z, p[0], p[1]);
            p[3] - a.min(b).min(c) * p[2]
        }),
        case("f_kampyle_of_eudoxus", &[-1.0, 0.2, 1.0], (0.0, 2.0), |x, y, z, p| {
            let (x2, c) = (x * x, p[2] * p[2]);
            field(p[0], -((y * y + z * z) - c * x2 * x2 + c * p[1] * p[1] * x2))
        }),
        case(
            "f_kampyle_of_eudoxus_2d",
            &[-1.0, 0.4, 1.5, 1.0, 0.0, 25.0],
            (0.0, 2.0),
            |x, y, z, p| {
                let (a, b) = curve(x, y, z, p);
                let (a2, c) = (a * a, p[2] * p[2]);
                field(p[0], -(b * b - c * a2 * a2 + c * p[1] * p[2] * a2))
            },
        ),
        case("f_klein_bottle", &[-1.0], (0.0, 5.0), |x, y, z, p| {
            let (x2, y2, z2) = (x * x, y * y, z * z);
            let (a, b) = (x2 + y2 + z2 + 2.0 * y - 1.0, x2 + y2 + z2 - 2.0 * y - 1.0);
            field(p[0], -(a * (b * b - 8.0 * z2) + 16.0 * x * z * b))
        }),
        case("f_kummer_surface_v1", &[-1.0], (0.0, 3.0), |x, y, z, p| {
            let (x2, y2, z2) = (x * x, y * y, z * z);
            let r = x2 * x2 + y2 * y2 + z2 * z2 - x2 - y2 - z2 - x2 * y2 - x2 * z2 - y2 * z2 + 1.0;
            field(p[0], -r)
        }),
        case("f_kummer_surface_v2", &[-1.0, -1.3, -1.0, 0.4], (0.0, 3.0), |x, y, z, p| {
            let (x2, y2, z2) = (x * x, y * y, z * z);
            let r = x2 * x2
                + y2 * y2
                + z2 * z2
                + p[1] * (x2 + y2 + z2)
                + p[2] * (x2 * y2 + x2 * z2 + y2 * z2)
                + p[3] * x * y * z
                - 1.0;
            field(p[0], -r)
        }),
        case("f_lemniscate_of_gerono", &[-1.0], (0.0, 2.0), |x, y, z, p| {
            let x2 = x * x;
            field(p[0], -(x2 * x2 - x2 + y * y + z * z))
        }),
        case(
            "f_lemniscate_of_gerono_2d",
            &[-1.0, 1.2, 0.7, 1.0, 0.2, 80.0],
            (0.0, 2.0),
            |x, y, z, p| {
                let (a, b) = curve(x, y, z, p);
                let (a2, w) = (a * a, p[2] * p[2]);
                field(p[0], -(b * b - w * p[1] * p[1] * a2 + w * a2 * a2))
            },
        ),
        case("f_mesh1", &[0.5, 0.6, 1.0, 0.1, 1.2], (0.1, 1.0), mesh),
        case("f_mitre", &[-1.0], (0.0, 2.0), |x, y, z, p| {
            let (x2, y2, z2) = (x * x, y * y, z * z);
            field(p[0], -(4.0 * x2 * (x2 + y2 + z2) - y2 * (1.0 - y2 - z2)))
        }),
        case("f_nodal_cubic", &[-1.0], (0.0, 2.0), |_, y, z, p| {
            field(p[0], -(y * y * y + z * z * z - 6.0 * y * z))
        }),
        case("f_odd", &[-1.0], (0.0, 2.0), cushion),
        case("f_ovals_of_cassini", &[-1.0, 0.5, 0.24, 6.0], (0.0, 2.0), |x, y, z, p| {
            let (x2, z2, m) = (x * x, z * z, p[1] * p[1]);
            let r = x2 + y * y + z2 + m;
            field(p[0], -(r * r - p[3] * m * (x2 + z2) - p[2] * p[2]))
        }),
        case("f_paraboloid", &[-1.0], (0.0, 2.0), |x, y, z, p| field(p[0], -(x * x - y + z * z))),
        case("f_parabolic_torus", &[-1.0, 0.6, 0.5], (0.0, 2.0), |x, y, z, p| {
            let (x2, y2, z2) = (x * x, y * y, z * z);
            let (ph, th) = (p[1] * p[1], p[2] * p[2]);
            let r = x2 * x2 + 2.0 * x2 * y2 - 2.0 * x2 * z - (ph + th) * x2 + y2 * y2
                - 2.0 * y2 * z
                + (ph - th) * y2
                + z2
                + (ph + th) * z
                + (ph - th) * (ph - th);
            field(p[0], -r)
        }),
        case("f_ph", &[], (0.7, 2.0), |x, y, z, _| (x * x + z * z).sqrt().atan2(y)),
        case("f_pillow", &[1.0], (0.0, 2.0), |x, y, z, p| {
            let (x2, y2, z2) = (x * x, y * y, z * z);
            field(p[0], x2 * x2 + y2 * y2 + z2 * z2 - (x2 + y2 + z2))
        }),
        case("f_piriform", &[1.0], (0.0, 2.0), |x, y, z, p| {
            let x2 = x * x;
            let r = -((x2 * x2 - x2 * x) + y * y + z * z);
            -(p[0] * r).clamp(-10.0, 10.0)
        }),
        case("f_piriform_2d", &[-1.0, 1.0, -1.0, 1.0, 1.0, 0.3, 20.0], (0.0, 2.0), |x, y, z, p| {
            let (a, b) = curve(x, y, z, p);
            let (a2, w) = (a * a, p[3] * p[3]);
            field(p[0], -(b * b - p[1] * w * a2 * a - p[2] * w * a2 * a2))
        }),
        case("f_poly4", &[0.5, 0.1, 0.3, -0.1, -0.4], (0.0, 2.0), |x, y, z, p| {
            let y2 = y * y;
            let r = p[0] + p[1] * y + p[2] * y2 + p[3] * y2 * y + p[4] * y2 * y2;
            let r = if r < -5.0 { -5.0 } else { r };
            -r + (x * x + z * z).sqrt()
        }),
        case("f_polytubes", &[5.0, 0.8, 0.1, 0.2, 0.0, -0.1], (0.2, 2.0), |x, y, z, p| {
            let y2 = y * y;
            let r = p[1] + p[2] * y + p[3] * y2 + p[4] * y2 * y + p[5] * y2 * y2;
            let mut nearest = -10_000_f64;
            for i in 0..p[0] as i32 {
                let (sin, cos) = (TAU / p[0] * f64::from(i)).sin_cos();
                let (a, b) = (x - r * sin, z - r * cos);
                nearest = nearest.max(-(a * a + b * b).sqrt());
            }
            -nearest
        }),
        case("f_quantum", &[0.0], (0.0, 5.0), |x, y, z, _| {
            let r = (x * x + z * z).sqrt();
            let cos = r.atan2(y).cos();
            let r = (r * r + y * y).sqrt() * 2.0;
            let wave = r * r * (-r * 0.333_333_33).exp() * (3.0 * cos * cos - 1.0);
            (wave * wave - 12.0) * -0.1
        }),
        case("f_quartic_paraboloid", &[-1.0], (0.0, 2.0), |x, y, z, p| {
            field(p[0], -(x.powi(4) + z.powi(4) - y))
        }),
        case("f_quartic_saddle", &[-1.0], (0.0, 2.0), |x, y, z, p| {
            field(p[0], -(x.powi(4) - z.powi(4) - y))
        }),
        case("f_quartic_cylinder", &[-1.0, 1.0, 0.5], (0.0, 2.0), |x, y, z, p| {
            let (q, w) = (x * x + z * z, p[2] * p[2]);
            field(p[0], -(q * y * y + w * q - w * p[1] * p[1]))
        }),
        case("f_r", &[], (1.0, 2.0), |x, y, z, _| (x * x + y * y + z * z).sqrt()),
        case("f_rounded_box", &[0.2, 1.0, 0.8, 0.6], (0.0, 2.0), |x, y, z, p| {
            let beyond = |v: f64, half: f64| {
                let (inner, outer) = (half - p[0], p[0] - half);
                let above = if v < inner { 0.0 } else { v - inner };
                let below = if v > outer { 0.0 } else { outer - v };
                above.max(below)
            };
            let [a, b, c] = [beyond(x, p[1]), beyond(y, p[2]), beyond(z, p[3])];
            -p[0] + (a * a + b * b + c * c).sqrt() - 1e-6
        }),
        case("f_sphere", &[1.2], (0.0, 2.0), |x, y, z, p| -p[0] + (x * x + y * y + z * z).sqrt()),
        case("f_spikes", &[0.05, 2.0, -1.0, 1.0, 2.0], (-0.4, 2.0), |x, y, z, p| {
            let [a, b, c] = three_ellipsoids(x, y, z, p[0], p[1]);
            let r = (-(x * x + y * y + z * z) * p[3]).exp() * p[4] - a - b - c;
            -r * p[2]
        }),
        case("f_spikes_2d", &[1.0, 4.0, 3.0, 0.5], (0.0, 2.0), |x, y, z, p| {
            -(p[0] * (p[1] * x).cos() * (p[2] * z).cos() * (-p[3] * (x * x + z * z)).exp() - y)
        }),
        case("f_spiral", &[0.6, 0.15, 1.8, 0.0, 0.0, 1.0], (0.0, 2.0), spiral),
        case("f_spiral", &[0.7, 0.2, 1.5, 0.0, 0.0, 0.0], (0.0, 2.0), spiral),
        case("f_spiral", &[0.5, 0.1, 1.5, 0.0, 0.0, 0.6], (0.0, 2.0), spiral),
        case("f_steiners_roman", &[-1.0], (0.0, 1.0), |x, y, z, p| {
            let (x2, y2, z2) = (x * x, y * y, z * z);
            field(p[0], -(x2 * y2 + x2 * z2 + y2 * z2 + x * y * z))
        }),
        case("f_strophoid", &[-1.0, 1.0, 0.3, 1.2], (0.0, 2.0), |x, y, z, p| {
            let (x2, w) = (x * x, p[3] * p[3]);
            field(p[0], -((p[2] - x) * (y * y + z * z) - w * p[1] * x2 - w * x2 * x))
        }),
        case("f_strophoid_2d", &[-1.0, 1.0, 0.3, 1.2, 1.0, 0.4, 10.0], (0.0, 2.0), |x, y, z, p| {
            let (a, b) = curve(x, y, z, p);
            let (a2, w) = (a * a, p[3] * p[3]);
            field(p[0], -((p[2] - a) * b * b - w * p[1] * a2 - w * a2 * a))
        }),
        case("f_superellipsoid", &[0.5, 1.5], (0.0, 2.0), |x, y, z, p| {
            let (e, n) = (2.0 / p[0], 1.0 / p[1]);
            let ring = (x.abs().powf(e) + y.abs().powf(e)).powf(p[0] * n);
            1.0 - (ring + z.abs().powf(2.0 * n)).powf(p[1] * 0.5)
        }),
        case("f_th", &[], (0.7, 2.0), |x, _, z, _| x.atan2(z)),
        case("f_torus", &[1.1, 0.4], (0.0, 2.0), |x, y, z, p| {
            let out = (x * x + z * z).sqrt() - p[0];
            -p[1] + (out * out + y * y).sqrt()
        }),
        case("f_torus2", &[-1.0, 1.1, 0.4], (0.0, 2.0), |x, y, z, p| {
            let (x2, y2, z2) = (x * x, y * y, z * z);
            let (ph, th) = (p[1] * p[1], p[2] * p[2]);
            let r = x2 * x2 + y2 * y2 + z2 * z2 + 2.0 * x2 * y2 + 2.0 * x2 * z2 + 2.0 * y2 * z2
                - 2.0 * (ph + th) * x2
                + 2.0 * (ph - th) * y2
                - 2.0 * (ph + th) * z2
                + (ph - th) * (ph - th);
            field(p[0], -r)
        }),
        case("f_torus_gumdrop", &[-1.0], (0.0, 3.0), |x, y, z, p| {
            let (x2, q) = (x * x, y * y + z * z);
            field(p[0], -(4.0 * (x2 * x2 + q * q) + 17.0 * x2 * q - 20.0 * (x2 + q) + 17.0))
        }),
        case("f_umbrella", &[-1.0], (0.0, 2.0), |x, y, z, p| field(p[0], -(x * x - y * z * z))),
        case("f_witch_of_agnesi", &[-1.0, 0.3], (0.0, 2.0), |x, y, z, p| {
            field(p[0], -(p[1] * (y - 1.0) + (x * x + z * z) * y))
        }),
        case(
            "f_witch_of_agnesi_2d",
            &[-1.0, 0.4, 0.3, 1.0, 0.5, 10.0],
            (0.0, 2.0),
            |x, y, z, p| {
                let (a, b) = curve(x, y, z, p);
                field(p[0], -(p[1] * p[1] * b + a * a * b - p[2]))
            },
        ),
        case("f_sine_wave", &[], (0.2, 2.0), |x, y, z, _| (x * z * PI).sin() * y),
        case("f_scallop_wave", &[], (0.2, 2.0), |x, y, z, _| ((x * z * PI).sin() * y).abs()),
    ]
}

impl Case {
    fn call(&self) -> String {
        let arguments: Vec<String> = self.arguments.iter().map(f64::to_string).collect();
        format!("{}({})", self.name, [vec!["x, y, z".to_owned()], arguments].concat().join(", "))
    }

    fn expr(&self, formula: &str) -> Expr {
        let ast = parse(formula).unwrap_or_else(|mistakes| panic!("{formula}: {mistakes:?}"));
        let resolved = Expr::resolve(&ast, &[]);
        resolved.unwrap_or_else(|mistakes| panic!("{formula}: {mistakes:?}")).expr
    }

    fn tape(&self) -> Tape {
        self.expr(&self.call()).tape()
    }

    fn points(&self) -> impl Iterator<Item = DVec3> {
        let reach = self.reach;
        (1..300).map(move |i| point(reach, i))
    }
}

/// Points that fill a cube evenly and are no special ones: fractions of multiples of roots.
fn point(reach: f64, i: u32) -> DVec3 {
    let roots = DVec3::new(2_f64.sqrt(), 3_f64.sqrt(), 5_f64.sqrt());
    reach * (2.0 * (roots * f64::from(i)).fract() - DVec3::ONE)
}

/// A tape's value and what is noted of it.
fn run<N: Number<Lanes: zeroset::math::Lanes<Token = ()>>>(
    tape: &Tape,
    inputs: [N; 3],
) -> (N, Notes<<N::Lanes as zeroset::math::Lanes>::Mask>) {
    let mut machine = Machine::<N, 1>::default();
    let notes = machine.run((), tape, &inputs.map(|v| [v]), false);
    (machine.slot(tape.result())[0], notes[0])
}

#[test]
fn all_functions_are_here() {
    let text = include_str!("../src/expr/povray.txt");
    let names = text.lines().filter(|line| line.starts_with("f_"));
    let names: BTreeSet<&str> = names.map(|line| line.split('(').next().unwrap()).collect();
    let tested: BTreeSet<&str> = cases().iter().map(|case| case.name).collect();
    assert_eq!(names, tested);
    assert_eq!(names.len(), 75);
}

#[test]
fn values_are_those_of_pov_ray() {
    for case in cases() {
        let tape = case.tape();
        for p in case.points() {
            let (found, _) = run(&tape, [p.x, p.y, p.z].map(Point::<f64>));
            let want = (case.definition)(p.x, p.y, p.z, case.arguments);
            let is_near = (found.0 - want).abs() <= 1e-9 * (1.0 + want.abs());
            assert!(is_near, "{} at {p}: {} and not {want}", case.call(), found.0);
        }
    }
}

/// What POV-Ray 3.7 itself printed: `povray/values.pov` says how. The definitions here agree with it, so
/// that they are good for other places as well.
#[test]
fn pov_ray_gave_these_values() {
    let cases = cases();
    let mut names = BTreeSet::new();
    let (mut case, mut tape) = (&cases[0], cases[0].tape());
    for line in include_str!("povray/values.txt").lines() {
        let Some(value) = line.strip_prefix("at ") else {
            case = cases.iter().find(|case| case.call() == line).unwrap();
            tape = case.tape();
            names.insert(case.name);
            continue;
        };
        let (place, value) = value.split_once(": ").unwrap();
        let (reach, i) = place.split_once(' ').unwrap();
        let p = point(reach.parse().unwrap(), i.parse().unwrap());
        let want: f64 = value.parse().unwrap();
        let found = run(&tape, [p.x, p.y, p.z].map(Point::<f64>)).0.0;
        let defined = (case.definition)(p.x, p.y, p.z, case.arguments);
        for value in [found, defined] {
            let is_near = (value - want).abs() <= 1e-9 * (1.0 + want.abs());
            assert!(is_near, "{} {line}: {value}", case.call());
        }
    }
    // Only Enneper's surface is another one since 3.8.
    assert_eq!(names.len(), 74);
}

#[test]
fn intervals_hold_the_values_of_pov_ray() {
    for case in cases() {
        let tape = case.tape();
        for p in case.points() {
            let want = (case.definition)(p.x, p.y, p.z, case.arguments);
            for half in [0.3, 1e-2, 1e-5] {
                // The point is not in the middle.
                let inputs = [p.x, p.y, p.z].map(|v| Interval { lo: v - half, hi: v + 0.3 * half });
                let (range, notes) = run(&tape, inputs);
                assert!(!notes.undefined, "{} around {p}", case.call());
                let slack = 1e-9 * (1.0 + want.abs());
                let is_held = range.lo - slack <= want && want <= range.hi + slack;
                assert!(is_held, "{} around {p}: {range:?} without {want}", case.call());
            }
        }
    }
}

/// Enclosures are good for something: of what is kept a good part is proven to be surface.
#[test]
fn each_function_has_a_surface() {
    for case in cases() {
        let expr = case.expr(&format!("{} - ({})", case.call(), case.level));
        let reach = DVec3::splat(case.reach);
        let lattice = Lattice::new(Aabb { min: -reach, max: reach }, 64);
        let found = voxelize(&expr, &lattice, &Settings::default(), &Unwatched).unwrap();
        let (stored, certified) = (found.octree.voxel_count(), found.octree.certified_count());
        let is_sharp = stored > 300 && 2 * certified > stored;
        assert!(is_sharp, "{}: {certified} of {stored}", case.call());
    }
}
