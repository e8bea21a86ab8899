//! The same bits from every instruction set, and from plain scalars.

use fearless_simd::{Simd, f32x16, f64x8};
use proptest::prelude::*;
use zeroset::{
    eval::{
        BATCH, BoxEvaluator, Boxes, GradientEvaluator, Machine, POINT_BATCH, PointEvaluator,
        Points, SlopeEvaluator, SlopeVerdict, Verdict,
    },
    expr::{Choice, Tape},
    math::{Dual, Interval, Lanes, Notes, Number, Point, Scalar, SimdLevel, SimdTask},
};

use crate::{
    formulas::{boxes, expr, formula},
    numbers::cases,
};

/// Equal for equal numbers; every NaN is the same one.
fn bits(v: f64) -> u64 {
    if v.is_nan() { u64::MAX } else { v.to_bits() }
}

/// Everything that the evaluators say of 64 boxes, and of points, as bits.
#[derive(Debug, PartialEq)]
struct Findings {
    ranges: [Vec<u64>; 2],
    verdicts: [Verdict; 2],
    choices: [Vec<Vec<Choice>>; 2],
    slopes: [SlopeVerdict; 2],
    values: Vec<u64>,
    gradients: Vec<u64>,
}

struct Everything<'a> {
    tape: &'a Tape,
    narrow: &'a Boxes<f32>,
    wide: &'a Boxes<f64>,
    points: &'a Points,
}

#[inline(always)]
fn ranges<L: Lanes, const G: usize>(
    token: L::Token,
    tape: &Tape,
    boxes: &Boxes<L::Scalar>,
) -> Vec<u64> {
    let zero = Interval::point(L::splat(token, L::Scalar::default()));
    let mut inputs = [[zero; G]; 3];
    for (axis, slot) in inputs.iter_mut().enumerate() {
        for (g, vector) in slot.iter_mut().enumerate() {
            let (lo, hi) = (&boxes.lo[axis][g * L::LEN..], &boxes.hi[axis][g * L::LEN..]);
            *vector = Interval { lo: L::load(token, lo), hi: L::load(token, hi) };
        }
    }
    let mut machine = Machine::<Interval<L>, G>::default();
    let notes = machine.run(token, tape, &inputs, false);
    let range = machine.slot(tape.result());
    let mut out = Vec::new();
    for g in 0..G {
        let (mut lo, mut hi) = ([L::Scalar::default(); 16], [L::Scalar::default(); 16]);
        range[g].lo.store(&mut lo);
        range[g].hi.store(&mut hi);
        for lane in 0..L::LEN {
            out.extend([lo[lane], hi[lane]].map(|v| bits(v.to_f64())));
            out.push(note_bits::<L>(notes[g], lane));
        }
    }
    out
}

#[inline(always)]
fn note_bits<L: Lanes>(notes: Notes<L::Mask>, lane: usize) -> u64 {
    use zeroset::math::Mask;
    [notes.undefined, notes.partial, notes.discontinuous]
        .iter()
        .fold(0, |bits, note| bits << 1 | (note.bits() >> lane & 1))
}

impl SimdTask for Everything<'_> {
    type Output = Findings;

    fn run<S: Simd>(self, simd: S) -> Findings {
        let Self { tape, narrow, wide, points } = self;
        let narrow_ranges = simd.vectorize(
            #[inline(always)]
            || ranges::<f32x16<S>, { BATCH / 16 }>(simd, tape, narrow),
        );
        let wide_ranges = simd.vectorize(
            #[inline(always)]
            || ranges::<f64x8<S>, { BATCH / 8 }>(simd, tape, wide),
        );
        let mut narrow_boxes = BoxEvaluator::<f32x16<S>, { BATCH / 16 }>::new(simd);
        let mut wide_boxes = BoxEvaluator::<f64x8<S>, { BATCH / 8 }>::new(simd);
        let verdicts = [
            narrow_boxes.eval(tape, narrow, BATCH, true),
            wide_boxes.eval(tape, wide, BATCH, true),
        ];
        let choices = [
            (0..BATCH).map(|lane| narrow_boxes.choices(lane).collect()).collect(),
            (0..BATCH).map(|lane| wide_boxes.choices(lane).collect()).collect(),
        ];
        let slopes = [
            SlopeEvaluator::new(simd).eval(&mut narrow_boxes, tape, narrow, narrow, BATCH),
            SlopeEvaluator::new(simd).eval(&mut wide_boxes, tape, wide, wide, BATCH),
        ];
        let values = PointEvaluator::new(simd).eval(tape, points);
        let gradients = GradientEvaluator::new(simd).eval(tape, points);
        Findings {
            ranges: [narrow_ranges, wide_ranges],
            verdicts,
            choices,
            slopes,
            values: values.map(bits).to_vec(),
            gradients: gradients.as_flattened().iter().map(|&v| bits(v)).collect(),
        }
    }
}

