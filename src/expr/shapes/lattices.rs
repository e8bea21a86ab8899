//! Solids along triply periodic surfaces G = 0, each near to a minimal one: sums of products of waves.
//!
//! - `thickness`: a wall of an even thickness t. The distance is atan(k |G| / |∇G|) / k, which is exact
//!   where G is a sine of √k times the distance; k was fitted to each surface. At a wall of a tenth of
//!   the cell, the distance is right within 1 % for the gyroid, 2 % for D, 4 % for P, 6 % for I-WP and
//!   S (root of the mean square), and 20 to 30 % for Neovius' surface and the lidinoid, which bend
//!   too sharply; thinner walls are more even.
//! - `fraction`: |G| < c, which fills that part of space; `skeletal`: G < c does. The level is a quantile
//!   of samples of the cell, right within 1e-4 of the volume.
//!
//! *Based on:* the nodal approximations of A. Schoen's and H. Schwarz's surfaces by H. G. von Schnering,
//! R. Nesper, "Nodal surfaces of Fourier series", 1991, in the form that is usual for lattices (O.
//! Al-Ketan, R. K. Abu Al-Rub, "Multifunctional mechanical metamaterials based on triply periodic
//! minimal surface lattices", 2019).

use std::{
    f64::consts::TAU,
    sync::{LazyLock, Mutex, PoisonError},
};

use rustc_hash::FxHashMap;

use super::{Build, Complaint, Number, Solid, abs, complaint, exact};
use crate::{
    expr::{
        graph::{Graph, Id},
        names::length,
    },
    math::{Binary, Constant, Wave},
};

/// A wave along one axis, with so many periods in a cell.
type Factor = Option<(Wave, u8)>;

const ONE: Factor = None;
const SIN: Factor = Some((Wave::Sin, 1));
const COS: Factor = Some((Wave::Cos, 1));
const SIN2: Factor = Some((Wave::Sin, 2));
const COS2: Factor = Some((Wave::Cos, 2));

/// G as a sum of products of waves along x, y and z.
pub(super) struct Periodic {
    name: &'static str,
    /// The number before a product, its waves, and whether the same follows for y, z, x and z, x, y.
    terms: &'static [(f64, [Factor; 3], bool)],
    /// k² of the file's text, where a period is 2π.
    bend: f64,
}

pub(super) static GYROID: Periodic =
    Periodic { name: "gyroid", terms: &[(1.0, [SIN, COS, ONE], true)], bend: 1.2 };

pub(super) static SCHWARZ_P: Periodic =
    Periodic { name: "schwarz_p", terms: &[(1.0, [COS, ONE, ONE], true)], bend: 0.35 };

pub(super) static SCHWARZ_D: Periodic = Periodic {
    name: "schwarz_d",
    terms: &[(1.0, [SIN, SIN, SIN], false), (1.0, [SIN, COS, COS], true)],
    bend: 1.6,
};

pub(super) static NEOVIUS: Periodic = Periodic {
    name: "neovius",
    terms: &[(3.0, [COS, ONE, ONE], true), (4.0, [COS, COS, COS], false)],
    bend: 1.0,
};

pub(super) static IWP: Periodic = Periodic {
    name: "iwp",
    terms: &[(2.0, [COS, COS, ONE], true), (-1.0, [COS2, ONE, ONE], true)],
    bend: 2.0,
};

pub(super) static FISCHER_KOCH_S: Periodic =
    Periodic { name: "fischer_koch_s", terms: &[(1.0, [COS2, SIN, COS], true)], bend: 3.4 };

pub(super) static LIDINOID: Periodic = Periodic {
    name: "lidinoid",
    terms: &[
        (0.5, [SIN2, COS, SIN], true),
        (-0.5, [COS2, COS2, ONE], true),
        (0.15, [ONE, ONE, ONE], false),
    ],
    bend: 2.0,
};

/// A number and the waves along x, y and z that it is multiplied with.
type Product = (f64, [Factor; 3]);

impl Periodic {
    fn products(&self) -> Vec<Product> {
        let turned = |&(factor, waves, is_cyclic): &(f64, [Factor; 3], bool)| {
            let n_turns = if is_cyclic { 3 } else { 1 };
            (0..n_turns).map(move |turn| {
                (factor, [0, 1, 2].map(|axis: usize| waves[(axis + 3 - turn) % 3]))
            })
        };
        self.terms.iter().flat_map(turned).collect()
    }
}

