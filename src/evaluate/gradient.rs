//! Whether regions should be alike by gradient as well as by value.
//!
//! A region keeps one value, so likeness of gradients alone would join a ramp, whatever it rises by; it
//! can only be asked for beside that of values. Then a larger tolerance of values may be had for the
//! same error, which is worth something if it leaves fewer regions.

use crate::volume::Volume;

/// How much samples of one region may differ, and central differences at them along each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Likeness {
    /// Of values.
    pub(super) value: f64,
    /// Of differences; infinite where they do not matter.
    pub(super) gradient: f64,
}

/// What is left of a volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Joined {
    /// Regions.
    pub(super) regions: u64,
    /// The root of the mean square by which samples differ from the mean of their region.
    pub(super) rms: f64,
}

/// Ranges and moments of the samples of a block.
#[derive(Clone, Copy)]
struct Summary {
    /// Least and largest value, then differences along x, y and z.
    ranges: [[f32; 2]; 4],
    n: f64,
    sum: f64,
    squares: f64,
}

/// Regions so far and their squared errors, for every likeness.
type Counts = Vec<(u64, f64)>;

struct Joiner<'a> {
    size: [u32; 3],
    /// A value and its differences for each sample.
    samples: Vec<[f32; 4]>,
    likenesses: &'a [Likeness],
}

/// Joins the samples of a volume in each of several ways.
#[must_use]
pub(super) fn joined(volume: &Volume, likenesses: &[Likeness]) -> Vec<Joined> {
    let size = volume.size;
    let n: u32 = size.iter().product();
    let sample = |i: u32| {
        let p = [i % size[0], i / size[0] % size[1], i / size[0] / size[1]];
        let along = |axis: usize| {
            let (mut lower, mut upper) = (p, p);
            lower[axis] = p[axis].saturating_sub(1);
            upper[axis] = (p[axis] + 1).min(size[axis] - 1);
            let steps = f64::from((upper[axis] - lower[axis]).max(1));
            ((volume.value(upper) - volume.value(lower)) / steps) as f32
        };
        [volume.value(p) as f32, along(0), along(1), along(2)]
    };
    let joiner = Joiner { size, samples: (0..n).map(sample).collect(), likenesses };
    let longest = size.into_iter().max().unwrap_or(1);
    let depth = longest.next_power_of_two().ilog2();
    let (_, counts) = joiner.block([0; 3], depth);
    let joined =
        |(regions, squares): (u64, f64)| Joined { regions, rms: (squares / f64::from(n)).sqrt() };
    counts.into_iter().map(joined).collect()
}

impl Joiner<'_> {
    /// What a block becomes; no summary where it reaches beyond the volume.
    fn block(&self, base: [u32; 3], level: u32) -> (Option<Summary>, Counts) {
        if (0..3).any(|axis| base[axis] >= self.size[axis]) {
            return (None, vec![(0, 0.0); self.likenesses.len()]);
        }
        if level == 0 {
            let [nx, ny, _] = self.size.map(|n| n as usize);
            let [x, y, z] = base.map(|i| i as usize);
            let sample = self.samples[x + nx * (y + ny * z)];
            let v = f64::from(sample[0]);
            let ranges = sample.map(|v| [v, v]);
            let summary = Summary { ranges, n: 1.0, sum: v, squares: v * v };
            return (Some(summary), vec![(1, 0.0); self.likenesses.len()]);
        }
        let half = 1 << (level - 1);
        let mut counts = vec![(0, 0.0); self.likenesses.len()];
        let mut whole: Option<Summary> = None;
        let mut is_cut = false;
        for c in 0..8 {
            let base = [0, 1, 2].map(|axis| base[axis] + half * (c >> axis & 1));
            let (summary, own) = self.block(base, level - 1);
            for (all, own) in counts.iter_mut().zip(own) {
                *all = (all.0 + own.0, all.1 + own.1);
            }
            match summary {
                Some(summary) => whole = Some(whole.map_or(summary, |whole| whole.with(&summary))),
                None => is_cut = true,
            }
        }
        let Some(summary) = whole.filter(|_| !is_cut) else { return (None, counts) };
        for (count, likeness) in counts.iter_mut().zip(self.likenesses) {
            if summary.is_alike(likeness) {
                *count = (1, (summary.squares - summary.sum * summary.sum / summary.n).max(0.0));
            }
        }
        (Some(summary), counts)
    }
}

impl Summary {
    fn with(&self, other: &Self) -> Self {
        let range = |k: usize| {
            let ([a, b], [c, d]) = (self.ranges[k], other.ranges[k]);
            [a.min(c), b.max(d)]
        };
        Self {
            ranges: [0, 1, 2, 3].map(range),
            n: self.n + other.n,
            sum: self.sum + other.sum,
            squares: self.squares + other.squares,
        }
    }

    fn is_alike(&self, likeness: &Likeness) -> bool {
        let spread = |k: usize| f64::from(self.ranges[k][1]) - f64::from(self.ranges[k][0]);
        spread(0) <= likeness.value && (1..4).all(|k| spread(k) <= likeness.gradient)
    }
}

/// How many regions values alone would leave with an error of `rms`, between those of `ladder`, which
/// rises; none where it does not reach so far.
#[must_use]
pub(super) fn regions_at(ladder: &[Joined], rms: f64) -> Option<f64> {
    let pair = ladder.windows(2).find(|pair| pair[0].rms <= rms && rms <= pair[1].rms)?;
    let width = pair[1].rms - pair[0].rms;
    let part = if width > 0.0 { (rms - pair[0].rms) / width } else { 0.0 };
    let [a, b] = [pair[0].regions, pair[1].regions].map(|n| n as f64);
    Some(a + part * (b - a))
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::*;
    use crate::{
        hrb::{HrbOctree, Tolerance},
        volume::Samples,
    };

    #[test]
    fn values_alone_give_the_regions_of_the_octree() {
        let value = |i: u32| ((i % 16) / 3 + (i / 16 % 16) / 5 + i / 256 / 2) as u8;
        let bytes: Vec<u8> = (0..16 * 16 * 16).map(value).collect();
        let size = [16; 3];
        let samples = Samples::U8(bytes.clone());
        let volume = Volume { size, samples, placing: DAffine3::IDENTITY };
        let epsilons = [0.0, 1.0, 2.0, 4.0];
        let likenesses = epsilons.map(|value| Likeness { value, gradient: f64::INFINITY });
        let found = joined(&volume, &likenesses);
        for (epsilon, joined) in epsilons.into_iter().zip(&found) {
            let tolerance = Tolerance { epsilon, ..Tolerance::default() };
            let octree = HrbOctree::build(&bytes, size, tolerance);
            assert_eq!(joined.regions, octree.storage().regions);
            assert!(joined.rms <= epsilon);
        }
        assert_eq!(found[0].rms, 0.0);
        // A bound of gradients divides further.
        let strict = joined(&volume, &[Likeness { value: 4.0, gradient: 0.5 }]);
        assert!(strict[0].regions > found[3].regions && strict[0].rms < found[3].rms);
        let between = regions_at(&found, strict[0].rms).unwrap();
        assert!((found[3].regions as f64..=found[0].regions as f64).contains(&between));
    }
}
