//! Plain Marching Cubes on all samples of a grid: what the dual grid of an octree is measured by.
//!
//! Which samples lie inside is a bit for each; rows of bits tell 64 edges at a time which of them are
//! cut, and the number of a vertex is the number of the first one in its row and the count of bits
//! before it. Cells reach from border to border as those of the dual grid do, with the same phantoms
//! beyond, so that an octree of nothing but single samples gives the same triangles.
//!
//! *Based on:* W. Lorensen, H. Cline, "Marching Cubes", SIGGRAPH 1987; W. Schroeder, R. Maynard,
//! B. Geveci, "Flying Edges", LDAV 2015 (rows that are counted before vertices are made).

use rayon::prelude::*;

use super::{
    Border,
    cases::{CASES, N_EDGES},
    extract::zone,
    grid::offset,
};

/// Triangles with shared vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangles {
    /// In samples from the grid's first corner; samples stand in the middles of unit cubes.
    pub positions: Vec<[f32; 3]>,
    /// Counter-clockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// What samples must be to lie inside.
pub trait Threshold: Copy + Default + PartialOrd + Into<f64> + Send + Sync {
    /// The least sample that is not below `isovalue`, if there is one.
    fn at_least(isovalue: f64) -> Option<Self>;
}

macro_rules! integer_threshold {
    ($($type:ty),*) => {$(
        impl Threshold for $type {
            fn at_least(isovalue: f64) -> Option<Self> {
                // The conversion is cut to the type's range.
                (isovalue <= f64::from(Self::MAX)).then_some(isovalue.ceil() as Self)
            }
        }
    )*};
}

integer_threshold!(u8, i8, u16, i16, u32, i32);

impl Threshold for f32 {
    fn at_least(isovalue: f64) -> Option<Self> {
        let nearest = isovalue as Self;
        let above = if f64::from(nearest) < isovalue { nearest.next_up() } else { nearest };
        (!above.is_nan()).then_some(above)
    }
}

impl Threshold for f64 {
    fn at_least(isovalue: f64) -> Option<Self> {
        Some(isovalue)
    }
}

/// The surface where `samples`, x fastest, are `isovalue`; what is more is inside.
///
/// # Panics
/// If there are not as many samples as `size` says.
#[must_use]
pub fn uniform<T: Threshold>(
    samples: &[T],
    size: [u32; 3],
    isovalue: f64,
    border: Border,
) -> Triangles {
    let size = size.map(|n| n as usize);
    assert!(size.iter().product::<usize>() == samples.len(), "as many samples as the size says");
    if samples.is_empty() {
        return Triangles::default();
    }
    let bits = Bits::of(samples, size, isovalue, border);
    let firsts = bits.firsts();
    let plain = Plain { samples, isovalue, border, bits, firsts };
    let slices = 0..size[2] + 2;
    let positions: Vec<Vec<[f32; 3]>> =
        slices.clone().into_par_iter().map(|z| plain.positions(z)).collect();
    let triangles: Vec<Vec<[u32; 3]>> =
        slices.into_par_iter().map(|z| plain.triangles(z)).collect();
    Triangles { positions: positions.concat(), triangles: triangles.concat() }
}

/// Which points lie inside. Points are samples and a layer of phantoms around them: coordinate 0 is
/// beyond the first sample, and n + 1 beyond the last.
struct Bits {
    /// Of samples.
    size: [usize; 3],
    /// In a row of points.
    n_words: usize,
    /// Rows of samples, then one without bits for what is beyond a capped border.
    words: Vec<u64>,
    border: Border,
}

impl Bits {
    fn of<T: Threshold>(samples: &[T], size: [usize; 3], isovalue: f64, border: Border) -> Self {
        let [nx, ny, nz] = size;
        let n_words = (nx + 2).div_ceil(64);
        let mut words = vec![0; n_words * (ny * nz + 1)];
        if let Some(least) = T::at_least(isovalue) {
            let rows = samples.par_chunks(nx);
            words.par_chunks_mut(n_words).zip(rows).with_min_len(64).for_each(|(row, samples)| {
                let mut before = 0;
                for (word, some) in row.iter_mut().zip(samples.chunks(64)) {
                    let inside = packed(some, least);
                    *word = before | inside << 1;
                    before = inside >> 63;
                }
                row[nx / 64] |= if nx.is_multiple_of(64) { before } else { 0 };
                if border == Border::Open {
                    let bit = |x: usize| row[x / 64] >> (x % 64) & 1;
                    let (first, last) = (bit(1), bit(nx));
                    row[0] |= first;
                    row[(nx + 1) / 64] |= last << ((nx + 1) % 64);
                }
            });
        }
        Self { size, n_words, words, border }
    }

