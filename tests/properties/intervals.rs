//! Every operation on intervals contains its results at points of its operands, rounding included.

use proptest::prelude::*;
use zeroset::math::{Binary, Constant, Hyperbolic, Interval, Notes, Step, Unary, Wave};

use crate::numbers::{Float, Truth, cases, interval, is_sane, number, reals};

const UNARY: [Unary; 28] = [
    Unary::Neg,
    Unary::Recip,
    Unary::Square,
    Unary::Powi(3),
    Unary::Powi(4),
    Unary::Powi(7),
    Unary::Powi(31),
    Unary::Powi(200),
    Unary::Sqrt,
    Unary::Abs,
    Unary::Wave(Wave::Sin),
    Unary::Wave(Wave::Cos),
    Unary::Exp,
    Unary::Ln,
    Unary::Acos,
    Unary::Asin,
    Unary::Atan,
    Unary::Tan,
    Unary::Hyperbolic(Hyperbolic::Sinh),
    Unary::Hyperbolic(Hyperbolic::Cosh),
    Unary::Hyperbolic(Hyperbolic::Tanh),
    Unary::Cbrt,
    Unary::Step(Step::Floor),
    Unary::Step(Step::Ceil),
    Unary::Step(Step::Round),
    Unary::Step(Step::Sign),
    Unary::Smoothstep,
    Unary::Triangle,
];

const BINARY: [Binary; 7] = [
    Binary::Add,
    Binary::Sub,
    Binary::Mul,
    Binary::Min,
    Binary::Max,
    Binary::Atan2 { lifted: false },
    Binary::Atan2 { lifted: true },
];

/// The true result; nothing where the operation is undefined.
fn unary_truth(op: Unary, a: f64) -> Option<Truth> {
    Some(match op {
        Unary::Neg => Truth::exact(-a),
        Unary::Abs => Truth::exact(a.abs()),
        Unary::Recip if a == 0.0 => return None,
        Unary::Recip => {
            let v = 1.0 / a;
            Truth::rounded(v, libm::fma(-v, a, 1.0) * a.signum())
        }
        Unary::Square => Truth::product(a, a),
        Unary::Powi(n) => Truth::within(libm::pow(a, f64::from(n)), 2),
        Unary::Sqrt if a < 0.0 => return None,
        Unary::Sqrt => Truth::rounded(a.sqrt(), libm::fma(-a.sqrt(), a.sqrt(), a)),
        Unary::Wave(Wave::Sin) => Truth::within(libm::sin(a), 2),
        Unary::Wave(Wave::Cos) => Truth::within(libm::cos(a), 2),
        Unary::Exp => Truth::within(libm::exp(a), 2),
        Unary::Ln if a < 0.0 => return None,
        Unary::Ln => Truth::within(libm::log(a), 2),
        Unary::Acos if a.abs() > 1.0 => return None,
        Unary::Acos => Truth::within(libm::acos(a), 2),
        Unary::Asin if a.abs() > 1.0 => return None,
        Unary::Asin => Truth::within(libm::asin(a), 2),
        Unary::Atan => Truth::within(libm::atan(a), 2),
        Unary::Tan => Truth::within(libm::tan(a), 2),
        Unary::Hyperbolic(Hyperbolic::Sinh) => Truth::within(libm::sinh(a), 3),
        Unary::Hyperbolic(Hyperbolic::Cosh) => Truth::within(libm::cosh(a), 3),
        Unary::Hyperbolic(Hyperbolic::Tanh) => Truth::within(libm::tanh(a), 3),
        Unary::Cbrt => Truth::within(libm::cbrt(a), 2),
        Unary::Step(Step::Floor) => Truth::exact(a.floor()),
        Unary::Step(Step::Ceil) => Truth::exact(a.ceil()),
        Unary::Step(Step::Round) => Truth::exact(a.round()),
        Unary::Step(Step::Sign) if a == 0.0 => Truth::exact(0.0),
        Unary::Step(Step::Sign) => Truth::exact(a.signum()),
        Unary::Triangle => Truth::exact((a - a.round()).abs()),
        Unary::Smoothstep => {
            let t = a.clamp(0.0, 1.0);
            Truth::within(t * t * (3.0 - 2.0 * t), 4)
        }
    })
}

fn binary_truth(op: Binary, a: f64, b: f64) -> Option<Truth> {
    Some(match op {
        Binary::Add => Truth::sum(a, b),
        Binary::Sub => Truth::sum(a, -b),
        Binary::Mul => Truth::product(a, b),
        Binary::Min => Truth::exact(if a < b { a } else { b }),
        Binary::Max => Truth::exact(if a < b { b } else { a }),
        Binary::Atan2 { .. } | Binary::Harmonic { .. } if a == 0.0 && b == 0.0 => return None,
        // The cut belongs to +π whatever the sign of zero.
        Binary::Atan2 { .. } => Truth::within(libm::atan2(a + 0.0, b), 2),
        Binary::Harmonic { .. } => unreachable!("harmonics have a test of their own"),
    })
}

fn contains<T: Float>(op: Binary, result: Interval<T>, truth: Truth) -> bool {
    let turn = 2.0 * std::f64::consts::PI;
    let turns: &[f64] =
        if op == (Binary::Atan2 { lifted: true }) { &[0.0, turn, -turn] } else { &[0.0] };
    turns.iter().any(|turn| {
        let truth = Truth { value: truth.value + turn, ..truth };
        truth.is_in(result.lo.to_f64(), result.hi.to_f64())
    })
}

