//! Formulas sampled to volumes.

use fearless_simd::Simd;
use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;

use super::{Sample, Samples, Volume, checked_size, with_room};
use crate::{
    Error, Result,
    eval::{POINT_BATCH, PointEvaluator, Points},
    expr::{Expr, Tape},
    math::{Aabb, SimdLevel, SimdTask},
    progress::Progress,
};

/// What becomes of the values of a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantize {
    /// The nearest f32, as [`Samples::F32`]; NaN where the formula is undefined or does not count.
    None,
    /// The next integer below, cut to 0 to 255, as [`Samples::U8`]; 0 where the formula is undefined
    /// or does not count.
    Floor,
    /// The nearest integer, halves away from 0; otherwise the same.
    Round,
}

impl Volume {
    /// The values of `formula` in the middles of voxels that fill `bounds`, in f64 first. Where the
    /// formula has a clip and the point lies beyond it, it counts as undefined. The result does not
    /// depend on the number of threads, nor on the instruction set.
    ///
    /// # Errors
    /// [`Error::Limit`] for sizes that cannot be had and boxes without a volume,
    /// [`Error::Interrupted`] if `progress` says so.
    pub fn sampled(
        formula: &Expr,
        bounds: Aabb,
        size: [u32; 3],
        quantize: Quantize,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let size = checked_size(size.map(u64::from)).map_err(Error::Limit)?;
        let step = bounds.size() / DVec3::from_array(size.map(f64::from));
        let placing = super::placing::placing(DMat3::from_diagonal(step), bounds.min + 0.5 * step)
            .map_err(Error::Limit)?;
        // Without the error of half a step there and back.
        let placing = DAffine3 { translation: bounds.min, ..placing };
        let tape = formula.tape();
        let task = Task { tape: &tape, bounds, size, quantize, progress };
        Ok(Self { size, samples: task.sample(SimdLevel::detect())?, placing })
    }
}

/// The work, for any instruction set.
#[derive(Clone, Copy)]
struct Task<'a> {
    tape: &'a Tape,
    bounds: Aabb,
    size: [u32; 3],
    quantize: Quantize,
    progress: &'a dyn Progress,
}

impl SimdTask for Task<'_> {
    type Output = Result<Samples>;

    fn run<S: Simd>(self, simd: S) -> Self::Output {
        // Conversions to integers cut to their range, and make 0 of NaN.
        Ok(match self.quantize {
            Quantize::None => Samples::F32(self.values(simd, |v| v as f32)?),
            Quantize::Floor => Samples::U8(self.values(simd, |v| v.floor() as u8)?),
            Quantize::Round => Samples::U8(self.values(simd, |v| v.round() as u8)?),
        })
    }
}

impl Task<'_> {
    fn sample(self, level: SimdLevel) -> Result<Samples> {
        let [_, ny, nz] = self.size.map(u64::from);
        self.progress.begin("sample", ny * nz, "rows");
        let samples = level.run(self);
        self.progress.end();
        samples
    }

    /// All values, x fastest.
    fn values<S: Simd, T: Sample>(
        &self,
        simd: S,
        finish: impl Fn(f64) -> T + Sync,
    ) -> Result<Vec<T>> {
        let n = self.size.iter().map(|&n| n as usize).product();
        let mut values = with_room(n, "samples").map_err(Error::Limit)?;
        values.resize(n, T::default());
        let ny = self.size[1] as usize;
        values.par_chunks_mut(self.size[0] as usize).enumerate().try_for_each_init(
            || PointEvaluator::new(simd),
            |evaluator, (row, values)| {
                if self.progress.is_cancelled() {
                    return Err(Error::Interrupted);
                }
                let [y, z] = [(1, row % ny), (2, row / ny)].map(|(axis, i)| self.place(axis, i));
                for (batch, values) in values.chunks_mut(POINT_BATCH).enumerate() {
                    // Beyond the end of a row more of it is evaluated, and not kept.
                    let mut points: Points =
                        [[0.0; POINT_BATCH], [y; POINT_BATCH], [z; POINT_BATCH]];
                    points[0] =
                        std::array::from_fn(|lane| self.place(0, batch * POINT_BATCH + lane));
                    let found = evaluator.eval(self.tape, &points);
                    let in_region = evaluator.in_region();
                    for (lane, value) in values.iter_mut().enumerate() {
                        let counts = in_region >> lane & 1 == 1;
                        *value = finish(if counts { found[lane] } else { f64::NAN });
                    }
                }
                self.progress.advance(1);
                Ok(())
            },
        )?;
        Ok(values)
    }

    /// Where sample `i` along an axis is.
    fn place(&self, axis: usize, i: usize) -> f64 {
        let n = f64::from(self.size[axis]);
        self.bounds.min[axis] + (i as f64 + 0.5) * self.bounds.size()[axis] / n
    }
}

