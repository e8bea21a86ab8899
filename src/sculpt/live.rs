//! A volume under the hands of a sculptor: its octree and its mesh, which follow every change.

use crate::{
    hrb::{HrbOctree, Samples, Value, Window},
    mesh::{Border, Extraction, LiveMesh, SIDE},
};

/// See the file's text. Coordinates are in samples, from the first corner of the first one.
#[derive(Clone, Debug)]
pub struct Sculpture<V> {
    octree: HrbOctree<V>,
    isovalue: f64,
    border: Border,
    mesh: LiveMesh,
}

impl<V: Value> Sculpture<V> {
    /// A sculpture of what is `isovalue` or above in a volume.
    #[must_use]
    pub fn new(mut octree: HrbOctree<V>, isovalue: f64, border: Border) -> Self {
        octree.assign_corners();
        let whole = Window::of(&[octree.samples().grown(1)]);
        let mut mesh = LiveMesh::default();
        mesh.renew(&octree.grid_around(isovalue, border, &whole), whole.chosen());
        Self { octree, isovalue, border, mesh }
    }

    /// The volume.
    #[must_use]
    pub fn octree(&self) -> &HrbOctree<V> {
        &self.octree
    }

    /// What is at this value or above is solid.
    #[must_use]
    pub fn isovalue(&self) -> f64 {
        self.isovalue
    }

    /// The mesh, with holes.
    #[must_use]
    pub fn mesh(&self) -> &LiveMesh {
        &self.mesh
    }

    /// The mesh in one piece: what [`crate::mesh::extract`] makes of the volume.
    #[must_use]
    pub fn extraction(&self) -> Extraction {
        self.mesh.compact()
    }

    /// Gives samples of the volume other values, x fastest.
    pub fn set(&mut self, samples: &Samples, values: &[V]) {
        let changes = self.octree.set(samples, values);
        if changes.bricks.is_empty() {
            return;
        }
        // Where no region at the surface is as large as a brick, before and after, it is no matter how
        // larger ones are divided.
        if self.mesh.is_of_small_regions() {
            let boxes: Vec<Samples> = changes.bricks.iter().map(|box_| box_.grown(1)).collect();
            let near = Window::of(&boxes);
            let grid = self.octree.grid_around(self.isovalue, self.border, &near);
            if grid.is_of_small_voxels() {
                return self.mesh.renew(&grid, near.chosen());
            }
        }
        let changed = changes.bricks.iter().chain(&changes.large);
        let changed = changed.fold(changes.bricks[0], |all, one| all.with(one));
        let near = Window::of(&[self.reach(changed)]);
        let grid = self.octree.grid_around(self.isovalue, self.border, &near);
        self.mesh.renew(&grid, near.chosen());
    }

    /// The volume within the parts of the mesh that changes of some samples can reach: its difference
    /// before and after is that of the whole.
    pub(super) fn volume_near(&self, samples: &Samples) -> f64 {
        self.mesh.volume_of(Window::of(&[samples.grown(1)]).chosen())
    }

    /// All samples whose bricks have to give their parts of the mesh anew. Regions larger than bricks
    /// keep vertices of all their faces in one brick, so that they count as a whole.
    fn reach(&self, changed: Samples) -> Samples {
        let mut reach = changed.grown(1);
        loop {
            let large = self.octree.large_regions(&reach);
            let wider = large
                .iter()
                .filter(|region| self.has_vertices(region))
                .fold(reach, |wider, region| wider.with(&region.grown(1)));
            if wider == reach {
                return reach;
            }
            reach = wider;
        }
    }

    /// Whether a region larger than a brick has vertices of its own, or had some.
    fn has_vertices(&self, region: &Samples) -> bool {
        if self.mesh.has_vertices_at(region.first.map(|i| i / SIDE + 1), 0) {
            return true;
        }
        let is_inside = |value: V| value.to_f64() >= self.isovalue;
        let of_region = self.octree.region_at(region.first);
        let own = is_inside(of_region.value);
        let size = self.octree.size();
        (0..3).any(|axis| {
            [region.first[axis].wrapping_sub(1), region.end[axis]].into_iter().any(|beside| {
                if beside >= size[axis] {
                    return own && self.border == Border::Capped;
                }
                let mut p = region.first;
                p[axis] = beside;
                let other = self.octree.region_at(p);
                other.level >= of_region.level && is_inside(other.value) != own
            })
        })
    }
}