/// What an operation gives over intervals, and whether it says that it is undefined or
/// discontinuous.
pub(crate) type Outcome<T> = (Interval<T>, Notes<bool>);

pub(crate) fn apply_unary<T: Float>(op: Unary, a: Interval<T>) -> Outcome<T> {
    let (mut slots, mut notes) = ([[a]], [Notes::clear::<T>(())]);
    op.apply(&mut slots, &mut notes, (0, 0));
    (slots[0][0], notes[0])
}

pub(crate) fn apply_binary<T: Float>(op: Binary, a: Interval<T>, b: Interval<T>) -> Outcome<T> {
    let (mut slots, mut notes) = ([[a], [b]], [Notes::clear::<T>(())]);
    op.apply(&mut slots, &mut notes, (0, 1, 0));
    (slots[0][0], notes[0])
}

fn apply_constant<T: Float>(op: Binary, a: Interval<T>, c: &Constant) -> Outcome<T> {
    let (mut slots, mut notes) = ([[a]], [Notes::clear::<T>(())]);
    op.apply_constant(&mut slots, &mut notes, (0, 0), c);
    (slots[0][0], notes[0])
}

/// The notes must fit what happened at the points.
fn check_notes(notes: Notes<bool>, is_defined: bool) -> Result<(), TestCaseError> {
    prop_assert!(!(notes.undefined && is_defined), "defined at a point, noted as undefined");
    prop_assert!(is_defined || notes.discontinuous, "undefined at a point, and no note of it");
    prop_assert!(!notes.undefined || notes.discontinuous, "undefined, yet continuous");
    Ok(())
}

fn check_unary<T: Float>(a: Interval<T>, at: &[f64]) -> Result<(), TestCaseError> {
    for op in UNARY {
        let (result, notes) = apply_unary(op, a);
        prop_assert!(is_sane(result), "{op:?} {a:?} = {result:?}");
        for point in reals(a, at) {
            let truth = unary_truth(op, point);
            check_notes(notes, truth.is_some())?;
            let inside = truth.is_none_or(|t| t.is_in(result.lo.to_f64(), result.hi.to_f64()));
            prop_assert!(inside, "{op:?} {a:?} = {result:?}, but at {point:?} it is {truth:?}");
        }
    }
    Ok(())
}

fn check_binary<T: Float>(a: Interval<T>, b: Interval<T>, at: &[f64]) -> Result<(), TestCaseError> {
    for op in BINARY {
        let (result, notes) = apply_binary(op, a, b);
        prop_assert!(is_sane(result), "{op:?} {a:?} {b:?} = {result:?}");
        for p in reals(a, at) {
            for q in reals(b, at) {
                let truth = binary_truth(op, p, q);
                check_notes(notes, truth.is_some())?;
                prop_assert!(
                    truth.is_none_or(|t| contains(op, result, t)),
                    "{op:?} {a:?} {b:?} = {result:?}, but at {p:?} {q:?} it is {truth:?}"
                );
            }
        }
    }
    Ok(())
}

fn check_constant<T: Float>(a: Interval<T>, c: Constant, at: &[f64]) -> Result<(), TestCaseError> {
    for op in [Binary::Add, Binary::Mul, Binary::Min, Binary::Max] {
        let (result, _) = apply_constant(op, a, &c);
        prop_assert!(is_sane(result), "{op:?} {a:?} {c:?} = {result:?}");
        for p in reals(a, at) {
            for q in [c.lo, c.value, c.hi] {
                let truth = binary_truth(op, p, q);
                prop_assert!(
                    truth.is_none_or(|t| contains(op, result, t)),
                    "{op:?} {a:?} {c:?} = {result:?}, but at {p:?} {q:?} it is {truth:?}"
                );
            }
        }
    }
    Ok(())
}

fn constant() -> impl Strategy<Value = Constant> {
    prop_oneof![
        number::<f64>().prop_map(Constant::exact),
        number::<f32>().prop_map(|c| Constant::exact(f64::from(c))),
        number::<f64>()
            .prop_filter("has neighbours", |c| c.abs() < f64::MAX)
            .prop_map(Constant::rounded),
    ]
}

proptest! {
    #![proptest_config(cases(40_000))]

    #[test]
    fn unary_operations_contain_their_results(
        narrow in interval::<f32>(),
        wide in interval::<f64>(),
        at in [0.0..1.0, 0.0..1.0],
    ) {
        check_unary(narrow, &at)?;
        check_unary(wide, &at)?;
    }

    #[test]
    fn binary_operations_contain_their_results(
        narrow in [interval::<f32>(), interval::<f32>()],
        wide in [interval::<f64>(), interval::<f64>()],
        at in [0.0..1.0, 0.0..1.0],
    ) {
        check_binary(narrow[0], narrow[1], &at)?;
        check_binary(wide[0], wide[1], &at)?;
    }

    #[test]
    fn operations_with_constants_contain_their_results(
        narrow in interval::<f32>(),
        wide in interval::<f64>(),
        c in constant(),
        at in [0.0..1.0, 0.0..1.0],
    ) {
        check_constant(narrow, c, &at)?;
        check_constant(wide, c, &at)?;
    }
}