#[cfg(test)]
mod tests {
    use rayon::ThreadPoolBuilder;

    use super::*;
    use crate::{
        progress::Unwatched,
        volume::{
            MAX_SAMPLES,
            thesis::{Alpha, MODELS},
        },
    };

    /// A formula of the coordinates.
    fn formula(text: &str) -> Expr {
        let resolved = crate::expr::parse(text).map(|ast| Expr::resolve(&ast, &[]));
        match resolved {
            Ok(Ok(resolved)) => resolved.expr,
            other => panic!("{text}: {other:?}"),
        }
    }

    const CUBE: Aabb = Aabb { min: DVec3::NEG_ONE, max: DVec3::ONE };

    fn sampled(text: &str, size: [u32; 3], quantize: Quantize) -> Volume {
        Volume::sampled(&formula(text), CUBE, size, quantize, &Unwatched).unwrap()
    }

    #[test]
    fn samples_stand_in_the_middles_of_voxels() {
        let volume = sampled("x + 10*y + 100*z", [4, 2, 1], Quantize::None);
        let row = [-0.75, -0.25, 0.25, 0.75];
        let expected: Vec<f32> = [-5.0, 5.0].iter().flat_map(|y| row.map(|x| x + y)).collect();
        assert_eq!(volume.samples, Samples::F32(expected));
        let first = volume.placing.transform_point3(DVec3::splat(0.5));
        assert_eq!(first, DVec3::new(-0.75, -0.5, 0.0));
        assert_eq!(volume.bounds(), CUBE);
    }

    #[test]
    fn bytes_are_cut_and_the_undefined_is_0() {
        let values = |quantize| sampled("sqrt(x)*300 - 1.5", [8, 1, 1], quantize).samples;
        assert_eq!(values(Quantize::Floor), Samples::U8(vec![0, 0, 0, 0, 104, 182, 235, 255]));
        assert_eq!(values(Quantize::Round), Samples::U8(vec![0, 0, 0, 0, 105, 182, 236, 255]));
        let Samples::F32(values) = values(Quantize::None) else { panic!("floats were asked for") };
        assert!(values[3].is_nan() && values[4] == (300.0 * 0.125_f64.sqrt() - 1.5) as f32);
    }

    #[test]
    fn beyond_a_clip_nothing_counts() {
        let clipped = formula("7 + 0*x").clipped(&formula("x"));
        let volume = Volume::sampled(&clipped, CUBE, [4, 1, 1], Quantize::Floor, &Unwatched);
        assert_eq!(volume.unwrap().samples, Samples::U8(vec![7, 7, 0, 0]));
    }

