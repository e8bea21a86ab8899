//! The octree that one would make without voxels: of cells between samples, which keep their eight
//! corners and are joined where all samples in them are alike.
//!
//! A cell's value is trilinear between its corners, so where cells of different size meet it jumps
//! unless samples are the same; and a corner is kept as long as one cell around it needs it.
//!
//! *Based on:* A. León Salas, 2008, sections 2.1 and 2.2 (cells and voxels compared).

use crate::volume::Volume;

/// Cells of a volume, joined.
#[derive(Clone, Debug)]
pub struct CellOctree<'a> {
    volume: &'a Volume,
    /// Of cells between samples.
    size: [u32; 3],
    /// For each of the smallest cells, x fastest: the edge of the one that it is part of is 2^level.
    levels: Vec<u8>,
}

/// What cells and their corners are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// Cells.
    pub cells: u64,
    /// Samples that are a corner of some cell.
    pub corners: u64,
}

impl<'a> CellOctree<'a> {
    /// Joins cells whose samples differ by `epsilon` at most; volumes have two samples at least along
    /// each axis.
    #[must_use]
    pub fn build(volume: &'a Volume, epsilon: f64) -> Self {
        let size = volume.size.map(|n| (n - 1).max(1));
        let n_cells = size.iter().map(|&n| n as usize).product();
        let mut octree = Self { volume, size, levels: vec![0; n_cells] };
        let longest = size.into_iter().max().unwrap_or(1);
        let depth = longest.next_power_of_two().ilog2() as u8;
        octree.join([0; 3], depth, epsilon);
        octree
    }

    /// The least and the largest sample of a block, unless it reaches beyond the volume or is not
    /// joined.
    fn join(&mut self, base: [u32; 3], level: u8, epsilon: f64) -> Option<[f64; 2]> {
        if (0..3).any(|axis| base[axis] >= self.size[axis]) {
            return None;
        }
        if level == 0 {
            let corner = |c: u32| self.sample([0, 1, 2].map(|axis| base[axis] + (c >> axis & 1)));
            let corners: [f64; 8] = std::array::from_fn(|c| corner(c as u32));
            // What is no number is like nothing.
            let is_known = corners.iter().all(|v| !v.is_nan());
            let low = corners.into_iter().fold(f64::MAX, f64::min);
            let high = corners.into_iter().fold(f64::MIN, f64::max);
            return is_known.then_some([low, high]);
        }
        let half = 1 << (level - 1);
        let children: [Option<[f64; 2]>; 8] = std::array::from_fn(|c| {
            let base = [0, 1, 2].map(|axis| base[axis] + half * (c as u32 >> axis & 1));
            self.join(base, level - 1, epsilon)
        });
        let mut range = [f64::MAX, f64::MIN];
        for child in children {
            let [low, high] = child?;
            range = [range[0].min(low), range[1].max(high)];
        }
        if range[1] - range[0] > epsilon {
            return None;
        }
        let side = 1_u32 << level;
        for z in base[2]..base[2] + side {
            for y in base[1]..base[1] + side {
                let first = self.index([base[0], y, z]);
                self.levels[first..first + side as usize].fill(level);
            }
        }
        Some(range)
    }

    fn index(&self, [x, y, z]: [u32; 3]) -> usize {
        let [nx, ny, _] = self.size.map(|n| n as usize);
        x as usize + nx * (y as usize + ny * z as usize)
    }

    fn sample(&self, p: [u32; 3]) -> f64 {
        self.volume.value([0, 1, 2].map(|axis| p[axis].min(self.volume.size[axis] - 1)))
    }

    /// How many cells there are, and how many samples they need.
    #[must_use]
    pub fn counts(&self) -> Counts {
        let [nx, ny, nz] = self.volume.size.map(|n| n as usize);
        let mut is_kept = vec![false; nx * ny * nz];
        let mut cells = 0;
        for (i, &level) in self.levels.iter().enumerate() {
            let i = i as u32;
            let p = [
                i % self.size[0],
                i / self.size[0] % self.size[1],
                i / self.size[0] / self.size[1],
            ];
            if p.iter().any(|x| x & ((1 << level) - 1) != 0) {
                continue;
            }
            cells += 1;
            for c in 0..8 {
                let corner = [0, 1, 2].map(|axis| {
                    (p[axis] + (c >> axis & 1) * (1 << level)).min(self.volume.size[axis] - 1)
                        as usize
                });
                is_kept[corner[0] + nx * (corner[1] + ny * corner[2])] = true;
            }
        }
        Counts { cells, corners: is_kept.iter().filter(|kept| **kept).count() as u64 }
    }

