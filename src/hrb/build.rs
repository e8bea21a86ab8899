//! From samples to regions, in one pass: subtrees of 64³ samples by themselves, each from bricks of
//! 8³, then the nodes above them.
//!
//! A node becomes one region if its own samples, not the means of its children, are alike: errors do
//! not add up from level to level. Nodes that reach beyond the volume are always divided.

use rayon::prelude::*;

use super::{
    octree::{HrbOctree, Level},
    sample::{Sample, Value},
};

/// When samples are alike.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tolerance {
    /// How much they may differ; 0 keeps every sample exactly.
    pub epsilon: f64,
    /// What is compared.
    pub criterion: Criterion,
}

/// What is compared with the tolerance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Criterion {
    /// The largest sample and the least (León Salas, definition 3).
    #[default]
    Range,
    /// Each sample and the mean.
    Deviation,
}

/// Edge of a brick, as a power of two.
const BRICK_LEVEL: u8 = 3;
const BRICK: usize = 512;
/// Edge of a subtree that one thread builds, as a power of two.
const SUBTREE_LEVEL: u8 = 7;

/// What is known of the samples in a node.
#[derive(Clone, Copy)]
struct Summary<T: Sample> {
    least: T,
    most: T,
    sum: T::Sum,
    /// Samples.
    n: u64,
    /// Whether the node reaches beyond the volume.
    is_cut: bool,
}

/// What became of a node.
#[derive(Clone, Copy)]
enum State<T: Sample> {
    /// It has no samples.
    Beyond,
    /// One region.
    Region(Summary<T>),
    /// Divided.
    Divided(Summary<T>),
}

/// A volume and when its samples are alike.
struct Builder<'a, T> {
    samples: &'a [T],
    size: [u32; 3],
    tolerance: Tolerance,
}

/// A node with the levels of what is divided below it, its own first.
struct Subtree<T: Sample> {
    levels: Vec<Level<T::Value>>,
    state: State<T>,
}

impl<V: Value> HrbOctree<V> {
    /// The regions of a volume of `size` samples, x fastest.
    ///
    /// # Panics
    /// If there are not as many samples, or none, or more than 2^20 along an axis.
    #[must_use]
    pub fn build<T: Sample<Value = V>>(
        samples: &[T],
        size: [u32; 3],
        tolerance: Tolerance,
    ) -> Self {
        let n: u64 = size.iter().map(|&n| u64::from(n)).product();
        assert!(n == samples.len() as u64 && n > 0, "as many samples as the size says");
        let longest = size.into_iter().max().unwrap_or(1);
        assert!(longest <= 1 << 20, "samples are counted in 20 bits an axis");
        let depth = (longest.next_power_of_two().ilog2() as u8).max(BRICK_LEVEL);
        let builder = Builder { samples, size, tolerance };
        let Subtree { mut levels, state } = builder.subtree([0; 3], depth);
        let root = match state {
            State::Region(summary) => value(&summary),
            _ => T::Value::default(),
        };
        levels.iter_mut().for_each(Level::count);
        Self { size, depth, levels, root }
    }
}

