//! Connected components of what is inside: specks of noise go, the rest stays as it is.
//!
//! Two samples inside are connected if they are corners of one cell, diagonals included (26
//! neighbours). So no cell has corners in two components, and since only samples of dropped ones
//! are changed, **the surface around what is kept is the same, bit for bit**; with 6 neighbours a
//! dropped sample could share a cell with a kept one. In the cells around a dropped component no
//! corner is inside afterwards.
//!
//! Dropped samples become the largest value below the isovalue. Any value below would do for the
//! surface; this one changes samples least, so that gradients that are taken from samples further
//! away, and surfaces at lower isovalues, change least as well.
//!
//! *Based on:* A. Rosenfeld, J. Pfaltz, "Sequential Operations in Digital Picture Processing", 1966:
//! runs of samples are joined with those of the rows before.

use std::ops::Range;

use super::{Refusal, Sample, Volume, with_room, with_samples};

/// Which connected components to keep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    /// The one with the most samples; of equal ones that which is met first, x fastest.
    Largest,
    /// Those with at least so many samples.
    AtLeast(u64),
}

/// What was found and kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kept {
    /// How many connected components there were.
    pub n_components: u64,
    /// How many were kept.
    pub n_kept: u64,
    /// The samples of the largest component.
    pub largest: u64,
    /// The samples that were changed.
    pub n_dropped: u64,
}

impl Volume {
    /// Keeps some of the connected components of the samples at or above `isovalue`, and lowers the
    /// others to just below it. For those of a range see [`Volume::band`]. Takes time in proportion
    /// to the samples, and memory for the runs of samples that are inside.
    ///
    /// # Errors
    /// The isovalue is out of range, no component is large enough, or there is no memory.
    pub fn keep(&mut self, isovalue: f64, keep: Keep) -> Result<Kept, Refusal> {
        self.check_isovalue(isovalue)?;
        let size = self.size;
        with_samples!(&mut self.samples, |values| keep_components(values, size, isovalue, keep))
    }
}

fn keep_components<T: Sample>(
    values: &mut [T],
    size: [u32; 3],
    isovalue: f64,
    keep: Keep,
) -> Result<Kept, Refusal> {
    let mut runs = Runs::new(values, size[0], isovalue)?;
    runs.join(size);
    let sizes = runs.sizes()?;
    let n_components = sizes.iter().filter(|&&n| n > 0).count() as u64;
    let largest = sizes.iter().copied().max().unwrap_or(0);
    let first_of_largest = sizes.iter().position(|&n| n == largest);
    let is_kept = |component: usize| match keep {
        Keep::Largest => Some(component) == first_of_largest,
        Keep::AtLeast(n) => sizes[component] >= n,
    };
    if let Keep::AtLeast(n) = keep
        && largest < n
    {
        return Err(format!(
            "no component of it has {n} samples at or above {isovalue}: the largest has {largest}"
        ));
    }
    let mut kept = Kept { n_components, n_kept: 0, largest, n_dropped: 0 };
    let below = T::just_below(isovalue);
    let rows = values.chunks_exact_mut(size[0] as usize);
    for (row, values) in rows.enumerate() {
        for run in runs.of_row(row) {
            let component = runs.parents[run] as usize;
            if !is_kept(component) {
                let dropped = &mut values[runs.places(run)];
                kept.n_dropped += dropped.len() as u64;
                dropped.fill(below);
            } else if component == run {
                kept.n_kept += 1;
            }
        }
    }
    Ok(kept)
}

/// The runs of samples inside, row after row, and the components that they belong to.
struct Runs {
    /// The first of each run, and the one after its last.
    bounds: Vec<[u32; 2]>,
    /// The first run of each row, and the end of all.
    rows: Vec<u32>,
    /// For each run an earlier one of its component, or itself: all lead to the first.
    parents: Vec<u32>,
}