    #[test]
    fn every_level_and_number_of_threads_gives_the_same_bits() {
        let formula = formula("sin(7*x*y) + exp(z)*atan2(y, x) - r^3");
        let tape = formula.tape();
        let size = [37, 19, 11];
        let task = Task {
            tape: &tape,
            bounds: CUBE,
            size,
            quantize: Quantize::None,
            progress: &Unwatched,
        };
        let bits = |samples: Result<Samples>| match samples {
            Ok(Samples::F32(values)) => values.into_iter().map(f32::to_bits).collect::<Vec<u32>>(),
            other => panic!("{other:?}"),
        };
        let reference = bits(task.sample(SimdLevel::detect()));
        for level in SimdLevel::available() {
            assert_eq!(bits(task.sample(level)), reference, "{}", level.name());
        }
        for n_threads in [1, 3] {
            let pool = ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
            let in_pool = pool.install(|| task.sample(SimdLevel::detect()));
            assert_eq!(bits(in_pool), reference, "{n_threads} threads");
        }
    }

    #[test]
    fn what_cannot_be_had_is_refused() {
        let tried = |bounds, size| {
            let x = formula("x");
            Volume::sampled(&x, bounds, size, Quantize::None, &Unwatched).unwrap_err().to_string()
        };
        assert_eq!(tried(CUBE, [4, 0, 4]), "its size is 4 x 0 x 4, and no side may be 0");
        assert_eq!(
            tried(CUBE, [2048; 3]),
            format!(
                "its size is 2048 x 2048 x 2048, and volumes have {MAX_SAMPLES} samples at most"
            )
        );
        let flat = Aabb { min: DVec3::ZERO, max: DVec3::X };
        assert!(tried(flat, [1; 3]).contains("lie in a plane"));
    }

    /// The leaves of an octree of blocks in which samples differ by `most` or less.
    fn n_leaves(volume: &Volume, at: [u32; 3], side: u32, most: f64) -> u64 {
        let places = (0..side.pow(3)).map(|i| {
            let local = [i % side, i / side % side, i / side / side];
            [0, 1, 2].map(|axis| at[axis] + local[axis])
        });
        let (low, high) = places.fold((f64::MAX, f64::MIN), |(low, high), ijk| {
            let v = volume.value(ijk);
            (low.min(v), high.max(v))
        });
        if high - low <= most {
            return 1;
        }
        let half = side / 2;
        let child = |c: u32| [0, 1, 2].map(|axis| at[axis] + half * (c >> axis & 1));
        (0..8).map(|c| n_leaves(volume, child(c), half, most)).sum()
    }

    /// Counts that were found by another program (see the table of test functions).
    #[test]
    fn the_models_of_the_thesis_have_as_many_blocks_as_elsewhere() {
        let [sphere, _, saddle, _] = MODELS;
        for (model, n, alpha, most, expected) in [
            (sphere, 32, Alpha::Solid, 0.0, 6112),
            (sphere, 32, Alpha::Linear, 0.0, 20448),
            (sphere, 32, Alpha::Linear, 1.0, 20112),
            (sphere, 64, Alpha::Solid, 0.0, 25432),
            (sphere, 64, Alpha::Linear, 2.0, 145_776),
            (saddle, 128, Alpha::Solid, 0.0, 40300),
            (saddle, 128, Alpha::Linear, 0.0, 978_300),
            (saddle, 128, Alpha::Linear, 2.0, 966_554),
        ] {
            let volume = sampled(&model.text(alpha), [n; 3], Quantize::Floor);
            let found = n_leaves(&volume, [0; 3], n, most);
            assert_eq!(found, expected, "{} {n} {alpha:?} {most}", model.name);
        }
    }

    #[test]
    fn the_trunk_is_empty_where_it_is_undefined() {
        let trunk = MODELS[1];
        for alpha in [Alpha::Solid, Alpha::Linear] {
            let volume = sampled(&trunk.text(alpha), [32; 3], Quantize::Floor);
            for (j, k) in [(15, 20), (10, 25), (3, 30)] {
                // x is almost 0 and y z negative: the radicand is, and r is no number.
                assert_eq!(volume.value([15, j, k]), 0.0);
            }
            assert!(volume.value([15, 18, 18]) > 0.0);
            assert_eq!(volume.value([15, 31, 31]), 0.0, "r is above 1");
        }
    }
}
