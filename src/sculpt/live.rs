//! A volume under the hands of a sculptor: its octree and its mesh, which follow every change.

use crate::{
    hrb::{HrbOctree, Region, Samples, Value},
    math::morton_encode,
    mesh::{Border, Extraction, LiveMesh, SIDE, extract_bricks},
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
        let mut sculpture = Self { octree, isovalue, border, mesh: LiveMesh::default() };
        let whole = sculpture.octree.samples().grown(1);
        sculpture.renew(&whole);
        sculpture
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
        let changed = self.octree.set(samples, values);
        if !changed.is_empty() {
            let reach = self.reach(changed);
            self.renew(&reach);
        }
    }

    /// All samples whose bricks have to give their parts of the mesh anew. Regions larger than bricks
    /// keep vertices of all their faces in one brick, so that they count as a whole.
    fn reach(&self, changed: Samples) -> Samples {
        let mut reach = changed.grown(1);
        loop {
            let mut wider = reach;
            for base in self.octree.large_bases(&reach) {
                let region = self.octree.region_at(base);
                if self.has_vertices(&region) {
                    let own = Samples { first: base, end: base.map(|i| i + (1 << region.level)) };
                    wider = wider.with(&own.grown(1));
                }
            }
            if wider == reach {
                return reach;
            }
            reach = wider;
        }
    }

    /// Whether a region larger than a brick has vertices of its own, or had some.
    fn has_vertices(&self, region: &Region<V>) -> bool {
        let place = region.base.map(|i| i / SIDE + 1);
        if self.mesh.has_vertices_at(morton_encode(place), 0) {
            return true;
        }
        let is_inside = |value: V| value.to_f64() >= self.isovalue;
        let own = is_inside(region.value);
        let size = self.octree.size();
        (0..3).any(|axis| {
            [region.base[axis].wrapping_sub(1), region.base[axis] + (1 << region.level)]
                .into_iter()
                .any(|beside| {
                    if beside >= size[axis] {
                        return own && self.border == Border::Capped;
                    }
                    let mut p = region.base;
                    p[axis] = beside;
                    let other = self.octree.region_at(p);
                    other.level >= region.level && is_inside(other.value) != own
                })
        })
    }

    /// Finds the mesh again in all bricks that hold these samples; the layer around the volume, to which
    /// they have grown, counts with them.
    fn renew(&mut self, samples: &Samples) {
        // Bricks are counted from one before the volume. What has grown to the first sample reaches
        // beyond it.
        let first = samples.first.map(|i| if i == 0 { 0 } else { i / SIDE + 1 });
        let end = samples.end.map(|i| i.div_ceil(SIDE) + 1);
        // Two bricks around, so that those next to the renewed ones are complete.
        let grid = self.octree.grid_within(
            self.isovalue,
            self.border,
            first.map(|i| i.saturating_sub(3)),
            end.map(|i| i + 3),
        );
        let is_renewed =
            |place: [u32; 3]| (0..3).all(|axis| (first[axis]..end[axis]).contains(&place[axis]));
        let meshes = extract_bricks(&grid, is_renewed);
        let mut bricks = Vec::new();
        for z in first[2]..end[2] {
            for y in first[1]..end[1] {
                bricks.extend((first[0]..end[0]).map(|x| morton_encode([x, y, z])));
            }
        }
        self.mesh.replace(&bricks, &meshes);
    }
}
