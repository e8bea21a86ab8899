//! Random formulas: enclosures of values and gradients, and tapes that mean what the formula does.

use proptest::prelude::*;
use zeroset::{
    eval::Machine,
    expr::{Choice, Expr, Tape, parse},
    math::{Dual, Interval, Lanes, Notes, Number, Point},
};

use crate::numbers::{cases, is_sane};

/// The text of a formula, in which much is defined almost everywhere.
pub(crate) fn formula() -> impl Strategy<Value = String> {
    let leaf = prop::sample::select(vec![
        "x",
        "y",
        "z",
        "x",
        "y",
        "z",
        "r",
        "rho",
        "theta",
        "phi",
        "0.5",
        "2",
        "(-1.3)",
        "0.1",
        "pi",
        "abs(sphere(0.3).repeat_x(0.8).repeat_y(0.9, 2))",
        "abs(gyroid(2, thickness = 0.2))",
        "abs(cone(1, 2, 0.5).twist(40))",
    ]);
    let unary = prop::sample::select(vec![
        "-(A)",
        "sqrt(A)",
        "sqrt(abs(A))",
        "abs(A)",
        "exp(A)",
        "exp(-abs(A))",
        "ln(A)",
        "ln(1+(A)^2)",
        "acos(A)",
        "acos(0.9*sin(A))",
        "sin(A)",
        "cos(3*(A))",
        "(A)^2",
        "(A)^3",
        "(A)^6",
        "(A)^-2",
        "(A)^1.5",
        "max(1-(A),0)^4",
        "1/(A)",
        "1/(1+(A)^2)",
        "sin(4*theta)*(A)",
        "cos(5*phi)-(A)",
        "sin(2*theta+(A))",
        "cos(theta-3*phi+(A))",
        "sin(0.5*theta)+(A)",
        "tanh(A)",
        "tan(0.3*(A))",
        "cbrt(A)",
        "floor(2*(A))",
        "mod(A,1.5)",
        "step(0.3,A)-0.5",
        "smoothstep(-1,1,A)",
        "log2(2+abs(A))",
    ]);
    let binary = prop::sample::select(vec![
        "(A)+(B)",
        "(A)-(B)",
        "(A)*(B)",
        "(A)/(B)",
        "min(A,B)",
        "max(A,B)",
        "min(A,max(B,A-1))",
        "atan2(A,B)",
        "sin(3*atan2(A,B))",
        "(A)+0.3*(B)",
        "hypot(A,B)",
        "smin(A,B,0.3)",
        "smax(A,B,0.3)",
        "mod(A,B)",
    ]);
    leaf.prop_map(str::to_owned).prop_recursive(6, 64, 2, move |inner| {
        prop_oneof![
            2 => (unary.clone(), inner.clone()).prop_map(|(form, a)| form.replace('A', &a)),
            3 => (binary.clone(), inner.clone(), inner)
                .prop_map(|(form, a, b)| form.replace('A', &a).replace('B', &b)),
        ]
    })
}

pub(crate) fn expr(text: &str) -> Expr {
    Expr::resolve(&parse(text).unwrap(), &[]).unwrap().expr
}

/// A box with f32 bounds.
pub(crate) fn boxes() -> impl Strategy<Value = [[f32; 2]; 3]> {
    let start = || {
        prop_oneof![
            3 => (-16_i32..=16).prop_map(|i| i as f32 / 8.0),
            2 => -2.0_f32..2.0,
            1 => Just(0.0_f32),
        ]
    };
    let starts = [start(), start(), start()];
    (starts, prop::sample::select(vec![4.0_f32, 1.0, 0.125, 1e-2, 1e-4, 0.0]))
        .prop_map(|(starts, size)| starts.map(|a| [a, a + size]))
}

/// The point at the given fractions of a box.
pub(crate) fn point_in(bounds: [[f32; 2]; 3], at: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|axis| {
        let [lo, hi] = bounds[axis].map(f64::from);
        (lo + at[axis] * (hi - lo)).clamp(lo, hi)
    })
}

fn run<N: Number<Lanes: Lanes<Token = ()>>>(
    tape: &Tape,
    inputs: [N; 3],
) -> (N, Notes<<N::Lanes as Lanes>::Mask>) {
    let mut machine = Machine::<N, 1>::default();
    let notes = machine.run((), tape, &inputs.map(|v| [v]), false);
    (machine.slot(tape.result())[0], notes[0])
}

/// An enclosure of the value at a point, where the formula is defined and continuous.
pub(crate) fn range_at(tape: &Tape, p: [f64; 3]) -> Option<Interval<f64>> {
    let (range, notes) = run(tape, p.map(Interval::point));
    (!notes.undefined && !notes.discontinuous).then_some(range)
}

pub(crate) fn value_at(tape: &Tape, p: [f64; 3]) -> f64 {
    run(tape, p.map(Point)).0.0
}

/// The choices of a tape on a box.
fn choices_on(tape: &Tape, inputs: [Interval<f32>; 3]) -> Vec<Choice> {
    let mut machine = Machine::<Interval<f32>, 1>::default();
    machine.run((), tape, &inputs.map(|v| [v]), true);
    let outcome = |&[first, second]: &[u64; 2]| match (first & 1, second & 1) {
        (1, _) => Choice::First,
        (_, 1) => Choice::Second,
        _ => Choice::Both,
    };
    machine.choices().iter().map(outcome).collect()
}

