//! From samples to regions, in one pass: bricks of 8³ samples by themselves, then the nodes above
//! them.
//!
//! A node becomes one region if its own samples, not the means of its children, are alike: errors do
//! not add up from level to level. Nodes that reach beyond the volume are always divided.

use std::array;

use rayon::prelude::*;

use super::{
    brick::Brick,
    octree::{BRICK_LEVEL, HrbOctree, Node, Tree, child},
    parts::{PARTS, Parts},
    sample::{Sample, Value},
};
use crate::mesh::{SIDE, VOXELS};

/// When samples are alike.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tolerance {
    /// How much they may differ; 0 keeps every sample exactly, and below 0 not even equal ones are
    /// alike.
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

/// Edge of a subtree that one thread builds, as a power of two.
const SUBTREE_LEVEL: u8 = 6;

/// What is known of the samples in a node.
#[derive(Clone, Copy)]
pub(super) struct Summary<T: Sample> {
    least: T,
    most: T,
    /// Counted only where a tolerance asks for means.
    sum: T::Sum,
    /// Samples.
    n: u64,
    /// Whether the node reaches beyond the volume.
    is_cut: bool,
}

/// A volume and when its samples are alike.
pub(super) struct Builder<'a, T> {
    pub(super) samples: &'a [T],
    pub(super) size: [u32; 3],
    pub(super) tolerance: Tolerance,
}

/// What became of a node, and what is known of its samples, if it has any.
pub(super) type Built<T> = (Tree<<T as Sample>::Value>, Option<Summary<T>>);

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
        let (root, _) = Builder { samples, size, tolerance }.node([0; 3], depth);
        Self { size, depth, root }
    }
}

