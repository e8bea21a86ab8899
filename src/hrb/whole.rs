//! All bricks of an octree, as if it could not tell where an isosurface is.

use rayon::prelude::*;

use super::{HrbOctree, NearVoxels, Value};
use crate::mesh::{Border, Grid, SIDE};

impl<V: Value> HrbOctree<V> {
    /// As [`Self::grid`], with every brick: nothing is passed over. It gives the same mesh; what it
    /// takes longer is what the octree saves as an index.
    #[must_use]
    pub fn whole_grid(&self, isovalue: f64, border: Border) -> Grid<NearVoxels<'_, V>> {
        let n = self.size.map(|n| n.div_ceil(SIDE) + 2);
        let place = |i: u32| [i % n[0], i / n[0] % n[1], i / n[0] / n[1]];
        let brick = |i: u32| self.brick(place(i), isovalue, border);
        let bricks = (0..n.iter().product()).into_par_iter().map(brick).collect();
        Grid::new(bricks, self.size, border)
    }
}
