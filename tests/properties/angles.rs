//! Angles of boxes and waves of them: nothing missing, and nothing more than there is.

use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use zeroset::math::{Binary, Interval, Wave};

use crate::{
    intervals::apply_binary,
    numbers::{Float, cases, interval, is_sane, reals},
};

/// Bounds of boxes as voxels have them: often on an axis, often touching the origin.
fn side<T: Float>() -> impl Strategy<Value = Interval<T>> {
    let step = prop_oneof![Just(1.0), Just(1.0 / 64.0), Just(0.3), Just(1e-6), Just(1e5)];
    (-6_i32..=6, 0_i32..=4, step).prop_map(|(from, n, step)| {
        let (lo, hi) = (T::nearest(f64::from(from) * step), T::nearest(f64::from(from + n) * step));
        Interval { lo, hi }
    })
}

/// Angles of a box that does not hold the origin, as an exact range; it may pass π.
fn true_range<T: Float>(y: Interval<T>, x: Interval<T>) -> (f64, f64) {
    let corners = [(y.lo, x.lo), (y.lo, x.hi), (y.hi, x.lo), (y.hi, x.hi)]
        .map(|(y, x)| libm::atan2(y.to_f64() + 0.0, x.to_f64()));
    // Convex and without the origin: all within half a turn of the first corner.
    let lifted = corners.map(|angle| {
        let ahead = angle - corners[0];
        corners[0] + ahead - TAU * ((ahead + PI) / TAU).floor()
    });
    lifted.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), &a| (lo.min(a), hi.max(a)))
}

fn wave_of(wave: Wave, angle: f64) -> f64 {
    match wave {
        Wave::Sin => libm::sin(angle),
        Wave::Cos => libm::cos(angle),
    }
}

/// Whether phase + 2πk lies between two angles.
fn holds_phase(from: f64, to: f64, phase: f64) -> bool {
    ((from - phase) / TAU).ceil() <= ((to - phase) / TAU).floor()
}

fn holds_origin<T: Float>(y: Interval<T>, x: Interval<T>) -> bool {
    y.contains_zero() && x.contains_zero()
}

fn check_harmonics<T: Float>(
    y: Interval<T>,
    x: Interval<T>,
    at: &[f64],
    is_tight: bool,
) -> Result<(), TestCaseError> {
    let numbers = (1..=32).chain([64, 100, 255, 511, 1024]);
    for (n, wave) in numbers.flat_map(|n| [(n, Wave::Sin), (n, Wave::Cos)]) {
        let (result, notes) = apply_binary(Binary::Harmonic { wave, n }, y, x);
        let (lo, hi) = (result.lo.to_f64(), result.hi.to_f64());
        prop_assert!(is_sane(result) && !notes.undefined, "{wave:?} {n} {y:?} {x:?} = {result:?}");
        // The reference's own error: of the angle, of its multiple, of the wave.
        let slack = 8e-16 * f64::from(n) + 2e-16;
        let points =
            reals(y, at).into_iter().flat_map(|p| reals(x, at).into_iter().map(move |q| (p, q)));
        for (p, q) in points {
            if p == 0.0 && q == 0.0 {
                prop_assert!(notes.discontinuous);
                continue;
            }
            let value = wave_of(wave, f64::from(n) * libm::atan2(p, q));
            prop_assert!(
                lo <= value + slack && value - slack <= hi,
                "{wave:?} {n} of y {y:?} x {x:?} = {result:?}, but at ({p:?}, {q:?}) it is {value:?}"
            );
        }
        if is_tight && !holds_origin(y, x) {
            let (from, to) = true_range(y, x);
            let (from, to) = (f64::from(n) * from, f64::from(n) * to);
            let ends = [from, to].map(|a| wave_of(wave, a));
            let crest = if wave == Wave::Sin { FRAC_PI_2 } else { 0.0 };
            let most = if holds_phase(from, to, crest) { 1.0 } else { ends[0].max(ends[1]) };
            let least = if holds_phase(from, to, crest + PI) { -1.0 } else { ends[0].min(ends[1]) };
            let error = 4.0 * (8.0 * f64::from(n) + 16.0) * T::UNIT;
            prop_assert!(
                least - error <= lo && hi <= most + error,
                "{wave:?} {n} of y {y:?} x {x:?} = {result:?}, but the range is {least:?} to {most:?}"
            );
        }
    }
    Ok(())
}

fn check_angle<T: Float>(y: Interval<T>, x: Interval<T>) -> Result<(), TestCaseError> {
    let error = 200.0 * T::UNIT;
    let (lifted, _) = apply_binary(Binary::Atan2 { lifted: true }, y, x);
    let (plain, notes) = apply_binary(Binary::Atan2 { lifted: false }, y, x);
    let (lo, hi) = (lifted.lo.to_f64(), lifted.hi.to_f64());
    prop_assert!(-PI - error <= plain.lo.to_f64() && plain.hi.to_f64() <= PI + error);
    if holds_origin(y, x) {
        return Ok(());
    }
    let (from, to) = true_range(y, x);
    prop_assert!(hi - lo <= PI + error, "{y:?} {x:?} = {lifted:?} is more than half a turn");
    prop_assert!((hi - lo) - (to - from) <= error, "{y:?} {x:?} = {lifted:?}, not {from} to {to}");
    let turns = ((lo - from) / TAU).round() * TAU;
    prop_assert!((lo - turns - from).abs() <= error, "{y:?} {x:?} = {lifted:?}, not {from}");
    prop_assert!((hi - turns - to).abs() <= error, "{y:?} {x:?} = {lifted:?}, not {to}");
    // The cut, which belongs to +π, is met from below only.
    let cut = y.lo.to_f64() < 0.0 && 0.0 <= y.hi.to_f64() && x.lo.to_f64() < 0.0;
    prop_assert_eq!(notes.discontinuous, cut);
    if !cut {
        prop_assert!((plain.hi.to_f64() - plain.lo.to_f64()) - (to - from) <= error);
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(4_000))]

    #[test]
    fn harmonics_of_boxes(
        narrow in [side::<f32>(), side::<f32>()],
        wide in [side::<f64>(), side::<f64>()],
        at in [0.0..1.0, 0.0..1.0],
    ) {
        check_harmonics(narrow[0], narrow[1], &at, true)?;
        check_harmonics(wide[0], wide[1], &at, true)?;
    }

    #[test]
    fn harmonics_of_awkward_intervals(
        narrow in [interval::<f32>(), interval::<f32>()],
        wide in [interval::<f64>(), interval::<f64>()],
        at in [0.0..1.0, 0.0..1.0],
    ) {
        check_harmonics(narrow[0], narrow[1], &at, false)?;
        check_harmonics(wide[0], wide[1], &at, false)?;
    }

    #[test]
    fn angles_of_boxes(
        narrow in [side::<f32>(), side::<f32>()],
        wide in [side::<f64>(), side::<f64>()],
    ) {
        check_angle(narrow[0], narrow[1])?;
        check_angle(wide[0], wide[1])?;
    }
}

/// A corner whose direction underflows onto the negative x axis lies below it all the same.
#[test]
fn a_corner_just_below_the_cut_keeps_its_side() {
    let y = Interval { lo: -1e3_f32, hi: -1e-45 };
    let x = Interval { lo: -100.0_f32, hi: 1e6 };
    for n in 1..=32 {
        let (sine, _) = apply_binary(Binary::Harmonic { wave: Wave::Sin, n }, y, x);
        assert!(sine.lo <= -1.0 + 1e-6, "{n}: {sine:?}");
    }
}