impl Runs {
    fn new<T: Sample>(values: &[T], row_len: u32, isovalue: f64) -> Result<Self, Refusal> {
        let is_inside = |v: &T| v.to_f64() >= isovalue;
        let rows = || values.chunks_exact(row_len as usize);
        // Counted first, so that as much memory is asked for as is needed.
        let starts = |row: &[T]| {
            let after_outside = row.windows(2).filter(|w| !is_inside(&w[0]) && is_inside(&w[1]));
            after_outside.count() + usize::from(is_inside(&row[0]))
        };
        let n_runs = rows().map(starts).sum();
        let mut runs = Self {
            bounds: with_room(n_runs, "runs of its samples")?,
            rows: with_room(rows().len() + 1, "rows of its samples")?,
            parents: with_room(n_runs, "runs of its samples")?,
        };
        for row in rows() {
            runs.rows.push(runs.bounds.len() as u32);
            let mut x = 0;
            while let Some(first) = row[x..].iter().position(is_inside) {
                let start = x + first;
                let length = row[start..].iter().position(|v| !is_inside(v));
                x = length.map_or(row.len(), |length| start + length);
                runs.bounds.push([start as u32, x as u32]);
            }
        }
        runs.rows.push(runs.bounds.len() as u32);
        runs.parents.extend(0..n_runs as u32);
        Ok(runs)
    }

    fn of_row(&self, row: usize) -> Range<usize> {
        self.rows[row] as usize..self.rows[row + 1] as usize
    }

    fn places(&self, run: usize) -> Range<usize> {
        let [start, end] = self.bounds[run];
        start as usize..end as usize
    }

    /// Joins the runs that touch, each row with the four before it that are its neighbours.
    fn join(&mut self, [_, ny, nz]: [u32; 3]) {
        let (ny, nz) = (ny as usize, nz as usize);
        for z in 0..nz {
            for y in 0..ny {
                let row = z * ny + y;
                if y > 0 {
                    self.join_rows(row - 1, row);
                }
                if z > 0 {
                    for other in y.saturating_sub(1)..=(y + 1).min(ny - 1) {
                        self.join_rows((z - 1) * ny + other, row);
                    }
                }
            }
        }
        for run in 0..self.parents.len() {
            // Those before lead to the first of their component already.
            self.parents[run] = self.parents[self.parents[run] as usize];
        }
    }

    fn join_rows(&mut self, before: usize, row: usize) {
        let (mut a, mut b) = (self.of_row(before), self.of_row(row));
        while !a.is_empty() && !b.is_empty() {
            let ([a_start, a_end], [b_start, b_end]) = (self.bounds[a.start], self.bounds[b.start]);
            // Also where they touch at a corner only.
            if a_start <= b_end && b_start <= a_end {
                self.unite(a.start, b.start);
            }
            if a_end <= b_end { a.start += 1 } else { b.start += 1 }
        }
    }

    fn unite(&mut self, a: usize, b: usize) {
        let (a, b) = (self.first_of_component(a), self.first_of_component(b));
        self.parents[a.max(b)] = a.min(b) as u32;
    }

    fn first_of_component(&mut self, mut run: usize) -> usize {
        while self.parents[run] as usize != run {
            // Half of the way is gone next time.
            self.parents[run] = self.parents[self.parents[run] as usize];
            run = self.parents[run] as usize;
        }
        run
    }

    /// The samples of each component, at its first run; 0 at all others.
    fn sizes(&self) -> Result<Vec<u64>, Refusal> {
        let mut sizes = with_room(self.parents.len(), "runs of its samples")?;
        sizes.resize(self.parents.len(), 0);
        for run in 0..self.parents.len() {
            sizes[self.parents[run] as usize] += self.places(run).len() as u64;
        }
        Ok(sizes)
    }
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;
    use proptest::prelude::*;

    use super::*;
    use crate::volume::Samples;

    fn volume(size: [u32; 3], samples: Vec<u8>) -> Volume {
        Volume { size, samples: Samples::U8(samples), placing: DAffine3::IDENTITY }
    }