impl<T: Sample> Builder<'_, T> {
    /// Builds a node with edges of `2^level` samples, by all threads.
    fn subtree(&self, base: [u32; 3], level: u8) -> Subtree<T> {
        let mut levels: Vec<Level<T::Value>> = (0..level).map(|_| Level::default()).collect();
        if level <= SUBTREE_LEVEL || self.is_beyond(base) {
            let state = self.node(base, level, &mut levels);
            return Subtree { levels, state };
        }
        let children: Vec<Subtree<T>> = (0..8)
            .into_par_iter()
            .map(|c| self.subtree(child(base, level, c), level - 1))
            .collect();
        let states = std::array::from_fn(|c| children[c].state);
        let state = self.parent(&states, &mut levels[0]);
        if let State::Divided(_) = state {
            for (below, all) in levels[1..].iter_mut().enumerate() {
                children.iter().for_each(|child| all.append(&child.levels[below]));
            }
        }
        Subtree { levels, state }
    }

    /// Builds a node; what is divided is put at the end of `levels`, its own level first.
    fn node(&self, base: [u32; 3], level: u8, levels: &mut [Level<T::Value>]) -> State<T> {
        if self.is_beyond(base) {
            return State::Beyond;
        }
        if level == 0 {
            let sample = self.samples[self.index(base)];
            return State::Region(Summary {
                least: sample,
                most: sample,
                sum: sample.sum(),
                n: 1,
                is_cut: false,
            });
        }
        if level == BRICK_LEVEL && (0..3).all(|axis| base[axis] + 8 <= self.size[axis]) {
            return self.brick(base, levels);
        }
        self.divided(levels, |c, below| self.node(child(base, level, c), level - 1, below))
    }

    /// What becomes of a node whose children `build` puts behind those before them.
    fn divided(
        &self,
        levels: &mut [Level<T::Value>],
        mut build: impl FnMut(u32, &mut [Level<T::Value>]) -> State<T>,
    ) -> State<T> {
        let Some((own, below)) = levels.split_first_mut() else {
            unreachable!("a level for every node above samples")
        };
        let mut marks = [[0; 2]; MAX_DEPTH];
        for (mark, level) in marks.iter_mut().zip(&*below) {
            *mark = [level.divided.len(), level.values.len()];
        }
        let children = std::array::from_fn(|c| build(c as u32, below));
        let state = self.parent(&children, own);
        if !matches!(state, State::Divided(_)) {
            below.iter_mut().zip(marks).for_each(|(level, mark)| level.truncate(mark));
        }
        state
    }

    /// What becomes of a node with these children; if it is divided it is put into `level`.
    #[inline]
    fn parent(&self, children: &[State<T>; 8], level: &mut Level<T::Value>) -> State<T> {
        let mut whole: Option<Summary<T>> = None;
        let mut is_beyond = false;
        for child in children {
            match child {
                State::Beyond => is_beyond = true,
                State::Region(summary) | State::Divided(summary) => {
                    whole = Some(whole.map_or(*summary, |whole| whole.with(summary)));
                }
            }
        }
        let Some(mut summary) = whole else { return State::Beyond };
        summary.is_cut |= is_beyond;
        if !summary.is_cut && self.is_alike(&summary) {
            return State::Region(summary);
        }
        let mut divided = 0;
        for (c, child) in children.iter().enumerate() {
            match child {
                State::Beyond => level.values.push(T::Value::default()),
                State::Region(summary) => level.values.push(value(summary)),
                State::Divided(_) => divided |= 1 << c,
            }
        }
        level.divided.push(divided);
        level.ranges.push([summary.least.value(), summary.most.value()]);
        State::Divided(summary)
    }

    /// Builds a brick of 8³ samples.
    fn brick(&self, base: [u32; 3], levels: &mut [Level<T::Value>]) -> State<T> {
        // Sample c of pair g stands at 64 c + g: the samples of all pairs are compared at once.
        let mut samples = [self.samples[self.index(base)]; BRICK];
        for z in 0..8_usize {
            for y in 0..8_usize {
                let first = self.index([base[0], base[1] + y as u32, base[2] + z as u32]);
                let row = &self.samples[first..first + 8];
                let c = (y & 1) << 1 | (z & 1) << 2;
                let g = SPREAD[y >> 1] << 1 | SPREAD[z >> 1] << 2;
                for x in 0..8 {
                    samples[64 * (c | x & 1) + (g | SPREAD[x >> 1])] = row[x];
                }
            }
        }
        let (mut least, mut most) = ([samples[0]; 64], [samples[0]; 64]);
        least.copy_from_slice(&samples[..64]);
        most.copy_from_slice(&samples[..64]);
        for c in 1..8 {
            for g in 0..64 {
                let sample = samples[64 * c + g];
                least[g] = least[g].least(sample);
                most[g] = most[g].most(sample);
            }
        }
        let pair = |g: usize, level: &mut Level<T::Value>| {
            let of_pair = |c: usize| samples[64 * c + g];
            let sum = (1..8).fold(of_pair(0).sum(), |sum, c| T::add(sum, of_pair(c).sum()));
            let summary = Summary { least: least[g], most: most[g], sum, n: 8, is_cut: false };
            if self.is_alike(&summary) {
                return State::Region(summary);
            }
            level.divided.push(0);
            level.ranges.push([summary.least.value(), summary.most.value()]);
            level.values.extend((0..8).map(|c| of_pair(c).value()));
            State::Divided(summary)
        };
        self.divided(levels, |four, below| {
            self.divided(below, |two, below| pair((8 * four + two) as usize, &mut below[0]))
        })
    }

    fn is_beyond(&self, base: [u32; 3]) -> bool {
        (0..3).any(|axis| base[axis] >= self.size[axis])
    }

    fn index(&self, [x, y, z]: [u32; 3]) -> usize {
        let [nx, ny, _] = self.size.map(|n| n as usize);
        x as usize + nx * (y as usize + ny * z as usize)
    }

    #[inline]
    fn is_alike(&self, Summary { least, most, sum, n, .. }: &Summary<T>) -> bool {
        let Tolerance { epsilon, criterion } = self.tolerance;
        // What is no number is like nothing.
        let (low, high) = (least.to_f64(), most.to_f64());
        match criterion {
            Criterion::Range => high - low <= epsilon,
            Criterion::Deviation => {
                let mean = T::mean(*sum, *n).to_f64();
                high - mean <= epsilon && mean - low <= epsilon
            }
        }
    }
}

/// Levels of an octree, at most.
const MAX_DEPTH: usize = 21;

/// Two bits with room for two others between them.
const SPREAD: [usize; 4] = [0, 1, 8, 9];

/// The first sample of child `c` of a node.
fn child(base: [u32; 3], level: u8, c: u32) -> [u32; 3] {
    let half = 1 << (level - 1);
    [0, 1, 2].map(|axis| base[axis] + half * (c >> axis & 1))
}

/// What a region keeps: its samples, if they are the same, or their mean.
#[inline]
fn value<T: Sample>(summary: &Summary<T>) -> T::Value {
    if summary.least == summary.most {
        summary.least.value()
    } else {
        T::mean(summary.sum, summary.n)
    }
}

impl<T: Sample> Summary<T> {
    #[inline]
    fn with(&self, other: &Self) -> Self {
        Self {
            least: self.least.least(other.least),
            most: self.most.most(other.most),
            sum: T::add(self.sum, other.sum),
            n: self.n + other.n,
            is_cut: self.is_cut || other.is_cut,
        }
    }
}