    /// The bits of the points (y, z).
    #[inline]
    fn row(&self, y: usize, z: usize) -> &[u64] {
        let [_, ny, nz] = self.size;
        let is_beyond = y == 0 || z == 0 || y > ny || z > nz;
        let number = match self.border {
            Border::Capped if is_beyond => ny * nz,
            _ => y.clamp(1, ny) - 1 + ny * (z.clamp(1, nz) - 1),
        };
        &self.words[number * self.n_words..(number + 1) * self.n_words]
    }

    /// Bit x: the edge from the point (x, y, z) along `axis` is cut. Of word `i`.
    #[inline]
    fn cut(&self, axis: usize, y: usize, z: usize, i: usize) -> u64 {
        let [nx, ny, nz] = self.size;
        let row = self.row(y, z);
        match axis {
            0 => (row[i] ^ shifted(row, i)) & low_bits(nx + 1, i),
            1 if y <= ny => (row[i] ^ self.row(y + 1, z)[i]) & low_bits(nx + 2, i),
            2 if z <= nz => (row[i] ^ self.row(y, z + 1)[i]) & low_bits(nx + 2, i),
            _ => 0,
        }
    }

    /// The number of the first vertex on edges along each axis of every row.
    fn firsts(&self) -> Vec<[u32; 3]> {
        let [_, ny, nz] = self.size;
        let count = |row: usize| {
            let (y, z) = (row % (ny + 2), row / (ny + 2));
            let ones = |axis| (0..self.n_words).map(|i| self.cut(axis, y, z, i).count_ones()).sum();
            [0, 1, 2].map(ones)
        };
        let n_rows = (ny + 2) * (nz + 2);
        let mut firsts: Vec<[u32; 3]> =
            (0..n_rows).into_par_iter().with_min_len(64).map(count).collect();
        let mut n = 0;
        for count in firsts.as_flattened_mut() {
            n += std::mem::replace(count, n);
        }
        firsts
    }
}

/// A bit for each of up to 64 samples.
#[inline]
fn packed<T: Threshold>(samples: &[T], least: T) -> u64 {
    let mut are_inside = [0_u8; 64];
    for (is_inside, &sample) in are_inside.iter_mut().zip(samples) {
        *is_inside = u8::from(sample >= least);
    }
    // Eight bytes of 0 or 1 become eight bits: this factor moves byte k to bit 56 + k.
    let mut word = 0;
    for (k, eight) in are_inside.as_chunks::<8>().0.iter().enumerate() {
        let bits = u64::from_le_bytes(*eight).wrapping_mul(0x0102_0408_1020_4080) >> 56;
        word |= bits << (8 * k);
    }
    word
}

/// Word `i` of the bits one place further in a row.
#[inline]
fn shifted(row: &[u64], i: usize) -> u64 {
    row[i] >> 1 | row.get(i + 1).map_or(0, |next| next << 63)
}

/// Word `i` of a row whose first `n` bits are set.
#[inline]
fn low_bits(n: usize, i: usize) -> u64 {
    match n.saturating_sub(64 * i) {
        n @ 0..64 => (1 << n) - 1,
        _ => u64::MAX,
    }
}

/// All of the work but the bits.
struct Plain<'a, T> {
    samples: &'a [T],
    isovalue: f64,
    border: Border,
    bits: Bits,
    firsts: Vec<[u32; 3]>,
}