/// One box after the other, one lane.
fn scalar_ranges<T>(tape: &Tape, boxes: &Boxes<T>) -> Vec<u64>
where
    T: Scalar + Lanes<Scalar = T, Token = ()>,
{
    let one = |i: usize| {
        let inputs =
            [0, 1, 2].map(|axis| [Interval { lo: boxes.lo[axis][i], hi: boxes.hi[axis][i] }]);
        let mut machine = Machine::<Interval<T>, 1>::default();
        let notes = machine.run((), tape, &inputs, false);
        let range = machine.slot(tape.result());
        let note = note_bits::<T>(notes[0], 0);
        [bits(range[0].lo.to_f64()), bits(range[0].hi.to_f64()), note]
    };
    (0..BATCH).flat_map(one).collect()
}

fn scalar_values<N: Number>(
    tape: &Tape,
    points: &Points,
    input: impl Fn(f64, usize) -> N,
    output: impl Fn(N) -> Vec<f64>,
) -> Vec<Vec<u64>>
where
    N::Lanes: Lanes<Token = ()>,
{
    let one = |i: usize| {
        let inputs = [0, 1, 2].map(|axis| [input(points[axis][i], axis)]);
        let mut machine = Machine::<N, 1>::default();
        machine.run((), tape, &inputs, false);
        let value = machine.slot(tape.result());
        output(value[0]).into_iter().map(bits).collect()
    };
    (0..POINT_BATCH).map(one).collect()
}

proptest! {
    #![proptest_config(cases(600))]

    #[test]
    fn every_level_and_the_scalars_give_the_same_bits(
        text in formula(),
        bounds in prop::collection::vec(boxes(), BATCH),
    ) {
        let tape = expr(&text).tape();
        let (mut narrow, mut wide) = (Boxes::<f32>::default(), Boxes::<f64>::default());
        let mut points: Points = [[0.0; POINT_BATCH]; 3];
        for (i, bounds) in bounds.iter().enumerate() {
            for axis in 0..3 {
                let [lo, hi] = bounds[axis];
                (narrow.lo[axis][i], narrow.hi[axis][i]) = (lo, hi);
                (wide.lo[axis][i], wide.hi[axis][i]) = (f64::from(lo), f64::from(hi));
                if i < POINT_BATCH {
                    points[axis][i] = 0.5 * (f64::from(lo) + f64::from(hi));
                }
            }
        }
        let find = |level: SimdLevel| {
            level.run(Everything { tape: &tape, narrow: &narrow, wide: &wide, points: &points })
        };
        let levels = SimdLevel::available();
        let best = find(levels[0]);
        for &level in &levels[1..] {
            prop_assert_eq!(&find(level), &best, "{}", level.name());
        }
        prop_assert_eq!(&scalar_ranges(&tape, &narrow), &best.ranges[0]);
        prop_assert_eq!(&scalar_ranges(&tape, &wide), &best.ranges[1]);
        let values = scalar_values(&tape, &points, |v, _| Point(v), |v| vec![v.0]);
        prop_assert_eq!(values.concat(), best.values);
        let gradients = scalar_values(
            &tape,
            &points,
            |v, axis| Dual::variable(Point(v), axis),
            |v| v.gradient.map(|g| g.0).to_vec(),
        );
        for axis in 0..3 {
            let partials: Vec<u64> = gradients.iter().map(|g| g[axis]).collect();
            prop_assert_eq!(&partials, &best.gradients[axis * POINT_BATCH..][..POINT_BATCH]);
        }
    }
}
