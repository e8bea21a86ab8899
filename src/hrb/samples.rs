//! Boxes of samples of a volume, and their values in rows.

/// A box of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Samples {
    /// The first one.
    pub first: [u32; 3],
    /// Behind the last one, along each axis.
    pub end: [u32; 3],
}

impl Samples {
    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        (0..3).any(|axis| self.first[axis] >= self.end[axis])
    }

    /// Samples along each axis.
    #[must_use]
    pub fn size(&self) -> [usize; 3] {
        [0, 1, 2].map(|axis| self.end[axis].saturating_sub(self.first[axis]) as usize)
    }

    /// How many there are.
    #[must_use]
    pub fn n(&self) -> usize {
        self.size().iter().product()
    }

    /// All of them, x fastest.
    pub fn iter(&self) -> impl Iterator<Item = [u32; 3]> + use<> {
        let Self { first, end } = *self;
        (first[2]..end[2]).flat_map(move |z| {
            (first[1]..end[1]).flat_map(move |y| (first[0]..end[0]).map(move |x| [x, y, z]))
        })
    }

    /// Where the rows along x begin, in order.
    pub fn rows(&self) -> impl Iterator<Item = [u32; 3]> + use<> {
        let Self { first, end } = *self;
        (first[2]..end[2]).flat_map(move |z| (first[1]..end[1]).map(move |y| [first[0], y, z]))
    }

    /// The number of one of them.
    #[inline]
    #[must_use]
    pub fn index(&self, p: [u32; 3]) -> usize {
        let [nx, ny, _] = self.size();
        let [x, y, z] = [0, 1, 2].map(|axis| (p[axis] - self.first[axis]) as usize);
        x + nx * (y + ny * z)
    }

    /// Those that another box has too.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        Self {
            first: [0, 1, 2].map(|axis| self.first[axis].max(other.first[axis])),
            end: [0, 1, 2].map(|axis| self.end[axis].min(other.end[axis])),
        }
    }

    /// The least box with these and those of another, which may be empty.
    #[must_use]
    pub fn with(&self, other: &Self) -> Self {
        if self.is_empty() {
            return *other;
        }
        Self {
            first: [0, 1, 2].map(|axis| self.first[axis].min(other.first[axis])),
            end: [0, 1, 2].map(|axis| self.end[axis].max(other.end[axis])),
        }
    }

    /// With `n` more on every side, as far as numbers reach.
    #[must_use]
    pub fn grown(&self, n: u32) -> Self {
        Self { first: self.first.map(|i| i.saturating_sub(n)), end: self.end.map(|i| i + n) }
    }

    /// In boxes of `edge` samples or less along each axis.
    #[must_use]
    pub(crate) fn blocks(&self, edge: u32) -> Vec<Self> {
        let n = self.size().map(|n| (n as u32).div_ceil(edge));
        let block = |b: [u32; 3]| {
            let first = [0, 1, 2].map(|axis| self.first[axis] + edge * b[axis]);
            Self { first, end: first.map(|i| i + edge) }.and(self)
        };
        Self { first: [0; 3], end: n }.iter().map(block).collect()
    }

    /// None.
    pub(super) const NONE: Self = Self { first: [0; 3], end: [0; 3] };

    /// Those of a node.
    pub(super) fn of_node(base: [u32; 3], level: u8) -> Self {
        Self { first: base, end: base.map(|i| i + (1 << level)) }
    }

    /// Whether a node reaches into the box.
    #[inline]
    pub(super) fn meets(&self, base: [u32; 3], level: u8) -> bool {
        (0..3)
            .all(|axis| base[axis] < self.end[axis] && base[axis] + (1 << level) > self.first[axis])
    }
}

/// Copies what two boxes have in common from the values of one, x fastest, to those of the other.
pub(crate) fn copy<V: Copy>(from: &[V], of: &Samples, to: &mut [V], into: &Samples) {
    let common = of.and(into);
    let n = common.size()[0];
    for row in common.rows() {
        let (start, goal) = (of.index(row), into.index(row));
        to[goal..goal + n].copy_from_slice(&from[start..start + n]);
    }
}

/// Joins to everything in a box of `n`, x fastest, what is beside it along every axis, and so all that
/// is in the 27 places around.
pub(crate) fn join_around<T: Copy>(all: &mut [T], n: [usize; 3], join: impl Fn(&mut T, T)) {
    // One axis after the other.
    let mut step = 1;
    for n in n {
        let before = all.to_vec();
        let run = (step * n).max(1);
        for (run, before) in all.chunks_mut(run).zip(before.chunks(run)) {
            run[step..].iter_mut().zip(before).for_each(|(one, &beside)| join(one, beside));
            run.iter_mut().zip(&before[step..]).for_each(|(one, &beside)| join(one, beside));
        }
        step *= n;
    }
}