impl<T: Sample> Builder<'_, T> {
    /// Builds a node with edges of `2^level` samples.
    fn node(&self, base: [u32; 3], level: u8) -> Built<T> {
        if (0..3).any(|axis| base[axis] >= self.size[axis]) {
            return (Tree::region(T::Value::default()), None);
        }
        if level == BRICK_LEVEL {
            return self.brick(base);
        }
        let build = |c: usize| self.node(child(base, level, c), level - 1);
        let children: [Built<T>; 8] = if level > SUBTREE_LEVEL {
            let children: Vec<Built<T>> = (0..8).into_par_iter().map(build).collect();
            match children.try_into() {
                Ok(children) => children,
                Err(_) => unreachable!("eight children"),
            }
        } else {
            array::from_fn(build)
        };
        let summary =
            children.iter().map(|(_, summary)| *summary).reduce(Summary::joined).flatten();
        match summary {
            Some(of_all) if self.is_divided(&of_all) => {
                let children = children.map(|(tree, _)| tree);
                (Tree::Node(Box::new(Node { children, range: of_all.range() })), summary)
            }
            Some(of_all) => (Tree::region(of_all.value()), summary),
            None => (Tree::region(T::Value::default()), None),
        }
    }

    /// Builds a node of 8³ samples.
    pub(super) fn brick(&self, base: [u32; 3]) -> Built<T> {
        let left = [0, 1, 2].map(|axis| (self.size[axis] - base[axis]).min(SIDE) as usize);
        let [nx, ny, _] = self.size.map(|n| n as usize);
        let own = &self.samples[self.index(base)..];
        let row = |y: usize, z: usize| &own[nx * (y + ny * z)..][..left[0]];
        let first = row(0, 0)[0];
        if left == [SIDE as usize; 3] && self.tolerance.epsilon >= 0.0 {
            let is_first = |row: &[T]| row.as_array::<8>().is_some_and(|row| *row == [first; 8]);
            if (0..8).all(|z| (0..8).all(|y| is_first(row(y, z)))) {
                return (Tree::region(first.value()), Some(Summary::of(first, VOXELS as u64)));
            }
        }
        let parts = Parts::of(first, left, row);
        let n = left.iter().map(|&n| n as u64).product();
        let all = self.summary_between(&parts, (0, PARTS), parts.range_of_all());
        let summary = Summary { n, ..all };
        if !self.is_divided(&summary) {
            return (Tree::region(summary.value()), Some(summary));
        }
        let (fours, twos) = self.divided(&parts);
        let is_exact = self.is_exact(&parts);
        let value = |first: usize, n: usize| match is_exact {
            true => parts.range(first)[0].value(),
            false => self.summary(&parts, first, n).value(),
        };
        let n = 8 + 7 * (fours.count_ones() + twos.count_ones()) as usize;
        let mut values = Vec::with_capacity(n);
        if twos == u64::MAX {
            values.extend(parts.samples.iter().map(|sample| sample.value()));
        } else {
            for c in 0..8 {
                if fours >> c & 1 == 0 {
                    values.push(value(8 * c, 8));
                    continue;
                }
                for g in 8 * c..8 * c + 8 {
                    match twos >> g & 1 {
                        0 => values.push(value(g, 1)),
                        _ => values.extend(parts.eight(g).map(T::value)),
                    }
                }
            }
        }
        let (values, corners) = (values.into(), Box::default());
        let brick = Brick { fours, twos, values, corners, range: summary.range() };
        (Tree::Brick(Box::new(brick)), Some(summary))
    }

    /// Which parts of 4³ samples, and of those which parts of 2³, are divided.
    #[inline]
    fn divided(&self, parts: &Parts<T>) -> (u8, u64) {
        let (mut fours, mut twos) = (0, parts.mixed());
        let is_exact = self.is_exact(parts);
        for c in 0..8 {
            let own = 0xff << (8 * c);
            let is_divided = if is_exact {
                let [least, _] = parts.range(8 * c);
                twos & own != 0 || (8 * c + 1..8 * c + 8).any(|g| parts.range(g)[0] != least)
            } else {
                self.is_divided(&self.summary(parts, 8 * c, 8))
            };
            if !is_divided {
                twos &= !own;
                continue;
            }
            fours |= 1 << c;
            if !is_exact {
                for g in 8 * c..8 * c + 8 {
                    let is_divided = self.is_divided(&self.summary(parts, g, 1));
                    twos = twos & !(1 << g) | u64::from(is_divided) << g;
                }
            }
        }
        (fours, twos)
    }

    /// Whether parts that are not divided have equal samples, and nothing else has.
    #[inline]
    fn is_exact(&self, parts: &Parts<T>) -> bool {
        self.tolerance == Tolerance::default() && parts.is_whole()
    }

    /// What is known of `n` parts of a brick from `first` on: one, or a part of 4³ samples.
    #[inline]
    fn summary(&self, parts: &Parts<T>, first: usize, n: usize) -> Summary<T> {
        let [mut least, mut most] = parts.range(first);
        for range in (first + 1..first + n).map(|g| parts.range(g)) {
            least = least.least(range[0]);
            most = most.most(range[1]);
        }
        self.summary_between(parts, (first, n), [least, most])
    }

    /// The same of parts of which it is known what they are between.
    #[inline]
    fn summary_between(
        &self,
        parts: &Parts<T>,
        (first, n): (usize, usize),
        [least, most]: [T; 2],
    ) -> Summary<T> {
        let is_cut = parts.is_cut(first, n);
        let mut summary = Summary { least, most, is_cut, ..Summary::of(least, 8 * n as u64) };
        // Otherwise regions are their samples, and no mean is asked for.
        if self.tolerance != Tolerance::default() {
            summary.sum = parts.sum(first, n).unwrap_or(summary.sum);
        }
        summary
    }

    fn index(&self, [x, y, z]: [u32; 3]) -> usize {
        let [nx, ny, _] = self.size.map(|n| n as usize);
        x as usize + nx * (y as usize + ny * z as usize)
    }

    #[inline]
    fn is_divided(&self, summary: &Summary<T>) -> bool {
        let Tolerance { epsilon, criterion } = self.tolerance;
        // What is no number is like nothing.
        let (low, high) = (summary.least.to_f64(), summary.most.to_f64());
        let is_alike = match criterion {
            _ if summary.least == summary.most => epsilon >= 0.0,
            Criterion::Range => high - low <= epsilon,
            Criterion::Deviation => {
                let mean = T::mean(summary.sum, summary.n).to_f64();
                high - mean <= epsilon && mean - low <= epsilon
            }
        };
        summary.is_cut || !is_alike
    }
}

impl<T: Sample> Summary<T> {
    /// Of `n` samples like this one.
    #[inline]
    fn of(sample: T, n: u64) -> Self {
        Self { least: sample, most: sample, sum: T::times(sample, n), n, is_cut: false }
    }

    /// Of two nodes; what has no samples lies beyond the volume.
    fn joined(a: Option<Self>, b: Option<Self>) -> Option<Self> {
        let (Some(a), Some(b)) = (a, b) else {
            return a.or(b).map(|one| Self { is_cut: true, ..one });
        };
        Some(Self {
            least: a.least.least(b.least),
            most: a.most.most(b.most),
            sum: T::add(a.sum, b.sum),
            n: a.n + b.n,
            is_cut: a.is_cut || b.is_cut,
        })
    }

    /// What a region keeps: its samples, if they are the same, or their mean.
    #[inline]
    fn value(&self) -> T::Value {
        if self.least == self.most { self.least.value() } else { T::mean(self.sum, self.n) }
    }

    fn range(&self) -> [T::Value; 2] {
        [self.least.value(), self.most.value()]
    }
}