/// Two enclosures of one number must overlap.
fn overlap(box_range: Interval<f32>, point_range: Interval<f64>) -> bool {
    f64::from(box_range.lo) <= point_range.hi && point_range.lo <= f64::from(box_range.hi)
}

proptest! {
    #![proptest_config(cases(40_000))]

    #[test]
    fn ranges_over_boxes_contain_values_at_points(
        text in formula(),
        bounds in boxes(),
        at in prop::collection::vec([0.0..=1.0, 0.0..=1.0, 0.0..=1.0], 8),
    ) {
        let tape = expr(&text).tape();
        let inputs = bounds.map(|[lo, hi]| Interval { lo, hi });
        let (range, notes) = run(&tape, inputs);
        prop_assert!(is_sane(range), "{range:?}");
        let short = tape.shortened(choices_on(&tape, inputs));
        for at in at.into_iter().chain([[0.0; 3], [1.0; 3]]) {
            let p = point_in(bounds, at);
            let value = value_at(&tape, p);
            // The enclosure of F at p alone: how far rounding may have moved the value.
            let (here, notes_here) = run(&tape, p.map(Interval::point));
            if notes.undefined {
                prop_assert!(!value.is_finite() || notes_here.discontinuous, "F{p:?} = {value}");
                continue;
            }
            if !value.is_nan() && !notes_here.undefined {
                prop_assert!(overlap(range, here), "F{p:?} in {here:?}, not in {range:?}");
            }
            // At a pole or a jump the value is a matter of chance: the formula may be undefined
            // there, and a step makes a finite number of an infinite one.
            if !value.is_nan() && !notes_here.undefined && !notes_here.discontinuous {
                let slack = (here.hi - here.lo).max(1e-300);
                prop_assert!(
                    f64::from(range.lo) - slack <= value && value <= f64::from(range.hi) + slack,
                    "F{p:?} = {value:?}, not in {range:?}"
                );
                prop_assert_eq!(value_at(&short, p), value, "shortened, at {:?}", p);
            }
        }
    }

    #[test]
    fn gradients_over_boxes_contain_gradients_at_points(
        text in formula(),
        bounds in boxes(),
        at in [0.0..=1.0, 0.0..=1.0, 0.0..=1.0],
    ) {
        let tape = expr(&text).tape();
        let p = point_in(bounds, at);
        let inputs = [0, 1, 2].map(|axis| {
            let [lo, hi] = bounds[axis];
            Dual::variable(Interval { lo, hi }, axis)
        });
        let (over_box, notes) = run(&tape, inputs);
        let at_point = [0, 1, 2].map(|axis| Dual::variable(Interval::point(p[axis]), axis));
        let (here, notes_here) = run(&tape, at_point);
        let plain = run(&tape, bounds.map(|[lo, hi]| Interval { lo, hi })).1;
        prop_assert_eq!(notes.undefined, plain.undefined, "derivatives change what is undefined");
        if !notes.undefined && !notes_here.undefined {
            prop_assert!(overlap(over_box.value, here.value));
            for axis in 0..3 {
                let (wide, narrow) = (over_box.gradient[axis], here.gradient[axis]);
                prop_assert!(is_sane(wide), "{wide:?}");
                prop_assert!(overlap(wide, narrow), "d/d{axis} at {p:?}: {narrow:?} not in {wide:?}");
            }
        }
    }

    #[test]
    fn gradients_are_what_differences_say(
        text in formula(),
        p in [-2.0..2.0_f64, -2.0..2.0_f64, -2.0..2.0_f64],
    ) {
        if ["floor", "mod", "step("].iter().any(|jumps| text.contains(jumps)) {
            return Ok(()); // differences across a jump say nothing about gradients
        }
        let tape = expr(&text).tape();
        let gradient_at = |p: [f64; 3]| {
            let inputs = [0, 1, 2].map(|axis| Dual::variable(Point(p[axis]), axis));
            run(&tape, inputs).0.gradient.map(|g| g.0)
        };
        let width = |p: [f64; 3]| {
            let (here, _) = run(&tape, p.map(Interval::point));
            here.hi - here.lo
        };
        for axis in 0..3 {
            let difference = |h: f64| {
                let (mut a, mut b) = (p, p);
                a[axis] -= h;
                b[axis] += h;
                let rounding = (width(a) + width(b)) / (2.0 * h);
                ((value_at(&tape, b) - value_at(&tape, a)) / (2.0 * h), rounding)
            };
            let [(wide, _), (middle, _), (narrow, rounding)] = [4e-5, 2e-5, 1e-5].map(difference);
            // Where differences of several widths agree, the gradient agrees with them.
            let spread = (wide - narrow).abs() + (middle - narrow).abs();
            let gradient = gradient_at(p)[axis];
            let scale = 1.0 + gradient.abs();
            let is_steady = [-4e-5, 4e-5].iter().all(|h| {
                let mut beside = p;
                beside[axis] += h;
                (gradient_at(beside)[axis] - gradient).abs() < 1e-2 * scale
            });
            if spread + rounding < 1e-3 * scale && is_steady {
                prop_assert!(
                    (gradient - narrow).abs() <= 4.0 * (spread + rounding) + 1e-5 * scale,
                    "d/d{axis} at {p:?} is {gradient:?}, differences say {narrow:?}"
                );
            }
        }
    }
}