    #[test]
    fn the_largest_part_is_kept_as_it_is() {
        let mut line = volume([9, 1, 1], vec![200, 9, 90, 70, 60, 59, 80, 81, 0]);
        let kept = line.keep(60.0, Keep::Largest).unwrap();
        assert_eq!(kept, Kept { n_components: 3, n_kept: 1, largest: 3, n_dropped: 3 });
        assert_eq!(line.samples, Samples::U8(vec![59, 9, 90, 70, 60, 59, 59, 59, 0]));
    }

    #[test]
    fn corners_connect() {
        let mut cube = volume([2, 2, 2], vec![9, 0, 0, 0, 0, 0, 0, 9]);
        assert_eq!(cube.keep(5.0, Keep::Largest).unwrap().n_components, 1);
        let mut line = volume([3, 1, 1], vec![9, 0, 9]);
        assert_eq!(line.keep(5.0, Keep::Largest).unwrap().n_components, 2);
        assert_eq!(
            line.samples,
            Samples::U8(vec![9, 0, 4]),
            "the first of equal components is kept"
        );
    }

    #[test]
    fn words_say_what_there_is() {
        let mut line = volume([3, 1, 1], vec![9, 0, 9]);
        let said = |refused: Result<Kept, Refusal>| refused.unwrap_err();
        assert_eq!(
            said(line.keep(5.0, Keep::AtLeast(2))),
            "no component of it has 2 samples at or above 5: the largest has 1"
        );
        assert_eq!(
            said(line.keep(10.0, Keep::Largest)),
            "10 is no isovalue of it: its samples go from 0 to 9"
        );
        assert!(line.keep(f64::NAN, Keep::Largest).is_err());
    }

    /// The component of each sample inside, found by spreading.
    fn components_by_spreading(values: &[u8], size: [usize; 3]) -> Vec<Option<usize>> {
        let [nx, ny, nz] = size;
        let mut components = vec![None; values.len()];
        for seed in 0..values.len() {
            let mut open = vec![seed];
            while let Some(i) = open.pop() {
                if values[i] < 5 || components[i].is_some() {
                    continue;
                }
                components[i] = Some(seed);
                let (x, y, z) = (i % nx, i / nx % ny, i / nx / ny);
                for c in z.saturating_sub(1)..(z + 2).min(nz) {
                    for b in y.saturating_sub(1)..(y + 2).min(ny) {
                        for a in x.saturating_sub(1)..(x + 2).min(nx) {
                            open.push((c * ny + b) * nx + a);
                        }
                    }
                }
            }
        }
        components
    }

    proptest! {
        #[test]
        fn parts_are_those_found_by_spreading(
            size in prop::array::uniform3(1_usize..7),
            noise in prop::collection::vec(0_u8..12, 216),
            density in 0_u8..9,
            at_least in 1_u64..6,
        ) {
            // Few samples inside make many components.
            let n = size.iter().product();
            let values: Vec<u8> =
                noise[..n].iter().map(|&v| v.saturating_sub(density)).collect();
            let components = components_by_spreading(&values, size);
            let n_of = |component| components.iter().filter(|&&p| p == component).count() as u64;
            let mut tried = volume(size.map(|n| n as u32), values.clone());
            let Ok(kept) = tried.keep(5.0, Keep::AtLeast(at_least)) else {
                let is_small = |seed: &Option<usize>| seed.is_none() || n_of(*seed) < at_least;
                prop_assert!(components.iter().all(is_small));
                return Ok(());
            };
            let expected: Vec<u8> = (0..n)
                .map(|i| match components[i] {
                    Some(component) if n_of(Some(component)) < at_least => 4,
                    _ => values[i],
                })
                .collect();
            let mut seeds: Vec<_> = components.iter().flatten().collect();
            seeds.sort_unstable();
            seeds.dedup();
            prop_assert_eq!(kept.n_components, seeds.len() as u64);
            prop_assert_eq!(
                kept.n_kept,
                seeds.iter().filter(|&&&seed| n_of(Some(seed)) >= at_least).count() as u64
            );
            prop_assert_eq!(tried.samples, Samples::U8(expected));
        }
    }
}