/// The derivative of a sum of products along an axis.
fn derivative(products: &[Product], axis: usize) -> Vec<Product> {
    let one = |&(factor, mut waves): &Product| {
        let (wave, n) = waves[axis]?;
        let (slope, sign) = match wave {
            Wave::Sin => (Wave::Cos, 1.0),
            Wave::Cos => (Wave::Sin, -1.0),
        };
        waves[axis] = Some((slope, n));
        Some((factor * sign * f64::from(n), waves))
    };
    products.iter().filter_map(one).collect()
}

pub(super) fn build(b: &mut Build<'_>, periodic: &Periodic) -> Result<Solid, Complaint> {
    let cell = b.positive(0)?;
    let given: Vec<usize> = (1..4).filter(|&index| b.given(index).is_some()).collect();
    if let &[_, second, ..] = given.as_slice() {
        let help = "give one of `thickness`, `fraction` and `skeletal`";
        return Err(complaint(second, "is given beside another", help));
    }
    let products = periodic.products();
    let phases = Phases::new(b, cell);
    let g = &mut *b.g;
    let value = phases.sum(g, &products);
    let unit = phases.unit;
    match given.first() {
        Some(1) => {
            let thickness = b.positive(1)?;
            if thickness.value > cell.value / 2.0 {
                let message = format!("is {}", thickness.value);
                return Err(complaint(1, message, "it must not be above half of the cell"));
            }
            let half = b.half(thickness.id);
            let g = &mut *b.g;
            let gradient = [0, 1, 2].map(|axis| phases.sum(g, &derivative(&products, axis)));
            let steepness = length(&gradient, g);
            let bend = g.constant(Constant::rounded(periodic.bend.sqrt()));
            let depth = abs(g, value);
            let depth = g.mul(depth, bend);
            let angle = g.binary(Binary::Atan2 { lifted: false }, depth, steepness);
            let distance = g.div(angle, bend);
            let distance = g.mul(distance, unit);
            Ok(Solid::exact(g.sub(distance, half)))
        }
        Some(&index) => {
            let fraction = b.number(index).value;
            if !(fraction > 0.0 && fraction < 1.0) {
                let help = "it must be above 0 and below 1: a part of the volume";
                return Err(complaint(index, format!("is {fraction}"), help));
            }
            let g = &mut *b.g;
            let is_sheet = index == 2;
            let level = exact(g, level(periodic, is_sheet, fraction));
            let value = if is_sheet { abs(g, value) } else { value };
            let field = g.sub(value, level);
            Ok(Solid::of_formula(g.mul(field, unit)))
        }
        None => Ok(Solid::of_formula(g.mul(value, unit))),
    }
}

/// The coordinates as angles.
struct Phases {
    /// 2π x / cell and so on, and twice that.
    angles: [[Id; 3]; 2],
    /// The length of one radian: cell / 2π.
    unit: Id,
}

impl Phases {
    fn new(b: &mut Build<'_>, cell: Number) -> Self {
        let place = b.coordinates();
        let g = &mut *b.g;
        let turn = g.constant(Constant::rounded(TAU));
        let unit = g.div(cell.id, turn);
        let angles = [1.0, 2.0].map(|n| {
            let (n, turn) = (exact(g, n), g.div(turn, cell.id));
            let rate = g.mul(turn, n);
            place.map(|coordinate| g.mul(coordinate, rate))
        });
        Self { angles, unit }
    }

    fn sum(&self, g: &mut Graph, products: &[Product]) -> Id {
        let mut sum = exact(g, 0.0);
        for &(factor, waves) in products {
            let mut product = g.constant(decimal(factor));
            for (axis, wave) in waves.into_iter().enumerate() {
                if let Some((wave, n)) = wave {
                    let wave = g.wave(wave, self.angles[usize::from(n) - 1][axis]);
                    product = g.mul(product, wave);
                }
            }
            sum = g.add(sum, product);
        }
        sum
    }
}

/// A number of a table, which is written in decimal.
fn decimal(value: f64) -> Constant {
    let is_dyadic = (value * 64.0).fract() == 0.0;
    if is_dyadic { Constant::exact(value) } else { Constant::rounded(value) }
}

