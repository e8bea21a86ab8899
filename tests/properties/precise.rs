//! Elementary functions against arithmetic of 160 bits: what intervals of one number hold.

use astro_float::{BigFloat, Consts, RoundingMode};
use proptest::prelude::*;
use zeroset::math::{Binary, Hyperbolic, Interval, Unary, Wave};

use crate::{
    intervals::{apply_binary, apply_unary},
    numbers::{Float, cases, number},
};

const BITS: usize = 160;
const ROUNDING: RoundingMode = RoundingMode::ToEven;

const FUNCTIONS: [Unary; 16] = [
    Unary::Recip,
    Unary::Sqrt,
    Unary::Cbrt,
    Unary::Powi(7),
    Unary::Powi(50),
    Unary::Wave(Wave::Sin),
    Unary::Wave(Wave::Cos),
    Unary::Tan,
    Unary::Exp,
    Unary::Ln,
    Unary::Asin,
    Unary::Acos,
    Unary::Atan,
    Unary::Hyperbolic(Hyperbolic::Sinh),
    Unary::Hyperbolic(Hyperbolic::Cosh),
    Unary::Hyperbolic(Hyperbolic::Tanh),
];

/// Exact. The crate's own conversion of subnormal numbers is not.
fn big(v: f64) -> BigFloat {
    const UP: f64 = (1_u64 << 60) as f64;
    if v == 0.0 || v.is_normal() {
        BigFloat::from_f64(v, BITS)
    } else {
        BigFloat::from_f64(v * UP, BITS).div(&BigFloat::from_f64(UP, BITS), BITS, ROUNDING)
    }
}

/// The function's value; nothing where it is not defined, or so large an argument that reducing it
/// takes more bits than these.
fn truth(function: Unary, v: f64, constants: &mut Consts) -> Option<BigFloat> {
    let x = big(v);
    let is_moderate = v.abs() < 1e15;
    Some(match function {
        Unary::Recip if v != 0.0 => x.reciprocal(BITS, ROUNDING),
        Unary::Sqrt if v >= 0.0 => x.sqrt(BITS, ROUNDING),
        Unary::Cbrt => x.cbrt(BITS, ROUNDING),
        Unary::Powi(n) => x.powi(n as usize, BITS, ROUNDING),
        Unary::Wave(Wave::Sin) if is_moderate => x.sin(BITS, ROUNDING, constants),
        Unary::Wave(Wave::Cos) if is_moderate => x.cos(BITS, ROUNDING, constants),
        Unary::Tan if is_moderate => x.tan(BITS, ROUNDING, constants),
        Unary::Exp if is_moderate => x.exp(BITS, ROUNDING, constants),
        Unary::Ln if v > 0.0 => x.ln(BITS, ROUNDING, constants),
        Unary::Asin if v.abs() <= 1.0 => x.asin(BITS, ROUNDING, constants),
        Unary::Acos if v.abs() <= 1.0 => x.acos(BITS, ROUNDING, constants),
        Unary::Atan => x.atan(BITS, ROUNDING, constants),
        Unary::Hyperbolic(_) if !is_moderate => return None,
        Unary::Hyperbolic(Hyperbolic::Sinh) => x.sinh(BITS, ROUNDING, constants),
        Unary::Hyperbolic(Hyperbolic::Cosh) => x.cosh(BITS, ROUNDING, constants),
        Unary::Hyperbolic(Hyperbolic::Tanh) => x.tanh(BITS, ROUNDING, constants),
        _ => return None,
    })
}

fn holds<T: Float>(range: Interval<T>, truth: &BigFloat) -> bool {
    let (lo, hi) = (range.lo.to_f64(), range.hi.to_f64());
    let is_above = lo == f64::NEG_INFINITY || big(lo).cmp(truth).is_some_and(|order| order <= 0);
    let is_below = hi == f64::INFINITY || big(hi).cmp(truth).is_some_and(|order| order >= 0);
    is_above && is_below
}

fn check<T: Float>(v: T, constants: &mut Consts) -> Result<(), TestCaseError> {
    for function in FUNCTIONS {
        if let Some(truth) = truth(function, v.to_f64(), constants) {
            let (range, _) = apply_unary(function, Interval { lo: v, hi: v });
            prop_assert!(
                holds(range, &truth),
                "{function:?} of {v:?} is {truth}, not in {range:?}"
            );
        }
    }
    Ok(())
}

/// sin and cos of n times the angle of (x, y), by powers of x + iy.
fn check_harmonics<T: Float>(y: T, x: T, n: u32) -> Result<(), TestCaseError> {
    if x.to_f64() == 0.0 && y.to_f64() == 0.0 {
        return Ok(());
    }
    let (a, b) = (big(x.to_f64()), big(y.to_f64()));
    let mul = |a: &BigFloat, b: &BigFloat| a.mul(b, BITS, ROUNDING);
    let length = mul(&a, &a).add(&mul(&b, &b), BITS, ROUNDING).sqrt(BITS, ROUNDING);
    let (c, s) = (a.div(&length, BITS, ROUNDING), b.div(&length, BITS, ROUNDING));
    let (mut cos, mut sin) = (big(1.0), big(0.0));
    for _ in 0..n {
        let next = mul(&cos, &c).sub(&mul(&sin, &s), BITS, ROUNDING);
        sin = mul(&cos, &s).add(&mul(&sin, &c), BITS, ROUNDING);
        cos = next;
    }
    for (wave, truth) in [(Wave::Sin, sin), (Wave::Cos, cos)] {
        let point = |v| Interval { lo: v, hi: v };
        let (range, _) = apply_binary(Binary::Harmonic { wave, n }, point(y), point(x));
        prop_assert!(holds(range, &truth), "{wave:?} {n} ({x:?}, {y:?}): {truth}, {range:?}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(4_000))]

    #[test]
    fn functions_hold_their_precise_values(
        narrow in number::<f32>(),
        wide in number::<f64>(),
        far in prop_oneof![Just(1e6), Just(-1e6), -2e6..2e6_f64],
    ) {
        let mut constants = Consts::new().unwrap();
        check(narrow, &mut constants)?;
        check(wide, &mut constants)?;
        check(far, &mut constants)?;
        check(far as f32, &mut constants)?;
    }

    #[test]
    fn harmonics_hold_their_precise_values(
        x in -2.0..2.0_f64,
        y in -2.0..2.0_f64,
        n in 1_u32..40,
    ) {
        check_harmonics(y, x, n)?;
        check_harmonics(y as f32, x as f32, n)?;
    }
}
