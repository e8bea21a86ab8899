//! A range of values instead of an isovalue.

use super::{Refusal, Sample, Samples, Volume, with_samples};

impl Volume {
    /// How deep samples lie in a range: min(v − low, high − v), at or above 0 where v is in it. So the
    /// range becomes the isovalue 0, and the surface has no sheet where samples jump over the range.
    /// An end that is infinite does not count: `[-∞, high]` is what is `high` or less. Differences are
    /// rounded to f32, which keeps their sign.
    ///
    /// # Errors
    /// Why no sample can be in the range: it is empty, or the samples' own range lies beside it.
    pub fn band(&self, [low, high]: [f64; 2]) -> Result<Self, Refusal> {
        let [least, most] = self.range();
        if low.is_nan() || high.is_nan() || low > high {
            return Err(format!(
                "no sample lies from {low} to {high}: the first must not be larger"
            ));
        }
        if !(low <= most && high >= least) {
            return Err(format!(
                "no sample lies from {low} to {high}: they go from {least} to {most}"
            ));
        }
        if low.is_infinite() && high.is_infinite() {
            return Err(format!("every number lies from {low} to {high}: one end must be finite"));
        }
        let depth = |v: f64| {
            let (above, below) = (v - low, high - v);
            // NaN is neither, and stays; so are differences of infinite samples to infinite ends.
            let is_above = low.is_finite() && (above < below || high.is_infinite());
            (if is_above { above } else { below }) as f32
        };
        let samples = Samples::F32(with_samples!(&self.samples, |values| values
            .iter()
            .map(|v| depth(v.to_f64()))
            .collect()));
        Ok(Self { size: self.size, samples, placing: self.placing })
    }
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::*;

    #[test]
    fn ranges_become_depths() {
        let samples = Samples::U8(vec![0, 10, 15, 20, 255]);
        let volume = Volume { size: [5, 1, 1], samples, placing: DAffine3::IDENTITY };
        let band = volume.band([10.0, 20.0]).unwrap();
        assert_eq!(band.samples, Samples::F32(vec![-10.0, 0.0, 5.0, 0.0, -235.0]));
        assert_eq!(
            volume.band([256.0, 300.0]).unwrap_err(),
            "no sample lies from 256 to 300: they go from 0 to 255"
        );
        assert!(volume.band([3.0, 2.0]).is_err());
        let inf = f64::INFINITY;
        assert_eq!(
            volume.band([-inf, inf]).unwrap_err(),
            "every number lies from -inf to inf: one end must be finite"
        );
        assert_eq!(
            volume.band([256.0, inf]).unwrap_err(),
            "no sample lies from 256 to inf: they go from 0 to 255"
        );
        assert!(volume.band([f64::NAN, 2.0]).is_err());
    }

    #[test]
    fn infinite_ends_are_open() {
        let samples = Samples::F32(vec![-3.0, 5.0, f32::INFINITY, f32::NEG_INFINITY]);
        let volume = Volume { size: [4, 1, 1], samples, placing: DAffine3::IDENTITY };
        let depths = |range: [f64; 2]| volume.band(range).unwrap().samples;
        let (inf, most) = (f64::INFINITY, f32::INFINITY);
        assert_eq!(depths([-inf, -1.0]), Samples::F32(vec![2.0, -6.0, -most, most]));
        assert_eq!(depths([1.0, inf]), Samples::F32(vec![-4.0, 4.0, most, -most]));
    }

    #[test]
    fn what_is_no_number_stays_none() {
        let samples = Samples::F32(vec![f32::NAN, 1.0]);
        let volume = Volume { size: [2, 1, 1], samples, placing: DAffine3::IDENTITY };
        let Samples::F32(depths) = volume.band([0.0, 3.0]).unwrap().samples else { panic!() };
        assert!(depths[0].is_nan() && depths[1] == 1.0);
    }
}