/// Samples of a cell.
const N_SAMPLES: u32 = 1 << 21;

/// The steps of the sequence of samples along x, y and z, in cells: powers of the root of g⁴ = g + 1.
/// Neither planes nor symmetries of the surfaces meet them at regular places, as those of a lattice.
///
/// *Based on:* M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018 (R3).
const STEPS: [f64; 3] = [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3];

type Levels = Mutex<FxHashMap<(&'static str, bool, u64), f64>>;

/// The levels that were found: a film asks for the same one in each frame.
static LEVELS: LazyLock<Levels> = LazyLock::new(Levels::default);

/// The c for which |G| < c, or G < c, holds in this part of the cell.
fn level(periodic: &Periodic, is_sheet: bool, fraction: f64) -> f64 {
    let key = (periodic.name, is_sheet, fraction.to_bits());
    let known = LEVELS.lock().unwrap_or_else(PoisonError::into_inner).get(&key).copied();
    known.unwrap_or_else(|| {
        let level = quantile(periodic, is_sheet, fraction);
        LEVELS.lock().unwrap_or_else(PoisonError::into_inner).insert(key, level);
        level
    })
}

fn quantile(periodic: &Periodic, is_sheet: bool, fraction: f64) -> f64 {
    let products = periodic.products();
    let sample = |i: u32| {
        let waves = STEPS.map(|step| {
            let (sin, cos) = libm::sincos(TAU * (0.5 + f64::from(i) * step).fract());
            [sin, cos, 2.0 * sin * cos, 1.0 - 2.0 * sin * sin]
        });
        let product = |&(factor, factors): &Product| {
            let along = |axis: usize| match factors[axis] {
                None => 1.0,
                Some((wave, n)) => {
                    waves[axis][usize::from(wave == Wave::Cos) + 2 * usize::from(n - 1)]
                }
            };
            factor * along(0) * along(1) * along(2)
        };
        let value: f64 = products.iter().map(product).sum();
        if is_sheet { value.abs() } else { value }
    };
    let mut values: Vec<f64> = (0..N_SAMPLES).map(sample).collect();
    let index = (fraction * f64::from(N_SAMPLES)) as usize;
    let last = values.len() - 1;
    *values.select_nth_unstable_by(index.min(last), f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Held against a lattice of ten million samples, which is itself right within 1e-4.
    #[test]
    fn levels_fill_what_they_should() {
        let all = [&GYROID, &SCHWARZ_P, &SCHWARZ_D, &NEOVIUS, &IWP, &FISCHER_KOCH_S, &LIDINOID];
        for periodic in all {
            let products = periodic.products();
            for (is_sheet, fraction) in [(true, 0.2), (false, 0.35)] {
                let c = level(periodic, is_sheet, fraction);
                let n = [211_u32, 223, 227];
                let wave = |factor: Factor, angle: f64| match factor {
                    None => 1.0,
                    Some((Wave::Sin, m)) => libm::sin(f64::from(m) * angle),
                    Some((Wave::Cos, m)) => libm::cos(f64::from(m) * angle),
                };
                let tables: Vec<Vec<Vec<f64>>> = (0..3)
                    .map(|axis| {
                        let angle = |i: u32| {
                            TAU * (f64::from(i) + [0.81, 0.27, 0.53][axis]) / f64::from(n[axis])
                        };
                        let of = |i| products.iter().map(|p| wave(p.1[axis], angle(i))).collect();
                        (0..n[axis]).map(of).collect()
                    })
                    .collect();
                let mut inside = 0_u32;
                for (x, y) in tables[0].iter().flat_map(|x| tables[1].iter().map(move |y| (x, y))) {
                    for z in &tables[2] {
                        let terms = products.iter().enumerate();
                        let value: f64 = terms.map(|(i, p)| p.0 * x[i] * y[i] * z[i]).sum();
                        let value = if is_sheet { value.abs() } else { value };
                        inside += u32::from(value < c);
                    }
                }
                let part = f64::from(inside) / n.map(f64::from).iter().product::<f64>();
                assert!((part - fraction).abs() < 1.5e-4, "{} {is_sheet}: {part}", periodic.name);
            }
        }
    }
}