impl<T: Threshold> Plain<'_, T> {
    /// The vertices on edges from the points of a slice, in order.
    fn positions(&self, z: usize) -> Vec<[f32; 3]> {
        let mut positions = Vec::new();
        for y in 0..self.bits.size[1] + 2 {
            for axis in 0..3 {
                for i in 0..self.bits.n_words {
                    let mut cut = self.bits.cut(axis, y, z, i);
                    while cut != 0 {
                        let x = 64 * i + cut.trailing_zeros() as usize;
                        cut &= cut - 1;
                        positions.push(self.position([x, y, z], axis));
                    }
                }
            }
        }
        positions
    }

    /// Where the edge from a point along `axis` is cut.
    fn position(&self, lower: [usize; 3], axis: usize) -> [f32; 3] {
        let mut upper = lower;
        upper[axis] += 1;
        let is_phantom = |p: [usize; 3]| (0..3).any(|k| p[k] == 0 || p[k] > self.bits.size[k]);
        let part = if self.border == Border::Capped && (is_phantom(lower) || is_phantom(upper)) {
            // The cap lies on the border.
            if is_phantom(upper) { 1.0 } else { 0.0 }
        } else {
            zone([lower, upper].map(|p| offset(self.value(p), self.isovalue)))
        };
        let [a, b] = [lower, upper].map(|p| [0, 1, 2].map(|k| self.coordinate(k, p[k])));
        [0, 1, 2].map(|k| (a[k] + part * (b[k] - a[k])) as f32)
    }

    fn value(&self, p: [usize; 3]) -> f64 {
        let [nx, ny, nz] = self.bits.size;
        let [x, y, z] = [(p[0], nx), (p[1], ny), (p[2], nz)].map(|(i, n)| i.clamp(1, n) - 1);
        self.samples[x + nx * (y + ny * z)].into()
    }

    /// Where points are; phantoms lie on the border.
    fn coordinate(&self, axis: usize, i: usize) -> f64 {
        match self.bits.size[axis] {
            _ if i == 0 => 0.0,
            n if i > n => n as f64,
            _ => (i - 1) as f64 + 0.5,
        }
    }

    /// The triangles of the cells between a slice and the next one.
    fn triangles(&self, z: usize) -> Vec<[u32; 3]> {
        let [nx, ny, nz] = self.bits.size;
        let mut triangles = Vec::new();
        if z > nz {
            return triangles;
        }
        for y in 0..=ny {
            let beside = [[y, z], [y + 1, z], [y, z + 1], [y + 1, z + 1]];
            let rows = beside.map(|[y, z]| self.bits.row(y, z));
            let firsts = beside.map(|[y, z]| self.firsts[y + (ny + 2) * z]);
            // The next vertex of each of the rows of edges around the cells.
            let mut next: [u32; N_ROWS] = std::array::from_fn(|k| firsts[ROWS[k].1][ROWS[k].0]);
            for i in 0..self.bits.n_words {
                let words = rows.map(|row| row[i]);
                let shifted = rows.map(|row| shifted(row, i));
                let any = |w: [u64; 4]| w[0] | w[1] | w[2] | w[3];
                let all = |w: [u64; 4]| w[0] & w[1] & w[2] & w[3];
                let (some, each) = (any(words) | any(shifted), all(words) & all(shifted));
                let mut mixed = some & !each & low_bits(nx + 1, i);
                if mixed == 0 {
                    continue;
                }
                let cuts: [u64; N_ROWS] = std::array::from_fn(|k| match ROWS[k] {
                    (0, row) => (words[row] ^ shifted[row]) & low_bits(nx + 1, i),
                    (1, row) => (words[row] ^ words[row + 1]) & low_bits(nx + 2, i),
                    (_, row) => (words[row] ^ words[row + 2]) & low_bits(nx + 2, i),
                });
                while mixed != 0 {
                    let x = mixed.trailing_zeros();
                    mixed &= mixed - 1;
                    let inside = (0..4).fold(0, |inside, row| {
                        let pair = words[row] >> x & 1 | (shifted[row] >> x & 1) << 1;
                        inside | (pair as usize) << (2 * row)
                    });
                    let case = &CASES[inside];
                    let mut vertices = [0; N_EDGES];
                    for &edge in case.loops.iter().flatten() {
                        let (row, step) = EDGES[edge as usize];
                        let before = cuts[row] & low_bits((x + step) as usize, 0);
                        vertices[edge as usize] = next[row] + before.count_ones();
                    }
                    let corners = |edges: &[u8; 3]| edges.map(|edge| vertices[edge as usize]);
                    triangles.extend(case.triangles.iter().map(corners));
                }
                for (next, cut) in next.iter_mut().zip(cuts) {
                    *next += cut.count_ones();
                }
            }
        }
        triangles
    }
}

/// The rows of edges around a row of cells: the axis of the edges, and where they begin, y + 2z.
const ROWS: [(usize, usize); N_ROWS] =
    [(0, 0), (0, 1), (0, 2), (0, 3), (1, 0), (1, 2), (2, 0), (2, 1)];
const N_ROWS: usize = 8;

/// For each edge of a cell the row that it is in, and whether it is at the cell's upper end in x.
const EDGES: [(usize, u32); N_EDGES] = [
    (0, 0),
    (1, 0),
    (2, 0),
    (3, 0), // along x: bits of y and z
    (4, 0),
    (5, 0),
    (4, 1),
    (5, 1), // along y: bits of z and x
    (6, 0),
    (6, 1),
    (7, 0),
    (7, 1), // along z: bits of x and y
];