    /// The value at a point, in samples from the volume's first corner. On the border of two cells,
    /// that of the upper one.
    #[must_use]
    pub fn value_at(&self, point: [f64; 3]) -> f64 {
        let at = [0, 1, 2]
            .map(|axis| (point[axis] - 0.5).clamp(0.0, f64::from(self.volume.size[axis] - 1)));
        let cell = [0, 1, 2].map(|axis| (at[axis] as u32).min(self.size[axis] - 1));
        self.value_in(cell, at)
    }

    /// What the cell that holds one of the smallest cells says of a point, counted from the first
    /// sample.
    fn value_in(&self, cell: [u32; 3], at: [f64; 3]) -> f64 {
        let level = self.levels[self.index(cell)];
        let (base, side) = (cell.map(|i| i >> level << level), 1_u32 << level);
        let corner =
            |c: u32| self.sample([0, 1, 2].map(|axis| base[axis] + side * (c >> axis & 1)));
        let part = [0, 1, 2].map(|axis| (at[axis] - f64::from(base[axis])) / f64::from(side));
        let blend = |a: f64, b: f64, part: f64| a + part * (b - a);
        let along = |c: u32| blend(corner(c), corner(c + 1), part[0]);
        blend(blend(along(0), along(2), part[1]), blend(along(4), along(6), part[1]), part[2])
    }

    /// The largest difference between what two cells say of their common border. It is largest at a
    /// corner of one of the smallest faces.
    #[must_use]
    pub fn largest_jump(&self) -> f64 {
        let mut largest = 0.0_f64;
        let [nx, ny, nz] = self.size;
        for z in 0..nz {
            for y in 0..ny {
                for x in 0..nx {
                    let p = [x, y, z];
                    let level = self.levels[self.index(p)];
                    for axis in 0..3 {
                        let mut next = p;
                        next[axis] += 1;
                        if next[axis] >= self.size[axis] || self.levels[self.index(next)] == level {
                            continue;
                        }
                        for c in 0..4 {
                            let mut corner = next;
                            corner[(axis + 1) % 3] += c & 1;
                            corner[(axis + 2) % 3] += c >> 1;
                            let at = corner.map(f64::from);
                            let jump = self.value_in(p, at) - self.value_in(next, at);
                            largest = largest.max(jump.abs());
                        }
                    }
                }
            }
        }
        largest
    }
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::*;
    use crate::volume::Samples;

    fn volume(n: u32, value: impl Fn([u32; 3]) -> u8) -> Volume {
        let at = |i: u32| value([i % n, i / n % n, i / n / n]);
        let samples = Samples::U8((0..n * n * n).map(at).collect());
        Volume { size: [n; 3], samples, placing: DAffine3::IDENTITY }
    }

    #[test]
    fn a_constant_is_one_cell_and_a_checkerboard_none_joined() {
        let constant = volume(9, |_| 7);
        assert_eq!(CellOctree::build(&constant, 0.0).counts(), Counts { cells: 1, corners: 8 });
        let board = volume(9, |[x, y, z]| (x + y + z) as u8 % 2);
        let counts = CellOctree::build(&board, 0.0).counts();
        assert_eq!(counts, Counts { cells: 512, corners: 729 });
    }

    #[test]
    fn cells_of_one_size_are_continuous_and_others_jump_within_the_tolerance() {
        let ramp = volume(17, |[x, y, z]| (x * x / 8 + y + z / 2) as u8);
        let fine = CellOctree::build(&ramp, 0.5);
        assert_eq!(fine.largest_jump(), 0.0);
        let coarse = CellOctree::build(&ramp, 6.0);
        assert!(coarse.counts().cells < fine.counts().cells);
        assert!((0.1..=6.0).contains(&coarse.largest_jump()));
        for p in [[0.5, 0.5, 0.5], [3.5, 9.5, 16.5]] {
            let sample = p.map(|x: f64| x as u32);
            assert_eq!(fine.value_at(p), ramp.value(sample));
        }
    }
}
